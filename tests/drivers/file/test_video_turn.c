/* All eight orientations of a stored frame, at odd sizes, pixel by pixel; anything but a quarter turn is refused. */
#include "check.h"

#include "file/video/video_turn.h"

#include <libavutil/display.h>
#include <stdlib.h>

static pupil_why why;

static void set_matrix(int32_t m[9], int xx, int xy, int yx, int yy)
{
    memset(m, 0, 9 * sizeof *m);
    m[0] = xx * 65536;
    m[1] = yx * 65536;
    m[3] = xy * 65536;
    m[4] = yy * 65536;
    m[8] = 1 << 30;
}

/* A sample value that occurs nowhere else. */
static uint16_t sample(uint32_t x, uint32_t y, size_t plane)
{
    return (uint16_t)(1 + x + 251 * y + 20011 * plane);
}

static void fill(void *data, uint32_t width, uint32_t height, int floats)
{
    for (size_t p = 0; p < 3; p++)
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++) {
                const size_t pixel = (size_t)y * width + x;
                if (floats)
                    ((float *)data)[3 * pixel + p] = sample(x, y, p);
                else
                    ((uint16_t *)data)[(size_t)width * height * p + pixel] = sample(x, y, p);
            }
}

/* The pixel (x, y) goes to (xx x + xy y, yx x + yy y) plus the corner; all are whole samples. */
static void check_turned(const pupil_image_const *image, uint32_t width, uint32_t height, int floats, const int way[4])
{
    const int64_t left = (way[0] < 0 ? (int64_t)width - 1 : 0) + (way[1] < 0 ? (int64_t)height - 1 : 0);
    const int64_t top = (way[2] < 0 ? (int64_t)width - 1 : 0) + (way[3] < 0 ? (int64_t)height - 1 : 0);
    const size_t plane = (size_t)width * height;
    CHECK(image->width == (way[1] ? height : width) && image->height == (way[1] ? width : height));
    for (size_t p = 0; p < 3; p++)
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++) {
                const int64_t to_x = way[0] * (int64_t)x + way[1] * (int64_t)y + left;
                const int64_t to_y = way[2] * (int64_t)x + way[3] * (int64_t)y + top;
                const size_t at = (size_t)(to_y * image->width + to_x);
                const int got = floats ? (int)((const float *)image->data)[3 * at + p]
                                       : ((const uint16_t *)image->data)[plane * p + at];
                CHECK_MSG(got == sample(x, y, p), "%ux%u plane %zu: (%u, %u) is not at (%lld, %lld)", width, height, p,
                          x, y, (long long)to_x, (long long)to_y);
            }
}

static void test_ways(uint32_t width, uint32_t height)
{
    static const int ways[8][4] = {{1, 0, 0, 1},  {0, -1, 1, 0}, {-1, 0, 0, -1}, {0, 1, -1, 0},
                                   {-1, 0, 0, 1}, {1, 0, 0, -1}, {0, 1, 1, 0},   {0, -1, -1, 0}};
    void *data = malloc((size_t)width * height * 3 * sizeof(float));
    for (size_t w = 0; w < 8; w++)
        for (int floats = 0; floats < 2; floats++) {
            pupil_video_turn turn = {0};
            int32_t matrix[9];
            fill(data, width, height, floats);
            pupil_image_const image =
                pupil_image_const_of(data, width, height, floats ? PUPIL_PIXEL_RGB32F : PUPIL_PIXEL_I444_16);
            set_matrix(matrix, ways[w][0], ways[w][1], ways[w][2], ways[w][3]);
            CHECK(pupil_video_turn_set(&turn, matrix, &why) == 0);
            CHECK(pupil_video_turn_image(&turn, &image, &why) == 0);
            CHECK(w > 0 || image.data == data); /* nothing is copied without a turn */
            check_turned(&image, width, height, floats, ways[w]);
            pupil_video_turn_free(&turn);
        }
    free(data);
}

/* Angles as in libav: negative is counterclockwise. */
static void test_angles(void)
{
    static const int ways[4][4] = {{0, 0, 0, 0}, {0, 1, -1, 0}, {-1, 0, 0, -1}, {0, -1, 1, 0}};
    for (int quarter = 0; quarter < 4; quarter++) {
        pupil_video_turn turn = {0};
        int32_t matrix[9];
        av_display_rotation_set(matrix, -90.0 * quarter);
        CHECK(pupil_video_turn_set(&turn, matrix, &why) == 0);
        const int *way = ways[quarter];
        CHECK_MSG(turn.xx == way[0] && turn.xy == way[1] && turn.yx == way[2] && turn.yy == way[3],
                  "%d quarters: %d %d %d %d", quarter, turn.xx, turn.xy, turn.yx, turn.yy);
    }
    for (double angle = 5; angle < 360; angle += 10) {
        pupil_video_turn turn = {0};
        int32_t matrix[9];
        av_display_rotation_set(matrix, angle);
        CHECK(pupil_video_turn_set(&turn, matrix, &why) == -1 && strstr(why.text, "--no-rotate"));
    }
    pupil_video_turn none = {0}; /* of an invalid matrix */
    CHECK(pupil_video_turn_set(&none, (const int32_t[9]){0}, &why) == 0 && !none.xx && !none.xy);
    CHECK(pupil_video_turn_set(&(pupil_video_turn){0}, (const int32_t[9]){INT32_MIN, 0, 0, 0, INT32_MIN, 0, 0, 0, 0},
                               &why) == 0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_ways(1, 1);
    test_ways(7, 3);
    test_ways(33, 65);
    test_ways(64, 32);
    test_angles();
    return check_end();
}

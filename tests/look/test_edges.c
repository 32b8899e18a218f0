/* Edges: each pixel against the textbook operator; groups of rows; formats; what is refused. */
#include "check.h"
#include "pupil/look.h"

#include <math.h>

enum { MOST = 700 };

static uint8_t in[MOST * 4 * 40 + 64], out[sizeof in], other[sizeof in];

static int at(const uint8_t *pixels, int width, int height, int bytes, int x, int y, int c)
{
    x = x < 0 ? 0 : x >= width ? width - 1 : x; /* the border is repeated */
    y = y < 0 ? 0 : y >= height ? height - 1 : y;
    return pixels[(y * width + x) * bytes + c];
}

static int is_edge(int width, int height, int bytes, int x, int y, unsigned threshold)
{
    static const int weight[3] = {1, 2, 1};
    for (int c = 0; c < 3; c++) {
        double gx = 0, gy = 0;
        for (int i = -1; i <= 1; i++) {
            gx += weight[i + 1] *
                  (at(in, width, height, bytes, x + 1, y + i, c) - at(in, width, height, bytes, x - 1, y + i, c));
            gy += weight[i + 1] *
                  (at(in, width, height, bytes, x + i, y + 1, c) - at(in, width, height, bytes, x + i, y - 1, c));
        }
        if (gx * gx + gy * gy >= (double)threshold * threshold)
            return 1;
    }
    return 0;
}

/* kind 0: any bytes; 1: a soft picture with a step in it. */
static void fill(int width, int height, int bytes, int kind)
{
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < bytes; c++)
                in[(y * width + x) * bytes + c] =
                    (uint8_t)(kind ? 40 + x / 8 + y / 4 + (x > width / 2 ? 50 : 0) + c : (int)(check_random() & 255));
}

static void compare(uint32_t pixel, int width, int height, unsigned threshold, int kind)
{
    static const uint8_t colour[3] = {255, 20, 7};
    const int bytes = (int)pupil_pixel_bytes(pixel), flipped = pixel == PUPIL_PIXEL_BGR8 || pixel == PUPIL_PIXEL_BGRX8;
    const pupil_image_const image = {.data = in,
                                     .stride_bytes = (ptrdiff_t)width * bytes,
                                     .width = (uint32_t)width,
                                     .height = (uint32_t)height,
                                     .pixel = pixel};
    const pupil_image to = {
        .data = out, .stride_bytes = image.stride_bytes, .width = image.width, .height = image.height, .pixel = pixel};
    uint64_t edges = 99, count = 0, sum = 0;
    fill(width, height, bytes, kind);
    memset(out, 0x55, sizeof out);
    CHECK(pupil_mark_edges(&image, threshold, colour, &to, &edges) == PUPIL_OK);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const int edge = is_edge(width, height, bytes, x, y, threshold), i = (y * width + x) * bytes;
            count += (uint64_t)edge;
            for (int c = 0; c < bytes; c++) {
                const int wanted = edge && c < 3 ? colour[flipped ? 2 - c : c] : in[i + c];
                CHECK_MSG(out[i + c] == wanted, "format %u, %dx%d, threshold %u, at %d %d: %d, not %d", pixel, width,
                          height, threshold, x, y, out[i + c], wanted);
            }
        }
    CHECK_MSG(edges == count, "%llu of %llu", (unsigned long long)edges, (unsigned long long)count);
    CHECK(out[width * height * bytes] == 0x55);

    /* the same in groups, from the last one on, upside down in memory */
    const pupil_image turned = {.data = other + (size_t)(height - 1) * (size_t)to.stride_bytes,
                                .stride_bytes = -to.stride_bytes,
                                .width = to.width,
                                .height = to.height,
                                .pixel = pixel};
    for (uint32_t end = image.height; end;) {
        const uint32_t rows = 1 + (uint32_t)(check_random() % end), first = end - rows;
        const pupil_image_const part = pupil_image_rows(image, first, rows);
        const pupil_image part_out = pupil_image_out_rows(turned, first, rows);
        uint64_t some;
        CHECK(pupil_mark_edges(&part, threshold, colour, &part_out, &some) == PUPIL_OK);
        sum += some;
        end = first;
    }
    for (int y = 0; y < height; y++)
        CHECK(memcmp(out + y * to.stride_bytes, other + (height - 1 - y) * to.stride_bytes, (size_t)(width * bytes)) ==
              0);
    CHECK(sum == edges);
}

static void check_step(void)
{
    /* a step of 50 codes has 200, on both of its sides; the slopes next to it have 1 code in 8 pixels */
    uint64_t edges = 0;
    const pupil_image_const image = {
        .data = in, .stride_bytes = 64 * 3, .width = 64, .height = 20, .pixel = PUPIL_PIXEL_RGB8};
    const pupil_image to = {.data = out, .stride_bytes = 64 * 3, .width = 64, .height = 20, .pixel = PUPIL_PIXEL_RGB8};
    fill(64, 20, 3, 1);
    CHECK(pupil_mark_edges(&image, 190, in, &to, &edges) == PUPIL_OK && edges == 2 * 20);
    CHECK(pupil_mark_edges(&image, 230, in, &to, &edges) == PUPIL_OK && edges == 0);
    CHECK(pupil_mark_edges(&image, 190, in, &to, NULL) == PUPIL_OK);
    /* an output has its input's format, and its coding is not read */
    const pupil_coding of_another = {.size_bytes = sizeof of_another, .matrix = 77};
    pupil_image coded = to;
    coded.coding = &of_another;
    CHECK(pupil_mark_edges(&image, 190, in, &coded, &edges) == PUPIL_OK && edges == 2 * 20);
}

static void check_refusals(void)
{
    const pupil_image_const good = {.data = in, .stride_bytes = 48, .width = 4, .height = 3, .pixel = PUPIL_PIXEL_RGB8};
    const pupil_image to = {.data = out, .stride_bytes = 48, .width = 4, .height = 3, .pixel = PUPIL_PIXEL_RGB8};
    const uint8_t red[3] = {255, 0, 0};
    uint64_t edges = 7;
    pupil_image_const bad = good;
    pupil_image bad_out = to;
    memset(out, 0x77, sizeof out);
    CHECK(pupil_mark_edges(NULL, 9, red, &to, &edges) == PUPIL_ERR_NULL);
    CHECK(pupil_mark_edges(&good, 9, NULL, &to, &edges) == PUPIL_ERR_NULL);
    CHECK(pupil_mark_edges(&good, 9, red, NULL, &edges) == PUPIL_ERR_NULL);
    CHECK(pupil_mark_edges(&good, 0, red, &to, &edges) == PUPIL_ERR_VALUE);
    CHECK(pupil_mark_edges(&good, PUPIL_EDGE_MOST + 1, red, &to, &edges) == PUPIL_ERR_VALUE);
    bad.data = NULL;
    CHECK(pupil_mark_edges(&bad, 9, red, &to, &edges) == PUPIL_ERR_NULL);
    bad = good, bad.pixel = PUPIL_PIXEL_RGBA16F;
    CHECK(pupil_mark_edges(&bad, 9, red, &to, &edges) == PUPIL_ERR_PIXEL);
    bad = good, bad.stride_bytes = 11;
    CHECK(pupil_mark_edges(&bad, 9, red, &to, &edges) == PUPIL_ERR_STRIDE);
    bad = good, bad.width = 0;
    CHECK(pupil_mark_edges(&bad, 9, red, &to, &edges) == PUPIL_ERR_SIZE);
    bad_out.data = NULL;
    CHECK(pupil_mark_edges(&good, 9, red, &bad_out, &edges) == PUPIL_ERR_NULL);
    bad_out = to, bad_out.pixel = PUPIL_PIXEL_BGR8;
    CHECK(pupil_mark_edges(&good, 9, red, &bad_out, &edges) == PUPIL_ERR_PIXEL_OUT);
    bad_out = to, bad_out.width = 3;
    CHECK(pupil_mark_edges(&good, 9, red, &bad_out, &edges) == PUPIL_ERR_SIZE);
    bad_out = to, bad_out.height = 2;
    CHECK(pupil_mark_edges(&good, 9, red, &bad_out, &edges) == PUPIL_ERR_SIZE);
    bad_out = to, bad_out.stride_bytes = -11;
    CHECK(pupil_mark_edges(&good, 9, red, &bad_out, &edges) == PUPIL_ERR_STRIDE);
    bad_out = to, bad_out.size_bytes = 3;
    CHECK(pupil_mark_edges(&good, 9, red, &bad_out, &edges) == PUPIL_ERR_SIZE_BYTES);
    for (size_t i = 0; i < sizeof out; i++)
        CHECK(out[i] == 0x77);
    CHECK(edges == 7);
}

int main(int argc, char **argv)
{
    static const uint32_t pixel[] = {PUPIL_PIXEL_RGB8, PUPIL_PIXEL_BGR8, PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_RGBX8,
                                     PUPIL_PIXEL_BGRX8};
    static const int size[][2] = {{1, 1},  {1, 7},  {2, 2},  {3, 1},   {63, 5},
                                  {64, 4}, {85, 3}, {86, 3}, {171, 2}, {700, 3}};
    static const unsigned threshold[] = {1, 60, 200, 777, PUPIL_EDGE_MOST};
    check_begin(argc, argv);
    for (size_t p = 0; p < sizeof pixel / sizeof *pixel; p++)
        for (size_t s = 0; s < sizeof size / sizeof *size; s++)
            for (size_t t = 0; t < sizeof threshold / sizeof *threshold; t++)
                compare(pixel[p], size[s][0], size[s][1], threshold[t], (s + t) % 2 != 0);
    check_step();
    check_refusals();
    return check_end();
}

#include "video_turn.h"

#include <stdlib.h>
#include <string.h>

#include "refuse.h"

/* Pixels of a side of a tile: source and target both stay in the cache, whichever way the tile is turned. */
#define TILE 32u

/* A part of a turn this small counts as none: a thousandth. */
#define LITTLE 1000

static int is_little(int32_t of, int32_t beside)
{
    return llabs((long long)of) * LITTLE <= llabs((long long)beside);
}

static int sign(int32_t value)
{
    return (value > 0) - (value < 0);
}

/* libav has (x, y) -> (m[0] x + m[3] y, m[1] x + m[4] y). */
int pupil_video_turn_set(pupil_video_turn *t, const int32_t m[9], pupil_why *why)
{
    const int along = m[0] && m[4] && is_little(m[1], m[0]) && is_little(m[3], m[4]);
    const int across = m[1] && m[3] && is_little(m[0], m[1]) && is_little(m[4], m[3]);
    if (!m[0] && !m[1] && !m[3] && !m[4]) /* no matrix: as ffmpeg and players take it */
        return 0;
    if (!along && !across)
        return pupil_refuse(why, "it is to be shown turned by less than a quarter turn, or skewed, which is not done; "
                                 "--no-rotate reads it as it is stored");
    t->xx = along ? sign(m[0]) : 0;
    t->xy = along ? 0 : sign(m[3]);
    t->yx = along ? 0 : sign(m[1]);
    t->yy = along ? sign(m[4]) : 0;
    if (t->xx == 1 && t->yy == 1)
        t->xx = t->yy = 0;
    return 0;
}

void pupil_video_turn_sides(const pupil_video_turn *t, uint32_t *width, uint32_t *height)
{
    const uint32_t was = *width;
    if (!t->xy)
        return;
    *width = *height;
    *height = was;
}

static void copy_row(const uint8_t *from, ptrdiff_t step, uint8_t *to, uint32_t count, size_t bytes)
{
    for (uint32_t i = 0; i < count; i++, from += step, to += bytes) {
        if (bytes == 3 * sizeof(float))
            memcpy(to, from, 3 * sizeof(float)); /* its size is known to the compiler */
        else if (bytes == 3)
            memcpy(to, from, 3);
        else
            memcpy(to, from, sizeof(uint16_t));
    }
}

/* The target's pixel (x, y) is the source's pixel at first + x * step_x + y * step_y. */
static void turn_plane(const pupil_video_turn *t, const uint8_t *from, uint32_t width, uint32_t height, size_t bytes,
                       uint8_t *to)
{
    const ptrdiff_t pixel = (ptrdiff_t)bytes, row = pixel * (ptrdiff_t)width;
    const ptrdiff_t step_x = t->xx * pixel + t->xy * row, step_y = t->yx * pixel + t->yy * row;
    const uint8_t *first = from;
    if (t->xx < 0 || t->yx < 0)
        first += row - pixel;
    if (t->xy < 0 || t->yy < 0)
        first += row * (ptrdiff_t)(height - 1);
    uint32_t out_width = width, out_height = height;
    pupil_video_turn_sides(t, &out_width, &out_height);
    for (uint32_t top = 0; top < out_height; top += TILE)
        for (uint32_t left = 0; left < out_width; left += TILE)
            for (uint32_t y = top; y < out_height && y < top + TILE; y++)
                copy_row(first + (ptrdiff_t)left * step_x + (ptrdiff_t)y * step_y, step_x,
                         to + ((size_t)y * out_width + left) * bytes, out_width - left < TILE ? out_width - left : TILE,
                         bytes);
}

int pupil_video_turn_image(pupil_video_turn *t, pupil_image_const *image, pupil_why *why)
{
    const uint32_t width = image->width, height = image->height;
    const size_t planes = image->pixel == PUPIL_PIXEL_I444_16 ? 3 : 1;
    const size_t bytes = pupil_pixel_bytes(image->pixel), plane = bytes * width * height;
    if (!t->xx && !t->xy)
        return 0;
    if (planes * plane > t->room_bytes) {
        free(t->room);
        t->room = malloc(planes * plane);
        t->room_bytes = t->room ? planes * plane : 0;
    }
    if (!t->room)
        return pupil_refuse(why, "not enough memory for a frame of %u x %u", width, height);
    for (size_t i = 0; i < planes; i++)
        turn_plane(t, (const uint8_t *)image->data + i * plane, width, height, bytes, t->room + i * plane);
    uint32_t out_width = width, out_height = height;
    pupil_video_turn_sides(t, &out_width, &out_height);
    const pupil_coding *coding = image->coding;
    *image = pupil_image_const_of(t->room, out_width, out_height, image->pixel);
    image->coding = coding;
    return 0;
}

void pupil_video_turn_free(pupil_video_turn *t)
{
    free(t->room);
    *t = (pupil_video_turn){0};
}

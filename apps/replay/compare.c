#include "compare.h"

#include <stdlib.h>
#include <string.h>

#include "common/font.h"
#include "refuse.h"

int compare_open(compare *c, const frame_options *right, uint32_t primaries)
{
    pupil_config config = right->config;
    config.primaries = primaries;
    *c = (compare){0};
    return frame_pipeline_open(&c->right, &config, right->threads) ||
                   (right->veil &&
                    frame_pipeline_use_veil(&c->right, &right->eye, right->bloom ? &right->bloom_above : NULL))
               ? -1
               : 0;
}

void compare_close(compare *c)
{
    frame_pipeline_close(&c->right);
    free(c->picture.data);
    *c = (compare){0};
}

static int make_room(compare *c, const pupil_image *half, pupil_why *why)
{
    const uint32_t width = 2 * half->width;
    const size_t bytes = (size_t)width * 3 * half->height;
    void *data = c->picture.data;
    if (width > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "--compare: two pictures of %u pixels side by side are wider than %u", half->width,
                            PUPIL_MAX_SIDE_PX);
    if (bytes > c->bytes) {
        free(data);
        data = malloc(bytes);
        c->bytes = data ? bytes : 0;
    }
    c->picture = pupil_image_of(data, width, half->height, PUPIL_PIXEL_RGB8);
    return data ? 0 : pupil_refuse(why, "not enough memory");
}

static void put_half(const compare *c, const pupil_image *half, uint32_t x)
{
    for (uint32_t y = 0; y < half->height; y++)
        memcpy((uint8_t *)c->picture.data + (ptrdiff_t)y * c->picture.stride_bytes + 3 * (size_t)x,
               (const uint8_t *)half->data + (ptrdiff_t)y * half->stride_bytes, 3 * (size_t)half->width);
}

/* A pixel of the font: a square of `scale` pixels of the picture. */
static void put_dot(const compare *c, uint32_t x, uint32_t y, uint32_t scale, uint8_t code)
{
    for (uint32_t row = y; row < y + scale && row < c->picture.height; row++)
        memset((uint8_t *)c->picture.data + (ptrdiff_t)row * c->picture.stride_bytes + 3 * (size_t)x, code,
               3 * (size_t)scale);
}

/* White on a dark bar at the top left of a half, as much as fits. */
static void put_label(const compare *c, const char *text, uint32_t x, uint32_t width)
{
    const uint32_t scale = 1 + c->picture.height / 480, cell = FONT_STEP * scale;
    const size_t fits = width / cell > 2 ? width / cell - 2 : 0;
    const size_t length = strlen(text) < fits ? strlen(text) : fits;
    const uint32_t wide = (uint32_t)(length + 1) * FONT_STEP, high = FONT_HEIGHT + 4;
    for (uint32_t row = 0; length && row < high; row++)
        for (uint32_t column = 0; column < wide; column++) {
            const uint32_t letter = (column - FONT_STEP / 2) / FONT_STEP, bit = (column - FONT_STEP / 2) % FONT_STEP;
            const int inside =
                column >= FONT_STEP / 2 && letter < length && bit < FONT_WIDTH && row >= 2 && row < 2 + FONT_HEIGHT;
            const int is_set = inside && font_rows(text[letter])[row - 2] >> (FONT_WIDTH - 1 - bit) & 1;
            put_dot(c, x + column * scale, row * scale, scale, is_set ? 255 : 24);
        }
}

int compare_frame(compare *c, const frame_pipeline *left, const pupil_frame *frame, const char *const label[2],
                  pupil_why *why)
{
    const pupil_image *half = &left->display;
    if (frame_pipeline_meter(&c->right, frame, why) || frame_pipeline_map(&c->right, frame, 1, why) ||
        make_room(c, half, why))
        return -1;
    put_half(c, half, 0);
    put_half(c, &c->right.display, half->width);
    for (uint32_t i = 0; i < 2; i++)
        put_label(c, label[i], i * half->width, half->width);
    return 0;
}

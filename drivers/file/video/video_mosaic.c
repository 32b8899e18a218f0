#include "video_mosaic.h"

#include <stdlib.h>
#include <string.h>

#include "refuse.h"

typedef struct mosaic_format {
    int format, bytes, is_big;
    uint32_t bayer;
} mosaic_format;

static const mosaic_format *find(int format)
{
    static const mosaic_format formats[] = {
        {AV_PIX_FMT_BAYER_RGGB8, 1, 0, PUPIL_BAYER_RGGB},    {AV_PIX_FMT_BAYER_GRBG8, 1, 0, PUPIL_BAYER_GRBG},
        {AV_PIX_FMT_BAYER_GBRG8, 1, 0, PUPIL_BAYER_GBRG},    {AV_PIX_FMT_BAYER_BGGR8, 1, 0, PUPIL_BAYER_BGGR},
        {AV_PIX_FMT_BAYER_RGGB16LE, 2, 0, PUPIL_BAYER_RGGB}, {AV_PIX_FMT_BAYER_GRBG16LE, 2, 0, PUPIL_BAYER_GRBG},
        {AV_PIX_FMT_BAYER_GBRG16LE, 2, 0, PUPIL_BAYER_GBRG}, {AV_PIX_FMT_BAYER_BGGR16LE, 2, 0, PUPIL_BAYER_BGGR},
        {AV_PIX_FMT_BAYER_RGGB16BE, 2, 1, PUPIL_BAYER_RGGB}, {AV_PIX_FMT_BAYER_GRBG16BE, 2, 1, PUPIL_BAYER_GRBG},
        {AV_PIX_FMT_BAYER_GBRG16BE, 2, 1, PUPIL_BAYER_GBRG}, {AV_PIX_FMT_BAYER_BGGR16BE, 2, 1, PUPIL_BAYER_BGGR},
    };
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].format == format)
            return &formats[i];
    return NULL;
}

int pupil_video_is_mosaic(int format)
{
    return find(format) != NULL;
}

static void copy_rows(uint8_t *to, const AVFrame *frame, const mosaic_format *of)
{
    const size_t row = (size_t)frame->width * (size_t)of->bytes;
    for (int y = 0; y < frame->height; y++, to += row) {
        const uint8_t *from = frame->data[0] + (ptrdiff_t)y * frame->linesize[0];
        if (of->bytes == 1)
            memcpy(to, from, row);
        for (size_t x = 0; of->bytes == 2 && x < row; x += 2) {
            const uint16_t code = (uint16_t)(from[x + !of->is_big] << 8 | from[x + of->is_big]);
            memcpy(to + x, &code, sizeof code);
        }
    }
}

int pupil_video_mosaic_take(pupil_video_mosaic *m, const AVFrame *frame, const pupil_frame_info *info,
                            pupil_image_const *image, pupil_why *why)
{
    const mosaic_format *of = find(frame->format);
    const size_t bytes = (size_t)frame->width * (size_t)frame->height * (size_t)of->bytes;
    if (frame->width % 2 || frame->height % 2)
        return pupil_refuse(why, "a mosaic of %d x %d pixels; it has even sides", frame->width, frame->height);
    if (bytes > m->room_bytes) {
        free(m->bytes);
        m->bytes = malloc(bytes);
        m->room_bytes = m->bytes ? bytes : 0;
    }
    if (!m->bytes)
        return pupil_refuse(why, "not enough memory for a frame of %d x %d", frame->width, frame->height);
    copy_rows(m->bytes, frame, of);
    *image = pupil_image_const_of(m->bytes, (uint32_t)frame->width, (uint32_t)frame->height,
                                  of->bytes == 1 ? PUPIL_PIXEL_BAYER8 : PUPIL_PIXEL_BAYER16);
    if (!m->has_colour) {
        const pupil_colour_options options = {0};
        const pupil_coding coding = {.bayer = of->bayer};
        if (pupil_white_balance_begin(&m->colour, &options, &coding, image->pixel, NULL, why))
            return -1;
        image->coding = &m->colour.coding;
        pupil_white_balance_frame(&m->colour, image, info);
    }
    m->has_colour = 1;
    image->coding = &m->colour.coding;
    return 0;
}

void pupil_video_mosaic_done(pupil_video_mosaic *m, const pupil_image_const *image, const pupil_frame_info *info)
{
    if (m->has_colour)
        pupil_white_balance_frame(&m->colour, image, info);
}

void pupil_video_mosaic_free(pupil_video_mosaic *m)
{
    free(m->bytes);
    *m = (pupil_video_mosaic){0};
}

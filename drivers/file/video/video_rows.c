#include "video_rows.h"

#include <math.h>

#include <libavcodec/avcodec.h>
#include <libavutil/avconfig.h>
#include <libavutil/pixdesc.h>

/* FFmpeg 6 (libavutil 58) has moved it to libavutil, FFmpeg 7 has removed the old one. */
#if LIBAVUTIL_VERSION_MAJOR < 58
#define av_chroma_location_enum_to_pos avcodec_enum_to_chroma_pos
#endif

/* Offset of the first chroma sample from the first luma sample, in luma samples: half a chroma sample's distance where
 * it is in the centre (position 128 in libav's terms). */
static double chroma_offset(int position, int shift)
{
    return position / 128.0 * (ldexp(1, shift) - 1) / 2;
}

void pupil_video_set_chroma(pupil_video_pixels *p, int location)
{
    int x_position = 0, y_position = 0;
    if (av_chroma_location_enum_to_pos(&x_position, &y_position, (enum AVChromaLocation)location))
        x_position = 0;
    int shift = p->format->log2_chroma_w;
    double offset = chroma_offset(x_position, shift);
    for (int x = 0; x < p->kind.width; x++) {
        double at = ldexp(x - offset, -shift);
        at = at > 0 ? at : 0;
        p->chroma_left[x] = (uint32_t)at;
        p->chroma_eighths[x] = (uint32_t)(8 * (at - floor(at)));
    }
}

const uint16_t *pupil_video_read_codes(pupil_video_pixels *p, const AVFrame *f, int component, int y, int width)
{
    const AVComponentDescriptor *c = &p->format->comp[component];
    const int is_big = (p->format->flags & AV_PIX_FMT_FLAG_BE) != 0;
    if (c->step == 2 && !c->shift && c->depth > 8 && is_big == AV_HAVE_BIGENDIAN) /* as they are */
        return (const uint16_t *)(const void *)(f->data[c->plane] + (ptrdiff_t)y * f->linesize[c->plane] + c->offset);
    av_read_image_line2(p->codes, (const uint8_t **)(uintptr_t)f->data, f->linesize, p->format, 0, y, component, width,
                        0, sizeof *p->codes);
    return p->codes;
}

pupil_video_chroma_rows pupil_video_chroma_rows_at(const pupil_video_pixels *p, const AVFrame *f, int y)
{
    const int shift = p->format->log2_chroma_h, height = AV_CEIL_RSHIFT(f->height, shift);
    int x_position = 0, y_position = 128;
    if (f->chroma_location != AVCHROMA_LOC_UNSPECIFIED)
        av_chroma_location_enum_to_pos(&x_position, &y_position, f->chroma_location);
    const double at = ldexp(y - chroma_offset(y_position, shift), -shift);
    const int first = (int)floor(at);
    return (pupil_video_chroma_rows){.upper = first < 0 ? 0 : first,
                                     .lower = first + 1 < height ? first + 1 : height - 1,
                                     .eighths = (uint32_t)(8 * (at - first))};
}

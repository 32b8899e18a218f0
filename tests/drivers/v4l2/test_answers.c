/* Random numbers in a driver's answers, for every format that is read: refused with a sentence, or all planes are
 * inside their memory. */
#include "check.h"

#include <linux/videodev2.h>

#include "v4l2/format.h"

/* If accepted, every plane is inside its area, and planes of one area follow one another without overlap. */
static void check_planes(const pupil_v4l2_format *f)
{
    uint64_t end[PUPIL_V4L2_MOST_AREAS] = {0};
    for (uint32_t i = 0; i < pupil_pixel_planes(f->pixel); i++) {
        const uint32_t area = f->buffers > 1 ? i : 0, rows = i ? pupil_chroma_rows(f->pixel, f->height) : f->height;
        const uint64_t row = i ? pupil_chroma_row_bytes(f->pixel, f->width) : pupil_row_bytes(f->pixel, f->width);
        const uint64_t last = f->plane_bytes[i] + (uint64_t)f->stride_bytes[i] * (rows - 1) + row;
        const char *name = pupil_v4l2_fourcc_name(f->fourcc).text;
        CHECK_MSG(f->plane_bytes[i] >= end[area] && last <= f->needs_bytes[area] &&
                      f->needs_bytes[area] <= f->size_bytes[area] && (rows == 1 || f->stride_bytes[i] >= row),
                  "%s %ux%u: plane %u from %u to %llu of %u", name, f->width, f->height, i, f->plane_bytes[i],
                  (unsigned long long)last, f->size_bytes[area]);
        end[area] = f->plane_bytes[i] + (uint64_t)f->stride_bytes[i] * (rows - 1) + row;
    }
    CHECK(f->needs_bytes[0] > 0 && (f->compressed || pupil_coding_check(&f->coding, f->pixel, NULL) == PUPIL_OK));
}

static uint32_t any_of(const uint32_t *values, uint32_t count)
{
    return values[check_random() % count];
}

int main(int argc, char **argv)
{
    static const uint32_t sides[] = {0, 1, 2, 3, 15, 16, 31, 64, 4096, 16383, 16384, 16385, 65537, UINT32_MAX};
    static const uint32_t strides[] = {0, 1, 31, 32, 64, 65, 128, 8192, 1u << 20, 1u << 31, UINT32_MAX};
    static const uint32_t sizes[] = {0, 1, 1024, 1536, 4608, 6144, 1u << 20, 1u << 24, 1u << 28, 1u << 31, UINT32_MAX};
    static pupil_why why;
    char names[512], *rest = names;
    uint32_t formats = 0, taken = 0;
    check_begin(argc, argv);
    snprintf(names, sizeof names, "%s", pupil_v4l2_natives);
    for (const char *name; (name = strtok_r(rest, ", ", &rest));) {
        const uint32_t fourcc = strlen(name) <= 4 ? pupil_v4l2_fourcc(name) : 0;
        if (!fourcc || !pupil_v4l2_is_read(fourcc))
            continue; /* the sentence's other words */
        formats++;
        for (int i = 0; i < 30000; i++) {
            pupil_v4l2_format f;
            struct v4l2_format answer = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE};
            struct v4l2_pix_format_mplane *pix = &answer.fmt.pix_mp;
            pix->pixelformat = fourcc;
            pix->width = any_of(sides, sizeof sides / sizeof sides[0]);
            pix->height = any_of(sides, sizeof sides / sizeof sides[0]);
            pix->field = V4L2_FIELD_NONE;
            pix->num_planes = (uint8_t)(1 + check_random() % 4);
            for (int k = 0; k < 4; k++) {
                pix->plane_fmt[k].bytesperline = any_of(strides, sizeof strides / sizeof strides[0]);
                pix->plane_fmt[k].sizeimage = any_of(sizes, sizeof sizes / sizeof sizes[0]);
            }
            pix->colorspace = check_random() % 14;
            pix->ycbcr_enc = (uint8_t)(check_random() % 10);
            pix->quantization = (uint8_t)(check_random() % 3);
            pix->xfer_func = (uint8_t)(check_random() % 10);
            why.text[0] = 0;
            if (pupil_v4l2_format_read(&answer, &f, &why) == 0) {
                check_planes(&f);
                taken++;
            } else {
                CHECK(why.text[0]);
            }
        }
    }
    CHECK_MSG(formats == 34 && taken > 5000, "%u formats, %u answers taken", formats, taken);
    return check_end();
}

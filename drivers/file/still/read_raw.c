/* DNG and the raw files of cameras, through LibRaw: unpacked, demosaiced, balanced as the camera was set, in linear
 * Rec.709 from 0 at black to 1 at white. */
#include "still.h"

#include <libraw/libraw.h>
#include <string.h>

#include "refuse.h"
#include "still_private.h"

/* Nothing that depends on the picture: no histogram stretch, no white level of its own. */
static void set_params(libraw_output_params_t *p, int as_stored)
{
    p->output_bps = 16;
    p->output_color = 1; /* the primaries of sRGB, which are those of Rec.709 */
    p->gamm[0] = p->gamm[1] = 1.0;
    p->no_auto_bright = 1;
    p->adjust_maximum_thr = 0.0f;
    p->use_camera_wb = 1;
    p->use_camera_matrix = 1;
    if (as_stored)
        p->user_flip = 0;
}

static int take(pupil_still *still, const libraw_processed_image_t *image, pupil_why *why)
{
    const uint64_t pixels = (uint64_t)image->width * image->height;
    const uint32_t colours = image->colors;
    if (image->type != LIBRAW_IMAGE_BITMAP || image->bits != 16 || (colours != 1 && colours != 3) ||
        image->data_size < pixels * colours * sizeof(uint16_t))
        return pupil_still_fail(why, "LibRaw makes no picture of 16 bits of it");
    if (pupil_still_reserve(still, image->width, image->height, PUPIL_PIXEL_RGB32F, why))
        return -1;
    float *to = still->pixels;
    for (uint64_t i = 0; i < pixels; i++)
        for (uint32_t c = 0; c < 3; c++) {
            uint16_t code;
            memcpy(&code, image->data + (i * colours + (colours == 3 ? c : 0)) * sizeof code, sizeof code);
            *to++ = (float)code / 65535.0f;
        }
    return 0;
}

static int fail(int code, pupil_why *why)
{
    return pupil_still_fail(why, "is damaged, or not what its header says: LibRaw: %s", libraw_strerror(code));
}

static int process(libraw_data_t *raw, pupil_still *still, pupil_why *why)
{
    int code = libraw_unpack(raw);
    if (code == LIBRAW_SUCCESS)
        code = libraw_dcraw_process(raw);
    if (code != LIBRAW_SUCCESS)
        return fail(code, why);
    libraw_processed_image_t *image = libraw_dcraw_make_mem_image(raw, &code);
    if (!image)
        return fail(code, why);
    const int failed = take(still, image, why);
    libraw_dcraw_clear_mem(image);
    return failed;
}

int pupil_read_raw(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    libraw_data_t *raw = libraw_init(0);
    if (!raw)
        return pupil_still_fail(why, "not enough memory");
    int failed;
    set_params(&raw->params, still->as_stored);
    libraw_set_dataerror_handler(raw, NULL, NULL);                            /* its own writes to standard error */
    const int code = libraw_open_buffer(raw, (void *)(uintptr_t)bytes, size); /* which it only reads */
    const libraw_image_sizes_t *sizes = &raw->sizes;
    if (code == LIBRAW_FILE_UNSUPPORTED)
        failed = -pupil_still_fail(why, "is no raw file that LibRaw knows"); /* PUPIL_STILL_NOT_RAW */
    else if (code != LIBRAW_SUCCESS)
        failed = fail(code, why);
    else if (pupil_still_size_ok(sizes->raw_width, sizes->raw_height, why))
        failed = -1;
    else
        failed = process(raw, still, why);
    libraw_close(raw);
    return failed;
}

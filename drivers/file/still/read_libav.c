/* Stills in the formats that libav reads and pupil has no reader of its own for: JPEG, TIFF, WebP, BMP and others. */
#include "still.h"

#include <string.h>

#include "file/video/video_source.h"
#include "refuse.h"

static int take(pupil_still *still, const pupil_image_const *image, pupil_why *why)
{
    const size_t row = (size_t)image->width * 3 * sizeof(float);
    if (image->pixel != PUPIL_PIXEL_RGB32F)
        return pupil_refuse(why, "is a still of PQ or HLG, which can be read alone and not in a sequence");
    if (pupil_still_reserve(still, image->width, image->height, PUPIL_PIXEL_RGB32F, why))
        return -1;
    for (uint32_t y = 0; y < image->height; y++)
        memcpy((uint8_t *)still->pixels + y * row, pupil_image_rows(*image, y, 1).data, row);
    return 0;
}

int pupil_read_libav(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    const pupil_source_options options = {.as_stored = still->as_stored};
    pupil_source *source;
    pupil_frame frame;
    pupil_why words = {""};
    if (pupil_video_source_open_bytes(bytes, size, "", (int64_t)pupil_still_most(still), &options, &source, &words))
        return pupil_refuse(why, "is no OpenEXR, Radiance, PFM or PNG file, by its first bytes, and for libav %s",
                            strncmp(words.text, ": ", 2) == 0 ? words.text + 2 : words.text);
    int failed = pupil_source_next(source, &frame, &words) != PUPIL_SOURCE_FRAME;
    if (failed)
        pupil_refuse(why, "%s", strncmp(words.text, ": ", 2) == 0 ? words.text + 2 : words.text);
    else
        failed = take(still, &frame.image, why);
    pupil_source_close(source);
    return failed ? -1 : 0;
}

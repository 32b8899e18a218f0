/* Stills that libav reads and pupil has no own reader for: JPEG, TIFF, WebP, BMP and others. */
#include "still.h"

#include <string.h>

#include "file/video/video_source.h"
#include "icc.h"
#include "refuse.h"
#include "still_private.h"
#include "tiff_tags.h"
#include "upright.h"

static int take(pupil_still *still, const pupil_image_const *image, pupil_why *why)
{
    const size_t row = (size_t)image->width * 3 * sizeof(float);
    if (pupil_pixel_is_mosaic(image->pixel))
        return pupil_refuse(why, "is a still of a mosaic, but not a DNG; without a header it is read as raw:FILE,...");
    if (image->pixel != PUPIL_PIXEL_RGB32F)
        return pupil_refuse(why, "is a still of PQ or HLG, which can be read alone and not in a sequence");
    if (pupil_still_reserve(still, image->width, image->height, PUPIL_PIXEL_RGB32F, why))
        return -1;
    for (uint32_t y = 0; y < image->height; y++)
        memcpy((uint8_t *)still->pixels + y * row, pupil_image_rows(*image, y, 1).data, row);
    return 0;
}

/* Passes on libav's message. libav calls files that it does not support damaged: the sentence corrects that. */
static int refuse_words(const uint8_t *bytes, size_t size, const char *words, pupil_why *why)
{
    static const char damaged[] = "frame 0 is damaged: ";
    const char *text = strncmp(words, ": ", 2) == 0 ? words + 2 : words;
    if (strncmp(text, damaged, strlen(damaged)) != 0 ||
        (!strstr(text, "not supported") && !strstr(text, "unsupported") && !strstr(text, "Not yet implemented")))
        return pupil_refuse(why, "%s", text);
    return pupil_refuse(why, "libav lacks this kind of file: %s%s", text + strlen(damaged),
                        pupil_is_tiff(bytes, size) ? "; save it as OpenEXR (.exr) or PFM, whose floats are read" : "");
}

/* Whether libav supports this compression (its tiff.h): if not, it calls the file damaged. */
static int is_compression_of_libav(uint32_t compression)
{
    enum { NONE = 1, ADOBE_DEFLATE = 8, PACKBITS = 32773, DEFLATE = 32946, LZMA = 34925 };
    return (compression >= NONE && compression <= ADOBE_DEFLATE) || compression == PACKBITS || compression == DEFLATE ||
           compression == LZMA;
}

/* For tiles and JPEG, libav returns black pixels without an error, for CMYK in planes a negative; its messages about
 * L*a*b* and other compressions do not help. */
static int check_tiff(const uint8_t *bytes, size_t size, pupil_why *why)
{
    enum {
        COMPRESSION = 259,
        PHOTOMETRIC = 262,
        PLANAR = 284,
        TILE_WIDTH = 322,
        TILE_OFFSETS = 324,
        OLD_JPEG = 6,
        JPEG = 7,
        CMYK = 5,
        CIE_LAB = 8,
        ITU_LAB = 10,
        LOGLUV = 34676, /* and 34677 */
    };
    uint32_t value = 0, planar = 1;
    if (pupil_tiff_find(bytes, size, PHOTOMETRIC, &value) && value >= CIE_LAB && value <= ITU_LAB)
        return pupil_refuse(why, "is a TIFF in CIE L*a*b*, which is not read; convert it to RGB "
                                 "(convert IN.tif -colorspace sRGB OUT.tif)");
    if (pupil_tiff_find(bytes, size, PHOTOMETRIC, &value) && value == CMYK &&
        pupil_tiff_find(bytes, size, PLANAR, &planar) && planar == 2)
        return pupil_refuse(why, "is a TIFF of CMYK in planes, which is not read; convert it to RGB "
                                 "(convert IN.tif -colorspace sRGB OUT.tif)");
    if (pupil_tiff_find(bytes, size, TILE_WIDTH, &value) || pupil_tiff_find(bytes, size, TILE_OFFSETS, &value))
        return pupil_refuse(why, "is a TIFF in tiles; save it in strips, or as PNG");
    if (pupil_tiff_find(bytes, size, COMPRESSION, &value) && (value == OLD_JPEG || value == JPEG))
        return pupil_refuse(why, "is a TIFF compressed as JPEG; save it as LZW or Deflate, or as PNG");
    if (pupil_tiff_find(bytes, size, COMPRESSION, &value) && (value == LOGLUV || value == LOGLUV + 1))
        return pupil_refuse(why, "is a TIFF of LogLuv, which is not read; save it as Radiance or OpenEXR");
    if (pupil_tiff_find(bytes, size, COMPRESSION, &value) && !is_compression_of_libav(value))
        return pupil_refuse(why, "is a TIFF of compression %u, which is not read; save it as LZW or Deflate, or as PNG",
                            value);
    return 0;
}

int pupil_read_libav(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    /* The orientation must be applied once only: newer libav reads that of TIFF and WebP, too. */
    const int is_turned = pupil_orientation_of(bytes, size) != 1;
    const pupil_source_options options = {.as_stored = still->as_stored || is_turned};
    pupil_source *source;
    pupil_frame frame;
    pupil_why words = {""};
    if (check_tiff(bytes, size, why))
        return -1;
    if (pupil_video_source_open_bytes(bytes, size, "", (int64_t)pupil_still_most(still), &options, &source, &words))
        return pupil_refuse(why, "is not an OpenEXR, Radiance, PFM or PNG file, by its first bytes, and for libav %s",
                            strncmp(words.text, ": ", 2) == 0 ? words.text + 2 : words.text);
    int failed = pupil_source_next(source, &frame, &words) != PUPIL_SOURCE_FRAME;
    if (failed)
        refuse_words(bytes, size, words.text, why);
    else
        failed = take(still, &frame.image, why) ||
                 pupil_icc_apply(bytes, size, still->pixels, (uint64_t)still->width * still->height, why) ||
                 pupil_still_make_upright(still, bytes, size, why);
    pupil_source_close(source);
    return failed ? -1 : 0;
}

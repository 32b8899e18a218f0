/* Stills that libav reads and pupil has no own reader for: JPEG, TIFF, WebP, BMP and others. */
#include "still.h"

#include <string.h>

#include "file/video/video_source.h"
#include "gain_map.h"
#include "icc.h"
#include "jpeg_segments.h"
#include "refuse.h"
#include "still_private.h"
#include "tiff_tags.h"
#include "upright.h"

static int take(pupil_still *still, const pupil_frame *frame, pupil_why *why)
{
    const pupil_image_const *image = &frame->image;
    const size_t row = (size_t)image->width * 3 * sizeof(float);
    if (pupil_pixel_is_mosaic(image->pixel))
        return pupil_refuse(why, "is a still of a mosaic, but not a DNG; without a header it is read as raw:FILE,...");
    if (image->pixel != PUPIL_PIXEL_RGB32F)
        return pupil_refuse(why, "is a still of PQ or HLG, which can be read alone and not in a sequence");
    if (pupil_still_reserve(still, image->width, image->height, PUPIL_PIXEL_RGB32F, why))
        return -1;
    still->code_light = frame->code_light;
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

/* Of a JPEG, the bytes of its first picture: where another is close behind, libav does not take the file for a JPEG. */
static size_t first_picture(const uint8_t *bytes, size_t size)
{
    pupil_jpeg_segment s;
    size_t at = 0;
    while (pupil_jpeg_next_segment(bytes, size, &at, &s))
        continue;
    return at ? pupil_jpeg_next_picture(bytes, size, at) : size;
}

/* Decodes the picture. The caller closes the source, whose frame it is, unless it is NULL. 0, or -1 and libav's words.
 */
static int decode(const pupil_still *still, const uint8_t *bytes, size_t size, const pupil_source_options *options,
                  pupil_source **source, pupil_frame *frame, pupil_why *words)
{
    *source = NULL;
    size = first_picture(bytes, size);
    if (pupil_video_source_open_bytes(bytes, size, "", (int64_t)pupil_still_most(still), options, source, words))
        return -1;
    return pupil_source_next(*source, frame, words) == PUPIL_SOURCE_FRAME ? 0 : -1;
}

static void leave_out_gain_map(pupil_still *still, const char *reason, const char *detail)
{
    pupil_still_fail(&still->notice, "is read as SDR, without its gain map: %s%s", reason, detail);
}

/* Applies a gain map to a picture that is as stored and has the primaries of `colour`. One that cannot be decoded is
 * left out. 0, or -1 and a sentence: no memory. */
static int apply_gain_map(pupil_still *still, const pupil_gain_map *map, pupil_still_colour *colour, pupil_why *why)
{
    const pupil_source_options options = {.as_stored = 1, .as_linear = 1};
    pupil_still_colour own = {.convert = 0}, between;
    pupil_source *source;
    pupil_frame frame;
    pupil_why words = {""};
    int failed = 0;
    if (decode(still, map->jpeg, map->jpeg_bytes, &options, &source, &frame, &words)) {
        const char *damage = strstr(words.text, "damaged: ");
        leave_out_gain_map(still, "the map cannot be decoded: ", damage ? damage + strlen("damaged: ") : words.text);
    } else if (frame.image.pixel != PUPIL_PIXEL_RGB32F) {
        leave_out_gain_map(still, "the map is no JPEG of 8 bits", "");
    } else {
        if (map->has_own_primaries)
            failed = pupil_icc_apply_curves(map->jpeg, map->jpeg_bytes, NULL, 0, &own, why);
        if (own.luminance[1] > 0) {
            pupil_still_colour_between(colour, &own, &between);
            pupil_still_colour_apply(&between, still->pixels, (uint64_t)still->width * still->height);
            *colour = own;
        }
        failed = failed || pupil_gain_map_apply(map, &frame.image, still->pixels, still->width, still->height, why);
    }
    pupil_source_close(source);
    return failed ? -1 : 0;
}

/* From what libav decoded to light, upright. */
static int finish(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    const uint64_t pixels = (uint64_t)still->width * still->height;
    pupil_still_colour colour;
    pupil_gain_map map;
    pupil_why reason = {""};
    if (pupil_icc_apply_curves(bytes, size, still->pixels, pixels, &colour, why))
        return -1;
    const int found = pupil_gain_map_find(bytes, size, &map, &reason);
    if (found < 0)
        leave_out_gain_map(still, reason.text, "");
    if (found > 0 && apply_gain_map(still, &map, &colour, why))
        return -1;
    pupil_still_colour_apply(&colour, still->pixels, pixels);
    return pupil_still_make_upright(still, bytes, size, why);
}

int pupil_read_libav(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    /* The orientation must be applied once only: libav reads that of JPEG, newer ones that of TIFF and WebP, too. */
    const int is_turned = pupil_orientation_of(bytes, size) != 1;
    const pupil_source_options options = {.as_stored = still->as_stored || is_turned};
    pupil_source *source;
    pupil_frame frame;
    pupil_why words = {""};
    if (check_tiff(bytes, size, why))
        return -1;
    int failed = decode(still, bytes, size, &options, &source, &frame, &words);
    if (!source)
        return pupil_refuse(why, "is not an OpenEXR, Radiance, PFM or PNG file, by its first bytes, and for libav %s",
                            strncmp(words.text, ": ", 2) == 0 ? words.text + 2 : words.text);
    if (failed)
        refuse_words(bytes, size, words.text, why);
    else
        failed = take(still, &frame, why);
    pupil_source_close(source);
    return failed || finish(still, bytes, size, why) ? -1 : 0;
}

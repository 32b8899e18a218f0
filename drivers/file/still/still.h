/* drivers/file/still/still.h: one HDR still in memory, and the readers that make it: one file a format, one function
 * each.
 *
 * A reader takes the whole file as bytes (so that a fuzzer can call it as it is) and leaves linear Rec.709/D65 pixels.
 * Limits: at most PUPIL_STILL_MAX_PIXELS pixels, fewer of small files (--max-pixels), and PUPIL_MAX_SIDE_PX a side; a
 * header that promises more than the file can hold is refused before memory is allocated. Files have at most 2 GiB.
 *
 * How each format's values are interpreted:
 *
 * - OpenEXR: linear, as stored; expTime and the like are never divided out. Half, float and uint channels; scanlines or
 *   tiles (the full-size level); all compressions of the installed OpenEXR C library (3.1 lacks DWAA and DWAB). R, G
 *   and B; else X, Y and Z, which are CIE XYZ under D65, as R, G and B are whose primaries are its axes; else Y with RY
 *   and BY (chroma of half the size is interpolated linearly); else Y as grey; else the first layer with one of these
 *   sets ("left.R"). Alpha and other channels are left out. Of several parts the first flat one with such channels;
 * deep data is refused. The picture is the display window, as compositors and players show it: what the data window
 * does not cover is black (`window` says what it covers), what it holds beyond is cut off, and a data window wholly
 * outside is refused. `chromaticities` are converted from, where they are sane.
 * - Radiance: mantissa * 2^(exponent - 136), the lower edge of Ward's step, as nearly every reader has it: the figures
 *   published with images agree with it and not with Ward's mantissa + 1/2. EXPOSURE and COLORCORR are divided out (an
 *   EXPOSURE of 0 is unknown), PRIMARIES converted from where they are sane, XYZE through its equal-energy white.
 * - PFM: as stored. Of the scale only the sign (the byte order) counts: files in circulation carry magnitudes (1/255,
 *   a maximum) that their samples are not to be multiplied with. PF, Pf and PF4 (alpha left out).
 * - PNG: by cICP (linear, BT.709, sRGB, PQ with 1.0 at 100 cd/m2, HLG scene light 0..1), else iCCP (icc.h), else sRGB,
 *   else gAMA (a power law; 1.0 is linear), else as sRGB; primaries by cICP or iCCP, else cHRM. 8-bit sRGB stays RGB8,
 *   which the core decodes; everything else becomes float. Alpha is left out.
 *
 * - DNG, of a mosaic or linear, and the raw files of cameras (NEF, CR2, CR3, ARW, RAF, ORF, RW2 ...), through LibRaw:
 *   demosaiced, balanced as the camera was set, 0 at black and 1 at white, upright. Exposure time and ISO are not
 *   divided out.
 * - JPEG, TIFF, WebP, BMP and what else libav reads as a picture: as a video's frame (video_pixels.h), and by the ICC
 *   profile of JPEG, TIFF and WebP (icc.h): phones store P3. A JPEG with a gain map (Ultra HDR, ISO 21496-1) becomes
 *   the HDR picture, in which 1.0 is the white of SDR (gain_map.h). A map that is damaged is left out, and `notice`
 *   says so.
 *
 * JPEG, TIFF, PNG and WebP come upright by their orientation (Exif), unless as_stored.
 *
 * White other than D65 is adapted (Bradford). Chromaticities that are zero, not finite or no usable triangle count as
 * unspecified, that is as Rec.709/D65.
 */
#ifndef PUPIL_DRIVERS_FILE_STILL_STILL_H
#define PUPIL_DRIVERS_FILE_STILL_STILL_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"

#define PUPIL_STILL_MAX_PIXELS (UINT64_C(1) << 26) /* 8192 x 8192; 805 MB as RGB float */
/* For files: a small one must not take all that memory. Photographs have at most some 10 pixels for each byte. */
#define PUPIL_STILL_SMALL_PIXELS    (UINT64_C(1) << 22) /* allowed for files of any size: 50 MB */
#define PUPIL_STILL_PIXELS_FOR_BYTE 256

typedef struct pupil_still {
    void *pixels; /* malloc'ed; kept and reused by the next read where it is large enough */
    size_t capacity_bytes;
    uint32_t width, height;
    uint32_t pixel;      /* PUPIL_PIXEL_RGB32F; PUPIL_PIXEL_RGB8 of 8-bit sRGB PNG */
    int as_stored;       /* not turned upright; set by the caller */
    uint64_t max_pixels; /* set by the caller: the limit for files of any size; 0: as above */
    uint64_t most;       /* the limit for the file that is read; 0: PUPIL_STILL_MAX_PIXELS */
    float code_light;    /* as in pupil_frame: above 0 where RGB32F was decoded from codes */
    double window[4];    /* x, y, width and height, in fractions, of the part that the file has; the rest is black. A
                          * width of 0: the whole picture */
    pupil_why notice;    /* what of the file could not be used, though its picture can; "": nothing */
    double exposure_s;   /* 0: in all four formats the pixel values are scene light already */
    uint8_t *file;       /* the file's bytes while it is read; kept and reused by the next pupil_still_load */
    size_t file_capacity_bytes;
} pupil_still;

void pupil_still_free(pupil_still *still);

/* How many pixels may be read. */
uint64_t pupil_still_most(const pupil_still *still);

/* Makes room; a sentence without a file name on failure (the caller puts the name in front). */
int pupil_still_reserve(pupil_still *still, uint64_t width, uint64_t height, uint32_t pixel, pupil_why *why);

/* 0, or -1 and a sentence without a file name ("the header promises 40000 x 40000 pixels, at most ..."). After a
 * failure the still has no valid picture, but can be reused. */
typedef int pupil_still_reader(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why);

pupil_still_reader pupil_read_exr;
pupil_still_reader pupil_read_radiance;
pupil_still_reader pupil_read_pfm;
pupil_still_reader pupil_read_png;
/* DNG and the raw files of cameras; PUPIL_STILL_NOT_RAW: it is none. */
enum { PUPIL_STILL_NOT_RAW = 1 };
pupil_still_reader pupil_read_raw;
pupil_still_reader pupil_read_libav; /* other formats, by libav (read_libav.c) */

/* Reads a file into memory and decodes it by its first bytes (not by its name); the sentence begins with the path. */
int pupil_still_load(pupil_still *still, const char *path, pupil_why *why);

#endif

/* PNG of 8 or 16 bits through libpng: decoded to linear light by what its colour chunks say (still.h). */
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include "file/common/transfer_curves.h"
#include "icc.h"
#include "still_private.h"
#include "upright.h"

/* Deflate cannot shrink more than 1032:1 (zlib's technical notes); a header that promises more pixels is wrong. */
#define DEFLATE_RATIO 1032

/* Larger ancillary chunks (profiles, texts) are not read; libpng's own default. */
#define MAX_CHUNK_BYTES 8000000

/* What cICP's transfer characteristics mean (Rec. ITU-T H.273, table 3), and gAMA. */
typedef enum curve { CURVE_SRGB, CURVE_POWER, CURVE_LINEAR, CURVE_BT709, CURVE_PQ, CURVE_HLG } curve;

typedef struct png_reader {
    const uint8_t *bytes;
    size_t size, at;
    jmp_buf failed;
    pupil_why *why;
    png_structp png;
    png_infop info;
    float *table; /* linear light by code */
    curve curve;
    double power;
    pupil_still_colour colour;
    const uint8_t *profile; /* in info; NULL: none, or sRGB's */
    uint32_t profile_bytes;
} png_reader;

static void on_error(png_structp png, png_const_charp message)
{
    png_reader *r = png_get_error_ptr(png);
    pupil_still_fail(r->why, "is damaged as a PNG file: %s", message);
    longjmp(r->failed, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void on_read(png_structp png, png_bytep out, size_t count)
{
    png_reader *r = png_get_io_ptr(png);
    if (count > r->size - r->at)
        png_error(png, "it ends early");
    memcpy(out, r->bytes + r->at, count);
    r->at += count;
}

/* The inverse of each curve, from a code 0..1 to light. */
static double light(const png_reader *r, double v)
{
    switch (r->curve) {
    case CURVE_SRGB:
        return pupil_srgb_light(v);
    case CURVE_POWER:
        return pow(v, r->power);
    case CURVE_BT709: /* Rec. ITU-R BT.709-6, item 1.2, inverted */
        return v < 0.081 ? v / 4.5 : pow((v + 0.099) / 1.099, 1 / 0.45);
    case CURVE_PQ:
        return pupil_pq_light(v);
    case CURVE_HLG:
        return pupil_hlg_light(v);
    case CURVE_LINEAR:
        break;
    }
    return v;
}

/* cICP (PNG third edition, 11.3.2.6), which libpng before 1.6.46 passes on as an unknown chunk. 1 where there is
 * one. */
static int read_cicp(png_reader *r, pupil_chromaticities *primaries, int *has_primaries)
{
    static const pupil_chromaticities bt2020 = {{0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290}};
    static const pupil_chromaticities display_p3 = {{0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290}};
    png_unknown_chunkp chunks;
    int count = png_get_unknown_chunks(r->png, r->info, &chunks);
    for (int i = 0; i < count; i++) {
        const png_byte *data = chunks[i].data;
        if (memcmp(chunks[i].name, "cICP", 4) || chunks[i].size != 4)
            continue;
        *has_primaries = data[0] == 9 || data[0] == 12;
        *primaries = data[0] == 9 ? bt2020 : display_p3;
        switch (data[1]) {
        case 8:
            r->curve = CURVE_LINEAR;
            break;
        case 13:
            r->curve = CURVE_SRGB;
            break;
        case 16:
            r->curve = CURVE_PQ;
            break;
        case 18:
            r->curve = CURVE_HLG;
            break;
        case 1:
        case 6:
        case 14:
        case 15:
            r->curve = CURVE_BT709;
            break;
        default:
            png_error(r->png, "its cICP transfer is none of 1, 6, 8, 13, 14, 15, 16 and 18");
        }
        return 1;
    }
    return 0;
}

/* A profile that is not sRGB's. */
static int read_profile(png_reader *r)
{
    png_charp name;
    png_bytep profile;
    png_uint_32 bytes;
    int compression;
    if (!png_get_iCCP(r->png, r->info, &name, &compression, &profile, &bytes) ||
        pupil_icc_apply_profile(profile, bytes, NULL, 0, r->why) <= 0)
        return 0;
    r->profile = profile;
    r->profile_bytes = bytes;
    return 1;
}

static void read_colour(png_reader *r)
{
    pupil_chromaticities primaries;
    int has_primaries = 0, intent;
    double gamma = 0;
    r->curve = CURVE_SRGB;
    if (!read_cicp(r, &primaries, &has_primaries) && !read_profile(r) && !png_get_sRGB(r->png, r->info, &intent)) {
        double *xy = primaries.xy;
        if (png_get_gAMA(r->png, r->info, &gamma) && gamma > 0.01 && gamma < 100) {
            r->curve = fabs(gamma - 1) < 1e-4 ? CURVE_LINEAR : CURVE_POWER;
            r->power = 1 / gamma;
        }
        has_primaries = png_get_cHRM(r->png, r->info, xy + 6, xy + 7, xy, xy + 1, xy + 2, xy + 3, xy + 4, xy + 5) != 0;
    }
    pupil_still_colour_from(has_primaries ? &primaries : NULL, &r->colour);
}

static void read_header(png_reader *r)
{
    png_set_user_limits(r->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* read_pixels checks the size and reports it */
    png_set_chunk_malloc_max(r->png, MAX_CHUNK_BYTES);
    png_set_chunk_cache_max(r->png, 64);
    png_set_keep_unknown_chunks(r->png, PNG_HANDLE_CHUNK_ALWAYS, (png_const_bytep) "cICP", 1);
    png_set_read_fn(r->png, r, on_read);
    png_read_info(r->png, r->info);
    read_colour(r);
    png_set_expand(r->png); /* palettes to RGB, fewer than 8 bits to 8 */
    png_set_gray_to_rgb(r->png);
    png_set_strip_alpha(r->png);
}

/* Codes become light in place: the rows are at the end of the buffer, so that the floats never overwrite codes that are
 * still to be read. */
static void decode(const png_reader *r, float *out, const uint8_t *codes, uint64_t samples, int bits)
{
    for (uint64_t i = 0; i < samples; i++)
        out[i] = r->table[bits == 16 ? codes[2 * i] << 8 | codes[2 * i + 1] : codes[i]];
}

static int make_table(png_reader *r, int bits)
{
    int count = 1 << bits;
    r->table = malloc((size_t)count * sizeof(float));
    if (!r->table)
        return pupil_still_fail(r->why, "no memory for a table of %d codes", count);
    for (int code = 0; code < count; code++)
        r->table[code] = (float)light(r, (double)code / (count - 1));
    return 0;
}

static float code_light(const png_reader *r)
{
    const int is_sdr = r->curve == CURVE_SRGB || r->curve == CURVE_POWER || r->curve == CURVE_BT709;
    return is_sdr ? PUPIL_SDR_CODE_LIGHT : r->table[1];
}

static int read_pixels(png_reader *r, pupil_still *still)
{
    uint64_t width = png_get_image_width(r->png, r->info), height = png_get_image_height(r->png, r->info);
    uint64_t stored = (uint64_t)png_get_rowbytes(r->png, r->info) * height;
    int passes = png_set_interlace_handling(r->png), bits, as_is;
    uint8_t *codes;
    if (pupil_still_size_ok(width, height, r->why))
        return -1;
    png_read_update_info(r->png, r->info);
    bits = png_get_bit_depth(r->png, r->info);
    as_is = bits == 8 && r->curve == CURVE_SRGB && !r->colour.convert && !r->profile;
    if (stored / DEFLATE_RATIO > r->size)
        return pupil_still_fail(r->why, "the header promises %llu x %llu pixels, more than %zu bytes of PNG can hold",
                                (unsigned long long)width, (unsigned long long)height, r->size);
    if (pupil_still_reserve(still, width, height, as_is ? PUPIL_PIXEL_RGB8 : PUPIL_PIXEL_RGB32F, r->why) ||
        (!as_is && make_table(r, bits)))
        return -1;
    codes = still->pixels;
    if (!as_is)
        codes += width * height * (bits == 16 ? 6 : 9);
    for (int pass = 0; pass < passes; pass++)
        for (uint64_t y = 0; y < height; y++)
            png_read_row(r->png, codes + y * width * 3 * (unsigned)(bits / 8), NULL);
    png_read_end(r->png, NULL);
    if (!as_is) {
        still->code_light = code_light(r);
        decode(r, still->pixels, codes, width * height * 3, bits);
        pupil_still_colour_apply(&r->colour, still->pixels, width * height);
    }
    return r->profile &&
                   pupil_icc_apply_profile(r->profile, r->profile_bytes, still->pixels, width * height, r->why) < 0
               ? -1
               : 0;
}

/* libpng allocates the length that a chunk claims before it sees the file's end: so lengths are checked first. */
static int check_chunks(png_reader *r)
{
    for (size_t at = 8; r->size >= 12 && at <= r->size - 12;) {
        const uint8_t *chunk = r->bytes + at;
        const uint32_t length = png_get_uint_32(chunk);
        if (length > r->size - at - 12)
            break;
        if (memcmp(chunk + 4, "IEND", 4) == 0)
            return 0;
        at += 12 + (size_t)length;
    }
    return pupil_still_fail(r->why, "is damaged as a PNG file: it ends early");
}

/* No locals here, which longjmp might clobber: r belongs to the caller. */
static int read_guarded(png_reader *r, pupil_still *still)
{
    if (setjmp(r->failed))
        return -1;
    read_header(r);
    return read_pixels(r, still);
}

int pupil_read_png(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    png_reader r = {.bytes = bytes, .size = size, .why = why};
    int result = -1;
    if (check_chunks(&r))
        return -1;
    r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, on_error, on_warning);
    if (r.png)
        r.info = png_create_info_struct(r.png);
    if (r.info)
        result = read_guarded(&r, still);
    else
        pupil_still_fail(why, "no memory for reading a PNG file");
    png_destroy_read_struct(&r.png, &r.info, NULL);
    free(r.table);
    return result ? result : pupil_still_make_upright(still, bytes, size, why);
}

/* A battery of frames and settings through the public interface, one line per case: its name and a digest of every
 * output bit. Frames are computed in integers, so that any difference between two machines is the library's. Runs
 * without a C library: 150 KiB of memory, memcpy and a function that prints text.
 */
#include "digest.h"

#include "pupil/pupil.h"

#include <stddef.h>
#include <stdint.h>

enum {
    MAX_PIXELS = 64 * 48 + 2 * 48 + 1500,
    INPUT_BYTES = MAX_PIXELS * 16,
    OUTPUT_BYTES = MAX_PIXELS * 4,
    MOST_OUTPUT_BYTES = MAX_PIXELS * 16
};

static union {
    uint64_t aligned;
    unsigned char bytes[INPUT_BYTES];
} input;
static _Alignas(4) unsigned char output[MOST_OUTPUT_BYTES];
static _Alignas(2) unsigned char input_chroma[4 * MAX_PIXELS];
static unsigned char output_chroma[MAX_PIXELS], output_cr[MAX_PIXELS];

/* --- digests and numbers --- */

/* FNV-1a, 64 bits (Fowler, Noll, Vo; draft-eastlake-fnv). */
static uint64_t fnv(uint64_t digest, const void *bytes, size_t count)
{
    for (const unsigned char *b = bytes; count--; b++)
        digest = (digest ^ *b) * UINT64_C(0x100000001b3);
    return digest;
}

static uint64_t fnv_u64(uint64_t digest, uint64_t value)
{
    for (int i = 0; i < 8; i++, value >>= 8)
        digest = (digest ^ (value & 255)) * UINT64_C(0x100000001b3);
    return digest;
}

static uint64_t fnv_double(uint64_t digest, double value)
{
    uint64_t bits;
    __builtin_memcpy(&bits, &value, sizeof bits);
    return fnv_u64(digest, bits);
}

static uint64_t random_state;

/* Knuth's MMIX generator (The Art of Computer Programming 2, 3.3.4); only its upper bits are used. */
static uint32_t random_bits(unsigned count)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(random_state >> (64 - count));
}

/* Samples are in the machine's byte order, digests are of little-endian bytes: on other machines bytes are swapped. */
static void swap_on_big_endian(unsigned char *bytes, size_t count, size_t sample)
{
    if (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
        return;
    for (size_t i = 0; i + sample <= count; i += sample)
        for (size_t j = 0; j < sample / 2; j++) {
            const unsigned char b = bytes[i + j];
            bytes[i + j] = bytes[i + sample - 1 - j];
            bytes[i + sample - 1 - j] = b;
        }
}

/* --- frames --- */

/* NaN of both kinds, infinities, zeros, denormals, negatives, and the ends of the range. */
static const uint32_t odd_float[16] = {0x7fc00000, 0x7f800001, 0xffc12345, 0x7f800000, 0xff800000, 0x00000000,
                                       0x80000000, 0x00000001, 0x007fffff, 0x80000001, 0xbf800000, 0xc2c80000,
                                       0x7f7fffff, 0xff7fffff, 0x00800000, 0x4e800000};
static const uint16_t odd_half[16] = {0x7e00, 0x7c01, 0xfe12, 0x7c00, 0xfc00, 0x0000, 0x8000, 0x0001,
                                      0x03ff, 0x8001, 0xbc00, 0xd640, 0x7bff, 0xfbff, 0x0400, 0x3c00};

/* One sample; `stops`: the frame's brightness here, -12..12. One in 64 is odd if `odd` is set. */
static void put_sample(unsigned char *to, uint32_t pixel, int stops, int odd)
{
    const int is_odd = random_bits(6) == 0 && odd;
    const uint32_t pick = random_bits(4);
    uint32_t bits = random_bits(23);
    uint16_t half;
    switch (pixel) {
    case PUPIL_PIXEL_RGBA32F:
    case PUPIL_PIXEL_RGB32F:
    case PUPIL_PIXEL_BGR32F:
        bits = is_odd ? odd_float[pick] : bits | (uint32_t)(127 + stops) << 23;
        __builtin_memcpy(to, &bits, 4);
        return;
    case PUPIL_PIXEL_RGBA16F:
    case PUPIL_PIXEL_RGB16F:
        half = (uint16_t)(is_odd ? odd_half[pick] : (bits >> 13) | (uint32_t)(15 + stops) << 10);
        __builtin_memcpy(to, &half, 2);
        return;
    case PUPIL_PIXEL_RGBA16:
    case PUPIL_PIXEL_RGB16:
    case PUPIL_PIXEL_GREY16:
    case PUPIL_PIXEL_I444_16:
    case PUPIL_PIXEL_BAYER16:
        half = (uint16_t)(is_odd ? (pick & 1) * 65535 : (bits >> 7) >> (12 - stops) / 2);
        __builtin_memcpy(to, &half, 2);
        return;
    case PUPIL_PIXEL_GREY10:
    case PUPIL_PIXEL_GREY12:
    case PUPIL_PIXEL_BAYER10:
    case PUPIL_PIXEL_BAYER12:
    case PUPIL_PIXEL_BAYER14:
        half = (uint16_t)(is_odd ? (pick & 1) * 65535 : (bits >> 11) >> (12 - stops) / 3);
        __builtin_memcpy(to, &half, 2);
        return;
    case PUPIL_PIXEL_RGB10A2:
        bits = bits << 9 ^ bits;
        __builtin_memcpy(to, &bits, 4);
        return;
    case PUPIL_PIXEL_P010:
    case PUPIL_PIXEL_I420_10:
        half = (uint16_t)(is_odd ? (pick & 1) * 65535 : (bits >> 13) >> (12 - stops) / 6);
        half = (uint16_t)(pixel == PUPIL_PIXEL_P010 ? half << 6 : half);
        __builtin_memcpy(to, &half, 2);
        return;
    default:
        *to = (unsigned char)(is_odd ? (pick & 1) * 255 : (bits >> 15) >> (12 - stops) / 6);
    }
}

static size_t sample_bytes(uint32_t pixel)
{
    if (pixel == PUPIL_PIXEL_RGBA32F || pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_BGR32F ||
        pixel == PUPIL_PIXEL_RGB10A2)
        return 4;
    if (pixel == PUPIL_PIXEL_P010 || pixel == PUPIL_PIXEL_I420_10 || pixel == PUPIL_PIXEL_I444_16)
        return 2;
    if (pixel <= PUPIL_PIXEL_BGRX8)
        return pixel >= PUPIL_PIXEL_RGBA8 ? 1 : 2;
    return pixel == PUPIL_PIXEL_RGB16F || (pixel >= PUPIL_PIXEL_GREY10 && pixel <= PUPIL_PIXEL_GREY16) ||
                   (pixel >= PUPIL_PIXEL_BAYER10 && pixel <= PUPIL_PIXEL_BAYER16)
               ? 2
               : 1;
}

/* Rows top-down or bottom-up, each with room for one more sample, which is never touched. */
static ptrdiff_t lay_out(uint32_t width, uint32_t height, uint32_t pixel, int upside_down, size_t *first_byte)
{
    const ptrdiff_t stride = (ptrdiff_t)(pupil_row_bytes(pixel, width) + sample_bytes(pixel));
    *first_byte = upside_down ? (size_t)stride * (height - 1) : 0;
    return upside_down ? -stride : stride;
}

/* From any eight bits. */
static unsigned char chroma_of(unsigned flags, uint32_t bits)
{
    return (unsigned char)(flags & DIGEST_PALE ? 112 + bits % 33 : bits);
}

static int is_packed_chroma(uint32_t pixel, size_t sample)
{
    return (pixel == PUPIL_PIXEL_YUYV && sample % 2 == 1) || (pixel == PUPIL_PIXEL_UYVY && sample % 2 == 0);
}

static pupil_image_const make_frame(const digest_case *c, unsigned number)
{
    /* Light that varies over nine stops, in steps, from frame to frame. */
    static const signed char level[8] = {0, 3, -4, 4, -1, -5, 2, 1};
    pupil_image_const image = {0};
    size_t first;
    image.stride_bytes = lay_out(c->width, c->height, c->in, c->flags & DIGEST_UPSIDE_DOWN, &first);
    image.data = input.bytes + first;
    image.width = c->width;
    image.height = c->height;
    image.pixel = c->in;
    image.chroma = input_chroma;
    image.chroma_stride_bytes = (ptrdiff_t)pupil_chroma_row_bytes(c->in, c->width);
    image.cr = input_chroma + pupil_chroma_row_bytes(c->in, c->width) * pupil_chroma_rows(c->in, c->height);
    image.cr_stride_bytes = image.chroma_stride_bytes;
    image.coding = &c->coding;
    random_state = number + 1;
    for (uint32_t y = 0; y < c->height; y++) {
        unsigned char *to = input.bytes + ((ptrdiff_t)first + (ptrdiff_t)y * image.stride_bytes);
        const size_t samples = pupil_row_bytes(c->in, c->width) / sample_bytes(c->in);
        for (size_t s = 0; s < samples; s++, to += sample_bytes(c->in)) {
            put_sample(to, c->in, level[number % 8] + (int)((s / 8 ^ y / 4) % 8) - 4, !(c->flags & DIGEST_PLAIN));
            if (is_packed_chroma(c->in, s))
                *to = c->flags & DIGEST_PALE ? chroma_of(c->flags, *to) : *to;
        }
    }
    const size_t plane = pupil_chroma_row_bytes(c->in, c->width) * pupil_chroma_rows(c->in, c->height);
    for (size_t i = 0; i < (pupil_pixel_planes(c->in) > 2 ? 2 * plane : plane); i++)
        input_chroma[i] = chroma_of(c->flags, random_bits(8));
    swap_on_big_endian(input_chroma, pupil_pixel_planes(c->in) > 2 ? 2 * plane : plane, sample_bytes(c->in));
    return image;
}

static pupil_frame_info make_info(const digest_case *c, unsigned number)
{
    pupil_frame_info info = {0};
    /* 30000/1001 frames a second; every third frame is dropped, and frame 5 comes with an earlier time. */
    if (c->flags & DIGEST_STAMPED)
        info.timestamp_ns = INT64_C(33366667) * (number + number / 2) - (number == 5 ? INT64_C(200000000) : 0);
    info.sequence = number;
    if (c->flags & DIGEST_EXPOSED) {
        info.exposure_s = number % 2 ? 0x1p-7 : 0x1p-5 + 0x1p-9;
        info.gain = 1.0 + number % 4;
    }
    return info;
}

/* --- one frame, four ways --- */

/* The number of rows in a group of about `about`: whole pairs if rows come in pairs. */
static uint32_t group_of(const pupil_image_const *in, const pupil_image *out, uint32_t about)
{
    const int pairs = in->pixel >= PUPIL_PIXEL_NV12 || pupil_pixel_planes(out->pixel) > 1;
    return pairs ? about + about % 2 : about;
}

/* In groups of five rows, as they arrive; mapped in the same pass if there was a frame before. */
static int by_rows(pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info, const pupil_image *out)
{
    pupil_exposure exposure;
    const uint32_t smaller = in->height / out->height, most = group_of(in, out, 5);
    int error = pupil_frame_begin(pupil, in->width, in->height, info);
    error |= pupil_get_exposure(pupil, &exposure);
    for (uint32_t y = 0; y < in->height; y += most) {
        const uint32_t rows = in->height - y < most ? in->height - y : most;
        const pupil_image_const group = pupil_image_rows(*in, y, rows);
        const pupil_image to = pupil_image_out_rows(*out, y / smaller, rows / smaller);
        error |= pupil_frame_rows(pupil, &group, y, exposure.frames > 0 ? &to : NULL);
    }
    return error | pupil_frame_end(pupil);
}

/* Each row (or pair) by itself, from the last to the first, into its own statistics; then adapted to, then mapped. */
static int by_seam(pupil_t *pupil, const pupil_image_const *in, const pupil_frame_info *info, const pupil_image *out)
{
    static pupil_stats sum, row;
    pupil_curve curve;
    int error = 0;
    const uint32_t most = group_of(in, out, 1);
    pupil_stats_clear(&sum);
    for (uint32_t y = (in->height + most - 1) / most * most; y > 0;) {
        y -= most;
        const pupil_image_const one = pupil_image_rows(*in, y, in->height - y < most ? in->height - y : most);
        pupil_stats_clear(&row);
        error |= pupil_meter_rows(pupil, &one, y, in->height, &row);
        error |= pupil_stats_add(&sum, &row);
    }
    error |= pupil_adapt(pupil, &sum, info);
    if (pupil_get_curve(pupil, info, &curve) == PUPIL_OK)
        error |= pupil_map_rows(pupil, &curve, in, out);
    return error;
}

static int one_frame(pupil_t *pupil, const digest_case *c, const pupil_image_const *in, const pupil_frame_info *info,
                     const pupil_image *out)
{
    if (c->flags & DIGEST_ROWS)
        return by_rows(pupil, in, info, out);
    if (c->flags & DIGEST_SEAM)
        return by_seam(pupil, in, info, out);
    return pupil_process(pupil, in, info, out);
}

/* --- the outputs --- */

static uint64_t digest_stats(uint64_t digest, const pupil_stats *s)
{
    double value;
    const uint64_t words[] = {s->pixels,    s->weight, s->black,        s->clipped,      s->bad, (uint64_t)s->log2_sum,
                              s->log2_frac, s->rows,   s->frame_height, s->has_histogram};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        digest = fnv_u64(digest, words[i]);
    for (size_t i = 0; i < PUPIL_HISTOGRAM_BINS; i++)
        digest = fnv_u64(digest, s->bin[i]);
    for (size_t i = 0; i < PUPIL_BANDS; i++)
        digest = fnv_u64(fnv_u64(digest, (uint64_t)s->band_log2_sum[i]), s->band_pixels[i]);
    if (pupil_stats_mean(s, 0.0, 1.0, &value) == PUPIL_OK)
        digest = fnv_double(digest, value);
    if (pupil_stats_mean(s, 0.125, 0.9375, &value) == PUPIL_OK)
        digest = fnv_double(digest, value);
    for (int q = 0; q <= 8; q++)
        if (pupil_stats_quantile(s, q / 8.0, &value) == PUPIL_OK)
            digest = fnv_double(digest, value);
    if (s->channel_quads) {
        for (int i = 0; i < 3; i++)
            digest = fnv_u64(digest, (uint64_t)s->channel_sum[i]);
        digest = fnv_u64(digest, s->channel_quads);
    }
    return digest;
}

static uint64_t digest_state(uint64_t digest, const pupil_t *pupil, const pupil_frame_info *info)
{
    static pupil_stats stats;
    pupil_exposure e;
    pupil_curve curve;
    if (pupil_get_exposure(pupil, &e) == PUPIL_OK) {
        const double values[] = {e.metered_ev, e.adapted_ev, e.white_ev, e.scale, e.dt_s};
        for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
            digest = fnv_double(digest, values[i]);
        digest = fnv_u64(fnv_u64(fnv_u64(digest, e.frames), e.state), e.reason);
    }
    if (pupil_get_curve(pupil, info, &curve) == PUPIL_OK) {
        digest = fnv_double(fnv_double(digest, (double)curve.scale), (double)curve.inverse_white_squared);
        for (uint32_t i = 0; i < curve.knots; i++)
            digest = fnv_double(digest, (double)(curve.knot_scale * curve.knot[i]));
    }
    if (pupil_get_stats(pupil, &stats) == PUPIL_OK)
        digest = digest_stats(digest, &stats);
    return digest;
}

uint64_t digest_run(const digest_case *c)
{
    static pupil_t pupil;
    uint64_t digest = UINT64_C(0xcbf29ce484222325);
    const int error = pupil_init(&pupil, &c->config);
    digest = fnv_u64(digest, (uint64_t)(int64_t)error);
    if (error)
        return digest;
    for (unsigned number = 0; number < c->frames; number++) {
        const pupil_image_const in = make_frame(c, number);
        const pupil_frame_info info = make_info(c, number);
        pupil_image out = {0};
        size_t first;
        const uint32_t smaller = c->flags & DIGEST_HALVED ? 2 : 1;
        out.width = c->width / smaller;
        out.height = c->height / smaller;
        out.stride_bytes = lay_out(out.width, out.height, c->out, c->flags & DIGEST_UPSIDE_DOWN, &first);
        out.data = output + first;
        out.pixel = c->out;
        out.chroma = output_chroma;
        out.chroma_stride_bytes = (ptrdiff_t)(out.width + out.width % 2);
        out.cr = output_cr;
        out.cr_stride_bytes = out.chroma_stride_bytes;
        const int yuv = pupil_pixel_planes(c->out) > 1;
        const size_t bytes = pupil_pixel_bytes(c->out) > 4 ? MOST_OUTPUT_BYTES : OUTPUT_BYTES;
        out.coding = yuv ? &c->coding : NULL;
        for (size_t i = 0; i < bytes; i++)
            output[i] = 0xa5;
        digest = fnv_u64(digest, (uint64_t)(int64_t)one_frame(&pupil, c, &in, &info, &out));
        swap_on_big_endian(output, bytes, sample_bytes(c->out));
        digest = fnv(digest, output, bytes);
        if (yuv)
            digest = fnv(digest, output_chroma, out.width * (size_t)(out.height + 1) / 2);
        if (c->out == PUPIL_PIXEL_I420)
            digest = fnv(digest, output_cr, out.width * (size_t)(out.height + 1) / 2);
        digest = digest_state(digest, &pupil, &info);
    }
    return digest;
}

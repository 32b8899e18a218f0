/* lib/kernels/neon_raw10.h: metering MIPI RAW10, the packed mosaic that board cameras send, straight from its bytes.
 * The operations on light are those of pixels_to_linear.h (binned) and of vector.h, one by one. Pixels that are
 * clipped, black or left over use those functions. */
#include "neon.h"
#include "pixels_to_linear.h"
#include "vector_formats.h"

/* 8 quads are 16 samples, 20 bytes, of each row. First the samples of the columns of red, then the others: the byte
 * with their upper bits, the byte with their lower bits, and its shift to the left that makes these bits 2 and 3. */
typedef struct raw10_order {
    uint8x16_t upper, lower;
    int8x16_t shift;
} raw10_order;

INLINE raw10_order raw10_order_of(int red_x)
{
    static const uint8_t upper[2][8] = {{0, 2, 5, 7, 10, 12, 15, 17}, {1, 3, 6, 8, 11, 13, 16, 18}};
    static const uint8_t lower[8] = {4, 4, 9, 9, 14, 14, 19, 19};
    static const int8_t shift[2][8] = {{2, -2, 2, -2, 2, -2, 2, -2}, {0, -4, 0, -4, 0, -4, 0, -4}};
    return (raw10_order){vcombine_u8(vld1_u8(upper[red_x]), vld1_u8(upper[!red_x])),
                         vcombine_u8(vld1_u8(lower), vld1_u8(lower)),
                         vcombine_s8(vld1_s8(shift[red_x]), vld1_s8(shift[!red_x]))};
}

/* Four times 8 samples each: of the columns of red, and of the others. */
typedef struct raw10_row {
    uint16x8_t red_column, other_column;
} raw10_row;

#define RAW10_BEYOND 12 /* bytes that are read behind 16 samples */

INLINE raw10_row raw10_load(const uint8_t *source, const raw10_order *o)
{
    const uint8x16x2_t bytes = vld1q_u8_x2(source);
    const uint8x16_t upper = vqtbl2q_u8(bytes, o->upper);
    const uint8x16_t lower = vandq_u8(vshlq_u8(vqtbl2q_u8(bytes, o->lower), o->shift), vdupq_n_u8(12));
    return (raw10_row){vaddw_u8(vshll_n_u8(vget_low_u8(upper), 4), vget_low_u8(lower)),
                       vaddw_high_u8(vshll_high_n_u8(upper, 4), lower)};
}

/* Four of eight sums, above black: the upper half of 2^23, and then the 16 bits, are the float 2^23 + sum. */
INLINE floats raw10_above(uint16x8_t sum4, int second, floats zero)
{
    const uint16x8_t magic = vdupq_n_u16(0x4b00);
    const uint16x8_t bits = second ? vzip2q_u16(sum4, magic) : vzip1q_u16(sum4, magic);
    return v_sub(vreinterpretq_f32_u16(bits), zero);
}

/* a * b[LANE]. With an intrinsic a compiler keeps six factors in six registers, which the products then lack. */
#define TIMES_LANE(TO, A, B, LANE) __asm__("fmul %0.4s, %1.4s, %2.s[" #LANE "]" : "=w"(TO) : "w"(A), "w"(B))

/* Of four quads; unit and weight: of R, G, B. */
INLINE floats raw10_luminance(floats r, floats g, floats b, floats unit, floats weight)
{
    TIMES_LANE(r, r, unit, 0);
    TIMES_LANE(g, g, unit, 1);
    TIMES_LANE(b, b, unit, 2);
    TIMES_LANE(r, r, weight, 0);
    TIMES_LANE(g, g, weight, 1);
    TIMES_LANE(b, b, weight, 2);
    return v_add(v_add(r, g), b);
}

/* The extremes of the quads so far, which are checked after several groups. */
typedef struct raw10_sums {
    uint16x8_t top, top_g;
    floats least;
} raw10_sums;

INLINE void raw10_sum(const uint8_t *red_row, const uint8_t *blue_row, const raw10_order *order, floats zero,
                      floats unit, floats weight, raw10_sums *sums, floats product[2])
{
    const raw10_row upper = raw10_load(red_row, order), lower = raw10_load(blue_row, order);
    const uint16x8_t r = upper.red_column, b = lower.other_column;
    const uint16x8_t g = vhaddq_u16(upper.other_column, lower.red_column); /* of multiples of 4 */
    sums->top = vmaxq_u16(sums->top, vmaxq_u16(r, b));
    sums->top_g = vmaxq_u16(sums->top_g, g);
    FOR_TWO(q)
    {
        const floats l =
            raw10_luminance(raw10_above(r, q, zero), raw10_above(g, q, zero), raw10_above(b, q, zero), unit, weight);
        sums->least = v_min(sums->least, l);
        product[q] = v_mul(product[q], l);
    }
}

/* By the usual pieces. */
static __attribute__((noinline)) void meter_raw10_hard(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                       uint32_t n, pupil_run *run)
{
    uint16_t upper[64], lower[64];
    pupil_planes planes;
    for (uint32_t end = x + n; x < end; x += n) {
        n = end - x < 32 ? end - x : 32; /* whole lanes */
        unpack_bayer10p(row->data, 0, 2 * x, 2 * n, upper);
        unpack_bayer10p(row->below, 0, 2 * x, 2 * n, lower);
        binned(job->coder, upper, lower, n, &planes);
        meter_planes(job, 0, &planes, n, run);
    }
}

/* Eight factors from 2^-15 to 2^14 stay inside a float's range: exponents are moved half as often as elsewhere, which
 * changes no bit. */
enum { RAW10_FACTORS = 8 };

/* Returns 0, and does nothing, if the row does not suit. */
static int meter_bayer10p(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, pupil_run *run)
{
    const pupil_coder *coder = job->coder;
    const float *unit = coder->unit4;
    const int32_t *ordinary = coder->ordinary4, limit = ordinary[0] < ordinary[2] ? ordinary[0] : ordinary[2];
    if (x % 2 || limit < 0 || ordinary[1] < 0 || !coder->close_to_1) /* x: whole groups of 4 samples */
        return 0;

    const raw10_order order = raw10_order_of((int)coder->red_x);
    const uint8_t *red_row = (coder->red_y ? row->below : row->data) + (size_t)(x / 2) * 5;
    const uint8_t *blue_row = (coder->red_y ? row->data : row->below) + (size_t)(x / 2) * 5;
    const floats zero = v_all(0x1p23f + coder->zero4);
    const floats units = {unit[0], unit[1], unit[2], 0.0f};
    const floats weights = {job->luma[0], job->luma[1], job->luma[2], 0.0f};
    uint8_t last[2][RAW10_FACTORS * 40 + RAW10_BEYOND]; /* of the run, and what may be read behind it */
    lanes s = lanes_of(run);
    uint32_t i = 0, groups;
    for (; (groups = (n - i) / PUPIL_LANES) != 0; i += groups * PUPIL_LANES) {
        raw10_sums sums = {vdupq_n_u16(0), vdupq_n_u16(0), v_all(PUPIL_CEILING)};
        if (groups > RAW10_FACTORS) {
            groups = RAW10_FACTORS;
        } else {
            __builtin_memcpy(last[0], red_row, groups * 40);
            __builtin_memcpy(last[1], blue_row, groups * 40);
            red_row = last[0];
            blue_row = last[1];
        }
        for (const uint8_t *end = red_row + groups * 40; red_row != end; red_row += 40, blue_row += 40) {
            raw10_sum(red_row, blue_row, &order, zero, units, weights, &sums, s.product);
            raw10_sum(red_row + 20, blue_row + 20, &order, zero, units, weights, &sums, s.product + 2);
        }
        const uint16x8_t fits =
            vandq_u16(vcleq_u16(sums.top, vdupq_n_u16((uint16_t)(limit < 4092 ? limit : 4092))),
                      vcleq_u16(sums.top_g, vdupq_n_u16((uint16_t)(ordinary[1] < 4092 ? ordinary[1] : 4092))));
        if (__builtin_expect(v_every(v_both(vreinterpretq_u32_u16(fits), v_greater(sums.least, v_all(job->floor)))),
                             1)) {
            move_exponents(&s, run);
        } else {
            meter_raw10_hard(job, row, x + i, groups * PUPIL_LANES, run);
            s = lanes_of(run);
        }
    }
    if (i < n)
        meter_raw10_hard(job, row, x + i, n - i, run);
    return 1;
}

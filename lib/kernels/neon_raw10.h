/* lib/kernels/neon_raw10.h: metering the packed mosaic that cameras of boards send, MIPI RAW10, straight from its
 * bytes: 16 quads are 40 bytes of each of two rows. The operations on light are those of loads.h (binned) and of
 * vector.h, one by one; whatever is clipped, black, odd or left over goes that way.
 */
#include "loads.h"
#include "neon.h"
#include "vector.h"

/* 8 quads are 16 samples, 20 bytes, of each row. First the samples of the columns of red, then the others: where their
 * upper bits are, where the byte with their lower bits is, and how far it goes left so that these become bits 2 and 3.
 * Bytes are counted in two vectors, from 0 and from 4 on. */
typedef struct raw10_constants {
    uint8x16_t upper, lower;
    int8x16_t shift;
} raw10_constants;

INLINE raw10_constants raw10_constants_of(int red_x)
{
    static const uint8_t upper[2][8] = {{0, 2, 5, 7, 10, 12, 15, 29}, {1, 3, 6, 8, 11, 13, 28, 30}};
    static const uint8_t lower[8] = {4, 4, 9, 9, 14, 14, 31, 31};
    static const int8_t shift[2][8] = {{2, -2, 2, -2, 2, -2, 2, -2}, {0, -4, 0, -4, 0, -4, 0, -4}};
    return (raw10_constants){vcombine_u8(vld1_u8(upper[red_x]), vld1_u8(upper[!red_x])),
                             vcombine_u8(vld1_u8(lower), vld1_u8(lower)),
                             vcombine_s8(vld1_s8(shift[red_x]), vld1_s8(shift[!red_x]))};
}

/* Four times 8 samples each: of the columns of red, and of the others. */
typedef struct raw10_row {
    uint16x8_t red_column, other_column;
} raw10_row;

INLINE raw10_row raw10_load(const uint8_t *source, const raw10_constants *c)
{
    const uint8x16x2_t bytes = {{vld1q_u8(source), vld1q_u8(source + 4)}};
    const uint8x16_t upper = vqtbl2q_u8(bytes, c->upper);
    const uint8x16_t lower = vandq_u8(vshlq_u8(vqtbl2q_u8(bytes, c->lower), c->shift), vdupq_n_u8(12));
    return (raw10_row){vaddw_u8(vshll_n_u8(vget_low_u8(upper), 4), vget_low_u8(lower)),
                       vaddw_high_u8(vshll_high_n_u8(upper, 4), lower)};
}

/* Four of eight: 16 bits behind the upper half of 2^23 are the float of their sum. */
INLINE floats raw10_light(uint16x8_t sum4, int second, floats zero, floats unit)
{
    const uint16x8_t magic = vdupq_n_u16(0x4b00);
    const uint16x8_t bits = second ? vzip2q_u16(sum4, magic) : vzip1q_u16(sum4, magic);
    return v_mul(v_sub(vreinterpretq_f32_u16(bits), zero), unit);
}

/* Up to 64 quads, in the usual pieces. */
static __attribute__((noinline)) void meter_raw10_hard(const pupil_row_job *job, const pupil_row *row, uint32_t x,
                                                       uint32_t n, pupil_run *run)
{
    uint16_t upper[128], lower[128];
    pupil_planes planes;
    unpack_bayer10p(row->data, 0, 2 * x, 2 * n, upper);
    unpack_bayer10p(row->below, 0, 2 * x, 2 * n, lower);
    binned(job->coder, upper, lower, n, &planes);
    meter_planes(job, 0, &planes, n, run);
}

/* The largest of four times a sample that is surely below the clip value and not cut at the channels' common limit;
 * negative: none. */
INLINE int32_t raw10_limit(const pupil_row_job *job, float unit)
{
    const float most = job->clip < job->coder->most ? job->clip : job->coder->most;
    const float limit = most / unit + job->coder->zero4;
    return limit < 65535.0f ? (int32_t)limit - 4 : 65535;
}

/* 0: not done, for it is not such a row. */
static int meter_bayer10p(const pupil_row_job *job, const pupil_row *row, uint32_t x, uint32_t n, pupil_run *run)
{
    const pupil_coder *coder = job->coder;
    const float *unit = coder->unit4;
    const int32_t limit[3] = {raw10_limit(job, unit[0]), raw10_limit(job, unit[1]), raw10_limit(job, unit[2])};
    /* whole groups of 4 samples; and a zero that 2^23 does not round */
    if (x % 2 || coder->zero4 > 0x1p22f || coder->zero4 != (float)(int32_t)coder->zero4 || limit[0] < 0 ||
        limit[1] < 0 || limit[2] < 0)
        return 0;

    const raw10_constants k = raw10_constants_of((int)coder->red_x);
    const uint8_t *red_row = (coder->red_y ? row->below : row->data) + (size_t)(x / 2) * 5;
    const uint8_t *blue_row = (coder->red_y ? row->data : row->below) + (size_t)(x / 2) * 5;
    const floats zero = v_all(0x1p23f + coder->zero4);
    const floats unit_r = v_all(unit[0]), unit_g = v_all(unit[1]), unit_b = v_all(unit[2]);
    const uint16x8_t most_r = vdupq_n_u16((uint16_t)limit[0]), most_g = vdupq_n_u16((uint16_t)limit[1]),
                     most_b = vdupq_n_u16((uint16_t)limit[2]);
    const meter_constants c = meter_constants_of(job);
    lanes s = lanes_of(run);
    size_t i = 0;
    for (; i + 4 * PUPIL_LANES <= n; i += 4 * PUPIL_LANES) {
        uint16x8_t top_r = vdupq_n_u16(0), top_g = top_r, top_b = top_r;
        floats least = c.ceiling;
        for (int j = 0; j < 4; j++)
            FOR_TWO(h)
            {
                const raw10_row upper = raw10_load(red_row, &k), lower = raw10_load(blue_row, &k);
                const uint16x8_t r = upper.red_column, b = lower.other_column;
                const uint16x8_t g = vhaddq_u16(upper.other_column, lower.red_column); /* of multiples of 4 */
                red_row += 20;
                blue_row += 20;
                top_r = vmaxq_u16(top_r, r);
                top_g = vmaxq_u16(top_g, g);
                top_b = vmaxq_u16(top_b, b);
                FOR_TWO(q)
                {
                    const floats l = luminance(raw10_light(r, q, zero, unit_r), raw10_light(g, q, zero, unit_g),
                                               raw10_light(b, q, zero, unit_b), &c);
                    least = v_min(least, l);
                    s.product[2 * h + q] = v_mul(s.product[2 * h + q], l);
                }
            }
        const uint16x8_t fits =
            vandq_u16(vandq_u16(vcleq_u16(top_r, most_r), vcleq_u16(top_g, most_g)), vcleq_u16(top_b, most_b));
        if (__builtin_expect(v_every(v_both(vreinterpretq_u32_u16(fits), v_greater(least, c.floor))), 1)) {
            move_exponents(&s, run);
        } else {
            meter_raw10_hard(job, row, x + (uint32_t)i, 4 * PUPIL_LANES, run);
            s = lanes_of(run);
        }
    }
    if (i < n)
        meter_raw10_hard(job, row, x + (uint32_t)i, n - (uint32_t)i, run);
    return 1;
}

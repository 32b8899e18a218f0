/* lib/kernels/neon.h: vectors of 4 floats (AArch64), for vector.h. */
#ifndef PUPIL_KERNELS_NEON_H
#define PUPIL_KERNELS_NEON_H

#include <arm_neon.h>
#include <stdint.h>

#define WIDTH 4
typedef float32x4_t floats;
typedef uint32x4_t ints;
typedef uint32x4_t mask;

#define INLINE static inline __attribute__((always_inline))

INLINE floats v_load(const float *p)
{
    return vld1q_f32(p);
}
INLINE void v_store(float *p, floats v)
{
    vst1q_f32(p, v);
}
INLINE void v_store_ints(int32_t *p, ints v)
{
    vst1q_s32(p, vreinterpretq_s32_u32(v));
}
INLINE ints v_load_ints(const int32_t *p)
{
    return vreinterpretq_u32_s32(vld1q_s32(p));
}
INLINE floats v_all(float x)
{
    return vdupq_n_f32(x);
}
INLINE ints v_all_ints(uint32_t x)
{
    return vdupq_n_u32(x);
}

INLINE floats v_add(floats a, floats b)
{
    return vaddq_f32(a, b);
}
INLINE floats v_sub(floats a, floats b)
{
    return vsubq_f32(a, b);
}
INLINE floats v_mul(floats a, floats b)
{
    return vmulq_f32(a, b);
}
INLINE floats v_div(floats a, floats b)
{
    return vdivq_f32(a, b);
}
/* a > b ? a : b and a < b ? a : b where b is a number; a zero may come out with either sign */
INLINE floats v_max(floats a, floats b)
{
    return vmaxnmq_f32(a, b);
}
INLINE floats v_min(floats a, floats b)
{
    return vminnmq_f32(a, b);
}

INLINE mask v_greater(floats a, floats b)
{
    return vcgtq_f32(a, b);
}
INLINE mask v_less(floats a, floats b)
{
    return vcltq_f32(a, b);
}
INLINE mask v_at_least(floats a, floats b)
{
    return vcgeq_f32(a, b);
}
INLINE mask v_is_number(floats a)
{
    return vceqq_f32(a, a);
}
INLINE mask v_both(mask a, mask b)
{
    return vandq_u32(a, b);
}
INLINE mask v_not(mask a)
{
    return vmvnq_u32(a);
}
INLINE floats v_select(mask m, floats yes, floats no)
{
    return vbslq_f32(m, yes, no);
}
INLINE floats v_where(mask m, floats a)
{
    return vreinterpretq_f32_u32(vandq_u32(m, vreinterpretq_u32_f32(a)));
}
/* its fraction, as a number in [1, 2) */
INLINE floats v_fraction(floats a)
{
    return vbslq_f32(vdupq_n_u32(0x007fffff), a, vdupq_n_f32(1.0f));
}
INLINE int v_every(mask m)
{
    return vminvq_u32(m) == ~0u;
}

/* how many are true, over several masks */
typedef uint32x4_t tally;
INLINE tally v_no_tally(void)
{
    return vdupq_n_u32(0);
}
INLINE tally v_tally(tally t, mask m)
{
    return vsubq_u32(t, m);
}
INLINE uint32_t v_tallied(tally t)
{
    return vaddvq_u32(t);
}
/* of four masks, 16 bits for each */
INLINE uint64_t v_group_bits(const mask *m)
{
    const uint32x4_t some = vpmaxq_u32(vpmaxq_u32(m[0], m[1]), vpmaxq_u32(m[2], m[3]));
    return vget_lane_u64(vreinterpret_u64_u16(vmovn_u32(some)), 0);
}

INLINE ints v_bits(floats a)
{
    return vreinterpretq_u32_f32(a);
}
INLINE floats v_of_bits(ints a)
{
    return vreinterpretq_f32_u32(a);
}
INLINE ints v_plus(ints a, ints b)
{
    return vaddq_u32(a, b);
}
INLINE ints v_minus(ints a, ints b)
{
    return vsubq_u32(a, b);
}
INLINE ints v_max_unsigned(ints a, ints b)
{
    return vmaxq_u32(a, b);
}
INLINE mask v_at_most(ints a, ints b)
{
    return vcleq_u32(a, b);
}
INLINE ints v_and(ints a, ints b)
{
    return vandq_u32(a, b);
}
INLINE ints v_or(ints a, ints b)
{
    return vorrq_u32(a, b);
}
#define v_right(a, n) vshrq_n_u32(a, n)
#define v_left(a, n)  vshlq_n_u32(a, n)
/* of numbers from 0 on */
INLINE ints v_to_ints(floats a)
{
    return vcvtq_u32_f32(a);
}
INLINE floats v_from_ints(ints a)
{
    return vcvtq_f32_u32(a);
}
/* 16 bytes as numbers, and 8 pairs of bytes as two numbers less 128, each twice */
INLINE void v_of_bytes(const uint8_t *p, floats to[4])
{
    const uint8x16_t bytes = vld1q_u8(p);
    const uint16x8_t low = vmovl_u8(vget_low_u8(bytes)), high = vmovl_high_u8(bytes);
    to[0] = vcvtq_f32_u32(vmovl_u16(vget_low_u16(low)));
    to[1] = vcvtq_f32_u32(vmovl_high_u16(low));
    to[2] = vcvtq_f32_u32(vmovl_u16(vget_low_u16(high)));
    to[3] = vcvtq_f32_u32(vmovl_high_u16(high));
}

INLINE void v_of_signed(int8x16_t bytes, floats to[4])
{
    const int16x8_t low = vmovl_s8(vget_low_s8(bytes)), high = vmovl_high_s8(bytes);
    to[0] = vcvtq_f32_s32(vmovl_s16(vget_low_s16(low)));
    to[1] = vcvtq_f32_s32(vmovl_high_s16(low));
    to[2] = vcvtq_f32_s32(vmovl_s16(vget_low_s16(high)));
    to[3] = vcvtq_f32_s32(vmovl_high_s16(high));
}

INLINE void v_of_chroma(const uint8_t *p, floats u[4], floats v[4])
{
    const int8x16_t pairs = vreinterpretq_s8_u8(veorq_u8(vld1q_u8(p), vdupq_n_u8(128)));
    v_of_signed(vtrn1q_s8(pairs, pairs), u);
    v_of_signed(vtrn2q_s8(pairs, pairs), v);
}

/* light[i][0] + rest * light[i][1] */
INLINE floats v_interpolate(const float (*light)[2], ints i, floats rest)
{
    const float32x4_t low = vcombine_f32(vld1_f32(light[vgetq_lane_u32(i, 0)]), vld1_f32(light[vgetq_lane_u32(i, 1)]));
    const float32x4_t high = vcombine_f32(vld1_f32(light[vgetq_lane_u32(i, 2)]), vld1_f32(light[vgetq_lane_u32(i, 3)]));
    return vaddq_f32(vuzp1q_f32(low, high), vmulq_f32(rest, vuzp2q_f32(low, high)));
}
/* from knot[i] to knot[i + 1], by a part of the way */
INLINE floats v_between(const float *knot, ints i, floats part)
{
    const float32x4_t low = vcombine_f32(vld1_f32(knot + vgetq_lane_u32(i, 0)), vld1_f32(knot + vgetq_lane_u32(i, 1)));
    const float32x4_t high = vcombine_f32(vld1_f32(knot + vgetq_lane_u32(i, 2)), vld1_f32(knot + vgetq_lane_u32(i, 3)));
    const floats from = vuzp1q_f32(low, high), to = vuzp2q_f32(low, high);
    return vaddq_f32(from, vmulq_f32(part, vsubq_f32(to, from)));
}
INLINE mask v_equal_ints(ints a, ints b)
{
    return vceqq_u32(a, b);
}

/* --- load WIDTH pixels; *a is alpha, or whether it is opaque --- */

INLINE void load4_rgba32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float32x4x4_t p = vld4q_f32(source);
    *r = p.val[0];
    *g = p.val[1];
    *b = p.val[2];
    *a = p.val[3];
}

INLINE void load4_rgb32f(const void *source, floats *r, floats *g, floats *b, floats *a)
{
    const float32x4x3_t p = vld3q_f32(source);
    *r = p.val[0];
    *g = p.val[1];
    *b = p.val[2];
    *a = v_all(1.0f);
}

/* Eight 16-bit samples to two vectors. */
INLINE void halves_to(uint16x8_t v, floats to[2])
{
    to[0] = vcvt_f32_f16(vreinterpret_f16_u16(vget_low_u16(v)));
    to[1] = vcvt_high_f32_f16(vreinterpretq_f16_u16(v));
}

INLINE void sixteens_to(uint16x8_t v, floats to[2])
{
    const floats unit = v_all(1.0f / 65535.0f);
    to[0] = vmulq_f32(vcvtq_f32_u32(vmovl_u16(vget_low_u16(v))), unit);
    to[1] = vmulq_f32(vcvtq_f32_u32(vmovl_high_u16(v)), unit);
}

/* Eight pixels of 16-bit samples, those at `eighth` * 8. */
typedef struct words {
    uint16x8_t r, g, b, a;
} words;

INLINE words load8_four(const uint8_t *source, int eighth)
{
    const uint16x8x4_t p = vld4q_u16((const uint16_t *)(const void *)source + 32 * eighth);
    return (words){p.val[0], p.val[1], p.val[2], p.val[3]};
}

INLINE words load8_three(const uint8_t *source, int eighth)
{
    const uint16x8x3_t p = vld3q_u16((const uint16_t *)(const void *)source + 24 * eighth);
    return (words){p.val[0], p.val[1], p.val[2], vdupq_n_u16(0xffff)};
}

INLINE ints larger_words(ints top, const words *w)
{
    const uint16x8_t rg = vmaxq_u16(w->r, w->g), bt = vmaxq_u16(w->b, vreinterpretq_u16_u32(top));
    return vreinterpretq_u32_u16(vmaxq_u16(rg, bt));
}

/* Alphas from 1.0 to infinity. */
INLINE mask opaque_halves(uint16x8_t a)
{
    return vreinterpretq_u32_u16(vcleq_u16(vsubq_u16(a, vdupq_n_u16(0x3c00)), vdupq_n_u16(0x7c00 - 0x3c00)));
}

INLINE mask all_ones(uint16x8_t a)
{
    return vreinterpretq_u32_u16(a);
}

#endif

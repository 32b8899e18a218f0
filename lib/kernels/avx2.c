/* The AVX2 level. Compiled for AVX2 regardless of the build's flags: level.c keeps other CPUs away. */
#if defined(__x86_64__)

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,f16c,popcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,fma,f16c,popcnt")
#endif

#include "avx2.h"
#include "vector_formats.h"
#include "vector_store.h"

/* Halves and 16-bit samples of four channels are deinterleaved faster 16 pixels at a time. */
INLINE void group_rgba16f(const uint8_t *source, group *p)
{
    load16_rgba16f(source, p->r, p->g, p->b, &p->opaque);
    p->top = top_of(p->r, p->g, p->b);
}

INLINE void group_rgba16(const uint8_t *source, group *p)
{
    load16_rgba16(source, p->r, p->g, p->b, &p->opaque);
    p->top = top_of(p->r, p->g, p->b);
}

static const format rgba32f = {.bytes = 16, .vector = load8_rgba32f};
static const format rgb32f = {.bytes = 12, .vector = load8_rgb32f};
static const format rgba16f = {.bytes = 8, .group = group_rgba16f};
static const format rgba16 = {.bytes = 8, .group = group_rgba16};
static const format rgb16 = {.bytes = 6, .vector = load8_rgb16};
static const format rgb16f = {.bytes = 6, .vector = load8_rgb16f};

#include "avx2_luma.h"
#include "x86_yuv.h"

#include "vector_table.h"

#if defined(__clang__)
#pragma clang attribute pop
#endif

const pupil_kernels pupil_kernels_avx2 = {VECTOR_PIECES};

#else
typedef int pupil_no_avx2; /* a C file must not be empty */
#endif

/* The AVX-512 level. Compiled for AVX-512 regardless of the build's flags: level.c keeps other CPUs away. */
#if defined(__x86_64__)

#if defined(PUPIL_EMULATE) /* a test without such a CPU has functions for the instructions */
#elif defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,popcnt"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl,popcnt")
#endif

#include "avx512.h"
#include "vector_formats.h"
#include "vector_store.h"

static const format rgba32f = {.bytes = 16, .vector = load16_rgba32f};
static const format rgb32f = {.bytes = 12, .vector = load16_rgb32f};
static const format rgba16f = {.bytes = 8, .vector = load16_rgba16f};
static const format rgba16 = {.bytes = 8, .vector = load16_rgba16};
static const format rgb16 = {.bytes = 6, .vector = load16_rgb16};
static const format rgb16f = {.bytes = 6, .vector = load16_rgb16f};

#include "avx512_luma.h"
#include "x86_yuv.h"

#include "vector_table.h"

#if defined(__clang__) && !defined(PUPIL_EMULATE)
#pragma clang attribute pop
#endif

const pupil_kernels pupil_kernels_avx512 = {VECTOR_PIECES};

#else
typedef int pupil_no_avx512; /* a C file must not be empty */
#endif

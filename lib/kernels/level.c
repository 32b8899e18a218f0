/* Which level this CPU can run. Asked once, at init: the instruction that reports it takes microseconds in a VM. */
#include "kernels.h"

/* The levels that may be chosen besides scalar: a mask of 1 << pupil_level (CMake's PUPIL_LEVELS). */
#ifndef PUPIL_LEVELS
#define PUPIL_LEVELS ~0u
#endif

/* For a test in which functions replace a level's instructions, on any CPU: a mask of 1 << pupil_level. */
#ifndef PUPIL_EMULATE
#define PUPIL_EMULATE 0u
#endif

#if defined(__x86_64__)
#include <cpuid.h>

/* The registers that the operating system saves (Intel SDM 13.3): SSE and AVX, or these and the AVX-512 ones. */
#define SAVES_AVX    0x06u
#define SAVES_AVX512 0xe6u

static uint32_t saved_registers(void)
{
    uint32_t low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}

/* A mask of 1 << pupil_level. */
static uint32_t levels_here(void)
{
    uint32_t a, b, c, d, levels = 1u << PUPIL_LEVEL_SCALAR;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE) || !(c & bit_F16C) || !(c & bit_FMA))
        return levels;
    const uint32_t saved = saved_registers();
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d))
        return levels;
    const uint32_t avx512 = bit_AVX512F | bit_AVX512BW | bit_AVX512VL | bit_AVX512DQ;
    if ((saved & SAVES_AVX) == SAVES_AVX && (b & bit_AVX2))
        levels |= 1u << PUPIL_LEVEL_AVX2;
    if ((saved & SAVES_AVX512) == SAVES_AVX512 && (b & bit_AVX2) && (b & avx512) == avx512)
        levels |= 1u << PUPIL_LEVEL_AVX512;
    return levels;
}

#elif defined(__aarch64__)

static uint32_t levels_here(void)
{
    return 1u << PUPIL_LEVEL_SCALAR | 1u << PUPIL_LEVEL_NEON;
}

#elif defined(PUPIL_WASM128)

static uint32_t levels_here(void)
{
    return 1u << PUPIL_LEVEL_SCALAR | 1u << PUPIL_LEVEL_WASM128;
}

#else

static uint32_t levels_here(void)
{
    return 1u << PUPIL_LEVEL_SCALAR;
}

#endif

const pupil_kernels *pupil_level_kernels(uint32_t level)
{
    switch (level) {
    case PUPIL_LEVEL_SCALAR:
        return &pupil_kernels_scalar;
#if defined(__x86_64__)
    case PUPIL_LEVEL_AVX2:
        return &pupil_kernels_avx2;
    case PUPIL_LEVEL_AVX512:
        return &pupil_kernels_avx512;
#elif defined(__aarch64__)
    case PUPIL_LEVEL_NEON:
        return &pupil_kernels_neon;
#endif
#if defined(PUPIL_WASM128)
    case PUPIL_LEVEL_WASM128:
        return &pupil_kernels_wasm128;
#endif
    default:
        return 0;
    }
}

uint32_t pupil_level_choose(uint32_t mask)
{
    const uint32_t levels = (levels_here() | PUPIL_EMULATE) & PUPIL_LEVELS & (mask ? mask : ~0u);
    uint32_t best = PUPIL_LEVEL_SCALAR;
    for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++)
        if (levels & 1u << level)
            best = level;
    return best;
}

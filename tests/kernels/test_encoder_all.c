/* Every float from 0 to a little above 1 through the store of every level: the exact code, by the cells whose
 * boundaries test_encoder checks. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "check.h"
#include "kernels/kernels.h"

static const char *const level_name[PUPIL_LEVEL_COUNT] = {"scalar", "NEON", "AVX2", "AVX-512", "wasm128"};

static float of_bits(uint32_t bits)
{
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* The three channels have the same consecutive floats, shifted by 85 each, so that each float is in each channel. */
static void fill(pupil_planes *p, uint32_t bits)
{
    for (uint32_t i = 0; i < PUPIL_BLOCK; i++) {
        p->r[i] = of_bits(bits + i);
        p->g[i] = of_bits(bits + (i + 85) % PUPIL_BLOCK);
        p->b[i] = of_bits(bits + (i + 170) % PUPIL_BLOCK);
    }
}

static void compare(const pupil_kernels *k, uint32_t level, uint32_t from, uint32_t end, uint32_t step)
{
    static const uint32_t outputs[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_RGB8, PUPIL_PIXEL_BGRX8};
    static uint8_t expected[PUPIL_BLOCK * 4], got[PUPIL_BLOCK * 4];
    pupil_planes p;
    unsigned long wrong = 0;
    for (uint32_t transfer = 0; transfer < PUPIL_TRANSFER_COUNT; transfer++) {
        const pupil_encoder *e = &pupil_encoders[transfer];
        uint32_t n = 0;
        for (uint32_t bits = from; bits < end; bits += step, n++) {
            const uint32_t out = outputs[n % 3];
            fill(&p, bits);
            pupil_kernels_scalar.store[out](&p, PUPIL_BLOCK, e, expected);
            k->store[out](&p, PUPIL_BLOCK, e, got);
            wrong += memcmp(got, expected, PUPIL_BLOCK * pupil_pixel_bytes(out)) != 0;
        }
    }
    CHECK_MSG(wrong == 0, "%s: %lu blocks of floats have other codes", level_name[level], wrong);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t level = 1; level < PUPIL_LEVEL_COUNT; level++) {
        if (pupil_level_choose(1u << level) != level)
            continue;
        const pupil_kernels *k = pupil_level_kernels(level);
        compare(k, level, 0, 0x34000000, 0x10000 - 0x100);          /* 0 and all that is far below the first code */
        compare(k, level, 0x34000000, 0x3f800000, PUPIL_BLOCK);     /* 2^-23 to 1: every one */
        compare(k, level, 0x3f800000, 0x3f800000 + 8, PUPIL_BLOCK); /* 1 and what rounding leaves above it */
        printf("%s: every float from 2^-23 to 1 has its exact code, in each transfer\n", level_name[level]);
    }
    return check_end();
}

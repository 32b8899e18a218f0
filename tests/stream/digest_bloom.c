/* Bloom: a picture with lobes of several octaves, with and without a threshold. */
#include "digest.h"

#include "pupil/bloom.h"

enum { BLOOM_WIDTH = 131, BLOOM_HEIGHT = 37, BLOOM_WORDS = 32000 };

uint64_t digest_bloom(void)
{
    static uint64_t memory[BLOOM_WORDS];
    static pupil_bloom_scratch scratch;
    static pupil_t pupil;
    static float frame[BLOOM_HEIGHT][BLOOM_WIDTH][3];
    static unsigned char picture[BLOOM_HEIGHT][BLOOM_WIDTH][3];
    static const pupil_veil_gaussian lobe[] = {{11.0, 0.1}, {5.0, 0.1}, {2.5, 0.1}, {1.1, 0.1}, {0.6, 0.1}, {0.3, 0.1}};
    const pupil_image_const in = {.data = frame,
                                  .stride_bytes = sizeof frame[0],
                                  .width = BLOOM_WIDTH,
                                  .height = BLOOM_HEIGHT,
                                  .pixel = PUPIL_PIXEL_RGB32F};
    const pupil_image out = {.data = picture,
                             .stride_bytes = sizeof picture[0],
                             .width = BLOOM_WIDTH,
                             .height = BLOOM_HEIGHT,
                             .pixel = PUPIL_PIXEL_RGB8};
    const pupil_curve curve = {.scale = 0.5f, .inverse_white_squared = 0.0625f, .dither = 1};
    pupil_bloom *const bloom = (pupil_bloom *)(void *)memory;
    const unsigned char *bytes = &picture[0][0][0];
    uint64_t digest = UINT64_C(0xcbf29ce484222325); /* FNV-1a, as digest.c has it */
    pupil_config config;
    pupil_bloom_config c;
    uint32_t random = 1;
    int error;
    pupil_config_default(&config);
    error = pupil_init(&pupil, &config);
    pupil_bloom_config_default(&c);
    c.width = BLOOM_WIDTH;
    c.height = BLOOM_HEIGHT;
    for (c.lobes = 0; c.lobes < sizeof lobe / sizeof lobe[0]; c.lobes++)
        c.lobe[c.lobes] = lobe[c.lobes];
    for (int y = 0; y < BLOOM_HEIGHT; y++)
        for (int x = 0; x < BLOOM_WIDTH; x++)
            for (int k = 0; k < 3; k++) {
                random = random * 1664525u + 1013904223u; /* Knuth's "quick and dirty" generator */
                frame[y][x][k] = (float)(random >> 8) * (random >> 28 ? 0x1p-24f : 0x1p-18f);
            }
    for (int i = 0; i < 2; i++) {
        c.threshold = i;
        error |= pupil_bloom_init(bloom, sizeof memory, &c);
        error |= pupil_bloom_gather_rows(bloom, &pupil, &in, 10, BLOOM_HEIGHT - 10, &scratch);
        error |= pupil_bloom_gather_rows(bloom, &pupil, &in, 0, 10, &scratch);
        error |= pupil_bloom_solve(bloom, &pupil);
        error |= pupil_bloom_map_rows(bloom, 0, &pupil, &curve, &in, &out, &scratch);
        for (size_t k = 0; k < sizeof picture; k++)
            digest = (digest ^ bytes[k]) * UINT64_C(0x100000001b3);
    }
    return (digest ^ (uint64_t)(uint32_t)error) * UINT64_C(0x100000001b3);
}

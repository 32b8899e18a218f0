/* Veiling glare: the nodes of two eyes and of a list of lights, a row of the series, and a picture. */
#include "digest.h"

#include "pupil/veil.h"

enum { VEIL_WIDTH = 131, VEIL_HEIGHT = 37, VEIL_FLOATS = PUPIL_VEIL_NODES * PUPIL_VEIL_NODES * 3 };

static uint64_t add(uint64_t digest, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        digest = (digest ^ ((const unsigned char *)bytes)[i]) * UINT64_C(0x100000001b3);
    return digest;
}

/* Their bits, the lowest byte first, as in the memory of a little-endian CPU. */
static uint64_t add_floats(uint64_t digest, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        __builtin_memcpy(&bits, &values[i], sizeof bits);
        const unsigned char bytes[4] = {(unsigned char)bits, (unsigned char)(bits >> 8), (unsigned char)(bits >> 16),
                                        (unsigned char)(bits >> 24)};
        digest = add(digest, bytes, sizeof bytes);
    }
    return digest;
}

uint64_t digest_veil(void)
{
    static pupil_veil veil;
    static pupil_veil_light light, rest;
    static pupil_veil_scratch scratch;
    static pupil_t pupil;
    static pupil_stats stats;
    static float frame[VEIL_HEIGHT][VEIL_WIDTH][3], nodes[VEIL_FLOATS], row[3 * VEIL_WIDTH];
    static unsigned char picture[VEIL_HEIGHT][VEIL_WIDTH][3];
    const pupil_image_const in = {.data = frame,
                                  .stride_bytes = sizeof frame[0],
                                  .width = VEIL_WIDTH,
                                  .height = VEIL_HEIGHT,
                                  .pixel = PUPIL_PIXEL_RGB32F};
    const pupil_image out = {.data = picture,
                             .stride_bytes = sizeof picture[0],
                             .width = VEIL_WIDTH,
                             .height = VEIL_HEIGHT,
                             .pixel = PUPIL_PIXEL_RGB8};
    const pupil_image_const upper = pupil_image_rows(in, 0, 10), lower = pupil_image_rows(in, 10, VEIL_HEIGHT - 10);
    const pupil_curve curve = {.scale = 0.5f, .inverse_white_squared = 0.0625f, .dither = 1};
    const pupil_veil_spot spot[2] = {{30.5, 11.25, {1.0f, 0.5f, 0.0f}, 0}, {101.0, 40.0, {0.0f, 2.0f, 3.0f}, 0}};
    uint64_t digest = UINT64_C(0xcbf29ce484222325); /* FNV-1a, as digest.c has it */
    pupil_config config;
    pupil_veil_config eye;
    uint32_t random = 1;
    int error;
    pupil_config_default(&config);
    error = pupil_init(&pupil, &config);
    pupil_veil_config_default(&eye);
    eye.width = VEIL_WIDTH;
    eye.height = VEIL_HEIGHT;
    for (int y = 0; y < VEIL_HEIGHT; y++)
        for (int x = 0; x < VEIL_WIDTH; x++)
            for (int c = 0; c < 3; c++) {
                random = random * 1664525u + 1013904223u; /* Knuth's "quick and dirty" generator */
                frame[y][x][c] = (float)(random >> 8) * (random >> 28 ? 0x1p-24f : 0x1p-10f);
            }
    for (uint32_t psf = 0; psf < PUPIL_VEIL_GAUSSIANS; psf++) {
        eye.psf = psf;
        error |= pupil_veil_init(&veil, &eye);
        error |= pupil_veil_light_clear(&light) | pupil_veil_light_clear(&rest);
        pupil_stats_clear(&stats);
        error |= pupil_veil_gather_rows(&veil, &pupil, &lower, 10, &stats, &light);
        error |= pupil_veil_gather_rows(&veil, &pupil, &upper, 0, 0, &rest);
        error |= pupil_veil_light_add(&light, &rest);
        error |= pupil_veil_begin(&veil) | pupil_veil_add_light(&veil, &light);
        for (uint32_t bell = 0; psf == PUPIL_VEIL_CIE && bell < PUPIL_VEIL_BELL_COUNT; bell++)
            error |= pupil_veil_add_bells(&veil, bell, 20.0, spot, 2);
        error |= pupil_veil_solve(&veil) | pupil_veil_get_nodes(&veil, nodes);
        error |= pupil_veil_map_rows(&veil, &pupil, &curve, &in, &out, &scratch);
        error |= pupil_veil_evaluate_rows(&veil, 17, 1, row);
        digest = add(add_floats(digest, nodes, VEIL_FLOATS), picture, sizeof picture);
        digest = add_floats(digest, row, sizeof row / sizeof row[0]);
    }
    return (digest ^ (uint64_t)(uint32_t)error) * UINT64_C(0x100000001b3);
}

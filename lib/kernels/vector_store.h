/* lib/kernels/vector_store.h: 8-bit codes by vectors that have fast arithmetic and slow table look-ups (x86).
 *
 * The code of a sample is exact by construction (kernels.h: pupil_encoder). Looking up 24 cells for 8 pixels would take
 * longer than all the rest. So sRGB is computed first, to a known error: by a polynomial in the fraction times a power
 * of the exponent (f = 1.055 x^(5/12) - 0.055; IEC 61966-2-1), and near black by two lines. Only where the result is
 * within that error of a boundary between two codes, in about one of 1200 samples, the cell decides. (With a degree
 * less it was one of 190, which took a third of the time: their branches are mispredicted.)
 */
#include "vector_scale.h"

/* In 1/65536 code. ERROR is an upper bound of the error over all floats (23.6; a test tries each of them), TOE_ERROR
 * that of the lines near black. */
#define CODE          65536.0f
#define ERROR         28.0f
#define TOE_ERROR     176.0f
#define UNCERTAIN     56  /* twice the error */
#define UNCERTAIN_TOE 352 /* where some are near black */

/* A code is added to 2^23 in units of 1/32768: then the number's lower bits are that sum, and need no conversion.
 * A polynomial whose first factor is 1 takes an addition where another would take a product and a copy of its factor.
 */
typedef struct srgb_constants {
    floats power; /* 32768 * 255 * 1.055 * 2^(5/12 k) * FIRST for x in [2^k, 2^(k+1)), k = -8..-1, at k + 127 mod 8 */
    floats p[5];  /* m^(5/12) / FIRST for m in [1, 2), less m^5; relative error 1.2e-6: minimax, by Remez' exchange */
    floats
        line[2]; /* slopes: the linear toe (2e-4 less, so that it also serves the first boundary above it), and the */
    floats from[2]; /* line through the two last boundaries below 2^-8 */
    floats offset;
} srgb_constants;

/* FIRST is 0.00543537306. */
static const float srgb_power[8] = {6345.52832f, 8470.26367f, 11306.4463f, 15092.2949f,
                                    20145.7969f, 26891.4121f, 35895.7305f, 4753.7749f};

INLINE srgb_constants srgb_constants_of(void)
{
    srgb_constants c;
    c.power = v_table8_of(srgb_power);
    c.p[0] = v_all(69.2372513f);
    c.p[1] = v_all(175.298889f);
    c.p[2] = v_all(-90.4685211f);
    c.p[3] = v_all(38.372303f);
    c.p[4] = v_all(-9.45970249f);
    c.line[0] = v_all(107935862.0f); /* 12.92 * 255 * 32768 * (1 - 2e-4) */
    c.from[0] = v_all(0x1p23f + (0.5f * CODE + TOE_ERROR) / 2);
    c.line[1] = v_all(96644921.0f);
    c.from[1] = v_all(0x1p23f + (108127.817f + TOE_ERROR) / 2);
    c.offset = v_all(0x1p23f + ((0.5f - 0.055f * 255.0f) * CODE + ERROR) / 2);
    return c;
}

/* Three channels at a time: each is a long chain of dependent instructions, and none waits for another. */
enum { GUESSES = 3 };
#if defined(__clang__)
#define FOR_EACH_GUESS(k) for (int k = 0; k < GUESSES; k++)
#else
#define FOR_EACH_GUESS(k) _Pragma("GCC unroll 8") for (int k = 0; k < GUESSES; k++)
#endif

/* x is from 2^-8 to just below 1. The third byte of the result is the code, which is certain if the lower half is not
 * below UNCERTAIN. */
INLINE void srgb_guess(const floats x[GUESSES], const srgb_constants *c, floats code[GUESSES])
{
    floats m[GUESSES], power[GUESSES];
    FOR_EACH_GUESS(k) m[k] = v_of_bits(v_or(v_bits(x[k]), v_all_ints(0x3f800000))); /* exponents up to 127 become 127 */
    FOR_EACH_GUESS(k) power[k] = v_table8(c->power, v_right(v_bits(x[k]), 23));
    FOR_EACH_GUESS(k) code[k] = v_add(m[k], c->p[4]);
    FOR_EACH_GUESS(k) code[k] = v_about(code[k], m[k], c->p[3]);
    FOR_EACH_GUESS(k) code[k] = v_about(code[k], m[k], c->p[2]);
    FOR_EACH_GUESS(k) code[k] = v_about(code[k], m[k], c->p[1]);
    FOR_EACH_GUESS(k) code[k] = v_about(code[k], m[k], c->p[0]);
    FOR_EACH_GUESS(k) code[k] = v_about(code[k], power[k], c->offset);
}

/* The same for x from 0 to 2^-8; then the limit is UNCERTAIN_TOE. */
INLINE void srgb_toe(const floats x[GUESSES], const srgb_constants *c, floats code[GUESSES])
{
    FOR_EACH_GUESS(k)
    {
        const floats toe = v_min(v_about(x[k], c->line[0], c->from[0]), v_about(x[k], c->line[1], c->from[1]));
        code[k] = v_select(v_less(x[k], v_all(0x1p-8f)), toe, code[k]);
    }
}

/* By its cell. */
INLINE ints code_of_cell(floats x, const pupil_encoder *e)
{
    const floats lowest = v_of_bits(v_all_ints(e->base_bits));
    const ints bits = v_bits(v_min(v_max(x, lowest), v_all(1.0f)));
    const ints cell = v_gather(e->cell, v_right(v_minus(bits, v_all_ints(e->base_bits)), 16));
    return v_plus(cell, v_and(bits, v_all_ints(0xffff)));
}

INLINE void store_pixels(ints pixels, uint8_t *target, uint32_t bytes)
{
    if (bytes == 4)
        v_store_four(pixels, target);
    else
        v_store_three(pixels, target);
}

/* A bit for each pixel of a block whose codes are not certain. They wait until after the loop, as those of group_list
 * do. Storing the bits takes no branch; making a list of the few would take branches that are mispredicted. */
typedef struct pixel_bits {
    uint8_t of[PUPIL_BLOCK / 8];
} pixel_bits;

INLINE void put_bits(pixel_bits *bits, size_t i, uint32_t of_vector)
{
    bits->of[i / 8] = (uint8_t)of_vector;
    if (WIDTH == 16)
        bits->of[i / 8 + 1] = (uint8_t)(of_vector >> 8);
}

/* The codes of three channels, by their cells, of those of n pixels whose bits are set. */
static void settle(pixel_bits *bits, uint32_t n, const float *first, const float *second, const float *third,
                   const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    for (uint32_t j = n / 8; j % 8; j++)
        bits->of[j] = 0;
    for (uint32_t from = 0; from < n; from += 64) {
        uint64_t which;
        for (__builtin_memcpy(&which, bits->of + from / 8, sizeof which); which; which &= which - 1) {
            const uint32_t i = from + (uint32_t)__builtin_ctzll(which);
            target[i * bytes] = exact_code(first[i], e);
            target[i * bytes + 1] = exact_code(second[i], e);
            target[i * bytes + 2] = exact_code(third[i], e);
        }
    }
}

/* Prefetches every second cache line of the pixels that are read next; scale prefetches the others. If there is nothing
 * to prefetch, the addresses are in the cache already: a branch took longer. */
INLINE void fetch_second_lines(pupil_lines next, size_t i)
{
    fetch_each((const void *)next.first, 16 * WIDTH, next.pixel_bytes * i, 128);
}

/* Returns the pixels whose guesses are not all certain. Dark samples are in few vectors, which are neighbours: a branch
 * is cheaper than the toe for all. */
INLINE mask store_guesses(const floats x[3], const srgb_constants *c, uint8_t *at, uint32_t bytes)
{
    floats guess[3];
    ints code[3], limit = v_all_ints(0xffff0000u | (UNCERTAIN - 1));
    srgb_guess(x, c, guess);
    if (__builtin_expect(v_mask_bits(v_less(v_min(v_min(x[0], x[1]), x[2]), v_all(0x1p-8f))) != 0, 0)) {
        srgb_toe(x, c, guess);
        limit = v_all_ints(0xffff0000u | (UNCERTAIN_TOE - 1));
    }
    FOR_EACH_GUESS(k) code[k] = v_plus(v_bits(guess[k]), v_bits(guess[k]));
    store_pixels(v_pixels(code[0], code[1], code[2]), at, bytes);
    const ints rest = v_min_halves(v_min_halves(code[0], code[1]), code[2]);
    return v_equal_ints(v_min_halves(rest, limit), rest);
}

/* Stores whole vectors as long as they do not write beyond the last pixel; returns the first pixel that is left. */
INLINE uint32_t store_srgb(const pupil_planes *planes, const float *first, const float *second, const float *third,
                           uint32_t n, const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    const srgb_constants c = srgb_constants_of();
    const pupil_lines next = planes->next;
    const floats most = v_all(0x1.fffffep-1f);
    const size_t slack = bytes == 3 ? 2 : 0, end = n < WIDTH + slack ? 0 : n - (WIDTH + slack) + 1;
    pixel_bits near;
    uint32_t any = 0;
    size_t i = 0;
    for (; i < end; i += WIDTH) {
        const floats x[3] = {v_min(most, v_load(first + i)), v_min(most, v_load(second + i)),
                             v_min(most, v_load(third + i))};
        uint8_t *at = target + i * bytes;
        fetch(at, WIDTH * bytes, PUPIL_BLOCK * bytes);
        fetch_second_lines(next, i);
        const mask uncertain = store_guesses(x, &c, at, bytes);
        any |= v_mask_bits(uncertain);
        put_bits(&near, i, v_mask_bits(uncertain));
    }
    if (any)
        settle(&near, (uint32_t)i, first, second, third, e, target, bytes);
    return (uint32_t)i;
}

INLINE uint32_t store_by_cells(const pupil_planes *planes, const float *first, const float *second, const float *third,
                               uint32_t n, const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    const pupil_lines next = planes->next;
    const uint32_t slack = bytes == 3 ? 2 : 0;
    uint32_t i = 0;
    for (; i + WIDTH + slack <= n; i += WIDTH) {
        const ints x = code_of_cell(v_load(first + i), e), y = code_of_cell(v_load(second + i), e);
        const ints z = code_of_cell(v_load(third + i), e);
        fetch_second_lines(next, i);
        store_pixels(v_pixels(x, y, z), target + (size_t)i * bytes, bytes);
    }
    return i;
}

INLINE void store_vectors(const pupil_planes *planes, const float *first, const float *second, const float *third,
                          uint32_t n, const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    uint32_t i = e->transfer == PUPIL_TRANSFER_SRGB ? store_srgb(planes, first, second, third, n, e, target, bytes)
                                                    : store_by_cells(planes, first, second, third, n, e, target, bytes);
    store_rest(first, second, third, i, n, e, target, bytes);
}

/* The level of WebAssembly with 128-bit vectors. A browser without these instructions refuses a whole module that has
 * any of them: so a page has a second module without this file, and asks WebAssembly.validate which one to take. Codes
 * are looked up in the encoder's cells, as by NEON: there is neither a table of eight floats nor a gather. */
#if defined(PUPIL_WASM128)

#include "wasm128.h"

#include "vector_formats.h"

static const format rgba32f = {.bytes = 16, .vector = load4_rgba32f};
static const format rgb32f = {.bytes = 12, .vector = load4_rgb32f};
static const format rgba16f = {.bytes = 8, .vector = load4_rgba16f};
static const format rgba16 = {.bytes = 8, .vector = load4_rgba16};
static const format rgb16 = {.bytes = 6, .vector = load4_rgb16};
static const format rgb16f = {.bytes = 6, .vector = load4_rgb16f};

/* The codes of four samples from 0 to a little more than 1, which is in the cell of 1 (kernels.h). Samples below the
 * first cell get its first code, 0. */
INLINE ints codes_of(const float *x, const uint32_t *cell, ints base)
{
    const ints at = v_minus(v_max_unsigned(v_bits(v_load(x)), base), base), i = v_right(at, 16);
    const ints word =
        wasm_i32x4_make((int32_t)cell[wasm_i32x4_extract_lane(i, 0)], (int32_t)cell[wasm_i32x4_extract_lane(i, 1)],
                        (int32_t)cell[wasm_i32x4_extract_lane(i, 2)], (int32_t)cell[wasm_i32x4_extract_lane(i, 3)]);
    return v_right(v_plus(word, v_and(at, v_all_ints(0xffff))), 16);
}

INLINE void store_vectors(const pupil_planes *planes, const float *first, const float *second, const float *third,
                          uint32_t n, const pupil_encoder *e, uint8_t *target, uint32_t bytes)
{
    (void)planes;
    const uint32_t *cell = e->cell;
    const ints base = v_all_ints(e->base_bits);
    const uint32_t whole = n / WIDTH * WIDTH;
    for (size_t i = 0; i < whole; i += WIDTH) {
        const ints x = codes_of(first + i, cell, base), y = codes_of(second + i, cell, base);
        const ints z = codes_of(third + i, cell, base);
        const ints pixel = v_or(v_or(x, v_left(y, 8)), v_or(v_left(z, 16), v_all_ints(0xff000000u)));
        if (bytes == 4) {
            wasm_v128_store(target + i * 4, pixel);
        } else {
            const ints packed = wasm_i8x16_shuffle(pixel, pixel, 0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 0, 0, 0, 0);
            wasm_v128_store64_lane(target + i * 3, packed, 0);
            wasm_v128_store32_lane(target + i * 3 + 8, packed, 2);
        }
    }
    store_rest(first, second, third, whole, n, e, target, bytes);
}

#include "wasm128_luma.h"

#include "vector_table.h"

const pupil_kernels pupil_kernels_wasm128 = {VECTOR_PIECES};

#else
typedef int pupil_no_wasm128; /* a C file must not be empty */
#endif

/* lib/kernels/avx512_bloom.h: bloom_filters.h's filters in one step: a vector that begins anywhere in a row is put
 * together of two, because almost every load of one would cross a cache line. */
#ifndef PUPIL_KERNELS_AVX512_BLOOM_H
#define PUPIL_KERNELS_AVX512_BLOOM_H

/* From the k-th lane of a on, and what follows in b. */
#define FROM_LANE(a, b, k) _mm512_castsi512_ps(_mm512_alignr_epi32(_mm512_castps_si512(b), _mm512_castps_si512(a), k))
/* d pixels from the first. */
#define BESIDE(d) ((d) + PUPIL_BLOOM_SIDE)

INLINE floats row_of(const floats a[4], const floats b[4])
{
    const floats at = FROM_LANE(a[0], b[0], BESIDE(0));
    const floats one = v_add(FROM_LANE(a[1], b[1], BESIDE(-1)), FROM_LANE(a[1], b[1], BESIDE(1)));
    const floats two = v_add(FROM_LANE(a[2], b[2], BESIDE(-2)), FROM_LANE(a[2], b[2], BESIDE(2)));
    const floats three = v_add(FROM_LANE(a[3], b[3], BESIDE(-3)), FROM_LANE(a[3], b[3], BESIDE(3)));
    return v_add(v_add(at, one), v_add(two, three));
}

INLINE void scatter_row(const float *const row[7], size_t ahead, const floats t[PUPIL_BLOOM_TAPS], uint32_t n,
                        const float *with, float *to)
{
    floats a[4], b[4];
    columns_at(row, t, 0, a);
    for (size_t i = 0; i < n; i += WIDTH) {
        if (ahead)
            __builtin_prefetch(row[6] + ahead + i);
        columns_at(row, t, i + WIDTH, b);
        const floats sum = row_of(a, b);
        v_store(to + i, with ? v_add(v_load(with + i), sum) : sum);
        FOR_EACH_OF(4, k) a[k] = b[k];
    }
}

static void bloom_scatter(const float *const *rows, size_t ahead, const pupil_bloom_taps *taps, uint32_t n,
                          pupil_bloom_room room, const float *with, float *to)
{
    /* local copies, so that the compiler knows that no store changes them */
    const float *const row[7] = {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6]};
    floats t[PUPIL_BLOOM_TAPS];
    (void)room;
    FOR_EACH_OF(PUPIL_BLOOM_TAPS, k) t[k] = v_all(taps->tap[k]);
    if (with)
        scatter_row(row, ahead, t, n, with, to);
    else
        scatter_row(row, ahead, t, n, 0, to);
}

INLINE floats down_at(const float *const row[8], size_t i)
{
    const floats inner = v_add(v_mul(both_of(row[3] + i, row[4] + i), v_all(0x89p-9f)),
                               v_mul(both_of(row[2] + i, row[5] + i), v_all(0x54p-9f)));
    const floats outer = v_add(v_mul(both_of(row[1] + i, row[6] + i), v_all(0x1ep-9f)),
                               v_mul(both_of(row[0] + i, row[7] + i), v_all(0x5p-9f)));
    return v_add(inner, outer);
}

/* The even and the odd ones of 32 pixels. */
INLINE void down_apart(const float *const row[8], size_t i, floats *even, floats *odd)
{
    const ints evens = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    const floats a = down_at(row, i), b = down_at(row, i + WIDTH);
    *even = _mm512_permutex2var_ps(a, evens, b);
    *odd = _mm512_permutex2var_ps(a, v_plus(evens, v_all_ints(1)), b);
}

static void bloom_halve(const float *const *rows, size_t ahead, uint32_t n, pupil_bloom_room room, float *to)
{
    enum { HERE = PUPIL_BLOOM_SIDE / 2 };
    /* local copies, so that the compiler knows that no store changes them */
    const float *const row[8] = {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7]};
    floats e, o, next_e, next_o;
    (void)room;
    down_apart(row, 0, &e, &o);
    for (size_t i = 0; i < n; i += WIDTH, e = next_e, o = next_o) {
        for (size_t k = 2 * i; ahead && k < 2 * i + 2 * WIDTH; k += WIDTH) {
            __builtin_prefetch(row[6] + ahead + k);
            __builtin_prefetch(row[7] + ahead + k);
        }
        down_apart(row, 2 * i + 2 * WIDTH, &next_e, &next_o);
        const floats first = v_add(FROM_LANE(e, next_e, HERE), FROM_LANE(o, next_o, HERE));
        const floats second = v_add(FROM_LANE(o, next_o, HERE - 1), FROM_LANE(e, next_e, HERE + 1));
        const floats third = v_add(FROM_LANE(e, next_e, HERE - 1), FROM_LANE(o, next_o, HERE + 1));
        const floats fourth = v_add(FROM_LANE(o, next_o, HERE - 2), FROM_LANE(e, next_e, HERE + 2));
        const floats inner = v_add(v_mul(first, v_all(0x89p-9f)), v_mul(second, v_all(0x54p-9f)));
        const floats outer = v_add(v_mul(third, v_all(0x1ep-9f)), v_mul(fourth, v_all(0x5p-9f)));
        v_store(to + i, v_add(inner, outer));
    }
}

/* Even and odd ones of 32 pixels, from vectors a and b. */
INLINE void widen_at(floats a, floats b, floats *even, floats *odd)
{
    const floats here = v_mul(FROM_LANE(a, b, BESIDE(0)), v_all(0x89p-8f));
    const floats before = FROM_LANE(a, b, BESIDE(-1)), after = FROM_LANE(a, b, BESIDE(1));
    const floats far_before = v_mul(FROM_LANE(a, b, BESIDE(-2)), v_all(0x5p-8f));
    const floats far_after = v_mul(FROM_LANE(a, b, BESIDE(2)), v_all(0x5p-8f));
    *even = v_add(v_add(here, v_mul(before, v_all(0x54p-8f))), v_add(v_mul(after, v_all(0x1ep-8f)), far_before));
    *odd = v_add(v_add(here, v_mul(after, v_all(0x54p-8f))), v_add(v_mul(before, v_all(0x1ep-8f)), far_after));
}

INLINE void widen_row(const float *const row[4], const floats t[4], uint32_t n, float *to, int add)
{
    const ints lower = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const ints upper = v_plus(lower, v_all_ints(8));
    floats a = up_at(row, t, 0), b, even, odd;
    for (size_t i = 0; i < n; i += WIDTH, to += 2 * WIDTH, a = b) {
        b = up_at(row, t, i + WIDTH);
        widen_at(a, b, &even, &odd);
        const floats low = _mm512_permutex2var_ps(even, lower, odd), high = _mm512_permutex2var_ps(even, upper, odd);
        v_store(to, add ? v_add(v_load(to), low) : low);
        if (i + WIDTH / 2 < n)
            v_store(to + WIDTH, add ? v_add(v_load(to + WIDTH), high) : high);
    }
}

static void bloom_widen(const float *const *rows, const float tap[4], uint32_t n, pupil_bloom_room room, float *to,
                        int add)
{
    /* local copies, so that the compiler knows that no store changes them */
    const float *const row[4] = {rows[0], rows[1], rows[2], rows[3]};
    const floats t[4] = {v_all(tap[0]), v_all(tap[1]), v_all(tap[2]), v_all(tap[3])};
    (void)room;
    if (add)
        widen_row(row, t, n, to, 1);
    else
        widen_row(row, t, n, to, 0);
}

#endif

/* The scalar level's rows of bloom and runs of the veil against the test's own sums, and that each row is written
 * exactly as far as kernels.h says. All numbers are small integers and powers of two, so every order of a sum has the
 * same bits. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "kernels/kernels.h"

enum { MOST = 400, ROOM = MOST + 64, GUARD = -12345 };
static const uint32_t counts[] = {1, 8, 15, 16, 17, 31, 32, 33, 64, 100, 192, 193, MOST};
enum { COUNTS = sizeof counts / sizeof counts[0], BLOCKS = 10 }; /* as many as a block has */

enum { ROWS = 8 };
static float rows[ROWS][2 * ROOM], to[2 * ROOM];

static uint32_t up_to(uint32_t n, uint32_t multiple)
{
    return (n + multiple - 1) / multiple * multiple;
}

static void begin(void)
{
    for (int r = 0; r < ROWS; r++)
        for (int i = 0; i < 2 * ROOM; i++)
            rows[r][i] = (float)(int)(check_random() % 512);
    for (int i = 0; i < 2 * ROOM; i++)
        to[i] = GUARD;
}

static void check_guard(const char *what, uint32_t n, uint32_t end)
{
    for (uint32_t i = end; i < 2 * ROOM; i++)
        CHECK_MSG(to[i] == GUARD, "%s of %u: wrote at %u", what, n, i);
}

/* The eight-tap filter, by pairs of both sides. */
static float eighth_of(const float pair[4])
{
    return 137 * pair[0] + 84 * pair[1] + 30 * pair[2] + 5 * pair[3];
}

static const pupil_bloom_taps taps = {{1, 2, 4, 8, 16, 32, 3, 5, 7}};

/* The tap at the distance (a, b), in the order of kernels.h. */
static float tap_at(int a, int b)
{
    const int y = abs(a), x = abs(b);
    if (y == 3 && x == 3)
        return 0.0f;
    return taps.tap[y > x ? y * (y + 1) / 2 + x : x * (x + 1) / 2 + y];
}

static pupil_bloom_room room;
static const float *row[ROWS];

static void begin_rows(void)
{
    begin();
    for (int r = 0; r < ROWS; r++)
        row[r] = rows[r];
}

static void check_scatter(uint32_t n, int with)
{
    static float more[2 * ROOM];
    const uint32_t end = up_to(n, 16);
    begin_rows();
    for (int i = 0; i < 2 * ROOM; i++)
        more[i] = (float)i;
    pupil_kernels_scalar.bloom_scatter(row, 0, &taps, n, room, with ? more : NULL, to);
    for (uint32_t i = 0; i < end; i++) {
        float sum = with ? more[i] : 0.0f;
        for (int y = -3; y <= 3; y++)
            for (int x = -3; x <= 3; x++)
                sum += tap_at(y, x) * rows[3 + y][PUPIL_BLOOM_SIDE + (int)i + x];
        CHECK_MSG(to[i] == sum, "scatter of %u at %u: %g, expected %g", n, i, (double)to[i], (double)sum);
    }
    check_guard("scatter", n, end);
}

/* The value of pixel i, filtered from eight rows. */
static float down_at(size_t i)
{
    const float pair[4] = {rows[3][i] + rows[4][i], rows[2][i] + rows[5][i], rows[1][i] + rows[6][i],
                           rows[0][i] + rows[7][i]};
    return eighth_of(pair);
}

static void check_halve(uint32_t n)
{
    const uint32_t end = up_to(n, 16);
    begin_rows();
    for (int r = 0; r < ROWS; r++) /* sums of 24 bits */
        for (int i = 0; i < 2 * ROOM; i++)
            rows[r][i] = (float)((int)rows[r][i] % 64);
    pupil_kernels_scalar.bloom_halve(row, n % 2 ? ROOM : 0, n, room, to);
    for (uint32_t i = 0; i < end; i++) {
        const size_t at = PUPIL_BLOOM_SIDE + 2 * (size_t)i;
        const float pair[4] = {down_at(at) + down_at(at + 1), down_at(at - 1) + down_at(at + 2),
                               down_at(at - 2) + down_at(at + 3), down_at(at - 3) + down_at(at + 4)};
        CHECK_MSG(512.0f * 512.0f * to[i] == eighth_of(pair), "halve of %u at %u", n, i);
    }
    check_guard("halve", n, end);
}

/* The value of pixel i, interpolated between four rows. */
static float up_at(size_t i)
{
    return 2 * rows[0][i] + 4 * rows[1][i] + rows[2][i] + 16 * rows[3][i];
}

static void check_widen(uint32_t n, int add)
{
    const float tap[4] = {0.25f, 0.5f, 0.125f, 2.0f};
    const uint32_t end = up_to(n, 8);
    begin_rows();
    for (uint32_t i = 0; add && i < 2 * end; i++)
        to[i] = (float)(int)i;
    pupil_kernels_scalar.bloom_widen(row, tap, n, room, to, add);
    for (uint32_t i = 0; i < end; i++) {
        const size_t at = PUPIL_BLOOM_SIDE + (size_t)i;
        const float here = up_at(at), left = up_at(at - 1), right = up_at(at + 1);
        const float before[4] = {here, left, right, up_at(at - 2)}, after[4] = {here, right, left, up_at(at + 2)};
        const float was[2] = {add ? (float)(int)(2 * i) : 0.0f, add ? (float)(int)(2 * i + 1) : 0.0f};
        CHECK_MSG(2048.0f * (to[2 * i] - was[0]) == eighth_of(before), "widen of %u at %u", n, 2 * i);
        CHECK_MSG(2048.0f * (to[2 * i + 1] - was[1]) == eighth_of(after), "widen of %u at %u", n, 2 * i + 1);
    }
    check_guard("widen", n, 2 * end);
}

/* No channel, or one channel of one pixel, is above the threshold; alpha and pixels beyond n do not count. */
static void check_lamps_of_pixels(uint32_t n)
{
    static float pixels[4 * PUPIL_BLOCK];
    for (uint32_t i = 0; i < 4 * PUPIL_BLOCK; i++)
        pixels[i] = i % 4 == 3 || i >= 4 * n ? 9.0f : i % 3 ? 2.0f : NAN;
    CHECK(pupil_kernels_scalar.bloom_lamps_rgba32f(pixels, n, 2.0f) == 0);
    for (uint32_t i = 0; i < 4 * n; i++) {
        const float before = pixels[i];
        if (i % 4 == 3)
            continue;
        pixels[i] = 2.5f;
        CHECK_MSG(pupil_kernels_scalar.bloom_lamps_rgba32f(pixels, n, 2.0f) == 1u << i / 32, "%u of %u", i, n);
        pixels[i] = before;
    }
}

static void check_lamps(uint32_t n)
{
    static pupil_planes planes;
    float *const channel[3] = {planes.r, planes.g, planes.b};
    for (uint32_t i = 0; i < 3 * PUPIL_BLOCK; i++)
        channel[i % 3][i / 3] = i >= 3 * n ? 9.0f : i % 5 ? 2.0f : NAN;
    for (uint32_t i = 0; i < 3 * n; i++) {
        float *at = &channel[i % 3][i / 3], before = *at;
        CHECK(pupil_kernels_scalar.bloom_lamps(&planes, n, 2.0f) == 0);
        *at = 2.5f;
        CHECK_MSG(pupil_kernels_scalar.bloom_lamps(&planes, n, 2.0f) == 1u << i / 24, "%u of %u", i, n);
        *at = before;
    }
}

/* Negative light, NaN and light above the ceiling; and light above a threshold, with its colour unchanged. -0 is 0, as
 * it is at the levels whose vectors take the larger of it and 0. */
static void check_bright(uint32_t n)
{
    static pupil_planes planes;
    static float bright[3][PUPIL_BLOCK];
    float *const out[3] = {bright[0], bright[1], bright[2]};
    for (int threshold = 0; threshold < 2; threshold++) {
        for (uint32_t i = 0; i < PUPIL_BLOCK; i++) {
            planes.r[i] = i % 5 == 1 ? (i % 2 ? -3.0f : -0.0f) : i % 5 == 2 ? NAN : 4.0f;
            planes.g[i] = i % 5 == 3 ? 0x1p31f : 2.0f;
            planes.b[i] = i % 5 == 4 ? 8.0f : 1.0f;
            bright[0][i] = bright[1][i] = bright[2][i] = GUARD;
        }
        pupil_kernels_scalar.bloom_bright(&planes, n, threshold ? 4.0f : 0.0f, out);
        for (uint32_t i = 0; i < n; i++) {
            const float r = i % 5 == 1 || i % 5 == 2 ? 0.0f : 4.0f, g = i % 5 == 3 ? 0x1p30f : 2.0f;
            const float b = i % 5 == 4 ? 8.0f : 1.0f, most = i % 5 == 3 ? 0x1p30f : i % 5 == 4 ? 8.0f : 4.0f;
            const float share = !threshold ? 1.0f : i % 5 == 1 || i % 5 == 2 ? 0.0f : (most - 4.0f) / most;
            CHECK(bright[0][i] == r * share && bright[1][i] == g * share && bright[2][i] == b * share);
            CHECK(!signbit(bright[0][i]));
        }
        for (uint32_t i = n; i < PUPIL_BLOCK; i++)
            CHECK(bright[0][i] == GUARD && bright[1][i] == GUARD && bright[2][i] == GUARD);
    }
}

/* Runs of 1 to 17 pixels: the sums of their channels, and of these times the pixel's index in its run. */
static void check_veil(void)
{
    enum { RUNS = 17, PIXELS = RUNS * (RUNS + 1) / 2 };
    static float pixels[PIXELS + 8][4];
    static pupil_veil_sums sums[RUNS];
    uint32_t n[RUNS];
    for (int i = 0; i < PIXELS + 8; i++)
        for (int c = 0; c < 4; c++)
            pixels[i][c] = (float)(int)(check_random() % 64);
    for (uint32_t k = 0; k < RUNS; k++)
        n[k] = 1 + (5 * k + 3) % RUNS; /* each once */
    pupil_kernels_scalar.veil_gather_rgba32f(pixels, 0, n, RUNS, sums);
    for (uint32_t k = 0, at = 0; k < RUNS; at += n[k], k++)
        for (int c = 0; c < 3; c++) {
            float sum = 0.0f, moment = 0.0f;
            for (uint32_t i = 0; i < n[k]; i++) {
                sum += pixels[at + i][c];
                moment += (float)(int)i * pixels[at + i][c];
            }
            CHECK_MSG(sums[k].sum[c] == sum && sums[k].moment[c] == moment, "a run of %u", n[k]);
        }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (int k = 0; k < COUNTS; k++) {
        check_scatter(counts[k], 0);
        check_scatter(counts[k], 1);
        check_halve(counts[k]);
        check_widen(counts[k], 0);
        check_widen(counts[k], 1);
    }
    for (int k = 0; k < BLOCKS; k++) {
        check_bright(counts[k]);
        check_lamps_of_pixels(counts[k]);
        check_lamps(counts[k]);
    }
    check_veil();
    return check_end();
}

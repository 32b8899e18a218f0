/* The kernel of each octave (bloom_private.h): 7 x 7 taps without the corners, the same seen from all sides. The light
 * that an octave's narrow lobes scatter beyond them comes from the next coarser octave, whose nine taps are fitted to
 * it by least squares of errors relative to all light there. The rest within 7 x 7 gives the octave's own taps. So all
 * Gaussians, however many, are one kernel in each octave. */
#include "bloom_private.h"

#include "base/numeric.h"

/* The variance that the filters to an octave and back add together, in square pixels of the finer octave. */
#define FILTERS 3.6875
/* A Gaussian moves to the next coarser octave if it then has at least this variance. */
#define LEAST_VARIANCE 0.7
/* A Gaussian of up to this variance scatters nothing that matters beyond 7 x 7. */
#define OWN_VARIANCE (1.75 + PIXEL)
#define PIXEL        (1.0 / 12.0) /* the variance of a pixel's own light */
/* Errors are relative to this share of the weakest lobe's peak at least. */
#define SHARE 0.3
/* The second fit's weights are the first one's errors plus this share of the largest, which reduces the largest
 * error. */
#define LEAST_WEIGHT 0.02
#define RIDGE        1e-6

enum {
    REACH = PUPIL_BLOOM_ROWS / 2,
    TAPS = PUPIL_BLOOM_TAPS,
    FAR = BLOOM_FIT_FAR, /* the reach of a tap of the coarser octave */
    WIDE = 2 * FAR + 1
};

/* The filter to an octave and back, by a pixel's distance from the first of the two pixels in one of half the size. */
static double filter(int distance)
{
    static const double tap[8] = {5, 30, 84, 137, 137, 84, 30, 5};
    return distance < -3 || distance > 4 ? 0.0 : tap[distance + 3] / 512.0;
}

static int is_beyond(int y, int x)
{
    const int a = y < 0 ? -y : y, b = x < 0 ? -x : x;
    return a > REACH || b > REACH || a + b == 2 * REACH;
}

/* How often a kernel has tap (a, b). */
static double times_of(int a, int b)
{
    return (a ? 2.0 : 1.0) * (b ? 2.0 : 1.0) * (a == b ? 1.0 : 2.0);
}

static double kernel_sum(const double tap[TAPS])
{
    double sum = 0.0;
    for (int a = 0, k = 0; a <= REACH; a++)
        for (int b = 0; b <= a && k < TAPS; b++, k++)
            sum += times_of(a, b) * tap[k];
    return sum;
}

/* The light of a Gaussian in the pixels from its middle on. */
static void find_gaussian(double variance, double tap[FAR + 1])
{
    enum { PARTS = 64 }; /* Simpson's rule */
    const double sigma = pupil_root(variance - PIXEL), unit = 0.3989422804014327 / (3.0 * PARTS * sigma);
    for (int k = 0; k <= FAR; k++) {
        tap[k] = 0.0;
        for (int i = 0; i <= PARTS; i++) {
            const double x = (k - 0.5 + (double)i / PARTS) / sigma;
            tap[k] += (i == 0 || i == PARTS ? 1.0 : i % 2 ? 4.0 : 2.0) * pupil_decay(0.5 * x * x);
        }
        tap[k] *= unit;
    }
}

/* The light that a pixel at an even place leaves at each distance along a row, by the taps a to both sides in the
 * coarser octave, with the effect of its grid. A pixel at an odd place leaves the mirror image. */
static void find_replies(bloom_fit *f)
{
    for (int a = 0; a <= REACH; a++)
        for (int d = -FAR; d <= FAR; d++) {
            double sum = 0.0;
            for (int q = -2; q <= 1; q++)
                sum += filter(-2 * q) * (filter(d - 2 * (q + a)) + (a ? filter(d - 2 * (q - a)) : 0.0));
            f->reply[a][d + FAR] = 2.0 * sum;
        }
}

static int goes_on(const bloom_fit *f, uint32_t i)
{
    return (f->variance[i] - FILTERS) / 4.0 >= LEAST_VARIANCE;
}

/* The light that the octave's narrow lobes scatter, and that of all lobes. */
static void find_target(bloom_fit *f, int last)
{
    double tap[FAR + 1];
    f->narrow = 0.0;
    f->least = 1.0;
    for (uint32_t i = 0; i < f->lobes; i++) {
        const int narrow = last || !goes_on(f, i);
        const double peak = f->share[i] * 0.15915494309189535 / f->variance[i];
        f->least = f->share[i] > 0.0 && SHARE * peak < f->least ? SHARE * peak : f->least;
        f->narrow += narrow ? f->share[i] : 0.0;
        find_gaussian(f->variance[i], tap);
        for (int y = 0; y <= FAR; y++)
            for (int x = 0; x <= FAR; x++) {
                f->target[y][x] += narrow ? f->share[i] * tap[y] * tap[x] : 0.0;
                f->all[y][x] += f->share[i] * tap[y] * tap[x];
            }
    }
}

/* The mean of what the octave's taps leave, over all places of a pixel. */
static double mean_reply(const bloom_fit *f, int a, int d)
{
    return 0.5 * (f->reply[a][FAR + d] + f->reply[a][FAR - d]);
}

static double mean_of_tap(const bloom_fit *f, int a, int b, int y, int x)
{
    const double one = mean_reply(f, a, y) * mean_reply(f, b, x);
    return a == b ? one : one + mean_reply(f, b, y) * mean_reply(f, a, x);
}

/* What each tap of the coarser octave leaves at (y, x). Within 7 x 7, where the octave's own taps correct the mean,
 * only the difference from it.
 */
static void find_taps_at(const bloom_fit *f, int y, int x, double at[TAPS])
{
    for (int a = 0, k = 0; a <= REACH; a++)
        for (int b = 0; b <= a && k < TAPS; b++, k++) {
            at[k] = f->reply[a][FAR + y] * f->reply[b][FAR + x];
            at[k] += a == b ? 0.0 : f->reply[b][FAR + y] * f->reply[a][FAR + x];
            at[k] -= is_beyond(y, x) ? 0.0 : mean_of_tap(f, a, b, y, x);
        }
}

static double target_at(const bloom_fit *f, int y, int x)
{
    return is_beyond(y, x) ? f->target[y < 0 ? -y : y][x < 0 ? -x : x] : 0.0;
}

/* The square of the light that errors at (y, x) are relative to. */
static double square_at(const bloom_fit *f, int y, int x)
{
    const double all = f->all[y < 0 ? -y : y][x < 0 ? -x : x];
    return all * all + f->least * f->least;
}

/* The normal equations. */
static void add_equations(bloom_fit *f)
{
    double at[TAPS];
    __builtin_memset(f->sums, 0, sizeof f->sums);
    for (int y = -FAR; y <= FAR; y++)
        for (int x = -FAR; x <= FAR; x++) {
            const double by = (double)f->weight[(y + FAR) * WIDE + x + FAR] / square_at(f, y, x);
            find_taps_at(f, y, x, at);
            for (int i = 0; i < TAPS; i++) {
                for (int j = i; j < TAPS; j++)
                    f->sums[i][j] += by * at[i] * at[j];
                f->sums[i][TAPS] += by * at[i] * target_at(f, y, x);
            }
        }
}

/* By elimination: the matrix is symmetric and positive. */
static void solve_equations(bloom_fit *f)
{
    for (int i = 0; i < TAPS; i++) {
        f->sums[i][i] *= 1.0 + RIDGE;
        for (int j = 0; j < i; j++)
            f->sums[i][j] = f->sums[j][i];
    }
    for (int i = 0; i < TAPS; i++)
        for (int j = i + 1; j < TAPS; j++) {
            const double by = f->sums[j][i] / f->sums[i][i];
            for (int k = i; k <= TAPS; k++)
                f->sums[j][k] -= by * f->sums[i][k];
        }
    for (int i = TAPS - 1; i >= 0; i--) {
        double sum = f->sums[i][TAPS];
        for (int k = i + 1; k < TAPS; k++)
            sum -= f->sums[i][k] * f->below[k];
        f->below[i] = sum / f->sums[i][i];
    }
}

static void weigh_errors(bloom_fit *f)
{
    double at[TAPS], most = 0.0;
    for (int y = -FAR; y <= FAR; y++)
        for (int x = -FAR; x <= FAR; x++) {
            double error = -target_at(f, y, x);
            find_taps_at(f, y, x, at);
            for (int k = 0; k < TAPS; k++)
                error += f->below[k] * at[k];
            error = (error < 0.0 ? -error : error) / pupil_root(square_at(f, y, x));
            most = error > most ? error : most;
            f->weight[(y + FAR) * WIDE + x + FAR] = (float)error;
        }
    for (int i = 0; i < WIDE * WIDE; i++)
        f->weight[i] = most > 0.0 ? (float)((double)f->weight[i] / most + LEAST_WEIGHT) : 1.0f;
}

static void fit_below(bloom_fit *f)
{
    for (int i = 0; i < WIDE * WIDE; i++)
        f->weight[i] = 1.0f;
    add_equations(f);
    solve_equations(f);
    weigh_errors(f);
    add_equations(f);
    solve_equations(f);
}

/* The octave's taps, plus those that the finer octave was fitted with. So that no light is lost, what the fit misses
 * beyond 7 x 7 is scattered within. */
static void find_own(const bloom_fit *f, double tap[TAPS])
{
    double within[TAPS];
    const double sum = f->narrow + kernel_sum(tap) - kernel_sum(f->below);
    for (int a = 0, k = 0; a <= REACH; a++)
        for (int b = 0; b <= a && k < TAPS; b++, k++) {
            within[k] = f->target[a][b];
            tap[k] += within[k];
            for (int c = 0, i = 0; c <= REACH; c++)
                for (int d = 0; d <= c && i < TAPS; d++, i++)
                    tap[k] -= f->below[i] * mean_of_tap(f, c, d, a, b);
        }
    const double more = (sum - kernel_sum(tap)) / kernel_sum(within);
    for (int k = 0; k < TAPS; k++)
        tap[k] += more * within[k];
}

/* The lobes of the next coarser octave. */
static void go_on(bloom_fit *f)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < f->lobes; i++)
        if (goes_on(f, i)) {
            f->share[left] = f->share[i];
            f->variance[left++] = (f->variance[i] - FILTERS) / 4.0;
        }
    f->lobes = left;
}

static void begin(bloom_fit *f, const pupil_bloom_config *c)
{
    f->lobes = 0;
    for (uint32_t i = 0; i < c->lobes; i++) {
        f->share[f->lobes] = c->lobe[i].weight;
        f->variance[f->lobes] = c->lobe[i].sigma * c->lobe[i].sigma + PIXEL;
        f->lobes += c->lobe[i].weight > 0.0;
    }
}

uint32_t pupil_bloom_octaves(const pupil_bloom_config *c)
{
    uint32_t most = 1;
    for (uint32_t i = 0; i < c->lobes; i++) {
        double variance = c->lobe[i].sigma * c->lobe[i].sigma + PIXEL;
        uint32_t octaves = 1;
        for (; (variance - FILTERS) / 4.0 >= LEAST_VARIANCE; octaves++)
            variance = (variance - FILTERS) / 4.0;
        octaves += variance > OWN_VARIANCE;
        most = octaves > most ? octaves : most;
    }
    return most < BLOOM_OCTAVES ? most : BLOOM_OCTAVES;
}

void pupil_bloom_fit(const pupil_bloom_config *config, bloom_fit *f, uint32_t octaves, pupil_bloom_taps taps[])
{
    double tap[TAPS];
    __builtin_memset(f, 0, sizeof *f);
    begin(f, config);
    find_replies(f);
    for (uint32_t k = 0; k < octaves; k++) {
        for (int i = 0; i < TAPS; i++)
            tap[i] = f->below[i];
        __builtin_memset(f->below, 0, sizeof f->below);
        __builtin_memset(f->target, 0, sizeof f->target);
        __builtin_memset(f->all, 0, sizeof f->all);
        find_target(f, k + 1 == octaves);
        if (f->narrow > 0.0 && k + 1 < octaves)
            fit_below(f);
        if (f->narrow > 0.0)
            find_own(f, tap);
        for (int i = 0; i < TAPS; i++)
            taps[k].tap[i] = (float)tap[i];
        go_on(f);
    }
}

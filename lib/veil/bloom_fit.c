/* Lobes at full size as two kernels (bloom_private.h): one of 5 x 5 taps, which may have any values, and a Gaussian
 * that reaches further. What is beyond 5 x 5 is fitted: by that Gaussian, and by one in the octave below. The rest is
 * exact, but for what the octave's own grid does. */
#include "bloom_private.h"

#include "base/numeric.h"

enum { NEAR = 3, FAR = 9, WIDE = PUPIL_BLOOM_ROWS / 2 + 1, STEPS = 32 };
/* The wide Gaussian is the best one of these. */
#define LEAST_SIGMA 0.9
#define SIGMA_STEP  0.05
/* The octave's grid is seen by this share of the coarse Gaussian's peak, as errors anywhere. */
#define GRID 0.003
/* How small a share of a lobe's peak is looked at. */
#define SHARE 0.3

/* A quarter of the plane, from the middle outwards. */
typedef float bloom_quarter[FAR][FAR];

void pupil_bloom_find_taps(double sigma, uint32_t taps, double *tap)
{
    enum { PARTS = 64 }; /* Simpson's rule */
    double all = 0.0;
    for (uint32_t k = 0; k < taps; k++) {
        tap[k] = 0.0;
        for (int i = 0; i <= PARTS; i++) {
            const double x = (k - 0.5 + (double)i / PARTS) / sigma;
            tap[k] += (i == 0 || i == PARTS ? 1.0 : i % 2 ? 4.0 : 2.0) * pupil_decay(0.5 * x * x);
        }
        all += (k ? 2.0 : 1.0) * tap[k];
    }
    for (uint32_t k = 0; k < taps; k++)
        tap[k] /= all;
}

/* The light of the lobes of up to a sigma; returns the smallest peak. */
static __attribute__((noinline)) double add_lobes(const pupil_bloom_config *c, double most_sigma, bloom_quarter sum)
{
    double tap[FAR], least = 1.0;
    for (uint32_t i = 0; i < c->lobes; i++) {
        const pupil_veil_gaussian g = c->lobe[i];
        if (g.sigma > most_sigma || !(g.weight > 0.0))
            continue;
        /* A wide one is not within these taps, but nearly even: its peak is 1 / (2 pi sigma^2). */
        pupil_bloom_find_taps(g.sigma, FAR, tap);
        const double unit = g.sigma > 2.5 ? 0.15915494309189535 / (g.sigma * g.sigma * tap[0] * tap[0]) : 1.0;
        for (int y = 0; y < FAR; y++)
            for (int x = 0; x < FAR; x++)
                sum[y][x] += (float)(g.weight * unit * tap[y] * tap[x]);
        const double peak = g.weight * unit * tap[0] * tap[0];
        least = peak < least ? peak : least;
    }
    return least;
}

/* Normal equations of what the wide Gaussian and the coarse one are to be beyond 5 x 5: errors count as much as they
 * are of all light there is, and as much in each ring around the middle. */
typedef struct bloom_sums {
    double ww, wc, cc, wt, ct, tt;
} bloom_sums;

static __attribute__((noinline)) void add_sums(bloom_quarter target, bloom_quarter all, double least,
                                               const double *wide, const double *coarse, bloom_sums *s)
{
    const double grid = GRID * coarse[0] * coarse[0];
    for (int y = 0; y < FAR; y++)
        for (int x = y < NEAR ? NEAR : 0; x < FAR; x++) {
            const double there = (double)all[y][x], t = (double)target[y][x];
            const double by = (x && y ? 1.0 : 0.5) / ((x * x + y * y) * (there * there + least * least));
            const double w = y < WIDE && x < WIDE ? wide[y] * wide[x] : 0.0, c = coarse[y] * coarse[x];
            s->ww += by * w * w;
            s->wc += by * w * c;
            s->cc += by * (c * c + (x < WIDE && y < WIDE ? grid * grid : 0.0));
            s->wt += by * w * t;
            s->ct += by * c * t;
            s->tt += by * t * t;
        }
}

/* Returns what is left of the target. */
static __attribute__((noinline)) double solve_sums(const bloom_sums *s, double *wide, double *coarse)
{
    const double determinant = s->ww * s->cc - s->wc * s->wc;
    const int both = determinant > 1e-9 * s->ww * s->cc;
    *wide = both ? (s->wt * s->cc - s->ct * s->wc) / determinant : s->wt / s->ww;
    *coarse = both ? (s->ct * s->ww - s->wt * s->wc) / determinant : 0.0;
    return s->tt - *wide * s->wt - *coarse * s->ct;
}

/* The standard deviation of the wide Gaussian. */
static __attribute__((noinline)) double best_sigma(bloom_quarter target, bloom_quarter all, double least,
                                                   const double *coarse)
{
    double best = LEAST_SIGMA, smallest = 0.0, wide[WIDE], unused[2];
    for (int i = 0; i < STEPS; i++) {
        bloom_sums s = {0};
        pupil_bloom_find_taps(LEAST_SIGMA + SIGMA_STEP * i, WIDE, wide);
        add_sums(target, all, least, wide, coarse, &s);
        const double left = solve_sums(&s, &unused[0], &unused[1]);
        if (i && left >= smallest)
            continue;
        smallest = left;
        best = LEAST_SIGMA + SIGMA_STEP * i;
    }
    return best;
}

/* What is beyond 5 x 5: the taps of both Gaussians, and by how much each is taken. */
typedef struct far_fit {
    double wide[WIDE], coarse[FAR], by_wide, by_coarse;
} far_fit;

static __attribute__((noinline)) void fit_far(const pupil_bloom_config *config, bloom_quarter target,
                                              double coarse_sigma, far_fit *f)
{
    bloom_quarter all = {{0}};
    const double least = SHARE * add_lobes(config, 1e30, all);
    bloom_sums s = {0};
    pupil_bloom_find_taps(coarse_sigma, FAR, f->coarse);
    pupil_bloom_find_taps(best_sigma(target, all, least, f->coarse), WIDE, f->wide);
    add_sums(target, all, least, f->wide, f->coarse, &s);
    (void)solve_sums(&s, &f->by_wide, &f->by_coarse);
}

/* The 5 x 5 taps: what is left there. Returns the light of all of them. */
static double find_near(bloom_quarter target, const far_fit *f, float near[6])
{
    static const int place[6][2] = {{0, 0}, {0, 1}, {1, 1}, {0, 2}, {1, 2}, {2, 2}};
    static const double times[6] = {1.0, 4.0, 4.0, 4.0, 8.0, 4.0};
    double sum = 0.0;
    for (int k = 0; k < 6; k++) {
        const int y = place[k][0], x = place[k][1];
        const double far = f->by_wide * f->wide[y] * f->wide[x] + f->by_coarse * f->coarse[y] * f->coarse[x];
        near[k] = (float)((double)target[y][x] - far);
        sum += times[k] * (double)near[k];
    }
    return sum;
}

double pupil_bloom_fit(const pupil_bloom_config *config, double full_sigma, double coarse_sigma, pupil_bloom_taps *full)
{
    bloom_quarter target = {{0}};
    far_fit f = {0};
    double light = 0.0;
    (void)add_lobes(config, full_sigma, target);
    for (uint32_t i = 0; i < config->lobes; i++)
        light += config->lobe[i].sigma <= full_sigma ? config->lobe[i].weight : 0.0;
    if (coarse_sigma > 0.0)
        fit_far(config, target, coarse_sigma, &f);
    const double sum = find_near(target, &f, full->near) + f.by_wide + f.by_coarse;
    const double factor = sum > 0.0 ? light / sum : 0.0; /* light is moved and not made */
    for (int k = 0; k < WIDE; k++) {
        full->near[k] = (float)(factor * (double)full->near[k]);
        full->column[k] = (float)f.wide[k];
        full->row[k] = (float)(factor * f.by_wide * f.wide[k]);
    }
    return factor * f.by_coarse;
}

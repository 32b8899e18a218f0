/* A1 to A7: what the tables must show, regardless of the scene. They read only the tables and the two log-averages;
 * docs/study.md has the closed forms. */
#include "study.h"

#include <math.h>
#include <stdlib.h>

/* A line of cells has one formula, case and weight. */
#define FOR_EACH_RUN(f, c, w)                                                                                          \
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)                                                                      \
        for (unsigned c = 0; c < STUDY_CASES; c++)                                                                     \
            for (unsigned w = 0; w < STUDY_WEIGHTS; w++)

static void count(study_test *test, int holds)
{
    test->checked++;
    test->violations += !holds;
}

static int cut_off(unsigned frame)
{
    return frame >= STUDY_LAST;
}

/* Updates since the last change of light. */
static double updates(unsigned which_case, unsigned frame)
{
    return (double)frame - (double)study_start(which_case, STUDY_FPS);
}

static int floor_or_ceil(double n, double of)
{
    return n == floor(of) || n == ceil(of);
}

static double lambda_of(unsigned w)
{
    return -log1p(-study_weights[w]);
}

static void accept_at_once(study_test *test, const study_cells *cells)
{
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++)
            for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
                count(test, updates(c, cells->frame[f][c][STUDY_WEIGHTS - 1][t]) == 1.0);
}

void study_accept_order(study_test *test, const study_cells *cells)
{
    FOR_EACH_RUN(f, c, w)
    {
        for (unsigned t = 0; t + 1 < STUDY_THRESHOLDS; t++)
            count(test, cells->frame[f][c][w][t + 1] >= cells->frame[f][c][w][t]);
        for (unsigned t = 0; w && t < STUDY_THRESHOLDS; t++)
            count(test, cells->frame[f][c][w][t] <= cells->frame[f][c][w - 1][t]);
    }
}

void study_accept_equal(study_test *test, const study_cells *cells)
{
    for (unsigned c = 0; c < STUDY_CASES; c++)
        for (unsigned w = 0; w < STUDY_WEIGHTS; w++)
            for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
                count(test, cells->frame[2][c][w][t] == cells->frame[3][c][w][t]);
}

/* A flash of 30 frames makes the arrival later or earlier by the part of the way that 30 frames leave. */
static void accept_flash(study_test *test, const study_cells *cells)
{
    static const unsigned pair[2][2] = {{2, 1}, {3, 0}}; /* with a flash, without: the same final light */
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned p = 0; p < 2; p++)
            for (unsigned w = 0; w + 1 < STUDY_WEIGHTS; w++)
                for (unsigned t = 0; t < STUDY_THRESHOLDS; t++) {
                    const unsigned with = cells->frame[f][pair[p][0]][w][t],
                                   without = cells->frame[f][pair[p][1]][w][t];
                    double n = updates(pair[p][0], with), m = updates(pair[p][1], without), lambda = lambda_of(w);
                    if (n >= 2.0 && m >= 2.0 && !cut_off(with) && !cut_off(without))
                        count(test, floor_or_ceil(n - m, log(-expm1(-(double)STUDY_FPS * lambda)) / lambda));
                }
}

/* --- one number a final light and threshold --- */

typedef struct span {
    double from, to; /* the u* that explain a cell: from <= u* < to */
} span;

#define MOST_SPANS (STUDY_FORMULAS * 2 * (STUDY_WEIGHTS - 1))

/* The largest number of spans that share a value. It is enough to test where spans begin. */
static unsigned most_common(const span *s, unsigned n)
{
    unsigned best = 0;
    for (unsigned i = 0; i < n; i++) {
        unsigned holding = 0;
        for (unsigned k = 0; k < n; k++)
            holding += s[k].from <= s[i].from && s[i].from < s[k].to;
        best = holding > best ? holding : best;
    }
    return best;
}

void study_accept_one_number(study_test *test, const study_cells *cells, double ln_r)
{
    for (int light = 0; light < 2; light++)
        for (unsigned t = 0; t < STUDY_THRESHOLDS; t++) {
            span s[MOST_SPANS];
            unsigned n = 0;
            FOR_EACH_RUN(f, c, w)
            {
                if (study_final(c) != light || w + 1 == STUDY_WEIGHTS || cut_off(cells->frame[f][c][w][t]))
                    continue;
                const double weight = study_weights[w], after = updates(c, cells->frame[f][c][w][t]);
                s[n].from = fabs(study_closed_u(f, c, weight, ln_r, after));
                s[n++].to = fabs(study_closed_u(f, c, weight, ln_r, after - 1.0));
            }
            test->checked += n;
            test->violations += n - most_common(s, n);
        }
}

/* --- against the u* of the renderer --- */

static void accept_asymmetry(study_test *test, const study_cells *cells, double ln_r)
{
    for (unsigned c = 0; c < STUDY_CASES; c++)
        for (unsigned w = 0; w + 1 < STUDY_WEIGHTS; w++)
            for (unsigned t = 0; t < STUDY_THRESHOLDS; t++) {
                const unsigned slow = cells->frame[study_final(c) ? 0 : 1][c][w][t],
                               fast = cells->frame[study_final(c) ? 1 : 0][c][w][t];
                if (!cut_off(slow) && !cut_off(fast))
                    count(test, floor_or_ceil((double)slow - (double)fast,
                                              (ln_r - cells->u_star[study_final(c)][t]) / lambda_of(w)));
            }
}

static void accept_closed_form(study_test *test, const study_cells *cells, double ln_r)
{
    FOR_EACH_RUN(f, c, w)
    for (unsigned t = 0; t < STUDY_THRESHOLDS; t++) {
        const double weight = study_weights[w], star = cells->u_star[study_final(c)][t];
        const double n = updates(c, cells->frame[f][c][w][t]), said = study_closed_n(f, c, weight, ln_r, star);
        if (cut_off(cells->frame[f][c][w][t]))
            continue;
        count(test, n == said);
    }
}

void study_accept_cells(study_test tests[STUDY_TESTS], const study_cells *cells, double ln_r)
{
    static const char *const text[STUDY_TESTS] = {
        "w = 1 arrives in the first frame after the change",
        "never sooner for a smaller threshold, never later for a larger w",
        "formula 3 and formula 4 agree in every cell",
        "cases 3 and 4 differ from 2 and 1 by floor or ceil of ln(1 - q^30) / lambda",
        "one u* for each final light and threshold explains all cells",
        "formulas 1 and 2 differ by floor or ceil of (ln r - u*) / lambda",
        "with u* bisected from pictures the closed form gives every cell",
        "u, except for its sign: F1c1 = F2c2, F1c2 = F2c1, F1c3 = F2c4, F1c4 = F2c3, F3 = F4, within 1e-13",
        "the state becomes bit-equal to its target for every w",
        "all light and the floor times 2^k: no cell changes",
        "the same tau at 24, 30, 60, 120, 240 fps: the same time within one dt",
    };
    static const char *const name[STUDY_TESTS] = {"A1", "A2", "A3", "A4", "A5", "A6", "A7", "A8", "A9", "A10", "A11"};
    for (unsigned i = 0; i < STUDY_TESTS; i++)
        tests[i] = (study_test){.name = name[i], .text = text[i]};
    accept_at_once(&tests[0], cells);
    study_accept_order(&tests[1], cells);
    study_accept_equal(&tests[2], cells);
    accept_flash(&tests[3], cells);
    study_accept_one_number(&tests[4], cells, ln_r);
    accept_asymmetry(&tests[5], cells, ln_r);
    accept_closed_form(&tests[6], cells, ln_r);
}

void study_accept_scaled(study_test *test, const study_cells *cells, const study_cells *scaled)
{
    FOR_EACH_RUN(f, c, w)
    for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
        count(test, cells->frame[f][c][w][t] == scaled->frame[f][c][w][t]);
}

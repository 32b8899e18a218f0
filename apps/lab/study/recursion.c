/* The state over time. It depends only on the two log-averages, so no picture is needed. */
#include "study.h"

#include <math.h>

const double study_weights[STUDY_WEIGHTS] = {0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09,
                                             0.1,   0.2,  0.3,  0.4,  0.5,  0.6,  0.7,  0.8,  0.9,  1.0};

static unsigned phase_of(unsigned fps, uint32_t frame)
{
    return frame <= fps ? 0 : frame <= 2 * fps ? 1 : 2;
}

int study_light_of(unsigned which_case, unsigned fps, uint32_t frame)
{
    static const int light[STUDY_CASES][3] = {{0, 1, 1}, {1, 0, 0}, {0, 1, 0}, {1, 0, 1}};
    return light[which_case][phase_of(fps, frame)];
}

uint32_t study_start(unsigned which_case, unsigned fps)
{
    return which_case < 2 ? fps : 2 * fps;
}

/* --- by the library --- */

int study_run_library(const study_lights *lights, const study_run *run, double *u)
{
    static const uint32_t law[] = {PUPIL_LAW_ARITHMETIC_SCALE, PUPIL_LAW_ARITHMETIC_LUMINANCE,
                                   PUPIL_LAW_GEOMETRIC_SCALE, PUPIL_LAW_GEOMETRIC_LUMINANCE, PUPIL_LAW_SECONDS};
    pupil_config config = lights->config;
    pupil_t pupil;
    config.law = law[run->formula];
    config.frame_weight = run->weight;
    config.nominal_frame_s = 1.0 / (double)run->fps;
    /* w = 1 - exp(-dt / tau); at once where w is 1 */
    config.tau_light_s = config.tau_dark_s = run->weight < 1.0 ? config.nominal_frame_s / -log1p(-run->weight) : 0.0;

    const double target_ev = lights->ev[study_final(run->which_case)];
    int error = pupil_init(&pupil, &config);
    for (uint32_t i = 0; !error && i < run->frames; i++) {
        pupil_exposure exposure;
        error = pupil_adapt(&pupil, &lights->stats[study_light_of(run->which_case, run->fps, i)], NULL);
        if (!error)
            error = pupil_get_exposure(&pupil, &exposure);
        if (!error)
            u[i] = (target_ev - exposure.adapted_ev) * M_LN2; /* X is key / L */
    }
    return error;
}

/* --- as in the original study --- */

static const float key = 0.18f;

/* The quantity that a formula averages, of a luminance. */
static float averaged(unsigned formula, float luminance)
{
    return formula == 0 || formula == 2 ? key / luminance : luminance;
}

static float average(unsigned formula, float w, float now, float before)
{
    if (formula < 2)
        return w * now + (1.0f - w) * before;
    return expf(w * logf(now) + (1.0f - w) * logf(before));
}

/* The exposure scale that the original study hands to its shader, a float. */
static float scale_of(unsigned formula, float state)
{
    return formula == 0 || formula == 2 ? state : key / state;
}

void study_run_float32(const float luminance[3], const study_run *run, double *u)
{
    const unsigned formula = run->formula;
    const float w = (float)run->weight;
    float state = averaged(formula, luminance[0]);
    for (uint32_t i = 0; i < run->frames; i++) {
        float now = averaged(formula, luminance[phase_of(run->fps, i)]);
        if (i)
            state = average(formula, w, now, state);
        u[i] = (double)scale_of(formula, state);
    }
    /* From the float scales of the state and of the last light: this reproduces the original tables best. With the end
     * of the run of weight 1 instead, expf(logf(x)) in formulas 3 and 4, 16 cells fewer are exact. */
    const double end = (double)scale_of(formula, averaged(formula, luminance[2]));
    for (uint32_t i = 0; i < run->frames; i++)
        u[i] = log(u[i] / end);
}

/* --- all runs --- */

int study_run_any(const study_lights *lights, const study_run *run, int float32, double *u)
{
    if (!float32)
        return study_run_library(lights, run, u);
    float luminance[3];
    for (unsigned phase = 0; phase < 3; phase++) {
        uint32_t within = phase ? phase * run->fps + 1 : 0;
        luminance[phase] = (float)exp2(lights->ev[study_light_of(run->which_case, run->fps, within)]);
    }
    study_run_float32(luminance, run, u);
    return PUPIL_OK;
}

int study_states_make(study_states *states, const study_lights *lights, int float32)
{
    int error = PUPIL_OK;
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++)
            for (unsigned w = 0; w < STUDY_WEIGHTS; w++) {
                study_run run = {f, c, study_weights[w], STUDY_FPS, STUDY_FRAMES};
                if (!error)
                    error = study_run_any(lights, &run, float32, states->u[f][c][w]);
            }
    return error;
}

/* --- the closed form --- */

/* ln of the share of the way that is left at the last change: all of it, or what 30 frames went the other way. */
static double way(unsigned which_case, double lambda)
{
    return which_case < 2 ? 0.0 : log(-expm1(-(double)STUDY_FPS * lambda));
}

/* Formulas 1 and 2 differ in the end of the light that they approach slowly: the arithmetic average arrives late at a
 * value that falls by r, early at one that rises. */
static int falls(unsigned formula, unsigned which_case)
{
    return (formula == 0) == study_final(which_case);
}

double study_closed_u(unsigned formula, unsigned which_case, double weight, double ln_r, double n)
{
    const double lambda = -log1p(-weight), left = exp(way(which_case, lambda) - n * lambda);
    if (formula >= 2)
        return ln_r * left;
    return falls(formula, which_case) ? log1p(expm1(ln_r) * left) : -log1p(expm1(-ln_r) * left);
}

double study_closed_n(unsigned formula, unsigned which_case, double weight, double ln_r, double u_star)
{
    if (weight >= 1.0)
        return 1.0;
    const double lambda = -log1p(-weight);
    double ratio; /* ln(A / B) without G */
    if (formula >= 2)
        ratio = log(ln_r / u_star);
    else if (falls(formula, which_case))
        ratio = log(expm1(ln_r) / expm1(u_star));
    else
        ratio = log(expm1(-ln_r) / expm1(-u_star));
    double n = ceil((ratio + way(which_case, lambda)) / lambda);
    return n > 1.0 ? n : 1.0;
}

/* A8, A9 and A11: what the state itself must do; no picture is needed except for the u* that A11 waits for. */
#include "study.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

static void count(study_test *test, int holds)
{
    test->checked++;
    test->violations += !holds;
}

/* --- A8 --- */

static void accept_mirror(study_test *test, const study_states *states)
{
    /* One formula in one case mirrors another formula in another case: {formula, case, formula, case}. */
    static const unsigned pair[][4] = {{0, 0, 1, 1}, {0, 1, 1, 0}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                       {2, 0, 3, 0}, {2, 1, 3, 1}, {2, 2, 3, 2}, {2, 3, 3, 3}};
    for (size_t p = 0; p < sizeof pair / sizeof pair[0]; p++)
        for (unsigned w = 0; w < STUDY_WEIGHTS; w++) {
            const double *a = states->u[pair[p][0]][pair[p][1]][w], *b = states->u[pair[p][2]][pair[p][3]][w];
            double worst = 0.0;
            for (unsigned i = 0; i < STUDY_FRAMES; i++)
                worst = fmax(worst, fabs(fabs(a[i]) - fabs(b[i])));
            count(test, worst <= 1e-13);
        }
}

/* --- A9 --- */

/* Enough frames: twice 55 bits of way at ln 2 / lambda frames a bit, and some hundred of the smallest step. */
static uint32_t long_run(double weight)
{
    return (uint32_t)(2.0 * 55.0 * M_LN2 / (weight < 1.0 ? -log1p(-weight) : 1.0)) + 1000;
}

static int accept_arrival(study_test *test, const study_lights *lights, study_run run, int float32, double *u)
{
    run.fps = STUDY_FPS;
    run.frames = long_run(run.weight);
    int error = study_run_any(lights, &run, float32, u);
    count(test, !error && u[run.frames - 1] == 0.0); /* a difference of doubles is 0 only where they are equal */
    return error;
}

/* --- A11 --- */

static const unsigned rates[] = {24, 30, 60, 120, 240};
#define RATES       (sizeof rates / sizeof rates[0])
#define LONGEST_S   400u /* wait_s() of the slowest tau, 6.65 s, and the strongest lamp, 2^20 */
#define MOST_FRAMES (LONGEST_S * 240u)

/* Seconds after which every formula is within every u*: the slowest needs ln(r / u*) times tau. */
static double wait_s(const study_cells *cells, double ln_r, int light, double tau_s)
{
    double least = 1.0;
    for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
        least = fmin(least, cells->u_star[light][t]);
    return fmin(3.0 + tau_s * (ln_r + 1.0 - log(fmax(least, 1e-13))), LONGEST_S);
}

/* Seconds from the last change until |u| <= u_star; negative: never. */
static double arrival_s(const double *u, const study_run *run, double u_star)
{
    const uint32_t start = study_start(run->which_case, run->fps);
    for (uint32_t i = start + 1; i < run->frames; i++)
        if (fabs(u[i]) <= u_star)
            return (double)(i - start) / (double)run->fps;
    return -1.0;
}

/* Whether arrivals differ by no more than one dt. */
static int agree(const double seconds[RATES])
{
    for (size_t a = 0; a < RATES; a++)
        for (size_t b = 0; b < a; b++) {
            double dt = 1.0 / (double)(rates[a] < rates[b] ? rates[a] : rates[b]);
            if (seconds[a] < 0.0 || seconds[b] < 0.0 || fabs(seconds[a] - seconds[b]) > dt * (1.0 + 1e-9))
                return 0;
        }
    return 1;
}

static int accept_rates(study_test *test, const study_cells *cells, const study_lights *lights, study_run run,
                        int float32, double *u)
{
    const double tau_s = run.weight < 1.0 ? -1.0 / (STUDY_FPS * log1p(-run.weight)) : 0.0;
    const double ln_r = (lights->ev[1] - lights->ev[0]) * M_LN2;
    const double until_s = wait_s(cells, ln_r, study_final(run.which_case), tau_s);
    double seconds[STUDY_THRESHOLDS][RATES];
    for (size_t r = 0; r < RATES; r++) {
        run.fps = rates[r];
        run.weight = tau_s > 0.0 ? -expm1(-1.0 / (run.fps * tau_s)) : 1.0;
        run.frames = (uint32_t)(until_s * run.fps);
        int error = study_run_any(lights, &run, float32 && run.formula < STUDY_FORMULAS, u);
        if (error)
            return error;
        for (unsigned t = 0; t < STUDY_THRESHOLDS; t++) {
            const double star = cells->u_star[study_final(run.which_case)][t];
            seconds[t][r] = arrival_s(u, &run, star);
        }
    }
    for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
        count(test, agree(seconds[t]));
    return PUPIL_OK;
}

/* --- both, on all workers --- */

typedef struct job {
    const study_cells *cells;
    const study_lights *lights;
    int float32;
    study_test *arrival, *rates;
    pthread_mutex_t lock;
    unsigned next;
    int error;
} job;

static void work(void *context, unsigned worker, unsigned count_of_workers)
{
    job *j = context;
    study_test arrival = {0}, by_rate = {0};
    double *u = malloc(MOST_FRAMES * sizeof *u);
    int error = u ? PUPIL_OK : PUPIL_ERR_NULL;
    (void)worker;
    (void)count_of_workers;
    while (!error) {
        pthread_mutex_lock(&j->lock);
        unsigned item = j->next++;
        pthread_mutex_unlock(&j->lock);
        /* the four formulas, and the library's own law in seconds; the slowest weights first */
        study_run run = {.formula = item % (STUDY_FORMULAS + 1),
                         .which_case = item / (STUDY_FORMULAS + 1) % STUDY_CASES};
        unsigned w = item / (STUDY_FORMULAS + 1) / STUDY_CASES;
        if (w >= STUDY_WEIGHTS)
            break;
        run.weight = study_weights[w];
        if (run.formula < STUDY_FORMULAS)
            error = accept_arrival(&arrival, j->lights, run, j->float32, u);
        if (!error)
            error = accept_rates(&by_rate, j->cells, j->lights, run, j->float32, u);
    }
    free(u);
    pthread_mutex_lock(&j->lock);
    j->error = error ? error : j->error;
    j->arrival->checked += arrival.checked;
    j->arrival->violations += arrival.violations;
    j->rates->checked += by_rate.checked;
    j->rates->violations += by_rate.violations;
    pthread_mutex_unlock(&j->lock);
}

int study_accept_states(study_test tests[STUDY_TESTS], const study_cells *cells, const study_lights *lights,
                        const study_states *states, int float32, workers *team)
{
    job j = {cells, lights, float32, &tests[8], &tests[10], PTHREAD_MUTEX_INITIALIZER, 0, PUPIL_OK};
    accept_mirror(&tests[7], states);
    workers_run(team, work, &j);
    pthread_mutex_destroy(&j.lock);
    return j.error;
}

/* The tables: the frame at which each run first is near enough to its target, found by bisection instead of rendering
 * every frame. */
#include "study.h"

#include <math.h>
#include <stdatomic.h>

/* The largest |u| whose picture is within the threshold, on the side that runs come from. The exponent of |u| is
 * bisected until no double is between. */
static double bisect(study_target *target, int light, uint64_t threshold)
{
    const double side = light ? 1.0 : -1.0; /* in a scene that has become bright the state starts too bright */
    double inside = 0.0, outside = 1.0;
    while (study_distance(target, side * outside, threshold) <= threshold && outside < 64.0)
        outside *= 2.0;
    for (;;) {
        double middle = inside > 0.0 ? sqrt(inside * outside) : outside * 0x1p-4;
        if (!(middle > inside && middle < outside) || outside < 1e-15)
            return inside;
        if (study_distance(target, side * middle, threshold) <= threshold)
            inside = middle;
        else
            outside = middle;
    }
}

static int arrived(study_target *target, double u, uint64_t threshold)
{
    return study_distance(target, u, threshold) <= threshold;
}

/* The first frame from `from` on whose picture is within the threshold, else the last. u* only says where to look; the
 * pictures decide: the found frame is within, the one before it is not. */
static uint16_t first_frame(study_target *target, const double *u, uint32_t from, uint64_t threshold, double u_star)
{
    uint32_t i = from;
    while (i < STUDY_LAST && !(fabs(u[i]) <= u_star))
        i++;
    while (i > from && arrived(target, u[i - 1], threshold))
        i--;
    while (i < STUDY_LAST && !arrived(target, u[i], threshold))
        i++;
    return (uint16_t)i;
}

/* Everything that the workers share. First the u* are found, then the runs' cells; a free thread takes one at a
 * time. */
typedef struct job {
    study_cells *cells;
    study_target *targets;
    const study_states *states; /* NULL while the u* are sought */
    study_progress *progress;
    void *context;
    atomic_uint next, done;
    atomic_int stopped;
} job;

#define STARS (2 * STUDY_THRESHOLDS)
#define RUNS  (STUDY_FORMULAS * STUDY_CASES * STUDY_WEIGHTS)

static void find_star(job *j, unsigned item)
{
    const unsigned light = item / STUDY_THRESHOLDS, t = item % STUDY_THRESHOLDS;
    j->cells->u_star[light][t] = bisect(&j->targets[light], (int)light, j->cells->threshold[t]);
}

static void find_cells(job *j, unsigned item)
{
    const unsigned w = item % STUDY_WEIGHTS, c = item / STUDY_WEIGHTS % STUDY_CASES,
                   f = item / STUDY_WEIGHTS / STUDY_CASES;
    const int light = study_final(c);
    for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
        j->cells->frame[f][c][w][t] =
            first_frame(&j->targets[light], j->states->u[f][c][w], study_start(c, STUDY_FPS) + 1,
                        j->cells->threshold[t], j->cells->u_star[light][t]);
}

static void work(void *context, unsigned worker, unsigned count)
{
    job *j = context;
    const unsigned items = j->states ? RUNS : STARS;
    unsigned item;
    (void)count;
    while (!j->stopped && (item = atomic_fetch_add(&j->next, 1)) < items) {
        if (j->states)
            find_cells(j, item);
        else
            find_star(j, item);
        unsigned done = atomic_fetch_add(&j->done, 1) + 1;
        if (worker == 0 && j->progress && j->progress(j->context, done, STARS + RUNS))
            j->stopped = 1;
    }
}

int study_cells_make(study_cells *cells, const study_images *images, study_target targets[2],
                     const study_states *states, workers *team, study_progress *progress, void *context)
{
    job j = {.cells = cells, .targets = targets, .progress = progress, .context = context};
    cells->width = images->width;
    cells->height = images->height;
    cells->threshold[0] = (uint64_t)images->width * images->height;
    cells->threshold[1] = 600;
    cells->threshold[2] = 60;
    cells->threshold[3] = 0;
    workers_run(team, work, &j);
    j.states = states;
    j.next = 0;
    workers_run(team, work, &j);
    return j.stopped ? -1 : 0;
}

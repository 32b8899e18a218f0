/* drivers/synth/spread.h: many small jobs over a few threads, which live as long as the jobs. */
#ifndef PUPIL_DRIVERS_SYNTH_SPREAD_H
#define PUPIL_DRIVERS_SYNTH_SPREAD_H

#include <stddef.h>

typedef struct pupil_spread {
    unsigned threads;  /* the caller among them; 0: one for each processor */
    int (*stop)(void); /* nonzero: the jobs not yet begun are left out; may be NULL */
} pupil_spread;

/* Runs job(context, i) for each i below count, in any order, and returns when all are done. `spread` is a pupil_spread.
 * If the system gives fewer threads, these do all jobs. */
void pupil_spread_run(void *spread, void (*job)(void *context, size_t i), void *context, size_t count);

#endif

/* apps/frame/workers.h: a fixed set of threads that do one job at a time together. */
#ifndef PUPIL_APPS_FRAME_WORKERS_H
#define PUPIL_APPS_FRAME_WORKERS_H

#include <stddef.h>

typedef struct workers workers;

/* What each worker runs: its number, and how many there are. */
typedef void worker_job(void *context, unsigned worker, unsigned count);

/* `count` workers, among them the caller, or fewer if the system gives fewer threads; 0: one for each processor. NULL:
 * not enough memory. */
workers *workers_open(unsigned count);
unsigned workers_count(const workers *w);

/* Runs the job on every worker and returns when all are done. */
void workers_run(workers *w, worker_job *job, void *context);
void workers_close(workers *w);

#endif

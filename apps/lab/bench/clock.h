/* apps/lab/bench/clock.h: times things in turns in one run, so that a slow phase of the machine slows all of them and
 * their ratios stay. */
#ifndef PUPIL_APPS_LAB_BENCH_CLOCK_H
#define PUPIL_APPS_LAB_BENCH_CLOCK_H

#include <stddef.h>

typedef struct bench_runner {
    void (*run)(void *context);
    void *context;
    double median_s, least_s;       /* of the rounds, once raced */
    double p99_s, p999_s, most_s;   /* quantiles of the times: 99 %, 99.9 %, all */
    void (*prepare)(void *context); /* called before each run, not timed; NULL: nothing */
} bench_runner;

/* A block of memory larger than the caches, read and written before each cold run. */
typedef struct bench_flush {
    unsigned char *block;
    size_t bytes;
} bench_flush;

/* 0; -1: not enough memory. */
int bench_flush_open(bench_flush *flush);
void bench_flush_close(bench_flush *flush);

/* Runs each runner `rounds` times, in turns. With a flush before each run (cold), or (NULL) with what earlier turns
 * left in the caches. `stop` may be NULL. 0; -1: it said stop, or not enough memory. */
int bench_race(bench_runner *runner, size_t runners, unsigned rounds, const bench_flush *flush, int (*stop)(void));

/* A plain pass that reads each byte once (a whole number of 64, aligned to 16) and does nothing else that takes time: a
 * lower bound for metering as many bytes. Returns a value, so that the compiler cannot drop the pass. */
unsigned long long bench_read(const void *data, size_t bytes);

#endif

/* apps/lab/bench/subject.h: what every benchmark of kernels runs: a frame with its outputs, pupil's kernels on it at a
 * level, and the plain read and the memcpy of the same bytes. */
#ifndef PUPIL_APPS_LAB_BENCH_SUBJECT_H
#define PUPIL_APPS_LAB_BENCH_SUBJECT_H

#include "clock.h"
#include "frame/workers.h"
#include "frames.h"
#include "pupil/pupil.h"
#include "report/verify.h"

enum { BENCH_MOST_THREADS = 64, BENCH_LEAST_LAMPS_PX = 64 /* as row_gain.h has it */ };

typedef struct bench_out { /* what frames are mapped to */
    const char *name;
    uint32_t pixel;
    uint32_t step; /* 2: a mosaic, to half its width and height */
} bench_out;

extern const bench_out bench_outs[]; /* ended by a NULL name; the first is the usual one */

typedef struct bench_options {
    const char *format; /* NULL: all */
    uint32_t light;     /* a pupil_light, of that format's coding; PUPIL_LIGHT_DEFAULT: the usual */
    const bench_out *out;
    const char *plot; /* a file, or NULL */
    uint32_t width, height;
    unsigned threads;
    unsigned rounds; /* 0: as many as the measurement needs */
    int peers, worst, row_gains, warm, overwrite, json, quiet;
} bench_options;

typedef enum bench_which {
    BENCH_METER = 0,
    BENCH_MAP,
    BENCH_FUSED,       /* both in one pass */
    BENCH_EXACT,       /* both, one after the other, without a histogram */
    BENCH_CONFIG,      /* what pupil_config_default gives: exact, with the histogram that a white point which follows
                        * needs */
    BENCH_WHITE,       /* fused, with that histogram */
    BENCH_WHITE_EVERY, /* the same of every pixel: histogram_step = 1 */
    BENCH_CURVE,       /* fused, by a table of knots: PUPIL_CURVE_ADJUST */
    BENCH_LUMA,        /* 8-bit Y'CbCr: fused+white by PUPIL_ACCURACY_LUMA */
    BENCH_KERNELS
} bench_which;

extern const char *const bench_kernel_names[BENCH_KERNELS];
extern const char *const bench_level_names[PUPIL_LEVEL_COUNT];

typedef struct bench_subject { /* what all of a format's runners share */
    workers *crew;
    pupil_image_const in;
    pupil_coding coding; /* of `in`, if its light is not the usual */
    pupil_image out;
    unsigned char *copy; /* as large as `in` */
    size_t bytes;        /* of all its planes, which are contiguous */
    unsigned long long seen;
    pupil_curve curve;
} bench_subject;

typedef struct bench_kernel {
    bench_subject *s;
    bench_which which;
    uint32_t level;
    const float *gain; /* of the frame's rows, for BENCH_MAP; NULL: none */
    pupil_t pupil;
    pupil_curve curve;                     /* the subject's, or what BENCH_CURVE makes of its frame */
    pupil_stats stats[BENCH_MOST_THREADS]; /* one a worker */
} bench_kernel;

/* The easy frame of a format, with room for options.out; 0, or -1 and a sentence on stderr. Closing takes what a failed
 * opening left. */
int bench_subject_open(bench_subject *s, const bench_options *o, uint32_t pixel, workers *crew);
void bench_subject_close(bench_subject *s);

/* -1: this CPU or this build has no such level. */
int bench_kernel_open(bench_kernel *k, bench_subject *s, bench_which which, uint32_t level);

/* The level that pupil chooses by itself here. */
uint32_t bench_best_level(void);

/* To be raced: the context of the first is a bench_kernel, of the others the bench_subject. */
void bench_kernel_run(void *context);
void bench_read_run(void *context);
void bench_copy_run(void *context);

/* The errors of a level on a frame like the timed one, or on a hard one; small, because the reference is slow. The
 * output is RGB8, at half the size if `step` is 2. light: as in the options. */
int bench_kernel_error(uint32_t level, uint32_t pixel, uint32_t light, uint32_t step, int hard,
                       verify_figures *figures);

/* Whether bench_levels measures a format: the named one, or each that can have the named output. */
int bench_is_measured(const bench_options *o, const bench_format *f);

/* What the modes of `pupil bench kernels` do; the exit status. */
int bench_levels(const bench_options *o, workers *crew, const bench_flush *flush);
int bench_peers(const bench_options *o, workers *crew, const bench_flush *flush);
int bench_worst(const bench_options *o, workers *crew);
int bench_plot(const bench_options *o, workers *crew, const bench_flush *flush);
int bench_lamps(const bench_options *o, workers *crew, const bench_flush *flush);

enum { BENCH_DONE = 0, BENCH_FAILED = 1, BENCH_USAGE = 2, BENCH_INTERRUPTED = 130 };

#endif

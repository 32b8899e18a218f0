/* apps/output/outputs.h: every display output of a run as one: all complete, or none. */
#ifndef PUPIL_APPS_OUTPUT_OUTPUTS_H
#define PUPIL_APPS_OUTPUT_OUTPUTS_H

#include "pupil/error.h"
#include "sink.h"
#include "v4l2/system.h"

#define OUTPUTS_MOST 17 /* those of the command line, and the video of a report */

typedef struct outputs {
    const pupil_v4l2_system *system; /* of output nodes; NULL: the kernel */
    pupil_sink *sink[OUTPUTS_MOST];
    const char *path[OUTPUTS_MOST]; /* the caller's */
    size_t count;
    size_t failed; /* which one, after a write or finish that failed */
} outputs;

int outputs_open(outputs *o, const char *path, const pupil_sink_options *options, pupil_why *why);
int outputs_write(outputs *o, const pupil_image_const *rgb8, const pupil_frame_info *info, pupil_why *why);

/* Finishes all. If one fails, those that follow are discarded; those before it are complete. */
/* The failed one is discarded; the others go on. */
void outputs_drop(outputs *o);
/* 1: it was standard output, and whoever read it is gone. */
int outputs_reader_gone(const outputs *o);

int outputs_finish(outputs *o, pupil_why *why);
void outputs_discard(outputs *o);

#endif

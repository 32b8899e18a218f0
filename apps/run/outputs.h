/* apps/run/outputs.h: everything that a run leaves: pictures, statistics, a plot, a recording. */
#ifndef PUPIL_APPS_RUN_OUTPUTS_H
#define PUPIL_APPS_RUN_OUTPUTS_H

#include "file/recording/recording.h"
#include "options.h"
#include "output/frame_log.h"
#include "output/outputs.h"
#include "output/stats_file.h"
#include "pupil/error.h"

typedef struct run_outputs {
    frame_options *options;
    pupil_source *source;
    const char *device;
    int is_open;
    uint64_t frames;        /* written to all */
    uint32_t width, height; /* of the pictures */
    outputs pictures;
    pupil_stats_file *stats_file;
    pupil_recorder *recorder;
    uint64_t not_recorded; /* the disk was too slow */
    frame_log log;         /* for the plot */
} run_outputs;

/* Of a live source, which `device` names in sentences. What is pointed at is kept by the caller. */
void run_outputs_begin(run_outputs *o, frame_options *options, pupil_source *source, const char *device);

/* A frame as it came, into the recording; the first one opens everything. 0, or -1 and a sentence. */
int run_outputs_take(run_outputs *o, const pupil_frame *frame, pupil_why *why);

/* What is shown of it; into the record goes how long it took. 0, or -1 and a sentence: an output that fails ends the
 * run, the others are kept. 1: so does a reader who has seen enough, or Ctrl-C, which is no failure. */
int run_outputs_write(run_outputs *o, const pupil_frame *frame, const pupil_image_const *display,
                      frame_log_entry *record, pupil_why *why);

/* All that has been written becomes complete, whatever ended the run; a second Ctrl-C leaves out what is to come. 0, or
 * -1 and the first sentence of those that cannot. Afterwards the options name what is there: not what failed, nor, of a
 * run that ended in its first frame, anything but the recording. */
int run_outputs_finish(run_outputs *o, pupil_why *why);

/* What is not finished is not there. */
void run_outputs_discard(run_outputs *o);

#endif

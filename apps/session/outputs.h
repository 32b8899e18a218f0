/* apps/session/outputs.h: everything that a run of frames leaves: pictures, statistics, a plot, a report, a recording.
 *
 * Of files they are all complete, or none is there; after Ctrl-C they hold the frames until then, and plot and report
 * are not there. Of a live camera (`live`) a frame does not come twice: what has
 * been written becomes complete in any case, and an output that fails takes no other with it.
 */
#ifndef PUPIL_APPS_SESSION_OUTPUTS_H
#define PUPIL_APPS_SESSION_OUTPUTS_H

#include "file/recording/recording.h"
#include "frame/pipeline.h"
#include "options/frame_options.h"
#include "output/frame_log.h"
#include "output/pictures.h"
#include "output/stats_file.h"
#include "report/replay_report.h"

typedef struct session_outputs {
    frame_options *options;
    const pupil_source *source;
    int live;
    int is_open;
    int is_cut;             /* by Ctrl-C */
    int held_sound;         /* the sound is left out, for --hold changes the pace */
    uint64_t frames;        /* written to all */
    uint32_t width, height; /* of the pictures */
    pictures pictures;
    pupil_stats_file *stats_file;
    pupil_recorder *recorder;
    uint64_t not_recorded; /* the disk was too slow */
    replay_report *report;
    frame_log log;     /* for the plot and the report */
    size_t finished;   /* outputs that are in their places */
    char summary[512]; /* the figures that the report found */
} session_outputs;

/* What is pointed at is kept by the caller. `live`: the source is one of live/live.h. */
void session_outputs_begin(session_outputs *o, frame_options *options, const pupil_source *source, int live);

/* Whether each path names a kind of output: 0, or -1 and a sentence. Nothing is opened. */
int session_outputs_check_kinds(const frame_options *options, pupil_why *why);

/* Whether anything is asked for that needs all pixels of the display frames; whether their figures are asked for. */
int session_outputs_want_pixels(const frame_options *options);
int session_outputs_want_figures(const frame_options *options);

/* A frame that was mapped, its picture, and its entry, which takes how long writing took. The first one opens
 * everything. 0; -1 and a sentence. 1, of a live run: a reader who has seen enough, or Ctrl-C, ends it here, which is
 * no failure. */
int session_outputs_write(session_outputs *o, const pupil_frame *frame, const frame_pipeline *p,
                          const pupil_image *shown, frame_log_entry *entry, pupil_why *why);

/* At the end, also of a run that never began: 0, or -1 and the first sentence of those outputs that cannot be
 * completed. A second Ctrl-C leaves out those that are to come. Of a live run, and after Ctrl-C, the options name what
 * is there afterwards: not what failed, nor, where a live one ended in its first frame, anything but the recording. */
int session_outputs_finish(session_outputs *o, pupil_why *why);

/* What is not finished is not there. */
void session_outputs_discard(session_outputs *o);

/* "; PATH" of each, to standard error. */
void session_outputs_name(const session_outputs *o);

#endif

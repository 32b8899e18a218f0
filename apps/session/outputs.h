/* apps/session/outputs.h: everything that a run of frames leaves: pictures, statistics, a plot, a report, a recording.
 *
 * For files all outputs are complete, or none exists; after Ctrl-C they hold the frames until then, without plot and
 * report. Frames of a live camera (`live`) do not come twice: what was written is always completed, and an output that
 * fails does not affect the others.
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
    int held_sound;         /* the sound is left out, because --hold changes the pace */
    uint64_t frames;        /* written to all outputs */
    uint32_t width, height; /* of the pictures */
    pictures pictures;
    pupil_stats_file *stats_file;
    pupil_recorder *recorder;
    uint64_t not_recorded; /* the disk was too slow */
    replay_report *report;
    frame_log log;     /* for the plot and the report */
    size_t finished;   /* outputs that are complete */
    char summary[512]; /* the figures that the report found */
} session_outputs;

/* The caller keeps what the arguments point to. `live`: the source is one of live/live.h. */
void session_outputs_begin(session_outputs *o, frame_options *options, const pupil_source *source, int live);

/* Whether each path names a kind of output: 0, or -1 and a sentence. Nothing is opened. */
int session_outputs_check_kinds(const frame_options *options, pupil_why *why);

/* Whether any output needs all pixels of the display frames; whether one needs their figures. */
int session_outputs_want_pixels(const frame_options *options);
int session_outputs_want_figures(const frame_options *options);

/* Writes a mapped frame, its picture and its entry, to which the time of writing is added. The first frame opens
 * everything. 0; -1 and a sentence. 1, of a live run: the reader has gone, or Ctrl-C came, which ends the run without a
 * failure. */
int session_outputs_write(session_outputs *o, const pupil_frame *frame, const frame_pipeline *p,
                          const pupil_image *shown, frame_log_entry *entry, pupil_why *why);

/* At the end, also of a run that never began: 0, or -1 and the sentence of the first output that cannot be completed. A
 * second Ctrl-C skips the outputs that are left. After a live run, and after Ctrl-C, the options name only what exists:
 * no failed output, and only the recording if a live run ended in its first frame. */
int session_outputs_finish(session_outputs *o, pupil_why *why);

/* Discards what is not finished. */
void session_outputs_discard(session_outputs *o);

/* "; PATH" of each, to standard error. */
void session_outputs_name(const session_outputs *o);

#endif

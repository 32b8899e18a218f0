/* apps/session/session.h: one run of frames, from a source through the pipeline to outputs and a window. The commands
 * replay and run are front ends of it: they open the source, and do their own steps between these:
 *
 *     session_check -> session_begin ->
 *     for each frame: session_meter -> session_map -> session_show
 *     -> session_outputs_finish -> session_end
 */
#ifndef PUPIL_APPS_SESSION_SESSION_H
#define PUPIL_APPS_SESSION_SESSION_H

#include "common/progress.h"
#include "outputs.h"
#include "view/view.h"

typedef struct session {
    const char *command; /* "pupil replay", before each sentence */
    frame_options *options;
    pupil_source *source; /* NULL: closed */
    frame_pipeline pipeline;
    session_outputs outputs;
    const pupil_image *shown; /* what is written instead of the pipeline's picture; NULL */
    view *view;               /* NULL: no window (yet) */
    progress progress;
    uint64_t frames;       /* shown */
    uint64_t too_dark;     /* of these: their codes are mostly noise, so they are left dark */
    uint64_t out_of_range; /* of these: more than half at or below --floor, or at the largest luminance */
    int ended;             /* the window was closed, or the reader of an output has ended */
    double metered_s;      /* progress_now_s, when metering began */
    pupil_why why;         /* why it failed */
} session;

/* Before anything is opened: checks the settings, and what would otherwise fail at the very end. 0, or -1 and
 * session.why. */
int session_check(session *s);

/* With session.source open. `live`: it is one of live/live.h. 0, or -1 and session.why. */
int session_begin(session *s, int live);

/* Before the first frame the window and the GPU are opened. 0, or -1 and session.why, as for the two that follow. */
int session_meter(session *s, const pupil_frame *frame);

/* Maps the frame by pipeline.curve, and fills in its entry. */
int session_map(session *s, const pupil_frame *frame, frame_log_entry *entry);

/* To the outputs and the window. */
int session_show(session *s, const pupil_frame *frame, frame_log_entry *entry);

/* 1: --frames allows another frame, and nothing has ended the run. */
int session_goes_on(const session *s);

/* Prints a sentence for the user on a line of its own, without control characters. */
void session_say(session *s, pupil_why *why, const char *end);

/* Discards what is not finished, and closes all but the source. Writes to `by` "; GPU: ..." if it was asked for, and
 * which frames the settings do not suit. */
void session_end(session *s, char *by, size_t by_bytes);

#endif

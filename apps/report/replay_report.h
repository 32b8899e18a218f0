/* apps/report/replay_report.h: what --report adds to a run: the page, its video, its plot, and the run's own error and
 * speed.
 */
#ifndef PUPIL_APPS_REPORT_REPLAY_REPORT_H
#define PUPIL_APPS_REPORT_REPLAY_REPORT_H

#include "options/frame_options.h"
#include "output/frame_log.h"
#include "pupil/error.h"
#include "sink.h"

typedef struct replay_report replay_report;

/* `frames`: how many are expected, 0 where unknown. The options stay the caller's. 0, or -1 and a sentence. */
int replay_report_open(replay_report **report, const frame_options *options, const pupil_sink_options *video,
                       uint64_t frames, pupil_why *why);
int replay_report_frame(replay_report *report, const pupil_frame *frame, const pupil_curve *curve,
                        const pupil_image_const *rgb8, const pupil_stats *stats, const frame_log_entry *record,
                        pupil_why *why);

/* Writes the page, and the run's figures to `summary`. The report is freed, whether that succeeded or not. */
int replay_report_finish(replay_report *report, const frame_log_entry *records, size_t count, char *summary,
                         size_t summary_bytes, pupil_why *why);
void replay_report_discard(replay_report *report); /* takes NULL */

#endif

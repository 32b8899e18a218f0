/* apps/report/report.h: --report: a folder with one page, index.html, that holds everything: pictures, video, plot,
 * settings and figures. The page loads nothing from anywhere and runs no script.
 *
 *     begin -> frame ... frame -> finish      or      discard
 *
 * The page is complete or absent. Nothing else in the folder is touched; an existing index.html is replaced only if
 * pupil made it and the user asked for that.
 */
#ifndef PUPIL_APPS_REPORT_REPORT_H
#define PUPIL_APPS_REPORT_REPORT_H

#include "page.h"
#include "pupil/error.h"
#include "pupil/image.h"

#define REPORT_MOST_FRAMES    12 /* pictures of a clip */
#define REPORT_MOST_STILLS    60 /* all of a sequence of stills, up to this number */
#define REPORT_MOST_VIDEO_MIB 64 /* browsers grow slow on larger pages */

typedef struct pupil_report pupil_report;

/* `stills`: the frames are pictures of their own, shown with their names. 0, or -1 and a sentence that names the path.
 */
int pupil_report_begin(pupil_report **report, const char *folder, int overwrite, int stills, pupil_why *why);

/* Where to put a video (.mp4) and a plot (.svg) for the page; finish embeds these files in the page and removes
 * them. */
const char *pupil_report_video(const pupil_report *report);
const char *pupil_report_plot(const pupil_report *report);

/* Whether the page may show the next frame; if not, no fixed image is needed. */
int pupil_report_wants(const pupil_report *report);

/* Takes every display frame. `fixed`: the same frame at the exposure of the first, to compare with; may be NULL. */
int pupil_report_frame(pupil_report *report, const pupil_image_const *rgb8, const pupil_image_const *fixed,
                       const frame_log_entry *record, pupil_why *why);

/* Writes the page and puts it in its place. The report is freed, whether that succeeded or not. */
int pupil_report_finish(pupil_report *report, const pupil_report_page *page, pupil_why *why);

/* Leaves nothing. Takes NULL. */
void pupil_report_discard(pupil_report *report);

#endif

/* apps/report/page.h: the parts of a report's page as HTML. */
#ifndef PUPIL_APPS_REPORT_PAGE_H
#define PUPIL_APPS_REPORT_PAGE_H

#include <stdio.h>

#include "output/frame_log.h"
#include "thumbnail.h"

/* The beginning of pupil's pages, by which a report is recognised. */
#define REPORT_MARK "<!DOCTYPE html>\n<html lang=\"en\">\n<meta name=\"generator\" content=\"pupil\">\n"

/* Texts are the caller's, and may be NULL. */
typedef struct pupil_report_row {
    const char *label, *value, *unit;
    const char *command; /* that prints the value */
} pupil_report_row;

typedef struct pupil_report_page {
    const char *title;
    const char *command; /* the command line that made the page */
    const char *version;
    const char *note; /* a sentence at the top: frames skipped, a plot that could not be drawn */
    const frame_log_entry *records;
    size_t record_count;
    const pupil_report_row *settings;
    size_t setting_count;
    const pupil_report_row *figures; /* in addition to those from the records */
    size_t figure_count;
    uint32_t primaries, transfer; /* of the pictures: a pupil_primaries, a pupil_transfer */
} pupil_report_page;

/* A frame that the page shows. */
typedef struct report_picture {
    thumbnail shown, fixed;
    char *name;
    uint64_t frame;
    double time_s, metered_ev, adapted_ev;
} report_picture;

/* What the frames had in common. */
typedef struct report_sums {
    uint64_t pixels;
    uint32_t width, height; /* of the first */
    int sizes_differ;
} report_sums;

/* Writes text with HTML's special characters escaped. */
void report_text(FILE *out, const char *text);

void report_head(FILE *out, const pupil_report_page *page, const report_sums *sums);
void report_tables(FILE *out, const pupil_report_page *page, const report_sums *sums);
void report_caption(FILE *out, const report_picture *picture, int stills);

#endif

/* apps/report/page.h: the parts of a report's page as HTML. */
#ifndef PUPIL_APPS_REPORT_PAGE_H
#define PUPIL_APPS_REPORT_PAGE_H

#include <stdio.h>

#include "report.h"
#include "thumbnail.h"

/* How a page of ours begins: by this a report is known again. */
#define REPORT_MARK "<!DOCTYPE html>\n<html lang=\"en\">\n<meta name=\"generator\" content=\"pupil\">\n"

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

/* Text with everything that HTML would read as its own made harmless. */
void report_text(FILE *out, const char *text);

void report_head(FILE *out, const pupil_report_page *page, const report_sums *sums);
void report_tables(FILE *out, const pupil_report_page *page, const report_sums *sums);
void report_caption(FILE *out, const report_picture *picture, int stills);

#endif

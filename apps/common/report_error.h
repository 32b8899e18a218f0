/* apps/common/report_error.h: sentences and names for the user. Control characters become '?'. */
#ifndef PUPIL_APPS_COMMON_REPORT_ERROR_H
#define PUPIL_APPS_COMMON_REPORT_ERROR_H

#include <stdio.h>

#include "progress.h"
#include "pupil/error.h"

/* "COMMAND: WHY" and `end`, on standard error. */
void report_error(const char *command, pupil_why *why, const char *end);

/* What of a frame could not be read (pupil_frame.notice), likewise, in place of the line of progress; NULL: nothing. */
void report_notice(progress *line, const char *command, const char *notice);

/* The name of a file between two texts. */
void report_name(FILE *out, const char *before, const char *name, const char *after);

#endif

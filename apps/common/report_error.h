/* apps/common/report_error.h: sentences and names for the user. Control characters become '?'. */
#ifndef PUPIL_APPS_COMMON_REPORT_ERROR_H
#define PUPIL_APPS_COMMON_REPORT_ERROR_H

#include <stdio.h>

#include "pupil/error.h"

/* "COMMAND: WHY" and `end`, on standard error. */
void report_error(const char *command, pupil_why *why, const char *end);

/* The name of a file between two texts. */
void report_name(FILE *out, const char *before, const char *name, const char *after);

#endif

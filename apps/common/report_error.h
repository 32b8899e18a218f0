/* apps/common/report_error.h: a sentence for the user, on standard error. */
#ifndef PUPIL_APPS_COMMON_REPORT_ERROR_H
#define PUPIL_APPS_COMMON_REPORT_ERROR_H

#include "pupil/error.h"

/* "COMMAND: WHY" and `end`. A sentence may quote a file's name: what would steer a terminal becomes '?'. */
void report_error(const char *command, pupil_why *why, const char *end);

#endif

#include "report_error.h"

#include <stdio.h>

#include "plain_text.h"

void report_error(const char *command, pupil_why *why, const char *end)
{
    pupil_plain_text(why->text);
    fprintf(stderr, "%s: %s%s\n", command, why->text, end);
}

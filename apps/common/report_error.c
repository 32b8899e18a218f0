#include "report_error.h"

#include <ctype.h>
#include <stdio.h>

void report_error(const char *command, pupil_why *why, const char *end)
{
    for (char *c = why->text; *c; c++)
        if (iscntrl((unsigned char)*c))
            *c = '?';
    fprintf(stderr, "%s: %s%s\n", command, why->text, end);
}

#include "report_error.h"

#include <ctype.h>
#include <stdio.h>

void sentence_say(const char *command, char *why, const char *end)
{
    for (char *c = why; *c; c++)
        if (iscntrl((unsigned char)*c))
            *c = '?';
    fprintf(stderr, "%s: %s%s\n", command, why, end);
}

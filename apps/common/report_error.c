#include "report_error.h"

#include <limits.h>

#include "plain_text.h"

void report_error(const char *command, pupil_why *why, const char *end)
{
    pupil_plain_text(why->text);
    fprintf(stderr, "%s: %s%s\n", command, why->text, end);
}

void report_notice(progress *line, const char *command, const char *notice)
{
    pupil_why why;
    if (!notice)
        return;
    snprintf(why.text, sizeof why.text, "%s", notice);
    progress_clear(line);
    report_error(command, &why, "");
}

void report_name(FILE *out, const char *before, const char *name, const char *after)
{
    char plain[PATH_MAX];
    snprintf(plain, sizeof plain, "%s", name);
    pupil_plain_text(plain);
    fprintf(out, "%s%s%s", before, plain, after);
}

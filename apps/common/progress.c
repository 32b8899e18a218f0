#include "progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double progress_now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

void progress_begin(progress *p, int quiet, uint64_t total)
{
    const char *terminal = getenv("TERM");
    int can_clear = terminal && strcmp(terminal, "dumb") != 0; /* a line, as ECMA-48 has it */
    *p = (progress){.shown = !quiet && can_clear && isatty(STDERR_FILENO), .total = total, .began_s = progress_now_s()};
}

int progress_due(progress *p, double every_s)
{
    const double now_s = progress_now_s();
    if (!p->shown || now_s - p->last_s < every_s)
        return 0;
    fprintf(stderr, "\r\033[K");
    p->last_s = now_s;
    p->line_open = 1;
    return 1;
}

void progress_clear(progress *p)
{
    if (p->line_open)
        fprintf(stderr, "\r\033[K");
    p->line_open = 0;
}

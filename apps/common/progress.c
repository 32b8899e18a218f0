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

void progress_step(progress *p, const frame_log_entry *r)
{
    double now_s = progress_now_s();
    if (!p->shown || now_s - p->last_s < 0.1)
        return;
    p->last_s = now_s;
    fprintf(stderr, "\r\033[Kframe %llu", (unsigned long long)r->frame + 1);
    if (p->total)
        fprintf(stderr, " of %llu", (unsigned long long)p->total);
    fprintf(stderr, "   metered %+.2f EV, adapted %+.2f EV, %s   %.0f frames/s", r->metered_ev, r->adapted_ev, r->state,
            (double)(r->frame + 1) / (now_s - p->began_s));
    fflush(stderr);
    p->line_open = 1;
}

void progress_clear(progress *p)
{
    if (p->line_open)
        fprintf(stderr, "\r\033[K");
    p->line_open = 0;
}

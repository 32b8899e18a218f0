#include "progress.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
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
    int can_clear = terminal && strcmp(terminal, "dumb") != 0; /* a line, by ECMA-48 */
    *p = (progress){.shown = !quiet && can_clear && isatty(STDERR_FILENO), .total = total, .began_s = progress_now_s()};
}

int progress_due(progress *p, double every_s)
{
    const double now_s = progress_now_s();
    if (!p->shown || now_s - p->last_s < every_s)
        return 0;
    p->last_s = now_s;
    p->line[0] = 0;
    return 1;
}

void progress_add(progress *p, const char *format, ...)
{
    const size_t used = strlen(p->line);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(p->line + used, sizeof p->line - used, format, arguments);
    va_end(arguments);
}

void progress_show(progress *p)
{
    struct winsize size;
    const int columns = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col ? size.ws_col : 80;
    fprintf(stderr, "\r\033[K%.*s", columns - 1, p->line);
    fflush(stderr);
    p->line_open = 1;
}

void progress_clear(progress *p)
{
    if (p->line_open)
        fprintf(stderr, "\r\033[K");
    p->line_open = 0;
}

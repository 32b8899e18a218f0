#include "status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/progress.h"
#include "v4l2/format.h"

#define EVERY_S 0.2

static const char *const modes[] = {"digital", "sensor", "both"};

void run_status_begin(run_status *s, int quiet, const pupil_source *source, const run_options *options)
{
    const pupil_v4l2_capture *c = pupil_live_capture(source);
    const char *terminal = getenv("TERM");
    const int can_clear = terminal && strcmp(terminal, "dumb") != 0; /* a line, as ECMA-48 has it */
    *s = (run_status){.quiet = quiet, .shown = !quiet && can_clear && isatty(STDERR_FILENO)};
    s->last_s = progress_now_s();
    if (!quiet)
        fprintf(stderr, "%s, %s: %s %ux%u at %.4g frames/s, mode %s\n", c->device.path, c->device.name,
                pupil_v4l2_fourcc_name(c->format.fourcc).text, c->format.width, c->format.height, source->fps,
                modes[options->mode]);
}

static void print_time(double s)
{
    if (isfinite(s))
        fprintf(stderr, s < 0.01 ? "   %.3f ms" : "   %.2f ms", s * 1e3);
}

void run_status_frame(run_status *s, const frame_log_entry *r)
{
    const double now_s = progress_now_s(), since_s = now_s - s->last_s;
    if (!s->frames)
        s->first_time_s = r->time_s;
    s->time_s = r->time_s;
    s->frames++;
    s->since++;
    s->lost += r->lost;
    s->flagged += r->flagged;
    s->late += r->late;
    if (isfinite(r->latency_us)) {
        s->stamped++;
        s->latency_us += r->latency_us;
        s->most_latency_us = fmax(s->most_latency_us, r->latency_us);
    }
    if (!s->shown || since_s < EVERY_S)
        return;
    fprintf(stderr, "\r\033[K%.1f frames/s", (double)s->since / since_s);
    if (isfinite(r->latency_us))
        fprintf(stderr, "   latency %.1f ms", r->latency_us * 1e-3);
    fprintf(stderr, "   EV %+.2f", r->metered_ev);
    print_time(r->exposure_s);
    if (isfinite(r->gain))
        fprintf(stderr, "   gain %.2f", r->gain);
    fprintf(stderr, "   %s", *r->sensor ? r->sensor : r->state);
    if (*r->sensor_reason)
        fprintf(stderr, " (%s)", r->sensor_reason);
    fprintf(stderr, "   lost %llu", (unsigned long long)s->lost);
    fflush(stderr);
    s->line_open = 1;
    s->last_s = now_s;
    s->since = 0;
}

void run_status_clear(run_status *s)
{
    if (s->line_open)
        fprintf(stderr, "\r\033[K");
    s->line_open = 0;
}

static void count(const char *what, uint64_t n)
{
    if (n)
        fprintf(stderr, ", %s %llu", what, (unsigned long long)n);
}

void run_status_end(const run_status *s, const run_options *options, uint64_t reopened, const char *more)
{
    const double took_s = s->time_s - s->first_time_s;
    if (s->quiet || !s->frames)
        return;
    fprintf(stderr, "%llu frames in %.1f s", (unsigned long long)s->frames, took_s);
    if (took_s > 0.0)
        fprintf(stderr, ", %.2f frames/s", (double)(s->frames - 1) / took_s);
    fprintf(stderr, ", lost %llu", (unsigned long long)s->lost);
    count("damaged", s->flagged);
    count("late", s->late);
    count("opened again", reopened);
    if (s->stamped)
        fprintf(stderr, "; latency %.1f ms, at most %.1f ms", s->latency_us / (double)s->stamped * 1e-3,
                s->most_latency_us * 1e-3);
    else
        fputs("; latency unknown, for the driver's timestamps are of no clock that is known", stderr);
    for (size_t i = 0; i < options->shown.out_count; i++)
        fprintf(stderr, "; %s", options->shown.out[i]);
    const char *const others[] = {options->shown.stats, options->shown.plot, options->shown.record};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (others[i])
            fprintf(stderr, "; %s", others[i]);
    fprintf(stderr, "%s\n", more);
}

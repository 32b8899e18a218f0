#include "status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "live/live.h"

#define EVERY_S 0.2

static const char *const modes[] = {"digital", "sensor", "both"};

void run_status_begin(run_status *s, session *of, uint32_t mode, int resumes)
{
    const pupil_live *c = pupil_live_get(of->source);
    *s = (run_status){.quiet = of->options->quiet, .line = &of->progress};
    progress_begin(s->line, s->quiet, 0);
    s->line->last_s = s->line->began_s;
    if (!s->quiet)
        fprintf(stderr, "%s, %s: %s %ux%u at %.4g frames/s, mode %s%s\n", c->is.path, c->is.name, c->stream.format,
                c->stream.width, c->stream.height, of->source->fps, modes[mode],
                resumes ? ", from the exposure of its last run" : "");
}

/* Says day or night, if it has changed. */
static void say_day_night(run_status *s, const frame_log_entry *r)
{
    if (!r->day_night || !*r->day_night || strcmp(r->day_night, "unknown") == 0 ||
        (s->day_night && strcmp(r->day_night, s->day_night) == 0))
        return;
    s->day_night = r->day_night;
    if (s->quiet)
        return;
    progress_clear(s->line);
    fprintf(stderr, "%s from frame %llu on: scene light %+.2f EV\n", r->day_night, (unsigned long long)r->sequence,
            r->scene_ev);
}

static void add_time(progress *line, double s)
{
    if (isfinite(s))
        progress_add(line, s < 0.01 ? "   %.3f ms" : "   %.2f ms", s * 1e3);
}

void run_status_frame(run_status *s, const frame_log_entry *r)
{
    const double before_s = s->line->last_s;
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
    say_day_night(s, r);
    if (!progress_due(s->line, EVERY_S))
        return;
    progress_add(s->line, "%.1f frames/s", (double)s->since / (s->line->last_s - before_s));
    if (isfinite(r->latency_us))
        progress_add(s->line, "   latency %.1f ms", r->latency_us * 1e-3);
    progress_add(s->line, "   EV %+.2f", r->metered_ev);
    add_time(s->line, r->exposure_s);
    if (isfinite(r->gain))
        progress_add(s->line, "   gain %.2f", r->gain);
    progress_add(s->line, "   %s", *r->sensor ? r->sensor : r->state);
    const char *reason = *r->sensor ? r->sensor_reason : r->reason;
    if (*reason)
        progress_add(s->line, " (%s)", reason);
    progress_add(s->line, "   lost %llu", (unsigned long long)s->lost);
    progress_show(s->line);
    s->since = 0;
}

static void count(const char *what, uint64_t n)
{
    if (n)
        fprintf(stderr, ", %s %llu", what, (unsigned long long)n);
}

void run_status_end(const run_status *s, const session_outputs *outputs, uint64_t reopened, const char *camera,
                    const char *more)
{
    const double took_s = s->time_s - s->first_time_s;
    if (s->quiet || !s->frames)
        return;
    if (camera)
        fprintf(stderr, "%s: ", camera);
    fprintf(stderr, "%llu frame%s in %.1f s", (unsigned long long)s->frames, s->frames == 1 ? "" : "s", took_s);
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
    session_outputs_name(outputs);
    fprintf(stderr, "%s\n", more);
}

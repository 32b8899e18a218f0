#include "explain.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "common/report_error.h"

/* A difference that a person sees side by side is worth a sentence: an eighth of a stop. */
#define VISIBLE_EV 0.125
/* Shares of pixels or samples worth a sentence. */
#define VISIBLE_SHARE 0.01

static double percent(double share)
{
    return 100.0 * share;
}

static void tell_light(FILE *out, const frame_log_entry *e)
{
    fprintf(out, "frame %llu", (unsigned long long)e->frame);
    report_name(out, " of ", e->name, "");
    fprintf(out, ", at %.3f s\n", e->time_s);
    if (strcmp(e->reason, "no_light") == 0) {
        fprintf(out, "metered  no light at all, where the metering looks\n");
        return;
    }
    fprintf(
        out,
        "metered  %+.2f EV, the log-average; 98 %% of the pixels are from %+.1f to %+.1f EV, the median is %+.1f EV\n",
        e->metered_ev, e->p01_ev, e->p99_ev, e->p50_ev);
    if (e->clipped_share >= VISIBLE_SHARE)
        fprintf(out,
                "         %.0f %% of the pixels are at the input's largest code: what was brighter is lost there\n",
                percent(e->clipped_share));
    if (e->black_share >= VISIBLE_SHARE)
        fprintf(out, "         %.0f %% are black, and count as the floor (--floor); --roi and --trim leave them out\n",
                percent(e->black_share));
    if (e->bad_share > 0.0)
        fprintf(out,
                "         %.3g %% are NaN, which counts as the floor (--floor), or infinite, which counts as 1e9\n",
                percent(e->bad_share));
}

/* The level's distance from the level of this frame alone: above 0, the picture is darker than it will be. */
static double lag_of(const frame_log_entry *e)
{
    return e->adapted_ev - e->metered_ev - e->held_back_ev;
}

static void tell_level(FILE *out, const frame_log_entry *e)
{
    const double lag = lag_of(e);
    fprintf(out, "adapted  to %+.2f EV, %s", e->adapted_ev, e->state);
    if (strcmp(e->state, "empty") == 0)
        fprintf(out, ": no frame has had light yet");
    else if (fabs(lag) < VISIBLE_EV)
        fprintf(out, ": where this frame alone would have it");
    else
        fprintf(out, ": %.2f EV %s than this frame alone would have it", fabs(lag), lag > 0.0 ? "higher" : "lower");
    fputc('\n', out);
}

static void tell_picture(FILE *out, const frame_log_entry *e)
{
    fprintf(out, "shown    values times %.4g, so that the level becomes %.3f (key and compensation)", e->scale, e->key);
    if (e->white > 0.0)
        fprintf(out, ", white at %.3g", e->white);
    fprintf(out, "\n         the picture's own log-average is %.3f; %.1f %% of its samples are white, %.1f %% black\n",
            e->output_level, percent(e->output_white_share), percent(e->output_black_share));
}

/* --- causes --- */

typedef struct causes {
    FILE *out;
    int count;
} causes;

__attribute__((format(printf, 2, 3))) static void cause(causes *c, const char *format, ...)
{
    va_list arguments;
    fputs(c->count++ ? "         " : "why      ", c->out);
    va_start(arguments, format);
    vfprintf(c->out, format, arguments);
    va_end(arguments);
    fputc('\n', c->out);
}

static void find_held(causes *c, const frame_log_entry *e, const pupil_config *config)
{
    const double lag = lag_of(e);
    if (strcmp(e->reason, "lock") == 0)
        cause(c, "the level is locked at the first frame's; without --lock it follows");
    else if (strcmp(e->reason, "no_light") == 0)
        cause(c, "nothing can be metered, so the level is held; --metering and --roi choose where to look");
    else if (strcmp(e->reason, "clock_back") == 0)
        cause(c, "its timestamp is before the last one's, so no time has passed and the level is held");
    else if (strcmp(e->reason, "clock_unit") == 0)
        cause(c,
              "its timestamp is under 0.1 ms after the last one's, so the level hardly moves; are the stamps in ns?");
    else if (fabs(lag) >= VISIBLE_EV && config->law == PUPIL_LAW_SECONDS)
        cause(c,
              "the light has become %s, and the level follows with a time constant of %.3g s; --tau-%s less is faster",
              lag > 0.0 ? "less, so the picture is dark for a while" : "more, so the picture is bright for a while",
              lag > 0.0 ? config->tau_dark_s : config->tau_light_s, lag > 0.0 ? "dark" : "light");
    else if (fabs(lag) >= VISIBLE_EV && config->law == PUPIL_LAW_EYE)
        cause(c, "the light has become %s, and an eye follows in part within a second, in part within minutes",
              lag > 0.0 ? "less" : "more");
    else if (fabs(lag) >= VISIBLE_EV)
        cause(c, "each frame counts %.3g (--weight) of the level, which follows slowly", config->frame_weight);
}

static void find_limits(causes *c, const frame_log_entry *e, const pupil_config *config)
{
    if (strcmp(e->reason, "amplification") == 0)
        cause(c,
              "so dark that its codes are mostly noise, so it is left dark; --amplification %.3g or more brightens it",
              (double)config->amplification_ev + 2.0);
    if (strcmp(e->reason, "range") == 0)
        cause(c, "most of its light is at or below %.2g, which counts as black (--floor), or above 1e9",
              (double)config->floor);
    if (e->bad_share > 0.5)
        cause(c, "most of its pixels are NaN or infinite, which is no light to adapt to");
    if (strcmp(e->reason, "ev_min") == 0 || strcmp(e->reason, "ev_max") == 0)
        cause(c, "its light is beyond the level's bounds (ev_min, ev_max)");
    if (e->held_back_ev >= VISIBLE_EV)
        cause(c,
              "%.2f EV darker for its highlights, much of which is over 4 stops brighter than the rest; --highlights 0 "
              "shows the rest brighter",
              e->held_back_ev);
    if (fabs(config->ev_compensation) >= VISIBLE_EV)
        cause(c, "--ev %+.2f", config->ev_compensation);
}

void explain_frame(FILE *out, const frame_log_entry *e, const pupil_config *config)
{
    causes c = {out, 0};
    tell_light(out, e);
    tell_level(out, e);
    tell_picture(out, e);
    find_held(&c, e, config);
    find_limits(&c, e, config);
    if (!c.count)
        cause(&c, "it is as it is aimed at; --ev 1 makes it twice as bright, --metering and --roi choose what counts");
    else
        cause(&c, "--ev changes the brightness of all frames, --metering and --roi what counts in them");
}

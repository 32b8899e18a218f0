/* The measurements, in their order, around one stream. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "refuse.h"
#include "stream.h"

#define FIRST_SETTLE 10 /* frames: twice the longest usual delay */
#define MORE_SETTLE  2
#define ALONE_S      2.0 /* for a camera without controls */

static void say(const probe_stream *s, const char *what)
{
    if (s->options->say && !s->state)
        s->options->say(what);
}

static void unknown_all(probe_report *r, const char *why)
{
    probe_known *const all[] = {&r->exposure_delay.is, &r->gain_delay.is, &r->exposure.is, &r->gain.is, &r->black.is};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (!all[i]->known && !*all[i]->why.text)
            probe_unknown(all[i], "%s", why);
}

/* So that later steps wait no longer than needed. */
static void shorten_settling(probe_stream *s)
{
    const probe_delay *e = &s->report->exposure_delay, *g = &s->report->gain_delay;
    if (!e->is.known || (!g->is.known && s->report->limits.has_gain))
        return;
    s->settle = (e->most > g->most ? e->most : g->most) + MORE_SETTLE;
}

static void measure_controls(probe_stream *s)
{
    probe_report *r = s->report;
    probe_known found = {0};
    double exposure_s, gain, moved_ev = 0.0;
    uint64_t unused;
    pupil_camera_get_limits(s->camera, &r->limits);
    s->longest_s = fmax(fmin(r->limits.exposure_max_s, s->period_s), r->limits.exposure_min_s);
    s->settle = FIRST_SETTLE;
    const pupil_camera_setting before = probe_taken(s);
    say(s, "black");
    probe_black_level(s); /* without it linear pictures look nonlinear */
    probe_set(s, before.exposure_s, before.gain, &unused);
    say(s, "a level to measure at");
    probe_find_level(s, &found, &exposure_s, &gain);
    if (found.known) {
        say(s, "whether the picture is at rest");
        probe_restless(s, exposure_s, gain, &moved_ev);
        say(s, "delays of the controls");
        probe_delays(s, exposure_s, gain, moved_ev);
        shorten_settling(s);
        probe_laws(s, exposure_s, gain, moved_ev);
    }
    unknown_all(r, found.known ? "there was no time left for it" : found.why.text);
}

static void measure(probe_stream *s)
{
    probe_report *r = s->report;
    say(s, "the first frame");
    if (probe_frame(s)) /* not part of the time limit: drivers may take seconds for it */
        return;
    const int64_t began_ns = pupil_live_now_ns(s->source);
    s->camera = pupil_live_camera(s->source);
    r->has_controls.known = s->camera != NULL;
    if (!s->camera)
        pupil_refuse(&r->has_controls.why, "%.*s", PROBE_WORDS - 1, pupil_live_no_controls(s->source));
    const double seconds = s->camera ? s->options->seconds : fmin(ALONE_S, s->options->seconds);
    s->end_ns = began_ns + (int64_t)(seconds * 1e9);
    if (s->camera) {
        measure_controls(s);
    } else {
        unknown_all(r, "its exposure cannot be set");
        say(s, "frames");
        while (probe_frame(s) == 0)
            ;
    }
    r->seconds = (double)(pupil_live_now_ns(s->source) - began_ns) * 1e-9;
}

static int open_stream(probe_stream *s, const pupil_live_system *system)
{
    pupil_live_options live = {.system = system, .capture = {.stop = s->options->stop}};
    pupil_config config;
    if (pupil_live_open(s->report->offers.is.path, NULL, &live, &s->source, s->why))
        return -1;
    pupil_config_default(&config);
    config.histogram = 1;
    config.floor = 0x1p-20f; /* below a code of 16 bits */
    s->period_s = 1.0 / s->source->fps;
    pupil_init(&s->pupil, &config);
    s->report->stream = pupil_live_get(s->source)->stream;
    s->report->fps = s->source->fps;
    return 0;
}

int probe_measure(probe_report *report, const pupil_live_system *system, const probe_options *options, pupil_why *why)
{
    pupil_why back;
    probe_stream *s = calloc(1, sizeof *s);
    if (!s)
        return pupil_refuse(why, "%s: not enough memory", report->offers.is.path);
    *s = (probe_stream){.report = report, .options = options, .why = why};
    if (open_stream(s, system)) {
        free(s);
        return -1;
    }
    if (options->source)
        options->source(s->source);
    measure(s);
    probe_stream_tell(s);
    int result = s->state == PROBE_STOPPED ? 1 : s->state < 0 ? -1 : 0;
    if (pupil_live_give_back(s->source, &back) && result == 0) {
        pupil_refuse(why, "%s", back.text);
        result = -1;
    }
    if (options->source)
        options->source(NULL);
    pupil_source_close(s->source);
    free(s);
    return result;
}

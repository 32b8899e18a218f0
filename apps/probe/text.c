/* The results of a probe, for people: a word, and its details. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "probe.h"

/* Formats with the same sizes on one line. */
static void print_camera(const probe_report *r, FILE *out)
{
    const pupil_live_identity *d = &r->offers.is;
    fprintf(out, "camera     %s (driver %s, at %s), %s\n", d->name, d->driver, d->bus, d->path);
    for (uint32_t i = 0; i < r->offers.modes.count; i++) {
        char sizes[4096], next[4096] = "";
        const pupil_live_mode *mode = &r->offers.modes.mode[i];
        pupil_live_mode_text(mode, sizes, sizeof sizes);
        fprintf(out, "%s%s%s", i ? "" : "formats    ", mode->name, mode->read ? "" : " (not read)");
        const int last = i + 1 == r->offers.modes.count;
        if (!last)
            pupil_live_mode_text(mode + 1, next, sizeof next);
        if (!last && strcmp(sizes, next) == 0)
            fputs(" ", out);
        else
            fprintf(out, "%s%s\n%s", *sizes ? ": " : "", sizes, last ? "" : "           ");
    }
    if (!r->offers.modes.count)
        fputs("formats    none reported\n", out);
}

static void print_stream(const probe_report *r, FILE *out)
{
    const pupil_live_stream *s = &r->stream;
    fprintf(out, "stream     %s %ux%u, %.4g frames a second, %u buffers\n", s->format, s->width, s->height, r->fps,
            s->buffers);
    fprintf(out, "colour     colorspace %s, transfer %s, encoding %s, %s range\n", s->colorspace, s->transfer,
            s->encoding, s->range);
    fprintf(out, "memory     %s", s->reading);
    if (*s->heap)
        fprintf(out, " %s", s->heap);
    if (s->read_bytes_s > 0.0)
        fprintf(out, "; the CPU reads it at %.3g GB/s, ordinary memory at %.3g GB/s", s->read_bytes_s * 1e-9,
                s->ordinary_bytes_s * 1e-9);
    fputc('\n', out);
}

static void print_sensor(const probe_report *r, FILE *out)
{
    const pupil_camera_sensor *s = &r->offers.sensor;
    char law[96];
    if (!r->offers.has_entity) {
        fputs("sensor     none of its own: the controls are the node's, as a webcam's\n", out);
        return;
    }
    fprintf(out, "sensor     %s (%s)", r->offers.entity, r->offers.entity_path);
    if (!r->offers.has_sensor) {
        fputs(", of which the table knows nothing\n", out);
        return;
    }
    probe_law_text(&s->gain, law, sizeof law);
    fprintf(out, "\n           known: gain %s", law);
    if (s->exposure_delay)
        fprintf(out, ", delays %u (exposure) and %u (gain) frames", s->exposure_delay, s->gain_delay);
    if (s->black >= 0.0)
        fprintf(out, ", black %g of 65535", s->black);
    fprintf(out, "%s\n           by: %s\n", s->has_matrix ? ", a colour matrix" : "", s->source);
}

static void print_controls(const probe_report *r, FILE *out)
{
    for (unsigned i = 0; i < r->offers.controls; i++) {
        const pupil_live_control *c = &r->offers.control[i];
        fprintf(out, "%s%s%s: ", i ? "           " : "controls   ", c->on_sensor ? "sensor's " : "", c->name);
        if (*c->item)
            fprintf(out, "%s", c->item);
        else if (isnan(c->value))
            fprintf(out, "%.15g by default,", c->usual);
        else
            fprintf(out, "%.15g", c->value);
        if (!*c->item)
            fprintf(out, " of %.15g..%.15g", c->least, c->most);
        if (c->step > 1.0)
            fprintf(out, " by %.15g", c->step);
        fprintf(out, "%s\n", c->automatic ? " (automatic: turned off while pupil steers)" : "");
    }
    if (!r->offers.controls)
        fputs("controls   none\n", out);
}

static void print_seconds(const char *before, double s, FILE *out)
{
    if (s >= 1.0)
        fprintf(out, "%s%.4g s", before, s);
    else if (s >= 1e-3)
        fprintf(out, "%s%.4g ms", before, s * 1e3);
    else
        fprintf(out, "%s%.4g us", before, s * 1e6);
}

static void print_limits(const probe_report *r, FILE *out)
{
    const pupil_camera_limits *l = &r->limits;
    char law[96];
    if (!r->has_controls.known) {
        fprintf(out, "exposure   cannot be set: %s\n", r->has_controls.why.text);
        return;
    }
    print_seconds("exposure   from ", l->exposure_min_s, out);
    print_seconds(" to ", l->exposure_max_s, out);
    if (l->exposure_step_s > 0.0)
        print_seconds(" by ", l->exposure_step_s, out);
    fputc('\n', out);
    if (!l->has_gain) {
        fputs("gain       none\n", out);
        return;
    }
    probe_law_text(&l->gain, law, sizeof law);
    fprintf(out, "gain       from %.4g to %.4g (%.3g to %.3g dB), %s%s\n", l->gain_min, l->gain_max,
            20.0 * log10(l->gain_min), 20.0 * log10(l->gain_max),
            l->gain_known ? "" : "its law is not known, taken for ", law);
}

/* --- measured --- */

static int print_unknown(const char *what, const probe_known *is, FILE *out)
{
    if (!is->known)
        fprintf(out, "%s undetermined: %s\n", what, is->why.text);
    return !is->known;
}

static void print_times(const probe_report *r, FILE *out)
{
    const probe_interval *i = &r->interval;
    if (!print_unknown("  interval", &i->is, out)) {
        print_seconds("  interval ", i->mean_s, out);
        fprintf(out, " (%.2f frames a second)", 1.0 / i->mean_s);
        print_seconds(", jitter ", i->jitter_s, out);
        print_seconds(", from ", i->least_s, out);
        print_seconds(" to ", i->most_s, out);
        fprintf(out, "; %llu frames came, %llu were lost, %llu damaged\n", (unsigned long long)i->frames,
                (unsigned long long)i->lost, (unsigned long long)i->damaged);
    }
    if (!print_unknown("  latency ", &r->latency.is, out)) {
        print_seconds("  latency  ", r->latency.median_s, out);
        print_seconds(" (at most ", r->latency.most_s, out);
        fprintf(out, ") from the driver's stamp, of the %s\n", probe_stamp(r->latency.stamp));
    }
}

static void print_delay(const char *what, const probe_delay *d, FILE *out)
{
    if (print_unknown(what, &d->is, out))
        return;
    fprintf(out, "%s %u frame%s", what, d->frames, d->frames == 1 ? "" : "s");
    if (d->least != d->most)
        fprintf(out, " (from %u to %u)", d->least, d->most);
    fprintf(out, " after the one that is exposed when it is written, in %u steps\n", d->steps);
}

static void print_law(const char *what, const probe_law *law, int of_gain, FILE *out)
{
    if (print_unknown(what, &law->is, out))
        return;
    if (!law->obeyed)
        fprintf(out, "%s read back but not obeyed: the picture does not follow (%.2f stops for one)\n", what,
                law->slope);
    else
        fprintf(out, "%s %s: %.3f stops of the picture for one of the control, at most %.3f off\n", what,
                law->as_told ? of_gain ? "as its law says" : "proportional, linear light"
                : of_gain    ? "not as its law says"
                             : "not proportional: a tone curve, or light that changes",
                law->slope, law->off_ev);
    if (law->drift_ev > 0.02)
        fprintf(out, "             (the scene itself changed by %.3f stops meanwhile)\n", law->drift_ev);
    for (unsigned i = 0; i < law->points; i++) {
        const probe_point *p = &law->point[i];
        print_seconds("             ", p->exposure_s, out);
        fprintf(out, ", gain %.4g", p->gain);
        if (of_gain)
            fprintf(out, " (code %lld)", (long long)p->code);
        fprintf(out, ": %+.3f stops off\n", p->off_ev);
    }
}

static void print_black(const probe_report *r, FILE *out)
{
    const probe_black *b = &r->black;
    if (print_unknown("  black   ", &b->is, out))
        return;
    fprintf(out, "  black    %s%.0f of 65535 (%.3g %% of full scale)", b->at_most ? "at most " : "", b->share * 65535.0,
            b->share * 100.0);
    print_seconds(", by what is left at ", b->exposure_s, out);
    fprintf(out, "%s\n", b->at_most ? "; the scene is bright even there: cover the lens" : "");
}

void probe_text(const probe_report *r, FILE *out)
{
    print_camera(r, out);
    print_stream(r, out);
    print_sensor(r, out);
    print_controls(r, out);
    print_limits(r, out);
    fprintf(out, "measured, in %.1f seconds:\n", r->seconds);
    print_times(r, out);
    if (!r->has_controls.known)
        return;
    print_delay("  delay of exposure", &r->exposure_delay, out);
    print_delay("  delay of gain", &r->gain_delay, out);
    print_law("  exposure", &r->exposure, 0, out);
    print_law("  gain    ", &r->gain, 1, out);
    print_black(r, out);
}

/* pupil probe on cameras in this process with known delays, laws, black levels and wrong reports. */
#include "probe_rig.h"

#include <math.h>

static void check_delay(const probe_delay *d, unsigned frames, const char *what)
{
    CHECK_MSG(d->is.known && d->frames == frames && d->least == frames && d->most == frames,
              "%s: %u (%u..%u), expected %u: %s", what, d->frames, d->least, d->most, frames, d->is.why.text);
}

/* 8 bits of limited range, sRGB's curve: half a code is 0.043 stops at the darkest point, light 2^-6, and 0.01 at the
 * first, 2^-3. With 10 bits of linear light: 0.045 and 0.006. */
#define MOST_OFF_EV 0.055

static void check_law(const probe_law *law)
{
    CHECK_MSG(law->is.known && law->obeyed && law->as_told, "known %d, obeyed %d, as told %d: %s", law->is.known,
              law->obeyed, law->as_told, law->is.why.text);
    CHECK_MSG(fabs(law->slope - 1) < 0.02 && law->off_ev < MOST_OFF_EV && law->drift_ev < 0.01,
              "slope %g, %g off, drift %g", law->slope, law->off_ev, law->drift_ev);
}

static void test_delays(void)
{
    for (uint32_t delay = 0; delay <= 6; delay++)
        for (uint32_t earlier = 0; earlier <= delay && earlier < 3; earlier++) {
            probed p;
            fake_v4l2_config c = usual();
            c.control_delay = delay;
            c.gain_earlier = earlier;
            c.stamp = delay % 2 ? FAKE_STAMP_START_OF_EXPOSURE : FAKE_STAMP_END_OF_FRAME;
            probe(&p, &c, delay % 3 != 0, 1.0);
            CHECK_MSG(p.result == 0, "%s", p.why.text);
            CHECK_MSG(p.report.seconds < 15, "%g s", p.report.seconds);
            if (c.stamp == FAKE_STAMP_END_OF_FRAME) {
                check_delay(&p.report.exposure_delay, delay, "exposure");
                check_delay(&p.report.gain_delay, delay - earlier, "gain");
            } else { /* its stamps are read as frame ends: the frame in progress is taken for one earlier */
                CHECK(p.report.exposure_delay.is.known && p.report.gain_delay.is.known);
                CHECK(p.report.exposure_delay.frames - p.report.gain_delay.frames == earlier);
            }
            pupil_live_modes_free(&p.report.offers.modes);
        }
}

static void test_laws(void)
{
    static const uint32_t formats[] = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_SRGGB10, V4L2_PIX_FMT_Y12};
    for (int i = 0; i < 4; i++) {
        probed p;
        fake_v4l2_config c = usual();
        const probe_report *r = &p.report;
        c.only_format = formats[i];
        c.black = i == 2 ? 0.0625 : 0.0; /* 64 of 1023 */
        probe(&p, &c, 0, 1.0);
        CHECK_MSG(p.result == 0 && r->has_controls.known, "%s%s", p.why.text, r->has_controls.why.text);
        check_law(&r->exposure);
        check_law(&r->gain);
        CHECK(r->exposure.points == 5 && r->gain.points == 6);
        for (unsigned k = 0; k < r->gain.points; k++)
            CHECK_MSG((double)r->gain.point[k].code == r->gain.point[k].gain * 16, "code %lld of %g",
                      (long long)r->gain.point[k].code, r->gain.point[k].gain);
        CHECK(r->limits.gain_min == 1 && r->limits.gain_max == 64 && !r->limits.gain_known);
        CHECK_MSG(r->black.is.known && !r->black.at_most && fabs(r->black.share - c.black) < 0.002,
                  "black %g of %g: %s", r->black.share, c.black, r->black.is.why.text);
        CHECK(r->interval.is.known && fabs(r->interval.mean_s * 30 - 1) < 1e-4 && r->interval.jitter_s < 2e-6);
        CHECK(r->interval.frames > 100 && r->interval.lost == 0 && r->interval.damaged == 0);
        CHECK(r->latency.is.known && r->latency.most_s < 1e-3 && r->latency.stamp == PUPIL_LIVE_STAMP_END_OF_FRAME);
        pupil_live_modes_free(&p.report.offers.modes);
    }
}

static void check_unknown(const probe_known *is, const char *sentence)
{
    CHECK_MSG(!is->known && strstr(is->why.text, sentence), "known %d: '%s' for '%s'", is->known, is->why.text,
              sentence);
}

/* What the driver reports and the picture does not do. */
static void test_lies(void)
{
    probed p;
    const probe_report *r = &p.report;
    fake_v4l2_config c = usual();
    c.deaf_gain = 1;
    probe(&p, &c, 0, 1.0);
    check_delay(&r->exposure_delay, 2, "exposure");
    check_law(&r->exposure);
    check_unknown(&r->gain_delay.is, "does not follow within 16 frames, though the driver says that it has the value");
    CHECK(r->gain.is.known && !r->gain.obeyed && !r->gain.as_told);
    CHECK_MSG(fabs(r->gain.slope) < 0.1, "slope %g", r->gain.slope); /* far from 1: dark codes of 8 bits */
    pupil_live_modes_free(&p.report.offers.modes);

    c = usual();
    c.deaf_exposure = 1;
    probe(&p, &c, 0, 1.0);
    check_unknown(&r->exposure_delay.is, "does not follow within 16 frames");
    check_delay(&r->gain_delay, 2, "gain");
    CHECK(r->exposure.is.known && !r->exposure.obeyed);
    check_unknown(&r->gain.is, "its exposure does not obey");
    check_unknown(&r->black.is, "the picture does not follow the exposure");
    pupil_live_modes_free(&p.report.offers.modes);

    c = usual(); /* a gain in steps that are not reported */
    c.coarse_gain = 1;
    probe(&p, &c, 0, 1.0);
    check_delay(&r->gain_delay, 2, "gain");
    CHECK_MSG(r->gain.is.known && r->gain.obeyed && !r->gain.as_told && r->gain.off_ev > 0.5 && r->gain.off_ev < 1.05,
              "%g off, slope %g", r->gain.off_ev, r->gain.slope);
    pupil_live_modes_free(&p.report.offers.modes);

    c = usual(); /* grey reported as linear that has sRGB's curve */
    c.only_format = V4L2_PIX_FMT_Y12;
    c.drawn_xfer = V4L2_XFER_FUNC_SRGB;
    probe(&p, &c, 0, 1.0);
    check_delay(&r->exposure_delay, 2, "exposure");
    /* 1 below 0.0031 and falling to 0.5 at 0.03 (IEC 61966-2-1, its derivative): about where the points are */
    CHECK_MSG(r->exposure.is.known && r->exposure.obeyed && !r->exposure.as_told && r->exposure.slope < 0.85,
              "slope %g", r->exposure.slope);
    pupil_live_modes_free(&p.report.offers.modes);
}

/* Pictures in which nothing can be measured are reported as such. */
static void test_light(void)
{
    probed p;
    fake_v4l2_config c = usual();
    probe(&p, &c, 1, 2000.0);
    CHECK(p.result == 0);
    check_unknown(&p.report.exposure_delay.is, "the picture is too bright");
    check_unknown(&p.report.gain.is, "the picture is too bright");
    CHECK(!p.report.black.is.known || p.report.black.at_most);
    pupil_live_modes_free(&p.report.offers.modes);
    probe(&p, &c, 1, 1e-6);
    check_unknown(&p.report.exposure_delay.is, "the picture is too dark");
    check_unknown(&p.report.exposure.is, "the picture is too dark");
    pupil_live_modes_free(&p.report.offers.modes);
    for (double light = 0.02; light < 30; light *= 3) { /* a camera has to find its level first */
        probe(&p, &c, 1, light);
        check_delay(&p.report.exposure_delay, 2, "exposure");
        check_delay(&p.report.gain_delay, 2, "gain");
        pupil_live_modes_free(&p.report.offers.modes);
    }
}

/* Lost and damaged frames, moving scenes. */
static void test_trouble(void)
{
    probed p;
    fake_v4l2_config c = usual();
    c.dropped = 0.05;
    c.flagged = 0.05;
    probe(&p, &c, 0, 1.0);
    CHECK_MSG(p.result == 0, "%s", p.why.text);
    CHECK(p.report.interval.lost > 0 && p.report.interval.damaged > 0);
    CHECK_MSG(
        p.report.exposure_delay.is.known && p.report.exposure_delay.least >= 2 && p.report.exposure_delay.most <= 4,
        "%u..%u: %s", p.report.exposure_delay.least, p.report.exposure_delay.most, p.report.exposure_delay.is.why.text);
    check_law(&p.report.exposure);
    pupil_live_modes_free(&p.report.offers.modes);

    c = usual();
    c.flat = 0;
    c.width = 320;
    c.height = 240;
    probe(&p, &c, 0, 1.0);
    check_delay(&p.report.exposure_delay, 2, "exposure");
    check_delay(&p.report.gain_delay, 2, "gain");
    CHECK(p.report.exposure.as_told && p.report.gain.as_told);
    pupil_live_modes_free(&p.report.offers.modes);

    c = usual();
    c.unplug_at = 100;
    probe(&p, &c, 0, 1.0);
    CHECK_MSG(p.result == -1 && strstr(p.why.text, "the camera was unplugged"), "%s", p.why.text);
    pupil_live_modes_free(&p.report.offers.modes);
}

static double amount, speed, from;

static double wave(unsigned long frames) /* stops from end to end, frames a period, frames before */
{
    return exp2(0.5 * amount * sin(6.2831853 * ((double)frames + from) / speed));
}

static double ramp(unsigned long frames)
{
    return exp2(amount * fmod((double)frames + from, speed) / speed);
}

/* A person walks by. */
static double visit(unsigned long frames)
{
    return (double)frames >= from && (double)frames < from + speed ? exp2(amount) : 1.0;
}

static double walk(unsigned long frames)
{
    static uint32_t state;
    static double ev;
    if (!frames) {
        ev = 0.0;
        state = (uint32_t)from;
    }
    state = state * 1664525u + 1013904223u; /* Numerical Recipes' quick generator */
    ev += amount * (2.0 * (state >> 8) / 16777216.0 - 1.0);
    ev = fmin(fmax(ev, -1.5), 1.5); /* no person leaves the room */
    return exp2(ev);
}

static unsigned known_things, unknown_things;

/* A scene that moves: each result is right, or the movement is reported. Returns how many results there were. */
static unsigned check_moving(double (*how)(unsigned long), int quick)
{
    probed p;
    const fake_v4l2_config c = usual();
    const probe_report *r = &p.report;
    unsigned known = 0;
    motion = how;
    probe(&p, &c, quick, 1.0);
    motion = NULL;
    CHECK_MSG(p.result == 0, "%s", p.why.text);
    const probe_delay *delays[] = {&r->exposure_delay, &r->gain_delay};
    const probe_law *laws[] = {&r->exposure, &r->gain};
    for (int i = 0; i < 2; i++) {
        const probe_delay *d = delays[i];
        const probe_law *law = laws[i];
        CHECK_MSG(!d->is.known || d->frames == 2, "%g %g %g: delay %d is %u", amount, speed, from, i, d->frames);
        CHECK_MSG(!law->is.known || (law->obeyed && law->as_told && fabs(law->slope - 1) < 0.2),
                  "%g %g %g: law %d: slope %g, %g off, drift %g", amount, speed, from, i, law->slope, law->off_ev,
                  law->drift_ev);
        CHECK_MSG(d->is.known || *d->is.why.text, "no sentence");
        known += (unsigned)(d->is.known + law->is.known);
    }
    CHECK_MSG(!r->black.is.known || r->black.at_most || r->black.share < 0.01, "black %g", r->black.share);
    known_things += known;
    unknown_things += 4 - known;
    pupil_live_modes_free(&p.report.offers.modes);
    return known;
}

/* People, clouds, lamps. */
static void test_moving(void)
{
    probed p;
    amount = 1.0, speed = 40.0, from = 0.0;
    motion = wave;
    const fake_v4l2_config c = usual();
    probe(&p, &c, 0, 1.0);
    motion = NULL;
    check_unknown(&p.report.exposure_delay.is,
                  "moves by itself, by 1.00 stops: point it at something that does not move");
    check_unknown(&p.report.gain_delay.is, "the picture moves by itself");
    check_unknown(&p.report.exposure.is, "the picture moves by itself");
    check_unknown(&p.report.gain.is, "the picture moves by itself");
    pupil_live_modes_free(&p.report.offers.modes);

    for (amount = 0.5; amount < 3; amount *= 2)
        for (speed = 7; speed < 200; speed *= 3)
            for (from = 0; from < speed; from += speed / 3)
                check_moving(wave, from > 0);
    for (amount = -1; amount < 3; amount += 2)
        for (speed = 5; speed < 30; speed += 10)
            for (from = 40; from < 340; from += 29)
                check_moving(visit, 0);
    for (amount = 0.02; amount < 0.4; amount *= 2)
        for (from = 1; from < 6; from++)
            check_moving(walk, 0);
    for (amount = -2; amount < 3; amount += 1)
        check_moving(ramp, 0);
    printf("%u things were told of moving scenes, and %u were not\n", known_things, unknown_things);
    amount = 0.04, speed = 30, from = 0; /* a hardly moving scene is still measured */
    CHECK(check_moving(wave, 0) == 4);
}

/* A stop at every moment: the probe ends, and the camera is given back (probe checks that). */
static void test_stop(void)
{
    for (int at = 1; at < 400; at = at * 3 / 2 + 1) {
        probed p;
        const fake_v4l2_config c = usual();
        stops_left = at;
        probe(&p, &c, 0, 1.0);
        CHECK_MSG(p.result == 1 || at > 250 || at == 1, "stopped at %d: %d %s", at, p.result, p.why.text);
        pupil_live_modes_free(&p.report.offers.modes);
    }
    stops_left = -1;
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_delays();
    test_laws();
    test_lies();
    test_light();
    test_trouble();
    test_moving();
    test_stop();
    return check_end();
}

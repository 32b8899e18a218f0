/* pupil probe on cameras in this process whose delays, laws, black and lies are known. */
#include "check.h"

#include <cjson/cJSON.h>
#include <linux/videodev2.h>
#include <math.h>

#include "probe.h"
#include "v4l2/fake/fake_v4l2.h"

static fake_v4l2_config usual(void)
{
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    config.flat = 500; /* a scene that stands still */
    return config;
}

static int32_t control(fake_v4l2 *fake, uint32_t id, int set, int32_t value)
{
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    struct v4l2_control c = {id, value};
    const int fd = system->open(system->context, "/dev/video0");
    CHECK(fd >= 0 && system->ioctl(system->context, fd, set ? VIDIOC_S_CTRL : VIDIOC_G_CTRL, &c) == 0);
    system->close(system->context, fd);
    return c.value;
}

static int stops_left = -1; /* -1: never */

static int stop(void)
{
    if (stops_left > 0)
        stops_left--;
    return stops_left == 0;
}

static const uint32_t ids[] = {V4L2_CID_EXPOSURE_AUTO, V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_GAIN,
                               V4L2_CID_EXPOSURE_AUTO_PRIORITY};
static const int32_t left_at[] = {3, 77, 40, 1}; /* as its user had them */

typedef struct probed {
    probe_report report;
    int result;
    char why[PUPIL_WHY_BYTES];
} probed;

/* The result of one probe; whatever it was, the camera is as before. */
static void probe(probed *p, const fake_v4l2_config *config, int quick, double light)
{
    const probe_options options = {.quick = quick, .seconds = 30, .stop = stop};
    fake_v4l2 *fake = fake_v4l2_new(config);
    if (!fake)
        abort();
    *p = (probed){.result = -1};
    fake_v4l2_light(fake, light);
    for (int i = 0; i < 4; i++)
        control(fake, ids[i], 1, left_at[i]);
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    CHECK_MSG(probe_offers(&p->report, system, "/dev/video0", p->why, sizeof p->why) == 0, "%s", p->why);
    for (int i = 0; i < 4; i++)
        CHECK(control(fake, ids[i], 0, 0) == left_at[i]); /* only asked */
    p->result = probe_measure(&p->report, system, &options, p->why, sizeof p->why);
    for (int i = 0; i < 4 && !config->unplug_at; i++)
        CHECK_MSG(control(fake, ids[i], 0, 0) == left_at[i], "control %d is left at %d", i,
                  control(fake, ids[i], 0, 0));
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%d files and %d maps are left", held.files, held.maps);
    fake_v4l2_free(fake);
}

static void check_delay(const probe_delay *d, unsigned frames, const char *what)
{
    CHECK_MSG(d->is.known && d->frames == frames && d->least == frames && d->most == frames,
              "%s: %u (%u..%u), expected %u: %s", what, d->frames, d->least, d->most, frames, d->is.why);
}

/* 8 bits of limited range, sRGB's curve: half a code of the darkest point, light of 2^-6, is 0.043 stops, and of the
 * first, 2^-3, 0.01. 10 bits of linear light: 0.045 and 0.006. */
#define MOST_OFF_EV 0.055

static void check_law(const probe_law *law)
{
    CHECK_MSG(law->is.known && law->obeyed && law->as_told, "known %d, obeyed %d, as told %d: %s", law->is.known,
              law->obeyed, law->as_told, law->is.why);
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
            CHECK_MSG(p.result == 0, "%s", p.why);
            CHECK_MSG(p.report.seconds < 15, "%g s", p.report.seconds);
            if (c.stamp == FAKE_STAMP_END_OF_FRAME) {
                check_delay(&p.report.exposure_delay, delay, "exposure");
                check_delay(&p.report.gain_delay, delay - earlier, "gain");
            } else { /* its stamps are those of frame ends all the same: the one under way is taken for one earlier */
                CHECK(p.report.exposure_delay.is.known && p.report.gain_delay.is.known);
                CHECK(p.report.exposure_delay.frames - p.report.gain_delay.frames == earlier);
            }
            probe_free(&p.report);
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
        CHECK_MSG(p.result == 0 && r->has_controls.known, "%s%s", p.why, r->has_controls.why);
        check_law(&r->exposure);
        check_law(&r->gain);
        CHECK(r->exposure.points == 5 && r->gain.points == 6);
        for (unsigned k = 0; k < r->gain.points; k++)
            CHECK_MSG((double)r->gain.point[k].code == r->gain.point[k].gain * 16, "code %lld of %g",
                      (long long)r->gain.point[k].code, r->gain.point[k].gain);
        CHECK(r->limits.gain_min == 1 && r->limits.gain_max == 64 && !r->limits.gain_known);
        CHECK_MSG(r->black.is.known && !r->black.at_most && fabs(r->black.share - c.black) < 0.002,
                  "black %g of %g: %s", r->black.share, c.black, r->black.is.why);
        CHECK(r->interval.is.known && fabs(r->interval.mean_s * 30 - 1) < 1e-4 && r->interval.jitter_s < 2e-6);
        CHECK(r->interval.frames > 100 && r->interval.lost == 0 && r->interval.damaged == 0);
        CHECK(r->latency.is.known && r->latency.most_s < 1e-3 && r->latency.stamp == PUPIL_V4L2_STAMP_END_OF_FRAME);
        probe_free(&p.report);
    }
}

static void check_unknown(const probe_known *is, const char *sentence)
{
    CHECK_MSG(!is->known && strstr(is->why, sentence), "known %d: '%s' for '%s'", is->known, is->why, sentence);
}

/* What the driver says and the picture does not do. */
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
    probe_free(&p.report);

    c = usual();
    c.deaf_exposure = 1;
    probe(&p, &c, 0, 1.0);
    check_unknown(&r->exposure_delay.is, "does not follow within 16 frames");
    check_delay(&r->gain_delay, 2, "gain");
    CHECK(r->exposure.is.known && !r->exposure.obeyed);
    check_unknown(&r->gain.is, "its exposure does not do what it is told");
    check_unknown(&r->black.is, "the picture does not follow the exposure");
    probe_free(&p.report);

    c = usual(); /* a gain in steps that nobody tells of */
    c.coarse_gain = 1;
    probe(&p, &c, 0, 1.0);
    check_delay(&r->gain_delay, 2, "gain");
    CHECK_MSG(r->gain.is.known && r->gain.obeyed && !r->gain.as_told && r->gain.off_ev > 0.5 && r->gain.off_ev < 1.05,
              "%g off, slope %g", r->gain.off_ev, r->gain.slope);
    probe_free(&p.report);

    c = usual(); /* grey that is called linear, and has sRGB's curve */
    c.only_format = V4L2_PIX_FMT_Y12;
    c.drawn_xfer = V4L2_XFER_FUNC_SRGB;
    probe(&p, &c, 0, 1.0);
    check_delay(&r->exposure_delay, 2, "exposure");
    /* 1 below 0.0031 and falling to 0.5 at 0.03 (IEC 61966-2-1, its derivative): about where the points are */
    CHECK_MSG(r->exposure.is.known && r->exposure.obeyed && !r->exposure.as_told && r->exposure.slope < 0.85,
              "slope %g", r->exposure.slope);
    probe_free(&p.report);
}

/* Pictures in which nothing can be measured say so. */
static void test_light(void)
{
    probed p;
    fake_v4l2_config c = usual();
    probe(&p, &c, 1, 2000.0);
    CHECK(p.result == 0);
    check_unknown(&p.report.exposure_delay.is, "the picture is too bright");
    check_unknown(&p.report.gain.is, "the picture is too bright");
    CHECK(!p.report.black.is.known || p.report.black.at_most);
    probe_free(&p.report);
    probe(&p, &c, 1, 1e-6);
    check_unknown(&p.report.exposure_delay.is, "the picture is too dark");
    check_unknown(&p.report.exposure.is, "the picture is too dark");
    probe_free(&p.report);
    for (double light = 0.02; light < 30; light *= 3) { /* a camera has to find its level first */
        probe(&p, &c, 1, light);
        check_delay(&p.report.exposure_delay, 2, "exposure");
        check_delay(&p.report.gain_delay, 2, "gain");
        probe_free(&p.report);
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
    CHECK_MSG(p.result == 0, "%s", p.why);
    CHECK(p.report.interval.lost > 0 && p.report.interval.damaged > 0);
    CHECK_MSG(
        p.report.exposure_delay.is.known && p.report.exposure_delay.least >= 2 && p.report.exposure_delay.most <= 4,
        "%u..%u: %s", p.report.exposure_delay.least, p.report.exposure_delay.most, p.report.exposure_delay.is.why);
    check_law(&p.report.exposure);
    probe_free(&p.report);

    c = usual();
    c.flat = 0;
    c.width = 320;
    c.height = 240;
    probe(&p, &c, 0, 1.0);
    check_delay(&p.report.exposure_delay, 2, "exposure");
    check_delay(&p.report.gain_delay, 2, "gain");
    CHECK(p.report.exposure.as_told && p.report.gain.as_told);
    probe_free(&p.report);

    c = usual();
    c.unplug_at = 100;
    probe(&p, &c, 0, 1.0);
    CHECK_MSG(p.result == -1 && strstr(p.why, "the camera was unplugged"), "%s", p.why);
    probe_free(&p.report);
}

/* At every moment: it stops, and the camera is given back (probe checks it). */
static void test_stop(void)
{
    for (int at = 1; at < 400; at = at * 3 / 2 + 1) {
        probed p;
        const fake_v4l2_config c = usual();
        stops_left = at;
        probe(&p, &c, 0, 1.0);
        CHECK_MSG(p.result == 1 || at > 250 || at == 1, "stopped at %d: %d %s", at, p.result, p.why);
        probe_free(&p.report);
    }
    stops_left = -1;
}

/* ---- what is printed ----------------------------------------------------------------------------------------------
 */

static double number_at(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    CHECK_MSG(cJSON_IsNumber(item), "%s is no number", name);
    return cJSON_IsNumber(item) ? item->valuedouble : -1e300;
}

/* cJSON writes 15 digits where that is near enough for it. */
static int is_number(const cJSON *object, const char *name, double value)
{
    return fabs(number_at(object, name) - value) <= 1e-14 * fabs(value);
}

static int is_text(const cJSON *object, const char *name, const char *text)
{
    const char *found = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
    return found && strcmp(found, text) == 0;
}

static int is_true(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    CHECK_MSG(cJSON_IsBool(item), "%s is neither true nor false", name);
    return cJSON_IsTrue(item);
}

static const cJSON *object_at(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    CHECK_MSG(cJSON_IsObject(item), "%s is not there", name);
    return item;
}

static void check_json_law(const cJSON *measured, const char *name, const probe_law *law)
{
    const cJSON *o = object_at(measured, name), *points = cJSON_GetObjectItemCaseSensitive(o, "points");
    CHECK(is_true(o, "known") == law->is.known && is_true(o, "obeyed") == law->obeyed);
    CHECK(is_true(o, "as_told") == law->as_told && is_number(o, "slope", law->slope));
    CHECK(is_number(o, "off_ev", law->off_ev) && is_number(o, "drift_ev", law->drift_ev));
    CHECK(cJSON_GetArraySize(points) == (int)law->points);
    for (unsigned i = 0; i < law->points; i++) {
        const cJSON *point = cJSON_GetArrayItem(points, (int)i);
        const probe_point *p = &law->point[i];
        CHECK(is_number(point, "exposure_s", p->exposure_s) && is_number(point, "gain", p->gain));
        CHECK(is_number(point, "gain_code", (double)p->code) && is_number(point, "level_ev", p->level_ev));
        CHECK(is_number(point, "off_ev", p->off_ev));
    }
}

static void check_json_measured(const cJSON *measured, const probe_report *r)
{
    const cJSON *interval = object_at(measured, "interval"), *latency = object_at(measured, "latency");
    const cJSON *e = object_at(measured, "exposure_delay"), *g = object_at(measured, "gain_delay");
    const cJSON *black = object_at(measured, "black");
    CHECK(is_number(measured, "seconds", r->seconds));
    CHECK(is_true(interval, "known") && is_number(interval, "mean_s", r->interval.mean_s));
    CHECK(is_number(interval, "jitter_s", r->interval.jitter_s));
    CHECK(is_number(interval, "least_s", r->interval.least_s) && is_number(interval, "most_s", r->interval.most_s));
    CHECK(number_at(interval, "frames") == (double)r->interval.frames && number_at(interval, "lost") == 0);
    CHECK(number_at(interval, "damaged") == 0 && is_text(latency, "stamp", "end of frame"));
    CHECK(is_number(latency, "median_s", r->latency.median_s) && is_number(latency, "most_s", r->latency.most_s));
    CHECK(number_at(e, "frames") == 3 && number_at(e, "least_frames") == 3 && number_at(e, "most_frames") == 3);
    CHECK(number_at(e, "steps") == 4 && is_true(e, "known"));
    CHECK(!is_true(g, "known") && is_text(g, "why", r->gain_delay.is.why) && !cJSON_HasObjectItem(g, "frames"));
    check_json_law(measured, "exposure", &r->exposure);
    check_json_law(measured, "gain", &r->gain);
    CHECK(is_true(black, "known") && !is_true(black, "at_most") && number_at(black, "exposure_s") == 1e-4);
    CHECK(is_number(black, "of_65535", r->black.share * 65535.0));
}

static void check_json(const cJSON *root, const probe_report *r)
{
    const cJSON *camera = object_at(root, "camera"), *stream = object_at(root, "stream");
    const cJSON *colour = object_at(root, "colour"), *memory = object_at(root, "memory");
    const cJSON *sensor = object_at(root, "sensor"), *limits = object_at(root, "limits");
    const cJSON *controls = cJSON_GetObjectItemCaseSensitive(root, "controls"), *exposure_auto;
    CHECK(is_text(camera, "name", FAKE_V4L2_NAME) && is_text(camera, "driver", "fake"));
    CHECK(is_text(camera, "path", "/dev/video0") && is_text(camera, "bus", "fake:1"));
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(camera, "formats")) == 37);
    CHECK(is_text(stream, "fourcc", "YUYV") && number_at(stream, "width") == 64 && number_at(stream, "height") == 48);
    CHECK(number_at(stream, "fps") == 30 && number_at(stream, "buffers") == 4);
    CHECK(is_text(colour, "colorspace", "sRGB") && is_text(colour, "transfer", "sRGB"));
    CHECK(is_text(colour, "encoding", "601") && is_text(colour, "range", "limited"));
    CHECK(is_text(memory, "reading", "copied") && is_text(memory, "heap", ""));
    CHECK(number_at(memory, "read_bytes_per_s") == 0.4e9 && number_at(memory, "ordinary_bytes_per_s") == 8e9);
    CHECK(is_text(sensor, "entity", "fake 1-0010") && is_text(sensor, "path", "/dev/v4l-subdev0"));
    CHECK(cJSON_IsNull(cJSON_GetObjectItemCaseSensitive(sensor, "table")));
    CHECK(cJSON_GetArraySize(controls) == 4);
    exposure_auto = cJSON_GetArrayItem(controls, 1);
    CHECK(is_text(exposure_auto, "name", "Auto Exposure") && is_text(exposure_auto, "item", "Aperture Priority Mode"));
    CHECK(number_at(exposure_auto, "id") == V4L2_CID_EXPOSURE_AUTO && number_at(exposure_auto, "value") == 3);
    CHECK(number_at(exposure_auto, "least") == 0 && number_at(exposure_auto, "most") == 3);
    CHECK(number_at(exposure_auto, "step") == 1 && number_at(exposure_auto, "default") == 1);
    CHECK(is_true(exposure_auto, "automatic") && !is_true(exposure_auto, "on_sensor"));
    CHECK(is_true(cJSON_GetArrayItem(controls, 3), "automatic") &&
          !is_true(cJSON_GetArrayItem(controls, 0), "automatic"));
    CHECK(is_true(limits, "known") && number_at(limits, "exposure_min_s") == 1e-4);
    CHECK(number_at(limits, "exposure_max_s") == 1 && number_at(limits, "exposure_step_s") == 1e-4);
    CHECK(is_true(limits, "has_gain") && number_at(limits, "gain_min") == 1 && number_at(limits, "gain_max") == 64);
    CHECK(number_at(limits, "gain_min_db") == 0 && fabs(number_at(limits, "gain_max_db") - 36.12) < 0.01);
    CHECK(is_text(limits, "gain_law", "code / 16") && !is_true(limits, "gain_law_known"));
    check_json_measured(object_at(root, "measured"), r);
}

static void test_print(void)
{
    probed p;
    fake_v4l2_config c = usual();
    char *text = NULL;
    size_t bytes = 0;
    c.control_delay = 3;
    c.deaf_gain = 1;
    c.slow = 1;
    c.media = FAKE_MEDIA_RIGHT;
    probe(&p, &c, 0, 1.0);
    char *json = probe_json(&p.report);
    cJSON *root = cJSON_Parse(json);
    check_json(root, &p.report);
    cJSON_Delete(root);
    free(json);
    FILE *file = open_memstream(&text, &bytes);
    probe_text(&p.report, file);
    fclose(file);
    static const char *const lines[] = {
        "camera     Fake Camera (driver fake, at fake:1), /dev/video0\nformats    MJPG YUYV",
        "\nstream     YUYV 64x48, 30 frames a second, 4 buffers\n",
        "\ncolour     colorspace sRGB, transfer sRGB, encoding 601, limited range\n",
        "\nmemory     copied; the CPU reads it at 0.4 GB/s, ordinary memory at 8 GB/s\n",
        "\nsensor     fake 1-0010 (/dev/v4l-subdev0), of which the table knows nothing\n",
        "\n           Auto Exposure: Aperture Priority Mode (automatic: turned off while pupil steers)\n",
        "\nexposure   from 100 us to 1 s by 100 us\n",
        "\ngain       from 1 to 64 (0 to 36.1 dB), its law is not known, taken for code / 16\n",
        "\n  interval 33.33 ms (30.00 frames a second), jitter ",
        "\n  delay of exposure 3 frames after the one that is exposed when it is written, in 4 steps\n",
        "\n  delay of gain undetermined: the picture does not follow within 16 frames",
        "\n  exposure proportional, linear light: ",
        "\n  gain     read back but not obeyed: the picture does not follow (",
        "\n  black    0 of 65535 (",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        CHECK_MSG(strstr(text, lines[i]), "'%s' is not in:\n%s", lines[i], text);
    free(text);
    probe_free(&p.report);
}

static void test_laws_text(void)
{
    static const struct {
        const char *sensor, *text;
    } cases[] = {{"ov5647", "code / 16"},
                 {"imx219 10-0010", "256 / (256 - code)"},
                 {"imx296", "0.1 dB a code"},
                 {"ar0521", "16 codes an octave"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        pupil_camera_sensor sensor;
        char text[96], why[256];
        CHECK(pupil_camera_find_sensor(NULL, cases[i].sensor, &sensor, why, sizeof why) == 1);
        probe_law_text(&sensor.gain, text, sizeof text);
        CHECK_MSG(strcmp(text, cases[i].text) == 0, "%s: %s", cases[i].sensor, text);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_delays();
    test_laws();
    test_lies();
    test_light();
    test_trouble();
    test_stop();
    test_print();
    test_laws_text();
    return check_end();
}

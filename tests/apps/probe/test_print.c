/* The output of pupil probe: JSON, field by field, and text. */
#include "probe_rig.h"

#include <cjson/cJSON.h>
#include <math.h>

static double number_at(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    CHECK_MSG(cJSON_IsNumber(item), "%s is not a number", name);
    return cJSON_IsNumber(item) ? item->valuedouble : -1e300;
}

/* cJSON writes 15 digits if it considers that accurate enough. */
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
    CHECK(!is_true(g, "known") && is_text(g, "why", r->gain_delay.is.why.text) && !cJSON_HasObjectItem(g, "frames"));
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
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(camera, "formats")) == 49);
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
    pupil_live_modes_free(&p.report.offers.modes);
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
        char text[96];
        pupil_why why;
        CHECK(pupil_camera_find_sensor(NULL, cases[i].sensor, &sensor, &why) == 1);
        probe_law_text(&sensor.gain, text, sizeof text);
        CHECK_MSG(strcmp(text, cases[i].text) == 0, "%s: %s", cases[i].sensor, text);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_print();
    test_laws_text();
    return check_end();
}

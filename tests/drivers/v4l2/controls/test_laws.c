/* Codes to factors and seconds and back, for every law and every sensor of the table; and the table's parser. */
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "pupil/camera_controls.h"

#ifdef __GLIBC__
/* As in a program whose locale has a decimal comma, such as gst-launch-1.0 with LANG=de_DE: numbers end at a point. The
 * locale itself may not be installed. */
double strtod(const char *text, char **end)
{
    char whole[64] = "", *whole_end;
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    strncpy(whole, text, strcspn(text, ".") < sizeof whole ? strcspn(text, ".") : sizeof whole - 1);
    const double value = strtod_l(whole, &whole_end, c);
    freelocale(c);
    if (end)
        *end = (char *)(uintptr_t)text + (whole_end - whole);
    return value;
}
#endif

static void round_trip(const char *name, const pupil_camera_gain *law, pupil_camera_range range)
{
    double last = 0;
    for (int64_t code = range.least; code <= range.most; code += range.step) {
        const double gain = pupil_camera_gain_of_code(law, code);
        if (law->law != PUPIL_CAMERA_TABLE || gain > last) /* between two rows of a table the lower one applies */
            CHECK_MSG(gain > last, "%s: code %lld is %g, the one before %g", name, (long long)code, gain, last);
        const int64_t back = pupil_camera_code_of_gain(law, gain, &range);
        CHECK_MSG(pupil_camera_gain_of_code(law, back) == gain, "%s: code %lld comes back as %lld", name,
                  (long long)code, (long long)back);
        if (last > 0 && gain > last) { /* between two codes: the lower one, so the gain is too low by its step */
            const int64_t below = pupil_camera_code_of_gain(law, 0.5 * (last + gain), &range);
            CHECK_MSG(pupil_camera_gain_of_code(law, below) == last, "%s: below %lld comes %lld", name, (long long)code,
                      (long long)below);
        }
        last = gain;
    }
    CHECK(pupil_camera_code_of_gain(law, 0, &range) == range.least);
    CHECK(pupil_camera_code_of_gain(law, NAN, &range) == range.least);
    CHECK(pupil_camera_gain_of_code(law, pupil_camera_code_of_gain(law, INFINITY, &range)) == last);
}

static void check_laws(void)
{
    const pupil_camera_gain sixteenth = {.law = PUPIL_CAMERA_RATIO, .p = {1, 0, 0, 16}},
                            imx219 = {.law = PUPIL_CAMERA_RATIO, .p = {0, 256, -1, 256}},
                            db = {.law = PUPIL_CAMERA_DB, .p = {0.3}},
                            octaves = {.law = PUPIL_CAMERA_OCTAVES, .p = {16}},
                            table = {.law = PUPIL_CAMERA_TABLE, .rows = 3, .code = {2, 5, 9}, .gain = {1, 1.26, 1.59}};
    CHECK(pupil_camera_gain_of_code(&sixteenth, 24) == 1.5 && pupil_camera_gain_of_code(&imx219, 128) == 2);
    CHECK(fabs(pupil_camera_gain_of_code(&db, 100) - 31.6227766) < 1e-6);
    CHECK(pupil_camera_gain_of_code(&octaves, 0x28) == 6 && pupil_camera_gain_of_code(&table, 8) == 1.26);
    CHECK(pupil_camera_gain_of_code(&imx219, 256) == 0 && pupil_camera_gain_of_code(&table, 1) == 0);
    round_trip("x / 16", &sixteenth, (pupil_camera_range){16, 1023, 1, 16});
    round_trip("x / 16, even codes", &sixteenth, (pupil_camera_range){16, 1023, 2, 16});
    round_trip("256 / (256 - x)", &imx219, (pupil_camera_range){0, 232, 1, 0});
    round_trip("0.3 dB", &db, (pupil_camera_range){0, 240, 1, 0});
    round_trip("octaves", &octaves, (pupil_camera_range){0, 63, 1, 0});
    round_trip("table", &table, (pupil_camera_range){2, 12, 1, 2});
    /* codes beyond the law's pole are never written */
    CHECK(pupil_camera_code_of_gain(&imx219, 1e9, &(pupil_camera_range){0, 1000, 1, 0}) == 255);
    CHECK(pupil_camera_code_of_gain(&table, 1.0, &(pupil_camera_range){0, 12, 1, 2}) == 4); /* the last of gain 1 */
}

static void check_exposures(void)
{
    static const double units[] = {1e-4, 18.9e-6, 3448 / 182.4e6, 1 / 27000.0};
    for (int u = 0; u < 4; u++)
        for (int64_t step = 1; step <= 2; step++) {
            const pupil_camera_range range = {3, 2047, step, 250};
            for (int64_t code = 3; code <= 2047; code += step) {
                const double s = (double)code * units[u];
                CHECK(pupil_camera_code_of_exposure(s, units[u], &range) == code);
                if (code > 3)
                    CHECK(pupil_camera_code_of_exposure(s - 0.5 * units[u], units[u], &range) == code - step);
            }
            CHECK(pupil_camera_code_of_exposure(0, units[u], &range) == 3);
            CHECK(pupil_camera_code_of_exposure(NAN, units[u], &range) == 3);
            CHECK(pupil_camera_code_of_exposure(1e300, units[u], &range) == 2047);
        }
}

/* Every line of the built-in table. */
static void check_table(void)
{
    const char *at = pupil_camera_sensors();
    int sensors = 0, matrices = 0;
    while (*at) {
        char name[24] = "", subdevice[64];
        pupil_why why = {""};
        pupil_camera_sensor s;
        if (*at != '#' && *at != '\n' && sscanf(at, "%23s", name) == 1) {
            snprintf(subdevice, sizeof subdevice, "%s 10-001a", name);
            CHECK_MSG(pupil_camera_find_sensor(NULL, subdevice, &s, &why) == 1, "%s: %s", name, why.text);
            CHECK(!strcmp(s.name, name) && s.source[0] && s.exposure_delay <= 4 && s.gain_delay <= 4 &&
                  s.black < 65535);
            const int64_t least = s.gain.law == PUPIL_CAMERA_RATIO && s.gain.p[1] == 0 ? (int64_t)s.gain.p[3] : 0;
            CHECK(fabs(pupil_camera_gain_of_code(&s.gain, least) - 1) < 1e-12); /* all of these begin at 1 */
            round_trip(name, &s.gain, (pupil_camera_range){least, least + 63, 1, least});
            for (int row = 0; s.has_matrix && row < 3; row++) /* grey stays grey */
                CHECK_MSG(fabs(s.matrix[3 * row] + s.matrix[3 * row + 1] + s.matrix[3 * row + 2] - 1) < 1e-4, "%s",
                          name);
            matrices += s.has_matrix != 0;
            sensors++;
        }
        at += strcspn(at, "\n");
        at += *at == '\n';
    }
    printf("%d sensors, %d with a matrix\n", sensors, matrices);
    CHECK(sensors >= 12 && matrices >= 3);
}

static void check_parser(void)
{
    static const struct {
        const char *text, *fault;
    } wrong[] = {
        {"a gain ratio 1 0 0", "number"},     {"a gain ratio 1 0 0 x", "number"},
        {"a gain ratio 0 1 1 1", "rise"},     {"a gain db 0", "number"},
        {"a gain octaves nan", "number"},     {"a gain", "one of"},
        {"a gain cubic 1", "one of"},         {"a delay 2 1", "gain is missing"},
        {"a gain db 1 delay 2", "number"},    {"a gain db 1 delay 0 1", "number"},
        {"a gain db 1 black -1", "number"},   {"a gain db 1 matrix 1 2", "number"},
        {"a gain db 1 colour", "words are"},  {"a gain table", "pairs"},
        {"a gain table 1:2 1:3", "pairs"},    {"a gain table 1:2 2:2", "pairs"},
        {"a gain table 1:x", "pairs"},        {"a gain table 1:2z", "pairs"},
        {"abcdefghijklmnopqrstuvwxyz", "23"}, {"a gain db 1e999", "number"},
    };
    pupil_camera_sensor s;
    pupil_why why;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char text[256];
        snprintf(text, sizeof text, "# of mine\nb gain db 1\n%s\n", wrong[i].text);
        why.text[0] = 0;
        CHECK_MSG(pupil_camera_find_sensor(text, "b", &s, &why) == -1, "%s", wrong[i].text);
        CHECK_MSG(strstr(why.text, "line 3") && strstr(why.text, wrong[i].fault), "%s: \"%s\"", wrong[i].text,
                  why.text);
    }
    const char *good = "\n  mine gain table 0:1 4:2.5 black 100 source a bench, at home\nMINE gain db 1";
    CHECK(pupil_camera_find_sensor(good, "Mine 3-0036", &s, &why) == 1);
    CHECK(s.gain.rows == 2 && s.gain.gain[1] == 2.5 && s.black == 100 && !strcmp(s.source, "a bench, at home"));
    CHECK(!s.exposure_delay && !s.has_matrix);
    CHECK(pupil_camera_find_sensor(good, "mine2", &s, &why) == 0);
    CHECK(pupil_camera_find_sensor("", "mine", &s, NULL) == 0);
    CHECK(pupil_camera_find_sensor(NULL, "imx2190", &s, &why) == 0);
    for (int i = 0; i < 20000; i++) { /* ends for any input */
        static const char *const pieces[] = {"a",      " ",  "\n",    "gain",  "ratio",  "table", "1:2",
                                             "3",      "-1", "#",     "delay", "matrix", "1e9",   ":",
                                             "source", "\t", "black", "db",    "\r",     "9:"};
        char text[700] = "";
        for (int k = 0; k < 60; k++)
            strcat(text, pieces[check_random() % (sizeof pieces / sizeof *pieces)]);
        pupil_camera_find_sensor(text, "a", &s, &why);
    }
}

/* A camera that has limits and nothing else. */
static pupil_camera_limits limits;

static void get_limits(pupil_camera *camera, pupil_camera_limits *to)
{
    (void)camera;
    *to = limits;
}

/* Each law that pupil/sensor.h names; a camera whose codes have steps, or with another law, is PUPIL_GAIN_ANY.
 */
static void check_configuration(void)
{
    static const struct {
        pupil_camera_gain gain;
        int64_t step;
        uint32_t law;
        double gain_step;
    } cases[] = {
        {{.law = PUPIL_CAMERA_DB, .p = {0.3}}, 2, PUPIL_GAIN_DB, 0.6},
        {{.law = PUPIL_CAMERA_RATIO, .p = {1, 0, 0, 16}}, 4, PUPIL_GAIN_LINEAR, 0.25},
        {{.law = PUPIL_CAMERA_RATIO, .p = {0, 256, -1, 256}}, 1, PUPIL_GAIN_RECIPROCAL, 256},
        {{.law = PUPIL_CAMERA_RATIO, .p = {0, 256, -1, 256}}, 2, PUPIL_GAIN_ANY, 0},
        {{.law = PUPIL_CAMERA_RATIO, .p = {0, 256, -2, 256}}, 1, PUPIL_GAIN_ANY, 0},
        {{.law = PUPIL_CAMERA_RATIO, .p = {0, 255, -1, 256}}, 1, PUPIL_GAIN_ANY, 0},
        {{.law = PUPIL_CAMERA_RATIO, .p = {1, 256, -1, 256}}, 1, PUPIL_GAIN_ANY, 0},
        {{.law = PUPIL_CAMERA_RATIO, .p = {1, 0, 1, 16}}, 1, PUPIL_GAIN_ANY, 0},
        {{.law = PUPIL_CAMERA_OCTAVES, .p = {16}}, 1, PUPIL_GAIN_ANY, 0},
        {{.law = PUPIL_CAMERA_TABLE, .rows = 2, .code = {1, 2}, .gain = {1, 1.5}}, 1, PUPIL_GAIN_TABLE, 0},
        {{.law = PUPIL_CAMERA_TABLE, .rows = 2, .code = {1, 3}, .gain = {1, 1.5}}, 2, PUPIL_GAIN_ANY, 0},
        {{.law = PUPIL_CAMERA_TABLE}, 1, PUPIL_GAIN_ANY, 0},
    };
    static const pupil_camera_ops ops = {.get_limits = get_limits};
    pupil_camera camera = {&ops};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pupil_sensor_config config;
        pupil_sensor_config_default(&config);
        limits = (pupil_camera_limits){.exposure_step_s = 1e-4,
                                       .exposure_min_s = 0.05,
                                       .exposure_max_s = 0.1,
                                       .gain_min = 1,
                                       .gain_max = 8,
                                       .has_gain = 1,
                                       .gain = cases[i].gain,
                                       .gain_code_step = cases[i].step,
                                       .exposure_delay = 20,
                                       .frame_s = 0.01};
        pupil_camera_configure(&camera, &config);
        CHECK_MSG(config.gain_law == cases[i].law, "case %zu: law %u", i, config.gain_law);
        CHECK(cases[i].gain_step == 0 || fabs(config.gain_step - cases[i].gain_step) < 1e-12);
        CHECK(config.gain_law != PUPIL_GAIN_TABLE || (config.gain_count == 2 && config.gain_table[1] == 1.5));
        CHECK(config.frame_s == 0.05 && config.delay_frames == 16); /* no shorter than the shortest exposure */
    }
}

/* The frame whose exposure is in progress, by the time that has passed. */
static void check_newest(void)
{
    CHECK(pupil_camera_newest(7, 0, 10000000, 0.02) == 7); /* half a frame */
    CHECK(pupil_camera_newest(7, 0, 50000000, 0.02) == 9);
    CHECK(pupil_camera_newest(7, 50000000, 0, 0.02) == 7);
    CHECK(pupil_camera_newest(7, 0, INT64_C(3600000000000), 0.02) == 7 + 256); /* another clock */
    CHECK(pupil_camera_close(NULL, NULL) == 0);
    pupil_camera_restore(NULL);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_laws();
    check_configuration();
    check_newest();
    check_exposures();
    check_table();
    check_parser();
    return check_end();
}

/* What the options of `pupil run` are given that replay has not. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "options.h"
#include "options/key_at.h"
#include "v4l2/format.h"

int run_value_time(const value_text *c, double plain_s, double low_s, double high_s, const char *right, double *seconds)
{
    static const struct {
        const char *name;
        double s;
    } units[] = {{"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}, {"min", 60.0}};
    char *end;
    double s = strtod(c->text, &end), unit = plain_s;
    if (end == c->text)
        return value_refuse(c, right);
    if (*end == '/') {
        char *below = end + 1;
        s /= strtod(below, &end);
        unit = 1.0;
        if (end == below)
            return value_refuse(c, right);
    }
    for (size_t i = 0; *end && i < sizeof units / sizeof units[0]; i++)
        if (strcmp(end, units[i].name) == 0) {
            unit = units[i].s;
            end += strlen(end);
        }
    s *= unit;
    if (*end || !(s >= low_s && s <= high_s))
        return value_refuse(c, right);
    *seconds = s;
    return OPTIONS_RUN;
}

static int one_of(const value_text *c, const char *const words[3], const char *right, uint32_t *which)
{
    for (uint32_t i = 0; i < 3; i++)
        if (strcmp(c->text, words[i]) == 0) {
            *which = i;
            return OPTIONS_RUN;
        }
    return value_refuse(c, right);
}

int run_value_mode(const value_text *c, uint32_t *mode)
{
    static const char *const words[] = {"digital", "sensor", "both"};
    return one_of(c, words, "digital, sensor or both", mode);
}

int run_value_curve(const value_text *c, uint32_t *curve)
{
    static const char *const words[] = {"auto", "linear", "unknown"};
    return one_of(c, words, "auto, linear or unknown", curve);
}

int run_value_key_at(const value_text *c, const char **key_at)
{
    pupil_sensor_config tried;
    pupil_sensor_config_default(&tried);
    *key_at = c->text;
    return key_at_parse(c->text, &tried) ? value_refuse(c, key_at_right) : OPTIONS_RUN;
}

int run_value_mains(const value_text *c, uint32_t *mains_hz, int *off)
{
    *off = strcmp(c->text, "off") == 0;
    if (!*off && strcmp(c->text, "auto") != 0 && strcmp(c->text, "50") != 0 && strcmp(c->text, "60") != 0)
        return value_refuse(c, "50, 60, auto or off");
    *mains_hz = (uint32_t)atoi(c->text); /* of words 0 */
    return OPTIONS_RUN;
}

/* Light flickers twice in a period of the mains. */
int run_value_period(const value_text *c, uint32_t *mains_hz)
{
    static const char right[] = "10000us (mains of 50 Hz) or 8333us (60 Hz); a plain number is microseconds";
    double s = 0.0;
    if (run_value_time(c, 1e-6, 8e-3, 1.1e-2, right, &s))
        return OPTIONS_USAGE;
    *mains_hz = fabs(s - 0.01) < 1e-5 ? 50 : fabs(s - 1.0 / 120.0) < 1e-5 ? 60 : 0;
    return *mains_hz ? OPTIONS_RUN : value_refuse(c, right);
}

int run_value_side(const value_text *c, uint32_t *side)
{
    uint64_t v;
    if (value_whole(c, 1, PUPIL_MAX_SIDE_PX, "pixels, from 1 to 16384", &v))
        return OPTIONS_USAGE;
    *side = (uint32_t)v;
    return OPTIONS_RUN;
}

int run_value_format(const value_text *c, uint32_t *fourcc)
{
    *fourcc = pupil_v4l2_fourcc(c->text);
    return *fourcc ? OPTIONS_RUN
                   : value_refuse(c, "a format's name of up to four letters, as 'pupil list' tells them: YUYV, NV12");
}

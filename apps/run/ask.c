#include "ask.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control.h"
#include "options/commands.h"
#include "refuse.h"

/* The command line's options that can change while frames come. Names, values and sentences are the same. */
static const char *const changeable[] = {"ev",       "key",         "key-at",        "metering",  "roi",
                                         "trim",     "highlights",  "amplification", "tau-light", "tau-dark",
                                         "gain-max", "shutter-max", "day-night"};
static const char more[] = "ev, key, key-at, lock, metering, roi, trim, highlights, amplification, tau-light, "
                           "tau-dark, gain-max, shutter-max, day-night, light, filter, status";

static const char blanks[] = " \t";

#define USUAL_FRAMES 30 /* a second, in which a person changes a filter */

/* --- status --- */

static void put_number(char *text, size_t bytes, const char *name, double x)
{
    const size_t used = strlen(text);
    if (isfinite(x))
        snprintf(text + used, bytes - used, ",\"%s\":%.9g", name, x);
    else
        snprintf(text + used, bytes - used, ",\"%s\":null", name);
}

static void put_text(char *text, size_t bytes, const char *name, const char *value)
{
    char json[256];
    const size_t used = strlen(text);
    run_control_text(value ? value : "", json, sizeof json);
    snprintf(text + used, bytes - used, ",\"%s\":\"%s\"", name, json);
}

static double known(double x)
{
    return x > 0.0 ? x : (double)NAN;
}

static void put_status(const run_ask *a, char *answer, size_t bytes)
{
    const frame_log_entry *e = &a->last;
    const run_options *o = a->options;
    const pupil_config *c = &o->shown.config;
    snprintf(answer, bytes, "{\"ok\":true,\"frames\":%llu,\"sequence\":%llu", (unsigned long long)a->session->frames,
             (unsigned long long)e->sequence);
    put_text(answer, bytes, "state", *e->sensor ? e->sensor : e->state);
    put_text(answer, bytes, "reason", *e->sensor ? e->sensor_reason : e->reason);
    put_number(answer, bytes, "metered_ev", e->metered_ev);
    put_number(answer, bytes, "adapted_ev", e->adapted_ev);
    put_number(answer, bytes, "scene_ev", e->scene_ev);
    put_number(answer, bytes, "exposure_s", known(e->exposure_s));
    put_number(answer, bytes, "gain", known(e->gain));
    put_number(answer, bytes, "ev", c->ev_compensation);
    put_number(answer, bytes, "key", c->key);
    put_text(answer, bytes, "metering", o->shown.metering);
    put_number(answer, bytes, "tau_light", c->tau_light_s);
    put_number(answer, bytes, "tau_dark", c->tau_dark_s);
    put_number(answer, bytes, "gain_max", known(o->gain_max));
    put_number(answer, bytes, "shutter_max", known(o->exposure_max_s));
    put_text(answer, bytes, "day_night", e->day_night);
    const size_t used = strlen(answer);
    snprintf(answer + used, bytes - used, ",\"lock\":%s}", c->lock ? "true" : "false");
}

/* --- changes --- */

static int set_lock(run_options *o, const char *value, pupil_why *why)
{
    const int on = strcmp(value, "on") == 0;
    if (!on && strcmp(value, "off") != 0)
        return pupil_refuse(why, "lock %s: must be on or off", *value ? value : "\"\"");
    o->shown.config.lock = (uint32_t)on;
    o->locked = on;
    return 0;
}

/* "off" removes a setting that the camera does not need. 1: removed. */
static int set_off(run_options *o, const char *name)
{
    pupil_config *c = &o->shown.config;
    if (strcmp(name, "gain-max") == 0) {
        o->gain_max = 0.0;
    } else if (strcmp(name, "shutter-max") == 0) {
        o->exposure_max_s = 0.0;
    } else if (strcmp(name, "day-night") == 0) {
        o->day_night_s = 0.0;
    } else if (strcmp(name, "key-at") == 0) {
        c->key_points = 0;
    } else if (strcmp(name, "trim") == 0) {
        c->trim_low = 0.0f;
        c->trim_high = 1.0f;
    } else if (strcmp(name, "roi") == 0) {
        pupil_metering_uniform(c);
        strcpy(o->shown.metering, "uniform");
    } else {
        return 0;
    }
    return 1;
}

static int set(run_options *o, const char *name, const char *text, pupil_why *why)
{
    const option_row *row;
    size_t base;
    for (size_t n = 0; (row = options_row(&run_command, n, &base)); n++) {
        const option_value value = {row, text, NULL, (char *)o + base, why};
        if (strcmp(row->name, name) != 0)
            continue;
        if (strcmp(name, "key") == 0)
            o->shown.config.key_points = 0; /* one key in any light */
        return row->parse ? row->parse(&value) : option_take(&value);
    }
    return pupil_refuse(why, "%s: no such command", name);
}

static int is_changeable(const char *name)
{
    for (size_t i = 0; i < sizeof changeable / sizeof *changeable; i++)
        if (strcmp(name, changeable[i]) == 0)
            return 1;
    return 0;
}

/* Checks a change against the run's mode and camera. */
static int check(const run_ask *a, const run_options *o, const char *name, pupil_why *why)
{
    const char *fault = "";
    const int is_day_night = strcmp(name, "day-night") == 0 && o->day_night_s > 0.0;
    const int is_limit = is_day_night || strcmp(name, "gain-max") == 0 || strcmp(name, "shutter-max") == 0;
    if (strncmp(name, "tau-", 4) == 0 && o->shown.config.law != PUPIL_LAW_SECONDS)
        return pupil_refuse(why, "%s: belongs to the default law", name);
    if (is_limit && !(a->gain_min > 0.0))
        return pupil_refuse(why, "%s: nothing of this camera is controlled", name);
    if ((o->gain_max > 0.0 && o->gain_max < a->gain_min) ||
        (o->exposure_max_s > 0.0 && o->exposure_max_s < a->exposure_min_s))
        return pupil_refuse(why, "%s: this camera has gains from %.4g on, and exposes for %.6g ms or longer", name,
                            a->gain_min, a->exposure_min_s * 1e3);
    if (pupil_config_check(&o->shown.config, &fault))
        return pupil_refuse(why, "%s: %s", name, fault);
    return 0;
}

/* "STOPS[,FRAMES]": an announced change of light. */
static int announce(run_ask *a, const char *name, const char *text, pupil_why *why)
{
    const uint32_t what = strcmp(name, "filter") == 0 ? PUPIL_SENSOR_CHANGE_FILTER : PUPIL_SENSOR_CHANGE_LIGHT;
    char *end;
    unsigned long frames = USUAL_FRAMES;
    pupil_why words;
    const double ev = strtod(text, &end);
    int wrong = end == text || !(ev >= -32.0 && ev <= 32.0);
    if (!wrong && *end == ',') {
        const char *number = end + 1;
        frames = strtoul(number, &end, 10);
        wrong = *number < '0' || *number > '9' || frames < 1 || frames > 1000;
    }
    if (wrong || *end)
        return pupil_refuse(why,
                            "%s %s: must be stops from -32 to 32, and after a comma frames from 1 to 1000, for "
                            "example +4,30",
                            name, *text ? text : "\"\"");
    return run_sensor_announce(a->sensor, ev, (uint32_t)frames, what, &words)
               ? pupil_refuse(why, "%s: %s", name, words.text)
               : 0;
}

static int change(run_ask *a, const char *name, const char *text, pupil_why *why)
{
    static run_options tried;
    int failed = 0;
    if (strcmp(name, "light") == 0 || strcmp(name, "filter") == 0)
        return announce(a, name, text, why);
    tried = *a->options;
    if (strcmp(name, "lock") == 0)
        failed = set_lock(&tried, text, why);
    else if (!is_changeable(name))
        return pupil_refuse(why, "%s: no such command; there are %s", name, more);
    else if (!(strcmp(text, "off") == 0 && set_off(&tried, name)))
        failed = set(&tried, name, text, why);
    if (failed || check(a, &tried, name, why))
        return -1;
    *a->options = tried;
    frame_pipeline_retune(&a->session->pipeline, &a->options->shown.config);
    return 0;
}

void run_ask_line(void *ask, const char *line, char *answer, size_t bytes)
{
    run_ask *a = ask;
    pupil_why why = {""};
    char name[32], text[CONTROL_LINE_BYTES];
    line += strspn(line, blanks);
    const size_t length = strcspn(line, blanks);
    snprintf(name, sizeof name, "%.*s", (int)(length < 31 ? length : 31), line);
    snprintf(text, sizeof text, "%s", line + length + strspn(line + length, blanks));
    for (size_t end = strlen(text); end && strchr(blanks, text[end - 1]);)
        text[--end] = 0;
    const int is_status = strcmp(name, "status") == 0;
    if (is_status && !*text) {
        put_status(a, answer, bytes);
        return;
    }
    if (is_status)
        pupil_refuse(&why, "status takes nothing");
    else if (!*name)
        pupil_refuse(&why, "an empty command; there are %s", more);
    if (*why.text || change(a, name, text, &why)) {
        run_control_refuse(why.text, answer, bytes);
        return;
    }
    snprintf(answer, bytes, "{\"ok\":true");
    put_text(answer, bytes, "set", name);
    put_text(answer, bytes, "value", text);
    const size_t used = strlen(answer);
    snprintf(answer + used, bytes - used, ",\"from_frame\":%llu}", (unsigned long long)a->session->frames);
}

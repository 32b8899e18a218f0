#include "values.h"

#include "refuse.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int value_refuse(const value_text *c, const char *right)
{
    pupil_refuse(c->why, "--%s %s: must be %s", c->name, c->text, right);
    return OPTIONS_USAGE;
}

/* A number within a range; `right` says in words what would do. */
int value_number(const value_text *c, double low, double high, const char *right, double *value)
{
    char *end;
    errno = 0;
    double v = strtod(c->text, &end);
    if (end == c->text || *end || !(v >= low && v <= high))
        return value_refuse(c, right);
    *value = v;
    return OPTIONS_RUN;
}

int value_whole(const value_text *c, uint64_t low, uint64_t high, const char *right, uint64_t *value)
{
    char *end;
    errno = 0;
    unsigned long long v = strtoull(c->text, &end, 10);
    if (end == c->text || *end || errno || strchr(c->text, '-') || v < low || v > high)
        return value_refuse(c, right);
    *value = v;
    return OPTIONS_RUN;
}

/* One of a list of words; its place is the value. */
static int word(const value_text *c, const char *const *words, uint32_t *value)
{
    char right[256] = "";
    for (uint32_t i = 0; words[i]; i++) {
        if (strcmp(c->text, words[i]) == 0) {
            *value = i;
            return OPTIONS_RUN;
        }
        snprintf(right + strlen(right), sizeof right - strlen(right), "%s%s", i ? ", " : "", words[i]);
    }
    return value_refuse(c, right);
}

/* `count` numbers with commas (or, for a trim, a dash) between. */
static int numbers(const value_text *c, int count, const char *right, double *value)
{
    const char *p = c->text;
    for (int i = 0; i < count; i++) {
        char *end;
        value[i] = strtod(p, &end);
        if (end == p || !isfinite(value[i]) || (i + 1 < count ? *end != ',' : *end != 0))
            return value_refuse(c, right);
        p = end + 1;
    }
    return OPTIONS_RUN;
}

int value_of_size(const value_text *c)
{
    unsigned width, height;
    char rest;
    if (sscanf(c->text, "%ux%u%c", &width, &height, &rest) != 2 || strchr(c->text, '-') || !width || !height ||
        width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return value_refuse(c, "WIDTHxHEIGHT, for example 640x360, each from 1 to 16384");
    c->o->source.width = width;
    c->o->source.height = height;
    return OPTIONS_RUN;
}

int value_of_metering(const value_text *c)
{
    static const char *const words[] = {"uniform", "centre", "spot", NULL};
    uint32_t which = 0;
    if (strcmp(c->text, "center") != 0 && word(c, words, &which))
        return OPTIONS_USAGE;
    if (strcmp(c->text, "center") == 0)
        which = 1;
    if (which == 0)
        pupil_metering_uniform(&c->o->config);
    else if (which == 1)
        pupil_metering_centre(&c->o->config);
    else
        pupil_metering_spot(&c->o->config);
    snprintf(c->o->metering, sizeof c->o->metering, "%s", words[which]);
    return OPTIONS_RUN;
}

int value_of_roi(const value_text *c)
{
    const char *right = "X,Y,WIDTH,HEIGHT in fractions of the frame, for example 0.25,0.25,0.5,0.5";
    double v[4];
    if (numbers(c, 4, right, v))
        return OPTIONS_USAGE;
    if (pupil_metering_roi(&c->o->config, v[0], v[1], v[2], v[3]))
        return value_refuse(c, right);
    snprintf(c->o->metering, sizeof c->o->metering, "roi %s", c->text);
    return OPTIONS_RUN;
}

int value_of_trim(const value_text *c)
{
    const char *right = "LOW,HIGH in per cent, for example 5,95, with 0 <= LOW < HIGH <= 100";
    double v[2];
    if (numbers(c, 2, right, v))
        return OPTIONS_USAGE;
    if (!(v[0] >= 0.0 && v[0] < v[1] && v[1] <= 100.0))
        return value_refuse(c, right);
    c->o->config.trim_low = (float)(v[0] / 100.0);
    c->o->config.trim_high = (float)(v[1] / 100.0);
    return OPTIONS_RUN;
}

int value_of_meter_rows(const value_text *c)
{
    uint64_t n;
    if (value_whole(c, 1, 8, "1, 2, 4 or 8", &n))
        return OPTIONS_USAGE;
    if (n & (n - 1))
        return value_refuse(c, "1, 2, 4 or 8");
    c->o->config.meter_rows = (uint32_t)n;
    return OPTIONS_RUN;
}

int value_of_white(const value_text *c)
{
    pupil_config *config = &c->o->config;
    snprintf(c->o->white, sizeof c->o->white, "%s", c->text);
    config->white_mode = strcmp(c->text, "follow") == 0 ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_NONE;
    if (config->white_mode == PUPIL_WHITE_FOLLOW || strcmp(c->text, "none") == 0)
        return OPTIONS_RUN;
    config->white_mode = PUPIL_WHITE_FIXED;
    return value_number(c, 0x1p-8, 0x1p30, "follow, none, or a number from 0.0039 to 1e9", &config->white);
}

int value_of_formula(const value_text *c)
{
    uint64_t v;
    if (value_whole(c, 1, 4, "1, 2, 3 or 4", &v))
        return OPTIONS_USAGE;
    c->o->config.law = (uint32_t)(PUPIL_LAW_ARITHMETIC_SCALE + v - 1);
    return OPTIONS_RUN;
}

int value_of_weight(const value_text *c)
{
    const char *right = "above 0, up to 1";
    if (value_number(c, 0.0, 1.0, right, &c->o->config.frame_weight))
        return OPTIONS_USAGE;
    return c->o->config.frame_weight > 0.0 ? OPTIONS_RUN : value_refuse(c, right);
}

int value_of_threads(const value_text *c)
{
    uint64_t v;
    if (value_whole(c, 0, 256, "from 0 (one a processor) to 256", &v))
        return OPTIONS_USAGE;
    c->o->threads = (unsigned)v;
    c->o->source.threads = (unsigned)v;
    return OPTIONS_RUN;
}

int value_of_fps(const value_text *c)
{
    return value_number(c, 0.001, 1e5, "frames a second, from 0.001 to 100000", &c->o->source.fps);
}

int value_of_transfer(const value_text *c)
{
    static const char *const words[] = {"srgb", "gamma22", "linear", NULL};
    return word(c, words, &c->o->config.transfer);
}

int value_of_gles_version(const value_text *c)
{
    static const char *const words[] = {"3.0", "3.1", NULL};
    uint32_t which = 0;
    if (word(c, words, &which))
        return OPTIONS_USAGE;
    c->o->gles_version = which ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30;
    return OPTIONS_RUN;
}

int value_of_out(const value_text *c)
{
    if (c->o->out_count == FRAME_MOST_OUTPUTS)
        return value_refuse(c, "one of at most 16 outputs");
    if (!*c->text)
        return value_refuse(c, "a path");
    c->o->out[c->o->out_count++] = c->text;
    return OPTIONS_RUN;
}

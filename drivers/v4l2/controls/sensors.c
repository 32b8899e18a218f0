/* sensors.txt. It is a text that is built in and parsed for each look-up. People can read it, correct it and pass one
 * of their own to the same parser. A program that was installed needs no file next to it. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "camera_sensor_text.h"
#include "controls_private.h"
#include "number.h"

typedef struct reader {
    char words[512]; /* the line, cut into words */
    char *at, *end;
    int line;
    const char *fault;
} reader;

const char *pupil_camera_sensors(void)
{
    return text_sensors_txt;
}

static const char *next_word(reader *r)
{
    while (r->at < r->end && isspace((unsigned char)*r->at))
        r->at++;
    if (r->at >= r->end)
        return NULL;
    char *word = r->at;
    while (r->at < r->end && !isspace((unsigned char)*r->at))
        r->at++;
    *r->at = 0;
    if (r->at < r->end)
        r->at++;
    return word;
}

static double number(reader *r, double least, double most)
{
    const char *word = next_word(r);
    char *end;
    const double x = word ? pupil_parse_double(word, &end) : 0.0;
    if (!word || end == word || *end || !(x >= least && x <= most)) {
        r->fault = "a number is missing, or not one, or out of its range";
        return 0.0;
    }
    return x;
}

/* CODE:GAIN ... to the end of the line, or to a word without a colon. */
static void read_table(reader *r, pupil_camera_gain *gain)
{
    for (;;) {
        char *before = r->at, *end;
        while (before < r->end && isspace((unsigned char)*before))
            before++;
        if (before >= r->end || !isdigit((unsigned char)*before))
            break;
        const long code = strtol(before, &end, 10);
        const double value = *end == ':' ? pupil_parse_double(end + 1, &end) : 0.0;
        const uint32_t i = gain->rows;
        if (i == PUPIL_CAMERA_TABLE_ROWS || !(value > 0.0 && value <= 65536.0) || code < 0 || code > INT32_MAX ||
            (i && (code <= gain->code[i - 1] || value <= gain->gain[i - 1])) ||
            (*end && !isspace((unsigned char)*end))) {
            r->fault = "a table has up to 32 pairs CODE:GAIN, both rising";
            return;
        }
        gain->code[i] = (int32_t)code;
        gain->gain[i] = value;
        gain->rows++;
        r->at = end;
    }
    if (!gain->rows)
        r->fault = "a table has up to 32 pairs CODE:GAIN, both rising";
}

static void read_gain(reader *r, pupil_camera_gain *gain)
{
    const char *law = next_word(r);
    if (law && !strcmp(law, "ratio")) {
        gain->law = PUPIL_CAMERA_RATIO;
        for (int i = 0; i < 4; i++)
            gain->p[i] = number(r, -65536.0, 65536.0);
        if (!r->fault && !(gain->p[0] * gain->p[3] - gain->p[1] * gain->p[2] > 0.0))
            r->fault = "this ratio does not rise: P0 P3 must be above P1 P2";
    } else if (law && !strcmp(law, "db")) {
        gain->law = PUPIL_CAMERA_DB;
        gain->p[0] = number(r, 1e-4, 20.0);
    } else if (law && !strcmp(law, "octaves")) {
        gain->law = PUPIL_CAMERA_OCTAVES;
        gain->p[0] = number(r, 1.0, 65536.0);
    } else if (law && !strcmp(law, "table")) {
        gain->law = PUPIL_CAMERA_TABLE;
        read_table(r, gain);
    } else {
        r->fault = "gain is one of ratio, db, octaves, table";
    }
}

static void read_words(reader *r, pupil_camera_sensor *s)
{
    const char *word;
    int has_gain = 0;
    while (!r->fault && (word = next_word(r))) {
        if (!strcmp(word, "gain")) {
            read_gain(r, &s->gain);
            has_gain = 1;
        } else if (!strcmp(word, "delay")) {
            s->exposure_delay = (uint32_t)number(r, 1.0, 16.0);
            s->gain_delay = (uint32_t)number(r, 1.0, 16.0);
        } else if (!strcmp(word, "black")) {
            s->black = number(r, 0.0, 65534.0);
        } else if (!strcmp(word, "matrix")) {
            for (int i = 0; i < 9; i++)
                s->matrix[i] = (float)number(r, -16.0, 16.0);
            s->has_matrix = 1;
        } else if (!strcmp(word, "source")) {
            snprintf(s->source, sizeof s->source, "%.*s", (int)(r->end - r->at), r->at);
            r->at = r->end;
        } else {
            r->fault = "words are gain, delay, black, matrix, source";
        }
    }
    if (!r->fault && !has_gain)
        r->fault = "gain is missing";
}

/* "imx219" is the sensor of "imx219 10-0010", and not of "imx2190". */
static int names(const char *subdevice, const char *name)
{
    const size_t n = strlen(name);
    return !strncasecmp(subdevice, name, n) && (!subdevice[n] || isspace((unsigned char)subdevice[n]));
}

int pupil_camera_find_sensor(const char *text, const char *name, pupil_camera_sensor *sensor, pupil_why *why)
{
    int found = 0, line = 0;
    for (const char *at = text ? text : pupil_camera_sensors(); *at;) {
        const size_t length = strcspn(at, "\n");
        pupil_camera_sensor s = {.black = -1.0};
        reader r = {.line = ++line};
        const char *word;
        if (length >= sizeof r.words)
            return pupil_refuse(why, "sensors, line %d: longer than %zu characters", line, sizeof r.words - 1);
        memcpy(r.words, at, length);
        r.at = r.words;
        r.end = r.words + length;
        at += length + (at[length] == '\n');
        if (!(word = next_word(&r)) || *word == '#')
            continue;
        if (strlen(word) >= sizeof s.name)
            return pupil_refuse(why, "sensors, line %d: a name has at most %zu characters", line, sizeof s.name - 1);
        strcpy(s.name, word);
        read_words(&r, &s);
        if (r.fault)
            return pupil_refuse(why, "sensors, line %d (%s): %s", line, s.name, r.fault);
        if (!found && name && names(name, s.name)) {
            *sensor = s;
            found = 1;
        }
    }
    return found;
}

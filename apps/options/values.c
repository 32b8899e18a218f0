/* Checks options' texts, and turns them into settings. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "option_table.h"
#include "refuse.h"

int option_refuse(const option_value *v, const char *right)
{
    char own[512];
    option_right(v->row, own, sizeof own);
    return pupil_refuse(v->why, "--%s %s: must be %s", v->row->name, *v->text ? v->text : "\"\"", right ? right : own);
}

int option_number(const option_value *v, double low, double high, double *number)
{
    char *end;
    const double x = strtod(v->text, &end);
    if (end == v->text || *end || !(x >= low && x <= high))
        return option_refuse(v, NULL);
    *number = x;
    return OPTIONS_RUN;
}

int option_whole(const option_value *v, double low, double high, uint64_t *whole)
{
    char *end;
    errno = 0;
    const unsigned long long n = strtoull(v->text, &end, 10);
    if (*v->text < '0' || *v->text > '9' || *end || errno || !((double)n >= low && (double)n <= high))
        return option_refuse(v, NULL);
    *whole = n;
    return OPTIONS_RUN;
}

/* [HOURS:]MINUTES:SECONDS, as in ffmpeg and players; -1: not of this form. */
static double clock_s(const char *text)
{
    double s = 0.0;
    int parts = 0;
    for (char *end; parts < 3; parts++, text = end + 1) {
        const double part = strtod(text, &end);
        if (*text < '0' || *text > '9' || strspn(text, "0123456789.") != (size_t)(end - text) ||
            (*end == ':' && memchr(text, '.', (size_t)(end - text))) || (parts > 0 && part >= 60.0))
            return -1.0;
        s = 60.0 * s + part;
        if (!*end)
            return parts > 0 ? s : -1.0;
        if (*end != ':')
            return -1.0;
    }
    return -1.0;
}

static int take_clock(const option_value *v, double low_s, double high_s, double *seconds)
{
    const double s = clock_s(v->text);
    if (s < 0.0 || !(s >= low_s && s <= high_s))
        return option_refuse(v, NULL);
    *seconds = s;
    return OPTIONS_RUN;
}

int option_time(const option_value *v, double low_s, double high_s, double *seconds)
{
    static const struct {
        const char *name;
        double s;
    } units[] = {{"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}, {"min", 60.0}};
    char *end;
    double s = strtod(v->text, &end);
    double unit_s = v->row->unit_s;
    if (unit_s == 1.0 && strchr(v->text, ':'))
        return take_clock(v, low_s, high_s, seconds);
    if (end == v->text)
        return option_refuse(v, NULL);
    if (*end == '/') {
        const char *below = end + 1;
        s /= strtod(below, &end);
        unit_s = 1.0;
        if (end == below)
            return option_refuse(v, NULL);
    }
    for (size_t i = 0; *end && i < sizeof units / sizeof units[0]; i++)
        if (strcmp(end, units[i].name) == 0) {
            unit_s = units[i].s;
            end += strlen(end);
        }
    s *= unit_s;
    if (*end || !(s >= low_s && s <= high_s))
        return option_refuse(v, NULL);
    *seconds = s;
    return OPTIONS_RUN;
}

int option_numbers(const option_value *v, int count, double *numbers)
{
    const char *p = v->text;
    for (int i = 0; i < count; i++) {
        char *end;
        numbers[i] = strtod(p, &end);
        if (end == p || !isfinite(numbers[i]) || *end != (i + 1 < count ? ',' : 0))
            return option_refuse(v, NULL);
        p = end + 1;
    }
    return OPTIONS_RUN;
}

const char *option_words_of(const option_row *row)
{
    return row->words ? row->words : row->value;
}

int option_word(const char *text, const char *words)
{
    for (int i = 0;; i++) {
        const size_t length = strcspn(words, "|");
        if (strlen(text) == length && strncmp(text, words, length) == 0)
            return i;
        if (!words[length])
            return -1;
        words += length + 1;
    }
}

static int take_size(const option_value *v, uint32_t *size)
{
    unsigned long width, height;
    int used = 0;
    if (sscanf(v->text, "%6lux%6lu%n", &width, &height, &used) != 2 || v->text[used] || strpbrk(v->text, "+- ") ||
        !width || !height || (double)width > v->row->high || (double)height > v->row->high)
        return option_refuse(v, NULL);
    size[0] = (uint32_t)width;
    size[1] = (uint32_t)height;
    return OPTIONS_RUN;
}

int option_take(const option_value *v)
{
    const option_row *row = v->row;
    void *place = (char *)v->options + row->offset;
    uint64_t whole = 0;
    int result = OPTIONS_RUN;
    int word;
    switch (row->kind) {
    case OPTION_NUMBER:
        return option_number(v, row->low, row->high, place);
    case OPTION_COUNT:
        return option_whole(v, row->low, row->high, place);
    case OPTION_COUNT32:
        result = option_whole(v, row->low, row->high, &whole);
        if (result == OPTIONS_RUN)
            *(uint32_t *)place = (uint32_t)whole;
        return result;
    case OPTION_CHOICE:
        word = option_word(v->text, option_words_of(row));
        if (word < 0)
            return option_refuse(v, NULL);
        *(uint32_t *)place = (uint32_t)row->low + (uint32_t)word;
        return OPTIONS_RUN;
    case OPTION_TIME:
        return option_time(v, row->low, row->high, place);
    case OPTION_SIZE:
        return take_size(v, place);
    case OPTION_TEXT:
    case OPTION_PATH:
        if (!*v->text)
            return option_refuse(v, NULL);
        *(const char **)place = v->text;
        return OPTIONS_RUN;
    case OPTION_PAIR:
        ((const char **)place)[0] = v->text;
        ((const char **)place)[1] = v->second;
        return OPTIONS_RUN;
    default:
        *(int *)place = 1;
        return OPTIONS_RUN;
    }
}

/* "seconds, from 0 to 10", "a whole number, 1 or more" */
static void range(const option_row *row, const char *unit, char *text, size_t bytes)
{
    const char *what = row->unit ? row->unit : unit;
    const char *comma = row->unit || row->high > 1e10 ? "," : "";
    if (row->high > 1e10)
        snprintf(text, bytes, "%s%s %.15g or more", what, comma, row->low);
    else
        snprintf(text, bytes, "%s%s from %.15g to %.15g", what, comma, row->low, row->high);
}

/* "a, b or c", or for many words "one of a b c" */
static void alternatives(const option_row *row, char *text, size_t bytes)
{
    size_t length = 0;
    const char *words = option_words_of(row);
    for (const char *word = words; *word; word += strcspn(word, "|"), word += *word == '|') {
        const char *before = word == words       ? row->words ? "one of " : ""
                             : row->words        ? " "
                             : strchr(word, '|') ? ", "
                                                 : " or ";
        length += (size_t)snprintf(text + length, bytes - length, "%s%.*s", before, (int)strcspn(word, "|"), word);
    }
}

void option_right(const option_row *row, char *text, size_t bytes)
{
    switch (row->right ? OPTION_FLAG : row->kind) {
    case OPTION_NUMBER:
        range(row, "a number", text, bytes);
        break;
    case OPTION_COUNT:
    case OPTION_COUNT32:
        range(row, "a whole number", text, bytes);
        break;
    case OPTION_CHOICE:
        alternatives(row, text, bytes);
        break;
    case OPTION_SIZE:
        snprintf(text, bytes, "WIDTHxHEIGHT, for example 640x360, each from 1 to %.15g", row->high);
        break;
    case OPTION_TEXT:
    case OPTION_PATH:
        snprintf(text, bytes, "%s", row->kind == OPTION_PATH ? "a path" : row->value);
        break;
    default:
        snprintf(text, bytes, "%s", row->right ? row->right : "");
    }
}

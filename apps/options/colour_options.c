#include "colour_options.h"

#include <stdio.h>
#include <string.h>

/* One of the two words, or `count` numbers within a range. */
static int take(const option_value *v, uint32_t *choice, float *given, int count, double low, double high)
{
    double number[9];
    const int word = option_word(v->text, "auto|off");
    if (word >= 0) {
        *choice = word == 0 ? PUPIL_COLOUR_AUTO : PUPIL_COLOUR_OFF;
        return OPTIONS_RUN;
    }
    if (option_numbers(v, count, number))
        return OPTIONS_USAGE;
    for (int i = 0; i < count; i++) {
        if (!(number[i] >= low && number[i] <= high))
            return option_refuse(v, NULL);
        given[i] = (float)number[i];
    }
    *choice = PUPIL_COLOUR_GIVEN;
    return OPTIONS_RUN;
}

static pupil_colour_options *options_of(const option_value *v)
{
    return (pupil_colour_options *)((char *)v->options + v->row->offset);
}

int colour_option_balance(const option_value *v)
{
    pupil_colour_options *o = options_of(v);
    return take(v, &o->balance, o->given_balance, 3, 0x1p-10, 0x1p10);
}

int colour_option_matrix(const option_value *v)
{
    pupil_colour_options tried = *options_of(v);
    int zeros = 0;
    if (take(v, &tried.matrix, tried.given_matrix, 9, -16.0, 16.0))
        return OPTIONS_USAGE;
    for (int i = 0; i < 9; i++)
        zeros += tried.given_matrix[i] == 0.0f;
    if (tried.matrix == PUPIL_COLOUR_GIVEN && zeros == 9)
        return option_refuse(v, NULL);
    *options_of(v) = tried;
    return OPTIONS_RUN;
}

int colour_option_black(const option_value *v)
{
    pupil_colour_options *o = options_of(v);
    return take(v, &o->black, &o->given_black, 1, 0.0, 65534.0);
}

int colour_option_knees(const option_value *v)
{
    pupil_colour_options *o = options_of(v);
    pupil_coding tried = {.size_bytes = sizeof tried};
    const char *p = v->text, *end = "";
    do {
        const uint32_t k = tried.knees++;
        int used = 0;
        if (k == PUPIL_KNEES || sscanf(p, "%f:%f%n", &tried.knee_code[k], &tried.knee_light[k], &used) != 2)
            return option_refuse(v, NULL);
        end = p + used;
        p = end + 1;
    } while (*end == ',');
    if (*end || pupil_coding_check(&tried, PUPIL_PIXEL_GREY16, NULL) != PUPIL_OK)
        return option_refuse(v, NULL);
    o->knees = tried.knees;
    memcpy(o->knee_code, tried.knee_code, sizeof o->knee_code);
    memcpy(o->knee_light, tried.knee_light, sizeof o->knee_light);
    return OPTIONS_RUN;
}

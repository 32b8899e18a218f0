#include "colour_options.h"

#include <stdlib.h>
#include <string.h>

#include "refuse.h"

/* 1: `text` is one of the two words. */
static int is_word(const char *text, uint32_t *choice)
{
    if (strcmp(text, "auto") != 0 && strcmp(text, "off") != 0)
        return 0;
    *choice = *text == 'a' ? PUPIL_COLOUR_AUTO : PUPIL_COLOUR_OFF;
    return 1;
}

/* `count` numbers with commas between; 0 where they are all there and within the range. */
static int numbers(const char *text, int count, double low, double high, float *value)
{
    for (int i = 0; i < count; i++) {
        char *end;
        const double v = strtod(text, &end);
        if (end == text || !(v >= low && v <= high) || *end != (i + 1 < count ? ',' : 0))
            return -1;
        value[i] = (float)v;
        text = end + 1;
    }
    return 0;
}

int colour_option_balance(pupil_colour_options *options, const char *text, pupil_why *why)
{
    if (is_word(text, &options->balance))
        return 0;
    if (numbers(text, 3, 0x1p-10, 0x1p10, options->given_balance))
        return pupil_refuse(why,
                            "--white-balance %s: must be auto, off, or factors R,G,B from 0.001 to 1024, for example "
                            "1.9,1,1.6",
                            text);
    options->balance = PUPIL_COLOUR_GIVEN;
    return 0;
}

int colour_option_matrix(pupil_colour_options *options, const char *text, pupil_why *why)
{
    float sum = 0.0f;
    if (is_word(text, &options->matrix))
        return 0;
    int wrong = numbers(text, 9, -16.0, 16.0, options->given_matrix);
    for (int i = 0; i < 9 && !wrong; i++)
        sum += options->given_matrix[i] < 0.0f ? -options->given_matrix[i] : options->given_matrix[i];
    if (wrong || !(sum > 0.0f))
        return pupil_refuse(why,
                            "--matrix %s: must be auto, off, or 9 numbers from -16 to 16, row by row, with commas "
                            "between, that take the sensor's red, green and blue to those of the picture",
                            text);
    options->matrix = PUPIL_COLOUR_GIVEN;
    return 0;
}

int colour_option_black(pupil_colour_options *options, const char *text, pupil_why *why)
{
    if (is_word(text, &options->black))
        return 0;
    if (numbers(text, 1, 0.0, 65534.0, &options->given_black))
        return pupil_refuse(why,
                            "--black-level %s: must be auto, off, or the code of no light in the camera's format, from "
                            "0 to 65534, for example 64 of 10 bits",
                            text);
    options->black = PUPIL_COLOUR_GIVEN;
    return 0;
}

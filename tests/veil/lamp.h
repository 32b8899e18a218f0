/* tests/veil/lamp.h: a lamp of one pixel, anywhere in a square frame. */
#ifndef PUPIL_TESTS_VEIL_LAMP_H
#define PUPIL_TESTS_VEIL_LAMP_H

#include <math.h>

#include "check.h"

typedef struct lamp {
    int x, y;
    float rgb[3];
} lamp;

/* 1 to 256 times as bright as the darkest, of any colour. */
static inline lamp lamp_anywhere(int side)
{
    lamp l;
    const double bright = exp2(8 * check_uniform());
    l.x = (int)(check_uniform() * side);
    l.y = (int)(check_uniform() * side);
    for (int c = 0; c < 3; c++)
        l.rgb[c] = (float)(bright * (0.2 + check_uniform()));
    return l;
}

#endif

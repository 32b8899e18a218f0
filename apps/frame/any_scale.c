#include "any_scale.h"

#include <math.h>
#include <stdlib.h>

/* The share of the pixels with light that is darker than what the scale is chosen by: the bright part of the picture,
 * but no lamp and no sun. */
#define BRIGHT_SHARE 0.95
/* log2 of that light where frames are left alone, with their bits: down to a dark room, up to the sun in its units. */
#define LEAST_EV (-6)
#define MOST_EV  16
/* Where it is else: 18 stops above the default floor, 26 below the largest luminance. */
#define WANTED_EV  4
#define MOST_STOPS 60  /* pupil.h: gain is from 2^-64 to 2^64 */
#define SAMPLES    256 /* rows, and pixels of a row, that are looked at */

/* Floats of a pixel; 0: not a format of floats. */
static size_t floats_of(uint32_t pixel)
{
    if (pixel == PUPIL_PIXEL_RGBA32F)
        return 4;
    return pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_BGR32F ? 3 : 0;
}

/* Whole stops of the light that BRIGHT_SHARE of the pixels with light are below. 0: there is no light. */
static int find_bright(const pupil_image_const *image, size_t floats, int *bright_ev)
{
    enum { LOWEST = -149, EXPONENTS = 278 };
    size_t count[EXPONENTS] = {0}, pixels = 0, below = 0;
    const uint32_t step_x = (image->width + SAMPLES - 1) / SAMPLES, step_y = (image->height + SAMPLES - 1) / SAMPLES;
    for (uint32_t y = 0; y < image->height; y += step_y) {
        const float *row = pupil_image_rows(*image, y, 1).data;
        for (uint32_t x = 0; x < image->width; x += step_x) {
            const float *p = row + x * floats;
            const float most = fmaxf(p[0], fmaxf(p[1], p[2]));
            if (!(most > 0.0f && isfinite(most)))
                continue;
            count[ilogbf(most) - LOWEST]++;
            pixels++;
        }
    }
    int i = 0;
    while (pixels && (double)(below += count[i]) < BRIGHT_SHARE * (double)pixels)
        i++;
    *bright_ev = i + LOWEST;
    return pixels > 0;
}

static int stops_for(int bright_ev)
{
    if (bright_ev >= LEAST_EV && bright_ev <= MOST_EV)
        return 0;
    const int stops = WANTED_EV - bright_ev;
    return stops < -MOST_STOPS ? -MOST_STOPS : stops > MOST_STOPS ? MOST_STOPS : stops;
}

static int make_room(any_scale *a, size_t bytes, pupil_why *why)
{
    if (bytes <= a->bytes)
        return 0;
    free(a->memory);
    a->memory = malloc(bytes);
    a->bytes = a->memory ? bytes : 0;
    return a->memory ? 0 : pupil_refuse(why, "not enough memory");
}

static int multiply(any_scale *a, pupil_image_const *image, size_t floats, pupil_why *why)
{
    const size_t row_floats = image->width * floats;
    const float factor = ldexpf(1.0f, a->stops);
    if (make_room(a, row_floats * image->height * sizeof(float), why))
        return -1;
    for (uint32_t y = 0; y < image->height; y++) {
        const float *from = pupil_image_rows(*image, y, 1).data;
        float *to = a->memory + y * row_floats;
        for (size_t i = 0; i < row_floats; i++)
            to[i] = floats == 4 && i % 4 == 3 ? from[i] : from[i] * factor;
    }
    image->data = a->memory;
    image->stride_bytes = (ptrdiff_t)(row_floats * sizeof(float));
    return 0;
}

int any_scale_take(any_scale *a, pupil_frame *frame, pupil_why *why)
{
    const size_t floats = floats_of(frame->image.pixel);
    pupil_frame_info *info = &frame->info;
    int bright_ev;
    if (!floats)
        return 0;
    if (!a->known && find_bright(&frame->image, floats, &bright_ev)) {
        a->stops = stops_for(bright_ev);
        a->known = 1;
    }
    if (!a->stops)
        return 0;
    info->exposure_s = info->exposure_s > 0.0 ? info->exposure_s : 1.0;
    info->gain = ldexp(info->gain > 0.0 ? info->gain : 1.0, a->stops);
    return multiply(a, &frame->image, floats, why);
}

void any_scale_forget(any_scale *a)
{
    a->known = 0;
    a->stops = 0;
}

void any_scale_close(any_scale *a)
{
    free(a->memory);
    *a = (any_scale){0};
}

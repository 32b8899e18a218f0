#include "any_scale.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The scale is chosen by this quantile of the pixels with light: the bright part of the picture, but no lamp and no
 * sun. */
#define BRIGHT_SHARE 0.95
/* The range of that light, log2, in which frames are left unchanged: from a dark room to the sun in its units. */
#define LEAST_EV (-6)
#define MOST_EV  16
/* Other light is scaled to this: 18 stops above the default floor, 26 below the largest luminance. */
#define WANTED_EV  4
#define MOST_STOPS 60 /* pupil.h: gain is from 2^-64 to 2^64 */
/* How many rows, and pixels of a row, are looked at for the unit; and in each later frame, only for noise. */
#define SAMPLES       256
#define LATER_SAMPLES 64
/* A frame is noise if this share of its pixels is dark in each channel: behind a lens cap it is half. Their quantile at
 * this share is scaled to NOISE_EV. The standard deviation is 2 to 4 times that: a 64th to a 32nd of the default floor,
 * so as dark as 8-bit noise at the limit of amplification (docs/pictures.md). */
#define NOISE_SHARE 0.25
#define NOISE_EV    (-21)
/* At this distance to the right, beyond the reach of a demosaicing or a lens, noise is uncorrelated; dark areas in a
 * picture of strong colours are larger. The correlation is 0 for noise, 1 for areas; fewer pairs than NOISE_PAIRS say
 * nothing. */
#define NOISE_REACH       4
#define NOISE_CORRELATION 0.5
#define NOISE_PAIRS       64

enum { LOWEST = -149, EXPONENTS = 278 }; /* of floats */

/* Floats of a pixel; 0: not a format of floats. */
static size_t floats_of(uint32_t pixel)
{
    if (pixel == PUPIL_PIXEL_RGBA32F)
        return 4;
    return pixel == PUPIL_PIXEL_RGB32F || pixel == PUPIL_PIXEL_BGR32F ? 3 : 0;
}

int any_scale_concerns(const pupil_frame *frame)
{
    return floats_of(frame->image.pixel) != 0 && !(frame->code_light > 0.0f);
}

/* What a frame's samples say of its unit. */
typedef struct sight {
    size_t stops[EXPONENTS]; /* pixels, by the exponent of their brightest channel, if that is above 0 */
    size_t lit, pixels;
    size_t dark[3];        /* per channel: below 0, or 0 while another one is above */
    size_t pairs, both[3]; /* pairs of a pixel and the one to its right; pairs with both dark */
} sight;

static int is_dark(const float rgb[3], int channel)
{
    const float most = fmaxf(rgb[0], fmaxf(rgb[1], rgb[2]));
    return rgb[channel] < 0.0f || (rgb[channel] == 0.0f && most > 0.0f);
}

/* right: the pixel to its right, or NULL. */
static void look_at(sight *s, const float rgb[3], const float *right)
{
    const float most = fmaxf(rgb[0], fmaxf(rgb[1], rgb[2]));
    if (!isfinite(rgb[0]) || !isfinite(rgb[1]) || !isfinite(rgb[2]))
        return;
    s->pixels++;
    s->pairs += right != 0;
    for (int c = 0; c < 3; c++) {
        s->dark[c] += (size_t)is_dark(rgb, c);
        s->both[c] += right && is_dark(rgb, c) && is_dark(right, c);
    }
    if (most > 0.0f) {
        s->stops[ilogbf(most) - LOWEST]++;
        s->lit++;
    }
}

static sight look(const pupil_image_const *image, size_t floats, uint32_t samples)
{
    sight s = {0};
    const uint32_t step_x = (image->width + samples - 1) / samples, step_y = (image->height + samples - 1) / samples;
    for (uint32_t y = 0; y < image->height; y += step_y) {
        const float *row = pupil_image_rows(*image, y, 1).data;
        for (uint32_t x = 0; x < image->width; x += step_x)
            look_at(&s, row + x * floats, image->width - x > NOISE_REACH ? row + (x + NOISE_REACH) * floats : 0);
    }
    return s;
}

/* The quantile of the light at a share of the pixels with light, in whole stops. */
static int quantile(const sight *s, double share)
{
    size_t below = 0;
    int i = 0;
    while ((double)(below += s->stops[i]) < share * (double)s->lit)
        i++;
    return i + LOWEST;
}

/* Light is not below 0; colours of a wider gamut are below 0 in one channel. Below 0 in all three, and not in areas, is
 * sensor noise. */
static int is_noise(const sight *s)
{
    if (s->pairs < NOISE_PAIRS)
        return 0;
    for (int c = 0; c < 3; c++) {
        const double share = (double)s->dark[c] / (double)s->pixels, both = (double)s->both[c] / (double)s->pairs;
        if (share < NOISE_SHARE || both - share * share > NOISE_CORRELATION * (share - share * share))
            return 0;
    }
    return 1;
}

static int stops_for(const sight *s)
{
    const int bright_ev = quantile(s, BRIGHT_SHARE);
    return bright_ev >= LEAST_EV && bright_ev <= MOST_EV ? 0 : WANTED_EV - bright_ev;
}

static int bounded(int stops)
{
    return stops < -MOST_STOPS ? -MOST_STOPS : stops > MOST_STOPS ? MOST_STOPS : stops;
}

/* The first frame with light sets the unit, and the first frame of noise the scale of noise: it is the sensor's. */
static void choose(any_scale *a, const sight *s)
{
    const int noise = is_noise(s);
    if (noise && !a->noise_known) {
        a->noise_known = 1;
        a->noise_stops = bounded(NOISE_EV - quantile(s, NOISE_SHARE));
    }
    if (!noise && !a->known) {
        a->known = 1;
        a->unit_stops = bounded(stops_for(s));
    }
    a->stops = noise ? a->noise_stops : a->unit_stops;
    a->noise_frames += (unsigned)noise;
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

/* Once a frame had a gain, each needs one: without it the library takes the last. */
static void state_gain(const any_scale *a, pupil_frame_info *info)
{
    if (!a->unit_stops && !a->noise_known)
        return;
    info->exposure_s = info->exposure_s > 0.0 ? info->exposure_s : 1.0;
    info->gain = ldexp(info->gain > 0.0 ? info->gain : 1.0, a->stops);
}

int any_scale_take(any_scale *a, pupil_frame *frame, pupil_why *why)
{
    const size_t floats = floats_of(frame->image.pixel);
    if (!any_scale_concerns(frame)) {
        a->stops = 0;
        state_gain(a, &frame->info);
        return 0;
    }
    const sight s = look(&frame->image, floats, a->known ? LATER_SAMPLES : SAMPLES);
    if (s.lit)
        choose(a, &s);
    else if (!a->stops)
        a->stops = a->unit_stops;
    state_gain(a, &frame->info);
    return a->stops ? multiply(a, &frame->image, floats, why) : 0;
}

void any_scale_describe(const any_scale *a, char *text, size_t text_bytes)
{
    *text = 0;
    if (a->noise_frames)
        snprintf(text, text_bytes, "; %llu frames are noise, and stay dark", a->noise_frames);
    else if (a->unit_stops)
        snprintf(text, text_bytes, "; the light is multiplied by 2^%d: it is far from 1", a->unit_stops);
}

void any_scale_forget(any_scale *a)
{
    a->known = 0;
    a->noise_known = 0;
    a->unit_stops = 0;
    a->stops = 0;
}

void any_scale_close(any_scale *a)
{
    free(a->memory);
    *a = (any_scale){0};
}

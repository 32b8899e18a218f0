/* tests/frames.h: frames to meter and map, the easy ones and the hard ones. Random numbers come from check.h, through a
 * function that the program passes (a program has one stream of them). */
#ifndef PUPIL_TESTS_FRAMES_H
#define PUPIL_TESTS_FRAMES_H

#include "pupil/image.h"

#include <stdint.h>

typedef struct frame {
    pupil_image_const image;
    unsigned char *memory;        /* with 64 bytes of guard before and after */
    size_t bytes;                 /* of the memory, guards and all */
    unsigned char *chroma_memory; /* of the second plane, likewise; NULL: none */
    unsigned char *cr_memory;     /* of the third */
    size_t chroma_bytes;          /* of each of these two */
} frame;

typedef double frame_random(void); /* in [0, 1) */

/* padding: bytes between rows (a multiple of the sample's size); upside_down: negative stride. Everything is filled
 * with 0xff, which is NaN in the float formats. */
frame frame_make(uint32_t width, uint32_t height, uint32_t pixel, size_t padding, int upside_down);
void frame_free(frame *f);
pupil_image frame_writable(const frame *f);

/* Whether each pixel has red, green and blue; whether blue comes first. */
int frame_is_rgb(uint32_t pixel);
int frame_blue_first(uint32_t pixel);

/* This size, rounded up to one that the format can have. */
void frame_fit(uint32_t pixel, uint32_t *width, uint32_t *height);

/* 1 if all planes are the same, byte for byte. */
int frame_equal(const frame *a, const frame *b);

/* 1 if nothing outside the pixels has changed since frame_make. */
int frame_guards_intact(const frame *f);

/* Stores a colour: clamped and rounded in integer formats, sRGB-encoded in 8 bit, rounded to nearest in half. Y'CbCr,
 * grey and mosaics, which hold less than a colour per pixel, get a value that rises and falls with it. */
void frame_set(frame *f, uint32_t x, uint32_t y, double r, double g, double b, double a);
void frame_fill(frame *f, double r, double g, double b);

/* Values as from a camera: log-normal luminance around `middle`, with colour. */
void frame_lognormal(frame *f, double middle, double sigma_stops, frame_random *random);
void frame_gradient(frame *f, double from, double to); /* geometric, along both sides */
void frame_checker(frame *f, double a, double b);
void frame_one(frame *f, double background, double bright, frame_random *random); /* one bright pixel */
/* Every special value in turn: NaN, Inf, -Inf, negative, zero, denormal, floor, 2^30, the largest float, ordinary. */
void frame_odd(frame *f, frame_random *random);
void frame_bits(frame *f, frame_random *random); /* any bytes at all */

uint16_t frame_half(double value); /* to nearest even */

#endif

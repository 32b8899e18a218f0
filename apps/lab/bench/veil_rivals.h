/* apps/lab/bench/veil_rivals.h: what one might use instead of a series. Each sums the bells of some lights at pixel
 * centres; a bell is a Gaussian that is cut off at four standard deviations. */
#ifndef PUPIL_APPS_LAB_BENCH_VEIL_RIVALS_H
#define PUPIL_APPS_LAB_BENCH_VEIL_RIVALS_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/veil.h"

typedef struct veil_lights {
    uint32_t side; /* of the picture, pixels */
    double sigma_px;
    const pupil_veil_spot *spot;
    size_t count;
} veil_lights;

/* Light by light, each in the square that its bell covers: 3 floats a pixel. */
void veil_direct(const veil_lights *lights, float *rgb);

/* The same in double precision, one channel: the reference for all. */
void veil_exact(const veil_lights *lights, int channel, double *sum);

/* As bloom is made in games: the lights as pixels, halved seven times (a tent of 1 3 3 1), each level enlarged
 * bilinearly to the next one and added with weights fitted to the bell by least squares. */
typedef struct veil_pyramid veil_pyramid;
veil_pyramid *veil_pyramid_open(uint32_t side, double sigma_px); /* NULL: not enough memory */
void veil_pyramid_run(veil_pyramid *p, const veil_lights *lights, float *rgb);
void veil_pyramid_close(veil_pyramid *p);

/* Convolution by FFT, by FFTW. NULL: not enough memory, or (why) this program is built without it. */
typedef struct veil_fft veil_fft;
veil_fft *veil_fft_open(uint32_t side, double sigma_px, const char **why);
void veil_fft_run(veil_fft *f, const veil_lights *lights, float *rgb);
void veil_fft_close(veil_fft *f);

#endif

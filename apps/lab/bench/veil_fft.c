/* Lights by convolution: a forward FFT, times the bell's transform, and back; the picture is padded by the bell's
 * reach. */
#include "veil_rivals.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct veil_fft {
    uint32_t side, room;
    float *plane;
    fftwf_complex *terms, *bell;
    fftwf_plan there, back;
};

static size_t terms_of(const veil_fft *f)
{
    return (size_t)f->room * (f->room / 2 + 1);
}

static void transform_bell(veil_fft *f, double sigma)
{
    const int reach = (int)floor(4 * sigma);
    const uint32_t room = f->room;
    memset(f->plane, 0, (size_t)room * room * sizeof *f->plane);
    for (int y = -reach; y <= reach; y++)
        for (int x = -reach; x <= reach; x++)
            f->plane[(size_t)((y + (int)room) % (int)room) * room + (size_t)((x + (int)room) % (int)room)] =
                (float)(exp(-0.5 * (x * x + y * y) / (sigma * sigma)) / ((double)room * room));
    fftwf_execute(f->there);
    memcpy(f->bell, f->terms, terms_of(f) * sizeof *f->bell);
}

veil_fft *veil_fft_open(uint32_t side, double sigma_px, const char **why)
{
    veil_fft *f = calloc(1, sizeof *f);
    *why = "not enough memory";
    if (!f)
        return NULL;
    f->side = side;
    f->room = side + (uint32_t)ceil(4 * sigma_px);
    f->room += f->room % 2;
    f->plane = fftwf_malloc((size_t)f->room * f->room * sizeof *f->plane);
    f->terms = fftwf_malloc(terms_of(f) * sizeof *f->terms);
    f->bell = fftwf_malloc(terms_of(f) * sizeof *f->bell);
    if (f->plane && f->terms && f->bell) {
        const int n = (int)f->room;
        f->there = fftwf_plan_dft_r2c_2d(n, n, f->plane, f->terms, FFTW_MEASURE);
        f->back = fftwf_plan_dft_c2r_2d(n, n, f->terms, f->plane, FFTW_MEASURE);
    }
    if (f->there && f->back) {
        transform_bell(f, sigma_px);
        return f;
    }
    veil_fft_close(f);
    return NULL;
}

void veil_fft_run(veil_fft *f, const veil_lights *l, float *rgb)
{
    const size_t terms = terms_of(f);
    for (int c = 0; c < 3; c++) {
        memset(f->plane, 0, (size_t)f->room * f->room * sizeof *f->plane);
        for (size_t n = 0; n < l->count; n++)
            f->plane[(size_t)l->spot[n].y_px * f->room + (size_t)l->spot[n].x_px] += l->spot[n].rgb[c];
        fftwf_execute(f->there);
        for (size_t i = 0; i < terms; i++) {
            const float re = f->terms[i][0], im = f->terms[i][1];
            f->terms[i][0] = re * f->bell[i][0] - im * f->bell[i][1];
            f->terms[i][1] = re * f->bell[i][1] + im * f->bell[i][0];
        }
        fftwf_execute(f->back);
        for (uint32_t y = 0; y < f->side; y++)
            for (uint32_t x = 0; x < f->side; x++)
                rgb[3 * ((size_t)y * f->side + x) + (size_t)c] = f->plane[(size_t)y * f->room + x];
    }
}

void veil_fft_close(veil_fft *f)
{
    if (!f)
        return;
    if (f->there)
        fftwf_destroy_plan(f->there);
    if (f->back)
        fftwf_destroy_plan(f->back);
    fftwf_free(f->plane);
    fftwf_free(f->terms);
    fftwf_free(f->bell);
    free(f);
}

/* Replaces veil_fft.c where FFTW is not built in. */
#include "veil_rivals.h"

veil_fft *veil_fft_open(uint32_t side, double sigma_px, const char **why)
{
    (void)side, (void)sigma_px;
    *why = "built without FFTW (-DPUPIL_BENCH_PEERS=ON, libfftw3-dev)";
    return 0;
}

void veil_fft_run(veil_fft *f, const veil_lights *lights, float *rgb)
{
    (void)f, (void)lights, (void)rgb;
}

void veil_fft_close(veil_fft *f)
{
    (void)f;
}

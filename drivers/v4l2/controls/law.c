/* Codes, factors and seconds. */
#include <math.h>

#include "pupil/camera_controls.h"

static double of_table(const pupil_camera_gain *law, int64_t code)
{
    double gain = 0.0;
    for (uint32_t i = 0; i < law->rows; i++)
        gain = law->code[i] <= code ? law->gain[i] : gain;
    return gain;
}

double pupil_camera_gain_of_code(const pupil_camera_gain *law, int64_t code)
{
    const double x = (double)code, *p = law->p;
    double gain = 0.0;
    switch (law->law) {
    case PUPIL_CAMERA_RATIO:
        gain = p[2] * x + p[3] > 0.0 ? (p[0] * x + p[1]) / (p[2] * x + p[3]) : 0.0;
        break;
    case PUPIL_CAMERA_DB:
        gain = pow(10.0, p[0] * x / 20.0);
        break;
    case PUPIL_CAMERA_OCTAVES: {
        const double octave = floor(x / p[0]);
        gain = exp2(octave) * (1.0 + (x - octave * p[0]) / p[0]);
        break;
    }
    case PUPIL_CAMERA_TABLE:
        gain = of_table(law, code);
        break;
    default:
        break;
    }
    return gain > 0.0 && isfinite(gain) ? gain : 0.0;
}

static int64_t step_of(const pupil_camera_range *range)
{
    return range->step > 0 ? range->step : 1;
}

/* Every law rises, so the code is found by bisection, regardless of the formula. A gain of 0 above the least code is
 * beyond the law's range (a denominator of 0): too much. */
int64_t pupil_camera_code_of_gain(const pupil_camera_gain *law, double gain, const pupil_camera_range *range)
{
    int64_t low = 0, high = (range->most - range->least) / step_of(range);
    while (low < high) {
        const int64_t middle = high - (high - low) / 2, code = range->least + middle * step_of(range);
        const double here = pupil_camera_gain_of_code(law, code);
        const int before = here == 0.0 && law->law == PUPIL_CAMERA_TABLE; /* below the table's first code */
        if ((here > 0.0 && here <= gain * (1.0 + 1e-6)) || before)
            low = middle;
        else
            high = middle - 1;
    }
    return range->least + low * step_of(range);
}

int64_t pupil_camera_code_of_exposure(double exposure_s, double unit_s, const pupil_camera_range *range)
{
    const double units = exposure_s / unit_s * (1.0 + 1e-6);
    if (!(units >= (double)range->least))
        return range->least;
    const double most = (double)range->most;
    const int64_t code = (int64_t)(units < most ? units : most);
    return range->least + (code - range->least) / step_of(range) * step_of(range);
}

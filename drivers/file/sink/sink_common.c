#include "sink_common.h"

#include "refuse.h"
#include <math.h>
#include <stdio.h>

/* From a frame every quarter of an hour to 30 a ms: well within the range of the ratio below. */
#define FPS_MIN 0.001
#define FPS_MAX 30000.0

int pupil_sink_check_options(const char *path, const pupil_sink_options *options, pupil_why *why)
{
    if (options->width < 1 || options->width > PUPIL_MAX_SIDE_PX || options->height < 1 ||
        options->height > PUPIL_MAX_SIDE_PX)
        return pupil_refuse(why, "%s: frames of %u x %u pixels cannot be written; each side is 1 to %u", path,
                            options->width, options->height, PUPIL_MAX_SIDE_PX);
    if (!(options->fps >= FPS_MIN && options->fps <= FPS_MAX))
        return pupil_refuse(why, "%s: %g frames a second cannot be written; give %g to %g", path, options->fps, FPS_MIN,
                            FPS_MAX);
    return PUPIL_SINK_OK;
}

int pupil_sink_check_image(const char *path, const pupil_sink_options *options, const pupil_image_const *image,
                           pupil_why *why)
{
    if (image->pixel != PUPIL_PIXEL_RGB8)
        return pupil_refuse(why, "%s: pixel format %u cannot be written; display frames are 8-bit RGB", path,
                            image->pixel);
    if (image->width != options->width || image->height != options->height)
        return pupil_refuse(why,
                            "%s: a frame of %u x %u pixels came after frames of %u x %u; all must be of one size "
                            "(a folder takes stills of any, with --reset-each)",
                            path, image->width, image->height, options->width, options->height);
    return PUPIL_SINK_OK;
}

void pupil_sink_add_kept(uint64_t frames, pupil_why *why)
{
    pupil_refuse_add(why, "; the %llu frame%s before %s kept", (unsigned long long)frames, frames == 1 ? "" : "s",
                     frames == 1 ? "is" : "are");
}

void pupil_fps_ratio(double fps, int *num, int *den)
{
    /* NTSC: n * 1000/1001. 2e-6 accepts the spellings with two and three decimals (29.97 and 23.976 are 1e-6 off), but
     * not 23.98, which is as far from 24000/1001 as 0.4 s an hour. */
    double whole = nearbyint(fps * 1.001), best_error = INFINITY;
    if (fabs(fps - nearbyint(fps)) > 1e-9 * fps && fabs(fps * 1.001 - whole) <= 2e-6 * whole) {
        *num = (int)whole * 1000;
        *den = 1001;
        return;
    }
    for (int d = 1; d <= 65535; d++) {
        double n = nearbyint(fps * d), error = fabs(n / d - fps);
        if (n > 1e9)
            break;
        if (n >= 1 && error < best_error) {
            best_error = error;
            *num = (int)n;
            *den = d;
            if (error <= 1e-9 * fps)
                return;
        }
    }
}

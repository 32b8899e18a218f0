#include "choose.h"

#include "refuse.h"
#include <stdio.h>
#include <string.h>

/* Manual settings must be within the camera's range. */
static int check_hand(const run_options *o, pupil_camera *camera, pupil_why *why)
{
    pupil_camera_limits limits;
    pupil_camera_get_limits(camera, &limits);
    if (o->exposure_s > 0.0 &&
        !(o->exposure_s >= 0.999 * limits.exposure_min_s && o->exposure_s <= 1.001 * limits.exposure_max_s))
        return pupil_refuse(why, "--shutter: this camera exposes from %.6g to %.6g ms", limits.exposure_min_s * 1e3,
                            limits.exposure_max_s * 1e3);
    if (o->gain > 0.0 && !(o->gain >= 0.999 * limits.gain_min && o->gain <= 1.001 * limits.gain_max))
        return pupil_refuse(why, "--gain: this camera has gains from %.4g to %.4g", limits.gain_min, limits.gain_max);
    if (o->exposure_max_s > 0.0 && o->exposure_max_s < 0.999 * limits.exposure_min_s)
        return pupil_refuse(why, "--shutter-max: this camera exposes from %.6g to %.6g ms", limits.exposure_min_s * 1e3,
                            limits.exposure_max_s * 1e3);
    if (o->gain_max > 0.0 && o->gain_max < 0.999 * limits.gain_min)
        return pupil_refuse(why, "--gain-max: this camera has gains from %.4g to %.4g", limits.gain_min,
                            limits.gain_max);
    return 0;
}

/* An option that needs a camera with controls; NULL: none was given. */
static const char *asked_of(const run_options *o)
{
    return o->exposure_s > 0.0                 ? "--shutter"
           : o->gain > 0.0                     ? "--gain"
           : o->exposure_max_s > 0.0           ? "--shutter-max"
           : o->gain_max > 0.0                 ? "--gain-max"
           : o->mode == RUN_SENSOR             ? "--mode sensor"
           : o->mode == RUN_BOTH               ? "--mode both"
           : o->live.mains_hz && !o->row_gains ? "--mains"
           : o->any_frame_rate                 ? "--no-frame-rate-priority"
           : o->live.delay                     ? "--control-delay"
           : o->curve                          ? "--curve"
           : o->resume                         ? "--resume"
           : o->devices > 1                    ? "--device (several share an exposure)"
           : o->day_night_s > 0.0              ? "--day-night"
                                               : NULL;
}

int run_choose_mode(run_options *o, const pupil_source *source, pupil_why *remark, pupil_why *why)
{
    pupil_camera *camera = pupil_live_camera(source);
    const char *asks = asked_of(o);
    if (!camera && asks)
        return pupil_refuse(why, "%s: %.900s", asks, pupil_live_no_controls(source));
    if (!camera && o->mode == RUN_BEST)
        pupil_refuse(remark, "%.900s; the picture is adapted to, and the camera stays as it is (--mode digital)",
                     pupil_live_no_controls(source));
    if (o->mode == RUN_BEST)
        o->mode = camera ? RUN_BOTH : RUN_DIGITAL;
    return camera ? check_hand(o, camera, why) : 0;
}

int run_choose_outputs(const run_options *o, pupil_why *why)
{
    const frame_options *s = &o->shown;
    size_t streams = s->stats && strcmp(s->stats, "-") == 0;
    for (size_t i = 0; i < s->out_count; i++) {
        streams += strcmp(s->out[i], "-") == 0;
        if (o->device && strcmp(s->out[i], o->device) == 0) {
            pupil_refuse(why, "%s: is the camera itself; an output is another node", s->out[i]);
            return OPTIONS_USAGE;
        }
    }
    frame_options all = *s;
    all.report = o->resume; /* in place of a report, which a run has not: everything written needs its own place */
    all.control = o->control;
    if ((o->resume || o->control) && frame_options_check_paths(&all, why))
        return OPTIONS_USAGE;
    if (streams > 1) {
        pupil_refuse(why, "-: named for two outputs; standard output is one");
        return OPTIONS_USAGE;
    }
    return OPTIONS_RUN;
}

#include "row_gains.h"

#include "refuse.h"

#include <stdio.h>

enum { /* reasons of its own */
       NO_READOUT = PUPIL_ROW_GAIN_REASON_COUNT,
       NO_MAINS,
       REASONS
};

static const char *const words[REASONS] = {
    [PUPIL_ROW_GAIN_ON] = "",
    [PUPIL_ROW_GAIN_WAITING] = "too few frames were seen",
    [PUPIL_ROW_GAIN_LONG] = "the exposure is a flicker period or longer",
    [PUPIL_ROW_GAIN_STATIONARY] = "the bands do not move at this frame rate",
    [PUPIL_ROW_GAIN_NO_FLICKER] = "no flicker was found",
    [PUPIL_ROW_GAIN_MIXED] = "parts of the picture do not have the flicker: daylight, clipped, or another readout",
    [PUPIL_ROW_GAIN_DISTURBED] = "too much moves",
    [NO_READOUT] = "the camera's readout is not known: --readout",
    [NO_MAINS] = "no banding was found: give the frequency with --mains 50 or 60",
};

/* Reopened controls may be another camera's. */
static void find_readout(run_row_gains *l)
{
    pupil_camera *camera = pupil_live_camera(l->source);
    pupil_camera_limits limits;
    if (camera && camera != l->camera && !(l->options->readout_s > 0.0)) {
        pupil_camera_get_limits(camera, &limits);
        l->readout_s = limits.readout_s;
    }
    l->camera = camera;
}

void run_row_gains_begin(run_row_gains *l, const run_options *options, const pupil_source *source, pupil_why *remark)
{
    l->options = options->row_gains ? options : NULL;
    l->source = source;
    l->camera = NULL;
    l->readout_s = options->readout_s;
    l->of.mains_hz = 0;
    l->frames = l->with = 0;
    remark->text[0] = 0;
    if (!l->options)
        return;
    find_readout(l);
    if (!(l->readout_s > 0.0))
        pupil_refuse(remark, "--row-gains: there are none: %s; give it with --readout MS",
                     l->camera ? "this camera's driver does not report its readout (PIXEL_RATE and HBLANK)"
                               : "without the camera's controls its readout is not known");
    else if (options->mode == RUN_DIGITAL && !options->live.mains_hz)
        pupil_refuse(remark,
                     "--row-gains: --mode digital does not find the mains frequency; give it with --mains 50 or 60");
}

/* Makes the object for the known mains and readout, or keeps it, with what it has learned, if these are unchanged. 0;
 * -1: there can be no gains. */
static int ready(run_row_gains *l, const run_sensor *sensor)
{
    const uint32_t mains_hz = sensor->loop.steers ? sensor->loop.setting.mains_hz : l->options->live.mains_hz;
    find_readout(l);
    l->reason = !(l->readout_s > 0.0) ? NO_READOUT : mains_hz ? PUPIL_ROW_GAIN_WAITING : NO_MAINS;
    if (l->reason != PUPIL_ROW_GAIN_WAITING) {
        l->of.mains_hz = 0;
        return -1;
    }
    if (l->of.mains_hz == mains_hz && l->of.readout_s == l->readout_s)
        return 0;
    pupil_row_gain_config_default(&l->of);
    l->of.mains_hz = mains_hz;
    l->of.readout_s = l->readout_s;
    if (pupil_row_gain_init(&l->lamps, &l->of) == PUPIL_OK)
        return 0;
    l->of.mains_hz = 0; /* an impossible readout */
    l->reason = NO_READOUT;
    return -1;
}

/* The lamps are tracked by the middle of the exposure, whose distance from the driver's timestamp depends on the
 * exposure time. */
static pupil_frame_info middle_of(const pupil_source *source, const pupil_frame_info *info)
{
    const int starts = pupil_live_get(source)->times.stamp == PUPIL_LIVE_STAMP_START_OF_EXPOSURE;
    pupil_frame_info middle = *info;
    if (info->exposure_s > 0.0 && info->exposure_s < 1.0)
        middle.timestamp_ns += (int64_t)((starts ? 0.5e9 : -0.5e9) * info->exposure_s);
    return middle;
}

const float *run_row_gains_take(run_row_gains *l, const run_sensor *sensor, const pupil_frame *frame)
{
    pupil_row_gain_result result;
    if (!l->options)
        return NULL;
    l->frames++;
    if (ready(l, sensor))
        return NULL;
    const pupil_frame_info info = middle_of(l->source, &frame->info);
    if (pupil_row_gain_frame(&l->lamps, &frame->image, &info) || pupil_row_gain_get(&l->lamps, &result))
        return NULL;
    l->reason = result.reason;
    if (!(result.strength > 0.0) || pupil_row_gain_of_rows(&l->lamps, &info, frame->image.height, l->gain))
        return NULL;
    l->reason = PUPIL_ROW_GAIN_ON;
    l->with++;
    return l->gain;
}

void run_row_gains_tell(const run_row_gains *l, char *text, size_t text_bytes)
{
    *text = 0;
    if (!l->options || !l->frames)
        return;
    const char *why = words[l->reason < REASONS ? l->reason : PUPIL_ROW_GAIN_ON];
    snprintf(text, text_bytes, "; row correction gains in %llu of %llu frames%s%s%s", (unsigned long long)l->with,
             (unsigned long long)l->frames, *why ? " (" : "", why, *why ? ")" : "");
}

#include "camera_stream.h"

#include <math.h>
#include <string.h>

#include "frame_numbers.h"
#include "refuse.h"

/* --- the sensor's loop --- */

static double within(double x, double least, double most)
{
    return fmin(fmax(x, least), most);
}

/* The camera's limits, and within them those of the settings. */
static void configure(const camera_stream *s, const camera_settings *w, pupil_sensor_config *c)
{
    pupil_sensor_config_default(c);
    c->frame_s = 1.0 / s->source->fps;
    pupil_camera_configure(s->camera, c);
    const double shortest_s = c->exposure_min_s, longest_s = c->exposure_max_s;
    const double least = c->gain_min, most = c->gain_max;
    if (w->exposure_max_s > 0.0) {
        c->exposure_min_s = within(w->exposure_min_s, shortest_s, longest_s);
        c->exposure_max_s = within(w->exposure_max_s, c->exposure_min_s, longest_s);
    }
    if (w->gain_max > 0.0) {
        c->gain_min = within(w->gain_min, least, most);
        c->gain_max = within(w->gain_max, c->gain_min, most);
    }
    if (c->frame_s < c->exposure_min_s)
        c->frame_s = c->exposure_min_s;
    c->mains_hz = w->mains_hz;
    c->lock = w->lock;
    c->linear = (uint32_t)pupil_live_is_linear(s->source);
}

/* A new camera begins with the setting that it has, so that its picture does not jump; one that came back, with what
 * was wanted last. */
static int follow_camera(camera_stream *s, pupil_why *why)
{
    pupil_sensor_config config;
    pupil_camera *camera = pupil_live_camera(s->source);
    const int is_new = camera && camera != s->camera;
    s->camera = camera;
    if (!camera) {
        pupil_camera_loop_lost(&s->loop);
        return 0;
    }
    if (!is_new) {
        if (!s->loop.setting.frames)
            pupil_camera_loop_retry(&s->loop);
        return 0;
    }
    configure(s, &s->settings, &config);
    return pupil_camera_loop_begin(&s->loop, camera, &config, s->loop.steers ? s->loop.setting.total_s : 0.0, why);
}

/* Stops by which the camera's largest setting is above the frame's: a dark frame is less noisy by that much. */
static double spare_ev(const camera_stream *s, const pupil_frame_info *info)
{
    const pupil_sensor_config *c = &s->loop.config;
    if (!s->loop.steers || !(info->exposure_s > 0.0 && info->gain > 0.0))
        return 0.0;
    return fmax(0.0, log2(fmin(c->frame_s, c->exposure_max_s) * c->gain_max / (info->exposure_s * info->gain)));
}

/* --- the level --- */

/* The settings' configuration, with what the frames say of themselves. */
static void configure_picture(const camera_stream *s, const camera_settings *settings, pupil_config *c)
{
    *c = settings->picture;
    c->lock = settings->lock;
    c->nominal_frame_s = 1.0 / s->source->fps;
    c->primaries = s->source->primaries;
    c->output_primaries = c->primaries == PUPIL_PRIMARIES_BT709 ? PUPIL_OUTPUT_AS_INPUT : PUPIL_OUTPUT_BT709;
    c->histogram = 1; /* for the highlights of the sensor's loop, too */
}

static void limit_amplification(camera_stream *s, const pupil_frame_info *info)
{
    const double most_ev = fmin(32.0, s->settings.picture.amplification_ev + spare_ev(s, info));
    if (most_ev == s->config.amplification_ev)
        return;
    s->config.amplification_ev = most_ev;
    pupil_retune(&s->pupil, &s->config);
}

int camera_stream_retune(camera_stream *s, const camera_settings *settings, pupil_why *why)
{
    pupil_config config;
    pupil_sensor_config sensor;
    const char *fault = "";
    const int steers = s->loop.steers && s->camera;
    configure_picture(s, settings, &config);
    if (pupil_config_check(&config, &fault))
        return pupil_refuse(why, "%s", fault);
    if (steers) {
        configure(s, settings, &sensor);
        if (pupil_sensor_config_check(&sensor, &fault))
            return pupil_refuse(why, "%s", fault);
        pupil_camera_loop_retune(&s->loop, &sensor);
    }
    s->settings = *settings;
    s->config = config;
    pupil_retune(&s->pupil, &config);
    return 0;
}

/* --- a frame --- */

static int balance(camera_stream *s, pupil_frame *frame, pupil_why *why)
{
    if (!s->has_colour) {
        pupil_camera_sensor known;
        const int is_known = pupil_live_find_sensor(s->source, &known);
        if (pupil_white_balance_begin(&s->colour, &s->colours, frame->image.coding, frame->image.pixel,
                                      is_known ? &known : NULL, why))
            return -1;
        s->has_colour = 1;
    }
    frame->image.coding = &s->colour.coding;
    return 0;
}

int camera_stream_show(camera_stream *s, pupil_frame *frame, const pupil_image *out, pupil_why *why)
{
    pupil_curve curve;
    if (follow_camera(s, why) || balance(s, frame, why))
        return -1;
    limit_amplification(s, &frame->info);
    int error = pupil_meter(&s->pupil, &frame->image, &frame->info);
    if (!error && s->loop.steers && s->camera) {
        pupil_get_stats(&s->pupil, &s->stats);
        pupil_live_mark(s->source); /* metering took time */
        error = pupil_camera_loop_frame(&s->loop, &s->stats, &frame->info);
    }
    if (!error && pupil_get_curve(&s->pupil, &frame->info, &curve))
        pupil_curve_before_light(&s->pupil, &curve);
    if (!error)
        error = pupil_map_rows(&s->pupil, &curve, &frame->image, out);
    if (error)
        return pupil_refuse(why, "%s: %s", frame->name, pupil_error_string(error));
    pupil_white_balance_frame(&s->colour, &frame->image, &frame->info);
    pupil_get_exposure(&s->pupil, &s->exposure);
    s->info = frame->info;
    return 0;
}

/* --- begin and end --- */

int camera_stream_open(camera_stream *s, const char *device, const pupil_live_options *options,
                       const pupil_colour_options *colours, const camera_settings *settings, pupil_why *why)
{
    memset(s, 0, sizeof *s);
    if (pupil_live_open(device, NULL, options, &s->source, why))
        return -1;
    s->colours = *colours;
    s->settings = *settings;
    configure_picture(s, settings, &s->config);
    if (pupil_init(&s->pupil, &s->config) == PUPIL_OK)
        return 0;
    camera_stream_close(s, NULL);
    return pupil_refuse(why, "%s: the settings are refused", device);
}

int camera_stream_close(camera_stream *s, pupil_why *why)
{
    if (!s->source)
        return 0;
    const int failed = pupil_live_give_back(s->source, why);
    pupil_source_close(s->source);
    s->source = NULL;
    s->camera = NULL;
    return failed;
}

const char *camera_stream_state(const camera_stream *s)
{
    if (s->loop.steers)
        return pupil_sensor_state_name(s->loop.setting.state);
    return frame_state_word(s->exposure.state);
}

const char *camera_stream_reason(const camera_stream *s)
{
    if (s->loop.steers && s->loop.refused)
        return "refused";
    if (s->loop.steers)
        return s->loop.setting.reason ? pupil_sensor_reason_name(s->loop.setting.reason) : "none";
    return frame_reason_word(s->exposure.reason);
}

#include "colour.h"

#include "live/live.h"
#include "v4l2/media/media.h"

/* What is known of the sensor behind a camera; 0: nothing. */
static int find_sensor(const pupil_v4l2_capture *capture, pupil_camera_sensor *known)
{
    pupil_v4l2_sensor sensor;
    pupil_why unused;
    return pupil_v4l2_media_sensor(&capture->device, &sensor, &unused) == 0 &&
           pupil_camera_find_sensor(NULL, sensor.entity, known, &unused) == 1;
}

int run_colour_take(run_colour *c, const pupil_colour_options *options, const pupil_source *source, pupil_frame *frame,
                    pupil_why *why)
{
    const pupil_v4l2_capture *capture = pupil_live_capture(source);
    if (!c->began || c->reopened != capture->counts.reopened) {
        pupil_camera_sensor known;
        const int is_known = find_sensor(capture, &known);
        if (pupil_white_balance_begin(&c->colour, options, frame->image.coding, frame->image.pixel,
                                      is_known ? &known : NULL, why))
            return -1;
        if (c->own_picture && c->colour.coding.light == PUPIL_LIGHT_BT709)
            c->colour.coding.light = c->colour.first.light = PUPIL_LIGHT_SRGB;
        c->began = 1;
        c->reopened = capture->counts.reopened;
    }
    frame->image.coding = &c->colour.coding;
    return 0;
}

#include "colour.h"

#include "live/live.h"

int run_colour_take(run_colour *c, const pupil_colour_options *options, const pupil_source *source, pupil_frame *frame,
                    pupil_why *why)
{
    const uint64_t reopened = pupil_live_get(source)->counts.reopened;
    if (!c->began || c->reopened != reopened) {
        pupil_camera_sensor known;
        const int is_known = pupil_live_find_sensor(source, &known);
        if (pupil_white_balance_begin(&c->colour, options, frame->image.coding, frame->image.pixel,
                                      is_known ? &known : NULL, why))
            return -1;
        if (c->own_picture && c->colour.coding.light == PUPIL_LIGHT_BT709)
            c->colour.coding.light = c->colour.first.light = PUPIL_LIGHT_SRGB;
        c->began = 1;
        c->reopened = reopened;
    }
    frame->image.coding = &c->colour.coding;
    return 0;
}

/* A camera changes after its properties were found: the code at which it saturates, and the light that its black level
 * adds. */
#include <math.h>

#include "check.h"
#include "hostile_rows.h"

static const hostile_row row = {.name = "a camera that changes"};

static void step_to(double light_ev)
{
    hostile.camera.light_ev = light_ev;
    hostile_frames(REST);
}

/* Saturated at 0.6, as in some modes of a sensor, and then at 1: the highlights have more room, and it is used. */
static void test_white_moves_up(void)
{
    hostile_prepare(&row, 1);
    hostile.camera.saturation = 0.6;
    hostile_begin(3.0);
    hostile_frames(REST);
    CHECK_MSG(hostile_wrong_ev() < 0.25, "full at 0.6: %g EV", hostile_wrong_ev());
    hostile.camera.saturation = 1.0;
    hostile_frames(REST);
    CHECK_MSG(hostile_wrong_ev() < 0.25, "full at 1: %g EV", hostile_wrong_ev());
}

/* 6 % are added to all pixels until the camera is corrected: the first step of the light shows the correction. */
static void test_black_goes(void)
{
    hostile_prepare(&row, 1);
    hostile.camera.pedestal = 0.06;
    for (int i = 0; i < HOSTILE_PIXELS; i++) /* so flat that few pixels are darker than that once it is gone */
        hostile.camera.scene[i] = sqrtf(hostile.camera.scene[i]);
    hostile_begin(0.0);
    for (int i = 0; i < 4; i++)
        step_to(i % 2 ? 2.0 : -1.0);
    CHECK_MSG(hostile.setting.reason == PUPIL_SENSOR_NONLINEAR, "with 6 %% more light: %s",
              pupil_sensor_reason_name(hostile.setting.reason));
    hostile.camera.pedestal = 0.0;
    step_to(3.0);
    CHECK_MSG(hostile.setting.reason != PUPIL_SENSOR_NONLINEAR && hostile_wrong_ev() < 0.25, "set right: %s, %g EV",
              pupil_sensor_reason_name(hostile.setting.reason), hostile_wrong_ev());
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_white_moves_up();
    test_black_goes();
    return check_end();
}

/* Writes that are lost, and metadata that are true: what the metadata show never arrived is written again, instead of
 * being taken for a control that does less. A control that does nothing is not written for ever. */
#include "sensor_plant.h"

enum { FIRST_FRAMES = 60, LIGHT_FRAMES = 120, PROMISED_FRAMES = 60 };

static plant p;
static pupil_sensor sensor;

static void open_loop(double light_ev, uint32_t delay)
{
    pupil_sensor_config c = plant_config(LAW_FINE);
    c.highlight_ev = 0.0; /* the key alone, so that the right setting is known */
    CHECK(pupil_sensor_init(&sensor, &c) == PUPIL_OK);
    plant_open(&p, &sensor, light_ev, delay);
}

/* A camera that is busy after each write. Returns the frames until the sensor is within 0.25 EV, for good. */
static int settle_frames(uint64_t busy, uint32_t delay, double step_ev)
{
    pupil_sensor_setting s;
    int settled = 0;
    open_loop(7.0, delay);
    p.busy = busy;
    for (int i = 0; i < FIRST_FRAMES + LIGHT_FRAMES; i++) {
        p.light_ev += i == FIRST_FRAMES ? step_ev : 0.0;
        const double off = plant_turn(&p, &sensor, &s, NULL);
        settled = i >= FIRST_FRAMES && fabs(off) > 0.25 ? i + 1 - FIRST_FRAMES : settled;
    }
    return settled;
}

static void check_busy(void)
{
    static const double steps[] = {-5.0, -2.0, 2.0, 5.0};
    for (uint64_t busy = 2; busy <= 5; busy++)
        for (uint32_t delay = 1; delay <= 3; delay++)
            for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
                const int frames = settle_frames(busy, delay, steps[i]);
                printf("busy %d, delay %u, %+g EV: %d frames\n", (int)busy, delay, steps[i], frames);
                CHECK_MSG(frames <= PROMISED_FRAMES, "busy %d, delay %u, %+g EV: %d frames", (int)busy, delay, steps[i],
                          frames);
            }
}

/* A gain that the camera does not have: its metadata never move. */
static void check_no_gain(void)
{
    pupil_sensor_setting s;
    int writes = 0;
    open_loop(3.0, 2);
    p.ignored[1] = 1;
    p.lies = PLANT_IN_FORCE;
    for (int i = 0; i < 300; i++) {
        p.light_ev -= i == 100 ? 3.0 : 0.0;
        plant_turn(&p, &sensor, &s, NULL);
        writes += i >= 160 && s.changed;
    }
    CHECK_MSG(writes <= 6, "%d writes in 140 frames", writes); /* once a second at the limit */
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_busy();
    check_no_gain();
    return check_end();
}

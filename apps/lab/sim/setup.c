/* The loop of the options: its controller, and its length. */
#include <math.h>

#include "options/key_at.h"
#include "sim.h"

enum { MOST_FRAMES = 1000000 };

void sim_configure(sim_options *o)
{
    pupil_sensor_config *c = &o->loop.sensor;
    if (o->believed)
        c->delay_frames = o->believed;
    c->mains_hz = o->mains_hz;
    if (o->key_at)
        key_at_parse(o->key_at, c->key_at, &c->key_points); /* it was checked when it was parsed */
}

size_t sim_frames(const sim_options *o, size_t *event)
{
    const double frame_s = o->loop.plant.frame_s, last_s = fixture_loop_last_s(&o->loop);
    const double rest = (double)(fixture_rest_after(&o->loop.sensor) + FIXTURE_REST_FRAMES);
    const double enough = ceil(last_s / frame_s) + 1.0 + rest; /* more than ten seconds of a slow camera */
    const double usual = o->plants ? enough : ceil((last_s + 10.0) / frame_s);
    const double frames = o->duration_s > 0.0 ? ceil(o->duration_s / frame_s) : usual > enough ? usual : enough;
    const size_t count = frames < SIM_REST_FRAMES + 1 ? SIM_REST_FRAMES + 1
                         : frames > MOST_FRAMES       ? MOST_FRAMES
                                                      : (size_t)frames;
    const double at = ceil(last_s / frame_s - 1e-6);
    const size_t latest = count - SIM_REST_FRAMES;
    *event = at < (double)latest ? (size_t)at : latest;
    return count;
}

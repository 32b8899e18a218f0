/* Whether the setting that was asked for last is in force. */
#include "sensor_private.h"

/* Whether only the metadata are left to say what is in force; those that the picture has borne out are (estimate.c). */
static int is_by_metadata(const sensor_estimate *a)
{
    return a->reports && a->alive[0] == 1 && a->alive[1] == 1;
}

/* The shortest delay that the frames so far leave possible. */
static uint32_t shortest_delay(const sensor_estimate *a)
{
    uint32_t shortest = 0;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        uint32_t delay = 0;
        while (pupil_sensor_is_waited_for(a, c) && delay < SENSOR_DELAYS && !(a->alive[c] >> delay & 1))
            delay++;
        shortest = delay > shortest ? delay : shortest;
    }
    return shortest;
}

/* Where many frames are lost, the program is slow, and settings come late by more than the camera's delay: the one that
 * was found holds as long as nothing speaks against it. */
static int is_refuted(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    uint32_t lost = 0;
    if (o->setting.frames < SENSOR_RING || (a->alive[0] >> a->delay[0] & a->alive[1] >> a->delay[1] & 1))
        return 0;
    for (uint32_t i = 0; i < SENSOR_RING; i++)
        lost += !a->past[i].gap;
    return lost >= SENSOR_MANY_LOST;
}

/* Frames after which a setting is taken to be in force, with any delay. */
uint32_t pupil_sensor_wait_frames(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const uint32_t longest = pupil_sensor_longest_delay(o), late = o->config.delay_frames + SENSOR_LATE_FRAMES;
    const uint32_t most = late > 2 * SENSOR_LATE_FRAMES ? late : 2 * SENSOR_LATE_FRAMES;
    const uint32_t known = a->delay[0] > a->delay[1] ? a->delay[0] : a->delay[1];
    if (a->is_borne_out && known && !is_refuted(o))
        return known > o->config.delay_frames ? known : o->config.delay_frames;
    const uint32_t usual = longest < most && !is_by_metadata(a) ? longest : most, shortest = shortest_delay(a);
    return usual > shortest ? usual : shortest;
}

int pupil_sensor_is_on_its_way(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    int is_there = 1, is_late = 0;
    for (int c = 0; c < SENSOR_CONTROLS; c++) {
        const int is_in = size_of(a->in_force[c] - a->requested[c]) < SENSOR_DIFFER_EV;
        is_there &= is_in;
        is_late |= !is_in && a->reports && !a->best[c];
    }
    /* Metadata that nothing contradicts say that it is not: the delay may be longer than was believed. And where frames
     * are lost because the program is slow, those that come have waited in the driver: they are counted. */
    const uint32_t usual = pupil_sensor_wait_frames(o), least = SENSOR_LATE_FRAMES + 1;
    const int is_waiting = o->search.since < usual || (is_late && o->search.looks < (usual > least ? usual : least));
    return is_waiting && !(is_there && is_by_metadata(a));
}

/* The setting that was asked for last is in force beyond doubt. */
int pupil_sensor_is_in_force(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const int is_known = is_by_metadata(a) || (a->delay[0] && a->delay[1]);
    return !pupil_sensor_is_on_its_way(o) &&
           (is_known || o->search.since >= o->config.delay_frames + SENSOR_LATE_FRAMES);
}

int pupil_sensor_is_pending(const pupil_sensor_object *o)
{
    return o->search.is_large && pupil_sensor_is_on_its_way(o);
}

double pupil_sensor_effect_asked(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    return a->effect + (pupil_sensor_is_on_its_way(o) ? pupil_sensor_effect(a, a->in_force, a->requested) : 0.0);
}

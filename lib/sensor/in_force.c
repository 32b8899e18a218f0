/* Whether the setting that was asked for last is in force. */
#include "sensor_private.h"

/* Whether only the metadata are left as a guess: those that the picture has confirmed are believed (estimate.c). */
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

/* Frames after which a setting is taken to be in force, with any delay. */
uint32_t pupil_sensor_wait_frames(const pupil_sensor_object *o)
{
    const sensor_estimate *a = &o->estimate;
    const uint32_t longest = pupil_sensor_longest_delay(o), late = o->config.delay_frames + SENSOR_LATE_FRAMES;
    const uint32_t most = late > 2 * SENSOR_LATE_FRAMES ? late : 2 * SENSOR_LATE_FRAMES;
    const uint32_t known = a->delay[0] > a->delay[1] ? a->delay[0] : a->delay[1];
    if (a->is_borne_out && known)
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
    /* Uncontradicted metadata say that it is not in force: the delay may be longer than believed, and longer still if
     * frames are lost: then those that arrive have waited in the driver, and only those are counted. */
    const uint32_t usual = pupil_sensor_wait_frames(o), least = SENSOR_LATE_FRAMES + 1;
    const int is_losing = o->search.looks < o->search.since || a->losses;
    const uint32_t late = is_losing ? usual + SENSOR_LATE_FRAMES : usual > least ? usual : least;
    const int is_waiting = o->search.since < usual || (is_late && o->search.looks < late);
    return is_waiting && !(is_there && is_by_metadata(a));
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

/* What was in force in a frame, and what frames show about it. */
#include "camera_history.h"

static uint64_t acts_from(const camera_history *h, const camera_entry *e)
{
    return e->in_stream ? e->under_way + h->delay : 0;
}

uint64_t pupil_camera_history_acts_from(const camera_history *h)
{
    return acts_from(h, &h->entry[(h->count - 1) % CAMERA_HISTORY]);
}

/* The newest of the kept entries whose frame has come. What was in force before the first one is not known: 0. */
double pupil_camera_history_at(const camera_history *h, uint64_t sequence)
{
    const uint32_t kept = h->count < CAMERA_HISTORY ? h->count : CAMERA_HISTORY;
    double value = h->count > kept ? h->entry[(h->count - kept) % CAMERA_HISTORY].value : 0.0;
    for (uint32_t i = kept; i > 0; i--) {
        const camera_entry *e = &h->entry[(h->count - i) % CAMERA_HISTORY];
        if (acts_from(h, e) <= sequence)
            value = e->value;
    }
    return value;
}

void pupil_camera_timeline_frame(camera_timeline *time, uint64_t sequence, int started)
{
    const uint64_t now = started ? sequence : sequence + 1;
    if (!time->any_frame || now > time->under_way)
        time->under_way = now;
    time->any_frame = 1;
}

void pupil_camera_timeline_measured(camera_timeline *time, uint64_t sequence)
{
    const uint64_t ahead = sequence - time->measured;
    time->measured_mask = (ahead < 64 ? time->measured_mask << ahead : 0) | 1;
    time->measured = sequence;
}

void pupil_camera_history_take(camera_history *h, const camera_timeline *time, pupil_camera_value *v, double value,
                               const uint64_t *after)
{
    if (!(value > 0.0) || (h->count && value == v->taken))
        return;
    h->entry[h->count++ % CAMERA_HISTORY] = (camera_entry){time->under_way, time->any_frame, value};
    h->late_before = h->late;
    h->late = after && time->any_frame && time->under_way > *after ? time->under_way - *after : 0;
    v->taken = value;
    v->from_frame = pupil_camera_history_acts_from(h);
}

/* A frame of these, from `from` to before `to`, was measured. */
static int has_measured(const camera_timeline *time, uint64_t from, uint64_t to)
{
    for (uint64_t n = from; n < to && n <= time->measured; n++)
        if (time->measured - n < 64 && time->measured_mask >> (time->measured - n) & 1)
            return 1;
    return 0;
}

/* What frames show is counted from the frame that was measured when a setting was asked for; if the last two writes
 * were not equally late after it, it is not known which of them was seen. Only a measured frame for which the two
 * delays give different settings shows anything: if it was lost, the assumed delay stays. 1: the delay has changed. */
static int learn(const camera_timeline *time, camera_history *h, uint32_t seen)
{
    if (!seen || seen == h->learned || !h->late || (h->late_before && h->late_before != h->late))
        return 0;
    const uint32_t before = h->delay, now = seen > h->late ? (uint32_t)(seen - h->late) : 0;
    const uint64_t under_way = h->entry[(h->count - 1) % CAMERA_HISTORY].under_way;
    const uint64_t from = under_way + (now < before ? now : before), to = under_way + (now < before ? before : now);
    const int differs = has_measured(time, from, to);
    if (!differs && time->measured < to)
        return 0; /* too early */
    h->learned = seen;
    h->delay = differs ? now : before;
    return h->delay != before;
}

int pupil_camera_history_learn(camera_history *e, camera_history *g, const camera_timeline *time,
                               uint32_t exposure_delay, uint32_t gain_delay)
{
    const int alike = e->delay == g->delay;
    if (!(learn(time, e, exposure_delay) | learn(time, g, gain_delay)))
        return 0;
    if (alike && !g->learned)
        g->delay = e->delay;
    if (alike && !e->learned)
        e->delay = g->delay;
    return 1;
}

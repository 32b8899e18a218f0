/* What was in force in a frame, and what frames teach about it. */
#include "controls_private.h"

static uint64_t acts_from(const camera_history *h, const camera_entry *e)
{
    return e->in_stream ? e->under_way + h->delay : 0;
}

uint64_t pupil_camera_acts_from(const camera_history *h)
{
    return acts_from(h, &h->entry[(h->count - 1) % CAMERA_HISTORY]);
}

/* Of the entries that are still there the newest whose frame has come. */
static double history_at(const camera_history *h, uint64_t sequence)
{
    const uint32_t kept = h->count < CAMERA_HISTORY ? h->count : CAMERA_HISTORY;
    double value = kept ? h->entry[(h->count - kept) % CAMERA_HISTORY].value : 0.0;
    for (uint32_t i = kept; i > 0; i--) {
        const camera_entry *e = &h->entry[(h->count - i) % CAMERA_HISTORY];
        if (acts_from(h, e) <= sequence)
            value = e->value;
    }
    return value;
}

void pupil_camera_v4l2_in_force(pupil_camera *of, uint64_t sequence, pupil_frame_info *info)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    pthread_mutex_lock(&camera->lock);
    info->exposure_s = history_at(&camera->exposures, sequence);
    info->gain = history_at(&camera->gains, sequence);
    const uint64_t ahead = sequence - camera->measured;
    camera->measured_mask = (ahead < 64 ? camera->measured_mask << ahead : 0) | 1;
    camera->measured = sequence;
    pthread_mutex_unlock(&camera->lock);
}

/* A frame of these, from `from` to before `to`, was measured. */
static int has_measured(const v4l2_camera *camera, uint64_t from, uint64_t to)
{
    for (uint64_t n = from; n < to && n <= camera->measured; n++)
        if (camera->measured - n < 64 && camera->measured_mask >> (camera->measured - n) & 1)
            return 1;
    return 0;
}

/* What frames show is counted from the frame that was measured when a setting was asked for; where the last two writes
 * were not equally late after it, nobody knows which of them was seen. And only where frames came that were taken
 * otherwise than they said have they shown anything: where the one that would show it was lost, the assumed delay
 * stays. 1: the delay is another one now. */
static int learn(const v4l2_camera *camera, camera_history *h, uint32_t seen)
{
    if (!seen || seen == h->learned || !h->late || (h->late_before && h->late_before != h->late))
        return 0;
    const uint32_t before = h->delay, now = seen > h->late ? (uint32_t)(seen - h->late) : 0;
    const uint64_t under_way = h->entry[(h->count - 1) % CAMERA_HISTORY].under_way;
    const uint64_t from = under_way + (now < before ? now : before), to = under_way + (now < before ? before : now);
    const int differs = has_measured(camera, from, to);
    if (!differs && camera->measured < to)
        return 0; /* too early */
    h->learned = seen;
    h->delay = differs ? now : before;
    return h->delay != before;
}

void pupil_camera_v4l2_learn(pupil_camera *of, uint32_t exposure_delay, uint32_t gain_delay)
{
    v4l2_camera *camera = (v4l2_camera *)of;
    camera_history *e = &camera->exposures, *g = &camera->gains;
    pthread_mutex_lock(&camera->lock);
    const int alike = e->delay == g->delay;
    if (!camera->delay_given && (learn(camera, e, exposure_delay) | learn(camera, g, gain_delay))) {
        if (alike && !g->learned)
            g->delay = e->delay;
        if (alike && !e->learned)
            e->delay = g->delay;
        camera->status.exposure_s.from_frame = e->count ? pupil_camera_acts_from(e) : 0;
        camera->status.gain.from_frame = g->count ? pupil_camera_acts_from(g) : 0;
    }
    pthread_mutex_unlock(&camera->lock);
}

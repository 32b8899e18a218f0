/* Slow, refused and lost writes of a camera whose exposure is steered. */
#include "pupil/camera_loop.h"

#include "refuse.h"

/* Asks for a setting that is not the last one, or that the sensor loop wants written again. */
static void ask(pupil_camera_loop *loop, uint32_t again)
{
    const pupil_camera_setting wanted = {.exposure_s = loop->setting.exposure_s, .gain = loop->setting.gain};
    if (again || wanted.exposure_s != loop->asked.exposure_s || wanted.gain != loop->asked.gain)
        pupil_camera_ask(loop->camera, &wanted);
    loop->asked = wanted;
}

void pupil_camera_loop_retry(pupil_camera_loop *loop)
{
    pupil_camera_status status;
    if (!loop->camera)
        return;
    pupil_camera_get_status(loop->camera, &status);
    if (status.written != status.asks) /* a write is in progress */
        return;
    loop->refused = status.failed != loop->failed_before;
    if (!loop->refused)
        return;
    loop->refusals += status.failed - loop->failed_before;
    loop->refusal = status.error;
    loop->failed_before = status.failed;
    pupil_camera_ask(loop->camera, &loop->asked);
}

static int retune_sensor(pupil_camera_loop *loop)
{
    pupil_sensor_config config = loop->config;
    config.lock |= loop->locked;
    return pupil_sensor_retune(&loop->sensor, &config);
}

/* While a write takes longer than a frame, it is not known what frames were taken with: `slow`, they are not measured.
 * While settings are refused, frames do not respond to them, and the sensor would ask for more and more: it is locked.
 * Both last until the first frame with the new values has passed, because the assumed delay may be wrong by one. */
static void judge_writes(pupil_camera_loop *loop, const pupil_frame_info *info)
{
    const uint32_t was_locked = loop->locked;
    pupil_camera_status status;
    pupil_camera_get_status(loop->camera, &status);
    const uint32_t is_early =
        info->sequence <= status.exposure_s.from_frame || info->sequence <= status.gain.from_frame;
    loop->slow = status.written != status.asks || (loop->slow && is_early);
    pupil_camera_loop_retry(loop);
    loop->locked = loop->refused || (loop->locked && is_early);
    if (loop->locked != was_locked && loop->steers)
        retune_sensor(loop);
}

static void take_camera(pupil_camera_loop *loop, pupil_camera *camera)
{
    loop->camera = camera;
    loop->slow = 0;
    loop->locked = 0;
    loop->refused = 0;
    loop->failed_before = 0; /* a camera that was just opened has refused nothing */
    loop->asked = (pupil_camera_setting){0};
}

int pupil_camera_loop_begin(pupil_camera_loop *loop, pupil_camera *camera, const pupil_sensor_config *config,
                            double total_s, pupil_why *why)
{
    const char *fault = "";
    pupil_camera_status status;
    if (pupil_sensor_config_check(config, &fault))
        return pupil_refuse(why, "the camera's exposure cannot be steered: %s", fault);
    take_camera(loop, camera);
    loop->config = *config;
    pupil_sensor_init(&loop->sensor, config); /* of a camera that came back nothing is known: it may be another one */
    pupil_camera_get_status(camera, &status);
    if (total_s > 0.0)
        pupil_sensor_start(&loop->sensor, total_s, 1.0);
    else
        pupil_sensor_start(&loop->sensor, status.exposure_s.taken, status.gain.taken); /* refused where unknown */
    loop->steers = 1;
    pupil_sensor_get(&loop->sensor, &loop->setting);
    ask(loop, 0);
    return 0;
}

void pupil_camera_loop_hold(pupil_camera_loop *loop, pupil_camera *camera, const pupil_camera_setting *setting)
{
    take_camera(loop, camera);
    loop->steers = 0;
    loop->asked = *setting;
    pupil_camera_ask(camera, setting);
}

int pupil_camera_loop_retune(pupil_camera_loop *loop, const pupil_sensor_config *config)
{
    const pupil_sensor_config before = loop->config;
    loop->config = *config;
    const int error = retune_sensor(loop);
    if (error)
        loop->config = before;
    return error;
}

int pupil_camera_loop_frame(pupil_camera_loop *loop, const pupil_stats *stats, const pupil_frame_info *info)
{
    int error = PUPIL_OK;
    uint32_t changed = 0;
    if (!loop->camera)
        return PUPIL_OK;
    judge_writes(loop, info);
    if (!loop->steers)
        return PUPIL_OK;
    if (!loop->slow) {
        error = pupil_sensor_frame(&loop->sensor, stats, info);
        pupil_sensor_get(&loop->sensor, &loop->setting);
        changed = loop->setting.changed && !error;
        pupil_camera_learn(loop->camera, loop->setting.exposure_delay, loop->setting.gain_delay);
    }
    if ((loop->slow || loop->locked) && !loop->config.lock) { /* the last step has not acted yet */
        loop->setting.state = PUPIL_SENSOR_SEARCHING;
        loop->setting.reason = PUPIL_SENSOR_WAITING;
    }
    ask(loop, changed);
    return error;
}

int pupil_camera_loop_announce(pupil_camera_loop *loop, double ev, uint32_t within_frames, uint32_t change)
{
    if (!loop->camera || !loop->steers)
        return PUPIL_OK;
    const int error = pupil_sensor_announce(&loop->sensor, ev, within_frames, change);
    pupil_sensor_get(&loop->sensor, &loop->setting);
    ask(loop, 0);
    return error;
}

int pupil_camera_loop_follow(pupil_camera_loop *loop, double total_s)
{
    if (!loop->camera || !loop->steers)
        return PUPIL_OK;
    const int error = pupil_sensor_start(&loop->sensor, total_s, 1.0);
    if (error)
        return error;
    const double frame_digital = loop->setting.frame_digital; /* still of the last frame */
    pupil_sensor_get(&loop->sensor, &loop->setting);
    loop->setting.frame_digital = frame_digital;
    ask(loop, 0);
    return PUPIL_OK;
}

void pupil_camera_loop_lost(pupil_camera_loop *loop)
{
    loop->camera = NULL;
    loop->refused = 0;
    loop->slow = 0;
    if (!loop->steers)
        return;
    loop->setting.state = PUPIL_SENSOR_SEARCHING;
    loop->setting.reason = PUPIL_SENSOR_WAITING;
    loop->setting.frame_digital = 1.0;
}

/* tests/apps/run/run_rig.h: `pupil run` frame by frame on the fake camera; every control is written before the next
 * frame begins. */
#ifndef PUPIL_TESTS_RUN_RIG_H
#define PUPIL_TESTS_RUN_RIG_H

#include <linux/videodev2.h>
#include <math.h>

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "frame/pipeline.h"
#include "pupil/error.h"
#include "run/colour.h"
#include "run/row_gains.h"
#include "run/sensor.h"

typedef struct live_run {
    fake_v4l2 *fake;
    run_options options;
    pupil_source *source;
    frame_pipeline pipeline;
    run_sensor sensor;
    run_colour colour;
    run_row_gains lamps;
    pupil_frame frame; /* that is held */
    frame_log_entry record;
    pupil_why why, remark;
} live_run;

static char *rig_arguments[16] = {"run"}; /* the command line, except for the mode */
static int rig_argument_count = 1;
static uint32_t rig_delay; /* --control-delay */

static void control(fake_v4l2 *fake, uint32_t id, int value)
{
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    struct v4l2_control c = {id, value};
    const int fd = system->open(system->context, "/dev/video0");
    CHECK(system->ioctl(system->context, fd, VIDIOC_S_CTRL, &c) == 0);
    system->close(system->context, fd);
}

static void begin_with(live_run *r, uint32_t mode, const fake_v4l2_config *config, int exposure, int gain, double light)
{
    memset(r, 0, sizeof *r);
    r->fake = fake_v4l2_new(config);
    control(r->fake, V4L2_CID_EXPOSURE_ABSOLUTE, exposure);
    control(r->fake, V4L2_CID_GAIN, gain);
    fake_v4l2_light(r->fake, light);
    CHECK_MSG(run_options_parse(&r->options, rig_argument_count, rig_arguments, &r->why) == OPTIONS_RUN, "%s",
              r->why.text);
    r->options.mode = mode;
    r->options.shown.threads = 1;
    r->options.live.delay = rig_delay;
    r->options.live.capture.system = fake_v4l2_system(r->fake);
    CHECK_MSG(pupil_live_open("0", NULL, &r->options.live, &r->source, &r->why) == 0, "%s", r->why.text);
    if (!r->source)
        exit(check_end());
    run_sensor_begin(&r->sensor, &r->options, r->source, NULL);
    run_row_gains_begin(&r->lamps, &r->options, r->source, &r->remark);
    r->colour.own_picture = mode == RUN_SENSOR;
    CHECK(frame_pipeline_open(&r->pipeline, &r->options.shown.config, 1) == 0);
}

/* The whole test has a time limit. */
static void await_writes(live_run *r)
{
    pupil_camera_status status;
    const struct timespec moment = {0, 100000};
    pupil_camera *camera = pupil_live_camera(r->source);
    for (pupil_camera_get_status(camera, &status); status.written != status.asks;
         pupil_camera_get_status(camera, &status))
        nanosleep(&moment, NULL);
}

static void give_frame_back(live_run *r)
{
    if (r->frame.name)
        pupil_source_done(r->source, &r->frame);
    r->frame.name = NULL;
}

static void step(live_run *r)
{
    give_frame_back(r);
    CHECK_MSG(pupil_source_next(r->source, &r->frame, &r->why) == PUPIL_SOURCE_FRAME, "%s", r->why.text);
    CHECK(run_sensor_take(&r->sensor, &r->why) == 0);
    CHECK(run_colour_take(&r->colour, &r->options.colour, r->source, &r->frame, &r->why) == 0);
    run_sensor_limit(&r->sensor, &r->frame.info, &r->pipeline);
    cpu_engine_row_gains(r->pipeline.cpu, run_row_gains_take(&r->lamps, &r->sensor, &r->frame));
    CHECK_MSG(frame_pipeline_meter(&r->pipeline, &r->frame, &r->why) == 0, "%s", r->why.text);
    run_sensor_frame(&r->sensor, &r->pipeline.stats, &r->frame.info, &r->pipeline.curve);
    CHECK_MSG(frame_pipeline_map(&r->pipeline, &r->frame, 1, &r->why) == 0, "%s", r->why.text);
    memset(&r->record, 0, sizeof r->record);
    run_sensor_describe(&r->sensor, &r->frame.info, &r->record);
    await_writes(r);
}

static void end(live_run *r)
{
    give_frame_back(r);
    frame_pipeline_close(&r->pipeline);
    pupil_source_close(r->source);
    CHECK(fake_v4l2_holds(r->fake).files == 0 && fake_v4l2_holds(r->fake).maps == 0);
    fake_v4l2_free(r->fake);
}

static const uint8_t *shown(const live_run *r, uint32_t x, uint32_t y)
{
    return (const uint8_t *)r->pipeline.display.data + (ptrdiff_t)y * r->pipeline.display.stride_bytes + 3 * x;
}

#endif

/* pupil/camera_loop.h on the simulated camera, through the table of pupil/camera_controls.h: the level becomes right
 * with writes that take no time, one frame or many, with writes that are refused for a while, and after a camera was
 * lost and came back. While a write is in progress the setting does not move. */
#include <errno.h>
#include <math.h>

#include "check.h"
#include "pupil/camera_loop.h"
#include "pupil/pupil.h"
#include "simulated_camera.h"

enum { FRAMES = 400, STEP = 100 /* the first frame with eight times the light */ };

typedef struct rig {
    simulated_camera camera;
    pupil_camera_loop loop;
    pupil_stats stats;
    fixture_truth truth;
    double off_ev; /* of the frame as the sensor took it, relative to the key */
} rig;

static void open_camera(rig *r, const char *light, double exposure_s, double gain)
{
    fixture_plant_config config;
    fixture_light_script script;
    pupil_why why = {""};
    fixture_plant_default(&config);
    CHECK_MSG(fixture_light_parse(&script, light, &why) == 0, "%s", why.text);
    CHECK_MSG(simulated_camera_open(&r->camera, &config, &script, exposure_s, gain, &why) == 0, "%s", why.text);
}

static void begin(rig *r, double total_s)
{
    pupil_sensor_config config;
    pupil_why why = {""};
    pupil_sensor_config_default(&config);
    pupil_camera_configure(&r->camera.base, &config);
    CHECK_MSG(pupil_camera_loop_begin(&r->loop, &r->camera.base, &config, total_s, &why) == 0, "%s", why.text);
}

/* One frame, as docs/examples/full.c has it. */
static void step(rig *r)
{
    pupil_frame_info info;
    simulated_camera_next(&r->camera, &r->stats, &info, &r->truth);
    pupil_camera_frame(&r->camera.base, info.sequence, 0);
    pupil_camera_in_force(&r->camera.base, info.sequence, &info);
    const uint32_t was_writing = r->camera.status.writing;
    const uint64_t asks = r->camera.status.asks;
    CHECK(pupil_camera_loop_frame(&r->loop, &r->stats, &info) == PUPIL_OK);
    CHECK_MSG(!was_writing || r->camera.status.asks == asks, "a setting is asked for while another one is written");
    r->off_ev = fixture_truth_ev(&r->truth, 1.0) - log2(0.18);
}

static void end(rig *r)
{
    pupil_why why;
    CHECK(pupil_camera_close(&r->camera.base, &why) == 0 && r->camera.closed == 1);
}

/* Frames from the step of light until the level stays within 0.15 EV of the key. */
static int frames_to_settle(uint32_t write_frames)
{
    static rig r;
    int settled = 0;
    r = (rig){.off_ev = 0.0};
    open_camera(&r, "3.3333s step +3ev", 0.01, 1.0);
    r.camera.write_frames = write_frames;
    begin(&r, 0.0);
    for (int i = 0; i < FRAMES; i++) {
        step(&r);
        if (i == STEP - 1)
            CHECK_MSG(fabs(r.off_ev) < 0.15, "writes of %u frames: %g EV off before the step", write_frames, r.off_ev);
        if (i >= STEP && fabs(r.off_ev) >= 0.15)
            settled = i + 1 - STEP;
    }
    CHECK_MSG(r.loop.setting.state == PUPIL_SENSOR_CONVERGED, "writes of %u frames: state %u", write_frames,
              r.loop.setting.state);
    CHECK(r.loop.refusals == 0 && !r.loop.refused && !r.loop.slow);
    end(&r);
    return settled;
}

/* A large step takes one write, and up to two more for clipped light; each takes its own time and the delay of 3. */
static void test_slow(void)
{
    static const uint32_t write_frames[] = {0, 1, 2, 5, 10, 30};
    for (size_t i = 0; i < sizeof write_frames / sizeof *write_frames; i++) {
        const int settled = frames_to_settle(write_frames[i]);
        printf("writes of %u frames: settled %d frames after the light changed\n", write_frames[i], settled);
        CHECK_MSG(settled <= 3 * (int)(write_frames[i] + 5), "writes of %u frames: %d frames", write_frames[i],
                  settled);
    }
}

/* The light changes while the camera is busy, then stays constant: only the loop asks again. */
static void test_refused(uint32_t write_frames)
{
    static rig r;
    uint64_t failed = 0;
    r = (rig){.off_ev = 0.0};
    open_camera(&r, "3.3333s step +3ev", 0.01, 1.0);
    r.camera.write_frames = write_frames;
    begin(&r, 0.0);
    for (int i = 0; i < FRAMES; i++) {
        r.camera.refusal = i >= STEP - 10 && i < STEP + 50 ? EBUSY : 0;
        step(&r);
        if (i == STEP + 40) {
            CHECK(r.loop.refused == 1 && r.loop.refusal == EBUSY);
            CHECK_MSG(fabs(r.off_ev) > 2.0, "%g EV off, and no write was taken", r.off_ev);
        }
        if (i == STEP + 49)
            failed = r.loop.refusals;
    }
    CHECK_MSG(failed >= 40 / (write_frames + 1) && r.loop.refusals <= failed + 2 &&
                  r.loop.refusals == r.camera.status.failed,
              "writes of %u frames: %d refusals of %d in 50 frames, %d later", write_frames, (int)failed,
              (int)r.camera.status.failed, (int)r.loop.refusals);
    CHECK_MSG(!r.loop.refused && fabs(r.off_ev) < 0.15 && r.loop.setting.state == PUPIL_SENSOR_CONVERGED,
              "writes of %u frames: %g EV off, state %u", write_frames, r.off_ev, r.loop.setting.state);
    end(&r);
}

/* A camera that comes back continues at the wanted setting, not at the one that it has. */
static void test_lost(void)
{
    static rig r;
    r = (rig){.off_ev = 0.0};
    open_camera(&r, "0s 0ev", 0.01, 1.0);
    begin(&r, 0.0);
    for (int i = 0; i < STEP; i++)
        step(&r);
    const double total_s = r.loop.setting.total_s;
    CHECK(fabs(r.off_ev) < 0.15 && r.loop.steers);
    pupil_camera_loop_lost(&r.loop);
    end(&r);
    CHECK(r.loop.setting.state == PUPIL_SENSOR_SEARCHING && r.loop.setting.reason == PUPIL_SENSOR_WAITING);
    CHECK(r.loop.setting.frame_digital == 1.0 && r.loop.setting.total_s == total_s);
    /* without a camera nothing is asked, and nothing of the setting moves */
    CHECK(pupil_camera_loop_frame(&r.loop, &r.stats, &r.camera.told) == PUPIL_OK);
    pupil_camera_loop_retry(&r.loop);
    CHECK(r.loop.setting.total_s == total_s);
    open_camera(&r, "0s 0ev", 0.0005, 1.0);
    begin(&r, r.loop.setting.total_s);
    CHECK_MSG(fabs(log2(r.camera.status.exposure_s.asked * r.camera.status.gain.asked / total_s)) < 0.1,
              "%g s x %g of a total of %g s", r.camera.status.exposure_s.asked, r.camera.status.gain.asked, total_s);
    for (int i = 0; i < 10; i++)
        step(&r);
    CHECK_MSG(fabs(r.off_ev) < 0.15, "%g EV off ten frames after it came back", r.off_ev);
    end(&r);
}

/* A fixed setting. */
static void test_hold(void)
{
    static rig r;
    pupil_frame_info info;
    r = (rig){.off_ev = 0.0};
    open_camera(&r, "0s 0ev", 0.01, 1.0);
    r.camera.refusal = EIO;
    pupil_camera_loop_hold(&r.loop, &r.camera.base, &(pupil_camera_setting){.exposure_s = 0.002, .gain = 2.0});
    for (int i = 0; i < 20; i++) {
        r.camera.refusal = i < 10 ? EIO : 0;
        simulated_camera_next(&r.camera, &r.stats, &info, &r.truth);
        pupil_camera_loop_retry(&r.loop);
    }
    CHECK(!r.loop.steers && !r.loop.refused && r.loop.refusal == EIO);
    CHECK_MSG(r.loop.refusals == 11, "%d refusals", (int)r.loop.refusals);
    CHECK_MSG(fabs(r.truth.exposure_s - 0.002) < 2e-5 && r.truth.gain == 2.0, "%g s x %g", r.truth.exposure_s,
              r.truth.gain);
    end(&r);
}

/* The caller's lock survives a slow write, and an invalid configuration changes nothing. */
static void test_retune(void)
{
    static rig r;
    pupil_why why = {""};
    r = (rig){.off_ev = 0.0};
    open_camera(&r, "0s 0ev", 0.0005, 1.0);
    pupil_sensor_config config;
    pupil_sensor_config_default(&config);
    pupil_camera_configure(&r.camera.base, &config);
    config.key = -1.0;
    CHECK(pupil_camera_loop_begin(&r.loop, &r.camera.base, &config, 0.0, &why) == -1);
    CHECK_MSG(strstr(why.text, "cannot be steered: key"), "%s", why.text);
    CHECK(!r.loop.steers && r.camera.status.asks == 0);
    r.camera.write_frames = 5;
    begin(&r, 0.0);
    for (int i = 0; i < 100; i++)
        step(&r);
    CHECK(fabs(r.off_ev) < 0.15);
    config = r.loop.config;
    config.lock = 1;
    config.ev_compensation = -1.0;
    CHECK(pupil_camera_loop_retune(&r.loop, &config) == PUPIL_OK);
    step(&r); /* splits the wanted total once more */
    const uint64_t asks = r.camera.status.asks;
    for (int i = 0; i < 30; i++)
        step(&r);
    CHECK_MSG(r.loop.setting.state == PUPIL_SENSOR_LOCKED && r.camera.status.asks == asks, "state %u, %d asks more",
              r.loop.setting.state, (int)(r.camera.status.asks - asks));
    config.key = -1.0;
    CHECK(pupil_camera_loop_retune(&r.loop, &config) == PUPIL_ERR_CONFIG && r.loop.config.key > 0.0);
    config = r.loop.config;
    config.lock = 0;
    CHECK(pupil_camera_loop_retune(&r.loop, &config) == PUPIL_OK);
    for (int i = 0; i < 150; i++)
        step(&r);
    CHECK_MSG(fabs(r.off_ev + 1.0) < 0.15, "%g EV off, for -1", r.off_ev);
    pupil_camera_restore(&r.camera.base);
    CHECK(r.camera.restored == 1);
    end(&r);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_slow();
    test_refused(0);
    test_refused(3);
    test_lost();
    test_hold();
    test_retune();
    return check_end();
}

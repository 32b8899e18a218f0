/* The writer: no caller waits for the driver, the latest ask wins, and it is known what was in force in which frame. */
#include <math.h>
#include <pthread.h>
#include <unistd.h>

#include "check.h"
#include "fake_controls.h"

static fake_controls fake;
static pupil_why why;

static pupil_camera *open_camera(int sensor, int at_frame_start)
{
    pupil_camera_options options = sensor ? fake_sensor_options(&fake) : fake_uvc_options(&fake);
    options.at_frame_start = (uint32_t)at_frame_start;
    return pupil_camera_open(&options, &why);
}

static pupil_camera_status status_of(pupil_camera *camera)
{
    pupil_camera_status status;
    pupil_camera_get_status(camera, &status);
    return status;
}

static void wait_for(pupil_camera *camera, uint64_t number)
{
    while (status_of(camera).written < number)
        usleep(200);
}

static void stick(void)
{
    pthread_mutex_lock(&fake.lock);
    fake.stuck = 1;
    pthread_mutex_unlock(&fake.lock);
}

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A write that takes two seconds. Meanwhile 150 frames each make all four calls, and none of them waits for the write.
 * The test checks order, not time: after the last call the write is still running. */
static void check_slow_write(void)
{
    fake_uvc(&fake);
    pupil_camera *camera = open_camera(0, 0);
    CHECK_MSG(camera, "%s", why.text);
    if (!camera)
        return;
    pthread_mutex_lock(&fake.lock);
    fake.sleep_ms = 2000;
    pthread_mutex_unlock(&fake.lock);
    const double begun = now_s();
    const uint64_t first = pupil_camera_ask(camera, &(pupil_camera_setting){0.001, 1, 0});
    while (!status_of(camera).writing)
        usleep(100);
    uint64_t last = first;
    for (uint64_t frame = 0; frame < 150; frame++) {
        pupil_frame_info info;
        pupil_camera_frame(camera, frame, 0);
        pupil_camera_in_force(camera, frame, &info);
        CHECK(info.exposure_s == 0.025 && info.gain == 2.5); /* the setting that it was opened with */
        last = pupil_camera_ask(camera, &(pupil_camera_setting){0.002 + 1e-4 * (double)frame, 2, 0});
    }
    CHECK(status_of(camera).written < first && status_of(camera).writing && last == first + 150);
    wait_for(camera, first);
    CHECK(now_s() - begun >= 2.0);
    wait_for(camera, last);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_ABSOLUTE) == 169); /* 0.0169 s: the latest ... */
    int exposures = 0;
    for (int i = 0; i < fake.logged; i++)
        exposures += fake.log[i].id == V4L2_CID_EXPOSURE_ABSOLUTE;
    CHECK(exposures == 2); /* ... and none in between */
    CHECK(pupil_camera_close(camera, &why) == 0);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_ABSOLUTE) == 250 && fake_value(&fake, V4L2_CID_EXPOSURE_AUTO) == 3);
}

/* What an ask leaves open keeps the value of an earlier ask. */
static void check_merging(void)
{
    fake_uvc(&fake);
    pupil_camera *camera = open_camera(0, 0);
    stick();
    pupil_camera_ask(camera, &(pupil_camera_setting){0.01, 1, 0});
    while (!status_of(camera).writing)
        usleep(100);
    pupil_camera_ask(camera, &(pupil_camera_setting){0.02, 0, 0});
    pupil_camera_ask(camera, &(pupil_camera_setting){0, 3, 0});
    const uint64_t last = pupil_camera_ask(camera, &(pupil_camera_setting){0.03, 0, 0});
    fake_release(&fake);
    wait_for(camera, last);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_ABSOLUTE) == 300 && fake_value(&fake, V4L2_CID_GAIN) == 48);
    CHECK(pupil_camera_close(camera, &why) == 0);
}

static pupil_frame_info in_force(pupil_camera *camera, uint64_t sequence)
{
    pupil_frame_info info = {0};
    pupil_camera_in_force(camera, sequence, &info);
    return info;
}

/* Asked, taken, in force from: an imx219, whose exposure takes two frames and whose gain takes one. */
static void check_in_force(void)
{
    const double line_s = 3448 / 182.4e6;
    fake_sensor(&fake);
    pupil_camera *camera = open_camera(1, 0);
    wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){500 * line_s, 2, 0}));
    CHECK(fabs(in_force(camera, 0).exposure_s / line_s - 500) < 1e-9); /* before any frame: in force from the first */
    pupil_camera_frame(camera, 10, 0);                                 /* 11 is being exposed */
    wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){1000 * line_s, 4, 0}));
    CHECK(status_of(camera).exposure_s.from_frame == 13 && status_of(camera).gain.from_frame == 12);
    for (uint64_t frame = 0; frame < 16; frame++) {
        CHECK(fabs(in_force(camera, frame).exposure_s / line_s - (frame < 13 ? 500 : 1000)) < 1e-9);
        CHECK(in_force(camera, frame).gain == (frame < 12 ? 2 : 4));
    }
    pupil_camera_frame(camera, 20, 1); /* 20 has begun */
    wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){1e9, 0, 0}));
    CHECK(status_of(camera).exposure_s.from_frame == 22 && status_of(camera).exposure_s.asked == 1e9);
    CHECK(fabs(status_of(camera).exposure_s.taken / line_s - 1759) < 1e-9); /* taken is not asked */
    pupil_camera_frame(camera, 5, 0);                                       /* late: it does not turn the time back */
    wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){700 * line_s, 0, 0}));
    CHECK(status_of(camera).exposure_s.from_frame == 22);
    for (int i = 0; i < 100; i++) { /* more than are remembered: the newest are right */
        pupil_camera_frame(camera, 100 + (uint64_t)i, 0);
        wait_for(camera, pupil_camera_ask(camera, &(pupil_camera_setting){(100 + i) * line_s, 0, 0}));
    }
    for (int i = 90; i < 100; i++)
        CHECK(fabs(in_force(camera, 103 + (uint64_t)i).exposure_s / line_s - (100 + i)) < 1e-9);
    CHECK(in_force(camera, 0).exposure_s > 0);
    CHECK(pupil_camera_close(camera, &why) == 0);
}

/* Written at the frame's start; also if no frame comes. */
static void check_frame_start(void)
{
    fake_sensor(&fake);
    pupil_camera *camera = open_camera(1, 1);
    pupil_camera_frame(camera, 1, 1);
    uint64_t number = pupil_camera_ask(camera, &(pupil_camera_setting){0.001, 0, 0});
    for (uint64_t frame = 2; status_of(camera).written < number; frame++) {
        pupil_camera_frame(camera, frame, 1);
        usleep(1000);
    }
    number = pupil_camera_ask(camera, &(pupil_camera_setting){0.002, 0, 0});
    wait_for(camera, number);
    CHECK(fabs(status_of(camera).exposure_s.taken - 0.002) < 2e-5);
    CHECK(pupil_camera_close(camera, &why) == 0);
}

/* A write that hangs: close returns, and everything is restored once the driver returns. */
static void check_hanging_close(void)
{
    fake_uvc(&fake);
    pupil_camera *camera = open_camera(0, 0);
    stick();
    pupil_camera_ask(camera, &(pupil_camera_setting){0.01, 1, 0});
    while (!status_of(camera).writing)
        usleep(100);
    CHECK(pupil_camera_close(camera, &why) == 1);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_AUTO) == V4L2_EXPOSURE_MANUAL);
    fake_release(&fake);
    for (int i = 0; i < 20000 && fake_value(&fake, V4L2_CID_EXPOSURE_AUTO) != 3; i++)
        usleep(1000);
    CHECK(fake_value(&fake, V4L2_CID_EXPOSURE_AUTO) == 3 && fake_value(&fake, V4L2_CID_EXPOSURE_ABSOLUTE) == 250);
    CHECK(fake_value(&fake, V4L2_CID_GAIN) == 40);
    usleep(100000); /* the thread frees its memory, for the leak checker */
}

static void *busy(void *of)
{
    pupil_camera *camera = of;
    for (int i = 0; i < 2000; i++) {
        pupil_frame_info info;
        pupil_camera_limits limits;
        pupil_camera_ask(camera, &(pupil_camera_setting){1e-3 * (1 + i % 30), 1 + i % 8, 0.03 + 1e-3 * (i % 7)});
        pupil_camera_frame(camera, (uint64_t)i, i & 1);
        pupil_camera_in_force(camera, (uint64_t)i, &info);
        pupil_camera_get_limits(camera, &limits);
        status_of(camera);
    }
    return NULL;
}

/* From several threads at once, for the thread sanitizer. */
static void check_threads(void)
{
    pthread_t thread[3];
    fake_sensor(&fake);
    pupil_camera *camera = open_camera(1, 0);
    for (int i = 0; i < 3; i++)
        pthread_create(&thread[i], NULL, busy, camera);
    for (int i = 0; i < 3; i++)
        pthread_join(thread[i], NULL);
    CHECK(status_of(camera).asks == 6000 && status_of(camera).failed == 0);
    CHECK(pupil_camera_close(camera, &why) == 0 && fake_value(&fake, V4L2_CID_VBLANK) == 683);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_slow_write();
    check_merging();
    check_in_force();
    check_frame_start();
    check_hanging_close();
    check_threads();
    return check_end();
}

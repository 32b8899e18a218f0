/* camera_loop.h: a camera's exposure time and gain, kept right frame by frame: pupil/sensor.h decides,
 * pupil/camera_controls.h writes, and this handles writes that are slow, refused or lost.
 *
 *     pupil_sensor_config_default(&config);
 *     pupil_camera_configure(camera, &config);
 *     pupil_camera_loop_begin(&loop, camera, &config, 0, &why);
 *     for each frame:
 *         pupil_camera_frame(camera, sequence, 0);
 *         pupil_camera_in_force(camera, sequence, &info);
 *         ... meter the frame into `stats` ...
 *         pupil_camera_loop_frame(&loop, &stats, &info);     // asks the camera for the next setting
 *         ... show the frame times loop.setting.frame_digital ...
 *
 * Slow: while a write takes longer than a frame, it is not known which frame is the first with its setting. Frames are
 * not measured until the write has returned and one frame with its values has passed.
 * Refused: a setting that the driver refused (EBUSY, EIO) is asked for again with every frame until the camera takes
 * it. The setting is locked until then.
 * Lost: call pupil_camera_loop_lost when the controls are gone (unplugged), and begin again when they come back: it
 * starts from the total that was wanted last.
 *
 * The camera can be any pupil_camera: V4L2's, or one with a table of its own.
 *
 * Memory: the caller's; nothing is allocated. Threads: one at a time on a loop. No call waits for the driver.
 * Libraries: libpupil-camera and libpupil (pkg-config pupil-camera names both).
 */
#ifndef PUPIL_CAMERA_LOOP_H
#define PUPIL_CAMERA_LOOP_H

#include "pupil/camera_controls.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pupil_camera_loop {
    /* to be read after each call */
    pupil_sensor_setting setting; /* as of the last frame; valid where `steers` is 1 */
    uint32_t steers;              /* 1: begun, and the camera is steered */
    uint32_t slow;                /* 1: a write takes longer than a frame, or did just now: nothing is measured */
    uint32_t refused;             /* 1: the camera refused the latest setting, which was asked for again ... */
    int refusal;                  /* ... and the errno of the last refusal */
    uint64_t refusals;            /* all refusals since the loop was zeroed */

    /* private */
    pupil_camera *camera; /* NULL: no controls now */
    pupil_sensor_config config;
    pupil_camera_setting asked;
    uint32_t locked;        /* the sensor is, because the camera refuses settings */
    uint64_t failed_before; /* writes of this camera that had failed when it was last looked at */
    pupil_sensor sensor;
} pupil_camera_loop;

/* Begins with a camera's controls, in a loop that is all zero, or again with controls that came back. `config` is
 * pupil_camera_configure's and what the caller changes. The first setting has the exposure x gain `total_s`; 0: what
 * the camera has now, so that its picture does not jump. 0, or -1 and a sentence: the configuration is wrong. */
int pupil_camera_loop_begin(pupil_camera_loop *loop, pupil_camera *camera, const pupil_sensor_config *config,
                            double total_s, pupil_why *why);

/* Instead of begin: one permanent setting, which is asked for again if it is refused. */
void pupil_camera_loop_hold(pupil_camera_loop *loop, pupil_camera *camera, const pupil_camera_setting *setting);

/* Another configuration at any time, as pupil_sensor_retune: 0, or a PUPIL_ERR_. */
int pupil_camera_loop_retune(pupil_camera_loop *loop, const pupil_sensor_config *config);

/* Takes the statistics of a frame, and its info with the exposure time and gain of pupil_camera_in_force; the setting
 * follows, and is asked for if it has changed. Nothing happens while there are no controls, or while one setting is
 * held. Returns what pupil_sensor_frame returns, or 0 if nothing happens. If more than a frame's period may have passed
 * since the frame was complete, call pupil_camera_frame once more before this, with pupil_camera_newest. */
int pupil_camera_loop_frame(pupil_camera_loop *loop, const pupil_stats *stats, const pupil_frame_info *info);

/* Light that is known to change: as pupil_sensor_announce. The setting for it is asked for at once, so call it where
 * pupil_camera_loop_frame is called, after the frame. Nothing happens while there are no controls, or while one setting
 * is held. */
int pupil_camera_loop_announce(pupil_camera_loop *loop, double ev, uint32_t within_frames, uint32_t change);

/* Sets a total, exposure time x gain, that was decided elsewhere: by another camera's loop. For a loop whose
 * config.lock is 1: its frames are measured, but decide nothing. The setting is clamped to this camera's limits, and
 * asked for at once. 0, or a PUPIL_ERR_. */
int pupil_camera_loop_follow(pupil_camera_loop *loop, double total_s);

/* For frames that are left out, or while one setting is held: asks again for a setting that was refused. Frames that go
 * through pupil_camera_loop_frame need no call of this. */
void pupil_camera_loop_retry(pupil_camera_loop *loop);

/* The controls are gone. The loop keeps the total that was wanted, for the next begin: loop->setting.total_s. */
void pupil_camera_loop_lost(pupil_camera_loop *loop);

#ifdef __cplusplus
}
#endif

#endif

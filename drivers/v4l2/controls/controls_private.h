/* drivers/v4l2/controls/controls_private.h: what the files of this folder share. */
#ifndef PUPIL_DRIVERS_V4L2_CONTROLS_CONTROLS_PRIVATE_H
#define PUPIL_DRIVERS_V4L2_CONTROLS_CONTROLS_PRIVATE_H

#include <linux/videodev2.h>
#include <pthread.h>

#include "camera_history.h"
#include "pupil/camera_controls.h"
#include "pupil/error.h"
#include "refuse.h"

enum { CAMERA_SAVED = 16 };

/* A control and where it is. fd -1: there is none. */
typedef struct camera_control {
    int fd;
    uint32_t id;
    pupil_camera_range range;
} camera_control;

typedef struct v4l2_camera {
    pupil_camera base;
    pupil_camera_calls calls;
    void (*released)(void *user);
    void *user;                 /* of released */
    int fd, subdevice_fd, owns; /* owns: the files are duplicates */
    uint32_t height, at_frame_start;
    camera_control exposure, gain, vblank;
    double unit_s; /* of exposure codes */
    double line_s; /* 0: unknown, and exposures are not in lines */
    pupil_camera_gain law;
    uint32_t gain_known, delay_given; /* delay_given: nothing is learned */
    struct {
        int fd;
        uint32_t id;
        int64_t value;
    } saved[CAMERA_SAVED]; /* in the order in which they are put back */
    uint32_t saved_count;
    struct {
        int fd;
        uint32_t id;
        int64_t value;
    } off[CAMERA_SAVED]; /* what was turned off, in that order */
    uint32_t off_count;

    pthread_t thread;
    pthread_mutex_t lock; /* of all that follows, and of exposure.range; never held while the driver is called */
    double now_frame_s;   /* by VBLANK, as last written */
    pthread_cond_t wake, idle;
    uint32_t closing, abandoned, running, frame_started, again;
    camera_timeline time;
    uint64_t pending_after; /* `time.measured` when `pending` was asked for ... */
    uint32_t pending_is;    /* ... if there was one */
    pupil_camera_setting pending;
    pupil_camera_status status;
    camera_history exposures, gains;
} v4l2_camera;

/* 0, or a negative errno. */
int pupil_camera_query(const v4l2_camera *camera, int fd, uint32_t id, camera_control *control);
int pupil_camera_get_control(const v4l2_camera *camera, int fd, uint32_t id, int64_t *value);
int pupil_camera_set_controls(const v4l2_camera *camera, int fd, struct v4l2_ext_controls *controls);
int pupil_camera_set_control(const v4l2_camera *camera, int fd, uint32_t id, int64_t value);
/* "exposure time, absolute": what the driver's documentation calls the control. */
const char *pupil_camera_control_name(uint32_t id);

/* Notes what is automatic, and turns it off: 0, or -1 and a sentence. Turns it off once more: 0, or the first error.
 * Puts everything back: how many could not be, and the id of the first. */
int pupil_camera_take(v4l2_camera *camera, uint32_t mains_hz, pupil_why *why);
int pupil_camera_turn_off_again(const v4l2_camera *camera);
int pupil_camera_put_back(const v4l2_camera *camera, uint32_t *first);

/* Writes a setting in the right order and reads back what was taken (0: as before): 0, or a negative errno. */
int pupil_camera_write(v4l2_camera *camera, const pupil_camera_setting *setting, double *exposure_s, double *gain);

/* The writer. stop: 0, or 1 where it hangs and will free the camera by itself. */
int pupil_camera_writer_start(v4l2_camera *camera);
int pupil_camera_writer_stop(v4l2_camera *camera);

void pupil_camera_free(v4l2_camera *camera);

/* The table of pupil/camera_controls.h, function by function. */
uint64_t pupil_camera_v4l2_ask(pupil_camera *camera, const pupil_camera_setting *setting);
uint64_t pupil_camera_v4l2_reapply(pupil_camera *camera);
void pupil_camera_v4l2_frame(pupil_camera *camera, uint64_t sequence, int started);
void pupil_camera_v4l2_in_force(pupil_camera *camera, uint64_t sequence, pupil_frame_info *info);
void pupil_camera_v4l2_learn(pupil_camera *camera, uint32_t exposure_delay, uint32_t gain_delay);
void pupil_camera_v4l2_get_status(pupil_camera *camera, pupil_camera_status *status);
void pupil_camera_v4l2_get_limits(pupil_camera *camera, pupil_camera_limits *limits);

#endif

/* drivers/camera/camera_parts.h: what the files of this folder share. */
#ifndef PUPIL_DRIVERS_CAMERA_PARTS_H
#define PUPIL_DRIVERS_CAMERA_PARTS_H

#include <linux/videodev2.h>
#include <pthread.h>

#include "camera_controls.h"

enum { CAMERA_SAVED = 16, CAMERA_HISTORY = 16, CAMERA_USUAL_DELAY = 3 };

/* A control and where it is. fd -1: there is none. */
typedef struct camera_control {
    int fd;
    uint32_t id;
    pupil_camera_range range;
} camera_control;

/* What was in force from a frame on. */
typedef struct camera_entry {
    uint64_t from_frame;
    double value;
} camera_entry;

typedef struct camera_history {
    camera_entry entry[CAMERA_HISTORY];
    uint32_t count; /* of all that were ever written */
} camera_history;

struct pupil_camera {
    pupil_camera_calls calls;
    int fd, subdevice_fd, owns; /* owns: the files are duplicates */
    uint32_t height, at_frame_start;
    camera_control exposure, gain, vblank;
    double unit_s; /* of exposure codes */
    double line_s; /* where exposures are in lines */
    pupil_camera_gain law;
    uint32_t gain_known, exposure_delay, gain_delay;
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
    } off[CAMERA_SAVED]; /* what was turned off, in the order in which it was */
    uint32_t off_count;

    pthread_t thread;
    pthread_mutex_t lock; /* of all that follows, and of exposure.range; never held while the driver is called */
    double now_frame_s;   /* by VBLANK, as last written */
    pthread_cond_t wake, idle;
    uint32_t closing, abandoned, running, frame_started, any_frame, again;
    uint64_t under_way; /* sequence of the frame that is exposed now */
    pupil_camera_setting pending;
    pupil_camera_status status;
    camera_history exposures, gains;
};

/* Writes the sentence; returns -1. why NULL: nowhere. */
__attribute__((format(printf, 3, 4))) int pupil_camera_refuse(char *why, size_t why_bytes, const char *format, ...);

/* 0, or a negative errno. */
int pupil_camera_query(const pupil_camera *camera, int fd, uint32_t id, camera_control *control);
int pupil_camera_get_control(const pupil_camera *camera, int fd, uint32_t id, int64_t *value);
int pupil_camera_set_control(const pupil_camera *camera, int fd, uint32_t id, int64_t value);
/* "exposure time, absolute": what the driver's documentation calls the control. */
const char *pupil_camera_control_name(uint32_t id);

/* Turns off what steers by itself, after noting it; -1 and a sentence. Turns it off once more: 0, or the first error.
 * Puts everything back; the number that could not be, and the id of the first. */
int pupil_camera_take(pupil_camera *camera, uint32_t mains_hz, char *why, size_t why_bytes);
int pupil_camera_turn_off_again(const pupil_camera *camera);
int pupil_camera_put_back(const pupil_camera *camera, uint32_t *first);

/* Writes a setting in the right order and reads back what was taken (0: as before): 0, or a negative errno. */
int pupil_camera_write(pupil_camera *camera, const pupil_camera_setting *setting, double *exposure_s, double *gain);

/* The writer. stop: 0, or 1 where it hangs and will free the camera by itself. */
int pupil_camera_writer_start(pupil_camera *camera);
int pupil_camera_writer_stop(pupil_camera *camera);
void pupil_camera_free(pupil_camera *camera);

#endif

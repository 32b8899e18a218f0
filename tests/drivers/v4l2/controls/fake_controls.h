/* A driver's controls without a driver, behind camera_controls.h in tests. */
#ifndef PUPIL_TESTS_FAKE_CONTROLS_H
#define PUPIL_TESTS_FAKE_CONTROLS_H

#include <linux/videodev2.h>
#include <pthread.h>
#include <stdint.h>

#include "pupil/camera_controls.h"

enum { FAKE_VIDEO = 10, FAKE_SUBDEVICE = 11, FAKE_CONTROLS = 20, FAKE_LOG = 4096 };

typedef struct fake_control {
    int fd;
    uint32_t id;
    int64_t least, most, step, usual, value;
    uint32_t menu; /* a mask of the existing entries; 0: no menu */
} fake_control;

typedef struct fake_write {
    uint32_t id, call; /* writes of one call share its number */
    int64_t value;
} fake_write;

typedef struct fake_controls {
    fake_control control[FAKE_CONTROLS];
    int count;
    uint32_t height;        /* of a sensor: EXPOSURE is at most height + VBLANK - 4 */
    int needs_manual;       /* as uvcvideo: EXPOSURE_ABSOLUTE only while EXPOSURE_AUTO is manual */
    int one_by_one;         /* refuses several at once, as some drivers do */
    int no_query_ext;       /* an old kernel */
    long fail_at, fail_for; /* this call, counted from 1, and so many after it fail ... */
    int fail_errno;
    long sleep_ms; /* how long the next write takes */
    int stuck;     /* ... or until this is cleared and `moved` signalled */
    long calls;    /* so far */
    fake_write log[FAKE_LOG];
    int logged;
    pthread_mutex_t lock;
    pthread_cond_t moved;
    pupil_camera_calls table;
} fake_controls;

void fake_uvc(fake_controls *fake);    /* automatic exposure on, exposure 3..2047 (x 100 us), gain 0..255, usual 16 */
void fake_sensor(fake_controls *fake); /* an imx219 of 1920 x 1080 */
/* Open the fakes. The sensor's name may be any other of the table. */
pupil_camera_options fake_uvc_options(fake_controls *fake);
pupil_camera_options fake_sensor_options(fake_controls *fake);
int64_t fake_value(fake_controls *fake, uint32_t id);
void fake_release(fake_controls *fake);

#endif

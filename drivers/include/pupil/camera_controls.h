/* camera_controls.h: a camera's exposure time and gain in seconds and factors, for anybody's capture loop.
 *
 *     pupil_camera_options options = {.fd = video_fd, .subdevice_fd = -1};
 *     pupil_camera *camera = pupil_camera_open(&options, &why);  // V4L2
 *     pupil_camera_configure(camera, &sensor_config);            // limits, steps and gain law for pupil/sensor.h
 *     for each frame:
 *         pupil_camera_frame(camera, sequence, 0);
 *         pupil_camera_in_force(camera, sequence, &info);        // info.exposure_s and .gain of this very frame
 *         ... pupil_sensor_frame, pupil_sensor_get ...
 *         pupil_camera_learn(camera, s.exposure_delay, s.gain_delay);
 *         pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = s.exposure_s, .gain = s.gain});
 *     pupil_camera_close(camera, &why);
 *
 * camera_loop.h does the last three lines of a frame, and handles writes that are slow or refused.
 *
 * It captures nothing and knows nothing of buffers. It works next to GStreamer or any program that has the device open.
 * Only this header, libpupil-camera and -pthread are needed (pkg-config pupil-camera); it uses only types of libpupil.
 *
 * V4L2 controls of UVC cameras: EXPOSURE_AUTO (its menu), EXPOSURE_ABSOLUTE (100 us), EXPOSURE_AUTO_PRIORITY and GAIN.
 * Of sensors, on their subdevice or on a video node that passes them on: EXPOSURE (lines; the line's time comes from
 * PIXEL_RATE, HBLANK and the width), VBLANK, and ANALOGUE_GAIN (by the sensor's law: sensors.txt). Of both:
 * POWER_LINE_FREQUENCY. VBLANK is written first, alone, and the limits of EXPOSURE are read again after it.
 *
 * Taking and giving back: open notes the values of all controls that it is going to change. It turns off automatic
 * exposure, gain and white balance, backlight compensation and the frame rate that follows the light. Close puts
 * everything back. So does an open that fails, and pupil_camera_restore for exits that are not orderly.
 *
 * pupil_camera_status keeps three things apart: what was asked for, what the driver took, and from which frame on that
 * is in force.
 *
 * Threads: a write of a control can take milliseconds, or seconds over USB. So the camera has a thread for it. ask,
 * reapply, frame, in_force, learn and get_status never wait for the driver. Of several asks in a row the latest is
 * written, the others are dropped. These may be called from any thread; open, configure and close from one.
 *
 * ABI: libpupil-camera is an archive, installed with this header. A program is linked with the version that it was
 * compiled with, so the structs here have no size_bytes (pupil/abi.h).
 */
#ifndef PUPIL_CAMERA_CONTROLS_H
#define PUPIL_CAMERA_CONTROLS_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"
#include "pupil/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* --- laws --- */

/* The factor of a gain code x. All rise with x. */
typedef enum pupil_camera_law {
    PUPIL_CAMERA_RATIO = 0, /* (p[0] x + p[1]) / (p[2] x + p[3]), as MIPI CCS has it: x / 16 is 1 0 0 16, and
                             * 256 / (256 - x) is 0 256 -1 256 */
    PUPIL_CAMERA_DB,        /* 10^(p[0] x / 20) */
    PUPIL_CAMERA_OCTAVES,   /* p[0] steps an octave: 2^(x / p[0]) (1 + (x mod p[0]) / p[0]), x / p[0] rounded down */
    PUPIL_CAMERA_TABLE,     /* code[i] is gain[i]; between two codes as the lower one */
    PUPIL_CAMERA_LAW_COUNT
} pupil_camera_law;

#define PUPIL_CAMERA_TABLE_ROWS 32

typedef struct pupil_camera_gain {
    uint32_t law;  /* a pupil_camera_law */
    uint32_t rows; /* of the table */
    double p[4];
    int32_t code[PUPIL_CAMERA_TABLE_ROWS];
    double gain[PUPIL_CAMERA_TABLE_ROWS];
} pupil_camera_gain;

/* A control's range, as the driver reports it. */
typedef struct pupil_camera_range {
    int64_t least, most, step, usual;
} pupil_camera_range;

/* 0 if the code has no gain (below a table, a denominator of 0). */
double pupil_camera_gain_of_code(const pupil_camera_gain *law, int64_t code);
/* The largest code of the range whose gain is at most `gain`, with a tolerance of a millionth; else the least code. */
int64_t pupil_camera_code_of_gain(const pupil_camera_gain *law, double gain, const pupil_camera_range *range);
/* The same for an exposure time in units: lines, 100 us. */
int64_t pupil_camera_code_of_exposure(double exposure_s, double unit_s, const pupil_camera_range *range);

/* --- sensors --- */

typedef struct pupil_camera_sensor {
    char name[24];
    pupil_camera_gain gain;
    uint32_t exposure_delay, gain_delay; /* frames: what is written while frame n is exposed acts on n + delay; 0:
                                          * unknown */
    double black;                        /* of a full scale of 65535; negative: unknown */
    uint32_t has_matrix;
    float matrix[9];  /* rgb_from_camera (pupil/coding.h) in daylight, after white balance */
    char source[128]; /* where this is known from */
} pupil_camera_sensor;

/* Looks a sensor up by its name, or by the name of its subdevice ("imx219 10-0010"), in `text`, or where that is NULL
 * in the built-in table, sensors.txt. 1: found; 0: not there; -1: the text is wrong, and `why` has its line. */
int pupil_camera_find_sensor(const char *text, const char *name, pupil_camera_sensor *sensor, pupil_why *why);
/* The built-in table. */
const char *pupil_camera_sensors(void);

/* --- what a camera can and does --- */

typedef struct pupil_camera_limits {
    double exposure_min_s, exposure_max_s, exposure_step_s;
    double gain_min, gain_max;       /* 1, 1 where there is no control of gain */
    double frame_s;                  /* the frame's period by VBLANK; 0: unknown */
    double frame_min_s, frame_max_s; /* by the range of VBLANK; 0: unknown */
    uint32_t has_gain;
    uint32_t gain_known; /* the law is a sensor's; 0: assumed to be proportional, with 1 at the least code, or at the
                          * control's default if the least code is 0 */
    uint32_t exposure_delay, gain_delay; /* frames, as above, or as they were learned; 3 if unknown */
    pupil_camera_gain gain;
    int64_t gain_code_step; /* between two codes of the gain */
    double readout_s;       /* of the sensor's lines, one after another: height times a line's time; 0: unknown */
} pupil_camera_limits;

typedef struct pupil_camera_setting {
    double exposure_s, gain; /* 0: as it is */
    double frame_s;          /* by VBLANK, where there is one; 0: as it is */
} pupil_camera_setting;

typedef struct pupil_camera_value {
    double asked;        /* the latest ask; 0: none */
    double taken;        /* what the driver reports after the latest write that returned */
    uint64_t from_frame; /* the sequence of the first frame with `taken` */
} pupil_camera_value;

typedef struct pupil_camera_status {
    pupil_camera_value exposure_s, gain;
    uint64_t asks, written; /* number of the latest ask, and of the latest that was written or refused */
    uint64_t failed;        /* writes that the driver refused ... */
    int error;              /* ... and the errno of the last one */
    uint32_t writing;       /* a write is in progress */
} pupil_camera_status;

/* --- any camera --- */

typedef struct pupil_camera pupil_camera;

/* What the calls below do for a kind of camera. pupil_camera_open makes one of V4L2. For another kind (a vendor's
 * library, a simulation) fill in a table, and put a pupil_camera first in the object. No function may wait for the
 * camera, except for get_limits, restore and close. */
typedef struct pupil_camera_ops {
    uint64_t (*ask)(pupil_camera *camera, const pupil_camera_setting *setting);
    uint64_t (*reapply)(pupil_camera *camera);
    void (*frame)(pupil_camera *camera, uint64_t sequence, int started);
    void (*in_force)(pupil_camera *camera, uint64_t sequence, pupil_frame_info *info);
    void (*learn)(pupil_camera *camera, uint32_t exposure_delay, uint32_t gain_delay);
    void (*get_status)(pupil_camera *camera, pupil_camera_status *status);
    void (*get_limits)(pupil_camera *camera, pupil_camera_limits *limits);
    void (*restore)(pupil_camera *camera);
    int (*close)(pupil_camera *camera, pupil_why *why);
} pupil_camera_ops;

struct pupil_camera {
    const pupil_camera_ops *ops;
};

/* Puts everything back and frees the object. 0: done; -1 and a sentence: a control could not be put back (named; the
 * others are). Waits up to a second for a write that hangs; then returns 1, and the camera's thread puts everything
 * back and frees the object when the write returns. NULL: 0. */
int pupil_camera_close(pupil_camera *camera, pupil_why *why);

/* Puts everything back, at once, by system calls alone (no lock, no memory): for handlers of fatal signals. The object
 * remains; nothing may be asked after it. NULL: nothing. */
void pupil_camera_restore(pupil_camera *camera);

void pupil_camera_get_limits(pupil_camera *camera, pupil_camera_limits *limits);

/* Writes exposure limits and step, gain limits and law, and the delay into a config. A law that pupil_gain_law has no
 * name for becomes PUPIL_GAIN_ANY; pupil_camera_in_force reports the gains that result. A known frame period goes into
 * frame_s. `linear` depends on the format, and stays as it is: 0 for cameras with a tone curve (Y'CbCr, RGB). */
void pupil_camera_configure(pupil_camera *camera, pupil_sensor_config *config);

/* Hands the setting to the writer; returns the ask's number, from 1. NaN and negative numbers count as 0. */
uint64_t pupil_camera_ask(pupil_camera *camera, const pupil_camera_setting *setting);

/* After STREAMON, at which some drivers set their controls again: has the writer turn off once more what open turned
 * off, and write the latest setting. Returns the number of that ask. */
uint64_t pupil_camera_reapply(pupil_camera *camera);

/* A frame has begun (started 1: V4L2_EVENT_FRAME_SYNC) or was dequeued (0; the next one is then being exposed). */
void pupil_camera_frame(pupil_camera *camera, uint64_t sequence, int started);

/* For pupil_camera_frame(.., 0) of a program that is slower than its camera, or where frames wait in a queue: the last
 * frame that is complete now, if `sequence` was complete at end_ns and frames come every frame_s. Both times are by one
 * clock. At most 256 more than `sequence`. */
uint64_t pupil_camera_newest(uint64_t sequence, int64_t end_ns, int64_t now_ns, double frame_s);

/* Fills in exposure_s and gain of a frame: the values that the driver took and that were in force then. For a frame
 * from before the last 16 writes: the oldest of them. */
void pupil_camera_in_force(pupil_camera *camera, uint64_t sequence, pupil_frame_info *info);

/* The delays that frames show, as in pupil_sensor_setting: from the frame last given to in_force when a setting was
 * asked for, to the first frame that was taken with it; 0: not known. From now on in_force and get_status use them,
 * also for earlier writes, instead of the sensor's known delays or assumed ones. While only one of two equal delays is
 * known, they stay equal. Call it after each frame; the same delays again cost nothing. */
void pupil_camera_learn(pupil_camera *camera, uint32_t exposure_delay, uint32_t gain_delay);

void pupil_camera_get_status(pupil_camera *camera, pupil_camera_status *status);

/* --- V4L2 --- */

/* The one system call that is made, so that a fake can take its place. */
typedef struct pupil_camera_calls {
    void *context;                                                              /* the first argument */
    int (*ioctl)(void *context, int fd, unsigned long request, void *argument); /* as ioctl(2): -1 and errno */
} pupil_camera_calls;

typedef struct pupil_camera_options {
    const pupil_camera_calls *calls; /* NULL: ioctl(2), on duplicates of the files. Else the context and the files must
                                      * remain valid until close returned 0 or -1, or `released` was called */
    void (*released)(void *user);    /* called once, when the context and the files are no longer needed: by an open
                                      * that failed, by close, or after a close that returned 1, by the camera's thread.
                                      * NULL: no call */
    void *user;                      /* of released */
    int fd;                          /* the video node, opened for writing; -1: none. Stays the caller's */
    int subdevice_fd;                /* the sensor's subdevice; -1: none */
    const char *sensor_name;         /* its name in the media graph, for its law; NULL: unknown */
    const pupil_camera_sensor *sensor; /* used instead of the table; NULL: the table */
    uint32_t width, height; /* of the sensor's own format (VIDIOC_SUBDEV_G_FMT); wanted where EXPOSURE is in lines */
    double line_s;          /* a line's time; 0: from PIXEL_RATE, HBLANK and width, where the driver has them */
    uint32_t delay;    /* frames that a control takes to act, as measured ('pupil probe'): then nothing is learned; 0:
                        * as known for the sensor */
    uint32_t mains_hz; /* POWER_LINE_FREQUENCY: 50, 60; 0: as it is */
    uint32_t at_frame_start; /* 1: writes just after pupil_camera_frame(.., 1), which reports V4L2_EVENT_FRAME_SYNC, or,
                              * if none comes in 0.2 s, without it */
} pupil_camera_options;

/* NULL and a sentence: there is no control of exposure; or the driver refuses a control (named), and everything is put
 * back. */
pupil_camera *pupil_camera_open(const pupil_camera_options *options, pupil_why *why);

#ifdef __cplusplus
}
#endif

#endif

/* The sensor's loop around abstract_camera, both as plain bytes: a copy continues from the same state. Events are a
 * text: letters, then a point for each frame.
 *
 *     0-9  the light is that level from this frame on
 *     e g  exposure, gain: dead, or alive again
 *     a    the camera's own automatic comes, or goes
 *     m c i  info is missing, is constant, says what was asked for last; or is true again
 *     x w b  the next frame is lost, white, black
 *     n    no fault any more
 */
#ifndef PUPIL_TESTS_ABSTRACT_LOOP_H
#define PUPIL_TESTS_ABSTRACT_LOOP_H

#include "abstract_camera.h"

enum { ABSTRACT_CAMERAS = 4 * 4 * 2 * 2 };

typedef struct abstract_loop {
    pupil_sensor sensor;
    abstract_camera camera;
    abstract_frame next; /* fault of the next frame */
    uint32_t believed;   /* delay_frames */
} abstract_loop;

typedef enum abstract_verdict {
    ABSTRACT_RIGHT = 0,
    ABSTRACT_NO_NUMBER,       /* NaN or infinite, or a call that failed */
    ABSTRACT_OUTSIDE_LIMITS,  /* a setting that the camera does not have */
    ABSTRACT_SHOWN_WRONG,     /* over 0.1 EV from the key, which is within reach */
    ABSTRACT_SENSOR_WRONG,    /* over 0.25 EV, and half a step, from the best setting */
    ABSTRACT_LIMIT_NOT_NAMED, /* out of reach, and the state is not LIMITED by a limit of that side */
    ABSTRACT_VERDICTS
} abstract_verdict;
extern const char *const abstract_verdict_name[ABSTRACT_VERDICTS];

/* One of ABSTRACT_CAMERAS: a true and a believed delay of 1 to 4, a saturation, a start at rest or none. */
void abstract_loop_open(abstract_loop *loop, int which);
const char *abstract_camera_name(int which);

/* Calls of pupil_sensor_frame so far, of all loops of this process. */
extern uint64_t abstract_frames;

/* Applies the letters; each point is a frame. Returns the first verdict that is ABSTRACT_NO_NUMBER or
 * OUTSIDE_LIMITS. */
abstract_verdict abstract_loop_go(abstract_loop *loop, const char *text);

/* Whether the shown frame is as promised for still light. */
abstract_verdict abstract_loop_judge(const abstract_loop *loop);

/* A line of the last frame. */
void abstract_loop_print(const abstract_loop *loop);

/* A hash of the state: equal states have equal hashes. Numbers of ordinary size are rounded to 1/64, relatively where
 * they are below 1. */
uint64_t abstract_loop_hash(const abstract_loop *loop);

#endif

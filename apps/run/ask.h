/* apps/run/ask.h: what a line of the control socket does to a run (docs/camera.md, Changing a running camera). */
#ifndef PUPIL_APPS_RUN_ASK_H
#define PUPIL_APPS_RUN_ASK_H

#include "options.h"
#include "sensor.h"
#include "session/session.h"

typedef struct run_ask {
    run_options *options;
    session *session;
    run_sensor *sensor;
    double gain_min, exposure_min_s; /* the camera's; 0: not controlled */
    frame_log_entry last;            /* the latest frame's; its texts are constant */
} run_ask;

/* A run_control_answer, called between two frames: the next frame has the settings. */
void run_ask_line(void *ask, const char *line, char *answer, size_t answer_bytes);

#endif

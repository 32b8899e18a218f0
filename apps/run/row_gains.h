/* apps/run/row_gains.h: the gains of a frame's rows under lamps on the mains (pupil/row_gain.h), for --row-gains. */
#ifndef PUPIL_APPS_RUN_LAMPS_H
#define PUPIL_APPS_RUN_LAMPS_H

#include "options.h"
#include "pupil/row_gain.h"
#include "sensor.h"

typedef struct run_row_gains {
    const run_options *options; /* NULL: as without --row-gains */
    const pupil_source *source;
    const pupil_camera *camera; /* whose readout was queried last; NULL: none */
    double readout_s;           /* 0: unknown */
    pupil_row_gain_config of;   /* of the lamps; mains_hz 0: there are none (now) */
    pupil_row_gain lamps;
    uint64_t frames, with; /* all; with gains */
    uint32_t reason;       /* of the last frame */
    float gain[PUPIL_MAX_SIDE_PX];
} run_row_gains;

/* For a live source, whose mode is no longer RUN_BEST. `remark`: if there will be no gains, a sentence that says how to
 * get them; else empty. */
void run_row_gains_begin(run_row_gains *l, const run_options *options, const pupil_source *source, pupil_why *remark);

/* Before a frame is mapped: the gains of its rows, valid until the next frame; NULL: none. */
const float *run_row_gains_take(run_row_gains *l, const run_sensor *sensor, const pupil_frame *frame);

/* "; row correction gains in 280 of 300 frames", and why the last frame had none; or nothing. */
void run_row_gains_tell(const run_row_gains *l, char *text, size_t text_bytes);

#endif

/* tests/drivers/live/simulated/simulated_camera.h: the simulated camera of fixtures/plant.h behind the table of
 * pupil/camera_controls.h. A write can take several frames, and can be refused for a while. */
#ifndef PUPIL_TESTS_DRIVERS_LIVE_SIMULATED_SIMULATED_CAMERA_H
#define PUPIL_TESTS_DRIVERS_LIVE_SIMULATED_SIMULATED_CAMERA_H

#include "plant.h"
#include "pupil/camera_controls.h"

typedef struct simulated_camera {
    pupil_camera base;
    fixture_plant_config config;
    fixture_plant *plant;
    uint64_t frame;        /* number of the last frame */
    uint32_t write_frames; /* frames that a write takes; 0: done before ask returns */
    int refusal;           /* the errno of writes now; 0: they succeed */
    int restored, closed;  /* how often these were called */
    int writing;           /* a write is in progress ... */
    uint64_t done_at;      /* ... until this frame has come */
    pupil_camera_setting wanted, pending;
    uint64_t number; /* of the ask that is being written */
    pupil_camera_status status;
    pupil_frame_info told; /* of the last frame */
} simulated_camera;

/* Opens the camera with a setting in force. 0, or -1 and a sentence. */
int simulated_camera_open(simulated_camera *camera, const fixture_plant_config *config,
                          const fixture_light_script *script, double exposure_s, double gain, pupil_why *why);

/* The next frame's statistics and truth; info has no exposure time and gain, which come from pupil_camera_in_force. */
void simulated_camera_next(simulated_camera *camera, pupil_stats *stats, pupil_frame_info *info, fixture_truth *truth);

#endif

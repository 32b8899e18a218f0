#include <math.h>

#include "check.h"
#include "hostile_rows.h"

hostile_loop hostile;

/* Not one check for each call: a million checks would show no more. */
static void must(int is_fine, const char *what)
{
    if (is_fine)
        return;
    printf("the hostile camera's loop cannot go on: %s\n", what);
    exit(1);
}

static double off_ev(double ev)
{
    const double held = hostile_camera_highlight_ev(&hostile.camera);
    return ev > 0.0 ? ev : fmin(0.0, ev - held);
}

double hostile_wrong_ev(void)
{
    return fmax(fabs(off_ev(hostile.shown_ev)), fabs(off_ev(hostile.sensor_ev)));
}

void hostile_prepare(const hostile_row *row, uint64_t seed)
{
    must(hostile_camera_open(&hostile.camera, seed), "pupil_init");
    hostile_camera_config(&hostile.config);
    hostile.camera.info_missing = row->info_missing;
    hostile.is_judged = 1;
}

void hostile_begin(double start_ev)
{
    pupil_sensor *sensor = &hostile.sensor;
    const double right_s = HOSTILE_REST_S * exp2(-hostile.camera.light_ev);
    must(pupil_sensor_init(sensor, &hostile.config) == PUPIL_OK, "pupil_sensor_init");
    if (start_ev != 0.0)
        must(pupil_sensor_start(sensor, right_s * exp2(start_ev), 1.0) == PUPIL_OK, "pupil_sensor_start");
    must(pupil_sensor_get(sensor, &hostile.setting) == PUPIL_OK, "pupil_sensor_get");
    hostile_camera_write_first(&hostile.camera, hostile.setting.exposure_s, hostile.setting.gain);
}

void hostile_frame(void)
{
    static pupil_stats stats;
    hostile_camera *camera = &hostile.camera;
    pupil_sensor_setting *setting = &hostile.setting;
    pupil_frame_info info;
    must(hostile_camera_frame(camera, &stats, &info), "pupil_meter_rows");
    must(pupil_sensor_frame(&hostile.sensor, &stats, &info) == PUPIL_OK, "pupil_sensor_frame");
    must(pupil_sensor_get(&hostile.sensor, setting) == PUPIL_OK, "pupil_sensor_get");
    hostile.sensor_ev = camera->level_ev;
    hostile.shown_ev = camera->level_ev + log2(setting->frame_digital);
    hostile.seen_gain_ev = log2(camera->exposure_s * camera->gain * setting->frame_digital);
    if (hostile.is_judged && setting->state == PUPIL_SENSOR_CONVERGED)
        hostile.converged_ev = fmax(hostile.converged_ev, fabs(off_ev(hostile.shown_ev)));
    hostile_camera_write(camera, setting->exposure_s, setting->gain);
}

void hostile_frames(int count)
{
    for (int i = 0; i < count; i++)
        hostile_frame();
}

double hostile_worst_wrong(void)
{
    double worst = 0.0;
    hostile_frames(PROMISED);
    for (int i = 0; i < WATCHED; i++) {
        hostile_frame();
        worst = fmax(worst, hostile_wrong_ev());
    }
    return worst;
}

/* The loop is right despite incomplete or odd frames: no histogram, no metadata, impossible numbers, many frames lost
 * at once, and the bands of lamps on the mains. */
#include <math.h>

#include "abstract_camera.h"
#include "check.h"

enum { PROMISED = 60 };

typedef struct kind {
    const char *name;
    int has_no_histogram, has_no_info;
    double exposure_s, gain; /* not 0: what info says, of each fifth frame */
    int lost;                /* frames before each change of light */
} kind;

static pupil_sensor sensor;
static pupil_sensor_setting s;
static abstract_camera camera;

static void begin(uint32_t mains_hz)
{
    pupil_sensor_config config;
    abstract_camera_config(&config, 4);
    config.mains_hz = mains_hz;
    CHECK(pupil_sensor_init(&sensor, &config) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    camera = abstract_camera_open(2, 1.0, s.exposure_s, s.gain);
}

static void without_histogram(pupil_stats *stats)
{
    stats->has_histogram = 0;
    stats->peak = 0;
    memset(stats->bin, 0, sizeof stats->bin);
    memset(stats->peak_bin, 0, sizeof stats->peak_bin);
}

static void turn(const kind *k)
{
    static pupil_stats stats;
    const pupil_stats *metered;
    pupil_frame_info info;
    CHECK(abstract_camera_frame(&camera, ABSTRACT_FRAME_FINE, &metered, &info));
    stats = *metered;
    if (k->has_no_histogram)
        without_histogram(&stats);
    if (camera.frame % 5 == 0 && k->exposure_s != 0)
        info.exposure_s = k->exposure_s;
    if (camera.frame % 5 == 0 && k->gain != 0)
        info.gain = k->gain;
    CHECK(pupil_sensor_frame(&sensor, &stats, k->has_no_info ? NULL : &info) == PUPIL_OK);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    abstract_camera_write(&camera, s.exposure_s, s.gain);
}

static void check_kinds(void)
{
    static const kind kinds[] = {{.name = "all that there is"},
                                 {.name = "no histogram", .has_no_histogram = 1},
                                 {.name = "no info", .has_no_info = 1},
                                 {.name = "neither", .has_no_histogram = 1, .has_no_info = 1},
                                 {.name = "an exposure of 1e30 s", .exposure_s = 1e30},
                                 {.name = "a gain of 1e30", .gain = 1e30},
                                 {.name = "an exposure that is none", .exposure_s = NAN},
                                 {.name = "a gain below 0", .gain = -1},
                                 {.name = "20 frames lost", .lost = 20},
                                 {.name = "40 frames lost", .lost = 40},
                                 {.name = "40 frames lost, no info", .lost = 40, .has_no_info = 1}};
    static const uint32_t levels[] = {4, 6, 2, 7, 3, 8, 5, 4};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        begin(0);
        for (size_t step = 0; step < sizeof levels / sizeof *levels; step++) {
            for (int n = 0; n < kinds[i].lost; n++) {
                const pupil_stats *stats;
                pupil_frame_info info;
                CHECK(!abstract_camera_frame(&camera, ABSTRACT_FRAME_LOST, &stats, &info));
                abstract_camera_write(&camera, s.exposure_s, s.gain);
            }
            camera.level = levels[step];
            for (int n = 0; n < PROMISED; n++)
                turn(&kinds[i]);
            const double off_ev = abstract_camera_off_ev(&camera), shown_ev = off_ev + log2(s.frame_digital);
            /* a line is 0.9 stops in the light of level 8 */
            CHECK_MSG(fabs(shown_ev) <= 0.1 && fabs(off_ev) <= (levels[step] == 8 ? 1.0 : 0.25),
                      "%s, level %u: sensor %+.3f EV, shown %+.3f EV", kinds[i].name, levels[step], off_ev, shown_ev);
        }
    }
}

/* A frame under lamps, by a rolling shutter of 20 ms. */
static void turn_under_lamps(double hz, double frame_s)
{
    static pupil_stats stats;
    const pupil_stats *metered;
    const double pi = 3.14159265358979;
    pupil_frame_info info;
    CHECK(abstract_camera_frame(&camera, ABSTRACT_FRAME_FINE, &metered, &info));
    stats = *metered;
    const double t = camera.frame * frame_s, x = 2 * pi * hz * camera.in_force[0];
    for (int band = 0; band < PUPIL_BANDS; band++) {
        const double wave = 0.4 * sin(x) / x * sin(4 * pi * hz * (t + 0.02 * band / PUPIL_BANDS));
        stats.band_log2_sum[band] += (int64_t)(stats.band_pixels[band] * log2(1 + wave) * 0x1p24);
    }
    info.timestamp_ns = 1000000000 + (int64_t)(t * 1e9);
    CHECK(pupil_sensor_frame(&sensor, &stats, &info) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    abstract_camera_write(&camera, s.exposure_s, s.gain);
    const double shown_ev = abstract_camera_off_ev(&camera) + log2(s.frame_digital);
    CHECK_MSG(fabs(shown_ev) <= 0.1, "%g Hz, frame %u: shown %+.3f EV", hz, camera.frame, shown_ev);
}

/* Lamps at 60 Hz, where the loop rests at 10 ms: found, and exposures are multiples of half a period from then on; what
 * is shown does not move. A lock keeps the setting; a new configuration keeps what was found. */
static void check_mains(uint32_t is_locked)
{
    pupil_sensor_config config;
    abstract_camera_config(&config, 4);
    config.mains_hz = PUPIL_SENSOR_MAINS_AUTO;
    config.frame_s = config.exposure_max_s = 1.0 / 27.0; /* the bands of neither lamp are still in it */
    begin(PUPIL_SENSOR_MAINS_AUTO);
    config.lock = is_locked;
    CHECK(pupil_sensor_retune(&sensor, &config) == PUPIL_OK);
    for (int n = 0; n < PROMISED; n++)
        turn_under_lamps(60, config.frame_s);
    const double periods = s.exposure_s * 120;
    if (is_locked)
        CHECK(s.state == PUPIL_SENSOR_LOCKED && fabs(s.exposure_s - ABSTRACT_REST_S) < 1e-9);
    else
        CHECK_MSG(s.mains == PUPIL_SENSOR_MAINS_FOUND && s.mains_hz == 60 && fabs(periods - 1) < 0.01,
                  "mains %u, %u Hz, %g s", s.mains, s.mains_hz, s.exposure_s);
    config.lock = 0;
    CHECK(pupil_sensor_retune(&sensor, &config) == PUPIL_OK && pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    turn_under_lamps(60, config.frame_s);
    turn_under_lamps(60, config.frame_s);
    CHECK_MSG(s.mains == PUPIL_SENSOR_MAINS_FOUND && s.mains_hz == 60, "mains %u, %u Hz", s.mains, s.mains_hz);
}

/* log2 of the setting after a first frame of which this share is clipped. */
static double total_after(double clipped_share)
{
    begin(0);
    CHECK(pupil_sensor_scene(&sensor, -log2(s.exposure_s * s.gain), clipped_share, NULL) == PUPIL_OK);
    CHECK(pupil_sensor_get(&sensor, &s) == PUPIL_OK);
    return log2(s.exposure_s * s.gain);
}

/* From 97 % on it is only known that the frame is far too bright: the step is at once as large as is safe. */
static void check_blind(void)
{
    CHECK(total_after(0.97) == total_after(1.0));
    CHECK_MSG(total_after(0.97) < total_after(0.96) - 0.5, "%g, %g", total_after(0.97), total_after(0.96));
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_kinds();
    check_mains(0);
    check_mains(1);
    check_blind();
    return check_end();
}

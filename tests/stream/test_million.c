/* A million frames of a day with weather, clouds, tunnels, cuts to black and clock errors: the level stays finite,
 * within its limits and between its targets, every state is valid, and a fork from the middle ends the same.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

int main(int argc, char **argv)
{
    pupil_config config;
    static pupil_t pupil[PUPIL_LAW_COUNT], fork[PUPIL_LAW_COUNT];
    double light = 0, low = 1e9, high = -1e9;
    int64_t now = 0;
    check_begin(argc, argv);
    pupil_config_default(&config);
    config.ev_min = -12;
    config.ev_max = 14;
    for (uint32_t law = 0; law < PUPIL_LAW_COUNT; law++) {
        config.law = law;
        CHECK(pupil_init(&pupil[law], &config) == PUPIL_OK);
    }
    for (int n = 0; n < 1000000; n++) {
        pupil_frame_info info = {.sequence = (uint64_t)n};
        pupil_stats stats;
        const uint64_t dice = check_random() % 1000;
        light += (check_uniform() - 0.5) * 0.2 - light * 1e-3;
        const double ev = dice == 0 ? -30 : dice == 1 ? 29.9 : 3 * light;
        ref_stats_at(fmax(-30, fmin(29.9, ev)), 1, &stats);
        if (dice == 2)
            memset(&stats, 0, sizeof stats); /* no light at all */
        now += dice == 3 ? -INT64_C(5000000000) : dice == 4 ? INT64_C(3600000000000) : INT64_C(16666667);
        info.timestamp_ns = dice == 5 ? 0 : now;
        info.exposure_s = dice % 3 ? 0.01 : 0;
        info.gain = dice % 3 ? 1 + (double)(dice % 7) : 0;
        if (n == 500000)
            memcpy(fork, pupil, sizeof fork);
        for (uint32_t law = 0; law < PUPIL_LAW_COUNT; law++) {
            pupil_exposure e = {0};
            CHECK(pupil_adapt(&pupil[law], &stats, &info) == PUPIL_OK);
            if (n >= 500000)
                CHECK(pupil_adapt(&fork[law], &stats, &info) == PUPIL_OK);
            CHECK(pupil_get_exposure(&pupil[law], &e) == PUPIL_OK);
            CHECK_MSG(e.adapted_ev >= -12 && e.adapted_ev <= 14 && e.scale > 0 && isfinite(e.scale) &&
                          isfinite(e.white_ev),
                      "law %u, frame %d: level %g, scale %g, white %g", law, n, e.adapted_ev, e.scale, e.white_ev);
            CHECK(e.state <= PUPIL_STATE_LIMITED && e.reason < PUPIL_REASON_LOCK && e.dt_s >= 0);
            low = fmin(low, e.adapted_ev);
            high = fmax(high, e.adapted_ev);
        }
    }
    CHECK(memcmp(fork, pupil, sizeof fork) == 0);
    for (uint32_t law = 0; law < PUPIL_LAW_COUNT; law++) {
        pupil_exposure e;
        CHECK(pupil_get_exposure(&pupil[law], &e) == PUPIL_OK && e.frames > 990000 && e.frames <= 1000000);
    }
    CHECK(high - low > 4); /* the day had weather */
    printf("a million frames: levels from %g to %g EV\n", low, high);
    return check_end();
}

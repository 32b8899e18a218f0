/* With a weight of 1e-7 the level never stalls, never overshoots, and ends bit-equal to its target, under every law
 * with a weight (the eye's has none: test_eye.c). It starts less than 0.5 / w units of the state away: a recursion that
 * rounds to nearest would not move from there.
 */
#include "check.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

static void converge(uint32_t law, double weight, double distance, double target)
{
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats[2];
    pupil_exposure e = {0};
    unsigned long n = 0;
    const double from = ref_stats_at(target + distance, 0, &stats[0]), to = ref_stats_at(target, 0, &stats[1]);
    double before = from;
    int wrong = 0;
    pupil_config_default(&config);
    config.law = law;
    config.white_mode = PUPIL_WHITE_NONE;
    config.frame_weight = weight;
    config.tau_light_s = config.tau_dark_s = 1e6;
    config.nominal_frame_s = -log1p(-weight) * 1e6;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_adapt(&pupil, &stats[0], NULL) == PUPIL_OK);
    for (; before != to && n < 400000000 && !wrong; n++) {
        wrong |= pupil_adapt(&pupil, &stats[1], NULL) != PUPIL_OK;
        if (n % 64 && n > 256 && fabs(before - to) > 1e-9)
            continue; /* a check costs as much as a step */
        wrong |= pupil_get_exposure(&pupil, &e) != PUPIL_OK;
        wrong |= to > from ? e.adapted_ev < before || e.adapted_ev > to : e.adapted_ev > before || e.adapted_ev < to;
        before = e.adapted_ev;
    }
    CHECK_MSG(!wrong && before == to, "law %u, w %g: %.17g after %lu frames, target %.17g", law, weight, before, n, to);
    printf("law %u, w %g, from %g stops: bit-equal after %lu frames\n", law, weight, distance, n);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t law = 0; law < PUPIL_LAW_EYE; law++) {
        const int linear = law == PUPIL_LAW_ARITHMETIC_SCALE || law == PUPIL_LAW_ARITHMETIC_LUMINANCE;
        converge(law, 1e-7, linear ? 6e-10 : 1e-9, 3.7); /* units: 2^-52 of the light, or of a stop */
        converge(law, 1e-7, linear ? -4e-10 : -5e-10, -2.2);
        converge(law, 1e-9, linear ? 1e-10 : 1e-9,
                 0); /* a target of exactly 0, where doubles would crawl through denormals */
    }
    return check_end();
}

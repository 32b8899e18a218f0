/* The four formulas of the study against their closed forms (long double), and the relations between them: 3 equals 4
 * bit for bit, 1 and 2 mirror each other, light scaled by 2^k moves the level by k.
 */
#include "check.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

/* The weights of the study's tables. */
static const double table_weight[] = {0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09,
                                      0.1,   0.2,  0.3,  0.4,  0.5,  0.6,  0.7,  0.8,  0.9,  1};
#define WEIGHTS (sizeof table_weight / sizeof *table_weight)

static void start(pupil_t *pupil, uint32_t law, double weight)
{
    pupil_config config;
    pupil_config_default(&config);
    config.law = law;
    config.frame_weight = weight;
    config.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_init(pupil, &config) == PUPIL_OK);
}

static pupil_exposure adapt(pupil_t *pupil, const pupil_stats *stats)
{
    pupil_exposure exposure = {0};
    CHECK(pupil_adapt(pupil, stats, NULL) == PUPIL_OK);
    CHECK(pupil_get_exposure(pupil, &exposure) == PUPIL_OK);
    return exposure;
}

/* log2 of the level n frames after a step from one light to another. */
static long double closed_form(uint32_t law, long double from, long double to, double weight, int n)
{
    const long double left = powl(1 - (long double)weight, n);
    const long double a = exp2l(from), b = exp2l(to);
    if (law == PUPIL_LAW_ARITHMETIC_SCALE)
        return -log2l(1 / b + (1 / a - 1 / b) * left);
    if (law == PUPIL_LAW_ARITHMETIC_LUMINANCE)
        return log2l(b + (a - b) * left);
    return to + (from - to) * left;
}

static void check_closed_forms(void)
{
    double worst[PUPIL_LAW_COUNT] = {0};
    for (uint32_t law = PUPIL_LAW_ARITHMETIC_SCALE; law < PUPIL_LAW_EYE; law++)
        for (unsigned i = 0; i < WEIGHTS; i++)
            for (int step = 0; step < 4; step++) {
                const double w = table_weight[i], ratio = step < 2 ? 8.0980 : 25; /* log2 274: the study's lamp */
                pupil_t pupil;
                pupil_stats stats[2];
                const double low = ref_stats_at(-2.504, 0, &stats[0]),
                             high = ref_stats_at(-2.504 + ratio, 0, &stats[1]);
                const double from = step & 1 ? high : low, to = step & 1 ? low : high;
                /* The geometric state is an integer of 2^-52 stop, rounded away from the old value by up to one unit
                 * each frame: at most 1/w units ahead. The arithmetic ones are doubles, with 2^-53 relative, so the
                 * bound is the same. */
                const double bound = 0x1p-51 * (1 / w + 8);
                start(&pupil, law, w);
                adapt(&pupil, &stats[step & 1]);
                for (int n = 1; n <= 1800; n++) {
                    const double got = adapt(&pupil, &stats[!(step & 1)]).adapted_ev;
                    const double off = fabs((double)(got - closed_form(law, from, to, w, n)));
                    worst[law] = fmax(worst[law], off);
                    CHECK_MSG(off <= bound, "formula %u, w %g, step %d, frame %d: off by %g (%g)", law, w, step, n, off,
                              bound);
                }
            }
    for (uint32_t law = PUPIL_LAW_ARITHMETIC_SCALE; law < PUPIL_LAW_EYE; law++)
        printf("formula %u: at most %.2g stops from its closed form\n", law, worst[law]);
}

/* Monotone, never past the target, and in the end the target itself, to the bit. */
static void check_endings(void)
{
    int longest = 0;
    for (uint32_t law = PUPIL_LAW_SECONDS; law < PUPIL_LAW_EYE; law++)
        for (unsigned i = 0; i < WEIGHTS; i++)
            for (int step = 0; step < 6; step++) {
                static const double ev[][2] = {{-2.504, 5.594}, {5.594, -2.504},   {-20, 20.3},
                                               {29.7, -29.2},   {0.1, 0.1 + 1e-9}, {1, 0}};
                const double w = table_weight[i];
                pupil_t pupil;
                pupil_stats stats[2];
                const double from = ref_stats_at(ev[step][0], 0, &stats[0]),
                             to = ref_stats_at(ev[step][1], 0, &stats[1]);
                int n = 0;
                start(&pupil, law, w);
                if (law == PUPIL_LAW_SECONDS) { /* dt and tau that give the same weight */
                    pupil_config config;
                    pupil_config_default(&config);
                    config.white_mode = PUPIL_WHITE_NONE;
                    config.nominal_frame_s = 0.1;
                    config.tau_light_s = config.tau_dark_s = w < 1 ? 0.1 / -log1p(-w) : 0;
                    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
                }
                double before = adapt(&pupil, &stats[0]).adapted_ev;
                CHECK(before == from);
                for (; before != to && n < 40000; n++) {
                    const pupil_exposure e = adapt(&pupil, &stats[1]);
                    CHECK_MSG(to > from ? e.adapted_ev >= before && e.adapted_ev <= to
                                        : e.adapted_ev <= before && e.adapted_ev >= to,
                              "law %u, w %g, step %d, frame %d: %.17g after %.17g", law, w, step, n, e.adapted_ev,
                              before);
                    CHECK(e.metered_ev == to);
                    before = e.adapted_ev;
                }
                CHECK_MSG(before == to, "law %u, w %g, step %d: stands at %.17g, target %.17g", law, w, step, before,
                          to);
                CHECK(adapt(&pupil, &stats[1]).adapted_ev == to && (w < 1 || n <= 1));
                longest = n > longest ? n : longest;
            }
    printf("every law and weight ends bit-equal to its target; the longest took %d frames\n", longest);
}

static void check_relations(void)
{
    double mirror = 0, scaled = 0;
    for (unsigned i = 0; i < WEIGHTS; i++) {
        pupil_t p[PUPIL_LAW_COUNT], inverse, shifted[PUPIL_LAW_COUNT];
        for (uint32_t law = 1; law < PUPIL_LAW_EYE; law++) {
            start(&p[law], law, table_weight[i]);
            start(&shifted[law], law, table_weight[i]);
        }
        start(&inverse, PUPIL_LAW_ARITHMETIC_LUMINANCE, table_weight[i]);
        for (int n = 0; n < 300; n++) {
            /* the four cases of the study in one: dark, lit at 30, dark at 60, and so on */
            const double ev = n / 30 % 2 ? 5.594 : -2.504;
            pupil_stats stats, mirrored, brighter;
            double level[PUPIL_LAW_COUNT];
            ref_stats_at(ev, 0, &stats);
            ref_stats_at(-ref_stats_at(ev, 0, &stats), 0, &mirrored);
            ref_stats_at(ev + 7, 0, &brighter);
            for (uint32_t law = 1; law < PUPIL_LAW_EYE; law++) {
                level[law] = adapt(&p[law], &stats).adapted_ev;
                scaled = fmax(scaled, fabs(adapt(&shifted[law], &brighter).adapted_ev - 7 - level[law]));
            }
            CHECK_MSG(memcmp(&level[3], &level[4], sizeof *level) == 0, "w %g, frame %d: formulas 3 and 4",
                      table_weight[i], n);
            mirror = fmax(mirror, fabs(adapt(&inverse, &mirrored).adapted_ev + level[1]));
        }
    }
    printf("formula 1 of 1/L mirrors formula 2 of L within %.2g stops (<= 1e-13); all light times 2^7: %.2g stops (<= "
           "1e-13)\n",
           mirror, scaled);
    CHECK(mirror <= 1e-13);
    CHECK(scaled <= 1e-13);
}

/* A change of law keeps any level. */
static void check_change(void)
{
    double worst = 0;
    for (uint32_t from = 0; from < PUPIL_LAW_COUNT; from++)
        for (uint32_t to = 0; to < PUPIL_LAW_COUNT; to++) {
            pupil_config config;
            pupil_t pupil;
            pupil_stats stats;
            pupil_exposure after = {0};
            start(&pupil, from, 0.1);
            ref_stats_at(-3.3, 0, &stats);
            adapt(&pupil, &stats);
            ref_stats_at(4.1, 0, &stats);
            const double before = adapt(&pupil, &stats).adapted_ev;
            pupil_config_default(&config);
            config.law = to;
            config.white_mode = PUPIL_WHITE_NONE;
            config.frame_weight = 1e-9;
            config.tau_light_s = 1e6;
            config.nominal_frame_s = to == PUPIL_LAW_EYE ? 1e-12 : config.nominal_frame_s; /* its times are fixed */
            CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
            CHECK(pupil_get_exposure(&pupil, &after) == PUPIL_OK && after.frames == 2);
            worst = fmax(worst, fabs(after.adapted_ev - before));
            /* and the next frame continues from there: 1e-7 is far more than such weights can move it */
            const double next = adapt(&pupil, &stats).adapted_ev;
            CHECK_MSG(fabs(next - before) <= 1e-6, "law %u to %u: %.17g, then %.17g", from, to, before, next);
        }
    printf("a change of law moves the level by at most %.2g stops\n", worst);
    CHECK(worst <= 1e-12);
}

/* With the weight 1 each frame has its own level, bit for bit, regardless of the past. */
static void check_at_once(void)
{
    for (uint32_t law = PUPIL_LAW_ARITHMETIC_SCALE; law < PUPIL_LAW_EYE; law++) {
        pupil_t pupil;
        start(&pupil, law, 1.0);
        for (int n = 0; n < 200; n++) {
            pupil_t first;
            pupil_stats stats;
            ref_stats_at(20.0 * check_uniform() - 10.0, 0, &stats);
            start(&first, law, 1.0);
            const double got = adapt(&pupil, &stats).adapted_ev, alone = adapt(&first, &stats).adapted_ev;
            CHECK_MSG(got == alone, "formula %u, frame %d: %.17g, alone %.17g", law, n, got, alone);
        }
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_closed_forms();
    check_at_once();
    check_endings();
    check_relations();
    check_change();
    return check_end();
}

/* The study on two lamps over spheres: every acceptance test holds; with the original study's binary32 recursions A3
 * and A5 do not; the tables are as if every frame were mapped. */
#include "lab/study/study.h"

#include <math.h>

#include "check.h"
#include "scratch.h"

static pupil_why why;

typedef struct setup {
    study_images images;
    study_lights lights;
    study_states states;
    study_target target[2];
    study_cells cells;
    study_test tests[STUDY_TESTS];
} setup;

static void begin(setup *s, uint32_t width, uint32_t height, int float32)
{
    CHECK(study_images_spheres(&s->images, width, height, &why) == 0);
    CHECK(study_lights_meter(&s->lights, &s->images, 0) == PUPIL_OK);
    CHECK(study_states_make(&s->states, &s->lights, float32) == PUPIL_OK);
    for (int light = 0; light < 2; light++)
        CHECK(study_target_open(&s->target[light], &s->images, &s->lights, light) == 0);
}

static void end(setup *s)
{
    study_target_close(&s->target[0]);
    study_target_close(&s->target[1]);
    study_images_free(&s->images);
}

static double ln_r(const setup *s)
{
    return (s->lights.ev[1] - s->lights.ev[0]) * M_LN2;
}

static void make(setup *s, workers *team)
{
    CHECK(study_cells_make(&s->cells, &s->images, s->target, &s->states, team, NULL, NULL) == 0);
    study_accept_cells(s->tests, &s->cells, ln_r(s));
}

/* --- acceptance --- */

static void check_acceptance(setup *s, workers *team)
{
    static setup scaled;
    begin(s, 96, 80, 0);
    make(s, team);
    CHECK(study_accept_states(s->tests, &s->cells, &s->lights, &s->states, 0, team) == PUPIL_OK);

    begin(&scaled, 96, 80, 0);
    study_images_scale(&scaled.images, -6);
    CHECK(study_lights_meter(&scaled.lights, &scaled.images, -6) == PUPIL_OK);
    CHECK(fabs(scaled.lights.ev[1] - s->lights.ev[1] + 6.0) < 1e-11);
    CHECK(study_states_make(&scaled.states, &scaled.lights, 0) == PUPIL_OK);
    for (int light = 0; light < 2; light++) {
        study_target_close(&scaled.target[light]);
        CHECK(study_target_open(&scaled.target[light], &scaled.images, &scaled.lights, light) == 0);
    }
    make(&scaled, team);
    study_accept_scaled(&s->tests[9], &s->cells, &scaled.cells);
    end(&scaled);

    /* the fewest cells that each test must check, so that none passes by checking too few */
    static const unsigned long least[STUDY_TESTS] = {64, 2176, 320, 500, 1000, 250, 1100, 160, 320, 1280, 1600};
    for (unsigned i = 0; i < STUDY_TESTS; i++) {
        CHECK_MSG(s->tests[i].violations == 0, "%s: %lu of %lu", s->tests[i].name, s->tests[i].violations,
                  s->tests[i].checked);
        CHECK_MSG(s->tests[i].checked >= least[i], "%s looked at %lu", s->tests[i].name, s->tests[i].checked);
    }
}

/* --- the tables against every frame --- */

static void check_every_frame(setup *s)
{
    for (unsigned k = 0; k < 12; k++) {
        const unsigned f = k % STUDY_FORMULAS, c = (unsigned)(check_random() % STUDY_CASES),
                       w = (unsigned)(check_random() % STUDY_WEIGHTS);
        study_target *target = &s->target[study_final(c)];
        uint16_t first[STUDY_THRESHOLDS] = {STUDY_LAST, STUDY_LAST, STUDY_LAST, STUDY_LAST};
        uint64_t before = UINT64_MAX;
        for (uint32_t i = study_start(c, STUDY_FPS) + 1; i < STUDY_FRAMES; i++) {
            uint64_t d = study_distance(target, s->states.u[f][c][w][i], UINT64_MAX);
            CHECK_MSG(d <= before, "farther in frame %u of formula %u case %u weight %u", i, f, c, w);
            before = d;
            for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
                if (d <= s->cells.threshold[t] && first[t] == STUDY_LAST)
                    first[t] = (uint16_t)i;
        }
        for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
            CHECK_MSG(first[t] == s->cells.frame[f][c][w][t], "formula %u case %u weight %u threshold %u: %u, not %u",
                      f, c, w, t, s->cells.frame[f][c][w][t], first[t]);
    }
}

/* --- the check can fail --- */

static void check_float32(setup *s, workers *team)
{
    begin(s, 96, 80, 1);
    make(s, team);
    CHECK(s->tests[2].violations > 20); /* formulas 3 and 4 differ by rounding alone */
    CHECK(s->tests[4].violations > 50);
    CHECK(s->tests[6].violations > 50);
    CHECK(study_accept_states(s->tests, &s->cells, &s->lights, &s->states, 1, team) == PUPIL_OK);
    CHECK(s->tests[7].violations > 100);
    CHECK(s->tests[8].violations > 100); /* "does not converge" */
    end(s);
}

/* Each test that checks a cell finds it if it is one frame too late. */
static void check_one_cell(setup *s)
{
    s->cells.frame[2][1][5][1] += 2;
    study_accept_cells(s->tests, &s->cells, ln_r(s));
    CHECK(s->tests[2].violations == 1 && s->tests[4].violations == 1 && s->tests[6].violations == 1);
    CHECK(s->tests[0].violations == 0 && s->tests[5].violations == 0);
    s->cells.frame[2][1][5][1] -= 2;
    s->cells.frame[0][0][STUDY_WEIGHTS - 1][3]++;
    study_accept_cells(s->tests, &s->cells, ln_r(s));
    CHECK(s->tests[0].violations == 1);
    s->cells.frame[0][0][STUDY_WEIGHTS - 1][3]--;
}

/* --- parts --- */

static void check_rounding(void)
{
    /* binary16: 11 significant bits, subnormals in steps of 2^-24, ties to even, at most 65504 */
    float v[] = {1.0f + 0x1p-11f, 1.0f + 3 * 0x1p-11f, 0x1p-24f, 0x1.8p-24f, 0x1p-26f, 1e6f, 0.0f, NAN, -0x1.0018p3f};
    const float right[] = {1.0f, 1.0f + 0x1p-9f, 0x1p-24f, 0x1p-23f, 0.0f, 65504.0f, 0.0f, 0.0f, -0x1.0p3f};
    study_images_round(v, sizeof v / sizeof v[0]);
    for (size_t i = 0; i < sizeof v / sizeof v[0]; i++)
        CHECK_MSG(v[i] == right[i], "%zu: %a, not %a", i, v[i], right[i]);
}

static void check_library_map(const setup *s)
{
    for (int light = 0; light < 2; light++) {
        uint64_t differ = 0;
        unsigned largest = 0;
        CHECK(study_distance_library(&s->target[light], &s->images, &s->lights, light, &differ, &largest) == PUPIL_OK);
        CHECK_MSG(largest <= 1 && differ <= 4, "%llu samples differ, by %u", (unsigned long long)differ, largest);
    }
}

/* The closed form against the library's state, and against its own inverse. */
static void check_closed_form(const setup *s)
{
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++)
            for (unsigned w = 0; w + 1 < STUDY_WEIGHTS; w++)
                for (unsigned n = 1; n < 60; n += 7) {
                    double u = s->states.u[f][c][w][study_start(c, STUDY_FPS) + n];
                    double said = (study_final(c) ? 1.0 : -1.0) * study_closed_u(f, c, study_weights[w], ln_r(s), n);
                    CHECK_MSG(fabs(u - said) <= 1e-12, "formula %u case %u weight %u n %u: %.17g, not %.17g", f, c, w,
                              n, u, said);
                    if (fabs(said) > 1e-9)
                        CHECK(study_closed_n(f, c, study_weights[w], ln_r(s), fabs(said) * (1.0 + 1e-9)) == n);
                }
}

static void check_csv(const setup *s)
{
    static study_cells again;
    const char *path = scratch("study.csv");
    FILE *f = fopen(path, "w");
    CHECK(f != NULL);
    if (!f)
        return;
    study_csv(f, &s->cells);
    fclose(f);
    CHECK(study_csv_read(&again, path, &why) == 0);
    CHECK(memcmp(again.frame, s->cells.frame, sizeof again.frame) == 0);

    static const char *const wrong[] = {"",
                                        "1,1,0.005,600,1799\n1,1,0.005,600,1799\n",
                                        "1,1,0.006,600,1799\n",
                                        "5,1,0.005,600,1799\n",
                                        "1,1,0.005,600,1800\n",
                                        "1,1,0.005,600\n"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        f = fopen(path, "w");
        if (f) {
            fputs(wrong[i], f);
            fclose(f);
        }
        CHECK(study_csv_read(&again, path, &why) == -1);
        CHECK_MSG(strstr(why.text, path), "%s", why.text);
    }
}

int main(int argc, char **argv)
{
    static setup s;
    check_begin(argc, argv);
    scratch_begin();
    workers *team = workers_open(2);
    check_rounding();
    check_acceptance(&s, team);
    check_every_frame(&s);
    check_library_map(&s);
    check_closed_form(&s);
    check_csv(&s);
    check_one_cell(&s);
    end(&s);
    check_float32(&s, team);
    workers_close(team);
    scratch_clear(scratch_folder);
    return check_end();
}

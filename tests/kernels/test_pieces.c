/* A level may implement any of the pieces; the scalar level's replace the others, with the same bits. Here are levels
 * with none, and with each half of this machine's best one. The linker replaces the table of levels by
 * __wrap_pupil_level_kernels (CMakeLists.txt). */
#include <math.h>
#include <string.h>

#include "check.h"
#include "frames.h"
#include "kernels/kernels.h"
#include "pupil/veil.h"

typedef void any_piece(void);
enum { PIECES = sizeof(pupil_kernels) / sizeof(any_piece *) };

typedef union table {
    pupil_kernels kernels;
    any_piece *piece[PIECES];
} table;

static table mixed;
static int is_mixed;

const pupil_kernels *__real_pupil_level_kernels(uint32_t level);
const pupil_kernels *__wrap_pupil_level_kernels(uint32_t level);
const pupil_kernels *__wrap_pupil_level_kernels(uint32_t level)
{
    return is_mixed ? &mixed.kernels : __real_pupil_level_kernels(level);
}

/* Each piece is the level's own with a probability of `share`; all levels have the pieces that take planes. */
static void mix(double share)
{
    const table own = {*__real_pupil_level_kernels(pupil_level_choose(0))};
    for (size_t i = 0; i < PIECES; i++)
        mixed.piece[i] = check_uniform() < share ? own.piece[i] : NULL;
    pupil_kernels *k = &mixed.kernels;
    k->meter[PUPIL_PLANES] = PUPIL_PIECE(k, meter[PUPIL_PLANES]);
    k->scale[PUPIL_PLANES] = PUPIL_PIECE(k, scale[PUPIL_PLANES]);
    k->scale_by_knots = PUPIL_PIECE(k, scale_by_knots);
}

/* --- a frame --- */

typedef struct outcome {
    pupil_stats metered, fused;
    frame mapped, fused_to, veiled;
} outcome;

/* The frame with a veil. What runs after the load is the same for each format. */
static void veil(const frame *in, const pupil_t *pupil, const pupil_curve *curve, uint32_t out, frame *to)
{
    static pupil_veil eye;
    static pupil_veil_light light;
    static pupil_veil_scratch scratch;
    pupil_veil_config config;
    *to = frame_make(in->image.width, in->image.height, out, 0, 0);
    const pupil_image target = frame_writable(to);
    pupil_veil_config_default(&config);
    config.width = in->image.width;
    config.height = in->image.height;
    CHECK(pupil_veil_init(&eye, &config) == PUPIL_OK && pupil_veil_light_clear(&light) == PUPIL_OK);
    CHECK(pupil_veil_gather_rows(&eye, pupil, &in->image, 0, NULL, &light) == PUPIL_OK);
    CHECK(pupil_veil_begin(&eye) == PUPIL_OK && pupil_veil_add_light(&eye, &light) == PUPIL_OK);
    CHECK(pupil_veil_solve(&eye) == PUPIL_OK);
    CHECK(pupil_veil_map_rows(&eye, pupil, curve, &in->image, &target, &scratch) == PUPIL_OK);
}

static void work(const frame *in, const pupil_config *config, const pupil_curve *curve, uint32_t out, uint32_t smaller,
                 outcome *o)
{
    pupil_t pupil;
    const uint32_t width = in->image.width / smaller, height = in->image.height / smaller;
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    o->mapped = frame_make(width, height, out, 0, 0);
    o->fused_to = frame_make(width, height, out, 0, 0);
    const pupil_image mapped = frame_writable(&o->mapped), fused = frame_writable(&o->fused_to);
    pupil_stats_clear(&o->metered);
    pupil_stats_clear(&o->fused);
    CHECK(pupil_meter_rows(&pupil, &in->image, 0, in->image.height, &o->metered) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, curve, &in->image, &mapped) == PUPIL_OK);
    CHECK(pupil_fused_rows(&pupil, curve, &in->image, 0, in->image.height, &fused, &o->fused) == PUPIL_OK);
    if (in->image.pixel == PUPIL_PIXEL_RGBA32F || in->image.pixel == PUPIL_PIXEL_RGB32F)
        veil(in, &pupil, curve, out, &o->veiled);
    else
        o->veiled = frame_make(1, 1, out, 0, 0);
}

static void outcome_free(outcome *o)
{
    frame_free(&o->mapped);
    frame_free(&o->fused_to);
    frame_free(&o->veiled);
}

static void compare(const frame *in, const pupil_config *config, const pupil_curve *curve, uint32_t out,
                    uint32_t smaller, double share)
{
    outcome expected, got;
    is_mixed = 0;
    work(in, config, curve, out, smaller, &expected);
    is_mixed = 1;
    work(in, config, curve, out, smaller, &got);
    is_mixed = 0;
    CHECK_MSG(memcmp(&got.metered, &expected.metered, sizeof got.metered) == 0 &&
                  memcmp(&got.fused, &expected.fused, sizeof got.fused) == 0,
              "share %g, pixel %u: statistics", share, in->image.pixel);
    CHECK_MSG(frame_equal(&got.mapped, &expected.mapped) && frame_equal(&got.fused_to, &expected.fused_to) &&
                  frame_equal(&got.veiled, &expected.veiled) && frame_guards_intact(&got.mapped),
              "share %g, pixel %u to %u", share, in->image.pixel, out);
    outcome_free(&expected);
    outcome_free(&got);
}

static pupil_config any_config(void)
{
    pupil_config c;
    pupil_config_default(&c);
    c.histogram = check_uniform() < 0.7;
    c.white_mode = c.histogram ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_NONE;
    c.output_primaries = check_uniform() < 0.5 ? PUPIL_OUTPUT_AS_INPUT : PUPIL_OUTPUT_BT2020;
    c.histogram_step = check_uniform() < 0.3 ? 4 : 0;
    c.accuracy = check_uniform() < 0.5 ? PUPIL_ACCURACY_LUMA : PUPIL_ACCURACY_EXACT;
    return c;
}

static pupil_curve any_curve(void)
{
    pupil_curve c = {.size_bytes = sizeof c, .scale = (float)exp2(6.0 * check_uniform() - 3.0), .gamut = 1.0f};
    c.inverse_white_squared = check_uniform() < 0.5 ? 0.01f : 0.0f;
    c.dither = check_uniform() < 0.4;
    c.knots = check_uniform() < 0.3 ? PUPIL_CURVE_KNOTS : 0;
    c.knot_scale = 100.0f;
    for (uint32_t k = 0; k < c.knots; k++)
        c.knot[k] = (float)k / PUPIL_CURVE_KNOTS;
    return c;
}

int main(int argc, char **argv)
{
    static const uint32_t outs[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_BGR8, PUPIL_PIXEL_NV12, PUPIL_PIXEL_I420,
                                    PUPIL_PIXEL_RGB32F};
    static const double shares[] = {0.0, 0.0, 0.5, 0.5, 0.5, 0.9};
    check_begin(argc, argv);
    for (size_t s = 0; s < sizeof shares / sizeof *shares; s++)
        for (uint32_t in = PUPIL_PIXEL_NONE + 1; in < PUPIL_PIXEL_COUNT; in++)
            for (size_t out = 0; out < sizeof outs / sizeof *outs; out++)
                for (uint32_t smaller = 1; smaller <= (pupil_pixel_is_mosaic(in) ? 2u : 1u); smaller++) {
                    uint32_t width = 300, height = 4; /* more than a block of pixels, and a remainder */
                    pupil_coding coding = {.rgb_from_camera = {1.6f, -0.4f, -0.2f, -0.3f, 1.5f, -0.2f, 0, -0.5f, 1.5f}};
                    coding.knees = pupil_pixel_is_mosaic(in) &&
                                   check_uniform() < 0.5; /* companded: half of the codes for a fifth of the light */
                    coding.knee_code[0] = coding.knees ? (float)(1u << (pupil_pixel_bits(in) - 1)) : 0.0f;
                    coding.knee_light[0] = coding.knees ? 0.2f : 0.0f;
                    pupil_config config = any_config();
                    pupil_curve curve = any_curve();
                    if (s == 0) { /* every format that can be mapped by luma is */
                        config.accuracy = PUPIL_ACCURACY_LUMA;
                        config.output_primaries = PUPIL_OUTPUT_AS_INPUT;
                        curve.dither = curve.knots = 0;
                    }
                    frame_fit(in, &width, &height);
                    frame f = frame_make(width, height, in, 0, 0);
                    frame_lognormal(&f, 0.18, 2.0, check_uniform);
                    f.image.coding = pupil_pixel_is_mosaic(in) && check_uniform() < 0.7 ? &coding : NULL;
                    mix(shares[s]);
                    compare(&f, &config, &curve, outs[out], smaller, shares[s]);
                    frame_free(&f);
                }
    return check_end();
}

/* Frames with a veil: the same bits at any CPU level and in any groups of rows; the picture of the formula; hard
 * frames; and what is refused.
 */
#include "check.h"
#include "frames.h"

#include <math.h>

#include "pupil/veil.h"

#define NODE_FLOATS (PUPIL_VEIL_NODES * PUPIL_VEIL_NODES * 3)

static const pupil_curve curve = {.scale = 2.0f, .inverse_white_squared = 0.0625f, .gamut = 3.7f, .dither = 1};

typedef struct outcome {
    pupil_veil_light light;
    pupil_stats stats;
    float nodes[NODE_FLOATS];
    frame to;
} outcome;

static pupil_veil veil;
static pupil_veil_light part;
static pupil_veil_scratch scratch;

static void start(pupil_t *pupil, uint32_t levels)
{
    pupil_config config;
    pupil_config_default(&config);
    config.levels = levels;
    CHECK(pupil_init(pupil, &config) == PUPIL_OK);
}

static void make_veil(uint32_t width, uint32_t height, uint32_t psf)
{
    pupil_veil_config config;
    pupil_veil_config_default(&config);
    config.width = width;
    config.height = height;
    config.psf = psf;
    CHECK(pupil_veil_init(&veil, &config) == PUPIL_OK);
}

/* The rows from `row` on, at most `most` of them, in pairs if the formats need that. */
static uint32_t rows_from(const frame *in, uint32_t row, uint32_t most)
{
    const uint32_t left = in->image.height - row, count = 2 * ((most + 1) / 2);
    return left < count ? left : count;
}

static void solve(outcome *o)
{
    CHECK(pupil_veil_begin(&veil) == PUPIL_OK);
    CHECK(pupil_veil_add_light(&veil, &o->light) == PUPIL_OK);
    CHECK(pupil_veil_solve(&veil) == PUPIL_OK);
    CHECK(pupil_veil_get_nodes(&veil, o->nodes) == PUPIL_OK);
}

/* In groups of up to `group` rows, each with its own light, from the last to the first. */
static void work(const frame *in, uint32_t levels, uint32_t group, uint32_t pixel_out, outcome *o)
{
    pupil_t pupil;
    start(&pupil, levels);
    pupil_stats_clear(&o->stats);
    CHECK(pupil_veil_light_clear(&o->light) == PUPIL_OK);
    o->to = frame_make(in->image.width, in->image.height, pixel_out, 0, 0);
    const pupil_image to = frame_writable(&o->to);
    uint32_t row[512], groups = 0;
    for (uint32_t y = 0; y < in->image.height; y += rows_from(in, y, group))
        row[groups++] = y;
    while (groups-- > 0) {
        const uint32_t y = row[groups];
        const pupil_image_const rows = pupil_image_rows(in->image, y, rows_from(in, y, group));
        CHECK(pupil_veil_light_clear(&part) == PUPIL_OK);
        CHECK(pupil_veil_gather_rows(&veil, &pupil, &rows, y, &o->stats, &part) == PUPIL_OK);
        CHECK(pupil_veil_light_add(&o->light, &part) == PUPIL_OK);
    }
    solve(o);
    for (uint32_t y = 0; y < in->image.height; y += rows_from(in, y, group)) {
        const pupil_image_const rows = pupil_image_rows(in->image, y, rows_from(in, y, group));
        const pupil_image out = pupil_image_out_rows(to, y, rows.height);
        pupil_curve by = curve;
        by.first_row = y;
        CHECK(pupil_veil_map_rows(&veil, &pupil, &by, &rows, &out, &scratch) == PUPIL_OK);
    }
    CHECK(frame_guards_intact(&o->to));
}

static void check_same(const frame *in, uint32_t pixel_out)
{
    static outcome whole, other;
    static const uint32_t levels[] = {PUPIL_LEVEL_SCALAR, PUPIL_LEVEL_NEON, PUPIL_LEVEL_AVX2, PUPIL_LEVEL_AVX512};
    pupil_t pupil;
    pupil_stats metered;
    make_veil(in->image.width, in->image.height, check_random() & 1 ? PUPIL_VEIL_CIE : PUPIL_VEIL_SPENCER);
    work(in, 1u << PUPIL_LEVEL_SCALAR, 512, pixel_out, &whole);
    for (size_t i = 0; i < 4; i++) {
        uint32_t level;
        start(&pupil, 1u << levels[i]);
        pupil_get_level(&pupil, &level);
        if (level != levels[i])
            continue; /* not of this CPU */
        work(in, 1u << levels[i], 1 + (uint32_t)(check_random() % 20), pixel_out, &other);
        CHECK_MSG(memcmp(&whole.light, &other.light, sizeof whole.light) == 0, "level %u of format %u to %u, %ux%u",
                  level, in->image.pixel, pixel_out, in->image.width, in->image.height);
        CHECK(memcmp(whole.nodes, other.nodes, sizeof whole.nodes) == 0);
        CHECK(memcmp(&whole.stats, &other.stats, sizeof whole.stats) == 0);
        CHECK_MSG(frame_equal(&whole.to, &other.to), "level %u of format %u to %u, %ux%u", level, in->image.pixel,
                  pixel_out, in->image.width, in->image.height);
        frame_free(&other.to);
    }
    for (uint32_t i = 0; i < NODE_FLOATS; i++)
        CHECK(whole.nodes[i] >= 0.0f && whole.nodes[i] < INFINITY);
    pupil_stats_clear(&metered);
    CHECK(pupil_meter_rows(&pupil, &in->image, 0, in->image.height, &metered) == PUPIL_OK);
    CHECK(memcmp(&whole.stats, &metered, sizeof metered) == 0);
    frame_free(&whole.to);
}

/* Every format that is no mosaic, any size, ordinary and odd values. */
static void check_formats(void)
{
    static const uint32_t out[] = {PUPIL_PIXEL_RGBA8,   PUPIL_PIXEL_RGB8,    PUPIL_PIXEL_NV12,
                                   PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_I420};
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (int i = 0; i < 4 && !pupil_pixel_is_mosaic(pixel); i++) {
            uint32_t width = 1 + (uint32_t)(check_random() % (i ? 90 : 1100)),
                     height = 1 + (uint32_t)(check_random() % 70);
            frame_fit(pixel, &width, &height);
            frame in = frame_make(width, height, pixel, 0, (int)(check_random() & 1));
            if (i < 2)
                frame_lognormal(&in, 0.1, 3, check_uniform);
            else if (i == 2)
                frame_odd(&in, check_uniform);
            else
                frame_bits(&in, check_uniform);
            check_same(&in, out[check_random() % 6]);
            frame_free(&in);
        }
}

/* If no light is moved, the picture is the one without a veil, from each format to each. */
static void check_nothing(void)
{
    pupil_veil_config config;
    pupil_t pupil;
    pupil_veil_config_default(&config);
    config.psf = PUPIL_VEIL_GAUSSIANS;
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (uint32_t out = 0; out < 3 && !pupil_pixel_is_mosaic(pixel); out++) {
            const uint32_t to = out == 0 ? PUPIL_PIXEL_RGBA8 : out == 1 ? PUPIL_PIXEL_NV12 : PUPIL_PIXEL_RGBA32F;
            uint32_t width = 530, height = 6;
            frame_fit(pixel, &width, &height);
            frame in = frame_make(width, height, pixel, 0, 0);
            frame a = frame_make(width, height, to, 0, 0), b = frame_make(width, height, to, 0, 0);
            const pupil_image to_a = frame_writable(&a), to_b = frame_writable(&b);
            frame_lognormal(&in, 0.1, 3, check_uniform);
            config.width = width;
            config.height = height;
            CHECK(pupil_veil_init(&veil, &config) == PUPIL_OK);
            start(&pupil, 0);
            CHECK(pupil_map_rows(&pupil, &curve, &in.image, &to_a) == PUPIL_OK);
            CHECK(pupil_veil_map_rows(&veil, &pupil, &curve, &in.image, &to_b, &scratch) == PUPIL_OK);
            CHECK_MSG(frame_equal(&a, &b), "format %u to %u", pixel, to);
            frame_free(&in);
            frame_free(&a);
            frame_free(&b);
        }
}

/* The mapped picture is direct * v + veil, bilinear between the nodes. */
static void check_picture(void)
{
    enum { WIDTH = 333, HEIGHT = 77 };
    static outcome o;
    static float veiled[HEIGHT][WIDTH][4];
    pupil_t pupil;
    pupil_veil_result result;
    frame in = frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame_one(&in, 0.01, 500, check_uniform);
    make_veil(WIDTH, HEIGHT, PUPIL_VEIL_SPENCER);
    work(&in, 0, 512, PUPIL_PIXEL_RGBA32F, &o);
    CHECK(pupil_veil_get(&veil, &result) == PUPIL_OK);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            const float *v = (const float *)in.image.data + 4 * ((size_t)y * WIDTH + x);
            const double u = (x + 0.5) * 64 / WIDTH, w = (y + 0.5) * 64 / HEIGHT;
            const uint32_t i = (uint32_t)u, j = (uint32_t)w;
            for (uint32_t c = 0; c < 3; c++) {
                const float *n = o.nodes + 3 * (j * PUPIL_VEIL_NODES + i) + c;
                const float *m = n + (size_t)3 * PUPIL_VEIL_NODES;
                const double upper = (double)n[0] + (u - i) * ((double)n[3] - (double)n[0]);
                const double lower = (double)m[0] + (u - i) * ((double)m[3] - (double)m[0]);
                veiled[y][x][c] = (float)(result.direct * (double)v[c] + upper + (w - j) * (lower - upper));
            }
            veiled[y][x][3] = v[3];
        }
    frame expected = frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
    const pupil_image to = frame_writable(&expected);
    const pupil_image_const from = {.data = veiled,
                                    .stride_bytes = sizeof veiled[0],
                                    .width = WIDTH,
                                    .height = HEIGHT,
                                    .pixel = PUPIL_PIXEL_RGBA32F};
    start(&pupil, 0);
    CHECK(pupil_map_rows(&pupil, &curve, &from, &to) == PUPIL_OK);
    double most = 0;
    for (size_t k = 0; k < (size_t)4 * WIDTH * HEIGHT; k++) {
        const double a = (double)((const float *)expected.image.data)[k];
        const double off = fabs((double)((const float *)o.to.image.data)[k] - a);
        most = off > most ? off : most; /* with fmax, gcc 12 for AArch64 crashes at -O3 */
    }
    printf("the picture is the formula's within %.1e of white\n", most);
    CHECK_MSG(most < 3e-6, "%g", most);
    frame_free(&in);
    frame_free(&expected);
    frame_free(&o.to);
}

/* Light is moved, not made: the gathered light is the frame's sum, also with cells of 65536 pixels, with the brightest
 * light, and with invalid light. */
static void check_hard(void)
{
    static outcome a, b;
    frame in = frame_make(40, 30, PUPIL_PIXEL_RGB32F, 0, 0), other = frame_make(40, 30, PUPIL_PIXEL_RGB32F, 0, 0);
    make_veil(40, 30, PUPIL_VEIL_SPENCER);
    frame_fill(&in, 0, 0, 0);
    work(&in, 0, 512, PUPIL_PIXEL_RGB8, &a);
    for (uint32_t i = 0; i < NODE_FLOATS; i++)
        CHECK(a.nodes[i] == 0.0f);
    frame_free(&a.to);
    frame_set(&in, 20, 15, 0x1p30, 1, 0, 1);
    frame_fill(&other, 0, 0, 0);
    frame_set(&other, 20, 15, INFINITY, 1, NAN, 1);
    frame_set(&other, 3, 4, -5, -INFINITY, NAN, 1);
    work(&in, 0, 512, PUPIL_PIXEL_RGB8, &a);
    work(&other, 0, 512, PUPIL_PIXEL_RGB8, &b);
    CHECK(memcmp(&a.light, &b.light, sizeof a.light) == 0);
    CHECK(a.nodes[3 * (32 * 65 + 32)] > 0.0f && a.nodes[3 * (32 * 65 + 32)] < INFINITY);
    frame_free(&a.to);
    frame_free(&b.to);
    frame_free(&in);
    frame_free(&other);

    in = frame_make(16384, 300, PUPIL_PIXEL_RGB32F, 0, 0);
    make_veil(16384, 300, PUPIL_VEIL_SPENCER);
    frame_fill(&in, 0x1p30, 0x1p30, 1e-5);
    work(&in, 0, 512, PUPIL_PIXEL_RGB8, &a);
    for (uint32_t i = 0; i < NODE_FLOATS; i++)
        CHECK(a.nodes[i] >= 0 && a.nodes[i] <= 0x1p30f);
    CHECK_MSG(fabs((double)a.nodes[3 * (32 * 65 + 32) + 2] / (double)a.nodes[3 * (32 * 65 + 32)] * 0x1p30 / 1e-5 - 1) <
                  1e-4,
              "faint and bright light differ in their veil: %g, %g", (double)a.nodes[3 * (32 * 65 + 32) + 2],
              (double)a.nodes[3 * (32 * 65 + 32)]);
    frame_free(&a.to);
    frame_free(&in);
}

/* As check_nothing, for pictures with other primaries and with rods. */
static void check_pictures(void)
{
    pupil_veil_config config;
    pupil_veil_config_default(&config);
    config.psf = PUPIL_VEIL_GAUSSIANS;
    config.width = 70;
    config.height = 6;
    CHECK(pupil_veil_init(&veil, &config) == PUPIL_OK);
    for (uint32_t n = 0; n < 8; n++) {
        frame in = frame_make(70, 6, PUPIL_PIXEL_RGB32F, 0, 0), plain = frame_make(70, 6, PUPIL_PIXEL_RGBA32F, 0, 0);
        frame a = frame_make(70, 6, PUPIL_PIXEL_RGBA32F, 0, 0), b = frame_make(70, 6, PUPIL_PIXEL_RGBA32F, 0, 0);
        const pupil_image to_plain = frame_writable(&plain), to_a = frame_writable(&a), to_b = frame_writable(&b);
        pupil_config own;
        pupil_t pupil;
        pupil_curve by = curve;
        frame_lognormal(&in, 0.1, 3, check_uniform);
        start(&pupil, 0);
        CHECK(pupil_map_rows(&pupil, &curve, &in.image, &to_plain) == PUPIL_OK);
        pupil_config_default(&own);
        own.output_primaries = n & 1 ? PUPIL_OUTPUT_BT2020 : PUPIL_OUTPUT_AS_INPUT;
        own.law = n & 2 ? PUPIL_LAW_EYE : PUPIL_LAW_SECONDS;
        by.rods = n & 4 ? 0.6f : 0.0f;
        CHECK(pupil_init(&pupil, &own) == PUPIL_OK);
        CHECK(pupil_map_rows(&pupil, &by, &in.image, &to_a) == PUPIL_OK);
        CHECK(pupil_veil_map_rows(&veil, &pupil, &by, &in.image, &to_b, &scratch) == PUPIL_OK);
        CHECK_MSG(frame_equal(&a, &b), "picture %u", n);
        CHECK_MSG(frame_equal(&a, &plain) == (!(n & 1) && (n & 6) != 6), "picture %u", n);
        frame_free(&in);
        frame_free(&plain);
        frame_free(&a);
        frame_free(&b);
    }
}

/* Images that do not fit: refused, and nothing is written. */
static void check_refused(void)
{
    frame in = frame_make(8, 6, PUPIL_PIXEL_RGB8, 0, 0), out = frame_make(8, 6, PUPIL_PIXEL_RGB8, 0, 0);
    frame as_made = frame_make(8, 6, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image good = frame_writable(&out);
    pupil_image to = good;
    pupil_image_const from = in.image;
    pupil_curve no_curve = curve;
    pupil_t pupil;
    start(&pupil, 0);
    make_veil(8, 6, PUPIL_VEIL_SPENCER);
    from.pixel = PUPIL_PIXEL_COUNT;
    CHECK(pupil_veil_map_rows(&veil, &pupil, &curve, &from, &to, &scratch) == PUPIL_ERR_PIXEL);
    to.pixel = PUPIL_PIXEL_COUNT;
    CHECK(pupil_veil_map_rows(&veil, &pupil, &curve, &in.image, &to, &scratch) == PUPIL_ERR_PIXEL_OUT);
    no_curve.scale = -1.0f;
    CHECK(pupil_veil_map_rows(&veil, &pupil, &no_curve, &in.image, &good, &scratch) == PUPIL_ERR_VALUE);
    for (uint32_t n = 0; n < 4; n++) { /* none of them a mosaic, of which half the size is right */
        to = good;
        to.width = n == 1 || n == 3 ? 4 : 8;
        to.height = n == 2 ? 3 : n == 3 ? 3 : n == 0 ? 5 : 6;
        CHECK_MSG(pupil_veil_map_rows(&veil, &pupil, &curve, &in.image, &to, &scratch) == PUPIL_ERR_SIZE, "size %u", n);
    }
    CHECK(frame_equal(&out, &as_made));
    frame_free(&in);
    frame_free(&out);
    frame_free(&as_made);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_formats();
    check_nothing();
    check_picture();
    check_hard();
    check_pictures();
    check_refused();
    return check_end();
}

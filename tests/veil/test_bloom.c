/* Bloom: veil and bloom together against the published formulas, at 600 x 600, 54 degrees, 100 lamps: every pixel
 * within 2 %, rms 0.5 %, energy 1e-3. The same bits at any CPU level and in any groups of rows; the bright pass; hard
 * frames; and what is refused.
 */
#include "check.h"
#include "eye.h"
#include "frames.h"
#include "lamp.h"

#include <math.h>

#include "pupil/bloom.h"

enum { SIDE = 600, LAMPS = 100 };
#define SCALE 0x1p-12f

static const pupil_curve as_it_is = {.scale = SCALE, .inverse_white_squared = 1.0f};
static pupil_veil veil;
static pupil_veil_light light;
static pupil_bloom_scratch scratch;

static void start(pupil_t *pupil, uint32_t levels)
{
    pupil_config config;
    pupil_config_default(&config);
    config.levels = levels;
    CHECK(pupil_init(pupil, &config) == PUPIL_OK);
}

static pupil_bloom *make(const pupil_bloom_config *config)
{
    const size_t bytes = pupil_bloom_bytes(config);
    CHECK(bytes > 0);
    pupil_bloom *bloom = malloc(bytes);
    CHECK(bloom);
    memset(bloom, 0xa5, bytes);
    CHECK(pupil_bloom_init(bloom, bytes, config) == PUPIL_OK);
    return bloom;
}

/* The narrow lobes of an eye. */
static void eye_lobes(pupil_bloom_config *config, const pupil_veil_config *psf)
{
    pupil_veil_result result;
    pupil_bloom_config_default(config);
    config->width = psf->width;
    config->height = psf->height;
    CHECK(pupil_veil_init(&veil, psf) == PUPIL_OK);
    CHECK(pupil_veil_get(&veil, &result) == PUPIL_OK);
    config->lobes = result.lobes;
    memcpy(config->lobe, result.lobe, sizeof config->lobe);
}

/* --- the formulas --- */

static lamp lamps[LAMPS];
static float scene[SIDE][SIDE][4], picture[SIDE][SIDE][4];
static double formula[SIDE][SIDE];

static void place_lamps(void)
{
    memset(scene, 0, sizeof scene);
    for (int i = 0; i < LAMPS; i++) {
        const lamp l = lamps[i] = lamp_anywhere(SIDE);
        for (int c = 0; c < 3; c++)
            scene[l.y][l.x][c] += l.rgb[c];
    }
}

static void draw(const pupil_bloom_config *config)
{
    pupil_t pupil;
    const pupil_image_const in = {
        .data = scene, .stride_bytes = sizeof scene[0], .width = SIDE, .height = SIDE, .pixel = PUPIL_PIXEL_RGBA32F};
    const pupil_image out = {.data = picture,
                             .stride_bytes = sizeof picture[0],
                             .width = SIDE,
                             .height = SIDE,
                             .pixel = PUPIL_PIXEL_RGBA32F};
    pupil_bloom *bloom = make(config);
    start(&pupil, 0);
    CHECK(pupil_veil_light_clear(&light) == PUPIL_OK);
    CHECK(pupil_veil_gather_rows(&veil, &pupil, &in, 0, NULL, &light) == PUPIL_OK);
    CHECK(pupil_veil_begin(&veil) == PUPIL_OK);
    CHECK(pupil_veil_add_light(&veil, &light) == PUPIL_OK);
    CHECK(pupil_veil_solve(&veil) == PUPIL_OK);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in, 0, SIDE, &scratch) == PUPIL_OK);
    CHECK(pupil_bloom_solve(bloom, &pupil) == PUPIL_OK);
    CHECK(pupil_bloom_map_rows(bloom, &veil, &pupil, &as_it_is, &in, &out, &scratch) == PUPIL_OK);
    free(bloom);
}

static void check_eye(const char *name, uint32_t psf, double age)
{
    pupil_veil_config config;
    pupil_veil_result result;
    pupil_bloom_config lobes;
    pupil_veil_config_default(&config);
    config.psf = psf;
    config.width = config.height = SIDE;
    config.age_years = age;
    const eye e = eye_of(psf, age, config.pigment);
    place_lamps();
    eye_lobes(&lobes, &config);
    CHECK(pupil_veil_get(&veil, &result) == PUPIL_OK);
    draw(&lobes);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            formula[y][x] = eye_pixel(&e, result.degrees_per_px, x, y);
    double most = 0, squares = 0, ours_in_all = 0, exact_in_all = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            for (int c = 0; c < 3; c++) {
                const double ours = (double)picture[y][x][c] / (double)SCALE;
                double exact = 0;
                for (int i = 0; i < LAMPS; i++)
                    exact += formula[abs(y - lamps[i].y)][abs(x - lamps[i].x)] * (double)lamps[i].rgb[c];
                const double error = fabs(ours / exact - 1);
                most = error > most ? error : most;
                squares += error * error;
                ours_in_all += ours;
                exact_in_all += exact;
            }
    const double rms = sqrt(squares / (3.0 * SIDE * SIDE)), energy = ours_in_all / exact_in_all - 1;
    printf("%-14s veil and bloom: worst pixel %.2f %%, rms %.3f %%, energy %+.2e\n", name, 100 * most, 100 * rms,
           energy);
    CHECK_MSG(most <= 0.02, "%s: worst pixel %g", name, most);
    CHECK_MSG(rms <= 0.005, "%s: rms %g", name, rms);
    CHECK_MSG(fabs(energy) <= 1e-3, "%s: energy %g", name, energy);
}

/* --- bits --- */

static uint32_t random_below(uint32_t n)
{
    return (uint32_t)(check_random() % n);
}

/* In groups of up to `group` rows, gathered from the last to the first. */
static void work(pupil_bloom *bloom, const frame *in, uint32_t levels, uint32_t group, frame *to)
{
    static const pupil_curve curve = {.scale = 2.0f, .inverse_white_squared = 0.0625f, .gamut = 3.7f, .dither = 1};
    const uint32_t height = in->image.height;
    const pupil_image out = frame_writable(to);
    pupil_t pupil;
    start(&pupil, levels);
    for (uint32_t y = (height - 1) / group * group + group; y > 0;) {
        y -= group;
        const uint32_t count = height - y < group ? height - y : group;
        CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in->image, y, count, &scratch) == PUPIL_OK);
    }
    CHECK(pupil_bloom_solve(bloom, &pupil) == PUPIL_OK);
    for (uint32_t y = 0; y < height; y += group) {
        pupil_curve by = curve;
        by.first_row = y;
        const pupil_image part = pupil_image_out_rows(out, y, height - y < group ? height - y : group);
        CHECK(pupil_bloom_map_rows(bloom, NULL, &pupil, &by, &in->image, &part, &scratch) == PUPIL_OK);
    }
    CHECK(frame_guards_intact(to));
}

static void check_same(const frame *in, uint32_t pixel_out)
{
    pupil_bloom_config config;
    pupil_bloom_config_default(&config);
    config.width = in->image.width;
    config.height = in->image.height;
    config.threshold = random_below(2) ? 0.5 : 0.0;
    config.lobes = 1 + random_below(8);
    for (uint32_t i = 0; i < config.lobes; i++)
        config.lobe[i] = (pupil_veil_gaussian){0.1 * exp2(9 * check_uniform()), 0.9 / config.lobes};
    pupil_bloom *bloom = make(&config);
    frame whole = frame_make(config.width, config.height, pixel_out, 0, 0);
    work(bloom, in, 1u << PUPIL_LEVEL_SCALAR, 2 * config.height, &whole);
    for (uint32_t level = PUPIL_LEVEL_SCALAR; level < PUPIL_LEVEL_COUNT; level++) {
        pupil_t pupil;
        uint32_t chosen;
        start(&pupil, 1u << level);
        pupil_get_level(&pupil, &chosen);
        if (chosen != level)
            continue; /* not of this CPU */
        frame other = frame_make(config.width, config.height, pixel_out, 0, 0);
        work(bloom, in, 1u << level, 2 + 2 * random_below(12), &other);
        CHECK_MSG(frame_equal(&whole, &other), "level %u of format %u to %u, %ux%u, %u lobes", level, in->image.pixel,
                  pixel_out, config.width, config.height, config.lobes);
        frame_free(&other);
    }
    frame_free(&whole);
    free(bloom);
}

static void check_formats(void)
{
    static const uint32_t out[] = {PUPIL_PIXEL_RGBA8,   PUPIL_PIXEL_RGB8,    PUPIL_PIXEL_NV12,
                                   PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_I420};
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (int i = 0; i < 3 && !pupil_pixel_is_mosaic(pixel); i++) {
            uint32_t width = 1 + random_below(i ? 60 : 600), height = 1 + random_below(50);
            frame_fit(pixel, &width, &height);
            frame in = frame_make(width, height, pixel, 0, (int)random_below(2));
            if (i == 0)
                frame_lognormal(&in, 0.1, 3, check_uniform);
            else if (i == 1)
                frame_odd(&in, check_uniform);
            else
                frame_bits(&in, check_uniform);
            check_same(&in, out[random_below(6)]);
            frame_free(&in);
        }
}

/* Ordinary pixels, and a few that must be loaded again, because their light differs from their values. */
static void check_few_odd(void)
{
    static const double odd[][4] = {{-0.0, 1, 1, 1},   {1, -2, 1, 1},  {1, 1, NAN, 1},
                                    {0x1p40, 1, 1, 1}, {1, 1, 1, 0.5}, {1, 1, 1, NAN}};
    for (int i = 0; i < 24; i++) {
        frame in = frame_make(200 + random_below(300), 20 + random_below(40), PUPIL_PIXEL_RGBA32F, 0, 0);
        for (uint32_t at = 0; at < in.image.width * in.image.height; at++)
            frame_set(&in, at % in.image.width, at / in.image.width, check_uniform(), check_uniform(),
                      4 * check_uniform(), 1);
        for (int k = 0; k < 3; k++) {
            const double *v = odd[random_below(6)];
            const uint32_t x = k ? random_below(in.image.width) : in.image.width - 1 - random_below(8);
            frame_set(&in, x, random_below(in.image.height), v[0], v[1], v[2], v[3]);
        }
        check_same(&in, i % 2 ? PUPIL_PIXEL_RGBA8 : PUPIL_PIXEL_RGBA32F);
        frame_free(&in);
    }
}

/* One lamp: most rows have no light to scatter. */
static void check_dark(void)
{
    frame in = frame_make(450, 60, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame_fill(&in, 0.25, 0.25, 0.25);
    frame_set(&in, random_below(450), random_below(60), 1000, 500, 250, 1);
    for (int i = 0; i < 6; i++)
        check_same(&in, PUPIL_PIXEL_RGBA32F);
    frame_free(&in);
}

/* --- properties --- */

/* The picture of one frame with one lobe, in light. */
static void draw_small(const frame *in, double sigma, double weight, double threshold, frame *to)
{
    const pupil_image out = frame_writable(to);
    pupil_bloom_config config;
    pupil_t pupil;
    pupil_bloom_config_default(&config);
    config.width = in->image.width;
    config.height = in->image.height;
    config.threshold = threshold;
    config.lobes = 1;
    config.lobe[0] = (pupil_veil_gaussian){sigma, weight};
    pupil_bloom *bloom = make(&config);
    start(&pupil, 0);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in->image, 0, config.height, &scratch) == PUPIL_OK);
    CHECK(pupil_bloom_solve(bloom, &pupil) == PUPIL_OK);
    CHECK(pupil_bloom_map_rows(bloom, NULL, &pupil, &as_it_is, &in->image, &out, &scratch) == PUPIL_OK);
    free(bloom);
}

/* One lamp anywhere, with one lobe of any width: the Gaussian, and light that is moved and not made. Compared with the
 * same picture without the lamp; it has light, so that what the lamp takes from a pixel shows, too. */
static void check_lobes(void)
{
    enum { AREA = 220 };
    static const double sigma[] = {0.1, 0.3, 0.42, 0.5,  0.79, 0.81, 1, 1.3, 1.34, 1.5, 1.7, 1.9, 2,   2.1,
                                   2.2, 2.4, 2.52, 2.54, 2.6,  3,    4, 4.8, 4.9,  5.3, 5.5, 7,   9.7, 15};
    static const float dark = 1.0f;
    frame in = frame_make(AREA, AREA, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame without = frame_make(AREA, AREA, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame with = frame_make(AREA, AREA, PUPIL_PIXEL_RGBA32F, 0, 0);
    for (size_t i = 0; i < sizeof sigma / sizeof sigma[0]; i++) {
        const int x = 100 + (int)random_below(20), y = 100 + (int)random_below(20);
        const float *row = with.image.data, *before = without.image.data;
        double most = 0, least = 0, all = 0;
        frame_fill(&in, (double)dark, (double)dark, (double)dark);
        draw_small(&in, sigma[i], 0.5, 0, &without);
        frame_set(&in, (uint32_t)x, (uint32_t)y, 1000 + (double)dark, 500, 250, 1);
        draw_small(&in, sigma[i], 0.5, 0, &with);
        for (int v = 0; v < AREA; v++)
            for (int u = 0; u < AREA; u++) {
                const int at = 4 * (v * AREA + u);
                const double ours = ((double)row[at] - (double)before[at]) / (double)SCALE / 1000;
                const double share = 0.5 * eye_gaussian(sigma[i], u - x, v - y) + (u == x && v == y ? 0.5 : 0);
                const double error = fabs(ours - share);
                most = error > most ? error : most;
                least = ours < least ? ours : least;
                all += ours;
            }
        const double peak = 0.5 * eye_gaussian(sigma[i], 0, 0);
        CHECK_MSG(most <= 0.02 * peak, "sigma %g: off by %g of its peak", sigma[i], most / peak);
        CHECK_MSG(least >= -0.002 * peak, "sigma %g: takes %g of its peak", sigma[i], -least / peak);
        CHECK_MSG(fabs(all - 1) < 2e-4, "sigma %g: %g of the light", sigma[i], all);
    }
    frame_free(&in);
    frame_free(&without);
    frame_free(&with);
}

/* An even frame stays even except at its edges; light below the threshold is unchanged; black is black. */
static void check_even(void)
{
    frame in = frame_make(301, 203, PUPIL_PIXEL_RGBA32F, 0, 0), to = frame_make(301, 203, PUPIL_PIXEL_RGBA32F, 0, 0);
    const float *middle = (const float *)to.image.data + 4 * (100 * 301 + 150);
    frame_fill(&in, 8, 4, 2);
    draw_small(&in, 6, 0.7, 0, &to);
    CHECK_MSG(fabs((double)middle[1] / (double)SCALE / 4 - 1) < 1e-5, "%g", (double)middle[1] / (double)SCALE);
    draw_small(&in, 6, 0.7, 8, &to);
    for (int i = 0; i < 301 * 203; i++)
        CHECK(((const float *)to.image.data)[4 * i] == 8 * SCALE);
    frame_fill(&in, 0, 0, 0);
    draw_small(&in, 6, 0.7, 0, &to);
    for (int i = 0; i < 301 * 203; i++)
        CHECK(((const float *)to.image.data)[4 * i] == 0.0f);
    frame_set(&in, 150, 100, INFINITY, NAN, -5, 1);
    draw_small(&in, 6, 0.7, 0, &to);
    for (int i = 0; i < 301 * 203 * 4; i++) {
        const float v = ((const float *)to.image.data)[i];
        CHECK(v >= 0.0f && v <= 1.0f);
    }
    frame_free(&in);
    frame_free(&to);
}

/* --- few lamps: what is skipped --- */

enum { FEW_WIDTH = 530, FEW_HEIGHT = 310, FEW_LAMPS = 5 };

/* The lobes from number `first` on: the narrow ones reach few pixels, the last one no octave. */
enum { FEW_NARROW = 3, FEW_NARROWEST = 5 };
static pupil_bloom_config few_config(double threshold, uint32_t first)
{
    static const pupil_veil_gaussian lobe[] = {{21, 0.1}, {9, 0.1}, {4, 0.1}, {2.5, 0.1}, {1.2, 0.1}, {0.4, 0.2}};
    pupil_bloom_config config;
    pupil_bloom_config_default(&config);
    config.width = FEW_WIDTH;
    config.height = FEW_HEIGHT;
    config.threshold = threshold;
    for (uint32_t i = first; i < sizeof lobe / sizeof lobe[0]; i++)
        config.lobe[config.lobes++] = lobe[i];
    return config;
}

static void draw_few(pupil_bloom *bloom, const pupil_veil *with, const frame *in, frame *to)
{
    const pupil_image out = frame_writable(to);
    pupil_t pupil;
    start(&pupil, 0);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in->image, 0, FEW_HEIGHT, &scratch) == PUPIL_OK);
    CHECK(pupil_bloom_solve(bloom, &pupil) == PUPIL_OK);
    CHECK(pupil_bloom_map_rows(bloom, with, &pupil, &as_it_is, &in->image, &out, &scratch) == PUPIL_OK);
}

/* A veil without light, so that no row is mapped as without bloom. */
static const pupil_veil *few_veil(void)
{
    pupil_veil_config config;
    pupil_veil_config_default(&config);
    config.width = FEW_WIDTH;
    config.height = FEW_HEIGHT;
    CHECK(pupil_veil_init(&veil, &config) == PUPIL_OK);
    return &veil;
}

/* Data that a frame leaves in the object does not show in the next picture: lamps elsewhere, none, and lamps again. */
static void check_next_frame(uint32_t pixel, double threshold, uint32_t first_lobe, const pupil_veil *with)
{
    const pupil_bloom_config config = few_config(threshold, first_lobe);
    pupil_bloom *kept = make(&config);
    for (int i = 0; i < 6; i++) {
        frame in = frame_make(FEW_WIDTH, FEW_HEIGHT, pixel, 0, 0);
        frame a = frame_make(FEW_WIDTH, FEW_HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
        frame b = frame_make(FEW_WIDTH, FEW_HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
        frame_fill(&in, 0.25, 0.125, 0.5);
        for (int k = 0; k < (i == 2 ? 0 : FEW_LAMPS); k++)
            frame_set(&in, random_below(FEW_WIDTH), random_below(FEW_HEIGHT), 1000, 500, 250, 1);
        draw_few(kept, with, &in, &a);
        pupil_bloom *fresh = make(&config);
        draw_few(fresh, with, &in, &b);
        CHECK_MSG(frame_equal(&a, &b), "frame %d of format %u, above %g%s", i, pixel, threshold,
                  with ? ", with a veil" : "");
        free(fresh);
        frame_free(&in);
        frame_free(&a);
        frame_free(&b);
    }
    free(kept);
}

/* A bright pass, which skips dark rows, scatters the same as its light in a frame where nothing is skipped. */
static void check_skipped(uint32_t first_lobe)
{
    const pupil_bloom_config with = few_config(0.5, first_lobe), without = few_config(0.0, first_lobe);
    pupil_bloom *bright = make(&with), *all = make(&without);
    frame in = frame_make(FEW_WIDTH, FEW_HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame above = frame_make(FEW_WIDTH, FEW_HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame a = frame_make(FEW_WIDTH, FEW_HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame b = frame_make(FEW_WIDTH, FEW_HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame_fill(&in, 0, 0, 0);
    frame_fill(&above, 0, 0, 0);
    for (int k = 0; k < FEW_LAMPS; k++) { /* in corners, at edges, anywhere */
        const uint32_t x = k == 0 ? 0 : k == 1 ? FEW_WIDTH - 1 : random_below(FEW_WIDTH);
        const uint32_t y = k == 1 ? FEW_HEIGHT - 1 : k == 2 ? 0 : random_below(FEW_HEIGHT);
        const double share = (1000 - 0.5) / 1000;
        frame_set(&in, x, y, 1000, 500, 250, 1);
        frame_set(&above, x, y, 1000 * share, 500 * share, 250 * share, 1);
    }
    draw_few(bright, NULL, &in, &a);
    draw_few(all, NULL, &above, &b);
    const float *from = in.image.data, *lit = above.image.data, *ours = a.image.data, *theirs = b.image.data;
    double most = 0;
    for (size_t i = 0; i < (size_t)FEW_WIDTH * FEW_HEIGHT * 4; i++) {
        const double error = (double)(ours[i] - theirs[i]) / (double)SCALE - (double)(from[i] - lit[i]);
        most = i % 4 != 3 && fabs(error) > most ? fabs(error) : most;
    }
    CHECK_MSG(most < 1e-3, "off by %g of 1000", most);
    free(bright);
    free(all);
    frame_free(&in);
    frame_free(&above);
    frame_free(&a);
    frame_free(&b);
}

/* --- refusals --- */

static void check_config(pupil_bloom_config c, const char *expected)
{
    const char *why = "";
    CHECK(pupil_bloom_config_check(&c, &why) == PUPIL_ERR_CONFIG);
    CHECK_MSG(strstr(why, expected), "\"%s\", not \"%s\"", why, expected);
    CHECK(pupil_bloom_bytes(&c) == 0);
}

static void check_refusals(void)
{
    pupil_bloom_config good, c;
    pupil_t pupil;
    const char *why = NULL;
    pupil_bloom_config_default(&good);
    good.width = 16;
    good.height = 8;
    good.lobes = 1;
    good.lobe[0] = (pupil_veil_gaussian){3, 0.5};
    CHECK(pupil_bloom_config_check(&good, &why) == PUPIL_OK && !why);
    c = good, c.width = 0, check_config(c, "width");
    c = good, c.height = 16385, check_config(c, "height");
    c = good, c.lobes = 33, check_config(c, "lobes");
    c = good, c.threshold = NAN, check_config(c, "threshold");
    c = good, c.threshold = -1, check_config(c, "threshold");
    c = good, c.lobe[0].sigma = 0, check_config(c, "sigma");
    c = good, c.lobe[0].weight = 1.5, check_config(c, "weight");
    c = good, c.lobes = 2, c.lobe[1] = (pupil_veil_gaussian){1, 0.6}, check_config(c, "together");
    start(&pupil, 0);
    pupil_bloom *bloom = make(&good);
    CHECK(pupil_bloom_init(bloom, pupil_bloom_bytes(&good) - 1, &good) == PUPIL_ERR_VALUE);
    CHECK(pupil_bloom_init(NULL, 1 << 20, &good) == PUPIL_ERR_NULL);
    CHECK(pupil_bloom_init((pupil_bloom *)(void *)((char *)bloom + 4), 1 << 30, &good) == PUPIL_ERR_ALIGNMENT);
    frame in = frame_make(16, 8, PUPIL_PIXEL_RGB32F, 0, 0), wide = frame_make(18, 8, PUPIL_PIXEL_RGB32F, 0, 0);
    frame raw = frame_make(16, 8, PUPIL_PIXEL_BAYER8, 0, 0), to = frame_make(16, 8, PUPIL_PIXEL_RGBA8, 0, 0);
    const pupil_image out = frame_writable(&to);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &wide.image, 0, 8, &scratch) == PUPIL_ERR_SIZE);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &raw.image, 0, 8, &scratch) == PUPIL_ERR_PIXEL);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in.image, 1, 2, &scratch) == PUPIL_ERR_ROWS);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in.image, 0, 3, &scratch) == PUPIL_ERR_ROWS);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in.image, 4, 6, &scratch) == PUPIL_ERR_ROWS);
    CHECK(pupil_bloom_gather_rows(bloom, &pupil, &in.image, 0, 8, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_bloom_gather_rows(NULL, &pupil, &in.image, 0, 8, &scratch) == PUPIL_ERR_NULL);
    CHECK(pupil_bloom_map_rows(bloom, NULL, &pupil, &as_it_is, &wide.image, &out, &scratch) == PUPIL_ERR_SIZE);
    CHECK(pupil_bloom_map_rows(bloom, &veil, &pupil, &as_it_is, &in.image, &out, &scratch) == PUPIL_ERR_SIZE);
    pupil_curve below = as_it_is;
    below.first_row = 2;
    CHECK(pupil_bloom_map_rows(bloom, NULL, &pupil, &below, &in.image, &out, &scratch) == PUPIL_ERR_ROWS);
    memset(bloom, 0, 8);
    CHECK(pupil_bloom_solve(bloom, &pupil) == PUPIL_ERR_OBJECT);
    free(bloom);
    frame_free(&in);
    frame_free(&wide);
    frame_free(&raw);
    frame_free(&to);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_eye("Spencer 1995", PUPIL_VEIL_SPENCER, 25);
    check_eye("CIE, age 25", PUPIL_VEIL_CIE, 25);
    check_eye("CIE, age 70", PUPIL_VEIL_CIE, 70);
    check_lobes();
    check_even();
    check_formats();
    check_few_odd();
    check_dark();
    for (int above = 0; above < 2; above++) {
        check_next_frame(PUPIL_PIXEL_RGBA32F, 0.5 * above, 0, NULL);
        check_next_frame(PUPIL_PIXEL_RGB16F, 0.5 * above, FEW_NARROW, NULL);
        check_next_frame(PUPIL_PIXEL_RGBA32F, 0.5 * above, FEW_NARROWEST, NULL);
        check_next_frame(PUPIL_PIXEL_RGBA32F, 0.5 * above, 0, few_veil());
    }
    check_skipped(0);
    check_skipped(FEW_NARROW);
    check_skipped(FEW_NARROWEST);
    check_refusals();
    return check_end();
}

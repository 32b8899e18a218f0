/* Every field of the config, one violation at a time: it is refused, the sentence names the field, and nothing is
 * touched. The defaults, both ends of every range, and the metering patterns.
 */
#include "check.h"
#include "pupil/pupil.h"

#include <math.h>
#include <stddef.h>

#define FIELD(name) #name, offsetof(pupil_config, name), sizeof(((pupil_config *)0)->name)

/* A field, its range, and values outside of it. Integers are given as doubles too. */
static const struct range {
    const char *name;
    size_t offset, bytes;
    char kind; /* u: uint32_t, f: float, d: double */
    double low, high;
    double bad[4];
} range[] = {
    {FIELD(size_bytes), 'u', sizeof(pupil_config), sizeof(pupil_config), {0, 1, sizeof(pupil_config) - 4, 1e9}},
    {FIELD(primaries), 'u', 0, 1, {3, 4, 1000, 4294967295.0}},
    {FIELD(floor), 'f', 0x1p-30, 1, {0, -1, 0x1.fffffep-31, 1.0000002}},
    {FIELD(clip), 'f', 0, 1e30, {-1, -1e-30, -INFINITY, NAN}},
    {FIELD(trim_low), 'f', 0, 0.99, {-1e-6, 1.001, 1, INFINITY}},
    {FIELD(trim_high), 'f', 0.01, 1, {-1, 0, 1.0000002, INFINITY}},
    {FIELD(histogram), 'u', 0, 1, {2, 3, 255, 4294967295.0}},
    {FIELD(flicker), 'u', 0, 1, {2, 3, 255, 4294967295.0}},
    {FIELD(law), 'u', 0, PUPIL_LAW_COUNT - 1, {PUPIL_LAW_COUNT, 6, 1e6, 4294967295.0}},
    {FIELD(lock), 'u', 0, 1, {2, 3, 255, 4294967295.0}},
    {FIELD(frame_weight), 'd', 1e-300, 1, {0, -0.1, 1.0000000000000002, INFINITY}},
    {FIELD(tau_light_s), 'd', 0, 1e6, {-1e-300, -1, 1000001, INFINITY}},
    {FIELD(tau_dark_s), 'd', 0, 1e6, {-1e-300, -1, 1000001, INFINITY}},
    {FIELD(nominal_frame_s), 'd', 1e-300, 1e6, {0, -1, -INFINITY, INFINITY}},
    {FIELD(ev_min), 'd', -64, 32, {-64.000001, 33, 65, -INFINITY}},
    {FIELD(ev_max), 'd', -32, 64, {64.000001, -33, -65, INFINITY}},
    {FIELD(calibration), 'd', 1e-10, 1e10, {0, -1, -INFINITY, INFINITY}},
    {FIELD(key), 'd', 0x1p-10, 1, {0, 0x1.ffp-11, 1.0001, INFINITY}},
    {FIELD(ev_compensation), 'd', -16, 16, {-16.001, 16.001, -INFINITY, INFINITY}},
    {FIELD(order), 'u', 0, 1, {2, 3, 255, 4294967295.0}},
    {FIELD(white_mode), 'u', 0, 2, {3, 4, 255, 4294967295.0}},
    {FIELD(white), 'd', 0x1p-8, 0x1p30, {0, -1, 0x1.fffp-9, 0x1.0001p30}},
    {FIELD(highlight_share), 'd', 0.001, 0.5, {0.0009, 0.5001, 0, -INFINITY}},
    {FIELD(highlight_room_ev), 'd', 0, 32, {-0.001, 32.001, INFINITY, -INFINITY}},
    {FIELD(highlight_ev), 'd', 0, 8, {-0.001, 8.001, INFINITY, -INFINITY}},
    {FIELD(amplification_ev), 'd', 0, 32, {-0.001, 32.001, INFINITY, -INFINITY}},
    {FIELD(white_quantile), 'd', 0.5, 1, {0.4999, 1.0001, 0, -INFINITY}},
    {FIELD(transfer), 'u', 0, 2, {3, 4, 255, 4294967295.0}},
    {FIELD(output_primaries), 'u', 0, 2, {3, 4, 255, 4294967295.0}},
    {FIELD(dither), 'u', 0, 1, {2, 3, 255, 4294967295.0}},
    {FIELD(levels), 'u', 0, 31, {32, 64, 255, 4294967295.0}},
    {FIELD(curve), 'u', 0, PUPIL_CURVE_COUNT - 1, {PUPIL_CURVE_COUNT, 6, 255, 4294967295.0}},
    {FIELD(curve_levels), 'u', 2, 256, {0, 1, 257, 4294967295.0}},
    {FIELD(curve_share), 'd', 0, 0.25, {-1e-9, 0.2501, -INFINITY, INFINITY}},
    {FIELD(curve_ceiling), 'd', 1, 4, {0.999, 4.001, -INFINITY, INFINITY}},
    {FIELD(curve_range_ev), 'd', 2, 16, {1.999, 16.001, -INFINITY, INFINITY}},
    {FIELD(meter_rows), 'u', 0, 8, {3, 5, 16, 4294967295.0}},
    {FIELD(histogram_step), 'u', 0, 8, {3, 5, 16, 4294967295.0}},
    {FIELD(accuracy), 'u', 0, PUPIL_ACCURACY_COUNT - 1, {PUPIL_ACCURACY_COUNT, 3, 255, 4294967295.0}},
};
#define RANGES (sizeof range / sizeof *range)

static void store(pupil_config *config, const struct range *r, double value)
{
    unsigned char *at = (unsigned char *)config + r->offset;
    const uint32_t u = r->kind == 'u' ? (uint32_t)value : 0;
    const float f = (float)value;
    memcpy(at, r->kind == 'u' ? (const void *)&u : r->kind == 'f' ? (const void *)&f : (const void *)&value, r->bytes);
}

static void refused(const pupil_config *config, const char *name, const char *other)
{
    const char *why = NULL;
    pupil_t pupil, before;
    memset(&pupil, 0x3c, sizeof pupil);
    before = pupil;
    CHECK_MSG(pupil_config_check(config, &why) == PUPIL_ERR_CONFIG, "%s", name);
    CHECK_MSG(why && (strstr(why, name) || (other && strstr(why, other))), "%s: \"%s\"", name, why ? why : "(null)");
    CHECK(pupil_config_check(config, NULL) == PUPIL_ERR_CONFIG);
    CHECK(pupil_init(&pupil, config) == PUPIL_ERR_CONFIG && memcmp(&pupil, &before, sizeof pupil) == 0);
    pupil_config good;
    pupil_config_default(&good);
    CHECK(pupil_init(&pupil, &good) == PUPIL_OK);
    before = pupil;
    CHECK(pupil_retune(&pupil, config) == PUPIL_ERR_CONFIG && memcmp(&pupil, &before, sizeof pupil) == 0);
}

static void check_ranges(void)
{
    for (unsigned i = 0; i < RANGES; i++) {
        const struct range *r = &range[i];
        pupil_config config;
        const char *why = NULL;
        for (int end = 0; end < 2; end++) {
            pupil_config_default(&config);
            store(&config, r, end ? r->high : r->low);
            CHECK_MSG(pupil_config_check(&config, &why) == PUPIL_OK, "%s at %g: %s", r->name, end ? r->high : r->low,
                      why);
        }
        for (int b = 0; b < 5; b++) {
            pupil_config_default(&config);
            if (!strcmp(r->name, "white"))
                config.white_mode = PUPIL_WHITE_FIXED;
            if (b < 4)
                store(&config, r, r->bad[b]);
            else if (r->kind != 'u')
                store(&config, r, NAN);
            else
                continue;
            /* either end of a range may be named for the other */
            refused(&config, r->name,
                    !strncmp(r->name, "trim", 4)   ? "trim_"
                    : !strncmp(r->name, "ev_m", 4) ? "ev_m"
                                                   : NULL);
        }
    }
}

static void check_the_rest(void)
{
    static const float row[][3] = {{0, 0, 0},    {NAN, 1, 1}, {INFINITY, 1, 1},
                                   {-1, -1, -1}, {1, -1, 0},  {1, 1, -INFINITY}};
    pupil_config config;
    const char *why = NULL;
    pupil_config_default(&config);
    memset(config.weight, 0, sizeof config.weight);
    refused(&config, "weight", NULL);
    config.weight[15][15] = 1;
    CHECK(pupil_config_check(&config, &why) == PUPIL_OK);
    for (unsigned i = 0; i < 6; i++) {
        pupil_config_default(&config);
        memcpy(config.rgb_to_xyz + 3, row[i], sizeof row[i]);
        CHECK(pupil_config_check(&config, &why) == PUPIL_OK); /* not read */
        config.primaries = PUPIL_PRIMARIES_MATRIX;
        refused(&config, "rgb_to_xyz", NULL);
    }
    pupil_config_default(&config); /* a luminance row alone cannot be converted to other primaries */
    memcpy(config.rgb_to_xyz + 3, (const float[3]){0.2f, 0.7f, 0.1f}, 3 * sizeof(float));
    config.primaries = PUPIL_PRIMARIES_MATRIX;
    CHECK(pupil_config_check(&config, &why) == PUPIL_OK);
    config.output_primaries = PUPIL_OUTPUT_BT709;
    refused(&config, "rgb_to_xyz", NULL);
    config.rgb_to_xyz[0] = config.rgb_to_xyz[8] = 100.0f; /* large numbers of a singular matrix */
    config.rgb_to_xyz[6] = config.rgb_to_xyz[7] = 0.0f;
    memcpy(config.rgb_to_xyz, (const float[3]){200.0f, 700.0f, 100.0f}, 3 * sizeof(float));
    memcpy(config.rgb_to_xyz + 3, config.rgb_to_xyz, 3 * sizeof(float));
    refused(&config, "rgb_to_xyz", NULL);
    config.rgb_to_xyz[0] = 400.0f;
    CHECK(pupil_config_check(&config, &why) == PUPIL_OK);
    const float green_first[9] = {700, 400, 100, 700, 200, 100, 0, 0, 100}; /* the determinant is negative */
    memcpy(config.rgb_to_xyz, green_first, sizeof green_first);
    CHECK(pupil_config_check(&config, &why) == PUPIL_OK);
    for (int i = 0; i < 3; i++) { /* outside the luminance row: only read for conversion to other primaries */
        config.rgb_to_xyz[6] = i == 0 ? NAN : i == 1 ? 2e6f : -2e6f;
        config.output_primaries = PUPIL_OUTPUT_BT709;
        refused(&config, "rgb_to_xyz", NULL);
        config.output_primaries = PUPIL_OUTPUT_AS_INPUT;
        CHECK(pupil_config_check(&config, &why) == PUPIL_OK);
    }
    pupil_config_default(&config);
    config.trim_low = 0.6f;
    config.trim_high = 0.4f;
    refused(&config, "trim_", NULL);
    pupil_config_default(&config);
    config.ev_min = 3;
    config.ev_max = 2;
    refused(&config, "ev_m", NULL);
    config.ev_min = config.ev_max;
    CHECK(pupil_config_check(&config, &why) == PUPIL_OK);
    pupil_config_default(&config);
    config.key_points = PUPIL_KEY_POINTS + 1;
    refused(&config, "key_points", NULL);
    config.key_points = 2; /* without a key */
    refused(&config, "key_at", NULL);
    config.key_at[0] = (pupil_key_point){0, 0.1};
    config.key_at[1] = (pupil_key_point){1, 0.2}; /* one stop per stop of light */
    refused(&config, "key_at", NULL);
    config.key_at[1].scene_ev = 2;
    CHECK(pupil_config_check(&config, &why) == PUPIL_OK);
    CHECK(pupil_config_check(NULL, &why) == PUPIL_ERR_NULL);
    pupil_config_default(NULL); /* does nothing, without an error */
}

static void check_defaults(void)
{
    pupil_config c;
    memset(&c, 0xff, sizeof c);
    pupil_config_default(&c);
    CHECK(c.size_bytes == sizeof c && c.primaries == PUPIL_PRIMARIES_BT709 && c.floor == 0x1p-14f && c.clip == 0);
    CHECK(c.trim_low == 0 && c.trim_high == 1 && c.histogram == 0 && c.law == PUPIL_LAW_SECONDS && c.lock == 0 &&
          c.flicker == 1);
    CHECK(c.frame_weight == 0.05 && c.tau_light_s == 0.3 && c.tau_dark_s == 0.9 && c.nominal_frame_s == 1.0 / 30);
    CHECK(c.ev_min == -32 && c.ev_max == 32 && c.calibration == 1 && c.key == 0.18 && c.key_points == 0 &&
          c.ev_compensation == 0);
    CHECK(c.highlight_share == 0.05 && c.highlight_room_ev == 4 && c.highlight_ev == 2 && c.amplification_ev == 4);
    CHECK(c.order == PUPIL_ORDER_EXACT && c.white_mode == PUPIL_WHITE_FOLLOW && c.white == 1 &&
          c.white_quantile == 0.995);
    CHECK(c.transfer == PUPIL_TRANSFER_SRGB && c.levels == 0 && c.output_primaries == PUPIL_OUTPUT_AS_INPUT);
    for (int i = 0; i < 256; i++)
        CHECK(c.weight[i / 16][i % 16] == 1);
}

static void check_patterns(void)
{
    pupil_config c, before;
    pupil_config_default(&c);
    CHECK(pupil_metering_centre(&c) == PUPIL_OK && pupil_config_check(&c, NULL) == PUPIL_OK);
    CHECK(c.weight[7][7] == 255 && c.weight[8][8] == 255 && c.weight[0][0] == 16 && c.weight[15][15] == 16);
    for (int i = 0; i < 256; i++) {
        const int y = i / 16, x = i % 16;
        CHECK(c.weight[y][x] == c.weight[15 - y][x] && c.weight[y][x] == c.weight[x][y]);
        CHECK(x >= 8 || x == 0 || c.weight[y][x] >= c.weight[y][x - 1]);
    }
    double covered = 0;
    CHECK(pupil_metering_spot(&c) == PUPIL_OK && pupil_config_check(&c, NULL) == PUPIL_OK);
    for (int i = 0; i < 256; i++) {
        covered += c.weight[i / 16][i % 16] / 255.0 / 256;
        CHECK(c.weight[i / 16][i % 16] == c.weight[i % 16][15 - i / 16]);
    }
    printf("spot: %.2f %% of the area\n", 100 * covered);
    CHECK(fabs(covered - 0.05) < 0.002 && c.weight[7][7] == 255 && c.weight[0][0] == 0);
    CHECK(pupil_metering_roi(&c, 0.25, 0.5, 0.5, 0.125) == PUPIL_OK); /* whole cells: columns 4..11, rows 8..9 */
    for (int i = 0; i < 256; i++)
        CHECK(c.weight[i / 16][i % 16] == (i % 16 >= 4 && i % 16 < 12 && i / 16 >= 8 && i / 16 < 10 ? 255 : 0));
    CHECK(pupil_metering_roi(&c, 0.5, 0.5, 1 / 32.0, 1 / 16.0) == PUPIL_OK); /* half of cell 8, 8 */
    CHECK(abs(c.weight[8][8] - 128) <= 1 && c.weight[8][9] == 0 && c.weight[7][8] == 0);
    CHECK(pupil_metering_roi(&c, 0, 0, 1, 1) == PUPIL_OK && c.weight[0][0] == 255 && c.weight[15][15] == 255);
    CHECK(pupil_metering_roi(&c, 0.999999, 0.999999, 1e-6, 1e-6) == PUPIL_OK);
    CHECK(pupil_config_check(&c, NULL) == PUPIL_OK); /* even the smallest region meters something */
    for (int i = 0; i < 100; i++) /* for any sum of two rounded fractions, whole per cents are never outside */
        CHECK_MSG(pupil_metering_roi(&c, i / 100.0, 0, (100 - i) / 100.0, 1) == PUPIL_OK, "%d %%", i);
    static const double bad[][4] = {{-0.01, 0, 1, 1},    {0, -0.01, 1, 1}, {0, 0, 1.01, 1},       {0, 0, 1, 1.01},
                                    {0, 0, 0, 1},        {0, 0, 1, 0},     {0.5, 0, 0.51, 1},     {0, 0.5, 1, 0.51},
                                    {NAN, 0, 1, 1},      {0, NAN, 1, 1},   {0, 0, NAN, 1},        {0, 0, 1, NAN},
                                    {0, 0, INFINITY, 1}, {1, 0, 0.5, 1},   {0.5, 0.5, -0.2, 0.2}, {1e300, 0, 1, 1},
                                    {0, 1, 1, 1e-10}};
    before = c;
    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK_MSG(pupil_metering_roi(&c, bad[i][0], bad[i][1], bad[i][2], bad[i][3]) == PUPIL_ERR_VALUE, "region %u",
                  i);
    CHECK(memcmp(&c, &before, sizeof c) == 0);
    CHECK(pupil_metering_uniform(&c) == PUPIL_OK && c.weight[3][9] == 1);
    CHECK(pupil_metering_uniform(NULL) == PUPIL_ERR_NULL && pupil_metering_centre(NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_metering_spot(NULL) == PUPIL_ERR_NULL && pupil_metering_roi(NULL, 0, 0, 1, 1) == PUPIL_ERR_NULL);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_defaults();
    check_ranges();
    check_the_rest();
    check_patterns();
    return check_end();
}

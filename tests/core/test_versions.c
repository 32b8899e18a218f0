/* Structs of every size: the library writes at most the given size, and reads what pupil/abi.h says. */
#include "check.h"
#include "pupil/pupil.h"
#include "pupil/row_gain.h"
#include "pupil/sensor.h"

#include <stddef.h>

enum { MARK = 0xa5, MORE = 24, MOST_EXTRA = 4096 };

static pupil_t pupil;
static pupil_sensor sensor;
static pupil_row_gain lamps;
static float pixels[4 * 4 * 3];
static unsigned char picture[4 * 4 * 4];

/* --- outputs --- */

static int config_default(void *out, size_t bytes)
{
    pupil_config_default_sized(out, bytes);
    return PUPIL_OK;
}

static int sensor_config_default(void *out, size_t bytes)
{
    pupil_sensor_config_default_sized(out, bytes);
    return PUPIL_OK;
}

static int row_gain_config_default(void *out, size_t bytes)
{
    pupil_row_gain_config_default_sized(out, bytes);
    return PUPIL_OK;
}

static int stats_clear(void *out, size_t bytes)
{
    pupil_stats_clear_sized(out, bytes);
    return PUPIL_OK;
}

static int get_stats(void *out, size_t bytes)
{
    return pupil_get_stats_sized(&pupil, out, bytes);
}

static int get_exposure(void *out, size_t bytes)
{
    return pupil_get_exposure_sized(&pupil, out, bytes);
}

static int get_curve(void *out, size_t bytes)
{
    return pupil_get_curve_sized(&pupil, NULL, out, bytes);
}

static int curve_before_light(void *out, size_t bytes)
{
    return pupil_curve_before_light_sized(&pupil, out, bytes);
}

static int sensor_get(void *out, size_t bytes)
{
    return pupil_sensor_get_sized(&sensor, out, bytes);
}

static int row_gain_get(void *out, size_t bytes)
{
    return pupil_row_gain_get_sized(&lamps, out, bytes);
}

static const struct output {
    const char *name;
    size_t bytes;
    int refuses; /* returns an error */
    int (*call)(void *out, size_t bytes);
} outputs[] = {
    {"config_default", sizeof(pupil_config), 0, config_default},
    {"sensor_config_default", sizeof(pupil_sensor_config), 0, sensor_config_default},
    {"row_gain_config_default", sizeof(pupil_row_gain_config), 0, row_gain_config_default},
    {"stats_clear", sizeof(pupil_stats), 0, stats_clear},
    {"get_stats", sizeof(pupil_stats), 1, get_stats},
    {"get_exposure", sizeof(pupil_exposure), 1, get_exposure},
    {"get_curve", sizeof(pupil_curve), 1, get_curve},
    {"curve_before_light", sizeof(pupil_curve), 1, curve_before_light},
    {"sensor_get", sizeof(pupil_sensor_setting), 1, sensor_get},
    {"row_gain_get", sizeof(pupil_row_gain_result), 1, row_gain_get},
};

static int all_are(const unsigned char *byte, size_t from, size_t end, int value)
{
    for (size_t i = from; i < end; i++)
        if (byte[i] != value)
            return 0;
    return 1;
}

static void check_output(const struct output *o)
{
    static _Alignas(16) unsigned char whole[8192], part[8192];
    uint32_t size_bytes;
    CHECK(o->bytes + 2 * MORE <= sizeof part && o->call(whole, o->bytes) == PUPIL_OK);
    for (size_t n = 0; n <= o->bytes + MORE; n++) {
        memset(part, MARK, sizeof part);
        const int error = o->call(part, n);
        CHECK_MSG(all_are(part, n, sizeof part, MARK), "%s wrote beyond %zu bytes", o->name, n);
        if (n < sizeof size_bytes) {
            CHECK_MSG(error == (o->refuses ? PUPIL_ERR_SIZE_BYTES : PUPIL_OK), "%s, %zu bytes: %d", o->name, n, error);
            CHECK_MSG(all_are(part, 0, n, MARK), "%s touched %zu bytes", o->name, n);
            continue;
        }
        memcpy(&size_bytes, part, sizeof size_bytes);
        CHECK_MSG(error == PUPIL_OK && size_bytes == n, "%s, %zu bytes: %d, size_bytes %u", o->name, n, error,
                  size_bytes);
        const size_t common = n < o->bytes ? n : o->bytes;
        CHECK_MSG(memcmp(part + 4, whole + 4, common - 4) == 0, "%s, %zu bytes: the content", o->name, n);
        CHECK_MSG(all_are(part, common, n, 0), "%s, %zu bytes: what the library does not know", o->name, n);
    }
}

/* --- inputs --- */

static pupil_image_const in_image(void)
{
    return (pupil_image_const){
        .data = pixels, .stride_bytes = 4 * 12, .width = 4, .height = 4, .pixel = PUPIL_PIXEL_RGB32F};
}

static pupil_image out_image(void)
{
    return (pupil_image){.data = picture, .stride_bytes = 4 * 4, .width = 4, .height = 4, .pixel = PUPIL_PIXEL_BGRX8};
}

static int with_config(const void *in)
{
    static pupil_t made;
    const int error = pupil_config_check(in, NULL);
    CHECK(pupil_init(&made, in) == error);
    return error;
}

static int with_sensor_config(const void *in)
{
    static pupil_sensor made;
    const int error = pupil_sensor_config_check(in, NULL);
    CHECK(pupil_sensor_init(&made, in) == error);
    return error;
}

static int with_row_gain_config(const void *in)
{
    static pupil_row_gain made;
    const int error = pupil_row_gain_config_check(in, NULL);
    CHECK(pupil_row_gain_init(&made, in) == error);
    return error;
}

static int with_coding(const void *in)
{
    const pupil_image out = out_image();
    pupil_image_const coded = in_image();
    coded.coding = in;
    const int error = pupil_coding_check(in, PUPIL_PIXEL_RGB32F, NULL);
    CHECK(pupil_process(&pupil, &coded, NULL, &out) == error);
    return error;
}

static int with_image_const(const void *in)
{
    const pupil_image out = out_image();
    return pupil_process(&pupil, in, NULL, &out);
}

static int with_image(const void *out)
{
    const pupil_image_const in = in_image();
    return pupil_process(&pupil, &in, NULL, out);
}

static int with_info(const void *info)
{
    const pupil_image_const in = in_image();
    const pupil_image out = out_image();
    pupil_curve curve;
    const int error = pupil_process(&pupil, &in, info, &out);
    CHECK(pupil_get_curve(&pupil, info, &curve) == error);
    CHECK(pupil_sensor_scene(&sensor, 0, 0, info) == error);
    return error;
}

static int with_curve(const void *curve)
{
    const pupil_image_const in = in_image();
    const pupil_image out = out_image();
    return pupil_map_rows(&pupil, curve, &in, &out);
}

static int with_stats(const void *stats)
{
    double log2_luminance;
    pupil_stats sum;
    pupil_stats_clear(&sum);
    const int error = pupil_stats_add(&sum, stats);
    CHECK(pupil_stats_mean(stats, 0, 1, &log2_luminance) == error);
    CHECK(pupil_sensor_frame(&sensor, stats, NULL) == error);
    CHECK(pupil_adapt(&pupil, stats, NULL) == error);
    return error;
}

typedef struct input {
    const char *name;
    size_t bytes;
    int takes_zero;
    int refusal;
    int (*call)(const void *in);
    const void *good;
    size_t first_bytes; /* of the first release's struct; 0: it has not grown */
} input;

static void check_input(const input *i)
{
    static _Alignas(16) unsigned char room[8192 + 2 * MOST_EXTRA];
    for (uint32_t n = 0; n <= i->bytes + MOST_EXTRA + 2; n++) {
        memset(room, 0, sizeof room);
        memcpy(room, i->good, i->bytes);
        memcpy(room, &n, sizeof n);
        const int fits =
            n ? n >= (i->first_bytes ? i->first_bytes : i->bytes) && n <= i->bytes + MOST_EXTRA : i->takes_zero;
        int error = i->call(room);
        CHECK_MSG(error == (fits ? PUPIL_OK : i->refusal), "%s, size_bytes %u: %d", i->name, n, error);
        if (!fits || n <= i->bytes + 1)
            continue;
        room[n] = 1; /* is not looked at */
        error = i->call(room);
        CHECK_MSG(error == PUPIL_OK, "%s, size_bytes %u, one beyond: %d", i->name, n, error);
        room[n - 1] = 1;
        error = i->call(room);
        CHECK_MSG(error == i->refusal, "%s, size_bytes %u, a field set: %d", i->name, n, error);
        n += n > i->bytes + 8 && n + 300 < i->bytes + MOST_EXTRA ? 97 : 0;
    }
}

int main(int argc, char **argv)
{
    pupil_config config;
    pupil_sensor_config sensor_config;
    pupil_row_gain_config row_gain_config;
    pupil_curve curve;
    pupil_stats stats;
    const pupil_coding coding = {0};
    const pupil_image_const in = in_image();
    const pupil_image out = out_image();
    const pupil_frame_info info = {0};
    check_begin(argc, argv);
    for (size_t i = 0; i < sizeof pixels / sizeof *pixels; i++)
        pixels[i] = 0.5f;
    pupil_config_default(&config);
    pupil_sensor_config_default(&sensor_config);
    pupil_row_gain_config_default(&row_gain_config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_sensor_init(&sensor, &sensor_config) == PUPIL_OK);
    CHECK(pupil_row_gain_init(&lamps, &row_gain_config) == PUPIL_OK);
    CHECK(pupil_process(&pupil, &in, NULL, &out) == PUPIL_OK && pupil_get_curve(&pupil, NULL, &curve) == PUPIL_OK);
    CHECK(pupil_get_stats(&pupil, &stats) == PUPIL_OK);

    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
        check_output(&outputs[i]);
    const input inputs[] = {
        {"config", sizeof config, 0, PUPIL_ERR_CONFIG, with_config, &config, 0},
        {"sensor_config", sizeof sensor_config, 0, PUPIL_ERR_CONFIG, with_sensor_config, &sensor_config, 0},
        {"row_gain_config", sizeof row_gain_config, 0, PUPIL_ERR_CONFIG, with_row_gain_config, &row_gain_config, 0},
        {"coding", sizeof coding, 1, PUPIL_ERR_CODING, with_coding, &coding, 0},
        {"image_const", sizeof in, 1, PUPIL_ERR_SIZE_BYTES, with_image_const, &in, 0},
        {"image", sizeof out, 1, PUPIL_ERR_SIZE_BYTES, with_image, &out, 0},
        {"info", sizeof info, 1, PUPIL_ERR_SIZE_BYTES, with_info, &info, 0},
        {"curve", sizeof curve, 1, PUPIL_ERR_SIZE_BYTES, with_curve, &curve, 0},
        {"stats", sizeof stats, 1, PUPIL_ERR_SIZE_BYTES, with_stats, &stats, offsetof(pupil_stats, black_weight)},
    };
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++)
        check_input(&inputs[i]);
    return check_end();
}

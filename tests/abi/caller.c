/* caller.c: a program that uses every public struct that may grow. It is compiled with headers of another version than
 * the library's, and with AddressSanitizer, which reports accesses beyond a struct: each struct has its own memory, of
 * the size that this program was compiled with.
 *
 *     caller              every call
 *     caller zero         size_bytes is 0 where that is allowed: the fields of the first release
 *     caller set STRUCT   the last byte of each STRUCT is not 0
 *
 * Prints "runs", or which call was refused with which code. Exit status 1 if a refused call has changed anything. */
#include "pupil/gles.h"
#include "pupil/pupil.h"
#include "pupil/row_gain.h"
#include "pupil/sensor.h"
#include "pupil/veil.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The last bytes of each struct: a field that the library does not know. */
#ifndef ADDED_BYTES
#define ADDED_BYTES 0
#endif

enum { SIDE = 64 }; /* the smallest picture with row gains */

static const char *set = "";
static int zero;

/* --- memory as it was before a call --- */

static struct block {
    unsigned char *now, *before;
    size_t bytes;
} blocks[48];
static int block_count;

static void *room(size_t bytes)
{
    struct block *b = &blocks[block_count++];
    b->now = malloc(bytes);
    b->before = malloc(bytes);
    b->bytes = bytes;
    memset(b->now, 0xa5, bytes);
    return b->now;
}

static void remember(void)
{
    for (int i = 0; i < block_count; i++)
        memcpy(blocks[i].before, blocks[i].now, blocks[i].bytes);
}

static void done(int error, const char *call)
{
    if (!error)
        return;
    for (int i = 0; i < block_count; i++)
        if (memcmp(blocks[i].before, blocks[i].now, blocks[i].bytes) != 0) {
            printf("%s is refused with %d, but has changed block %d\n", call, error, i);
            exit(1);
        }
    printf("refused %d by %s\n", error, call);
    exit(0);
}

#define CALL(function, ...) (remember(), done(function(__VA_ARGS__), #function))

/* --- the caller's structs --- */

static void finish(void *made, size_t bytes, const char *name)
{
    if (!strcmp(set, name))
        ((unsigned char *)made)[bytes - 1] = 1;
}

/* A struct that the caller fills in. */
static void *input(size_t bytes, const char *name)
{
    void *made = room(bytes);
    const uint32_t size_bytes = zero ? 0 : (uint32_t)bytes;
    memset(made, 0, bytes);
    memcpy(made, &size_bytes, sizeof size_bytes);
    finish(made, bytes, name);
    return made;
}

/* A struct that the library has filled in: fields that it does not know are 0. */
static void check_output(const void *filled, size_t bytes, const char *name)
{
    uint32_t size_bytes;
    memcpy(&size_bytes, filled, sizeof size_bytes);
    int bad = size_bytes != bytes;
    for (size_t i = bytes - ADDED_BYTES; i < bytes; i++)
        bad |= ((const unsigned char *)filled)[i] != 0;
    if (bad) {
        printf("%s of %zu bytes: size_bytes is %u, or an added field is not 0\n", name, bytes, size_bytes);
        exit(1);
    }
}

static pupil_t *pupil;
static pupil_sensor *sensor;
static pupil_row_gain *lamps;
static pupil_coding *coding;
static pupil_image_const *in;
static pupil_image *out;
static pupil_frame_info *info;
static pupil_curve *curve;
static float *gain;

#define INPUT(type)           input(sizeof(type), #type)
#define CHECK_OUTPUT(p, type) check_output(p, sizeof(type), #type)

/* --- calls, in the order of a program --- */

static void make_objects(void)
{
    pupil_config *config = room(sizeof *config);
    pupil_sensor_config *sensor_config = room(sizeof *sensor_config);
    pupil_row_gain_config *row_gain_config = room(sizeof *row_gain_config);
    pupil = room(sizeof *pupil);
    sensor = room(sizeof *sensor);
    lamps = room(sizeof *lamps);

    pupil_config_default(config);
    CHECK_OUTPUT(config, pupil_config);
    finish(config, sizeof *config, "pupil_config");
    CALL(pupil_config_check, config, NULL);
    CALL(pupil_init, pupil, config);
    CALL(pupil_retune, pupil, config);

    pupil_sensor_config_default(sensor_config);
    CHECK_OUTPUT(sensor_config, pupil_sensor_config);
    finish(sensor_config, sizeof *sensor_config, "pupil_sensor_config");
    CALL(pupil_sensor_init, sensor, sensor_config);
    CALL(pupil_sensor_retune, sensor, sensor_config);

    pupil_row_gain_config_default(row_gain_config);
    CHECK_OUTPUT(row_gain_config, pupil_row_gain_config);
    finish(row_gain_config, sizeof *row_gain_config, "pupil_row_gain_config");
    CALL(pupil_row_gain_init, lamps, row_gain_config);
}

static void make_frame(void)
{
    static unsigned char pixels[SIDE * SIDE];
    memset(pixels, 100, sizeof pixels);
    coding = INPUT(pupil_coding);
    in = INPUT(pupil_image_const);
    in->data = pixels;
    in->stride_bytes = SIDE;
    in->width = SIDE;
    in->height = SIDE;
    in->pixel = PUPIL_PIXEL_GREY8;
    in->coding = coding;
    out = INPUT(pupil_image);
    out->data = room(SIDE * SIDE * 4);
    out->stride_bytes = SIDE * 4;
    out->width = SIDE;
    out->height = SIDE;
    out->pixel = PUPIL_PIXEL_BGRX8;
    info = INPUT(pupil_frame_info);
    info->timestamp_ns = 1;
    info->exposure_s = 0.01;
    gain = room(SIDE * sizeof *gain);
    for (int i = 0; i < SIDE; i++)
        gain[i] = 1;
}

static void whole_frames(void)
{
    pupil_exposure *exposure = room(sizeof *exposure);
    CALL(pupil_coding_check, coding, PUPIL_PIXEL_GREY8, NULL);
    CALL(pupil_process, pupil, in, info, out);
    CALL(pupil_meter, pupil, in, info);
    CALL(pupil_get_exposure, pupil, exposure);
    CHECK_OUTPUT(exposure, pupil_exposure);
    CALL(pupil_frame_begin, pupil, SIDE, SIDE, info);
    CALL(pupil_frame_rows, pupil, in, 0, out);
    CALL(pupil_frame_end, pupil);
}

static void seam(void)
{
    pupil_stats *stats = room(sizeof *stats);
    pupil_stats *sum = room(sizeof *sum);
    curve = room(sizeof *curve);
    CALL(pupil_curve_before_light, pupil, curve);
    CHECK_OUTPUT(curve, pupil_curve);
    CALL(pupil_get_curve, pupil, info, curve);
    CHECK_OUTPUT(curve, pupil_curve);
    finish(curve, sizeof *curve, "pupil_curve");
    CALL(pupil_map_rows, pupil, curve, in, out);
    CALL(pupil_map_rows_with_gains, pupil, curve, in, gain, out);

    CALL(pupil_get_stats, pupil, stats);
    CHECK_OUTPUT(stats, pupil_stats);
    pupil_stats_clear(stats);
    CHECK_OUTPUT(stats, pupil_stats);
    finish(stats, sizeof *stats, "pupil_stats");
    CALL(pupil_meter_rows, pupil, in, 0, SIDE, stats);
    pupil_stats_clear(sum);
    CALL(pupil_stats_add, sum, stats);
    CALL(pupil_adapt, pupil, sum, info);
    CALL(pupil_sensor_frame, sensor, sum, info);
    pupil_stats_clear(sum);
    CALL(pupil_fused_rows, pupil, curve, in, 0, SIDE, out, sum);
}

static void cameras(void)
{
    pupil_sensor_setting *setting = room(sizeof *setting);
    pupil_row_gain_result *result = room(sizeof *result);
    CALL(pupil_sensor_scene, sensor, 0, 0, info);
    CALL(pupil_sensor_get, sensor, setting);
    CHECK_OUTPUT(setting, pupil_sensor_setting);
    CALL(pupil_row_gain_frame, lamps, in, info);
    CALL(pupil_row_gain_of_rows, lamps, info, SIDE, gain);
    CALL(pupil_row_gain_get, lamps, result);
    CHECK_OUTPUT(result, pupil_row_gain_result);
}

static void veils(void)
{
    pupil_veil *veil = room(sizeof *veil);
    pupil_veil_light *light = room(sizeof *light);
    pupil_veil_scratch *scratch = room(sizeof *scratch);
    pupil_veil_config *config = room(sizeof *config);
    pupil_veil_result *result = room(sizeof *result);
    pupil_veil_config_default(config);
    CHECK_OUTPUT(config, pupil_veil_config);
    config->width = SIDE;
    config->height = SIDE;
    finish(config, sizeof *config, "pupil_veil_config");
    CALL(pupil_veil_init, veil, config);
    CALL(pupil_veil_get, veil, result);
    CHECK_OUTPUT(result, pupil_veil_result);
    CALL(pupil_veil_light_clear, light);
    CALL(pupil_veil_gather_rows, veil, pupil, in, 0, NULL, light);
    CALL(pupil_veil_add_light, veil, light);
    CALL(pupil_veil_map_rows, veil, pupil, curve, in, out, scratch);
}

static pupil_gles_function finds_nothing(const char *name)
{
    (void)name;
    return 0;
}

/* Without a context pupil_gles_init accepts the configuration and then reports that there is no context. The calls that
 * need one are in tests/gles/test_versions.c. */
static void gpu(void)
{
    pupil_gles *gles = room(sizeof *gles);
    pupil_gles_config *config = room(sizeof *config);
    pupil_gles_config_default(config);
    CHECK_OUTPUT(config, pupil_gles_config);
    config->pixel = PUPIL_PIXEL_GREY8;
    config->width = SIDE;
    config->height = SIDE;
    finish(config, sizeof *config, "pupil_gles_config");
    remember();
    const int error = pupil_gles_init(gles, config, pupil, finds_nothing, NULL);
    if (error != PUPIL_ERR_GLES_VERSION)
        done(error, "pupil_gles_init");
}

int main(int argc, char **argv)
{
    zero = argc > 1 && !strcmp(argv[1], "zero");
    set = argc > 2 ? argv[2] : "";
    make_objects();
    make_frame();
    whole_frames();
    seam();
    cameras();
    veils();
    gpu();
    puts("runs");
    return 0;
}

/* The core as the page calls it: numbers and addresses in a module's memory go in, numbers come out. No C library: the
 * page fills in a frame's bytes, and reads a picture's.
 *
 * Each engine is a pupil_t of one law. They take the same statistics: the frame is metered once.
 */
#include <stddef.h>
#include <stdint.h>

#include "pupil/pupil.h"
#include "pupil/sensor.h"

#define EXPORT(NAME) __attribute__((export_name(NAME)))

/* What a view shows: an engine of each law, and then these. */
enum { LOCKED = PUPIL_LAW_COUNT, ENGINES, AS_IT_CAME = ENGINES };

static pupil_t engine[ENGINES];
static pupil_config config;
static pupil_stats stats;
static pupil_image_const frame;
static pupil_coding coding;
static pupil_frame_info info;
static pupil_sensor sensor;
static pupil_sensor_config sensor_config;
static const char *why = "";

/* --- memory: one region, behind what the linker has placed --- */

extern unsigned char __heap_base;
enum { PAGE_BYTES = 65536 };

/* Where `bytes` bytes are, until the next call; 0: there is no room. */
EXPORT("room") unsigned char *page_room(uint32_t bytes);
unsigned char *page_room(uint32_t bytes)
{
    const uintptr_t begin = ((uintptr_t)&__heap_base + 63) & ~(uintptr_t)63, end = begin + bytes;
    const size_t have = __builtin_wasm_memory_size(0), need = (end + PAGE_BYTES - 1) / PAGE_BYTES;
    if (end < begin || (need > have && __builtin_wasm_memory_grow(0, need - have) == (size_t)-1))
        return NULL;
    return (unsigned char *)begin;
}

/* --- settings --- */

static int settle(void)
{
    int result = pupil_config_check(&config, &why);
    pupil_config own = config;
    for (uint32_t i = 0; i < ENGINES && result == PUPIL_OK; i++) {
        own.law = i < LOCKED ? i : (uint32_t)PUPIL_LAW_SECONDS;
        own.lock = i == LOCKED ? 1 : config.lock;
        result = pupil_retune(&engine[i], &own);
    }
    return result;
}

EXPORT("begin") int page_begin(void);
int page_begin(void)
{
    pupil_config_default(&config);
    config.histogram = 1;
    for (uint32_t i = 0; i < ENGINES; i++)
        pupil_init(&engine[i], &config);
    return settle();
}

EXPORT("reset") void page_reset(void);
void page_reset(void)
{
    for (uint32_t i = 0; i < ENGINES; i++)
        pupil_reset(&engine[i]);
}

static void meter_by(uint32_t pattern)
{
    if (pattern == 1)
        pupil_metering_centre(&config);
    else if (pattern == 2)
        pupil_metering_spot(&config);
    else
        pupil_metering_uniform(&config);
}

/* The order is that of SETTINGS in core.js. */
static void change(uint32_t what, double value)
{
    double *const number[] = {&config.ev_compensation, &config.key,           &config.tau_light_s, &config.tau_dark_s,
                              &config.frame_weight,    &config.ev_min,        &config.ev_max,      &config.highlight_ev,
                              &config.white_quantile,  &config.eye_unit_cd_m2};
    uint32_t *const choice[] = {&config.lock, &config.white_mode, &config.curve, &config.flicker, &config.levels};
    const uint32_t numbers = sizeof number / sizeof *number, choices = sizeof choice / sizeof *choice;
    if (what < numbers)
        *number[what] = value;
    else if (what < numbers + choices)
        *choice[what - numbers] = (uint32_t)value;
    else
        meter_by((uint32_t)value);
}

/* 0, or an error, and then nothing has changed and page_why has a sentence. */
EXPORT("set") int page_set(uint32_t what, double value);
int page_set(uint32_t what, double value)
{
    const pupil_config before = config;
    change(what, value);
    const int result = settle();
    if (result != PUPIL_OK) {
        config = before;
        settle();
    }
    return result;
}

EXPORT("region") int page_region(double x, double y, double width, double height);
int page_region(double x, double y, double width, double height)
{
    const int result = pupil_metering_roi(&config, x, y, width, height);
    return result == PUPIL_OK ? settle() : result;
}

EXPORT("why") const char *page_why(void);
const char *page_why(void)
{
    return why;
}

EXPORT("level") uint32_t page_level(void);
uint32_t page_level(void)
{
    uint32_t level = PUPIL_LEVEL_SCALAR;
    pupil_get_level(&engine[0], &level);
    return level;
}

/* --- a frame --- */

/* Bytes of a picture without padding; 0: not a format, or too large. */
EXPORT("image_bytes") uint32_t page_image_bytes(uint32_t pixel, uint32_t width, uint32_t height);
uint32_t page_image_bytes(uint32_t pixel, uint32_t width, uint32_t height)
{
    if (!width || !height || width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX)
        return 0;
    const uint64_t bytes = (uint64_t)pupil_row_bytes(pixel, width) * height +
                           (uint64_t)pupil_chroma_row_bytes(pixel, width) * pupil_chroma_rows(pixel, height) *
                               (pupil_pixel_planes(pixel) == 3 ? 2 : 1);
    return bytes > UINT32_MAX / 2 ? 0 : (uint32_t)bytes;
}

/* The frame whose bytes are at `data`, as page_image_bytes has them, and the coding of its Y'CbCr. */
EXPORT("frame")
void page_frame(unsigned char *data, uint32_t pixel, uint32_t width, uint32_t height, uint32_t matrix, uint32_t range);
void page_frame(unsigned char *data, uint32_t pixel, uint32_t width, uint32_t height, uint32_t matrix, uint32_t range)
{
    coding = (pupil_coding){.matrix = matrix, .range = range};
    frame = pupil_image_const_of(data, width, height, pixel);
    frame.coding = &coding;
}

/* Floats as they would be in other light. */
EXPORT("light") void page_light(const float *from, float *to, uint32_t count, float factor);
void page_light(const float *from, float *to, uint32_t count, float factor)
{
    for (uint32_t i = 0; i < count; i++)
        to[i] = from[i] * factor;
}

/* code_light: of floats that were codes, as in pupil_stats; 0: they are light. */
EXPORT("meter") int page_meter(float code_light);
int page_meter(float code_light)
{
    pupil_stats_clear(&stats);
    const int result = pupil_meter_rows(&engine[0], &frame, 0, frame.height, &stats);
    if (code_light > 0.0f)
        stats.code_light = code_light;
    return result;
}

/* exposure_s and gain: 0 where they are unknown. */
EXPORT("adapt") int page_adapt(int64_t timestamp_ns, double exposure_s, double gain);
int page_adapt(int64_t timestamp_ns, double exposure_s, double gain)
{
    int result = PUPIL_OK;
    info = (pupil_frame_info){.timestamp_ns = timestamp_ns, .exposure_s = exposure_s, .gain = gain};
    for (uint32_t i = 0; i < ENGINES && result == PUPIL_OK; i++)
        result = pupil_adapt(&engine[i], &stats, &info);
    return result;
}

/* Writes the picture of a view to `out`, as RGBA. */
EXPORT("map") int page_map(uint32_t view, unsigned char *out);
int page_map(uint32_t view, unsigned char *out)
{
    const pupil_image picture = pupil_image_of(out, frame.width, frame.height, PUPIL_PIXEL_RGBA8);
    pupil_curve curve = {.scale = 1.0f, .inverse_white_squared = 1.0f}; /* the identity up to white */
    const pupil_t *by = &engine[view < ENGINES ? view : 0];
    if (view < ENGINES && pupil_get_curve(by, &info, &curve) != PUPIL_OK)
        pupil_curve_before_light(by, &curve);
    return pupil_map_rows(by, &curve, &frame, &picture);
}

/* --- results --- */

/* The order is that of RESULTS in core.js. */
EXPORT("result") double page_result(uint32_t view, uint32_t what);
double page_result(uint32_t view, uint32_t what)
{
    pupil_exposure e;
    if (view >= ENGINES || pupil_get_exposure(&engine[view], &e) != PUPIL_OK)
        return 0.0;
    const double all = stats.pixels ? (double)stats.pixels : 1.0;
    const double value[] = {e.metered_ev,
                            e.adapted_ev,
                            e.white_ev,
                            e.scale,
                            e.dt_s,
                            (double)e.state,
                            (double)e.reason,
                            e.held_back_ev,
                            e.flicker_ev,
                            (double)stats.black / all,
                            (double)stats.clipped / all,
                            (double)stats.bad / all};
    return what < sizeof value / sizeof *value ? value[what] : 0.0;
}

/* --- the sensor loop --- */

/* A camera whose exposure time has limits and a step. gain_most: its largest gain, 1 if it has none. Its tone curve is
 * unknown. */
EXPORT("sensor_begin")
int page_sensor_begin(double frame_s, double least_s, double most_s, double step_s, double gain_most, double exposure_s,
                      double gain);
int page_sensor_begin(double frame_s, double least_s, double most_s, double step_s, double gain_most, double exposure_s,
                      double gain)
{
    pupil_sensor_config_default(&sensor_config);
    sensor_config.delay_frames = 16; /* a browser does not say how many frames are on their way */
    sensor_config.frame_s = frame_s;
    sensor_config.exposure_min_s = least_s;
    sensor_config.exposure_max_s = most_s;
    sensor_config.exposure_step_s = step_s;
    sensor_config.frame_rate_priority = frame_s > least_s;
    sensor_config.gain_max = gain_most;
    sensor_config.linear = 0;
    int result = pupil_sensor_config_check(&sensor_config, &why);
    if (result == PUPIL_OK)
        result = pupil_sensor_init(&sensor, &sensor_config);
    return result == PUPIL_OK ? pupil_sensor_start(&sensor, exposure_s, gain) : result;
}

/* The frame that was metered last. 1: there is a setting to be written, -1: refused. */
EXPORT("sensor_frame") int page_sensor_frame(int64_t timestamp_ns, double exposure_s, double gain);
int page_sensor_frame(int64_t timestamp_ns, double exposure_s, double gain)
{
    const pupil_frame_info taken = {.timestamp_ns = timestamp_ns, .exposure_s = exposure_s, .gain = gain};
    pupil_sensor_setting setting;
    if (pupil_sensor_frame(&sensor, &stats, &taken) != PUPIL_OK || pupil_sensor_get(&sensor, &setting) != PUPIL_OK)
        return -1;
    return setting.changed != 0;
}

/* exposure_s, gain, error_ev, scene_ev, state, reason */
EXPORT("sensor_result") double page_sensor_result(uint32_t what);
double page_sensor_result(uint32_t what)
{
    pupil_sensor_setting s;
    if (pupil_sensor_get(&sensor, &s) != PUPIL_OK)
        return 0.0;
    const double value[] = {s.exposure_s, s.gain, s.error_ev, s.scene_ev, (double)s.state, (double)s.reason};
    return what < sizeof value / sizeof *value ? value[what] : 0.0;
}

EXPORT("sensor_state") const char *page_sensor_state(void);
const char *page_sensor_state(void)
{
    return pupil_sensor_state_name((uint32_t)page_sensor_result(4));
}

EXPORT("sensor_reason") const char *page_sensor_reason(void);
const char *page_sensor_reason(void)
{
    return pupil_sensor_reason_name((uint32_t)page_sensor_result(5));
}

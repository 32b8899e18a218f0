/* Row correction gains: life, metering by groups of columns, and the gains of rows. */
#include "row_gain_private.h"

#include "base/numeric.h"
#include "base/versioned.h"
#include "core/image.h"
#include "core/object.h"
#include "core/read.h"

/* "rowgan" and the object's size: another version's object is refused. */
#define ROW_GAIN_MAGIC (UINT64_C(0x726f7767616e0000) + sizeof(pupil_row_gain_object))

enum { GROUPS = PUPIL_ROW_GAIN_GROUPS, HARMONICS = PUPIL_ROW_GAIN_HARMONICS, TERMS = PUPIL_ROW_GAIN_TERMS };
enum { SMALLEST_PX = 64 }; /* eight columns a group, a row a band */

static const pupil_row_gain_object *object_of(const pupil_row_gain *lamps)
{
    const pupil_row_gain_object *o = (const pupil_row_gain_object *)(const void *)lamps;
    return o && o->magic == ROW_GAIN_MAGIC ? o : 0;
}

static const pupil_row_gain_config defaults = {.mains_hz = 50, .readout_s = 1.0 / 60.0};

void pupil_row_gain_config_default_sized(pupil_row_gain_config *config, size_t config_bytes)
{
    if (config)
        (void)pupil_versioned_write(config, config_bytes, &defaults, sizeof defaults);
}

/* The caller's configuration as one of this version: NULL, or what is wrong with it. */
static const char *read_config(pupil_row_gain_config *ours, const pupil_row_gain_config *theirs)
{
    const size_t first_bytes = PUPIL_FIRST_BYTES(pupil_row_gain_config, readout_s);
    *ours = defaults;
    const char *fault = pupil_versioned_read(ours, sizeof *ours, first_bytes, theirs, theirs->size_bytes);
    if (fault)
        return fault;
    if (ours->mains_hz != 50 && ours->mains_hz != 60)
        return "mains_hz must be 50 or 60";
    if (!(ours->readout_s >= 1e-4 && ours->readout_s <= 1.0)) /* true for NaN */
        return "readout_s must be from 1e-4 to 1";
    return 0;
}

int pupil_row_gain_config_check(const pupil_row_gain_config *config, const char **why)
{
    pupil_row_gain_config own;
    if (!config)
        return PUPIL_ERR_NULL;
    const char *fault = read_config(&own, config);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

int pupil_row_gain_init(pupil_row_gain *lamps, const pupil_row_gain_config *config)
{
    pupil_config metering;
    pupil_row_gain_config copy; /* the caller's may be where the object will */
    if (!lamps || !config)
        return PUPIL_ERR_NULL;
    if (read_config(&copy, config))
        return PUPIL_ERR_CONFIG;
    pupil_row_gain_object *o = (pupil_row_gain_object *)(void *)lamps;
    __builtin_memset(lamps, 0, sizeof *lamps);
    o->config = copy;
    pupil_config_default(&metering);
    metering.white_mode = PUPIL_WHITE_NONE; /* no histogram: only bands are used */
    pupil_row_gain_forget(o);
    o->magic = ROW_GAIN_MAGIC;
    return pupil_init(&o->meter, &metering);
}

/* The columns from x on, which is a multiple of 4 as every format needs it. */
static pupil_image_const columns_of(pupil_image_const image, uint32_t x, uint32_t width)
{
    image.data = (const unsigned char *)image.data + pupil_row_bytes(image.pixel, x);
    if (image.chroma)
        image.chroma = (const unsigned char *)image.chroma + pupil_chroma_row_bytes(image.pixel, x);
    if (image.cr)
        image.cr = (const unsigned char *)image.cr + pupil_chroma_row_bytes(image.pixel, x);
    image.width = width;
    return image;
}

/* Which pairs of rows are metered: two of a band, the same in each frame, so that the scene cancels. */
static int is_metered(uint32_t pair, uint32_t pairs)
{
    const uint32_t band = pair * PUPIL_BANDS / pairs;
    const uint32_t first = (band * pairs + PUPIL_BANDS - 1) / PUPIL_BANDS;
    const uint32_t end = ((band + 1) * pairs + PUPIL_BANDS - 1) / PUPIL_BANDS;
    const uint32_t count = end - first;
    const uint32_t place = pair - first;
    return count <= 2 || place == count / 4 || place == count * 3 / 4;
}

/* Where the metered rows of each band are. */
static void find_places(pupil_row_gain_object *o, uint32_t pixel, uint32_t height)
{
    const uint32_t pairs = (height + 1) / 2;
    const int together = pupil_pixel_is_mosaic(pixel); /* a band holds whole quads */
    int rows[PUPIL_BANDS] = {0};
    for (int b = 0; b < PUPIL_BANDS; b++)
        o->place[b] = 0.0;
    for (uint32_t y = 0; y < height; y++) {
        const uint32_t band = together ? y / 2 * PUPIL_BANDS / pairs : y * PUPIL_BANDS / height;
        if (is_metered(y / 2, pairs)) {
            o->place[band] += (y + 0.5) / height;
            rows[band]++;
        }
    }
    for (int b = 0; b < PUPIL_BANDS; b++)
        o->place[b] /= rows[b] ? rows[b] : 1; /* a band without rows is without light, too */
}

static void meter_group(pupil_row_gain_object *o, const pupil_image_const *image, uint32_t group)
{
    const uint32_t step = image->width / GROUPS & ~3u;
    const uint32_t x = group * step;
    const pupil_image_const part = columns_of(*image, x, group + 1 < GROUPS ? step : image->width - x);
    const uint32_t height = image->height;
    const uint32_t pairs = (height + 1) / 2;
    pupil_stats_clear(&o->stats);
    for (uint32_t pair = 0; pair < pairs; pair++)
        if (is_metered(pair, pairs)) {
            const uint32_t y = 2 * pair;
            const pupil_image_const rows = pupil_image_rows(part, y, height - y < 2 ? 1 : 2);
            const int error = pupil_meter_rows(&o->meter, &rows, y, height, &o->stats);
            PUPIL_ASSERT(!error); /* the whole picture was looked at before */
            (void)error;
        }
    for (int b = 0; b < PUPIL_BANDS; b++) {
        const double pixels = o->stats.band_pixels[b];
        o->light[group][b] =
            pixels > 0.0 ? (double)o->stats.band_log2_sum[b] * 0x1p-24 / pixels : 2.0 * PUPIL_ROW_GAIN_DARK;
    }
}

int pupil_row_gain_frame(pupil_row_gain *lamps, const pupil_image_const *image, const pupil_frame_info *info)
{
    if (!lamps || !image || !info)
        return PUPIL_ERR_NULL;
    if (!object_of(lamps))
        return PUPIL_ERR_OBJECT;
    pupil_row_gain_object *o = (pupil_row_gain_object *)(void *)lamps;
    pupil_input in;
    pupil_frame_info own;
    int error = pupil_input_read(&in, image);
    if (!error)
        error = pupil_info_read(&own, info);
    if (error)
        return error;
    image = &in.image;
    info = &own;
    if (info->timestamp_ns == o->timestamp_ns && o->stamped)
        return PUPIL_OK;
    if (!info->timestamp_ns || image->width < SMALLEST_PX || image->height < SMALLEST_PX) {
        pupil_row_gain_forget(o);
        return PUPIL_OK;
    }
    if (image->width != o->width || image->height != o->height)
        pupil_row_gain_forget(o);
    o->width = image->width;
    o->height = image->height;
    find_places(o, image->pixel, image->height);
    for (uint32_t g = 0; g < GROUPS; g++)
        meter_group(o, image, g);
    pupil_row_gain_learn(o, info);
    return PUPIL_OK;
}

int pupil_row_gain_get_sized(const pupil_row_gain *lamps, pupil_row_gain_result *result, size_t result_bytes)
{
    if (!lamps || !result)
        return PUPIL_ERR_NULL;
    const pupil_row_gain_object *o = object_of(lamps);
    if (!o)
        return PUPIL_ERR_OBJECT;
    return pupil_versioned_write(result, result_bytes, &o->result, sizeof o->result);
}

/* The wave's amplitudes in a frame of this exposure, times the share that is removed. */
static void amplitudes(const pupil_row_gain_object *o, double exposure_s, double wave[TERMS])
{
    for (int h = 0; h < HARMONICS; h++) {
        const double left = o->result.strength * pupil_row_gain_averaged(o->result.light_hz, h + 1, exposure_s);
        wave[2 * h] = o->coefficient[2 * h] * left;
        wave[2 * h + 1] = o->coefficient[2 * h + 1] * left;
    }
}

int pupil_row_gain_of_rows(const pupil_row_gain *lamps, const pupil_frame_info *info, uint32_t height, float *gain)
{
    if (!lamps || !info || !gain)
        return PUPIL_ERR_NULL;
    const pupil_row_gain_object *o = object_of(lamps);
    pupil_frame_info own;
    if (!o)
        return PUPIL_ERR_OBJECT;
    if (pupil_info_read(&own, info))
        return PUPIL_ERR_SIZE_BYTES;
    info = &own;
    if (!height || height > PUPIL_MAX_SIDE_PX)
        return PUPIL_ERR_SIZE;
    /* the difference as if it could not overflow; a frame that is further away than learning reaches has no gains */
    const double ahead_s = ((double)info->timestamp_ns - (double)o->timestamp_ns) * 1e-9;
    if (!(o->result.strength > 0.0) || !(ahead_s >= 0.0 && ahead_s <= 0.5)) {
        for (uint32_t y = 0; y < height; y++)
            gain[y] = 1.0f;
        return PUPIL_OK;
    }
    double wave[TERMS], cosine, sine, step_cosine, step_sine;
    const double exact_s = (double)(int64_t)((uint64_t)info->timestamp_ns - (uint64_t)o->timestamp_ns) * 1e-9;
    const double per_row = o->result.light_hz * o->result.readout_s / height;
    amplitudes(o, info->exposure_s > 0.0 && info->exposure_s <= 1e4 ? info->exposure_s : 0.0, wave);
    pupil_circle(o->turn + o->result.light_hz * exact_s + 0.5 * per_row, &cosine, &sine);
    pupil_circle(per_row, &step_cosine, &step_sine);
    for (uint32_t y = 0; y < height; y++) {
        double c = cosine, s = sine, sum = 0.0;
        for (int h = 0; h < HARMONICS; h++) {
            sum += wave[2 * h] * c + wave[2 * h + 1] * s;
            const double next = c * cosine - s * sine; /* the angle of the next harmonic */
            s = s * cosine + c * sine;
            c = next;
        }
        gain[y] = (float)pupil_exp2(sum > 4.0 ? -4.0 : sum < -4.0 ? 4.0 : -sum);
        const double turned = cosine * step_cosine - sine * step_sine;
        sine = sine * step_cosine + cosine * step_sine;
        cosine = turned;
    }
    return PUPIL_OK;
}

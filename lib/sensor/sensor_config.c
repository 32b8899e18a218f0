#include "sensor_private.h"

#include "base/key.h"
#include "base/numeric.h"
#include "base/versioned.h"

#define FIRST_BYTES PUPIL_FIRST_BYTES(pupil_sensor_config, day_night_s)

static const pupil_sensor_config defaults = {
    .delay_frames = 4,
    .key = 0.18, /* as pupil_config's, so that sensor and display agree on what is grey */
    .clip = 1.0,
    .trim_high = 1.0,
    .highlight_share = 0.05,
    .highlight_ev = 1.0,
    .far_ev = 0.10,
    .tau_s = 0.8,
    .hold_ev = 0.05,
    .digital_ev = 1.5, /* covers one half mains period to two, one control ahead of the other, and rounding */
    .frame_s = 1.0 / 30.0,
    .exposure_min_s = 1e-4,
    .exposure_max_s = 1.0 / 30.0,
    .frame_rate_priority = 1,
    .mains_hz = PUPIL_SENSOR_MAINS_AUTO,
    .gain_min = 1.0,
    .gain_max = 16.0,
    .gain_step = 1.0 / 16.0,
    .flash_frames = 2, /* a strobe or a lightning lights one frame, or parts of two */
    .linear = 1,
};

void pupil_sensor_config_default_sized(pupil_sensor_config *config, size_t config_bytes)
{
    if (config)
        (void)pupil_versioned_write(config, config_bytes, &defaults, sizeof defaults);
}

const char *pupil_sensor_config_read(pupil_sensor_config *ours, const pupil_sensor_config *theirs)
{
    *ours = defaults;
    return pupil_versioned_read(ours, sizeof *ours, FIRST_BYTES, theirs, theirs->size_bytes);
}

typedef struct {
    uint32_t at; /* offset in pupil_sensor_config */
    uint32_t is_count;
    double least, most;
    const char *fault;
} field_range;

#define RANGE(field, is_count, least, most, words)                                                                     \
    {                                                                                                                  \
        offsetof(pupil_sensor_config, field), is_count, least, most, #field " must be " words                          \
    }
#define COUNT(field, least, most)  RANGE(field, 1, least, most, "from " #least " to " #most)
#define NUMBER(field, least, most) RANGE(field, 0, least, most, "from " #least " to " #most)

static const field_range ranges[] = {
    COUNT(delay_frames, 1, 16),
    RANGE(key, 0, 0x1p-10, 1, "from 2^-10 to 1"),
    NUMBER(ev_compensation, -16, 16),
    COUNT(key_points, 0, 8),
    RANGE(reserved, 1, 0, 0, "0"),
    RANGE(clip, 0, 0x1p-16, 65536, "from 2^-16 to 65536"),
    NUMBER(trim_low, 0, 1),
    NUMBER(highlight_share, 0.001, 1),
    NUMBER(highlight_ev, 0, 8),
    NUMBER(far_ev, 0.02, 2),
    NUMBER(tau_s, 0, 1e6),
    NUMBER(hold_ev, 0, 0.5),
    NUMBER(digital_ev, 0, 8),
    NUMBER(frame_s, 1e-6, 1e6),
    NUMBER(exposure_max_s, 1e-9, 1e4),
    NUMBER(exposure_step_s, 0, 1),
    COUNT(frame_rate_priority, 0, 1),
    RANGE(gain_max, 0, 0x1p-10, 65536, "from 2^-10 to 65536"),
    COUNT(lock, 0, 1),
    COUNT(flash_frames, 0, 8),
    COUNT(linear, 0, 1),
    COUNT(gain_law, 0, 4),
    COUNT(stages, 0, 8),
    COUNT(exposure_mode, 0, 2),
    COUNT(gain_mode, 0, 2),
    COUNT(exposure_count, 0, 64),
    RANGE(reserved_too, 1, 0, 0, "0"),
    NUMBER(day_ev, -256, 256),
    NUMBER(day_night_s, 0, 1e6),
};

/* NaN is in no range. */
static int is_within(const pupil_sensor_config *c, const field_range *range)
{
    const char *at = (const char *)c + range->at;
    uint32_t count = 0;
    double number;
    if (range->is_count) {
        __builtin_memcpy(&count, at, sizeof count);
        number = count;
    } else {
        __builtin_memcpy(&number, at, sizeof number);
    }
    return number >= range->least && number <= range->most;
}

static const char *fault_of_ranges(const pupil_sensor_config *c)
{
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (!is_within(c, &ranges[i]))
            return ranges[i].fault;
    return 0;
}

static const char *fault_of_light(const pupil_sensor_config *c)
{
    const char *fault = pupil_key_fault(c->key_at, c->key_points);
    if (!fault && !(c->trim_high > c->trim_low && c->trim_high <= 1.0))
        fault = "trim_high must be above trim_low, up to 1";
    if (!fault && !(c->night_ev >= -256.0 && c->night_ev <= c->day_ev))
        fault = "night_ev must be from -256 to day_ev";
    return fault;
}

static const char *fault_of_exposure(const pupil_sensor_config *c)
{
    if (!(c->exposure_min_s >= 1e-9 && c->exposure_min_s <= c->exposure_max_s))
        return "exposure_min_s must be from 1e-9 to exposure_max_s";
    if (c->frame_rate_priority && c->exposure_min_s > c->frame_s)
        return "exposure_min_s must be at most frame_s with frame_rate_priority";
    if (c->mains_hz > PUPIL_SENSOR_MAINS_AUTO && c->mains_hz != 50 && c->mains_hz != 60)
        return "mains_hz must be 50, 60, 0 or PUPIL_SENSOR_MAINS_AUTO";
    if (c->exposure_mode == PUPIL_SENSOR_MANUAL && !(c->manual_exposure_s >= 1e-9 && c->manual_exposure_s <= 1e4))
        return "manual_exposure_s must be from 1e-9 to 1e4 with PUPIL_SENSOR_MANUAL";
    for (uint32_t i = 0; i < c->exposure_count; i++)
        if (!(c->exposure_table[i] >= (i ? c->exposure_table[i - 1] : 1e-9) && c->exposure_table[i] <= 1e4))
            return "exposure_table must be from 1e-9 to 1e4 s, and must not fall";
    return 0;
}

static const char *fault_of_gain(const pupil_sensor_config *c)
{
    if (!(c->gain_min >= 0x1p-10 && c->gain_min <= c->gain_max))
        return "gain_min must be from 2^-10 to gain_max";
    if (c->gain_mode == PUPIL_SENSOR_MANUAL && !(c->manual_gain >= 0x1p-10 && c->manual_gain <= 65536.0))
        return "manual_gain must be from 2^-10 to 65536 with PUPIL_SENSOR_MANUAL";
    if ((c->gain_law == PUPIL_GAIN_LINEAR || c->gain_law == PUPIL_GAIN_DB) &&
        !(c->gain_step >= 1e-6 && c->gain_step <= 64.0))
        return "gain_step must be from 1e-6 to 64 with this gain_law";
    if (c->gain_law == PUPIL_GAIN_RECIPROCAL && !(c->gain_step >= 2.0 && c->gain_step <= 65536.0))
        return "gain_step must be from 2 to 65536 with PUPIL_GAIN_RECIPROCAL: 256 for 256 / (256 - n)";
    return 0;
}

static const char *fault_of_gain_table(const pupil_sensor_config *c)
{
    if (c->gain_law != PUPIL_GAIN_TABLE)
        return 0;
    if (!(c->gain_count >= 1 && c->gain_count <= PUPIL_SENSOR_GAIN_TABLE))
        return "gain_count must be from 1 to 64 with PUPIL_GAIN_TABLE";
    for (uint32_t i = 0; i < c->gain_count; i++)
        if (!(c->gain_table[i] >= (i ? c->gain_table[i - 1] : 0x1p-10) && c->gain_table[i] <= 65536.0))
            return "gain_table must be from 2^-10 to 65536, and must not fall";
    return 0;
}

static const char *fault_of_stages(const pupil_sensor_config *c)
{
    for (uint32_t i = 0; i < c->stages; i++)
        if (!(c->stage[i].exposure_s >= (i ? c->stage[i - 1].exposure_s : 1e-9) && c->stage[i].exposure_s <= 1e4 &&
              c->stage[i].gain >= (i ? c->stage[i - 1].gain : 0x1p-10) && c->stage[i].gain <= 65536.0))
            return "stage must have exposures from 1e-9 to 1e4 s and gains from 2^-10 to 65536, neither of which falls";
    return 0;
}

/* Checks the caller's own struct, because a copy is too large for the stack of one function (1 KiB). It has all fields
 * of the first release. A field that was added later may be read only where c->size_bytes covers it. */
int pupil_sensor_config_check(const pupil_sensor_config *config, const char **why)
{
    static const char *(*const rules[])(const pupil_sensor_config *) = {
        fault_of_ranges, fault_of_light, fault_of_exposure, fault_of_gain, fault_of_gain_table, fault_of_stages,
    };
    if (!config)
        return PUPIL_ERR_NULL;
    const char *fault = pupil_versioned_fault(config, config->size_bytes, sizeof *config, FIRST_BYTES);
    for (size_t i = 0; !fault && i < sizeof rules / sizeof *rules; i++)
        fault = rules[i](config);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

double pupil_sensor_longest_exposure(const pupil_sensor_config *c)
{
    return c->frame_rate_priority ? smaller(c->frame_s, c->exposure_max_s) : c->exposure_max_s;
}

#include "sensor_private.h"

#include "base/numeric.h"
#include "base/versioned.h"

#define FIRST_BYTES PUPIL_FIRST_BYTES(pupil_sensor_config, exposure_table)

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
    .digital_ev = 1.5, /* from one half mains period to two, one control ahead of the other, and what is rounded */
    .frame_s = 1.0 / 30.0,
    .exposure_min_s = 1e-4,
    .exposure_max_s = 1.0 / 30.0,
    .frame_rate_priority = 1,
    .mains_hz = PUPIL_SENSOR_MAINS_AUTO,
    .gain_min = 1.0,
    .gain_max = 16.0,
    .gain_step = 1.0 / 16.0,
    .flash_frames = 2, /* what a strobe or a lightning lights: one frame, or parts of two */
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

#define MUST(be_so, sentence)                                                                                          \
    if (!(be_so)) /* NaN is not */                                                                                     \
    return sentence

#define WITHIN(field, least, most)                                                                                     \
    MUST((double)c->field >= (least) && (double)c->field <= (most), #field " must be from " #least " to " #most)

static const char *fault_of_laws(const pupil_sensor_config *c)
{
    WITHIN(gain_law, 0, 4);
    if ((c->gain_law == PUPIL_GAIN_LINEAR || c->gain_law == PUPIL_GAIN_DB) &&
        !(c->gain_step >= 1e-6 && c->gain_step <= 64.0))
        return "gain_step must be from 1e-6 to 64 with this gain_law";
    if (c->gain_law == PUPIL_GAIN_RECIPROCAL && !(c->gain_step >= 2.0 && c->gain_step <= 65536.0))
        return "gain_step must be from 2 to 65536 with PUPIL_GAIN_RECIPROCAL: 256 for 256 / (256 - n)";
    if (c->gain_law == PUPIL_GAIN_TABLE && !(c->gain_count >= 1 && c->gain_count <= PUPIL_SENSOR_GAIN_TABLE))
        return "gain_count must be from 1 to 64 with PUPIL_GAIN_TABLE";
    for (uint32_t i = 0; c->gain_law == PUPIL_GAIN_TABLE && i < c->gain_count; i++)
        if (!(c->gain_table[i] >= (i ? c->gain_table[i - 1] : 0x1p-10) && c->gain_table[i] <= 65536.0))
            return "gain_table must rise, from 2^-10 to 65536";
    WITHIN(stages, 0, 8);
    for (uint32_t i = 0; i < c->stages; i++)
        if (!(c->stage[i].exposure_s >= (i ? c->stage[i - 1].exposure_s : 1e-9) && c->stage[i].exposure_s <= 1e4 &&
              c->stage[i].gain >= (i ? c->stage[i - 1].gain : 0x1p-10) && c->stage[i].gain <= 65536.0))
            return "stage must have exposures from 1e-9 to 1e4 s and gains from 2^-10 to 65536, neither of which falls";
    WITHIN(exposure_mode, 0, 2);
    WITHIN(gain_mode, 0, 2);
    if (c->exposure_mode == PUPIL_SENSOR_MANUAL)
        WITHIN(manual_exposure_s, 1e-9, 1e4);
    if (c->gain_mode == PUPIL_SENSOR_MANUAL)
        WITHIN(manual_gain, 0.0009765625, 65536);
    return 0;
}

/* Of the caller's own struct, because a copy of it is too large for the stack of one function (1 KiB). It has all
 * fields of the first release. A field that was added later may be looked at only where c->size_bytes covers it. */
static const char *fault_of(const pupil_sensor_config *c)
{
    WITHIN(delay_frames, 1, 16);
    WITHIN(key, 0.0009765625, 1);
    WITHIN(ev_compensation, -16, 16);
    WITHIN(key_points, 0, 8);
    WITHIN(reserved, 0, 0);
    for (const pupil_sensor_key_point *p = c->key_at; p < c->key_at + c->key_points; p++)
        if (!(p->scene_ev >= -256.0 && p->scene_ev <= 256.0 && p->key >= 0x1p-10 && p->key <= 1.0) ||
            (p > c->key_at && !(p->scene_ev > p[-1].scene_ev && p->key >= p[-1].key && /* a stop for two, or rounded */
                                pupil_log2(p->key / p[-1].key) <= 0.5 * (p->scene_ev - p[-1].scene_ev) + 1e-9)))
            return "key_at must rise: scene_ev in -256..256, key in 2^-10..1 by at most a stop for two of light";
    WITHIN(clip, 0.0000152587890625, 65536);
    WITHIN(trim_low, 0, 1);
    MUST(c->trim_high > c->trim_low && c->trim_high <= 1.0, "trim_high must be above trim_low, up to 1");
    WITHIN(highlight_share, 0.001, 1);
    WITHIN(highlight_ev, 0, 8);
    WITHIN(far_ev, 0.02, 2);
    WITHIN(tau_s, 0, 1e6);
    WITHIN(hold_ev, 0, 0.5);
    WITHIN(digital_ev, 0, 8);
    WITHIN(frame_s, 1e-6, 1e6);
    WITHIN(exposure_max_s, 1e-9, 1e4);
    if (!(c->exposure_min_s >= 1e-9 && c->exposure_min_s <= c->exposure_max_s))
        return "exposure_min_s must be from 1e-9 to exposure_max_s";
    WITHIN(exposure_step_s, 0, 1);
    WITHIN(frame_rate_priority, 0, 1);
    if (c->frame_rate_priority && c->exposure_min_s > c->frame_s)
        return "exposure_min_s must be at most frame_s with frame_rate_priority";
    if (c->mains_hz > PUPIL_SENSOR_MAINS_AUTO && c->mains_hz != 50 && c->mains_hz != 60)
        return "mains_hz must be 50, 60, 0 or PUPIL_SENSOR_MAINS_AUTO";
    WITHIN(gain_max, 0.0009765625, 65536);
    MUST(c->gain_min >= 0x1p-10 && c->gain_min <= c->gain_max, "gain_min must be from 2^-10 to gain_max");
    WITHIN(lock, 0, 1);
    WITHIN(flash_frames, 0, 8);
    WITHIN(linear, 0, 1);
    return fault_of_laws(c);
}

static const char *fault_of_table(const pupil_sensor_config *c)
{
    WITHIN(reserved_too, 0, 0);
    WITHIN(exposure_count, 0, 64);
    for (uint32_t i = 0; i < c->exposure_count; i++)
        if (!(c->exposure_table[i] >= (i ? c->exposure_table[i - 1] : 1e-9) && c->exposure_table[i] <= 1e4))
            return "exposure_table must rise, from 1e-9 to 1e4 s";
    return 0;
}

int pupil_sensor_config_check(const pupil_sensor_config *config, const char **why)
{
    if (!config)
        return PUPIL_ERR_NULL;
    const char *fault = pupil_versioned_fault(config, config->size_bytes, sizeof *config, FIRST_BYTES);
    if (!fault)
        fault = fault_of(config);
    if (!fault)
        fault = fault_of_table(config);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

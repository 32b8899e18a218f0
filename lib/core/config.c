#include "object.h"

#include "base/fault.h"
#include "base/key.h"
#include "base/numeric.h"
#include "base/versioned.h"

#define FIRST_BYTES PUPIL_FIRST_BYTES(pupil_config, accuracy)

static void fill_in_defaults(pupil_config *config)
{
    static const pupil_config defaults = {
        .primaries = PUPIL_PRIMARIES_BT709,
        .floor = 0x1p-14f, /* the smallest normal half; a fifth of the first 8-bit sRGB code */
        .trim_high = 1.0f,
        .law = PUPIL_LAW_SECONDS,
        .eye_unit_cd_m2 = 100.0, /* image.h, PUPIL_LIGHT_PQ */
        .frame_weight = 0.05,
        .tau_light_s = 0.3, /* the eye, too, is faster toward the light */
        .tau_dark_s = 0.9,
        .nominal_frame_s = 1.0 / 30.0,
        .flicker = 1,
        .ev_min = -32.0,
        .ev_max = 32.0,
        .calibration = 1.0,
        .key = 0.18, /* Reinhard et al. 2002, section 2.1 */
        .white = 1.0,
        .white_quantile = 0.995,
        .highlight_share = 0.05,
        .highlight_room_ev = 4.0,
        .highlight_ev = 2.0,
        .amplification_ev = 4.0,
        .curve_levels = 8,
        .curve_share = 0.005,
        .curve_ceiling = 1.0,
        .curve_range_ev = 8.0,
    };
    *config = defaults;
    (void)pupil_metering_uniform(config);
}

void pupil_config_default_sized(pupil_config *config, size_t config_bytes)
{
    pupil_config defaults;
    fill_in_defaults(&defaults);
    if (config)
        (void)pupil_versioned_write(config, config_bytes, &defaults, sizeof defaults);
}

const char *pupil_config_read(pupil_config *ours, const pupil_config *theirs)
{
    fill_in_defaults(ours);
    return pupil_versioned_read(ours, sizeof *ours, FIRST_BYTES, theirs, theirs->size_bytes);
}

/* Whether rgb_to_xyz is a whole matrix. Scaled to a luminance of 1, the determinant is 0.2 for BT.709 and 0.7 for ACES
 * AP0; of a luminance row alone it is 0. */
static int leads_to_xyz(const pupil_config *c, double sum)
{
    double m[9];
    for (int i = 0; i < 9; i++)
        m[i] = (double)c->rgb_to_xyz[i];
    const double determinant =
        m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
    const double scaled = determinant / (sum * sum * sum);
    return scaled > 1e-6 || scaled < -1e-6;
}

static const char *primaries_fault(const pupil_config *c)
{
    float sum = 0.0f;
    if (c->primaries > PUPIL_PRIMARIES_MATRIX)
        return "primaries must be a pupil_primaries";
    if (c->primaries != PUPIL_PRIMARIES_MATRIX)
        return 0;
    for (int i = 3; i < 6; i++) {
        if (!within((double)c->rgb_to_xyz[i], 0.0, 1e6))
            return "rgb_to_xyz[3..5], luminance, must be from 0 to 1e6";
        sum += c->rgb_to_xyz[i];
    }
    for (int i = 0; i < 9 && c->output_primaries != PUPIL_OUTPUT_AS_INPUT; i++)
        if (!within((double)c->rgb_to_xyz[i], -1e6, 1e6))
            return "rgb_to_xyz must be numbers from -1e6 to 1e6 where output_primaries names others than the input's";
    if (!(sum > 1e-6f))
        return "rgb_to_xyz[3..5], the luminance row, must have a sum above 1e-6";
    if (c->output_primaries != PUPIL_OUTPUT_AS_INPUT && !leads_to_xyz(c, (double)sum))
        return "rgb_to_xyz must have all three rows, and a determinant other than 0, where output_primaries is not "
               "PUPIL_OUTPUT_AS_INPUT";
    return 0;
}

static const char *weight_fault(const pupil_config *c)
{
    for (int i = 0; i < PUPIL_GRID_SIDE * PUPIL_GRID_SIDE; i++)
        if (c->weight[i / PUPIL_GRID_SIDE][i % PUPIL_GRID_SIDE])
            return 0;
    return "weight must be above 0 in at least one cell";
}

static const char *metering_fault(const pupil_config *c)
{
    const pupil_rule rules[] = {
        {within((double)c->floor, 0x1p-30, 1.0), "floor must be from 2^-30 to 1"},
        {c->clip >= 0.0f, "clip must be 0 (the format's largest value) or a positive number"},
        {within((double)c->trim_low, 0.0, 1.0), "trim_low must be from 0 to 1"},
        {within((double)c->trim_high, 0.0, 1.0) && c->trim_high > c->trim_low,
         "trim_high must be above trim_low, up to 1"},
        {c->histogram <= 1, "histogram must be 0 or 1"},
        {c->meter_rows <= 8 && !(c->meter_rows & (c->meter_rows - 1)), "meter_rows must be 0, 1, 2, 4 or 8"},
        {c->histogram_step <= 8 && !(c->histogram_step & (c->histogram_step - 1)),
         "histogram_step must be 0, 1, 2, 4 or 8"},
        {c->grey_world <= 1, "grey_world must be 0 or 1"},
        {c->accuracy < PUPIL_ACCURACY_COUNT, "accuracy must be a pupil_accuracy"},
        {c->dither <= 1, "dither must be 0 or 1"},
    };
    const char *fault = primaries_fault(c);
    if (!fault)
        fault = first_fault(rules, sizeof rules / sizeof rules[0]);
    if (!fault)
        fault = weight_fault(c);
    return fault;
}

static __attribute__((noinline)) const char *adaptation_fault(const pupil_config *c)
{
    const pupil_rule rules[] = {
        {c->law < PUPIL_LAW_COUNT, "law must be a pupil_law"},
        {c->lock <= 1, "lock must be 0 or 1"},
        {c->flicker <= 1, "flicker must be 0 or 1"},
        {c->key_points <= PUPIL_KEY_POINTS, "key_points must be from 0 to 8"},
        {c->frame_weight > 0.0 && c->frame_weight <= 1.0, "frame_weight must be above 0, up to 1"},
        {within(c->tau_light_s, 0.0, 1e6), "tau_light_s must be from 0 to 1e6 seconds"},
        {within(c->tau_dark_s, 0.0, 1e6), "tau_dark_s must be from 0 to 1e6 seconds"},
        {c->nominal_frame_s > 0.0 && c->nominal_frame_s <= 1e6, "nominal_frame_s must be above 0, up to 1e6 seconds"},
        {within(c->ev_min, -64.0, 64.0), "ev_min must be from -64 to 64"},
        {within(c->ev_max, -64.0, 64.0) && c->ev_max >= c->ev_min, "ev_max must be from ev_min to 64"},
        {within(c->calibration, 0x1p-64, 0x1p64), "calibration must be above 0 (from 2^-64 to 2^64)"},
        {within(c->key, 0x1p-10, 1.0), "key must be from 2^-10 to 1"},
        {within(c->ev_compensation, -16.0, 16.0), "ev_compensation must be from -16 to 16 stops"},
        {within(c->highlight_share, 0.001, 0.5), "highlight_share must be from 0.001 to 0.5"},
        {within(c->highlight_room_ev, 0.0, 32.0), "highlight_room_ev must be from 0 to 32 stops"},
        {within(c->highlight_ev, 0.0, 8.0), "highlight_ev must be from 0 to 8 stops"},
        {within(c->amplification_ev, 0.0, 32.0), "amplification_ev must be from 0 to 32 stops"},
        {within(c->eye_unit_cd_m2, 1e-6, 1e9), "eye_unit_cd_m2 must be from 1e-6 to 1e9 cd/m2"},
    };
    const char *fault = first_fault(rules, sizeof rules / sizeof rules[0]);
    return fault ? fault : pupil_key_fault(c->key_at, c->key_points);
}

static const char *mapping_fault(const pupil_config *c)
{
    const pupil_rule rules[] = {
        {c->order < PUPIL_ORDER_COUNT, "order must be a pupil_order"},
        {c->white_mode < PUPIL_WHITE_COUNT, "white_mode must be a pupil_white"},
        {within(c->white, 0x1p-8, 0x1p30), "white must be from 2^-8 to 2^30"},
        {within(c->white_quantile, 0.5, 1.0), "white_quantile must be from 0.5 to 1"},
        {c->output_primaries < PUPIL_OUTPUT_COUNT, "output_primaries must be a pupil_output_primaries"},
        {c->transfer < PUPIL_TRANSFER_COUNT, "transfer must be a pupil_transfer"},
        {!(c->levels >> PUPIL_LEVEL_COUNT), "levels must be 0 or a mask of 1 << pupil_level"},
        {c->curve < PUPIL_CURVE_COUNT, "curve must be a pupil_curve_kind"},
        {c->curve_levels >= 2 && c->curve_levels <= 256, "curve_levels must be from 2 to 256"},
        {within(c->curve_share, 0.0, 0.25), "curve_share must be from 0 to 0.25"},
        {within(c->curve_ceiling, 1.0, 4.0), "curve_ceiling must be from 1 to 4"},
        {within(c->curve_range_ev, 2.0, 16.0), "curve_range_ev must be from 2 to 16 stops"},
    };
    return first_fault(rules, sizeof rules / sizeof rules[0]);
}

int pupil_config_check(const pupil_config *config, const char **why)
{
    pupil_config own;
    if (!config)
        return PUPIL_ERR_NULL;
    const char *fault = pupil_config_read(&own, config);
    if (!fault)
        fault = metering_fault(&own);
    if (!fault)
        fault = adaptation_fault(&own);
    if (!fault)
        fault = mapping_fault(&own);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

double pupil_scale_log2(const pupil_config *c, double adapted_ev)
{
    return pupil_key_log2(c->key, c->key_at, c->key_points, adapted_ev) + c->ev_compensation - adapted_ev;
}

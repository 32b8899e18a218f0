#include "object.h"

#include "numeric.h"

void pupil_config_default(pupil_config *config)
{
    static const pupil_config defaults = {
        .size_bytes = sizeof(pupil_config),
        .primaries = PUPIL_PRIMARIES_BT709,
        .floor = 0x1p-14f, /* the smallest normal half; a fifth of the first 8-bit sRGB code */
        .trim_high = 1.0f,
        .law = PUPIL_LAW_SECONDS,
        .frame_weight = 0.05,
        .tau_light_s = 0.3, /* the eye, too, is faster toward the light */
        .tau_dark_s = 0.9,
        .nominal_frame_s = 1.0 / 30.0,
        .beat = 1,
        .ev_min = -32.0,
        .ev_max = 32.0,
        .calibration = 1.0,
        .key = 0.18, /* Reinhard et al. 2002, section 2.1 */
        .white = 1.0,
        .white_quantile = 0.995,
    };
    if (config) {
        *config = defaults;
        pupil_metering_uniform(config);
    }
}

static int within(double x, double low, double high)
{
    return x >= low && x <= high; /* false for NaN */
}

static const char *metering_fault(const pupil_config *c)
{
    if (c->primaries > PUPIL_PRIMARIES_MATRIX)
        return "primaries must be a pupil_primaries";
    if (c->primaries == PUPIL_PRIMARIES_MATRIX) {
        float sum = 0.0f;
        for (int i = 3; i < 6; i++) {
            if (!within((double)c->rgb_to_xyz[i], 0.0, 1e6))
                return "rgb_to_xyz[3..5], the luminance row, must be numbers from 0 to 1e6";
            sum += c->rgb_to_xyz[i];
        }
        if (!(sum > 1e-6f))
            return "rgb_to_xyz[3..5], the luminance row, must have a sum above 1e-6";
    }
    if (!within((double)c->floor, 0x1p-30, 1.0))
        return "floor must be from 2^-30 to 1";
    if (!(c->clip >= 0.0f))
        return "clip must be 0 (the format's largest value) or a positive number";
    if (!within((double)c->trim_low, 0.0, 1.0))
        return "trim_low must be from 0 to 1";
    if (!within((double)c->trim_high, 0.0, 1.0) || !(c->trim_high > c->trim_low))
        return "trim_high must be above trim_low, up to 1";
    if (c->histogram > 1)
        return "histogram must be 0 or 1";
    if (c->meter_rows > 8 || (c->meter_rows & (c->meter_rows - 1)))
        return "meter_rows must be 0, 1, 2, 4 or 8";
    if (c->grey_world > 1)
        return "grey_world must be 0 or 1";
    for (int i = 0; i < PUPIL_GRID_SIDE * PUPIL_GRID_SIDE; i++)
        if (c->weight[i / PUPIL_GRID_SIDE][i % PUPIL_GRID_SIDE])
            return 0;
    return "weight must be above 0 in at least one cell";
}

static const char *adaptation_fault(const pupil_config *c)
{
    if (c->law >= PUPIL_LAW_COUNT)
        return "law must be a pupil_law";
    if (c->lock > 1)
        return "lock must be 0 or 1";
    if (c->beat > 1)
        return "beat must be 0 or 1";
    if (!(c->frame_weight > 0.0 && c->frame_weight <= 1.0))
        return "frame_weight must be above 0, up to 1";
    if (!within(c->tau_light_s, 0.0, 1e6))
        return "tau_light_s must be from 0 to 1e6 seconds";
    if (!within(c->tau_dark_s, 0.0, 1e6))
        return "tau_dark_s must be from 0 to 1e6 seconds";
    if (!(c->nominal_frame_s > 0.0 && c->nominal_frame_s <= 1e6))
        return "nominal_frame_s must be above 0, up to 1e6 seconds";
    if (!within(c->ev_min, -64.0, 64.0))
        return "ev_min must be from -64 to 64";
    if (!within(c->ev_max, -64.0, 64.0) || c->ev_max < c->ev_min)
        return "ev_max must be from ev_min to 64";
    if (!within(c->calibration, 0x1p-64, 0x1p64))
        return "calibration must be above 0 (from 2^-64 to 2^64)";
    if (!within(c->key, 0x1p-10, 1.0))
        return "key must be from 2^-10 to 1";
    if (!within(c->ev_compensation, -16.0, 16.0))
        return "ev_compensation must be from -16 to 16 stops";
    return 0;
}

static const char *mapping_fault(const pupil_config *c)
{
    if (c->order >= PUPIL_ORDER_COUNT)
        return "order must be a pupil_order";
    if (c->white_mode >= PUPIL_WHITE_COUNT)
        return "white_mode must be a pupil_white";
    if (!within(c->white, 0x1p-8, 0x1p30))
        return "white must be from 2^-8 to 2^30";
    if (!within(c->white_quantile, 0.5, 1.0))
        return "white_quantile must be from 0.5 to 1";
    if (c->transfer >= PUPIL_TRANSFER_COUNT)
        return "transfer must be a pupil_transfer";
    if (c->levels >> PUPIL_LEVEL_COUNT)
        return "levels must be 0 or a mask of 1 << pupil_level";
    return 0;
}

int pupil_config_check(const pupil_config *config, const char **why)
{
    const char *fault = 0;
    if (!config)
        return PUPIL_ERR_NULL;
    if (config->size_bytes != sizeof(pupil_config))
        fault = "size_bytes must be sizeof(pupil_config) of this version: begin with pupil_config_default";
    if (!fault)
        fault = metering_fault(config);
    if (!fault)
        fault = adaptation_fault(config);
    if (!fault)
        fault = mapping_fault(config);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

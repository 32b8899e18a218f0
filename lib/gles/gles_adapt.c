/* ADAPT_GPU: the inputs of the shaders' integer law (shaders/adapt.glsl) for each frame. */
#include "gles_private.h"

#include "base/numeric.h"

/* 64 bits of 2^-56 stops end at 128. Frames hold 2^-30 to 2^30, and ev_min and ev_max are 64 at most: with any divisor
 * beyond 96 the target is one of them. So it is clamped to 96. */
#define MOST_STOPS 96.0
/* 32 bits of 2^-24 stops end at 128, too. A curve's scale ends 60 stops from 1 (lib/core/curve.c), which 124 reach from
 * every level. */
#define MOST_BASE_STOPS 124.0
#define OFFSET_STOPS    32.0 /* as in the shaders */

int pupil_gles_adapt_check(const pupil_config *c, pupil_why *why)
{
    const char *fault = 0;
    if (c->law != PUPIL_LAW_SECONDS)
        fault = "on the GPU the law must be PUPIL_LAW_SECONDS";
    else if (c->white_mode == PUPIL_WHITE_FOLLOW)
        fault = "on the GPU white_mode must be PUPIL_WHITE_FIXED or PUPIL_WHITE_NONE";
    else if (c->trim_low > 0.0f || c->trim_high < 1.0f)
        fault = "on the GPU trim_low and trim_high must be 0 and 1";
    else if (c->curve != PUPIL_CURVE_REINHARD)
        fault = "on the GPU curve must be PUPIL_CURVE_REINHARD";
    else if (c->key_points)
        fault = "on the GPU key_points must be 0";
    else if (c->histogram && c->highlight_ev > 0.0)
        fault = "on the GPU highlight_ev must be 0, or histogram must be";
    if (fault)
        pupil_gles_say(why, (const char *const[]){fault, 0});
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

void pupil_gles_adapt_take(gles_object *o, const pupil_object *pupil)
{
    o->adaptation = pupil->adaptation;
    o->given = 1;
}

static double within(double x, double most) /* -most..most */
{
    return x < -most ? -most : x > most ? most : x;
}

/* Stops in 2^-56. */
static int64_t q56(double stops)
{
    return pupil_level_of(within(stops, MOST_STOPS)) * 16;
}

static uint32_t low(int64_t q)
{
    return (uint32_t)((uint64_t)q & 0xffffffff);
}

static uint32_t high(int64_t q)
{
    return (uint32_t)((uint64_t)q >> 32);
}

/* In 2^-32. All bits: at once. The rounding error goes to the next frame, or a tau of hours would change. */
static uint32_t weight_q32(const pupil_config *c, double dt_s, int more_light, double *rest)
{
    const double w = pupil_weight_of_step(c, dt_s, more_light) * 0x1p32 + *rest;
    const int at_once = w >= 0x1p32 - 1.0;
    const uint32_t rounded = at_once ? 0xffffffffu : w < 0.5 ? 0 : (uint32_t)(w + 0.5);
    *rest = at_once ? 0.0 : w - rounded;
    return rounded;
}

/* By how much sums of weights times log2 must be shifted: 62 stops in 2^-24 take 30 bits of 64. */
static uint32_t sum_shift(const gles_object *o)
{
    const uint64_t pixels = (uint64_t)o->config.width * o->config.height;
    uint32_t shift = 0;
    while ((pixels * 255) >> (33 + shift))
        shift++;
    return shift;
}

/* Of all pixels: below 2^36. */
static uint64_t sum_of_weights(const gles_object *o)
{
    const uint32_t units_x = o->config.width / o->unit, units_y = o->config.height / o->unit;
    uint64_t sum = 0;
    for (uint32_t y = 0; y < PUPIL_GRID_SIDE; y++)
        for (uint32_t x = 0; x < PUPIL_GRID_SIDE; x++) {
            const uint32_t width = pupil_grid_first_in_cell(x + 1, units_x) - pupil_grid_first_in_cell(x, units_x);
            const uint32_t height = pupil_grid_first_in_cell(y + 1, units_y) - pupil_grid_first_in_cell(y, units_y);
            sum += (uint64_t)width * height * o->settings.weight[y][x];
        }
    return sum;
}

void pupil_gles_adapt_set(const gles_object *o, GLuint program)
{
    const gl_functions *gl = &o->gl;
    const double black_log2 = pupil_log2((double)o->settings.floor);
    gl->Uniform1ui(gl->GetUniformLocation(program, "sum_shift"), sum_shift(o));
    gl->Uniform1i(gl->GetUniformLocation(program, "is_locked"), o->settings.lock != 0);
    gl->Uniform1i(gl->GetUniformLocation(program, "is_black_left_out"), !(o->code_light > 0.0f));
    gl->Uniform1ui(gl->GetUniformLocation(program, "black_log2"), (uint32_t)((black_log2 + OFFSET_STOPS) * 0x1p24));
    gl->Uniform1ui(gl->GetUniformLocation(program, "least_light"), (uint32_t)pupil_least_light(sum_of_weights(o)));
}

void pupil_gles_adapt_step(gles_object *o, const pupil_frame_info *info)
{
    const pupil_config *c = &o->settings;
    pupil_adaptation *a = &o->adaptation;
    double dt_s = pupil_adaptation_tick(c, a, info);
    dt_s = dt_s > 0.0 ? dt_s : 0.0;
    pupil_adaptation_learn_exposure(a, info);
    const double divisor_log2 = pupil_exposure_log2(c, a, info);
    const int64_t divisor = -q56(divisor_log2), given = q56(a->result.adapted_ev);
    const double least_ev = pupil_least_level_log2(c, o->code_light) - divisor_log2;
    const int64_t least = q56(least_ev > c->ev_min ? least_ev : c->ev_min), most = q56(c->ev_max);
    o->gl.Uniform4ui(o->programs.adapt.level_limits, low(least), high(least), low(most), high(most));
    o->gl.Uniform2ui(o->programs.adapt.minus_divisor, low(divisor), high(divisor));
    const uint32_t light = weight_q32(c, dt_s, 1, &o->weight_rest[0]);
    o->gl.Uniform2ui(o->programs.adapt.step_weight, light, weight_q32(c, dt_s, 0, &o->weight_rest[1]));
    o->gl.Uniform4ui(o->programs.adapt.given, low(given), high(given), a->seen != 0, o->given);
    o->given = 0;
}

int32_t pupil_gles_adapt_scale_base(const gles_object *o)
{
    const pupil_config *c = &o->settings;
    const double base = within(pupil_log2(c->key) + c->ev_compensation - o->exposure_log2, MOST_BASE_STOPS) * 0x1p24;
    return (int32_t)(base < 0.0 ? base - 0.5 : base + 0.5);
}

/* Mapping: where the picture is in its target, and the draw. */
#include "gles_private.h"

typedef struct rectangle {
    int32_t x, y, width, height; /* y from the framebuffer's first row */
} rectangle;

/* From a place (u, v) in the picture as it is shown to a place in the picture as it is mapped. x = xu u + xv v, counted
 * from the picture's far edge where the factor is -1; the same for y. */
typedef struct turning {
    int8_t xu, xv, yu, yv;
} turning;

static const turning turnings[PUPIL_GLES_ORIENTATION_COUNT] = {
    [PUPIL_GLES_UPRIGHT] = {1, 0, 0, 1},       [PUPIL_GLES_MIRRORED] = {-1, 0, 0, 1},
    [PUPIL_GLES_ROTATED_180] = {-1, 0, 0, -1}, [PUPIL_GLES_FLIPPED] = {1, 0, 0, -1},
    [PUPIL_GLES_TRANSPOSED] = {0, 1, 1, 0},    [PUPIL_GLES_ROTATED_90] = {0, 1, -1, 0},
    [PUPIL_GLES_TRANSVERSED] = {0, -1, -1, 0}, [PUPIL_GLES_ROTATED_270] = {0, -1, 1, 0},
};

typedef struct picture {
    uint32_t width, height;             /* as it is mapped */
    uint32_t shown_width, shown_height; /* as it is turned */
} picture;

static picture picture_of(const gles_object *o, uint32_t orientation)
{
    const uint32_t halved = o->config.half_size ? 2 : 1;
    picture p = {.width = o->config.width / halved, .height = o->config.height / halved};
    p.shown_width = orientation >= PUPIL_GLES_TRANSPOSED ? p.height : p.width;
    p.shown_height = orientation >= PUPIL_GLES_TRANSPOSED ? p.width : p.height;
    return p;
}

/* Where all of the picture would be drawn, in the middle of the target; may be larger than the target. */
static rectangle place(const pupil_gles_target *t, const picture *p)
{
    rectangle all = {t->x, t->y, (int32_t)t->width, (int32_t)t->height};
    const double by_width = (double)t->width / p->shown_width, by_height = (double)t->height / p->shown_height;
    if (t->fit == PUPIL_GLES_STRETCH)
        return all;
    const int narrow = t->fit == PUPIL_GLES_LETTERBOX ? by_width <= by_height : by_width >= by_height;
    const double scale = narrow ? by_width : by_height;
    const int32_t width = (int32_t)(p->shown_width * scale + 0.5), height = (int32_t)(p->shown_height * scale + 0.5);
    all.width = width < 1 ? 1 : width;
    all.height = height < 1 ? 1 : height;
    all.x += ((int32_t)t->width - all.width) / 2;
    all.y += ((int32_t)t->height - all.height) / 2;
    return all;
}

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static rectangle common(rectangle a, rectangle b)
{
    const int32_t x = larger(a.x, b.x), y = larger(a.y, b.y);
    return (rectangle){x, y, larger(smaller(a.x + a.width, b.x + b.width) - x, 0),
                       larger(smaller(a.y + a.height, b.y + b.height) - y, 0)};
}

/* The part of the target that is to be drawn. */
static rectangle part_of(const pupil_gles_target *t)
{
    const float to = t->from == 0.0f && t->to == 0.0f ? 1.0f : t->to;
    const int32_t first = (int32_t)(t->from * (float)t->width + 0.5f), end = (int32_t)(to * (float)t->width + 0.5f);
    return (rectangle){t->x + first, t->y, end - first, (int32_t)t->height};
}

static int check_target(const gles_object *o, const pupil_gles_target *t)
{
    if (!t->width || !t->height || t->width > PUPIL_MAX_SIDE_PX || t->height > PUPIL_MAX_SIDE_PX)
        return PUPIL_ERR_SIZE;
    const int32_t far_off = 1 << 24;
    if (t->orientation >= PUPIL_GLES_ORIENTATION_COUNT || t->fit >= PUPIL_GLES_FIT_COUNT || t->x < -far_off ||
        t->x > far_off || t->y < -far_off || t->y > far_off)
        return PUPIL_ERR_VALUE;
    if (!(t->from >= 0.0f && t->to <= 1.0f && t->from <= t->to))
        return PUPIL_ERR_VALUE;
    const picture p = picture_of(o, t->orientation);
    return o->config.scaled || (t->width == p.shown_width && t->height == p.shown_height) ? PUPIL_OK : PUPIL_ERR_SIZE;
}

int pupil_gles_target_read(const gles_object *o, pupil_gles_target *ours, const pupil_gles_target *theirs)
{
    const size_t first_bytes = PUPIL_FIRST_BYTES(pupil_gles_target, to);
    *ours = (pupil_gles_target){0};
    if (!theirs)
        return PUPIL_ERR_NULL;
    const size_t size_bytes = theirs->size_bytes ? theirs->size_bytes : first_bytes;
    if (pupil_versioned_read(ours, sizeof *ours, first_bytes, theirs, size_bytes))
        return PUPIL_ERR_SIZE_BYTES;
    return check_target(o, ours);
}

/* From pixels of the framebuffer to pixels of the picture, without scaling. */
static void set_turn(const gles_object *o, const pupil_gles_target *t, const picture *p, rectangle r)
{
    const turning by = turnings[t->orientation];
    const int32_t v_sign = t->top_first ? 1 : -1;
    /* u = fx - r.x, v = fy - r.y, or from the top: r.y + r.height - 1 - fy */
    const int32_t u0 = -r.x, v0 = t->top_first ? -r.y : r.y + r.height - 1;
    const int32_t x0 = by.xu * u0 + by.xv * v0 + (by.xu + by.xv < 0 ? (int32_t)p->width - 1 : 0);
    const int32_t y0 = by.yu * u0 + by.yv * v0 + (by.yu + by.yv < 0 ? (int32_t)p->height - 1 : 0);
    o->gl.Uniform4i(o->programs.map[0].turn, by.xu, by.xv * v_sign, by.yu, by.yv * v_sign);
    o->gl.Uniform2i(o->programs.map[0].shift, x0, y0);
}

/* The same with scaling, between places: a pixel's middle is at its index and a half. */
static void set_scaled_turn(const gles_object *o, const pupil_gles_target *t, const picture *p, rectangle r)
{
    const turning by = turnings[t->orientation];
    const double u_scale = (double)p->shown_width / r.width, v_scale = (double)p->shown_height / r.height;
    const double v_sign = t->top_first ? v_scale : -v_scale;
    const double u0 = -r.x * u_scale, v0 = (t->top_first ? -r.y : r.y + r.height) * v_scale;
    const double x0 = by.xu * u0 + by.xv * v0 + (by.xu + by.xv < 0 ? p->width : 0);
    const double y0 = by.yu * u0 + by.yv * v0 + (by.yu + by.yv < 0 ? p->height : 0);
    o->gl.Uniform4f(o->programs.map[1].turn, (float)(by.xu * u_scale), (float)(by.xv * v_sign),
                    (float)(by.yu * u_scale), (float)(by.yv * v_sign));
    o->gl.Uniform2f(o->programs.map[1].shift, (float)x0, (float)y0);
}

static void scissor(const gles_object *o, rectangle r)
{
    o->gl.Enable(GL_SCISSOR_TEST);
    o->gl.Scissor(r.x, r.y, r.width, r.height);
}

/* Mixes the rods' share into the matrix to the picture. Does nothing if it was 0 and is 0. */
static void set_rods(gles_object *o, int scaled, float rods)
{
    const int mix = o->has_rods && rods > 0.0f;
    float matrix[9];
    if (!mix && !o->rods_are_mixed[scaled])
        return;
    if (mix)
        pupil_mix_rods(o->has_to_picture ? o->to_picture : 0, o->rods_to_picture, rods, matrix);
    o->rods_are_mixed[scaled] = (uint32_t)mix;
    o->gl.Uniform1i(o->programs.map[scaled].has_to_picture, mix || o->has_to_picture);
    o->gl.UniformMatrix3fv(o->programs.map[scaled].to_picture, 1, GL_TRUE, mix ? matrix : o->to_picture);
}

static void set_curve(gles_object *o, int scaled, const pupil_tone *curve)
{
    if (o->variant.level_here)
        o->gl.Uniform1i(o->programs.map[scaled].scale, pupil_gles_adapt_scale_base(o));
    else
        o->gl.Uniform1f(o->programs.map[scaled].scale, curve->scale);
    o->gl.Uniform1f(o->programs.map[scaled].inverse_white_squared, curve->inverse_white_squared);
    o->gl.Uniform1f(o->programs.map[scaled].gamut, curve->gamut);
    o->gl.Uniform1i(o->programs.map[scaled].dither, (GLint)curve->dither);
    set_rods(o, scaled, curve->rods);
    if (o->config.veil)
        o->gl.Uniform1f(o->programs.map[scaled].direct, o->direct);
    o->gl.Uniform1f(o->programs.map[scaled].knot_scale, curve->knot ? curve->knot_scale : -1.0f);
    if (!curve->knot)
        return;
    o->gl.Uniform1f(o->programs.map[scaled].knot_levels, (float)curve->levels);
    o->gl.Uniform4fv(o->programs.map[scaled].knots, PUPIL_CURVE_KNOTS / 4, curve->knot);
}

static void draw(gles_object *o, const pupil_tone *curve, const pupil_gles_target *t)
{
    const gl_functions *gl = &o->gl;
    const picture p = picture_of(o, t->orientation);
    const rectangle all = {t->x, t->y, (int32_t)t->width, (int32_t)t->height}, r = place(t, &p), part = part_of(t);
    const rectangle drawn = common(r, part), covered = common(r, all);
    const int scaled = (uint32_t)r.width != p.shown_width || (uint32_t)r.height != p.shown_height;

    pupil_gles_begin(o, scaled ? GLES_MAP_SCALED : GLES_MAP);
    gl->BindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
    gl->Viewport(t->x, t->y, (GLsizei)t->width, (GLsizei)t->height);
    scissor(o, part);
    if (covered.width < all.width || covered.height < all.height) {
        gl->ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
        gl->Clear(GL_COLOR_BUFFER_BIT);
    }
    scissor(o, drawn);
    pupil_gles_bind_frame(o);
    if (o->variant.level_here && o->variant.version == PUPIL_GLES_ES31)
        gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, o->state);
    else if (o->variant.level_here)
        pupil_gles_bind(o, GLES_UNIT_STATE, GL_TEXTURE_2D, o->target[GLES_STATE_0 + o->newest_state]);
    set_curve(o, scaled, curve);
    if (scaled)
        set_scaled_turn(o, t, &p, r);
    else
        set_turn(o, t, &p, r);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    pupil_gles_unbind(o);
}

int pupil_gles_map(pupil_gles *gles, const pupil_curve *curve, const pupil_gles_target *target)
{
    pupil_tone by;
    pupil_gles_target to;
    int error = pupil_gles_check(gles);
    if (error)
        return error;
    gles_object *o = gles_object_of(gles);
    if ((curve == 0) != (o->config.adapt == PUPIL_GLES_ADAPT_GPU))
        return curve ? PUPIL_ERR_VALUE : PUPIL_ERR_NULL;
    if (curve)
        error = pupil_curve_read(&by, curve);
    if (!error)
        error = pupil_gles_target_read(o, &to, target);
    if (error)
        return error;
    if (!o->source[0] || (o->config.veil && o->direct < 0.0f))
        return PUPIL_ERR_ORDER;
    draw(o, curve ? &by : &o->curve, &to);
    return pupil_gles_error(o);
}

int pupil_gles_veil(pupil_gles *gles, const float *nodes, float direct)
{
    const int error = gles && nodes ? pupil_gles_check(gles) : PUPIL_ERR_NULL;
    if (error)
        return error;
    gles_object *o = gles_object_of(gles);
    if (!o->config.veil)
        return PUPIL_ERR_ORDER;
    if (!(direct >= 0.0f && direct <= 1.0f)) /* true for NaN */
        return PUPIL_ERR_VALUE;
    o->direct = direct;
    pupil_gles_textures_veil(o, nodes);
    return pupil_gles_error(o);
}

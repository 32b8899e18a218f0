/* From texts to programs, and their uniforms. */
#include "base/pixel.h"
#include "gles_private.h"

static GLuint compile(const gles_object *o, const gles_variant *variant, uint32_t shader, pupil_why *why)
{
    const gl_functions *gl = &o->gl;
    const char *texts[GLES_MOST_TEXTS];
    const uint32_t count = pupil_gles_shader_texts(variant, shader, texts);
    const int is_vertex = shader == GLES_TRIANGLE_VERT || shader == GLES_MAP_VERT || shader == GLES_SCATTER_VERT;
    const int is_compute = shader == GLES_METER_COMP || shader == GLES_ADAPT_COMP;
    GLint done = 0;
    GLuint name = gl->CreateShader(is_vertex ? GL_VERTEX_SHADER : is_compute ? GL_COMPUTE_SHADER : GL_FRAGMENT_SHADER);
    gl->ShaderSource(name, (GLsizei)count, texts, 0);
    gl->CompileShader(name);
    gl->GetShaderiv(name, GL_COMPILE_STATUS, &done);
    if (done)
        return name;
    char log[512] = "";
    gl->GetShaderInfoLog(name, sizeof log, 0, log);
    pupil_gles_say(why,
                   (const char *const[]){"the driver does not compile ", pupil_gles_shader_name(shader), ": ", log, 0});
    gl->DeleteShader(name);
    return 0;
}

/* vertex or other may be GLES_SHADER_COUNT: none. */
static GLuint link(const gles_object *o, const gles_variant *variant, uint32_t vertex, uint32_t other, pupil_why *why)
{
    const gl_functions *gl = &o->gl;
    const uint32_t stage[2] = {vertex, other};
    GLuint shader[2] = {0}, program = 0;
    GLint done = 1;
    for (int i = 0; i < 2 && done; i++)
        if (stage[i] != GLES_SHADER_COUNT)
            done = (shader[i] = compile(o, variant, stage[i], why)) != 0;
    if (done) {
        program = gl->CreateProgram();
        for (int i = 0; i < 2; i++)
            if (shader[i])
                gl->AttachShader(program, shader[i]);
        gl->LinkProgram(program);
        gl->GetProgramiv(program, GL_LINK_STATUS, &done);
        if (!done) {
            char log[512] = "";
            gl->GetProgramInfoLog(program, sizeof log, 0, log);
            pupil_gles_say(
                why, (const char *const[]){"the driver does not link ", pupil_gles_shader_name(other), ": ", log, 0});
            gl->DeleteProgram(program);
            program = 0;
        }
    }
    for (int i = 0; i < 2; i++)
        if (shader[i])
            gl->DeleteShader(shader[i]);
    return program;
}

static GLint at(const gles_object *o, GLuint program, const char *name)
{
    return program ? o->gl.GetUniformLocation(program, name) : -1;
}

static void find_uniforms(const gles_object *o, const gles_variant *variant, gles_programs *p)
{
    p->adapt.step_weight = at(o, p->name[GLES_ADAPT], "step_weight");
    p->adapt.level_limits = at(o, p->name[GLES_ADAPT], "level_limits");
    p->adapt.minus_divisor = at(o, p->name[GLES_ADAPT], "minus_divisor");
    p->adapt.given = at(o, p->name[GLES_ADAPT], "given");
    for (int i = 0; i < 2; i++) {
        const GLuint name = p->name[GLES_MAP + i];
        p->map[i].scale = at(o, name, variant->level_here ? "scale_base" : "given_scale");
        p->map[i].inverse_white_squared = at(o, name, "inverse_white_squared");
        p->map[i].gamut = at(o, name, "gamut");
        p->map[i].dither = at(o, name, "dither");
        p->map[i].turn = at(o, name, "turn");
        p->map[i].has_to_picture = at(o, name, "has_to_picture");
        p->map[i].to_picture = at(o, name, "to_picture");
        p->map[i].shift = at(o, name, "shift");
        p->map[i].knots = at(o, name, "knots");
        p->map[i].knot_scale = at(o, name, "knot_scale");
        p->map[i].knot_levels = at(o, name, "knot_levels");
        p->map[i].direct = at(o, name, "direct");
    }
}

int pupil_gles_programs_make(const gles_object *o, const gles_variant *variant, gles_programs *programs, pupil_why *why)
{
    const int is_31 = variant->version == PUPIL_GLES_ES31;
    const uint32_t none = GLES_SHADER_COUNT;
    const struct {
        int is_wanted;
        uint32_t vertex, other;
    } stages[GLES_PROGRAM_COUNT] = {
        [GLES_METER] = {1, is_31 ? none : GLES_TRIANGLE_VERT, is_31 ? GLES_METER_COMP : GLES_METER_FRAG},
        [GLES_REDUCE] = {!is_31, GLES_TRIANGLE_VERT, GLES_REDUCE_FRAG},
        [GLES_SCATTER] = {variant->histogram && !is_31, GLES_SCATTER_VERT, GLES_SCATTER_FRAG},
        [GLES_COUNT] = {variant->histogram && !is_31, GLES_TRIANGLE_VERT, GLES_COUNT_FRAG},
        [GLES_WEIGH] = {variant->level_here && !is_31, GLES_TRIANGLE_VERT, GLES_WEIGH_FRAG},
        [GLES_ADAPT] = {variant->level_here, is_31 ? none : GLES_TRIANGLE_VERT,
                        is_31 ? GLES_ADAPT_COMP : GLES_ADAPT_FRAG},
        [GLES_MAP] = {1, GLES_MAP_VERT, GLES_MAP_FRAG},
        [GLES_MAP_SCALED] = {o->config.scaled, GLES_MAP_VERT, GLES_MAP_SCALED_FRAG},
    };
    gles_programs made = {.name = {0}};
    for (int i = 0; i < GLES_PROGRAM_COUNT; i++) {
        if (!stages[i].is_wanted)
            continue;
        made.name[i] = link(o, variant, stages[i].vertex, stages[i].other, why);
        if (!made.name[i]) {
            pupil_gles_programs_delete(o, &made);
            return PUPIL_ERR_GLES_SHADER;
        }
    }
    find_uniforms(o, variant, &made);
    *programs = made;
    return PUPIL_OK;
}

void pupil_gles_programs_delete(const gles_object *o, gles_programs *programs)
{
    for (int i = 0; i < GLES_PROGRAM_COUNT; i++) {
        if (programs->name[i])
            o->gl.DeleteProgram(programs->name[i]);
        programs->name[i] = 0;
    }
}

static GLint uniform(const gles_object *o, uint32_t program, const char *name)
{
    return at(o, o->programs.name[program], name);
}

/* --- uniforms that stay; GL ignores those that a program does not have --- */

/* Of four samples; of four times the light, where there are knees. */
static void set_mosaic(const gles_object *o, uint32_t p)
{
    const gl_functions *gl = &o->gl;
    const pupil_coder *c = &o->coder;
    const float part = c->lines ? 0.25f : 1.0f;
    gl->Uniform2f(uniform(o, p, "mosaic"), c->lines ? 0.0f : c->zero4, c->most);
    gl->Uniform3f(uniform(o, p, "unit4"), part * c->unit4[0], part * c->unit4[1], part * c->unit4[2]);
}

static void set_frame(const gles_object *o, uint32_t p)
{
    const gl_functions *gl = &o->gl;
    const pupil_coder *c = &o->coder;
    const pupil_pixel_layout layout = pupil_pixel_layout_of(o->config.pixel);
    gl->Uniform1i(uniform(o, p, "frame"), GLES_UNIT_FRAME);
    gl->Uniform1i(uniform(o, p, "chroma"), GLES_UNIT_CHROMA);
    gl->Uniform1i(uniform(o, p, "cr"), GLES_UNIT_CR);
    gl->Uniform1i(uniform(o, p, "light"), GLES_UNIT_LIGHT);
    gl->Uniform1f(uniform(o, p, "light_top"), c->top);
    gl->Uniform2i(uniform(o, p, "frame_size"), (GLint)o->config.width, (GLint)o->config.height);
    gl->Uniform2f(uniform(o, p, "rgb_codes"), o->config.pixel == PUPIL_PIXEL_RGB10A2 ? 1023.0f : 255.0f, c->unit);
    gl->Uniform3f(uniform(o, p, "yuv_luma"), c->y_zero, c->y_unit, (float)(1u << (layout.yuv ? layout.yuv - 1 : 0)));
    gl->Uniform4f(uniform(o, p, "yuv_chroma"), c->red_v, c->green_u, c->green_v, c->blue_u);
    gl->Uniform2i(uniform(o, p, "chroma_shift"), layout.chroma_columns == 2, layout.chroma_rows == 2);
    gl->Uniform1i(uniform(o, p, "sample_shift"), o->config.pixel == PUPIL_PIXEL_P010 ? 6 : (GLint)c->shift);
    gl->Uniform2f(uniform(o, p, "grey"), c->zero, c->unit);
    gl->Uniform1i(uniform(o, p, "has_to_picture"), (GLint)o->has_to_picture);
    gl->UniformMatrix3fv(uniform(o, p, "to_picture"), 1, GL_TRUE, o->to_picture);
    set_mosaic(o, p);
    gl->Uniform1i(uniform(o, p, "lines"), (GLint)c->lines);
    for (uint32_t i = 0; i < c->lines; i++) {
        const char name[] = {'l', 'i', 'n', 'e', '[', (char)('0' + i), ']', 0};
        gl->Uniform3f(uniform(o, p, name), c->line[i].from, c->line[i].light, c->line[i].slope);
    }
    gl->Uniform2i(uniform(o, p, "red_at"), (GLint)c->red_x, (GLint)c->red_y);
    gl->UniformMatrix3fv(uniform(o, p, "camera_matrix"), 1, GL_TRUE, c->matrix);
}

void pupil_gles_programs_balance(gles_object *o)
{
    static const uint32_t readers[] = {GLES_METER, GLES_SCATTER, GLES_MAP, GLES_MAP_SCALED};
    const gl_functions *gl = &o->gl;
    const pupil_coder *c = &o->coder;
    for (uint32_t i = 0; i < sizeof readers / sizeof readers[0]; i++) {
        const uint32_t p = readers[i];
        if (!o->programs.name[p])
            continue;
        gl->UseProgram(o->programs.name[p]);
        set_mosaic(o, p);
        if (p == GLES_METER)
            gl->Uniform1f(uniform(o, p, "clip_value"), pupil_clip_of(&o->settings, o->config.pixel, c));
    }
}

static void set_regions(const gles_object *o, uint32_t p)
{
    const gl_functions *gl = &o->gl;
    GLuint weights[PUPIL_GRID_SIDE][4] = {{0}};
    for (int y = 0; y < PUPIL_GRID_SIDE; y++)
        for (int x = 0; x < PUPIL_GRID_SIDE; x++)
            weights[y][x / 4] |= (GLuint)o->settings.weight[y][x] << 8 * (x % 4);
    gl->Uniform4uiv(uniform(o, p, "weights"), PUPIL_GRID_SIDE, weights[0]);
    gl->Uniform4iv(uniform(o, p, "region_row"), (GLsizei)o->region_rows, &o->region_row[0].first);
    gl->Uniform2i(uniform(o, p, "metered_size"), (GLint)(o->config.width / o->unit),
                  (GLint)(o->config.height / o->unit));
    gl->Uniform1i(uniform(o, p, "cells_together"), (GLint)o->cells_together);
    gl->Uniform1i(uniform(o, p, "region_rows"), (GLint)o->region_rows);
}

static void set_metering(const gles_object *o, uint32_t p)
{
    const gl_functions *gl = &o->gl;
    gl->Uniform1f(uniform(o, p, "floor_luminance"), o->settings.floor);
    gl->Uniform1f(uniform(o, p, "clip_value"), pupil_clip_of(&o->settings, o->config.pixel, &o->coder));
    gl->Uniform3f(uniform(o, p, "luma"), o->metered_luma[0], o->metered_luma[1], o->metered_luma[2]);
}

static void set_mapping(const gles_object *o, uint32_t p)
{
    const gl_functions *gl = &o->gl;
    const GLint halved = o->config.half_size ? 2 : 1;
    gl->Uniform3f(uniform(o, p, "luma"), o->luma[0], o->luma[1], o->luma[2]);
    gl->UniformMatrix3fv(uniform(o, p, "cones_of_rgb"), 1, GL_TRUE, o->cones.from_rgb);
    gl->UniformMatrix3fv(uniform(o, p, "rgb_of_cones"), 1, GL_TRUE, o->cones.to_rgb);
    gl->Uniform1i(uniform(o, p, "encoder"), GLES_UNIT_ENCODER);
    gl->Uniform1i(uniform(o, p, "veil"), GLES_UNIT_VEIL);
    gl->Uniform1ui(uniform(o, p, "encoder_base"), pupil_encoders[o->settings.transfer].base_bits);
    gl->Uniform1i(uniform(o, p, "adapted"), GLES_UNIT_STATE);
    const pupil_code_width *light = &pupil_code_widths[o->settings.transfer];
    gl->Uniform3f(uniform(o, p, "code_light"), light->power, light->scale, light->least);
    gl->Uniform1ui(uniform(o, p, "code_light_offset"), light->offset);
    gl->Uniform2i(uniform(o, p, "picture_size"), (GLint)o->config.width / halved, (GLint)o->config.height / halved);
}

/* Where ES 3.0's chain reads what was drawn before. */
static void set_targets(const gles_object *o, uint32_t p)
{
    const gl_functions *gl = &o->gl;
    const gles_bins *b = &o->bins;
    gl->Uniform1i(uniform(o, p, "parts"), p == GLES_REDUCE ? GLES_UNIT_FRAME : GLES_UNIT_CHROMA);
    gl->Uniform1i(uniform(o, p, "regions"), GLES_UNIT_FRAME);
    gl->Uniform1i(uniform(o, p, "bins"), GLES_UNIT_FRAME);
    gl->Uniform4i(uniform(o, p, "plan"), (GLint)b->columns, (GLint)b->step, (GLint)b->groups, (GLint)o->region_rows);
}

void pupil_gles_programs_set(gles_object *o)
{
    o->cells_together = pupil_gles_regions_together(o);
    for (uint32_t p = 0; p < GLES_PROGRAM_COUNT; p++) {
        if (!o->programs.name[p])
            continue;
        o->gl.UseProgram(o->programs.name[p]);
        if (p == GLES_METER || p == GLES_SCATTER || p == GLES_MAP || p == GLES_MAP_SCALED)
            set_frame(o, p);
        if (p != GLES_MAP && p != GLES_MAP_SCALED && p != GLES_REDUCE)
            set_regions(o, p);
        if (p == GLES_METER || p == GLES_SCATTER)
            set_metering(o, p);
        if (p == GLES_MAP || p == GLES_MAP_SCALED)
            set_mapping(o, p);
        set_targets(o, p);
        if (p == GLES_WEIGH || p == GLES_ADAPT)
            pupil_gles_adapt_set(o, o->programs.name[p]);
        if (p == GLES_ADAPT) {
            o->gl.Uniform1i(uniform(o, p, "columns"), GLES_UNIT_FRAME);
            o->gl.Uniform1i(uniform(o, p, "state_before"), GLES_UNIT_STATE);
        }
    }
}

void pupil_gles_begin(const gles_object *o, uint32_t program)
{
    static const GLenum off[] = {GL_BLEND,
                                 GL_DEPTH_TEST,
                                 GL_STENCIL_TEST,
                                 GL_CULL_FACE,
                                 GL_SCISSOR_TEST,
                                 GL_DITHER,
                                 GL_POLYGON_OFFSET_FILL,
                                 GL_RASTERIZER_DISCARD,
                                 GL_SAMPLE_ALPHA_TO_COVERAGE,
                                 GL_SAMPLE_COVERAGE};
    for (size_t i = 0; i < sizeof off / sizeof off[0]; i++)
        o->gl.Disable(off[i]);
    if (o->gl.MemoryBarrier) /* of 3.1, too; asked of the context, not of the version that is used */
        o->gl.Disable(GL_SAMPLE_MASK);
    o->gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    o->gl.BindVertexArray(o->vertex_array);
    o->gl.UseProgram(o->programs.name[program]);
}

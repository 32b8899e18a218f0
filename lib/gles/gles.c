/* The object's life, and a frame at once. */
#include "base/pixel.h"
#include "core/image.h"
#include "gles_private.h"

static const pupil_gles_config defaults; /* all zero */

void pupil_gles_config_default_sized(pupil_gles_config *config, size_t config_bytes)
{
    if (config)
        (void)pupil_versioned_write(config, config_bytes, &defaults, sizeof defaults);
}

/* --- errors --- */

/* After a step of init or retune: an error of GL itself, out of memory or lost, is the cause of any other failure.
 */
static int cause_of(const gles_object *o, int error, pupil_why *why)
{
    const int by_gl = pupil_gles_error(o);
    if (by_gl == PUPIL_OK || (error && by_gl == PUPIL_ERR_GLES))
        return error;
    pupil_gles_say(why, (const char *const[]){pupil_error_string(by_gl), 0});
    return by_gl;
}

/* --- the context --- */

static int equal(const char *a, const char *b)
{
    while (*a && *a == *b) {
        a++;
        b++;
    }
    return *a == *b;
}

static int has_extension(const gl_functions *gl, const char *name)
{
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const char *have = (const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
        if (have && equal(have, name))
            return 1;
    }
    return 0;
}

/* "OpenGL ES 3.1 ..." as 31; 0: not of this kind. */
static uint32_t version_of(const char *text)
{
    const char *const begins = "OpenGL ES ";
    int i = 0;
    for (; begins[i]; i++)
        if (text[i] != begins[i])
            return 0;
    const int has_two =
        text[i] >= '0' && text[i] <= '9' && text[i + 1] == '.' && text[i + 2] >= '0' && text[i + 2] <= '9';
    return has_two ? (uint32_t)(text[i] - '0') * 10 + (uint32_t)(text[i + 2] - '0') : 0;
}

static int refuse_version(pupil_why *why, const char *a, const char *b, const char *c)
{
    pupil_gles_say(why, (const char *const[]){a, b, c, 0});
    return PUPIL_ERR_GLES_VERSION;
}

/* Finds the functions, and which version there is. */
static int meet_context(gles_object *o, pupil_gles_get_proc get_proc, uint32_t *version, pupil_why *why)
{
    o->gl.GetCurrentContext = (void *(*)(void))get_proc("eglGetCurrentContext");
    o->context = o->gl.GetCurrentContext ? o->gl.GetCurrentContext() : 0;
    o->gl.GetString = (PFNGLGETSTRINGPROC)get_proc("glGetString");
    if (!o->gl.GetString)
        return refuse_version(why, "get_proc does not find glGetString", "", "");
    const char *text = o->gl.GetCurrentContext && !o->context ? 0 : (const char *)o->gl.GetString(GL_VERSION);
    if (!text) {
        o->gl.GetError = (PFNGLGETERRORPROC)get_proc("glGetError");
        if (o->context && o->gl.GetError && pupil_gles_error(o) == PUPIL_ERR_GLES_LOST)
            return cause_of(o, PUPIL_ERR_GLES_LOST, why);
        pupil_gles_say(why, (const char *const[]){"no OpenGL ES context is current in this thread", 0});
        return PUPIL_ERR_GLES_CONTEXT;
    }
    *version = version_of(text);
    if (*version < 30)
        return refuse_version(why, "OpenGL ES 3.0 or newer is needed; the context is ", text, "");
    const char *lacks = pupil_gl_functions_find(&o->gl, *version >= 31, get_proc);
    if (lacks)
        return refuse_version(why, text, ": the context lacks the function ", lacks);
    if (*version >= 32)
        o->gl.GetGraphicsResetStatus = (GLenum(*)(void))get_proc("glGetGraphicsResetStatus");
    else if (has_extension(&o->gl, "GL_KHR_robustness"))
        o->gl.GetGraphicsResetStatus = (GLenum(*)(void))get_proc("glGetGraphicsResetStatusKHR");
    else if (has_extension(&o->gl, "GL_EXT_robustness"))
        o->gl.GetGraphicsResetStatus = (GLenum(*)(void))get_proc("glGetGraphicsResetStatusEXT");
    o->gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &o->largest_side);
    o->has_half_targets = *version >= 32 || has_extension(&o->gl, "GL_EXT_color_buffer_half_float") ||
                          has_extension(&o->gl, "GL_EXT_color_buffer_float");
    for (int i = 0; i < 16 && o->gl.GetError() != GL_NO_ERROR; i++) { /* the caller's own; a lost context has no end */
    }
    return PUPIL_OK;
}

/* --- settings --- */

static int refuse_config(pupil_why *why, const char *sentence)
{
    pupil_gles_say(why, (const char *const[]){sentence, 0});
    return PUPIL_ERR_CONFIG;
}

/* The caller's configuration and its coding as ones of this version; config->coding is NULL then. */
static int read_config(pupil_gles_config *config, pupil_coding *coding, const pupil_gles_config *theirs, pupil_why *why)
{
    const size_t first_bytes = PUPIL_FIRST_BYTES(pupil_gles_config, coding);
    *config = defaults;
    *coding = (pupil_coding){0};
    const char *fault = pupil_versioned_read(config, sizeof *config, first_bytes, theirs, theirs->size_bytes);
    if (fault)
        return refuse_config(why, fault);
    fault = config->coding ? pupil_coding_read(coding, config->coding) : 0;
    config->coding = 0;
    if (fault)
        pupil_gles_say(why, (const char *const[]){fault, 0});
    return fault ? PUPIL_ERR_CODING : PUPIL_OK;
}

static int check_config(const pupil_gles_config *c, pupil_why *why)
{
    if (c->version != PUPIL_GLES_BEST && c->version != PUPIL_GLES_ES30 && c->version != PUPIL_GLES_ES31)
        return refuse_config(why, "version must be a pupil_gles_version");
    if (c->source >= PUPIL_GLES_SOURCE_COUNT)
        return refuse_config(why, "source must be a pupil_gles_source");
    if (c->adapt >= PUPIL_GLES_ADAPT_COUNT)
        return refuse_config(why, "adapt must be a pupil_gles_adapt");
    if (c->source == PUPIL_GLES_EXTERNAL && c->pixel != PUPIL_PIXEL_RGBA8)
        return refuse_config(why, "pixel of PUPIL_GLES_EXTERNAL must be PUPIL_PIXEL_RGBA8");
    if (c->normalized_16 && c->source != PUPIL_GLES_TEXTURES)
        return refuse_config(why, "normalized_16 must be 0 but with PUPIL_GLES_TEXTURES");
    if (c->half_size && !pupil_pixel_is_mosaic(c->pixel))
        return refuse_config(why, "half_size must be 0, except for mosaics");
    if (c->veil > 1 || (c->veil && pupil_pixel_is_mosaic(c->pixel)))
        return refuse_config(why,
                             "veil must be 0 or 1, and 0 for mosaics, whose lens has put its own veiling glare in");
    if (c->reserved)
        return refuse_config(why, "reserved must be 0");
    return PUPIL_OK;
}

/* Whether frames of the config can be read, and what the coding does not allow. */
static int check_frames(const pupil_gles_config *c, const pupil_coding *coding, pupil_why *why)
{
    static const uint64_t somewhere; /* an address, never read */
    const pupil_image_const frame = {.data = &somewhere,
                                     .chroma = &somewhere,
                                     .cr = &somewhere,
                                     .stride_bytes = PUPIL_MAX_SIDE_PX * 16,
                                     .chroma_stride_bytes = PUPIL_MAX_SIDE_PX * 16,
                                     .cr_stride_bytes = PUPIL_MAX_SIDE_PX * 16,
                                     .width = c->width,
                                     .height = c->height,
                                     .pixel = c->pixel};
    const char *fault = 0;
    int error = pupil_image_check(&frame, 0);
    if (error)
        fault = pupil_error_string(error);
    else
        error = pupil_coding_check(coding, c->pixel, &fault);
    if (error)
        pupil_gles_say(why, (const char *const[]){fault, 0});
    return error;
}

static int check_settings(const gles_object *o, const pupil_object *pupil, uint32_t version, pupil_why *why)
{
    if (pupil->config.grey_world)
        return refuse_config(why, "grey_world must be 0: the sums of channels are made by the CPU alone");
    if (o->config.adapt == PUPIL_GLES_ADAPT_GPU && pupil_gles_adapt_check(&pupil->config, why))
        return PUPIL_ERR_CONFIG;
    if (pupil->histogram && version == PUPIL_GLES_ES30 && !o->has_half_targets)
        return refuse_config(why, "this OpenGL ES 3.0 has no histogram, for it lacks GL_EXT_color_buffer_half_float: "
                                  "choose PUPIL_WHITE_FIXED or PUPIL_WHITE_NONE, trim 0 and 1, histogram 0, and "
                                  "PUPIL_CURVE_REINHARD");
    if (pupil->histogram && version == PUPIL_GLES_ES30 && o->config.source == PUPIL_GLES_EXTERNAL)
        return refuse_config(why, "OpenGL ES 3.0 has no histogram of PUPIL_GLES_EXTERNAL: choose PUPIL_WHITE_FIXED or "
                                  "PUPIL_WHITE_NONE, trim 0 and 1, histogram 0, and PUPIL_CURVE_REINHARD");
    return PUPIL_OK;
}

/* External textures are R'G'B' of the coding's curve, as RGB10A2 is; 8-bit RGB is sRGB with any coding
 * (pupil/image.h). */
void pupil_gles_coder_set(gles_object *o)
{
    const int external = o->config.source == PUPIL_GLES_EXTERNAL;
    const pupil_pixel_layout layout = pupil_pixel_layout_of(o->config.pixel);
    const int rgb8 = layout.sample == 1 && !layout.yuv && !layout.bits;
    pupil_coder_make(external || !rgb8 ? &o->coding : 0, rgb8 ? (uint32_t)PUPIL_PIXEL_RGB10A2 : o->config.pixel,
                     &o->coder);
    if (rgb8)
        o->coder.unit = 1.0f; /* its codes are indices of the table */
    o->code_light = pupil_code_light(&o->coder, o->config.pixel);
}

static void take_settings(gles_object *o, const pupil_t *from)
{
    const pupil_object *pupil = pupil_object_of_const(from);
    o->settings = pupil->config;
    o->histogram = pupil->histogram;
    for (int i = 0; i < 3; i++)
        o->luma[i] = pupil->picture_luma[i];
    for (int i = 0; i < 9; i++)
        o->to_picture[i] = pupil->to_picture[i];
    o->has_to_picture = pupil->has_to_picture;
    for (int i = 0; i < 9; i++)
        o->rods_to_picture[i] = pupil->rods_to_picture[i];
    o->has_rods = pupil->has_rods;
    o->cones = pupil->cones;
    pupil_metered_luma(pupil->luma, &o->coder, o->metered_luma);
    pupil_curve before_light;
    (void)pupil_curve_before_light(from, &before_light);
    (void)pupil_curve_read(&o->curve, &before_light);
}

static gles_variant variant_of(const gles_object *o, const pupil_object *pupil, uint32_t version)
{
    const pupil_pixel_layout layout = pupil_pixel_layout_of(o->config.pixel);
    const int coded = layout.yuv || (layout.bits && !layout.mosaic) || o->config.pixel == PUPIL_PIXEL_RGB10A2 ||
                      o->config.source == PUPIL_GLES_EXTERNAL;
    return (gles_variant){.version = version,
                          .pixel = o->config.pixel,
                          .source = o->config.source,
                          .normalized_16 = o->config.normalized_16,
                          .half_size = o->config.half_size,
                          .is_linear = coded && !o->coder.light,
                          .has_matrix = o->coder.has_matrix,
                          .has_knees = o->coder.lines != 0,
                          .veil = o->config.veil,
                          .histogram = pupil->histogram,
                          .level_here = o->config.adapt == PUPIL_GLES_ADAPT_GPU};
}

/* --- life --- */

static void delete_all(gles_object *o)
{
    pupil_gles_meter_delete(o);
    pupil_gles_textures_delete(o);
    pupil_gles_programs_delete(o, &o->programs);
    o->gl.DeleteVertexArrays(1, &o->vertex_array);
}

/* Makes everything for one version; after an error nothing is left. */
static int make_all(gles_object *o, const pupil_object *pupil, uint32_t version, pupil_why *why)
{
    int error = check_settings(o, pupil, version, why);
    if (error)
        return error;
    o->variant = variant_of(o, pupil, version);
    error = pupil_gles_programs_make(o, &o->variant, &o->programs, why);
    if (error)
        return cause_of(o, error, why);
    o->gl.GenVertexArrays(1, &o->vertex_array);
    o->bins = pupil_gles_bins_plan(o, &pupil->config);
    error = pupil_gles_textures_make(o, why);
    if (!error && o->variant.version == PUPIL_GLES_ES30 && o->variant.histogram)
        error = pupil_gles_bins_make(o, why);
    if (!error) {
        pupil_gles_meter_make(o);
        pupil_gles_textures_set(o);
        pupil_gles_programs_set(o);
    }
    error = cause_of(o, error, why);
    if (error)
        delete_all(o);
    return error;
}

static int make_best(gles_object *o, const pupil_object *pupil, uint32_t have, pupil_why *why)
{
    const uint32_t wanted = o->config.version;
    if (wanted > have)
        return refuse_version(why, "OpenGL ES 3.1 is asked for; the context has 3.0", "", "");
    if (wanted == PUPIL_GLES_ES30 || have < 31)
        return make_all(o, pupil, PUPIL_GLES_ES30, why);
    const int error = make_all(o, pupil, PUPIL_GLES_ES31, why);
    if (error != PUPIL_ERR_GLES_SHADER || wanted == PUPIL_GLES_ES31 || pupil->histogram)
        return error;
    pupil_gles_say(why, (const char *const[]){0}); /* nothing: it is not refused */
    return make_all(o, pupil, PUPIL_GLES_ES30, why);
}

static int check_arguments(const void *gles, const pupil_t *pupil, const void *also, pupil_why *why)
{
    const int error = gles && also ? pupil_object_check(pupil) : PUPIL_ERR_NULL;
    if (error)
        pupil_gles_say(why, (const char *const[]){pupil_error_string(error), 0});
    return error;
}

int pupil_gles_init(pupil_gles *gles, const pupil_gles_config *config, const pupil_t *pupil,
                    pupil_gles_get_proc get_proc, pupil_why *why)
{
    pupil_gles_config own;
    pupil_coding coding;
    int error = check_arguments(gles, pupil, get_proc ? (const void *)config : 0, why);
    if (!error)
        error = read_config(&own, &coding, config, why);
    if (!error)
        error = check_config(&own, why);
    if (!error)
        error = check_frames(&own, &coding, why);
    if (error)
        return error;
    const pupil_object *settings = pupil_object_of_const(pupil);
    gles_object *o = gles_object_of(gles);
    *o = (gles_object){
        .config = own, .coding = coding, .direct = -1.0f, .unit = pupil_pixel_is_mosaic(own.pixel) ? 2 : 1};
    pupil_gles_coder_set(o);
    take_settings(o, pupil);
    o->region_rows = pupil_gles_regions_make(own.height / o->unit, o->region_row);
    uint32_t have = 0;
    error = meet_context(o, get_proc, &have, why);
    if (!error && own.source == PUPIL_GLES_EXTERNAL && !has_extension(&o->gl, "GL_OES_EGL_image_external_essl3"))
        error = refuse_version(why, "the context lacks GL_OES_EGL_image_external_essl3", "", "");
    if (!error)
        error = make_best(o, settings, have, why);
    if (error)
        return error;
    pupil_gles_adapt_take(o, settings);
    o->magic = GLES_MAGIC;
    return PUPIL_OK;
}

/* ES 3.0: the histogram's targets for other settings; after an error the old ones are there. */
static int retune_bins(gles_object *o, const pupil_object *settings, const gles_variant *variant, pupil_why *why)
{
    const gles_bins had = o->bins, plan = pupil_gles_bins_plan(o, &settings->config);
    const int same = o->target[GLES_BINS] && had.groups * had.columns == plan.groups * plan.columns;
    const GLuint texture[2] = {o->target[GLES_BINS], o->target[GLES_COUNTS]};
    const GLuint framebuffer[2] = {o->framebuffer[GLES_BINS], o->framebuffer[GLES_COUNTS]};
    GLuint old[4];
    o->bins = plan;
    if (variant->version != PUPIL_GLES_ES30 || !variant->histogram || same)
        return PUPIL_OK;
    for (int i = 0; i < 2; i++)
        o->target[GLES_BINS + i] = o->framebuffer[GLES_BINS + i] = 0;
    const int error = cause_of(o, pupil_gles_bins_make(o, why), why);
    for (int i = 0; i < 2; i++) { /* after an error the new ones are deleted */
        old[i] = error ? o->target[GLES_BINS + i] : texture[i];
        old[2 + i] = error ? o->framebuffer[GLES_BINS + i] : framebuffer[i];
        o->target[GLES_BINS + i] = error ? texture[i] : o->target[GLES_BINS + i];
        o->framebuffer[GLES_BINS + i] = error ? framebuffer[i] : o->framebuffer[GLES_BINS + i];
    }
    if (error)
        o->bins = had;
    o->gl.DeleteTextures(2, old);
    o->gl.DeleteFramebuffers(2, old + 2);
    return error;
}

int pupil_gles_retune(pupil_gles *gles, const pupil_t *pupil, pupil_why *why)
{
    int error = check_arguments(gles, pupil, gles, why);
    if (!error && (error = pupil_gles_check(gles)))
        pupil_gles_say(why, (const char *const[]){pupil_error_string(error), 0});
    if (error)
        return error;
    gles_object *o = gles_object_of(gles);
    const pupil_object *settings = pupil_object_of_const(pupil);
    if ((error = check_settings(o, settings, o->variant.version, why)))
        return error;
    const gles_variant variant = variant_of(o, settings, o->variant.version);
    gles_programs programs = o->programs;
    const int others = variant.histogram != o->variant.histogram;
    if (others && (error = pupil_gles_programs_make(o, &variant, &programs, why)))
        return cause_of(o, error, why);
    error = retune_bins(o, settings, &variant, why);
    if (error) {
        if (others)
            pupil_gles_programs_delete(o, &programs);
        return error;
    }
    if (others) {
        pupil_gles_programs_delete(o, &o->programs);
        o->programs = programs;
        o->variant = variant;
    }
    pupil_gles_meter_drop(o);
    take_settings(o, pupil);
    pupil_gles_adapt_take(o, settings);
    pupil_gles_textures_set(o);
    pupil_gles_programs_set(o);
    return cause_of(o, PUPIL_OK, why);
}

void pupil_gles_close(pupil_gles *gles)
{
    if (!gles || gles_object_of(gles)->magic != GLES_MAGIC)
        return;
    if (pupil_gles_check(gles) == PUPIL_OK)
        delete_all(gles_object_of(gles));
    gles_object_of(gles)->magic = 0;
}

int pupil_gles_get_status_sized(const pupil_gles *gles, pupil_gles_status *status, size_t status_bytes)
{
    const gles_object *o = (const gles_object *)(const void *)gles;
    if (!gles || !status)
        return PUPIL_ERR_NULL;
    if (o->magic != GLES_MAGIC)
        return PUPIL_ERR_OBJECT;
    const pupil_gles_status now = {.version = o->variant.version,
                                   .under_way = o->under_way,
                                   .metered = o->metered,
                                   .unmetered = o->unmetered,
                                   .level_q24 = o->level_q24,
                                   .level_known = o->level_known};
    return pupil_versioned_write(status, status_bytes, &now, sizeof now);
}

/* --- a frame at once --- */

static int take_statistics(pupil_gles *gles, pupil_t *pupil)
{
    gles_object *o = gles_object_of(gles);
    pupil_frame_info info;
    int got;
    while ((got = pupil_gles_fetch(o, 0, &info)) == PUPIL_OK) {
        const int error = pupil_adapt(pupil, &o->stats, &info);
        if (error)
            return error;
    }
    return got == PUPIL_GLES_NOTHING ? PUPIL_OK : got;
}

int pupil_gles_process(pupil_gles *gles, pupil_t *pupil, const pupil_frame_info *info, const pupil_gles_target *target)
{
    pupil_gles_target to;
    pupil_frame_info own;
    int error = pupil_gles_check(gles);
    if (!error)
        error = pupil_object_check(pupil);
    if (!error)
        error = pupil_gles_target_read(gles_object_of(gles), &to, target);
    if (!error)
        error = pupil_info_read(&own, info);
    if (!error)
        error = take_statistics(gles, pupil);
    info = info ? &own : 0;
    if (!error)
        error = pupil_gles_meter(gles, info);
    if (error && error != PUPIL_GLES_BUSY)
        return error;
    if (gles_object_of(gles)->config.adapt == PUPIL_GLES_ADAPT_GPU)
        return pupil_gles_map(gles, 0, &to);
    pupil_curve curve;
    if (pupil_get_curve(pupil, info, &curve) != PUPIL_OK)
        (void)pupil_curve_before_light(pupil, &curve);
    return pupil_gles_map(gles, &curve, &to);
}

#include "gles_variant.h"

#include "base/pixel.h"
#include "gles_shader_texts.h"

const char *pupil_gles_shader_name(uint32_t shader)
{
    static const char *const names[GLES_SHADER_COUNT] = {
        "triangle.vert", "meter.comp", "meter.frag", "reduce.frag", "scatter.vert", "scatter.frag",    "count.frag",
        "weigh.frag",    "adapt.comp", "adapt.frag", "map.vert",    "map.frag",     "map.frag, scaled"};
    return names[shader];
}

/* All of them: the default precision of samplers is low, and fragment shaders have none for floats. */
static const char precisions[] = "precision highp float;\n"
                                 "precision highp int;\n"
                                 "precision highp sampler2D;\n"
                                 "precision highp usampler2D;\n";

/* Load of load.glsl, by format. */
static const char *load_of(const gles_variant *v)
{
    if (v->source == PUPIL_GLES_EXTERNAL)
        return "#define LOAD_CODED_RGB\n";
    switch (v->pixel) {
    case PUPIL_PIXEL_RGBA32F:
    case PUPIL_PIXEL_RGBA16F:
        return "#define LOAD_FLOAT\n#define ALPHA\n";
    case PUPIL_PIXEL_RGB32F:
    case PUPIL_PIXEL_BGR32F:
    case PUPIL_PIXEL_RGB16F:
        return "#define LOAD_FLOAT\n";
    case PUPIL_PIXEL_RGBA16:
        return "#define LOAD_RGB16\n#define ALPHA\n";
    case PUPIL_PIXEL_RGB16:
        return "#define LOAD_RGB16\n";
    case PUPIL_PIXEL_RGBA8:
    case PUPIL_PIXEL_RGB10A2:
        return "#define LOAD_RGB_CODES\n#define ALPHA\n";
    case PUPIL_PIXEL_RGB8:
    case PUPIL_PIXEL_BGR8:
    case PUPIL_PIXEL_BGRX8:
    case PUPIL_PIXEL_RGBX8:
        return "#define LOAD_RGB_CODES\n";
    case PUPIL_PIXEL_YUYV:
    case PUPIL_PIXEL_UYVY:
        return "#define LOAD_YUYV\n";
    default:
        break;
    }
    if (pupil_pixel_is_mosaic(v->pixel))
        return "#define LOAD_MOSAIC\n";
    if (pupil_pixel_bits(v->pixel))
        return "#define LOAD_GREY\n";
    return pupil_pixel_planes(v->pixel) == 3 ? "#define LOAD_PLANES\n#define CR_PLANE\n" : "#define LOAD_PLANES\n";
}

static const char *samples_of(const gles_variant *v)
{
    const pupil_pixel_layout layout = pupil_pixel_layout_of(v->pixel);
    if (!layout.yuv && !layout.bits)
        return "";
    if (layout.sample == 2)
        return v->normalized_16 ? "#define SAMPLES_NORMALIZED_16\n" : "#define SAMPLES_16\n";
    return layout.bits == 10   ? "#define SAMPLES_10P\n"
           : layout.bits == 12 ? "#define SAMPLES_12P\n"
                               : "#define SAMPLES_8\n";
}

static int is_grey(uint32_t pixel)
{
    return pupil_pixel_bits(pixel) && !pupil_pixel_is_mosaic(pixel);
}

/* What reads the frame. */
static uint32_t add_load(const gles_variant *v, uint32_t n, const char *texts[GLES_MOST_TEXTS])
{
    texts[n++] = load_of(v);
    texts[n++] = samples_of(v);
    if (is_grey(v->pixel) && !v->is_linear)
        texts[n++] = "#define GREY_LIGHT\n";
    if (v->is_linear)
        texts[n++] = "#define LIGHT_LINEAR\n";
    if (v->has_knees)
        texts[n++] = "#define KNEES\n";
    if (v->has_matrix)
        texts[n++] = "#define MATRIX\n";
    if (v->half_size)
        texts[n++] = "#define QUADS\n";
    texts[n++] = text_load_glsl;
    texts[n++] = text_load_yuv_glsl;
    texts[n++] = text_load_samples_glsl;
    texts[n++] = text_light_glsl;
    return n;
}

static uint32_t add_metering(const gles_variant *v, uint32_t n, const char *texts[GLES_MOST_TEXTS])
{
    n = add_load(v, n, texts);
    texts[n++] = text_regions_glsl;
    texts[n++] = text_meter_glsl;
    return n;
}

static uint32_t add_adapting(uint32_t n, const char *texts[GLES_MOST_TEXTS])
{
    texts[n++] = text_regions_glsl;
    texts[n++] = text_integers_glsl;
    texts[n++] = text_adapt_glsl;
    return n;
}

static uint32_t add_shader_that_meters(const gles_variant *v, uint32_t shader, uint32_t n,
                                       const char *texts[GLES_MOST_TEXTS])
{
    switch (shader) {
    case GLES_METER_COMP:
        if (v->histogram)
            texts[n++] = "#define HISTOGRAM\n";
        n = add_metering(v, n, texts);
        texts[n++] = text_statistics_glsl;
        texts[n++] = text_meter_comp;
        break;
    case GLES_METER_FRAG:
        if (v->histogram)
            texts[n++] = "#define HISTOGRAM\n";
        n = add_metering(v, n, texts);
        texts[n++] = text_meter_frag;
        break;
    case GLES_REDUCE_FRAG:
        texts[n++] = text_regions_glsl;
        texts[n++] = text_reduce_frag;
        break;
    case GLES_SCATTER_VERT:
        texts[n++] = "#define HISTOGRAM\n";
        n = add_metering(v, n, texts);
        texts[n++] = text_bins_glsl;
        texts[n++] = text_scatter_vert;
        break;
    case GLES_SCATTER_FRAG:
        texts[n++] = text_scatter_frag;
        break;
    default: /* GLES_COUNT_FRAG */
        texts[n++] = text_regions_glsl;
        texts[n++] = text_integers_glsl;
        texts[n++] = text_bins_glsl;
        texts[n++] = text_count_frag;
        break;
    }
    return n;
}

uint32_t pupil_gles_shader_texts(const gles_variant *v, uint32_t shader, const char *texts[GLES_MOST_TEXTS])
{
    uint32_t n = 0;
    texts[n++] = v->version == PUPIL_GLES_ES31 ? "#version 310 es\n" : "#version 300 es\n";
    if (v->source == PUPIL_GLES_EXTERNAL)
        texts[n++] = "#extension GL_OES_EGL_image_external_essl3 : require\n"
                     "precision highp samplerExternalOES;\n";
    texts[n++] = precisions;
    if (v->level_here)
        texts[n++] =
            v->version == PUPIL_GLES_ES31 ? "#define LEVEL_HERE\n#define STATE_IN_BUFFER\n" : "#define LEVEL_HERE\n";
    switch (shader) {
    case GLES_WEIGH_FRAG:
        n = add_adapting(n, texts);
        texts[n++] = text_weigh_frag;
        break;
    case GLES_ADAPT_FRAG:
        n = add_adapting(n, texts);
        texts[n++] = text_adapt_frag;
        break;
    case GLES_ADAPT_COMP:
        n = add_adapting(n, texts);
        texts[n++] = text_statistics_glsl;
        texts[n++] = text_adapt_comp;
        break;
    case GLES_MAP_SCALED_FRAG:
    case GLES_MAP_FRAG:
        if (shader == GLES_MAP_SCALED_FRAG)
            texts[n++] = "#define SCALED\n";
        if (v->veil)
            texts[n++] = "#define VEIL\n";
        n = add_load(v, n, texts);
        texts[n++] = text_gamut_glsl;
        texts[n++] = text_dither_glsl;
        texts[n++] = text_map_frag;
        break;
    case GLES_MAP_VERT:
        texts[n++] = text_map_vert;
        break;
    case GLES_TRIANGLE_VERT:
        texts[n++] = text_triangle_vert;
        break;
    default:
        n = add_shader_that_meters(v, shader, n, texts);
        break;
    }
    return n;
}

/* lib/gles/gles_variant.h: which shaders a use of pupil_gles needs, as texts; what a use does not need is not in them.
 */
#ifndef PUPIL_GLES_VARIANT_H
#define PUPIL_GLES_VARIANT_H

#include "pupil/gles.h"

typedef struct gles_variant {
    uint32_t version; /* a pupil_gles_version: 30 or 31 */
    uint32_t pixel;   /* a pupil_pixel that can be an input */
    uint32_t source;  /* a pupil_gles_source */
    uint32_t normalized_16, half_size;
    uint32_t is_linear; /* Y'CbCr and RGB10A2: coded values are light; grey: no curve is looked up */
    uint32_t has_matrix, has_knees;
    uint32_t histogram;
    uint32_t veil;
    uint32_t level_here; /* the level is on the GPU */
} gles_variant;

/* Files of lib/gles/shaders, with what they include. */
typedef enum gles_shader {
    GLES_TRIANGLE_VERT = 0,
    GLES_METER_COMP,
    GLES_METER_FRAG,
    GLES_REDUCE_FRAG,
    GLES_SCATTER_VERT,
    GLES_SCATTER_FRAG,
    GLES_COUNT_FRAG,
    GLES_WEIGH_FRAG,
    GLES_ADAPT_COMP,
    GLES_ADAPT_FRAG,
    GLES_MAP_VERT,
    GLES_MAP_FRAG,
    GLES_MAP_SCALED_FRAG,
    GLES_SHADER_COUNT
} gles_shader;

/* "meter.comp" and so on, for messages. */
const char *pupil_gles_shader_name(uint32_t shader);

#define GLES_MOST_TEXTS 24

/* The texts that glShaderSource takes, constant ones; their number. */
uint32_t pupil_gles_shader_texts(const gles_variant *variant, uint32_t shader, const char *texts[GLES_MOST_TEXTS]);

#endif

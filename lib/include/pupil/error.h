/* pupil/error.h: what a refused call says.
 *
 * Every call that can be refused returns an int: 0 (PUPIL_OK) or one of the negative codes below. A refused call leaves
 * every object and every output untouched. Odd pixels (NaN, Inf, negative, zero, denormal) are never errors; stats.h
 * says what each of them counts as.
 *
 * Threads: every function here may be called from any thread at any time.
 */
#ifndef PUPIL_ERROR_H
#define PUPIL_ERROR_H

#include "pupil/abi.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PUPIL_OK = 0,
    PUPIL_ERR_NULL = -1,      /* a required pointer is NULL (the chroma plane of NV12 is one) */
    PUPIL_ERR_CONFIG = -2,    /* the configuration is refused; its check (pupil_config_check ...) says which field */
    PUPIL_ERR_OBJECT = -3,    /* the object was not made by its init (pupil_init ...) of this version */
    PUPIL_ERR_SIZE = -4,      /* width or height is 0, above PUPIL_MAX_SIDE_PX or not possible in the format, or in and
                               * out differ in size */
    PUPIL_ERR_STRIDE = -5,    /* rows would overlap: |stride| is smaller than one row of pixels */
    PUPIL_ERR_ALIGNMENT = -6, /* data or stride is not a multiple of the sample's size */
    PUPIL_ERR_PIXEL = -7,     /* the input's pixel format cannot be read, or is not that of gles.h's config */
    PUPIL_ERR_ROWS = -8,      /* rows outside the frame, or that split a pair (image.h), or a frame ended before each of
                               * its rows came once */
    PUPIL_ERR_ORDER = -9,     /* calls out of order: rows or end without a begin, or a second begin */
    PUPIL_ERR_NO_EXPOSURE = -10,  /* a curve was asked for before any frame was adapted to */
    PUPIL_ERR_NO_HISTOGRAM = -11, /* a quantile was asked of statistics gathered without a histogram */
    PUPIL_ERR_VALUE = -12,        /* an argument is NaN or outside its range */
    PUPIL_ERR_STATS = -13,        /* statistics that no metering can have produced, or of another frame height */
    PUPIL_ERR_CODING = -14,       /* pupil_coding_check refuses the image's coding, and says which field */
    PUPIL_ERR_GLES_ABSENT = -15,  /* gles.h: the library was built without OpenGL ES */
    PUPIL_ERR_GLES_VERSION = -16, /* ... the context lacks the version, a function or an extension that is needed */
    PUPIL_ERR_GLES_SHADER = -17,  /* ... the driver refuses a shader */
    PUPIL_ERR_GLES_MEMORY = -18,  /* ... the driver is out of memory */
    PUPIL_ERR_GLES_CONTEXT = -19, /* ... no context is current, or another one than at init */
    PUPIL_ERR_GLES_LOST = -20,    /* ... the context is lost */
    PUPIL_ERR_GLES = -21,         /* ... any other error of GL */
    PUPIL_ERR_SIZE_BYTES = -22,   /* abi.h: size_bytes of a struct matches no version, or it covers a field that is
                                   * set and that this version does not know */
    PUPIL_ERR_PIXEL_OUT = -23, /* the output's pixel format cannot be written; pupil_error_string has those that can */
    PUPIL_ERR_NO_LIGHT = -24   /* a mean, a quantile or a balance was asked of statistics that have none: no pixel was
                                * metered, or a channel has no light */
};

/* A sentence that says why a call failed, for calls that return more than a code. It is English, without a full stop,
 * ended by a zero byte. It names the file, the option or the field, and what would be right. A call that succeeds
 * leaves it unchanged. The pointer may be NULL: then there is no sentence. Frozen: longer sentences are cut. */
typedef struct pupil_why {
    char text[1024];
} pupil_why;

/* One sentence, in English, for any code above (and for any other number). Never NULL; points to constant text. */
PUPIL_API const char *pupil_error_string(int code);

#ifdef __cplusplus
}
#endif

#endif

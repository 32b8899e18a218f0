/* pupil/gles.h: metering and mapping on a GPU, in the caller's current OpenGL ES context.
 *
 * A second way to fill pupil_stats and to apply a pupil_curve. The adaptation remains in the pupil_t: pupil_adapt takes
 * statistics from any meter. So a frame may be metered here and mapped by the CPU, or the other way round.
 *
 *     pupil_gles_config config;
 *     pupil_gles gles;
 *     pupil_gles_config_default(&config);
 *     config.pixel = PUPIL_PIXEL_RGBA16F, config.width = 1920, config.height = 1080;
 *     pupil_gles_init(&gles, &config, &pupil, eglGetProcAddress, &why);
 *     for each frame:
 *         pupil_gles_upload(&gles, &in);
 *         pupil_gles_process(&gles, &pupil, &info, &target);
 *
 * Versions: OpenGL ES 3.1 (metering by a compute shader) or 3.0 (by fragment shaders into integer targets; the
 * histogram by points that blending counts). ES 2.0 is refused. External textures need an extension. In ES 3.0 a
 * histogram needs GL_EXT_color_buffer_half_float or GL_EXT_color_buffer_float, and is not available for external
 * textures. In ES 3.1 it counts every pixel. In ES 3.0 it counts one of each four rows, or of config.meter_rows of the
 * pupil_t, scaled to the weight of all; always the same rows, chosen pseudo-randomly. With config.meter_rows 1 it
 * counts all rows, and is exact, unless the frame has more than fit the context's largest texture (docs/gpu.md).
 * stats.peak is that of every pixel in both versions.
 * config.histogram_step is not read: on large frames the white point is that of the CPU with histogram_step 1, which is
 * not quite that of its default.
 *
 * Results: counts, weights and the histogram's total are exact. The log-average is within 1e-5 (relative) of the CPU's.
 * At most one mapped sample of 10,000 differs, by one code (docs/gpu.md). Rounding depends on the GPU, so two GPUs may
 * give different bits.
 *
 * Nothing waits: statistics come through a ring of buffers, each read only after its fence has signalled. So they reach
 * pupil_adapt at least a frame late. Only pupil_gles_collect with a timeout may wait.
 *
 * GL state: nothing is restored. init, retune, upload, meter, collect, process and map change:
 *
 * - program, vertex array, active texture; the 2D (external) bindings and samplers of units 0..6;
 * - pixel packing and unpacking and their buffers; copy write, uniform, shader storage and framebuffer bindings;
 * - viewport, scissor, clear colour, colour mask;
 * - with a histogram in ES 3.0, blend function and equation;
 * - off afterwards: blending, depth, stencil, cull, dither, polygon offset, rasterizer discard, alpha-to-coverage,
 *   sample coverage and sample mask.
 *
 * Other state that the caller sets has no effect, but transform feedback must not be active. A GL error that was
 * pending before a call is reported as the call's own. Only init and retune make GL objects.
 *
 * Memory: the caller owns the object. It has a fixed size and must not be copied or moved, because it refers to objects
 * of one context. Nothing is allocated here; the driver may allocate.
 *
 * Errors: a refused call leaves the object as it was. Where `why` is given it gets a sentence; `why` may be NULL.
 * PUPIL_ERR_GLES_CONTEXT: no context is current, or another one than at init (detected if get_proc finds
 * eglGetCurrentContext, as EGL 1.5 does). PUPIL_ERR_GLES_LOST: the context is lost (detected if it was made with reset
 * notification). After either the pupil_t still has its level. pupil_process then continues with the CPU where the GPU
 * stopped, and so does another pupil_gles_init in a new context.
 *
 * Threads: one thread at a time, in which the context is current.
 */
#ifndef PUPIL_GLES_H
#define PUPIL_GLES_H

#include "pupil/error.h"
#include "pupil/pupil.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Finds an entry point of GL or EGL by its name: eglGetProcAddress is one. */
typedef void (*pupil_gles_function)(void);
typedef pupil_gles_function (*pupil_gles_get_proc)(const char *name);

typedef enum pupil_gles_version {
    PUPIL_GLES_BEST = 0, /* default: 3.1 where the context has it and its compute shaders build, or else 3.0 */
    PUPIL_GLES_ES30 = 30,
    PUPIL_GLES_ES31 = 31
} pupil_gles_version;

/* Where a frame's texels come from. */
typedef enum pupil_gles_source {
    PUPIL_GLES_MEMORY = 0, /* default: pupil_gles_upload copies images into textures made by init */
    PUPIL_GLES_TEXTURES,   /* pupil_gles_use names the caller's GL_TEXTURE_2D, for instance dma-bufs */
    PUPIL_GLES_EXTERNAL, /* pupil_gles_use names one GL_TEXTURE_EXTERNAL_OES, whose driver converts its content to RGB.
                          * config.pixel is RGBA8; coding.light says how it is coded, as for RGB10A2. Needs
                          * GL_OES_EGL_image_external_essl3 */
    PUPIL_GLES_SOURCE_COUNT
} pupil_gles_source;

/* Which state maps a frame. */
typedef enum pupil_gles_adapt {
    PUPIL_GLES_ADAPT_CPU = 0, /* default: every law. A frame is mapped by the newest statistics that have come back,
                               * which are at least a frame old */
    PUPIL_GLES_ADAPT_GPU,     /* a frame is mapped by its own light, without a round trip. Only with PUPIL_LAW_SECONDS,
                               * no trimming, a white that does not follow, Reinhard's curve, no key_points, and
                               * highlight_ev 0 or no histogram. Temporal flicker is not removed. The state on the GPU
                               * is an integer, within 2e-6 stops of the CPU's with config.flicker 0
                               * (docs/numerics.md). Statistics still come back, so the pupil_t follows and can take
                               * over */
    PUPIL_GLES_ADAPT_COUNT
} pupil_gles_adapt;

/* Textures that pupil_gles_use takes for a format (init makes the same for memory). 8-bit formats are normalised:
 *     RGBA32F, RGB32F, BGR32F    float: RGBA32F, RGB32F
 *     RGBA16F, RGB16F            float, as named
 *     RGBA16, RGB16              RGBA16UI, RGB16UI
 *     RGBA8, RGBX8, BGRX8        RGBA8; not the SRGB8 kinds
 *     RGB8, BGR8                 RGB8
 *     RGB10A2                    RGB10_A2
 *     YUYV, UYVY                 RG8, width + width % 2 texels wide
 *     NV12, NV21, NV16           R8, and RG8 of (width + 1) / 2 by pupil_chroma_rows
 *     P010                       as NV12, with R16UI and RG16UI; with config.normalized_16, R16 and RG16
 *     I420, I420_10              as NV12 and P010, with one channel for Cb and one for Cr
 *     I444_16                    R16UI for each plane, of the frame's size; with config.normalized_16, R16
 *     GREY8, BAYER8              R8
 *     GREY10..16, BAYER10..16    R16UI; with config.normalized_16, R16
 *     GREY10P..BAYER12P          R8, pupil_row_bytes texels wide
 * Shaders read red from r, Y' of YUYV and UYVY from r, and Cb from r: where memory has another order (BGR8, BGRX8,
 * BGR32F, UYVY, NV21), set GL_TEXTURE_SWIZZLE_R and so on of the texture. dma-bufs are imported in the shaders' order.
 */
typedef struct pupil_gles_config {
    uint32_t size_bytes;    /* abi.h; filled in by pupil_gles_config_default */
    uint32_t version;       /* a pupil_gles_version; best */
    uint32_t source;        /* a pupil_gles_source; memory */
    uint32_t adapt;         /* a pupil_gles_adapt; CPU */
    uint32_t pixel;         /* a pupil_pixel that can be an input; to be chosen */
    uint32_t width, height; /* of every frame, pixels; to be chosen */
    uint32_t normalized_16; /* 1: textures of 16-bit samples are R16 and RG16 (GL_EXT_texture_norm16, dma-bufs); 0 */
    uint32_t half_size;     /* 1: a mosaic is mapped quad by quad, to a picture of half its size; 0 */
    uint32_t scaled;        /* 1: targets may have another size than the picture; 0 */
    const pupil_coding *coding; /* of every frame, copied by pupil_gles_init; NULL: all zero */
    uint32_t veil;              /* 1: frames are mapped with the veil that pupil_gles_veil sets; 0; not for mosaics */
    uint32_t reserved;          /* 0 */
} pupil_gles_config;

/* Fills in every field with its default. */
PUPIL_API void pupil_gles_config_default_sized(pupil_gles_config *config, size_t config_bytes);
static inline void pupil_gles_config_default(pupil_gles_config *config)
{
    pupil_gles_config_default_sized(config, sizeof *config);
}

/* Orientation of the picture in the target: EXIF's orientations 1 to 8, less one. */
typedef enum pupil_gles_orientation {
    PUPIL_GLES_UPRIGHT = 0,
    PUPIL_GLES_MIRRORED, /* left and right swapped */
    PUPIL_GLES_ROTATED_180,
    PUPIL_GLES_FLIPPED,    /* top and bottom swapped */
    PUPIL_GLES_TRANSPOSED, /* rows become columns */
    PUPIL_GLES_ROTATED_90, /* clockwise: upright, from a camera that was turned to its left */
    PUPIL_GLES_TRANSVERSED,
    PUPIL_GLES_ROTATED_270,
    PUPIL_GLES_ORIENTATION_COUNT
} pupil_gles_orientation;

typedef enum pupil_gles_fit {
    PUPIL_GLES_LETTERBOX = 0, /* all of the picture, its shape kept, the rest black */
    PUPIL_GLES_FILL,          /* all of the target, the picture's shape kept, its rest cut off */
    PUPIL_GLES_STRETCH,       /* all of both */
    PUPIL_GLES_FIT_COUNT
} pupil_gles_fit;

/* Where a mapped frame goes: a framebuffer with an 8-bit RGBA colour attachment that is not of an SRGB8 kind. Sizes
 * other than the rotated picture's are drawn with four samples a pixel, averaged as display codes. At half the size and
 * less, details may flicker. */
typedef struct pupil_gles_target {
    uint32_t size_bytes;    /* abi.h; or 0 */
    uint32_t framebuffer;   /* 0: the window's */
    int32_t x, y;           /* the rectangle that it may use; y counts from the framebuffer's first row */
    uint32_t width, height; /* 1..PUPIL_MAX_SIDE_PX */
    uint32_t top_first;     /* 1: the framebuffer's first row is the picture's top, as in memory and dma-bufs; 0: its
                             * bottom, as a window shows it */
    uint32_t orientation;   /* a pupil_gles_orientation */
    uint32_t fit;           /* a pupil_gles_fit; used where config.scaled is */
    float from, to;         /* the part of the rectangle's width that is drawn, 0..1; the rest is left as it is, for a
                             * split screen; both 0: all */
} pupil_gles_target;

#define PUPIL_GLES_OBJECT_BYTES 16384

/* The object. Its content is private; its size is part of the ABI. */
typedef union pupil_gles {
    uint64_t private_words[PUPIL_GLES_OBJECT_BYTES / 8];
} pupil_gles;

/* --- life --- */

/* Compiles the shaders and makes every GL object for frames of one size and format, with the settings and the adapted
 * level of `pupil`. `gles` may be any bytes, but not an object that is open.
 * PUPIL_ERR_GLES_ABSENT: the library was built without GLES. PUPIL_ERR_GLES_VERSION: the context is not of the
 * requested version, or lacks a function or an extension, which `why` names. PUPIL_ERR_GLES_SHADER, _MEMORY.
 * PUPIL_ERR_SIZE: larger than the context's textures can be. PUPIL_ERR_CONFIG: a setting of config or of pupil that is
 * not available: another law with PUPIL_GLES_ADAPT_GPU; grey_world; a histogram, or a setting that needs one, where
 * there is none (above). PUPIL_ERR_PIXEL, _CODING. After an error nothing is left behind. Every row is metered,
 * regardless of config.meter_rows of pupil. */
PUPIL_API int pupil_gles_init(pupil_gles *gles, const pupil_gles_config *config, const pupil_t *pupil,
                              pupil_gles_get_proc get_proc, pupil_why *why);

/* After pupil_retune or pupil_reset: takes over the new settings and the level. Compiles the affected shaders again;
 * statistics in progress are dropped. Errors as of init; the old settings then stay. */
PUPIL_API int pupil_gles_retune(pupil_gles *gles, const pupil_t *pupil, pupil_why *why);

/* Another white balance (pupil_coding.balance) for the mosaics that are metered and mapped from now on: for a balance
 * that follows the frames. Nothing is compiled, and statistics in progress are kept. PUPIL_ERR_CODING. */
PUPIL_API int pupil_gles_balance(pupil_gles *gles, const float balance[3]);

/* With config.veil: the veil of the frames that are mapped from now on (veil.h): `nodes` from pupil_veil_get_nodes,
 * `direct` from pupil_veil_result. Before the first veil nothing is mapped (PUPIL_ERR_ORDER). The picture is that of
 * pupil_veil_map_rows, as exact as any other; the light is gathered on the CPU. PUPIL_ERR_ORDER: config.veil is 0.
 * PUPIL_ERR_VALUE: direct is not from 0 to 1. */
PUPIL_API int pupil_gles_veil(pupil_gles *gles, const float *nodes, float direct);

/* Deletes the GL objects (where the context is current and not lost) and the object. NULL, and twice, is allowed. */
PUPIL_API void pupil_gles_close(pupil_gles *gles);

/* --- a frame's texels --- */

/* PUPIL_GLES_MEMORY: an image of the config's size and format, any stride; its coding is not read. PUPIL_ERR_SIZE,
 * _PIXEL, _STRIDE, _ALIGNMENT. */
PUPIL_API int pupil_gles_upload(pupil_gles *gles, const pupil_image_const *image);

/* PUPIL_GLES_TEXTURES and _EXTERNAL: textures that the calls from now on read, one for each plane (pupil_pixel_planes;
 * else 0). They stay the caller's. */
PUPIL_API int pupil_gles_use(pupil_gles *gles, uint32_t texture, uint32_t chroma_texture, uint32_t cr_texture);

/* --- a frame at once --- */

/* Takes the statistics that have come back into `pupil` (pupil_adapt, in the frames' order), meters the frame and maps
 * it. `info` may be NULL. Before the first statistics are back, a frame is mapped at the key itself (scale 1), except
 * with PUPIL_GLES_ADAPT_GPU. Where the GPU is more than three frames behind, a frame is mapped but not metered
 * (pupil_gles_status.unmetered). */
PUPIL_API int pupil_gles_process(pupil_gles *gles, pupil_t *pupil, const pupil_frame_info *info,
                                 const pupil_gles_target *target);

/* --- metering and mapping apart --- */

/* Hands the metering of the frame to the GPU, and with PUPIL_GLES_ADAPT_GPU the adaptation too. PUPIL_GLES_BUSY: not
 * metered, because three frames are still in progress. */
PUPIL_API int pupil_gles_meter(pupil_gles *gles, const pupil_frame_info *info);

/* Not errors: nothing (more) has come back; three frames are in progress. */
enum { PUPIL_GLES_NOTHING = 1, PUPIL_GLES_BUSY = 2 };

/* The oldest statistics that have come back, with the info of their frame: PUPIL_OK, or PUPIL_GLES_NOTHING. Waits at
 * most timeout_ns; 0 never waits. `info` may be NULL. */
PUPIL_API int pupil_gles_collect_sized(pupil_gles *gles, uint64_t timeout_ns, pupil_stats *stats, size_t stats_bytes,
                                       pupil_frame_info *info, size_t info_bytes);
static inline int pupil_gles_collect(pupil_gles *gles, uint64_t timeout_ns, pupil_stats *stats, pupil_frame_info *info)
{
    return pupil_gles_collect_sized(gles, timeout_ns, stats, sizeof *stats, info, sizeof *info);
}

/* Maps the frame. `curve` NULL: with the level on the GPU (PUPIL_GLES_ADAPT_GPU). */
PUPIL_API int pupil_gles_map(pupil_gles *gles, const pupil_curve *curve, const pupil_gles_target *target);

/* --- results --- */

typedef struct pupil_gles_status {
    uint32_t size_bytes;  /* abi.h */
    uint32_t version;     /* PUPIL_GLES_ES30 or _ES31 */
    uint32_t under_way;   /* frames metered whose statistics were not collected yet */
    uint32_t level_known; /* 1: level_q24 is the GPU's, which has had a valid frame */
    uint64_t metered;     /* frames handed to the GPU since init */
    uint64_t unmetered;   /* frames for which pupil_gles_meter found the ring full */
    int64_t level_q24;    /* ADAPT_GPU: the level (2^-24 stops) on the GPU after the last frame that was collected */
} pupil_gles_status;

PUPIL_API int pupil_gles_get_status_sized(const pupil_gles *gles, pupil_gles_status *status, size_t status_bytes);
static inline int pupil_gles_get_status(const pupil_gles *gles, pupil_gles_status *status)
{
    return pupil_gles_get_status_sized(gles, status, sizeof *status);
}

#ifdef __cplusplus
}
#endif

#endif

/* pupil/veil.h: veiling glare, the light that scatters in an eye or a lens and lifts the whole picture.
 *
 * When not to use it: on pictures of a camera. Its lens and sensor have added their own veiling glare already, and a
 * second one only costs contrast. It is for pictures without a lens: rendered ones, and HDR ones that were merged and
 * corrected for glare, in which a lamp should look as bright as it did to an eye at the scene.
 *
 *     pupil_veil_config config;
 *     pupil_veil_config_default(&config);
 *     config.width = 1920, config.height = 1080, config.fov_deg = 54;
 *     pupil_veil_init(&veil, &config);
 *     for each frame:
 *         pupil_stats_clear(&stats), pupil_veil_light_clear(&light);
 *         pupil_veil_gather_rows(&veil, &pupil, &in, 0, &stats, &light);   meters and gathers in one pass
 *         pupil_adapt(&pupil, &stats, &info), pupil_get_curve(&pupil, &info, &curve);
 *         pupil_veil_begin(&veil);
 *         pupil_veil_add_light(&veil, &light);
 *         pupil_veil_solve(&veil);
 *         pupil_veil_map_rows(&veil, &pupil, &curve, &in, &out, &scratch);
 *
 * The picture that is mapped is, in linear light,
 *     direct * v(x, y) + sum over all pixels of v(x', y') * PSF(distance)
 * where PSF is the wide part of a point spread function (PSF) and `direct` the share that stays in place. So light is
 * moved and none is added. Light scattered beyond the picture's edges is lost, and no light comes from there.
 *
 * The wide part. A PSF is a sum of Gaussians (lobes), their standard deviations a factor of 1.6 apart. Those of
 * pupil_veil_result.narrowest_px and more are the veil; narrowest_px is a tenth of the picture's long side or a little
 * less, and 2 pixels or more. The narrower ones are bloom: their light stays in place here, and pupil_veil_result lists
 * them for bloom.h. Angles are those of the flat picture: right in its middle, and wrong at the edges of wide ones.
 * Where this would add light (with an eye from a hundred degrees or so on), all lobes are weakened so that it does not.
 *
 * How: the frame is gathered into 64 x 64 cells, each with the sums of its light and their first moments, so that a
 * lamp that moves makes no steps. The veil is a Fourier series with a period of twice the picture (config.period), so
 * that no light wraps around from the other edge. One table of coefficients has all lobes. The series is evaluated at
 * 65 x 65 nodes, and is bilinear between them. So a frame's cost does not depend on the number of lights or lobes.
 * Errors against the sum over all pixels: docs/look.md.
 *
 * Known lights, such as lens ghosts, may be added by formula (pupil_veil_add_bells): each is a bell on the picture.
 *
 * Units: pixels are counted from the picture's upper left corner; the first one's middle is at (0.5, 0.5). Light is in
 * the frame's unit (image.h: White).
 *
 * What odd pixels count as: a channel below 0 or NaN is gathered as 0, one above 2^30 as 2^30.
 *
 * Memory: the caller owns every byte. The objects have fixed sizes and no pointers; nothing is allocated. Each thread
 * has a pupil_veil_light and a pupil_veil_scratch of its own.
 *
 * Determinism: the gathered light is integers, so rows may be gathered in any groups, order and threads. The same
 * frames give the same bits on every CPU.
 *
 * Threads: calls that take a `const pupil_veil *` may run at the same time on one object.
 */
#ifndef PUPIL_VEIL_H
#define PUPIL_VEIL_H

#include "pupil/error.h"
#include "pupil/image.h"
#include "pupil/pupil.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Point spread functions, in 1/sr, of an angle t in degrees. Each is divided by its integral over the hemisphere. */
typedef enum pupil_veil_psf {
    PUPIL_VEIL_SPENCER = 0, /* default: the photopic eye of Spencer, Shirley, Zimmerman, Greenberg: Physically-Based
                             * Glare Effects for Digital Images, 1995:
                             *     0.384 * 2.61e6 exp(-(t/0.02)^2)
                             *     + 0.478 * 20.91/(t + 0.02)^3 + 0.138 * 72.37/(t + 0.02)^2
                             * The lenticular halo, which is coloured, is left out */
    PUPIL_VEIL_CIE,         /* CIE 135/1:1999 and 146:2002, by age A and pigment p (Vos, van den Berg: Report on
                             * Disability Glare, 1999, total glare function):
                             *     (1 - 0.08 a) (9.2e6/(1 + (t/0.0046)^2)^1.5 + 1.5e5/(1 + (t/0.045)^2)^1.5)
                             *     + (1 + 1.6 a) (400/(1 + (t/0.1)^2) + 3e-8 t^2
                             *                    + p (1300/(1 + (t/0.1)^2)^1.5 + 0.8/(1 + (t/0.1)^2)^0.5))
                             *     + 2.5e-3 p,    a = (A/70)^4 */
    PUPIL_VEIL_GAUSSIANS,   /* config.gaussian */
    PUPIL_VEIL_PSF_COUNT
} pupil_veil_psf;

#define PUPIL_VEIL_MOST_GAUSSIANS 24u
#define PUPIL_VEIL_MOST_HARMONICS 32u
#define PUPIL_VEIL_CELLS          64u
#define PUPIL_VEIL_NODES          65u

/* exp(-r^2 / (2 sigma^2)), scaled so that its integral over the plane is `weight` of the light. Frozen: elements of
 * arrays. */
typedef struct pupil_veil_gaussian {
    double sigma; /* degrees in the configuration, pixels in the result */
    double weight;
} pupil_veil_gaussian;

typedef struct pupil_veil_config {
    uint32_t size_bytes;    /* abi.h; filled in by pupil_veil_config_default */
    uint32_t psf;           /* a pupil_veil_psf; Spencer */
    uint32_t width, height; /* of every frame, pixels, 1..PUPIL_MAX_SIDE_PX; to be chosen */
    double fov_deg;         /* the angle from the picture's left to its right edge, seen from the camera, in degrees;
                             * 54, as of a 35 mm lens on small film; 0.1..150 */
    double age_years;       /* CIE: 25; 1..120 */
    double pigment;         /* CIE: of the iris, 0 black, 0.5 brown, 1 blue, 1.2 very light; 0.5; 0..1.2 */
    double period;          /* of the series, in widths and heights; 2, the least with a PSF; 1..4 */
    uint32_t harmonics;     /* of the series in x and in y; 16; 1..PUPIL_VEIL_MOST_HARMONICS */
    uint32_t gaussians;     /* PUPIL_VEIL_GAUSSIANS: how many; 0 is no PSF at all, for pupil_veil_add_bells alone */
    pupil_veil_gaussian gaussian[PUPIL_VEIL_MOST_GAUSSIANS]; /* sigma 1e-4..180 degrees, weight 0..1, together 1 at
                                                              * most; the rest of 1 stays in place */
} pupil_veil_config;

/* Fills in every field with its default. */
PUPIL_API void pupil_veil_config_default_sized(pupil_veil_config *config, size_t config_bytes);
static inline void pupil_veil_config_default(pupil_veil_config *config)
{
    pupil_veil_config_default_sized(config, sizeof *config);
}

/* PUPIL_OK or PUPIL_ERR_CONFIG. `why` may be NULL; else *why is a sentence (constant text) that names the first wrong
 * field and what would be right. */
PUPIL_API int pupil_veil_config_check(const pupil_veil_config *config, const char **why);

#define PUPIL_VEIL_OBJECT_BYTES  278528
#define PUPIL_VEIL_LIGHT_BYTES   299264
#define PUPIL_VEIL_SCRATCH_BYTES 28672

/* The object: coefficients, the series, its nodes. Its content is private; its size is part of the ABI. */
typedef union pupil_veil {
    uint64_t private_words[PUPIL_VEIL_OBJECT_BYTES / 8];
} pupil_veil;

/* The gathered light of a frame, or of some of its rows. */
typedef union pupil_veil_light {
    uint64_t private_words[PUPIL_VEIL_LIGHT_BYTES / 8];
} pupil_veil_light;

/* Room for pupil_veil_map_rows; any bytes. */
typedef union pupil_veil_scratch {
    uint64_t private_words[PUPIL_VEIL_SCRATCH_BYTES / 8];
} pupil_veil_scratch;

/* Makes an object out of any bytes, with no light yet: its veil is 0. Computes the table of coefficients, which takes
 * about a millisecond. PUPIL_ERR_CONFIG: see pupil_veil_config_check. */
PUPIL_API int pupil_veil_init(pupil_veil *veil, const pupil_veil_config *config);

#define PUPIL_VEIL_MOST_LOBES 32u
typedef struct pupil_veil_result {
    uint32_t size_bytes;   /* abi.h */
    uint32_t lobes;        /* how many of `lobe` */
    double direct;         /* the share of light that stays in place, including that of `lobe` */
    double narrowest_px;   /* standard deviation of the veil's narrowest lobe */
    double degrees_per_px; /* in the picture's middle */
    pupil_veil_gaussian lobe[PUPIL_VEIL_MOST_LOBES]; /* the narrower ones, of 0.12 pixels and more, from wide to narrow:
                                                      * bloom. Sigma in pixels */
} pupil_veil_result;

PUPIL_API int pupil_veil_get_sized(const pupil_veil *veil, pupil_veil_result *result, size_t result_bytes);
static inline int pupil_veil_get(const pupil_veil *veil, pupil_veil_result *result)
{
    return pupil_veil_get_sized(veil, result, sizeof *result);
}

/* --- the frame's own light --- */

PUPIL_API int pupil_veil_light_clear(pupil_veil_light *light);

/* Gathers a group of whole rows, the first being row `first_row` of the frame, and adds them to `light`. With `stats`
 * (which may be NULL) they are metered too, as by pupil_meter_rows, while they are in the cache. Mosaics are refused
 * (PUPIL_ERR_PIXEL): they are a camera's. PUPIL_ERR_SIZE: another width than config's. PUPIL_ERR_ROWS: more rows than
 * the frame has, or as of pupil_meter_rows. PUPIL_ERR_OBJECT: light of a frame of another size. */
PUPIL_API int pupil_veil_gather_rows(const pupil_veil *veil, const pupil_t *pupil, const pupil_image_const *rows,
                                     uint32_t first_row, pupil_stats *stats, pupil_veil_light *light);

/* Adds another worker's light. PUPIL_ERR_ROWS: together more rows than the frame has. */
PUPIL_API int pupil_veil_light_add(pupil_veil_light *light, const pupil_veil_light *other);

/* --- the series --- */

/* A new frame: no light. */
PUPIL_API int pupil_veil_begin(pupil_veil *veil);

/* Adds the veil of a frame's light. PUPIL_ERR_ROWS: some of its rows are missing. */
PUPIL_API int pupil_veil_add_light(pupil_veil *veil, const pupil_veil_light *light);

/* Bells of height 1 around (0, 0), R being the radius. */
typedef enum pupil_veil_bell {
    PUPIL_VEIL_BAND = 0,  /* 1 - (x/R)^2 for |x| < R: a band from top to bottom */
    PUPIL_VEIL_QUADRATIC, /* (1 - (x/R)^2) (1 - (y/R)^2) for |x|, |y| < R */
    PUPIL_VEIL_COSINE,    /* cos(pi x / 2R)^2 cos(pi y / 2R)^2 for |x|, |y| < R */
    PUPIL_VEIL_DISC,      /* 1 - (x^2 + y^2) / R^2 where that is above 0; its coefficients are 4 pi R^2 J2(z) / z^2 */
    PUPIL_VEIL_GAUSSIAN,  /* exp(-(x^2 + y^2) / (2 s^2)), s = R / 4, cut at |x|, |y| = R */
    PUPIL_VEIL_BELL_COUNT
} pupil_veil_bell;

/* One of them. Frozen: elements of the caller's array. */
typedef struct pupil_veil_spot {
    double x_px, y_px; /* its middle; may move from frame to frame, and be outside of the picture */
    float rgb[3];      /* light in its middle; 0..2^30 */
    uint32_t reserved; /* 0 */
} pupil_veil_spot;

/* Adds bells of one shape and radius. The cost of a pixel does not depend on `count`; each bell costs its
 * (2 harmonics + 1)^2 terms. The harmonics limit how exact a bell is: docs/look.md has the errors. PUPIL_ERR_VALUE: a
 * value out of range, or a spot that would wrap around from the other edge: x_px + R may be at most the period
 * (config.period * width), x_px - R at least the width less the period; y likewise (not for bands). */
PUPIL_API int pupil_veil_add_bells(pupil_veil *veil, uint32_t bell, double radius_px, const pupil_veil_spot *spot,
                                   size_t count);

/* Evaluates the series at the nodes, which pupil_veil_map_rows and pupil_veil_get_nodes use. Values below 0, which a
 * series has around steep bells, become 0. */
PUPIL_API int pupil_veil_solve(pupil_veil *veil);

/* --- the picture --- */

/* The nodes: 65 rows of 65, each red, green and blue, so 12675 floats. Node (i, j) is at (i * width / 64, j * height /
 * 64). They are what a shader needs (gles.h: pupil_gles_veil). */
PUPIL_API int pupil_veil_get_nodes(const pupil_veil *veil, float *rgb);

/* pupil_map_rows of the picture with its veil. curve->first_row is the frame's row that `rows` begins with.
 * PUPIL_ERR_SIZE: another width than config's. PUPIL_ERR_ROWS: rows outside the frame. PUPIL_ERR_PIXEL: a mosaic. */
PUPIL_API int pupil_veil_map_rows(const pupil_veil *veil, const pupil_t *pupil, const pupil_curve *curve,
                                  const pupil_image_const *rows, const pupil_image *out, pupil_veil_scratch *scratch);

/* The series itself at the middles of the pixels of rows first_row to first_row + count, without nodes: 3 * width
 * floats a row. For studies, and for bells that are too narrow for nodes: a pixel's channel costs 2 * harmonics + 1
 * multiplications. Values below 0 are kept. */
PUPIL_API int pupil_veil_evaluate_rows(pupil_veil *veil, uint32_t first_row, uint32_t count, float *rgb);

#ifdef __cplusplus
}
#endif

#endif

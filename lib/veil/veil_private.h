/* lib/veil/veil_private.h: what is inside a pupil_veil, and its parts. */
#ifndef PUPIL_VEIL_VEIL_PRIVATE_H
#define PUPIL_VEIL_VEIL_PRIVATE_H

#include "pupil/veil.h"

#include "kernels/kernels.h"

enum {
    VEIL_CELLS = (int)PUPIL_VEIL_CELLS,
    VEIL_NODES = (int)PUPIL_VEIL_NODES,
    VEIL_WAVES = (int)PUPIL_VEIL_MOST_HARMONICS + 1,     /* harmonics and the constant */
    VEIL_TERMS = 2 * (int)PUPIL_VEIL_MOST_HARMONICS + 1, /* 1, cos 1, sin 1, cos 2, ... */
    /* rounded up, so that vector loops have no remainder */
    VEIL_TERM_ROOM = 72,
    VEIL_NODE_ROOM = 72,
    VEIL_COLUMNS = 16
};

#define VEIL_PI         0x1.921fb54442d18p+1
#define VEIL_STERADIANS 3.0461741978670857e-4 /* of a square degree: (pi / 180)^2 */

/* Waves by harmonics in y and in x: what one unit of light in (0, 0) adds to cos(m y) cos(n x). */
typedef float veil_table[VEIL_WAVES][VEIL_WAVES];
/* Terms in y, each a row of those in x. */
typedef float veil_terms[VEIL_TERMS][VEIL_TERM_ROOM];

typedef struct veil_object {
    uint64_t magic;
    pupil_veil_config config;
    pupil_veil_result result;
    uint32_t terms; /* 2 harmonics + 1 */
    uint32_t bell;  /* bell_table is of this one; PUPIL_VEIL_BELL_COUNT: of none */
    double bell_radius_px;
    veil_table psf_table, bell_table;
    float cell[VEIL_CELLS][VEIL_TERM_ROOM],
        cell_slope[VEIL_CELLS][VEIL_TERM_ROOM]; /* terms in the cells' middles, and
                                                 * how much more a cell further on */
    float node[VEIL_TERMS][VEIL_NODE_ROOM];     /* terms at the nodes */
    veil_terms series[3];
    float solved[3][VEIL_NODES][VEIL_NODE_ROOM];
    veil_terms work[3];
    float column[VEIL_TERMS][VEIL_COLUMNS]; /* terms at some pixels */
} veil_object;

_Static_assert(sizeof(veil_object) <= sizeof(pupil_veil), "PUPIL_VEIL_OBJECT_BYTES is too small");

/* A cell's light: the sum of v * 2^(32 - shift), and that times the distance from its middle in cells. 2^shift pixels
 * are no fewer than a cell's, so that the sums stay below 2^62. */
typedef struct veil_cell {
    int64_t sum[3], x[3], y[3];
} veil_cell;

typedef struct veil_light_object {
    uint64_t magic;
    uint32_t width, height; /* of the frame; 0, 0 where no row is there yet */
    uint32_t rows, reserved;
    pupil_planes planes; /* scratch of the worker that gathers */
    veil_cell cell[VEIL_CELLS][VEIL_CELLS];
} veil_light_object;

_Static_assert(sizeof(veil_light_object) <= sizeof(pupil_veil_light), "PUPIL_VEIL_LIGHT_BYTES is too small");

/* "veil", "glim" and the object's size: another version's object is refused. */
#define VEIL_MAGIC       (UINT64_C(0x7665696c00000000) + sizeof(veil_object))
#define VEIL_LIGHT_MAGIC (UINT64_C(0x676c696d00000000) + sizeof(veil_light_object))

static inline veil_object *pupil_veil_object_of(pupil_veil *veil)
{
    return (veil_object *)(void *)veil;
}

static inline const veil_object *pupil_veil_object_of_const(const pupil_veil *veil)
{
    return (const veil_object *)(const void *)veil;
}

/* PUPIL_OK, PUPIL_ERR_NULL or PUPIL_ERR_OBJECT. */
static inline int pupil_veil_check(const pupil_veil *veil)
{
    if (!veil)
        return PUPIL_ERR_NULL;
    return pupil_veil_object_of_const(veil)->magic == VEIL_MAGIC ? PUPIL_OK : PUPIL_ERR_OBJECT;
}

/* Cell i holds the pixels whose middles are in it: this is its first one; for the cell behind the last it is width. */
static inline uint32_t pupil_veil_first_in_cell(uint32_t cell, uint32_t width)
{
    return (cell * width + VEIL_CELLS / 2 - 1) / VEIL_CELLS; /* the smallest x with (2x + 1) * 64 / (2 width) >= cell */
}

static inline uint32_t pupil_veil_cell_of(uint32_t x, uint32_t width)
{
    return (2 * x + 1) * VEIL_CELLS / (2 * width);
}

/* veil_gather.c: a power of two that is no fewer than a cell's pixels. */
double pupil_veil_cell_pixels(uint32_t width, uint32_t height);

/* veil_psf.c: a lobe of the veil: height * exp(-r^2 / (2 sigma^2)), in pixels. */
typedef struct veil_lobe {
    double sigma_px, height;
} veil_lobe;
enum { VEIL_MOST_WIDE = 26 };
/* The wide lobes, and result, from the configuration; how many. */
uint32_t pupil_veil_lobes(const pupil_veil_config *config, pupil_veil_result *result, veil_lobe lobe[VEIL_MOST_WIDE]);

/* veil_table.c */
void pupil_veil_fill_psf(veil_object *o, const veil_lobe *lobe, uint32_t lobes);
void pupil_veil_fill_bell(veil_object *o, uint32_t bell, double radius_px);

/* veil_series.c */
/* The terms at a number of turns of the first harmonic. */
void pupil_veil_terms_at(double turns, uint32_t terms, float *term);
void pupil_veil_fill_places(veil_object *o);
/* series[channel] += table * light: light in terms becomes glare. */
void pupil_veil_spread(veil_object *o, const veil_table table, const veil_terms light, int channel);

#endif

/* The series: light into it, and its values at the nodes and along rows. */
#include "veil_private.h"

#include "base/numeric.h"

#define LEAST_UNIT 0x1p-32 /* of veil_cell */

/* --- terms --- */

void pupil_veil_terms_at(double turns, uint32_t terms, float *term)
{
    double cosine, sine, c = 1.0, s = 0.0;
    pupil_circle(turns, &cosine, &sine);
    term[0] = 1.0f;
    for (uint32_t k = 1; k < terms; k += 2) {
        const double next = c * cosine - s * sine;
        s = s * cosine + c * sine;
        c = next;
        term[k] = (float)c;
        term[k + 1] = (float)s;
    }
}

void pupil_veil_fill_places(veil_object *o)
{
    const double turns_a_cell = 1.0 / (VEIL_CELLS * o->config.period);
    float at_node[VEIL_TERMS];
    for (int i = 0; i < VEIL_CELLS; i++) {
        float *term = o->cell[i], *slope = o->cell_slope[i];
        pupil_veil_terms_at((i + 0.5) * turns_a_cell, o->terms, term);
        for (uint32_t k = 1; k < o->terms; k += 2) {
            const float rate = (float)(2.0 * VEIL_PI * turns_a_cell * ((k + 1) / 2));
            slope[k] = -rate * term[k + 1];
            slope[k + 1] = rate * term[k];
        }
    }
    for (int i = 0; i < VEIL_NODES; i++) {
        pupil_veil_terms_at(i * turns_a_cell, o->terms, at_node);
        for (uint32_t k = 0; k < o->terms; k++)
            o->node[k][i] = at_node[k];
    }
}

static void clear(veil_terms terms)
{
    for (int l = 0; l < VEIL_TERMS; l++)
        for (int k = 0; k < VEIL_TERM_ROOM; k++)
            terms[l][k] = 0.0f;
}

void pupil_veil_spread(veil_object *o, const veil_table table, const veil_terms light, int channel)
{
    for (uint32_t l = 0; l < o->terms; l++)
        for (uint32_t k = 0; k < o->terms; k++)
            o->series[channel][l][k] += table[(l + 1) / 2][(k + 1) / 2] * light[l][k];
}

int pupil_veil_begin(pupil_veil *veil)
{
    const int error = pupil_veil_check(veil);
    for (int channel = 0; !error && channel < 3; channel++)
        clear(pupil_veil_object_of(veil)->series[channel]);
    return error;
}

/* --- a frame's light --- */

typedef const float term_row[VEIL_TERM_ROOM];

/* Rows of terms and the weight of each; and, if there are any, of slopes. */
typedef struct weighted_rows {
    term_row *term, *slope; /* slope NULL: none */
    const float *by, *by_slope;
    uint32_t rows;
} weighted_rows;

/* Each addition waits for the one before it in its column, so some vectors of columns are added up at a time. */
enum { LANES = 4, VECTORS = 6 };
typedef float lanes __attribute__((vector_size(4 * LANES)));

static inline __attribute__((always_inline)) void add_vectors(const weighted_rows *w, uint32_t k, uint32_t vectors,
                                                              int has_slopes, float *to)
{
    lanes sum[VECTORS];
    for (uint32_t v = 0; v < vectors; v++)
        sum[v] = (lanes){0.0f};
    for (uint32_t r = 0; r < w->rows; r++)
        for (uint32_t v = 0; v < vectors; v++) {
            lanes term, slope;
            __builtin_memcpy(&term, w->term[r] + k + v * LANES, sizeof term);
            if (has_slopes)
                __builtin_memcpy(&slope, w->slope[r] + k + v * LANES, sizeof slope);
            sum[v] += has_slopes ? w->by[r] * term + w->by_slope[r] * slope : w->by[r] * term;
        }
    for (uint32_t v = 0; v < vectors; v++)
        __builtin_memcpy(to + k + v * LANES, &sum[v], sizeof sum[v]);
}

static inline __attribute__((always_inline)) void add_columns(const weighted_rows *w, uint32_t columns, int has_slopes,
                                                              float *to)
{
    uint32_t k = 0;
    for (; k + VECTORS * LANES <= columns; k += VECTORS * LANES)
        add_vectors(w, k, VECTORS, has_slopes, to);
    for (; k + 4 * LANES <= columns; k += 4 * LANES)
        add_vectors(w, k, 4, has_slopes, to);
    if (k < columns)
        add_vectors(w, k, 2, has_slopes, to);
}

/* The sum of the rows; columns are a multiple of two vectors. */
static __attribute__((noinline)) void add_rows(const weighted_rows *w, uint32_t columns, float *to)
{
    if (w->slope)
        add_columns(w, columns, 1, to);
    else
        add_columns(w, columns, 0, to);
}

/* The terms, and zeros up to whole vectors. */
static uint32_t columns_of(const veil_object *o)
{
    return (o->terms + 2 * LANES - 1) / (2 * LANES) * (2 * LANES);
}

/* A row of cells to terms in x: of the light, and of its moment in y. Light at a distance d from its cell's middle
 * counts as light there, and d times the slope. */
static __attribute__((noinline)) void add_row(const veil_object *o, const veil_cell cell[VEIL_CELLS], int channel,
                                              float unit, float *sum, float *moment)
{
    float here[VEIL_CELLS], x[VEIL_CELLS], y[VEIL_CELLS];
    for (int i = 0; i < VEIL_CELLS; i++) {
        here[i] = (float)cell[i].sum[channel] * unit;
        x[i] = (float)cell[i].x[channel] * unit;
        y[i] = (float)cell[i].y[channel] * unit;
    }
    add_rows(&(weighted_rows){(term_row *)o->cell, (term_row *)o->cell_slope, here, x, VEIL_CELLS}, columns_of(o), sum);
    add_rows(&(weighted_rows){(term_row *)o->cell, 0, y, 0, VEIL_CELLS}, columns_of(o), moment);
}

/* A channel to terms in x and y, in work[0]. */
static void add_channel(veil_object *o, const veil_light_object *light, int channel, float unit)
{
    float(*sum)[VEIL_TERM_ROOM] = o->work[1], (*moment)[VEIL_TERM_ROOM] = o->work[2];
    float term[VEIL_CELLS], slope[VEIL_CELLS];
    for (int j = 0; j < VEIL_CELLS; j++)
        add_row(o, light->cell[j], channel, unit, sum[j], moment[j]);
    for (uint32_t l = 0; l < o->terms; l++) {
        for (int j = 0; j < VEIL_CELLS; j++) {
            term[j] = o->cell[j][l];
            slope[j] = o->cell_slope[j][l];
        }
        add_rows(&(weighted_rows){(term_row *)sum, (term_row *)moment, term, slope, VEIL_CELLS}, columns_of(o),
                 o->work[0][l]);
    }
}

int pupil_veil_add_light(pupil_veil *veil, const pupil_veil_light *light)
{
    const veil_light_object *l = (const veil_light_object *)(const void *)light;
    const int error = light ? pupil_veil_check(veil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    veil_object *o = pupil_veil_object_of(veil);
    if (l->magic != VEIL_LIGHT_MAGIC)
        return PUPIL_ERR_OBJECT;
    if (!l->rows || l->rows != o->config.height)
        return PUPIL_ERR_ROWS;
    if (l->width != o->config.width || l->height != o->config.height)
        return PUPIL_ERR_OBJECT;
    const float unit = (float)(LEAST_UNIT * pupil_veil_cell_pixels(l->width, l->height));
    for (int channel = 0; channel < 3; channel++) {
        add_channel(o, l, channel, unit);
        pupil_veil_spread(o, (const float(*)[VEIL_WAVES])o->psf_table, (term_row *)o->work[0], channel);
    }
    return PUPIL_OK;
}

/* --- values --- */

int pupil_veil_solve(pupil_veil *veil)
{
    const int error = pupil_veil_check(veil);
    if (error)
        return error;
    veil_object *o = pupil_veil_object_of(veil);
    float at_node[VEIL_TERMS], term[VEIL_TERM_ROOM];
    for (int j = 0; j < VEIL_NODES; j++) {
        for (uint32_t l = 0; l < o->terms; l++)
            at_node[l] = o->node[l][j];
        for (int channel = 0; channel < 3; channel++) {
            float *row = o->solved[channel][j];
            add_rows(&(weighted_rows){(term_row *)o->series[channel], 0, at_node, 0, o->terms}, columns_of(o), term);
            add_rows(&(weighted_rows){(term_row *)o->node, 0, term, 0, o->terms}, VEIL_NODE_ROOM, row);
            for (int i = 0; i < VEIL_NODE_ROOM; i++)
                row[i] = row[i] > 0.0f ? row[i] : 0.0f;
        }
    }
    return PUPIL_OK;
}

int pupil_veil_get_nodes(const pupil_veil *veil, float *rgb)
{
    const int error = rgb ? pupil_veil_check(veil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    const veil_object *o = pupil_veil_object_of_const(veil);
    for (int j = 0; j < VEIL_NODES; j++)
        for (int i = 0; i < VEIL_NODES; i++)
            for (int channel = 0; channel < 3; channel++)
                *rgb++ = o->solved[channel][j][i];
    return PUPIL_OK;
}

/* --- along rows --- */

/* Rows as terms in x, which are in work[channel]. */
static __attribute__((noinline)) void find_rows(veil_object *o, uint32_t first_row, uint32_t count)
{
    float at[VEIL_TERMS];
    for (uint32_t j = 0; j < count; j++) {
        pupil_veil_terms_at((first_row + j + 0.5) / (o->config.height * o->config.period), o->terms, at);
        for (int channel = 0; channel < 3; channel++)
            add_rows(&(weighted_rows){(term_row *)o->series[channel], 0, at, 0, o->terms}, columns_of(o),
                     o->work[channel][j]);
    }
}

/* The terms at the pixels from x on. */
static __attribute__((noinline)) void find_columns(veil_object *o, uint32_t x)
{
    const double turns_a_pixel = 1.0 / (o->config.width * o->config.period);
    float at[VEIL_TERMS];
    for (uint32_t j = 0; j < VEIL_COLUMNS; j++) {
        pupil_veil_terms_at((x + j + 0.5) * turns_a_pixel, o->terms, at);
        for (uint32_t k = 0; k < o->terms; k++)
            o->column[k][j] = at[k];
    }
}

static void evaluate(const veil_object *o, uint32_t row, uint32_t n, float *rgb)
{
    for (uint32_t channel = 0; channel < 3; channel++) {
        const float *restrict term = o->work[channel][row];
        float value[VEIL_COLUMNS] = {0};
        for (uint32_t k = 0; k < o->terms; k++)
            for (int j = 0; j < VEIL_COLUMNS; j++)
                value[j] += term[k] * o->column[k][j];
        for (uint32_t j = 0; j < n; j++)
            rgb[3 * j + channel] = value[j];
    }
}

int pupil_veil_evaluate_rows(pupil_veil *veil, uint32_t first_row, uint32_t count, float *rgb)
{
    const int error = rgb || !count ? pupil_veil_check(veil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    veil_object *o = pupil_veil_object_of(veil);
    const uint32_t width = o->config.width, height = o->config.height;
    if (first_row > height || count > height - first_row)
        return PUPIL_ERR_ROWS;
    for (uint32_t done = 0; done < count; done += VEIL_TERMS) {
        const uint32_t left = count - done, rows = left < VEIL_TERMS ? left : VEIL_TERMS;
        find_rows(o, first_row + done, rows);
        for (uint32_t x = 0; x < width; x += VEIL_COLUMNS) {
            find_columns(o, x);
            for (uint32_t j = 0; j < rows; j++)
                evaluate(o, j, width - x < VEIL_COLUMNS ? width - x : VEIL_COLUMNS,
                         rgb + 3 * ((size_t)(done + j) * width + x));
        }
    }
    return PUPIL_OK;
}

/* The octaves of a bloom: the light of the first one is halved again and again, and each octave is blurred. Pixels that
 * no lamp reaches are 0 in all planes, and are not written again: flags mark the others. */
#include "bloom_private.h"

enum { HALVED = 8, REACH = PUPIL_BLOOM_ROWS / 2 };

void pupil_bloom_clear(bloom_object *o, uint32_t octave, size_t planes, size_t flags, int32_t y, uint32_t first,
                       uint32_t end)
{
    uint8_t *set = pupil_bloom_flags(o, octave, flags, y);
    for (uint32_t u = first; u < end; u++) {
        for (int channel = 0; channel < 3 && set[u]; channel++) {
            float *row = o->memory + pupil_bloom_row(o, octave, planes, channel, y) + BLOOM_LEFT - BLOOM_MARGIN;
            __builtin_memset(row + u * BLOOM_UNIT, 0, BLOOM_UNIT * sizeof *row);
        }
        set[u] = 0;
    }
}

/* Which units are set in one of rows y to y + rows. */
static void find_any(const bloom_object *o, uint32_t octave, size_t flags, int32_t y, int32_t rows,
                     uint8_t *restrict any)
{
    const uint32_t units = o->octave[octave].units;
    const int32_t last = (int32_t)o->octave[octave].height + BLOOM_MARGIN, end = y + rows < last ? y + rows : last;
    __builtin_memset(any, 0, units);
    for (int32_t i = y > -BLOOM_MARGIN ? y : -BLOOM_MARGIN; i < end; i++) {
        const uint8_t *restrict row = pupil_bloom_flags(o, octave, flags, i);
        for (uint32_t u = 0; u < units; u++)
            any[u] |= row[u];
    }
}

/* Whether one of `count` units from u on is set, or the one before. */
static int is_near(const uint8_t *any, uint32_t units, uint32_t u, uint32_t count)
{
    uint32_t near = u && u <= units ? any[u - 1] : 0;
    for (uint32_t i = u; i < u + count && i < units; i++)
        near |= any[i];
    return near != 0;
}

static float (*room_of(bloom_object *o))[PUPIL_BLOOM_LINE]
{
    return (float(*)[PUPIL_BLOOM_LINE])(void *)(o->memory + o->room);
}

/* --- light --- */

/* Units first to end of row j of octave k + 1. */
static void halve_units(bloom_object *o, const pupil_kernels *kernels, uint32_t k, int32_t j, uint32_t first,
                        uint32_t end)
{
    const bloom_octave *from = &o->octave[k], *to = &o->octave[k + 1];
    const uint32_t at = first * BLOOM_UNIT, all = to->width + 2 * BLOOM_MARGIN, most = (end - first) * BLOOM_UNIT;
    const uint32_t n = all - at < most ? all - at : most;
    for (int channel = 0; channel < 3; channel++) {
        const float *rows[HALVED];
        for (int32_t i = 0; i < HALVED; i++)
            rows[i] = o->memory + pupil_bloom_row(o, k, from->light, channel, 2 * j - 3 + i) + BLOOM_LEFT -
                      2 * BLOOM_MARGIN - BLOOM_SIDE + 2 * at;
        const size_t ahead = pupil_bloom_has_row(from, 2 * j + HALVED - 4) ? 4 * (size_t)from->stride : 0;
        float *row = o->memory + pupil_bloom_row(o, k + 1, to->light, channel, j) + BLOOM_LEFT - BLOOM_MARGIN + at;
        PUPIL_PIECE(kernels, bloom_halve)(rows, ahead, n, room_of(o), row);
    }
}

/* Row j of octave k + 1. */
static void halve_row(bloom_object *o, const pupil_kernels *kernels, uint32_t k, int32_t j)
{
    const bloom_octave *from = &o->octave[k], *to = &o->octave[k + 1];
    uint8_t *near = (uint8_t *)o->memory + o->need, *lit = pupil_bloom_flags(o, k + 1, to->lit, j);
    find_any(o, k, from->lit, 2 * j - 3, HALVED, near);
    for (uint32_t first = 0, end; first < to->units; first = end) {
        for (end = first; end < to->units && is_near(near, from->units, 2 * end, 2); end++)
            lit[end] = 1;
        if (end > first)
            halve_units(o, kernels, k, j, first, end);
        const uint32_t dark = end;
        for (; end < to->units && !is_near(near, from->units, 2 * end, 2); end++)
            ;
        pupil_bloom_clear(o, k + 1, to->light, to->lit, j, dark, end);
    }
}

static void halve(bloom_object *o, const pupil_kernels *kernels, uint32_t k)
{
    const int32_t end = (int32_t)o->octave[k + 1].height + BLOOM_MARGIN - 1;
    for (int32_t j = 1 - BLOOM_MARGIN; j < end; j++)
        halve_row(o, kernels, k, j);
}

/* --- blurs --- */

/* Units first to end of row y of an octave's plane. */
typedef struct bloom_units {
    uint32_t octave, first, end;
    int32_t y;
    int channel;
} bloom_units;

static float *blurred_of(bloom_object *o, const bloom_units *s)
{
    const size_t row = pupil_bloom_row(o, s->octave, o->octave[s->octave].blurred, s->channel, s->y);
    return o->memory + row + BLOOM_LEFT - BLOOM_MARGIN + s->first * BLOOM_UNIT;
}

/* Writes what the kernel scatters to them. */
static void blur_units(bloom_object *o, const pupil_kernels *kernels, const bloom_units *s)
{
    const bloom_octave *at = &o->octave[s->octave];
    const float *row[PUPIL_BLOOM_ROWS];
    for (int32_t i = 0; i < PUPIL_BLOOM_ROWS; i++)
        row[i] = o->memory + pupil_bloom_row(o, s->octave, at->light, s->channel, s->y - REACH + i) + BLOOM_LEFT -
                 BLOOM_MARGIN - BLOOM_SIDE + s->first * BLOOM_UNIT;
    const uint32_t n = (s->end - s->first) * BLOOM_UNIT;
    const size_t ahead = pupil_bloom_has_row(at, s->y + REACH) ? 2 * (size_t)at->stride : 0;
    PUPIL_PIECE(kernels, bloom_scatter)(row, ahead, &o->taps[s->octave], n, room_of(o), 0, blurred_of(o, s));
}

/* Bits of `reached`: a unit gets light from within the kernel's reach (some rows, and the units next to it), or from
 * the coarser octave. */
enum { BY_KERNEL = 1, BY_COARSER = 2 };

static void plan_row(bloom_object *o, uint32_t octave, int32_t y)
{
    const bloom_octave *at = &o->octave[octave];
    const int32_t middle = (y + 2 * BLOOM_STEP) / 2 - BLOOM_STEP; /* y / 2, rounded down */
    const uint32_t units = at->units;
    uint8_t *restrict near = (uint8_t *)o->memory + o->need + 1, *restrict coarser = near + units + 2;
    uint8_t *restrict reached = pupil_bloom_flags(o, octave, at->reached, y);
    find_any(o, octave, at->lit, y - REACH, PUPIL_BLOOM_ROWS, near);
    near[-1] = near[units] = 0;
    __builtin_memset(coarser, 0, units / 2 + 2);
    if (octave + 1 < o->octaves)
        find_any(o, octave + 1, o->octave[octave + 1].reached, middle - (y & 1 ? 1 : 2), 4, coarser);
    for (uint32_t u = 0; u < units; u++) {
        const int kernel = near[(int32_t)u - 1] | near[u] | near[u + 1], above = coarser[u / 2] | coarser[(u + 1) / 2];
        const int by = (kernel ? BY_KERNEL : 0) | (above ? BY_COARSER : 0);
        if (!by && reached[u])
            pupil_bloom_clear(o, octave, at->blurred, at->reached, y, u, u + 1);
        reached[u] = (uint8_t)by;
    }
}

static void plan(bloom_object *o, uint32_t octave)
{
    const bloom_octave *at = &o->octave[octave];
    const int32_t end = (int32_t)at->height + BLOOM_MARGIN - 1;
    const int all = octave + 1 < o->octaves ? BY_KERNEL | BY_COARSER : BY_KERNEL;
    for (int32_t y = 1 - BLOOM_MARGIN; y < end; y++)
        if (o->config.threshold > 0.0)
            plan_row(o, octave, y);
        else
            __builtin_memset(pupil_bloom_flags(o, octave, at->reached, y), all, at->units);
}

/* Writes the light of the coarser octave to them, or with `add` adds it. */
static void take_coarser(bloom_object *o, const pupil_kernels *kernels, const bloom_units *s, bloom_four four, int add)
{
    const uint32_t half = s->first * (BLOOM_UNIT / 2), all = o->octave[s->octave].width / 2 + BLOOM_MARGIN;
    const uint32_t most = (s->end - s->first) * (BLOOM_UNIT / 2), left = all > half ? all - half : 0;
    const uint32_t n = left < most ? left : most;
    float *to = blurred_of(o, s);
    if (!add && n < most)
        __builtin_memset(to + 2 * n, 0, 2 * (most - n) * sizeof *to);
    if (!n)
        return;
    for (int i = 0; i < 4; i++)
        four.row[i] += half;
    pupil_bloom_take(kernels, &four, n, room_of(o), to, add);
}

static void blur_row(bloom_object *o, const pupil_kernels *kernels, bloom_units s)
{
    const uint32_t units = o->octave[s.octave].units;
    const uint8_t *reached = pupil_bloom_flags(o, s.octave, o->octave[s.octave].reached, s.y);
    bloom_four four = {.y = s.y};
    if (s.octave + 1 < o->octaves)
        pupil_bloom_find_four(o, s.octave + 1, s.y, -BLOOM_MARGIN / 2, &four);
    for (int i = 0; i < 4 && four.row[i]; i++)
        four.row[i] += (size_t)s.channel * four.next[i];
    for (s.first = 0; s.first < units; s.first = s.end) {
        const uint8_t by = reached[s.first];
        for (s.end = s.first; s.end < units && reached[s.end] == by; s.end++)
            ;
        if (by & BY_KERNEL)
            blur_units(o, kernels, &s);
        if (by & BY_COARSER)
            take_coarser(o, kernels, &s, four, by & BY_KERNEL);
    }
}

/* A channel at a time: all rows within reach are then in the L1 cache. */
static void blur(bloom_object *o, const pupil_kernels *kernels, uint32_t octave)
{
    const int32_t end = (int32_t)o->octave[octave].height + BLOOM_MARGIN - 1;
    plan(o, octave);
    for (int channel = 0; channel < 3; channel++)
        for (int32_t y = 1 - BLOOM_MARGIN; y < end; y++)
            blur_row(o, kernels, (bloom_units){.octave = octave, .y = y, .channel = channel});
}

static int has_lamps(bloom_object *o)
{
    const uint32_t words = pupil_bloom_words(o->config.width);
    for (uint32_t y = 0; y < o->config.height; y++) {
        const uint32_t *lamps = pupil_bloom_lamps_of(o, (int32_t)y);
        for (uint32_t i = 0; i < words; i++)
            if (lamps[i])
                return 1;
    }
    return 0;
}

int pupil_bloom_solve(pupil_bloom *bloom, const pupil_t *pupil)
{
    int error = pupil_bloom_check(bloom);
    if (!error)
        error = pupil_object_check(pupil);
    if (error)
        return error;
    bloom_object *o = (bloom_object *)(void *)bloom;
    const pupil_kernels *kernels = pupil_level_kernels(pupil_object_of_const(pupil)->level);
    o->lit = !(o->config.threshold > 0.0) || has_lamps(o);
    if (!o->lit)
        return PUPIL_OK;
    for (uint32_t k = 1; k + 1 < o->octaves; k++)
        halve(o, kernels, k);
    for (uint32_t k = o->octaves - 1; k > 0; k--)
        blur(o, kernels, k);
    return PUPIL_OK;
}

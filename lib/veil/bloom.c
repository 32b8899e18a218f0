/* A bloom's configuration, memory and life. */
#include "bloom_private.h"

#include "base/fault.h"
#include "base/versioned.h"

static const pupil_bloom_config defaults = {.lobes = 0};

void pupil_bloom_config_default_sized(pupil_bloom_config *config, size_t config_bytes)
{
    if (config)
        (void)pupil_versioned_write(config, config_bytes, &defaults, sizeof defaults);
}

static const char *lobes_fault(const pupil_bloom_config *c)
{
    double together = 0.0;
    for (uint32_t i = 0; i < c->lobes; i++) {
        if (!within(c->lobe[i].sigma, 0.1, 1024.0))
            return "lobe: sigma must be from 0.1 to 1024 pixels";
        if (!within(c->lobe[i].weight, 0.0, 1.0))
            return "lobe: weight must be from 0 to 1";
        together += c->lobe[i].weight;
    }
    return together <= 1.0 + 1e-12 ? 0 : "lobe: the weights must be at most 1 together";
}

static const char *read_config(pupil_bloom_config *ours, const pupil_bloom_config *theirs)
{
    *ours = defaults;
    const size_t first_bytes = PUPIL_FIRST_BYTES(pupil_bloom_config, lobe);
    const char *fault = pupil_versioned_read(ours, sizeof *ours, first_bytes, theirs, theirs->size_bytes);
    if (fault)
        return fault;
    const pupil_rule rules[] = {
        {ours->width >= 1 && ours->width <= PUPIL_MAX_SIDE_PX, "width must be from 1 to 16384"},
        {ours->height >= 1 && ours->height <= PUPIL_MAX_SIDE_PX, "height must be from 1 to 16384"},
        {ours->lobes <= PUPIL_VEIL_MOST_LOBES, "lobes must be at most 32"},
        {within(ours->threshold, 0.0, (double)PUPIL_CEILING), "threshold must be from 0 to 2^30"},
    };
    fault = first_fault(rules, sizeof rules / sizeof rules[0]);
    return fault ? fault : lobes_fault(ours);
}

int pupil_bloom_config_check(const pupil_bloom_config *config, const char **why)
{
    pupil_bloom_config own;
    if (!config)
        return PUPIL_ERR_NULL;
    const char *fault = read_config(&own, config);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

/* --- memory --- */

static uint32_t rounded(uint32_t n)
{
    return (n + BLOOM_STEP - 1) / BLOOM_STEP * BLOOM_STEP;
}

static bloom_octave octave_at(const pupil_bloom_config *c, uint32_t k, size_t *floats)
{
    bloom_octave at = {.width = ((c->width - 1) >> k) + 1, .height = ((c->height - 1) >> k) + 1};
    /* An odd number of steps: rows that are 4096 bytes apart would share a few sets of a cache. */
    at.stride = (rounded(BLOOM_LEFT + at.width + BLOOM_LEFT + BLOOM_STEP) / BLOOM_STEP | 1) * BLOOM_STEP;
    const int all_light = !(c->threshold > 0.0);
    at.rows = at.height + 2 * BLOOM_MARGIN + (all_light ? BLOOM_BEHIND : 0);
    at.units = (at.width + 2 * BLOOM_MARGIN + BLOOM_UNIT - 1) / BLOOM_UNIT;
    at.blurred = *floats;
    at.light = at.blurred + (all_light ? BLOOM_BEHIND : 3 * (size_t)at.rows) * at.stride;
    *floats = (all_light ? at.blurred : at.light) + 3 * (size_t)at.rows * at.stride;
    return at;
}

/* The content of memory, from octave 1 on: planes, a row of zeros, room for solve, and bytes. */
typedef struct bloom_places {
    bloom_octave octave[BLOOM_OCTAVES];
    size_t nothing, room, need, lamps, bytes;
} bloom_places;

static __attribute__((noinline)) void find_places(const pupil_bloom_config *c, uint32_t octaves, bloom_places *p)
{
    size_t floats = 0;
    for (uint32_t k = 1; k < octaves; k++)
        p->octave[k] = octave_at(c, k, &floats);
    const uint32_t longest = octaves > 1 ? p->octave[1].stride : 0;
    p->nothing = floats;
    p->room = p->nothing + longest;
    p->lamps = p->room + sizeof(pupil_bloom_room) / sizeof(float);
    p->bytes = (p->lamps + (c->threshold > 0.0 ? (size_t)c->height * pupil_bloom_words(c->width) : 0)) * sizeof(float);
    for (uint32_t k = 1; k < octaves; k++) {
        p->octave[k].lit = p->bytes;
        p->octave[k].reached = p->bytes + (size_t)p->octave[k].rows * p->octave[k].units;
        p->bytes += 2 * (size_t)p->octave[k].rows * p->octave[k].units;
    }
    p->need = p->bytes;
    p->bytes += octaves > 1 ? 2 * (size_t)p->octave[1].units + BLOOM_STEP : 0;
    p->bytes = p->bytes > sizeof(bloom_fit) ? p->bytes : sizeof(bloom_fit);
}

static __attribute__((noinline)) size_t bytes_for(const pupil_bloom_config *c)
{
    bloom_places p;
    find_places(c, pupil_bloom_octaves(c), &p);
    return sizeof(bloom_object) + (p.bytes + sizeof(double) - 1) / sizeof(double) * sizeof(double);
}

size_t pupil_bloom_bytes(const pupil_bloom_config *config)
{
    pupil_bloom_config c;
    return config && !read_config(&c, config) ? bytes_for(&c) : 0;
}

static __attribute__((noinline)) void take_places(bloom_object *o)
{
    bloom_places p;
    find_places(&o->config, o->octaves, &p);
    for (uint32_t k = 1; k < o->octaves; k++)
        o->octave[k] = p.octave[k];
    o->nothing = p.nothing;
    o->room = p.room;
    o->need = p.need;
    o->lamps = p.lamps;
}

/* Scattered light is subtracted from its pixel. */
static void find_taps(bloom_object *o)
{
    double moved = 0.0;
    bloom_fit *fit = (bloom_fit *)(void *)o->memory;
    pupil_bloom_fit(&o->config, fit, o->octaves, o->taps);
    __builtin_memset(fit, 0, sizeof *fit);
    for (uint32_t i = 0; i < o->config.lobes; i++)
        moved += o->config.lobe[i].weight;
    o->taps[0].tap[0] -= (float)moved;
}

int pupil_bloom_init(pupil_bloom *bloom, size_t bytes, const pupil_bloom_config *config)
{
    pupil_bloom_config copy; /* the caller's may be in the object's memory */
    if (!bloom || !config)
        return PUPIL_ERR_NULL;
    if (read_config(&copy, config))
        return PUPIL_ERR_CONFIG;
    if ((uintptr_t)bloom % sizeof(double))
        return PUPIL_ERR_ALIGNMENT;
    const size_t needed = bytes_for(&copy);
    if (bytes < needed)
        return PUPIL_ERR_VALUE;
    bloom_object *o = (bloom_object *)(void *)bloom;
    __builtin_memset(bloom, 0, needed);
    o->config = copy;
    o->octaves = pupil_bloom_octaves(&copy);
    find_taps(o);
    take_places(o);
    o->magic = BLOOM_MAGIC;
    return PUPIL_OK;
}

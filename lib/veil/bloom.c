/* A bloom's configuration and life: which octave and which taps each lobe has. */
#include "bloom_private.h"

#include "base/fault.h"
#include "base/numeric.h"
#include "base/versioned.h"

/* The six taps to an octave and back are binomial: each way adds 5/4 square pixels of variance, of the finer octave. */
#define FILTERS 2.5
/* A blur in an octave has at least this variance, so that the filters' own grid does not show. */
#define LEAST_VARIANCE 0.7
/* That of the lobe in the first octave which completes those at full size is at least this. */
#define OWN_VARIANCE 0.5
#define REACH        3.2 /* standard deviations */
/* What a Gaussian up to this one scatters is within 5 x 5 pixels. */
#define NEAR_SIGMA 0.8
/* The narrowest lobe of the first octave completes the fit at full size where it is no wider than this. */
#define COARSE_SIGMA 2.7

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

/* --- lobes --- */

static uint32_t taps_of(double sigma)
{
    const double reach = REACH * sigma - 0.5;
    uint32_t taps = 2;
    while (taps < BLOOM_TAPS && taps - 1 < reach)
        taps++;
    return taps;
}

/* A Gaussian of standard deviation sigma there. The middle tap is met twice: pairs of one pixel with itself. */
static void set_lobe(bloom_lobe *lobe, uint32_t octave, double sigma, double weight)
{
    double tap[BLOOM_TAPS];
    const uint32_t taps = taps_of(sigma);
    pupil_bloom_find_taps(sigma, taps, tap);
    lobe->octave = octave;
    lobe->taps = taps;
    for (uint32_t k = 0; k < taps; k++) {
        lobe->column[k] = (float)(k ? tap[k] : tap[k] * 0.5);
        lobe->row[k] = (float)((k ? tap[k] : tap[k] * 0.5) * weight);
    }
}

/* The last octave in which enough variance is left for a blur, and that blur's sigma there. */
static uint32_t octave_of(double sigma, double *left_sigma)
{
    const double variance = sigma * sigma + 1.0 / 12.0; /* a pixel's own is 1/12 */
    double unit = 1.0, filters = 0.0;
    uint32_t octave = 0;
    *left_sigma = sigma;
    while (octave + 1 < BLOOM_OCTAVES) {
        filters += FILTERS * unit;
        unit *= 4.0;
        const double left = (variance - filters) / unit;
        if (left < LEAST_VARIANCE)
            break;
        *left_sigma = pupil_root(left - 1.0 / 12.0);
        octave++;
    }
    return octave;
}

/* The widest lobe at full size, and the narrowest in the first octave; 0: there is none. */
typedef struct edge_lobes {
    double full_sigma, coarse_sigma;
} edge_lobes;

static edge_lobes find_edges(const pupil_bloom_config *c)
{
    edge_lobes e = {0};
    double unused;
    for (uint32_t i = 0; i < c->lobes; i++) {
        const double sigma = c->lobe[i].sigma;
        const uint32_t octave = octave_of(sigma, &unused);
        if (octave == 0)
            e.full_sigma = sigma > e.full_sigma ? sigma : e.full_sigma;
        else if (octave == 1 && (e.coarse_sigma == 0.0 || sigma < e.coarse_sigma))
            e.coarse_sigma = sigma;
    }
    return e;
}

static uint32_t octaves_of(const pupil_bloom_config *c)
{
    uint32_t octaves = find_edges(c).full_sigma > NEAR_SIGMA ? 2 : 1;
    double unused;
    for (uint32_t i = 0; i < c->lobes; i++) {
        const uint32_t octave = octave_of(c->lobe[i].sigma, &unused);
        octaves = octave + 1 > octaves ? octave + 1 : octaves;
    }
    return octaves;
}

static void find_lobes(bloom_object *o)
{
    const pupil_bloom_config *c = &o->config;
    const edge_lobes e = find_edges(c);
    double own = (e.full_sigma * e.full_sigma + 1.0 / 12.0 - FILTERS) / 4.0 + 0.1;
    own = own > OWN_VARIANCE ? own : OWN_VARIANCE;
    double sigma, coarse = 0.0, moved = 0.0;
    int has_own = 0;
    if (e.full_sigma > NEAR_SIGMA) {
        has_own = e.coarse_sigma == 0.0 || e.coarse_sigma > COARSE_SIGMA;
        coarse = has_own ? pupil_root(FILTERS + 4.0 * own - 1.0 / 12.0) : e.coarse_sigma;
    }
    double weight = pupil_bloom_fit(c, e.full_sigma, coarse, &o->full);
    if (has_own)
        set_lobe(&o->lobe[o->lobes++], 1, pupil_root(own - 1.0 / 12.0), weight);
    for (uint32_t i = 0; i < c->lobes; i++) {
        const uint32_t octave = octave_of(c->lobe[i].sigma, &sigma);
        const int completes = !has_own && c->lobe[i].sigma == coarse;
        moved += c->lobe[i].weight;
        if (octave)
            set_lobe(&o->lobe[o->lobes++], octave, sigma, c->lobe[i].weight + (completes ? weight : 0.0));
        weight = completes ? 0.0 : weight;
    }
    o->full.near[0] -= (float)moved;
}

/* --- memory --- */

static uint32_t rounded(uint32_t n)
{
    return (n + BLOOM_STEP - 1) / BLOOM_STEP * BLOOM_STEP;
}

static bloom_octave octave_at(const pupil_bloom_config *c, uint32_t k, size_t *floats)
{
    bloom_octave at = {.width = ((c->width - 1) >> k) + 1, .height = ((c->height - 1) >> k) + 1};
    /* An odd number of steps: rows that are 4096 bytes apart would share a few places of a cache. */
    at.stride = (rounded(BLOOM_LEFT + at.width + BLOOM_LEFT + BLOOM_STEP) / BLOOM_STEP | 1) * BLOOM_STEP;
    at.rows = at.height + 2 * BLOOM_MARGIN;
    at.units = rounded(at.width + 2 * BLOOM_MARGIN) / BLOOM_STEP;
    at.light = *floats;
    at.blurred = at.light + 3 * (size_t)at.rows * at.stride;
    *floats = at.blurred + 3 * (size_t)at.rows * at.stride;
    return at;
}

/* What memory holds, from octave 1 on: planes, rows of zeros and for solve, and bytes. */
typedef struct bloom_places {
    bloom_octave octave[BLOOM_OCTAVES];
    size_t nothing, line, need, bytes;
} bloom_places;

static __attribute__((noinline)) void find_places(const pupil_bloom_config *c, uint32_t octaves, bloom_places *p)
{
    size_t floats = 0;
    for (uint32_t k = 1; k < octaves; k++)
        p->octave[k] = octave_at(c, k, &floats);
    const uint32_t longest = octaves > 1 ? p->octave[1].stride : 0;
    p->nothing = floats;
    p->line = floats + longest;
    p->bytes = (floats + 2 * longest + BLOOM_STEP) * sizeof(float);
    for (uint32_t k = 1; k < octaves; k++) {
        p->octave[k].lit = p->bytes;
        p->bytes += (size_t)p->octave[k].rows * p->octave[k].units;
    }
    p->need = p->bytes;
    p->bytes += octaves > 1 ? p->octave[1].units : 0;
}

static __attribute__((noinline)) size_t bytes_for(const pupil_bloom_config *c)
{
    bloom_places p;
    find_places(c, octaves_of(c), &p);
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
    o->line = p.line;
    o->need = p.need;
}

int pupil_bloom_init(pupil_bloom *bloom, size_t bytes, const pupil_bloom_config *config)
{
    pupil_bloom_config copy; /* the caller's may be where the object will */
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
    o->octaves = octaves_of(&copy);
    find_lobes(o);
    take_places(o);
    o->magic = BLOOM_MAGIC;
    return PUPIL_OK;
}

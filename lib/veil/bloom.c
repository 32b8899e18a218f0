/* A bloom's configuration and life: which octave and which taps each lobe has. */
#include "bloom_private.h"

#include "base/fault.h"
#include "base/numeric.h"
#include "base/versioned.h"

/* The six taps to an octave and back are binomial: each way adds 5/4 square pixels of variance, of the finer octave. */
#define FILTERS 2.5
/* A blur in an octave has at least this variance, so that the filters' own grid does not show. */
#define LEAST_VARIANCE 0.75
#define REACH          3.5 /* standard deviations */

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

/* The light of a Gaussian in the pixels 0 to taps - 1 from its middle, by Simpson's rule; with those on the other side
 * 1 in all. */
static void find_taps(double sigma, uint32_t taps, double *tap)
{
    enum { STEPS = 64 };
    double all = 0.0;
    for (uint32_t k = 0; k < taps; k++) {
        tap[k] = 0.0;
        for (int i = 0; i <= STEPS; i++) {
            const double x = (k - 0.5 + (double)i / STEPS) / sigma;
            tap[k] += (i == 0 || i == STEPS ? 1.0 : i % 2 ? 4.0 : 2.0) * pupil_decay(0.5 * x * x);
        }
        all += (k ? 2.0 : 1.0) * tap[k];
    }
    for (uint32_t k = 0; k < taps; k++)
        tap[k] /= all;
}

static uint32_t taps_of(double sigma)
{
    const double reach = REACH * sigma - 0.5;
    uint32_t taps = 2;
    while (taps < BLOOM_TAPS && taps - 1 < reach)
        taps++;
    return taps;
}

/* The middle tap is met twice: pairs of one pixel with itself. */
static void set_lobe(bloom_lobe *lobe, uint32_t octave, uint32_t taps, const double *tap, double weight)
{
    lobe->octave = octave;
    lobe->taps = taps;
    for (uint32_t k = 0; k < taps; k++) {
        lobe->column[k] = (float)(k ? tap[k] : tap[k] * 0.5);
        lobe->row[k] = (float)((k ? tap[k] : tap[k] * 0.5) * weight);
    }
}

/* Lobes that reach no further than one pixel, as one: exact beside and at the corners; the middle is set right by
 * `middle`. */
typedef struct narrow_lobes {
    double middle, beside, corner;
} narrow_lobes;

static void add_narrow(bloom_object *o, const narrow_lobes *n)
{
    if (!(n->corner > 1e-30))
        return;
    const double ratio = n->corner / n->beside, tap[2] = {1.0, ratio};
    set_lobe(&o->lobe[o->lobes++], 0, 2, tap, n->beside / ratio);
    o->middle -= (float)(n->beside / ratio);
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

static uint32_t octaves_of(const pupil_bloom_config *c)
{
    uint32_t octaves = 1;
    double unused;
    for (uint32_t i = 0; i < c->lobes; i++) {
        const uint32_t octave = octave_of(c->lobe[i].sigma, &unused);
        octaves = octave + 1 > octaves ? octave + 1 : octaves;
    }
    return octaves;
}

static void find_lobes(bloom_object *o)
{
    narrow_lobes narrow = {0};
    double moved = 0.0, tap[BLOOM_TAPS], sigma;
    o->reach = 1;
    for (uint32_t i = 0; i < o->config.lobes; i++) {
        const pupil_veil_gaussian g = o->config.lobe[i];
        const uint32_t octave = octave_of(g.sigma, &sigma), taps = taps_of(sigma);
        moved += g.weight;
        find_taps(sigma, taps, tap);
        if (octave || taps > 2) {
            set_lobe(&o->lobe[o->lobes++], octave, taps, tap, g.weight);
            o->reach = !octave && taps - 1 > o->reach ? taps - 1 : o->reach;
            continue;
        }
        narrow.middle += g.weight * tap[0] * tap[0];
        narrow.beside += g.weight * tap[0] * tap[1];
        narrow.corner += g.weight * tap[1] * tap[1];
    }
    o->middle = (float)(narrow.middle - moved);
    add_narrow(o, &narrow);
}

/* --- memory --- */

static uint32_t rounded(uint32_t n)
{
    return (n + BLOOM_STEP - 1) / BLOOM_STEP * BLOOM_STEP;
}

static bloom_octave octave_at(const pupil_bloom_config *c, uint32_t k, size_t *floats)
{
    bloom_octave at = {.width = ((c->width - 1) >> k) + 1, .height = ((c->height - 1) >> k) + 1};
    at.stride = rounded(BLOOM_LEFT + at.width + BLOOM_LEFT + BLOOM_STEP);
    at.rows = at.height + 2 * BLOOM_MARGIN;
    at.light = *floats;
    at.blurred = at.light + 3 * (size_t)at.rows * at.stride;
    *floats = at.blurred + 3 * (size_t)at.rows * at.stride;
    return at;
}

size_t pupil_bloom_bytes(const pupil_bloom_config *config)
{
    pupil_bloom_config c;
    size_t floats = 0;
    if (!config || read_config(&c, config))
        return 0;
    const uint32_t octaves = octaves_of(&c);
    const uint32_t longest = octaves > 1 ? octave_at(&c, 1, &floats).stride : 0;
    for (uint32_t k = 2; k < octaves; k++)
        (void)octave_at(&c, k, &floats);
    return sizeof(bloom_object) + (floats + 2 * longest + BLOOM_STEP) * sizeof(float);
}

static void find_places(bloom_object *o)
{
    size_t floats = 0;
    for (uint32_t k = 1; k < o->octaves; k++)
        o->octave[k] = octave_at(&o->config, k, &floats);
    o->nothing = floats;
    o->line = floats + o->octave[1].stride;
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
    const size_t needed = pupil_bloom_bytes(&copy);
    if (bytes < needed)
        return PUPIL_ERR_VALUE;
    bloom_object *o = (bloom_object *)(void *)bloom;
    __builtin_memset(bloom, 0, needed);
    o->config = copy;
    o->octaves = octaves_of(&copy);
    find_lobes(o);
    find_places(o);
    o->magic = BLOOM_MAGIC;
    return PUPIL_OK;
}

/* The veil's configuration and life. */
#include "veil_private.h"

#include "base/fault.h"
#include "base/versioned.h"

static const pupil_veil_config defaults = {
    .psf = PUPIL_VEIL_SPENCER, .fov_deg = 54.0, .age_years = 25.0, .pigment = 0.5, .period = 2.0, .harmonics = 16};

void pupil_veil_config_default_sized(pupil_veil_config *config, size_t config_bytes)
{
    if (config)
        (void)pupil_versioned_write(config, config_bytes, &defaults, sizeof defaults);
}

static const char *gaussians_fault(const pupil_veil_config *c)
{
    double together = 0.0;
    if (c->gaussians > PUPIL_VEIL_MOST_GAUSSIANS)
        return "gaussians must be at most 24";
    for (uint32_t i = 0; i < c->gaussians; i++) {
        if (!within(c->gaussian[i].sigma, 1e-4, 180.0))
            return "gaussian: sigma must be from 1e-4 to 180 degrees";
        if (!within(c->gaussian[i].weight, 0.0, 1.0))
            return "gaussian: weight must be from 0 to 1";
        together += c->gaussian[i].weight;
    }
    return together <= 1.0 + 1e-12 ? 0 : "gaussian: the weights must be at most 1 together";
}

/* The caller's configuration as one of this version: NULL, or what is wrong with it. */
static const char *read_config(pupil_veil_config *ours, const pupil_veil_config *theirs)
{
    *ours = defaults;
    const size_t first_bytes = PUPIL_FIRST_BYTES(pupil_veil_config, gaussian);
    const char *fault = pupil_versioned_read(ours, sizeof *ours, first_bytes, theirs, theirs->size_bytes);
    if (fault)
        return fault;
    const int scatters = ours->psf != PUPIL_VEIL_GAUSSIANS || ours->gaussians;
    const pupil_rule rules[] = {
        {ours->psf < PUPIL_VEIL_PSF_COUNT, "psf must be a pupil_veil_psf"},
        {ours->width >= 1 && ours->width <= PUPIL_MAX_SIDE_PX, "width must be from 1 to 16384"},
        {ours->height >= 1 && ours->height <= PUPIL_MAX_SIDE_PX, "height must be from 1 to 16384"},
        {within(ours->fov_deg, 0.1, 150.0), "fov_deg must be from 0.1 to 150"},
        {within(ours->age_years, 1.0, 120.0), "age_years must be from 1 to 120"},
        {within(ours->pigment, 0.0, 1.2), "pigment must be from 0 to 1.2"},
        {within(ours->period, 1.0, 4.0), "period must be from 1 to 4"},
        {!scatters || ours->period >= 2.0, "period must be 2 or more where there is a psf, whose light reaches far"},
        {ours->harmonics >= 1 && ours->harmonics <= PUPIL_VEIL_MOST_HARMONICS, "harmonics must be from 1 to 32"},
    };
    fault = first_fault(rules, sizeof rules / sizeof rules[0]);
    return fault || ours->psf != PUPIL_VEIL_GAUSSIANS ? fault : gaussians_fault(ours);
}

int pupil_veil_config_check(const pupil_veil_config *config, const char **why)
{
    pupil_veil_config own;
    if (!config)
        return PUPIL_ERR_NULL;
    const char *fault = read_config(&own, config);
    if (fault && why)
        *why = fault;
    return fault ? PUPIL_ERR_CONFIG : PUPIL_OK;
}

int pupil_veil_init(pupil_veil *veil, const pupil_veil_config *config)
{
    pupil_veil_config copy; /* the caller's may be in the object's memory */
    if (!veil || !config)
        return PUPIL_ERR_NULL;
    if (read_config(&copy, config))
        return PUPIL_ERR_CONFIG;
    veil_object *o = pupil_veil_object_of(veil);
    veil_lobe lobe[VEIL_MOST_WIDE];
    __builtin_memset(veil, 0, sizeof *veil);
    o->config = copy;
    o->terms = 2 * copy.harmonics + 1;
    o->bell = PUPIL_VEIL_BELL_COUNT;
    const uint32_t lobes = pupil_veil_lobes(&o->config, &o->result, lobe);
    pupil_veil_fill_psf(o, lobe, lobes);
    pupil_veil_fill_places(o);
    o->magic = VEIL_MAGIC;
    return PUPIL_OK;
}

int pupil_veil_get_sized(const pupil_veil *veil, pupil_veil_result *result, size_t result_bytes)
{
    const int error = result ? pupil_veil_check(veil) : PUPIL_ERR_NULL;
    if (error)
        return error;
    const pupil_veil_result *ours = &pupil_veil_object_of_const(veil)->result;
    return pupil_versioned_write(result, result_bytes, ours, sizeof *ours);
}

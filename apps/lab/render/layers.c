#include "layers.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "file/common/pending.h"
#include "file/sink/picture_sink.h"
#include "gbuffer.h"
#include "refuse.h"
#include "synth/spread.h"

enum { MOST_CHANNELS = 12, PLANES = 9 };

int layers_parse(const char *text, unsigned *layers)
{
    static const char *const names[] = {"depth", "normal", "albedo", "occlusion", "ssao"};
    *layers = 0;
    for (;;) {
        const size_t length = strcspn(text, ",");
        unsigned found = 0;
        for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++)
            if (strlen(names[i]) == length && strncmp(text, names[i], length) == 0)
                found = 1u << i;
        if (!found || (*layers & found))
            return -1;
        *layers |= found;
        if (!text[length])
            return 0;
        text += length + 1;
    }
}

typedef struct layering {
    fixture_scene *scene;
    fixture_scene_facts facts;
    fixture_gbuffer g;
    unsigned layers;
    float *rgb, *plane; /* plane: Z, N, albedo, occlusion, ssao: floats of all pixels one after the other */
} layering;

static float *plane_of(const layering *l, int first)
{
    return l->plane + (size_t)first * l->facts.width * l->facts.height;
}

/* The channels in the order of their names. */
static size_t channels_of(const layering *l, pupil_exr_channel channel[MOST_CHANNELS])
{
    float *albedo = plane_of(l, 4), *normal = plane_of(l, 1);
    const struct {
        unsigned layer;
        const char *name;
        const float *data;
        size_t step;
    } all[MOST_CHANNELS] = {{0, "B", l->rgb + 2, 3},
                            {0, "G", l->rgb + 1, 3},
                            {LAYER_NORMAL, "N.X", normal, 3},
                            {LAYER_NORMAL, "N.Y", normal + 1, 3},
                            {LAYER_NORMAL, "N.Z", normal + 2, 3},
                            {0, "R", l->rgb, 3},
                            {LAYER_DEPTH, "Z", plane_of(l, 0), 1},
                            {LAYER_ALBEDO, "albedo.B", albedo + 2, 3},
                            {LAYER_ALBEDO, "albedo.G", albedo + 1, 3},
                            {LAYER_ALBEDO, "albedo.R", albedo, 3},
                            {LAYER_OCCLUSION, "occlusion.Y", plane_of(l, 7), 1},
                            {LAYER_SSAO, "ssao.Y", plane_of(l, 8), 1}};
    size_t count = 0;
    for (size_t i = 0; i < MOST_CHANNELS; i++)
        if (!all[i].layer || (l->layers & all[i].layer))
            channel[count++] = (pupil_exr_channel){all[i].name, all[i].data, all[i].step,
                                                   (ptrdiff_t)(all[i].step * l->facts.width * sizeof(float))};
    return count;
}

static void fill(layering *l)
{
    const fixture_ssao ssao = {.radius_m = LAYERS_RADIUS_M, .samples = LAYERS_SAMPLES, .hemisphere = 1, .range = 1};
    float *depth = plane_of(l, 0), *normal = plane_of(l, 1);
    for (size_t i = 0; i < (size_t)l->facts.width * l->facts.height; i++) {
        depth[i] = (float)l->g.depth[i];
        normal[3 * i] = (float)l->g.normal[i].x;
        normal[3 * i + 1] = (float)l->g.normal[i].y;
        normal[3 * i + 2] = (float)l->g.normal[i].z;
    }
    fixture_gbuffer_albedo(&l->g, plane_of(l, 4));
    if (l->layers & LAYER_OCCLUSION)
        fixture_gbuffer_open_by_rays(&l->g, LAYERS_RADIUS_M, LAYERS_RAYS, plane_of(l, 7));
    if (l->layers & LAYER_SSAO)
        fixture_gbuffer_open_by_screen(&l->g, &ssao, plane_of(l, 8));
}

static int write_file(const layering *l, const char *path, const char *name, pupil_why *why)
{
    pupil_exr_channel channel[MOST_CHANNELS];
    const size_t count = channels_of(l, channel);
    FILE *file = fopen(path, "wbe");
    int failed = !file || pupil_write_exr_channels(file, l->facts.width, l->facts.height, channel, count);
    int error = errno;
    if (file && fclose(file) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    return failed ? pupil_refuse(why, "%s: cannot be written: %s", name, strerror(error)) : 0;
}

static int render_frame(layering *l, uint64_t frame, const pupil_pending *p, pupil_why *why)
{
    char path[4352];
    if (fixture_scene_frame(l->scene, frame, l->rgb, NULL, why) || fixture_gbuffer_make(&l->g, l->scene, frame, why))
        return -1;
    fill(l);
    fixture_gbuffer_free(&l->g);
    if (!p->is_folder)
        return write_file(l, p->temporary, p->path, why);
    if ((size_t)snprintf(path, sizeof path, "%s/frame_%06" PRIu64 ".exr", p->temporary, frame) >= sizeof path)
        return pupil_refuse(why, "%s: the path is too long", p->path);
    return write_file(l, path, p->path, why);
}

static int reserve(layering *l, const char *scene, pupil_why *why)
{
    const size_t pixels = (size_t)l->facts.width * l->facts.height;
    l->rgb = malloc(3 * pixels * sizeof *l->rgb);
    l->plane = calloc(PLANES * pixels, sizeof *l->plane);
    return l->rgb && l->plane ? 0
                              : pupil_refuse(why, "%s: not enough memory for layers of %ux%u pixels", scene,
                                             l->facts.width, l->facts.height);
}

int layers_render(const char *scene, const pupil_source_options *options, unsigned layers, const char *path,
                  int overwrite, void (*progress)(void *context, uint64_t done, uint64_t total), void *context,
                  pupil_why *why)
{
    pupil_spread spread = {options->threads, options->stop};
    const fixture_scene_options o = {options->width, options->height, options->fps, pupil_spread_run, &spread};
    pupil_pending pending = {0};
    layering l = {.layers = layers};
    int single, failed = !pupil_is_linear_path(path, &single) || (single && strcmp(strrchr(path, '.'), ".exr") != 0);
    if (failed)
        return pupil_refuse(why, "%s: layers are written to a .exr, or a folder of them", path);
    if (fixture_scene_load(&l.scene, scene, &o, why))
        return -1;
    l.facts = fixture_scene_facts_of(l.scene);
    const uint64_t rest = l.facts.frames > options->first ? l.facts.frames - options->first : 1;
    const uint64_t frames = single ? 1 : options->frames ? options->frames : rest;
    failed = (single ? pupil_pending_file(&pending, path, overwrite, why)
                     : pupil_pending_folder(&pending, path, overwrite, why)) ||
             reserve(&l, scene, why);
    for (uint64_t i = 0; i < frames && !failed; i++) {
        failed = render_frame(&l, options->first + i, &pending, why) || (options->stop && options->stop());
        progress(context, i + 1, frames);
    }
    if (!failed)
        failed = pupil_pending_commit(&pending, why);
    pupil_pending_discard(&pending);
    fixture_scene_free(l.scene);
    free(l.rgb);
    free(l.plane);
    return failed ? -1 : 0;
}

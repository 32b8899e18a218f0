#include "synth/synth_source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "max_pixels.h"
#include "recipe.h"
#include "refuse.h"
#include "scene.h"
#include "synth/spread.h"

#define LONGEST_S 3.2e9 /* a hundred years; 2^63 ns are 292 */

typedef struct synth_source {
    pupil_source source;
    fixture_scene *scene;
    fixture_scene_facts facts;
    pupil_spread spread;
    uint64_t next, end;
    float *rgb;
    size_t name_bytes;
    char *recipe, *name;
} synth_source;

static int synth_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    synth_source *s = (synth_source *)source;
    if (s->next >= s->end)
        return PUPIL_SOURCE_END;
    memset(frame, 0, sizeof *frame);
    if (fixture_scene_frame(s->scene, s->next, s->rgb, &frame->info, why))
        return PUPIL_SOURCE_FAILED;
    if (s->spread.stop && s->spread.stop()) { /* then rows may be missing, of this frame and of those to come */
        s->end = s->next;
        pupil_refuse(why, "synth:%s: stopped", s->recipe);
        return PUPIL_SOURCE_FAILED;
    }
    snprintf(s->name, s->name_bytes, "synth:%s frame %llu", s->recipe, (unsigned long long)s->next);
    frame->image.data = s->rgb;
    frame->image.stride_bytes = (ptrdiff_t)(s->facts.width * 3 * sizeof(float));
    frame->image.width = s->facts.width;
    frame->image.height = s->facts.height;
    frame->image.pixel = PUPIL_PIXEL_RGB32F;
    frame->name = s->name;
    s->next++;
    return PUPIL_SOURCE_FRAME;
}

static void synth_done(pupil_source *source, pupil_frame *frame)
{
    (void)source;
    (void)frame;
}

static void synth_close(pupil_source *source)
{
    synth_source *s = (synth_source *)source;
    fixture_scene_free(s->scene);
    free(s->rgb);
    free(s->recipe);
    free(s->name);
    free(s);
}

static const pupil_source_ops synth_ops = {synth_next, synth_done, synth_close};

/* What is neither a file nor a shipped scene. */
static int refuse_name(const char *recipe, pupil_why *why)
{
    pupil_refuse(why, "there is no scene \"synth:%s\" and no such file; the scenes are:", recipe);
    for (size_t i = 0; fixture_shipped_names[i]; i++)
        pupil_refuse_add(why, "%s synth:%s", i ? "," : "", fixture_shipped_names[i]);
    return PUPIL_SOURCE_FAILED;
}

static int begin(synth_source *s, const char *recipe, const pupil_source_options *options, pupil_why *why)
{
    fixture_scene_options o = {options->width, options->height, options->fps, pupil_spread_run, &s->spread};
    s->spread = (pupil_spread){options->threads, options->stop};
    if (fixture_scene_load(&s->scene, recipe, &o, why))
        return -1;
    s->facts = fixture_scene_facts_of(s->scene);
    if (pupil_check_max_pixels(options, s->facts.width, s->facts.height, "synth:", recipe, why))
        return -1;
    s->next = options->first;
    uint64_t frames = options->frames                    ? options->frames
                      : s->facts.frames > options->first ? s->facts.frames - options->first
                                                         : 0;
    if (!frames || ((double)s->next + (double)frames) / s->facts.fps > LONGEST_S)
        return pupil_refuse(why, "synth:%s: no frame %llu; it has the frames 0 to %llu, and no scene lasts 100 years",
                            recipe, (unsigned long long)s->next, (unsigned long long)s->facts.frames - 1);
    s->end = s->next + frames;
    s->source.fps = s->facts.fps;
    s->source.frames = frames;
    s->name_bytes = strlen(recipe) + 64;
    s->recipe = strdup(recipe);
    s->name = malloc(s->name_bytes);
    s->rgb = malloc((size_t)s->facts.width * s->facts.height * 3 * sizeof(float));
    if (!s->recipe || !s->name || !s->rgb)
        return pupil_refuse(why, "synth:%s: not enough memory for frames of %ux%u pixels", recipe, s->facts.width,
                            s->facts.height);
    return 0;
}

int pupil_synth_source_open(const char *name, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why)
{
    if (!fixture_shipped(name) && access(name, F_OK) != 0)
        return refuse_name(name, why);
    synth_source *s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "synth:%s: out of memory", name);
        return PUPIL_SOURCE_FAILED;
    }
    s->source.ops = &synth_ops;
    s->source.obeys = PUPIL_SOURCE_FPS | PUPIL_SOURCE_SIZE;
    if (begin(s, name, options, why)) {
        synth_close(&s->source);
        return PUPIL_SOURCE_FAILED;
    }
    *source = &s->source;
    return 0;
}

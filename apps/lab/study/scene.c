/* The two states of light of a recipe: one render for each lamp, summed as for the recipe's frames, without its
 * sensor. */
#include "study.h"

#include <stdlib.h>
#include <string.h>

#include "file/sink/sink_common.h"
#include "refuse.h"
#include "scene.h"
#include "synth/spread.h"

static double level_sum(const fixture_scene *scene, size_t lights, uint64_t frame)
{
    double sum = 0.0;
    for (size_t i = 0; i < lights; i++)
        sum += fixture_scene_level(scene, i, frame);
    return sum;
}

/* Finds the frames with the least and the most light; 0: they are equal. */
static int find_states(const fixture_scene *scene, const fixture_scene_facts *facts, uint64_t state[2])
{
    double least = level_sum(scene, facts->lights, 0), most = least;
    state[0] = state[1] = 0;
    for (uint64_t i = 1; i < facts->frames; i++) {
        double sum = level_sum(scene, facts->lights, i);
        if (sum < least) {
            least = sum;
            state[0] = i;
        }
        if (sum > most) {
            most = sum;
            state[1] = i;
        }
    }
    return least < most;
}

static int sum_state(float *rgb, const fixture_scene *scene, const fixture_scene_facts *facts, uint64_t frame,
                     pupil_why *why)
{
    const float **image = malloc(facts->lights * sizeof *image);
    float *level = malloc(facts->lights * sizeof *level);
    const size_t samples = (size_t)facts->width * facts->height * 3;
    int failed = !image || !level;
    for (size_t i = 0; !failed && i < facts->lights; i++) {
        image[i] = fixture_scene_light_image(scene, i);
        level[i] = (float)fixture_scene_level(scene, i, frame);
        failed = !image[i];
    }
    if (!failed)
        fixture_sum_lights(rgb, image, level, facts->lights, samples);
    else
        pupil_refuse(why, "not enough memory for the scene's light");
    free(image);
    free(level);
    return failed ? -1 : 0;
}

static int take_states(study_images *images, fixture_scene *scene, const char *name, int (*stop)(void), pupil_why *why)
{
    const fixture_scene_facts facts = fixture_scene_facts_of(scene);
    uint64_t state[2];
    if (facts.moves)
        return pupil_refuse(why, "%s: its camera moves; the study needs one that does not", name);
    if (!find_states(scene, &facts, state))
        return pupil_refuse(why, "%s: its light never changes; the study needs a lamp with a level line", name);
    if (fixture_scene_prepare(scene, why))
        return -1;
    if (stop && stop())
        return pupil_refuse(why, "%s: stopped", name);
    if (study_images_reserve(images, facts.width, facts.height, why))
        return -1;
    for (int s = 0; s < 2; s++) {
        if (sum_state(images->state[s], scene, &facts, state[s], why)) {
            study_images_free(images);
            return -1;
        }
        study_images_round(images->state[s], (size_t)facts.width * facts.height * 3);
    }
    return 0;
}

int study_images_open(study_images *images, const char *scene, uint32_t width, uint32_t height, unsigned threads,
                      int (*stop)(void), pupil_why *why)
{
    pupil_spread spread = {threads, stop};
    fixture_scene *rendered = NULL;
    width = width ? width : 600;
    height = height ? height : 600;
    if (strcmp(scene, "spheres") == 0)
        return study_images_spheres(images, width, height, why);
    fixture_scene_options options = {width, height, 0.0, pupil_spread_run, &spread};
    if (fixture_scene_load(&rendered, scene, &options, why))
        return -1;
    int failed = take_states(images, rendered, scene, stop, why);
    fixture_scene_free(rendered);
    return failed;
}

/* A rendered scene for a simulated camera to look at. */
#include <stdlib.h>

#include "refuse.h"
#include "scene.h"
#include "sim.h"

int sim_luminance(const char *recipe, uint32_t width, uint32_t height, float **luminance, pupil_why *why)
{
    static const float weight[3] = {0.2126f, 0.7152f, 0.0722f}; /* Rec. ITU-R BT.709-6, item 3.2 */
    const size_t pixels = (size_t)width * height;
    const fixture_scene_options options = {.width = width, .height = height};
    fixture_scene *scene = NULL;
    float *sum = calloc(pixels, sizeof *sum);
    int failed = !sum ? pupil_refuse(why, "not enough memory for the scene")
                      : fixture_scene_load(&scene, recipe, &options, why) || fixture_scene_prepare(scene, why);
    const size_t lights = failed ? 0 : fixture_scene_facts_of(scene).lights;
    for (size_t l = 0; l < lights && !failed; l++) {
        const float *rgb = fixture_scene_light_image(scene, l);
        if (!rgb)
            failed = pupil_refuse(why, "%s: its camera moves; a simulated camera does not", recipe);
        for (size_t i = 0; i < 3 * pixels && !failed; i++)
            sum[i / 3] += weight[i % 3] * rgb[i];
    }
    fixture_scene_free(scene);
    if (failed) {
        free(sum);
        sum = NULL;
    }
    *luminance = sum;
    return failed ? -1 : 0;
}

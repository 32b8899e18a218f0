/* drivers/synth/scene_source.h: the frames of a scene from a recipe (fixtures/scene.h). */
#ifndef PUPIL_DRIVERS_SYNTH_SCENE_SOURCE_H
#define PUPIL_DRIVERS_SYNTH_SCENE_SOURCE_H

#include "pupil/error.h"
#include "source.h"

/* A recipe by path, or by the name of one that is shipped. Size, frame rate and number of frames are the recipe's
 * unless the options say otherwise. What frames have in common is rendered by the first next. */
int pupil_scene_source_open(const char *recipe, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why);

#endif

/* drivers/synth/synth_source.h: rendered frames: the scene of a recipe (fixtures/scene.h). */
#ifndef PUPIL_DRIVERS_SYNTH_SOURCE_H
#define PUPIL_DRIVERS_SYNTH_SOURCE_H

#include "pupil/error.h"
#include "source.h"

/* `name`: the path of a recipe, or a recipe that is built in ("walk", "room", "room-radiosity"). Linear light in RGB
 * float, the same bits on every machine. Size, frame rate and number of frames are the recipe's unless the options say
 * otherwise. The first call of next renders what frames have in common. */
int pupil_synth_source_open(const char *name, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why);

#endif

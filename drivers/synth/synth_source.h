/* drivers/synth/synth_source.h: frames made on the spot, without a file or a camera. */
#ifndef PUPIL_DRIVERS_SYNTH_SOURCE_H
#define PUPIL_DRIVERS_SYNTH_SOURCE_H

#include "pupil/error.h"
#include "source.h"

/* "walk": from a dark room to a bright window and back, with a flash on the way. Linear light in RGB float, 320x180 and
 * 300 frames unless the options say otherwise. The same bits on every machine: additions, multiplications, divisions
 * and square roots only.
 * Other names: a scene from a recipe (scene_source.h). */
int pupil_synth_source_open(const char *name, const pupil_source_options *options, pupil_source **source,
                            pupil_why *why);

#endif

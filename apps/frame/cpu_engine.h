/* apps/frame/cpu_engine.h: the pixels of a frame on several threads of the CPU, bit for bit as one thread does them. */
#ifndef PUPIL_APPS_FRAME_CPU_ENGINE_H
#define PUPIL_APPS_FRAME_CPU_ENGINE_H

#include "engine.h"
#include "frame_veil.h"

typedef struct cpu_engine cpu_engine;

/* `threads`: 0: one for each processor. NULL: not enough memory. */
cpu_engine *cpu_engine_open(unsigned threads);
void cpu_engine_close(cpu_engine *e); /* NULL is allowed */

/* From now on rows are mapped with these gains, one for each row of the frame (pupil/row_gain.h), except by
 * meter_and_map. NULL: with none. */
void cpu_engine_row_gains(cpu_engine *e, const float *gain);

/* From now on frames are mapped with their veil (frame_veil.h), except by meter_and_map, and unless bloom_above is NULL
 * with their bloom. -1: not enough memory. */
int cpu_engine_use_veil(cpu_engine *e, const pupil_veil_config *config, const double *bloom_above);
/* The veil of a frame that another engine meters; NULL and a sentence. */
const pupil_veil *cpu_engine_find_veil(cpu_engine *e, const pupil_t *pupil, const pupil_frame *frame, pupil_why *why);

extern const frame_engine_ops cpu_engine_ops; /* self: a cpu_engine. It maps any frame, not only the last one */

#endif

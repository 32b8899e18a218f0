/* apps/replay/explain.h: --explain: why a frame is as bright as it is, in plain words. */
#ifndef PUPIL_APPS_REPLAY_EXPLAIN_H
#define PUPIL_APPS_REPLAY_EXPLAIN_H

#include <stdio.h>

#include "output/frame_log.h"
#include "pupil/config.h"

/* Says what was metered, what limited the level, what clipped, and which option changes that. */
void explain_frame(FILE *out, const frame_log_entry *entry, const pupil_config *config);

#endif

/* drivers/live/kinds_private.h: the kinds of cameras that live.c chooses from. */
#ifndef PUPIL_DRIVERS_LIVE_KINDS_PRIVATE_H
#define PUPIL_DRIVERS_LIVE_KINDS_PRIVATE_H

#include "live.h"

/* The kernel's, or a stub where they are not built in. `which` without its prefix. */
int live_v4l2_open(const char *which, const pupil_live_options *options, pupil_source **source, pupil_why *why);

#endif

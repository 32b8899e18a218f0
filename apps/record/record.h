/* apps/record/record.h: pupil record: raw frames into a folder. */
#ifndef PUPIL_APPS_RECORD_RECORD_H
#define PUPIL_APPS_RECORD_RECORD_H

#include "live/live.h"

/* The whole command, with the cameras of `system` (NULL: the kernel's). The program's exit status. */
int record_on(const pupil_live_system *system, int argc, char **argv);

#endif

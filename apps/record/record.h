/* apps/record/record.h: pupil record: raw frames into a folder. */
#ifndef PUPIL_APPS_RECORD_RECORD_H
#define PUPIL_APPS_RECORD_RECORD_H

#include "v4l2/system.h"

/* The whole command, with the cameras of `system` (NULL: the kernel's). The program's exit status. */
int record_on(const pupil_v4l2_system *system, int argc, char **argv);

#endif

/* apps/run/run.h: `pupil run`, on any system of cameras. */
#ifndef PUPIL_APPS_RUN_RUN_H
#define PUPIL_APPS_RUN_RUN_H

#include "v4l2/system.h"

/* What run_main is; system NULL: the kernel. Once a process. */
int run_on(const pupil_v4l2_system *system, int argc, char **argv);

#endif

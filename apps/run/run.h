/* apps/run/run.h: `pupil run`, on any system of cameras. */
#ifndef PUPIL_APPS_RUN_RUN_H
#define PUPIL_APPS_RUN_RUN_H

#include "live/live.h"

/* As run_main; system NULL: the machine's. Once a process. */
int run_on(const pupil_live_system *system, int argc, char **argv);

#endif

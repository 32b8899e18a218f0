/* apps/common/command_line.h: the command line as a user would type it again. */
#ifndef PUPIL_APPS_COMMON_COMMAND_LINE_H
#define PUPIL_APPS_COMMON_COMMAND_LINE_H

#include <stddef.h>

/* "pupil" and the arguments, quoted where a shell would otherwise split them. */
void command_line(char *text, size_t bytes, int argc, char **argv);

#endif

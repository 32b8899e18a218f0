/* drivers/file/standard_input.h: looks at standard input before it is read. */
#ifndef PUPIL_DRIVERS_FILE_STANDARD_INPUT_H
#define PUPIL_DRIVERS_FILE_STANDARD_INPUT_H

#include "pupil/error.h"

/* A pipe can only be read once, from the front. An input that needs more (a still; an MP4 whose index comes last, as
 * cameras write it) is read into memory to its end, and this file replaces the pipe. 1: a still, which can be read from
 * /dev/stdin; 0: anything else; -1 and a sentence. `stop`: asked after each read that was interrupted; NULL: never. */
int pupil_standard_input_prepare(int (*stop)(void), pupil_why *why);

#endif

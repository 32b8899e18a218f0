/* drivers/file/standard_input.h: what comes in standard input, before it is read. */
#ifndef PUPIL_DRIVERS_FILE_STANDARD_INPUT_H
#define PUPIL_DRIVERS_FILE_STANDARD_INPUT_H

#include "pupil/error.h"

/* A pipe is read once and from its front. What needs more than that (a still; an MP4 whose index comes last, as cameras
 * write it) is read to its end, into memory, and takes the pipe's place as a file. 1: a still, which can be read from
 * /dev/stdin; 0: anything else; -1 and a sentence. `stop`: asked after each read that was interrupted; NULL: never. */
int pupil_standard_input_prepare(int (*stop)(void), pupil_why *why);

#endif

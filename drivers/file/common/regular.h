/* drivers/file/common/regular.h: texts that are read line by line must be files: a pipe may stay silent, and a device
 * such as /dev/zero never ends.
 */
#ifndef PUPIL_DRIVERS_FILE_COMMON_REGULAR_H
#define PUPIL_DRIVERS_FILE_COMMON_REGULAR_H

#include <stdio.h>

#include "pupil/error.h"

/* Opens a regular file (or a link to one) for reading. NULL and a sentence with the path, and errno; ENOENT: there is
 * none. */
FILE *pupil_regular_open(const char *path, pupil_why *why);

#endif

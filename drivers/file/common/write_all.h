/* drivers/file/common/write_all.h: all of some bytes into a file. */
#ifndef PUPIL_DRIVERS_FILE_COMMON_WRITE_ALL_H
#define PUPIL_DRIVERS_FILE_COMMON_WRITE_ALL_H

#include <stddef.h>

/* Continues after a short write or a signal. 0, or -1 and errno: then the number written is not known. Not for pipes:
 * a reader that has stopped would keep the program from ending. */
int pupil_write_all(int fd, const void *bytes, size_t count);

#endif

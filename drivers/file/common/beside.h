/* drivers/file/common/beside.h: the temporary names beside an output, ".NAME.PID.part", and the locks on them: a lock
 * ends with its process, so that a name without one was left by a process that was killed. */
#ifndef PUPIL_DRIVERS_FILE_COMMON_BESIDE_H
#define PUPIL_DRIVERS_FILE_COMMON_BESIDE_H

/* Names tried: leavings of killed processes of the same number, and outputs asked for twice. */
#define BESIDE_ATTEMPTS 100

/* "folder/.name.pid.ending", made as an empty file or folder that was not there before; fd: its own, locked. NULL:
 * errno says why. */
char *beside_make(const char *path, int is_folder, const char *ending, int *fd);

/* Removes what runs that were killed have left of this output. ".old" is what an output has replaced: it is kept where
 * there is nothing in its place. */
void beside_sweep(const char *path);

/* Whether a process that lives has begun this output, under another temporary name than `own`. */
int beside_is_held(const char *path, const char *own);

#endif

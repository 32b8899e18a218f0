/* drivers/file/common/beside.h: the temporary names beside an output, ".NAME.PID.part", and the locks on them: a lock
 * ends with its process, so a name without a lock was left by a killed process. */
#ifndef PUPIL_DRIVERS_FILE_COMMON_BESIDE_H
#define PUPIL_DRIVERS_FILE_COMMON_BESIDE_H

/* Names tried: some may be left from killed processes with the same PID, or the output was asked for twice. */
#define BESIDE_ATTEMPTS 100

/* "folder/.name.pid.ending", made as a new empty file or folder; fd: its descriptor, locked. NULL: errno says why. */
char *beside_make(const char *path, int is_folder, const char *ending, int *fd);

/* Removes what killed runs have left of this output. ".old" is a folder that an output has replaced: it is kept where
 * nothing is in its place. */
void beside_sweep(const char *path);

/* Whether a living process has begun this output under a temporary name other than `own`. */
int beside_is_held(const char *path, const char *own);

#endif

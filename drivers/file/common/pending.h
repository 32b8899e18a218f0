/* drivers/file/common/pending.h: outputs that are complete or absent. A pending file (or folder) is written under a
 * temporary name next to its place, and commit renames it; discard, or a signal, leaves nothing. What a killed process
 * has left is removed when the same output is begun again: it is recognised by its name, and by a lock that no process
 * holds.
 */
#ifndef PUPIL_DRIVERS_FILE_COMMON_PENDING_H
#define PUPIL_DRIVERS_FILE_COMMON_PENDING_H

#include "pupil/error.h"
#include <stddef.h>
#include <stdio.h>

typedef struct pupil_pending {
    char *path;      /* where it will be */
    char *temporary; /* where it is written: ".NAME.PID.part" (or ".NAME.PID-1.part" ...) in the same folder */
    int fd;          /* of that file or folder, locked (flock) until commit or discard */
    int is_folder;
    int is_merged; /* the folder may be there, and its other files stay */
    int overwrite; /* what is there is replaced; else it stays, and the output is refused */
    unsigned mode; /* permissions of the file that is there, which the new one gets; 0: nothing is there */
} pupil_pending;

/* Begins a file: checks that the folder is there and can be written (and that path is no folder, device or pipe) by
 * making `temporary`, empty; the caller writes it. A link is followed. A file that is there is refused, unless
 * overwrite; one that comes in the meantime is reported by commit. 0, or -1 and a sentence that names the path. */
int pupil_pending_file(pupil_pending *pending, const char *path, int overwrite, pupil_why *why);

/* The sentence of that refusal: which option replaces the file, and which name is free. Returns -1. */
int pupil_pending_keep(const char *path, pupil_why *why);

/* Begins a folder and makes it under the temporary name. A path that exists and is not empty is refused, unless
 * overwrite. Even with overwrite, here and in commit, it is refused where it holds anything but files named
 * frame_NNNNNN.png or .exr. */
int pupil_pending_folder(pupil_pending *pending, const char *path, int overwrite, pupil_why *why);

/* The same for a folder that may hold other files. Commit moves each of its own files into it, where (unless overwrite)
 * none may have that name; it checks all names first. */
int pupil_pending_into(pupil_pending *pending, const char *path, int overwrite, pupil_why *why);

/* Reserves the name of an output that is begun later, until `pending` is discarded: 0; 1 where something is there, or
 * another process reserves or writes it. Of two that ask at once at most one gets the name. Where the folder cannot be
 * written nothing is reserved, and begin will say so: 0. */
int pupil_pending_reserve(pupil_pending *pending, const char *path);

/* Whether the output whose name is reserved exists or has been begun, here or elsewhere: then others see that. */
int pupil_pending_is_begun(const pupil_pending *kept);

/* A file's stream at its beginning, for the caller to close. It is not opened by its name, which might be that of
 * another file by now. NULL: errno says why. */
FILE *pupil_pending_stream(const pupil_pending *pending);

/* Renames a file into place now and continues writing it there: what a live run has written stays, even if the process
 * is killed. From then on discard leaves the file. */
int pupil_pending_show(pupil_pending *pending, pupil_why *why);

/* Flushes to the disk (fsync), renames into place and frees. After a failure the caller discards. Where another file
 * (or a folder that is not empty) has been made there since and is not to be replaced, that is a failure, too: both
 * stay, and the sentence has the free name that this output got. */
int pupil_pending_commit(pupil_pending *pending, pupil_why *why);

/* Removes what was written. Safe after commit and twice. */
void pupil_pending_discard(pupil_pending *pending);

#endif

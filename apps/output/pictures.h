/* apps/output/pictures.h: every display output of a run as one: all complete, or none. */
#ifndef PUPIL_APPS_OUTPUT_PICTURES_H
#define PUPIL_APPS_OUTPUT_PICTURES_H

#include "live/live.h"
#include "pupil/error.h"
#include "sink.h"

#define PICTURES_MOST 17 /* those of the command line, and the video of a report */

typedef struct pictures {
    const pupil_live_system *system; /* of output nodes; NULL: the machine's */
    pupil_sink *sink[PICTURES_MOST];
    const char *path[PICTURES_MOST]; /* the caller's */
    size_t count;
    char silent[512]; /* "; PATH is without its sound: ...", of each video that has not got it */
    size_t failed;    /* which one, after a write or finish that failed */
} pictures;

/* Of pictures that are mapped so: a pupil_primaries, for pupil_sink_options. */
uint32_t pictures_primaries(const pupil_config *config);

int pictures_open(pictures *o, const char *path, const pupil_sink_options *options, pupil_why *why);
/* name: the frame's (pupil_sink.frame_name), or NULL. */
int pictures_write(pictures *o, const pupil_image_const *rgb8, const pupil_frame_info *info, const char *name,
                   pupil_why *why);

/* After one failed to write or to finish: it is discarded; the others continue. */
void pictures_drop(pictures *o);
/* 1: it was standard output, and its reader is gone. */
int pictures_reader_gone(const pictures *o);

/* Finishes all, up to the first that fails: those before it are complete, those after it as they were. */
int pictures_finish(pictures *o, pupil_why *why);
void pictures_discard(pictures *o);

#endif

/* apps/output/pictures.h: all display outputs of a run as one: all complete, or none. */
#ifndef PUPIL_APPS_OUTPUT_PICTURES_H
#define PUPIL_APPS_OUTPUT_PICTURES_H

#include "live/live.h"
#include "pupil/error.h"
#include "sink.h"

#define PICTURES_MOST 17 /* those of the command line, and the video of a report */

typedef struct pictures {
    const pupil_live_system *system; /* where the output nodes are; NULL: the machine's */
    pupil_sink *sink[PICTURES_MOST];
    const char *path[PICTURES_MOST]; /* the caller's */
    size_t count;
    char silent[512]; /* "; PATH is without its sound: ...", for each video without it */
    size_t failed;    /* the one that failed to write or finish */
} pictures;

/* The pupil_primaries of pictures mapped by this configuration, for pupil_sink_options. */
uint32_t pictures_primaries(const pupil_config *config);

int pictures_open(pictures *o, const char *path, const pupil_sink_options *options, pupil_why *why);
/* name: the frame's (pupil_sink.frame_name), or NULL. */
int pictures_write(pictures *o, const pupil_image_const *rgb8, const pupil_frame_info *info, const char *name,
                   pupil_why *why);

/* Discards the one that failed to write or to finish; the others continue. */
void pictures_drop(pictures *o);
/* 1: the failed one was standard output, and its reader is gone. */
int pictures_reader_gone(const pictures *o);

/* Finishes all, up to the first that fails: those before it are complete, those after it as they were. */
int pictures_finish(pictures *o, pupil_why *why);
void pictures_discard(pictures *o);

#endif

/* apps/split/split_input.h: the frames of a range, as pupil replay would have them. What replay knows from earlier
 * frames (the unit of the light, frame/any_scale.h) is found from the input's first frame with light. An input with
 * frames of sensor noise is refused: there the scale of a replay's later frames depends on the noise. */
#ifndef PUPIL_APPS_SPLIT_SPLIT_INPUT_H
#define PUPIL_APPS_SPLIT_SPLIT_INPUT_H

#include "common/progress.h"
#include "frame/any_scale.h"
#include "split_file.h"
#include "split_options.h"

typedef struct split_input {
    const split_options *options;
    pupil_source *source;
    any_scale scale;
    uint64_t number; /* of the next frame */
    int has_unit;    /* as in split_header */
    int unit_stops;
    uint64_t unit_frame;
    int is_at_end; /* the input has no more frames */
} split_input;

/* Opens it before the first frame of the range. `unit`: the header of a part or of curves that knows the unit; NULL: it
 * is found. 0, or -1 and a sentence. */
int split_input_open(split_input *s, split_options *options, const split_header *unit, pupil_why *why);

/* 1: a frame, to be given back; 0: the range or the input has ended, or Ctrl-C came; -1: a sentence. */
int split_input_next(split_input *s, pupil_frame *frame, pupil_why *why);
void split_input_done(split_input *s, pupil_frame *frame);

/* FNV-1a of some rows of a frame: different for another picture. */
uint64_t split_pixels(const pupil_image_const *image);

/* Fills in the header's fields of the input. */
void split_input_describe(const split_input *s, split_header *header);

void split_input_close(split_input *s);

/* The progress line, if it is due: the number of frames done, or of the next one. */
void split_show(progress *line, uint64_t frame);

/* "metered 100 frames in 2.0 s", without the end of the line. */
void split_tell(const char *what, uint64_t frames, double began_s);

/* The end of the three commands, after progress was cleared: prints why it failed, or nothing. Returns the exit
 * status. */
int split_end(const char *command, int failed, pupil_why *why);

#endif

/* drivers/file/pan/pan_path.h: where the camera of a pan looks at a time.
 *
 * Between keyframes yaw, pitch and field of view each follow a monotone cubic (F. N. Fritsch, J. Butland, "A method for
 * constructing local monotone piecewise cubic interpolants", 1984): smooth, and never beyond the keyframes. Before the
 * first and after the last the camera does not move.
 */
#ifndef PUPIL_DRIVERS_FILE_PAN_PAN_PATH_H
#define PUPIL_DRIVERS_FILE_PAN_PAN_PATH_H

#include "panorama.h"
#include "pupil/error.h"

#define PUPIL_PAN_MAX_KEYS 64
#define PUPIL_PAN_MIN_FOV  5.0
#define PUPIL_PAN_MAX_FOV  150.0

typedef struct pupil_pan_path {
    size_t count;
    int has_times; /* the text stamped its keyframes */
    double times[PUPIL_PAN_MAX_KEYS];
    double values[3][PUPIL_PAN_MAX_KEYS]; /* yaw (unwound: neighbours never differ by a turn they were not given),
                                           * pitch, fov; degrees */
    double slopes[3][PUPIL_PAN_MAX_KEYS]; /* degrees a second */
} pupil_pan_path;

/* Reads "yaw/pitch[/fov][@seconds]:..." (pan_source.h says what it means); keyframes without a field of view get the
 * given one. Call finish next. 0, or -1 and a sentence without the key's name. */
int pupil_pan_path_read(pupil_pan_path *path, const char *text, double fov, pupil_why *why);

/* A walk of seeded turns that passes both views, the second right after the first. Its times are not scaled yet. */
void pupil_pan_path_draw(pupil_pan_path *path, uint64_t seed, pupil_view brightest, pupil_view darkest, double fov);

/* Spreads keyframes without times evenly over the duration, unwinds yaw and finds the slopes. */
void pupil_pan_path_finish(pupil_pan_path *path, double duration_s);

pupil_view pupil_pan_path_at(const pupil_pan_path *path, double time_s);

/* Reads a finite number that ends at one of the characters in `ends` or at the end of the text; NULL if it does not.
 * Returns where it ended. */
const char *pupil_pan_number(const char *text, const char *ends, double *value);

#endif

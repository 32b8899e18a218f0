/* drivers/synth/walk.h: the scene "walk": a dark room, a bright window, and a camera that goes there and back.
 *
 * Units: metres; x to the right, y up, z from the back wall toward the window. Light is relative: the room lies around
 * 0.02..0.5, the sky outside around 100..400, the sun's disc at 20000.
 */
#ifndef PUPIL_DRIVERS_SYNTH_WALK_H
#define PUPIL_DRIVERS_SYNTH_WALK_H

#include <stdint.h>

#include "synth/walk_math.h"

#define PUPIL_WALK_SUN 20000.0f

/* Where the camera is, where it looks (three unit vectors) and how strongly its flash burns (0 or 1). */
typedef struct pupil_walk_view {
    v3 eye, right, up, forward;
    float flash;
} pupil_walk_view;

/* The view of frame `frame` of a clip of `frames`: the way is the same however many frames it is cut into. */
void pupil_walk_view_at(uint64_t frame, uint64_t frames, pupil_walk_view *view);

/* Renders width x height pixels of linear RGB, rows without gaps, top row first. */
void pupil_walk_render(const pupil_walk_view *view, uint32_t width, uint32_t height, float *rgb);

/* Light that comes along `direction` (any length) to `eye`, in the room ... */
v3 pupil_walk_room(const pupil_walk_view *view, v3 direction);

/* ... and from outside, where the view passes the window. */
v3 pupil_walk_outside(v3 direction);

/* The direction toward the sun, z = 1: high enough to throw the window's light onto the middle of the floor, and in
 * sight from 2 m before the window. */
static inline v3 pupil_walk_sun(void)
{
    return vec(-0.24f, 0.41f, 1.0f);
}

#endif

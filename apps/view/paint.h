/* apps/view/paint.h: boxes, lines and letters over the picture in the window; places are pixels from its top left. */
#ifndef PUPIL_APPS_VIEW_PAINT_H
#define PUPIL_APPS_VIEW_PAINT_H

#include "frame/gl_calls.h"
#include "pupil/error.h"

typedef struct view_paint view_paint;

typedef uint32_t view_colour; /* 0xRRGGBBAA, display codes */

/* NULL and a sentence: the driver refuses a shader, or no memory. `gl` stays the caller's. */
view_paint *view_paint_open(const gl_calls *gl, pupil_why *why);
void view_paint_close(view_paint *p);

/* Everything between begin and end is painted over the bound framebuffer, in that order. */
void view_paint_begin(view_paint *p, float width, float height);
void view_paint_end(view_paint *p);

void view_paint_box(view_paint *p, float x, float y, float width, float height, view_colour colour);
void view_paint_line(view_paint *p, const float from[2], const float to[2], float thick, view_colour colour);

/* Letters of `scale` pixels for each of the font's; '\n' begins a line. */
void view_paint_text(view_paint *p, float x, float y, float scale, view_colour colour, const char *text);
float view_paint_text_width(float scale, const char *text);

#endif

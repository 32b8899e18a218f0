/* apps/view/picture.h: shows a picture that the CPU mapped in the window: whole, centred, with its aspect ratio. */
#ifndef PUPIL_APPS_VIEW_PICTURE_H
#define PUPIL_APPS_VIEW_PICTURE_H

#include "frame/gl_calls.h"
#include "pupil/error.h"

typedef struct view_picture {
    const gl_calls *gl;
    GLuint program, array, texture;
    uint32_t width, height; /* of the texture; 0: none yet */
} view_picture;

/* 0, or -1 and a sentence. `gl` stays the caller's. */
int view_picture_open(view_picture *p, const gl_calls *gl, pupil_why *why);
void view_picture_close(view_picture *p);

/* Takes over the pixels of an RGB8 image without gaps. */
void view_picture_take(view_picture *p, const pupil_image_const *rgb8);

/* Draws the part from..to, 0..1, of the window's width, in a window of that size. */
void view_picture_draw(const view_picture *p, uint32_t width, uint32_t height, float from, float to);

#endif

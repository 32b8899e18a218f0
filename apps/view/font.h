/* apps/view/font.h: letters for the window, five pixels wide and seven high. */
#ifndef PUPIL_APPS_VIEW_FONT_H
#define PUPIL_APPS_VIEW_FONT_H

enum { VIEW_FONT_WIDTH = 5, VIEW_FONT_HEIGHT = 7, VIEW_FONT_STEP = 6, VIEW_FONT_LINE = 10 };

/* Rows from the top, the leftmost pixel in bit 4. Small letters are capitals; what has no picture is a '?'. */
const unsigned char *view_font_rows(char c);

#endif

/* apps/common/font.h: letters for windows and pictures, five pixels wide and seven high. */
#ifndef PUPIL_APPS_COMMON_FONT_H
#define PUPIL_APPS_COMMON_FONT_H

enum { FONT_WIDTH = 5, FONT_HEIGHT = 7, FONT_STEP = 6, FONT_LINE = 10 };

/* Rows from the top, the leftmost pixel in bit 4. Small letters are shown as capitals, characters without a glyph as
 * '?'. */
const unsigned char *font_rows(char c);

#endif

/* tests/freestanding/board.h: the only thing that a program on the bare board can do. */
#ifndef PUPIL_TESTS_BOARD_H
#define PUPIL_TESTS_BOARD_H

void board_print(const char *text);

#endif

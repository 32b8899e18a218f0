/* What a program needs to run as a WebAssembly module: an export that calls main, and an import that prints. */
#include "board.h"

int main(void);
int board_start(void);
void board_out(const char *text);

__attribute__((import_module("board"), import_name("print"))) void board_out(const char *text);

void board_print(const char *text)
{
    board_out(text);
}

__attribute__((export_name("start"))) int board_start(void)
{
    return main();
}

/* The rows of a command, group after group; --help is the last. */
#include "option_table.h"

const option_row *options_row(const option_command *command, size_t n, size_t *base)
{
    static const option_row help = {.name = "help", .letter = 'h', .help = "this text"};
    *base = 0;
    for (const option_group *g = command->groups; g && g->rows; g++) {
        if (n < g->rows) {
            *base = g->base;
            return &g->row[n];
        }
        n -= g->rows;
    }
    return n == 0 ? &help : NULL;
}

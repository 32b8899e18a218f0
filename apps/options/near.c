/* The name that a misspelt one was meant to be. */
#include <string.h>

#include "option_table.h"

enum { LONGEST = 40, FAR = 3 };

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* How many letters are wrong, missing or too many; a swap of two counts once (optimal string alignment). */
static size_t distance(const char *a, const char *b)
{
    const size_t rows = strlen(a), columns = strlen(b);
    size_t cost[LONGEST + 1][LONGEST + 1];
    if (rows > LONGEST || columns > LONGEST)
        return FAR;
    for (size_t r = 0; r <= rows; r++)
        for (size_t c = 0; c <= columns; c++) {
            if (!r || !c) {
                cost[r][c] = r + c;
                continue;
            }
            cost[r][c] = least(least(cost[r - 1][c], cost[r][c - 1]) + 1, cost[r - 1][c - 1] + (a[r - 1] != b[c - 1]));
            if (r > 1 && c > 1 && a[r - 1] == b[c - 2] && a[r - 2] == b[c - 1])
                cost[r][c] = least(cost[r][c], cost[r - 2][c - 2] + 1);
        }
    return cost[rows][columns];
}

void option_near_begin(option_near *near, const char *given)
{
    *near = (option_near){.given = given, .distance = least(FAR, strlen(given) / 2)};
}

void option_near_try(option_near *near, const char *name)
{
    const size_t length = strlen(near->given);
    const size_t d = length && strncmp(near->given, name, length) == 0 ? 0 : distance(near->given, name);
    if (d < near->distance) {
        near->distance = d;
        near->name = name;
    }
}

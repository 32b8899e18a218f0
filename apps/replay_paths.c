/* Outputs that would destroy an input or each other, found before anything is opened. */
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "replay_options.h"

enum { MOST_PATHS = REPLAY_MOST_OUTPUTS + 3 };

static size_t gather(const replay_options *o, const char *paths[MOST_PATHS])
{
    const char *others[] = {o->stats, o->plot, o->report};
    size_t count = 0;
    for (size_t i = 0; i < o->out_count; i++)
        paths[count++] = o->out[i];
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (others[i])
            paths[count++] = others[i];
    return count;
}

static int is_same_file(const char *a, const char *b)
{
    struct stat x, y;
    return stat(a, &x) == 0 && stat(b, &y) == 0 && S_ISREG(x.st_mode) && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

int replay_options_check_paths(const replay_options *o, char *why, size_t why_bytes)
{
    const char *paths[MOST_PATHS];
    size_t count = gather(o, paths);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < i; k++)
            if (strcmp(paths[i], paths[k]) == 0 || is_same_file(paths[i], paths[k])) {
                snprintf(why, why_bytes, "%s: named for two outputs; each needs a place of its own", paths[i]);
                return REPLAY_USAGE;
            }
        for (size_t k = 0; k < o->input_count; k++) {
            const char *input = o->inputs[k];
            size_t prefix = strncmp(input, "pan:", 4) == 0 ? 4 : 0;
            if (is_same_file(paths[i], input + prefix)) {
                snprintf(why, why_bytes, "%s: is also an input, and would be replaced", paths[i]);
                return REPLAY_USAGE;
            }
        }
    }
    return REPLAY_RUN;
}

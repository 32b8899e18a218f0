#include "kept.h"

#include <stdlib.h>
#include <string.h>

#include "live/live.h"
#include "refuse.h"

#define HEADER "pupil run --resume 1: exposure x gain in seconds, driver, bus, card of each camera\n"

enum { MOST_LINE = 64 + sizeof(pupil_live_identity), MOST_CAMERAS = 64, MOST_BYTES = MOST_CAMERAS * MOST_LINE };

typedef struct text {
    FILE *in;
    size_t bytes; /* read so far */
    int has_text; /* one byte was not 0 */
    char line[MOST_LINE];
} text;

/* The next line; one that is too long, is cut off or has a zero byte becomes "". 0: the text has no more. */
static int next_line(text *t)
{
    size_t length = 0;
    int c = 0, is_whole = 1;
    while (t->bytes < MOST_BYTES && c != '\n' && (c = getc(t->in)) != EOF) {
        t->bytes++;
        t->has_text |= c;
        is_whole = is_whole && c && length + 1 < sizeof t->line;
        if (is_whole)
            t->line[length++] = (char)c;
        else
            length = 1;
    }
    t->line[is_whole && c == '\n' ? length : 0] = 0;
    return length > 0;
}

/* "TOTAL\tDRIVER\tBUS\tCARD\n": the total, and what follows it. 0: not such a line. */
static int split_line(char *line, double *total_s, const char **camera)
{
    char *end;
    *total_s = strtod(line, &end);
    if (end == line || *end != '\t' || !(*total_s >= 0x1p-64 && *total_s <= 0x1p64)) /* pupil_sensor_start */
        return 0;
    *camera = end + 1;
    const char *bus = strchr(*camera, '\t'), *card = bus ? strchr(bus + 1, '\t') : NULL;
    return card && !strchr(card + 1, '\t');
}

/* A loss of power may leave a just written file with its size, but all zeros. */
static int is_zeroed(text *t)
{
    while (!t->has_text && next_line(t))
        ;
    return !t->has_text && t->bytes < MOST_BYTES;
}

int run_kept_read(FILE *in, const char *path, const char *camera, FILE *others, run_kept *kept, pupil_why *why)
{
    text t = {.in = in};
    *kept = (run_kept){0};
    if (next_line(&t) && strcmp(t.line, HEADER) != 0) {
        if (!is_zeroed(&t))
            return pupil_refuse(
                why, "%s: was not written by --resume, and is left as it is; name another one: --resume FILE", path);
        kept->is_damaged = 1;
        return 0;
    }
    for (int cameras = 1; cameras < MOST_CAMERAS && next_line(&t);) {
        double total = 0.0;
        const char *of = NULL;
        if (!split_line(t.line, &total, &of)) {
            kept->is_damaged = 1;
        } else if (camera && strncmp(of, camera, strlen(camera)) == 0 && strcmp(of + strlen(camera), "\n") == 0) {
            kept->total_s = total;
        } else {
            cameras++;
            if (others)
                fputs(t.line, others);
        }
    }
    kept->is_damaged |= t.bytes == MOST_BYTES;
    return ferror(in) ? pupil_refuse(why, "%s: cannot be read to its end", path) : 0;
}

void run_kept_write(FILE *out, const char *camera, double total_s)
{
    fprintf(out, HEADER "%.9g\t%s\n", total_s, camera);
}

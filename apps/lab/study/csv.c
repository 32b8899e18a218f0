/* The tables as lines: formula,case,weight,threshold,frame. */
#include "study.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "file/sink/sink_common.h"
#include "refuse.h"

#define HEAD "formula,case,weight,threshold,frame"

void study_csv(FILE *out, const study_cells *cells)
{
    fputs(HEAD "\n", out);
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++)
            for (unsigned w = 0; w < STUDY_WEIGHTS; w++)
                for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
                    fprintf(out, "%u,%u,%g,%llu,%u\n", f + 1, c + 1, study_weights[w],
                            (unsigned long long)cells->threshold[t], cells->frame[f][c][w][t]);
}

/* One line's place in the table; 0: none. The first threshold depends on the frame's size. */
static int place(const char *line, unsigned at[4], unsigned *frame)
{
    static const unsigned threshold[] = {0, 600, 60, 0};
    unsigned formula, which_case, value;
    double weight;
    int used = 0;
    if (sscanf(line, "%u,%u,%lf,%u,%u %n", &formula, &which_case, &weight, &value, frame, &used) != 5 || line[used])
        return 0;
    at[0] = formula - 1;
    at[1] = which_case - 1;
    for (at[2] = 0; at[2] < STUDY_WEIGHTS && fabs(weight - study_weights[at[2]]) > 1e-9;)
        at[2]++;
    for (at[3] = 1; at[3] < STUDY_THRESHOLDS && value != threshold[at[3]];)
        at[3]++;
    at[3] %= STUDY_THRESHOLDS;
    return at[0] < STUDY_FORMULAS && at[1] < STUDY_CASES && at[2]<STUDY_WEIGHTS && * frame> STUDY_FPS &&
           *frame < STUDY_FRAMES;
}

int study_csv_read(study_cells *cells, const char *path, pupil_why *why)
{
    char line[128];
    unsigned number = 0, known = 0, at[4], value;
    FILE *f = fopen(path, "re");
    if (!f)
        return pupil_refuse(why, "%s: cannot be read: %s", path, strerror(errno));
    memset(cells, 0, sizeof *cells);
    while (fgets(line, sizeof line, f)) {
        uint16_t *cell;
        if (number++ == 0 && strncmp(line, HEAD, strlen(HEAD)) == 0)
            continue;
        if (!place(line, at, &value) || *(cell = &cells->frame[at[0]][at[1]][at[2]][at[3]])) {
            fclose(f);
            return pupil_refuse(why,
                                "%s: line %u is not a cell of the tables, or one that was there already; lines are %s",
                                path, number, HEAD);
        }
        *cell = (uint16_t)value;
        known++;
    }
    int failed = ferror(f);
    fclose(f);
    if (failed || known != STUDY_FORMULAS * STUDY_CASES * STUDY_WEIGHTS * STUDY_THRESHOLDS)
        return pupil_refuse(why, "%s: has %u of the 1280 cells that the tables are", path, known);
    return 0;
}

/* The exposure's error over time: a panel for each weight, a line for each formula. */
#include "study.h"

#include <math.h>

#include "output/plot.h"

typedef struct drawing {
    const study_result *result;
    unsigned which_case;
} drawing;

static const unsigned shown_weight[] = {1, 5, 11}; /* 0.01, 0.05, 0.2 */
#define PANELS (sizeof shown_weight / sizeof shown_weight[0])

static void script(FILE *out, int is_png, const void *context)
{
    /* Okabe and Ito, as in plot.c */
    static const struct {
        unsigned formula;
        const char *colour, *title;
    } line[] = {{0, "#0072B2", "formula 1"}, {1, "#D55E00", "formula 2"}, {2, "#009E73", "formulas 3, 4"}};
    static const double seconds[PANELS] = {25.0, 10.0, 4.0};
    const drawing *d = context;
    const double from = d->which_case < 2 ? 1.0 : 2.0;

    fputs(is_png ? "set terminal pngcairo size 1000,360 font 'Sans,11' background '#ffffff'\n"
                 : "set terminal svg size 1000,360 dynamic font 'Helvetica,Arial,sans-serif,14' background '#ffffff'\n",
          out);
    fputs(study_final(d->which_case) ? "set key top right\n" : "set key bottom right\n", out);
    fputs("set encoding utf8\nset multiplot layout 1,3\nset border 3 lc '#666666'\nset tics nomirror out scale 0.6\n"
          "set grid lc '#dddddd' lt 1 lw 0.7\nset xzeroaxis lc '#555555' dt 2\nset xlabel 'time, seconds'\n"
          "set ylabel 'exposure too bright by, stops'\n",
          out);
    for (size_t p = 0; p < PANELS; p++) {
        const double to = from + seconds[p];
        fprintf(out, "set title 'w = %g, tau = %.2f s'\nset xrange [0:%g]\n", study_weights[shown_weight[p]],
                -1.0 / (STUDY_FPS * log1p(-study_weights[shown_weight[p]])), to);
        for (unsigned i = 0; i < 3; i++) {
            const double *u = d->result->states->u[line[i].formula][d->which_case][shown_weight[p]];
            fprintf(out, "$f%u << END\n", i);
            const unsigned most = (unsigned)(to * STUDY_FPS), every = 1 + most / 250; /* as many as are visible */
            for (unsigned frame = 0; frame < STUDY_FRAMES && frame <= most; frame++) {
                if (frame % every && frame % STUDY_FPS > 8)
                    continue;
                /* relative to the light in that frame, which is what a viewer sees */
                int lit = study_light_of(d->which_case, STUDY_FPS, frame), end = study_final(d->which_case);
                double shift = d->result->lights->ev[lit] - d->result->lights->ev[end];
                fprintf(out, "%.4f %.5f\n", frame / (double)STUDY_FPS, u[frame] / M_LN2 + shift);
            }
            fputs("END\n", out);
        }
        fputs("plot ", out);
        for (unsigned i = 0; i < 3; i++)
            fprintf(out, "%s$f%u w lines lw 2 lc '%s' t '%s'", i ? ", " : "", i, line[i].colour, line[i].title);
        fputs("\n", out);
    }
    fputs("unset multiplot\n", out);
}

int study_plot(const char *path, const study_result *result, unsigned which_case, pupil_why *why)
{
    drawing d = {result, which_case};
    return pupil_plot_draw(path, 1, script, &d, why);
}

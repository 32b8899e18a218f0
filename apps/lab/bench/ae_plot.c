/* pupil bench ae --plot: how each loop answers a step of the light up, and one down. */
#include <math.h>
#include <stdio.h>

#include "ae.h"
#include "output/plot.h"

enum { CURVES = FIXTURE_CONTROLLERS + 1, BEFORE = 300, SHOWN_BEFORE = 4, SHOWN = 45, STEPS = 2, DELAY = 3 };

static const double step_ev[STEPS] = {3, -3};

/* Okabe and Ito, as in plot.c; lines that could be confused are dashed. */
static const char *const style[CURVES] = {"lw 3 lc '#D55E00'",        "lw 2 lc '#D55E00' dt 2", "lw 1.6 lc '#0072B2'",
                                          "lw 1.6 lc '#56B4E9' dt 2", "lw 1.6 lc '#CC79A7'",    "lw 1.6 lc '#009E73'",
                                          "lw 1.6 lc '#E69F00'",      "lw 0.8 lc '#999999'"};

typedef struct answers {
    double error_ev[STEPS][CURVES][SHOWN];
    char name[CURVES][64];
} answers;

/* The error is relative to the loop's rest before the step, because the published laws have their own keys. */
static int answer(bench_ae *b, answers *a, int curve, const fixture_controller *law, int rejects)
{
    for (int step = 0; step < STEPS; step++) {
        fixture_loop loop;
        bench_ae_begin(&loop, law, DELAY, FIXTURE_GAIN_RECIPROCAL);
        loop.sensor.flash_frames *= rejects != 0;
        if (bench_ae_loop(b, &loop, BEFORE + SHOWN, "%.6fs step %gev", BEFORE * loop.plant.frame_s, step_ev[step]))
            return -1;
        const double rest = fixture_loop_sum_of(b->frame, BEFORE, 0, 60).aim_ev;
        for (int i = 0; i < SHOWN; i++)
            a->error_ev[step][curve][i] = b->frame[BEFORE - SHOWN_BEFORE + i].error_ev - rest;
    }
    snprintf(a->name[curve], sizeof a->name[curve], "%s%s", law->name,
             law->total || rejects ? "" : ", " BENCH_AE_NO_FLASH);
    return 0;
}

static void script(FILE *out, int is_png, const void *context)
{
    const answers *a = context;
    fputs(is_png ? "set terminal pngcairo size 1000,560 font 'Sans,11' background '#ffffff'\n"
                 : "set terminal svg size 1000,560 dynamic font 'Helvetica,Arial,sans-serif,14' background '#ffffff'\n",
          out);
    fprintf(out,
            "set encoding utf8\nset multiplot title 'the picture after a step of the light, delay %d' noenhanced\n"
            "set lmargin at screen 0.075\nset rmargin at screen 0.78\nset border 3 lc '#666666'\n"
            "set tics nomirror out scale 0.6\nset grid lc '#dddddd' lt 1 lw 0.7\nset xrange [%d:%d]\n"
            "set key at graph 1.015, graph 1.0 left top Left reverse samplen 2.6 spacing 1.2 noenhanced\n",
            DELAY, -SHOWN_BEFORE, SHOWN - SHOWN_BEFORE - 1);
    for (int step = 0; step < STEPS; step++) {
        fprintf(out, "set tmargin at screen %g\nset bmargin at screen %g\nset ylabel 'error, EV'\n", 0.93 - 0.43 * step,
                0.54 - 0.43 * step);
        fprintf(out,
                step ? "set format x '%%g'\nset xlabel 'frames since the step'\nunset key\n" : "set format x ''\n");
        for (int c = 0; c < CURVES; c++) {
            fprintf(out, "$c%d_%d << END\n", step, c);
            for (int i = 0; i < SHOWN; i++)
                fprintf(out, "%d %.5f\n", i - SHOWN_BEFORE, a->error_ev[step][c][i]);
            fputs("END\n", out);
        }
        /* the range of the step; larger swings are cut off */
        fprintf(out,
                "set yrange [%s]\nplot 0.1 w lines lw 0.8 dt 3 lc '#555555' t 'within 0.1 EV', "
                "-0.1 w lines lw 0.8 dt 3 lc '#555555' notitle",
                step_ev[step] > 0 ? "-1:3.4" : "-3.4:1");
        for (int c = CURVES - 1; c >= 0; c--)
            fprintf(out, ", $c%d_%d w steps %s t '%s'", step, c, style[c], a->name[c]);
        fputs("\n", out);
    }
    fputs("unset multiplot\n", out);
}

int bench_ae_plot(bench_ae *b)
{
    answers a;
    int curve = 0;
    for (size_t i = 0; i < FIXTURE_CONTROLLERS; i++) {
        const fixture_controller *law = &fixture_controllers[i];
        for (int rejects = 1; rejects >= (law->total ? 1 : 0); rejects--)
            if (answer(b, &a, curve++, law, rejects))
                return -1;
    }
    return pupil_plot_draw(b->plot, b->overwrite, script, &a, &b->why);
}

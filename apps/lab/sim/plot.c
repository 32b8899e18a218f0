/* pupil sim --plot: the light, the camera's settings, and the picture's error. */
#include <math.h>

#include "output/plot.h"
#include "sim.h"

/* Okabe and Ito, as in plot.c. */
#define BLUE      "#0072B2"
#define SKY       "#56B4E9"
#define VERMILION "#D55E00"
#define GREEN     "#009E73"
#define ORANGE    "#E69F00"

enum { MOST_LINES = 20000 };

static void data(FILE *out, const sim_run *run)
{
    const size_t every = run->frames / MOST_LINES + 1; /* with more points a frame would be thinner than a line */
    fputs("$run << END\n", out);
    for (size_t i = 0; i < run->frames; i += every) {
        const fixture_loop_frame *f = &run->frame[i];
        const fixture_truth *t = &f->truth;
        fprintf(out, "%.6f %.5f %.5f %.7g %.7g %.6g %.6g %.6g %.6g %.5f %.5f %.5f %.5f\n", t->time_s,
                t->light_ev - run->options->loop.plant.light_ev, t->steady_ev - run->options->loop.plant.light_ev,
                1e3 * t->exposure_s, 1e3 * f->setting.exposure_s, t->gain, f->setting.gain, t->digital,
                f->setting.frame_digital > 0.0 ? f->setting.frame_digital : t->digital, f->error_ev, f->shown_ev,
                t->band_ev, 100.0 * t->clipped_share);
    }
    fputs("END\n", out);
}

static void panel(FILE *out, int index, int count, const char *label)
{
    const double height = 0.88 / count, top = 0.945 - index * height;
    fprintf(out,
            "set tmargin at screen %g\nset bmargin at screen %g\nset label 1 '%s' at screen 0.016, screen %g center "
            "rotate\n",
            top, top - height + 0.022, label, top - 0.5 * height);
    fprintf(out,
            index == count - 1 ? "set format x '%%g'\nset xlabel 'time, seconds' offset 0,0.4\n" : "set format x ''\n");
}

/* The range of a number over all frames, never empty. */
static void range(FILE *out, const sim_run *run, double (*value)(const fixture_loop_frame *f), double at_least)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < run->frames; i++) {
        low = fmin(low, value(&run->frame[i]));
        high = fmax(high, value(&run->frame[i]));
    }
    const double more = fmax(0.06 * (high - low), 0.5 * (at_least - (high - low)));
    fprintf(out, "set yrange [%.7g:%.7g]\n", low - more, high + more);
}

static double light_of(const fixture_loop_frame *f)
{
    return f->truth.light_ev;
}

static double error_of(const fixture_loop_frame *f)
{
    return f->error_ev;
}

static double exposure_of(const fixture_loop_frame *f)
{
    return log2(f->truth.exposure_s);
}

static void script(FILE *out, int is_png, const void *context)
{
    const sim_run *run = context;
    const sim_options *o = run->options;
    const char *style = run->frames <= 150 ? "steps" : "lines";
    fputs(is_png ? "set terminal pngcairo size 1000,860 font 'Sans,11' background '#ffffff'\n"
                 : "set terminal svg size 1000,860 dynamic font 'Helvetica,Arial,sans-serif,14' background '#ffffff'\n",
          out);
    data(out, run);
    fprintf(out,
            "set encoding utf8\nset multiplot title '%s, delay %u/%u, believed %u' noenhanced offset 0,0.3\n"
            "set lmargin at screen 0.085\nset rmargin at screen 0.80\nset border 3 lc '#666666'\n"
            "set tics nomirror out scale 0.6\nset grid lc '#dddddd' lt 1 lw 0.7\n"
            "set key at graph 1.015, graph 1.0 left top Left reverse samplen 1.6 spacing 1.25 noenhanced\n",
            o->loop.law->name, o->loop.plant.delay[0], o->loop.plant.delay[1], o->loop.sensor.delay_frames);
    fprintf(out, "set xrange [%.6f:%.6f]\n", run->frame[0].truth.time_s,
            run->frame[run->frames - 1].truth.time_s + 1e-3);
    panel(out, 0, 5, "light, EV");
    fprintf(out, "l0 = %.7g\n", o->loop.plant.light_ev);
    range(out, run, light_of, 1.0);
    fprintf(out, "plot $run u 1:($2+l0) w %s lw 1.8 lc '" BLUE "' t 'scene (1 s, gain 1)'\n", style);
    panel(out, 1, 5, "exposure, log2 s");
    range(out, run, exposure_of, 1.0);
    fprintf(out,
            "plot $run u 1:(log($5/1e3)/log(2)) w %s lw 1.2 lc '" SKY "' t 'asked', "
            "$run u 1:(log($4/1e3)/log(2)) w %s lw 1.8 lc '" BLUE "' t 'in force'\n",
            style, style);
    panel(out, 2, 5, "factor");
    fprintf(out,
            "set yrange [0:*]\nplot $run u 1:6 w %s lw 1.8 lc '" GREEN "' t 'gain in force', "
            "$run u 1:9 w %s lw 1.4 lc '" ORANGE "' t 'digital, as shown'\n",
            style, style);
    panel(out, 3, 5, "error, EV");
    range(out, run, error_of, 0.5);
    fprintf(out,
            "plot 0 w lines dt 2 lw 1.2 lc '#555555' t 'key', $run u 1:10 w %s lw 2.2 lc '" VERMILION
            "' t 'sensor', $run u 1:11 w %s lw 1.2 lc '#000000' t 'as shown'\n",
            style, style);
    panel(out, 4, 5, "at rest, EV"); /* around where it comes to rest */
    fprintf(out,
            "set yrange [%.4f:%.4f]\nplot 0 w lines dt 2 lw 1.2 lc '#555555' t 'key', $run u 1:10 w %s lw 2.2 lc "
            "'" VERMILION "' t 'sensor', $run u 1:11 w %s lw 1.2 lc '#000000' t 'as shown', "
            "$run u 1:12 w %s lw 1.2 dt 3 lc '" BLUE "' t 'bands of lamps'\nunset multiplot\n",
            run->sum.aim_ev - 0.15, run->sum.aim_ev + 0.15, style, style, style);
}

int sim_plot(const sim_run *run, pupil_why *why)
{
    return pupil_plot_draw(run->options->plot, run->options->overwrite, script, run, why);
}

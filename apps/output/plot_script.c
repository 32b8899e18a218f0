/* What gnuplot is given of a run. */
#include "plot_script.h"

#include <ctype.h>
#include <math.h>

#include "plot_series.h"

/* Colours that stay apart for every kind of colour vision: Okabe and Ito, Color Universal Design, 2008. */
#define BLUE      "#0072B2"
#define SKY       "#56B4E9"
#define VERMILION "#D55E00"
#define GREEN     "#009E73"
#define PURPLE    "#CC79A7"
#define ORANGE    "#E69F00"

/* --- what is drawn --- */

static double get_time(const frame_log_entry *r)
{
    return r->time_s;
}

static double get_metered(const frame_log_entry *r)
{
    return r->metered_ev;
}

static double get_adapted(const frame_log_entry *r)
{
    return r->adapted_ev;
}

static double get_p01(const frame_log_entry *r)
{
    return r->p01_ev;
}

static double get_p99(const frame_log_entry *r)
{
    return r->p99_ev;
}

static double get_level(const frame_log_entry *r)
{
    return r->output_level;
}

static double get_clipped(const frame_log_entry *r)
{
    return 100.0 * r->clipped_share;
}

static double get_black(const frame_log_entry *r)
{
    return 100.0 * r->black_share;
}

static double get_white(const frame_log_entry *r)
{
    return 100.0 * r->output_white_share;
}

static double get_exposure(const frame_log_entry *r)
{
    return 1e3 * r->exposure_s;
}

static double get_asked_exposure(const frame_log_entry *r)
{
    return 1e3 * r->asked_exposure_s;
}

static double get_gain(const frame_log_entry *r)
{
    return r->gain;
}

static double get_asked_gain(const frame_log_entry *r)
{
    return r->asked_gain;
}

static double get_key(const frame_log_entry *r)
{
    return r->key;
}

/* How far off their keys the log-averages are of what the camera gave, and of what is shown of it. */
static double get_camera_error(const frame_log_entry *r)
{
    return r->scene_ev + log2(r->exposure_s * r->gain / r->camera_key);
}

static double get_shown_error(const frame_log_entry *r)
{
    return log2(r->output_level / r->key);
}

/* --- the script --- */

/* In single quotes gnuplot takes every character as it is, but a quote, which is doubled, and a line end. */
static void quoted(FILE *out, const char *text)
{
    fputc('\'', out);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', out);
        fputc(iscntrl((unsigned char)*text) ? ' ' : *text, out);
    }
    fputc('\'', out);
}

static void data(FILE *out, const frame_log_entry *records, size_t count)
{
    static const struct {
        const char *name;
        plot_value *value;
    } series[] = {{"metered", get_metered},
                  {"adapted", get_adapted},
                  {"level", get_level},
                  {"clipped", get_clipped},
                  {"black", get_black},
                  {"white", get_white},
                  {"exposure", get_exposure},
                  {"asked_exposure", get_asked_exposure},
                  {"gain", get_gain},
                  {"asked_gain", get_asked_gain},
                  {"key", get_key},
                  {"camera_error", get_camera_error},
                  {"shown_error", get_shown_error}};
    fputs("$range << END\n", out);
    plot_band(out, records, count, get_p01, get_p99);
    fputs("END\n", out);
    for (size_t i = 0; i < sizeof series / sizeof series[0]; i++) {
        fprintf(out, "$%s << END\n", series[i].name);
        plot_series(out, records, count, series[i].value);
        fputs("END\n", out);
    }
}

/* A range that is not empty: gnuplot would widen it too, but with a warning. */
static void axis(FILE *out, char name, double low, double high, double margin, double at_least)
{
    if (low > high)
        low = high = 0.0;
    double more = margin * (high - low);
    if (high - low < at_least)
        more = 0.5 * (at_least - (high - low));
    fprintf(out, "set %crange [%.9g:%.9g]\n", name, low - more, high + more);
}

static const double plain_edges[] = {0.93, 0.52, 0.29, 0.06}; /* of its panels, from the top */
static const double camera_edges[] = {0.945, 0.70, 0.53, 0.41, 0.20, 0.055};

static void panel(FILE *out, const double *top, int index, const char *label)
{
    fprintf(out, "set tmargin at screen %g\nset bmargin at screen %g\n", top[index], top[index + 1] + 0.025);
    /* A label in a fixed place: gnuplot puts its own next to the numbers, however far out that is. */
    fprintf(out, "set label 1 '%s' at screen 0.016, screen %g center rotate\n", label,
            0.5 * (top[index] + top[index + 1] + 0.025));
    fprintf(out, top[index + 1] < 0.1 ? "set format x '%%g'\nset xlabel 'time, seconds' offset 0,0.4\n"
                                      : "set format x ''\n");
}

/* What the camera was asked for, and what frames were taken with; both in powers of two. */
static void camera_panel(FILE *out, int index, const char *label, const char *name, plot_value *value,
                         plot_value *asked, const frame_log_entry *records, size_t count)
{
    double low = INFINITY, high = 0.0;
    plot_range(records, count, value, &low, &high);
    plot_range(records, count, asked, &low, &high);
    if (!(low > 0.0 && low <= high))
        low = high = 1.0;
    panel(out, camera_edges, index, label);
    fprintf(out, "set logscale y 2\nset yrange [%.9g:%.9g]\n", low / 1.5, high * 1.5);
    fprintf(out,
            "plot $asked_%s w steps lw 1.2 lc '" ORANGE "' t 'asked', $%s w steps lw 2 lc '" BLUE "' t 'in force'\n"
            "unset logscale y\n",
            name, name);
}

/* Of error: 0; with its number, where it was the same all the time. */
static void key_line(FILE *out, const frame_log_entry *records, size_t count, int of_error)
{
    double low = INFINITY, high = -INFINITY;
    plot_range(records, count, get_key, &low, &high);
    if (low == high)
        fprintf(out, "plot %.9g w lines dt 2 lw 1.4 lc '#555555' t 'key %g'", of_error ? 0.0 : low, low);
    else
        fprintf(out, "plot %s w lines dt 2 lw 1.4 lc '#555555' t 'key'", of_error ? "0" : "$key");
}

static void error_panel(FILE *out, const char *style, const frame_log_entry *records, size_t count)
{
    double low = 0.0, high = 0.0;
    plot_range(records, count, get_camera_error, &low, &high);
    plot_range(records, count, get_shown_error, &low, &high);
    panel(out, camera_edges, 3, "error, EV");
    axis(out, 'y', low, high, 0.06, 0.5);
    key_line(out, records, count, 1);
    fprintf(out,
            ", $camera_error w %s lw 2.2 lc '" VERMILION "' t 'camera', "
            "$shown_error w %s lw 1.2 lc '#000000' t 'as shown'\n",
            style, style);
}

static void light_panel(FILE *out, const double *edges, const char *style, const frame_log_entry *records, size_t count)
{
    double low = INFINITY, high = -INFINITY;
    plot_range(records, count, get_p01, &low, &high);
    plot_range(records, count, get_p99, &low, &high);
    plot_range(records, count, get_metered, &low, &high);
    plot_range(records, count, get_adapted, &low, &high);
    panel(out, edges, 0, "scene light, EV (stops)");
    axis(out, 'y', low, high, 0.04, 2.0);
    fprintf(out,
            "plot $range u 1:2:3 w filledcurves fc '" SKY "' fs transparent solid 0.25 noborder t '1 %% to 99 %%', "
            "$metered w %s lw 1.4 lc '" BLUE "' t 'metered', "
            "$adapted w %s lw 2.4 lc '" VERMILION "' t 'adapted'\n",
            style, style);
}

static void level_panel(FILE *out, const char *style, const frame_log_entry *records, size_t count)
{
    double level = 0x1p-10, nothing = 0.0;
    plot_range(records, count, get_key, &nothing, &level);
    level *= 2.0;
    plot_range(records, count, get_level, &nothing, &level);
    panel(out, plain_edges, 1, "display, linear");
    axis(out, 'y', 0.0, 1.05 * level, 0.0, 0.0);
    key_line(out, records, count, 0);
    fprintf(out, ", $level w %s lw 1.8 lc '" GREEN "' t 'log-average'\n", style);
}

static void share_panel(FILE *out, const double *edges, int index, const char *style, const frame_log_entry *records,
                        size_t count)
{
    double nothing = 0.0, share = 1.0;
    plot_range(records, count, get_clipped, &nothing, &share);
    plot_range(records, count, get_black, &nothing, &share);
    plot_range(records, count, get_white, &nothing, &share);
    panel(out, edges, index, "share, %");
    axis(out, 'y', 0.0, 1.05 * share, 0.0, 0.0);
    fprintf(out,
            "plot $clipped w %s lw 1.8 lc '" PURPLE "' t 'input clipped', "
            "$black w %s lw 1.8 dt 3 lc '#000000' t 'input black', "
            "$white w %s lw 1.8 dt 2 lc '" ORANGE "' t 'display at 255'\nunset multiplot\n",
            style, style, style);
}

/* Of a camera whose exposure is known, what was asked of it and what it did, too. */
void plot_script(FILE *out, int is_png, const frame_log_entry *records, size_t count, const char *title)
{
    const char *style = count <= 60 ? "linespoints pt 7 ps 0.5" : "lines";
    double from = INFINITY, to = -INFINITY, least = INFINITY, most = -INFINITY;
    plot_range(records, count, get_time, &from, &to);
    plot_range(records, count, get_exposure, &least, &most);
    const int has_camera = least > 0.0 && least <= most;
    const double *edges = has_camera ? camera_edges : plain_edges;

    fprintf(out,
            is_png
                ? "set terminal pngcairo size 1000,%d font 'Sans,11' background '#ffffff'\n"
                : "set terminal svg size 1000,%d dynamic font 'Helvetica,Arial,sans-serif,14' background '#ffffff'\n",
            has_camera ? 900 : 760);
    data(out, records, count);
    fputs("set encoding utf8\nset multiplot title ", out);
    quoted(out, title);
    fputs(" noenhanced offset 0,0.3\nset lmargin at screen 0.075\nset rmargin at screen 0.795\n"
          "set border 3 lc '#666666'\nset tics nomirror out scale 0.6\nset grid lc '#dddddd' lt 1 lw 0.7\n"
          "set key at graph 1.015, graph 1.0 left top Left reverse samplen 1.6 spacing 1.25 noenhanced\n",
          out);
    axis(out, 'x', from, to, 0.0, 1e-3);
    light_panel(out, edges, style, records, count);
    if (has_camera) {
        camera_panel(out, 1, "exposure, ms", "exposure", get_exposure, get_asked_exposure, records, count);
        camera_panel(out, 2, "gain", "gain", get_gain, get_asked_gain, records, count);
        error_panel(out, style, records, count);
    } else {
        level_panel(out, style, records, count);
    }
    share_panel(out, edges, has_camera ? 4 : 2, style, records, count);
}

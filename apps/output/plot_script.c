/* The gnuplot script of a run. */
#include "plot_script.h"

#include <ctype.h>
#include <math.h>

#include "plot_series.h"

/* Colours that every kind of colour vision can distinguish: Okabe and Ito, Color Universal Design, 2008. */
#define BLUE      "#0072B2"
#define SKY       "#56B4E9"
#define VERMILION "#D55E00"
#define GREEN     "#009E73"
#define PURPLE    "#CC79A7"
#define ORANGE    "#E69F00"

/* --- what is drawn --- */

/* The distance of the log-average from the wanted one: of the camera's frame, and of the shown one. */
static double camera_error(const frame_log_entry *r)
{
    return r->scene_ev + log2(r->exposure_s * r->gain / r->camera_key);
}

static double shown_error(const frame_log_entry *r)
{
    return log2(r->output_level / r->aimed_level);
}

#define MEMBER(name) offsetof(frame_log_entry, name)

enum {
    TIME,
    P01,
    P99,
    METERED,
    ADAPTED,
    LEVEL,
    AIMED,
    CLIPPED,
    BLACK,
    WHITE,
    EXPOSURE,
    ASKED_EXPOSURE,
    GAIN,
    ASKED_GAIN,
    KEY,
    CAMERA_ERROR,
    SHOWN_ERROR,
    VALUES
};

static const struct {
    const char *name; /* of its data in the script; NULL: no own data */
    plot_value value;
} series[VALUES] = {
    [TIME] = {NULL, {.offset = MEMBER(time_s)}},
    [P01] = {NULL, {.offset = MEMBER(p01_ev)}},
    [P99] = {NULL, {.offset = MEMBER(p99_ev)}},
    [METERED] = {"metered", {.offset = MEMBER(metered_ev)}},
    [ADAPTED] = {"adapted", {.offset = MEMBER(adapted_ev)}},
    [LEVEL] = {"level", {.offset = MEMBER(output_level)}},
    [CLIPPED] = {"clipped", {.offset = MEMBER(clipped_share), .factor = 100.0}},
    [BLACK] = {"black", {.offset = MEMBER(black_share), .factor = 100.0}},
    [WHITE] = {"white", {.offset = MEMBER(output_white_share), .factor = 100.0}},
    [EXPOSURE] = {"exposure", {.offset = MEMBER(exposure_s), .factor = 1e3}},
    [ASKED_EXPOSURE] = {"asked_exposure", {.offset = MEMBER(asked_exposure_s), .factor = 1e3}},
    [GAIN] = {"gain", {.offset = MEMBER(gain)}},
    [ASKED_GAIN] = {"asked_gain", {.offset = MEMBER(asked_gain)}},
    [AIMED] = {"aimed", {.offset = MEMBER(aimed_level)}},
    [KEY] = {NULL, {.offset = MEMBER(key)}},
    [CAMERA_ERROR] = {"camera_error", {.derived = camera_error}},
    [SHOWN_ERROR] = {"shown_error", {.derived = shown_error}},
};

static void range(const frame_log_entry *records, size_t count, int of, double *low, double *high)
{
    plot_range(records, count, &series[of].value, low, high);
}

/* --- the script --- */

/* In single quotes gnuplot takes every character literally, except a quote, which is doubled, and a line end. */
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
    fputs("$range << END\n", out);
    plot_band(out, records, count, &series[P01].value, &series[P99].value);
    fputs("END\n", out);
    for (size_t i = 0; i < VALUES; i++) {
        if (!series[i].name)
            continue;
        fprintf(out, "$%s << END\n", series[i].name);
        plot_series(out, records, count, &series[i].value);
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
    /* The label has a fixed place: gnuplot would put it next to the numbers, at varying distances. */
    fprintf(out, "set label 1 '%s' at screen 0.016, screen %g center rotate\n", label,
            0.5 * (top[index] + top[index + 1] + 0.025));
    fprintf(out, top[index + 1] < 0.1 ? "set format x '%%g'\nset xlabel 'time, seconds' offset 0,0.4\n"
                                      : "set format x ''\n");
}

/* The asked setting, and the one in force; both in powers of two. */
static void camera_panel(FILE *out, int index, const char *label, int value, int asked, const frame_log_entry *records,
                         size_t count)
{
    double low = INFINITY, high = 0.0;
    range(records, count, value, &low, &high);
    range(records, count, asked, &low, &high);
    if (!(low > 0.0 && low <= high))
        low = high = 1.0;
    panel(out, camera_edges, index, label);
    fprintf(out, "set logscale y 2\nset yrange [%.9g:%.9g]\n", low / 1.5, high * 1.5);
    fprintf(out,
            "plot $%s w steps lw 1.2 lc '" ORANGE "' t 'asked', $%s w steps lw 2 lc '" BLUE "' t 'in force'\n"
            "unset logscale y\n",
            series[asked].name, series[value].name);
}

/* The wanted level is below the key, because the tone curve compresses. The key's number is given if it was
 * constant. */
static void aimed_line(FILE *out, const frame_log_entry *records, size_t count, const char *line)
{
    double low = INFINITY, high = -INFINITY;
    range(records, count, KEY, &low, &high);
    fprintf(out, "plot %s w lines dt 2 lw 1.4 lc '#555555' t 'aimed at", line);
    if (low <= high && high - low < 1e-9) /* it is computed from a rounded scale */
        fprintf(out, ": key %.3g", low);
    fputc('\'', out);
}

static void error_panel(FILE *out, const char *style, const frame_log_entry *records, size_t count)
{
    double low = 0.0, high = 0.0;
    range(records, count, CAMERA_ERROR, &low, &high);
    range(records, count, SHOWN_ERROR, &low, &high);
    panel(out, camera_edges, 3, "error, EV");
    axis(out, 'y', low, high, 0.06, 0.5);
    aimed_line(out, records, count, "0");
    fprintf(out,
            ", $camera_error w %s lw 2.2 lc '" VERMILION "' t 'camera', "
            "$shown_error w %s lw 1.2 lc '#000000' t 'as shown'\n",
            style, style);
}

static void light_panel(FILE *out, const double *edges, const char *style, const frame_log_entry *records, size_t count)
{
    double low = INFINITY, high = -INFINITY;
    range(records, count, P01, &low, &high);
    range(records, count, P99, &low, &high);
    range(records, count, METERED, &low, &high);
    range(records, count, ADAPTED, &low, &high);
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
    range(records, count, AIMED, &nothing, &level);
    level *= 2.0;
    range(records, count, LEVEL, &nothing, &level);
    panel(out, plain_edges, 1, "display, linear");
    axis(out, 'y', 0.0, 1.05 * level, 0.0, 0.0);
    fputs("set label 2 'through the tone curve' at graph 1.02, 0.6 tc '#555555'\n", out);
    aimed_line(out, records, count, "$aimed");
    fprintf(out, ", $level w %s lw 1.8 lc '" GREEN "' t 'log-average'\nunset label 2\n", style);
}

static void share_panel(FILE *out, const double *edges, int index, const char *style, const frame_log_entry *records,
                        size_t count)
{
    double nothing = 0.0, share = 1.0;
    range(records, count, CLIPPED, &nothing, &share);
    range(records, count, BLACK, &nothing, &share);
    range(records, count, WHITE, &nothing, &share);
    panel(out, edges, index, "share, %");
    axis(out, 'y', 0.0, 1.05 * share, 0.0, 0.0);
    fprintf(out,
            "plot $clipped w %s lw 1.8 lc '" PURPLE "' t 'input clipped', "
            "$black w %s lw 1.8 dt 3 lc '#000000' t 'input black', "
            "$white w %s lw 1.8 dt 2 lc '" ORANGE "' t 'display at 255'\nunset multiplot\n",
            style, style, style);
}

/* If the camera's exposure is known, also what was asked and what was in force. */
void plot_script(FILE *out, int is_png, const frame_log_entry *records, size_t count, const char *title)
{
    const char *style = count <= 60 ? "linespoints pt 7 ps 0.5" : "lines";
    double from = INFINITY, to = -INFINITY, least = INFINITY, most = -INFINITY;
    range(records, count, TIME, &from, &to);
    range(records, count, EXPOSURE, &least, &most);
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
        camera_panel(out, 1, "exposure, ms", EXPOSURE, ASKED_EXPOSURE, records, count);
        camera_panel(out, 2, "gain", GAIN, ASKED_GAIN, records, count);
        error_panel(out, style, records, count);
    } else {
        level_panel(out, style, records, count);
    }
    share_panel(out, edges, has_camera ? 4 : 2, style, records, count);
}

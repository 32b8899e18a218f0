/* pupil bench kernels --plot: speed across, error up, one named point for each choice; a panel for metering, one for
 * mapping, one for frames of a camera. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "choices.h"
#include "common/interrupt.h"
#include "common/report_error.h"
#include "output/plot.h"

/* In pixels of the picture; a letter has the average width of gnuplot's Sans of 10 points. */
#define WIDE   1500.0
#define HIGH   520.0
#define LETTER 7.3
#define LINE   15.0
#define DOT    6.0

/* Okabe and Ito, as in plot.c. */
static const char *const colour[BENCH_GROUPS] = {"#0072B2", "#D55E00", "#0072B2", "#009E73", "#0072B2", "#D55E00"};
static const char *const mark[BENCH_GROUPS] = {"pt 7", "pt 9", "pt 7", "pt 5", "pt 7", "pt 9"};
static const char *const means[BENCH_GROUPS] = {"metering, natural frame", "metering, striped frame",
                                                "pupil, a whole frame",    "encoding alone, plain C",
                                                "NV12, a whole frame",     "10-bit mosaic, a whole frame"};

typedef struct box {
    double x0, y0, x1, y1;
} box;

typedef struct panel {
    bench_group first, last; /* groups in this panel */
    double x0, x1, y0, y1;   /* its axes, 0..1 of the picture */
    double fastest, slowest; /* ns: its axis */
    int lowest, highest;     /* error: powers of ten; exact choices are below the lowest */
    const char *error;
} panel;

enum { PANELS = 3 };

typedef struct drawing {
    const bench_choice *choice;
    size_t count;
    const char *title;
} drawing;

static int is_in(const panel *p, const bench_choice *c)
{
    return c->group >= p->first && c->group <= p->last;
}

static double height_of(const panel *p, const bench_choice *c)
{
    return c->error > 0.0 ? log10(c->error) : p->lowest;
}

static void fit(panel *p, const drawing *d)
{
    double lowest = 0.0, highest = -20.0;
    p->slowest = 0.0;
    for (size_t i = 0; i < d->count; i++) {
        const bench_choice *c = &d->choice[i];
        if (!is_in(p, c))
            continue;
        p->slowest = fmax(p->slowest, c->ns_per_px);
        if (c->error > 0.0) {
            lowest = fmin(lowest, log10(c->error));
            highest = fmax(highest, log10(c->error));
        }
    }
    p->slowest *= 1.45;                 /* room for the last name */
    p->lowest = (int)floor(lowest) - 2; /* and for the names of exact choices */
    p->highest = (int)ceil(fmax(highest, lowest) + 0.3);
}

static box point_of(const panel *p, const bench_choice *c)
{
    const double x = WIDE * (p->x0 + (p->x1 - p->x0) * c->ns_per_px / p->slowest);
    const double y =
        HIGH * (p->y0 + (p->y1 - p->y0) * (height_of(p, c) - p->lowest + 0.5) / (p->highest - p->lowest + 0.5));
    return (box){x - DOT, y - DOT, x + DOT, y + DOT};
}

static int apart(const box *a, const box *b)
{
    return a->x1 < b->x0 || b->x1 < a->x0 || a->y1 < b->y0 || b->y1 < a->y0;
}

static int is_free(const box *wanted, const box *taken, size_t count, const panel *p)
{
    if (wanted->x0 < WIDE * p->x0 + 4.0 || wanted->x1 > WIDE * p->x1 + 4.0 || wanted->y0 < HIGH * p->y0 + 2.0 ||
        wanted->y1 > HIGH * p->y1)
        return 0;
    for (size_t i = 0; i < count; i++)
        if (!apart(wanted, &taken[i]))
            return 0;
    return 1;
}

static void label(FILE *out, const bench_choice *c, double x, double y, int left)
{
    fprintf(out, "set label '%s", c->name);
    if (c->code_max > 1)
        fprintf(out, " (up to %d codes)", c->code_max);
    fprintf(out, "' at screen %.5f, screen %.5f %s tc '%s' font ',10' noenhanced front\n", x / WIDE, y / HIGH,
            left ? "right" : "left", colour[c->group]);
}

static void line(FILE *out, const bench_choice *c, double x0, double y0, double x1, double y1)
{
    fprintf(out, "set arrow from screen %.5f, screen %.5f to screen %.5f, screen %.5f nohead lw 0.6 lc '%s'\n",
            x0 / WIDE, y0 / HIGH, x1 / WIDE, y1 / HIGH, colour[c->group]);
}

static double width_of(const bench_choice *c)
{
    return LETTER * (double)(strlen(c->name) + (c->code_max > 1 ? 16 : 0));
}

/* Puts a name in the first free place right or left of its point, each time one line higher or lower; a thin line
 * connects it with the point. */
static void name_point(FILE *out, const panel *p, const bench_choice *c, box *taken, size_t *count)
{
    const box at = point_of(p, c);
    const double wide = width_of(c), middle = 0.5 * (at.y0 + at.y1);
    for (int step = 0; step < 80; step++) {
        const int left = step & 1, lines = (step / 2 + 1) / 2 * ((step / 2 & 1) ? 1 : -1);
        const double gap = lines ? 10.0 : 3.0, y = middle + LINE * lines;
        const double x = left ? at.x0 - gap - wide : at.x1 + gap;
        const box wanted = {x, y - 0.5 * LINE, x + wide, y + 0.5 * LINE};
        if (!is_free(&wanted, taken, *count, p))
            continue;
        taken[(*count)++] = wanted;
        label(out, c, left ? x + wide : x, y, left);
        if (lines)
            line(out, c, 0.5 * (at.x0 + at.x1), middle, left ? x + wide + 1.0 : x - 1.0, y);
        return;
    }
}

/* Exact choices are on one line. Their names are flags above it, with higher masts farther left, so that no mast
 * crosses a name. */
static void name_exact(FILE *out, const panel *p, const drawing *d, box *taken, size_t *count)
{
    for (size_t i = 0; i < d->count; i++) {
        const bench_choice *c = &d->choice[i];
        int rank = 1;
        if (!is_in(p, c) || c->error > 0.0)
            continue;
        for (size_t k = 0; k < d->count; k++)
            rank += is_in(p, &d->choice[k]) && !(d->choice[k].error > 0.0) &&
                    (d->choice[k].ns_per_px > c->ns_per_px || (d->choice[k].ns_per_px == c->ns_per_px && k > i));
        const box at = point_of(p, c);
        const double x = 0.5 * (at.x0 + at.x1), y = at.y1 + LINE * (rank - 0.4), wide = width_of(c);
        const int left = x + 4.0 + wide > WIDE * p->x1 + 12.0;
        line(out, c, x, at.y1, x, y + 0.4 * LINE);
        label(out, c, left ? x - 4.0 : x + 4.0, y, left);
        taken[(*count)++] = (box){left ? x - 4.0 - wide : x, at.y0, left ? x : x + 4.0 + wide, y + 0.5 * LINE};
    }
}

static void axes(FILE *out, const panel *p)
{
    fprintf(out,
            "unset label\nunset arrow\nset lmargin at screen %g\nset rmargin at screen %g\n"
            "set bmargin at screen %g\nset tmargin at screen %g\nset xrange [0:%.6g]\nset yrange [%g:%d]\n",
            p->x0, p->x1, p->y0, p->y1, p->slowest, p->lowest - 0.5, p->highest);
    fprintf(out, "set ylabel '%s' offset 1,0\nset xlabel 'ns for a pixel'\nset ytics ('exact' %d", p->error, p->lowest);
    const int every = p->highest - p->lowest > 8 ? 2 : 1;
    for (int decade = p->lowest + 2; decade <= p->highest; decade += every)
        fprintf(out, ", '%g' %d", pow(10.0, decade), decade);
    fprintf(out, ")\nset arrow from graph 0, first %d to graph 1, first %d nohead lw 1.2 dt 2 lc '#555555' back\n",
            p->lowest, p->lowest);
}

static void draw_panel(FILE *out, panel *p, const drawing *d)
{
    box taken[2 * BENCH_MOST_CHOICES];
    size_t count = 0;
    fit(p, d);
    axes(out, p);
    for (size_t i = 0; i < d->count; i++)
        if (is_in(p, &d->choice[i]))
            taken[count++] = point_of(p, &d->choice[i]);
    name_exact(out, p, d, taken, &count);
    for (size_t i = 0; i < d->count; i++)
        if (is_in(p, &d->choice[i]) && d->choice[i].error > 0.0)
            name_point(out, p, &d->choice[i], taken, &count);
    for (int group = p->first; group <= (int)p->last; group++) {
        fprintf(out, "$g%d << END\n", group);
        for (size_t i = 0; i < d->count; i++)
            if ((int)d->choice[i].group == group)
                fprintf(out, "%.6g %.6g\n", d->choice[i].ns_per_px, height_of(p, &d->choice[i]));
        fputs("END\n", out);
    }
    for (int group = p->first; group <= (int)p->last; group++)
        fprintf(out, "%s$g%d w points %s ps 1.1 lc '%s' t '%s'", group == (int)p->first ? "plot " : ", ", group,
                mark[group], colour[group], means[group]);
    fputs("\n", out);
}

static void script(FILE *out, int is_png, const void *context)
{
    const drawing *d = context;
    panel panels[PANELS] = {
        {.first = BENCH_GROUP_NATURAL, .last = BENCH_GROUP_STRIPED, .error = "error of the log-average, EV"},
        {.first = BENCH_GROUP_FRAME, .last = BENCH_GROUP_ENCODER, .error = "share of samples that are one code off"},
        {.first = BENCH_GROUP_CAMERA, .last = BENCH_GROUP_MOSAIC, .error = "mean error, codes"}};
    for (int i = 0; i < PANELS; i++) {
        panels[i].x0 = 0.05 + 0.335 * i;
        panels[i].x1 = panels[i].x0 + 0.265;
        panels[i].y0 = 0.11;
        panels[i].y1 = 0.83;
    }
    fprintf(out, "set terminal %s size %g,%g %s background '#ffffff'\n", is_png ? "pngcairo" : "svg", WIDE, HIGH,
            is_png ? "font 'Sans,10'" : "dynamic font 'Helvetica,Arial,sans-serif,13'");
    fprintf(out,
            "set encoding utf8\nset multiplot title '%s' noenhanced\nset border 3 lc '#666666'\n"
            "set tics nomirror out scale 0.6\nset grid lc '#dddddd' lt 1 lw 0.7\n"
            "set key at graph 0.02, graph 1.02 left bottom Left reverse samplen 1 noenhanced\n",
            d->title);
    for (int i = 0; i < PANELS; i++)
        draw_panel(out, &panels[i], d);
    fputs("unset multiplot\n", out);
}

int bench_plot(const bench_options *o, workers *crew, const bench_flush *flush)
{
    bench_choice choice[BENCH_MOST_CHOICES];
    size_t count;
    char title[128];
    pupil_why why;
    const uint32_t level = bench_best_level();
    if (bench_choices(o, crew, flush, level, choice, &count))
        return interrupt_came() ? BENCH_INTERRUPTED : BENCH_FAILED;
    printf("%-30s %-24s %8s %10s %6s\n", "choice", "of", "ns/px", "error", "codes");
    for (size_t i = 0; i < count; i++)
        printf("%-30s %-24s %8.3f %10.2e %6d\n", choice[i].name, means[choice[i].group], choice[i].ns_per_px,
               choice[i].error, choice[i].code_max);
    snprintf(title, sizeof title, "RGBA float and frames of a camera, %lux%lu, one thread, %s, %s",
             (unsigned long)o->width, (unsigned long)o->height, bench_level_names[level], flush ? "cold" : "warm");
    const drawing d = {choice, count, title};
    if (pupil_plot_draw(o->plot, o->overwrite, script, &d, &why)) {
        report_error("pupil bench", &why, "");
        return BENCH_FAILED;
    }
    return BENCH_DONE;
}

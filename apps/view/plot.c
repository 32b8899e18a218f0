#include "plot.h"

#include <math.h>
#include <stdio.h>

#include "common/font.h"

/* As in plot.c: Okabe and Ito, Color Universal Design, 2008. */
#define BLUE      0x0072B2ffu
#define VERMILION 0xD55E00ffu
#define GREEN     0x009E73ffu
#define GREY      0xA0A0A0ffu
#define WHITE     0xF0F0F0ffu
#define SHADE     0x000000d0u

#define SECONDS 10.0

typedef struct panel { /* the place of one of the two diagrams, and the values at its edges */
    float x, y, width, height;
    double from_s, low, high;
} panel;

/* A member of view_plot_point. */
typedef enum plotted { METERED, ADAPTED, LEVEL, AIMED } plotted;

static double value_of(const view_plot_point *point, plotted of)
{
    switch (of) {
    case METERED:
        return point->metered_ev;
    case ADAPTED:
        return point->adapted_ev;
    case LEVEL:
        return point->level;
    default:
        return point->aimed_level;
    }
}

void view_plot_add(view_plot *plot, const frame_log_entry *record)
{
    plot->point[plot->next] = (view_plot_point){record->time_s, record->metered_ev, record->adapted_ev,
                                                record->output_level, record->aimed_level};
    plot->next = (plot->next + 1) % VIEW_PLOT_MOST;
    plot->count += plot->count < VIEW_PLOT_MOST;
}

/* 0 is the oldest. */
static const view_plot_point *at(const view_plot *plot, size_t i)
{
    return &plot->point[(plot->next + VIEW_PLOT_MOST - plot->count + i) % VIEW_PLOT_MOST];
}

static void widen(const view_plot *plot, panel *on, plotted of)
{
    for (size_t i = 0; i < plot->count; i++) {
        const double v = value_of(at(plot, i), of);
        if (at(plot, i)->time_s < on->from_s || !isfinite(v))
            continue;
        on->low = v < on->low ? v : on->low;
        on->high = v > on->high ? v : on->high;
    }
}

static float height_of(const panel *on, double value)
{
    const double share = (value - on->low) / (on->high - on->low);
    return on->y + on->height * (float)(1.0 - (share < 0.0 ? 0.0 : share > 1.0 ? 1.0 : share));
}

static void curve(const view_plot *plot, view_paint *p, const panel *on, plotted of, float thick, view_colour colour)
{
    float before[2] = {0};
    int begun = 0;
    for (size_t i = 0; i < plot->count; i++) {
        const view_plot_point *point = at(plot, i);
        if (point->time_s < on->from_s || !isfinite(value_of(point, of)))
            continue;
        const float here[2] = {on->x + on->width * (float)((point->time_s - on->from_s) / SECONDS),
                               height_of(on, value_of(point, of))};
        if (begun)
            view_paint_line(p, before, here, thick, colour);
        else
            view_paint_box(p, here[0], here[1] - 0.5f * thick, thick, thick, colour);
        before[0] = here[0];
        before[1] = here[1];
        begun = 1;
    }
}

/* The thinnest line of at least a pixel: a thinner line between two pixel centres would be invisible. */
static float hair(float scale)
{
    return fmaxf(1.0f, floorf(0.5f * scale));
}

static void frame_of(view_paint *p, const panel *on, float scale)
{
    const float thin = hair(scale), bottom = floorf(on->y + on->height);
    view_paint_box(p, on->x, floorf(on->y), thin, bottom - floorf(on->y), GREY);
    view_paint_box(p, on->x, bottom, on->width, thin, GREY);
}

/* The numbers at the edges, right of the axis. */
static void edges(view_paint *p, const panel *on, float scale, const char *format)
{
    char text[32];
    const float x = on->x + on->width + 3.0f * scale;
    snprintf(text, sizeof text, format, on->high);
    view_paint_text(p, x, on->y, scale, WHITE, text);
    snprintf(text, sizeof text, format, on->low);
    view_paint_text(p, x, on->y + on->height - FONT_HEIGHT * scale, scale, WHITE, text);
}

static void legend(view_paint *p, float x, float y, float scale)
{
    static const struct {
        const char *name;
        view_colour colour;
    } line[] = {{"metered EV", BLUE}, {"adapted EV", VERMILION}, {"output level", GREEN}, {"aimed at", GREY}};
    for (size_t i = 0; i < sizeof line / sizeof line[0]; i++) {
        view_paint_box(p, x, y + 2.0f * scale, 12.0f * scale, 3.0f * scale, line[i].colour);
        view_paint_text(p, x + 16.0f * scale, y, scale, WHITE, line[i].name);
        x += 32.0f * scale + view_paint_text_width(scale, line[i].name);
    }
}

void view_plot_paint(const view_plot *plot, view_paint *p, float width, float height, float scale, double key)
{
    const float margin = 8.0f * scale, line = FONT_LINE * scale, numbers = 40.0f * scale;
    const float all = fminf(0.45f * height, 130.0f * scale), top = height - all;
    const double now_s = plot->count ? at(plot, plot->count - 1)->time_s : 0.0;
    const float room = all - margin - 1.5f * line - margin; /* under the legend */
    panel ev = {.x = margin, .y = top + margin + 1.5f * line, .width = width - 2.0f * margin - numbers};
    ev.height = 0.62f * room;
    ev.from_s = now_s - SECONDS;
    panel out = ev;
    out.y += 0.7f * room;
    out.height = 0.3f * room;
    out.low = 0.0;
    out.high = 2.0 * key;
    ev.low = INFINITY;
    ev.high = -INFINITY;
    if (ev.width <= 0.0f || room <= 0.0f)
        return; /* the window is too small for a plot */
    widen(plot, &ev, METERED);
    widen(plot, &ev, ADAPTED);
    widen(plot, &out, LEVEL);
    widen(plot, &out, AIMED);
    if (!(ev.low <= ev.high))
        ev.low = ev.high = 0.0;
    const double more = ev.high - ev.low < 2.0 ? 0.5 * (2.0 - (ev.high - ev.low)) : 0.05 * (ev.high - ev.low);
    ev.low -= more;
    ev.high += more;

    view_paint_box(p, 0.0f, top, width, all, SHADE);
    legend(p, margin, top + margin, scale);
    frame_of(p, &ev, scale);
    frame_of(p, &out, scale);
    edges(p, &ev, scale, "%+.1f");
    edges(p, &out, scale, "%.2f");
    curve(plot, p, &ev, METERED, 1.4f * scale, BLUE);
    curve(plot, p, &ev, ADAPTED, 1.8f * scale, VERMILION);
    curve(plot, p, &out, AIMED, hair(scale), GREY);
    curve(plot, p, &out, LEVEL, 1.4f * scale, GREEN);
}

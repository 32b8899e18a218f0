#include "plot_series.h"

#include <math.h>

_Static_assert(FRAME_LOG_BOUND / 2 >= 2 * PLOT_MOST_POINTS, "a log that was thinned out is finer than its plot");

static double number(const plot_value *value, const frame_log_entry *entry)
{
    if (value->derived)
        return value->derived(entry);
    const double member = *(const double *)(const void *)((const char *)entry + value->offset);
    return value->factor > 0.0 ? value->factor * member : member;
}

static int usable(const frame_log_entry *record, double value)
{
    return isfinite(record->time_s) && isfinite(value);
}

static void point(FILE *out, const frame_log_entry *record, double value)
{
    fprintf(out, "%.9g %.9g\n", record->time_s, value);
}

void plot_series(FILE *out, const frame_log_entry *records, size_t count, const plot_value *value)
{
    size_t stretch = count <= PLOT_MOST_POINTS ? 1 : (count + PLOT_MOST_POINTS / 2 - 1) / (PLOT_MOST_POINTS / 2);
    for (size_t from = 0; from < count; from += stretch) {
        size_t end = count - from < stretch ? count : from + stretch, least = end, most = end;
        for (size_t i = from; i < end; i++) {
            if (!usable(&records[i], number(value, &records[i])))
                continue;
            if (least == end || number(value, &records[i]) < number(value, &records[least]))
                least = i;
            if (most == end || number(value, &records[i]) > number(value, &records[most]))
                most = i;
        }
        if (least == end)
            continue;
        size_t first = least < most ? least : most, second = least < most ? most : least;
        point(out, &records[first], number(value, &records[first]));
        if (second != first)
            point(out, &records[second], number(value, &records[second]));
    }
}

void plot_band(FILE *out, const frame_log_entry *records, size_t count, const plot_value *low, const plot_value *high)
{
    size_t stretch = (count + PLOT_MOST_POINTS - 1) / PLOT_MOST_POINTS;
    for (size_t from = 0; from < count; from += stretch) {
        size_t end = count - from < stretch ? count : from + stretch;
        double least = INFINITY, most = -INFINITY, time_s = 0.0;
        for (size_t i = from; i < end; i++) {
            double a = number(low, &records[i]), b = number(high, &records[i]);
            if (!usable(&records[i], a) || !usable(&records[i], b))
                continue;
            if (least > most)
                time_s = records[i].time_s;
            least = a < least ? a : least;
            most = b > most ? b : most;
        }
        if (least <= most)
            fprintf(out, "%.9g %.9g %.9g\n", time_s, least, most);
    }
}

void plot_range(const frame_log_entry *records, size_t count, const plot_value *value, double *low, double *high)
{
    for (size_t i = 0; i < count; i++) {
        double v = number(value, &records[i]);
        if (!isfinite(v))
            continue;
        *low = v < *low ? v : *low;
        *high = v > *high ? v : *high;
    }
}

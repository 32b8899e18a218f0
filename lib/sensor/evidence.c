/* What a frame shows of the light, if anything. A clipped picture says "at least so bright", a black one "at most so
 * bright": neither shows what a control did. */
#include "sensor_private.h"

#include "base/numeric.h"
#include "core/object.h"

static const double order_share[SENSOR_ORDERS] = SENSOR_ORDER_SHARES;

/* log2 of the lower edge of a bin of the histogram: stats.h. */
static double edge_of(int bin)
{
    const int stop = bin / PUPIL_HISTOGRAM_BINS_PER_STOP, part = bin % PUPIL_HISTOGRAM_BINS_PER_STOP;
    return (double)(stop + PUPIL_HISTOGRAM_MIN_EV) + pupil_log2(1.0 + (double)part / PUPIL_HISTOGRAM_BINS_PER_STOP);
}

static double weight_from(const pupil_stats *stats, int bin, int count)
{
    uint64_t sum = 0;
    for (int i = 0; i < count; i++)
        sum += bin - i >= 0 ? stats->bin[bin - i] : 0;
    return (double)sum / (double)stats->weight;
}

/* A spike at the top with nothing above it is clipped light, regardless of the code at which the sensor saturates. It
 * has two bins, because white may be noisy, or on the edge of two. */
static void find_top(const pupil_stats *stats, sensor_evidence *v)
{
    int bin = PUPIL_HISTOGRAM_BINS - 1;
    uint64_t above = 0;
    while (bin > 0 && (double)(above + stats->bin[bin]) <= SENSOR_ABOVE_WHITE * (double)stats->weight)
        above += stats->bin[bin--];
    const double share = weight_from(stats, bin, 2), below = weight_from(stats, bin - 2, 2);
    v->top = edge_of(bin);
    v->spike = share > SENSOR_SPIKE_SHARE && share > SENSOR_SPIKE_TIMES * below ? share : 0.0;
}

/* Far enough above the key to be clipped light. */
static int is_bright(const pupil_sensor_config *c, double top)
{
    return top > pupil_log2(c->clip) + pupil_log2(c->key) + SENSOR_BRIGHT_EV;
}

/* Which share of the frame counts as clipped. */
static void find_clipped(const pupil_sensor_object *o, sensor_evidence *v)
{
    const double white = pupil_log2(o->config.clip);
    const int is_found = o->white.is_found && v->top <= o->white.level + SENSOR_STUCK_EV;
    v->white = is_found ? o->white.level : white;
    if (v->clipped_share < 0.5 * v->spike && v->top >= v->white - SENSOR_WHITE_EV)
        v->clipped_share = v->spike; /* the sensor is full below the code that counts as clipped */
    /* at any code: a flat top far above the key may be clipped light, and shows no more than "at least so bright"
     */
    v->full_share = is_bright(&o->config, v->top) && v->spike > v->clipped_share ? v->spike : v->clipped_share;
    v->is_number = v->full_share < SENSOR_BLIND_CLIPPED && v->black_share < 0.5 && v->mean > white - SENSOR_DARK_EV;
}

/* The mean without a wrong black level: of the bins, each taken as its middle. */
static void subtract_black(const pupil_sensor_object *o, const pupil_stats *stats, sensor_evidence *v)
{
    double sum = 0.0, counted = 0.0;
    for (int bin = 0; bin < PUPIL_HISTOGRAM_BINS; bin++)
        if (stats->bin[bin]) {
            sum += (double)stats->bin[bin] * pupil_sensor_above_black(o, 0.5 * (edge_of(bin) + edge_of(bin + 1)));
            counted += (double)stats->bin[bin];
        }
    v->mean = sum / counted;
}

/* The levels of some quantiles; of a clipped or black one only a bound. */
static void find_orders(const pupil_sensor_object *o, const pupil_stats *stats, sensor_evidence *v, double dark)
{
    const int has_bins = stats && pupil_stats_are_counted(stats);
    double quantile[SENSOR_ORDERS];
    if (has_bins) {
        pupil_stats_quantiles(stats, order_share, SENSOR_ORDERS, quantile);
        v->rank[0] = quantile[SENSOR_ORDERS - 1]; /* the darkest, the median, and the second brightest */
        v->rank[1] = quantile[0];
        v->rank[2] = quantile[SENSOR_ORDERS - SENSOR_BRIGHT_ORDER];
    }
    for (int i = 0; has_bins && i < SENSOR_ORDERS; i++)
        quantile[i] = pupil_sensor_above_black(o, quantile[i]);
    for (int i = 0; i < SENSOR_ORDERS; i++) {
        const int is_mean = !has_bins || i == 0;
        const double value = is_mean ? v->mean : quantile[i];
        const double above = is_mean ? SENSOR_MEAN_MARGIN : 1.0 - SENSOR_ORDER_MARGIN - order_share[i];
        const double below = is_mean ? SENSOR_MEAN_MARGIN : order_share[i] - SENSOR_ORDER_MARGIN;
        const int is_black = v->black_share > below || (stats && value < dark);
        v->low[i] = is_black ? -SENSOR_FAR_AWAY : value;
        v->high[i] = v->full_share > above ? SENSOR_FAR_AWAY : is_black ? larger(value, dark) : value;
    }
}

int pupil_sensor_evidence(const pupil_sensor_object *o, const pupil_stats *stats, sensor_evidence *v)
{
    const pupil_sensor_config *c = &o->config;
    *v = (sensor_evidence){.is_dead = !stats->weight, .top = -SENSOR_FAR_AWAY, .rank = {-SENSOR_FAR_AWAY}};
    if (v->is_dead)
        return PUPIL_OK;
    const int trims = pupil_stats_are_counted(stats);
    int error = pupil_stats_mean(stats, trims ? c->trim_low : 0.0, trims ? c->trim_high : 1.0, &v->mean);
    if (!error)
        error = pupil_stats_mean(stats, trims ? SENSOR_FLICKER_TRIM : 0.0, trims ? 1.0 - SENSOR_FLICKER_TRIM : 1.0,
                                 &v->middle);
    v->has_highlight = trims && c->highlight_ev > 0.0;
    if (!error && v->has_highlight)
        error = pupil_stats_peak_quantile(stats, 1.0 - c->highlight_share, &v->highlight);
    if (error)
        return error;
    v->clipped_share = (double)stats->clipped / (double)(stats->pixels ? stats->pixels : 1);
    v->black_share = (double)stats->black / (double)(stats->pixels ? stats->pixels : 1);
    if (trims)
        find_top(stats, v);
    find_clipped(o, v);
    if (trims && o->black.value > 0.0)
        subtract_black(o, stats, v);
    find_orders(o, stats, v, pupil_log2(c->clip) - SENSOR_DARK_EV);
    return PUPIL_OK;
}

void pupil_sensor_evidence_of_level(const pupil_sensor_object *o, double mean, double clipped_share, sensor_evidence *v)
{
    *v = (sensor_evidence){.mean = mean,
                           .middle = mean,
                           .clipped_share = clipped_share,
                           .top = -SENSOR_FAR_AWAY,
                           .rank = {-SENSOR_FAR_AWAY}};
    v->white = pupil_log2(o->config.clip);
    v->full_share = clipped_share;
    v->is_number = clipped_share < SENSOR_BLIND_CLIPPED;
    find_orders(o, 0, v, -SENSOR_FAR_AWAY);
}

/* Light above what was taken for white shows, now and later, that it is not white: a companded picture is flat below
 * its knee. */
void pupil_sensor_white_frame(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_white *w = &o->white;
    w->highest = larger(v->top, w->highest);
    w->is_found &= w->highest <= w->level + SENSOR_STUCK_EV;
}

/* A flat top that does not move with the setting is white. */
void pupil_sensor_find_white(pupil_sensor_object *o, const sensor_evidence *v)
{
    sensor_white *w = &o->white;
    if (v->spike <= 0.0 || !is_bright(&o->config, v->top) || v->top < w->highest - SENSOR_STUCK_EV)
        return;
    if (size_of(v->top - w->top) < SENSOR_STUCK_EV) {
        w->level = v->top;
        w->is_found = 1;
    }
}

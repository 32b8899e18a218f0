/* The curve as a table: what a frame's histogram asks for, and how the knots follow that in time (config.h:
 * pupil_curve_kind; docs/numerics.md has each formula).
 *
 * Each knot has a fixed scene luminance, as each bin of the histogram has. What moves in time is its display light. Two
 * curves are mixed by the square roots of display light: both rise and keep the ceiling of contrast, and so does every
 * mixture. */
#include "object.h"

#include "base/key.h"
#include "base/numeric.h"

#define KNOTS      PUPIL_CURVE_KNOTS
#define A_STOP     PUPIL_HISTOGRAM_BINS_PER_STOP
#define KNOT_STOPS (KNOTS / A_STOP)
#define ONE_Q31    0x1p31
/* The knots are moved by whole stops when the level is farther than this from their middle. */
#define MOST_OFF_EV 1
/* PUPIL_CURVE_NORMALISE: a frame of one grey must not become noise in black and white. */
#define LEAST_SPAN 0.25
/* PUPIL_CURVE_ADJUST: this share of the demand is spread evenly over the frame's range, so that the curve is flat
 * nowhere. Ward Larson et al. stop trimming the histogram when this share is left to trim (section 4.2). */
#define TOLERANCE 0.025
/* Halvings until a threshold of shares, 0..1, is known to the last bit of a float. */
#define HALVINGS 32

/* Luminance of knot k over that of the first. */
static double place_of(int k)
{
    return (double)(UINT64_C(1) << (k / A_STOP)) * (1.0 + (double)(k % A_STOP) / A_STOP);
}

/* The smallest ratio of the root at knot k to that at knot k + 1. Between them (dg / g) / (dL / L) is steepest at knot
 * k + 1, (1 - g_k / g_k+1) / (1 - L_k / L_k+1), or where it is above 1 at knot k, (g_k+1 / g_k - 1) / (L_k+1 / L_k -
 * 1); and light is g^2. */
static double least_ratio(int k, double ceiling)
{
    const double ratio = place_of(k + 1) / place_of(k), slope = 0.5 * ceiling;
    const double at_end = 1.0 - slope * (1.0 - 1.0 / ratio), at_start = 1.0 / (1.0 + slope * (ratio - 1.0));
    return at_end > at_start ? at_end : at_start;
}

static double root_of(double light)
{
    return light >= 1.0 ? 1.0 : light > 0x1p-100 ? pupil_exp2(0.5 * pupil_log2(light)) : 0.0;
}

/* IEC 61966-2-1, and the others: light of a code over 255. */
static double light_of_code(uint32_t transfer, double code)
{
    if (code <= 0.0 || transfer == PUPIL_TRANSFER_LINEAR)
        return code;
    if (transfer == PUPIL_TRANSFER_GAMMA22)
        return pupil_exp2(2.2 * pupil_log2(code));
    return code <= 0.04045 ? code / 12.92 : pupil_exp2(2.4 * pupil_log2((code + 0.055) / 1.055));
}

/* The share of the weight below each knot. Bins are equally wide in luminance within their stop. */
static void find_shares(const pupil_stats *stats, double first_log2, float share[KNOTS])
{
    const double first = pupil_exp2(clamp(first_log2, -200.0, 200.0)), total = (double)stats->weight;
    uint64_t below = 0;
    int bin = 0;
    for (int k = 0; k < KNOTS; k++) {
        const uint64_t bits = pupil_bits_of_double(clamp(first * place_of(k), 0x1p-32, 0x1p32));
        const int at = (int)(bits >> 49) - (1023 + PUPIL_HISTOGRAM_MIN_EV) * PUPIL_HISTOGRAM_BINS_PER_STOP;
        const double part = (double)(bits & ((UINT64_C(1) << 49) - 1)) * 0x1p-49;
        while (bin < at)
            below += stats->bin[bin++];
        const double inside = at < PUPIL_HISTOGRAM_BINS ? part * (double)stats->bin[at] : 0.0;
        share[k] = (float)(((double)below + inside) / total);
    }
}

/* --- curves: each makes roots of display light --- */

/* Reinhard's, where it is to go. */
typedef struct plain {
    double scale_log2, inverse_white_squared;
} plain;

static plain plain_of(const pupil_config *c, const pupil_knots_frame *f)
{
    plain p = {.scale_log2 = pupil_scale_log2(c, f->target_ev)};
    double white_log2 = clamp(p.scale_log2 + f->white_ev, 0.0, 30.0);
    if (c->white_mode == PUPIL_WHITE_FIXED)
        white_log2 = pupil_log2(c->white);
    p.inverse_white_squared = c->white_mode == PUPIL_WHITE_NONE ? 0.0 : pupil_exp2(-2.0 * white_log2);
    return p;
}

static double plain_root(const plain *p, double luminance_log2)
{
    const double u = pupil_exp2(clamp(p->scale_log2 + luminance_log2, -100.0, 100.0));
    return root_of(u * (1.0 + u * p->inverse_white_squared) / (1.0 + u));
}

static void make_plain(const plain *p, double first_ev, float root[KNOTS])
{
    for (int k = 0; k < KNOTS; k++)
        root[k] = (float)plain_root(p, first_ev + pupil_log2(place_of(k)));
}

/* log2 of scene luminance at the limits of the shares that are left out at both ends. */
static void find_ends(const pupil_config *c, const pupil_knots_frame *f, double ends[2])
{
    const double q[2] = {c->curve_share, 1.0 - c->curve_share};
    pupil_stats_quantiles(f->stats, q, 2, ends);
    ends[0] -= f->divisor_log2;
    ends[1] -= f->divisor_log2;
}

/* G* = (G - G1) / (G2 - G1) if G2 - G1 is large enough; else the gain is limited, and the middle moves less far toward
 * 0.5. */
static void normalise(const pupil_config *c, const pupil_knots_frame *f, double first_ev, float root[KNOTS])
{
    const plain p = plain_of(c, f);
    double ends[2];
    find_ends(c, f, ends);
    const double low = plain_root(&p, ends[0]), high = plain_root(&p, ends[1]);
    const double span = high - low, middle = 0.5 * (low + high);
    const double gain = 1.0 / (span > LEAST_SPAN ? span : LEAST_SPAN);
    const double to = middle + (0.5 - middle) * (span < LEAST_SPAN ? span / LEAST_SPAN : 1.0);
    make_plain(&p, first_ev, root);
    for (int k = 0; k < KNOTS; k++)
        root[k] = (float)clamp(to + ((double)root[k] - middle) * gain, 0.0, 1.0);
}

static void equalise(const pupil_config *c, float share_to_root[KNOTS])
{
    for (int k = 0; k < KNOTS; k++)
        share_to_root[k] = (float)root_of(light_of_code(c->transfer, (double)share_to_root[k]));
}

/* --- adjust --- */

/* The frame's range on the knots: between `low` and `high`, luminance over the first knot's. */
typedef struct adjusted {
    double low, high;
    double most_ev[A_STOP]; /* by k % A_STOP: what the ceiling allows from knot k to the next, stops of display light */
    int first, end;         /* knots: the range is within these */
} adjusted;

/* How much of the interval from knot k to the next is in the range. */
static double use_of(const adjusted *a, int k)
{
    const double begin = place_of(k), end = place_of(k + 1);
    return (clamp(a->high, begin, end) - clamp(a->low, begin, end)) / (end - begin);
}

static void find_range(const pupil_config *c, const pupil_knots_frame *f, double first_ev, adjusted *a)
{
    double ends[2];
    find_ends(c, f, ends);
    a->low = clamp(pupil_exp2(clamp(ends[0] - first_ev, 0.0, KNOT_STOPS)), 1.0, place_of(KNOTS - 1));
    a->high = clamp(pupil_exp2(clamp(ends[1] - first_ev, 0.0, KNOT_STOPS)), 1.0, place_of(KNOTS - 1));
    for (int k = 0; k < A_STOP; k++)
        a->most_ev[k] = -2.0 * pupil_log2(least_ratio(k, c->curve_ceiling));
    for (a->first = 0; a->first < KNOTS - 2 && place_of(a->first + 1) <= a->low;)
        a->first++;
    for (a->end = a->first + 1; a->end < KNOTS - 1 && place_of(a->end) < a->high;)
        a->end++;
}

/* Shares below knots become the demand of the intervals in the range: their part of the weight that is not left out,
 * and of the share that is spread evenly. */
static void find_demand(const pupil_config *c, const adjusted *a, float value[KNOTS])
{
    const double left_out = c->curve_share, whole = 1.0 - 2.0 * left_out;
    double used = 0.0;
    for (int k = a->first; k < a->end; k++)
        used += use_of(a, k);
    double below = clamp(((double)value[a->first] - left_out) / whole, 0.0, 1.0);
    for (int k = a->first; k < a->end; k++) {
        const double above = clamp(((double)value[k + 1] - left_out) / whole, 0.0, 1.0);
        value[k] = (float)(above - below + (used > 0.0 ? TOLERANCE * use_of(a, k) / used : 0.0));
        below = above;
    }
}

/* Stops from knot k to the next: all that the ceiling allows where the demand is `full`, and everywhere outside of the
 * range. */
static double growth_of(const adjusted *a, const float demand[KNOTS], int k, double per_full)
{
    const double share = k < a->first || k >= a->end ? 1.0 : (double)demand[k] * per_full;
    return a->most_ev[k % A_STOP] * (share < 1.0 ? share : 1.0);
}

static double range_of(const adjusted *a, const float demand[KNOTS], double per_full)
{
    double sum = 0.0;
    for (int k = a->first; k < a->end; k++)
        sum += growth_of(a, demand, k, per_full);
    return sum;
}

/* Returns 1 / full, where `full` is the demand that gets all that the ceiling allows: the one with which the frame's
 * range is that of the display. If the smallest demand, that of the evenly spread share alone, gives a shorter range,
 * full is that one. */
static double find_full(const pupil_config *c, const adjusted *a, const float demand[KNOTS])
{
    double low = TOLERANCE / (a->end - a->first), high = 1.0 + TOLERANCE;
    if (range_of(a, demand, 1.0 / low) <= c->curve_range_ev)
        return 1.0 / low;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (range_of(a, demand, 1.0 / middle) > c->curve_range_ev)
            low = middle;
        else
            high = middle;
    }
    return 1.0 / high;
}

static void adjust(const pupil_config *c, const pupil_knots_frame *f, double first_ev, float value[KNOTS])
{
    adjusted a;
    find_range(c, f, first_ev, &a);
    find_demand(c, &a, value);
    const double per_full = find_full(c, &a, value);

    /* the sums of growth overwrite the demand */
    const double level = pupil_exp2(clamp(f->target_ev - first_ev, 0.0, KNOT_STOPS));
    double sum = 0.0, at_level = 0.0;
    for (int k = 0; k < KNOTS; k++) {
        const double growth = k < KNOTS - 1 ? growth_of(&a, value, k, per_full) : 0.0;
        const double way = clamp((level - place_of(k)) / (place_of(k + 1) - place_of(k)), 0.0, 1.0);
        value[k] = (float)sum;
        sum += growth;
        at_level += growth * way;
    }

    /* at the key, unless an end of the range would then be off the display */
    const double key_log2 = pupil_scale_log2(c, f->target_ev) + f->target_ev;
    const double least = -c->curve_range_ev - (double)value[a.first], most = -(double)value[a.end];
    const double offset = clamp(key_log2 - at_level, least < most ? least : most, most);
    for (int k = 0; k < KNOTS; k++)
        value[k] = (float)pupil_exp2(0.5 * clamp(offset + (double)value[k], -200.0, 0.0));
}

/* --- in time --- */

/* The roots that a frame asks for. */
static void find_goal(const pupil_config *c, const pupil_knots_frame *f, double first_ev, float goal[KNOTS])
{
    plain p;
    find_shares(f->stats, first_ev + f->divisor_log2, goal);
    switch (c->curve) {
    case PUPIL_CURVE_NORMALISE:
        normalise(c, f, first_ev, goal);
        break;
    case PUPIL_CURVE_QUANTISE:
        p = plain_of(c, f);
        make_plain(&p, first_ev, goal);
        break;
    case PUPIL_CURVE_EQUALISE:
        equalise(c, goal);
        break;
    default:
        adjust(c, f, first_ev, goal);
        break;
    }
}

/* The same curve on knots that begin higher or lower by whole stops: flat above, in proportion to luminance below. */
static void shift(pupil_knots *knots, int32_t first_ev)
{
    const int64_t by = A_STOP * ((int64_t)first_ev - knots->first_ev);
    uint32_t *q = knots->root_q31;
    for (int k = 0; k < KNOTS && by > 0; k++)
        q[k] = q[k + by < KNOTS ? k + by : KNOTS - 1];
    for (int k = KNOTS - 1; k >= 0 && by < 0; k--)
        q[k] = q[k + by > 0 ? k + by : 0];
    for (int64_t k = (-by < KNOTS ? -by : KNOTS - 1) - 1; k >= 0; k--)
        q[k] = (uint32_t)((double)q[k + 1] * least_ratio((int)k, 1.0));
    knots->first_ev = first_ev;
}

/* A step of w of the way, at least one unit where w > 0, as adapt.c's. */
static uint32_t approach(uint32_t s, uint32_t t, double w)
{
    const uint32_t distance = t > s ? t - s : s - t;
    const double exact = w * (double)distance;
    uint32_t step = (uint32_t)exact;
    step += (double)step < exact;
    return t > s ? s + step : s - step;
}

void pupil_knots_follow(const pupil_config *c, pupil_knots *knots, const pupil_knots_frame *f)
{
    float goal[KNOTS];
    const double centre = clamp(f->centre_ev, -1000.0, 1000.0);
    const int32_t first_ev = (int32_t)(centre + 1000.5) - 1000 - KNOT_STOPS / 2;
    const int32_t off = first_ev - knots->first_ev;
    if (!knots->seen || f->weight >= 1.0)
        knots->first_ev = first_ev;
    else if (off > MOST_OFF_EV || off < -MOST_OFF_EV)
        shift(knots, first_ev);
    find_goal(c, f, knots->first_ev, goal);
    for (int k = 0; k < KNOTS; k++) {
        const uint32_t target = (uint32_t)((double)goal[k] * ONE_Q31 + 0.5);
        knots->root_q31[k] = knots->seen && f->weight < 1.0 ? approach(knots->root_q31[k], target, f->weight) : target;
    }
    knots->seen = 1;
}

void pupil_knots_get(const pupil_config *c, const pupil_knots *knots, double divisor_log2, pupil_curve *curve)
{
    curve->knots = KNOTS;
    curve->levels = c->curve == PUPIL_CURVE_QUANTISE ? c->curve_levels : 0;
    curve->knot_scale = (float)pupil_exp2(clamp(-divisor_log2 - knots->first_ev, -60.0, 60.0));
    for (int k = 0; k < KNOTS; k++)
        curve->knot[k] = (float)knots->root_q31[k] * (1.0f / (float)ONE_Q31);
}

/* Curves from the histogram: each knot and the picture against the formulas in double; equal shares for equal codes;
 * contrast never above the ceiling, not even on the way from one frame to another; and no jump when a lamp is switched
 * on.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#include <math.h>

#define KNOTS PUPIL_CURVE_KNOTS

static const char *const name[] = {"reinhard", "normalise", "quantise", "equalise", "adjust"};

/* --- frames --- */

enum { LOGNORMAL, LINEAR, LOGARITHMIC, TWO_ROOMS, EVEN, BLACK, ONE_LAMP, NARROW, FRAMES };

static double light_of(int kind, double x)
{
    switch (kind) {
    case LINEAR:
        return x;
    case LOGARITHMIC:
        return exp2(-12.0 * x);
    case TWO_ROOMS:
        return x < 0.7 ? 0.01 * (1.0 + x) : 40.0 * (1.0 + x);
    case EVEN:
        return 0.3;
    case BLACK:
        return 0.0;
    case ONE_LAMP:
        return x < 0.99 ? exp2(-4.0 + 2.0 * x) : 5000.0;
    default: /* NARROW */
        return exp2(3.0 * x - 2.0);
    }
}

static frame make(int kind, double gain)
{
    frame f = frame_make(4096, 1, PUPIL_PIXEL_RGB32F, 0, 0);
    if (kind == LOGNORMAL)
        frame_lognormal(&f, 0.2 * gain, 2.5, check_uniform);
    for (uint32_t x = 0; x < 4096 && kind != LOGNORMAL; x++) {
        const double light = gain * light_of(kind, (x + 0.5) / 4096.0);
        frame_set(&f, x, 0, light, light, light, 1);
    }
    return f;
}

/* --- the formulas of docs/numerics.md, in double --- */

/* Luminance of knot k over that of the first. */
static double place(int k)
{
    return ldexp(1.0 + k % 8 / 8.0, k / 8);
}

static double within(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

/* The share of the weight below a luminance of the frame. */
static double below(const pupil_stats *s, double y)
{
    double sum = 0.0;
    for (int b = 0; b < PUPIL_HISTOGRAM_BINS; b++) {
        const double low = ldexp(1.0 + b % 8 / 8.0, b / 8 - 32), high = ldexp(1.0 + (b % 8 + 1) / 8.0, b / 8 - 32);
        sum += (double)s->bin[b] * within((y - low) / (high - low), 0.0, 1.0);
    }
    return sum / (double)s->weight;
}

/* What a table is made from: a frame's statistics, and the targets of level and white point. */
typedef struct scene {
    const pupil_config *config;
    const pupil_stats *stats;
    double level, white, divisor; /* log2; scene luminance is a frame's over 2^divisor */
    double first;                 /* of the first knot */
} scene;

static double plain(const scene *s, double luminance)
{
    const double scale = s->config->key * exp2(s->config->ev_compensation - s->level), u = scale * luminance;
    const double w = fmax(1.0, scale * exp2(s->white));
    return sqrt(fmin(1.0, u * (1.0 + u / (w * w)) / (1.0 + u)));
}

static double end(const scene *s, double share)
{
    double log2_y;
    CHECK(pupil_stats_quantile(s->stats, share, &log2_y) == PUPIL_OK);
    return exp2(log2_y - s->divisor);
}

static double decode(uint32_t transfer, double code)
{
    const double srgb = code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
    return transfer == PUPIL_TRANSFER_SRGB ? srgb : transfer == PUPIL_TRANSFER_LINEAR ? code : pow(code, 2.2);
}

/* As in the paper: cut off what is above the ceiling and recompute the ceiling, until nothing is above it. */
static void adjust(const scene *s, double root[KNOTS])
{
    const pupil_config *c = s->config;
    const double share = c->curve_share, range = c->curve_range_ev, unit = exp2(s->first);
    const double low = end(s, share) / unit, high = end(s, 1.0 - share) / unit;
    double use[KNOTS] = {0}, demand[KNOTS] = {0}, most[KNOTS] = {0}, used = 0.0, sum[KNOTS + 1] = {0}, at_level = 0.0;
    int first = KNOTS, last = 0;
    for (int k = 0; k < KNOTS - 1; k++) {
        use[k] = fmax(0.0, (fmin(high, place(k + 1)) - fmax(low, place(k))) / (place(k + 1) - place(k)));
        used += use[k];
        const double half = 0.5 * c->curve_ceiling, step = place(k + 1) / place(k);
        most[k] = -2.0 * log2(fmax(1.0 - half * (1.0 - 1.0 / step), 1.0 / (1.0 + half * (step - 1.0))));
        first = use[k] > 0.0 && first == KNOTS ? k : first;
        last = use[k] > 0.0 ? k : last;
    }
    for (int k = first; k <= last; k++) {
        const double from =
            within((below(s->stats, unit * place(k) * exp2(s->divisor)) - share) / (1 - 2 * share), 0, 1);
        const double to =
            within((below(s->stats, unit * place(k + 1) * exp2(s->divisor)) - share) / (1 - 2 * share), 0, 1);
        demand[k] = to - from + 0.025 * use[k] / used;
    }
    double full = 1.0, least = 0.025 / (last + 1 - first);
    for (int turn = 0; turn < 20000 && full > least; turn++) {
        double cut = 0.0;
        for (int k = first; k <= last; k++)
            cut += most[k] * fmin(demand[k], full) / range;
        full = fmin(full, cut);
    }
    full = fmax(full, least);
    for (int k = 0; k < KNOTS; k++) {
        const int inside = k >= first && k <= last;
        const double growth = most[k] * (inside ? fmin(1.0, demand[k] / full) : 1.0);
        sum[k + 1] = sum[k] + growth;
        at_level += growth * within((exp2(s->level) / unit - place(k)) / (place(k + 1) - place(k)), 0.0, 1.0);
    }
    const double offset = within(log2(c->key) + c->ev_compensation - at_level, -range - sum[first], -sum[last + 1]);
    for (int k = 0; k < KNOTS; k++)
        root[k] = sqrt(fmin(1.0, exp2(offset + sum[k])));
}

static void table_of(const scene *s, double root[KNOTS])
{
    const pupil_config *c = s->config;
    const double low = plain(s, end(s, c->curve_share)), high = plain(s, end(s, 1.0 - c->curve_share));
    const double span = high - low, middle = (low + high) / 2;
    const double to = span > 0.25 ? 0.5 : middle + (0.5 - middle) * span / 0.25;
    for (int k = 0; k < KNOTS; k++) {
        const double luminance = exp2(s->first) * place(k);
        root[k] = plain(s, luminance);
        if (c->curve == PUPIL_CURVE_NORMALISE)
            root[k] = within(to + (root[k] - middle) / fmax(span, 0.25), 0.0, 1.0);
        if (c->curve == PUPIL_CURVE_EQUALISE)
            root[k] = sqrt(decode(c->transfer, below(s->stats, luminance * exp2(s->divisor))));
    }
    if (c->curve == PUPIL_CURVE_ADJUST)
        adjust(s, root);
}

/* --- against the formulas --- */

static double most_off;

static double code_of(uint32_t transfer, double root)
{
    const double light = root * root;
    if (transfer != PUPIL_TRANSFER_SRGB)
        return 255.0 * (transfer == PUPIL_TRANSFER_LINEAR ? light : pow(light, 1.0 / 2.2));
    return 255.0 * (light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055);
}

/* Checks the knots, and each pixel of the picture. */
static void check_picture(const pupil_t *pupil, const scene *s, const pupil_frame_info *info, const double root[KNOTS],
                          const frame *in, int kind)
{
    const pupil_config *c = s->config;
    frame out = frame_make(in->image.width, 1, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image to = frame_writable(&out);
    pupil_curve curve;
    CHECK(pupil_get_curve(pupil, info, &curve) == PUPIL_OK && curve.knots == KNOTS);
    CHECK_MSG(fabs(log2((double)curve.knot_scale) + s->divisor + s->first) < 1e-6, "knots from %g, not %g",
              -log2((double)curve.knot_scale), s->divisor + s->first);
    for (int k = 0; k < KNOTS; k++) {
        const double off = fabs(code_of(c->transfer, (double)curve.knot[k]) - code_of(c->transfer, root[k]));
        most_off = fmax(most_off, off);
        CHECK_MSG(off <= 0.05, "%s of frame %d, transfer %u, knot %d: %.7g, wanted %.7g", name[c->curve], kind,
                  c->transfer, k, (double)curve.knot[k], root[k]);
    }
    CHECK(pupil_map_rows(pupil, &curve, &in->image, &to) == PUPIL_OK);
    for (uint32_t x = 0; x < in->image.width && kind != LOGNORMAL; x++) {
        const double y = (double)((const float *)in->image.data)[3 * x];
        const double t = fmax(1.0, y * exp2(-s->divisor - s->first));
        int k = (int)within(8.0 * floor(log2(t)), 0, KNOTS - 2);
        while (k < KNOTS - 2 && place(k + 1) <= t)
            k++;
        double g = root[k] + (root[k + 1] - root[k]) * within((t - place(k)) / (place(k + 1) - place(k)), 0, 1);
        if (curve.levels && fabs(g * curve.levels - floor(g * curve.levels + 0.5)) < 1e-4)
            continue; /* on the step itself */
        if (curve.levels)
            g = fmin(floor(g * curve.levels), curve.levels - 1) / (curve.levels - 1);
        const double wanted = y > 0.0 ? code_of(c->transfer, g * sqrt(fmin(1.0, y * exp2(-s->divisor - s->first)))) : 0;
        const int got = ((const unsigned char *)to.data)[3 * x];
        CHECK_MSG(fabs(got - wanted) <= 1.0, "%s of frame %d: %g became %d, wanted %.3f", name[c->curve], kind, y, got,
                  wanted);
    }
    frame_free(&out);
}

/* Six frames: the first sets the table; it follows the others as the level does. */
static void check_formulas(uint32_t curve, int kind, double exposure_s, uint32_t transfer)
{
    pupil_config config, at_once;
    pupil_t pupil, target;
    double root[KNOTS] = {0}, goal[KNOTS], level = 0.0, first = 0.0;
    pupil_config_default(&config);
    config.curve = curve;
    config.transfer = transfer;
    config.flicker = 0;
    config.ev_compensation = exposure_s > 0.0 ? 0.5 : 0.0;
    config.curve_share = transfer ? 0.02 : 0.005;
    config.curve_ceiling = transfer == PUPIL_TRANSFER_LINEAR ? 2.7 : 1.0;
    config.curve_range_ev = transfer ? 5.5 : 8.0;
    at_once = config;
    at_once.tau_light_s = at_once.tau_dark_s = 0.0;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_init(&target, &at_once) == PUPIL_OK);
    for (int n = 0; n < 6; n++) {
        const pupil_frame_info info = {.timestamp_ns = 1 + n * INT64_C(40000000),
                                       .exposure_s = exposure_s,
                                       .gain = exposure_s > 0.0 ? 1.0 + 0.1 * n : 0.0};
        frame in = make(kind, exp2(0.3 * n));
        pupil_exposure goes, is;
        pupil_stats stats;
        CHECK(pupil_meter(&pupil, &in.image, &info) == PUPIL_OK && pupil_meter(&target, &in.image, &info) == PUPIL_OK);
        CHECK(pupil_get_exposure(&target, &goes) == PUPIL_OK && pupil_get_exposure(&pupil, &is) == PUPIL_OK);
        CHECK(pupil_get_stats(&pupil, &stats) == PUPIL_OK);
        scene s = {.config = &config, .stats = &stats, .level = goes.adapted_ev, .white = goes.white_ev};
        s.divisor = exposure_s > 0.0 ? log2(info.exposure_s * info.gain) : 0.0;
        first = n ? first : floor(goes.adapted_ev + 0.5) - 8.0;
        s.first = first;
        table_of(&s, goal);
        const double tau = goes.adapted_ev > level ? config.tau_light_s : config.tau_dark_s;
        for (int k = 0; k < KNOTS; k++)
            root[k] += (n ? 1.0 - exp(-0.04 / tau) : 1.0) * (goal[k] - root[k]);
        level = is.adapted_ev;
        check_picture(&pupil, &s, &info, root, &in, kind);
        frame_free(&in);
    }
}

/* --- equalise: equal shares --- */

/* `end`: how many cells are checked. If a ramp does not end at a bin's edge, its share is spread over the whole bin. */
static void check_flat(int logarithmic, double from, int end)
{
    const uint32_t width = PUPIL_MAX_SIDE_PX;
    frame in = frame_make(width, 1, PUPIL_PIXEL_RGB32F, 0, 0), out = frame_make(width, 1, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image to = frame_writable(&out);
    pupil_config config;
    pupil_t pupil;
    double worst = 0.0;
    for (uint32_t x = 0; x < width; x++) {
        const double part = (x + 0.5) / width, light = from * (logarithmic ? exp2(10.0 * part) : part);
        frame_set(&in, x, 0, light, light, light, 1);
    }
    pupil_config_default(&config);
    config.curve = PUPIL_CURVE_EQUALISE;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_process(&pupil, &in.image, NULL, &to) == PUPIL_OK);
    uint32_t counted = 0; /* the first and the last code have half as many values that round to them */
    for (int cell = 0; cell < 32; cell++) {
        uint32_t inside = 0;
        for (uint32_t x = 0; x < width; x++) {
            const int code = ((const unsigned char *)to.data)[3 * x];
            inside += code >= 8 * cell && code < 8 * cell + 8;
        }
        const double wanted = (cell == 0 || cell == 31 ? 7.5 : 8.0) / 255.0;
        worst = cell >= end ? worst : fmax(worst, fabs(inside / (double)width / wanted - 1.0));
        counted += inside;
    }
    CHECK(counted == width);
    printf("equalised %s ramp: cells of 8 codes within %.2f %%\n", logarithmic ? "logarithmic" : "linear",
           100.0 * worst);
    CHECK_MSG(worst <= 0.02, "%s ramp from %g: %g", logarithmic ? "logarithmic" : "linear", from, worst);
    frame_free(&in);
    frame_free(&out);
}

/* --- adjust: the ceiling --- */

static double light_at(const pupil_curve *curve, double t)
{
    int k = (int)within(8.0 * floor(log2(t)), 0, KNOTS - 2);
    while (k < KNOTS - 2 && place(k + 1) <= t)
        k++;
    const double part = within((t - place(k)) / (place(k + 1) - place(k)), 0.0, 1.0);
    const double root = (double)curve->knot[k] + part * ((double)curve->knot[k + 1] - (double)curve->knot[k]);
    return root * root * fmin(t, 1.0);
}

static double steepest(const pupil_curve *curve)
{
    double most = 0.0;
    for (double t = 0x1p-3; t < 0x1p17; t *= 1.005) {
        const double from = light_at(curve, t), to = light_at(curve, t * 1.005);
        most = from > 0x1p-24 ? /* roots end at 2^-31 */ fmax(most, log2(to / from) / log2(1.005)) : most;
    }
    return most;
}

/* Any frame, then any other; each moves the level at once, by up to 20 stops. */
static void check_ceiling(double ceiling)
{
    pupil_config config;
    pupil_t pupil;
    double most = 0.0;
    pupil_config_default(&config);
    config.curve = PUPIL_CURVE_ADJUST;
    config.curve_ceiling = ceiling;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int n = 0; n < 150; n++) {
        const pupil_frame_info info = {.timestamp_ns = 1 + n * INT64_C(33333333)};
        frame in = make(n / 10 * 7 % FRAMES, exp2(n / 10 * 3 % 20 - 10.0));
        pupil_curve curve;
        CHECK(pupil_meter(&pupil, &in.image, &info) == PUPIL_OK && pupil_get_curve(&pupil, &info, &curve) == PUPIL_OK);
        most = fmax(most, steepest(&curve));
        frame_free(&in);
    }
    printf("adjust, ceiling %g: steepest %.6f\n", ceiling, most);
    CHECK_MSG(most <= ceiling * (1.0 + 1e-4), "ceiling %g: %.7f", ceiling, most);
}

/* --- a lamp --- */

static double display_code(const pupil_curve *c, double y)
{
    const double u = (double)c->scale * y, w = (double)c->inverse_white_squared;
    return code_of(0, sqrt(fmin(1.0, c->knots ? light_at(c, (double)c->knot_scale * y) : u * (1 + u * w) / (1 + u))));
}

/* The most that any luminance's code moves from one frame to the next, when light goes up by 8 stops and down again.
 * And over all these steps, how far a code moves away from its final value. */
static double jump(uint32_t curve, int kind, int part)
{
    pupil_config config;
    pupil_t pupil;
    double before[60], most = 0.0;
    pupil_config_default(&config);
    config.curve = curve;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int n = 0; n < 120; n++) {
        const pupil_frame_info info = {.timestamp_ns = 1 + n * INT64_C(33333333)};
        const int lamp = n >= 10 && n < 60;
        frame in = make(kind, lamp && !part ? 256.0 : 1.0);
        for (uint32_t x = 0; x < 4096 && part && lamp; x += (uint32_t)part) {
            const double light = 256.0 * light_of(kind, (x + 0.5) / 4096.0);
            frame_set(&in, x, 0, light, light, light, 1);
        }
        pupil_curve found;
        CHECK(pupil_meter(&pupil, &in.image, &info) == PUPIL_OK && pupil_get_curve(&pupil, &info, &found) == PUPIL_OK);
        found.levels = 0; /* brightness may have steps; time must not */
        for (int i = 0; i < 60; i++) {
            const double code = display_code(&found, exp2(i / 2.0 - 16.0));
            most = n ? fmax(most, fabs(code - before[i])) : most;
            before[i] = code;
        }
        frame_free(&in);
    }
    return most;
}

static void check_lamp(int kind, int part)
{
    const double law = jump(PUPIL_CURVE_REINHARD, kind, part), share = 1.0 - exp(-1.0 / 30.0 / 0.3);
    printf("a lamp, frame %d, 1 of %d: the law's largest step %.1f codes;", kind, part ? part : 1, law);
    for (uint32_t curve = PUPIL_CURVE_NORMALISE; curve < PUPIL_CURVE_COUNT; curve++) {
        const double most = jump(curve, kind, part);
        printf(" %s %.1f", name[curve], most);
        CHECK_MSG(part || most <= law, "%s: %g codes, the law %g", name[curve], most, law);
        CHECK_MSG(most <= 255.0 * share, "%s: %g codes of 255 * %g", name[curve], most, share);
    }
    printf("\n");
}

/* --- where they begin, and the ends of light --- */

static frame even(double light)
{
    frame f = frame_make(64, 1, PUPIL_PIXEL_RGB32F, 0, 0);
    frame_fill(&f, light, light, light);
    return f;
}

static void show(pupil_t *pupil, double light, int64_t timestamp_ns, pupil_curve *curve)
{
    const pupil_frame_info info = {.timestamp_ns = timestamp_ns};
    frame f = even(light);
    CHECK(pupil_meter(pupil, &f.image, &info) == PUPIL_OK && pupil_get_curve(pupil, &info, curve) == PUPIL_OK);
    frame_free(&f);
}

/* Knots begin without a past: before the first frame there are none, and then they are at once that frame's. A change
 * to another kind of curve keeps their past. */
static void check_beginning(void)
{
    pupil_config config;
    pupil_t pupil, other;
    pupil_curve curve, fresh;
    pupil_config_default(&config);
    config.tau_light_s = config.tau_dark_s = 100.0;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    show(&pupil, 0.5, 1000000000, &curve);
    config.curve = PUPIL_CURVE_EQUALISE;
    CHECK(pupil_init(&other, &config) == PUPIL_OK && pupil_retune(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_get_curve(&pupil, NULL, &curve) == PUPIL_OK && curve.knots == 0);
    show(&pupil, 0.5, 1040000000, &curve);
    show(&other, 0.5, 1040000000, &fresh);
    CHECK(curve.knots == KNOTS && memcmp(curve.knot, fresh.knot, sizeof curve.knot) == 0);
    config.curve = PUPIL_CURVE_NORMALISE;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK && pupil_get_curve(&pupil, NULL, &curve) == PUPIL_OK);
    CHECK(curve.knots == KNOTS && memcmp(curve.knot, fresh.knot, sizeof curve.knot) == 0);
}

/* The law's curve in the table, by each kind of white point. */
static void check_white_modes(void)
{
    for (uint32_t mode = 0; mode < PUPIL_WHITE_COUNT; mode++) {
        pupil_config config;
        pupil_t pupil;
        pupil_curve table, law;
        pupil_config_default(&config);
        config.white_mode = mode;
        config.white = 3.0;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        show(&pupil, 0.5, 1, &law);
        config.curve = PUPIL_CURVE_QUANTISE;
        config.curve_levels = 256;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        show(&pupil, 0.5, 1, &table);
        for (int k = 0; k < KNOTS; k++) {
            const double u = (double)law.scale * place(k) / (double)table.knot_scale;
            const double light = u * (1.0 + u * (double)law.inverse_white_squared) / (1.0 + u);
            CHECK_MSG(fabs((double)table.knot[k] - sqrt(fmin(1.0, light))) < 1e-6, "white mode %u, knot %d", mode, k);
        }
    }
}

/* Knots above the brightest light of the frame: the whole frame is below them. */
static void check_brightest(void)
{
    pupil_config config;
    pupil_t pupil;
    pupil_curve curve;
    pupil_config_default(&config);
    config.curve = PUPIL_CURVE_EQUALISE;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    show(&pupil, 0x1.8p29, 1, &curve);
    for (int k = 0; k < KNOTS; k++) {
        const double light = place(k) / (double)curve.knot_scale;
        CHECK_MSG(light < 0x1.8p29 ? curve.knot[k] == 0.0f : light < 0x1.ap29 || curve.knot[k] == 1.0f, "knot %d: %g",
                  k, (double)curve.knot[k]);
    }
}

/* The level falls by more stops than the knots cover: at first as before, flat above and proportional below, and in the
 * end as if there had been no past. */
static void check_fall(void)
{
    pupil_config config;
    pupil_t pupil, other;
    pupil_curve curve, fresh;
    pupil_config_default(&config);
    config.curve = PUPIL_CURVE_ADJUST;
    config.tau_dark_s = 0.0145; /* nine tenths of the way in a frame */
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_init(&other, &config) == PUPIL_OK);
    show(&pupil, 0x1p20, 1000000000, &curve);
    for (int64_t n = 1; n < 60; n++) {
        show(&pupil, 0x1p-9, 1000000000 + n * 33333333, &curve);
        CHECK_MSG(steepest(&curve) <= 1.0 + 1e-4, "frame %d: %g", (int)n, steepest(&curve));
        for (int k = 1; k < KNOTS; k++)
            CHECK(curve.knot[k] >= curve.knot[k - 1] && curve.knot[k] <= 1.0f);
    }
    show(&other, 0x1p-9, 1, &fresh);
    CHECK(curve.knot_scale == fresh.knot_scale);
    for (int k = 0; k < KNOTS; k++)
        CHECK(fabsf(curve.knot[k] - fresh.knot[k]) < 1e-6f);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t curve = PUPIL_CURVE_NORMALISE; curve < PUPIL_CURVE_COUNT; curve++)
        for (int kind = 0; kind < FRAMES; kind++)
            for (uint32_t transfer = 0; transfer < PUPIL_TRANSFER_COUNT; transfer++)
                check_formulas(curve, kind, (kind + transfer) % 2 ? 0.013 : 0.0, transfer);
    printf("knots within %.4f codes of the formulas\n", most_off);
    for (int logarithmic = 0; logarithmic < 2; logarithmic++) {
        check_flat(logarithmic, 1.0, 32);
        check_flat(logarithmic, 0.37, 29);
    }
    check_ceiling(1.0);
    check_ceiling(2.5);
    check_ceiling(4.0);
    check_lamp(LOGARITHMIC, 0);
    check_lamp(NARROW, 0);
    check_lamp(LOGARITHMIC, 10);
    check_beginning();
    check_white_modes();
    check_brightest();
    check_fall();
    return check_end();
}

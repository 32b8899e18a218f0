/* The lamps' wave: found in the light of bands, followed, and held against each tile of the picture.
 *
 * log2 of the light in a band is that of the scene, which stands still, plus a sum of coefficient x term: cosine and
 * sine of the phase and its multiples, each weakened as the exposure averages it. From both sides, light and terms, the
 * mean of the last frames is taken off, so that the scene is gone, and of each group the mean over its bands, so that
 * whatever changes the whole group at once is gone, too (the camera's settings, clouds). What is left is a linear
 * regression, whose normal equations are summed up with frames forgotten in seconds. Phase, frequency and readout are
 * led after the frames by what they explain of the rest.
 */
#include "row_gain_object.h"

#include "numeric.h"

enum {
    GROUPS = PUPIL_ROW_GAIN_GROUPS,
    SEGMENTS = PUPIL_ROW_GAIN_SEGMENTS,
    PARTS = PUPIL_ROW_GAIN_PARTS,
    HARMONICS = PUPIL_ROW_GAIN_HARMONICS,
    TERMS = PUPIL_ROW_GAIN_TERMS,
    BANDS = PUPIL_BANDS
};

#define PI 0x1.921fb54442d18p+1

static const double memory_s = 0.4;  /* of the normal equations: lamps that go off are half forgotten in 0.3 s */
static const double gap_s = 0.5;     /* mains of 50 +- 0.2 Hz are a fifth of a period off after it */
static const double noise_ev = 0.02; /* what a band differs from the wave by at best; weights of frames */
static const double prior = 10.0;    /* 1 / (0.3 EV)^2: what coefficients are like before there are frames */

static double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* 0 at `none`, 1 at `all`, straight between. */
static double ramp(double x, double none, double all)
{
    return clamp((x - none) / (all - none), 0.0, 1.0);
}

static double square_root(double x)
{
    return x > 1e-300 ? pupil_exp2(0.5 * pupil_log2(x)) : 0.0;
}

static double nearest_integer(double x)
{
    return (double)(int64_t)(x < 0.0 ? x - 0.5 : x + 0.5);
}

void pupil_row_gain_circle(double turns, double *cosine, double *sine)
{
    const double quarters = nearest_integer(turns * 4.0);
    const double a = (turns - quarters * 0.25) * (2.0 * PI), z = a * a; /* |a| <= pi / 4 */
    double c = 0.0, s = 0.0;
    for (int k = 16; k >= 2; k -= 2) { /* Taylor; the first terms left out are a^18 / 18! and a^19 / 19! < 3e-18 */
        c = (1.0 - c) * z / (k * (k - 1));
        s = (1.0 - s) * z / (k * (k + 1));
    }
    c = 1.0 - c;
    s = a * (1.0 - s);
    const int quarter = (int)((int64_t)quarters & 3);
    *cosine = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
    *sine = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
}

double pupil_row_gain_averaged(double light_hz, int h, double seconds)
{
    double cosine, sine;
    const double turns = 0.5 * light_hz * h * seconds;
    pupil_row_gain_circle(turns, &cosine, &sine);
    return turns > 1e-6 ? sine / (2.0 * PI * turns) : 1.0;
}

void pupil_row_gain_forget(pupil_row_gain_object *o)
{
    o->stamped = 0;
    o->width = o->height = 0;
    o->result = (pupil_row_gain_result){.light_hz = 2.0 * o->config.mains_hz,
                                        .readout_s = o->config.readout_s,
                                        .disagreement = 1.0,
                                        .reason = PUPIL_ROW_GAIN_WAITING};
    o->turn = o->known_s = o->moving = o->faded = 0.0;
    o->heard = o->heard_lately = 1.0;
    for (int i = 0; i < PARTS; i++)
        o->part_lately[i] = 1.0;
    __builtin_memset(o->coefficient, 0, sizeof o->coefficient);
    __builtin_memset(o->matrix, 0, sizeof o->matrix);
    __builtin_memset(o->side, 0, sizeof o->side);
    __builtin_memset(o->tile, 0, sizeof o->tile);
    __builtin_memset(o->row_rest, 0, sizeof o->row_rest);
    __builtin_memset(o->row_wave, 0, sizeof o->row_wave);
}

/* term[][] of a frame whose first row has the phase o->turn. */
static void fill_terms(pupil_row_gain_object *o)
{
    const double per_band_s = o->result.readout_s / BANDS, hz = o->result.light_hz;
    double left[HARMONICS], cosine, sine, step_cosine, step_sine;
    for (int h = 0; h < HARMONICS; h++)
        left[h] = pupil_row_gain_averaged(hz, h + 1, o->exposure_s) * pupil_row_gain_averaged(hz, h + 1, per_band_s);
    pupil_row_gain_circle(o->turn + 0.5 * hz * per_band_s, &cosine, &sine);
    pupil_row_gain_circle(hz * per_band_s, &step_cosine, &step_sine);
    for (int b = 0; b < BANDS; b++) {
        double c = cosine, s = sine;
        for (int h = 0; h < HARMONICS; h++) {
            o->term[b][2 * h] = c * left[h];
            o->term[b][2 * h + 1] = s * left[h];
            const double next = c * cosine - s * sine;
            s = s * cosine + c * sine;
            c = next;
        }
        const double turned = cosine * step_cosine - sine * step_sine;
        sine = sine * step_cosine + cosine * step_sine;
        cosine = turned;
    }
}

static int is_lit(const pupil_row_gain_object *o, int g, int b)
{
    return o->light[g][b] > PUPIL_ROW_GAIN_DARK && o->light_mean[g][b] > PUPIL_ROW_GAIN_DARK;
}

/* Light and terms of a group less their means over its bands; 0 where too few bands are lit. */
typedef struct group_mean {
    double light, term[TERMS];
} group_mean;

static int find_group_mean(const pupil_row_gain_object *o, int g, group_mean *mean)
{
    int count = 0;
    *mean = (group_mean){0};
    for (int b = 0; b < BANDS; b++)
        if (is_lit(o, g, b)) {
            count++;
            mean->light += o->light[g][b] - o->light_mean[g][b];
            for (int k = 0; k < TERMS; k++)
                mean->term[k] += o->term[b][k] - o->term_mean[b][k];
        }
    if (count < BANDS / 8)
        return 0;
    mean->light /= count;
    for (int k = 0; k < TERMS; k++)
        mean->term[k] /= count;
    return 1;
}

/* What a frame says of the wave as it is known: sums over all bands that are lit. */
typedef struct look {
    double cells;
    double rest;           /* (light - wave)^2 */
    double early[2];       /* rest x slope of the wave over its phase, times 1 and times the band from the middle */
    double slope[2];       /* slope^2, the same squared */
    double moved, fitting; /* power of the first harmonic's terms as regressed; as they are */
} look;

static void look_at_group(pupil_row_gain_object *o, int g, look *l)
{
    group_mean mean;
    if (!find_group_mean(o, g, &mean))
        return;
    const double *k = o->coefficient;
    double slope_mean = 0.0, now_mean = 0.0, count = 0.0;
    for (int pass = 0; pass < 2; pass++)
        for (int b = 0; b < BANDS; b++) {
            if (!is_lit(o, g, b))
                continue;
            double wave = 0.0, now = 0.0, slope = 0.0, x[TERMS];
            for (int i = 0; i < TERMS; i++) {
                x[i] = o->term[b][i] - o->term_mean[b][i] - mean.term[i];
                wave += k[i] * x[i];
                now += k[i] * o->term[b][i];
            }
            for (int h = 0; h < HARMONICS; h++)
                slope += (h + 1) * (k[2 * h + 1] * o->term[b][2 * h] - k[2 * h] * o->term[b][2 * h + 1]);
            if (pass == 0) {
                now_mean += now;
                slope_mean += slope;
                count += 1.0;
                continue;
            }
            now -= now_mean / count;
            slope -= slope_mean / count;
            const double rest = o->light[g][b] - o->light_mean[g][b] - mean.light - wave;
            const double place = (b - 0.5 * (BANDS - 1)) / BANDS;
            l->cells += 1.0;
            l->rest += rest * rest;
            o->part_wave[g] += now * now;
            o->part_rest[g] += now * rest;
            o->part_wave[GROUPS + b * SEGMENTS / BANDS] += now * now;
            o->part_rest[GROUPS + b * SEGMENTS / BANDS] += now * rest;
            l->early[0] += rest * slope;
            l->early[1] += rest * slope * place;
            l->slope[0] += slope * slope;
            l->slope[1] += slope * slope * place * place;
            l->moved += x[0] * x[0] + x[1] * x[1];
            l->fitting += o->term[b][0] * o->term[b][0] + o->term[b][1] * o->term[b][1];
        }
}

static look look_at_frame(pupil_row_gain_object *o)
{
    look l = {0};
    for (int i = 0; i < PARTS; i++)
        o->part_wave[i] = o->part_rest[i] = 0.0;
    for (int g = 0; g < GROUPS; g++)
        look_at_group(o, g, &l);
    return l;
}

/* Adds the frame to the normal equations of all and of each tile. */
static void add_group(pupil_row_gain_object *o, int g, double weight)
{
    group_mean mean;
    if (!find_group_mean(o, g, &mean))
        return;
    for (int b = 0; b < BANDS; b++) {
        if (!is_lit(o, g, b))
            continue;
        pupil_row_gain_tile *t = &o->tile[g][b * SEGMENTS / BANDS];
        const double light = o->light[g][b] - o->light_mean[g][b] - mean.light;
        double x[TERMS], wave = 0.0;
        for (int i = 0; i < TERMS; i++) {
            x[i] = o->term[b][i] - o->term_mean[b][i] - mean.term[i];
            wave += x[i] * o->coefficient[i];
        }
        o->row_rest[b] += weight * wave * (light - wave);
        o->row_wave[b] += weight * wave * wave;
        for (int i = 0; i < TERMS; i++) {
            for (int j = 0; j < TERMS; j++)
                o->matrix[i][j] += weight * x[i] * x[j];
            o->side[i] += weight * x[i] * light;
        }
        for (int i = 0; i < 2; i++) {
            for (int j = 0; j < TERMS; j++)
                t->matrix[i][j] += weight * x[i] * x[j];
            t->side[i] += weight * x[i] * light;
        }
        t->bands += 1.0;
    }
}

static void forget_a_little(pupil_row_gain_object *o, double keep)
{
    for (int b = 0; b < BANDS; b++) {
        o->row_rest[b] *= keep;
        o->row_wave[b] *= keep;
    }
    for (int i = 0; i < TERMS; i++) {
        for (int j = 0; j < TERMS; j++)
            o->matrix[i][j] *= keep;
        o->side[i] *= keep;
    }
    for (int g = 0; g < GROUPS; g++)
        for (int v = 0; v < SEGMENTS; v++) {
            pupil_row_gain_tile *t = &o->tile[g][v];
            for (int i = 0; i < 2; i++) {
                for (int j = 0; j < TERMS; j++)
                    t->matrix[i][j] *= keep;
                t->side[i] *= keep;
            }
            t->bands *= keep;
        }
}

/* What the harmonics are if the lamps' light is a sine: log2(1 + m cos p) is the sum of
 * 2 r^h cos(h p) (-1)^(h+1) / (h ln 2) and a constant, r = (1 - sqrt(1 - m^2)) / m. */
static void of_sine(const double k[2], double usual[TERMS])
{
    const double ln2 = 0x1.62e42fefa39efp-1, c = 0.5 * ln2 * k[0], s = 0.5 * ln2 * k[1]; /* r and the phase */
    double power_c = c, power_s = s;
    usual[0] = usual[1] = 0.0; /* nothing is expected of the fundamental */
    for (int h = 1; h < HARMONICS; h++) {
        const double next = power_c * c - power_s * s, sign = h % 2 ? -2.0 : 2.0;
        power_s = power_s * c + power_c * s;
        power_c = next;
        usual[2 * h] = sign * power_c / ((h + 1) * ln2);
        usual[2 * h + 1] = sign * power_s / ((h + 1) * ln2);
    }
}

/* coefficient = (matrix + prior)^-1 (side + prior x usual), by elimination: the matrix is symmetric and, with the
 * prior, positive. A harmonic that stands still (the third of 100 Hz at 30 frames a second) looks like the scene: it
 * has to move a tenth as much as the fundamental does to be believed, and is that of a sine if not. */
static void solve(pupil_row_gain_object *o)
{
    const double harmonic = prior + 0.01 * (o->matrix[0][0] + o->matrix[1][1]);
    double a[TERMS][TERMS], x[TERMS], usual[TERMS];
    of_sine(o->coefficient, usual);
    for (int i = 0; i < TERMS; i++) {
        x[i] = o->side[i] + (i < 2 ? 0.0 : harmonic * usual[i]);
        for (int j = 0; j < TERMS; j++)
            a[i][j] = o->matrix[i][j] + (i != j ? 0.0 : i < 2 ? prior : harmonic);
    }
    for (int i = 0; i < TERMS; i++)
        for (int j = i + 1; j < TERMS; j++) {
            const double factor = a[j][i] / a[i][i];
            for (int k = i; k < TERMS; k++)
                a[j][k] -= factor * a[i][k];
            x[j] -= factor * x[i];
        }
    for (int i = TERMS; i-- > 0;) {
        for (int k = i + 1; k < TERMS; k++)
            x[i] -= a[i][k] * x[k];
        x[i] /= a[i][i];
    }
    for (int i = 0; i < TERMS; i++)
        o->coefficient[i] = x[i];
}

/* The power of the fundamental in some bands, as the frames showed it. */
static double power_of(const double k[2], const double row0[2], const double row1[2])
{
    return k[0] * (row0[0] * k[0] + row0[1] * k[1]) + k[1] * (row1[0] * k[0] + row1[1] * k[1]);
}

/* The power of what a tile's wave differs by from that of all, over the power of the latter. `usual` is a part of the
 * power in other tiles: where the wave alternates between frames some rows hardly see it. */
static double disagreement_of(const pupil_row_gain_object *o, const pupil_row_gain_tile *t, double usual)
{
    const double *k = o->coefficient;
    const double wave = power_of(k, t->matrix[0], t->matrix[1]) + usual;
    double u[2];
    for (int i = 0; i < 2; i++) {
        u[i] = t->side[i];
        for (int j = 0; j < TERMS; j++)
            u[i] -= t->matrix[i][j] * k[j];
    }
    const double a = t->matrix[0][0] + prior, b = t->matrix[0][1], c = t->matrix[1][1] + prior;
    const double other = (u[0] * u[0] * c - 2.0 * u[0] * u[1] * b + u[1] * u[1] * a) / (a * c - b * b);
    return other < wave ? other / wave : 1.0;
}

static double worst_disagreement(const pupil_row_gain_object *o)
{
    const double power = power_of(o->coefficient, o->matrix[0], o->matrix[1]) + prior;
    double worst = 0.0;
    int groups = 0, tiles = 0;
    for (int g = 0; g < GROUPS; g++) {
        int here = 0;
        for (int v = 0; v < SEGMENTS; v++)
            if (o->tile[g][v].bands > 2.0) {
                const double d = disagreement_of(o, &o->tile[g][v], 0.2 * power / (GROUPS * SEGMENTS));
                worst = d > worst ? d : worst;
                here++;
            }
        groups += here > 0;
        tiles += here;
    }
    for (int b = 0; b < BANDS; b++) { /* what lies across the picture is thinner than a tile */
        const double share = o->row_rest[b] / (o->row_wave[b] + 0.2 * power / BANDS), d = share * share;
        worst = d > worst ? d < 1.0 ? d : 1.0 : worst;
    }
    /* a few tiles in the dark agree easily */
    return groups >= GROUPS / 2 && tiles >= GROUPS * SEGMENTS / 4 ? worst : 1.0;
}

/* Leads phase, frequency and readout by what a shift of them would explain of this frame. Whether to look
 * again. */
static int lead(pupil_row_gain_object *o, const look *l, double dt_s)
{
    const double two_pi = 2.0 * PI, usual_hz = 2.0 * o->config.mains_hz;
    if (!(l->slope[0] > 1e-4 * l->cells)) /* a wave of 0.014 EV */
        return 0;
    /* The error of the shift is the rest over the slope, and more, because neighbours move together; it is held against
     * what timestamps may be off, 0.1 rad: 0.16 ms. */
    const double error = 8.0 * l->rest / l->cells / l->slope[0], trust = 0.01 / (0.01 + error);
    const double early = trust * clamp(l->early[0] / l->slope[0], -1.0, 1.0) / two_pi; /* turns */
    o->turn += early;
    o->result.light_hz = clamp(o->result.light_hz + 0.03 * early / dt_s, usual_hz * 0.99, usual_hz * 1.01);
    const double tilt_trust = 0.01 / (0.01 + 12.0 * error); /* a place is a twelfth of 1, squared and on average */
    const double tilt = 0.3 * tilt_trust * clamp(l->early[1] / l->slope[1], -0.5, 0.5) / two_pi; /* turns a readout */
    const double readout_s = o->result.readout_s + tilt / o->result.light_hz, usual_s = o->config.readout_s;
    o->result.readout_s = clamp(readout_s, usual_s * 0.88, usual_s * 1.12);
    o->turn -= 0.5 * tilt; /* so that the middle row stays */
    fill_terms(o);
    return early > 0.03 || early < -0.03; /* a fifth of a radian: the wave is no straight line that far away */
}

/* The least that was heard of the wave in any group or segment. A part that is dark, or that the wave does not reach (a
 * segment is a fraction of a period), has little to say. */
static void hear(pupil_row_gain_object *o, double dt_s)
{
    double all = 0.0;
    for (int i = 0; i < PARTS; i++)
        all += o->part_wave[i] / PARTS;
    o->heard = o->heard_lately = 1.0;
    for (int i = 0; i < PARTS; i++) {
        const double part = 1.0 + clamp(o->part_rest[i] / (o->part_wave[i] + 0.2 * all + 1e-30), -1.0, 1.0);
        o->part_lately[i] += pupil_one_minus_exp(dt_s / 0.1) * (part - o->part_lately[i]);
        o->heard = part < o->heard ? part : o->heard;
        o->heard_lately = o->part_lately[i] < o->heard_lately ? o->part_lately[i] : o->heard_lately;
    }
}

/* How much of a gain there may be, and why not more. */
static double judge(pupil_row_gain_object *o)
{
    pupil_row_gain_result *r = &o->result;
    const double *k = o->coefficient;
    const double left = pupil_row_gain_averaged(r->light_hz, 1, o->exposure_s);
    const double power = (k[0] * k[0] + k[1] * k[1]) * left * left, worst = worst_disagreement(o);
    const double allowed[] = {
        [PUPIL_ROW_GAIN_WAITING] = o->known_s >= 0.3,
        [PUPIL_ROW_GAIN_LONG] = ramp(o->exposure_s * r->light_hz, 0.95, 0.9),
        [PUPIL_ROW_GAIN_STANDING] = ramp(o->moving, 0.02, 0.04),
        [PUPIL_ROW_GAIN_NO_LAMPS] = ramp(power, 1e-4, 4e-4), /* 0.01 and 0.02 EV */
        [PUPIL_ROW_GAIN_DISTURBED] = ramp(o->heard, 0.4, 0.7),
        /* 8 and 4 % of the wave; sooner, where it is lost in a whole group or segment */
        [PUPIL_ROW_GAIN_MIXED] = ramp(worst, 0.0064, 0.0016) * ramp(o->heard_lately, 0.7, 0.85),
    };
    double all = 1.0;
    r->reason = PUPIL_ROW_GAIN_ON;
    for (uint32_t i = PUPIL_ROW_GAIN_REASON_COUNT; i-- > PUPIL_ROW_GAIN_WAITING;) {
        all *= allowed[i];
        if (allowed[i] < 1.0)
            r->reason = i; /* the first that applies */
    }
    r->disagreement = square_root(worst);
    r->wave_ev = square_root(power);
    return all;
}

/* Gains come in half a second and go in a seventh; in a frame that does not have the wave there are none at once. */
static void fade(pupil_row_gain_object *o, double aim, double dt_s)
{
    const double now = ramp(o->heard, 0.4, 0.7);
    o->faded = aim > o->faded ? clamp(o->faded + dt_s / 0.5, 0.0, aim) : clamp(o->faded - dt_s / 0.15, aim, 1.0);
    o->result.strength = o->faded * now;
}

static void keep_means(pupil_row_gain_object *o, double weight)
{
    for (int b = 0; b < BANDS; b++) {
        for (int i = 0; i < TERMS; i++)
            o->term_mean[b][i] += weight * (o->term[b][i] - o->term_mean[b][i]);
        for (int g = 0; g < GROUPS; g++)
            o->light_mean[g][b] += weight * (o->light[g][b] - o->light_mean[g][b]);
    }
}

void pupil_row_gain_learn(pupil_row_gain_object *o, const pupil_frame_info *info)
{
    const double dt_s = (double)(int64_t)((uint64_t)info->timestamp_ns - (uint64_t)o->timestamp_ns) * 1e-9;
    const int goes_on = o->stamped && dt_s > 0.0 && dt_s <= gap_s;
    if (!goes_on) {
        const uint32_t width = o->width, height = o->height;
        pupil_row_gain_forget(o);
        o->width = width;
        o->height = height;
    }
    o->stamped = 1;
    o->timestamp_ns = info->timestamp_ns;
    o->exposure_s = info->exposure_s > 0.0 && info->exposure_s <= 1e4 ? info->exposure_s : 0.0;
    const double advance = goes_on ? o->result.light_hz * dt_s : 0.0, slip = advance - nearest_integer(advance);
    o->turn += slip;
    o->turn -= nearest_integer(o->turn);
    fill_terms(o);
    if (!goes_on) {
        keep_means(o, 1.0); /* from what they were to what is here: rounding leaves nothing of note */
        return;
    }
    look l = look_at_frame(o);
    if (l.cells > 0.0) {
        for (int again = 0; again < 3 && lead(o, &l, dt_s); again++)
            l = look_at_frame(o);
        const double explained = l.slope[0] > 0.0 ? l.early[0] * l.early[0] / l.slope[0] : 0.0;
        const double rest = clamp(l.rest - explained, 0.0, l.rest) / l.cells;
        forget_a_little(o, 1.0 - pupil_one_minus_exp(dt_s / memory_s));
        for (int g = 0; g < GROUPS; g++)
            add_group(o, g, 1.0 / (rest + noise_ev * noise_ev));
        l = look_at_frame(o);
        hear(o, dt_s);
        o->moving += pupil_one_minus_exp(dt_s / memory_s) * (l.moved / (l.fitting + 1e-30) - o->moving);
        o->known_s += dt_s;
        solve(o);
    }
    const double pace = slip < 0.0 ? -slip : slip;
    keep_means(o, clamp(3.0 * pace, 0.03, 1.0));
    fade(o, judge(o), dt_s);
}

/* The flicker's wave: found in the light of bands, followed, and compared with each tile of the picture.
 *
 * log2 of the light in a band is that of the scene, which is constant, plus a sum of coefficient x term. The terms are
 * cosine and sine of the phase and its multiples, each attenuated by the exposure. The mean of the last frames is
 * subtracted from both light and terms, which removes the scene. The mean over its bands is subtracted from each group,
 * which removes what changes the whole group at once (the camera's settings, clouds). A linear regression remains. Its
 * normal equations are sums that forget frames within seconds. Phase, frequency and readout are corrected by how much
 * they explain of the residual.
 */
#include "row_gain_private.h"

#include "base/numeric.h"

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
static const double scene_s = 1.0;   /* of the means: at most; waves that roll by more slowly count as stationary */
static const double gap_s = 0.5;     /* mains of 50 +- 0.2 Hz are a fifth of a period off after it */
static const double noise_ev = 0.02; /* the smallest error of a band; for the weights of frames */

void pupil_row_gain_forget(pupil_row_gain_object *o)
{
    o->stamped = 0;
    o->width = o->height = 0;
    o->result = (pupil_row_gain_result){.light_hz = 2.0 * o->config.mains_hz,
                                        .readout_s = o->config.readout_s,
                                        .disagreement = 1.0,
                                        .reason = PUPIL_ROW_GAIN_WAITING};
    o->turn = o->known_s = o->moving = o->drift = o->faded = 0.0;
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

static int is_lit(const pupil_row_gain_object *o, int g, int b)
{
    return o->light[g][b] > PUPIL_ROW_GAIN_DARK && o->light_mean[g][b] > PUPIL_ROW_GAIN_DARK;
}

/* A term of this frame less its mean, as the exposure leaves it. */
static double regressor(const pupil_row_gain_object *o, int b, int i)
{
    return (o->term[b][i] - o->term_mean[b][i]) * o->left[i / 2];
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
                mean->term[k] += regressor(o, b, k);
        }
    if (count < BANDS / 8)
        return 0;
    mean->light /= count;
    for (int k = 0; k < TERMS; k++)
        mean->term[k] /= count;
    return 1;
}

/* How a frame agrees with the wave as it is known: sums over all bands that are lit. */
typedef struct look {
    double cells;
    double rest;         /* (light - wave)^2 */
    double wave, miss;   /* this frame's wave, squared; times the rest */
    double early[2];     /* rest x slope of the wave over its phase, times 1 and times the band from the middle */
    double slope[3];     /* slope^2, times 1, the band and its square */
    double moved, whole; /* power of the first harmonic's terms as regressed; without any mean over frames */
} look;

static void look_at_group(pupil_row_gain_object *o, int g, look *l)
{
    group_mean mean;
    if (!find_group_mean(o, g, &mean))
        return;
    const double *k = o->coefficient;
    double slope_mean = 0.0, now_mean = 0.0, count = 0.0, term_mean[2] = {0.0, 0.0};
    for (int pass = 0; pass < 2; pass++)
        for (int b = 0; b < BANDS; b++) {
            if (!is_lit(o, g, b))
                continue;
            double wave = 0.0, now = 0.0, slope = 0.0, x[TERMS];
            for (int i = 0; i < TERMS; i++) {
                x[i] = regressor(o, b, i) - mean.term[i];
                wave += k[i] * x[i];
                now += k[i] * o->left[i / 2] * o->term[b][i];
            }
            for (int h = 0; h < HARMONICS; h++)
                slope += (h + 1) * o->left[h] * (k[2 * h + 1] * o->term[b][2 * h] - k[2 * h] * o->term[b][2 * h + 1]);
            if (pass == 0) {
                now_mean += now;
                term_mean[0] += o->term[b][0];
                term_mean[1] += o->term[b][1];
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
            l->wave += now * now;
            l->miss += now * rest;
            o->part_wave[g] += now * now;
            o->part_rest[g] += now * rest;
            o->part_wave[GROUPS + b * SEGMENTS / BANDS] += now * now;
            o->part_rest[GROUPS + b * SEGMENTS / BANDS] += now * rest;
            l->early[0] += rest * slope;
            l->early[1] += rest * slope * place;
            l->slope[0] += slope * slope;
            l->slope[1] += slope * slope * place;
            l->slope[2] += slope * slope * place * place;
            l->moved += x[0] * x[0] + x[1] * x[1];
            for (int i = 0; i < 2; i++) {
                const double whole = o->left[0] * (o->term[b][i] - term_mean[i] / count);
                l->whole += whole * whole;
            }
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
            x[i] = regressor(o, b, i) - mean.term[i];
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

/* Corrects phase, frequency and readout by the shift that explains this frame best. Returns whether to look again.
 */
static int lead(pupil_row_gain_object *o, const look *l, double dt_s)
{
    const double two_pi = 2.0 * PI;
    const double usual_hz = 2.0 * o->config.mains_hz;
    if (!(l->slope[0] > 1e-4 * l->cells)) /* a wave of 0.014 EV */
        return 0;
    /* The error of the shift is the rest over the slope, and more, because neighbours move together. It is compared
     * with the error that timestamps may have, 0.1 rad: 0.16 ms. */
    const double error = 8.0 * l->rest / l->cells / l->slope[0];
    const double trust = 0.01 / (0.01 + error);
    const double usual_s = o->config.readout_s;
    /* less than half a period in the picture does not show the period's length */
    const double tilt_trust = clamp(2.0 * usual_s * usual_hz - 1.0, 0.0, 1.0) * 0.01 / (0.01 + 2.0 * error);
    /* least squares for the two: normal equations of two by two, a little regularised */
    const double a = l->slope[0] * (1.0 + 1e-6);
    const double b = l->slope[1];
    const double c = l->slope[2] + 1e-6 * a;
    const double of = a * c - b * b;
    const double shift = (l->early[0] * c - l->early[1] * b) / of;
    const double lean = (l->early[1] * a - l->early[0] * b) / of;
    const double early = trust * clamp(shift, -1.0, 1.0) / two_pi;          /* turns */
    const double tilt = 0.2 * tilt_trust * clamp(lean, -0.5, 0.5) / two_pi; /* turns a readout */
    o->turn += early;
    o->result.light_hz = clamp(o->result.light_hz + 0.03 * early / dt_s, usual_hz * 0.99, usual_hz * 1.01);
    o->result.readout_s = clamp(o->result.readout_s + tilt / o->result.light_hz, usual_s * 0.88, usual_s * 1.12);
    o->turn -= 0.5 * tilt; /* so that the middle row keeps its phase */
    pupil_row_gain_fill_terms(o);
    return early > 0.03 || early < -0.03; /* a fifth of a radian: over such a shift the wave is not linear */
}

/* If no shift makes the wave fit, it is missing, at least in places: phase, frequency and readout then remain as they
 * were. They also remain if shifts keep their direction: a picture without the wave looks like one in which it does not
 * move.
 */
static look lead_while_it_helps(pupil_row_gain_object *o, look l, double dt_s)
{
    const double turn = o->turn;
    const double light_hz = o->result.light_hz;
    const double readout_s = o->result.readout_s;
    int again = 1;
    for (int i = 0; i < 3 && again; i++) {
        again = lead(o, &l, dt_s);
        l = look_at_frame(o);
    }
    o->drift += pupil_one_minus_exp(dt_s / 0.1) * (o->turn - turn - o->drift);
    if (l.miss < -0.5 * l.wave || o->drift > PUPIL_ROW_GAIN_DRIFT || o->drift < -PUPIL_ROW_GAIN_DRIFT) {
        o->turn = turn;
        o->result.light_hz = light_hz;
        o->result.readout_s = readout_s;
        pupil_row_gain_fill_terms(o);
        l = look_at_frame(o);
    }
    return l;
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
    const int goes_on = o->stamped && info->timestamp_ns > o->timestamp_ns && dt_s > 0.0 && dt_s <= gap_s;
    if (!goes_on) {
        const uint32_t width = o->width;
        const uint32_t height = o->height;
        pupil_row_gain_forget(o);
        o->width = width;
        o->height = height;
    }
    o->stamped = 1;
    o->timestamp_ns = info->timestamp_ns;
    pupil_row_gain_expose(o, info->exposure_s > 0.0 && info->exposure_s <= 1e4 ? info->exposure_s : 0.0);
    const double advance = goes_on ? o->result.light_hz * dt_s : 0.0;
    const double slip = advance - pupil_nearest(advance);
    o->turn += slip;
    o->turn -= pupil_nearest(o->turn);
    pupil_row_gain_fill_terms(o);
    if (!goes_on) {
        keep_means(o, 1.0); /* replaces the old means; the rounding error does not matter */
        return;
    }
    look l = look_at_frame(o);
    if (l.cells > 0.0) {
        l = lead_while_it_helps(o, l, dt_s);
        const double rest = l.rest / l.cells;
        forget_a_little(o, 1.0 - pupil_one_minus_exp(dt_s / memory_s));
        for (int g = 0; g < GROUPS; g++)
            add_group(o, g, 1.0 / (rest + noise_ev * noise_ev));
        l = look_at_frame(o);
        o->moving += pupil_one_minus_exp(dt_s / memory_s) * (l.moved / (l.whole + 1e-30) - o->moving);
        o->known_s += dt_s;
        pupil_row_gain_solve(o);
    }
    const double pace = slip < 0.0 ? -slip : slip;
    keep_means(o, clamp(3.0 * pace, pupil_one_minus_exp(dt_s / scene_s), 1.0));
    pupil_row_gain_judge(o, l.cells > 0.0, dt_s);
}

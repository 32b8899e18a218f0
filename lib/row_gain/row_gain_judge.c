/* How much of a gain there may be: whether all tiles have the wave, and whether the last frame has it. */
#include "row_gain_private.h"

#include "base/numeric.h"

enum {
    GROUPS = PUPIL_ROW_GAIN_GROUPS,
    SEGMENTS = PUPIL_ROW_GAIN_SEGMENTS,
    PARTS = PUPIL_ROW_GAIN_PARTS,
    TERMS = PUPIL_ROW_GAIN_TERMS,
    BANDS = PUPIL_BANDS
};

/* 0 at `none`, 1 at `all`, straight between. */
static double ramp(double x, double none, double all)
{
    return clamp((x - none) / (all - none), 0.0, 1.0);
}

static double square_root(double x)
{
    return x > 1e-300 ? pupil_exp2(0.5 * pupil_log2(x)) : 0.0;
}

/* The power of the fundamental in some bands, as the frames showed it. */
static double power_of(const double k[2], const double row0[2], const double row1[2])
{
    return k[0] * (row0[0] * k[0] + row0[1] * k[1]) + k[1] * (row1[0] * k[0] + row1[1] * k[1]);
}

/* The power of the difference between a tile's wave and that of all tiles, over the power of the latter. `usual` is a
 * part of the power in other tiles, because some rows hardly see a wave that alternates between frames. */
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
    const double a = t->matrix[0][0] + PUPIL_ROW_GAIN_PRIOR;
    const double b = t->matrix[0][1];
    const double c = t->matrix[1][1] + PUPIL_ROW_GAIN_PRIOR;
    const double other = (u[0] * u[0] * c - 2.0 * u[0] * u[1] * b + u[1] * u[1] * a) / (a * c - b * b);
    return other < wave ? other / wave : 1.0;
}

static double worst_disagreement(const pupil_row_gain_object *o)
{
    const double power = power_of(o->coefficient, o->matrix[0], o->matrix[1]) + PUPIL_ROW_GAIN_PRIOR;
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
    for (int b = 0; b < BANDS; b++) { /* areas across the whole picture may be thinner than a tile */
        const double share = o->row_rest[b] / (o->row_wave[b] + 0.2 * power / BANDS);
        const double d = share * share;
        worst = d > worst ? d < 1.0 ? d : 1.0 : worst;
    }
    /* a few tiles in the dark agree easily */
    return groups >= GROUPS / 2 && tiles >= GROUPS * SEGMENTS / 4 ? worst : 1.0;
}

/* The smallest share of the wave that was found in any group or segment. A part that is dark, or that the wave does not
 * reach (a segment is a fraction of a period), counts little. The share falls at once and recovers in a tenth of a
 * second, because the means of the last frames get used to the picture. */
static void hear(pupil_row_gain_object *o, double dt_s)
{
    const double w = pupil_one_minus_exp(dt_s / 0.1);
    double all = 0.0;
    for (int i = 0; i < PARTS; i++)
        all += o->part_wave[i] / PARTS;
    double now = 1.0;
    o->heard_lately = 1.0;
    for (int i = 0; i < PARTS; i++) {
        const double part = 1.0 + clamp(o->part_rest[i] / (o->part_wave[i] + 0.2 * all + 1e-30), -1.0, 1.0);
        o->part_lately[i] += w * (part - o->part_lately[i]);
        now = part < now ? part : now;
        o->heard_lately = o->part_lately[i] < o->heard_lately ? o->part_lately[i] : o->heard_lately;
    }
    o->heard = now < o->heard ? now : o->heard + w * (now - o->heard);
}

/* Whether the last frame has the wave in all groups and segments. A pan of 1 % of the width a frame hides up to 0.15 of
 * a wave of modulation 0.3 in one of them. If a pan brings a window into view, more than that is missing from the
 * outermost group in the third frame. */
static double has_wave(const pupil_row_gain_object *o)
{
    return ramp(o->heard, 0.7, 0.85);
}

/* How much of a gain there may be, and why not more. */
static double judge(pupil_row_gain_object *o)
{
    pupil_row_gain_result *r = &o->result;
    const double *k = o->coefficient;
    const double left = pupil_row_gain_averaged(r->light_hz, 1, o->exposure_s);
    const double power = (k[0] * k[0] + k[1] * k[1]) * left * left;
    const double worst = worst_disagreement(o);
    const double drift = o->drift < 0.0 ? -o->drift : o->drift;
    const double allowed[] = {
        [PUPIL_ROW_GAIN_WAITING] = o->known_s >= 0.3,
        [PUPIL_ROW_GAIN_LONG] = ramp(o->exposure_s * r->light_hz, 0.95, 0.9),
        [PUPIL_ROW_GAIN_STATIONARY] = ramp(o->moving, 0.1, 0.2),
        [PUPIL_ROW_GAIN_NO_FLICKER] = ramp(power, 1e-4, 4e-4), /* 0.01 and 0.02 EV */
        [PUPIL_ROW_GAIN_DISTURBED] = has_wave(o) * ramp(drift, PUPIL_ROW_GAIN_DRIFT, 0.8 * PUPIL_ROW_GAIN_DRIFT),
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
    r->flicker_ev = square_root(power);
    return all;
}

/* Gains fade in within half a second and out within a seventh; a frame that does not have the wave has none at once. */
static void fade(pupil_row_gain_object *o, double aim, double dt_s)
{
    o->faded = aim > o->faded ? clamp(o->faded + dt_s / 0.5, 0.0, aim) : clamp(o->faded - dt_s / 0.15, aim, 1.0);
    o->result.strength = o->faded * has_wave(o);
}

void pupil_row_gain_judge(pupil_row_gain_object *o, int heard, double dt_s)
{
    if (heard)
        hear(o, dt_s);
    fade(o, judge(o), dt_s);
}

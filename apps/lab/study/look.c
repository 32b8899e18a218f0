/* `pupil study look`: how the picture looks while a law adapts: how far the colour of objects and the contrast are off
 * in each frame, under the four formulas, the default law and the eye's. A lamp is switched on, and off.
 *
 * The picture of each frame is compared with that of a settled exposure of the same light: colour by the distance of a
 * and b of Oklab, times 100; contrast by the spread of Oklab's lightness L.
 */
#include "study.h"

#include <math.h>
#include <stdlib.h>

#include "common/interrupt.h"
#include "refuse.h"

enum { LAWS = 6, TIMES = 7, LOOKED_S = 10, EVERY_FRAME_S = 2 };

static const struct {
    const char *name;
    uint32_t law;
} laws[LAWS] = {{"formula 1", PUPIL_LAW_ARITHMETIC_SCALE},
                {"formula 2", PUPIL_LAW_ARITHMETIC_LUMINANCE},
                {"formula 3", PUPIL_LAW_GEOMETRIC_SCALE},
                {"formula 4", PUPIL_LAW_GEOMETRIC_LUMINANCE},
                {"seconds", PUPIL_LAW_SECONDS},
                {"eye", PUPIL_LAW_EYE}};

static const double times_s[TIMES] = {0.1, 0.5, 1.0, 5.0, 30.0, 120.0, 600.0};

typedef struct lab {
    double lightness, a, b;
} lab;

typedef struct looking {
    const study_images *images;
    const study_look *options;
    pupil_stats stats[2];
    size_t pixels;
    float *shown;
    lab *target, *now;
} looking;

/* The result of one law for one change of light. */
typedef struct look_row {
    double off_ev[TIMES]; /* the level's distance from the light's: positive is too dark */
    double settled_s;     /* within 0.05 stops from this time on; infinite: not in 10 minutes */
    double colour_mean, colour_most, contrast_mean, contrast_least, jump_most;
} look_row;

/* Oklab of linear BT.709: Ottosson 2020. */
static lab lab_of(const float rgb[3])
{
    const double r = (double)rgb[0], g = (double)rgb[1], b = (double)rgb[2];
    const double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return (lab){100.0 * (0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s),
                 100.0 * (1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s),
                 100.0 * (0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s)};
}

static int begin(const looking *k, pupil_t *pupil, uint32_t law)
{
    pupil_config config;
    pupil_config_default(&config);
    config.law = law;
    config.frame_weight = k->options->weight;
    config.eye_unit_cd_m2 = k->options->unit_cd_m2;
    config.flicker = 0; /* a lamp's switching is not mains flicker */
    return pupil_init(pupil, &config);
}

static int picture(const looking *k, const pupil_t *pupil, int light, lab *out)
{
    const ptrdiff_t stride = (ptrdiff_t)(k->images->width * 3 * sizeof(float));
    const pupil_image_const in = {.data = k->images->state[light],
                                  .stride_bytes = stride,
                                  .width = k->images->width,
                                  .height = k->images->height,
                                  .pixel = PUPIL_PIXEL_RGB32F};
    const pupil_image to = {.data = k->shown,
                            .stride_bytes = stride,
                            .width = k->images->width,
                            .height = k->images->height,
                            .pixel = PUPIL_PIXEL_RGB32F};
    pupil_curve curve;
    int error = pupil_get_curve(pupil, NULL, &curve);
    error = error ? error : pupil_map_rows(pupil, &curve, &in, &to);
    for (size_t i = 0; i < k->pixels && !error; i++)
        out[i] = lab_of(k->shown + 3 * i);
    return error;
}

static double mean_lightness(const looking *k, const lab *p)
{
    double sum = 0.0;
    for (size_t i = 0; i < k->pixels; i++)
        sum += p[i].lightness;
    return sum / (double)k->pixels;
}

static double contrast(const looking *k, const lab *p)
{
    const double mean = mean_lightness(k, p);
    double square = 0.0;
    for (size_t i = 0; i < k->pixels; i++)
        square += (p[i].lightness - mean) * (p[i].lightness - mean);
    return sqrt(square / (double)k->pixels);
}

static double colour_off(const looking *k)
{
    double sum = 0.0;
    for (size_t i = 0; i < k->pixels; i++)
        sum += hypot(k->now[i].a - k->target[i].a, k->now[i].b - k->target[i].b);
    return sum / (double)k->pixels;
}

/* Frames whose picture is compared: all of the first two seconds, then two a second. */
static int is_looked_at(uint32_t frame)
{
    return frame <= EVERY_FRAME_S * STUDY_FPS || (frame <= LOOKED_S * STUDY_FPS && frame % (STUDY_FPS / 2) == 0);
}

static int look_at(const looking *k, const pupil_t *pupil, uint32_t frame, int light, double *last, double *weight,
                   look_row *row)
{
    const double held_s = frame <= EVERY_FRAME_S * STUDY_FPS ? 1.0 / STUDY_FPS : 0.5;
    const double whole = contrast(k, k->target);
    const int error = picture(k, pupil, light, k->now);
    if (error)
        return error;
    const double colour = colour_off(k), left = contrast(k, k->now) / whole, mean = mean_lightness(k, k->now);
    row->colour_mean += colour * held_s;
    row->colour_most = fmax(row->colour_most, colour);
    row->contrast_mean += left * held_s;
    row->contrast_least = fmin(row->contrast_least, left);
    if (frame > 1 && frame <= EVERY_FRAME_S * STUDY_FPS)
        row->jump_most = fmax(row->jump_most, fabs(mean - *last));
    *last = mean;
    *weight += held_s;
    return PUPIL_OK;
}

/* The lamp is switched in frame 1; before it the eye is at rest. */
static int run_law(const looking *k, uint32_t law, int light, look_row *row)
{
    const uint32_t frames = (uint32_t)(times_s[TIMES - 1] * STUDY_FPS);
    double last = 0.0, weight = 0.0;
    int time = 0;
    pupil_t pupil;
    int error = begin(k, &pupil, law);
    *row = (look_row){.settled_s = INFINITY, .contrast_least = INFINITY};
    for (uint32_t frame = 0; frame <= frames && !error; frame++) {
        const pupil_frame_info info = {.timestamp_ns = (int64_t)frame * 1000000000 / STUDY_FPS + 1};
        pupil_exposure e = {0};
        error = pupil_adapt(&pupil, &k->stats[frame ? light : !light], &info);
        error = error ? error : pupil_get_exposure(&pupil, &e);
        if (!frame)
            continue;
        const double off_ev = e.adapted_ev - e.metered_ev - e.held_back_ev;
        row->settled_s = fabs(off_ev) > 0.05     ? INFINITY
                         : isinf(row->settled_s) ? (double)frame / STUDY_FPS
                                                 : row->settled_s;
        if (time < TIMES && frame == (uint32_t)lround(times_s[time] * STUDY_FPS))
            row->off_ev[time++] = off_ev;
        if (is_looked_at(frame) && !error)
            error = look_at(k, &pupil, frame, light, &last, &weight, row);
    }
    row->colour_mean /= weight;
    row->contrast_mean /= weight;
    return error;
}

/* The picture of a settled exposure: the default law's first frame. */
static int find_target(const looking *k, int light)
{
    pupil_t pupil;
    int error = begin(k, &pupil, PUPIL_LAW_SECONDS);
    error = error ? error : pupil_adapt(&pupil, &k->stats[light], NULL);
    return error ? error : picture(k, &pupil, light, k->target);
}

static int meter(looking *k)
{
    pupil_t pupil;
    int error = begin(k, &pupil, PUPIL_LAW_SECONDS);
    for (int light = 0; light < 2 && !error; light++) {
        const pupil_image_const image = {.data = k->images->state[light],
                                         .stride_bytes = (ptrdiff_t)(k->images->width * 3 * sizeof(float)),
                                         .width = k->images->width,
                                         .height = k->images->height,
                                         .pixel = PUPIL_PIXEL_RGB32F};
        pupil_stats_clear(&k->stats[light]);
        error = pupil_meter_rows(&pupil, &image, 0, image.height, &k->stats[light]);
    }
    return error;
}

static void put_rows(FILE *out, const look_row row[LAWS], int light)
{
    fprintf(out, "\n## The lamp is switched %s\n\n", light ? "on" : "off");
    fprintf(
        out,
        "Stops by which the level is above the light's (positive: too dark a picture), and when it has settled.\n\n");
    fprintf(out, "| law |");
    for (int t = 0; t < TIMES; t++)
        fprintf(out, " %g s |", times_s[t]);
    fprintf(out, " settled, s |\n|---|");
    for (int t = 0; t <= TIMES; t++)
        fprintf(out, "--:|");
    for (int n = 0; n < LAWS; n++) {
        fprintf(out, "\n| %s |", laws[n].name);
        for (int t = 0; t < TIMES; t++)
            fprintf(out, " %+.2f |", row[n].off_ev[t] + 0.0);
        if (isinf(row[n].settled_s))
            fprintf(out, " after %g |", times_s[TIMES - 1]);
        else
            fprintf(out, " %.2f |", row[n].settled_s);
    }
    fprintf(out, "\n\nThe first %d s, compared with the picture that has arrived.\n\n", LOOKED_S);
    fprintf(out,
            "| law | colour of objects, mean | worst frame | contrast between frames, mean | least | largest step of "
            "lightness |\n|---|--:|--:|--:|--:|--:|");
    for (int n = 0; n < LAWS; n++)
        fprintf(out, "\n| %s | %.2f | %.2f | %.3f | %.3f | %.2f |", laws[n].name, row[n].colour_mean,
                row[n].colour_most, row[n].contrast_mean, row[n].contrast_least, row[n].jump_most);
    fputc('\n', out);
}

static int look(looking *k, FILE *out, pupil_why *why)
{
    int error = meter(k);
    fprintf(out, "# How the picture looks while it adapts\n\n%s, %ux%u, 30 fps, w = %g; a luminance of 1 is %g cd/m2\n",
            k->options->scene, k->images->width, k->images->height, k->options->weight, k->options->unit_cd_m2);
    for (int light = 1; light >= 0 && !error; light--) {
        look_row row[LAWS];
        error = find_target(k, light);
        for (int n = 0; n < LAWS && !error; n++) {
            error = run_law(k, laws[n].law, light, &row[n]);
            if (interrupt_came())
                return pupil_refuse(why, "%s: stopped", k->options->scene);
        }
        if (!error)
            put_rows(out, row, light);
    }
    return error ? pupil_refuse(why, "%s: %s", k->options->scene, pupil_error_string(error)) : 0;
}

int study_look_at(const study_images *images, const study_look *options, FILE *out, pupil_why *why)
{
    static looking k; /* two statistics are too large for a stack */
    int failed;
    k = (looking){.images = images, .options = options, .pixels = (size_t)images->width * images->height};
    k.shown = malloc(k.pixels * 3 * sizeof *k.shown);
    k.target = malloc(k.pixels * sizeof *k.target);
    k.now = malloc(k.pixels * sizeof *k.now);
    if (!k.shown || !k.target || !k.now)
        failed = pupil_refuse(why, "%s: not enough memory", options->scene);
    else
        failed = look(&k, out, why);
    free(k.shown);
    free(k.target);
    free(k.now);
    return failed;
}

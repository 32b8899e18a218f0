/* Colours beyond the display's gamut: hue and chroma of their display light in Oklab, from black to white. Lamps and
 * surfaces of known colours, in fine steps of exposure.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#include <math.h>

enum { STEPS = 16000, FIRST_EV = -8, STEPS_A_STOP = 800 };

/* Oklab (Ottosson 2020) of linear RGB: M1 times the primaries' XYZ (SMPTE RP 177-1993), by rows, then M2. */
static const double cones_of[2][3][3] = {{{0.4122214708, 0.5363325363, 0.0514459929},
                                          {0.2119034982, 0.6806995451, 0.1073969566},
                                          {0.0883024619, 0.2817188376, 0.6299787005}},
                                         {{0.6166884490, 0.3601590830, 0.0230432934},
                                          {0.2651402156, 0.6358565293, 0.0990302403},
                                          {0.1001506405, 0.2040043176, 0.6963246745}}};

typedef struct lab {
    double lightness, a, b;
} lab;

static lab lab_of(uint32_t primaries, const double rgb[3])
{
    double root[3];
    for (int i = 0; i < 3; i++) {
        const double *row = cones_of[primaries][i], white = row[0] + row[1] + row[2];
        root[i] = cbrt((row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]) / white);
    }
    return (lab){0.2104542553 * root[0] + 0.7936177850 * root[1] - 0.0040720468 * root[2],
                 1.9779984951 * root[0] - 2.4285922050 * root[1] + 0.4505937099 * root[2],
                 0.0259040371 * root[0] + 0.7827717662 * root[1] - 0.8086757660 * root[2]};
}

static double chroma_of(lab c)
{
    return hypot(c.a, c.b);
}

static double turn_deg(lab from, lab to)
{
    const double cross = from.a * to.b - from.b * to.a, dot = from.a * to.a + from.b * to.b;
    return fabs(atan2(cross, dot)) * 57.29577951308232;
}

/* Whether BT.709 has a colour. Inverses of M2 and M1: Ottosson 2020. */
static int is_in_gamut(lab c)
{
    const double l = pow(c.lightness + 0.3963377774 * c.a + 0.2158037573 * c.b, 3);
    const double m = pow(c.lightness - 0.1055613458 * c.a - 0.0638541728 * c.b, 3);
    const double s = pow(c.lightness - 0.0894841775 * c.a - 1.2914855480 * c.b, 3);
    const double rgb[3] = {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                           -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                           -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
    for (int i = 0; i < 3; i++)
        if (rgb[i] < -1e-4 || rgb[i] > 1.0001)
            return 0;
    return 1;
}

/* The chroma as a share of the largest that BT.709 has at that hue and lightness. */
static double fullness(lab c)
{
    double low = 0.0, high = 4.0;
    for (int i = 0; i < 40; i++) {
        const double middle = (low + high) / 2;
        if (is_in_gamut((lab){c.lightness, c.a * middle, c.b * middle}))
            low = middle;
        else
            high = middle;
    }
    return 1.0 / low;
}

typedef struct light {
    const char *name;
    double rgb[3];
    int is_warm, is_led;
} light;

static const light lights[] = {{"red", {1, 0, 0}, 0, 1},
                               {"green", {0, 1, 0}, 0, 1},
                               {"blue", {0, 0, 1}, 0, 1},
                               {"red LED", {1, 0.02, 0.01}, 0, 1},
                               {"green LED", {0.03, 1, 0.1}, 0, 1},
                               {"blue LED", {0.02, 0.06, 1}, 0, 1},
                               {"cyan", {0, 1, 1}, 0, 0},
                               {"magenta", {1, 0, 1}, 0, 0},
                               {"yellow", {1, 1, 0}, 0, 0},
                               {"oil lamp", {1, 0.42, 0.1}, 1, 0},
                               {"incandescent", {1, 0.6, 0.25}, 1, 0},
                               {"wood", {0.6, 0.28, 0.1}, 1, 0},
                               {"bread", {0.75, 0.45, 0.18}, 1, 0},
                               {"skin", {0.8, 0.5, 0.38}, 1, 0},
                               {"sky", {0.25, 0.45, 1}, 0, 0},
                               {"grey", {1, 1, 1}, 0, 0}};
enum { LIGHTS = sizeof lights / sizeof *lights };

/* Without a white point, with one at 8, and at 1. */
static const pupil_curve curves[] = {{.scale = 1, .gamut = 1 / 0.15f},
                                     {.scale = 1, .inverse_white_squared = 1.0f / 64, .gamut = 1 / 0.15f - 1 / 7.15f},
                                     {.scale = 1, .inverse_white_squared = 1}};

static void map(uint32_t primaries, const pupil_curve *curve, const frame *in, frame *out)
{
    const pupil_image to = frame_writable(out);
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    config.primaries = primaries;
    config.output_primaries = PUPIL_OUTPUT_AS_INPUT;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, curve, &in->image, &to) == PUPIL_OK);
}

static double luminance_of(uint32_t primaries, const double rgb[3])
{
    static const double luma[2][3] = {{0.2126, 0.7152, 0.0722}, {0.262631403, 0.678055704, 0.0593128936}};
    return luma[primaries][0] * rgb[0] + luma[primaries][1] * rgb[1] + luma[primaries][2] * rgb[2];
}

/* What is measured for one light. */
typedef struct figures {
    double turn, jump, fall; /* the largest of each */
    unsigned moved;          /* of display luminance 0.1 to 0.9, how many were; and what they are */
    double kept[STEPS], full[STEPS / 8 + 1];
} figures;

static void see(uint32_t primaries, const double scene[3], double display, const double shown[3], int is_moved,
                figures *f)
{
    const lab from = lab_of(primaries, scene), to = lab_of(primaries, shown);
    if (chroma_of(to) > 0.02)
        f->turn = fmax(f->turn, turn_deg(from, to));
    if (display < 0.1 || display > 0.9 || primaries)
        return;
    if (!is_moved)
        return;
    if (f->moved % 8 == 0)
        f->full[f->moved / 8] = fullness(to);
    f->kept[f->moved++] = chroma_of(to) / chroma_of(from);
}

static int is_less(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, unsigned n)
{
    qsort(values, n, sizeof *values, is_less);
    return n ? values[n / 2] : 1.0;
}

/* One exposure of a light, after the one before it. */
static void check_step(const light *of, uint32_t primaries, const pupil_curve *curve, double exposure,
                       const double shown[3], const double before[3], figures *f)
{
    const double l = exposure * luminance_of(primaries, of->rgb), iw2 = (double)curve->inverse_white_squared;
    const double s = (1 + l * iw2) / (1 + l), display = l * s, knee = curve->gamut > 0 ? (double)PUPIL_GAMUT_KNEE : 1;
    double scene[3], most = 0;
    for (int c = 0; c < 3; c++) {
        scene[c] = exposure * of->rgb[c] * s;
        most = fmax(most, scene[c]);
        f->jump = fmax(f->jump, fabs(shown[c] - before[c]));
    }
    f->fall = fmax(f->fall, luminance_of(primaries, before) - luminance_of(primaries, shown));
    f->fall = fmax(f->fall, lab_of(primaries, before).lightness - lab_of(primaries, shown).lightness);
    if (display >= 1.0001) {
        CHECK_MSG(shown[0] == 1 && shown[1] == 1 && shown[2] == 1, "%s: not white at %g", of->name, display);
        return;
    }
    const double limit = knee + (1 - knee) * display;
    see(primaries, scene, display, shown, most > limit, f);
    for (int c = 0; c < 3 && most < limit * 0.99999; c++)
        CHECK_MSG(fabs(shown[c] - scene[c]) <= 3e-7 * scene[c], "%s: %g became %g", of->name, scene[c], shown[c]);
}

static void check_light(const light *of, uint32_t primaries, unsigned which)
{
    static figures f;
    frame in = frame_make(STEPS, 1, PUPIL_PIXEL_RGB32F, 0, 0), out = frame_make(STEPS, 1, PUPIL_PIXEL_RGB32F, 0, 0);
    const float *at = frame_writable(&out).data;
    double before[3], shown[3];
    for (uint32_t x = 0; x < STEPS; x++) {
        const double exposure = exp2((double)x / STEPS_A_STOP + FIRST_EV);
        frame_set(&in, x, 0, exposure * of->rgb[0], exposure * of->rgb[1], exposure * of->rgb[2], 1);
    }
    map(primaries, &curves[which], &in, &out);
    f = (figures){.turn = 0};
    for (uint32_t x = 0; x < STEPS; x++) {
        for (int c = 0; c < 3; c++) {
            shown[c] = (double)at[3 * x + (uint32_t)c];
            before[c] = (double)at[3 * (x ? x - 1 : x) + (uint32_t)c];
            CHECK(shown[c] >= 0 && shown[c] <= 1);
        }
        if (strcmp(of->name, "grey") == 0)
            CHECK(shown[0] == shown[1] && shown[1] == shown[2]);
        check_step(of, primaries, &curves[which], exp2((double)x / STEPS_A_STOP + FIRST_EV), shown, before, &f);
    }
    const double kept = median(f.kept, f.moved), full = median(f.full, (f.moved + 7) / 8);
    if (!primaries)
        printf("%-12s curve %u: hue turned by %.2f degrees at most, chroma kept %.2f, and %.2f of the gamut's; "
               "largest step %.4f\n",
               of->name, which, f.turn, kept, full, f.jump);
    /* the largest turn is where a blue would have negative red */
    CHECK_MSG(f.turn <= 0.3, "%s: turned by %g degrees", of->name, f.turn);
    /* per step of 0.09 % of light; with a white point of 1, yellow goes from full colour to white in 0.1 stops */
    CHECK_MSG(f.jump <= (which == 2 ? 0.025 : 0.005), "%s: a step of %g", of->name, f.jump);
    CHECK_MSG(f.fall <= 1e-6, "%s: darker by %g", of->name, f.fall);
    CHECK_MSG(!of->is_warm || kept >= 0.6, "%s: chroma kept %g", of->name, kept);
    CHECK_MSG(!of->is_led || full >= 0.9, "%s: %g of the gamut's chroma", of->name, full);
    frame_free(&in);
    frame_free(&out);
}

/* From grey to a light of the same luminance: no step, not even where gamut handling begins. */
static void check_saturation(const light *of, double display)
{
    frame in = frame_make(STEPS, 1, PUPIL_PIXEL_RGB32F, 0, 0), out = frame_make(STEPS, 1, PUPIL_PIXEL_RGB32F, 0, 0);
    const float *at = frame_writable(&out).data;
    const double l = display / (1 - display), unit = l / luminance_of(0, of->rgb);
    double most = 0;
    for (uint32_t x = 0; x < STEPS; x++) {
        const double t = (double)x / STEPS;
        frame_set(&in, x, 0, l + (of->rgb[0] * unit - l) * t, l + (of->rgb[1] * unit - l) * t,
                  l + (of->rgb[2] * unit - l) * t, 1);
    }
    map(0, &curves[0], &in, &out);
    /* in one loop over all samples gcc 12 for ARM stops with an internal error */
    for (uint32_t x = 1; x < STEPS; x++)
        for (int c = 0; c < 3; c++) {
            const double step = fabs((double)at[3 * x + c] - (double)at[3 * x + c - 3]);
            most = step > most ? step : most;
        }
    CHECK_MSG(most <= 0.01, "%s at %g: a step of %g", of->name, display, most);
    frame_free(&in);
    frame_free(&out);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (unsigned i = 0; i < LIGHTS; i++) {
        for (uint32_t primaries = PUPIL_PRIMARIES_BT709; primaries <= PUPIL_PRIMARIES_BT2020; primaries++)
            for (unsigned which = 0; which < 3; which++)
                check_light(&lights[i], primaries, which);
        for (int n = 1; n < 20; n++)
            check_saturation(&lights[i], n / 20.0);
    }
    return check_end();
}

#include "frame_options.h"

#include <string.h>

#include "key_at.h"
#include "refuse.h"

/* --- values that no kind fits --- */

static int parse_out(const option_value *v)
{
    frame_options *o = v->options;
    if (o->out_count == FRAME_MOST_OUTPUTS)
        return option_refuse(v, "one of at most 16 outputs");
    if (!*v->text)
        return option_refuse(v, "a path");
    o->out[o->out_count++] = v->text;
    return OPTIONS_RUN;
}

static int parse_metering(const option_value *v)
{
    frame_options *o = v->options;
    static const char words[] = "uniform|centre|spot|center"; /* the last is another spelling */
    const int which = option_word(v->text, words);
    if (which < 0)
        return option_refuse(v, NULL);
    if (which == 0)
        pupil_metering_uniform(&o->config);
    else if (which == 2)
        pupil_metering_spot(&o->config);
    else
        pupil_metering_centre(&o->config);
    snprintf(o->metering, sizeof o->metering, "%s", which == 3 ? "centre" : v->text);
    return OPTIONS_RUN;
}

static int parse_roi(const option_value *v)
{
    frame_options *o = v->options;
    double part[4];
    if (option_numbers(v, 4, part))
        return OPTIONS_USAGE;
    if (pupil_metering_roi(&o->config, part[0], part[1], part[2], part[3]))
        return option_refuse(v, NULL);
    snprintf(o->metering, sizeof o->metering, "roi %s", v->text);
    return OPTIONS_RUN;
}

static int parse_trim(const option_value *v)
{
    frame_options *o = v->options;
    double percent[2];
    if (option_numbers(v, 2, percent))
        return OPTIONS_USAGE;
    if (!(percent[0] >= 0.0 && percent[0] < percent[1] && percent[1] <= 100.0))
        return option_refuse(v, NULL);
    o->config.trim_low = (float)(percent[0] / 100.0);
    o->config.trim_high = (float)(percent[1] / 100.0);
    return OPTIONS_RUN;
}

static int parse_floor(const option_value *v)
{
    frame_options *o = v->options;
    double floor;
    if (option_number(v, v->row->low, v->row->high, &floor))
        return OPTIONS_USAGE;
    o->config.floor = (float)floor;
    return OPTIONS_RUN;
}

static int parse_key_at(const option_value *v)
{
    frame_options *o = v->options;
    return key_at_parse(v->text, o->config.key_at, &o->config.key_points) ? option_refuse(v, NULL) : OPTIONS_RUN;
}

static int parse_meter_rows(const option_value *v)
{
    frame_options *o = v->options;
    const int place = option_word(v->text, v->row->value);
    if (place < 0)
        return option_refuse(v, NULL);
    o->config.meter_rows = 1u << place;
    return OPTIONS_RUN;
}

static int parse_histogram_step(const option_value *v)
{
    frame_options *o = v->options;
    const int place = option_word(v->text, v->row->value);
    if (place < 0)
        return option_refuse(v, NULL);
    o->config.histogram_step = place ? 1u << (place - 1) : 0;
    return OPTIONS_RUN;
}

static int parse_white(const option_value *v)
{
    frame_options *o = v->options;
    const int word = option_word(v->text, "follow|none");
    snprintf(o->white, sizeof o->white, "%s", v->text);
    o->config.white_mode = word == 0 ? PUPIL_WHITE_FOLLOW : word == 1 ? PUPIL_WHITE_NONE : PUPIL_WHITE_FIXED;
    return word >= 0 ? OPTIONS_RUN : option_number(v, v->row->low, v->row->high, &o->config.white);
}

/* --- the table --- */

static int parse_eye(const option_value *v)
{
    frame_options *o = v->options;
    o->as_eye = 1;
    return option_number(v, v->row->low, v->row->high, &o->config.eye_unit_cd_m2);
}

#define AT(field) offsetof(frame_options, field)

const option_row frame_output_rows[FRAME_OUTPUT_ROWS] = {
    {"out", 'o', OPTION_PATH, "PATH", 0, .parse = parse_out,
     .help = ".mp4 .mkv .mov .y4m .png .jpg .tif, a folder, - (Y4M); repeatable",
     .more =
         "A name without an extension is a folder of PNG files; .png, .jpg and .tif are one picture. - is YUV4MPEG2 on "
         "standard "
         "output."},
    {"stats", 0, OPTION_PATH, "FILE", AT(stats), .help = "figures of each frame: .jsonl .json .csv (- is JSONL)",
     .more = "Metered and adapted EV, scale, white point, quantiles, shares of black, clipped and bad pixels, display "
             "level, microseconds. docs/stats.md has the fields."},
    {"plot", 0, OPTION_PATH, "FILE", AT(plot), .help = "exposure over time: .svg or .png", .more = "Needs gnuplot."},
};

const option_row frame_exposure_rows[FRAME_EXPOSURE_ROWS] = {
    {"tau-light", 0, OPTION_NUMBER, "S", AT(config.tau_light_s), .initial = "0.3", .high = 1e6, .unit = "seconds",
     .help = "time constant toward more light, seconds", .more = "0 is at once."},
    {"tau-dark", 0, OPTION_NUMBER, "S", AT(config.tau_dark_s), .initial = "0.9", .high = 1e6, .unit = "seconds",
     .help = "time constant toward less light, seconds"},
    {"law", 0, OPTION_CHOICE, "seconds|1|2|3|4|eye", AT(config.law), .initial = "seconds",
     .help = "adaptation: in seconds, a formula, an eye",
     .more = "The field law of pupil_config. 1 to 4 are --formula. eye: --eye 100."},
    {"formula", 0, OPTION_CHOICE, "1|2|3|4", AT(config.law), .low = PUPIL_LAW_ARITHMETIC_SCALE,
     .help = "a formula of the study instead",
     .more = "The four formulas weight each frame, not each second: docs/numerics.md."},
    {"weight", 0, OPTION_NUMBER, "W", AT(config.frame_weight), .initial = "0.05", .low = 0x1p-1022, .high = 1.0,
     .right = "above 0, up to 1", .help = "its weight of each new frame"},
    {"key", 0, OPTION_NUMBER, "K", AT(config.key), .initial = "0.18", .low = 0x1p-10, .high = 1.0,
     .right = "from 0.001 to 1", .help = "mid-grey", .more = "What the log-average luminance is mapped to."},
    {"key-at", 0, OPTION_TEXT, "EV:KEY,...", 0, .parse = parse_key_at, .right = key_at_right,
     .help = "key by scene light",
     .more =
         "So that night stays dark. At most 8 points, EV rising, KEY rising by at most a stop for two of EV. Between "
         "two points the logarithm of the key is linear, beyond them the key is constant. EV is adapted_ev of --stats, "
         "and scene_ev of pupil run --mode sensor; docs/sensor.md gives it in lux."},
    {"ev", 0, OPTION_NUMBER, "STOPS", AT(config.ev_compensation), .initial = "0", .low = -16.0, .high = 16.0,
     .unit = "stops", .help = "exposure compensation", .more = "Positive is brighter."},
    {"highlights", 0, OPTION_NUMBER, "STOPS", AT(config.highlight_ev), .initial = "2", .high = 8.0, .unit = "stops",
     .help = "darken at most by this",
     .more = "0: not at all. Where more than 5 % of the frame is over 4 stops brighter than its log-average, the "
             "picture is darker by "
             "what is missing, at most so much: a lamp in a dark room, a lit meadow behind a tree."},
    {"lock", 0, OPTION_FLAG, NULL, AT(config.lock), .help = "hold the first level"},
    {"amplification", 0, OPTION_NUMBER, "STOPS", AT(config.amplification_ev), .initial = "4", .high = 32.0,
     .unit = "stops", .help = "brighten at most by this",
     .more = "Frames of 8 to 16 bits, so that noise remains dark, as behind a lens cap. Formats finer than 12 bits of "
             "linear light are brightened by as many stops more; float and half are not limited."},
    {"floor", 0, OPTION_NUMBER, "L", 0, .initial = "6.1e-5", .low = 0x1p-30, .high = 1.0, .right = "from 9.4e-10 to 1",
     .parse = parse_floor, .help = "least light",
     .more =
         "In the input's units; of float input that is far too dark or bright, after its scale (docs/pictures.md)."},
    {"metering", 0, OPTION_CHOICE, "uniform|centre|spot", 0, .initial = "uniform", .parse = parse_metering,
     .help = "which part of the frame counts most"},
    {"roi", 0, OPTION_TEXT, "X,Y,W,H", 0,
     .right = "X,Y,WIDTH,HEIGHT in fractions of the frame, for example 0.25,0.25,0.5,0.5", .parse = parse_roi,
     .help = "meter only this part, in fractions of the frame", .more = "In place of --metering: the last one counts."},
    {"trim", 0, OPTION_TEXT, "LOW,HIGH", 0,
     .right = "LOW,HIGH in per cent, for example 5,95, with 0 <= LOW < HIGH <= 100", .parse = parse_trim,
     .help = "leave out the darkest and the brightest, per cent: 5,95",
     .more = "The mean is then that of the pixels between the two quantiles."},
    {"meter-rows", 0, OPTION_CHOICE, "1|2|4|8", 0, .initial = "1", .parse = parse_meter_rows,
     .help = "meter one of each N rows", .more = "Another row of them in each frame. For machines that are too slow."},
    {"eye", 0, OPTION_NUMBER, "CD_M2", 0, .parse = parse_eye, .low = 1e-6, .high = 1e9,
     .right = "cd/m2 of light of 1, from 1e-6 to 1e9", .help = "adapt like an eye",
     .more = "CD_M2 is the luminance of light of 1. Cones and rods with their own times, bleached pigments that take "
             "minutes in the dark, and colours that "
             "fade at night: docs/numerics.md. 100 for PQ."},
    {"accuracy", 0, OPTION_CHOICE, "exact|luma", AT(config.accuracy), .initial = "exact",
     .help = "luma: 8-bit Y'CbCr for small boards",
     .more =
         "luma: meters some of the pixels, and maps to NV12, I420, RGBA8 and BGRX8 by tables of luma. Other formats "
         "are exact. docs/numerics.md has the errors."},
    {"histogram-step", 0, OPTION_CHOICE, "auto|1|2|4|8", 0, .initial = "auto", .parse = parse_histogram_step,
     .help = "count one pixel of each 2N x N",
     .more = "For the white point, quantiles, --trim, --highlights and --tone. auto: 4 for 1920x1080, 8 for 3840x2160, "
             "1 for small frames. 1 is exact. The log-average always counts all pixels."},
};

const option_row frame_mapping_rows[FRAME_MAPPING_ROWS] = {
    {"white", 0, OPTION_TEXT, "W", 0, .initial = "follow", .low = 0x1p-8, .high = 0x1p30,
     .right = "follow, none, or a number from 0.0039 to 1e9", .parse = parse_white,
     .help = "white point: follow, none, or a number",
     .more = "follow: the white point follows the 99.5 % quantile of the frame, never below 1. none: Reinhard's global "
             "operator. A number: a fixed white point in units of scaled luminance."},
    {"tone", 0, OPTION_CHOICE, "reinhard|normalise|quantise|equalise|adjust", AT(config.curve), .initial = "reinhard",
     .help = "curve",
     .more =
         "reinhard: by the level and the white point. The others are made from the histogram. normalise: the picture's "
         "darkest and brightest 0.5 % become black and white. quantise: 8 levels. equalise: "
         "all "
         "codes equally frequent. adjust: a range of light that is too large for the display is fitted into it where "
         "light is rare, and no contrast is above the scene's (Ward Larson et al. 1997). Each follows the light in "
         "time "
         "as the level does. docs/look.md shows them."},
    {"transfer", 0, OPTION_CHOICE, "srgb|gamma22|linear", AT(config.transfer), .initial = "srgb",
     .help = "display encoding"},
    {"output-primaries", 0, OPTION_CHOICE, "input|bt709|bt2020", AT(config.output_primaries), .initial = "bt709",
     .help = "the picture's primaries",
     .more =
         "Where the input has others, its colours are converted after metering. Components below 0, of colours that "
         "these primaries cannot show, become 0. input: not converted. .mp4, .mkv, .mov and .png say which they have; "
         "the other outputs do not."},
    {"fused", 0, OPTION_FLAG, NULL, AT(config.order),
     .help = "map with the state before the frame: one pass, one frame late",
     .more = "Each frame is mapped while it is metered."},
    {"gles", 0, OPTION_FLAG, NULL, AT(gles), .help = "on the GPU, or else on the CPU",
     .more =
         "OpenGL ES 3.1 or 3.0, without a window. The outputs are the CPU's within one display code. Where the GPU is "
         "missing or fails, a sentence says why, and the CPU continues from the same level. Every row is metered, "
         "with any --meter-rows."},
    {"gles-version", 0, OPTION_CHOICE, "3.0|3.1", AT(gles_version), .low = PUPIL_GLES_ES30, .help = "of GLES",
     .more =
         "Without it, the best there is. In 3.0 the histogram counts one of each four rows, or of --meter-rows; a GPU "
         "without GL_EXT_color_buffer_half_float needs --white none or a number there, and no --trim or --tone."},
    {"threads", 0, OPTION_COUNT32, "N", AT(threads), .initial = "0", .high = 256,
     .help = "worker threads, 0: one a processor", .more = "The result has the same bits with any number."},
    {"dither", 0, OPTION_CHOICE, "off|on", AT(dither), .low = 1, .help = "of 8 bits",
     .more =
         "Ordered dither of 8 x 8 pixels, so that smooth ramps show no bands. Without this option it is on in windows "
         "and where every --out is a video, but not with --report, which measures codes."},
};

_Static_assert(PUPIL_CURVE_NORMALISE == 1 && PUPIL_CURVE_COUNT == 5 && PUPIL_ORDER_FUSED == 1 &&
                   PUPIL_TRANSFER_SRGB == 0 && PUPIL_TRANSFER_LINEAR == 2 && PUPIL_OUTPUT_AS_INPUT == 0 &&
                   PUPIL_GLES_ES31 == PUPIL_GLES_ES30 + 1 &&
                   PUPIL_LAW_GEOMETRIC_LUMINANCE == PUPIL_LAW_ARITHMETIC_SCALE + 3,
               "a flag sets 1, and a choice its first value and its place");

/* --- the rest --- */

void frame_options_begin(frame_options *o)
{
    *o = (frame_options){.hold = 1, .metering = "uniform", .white = "follow"};
    pupil_config_default(&o->config);
    pupil_veil_config_default(&o->eye);
    o->config.output_primaries = PUPIL_OUTPUT_BT709;
    o->config.histogram = 1; /* every record has quantiles, and the sensor's controller sees highlights */
}

static int is_video(const char *path)
{
    static const char *const ends[] = {".mp4", ".mkv", ".mov", ".y4m"};
    const size_t length = strlen(path);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (length > 4 && strcmp(path + length - 4, ends[i]) == 0)
            return 1;
    return strcmp(path, "-") == 0 || strncmp(path, "/dev/", 5) == 0;
}

/* Outputs viewed in motion are dithered; outputs that may be measured, not. */
static int wants_dither(const frame_options *o)
{
    for (size_t i = 0; i < o->out_count; i++)
        if (!is_video(o->out[i]))
            return 0;
    return !o->report && (o->view || o->out_count);
}

int frame_options_check(frame_options *o, int weight_given, int key_given, pupil_why *why)
{
    pupil_config usual;
    pupil_config_default(&usual);
    o->source.threads = o->threads;
    if (o->as_eye && o->config.law != PUPIL_LAW_SECONDS && o->config.law != PUPIL_LAW_EYE)
        return pupil_refuse(why, "--eye and --formula: one of them");
    o->config.law = o->as_eye ? PUPIL_LAW_EYE : o->config.law;
    if (o->config.law == PUPIL_LAW_EYE &&
        (weight_given || o->config.tau_light_s != usual.tau_light_s || o->config.tau_dark_s != usual.tau_dark_s))
        return pupil_refuse(why, "--tau-light, --tau-dark, --weight: not with --eye, whose times are its own");
    if (weight_given && o->config.law == PUPIL_LAW_SECONDS)
        return pupil_refuse(why,
                            "--weight: is how much each new frame counts, of --formula 1 to 4; the default law has "
                            "--tau-light and --tau-dark instead");
    if (key_given && o->config.key_points)
        return pupil_refuse(why, "--key and --key-at: one of them; --key is the same in any light");
    if (o->gles_version && !o->gles && !o->view)
        return pupil_refuse(why, "--gles-version: needs --gles or --view");
    if (o->dither == 2 && o->report)
        return pupil_refuse(why, "--dither on: a report measures codes without it");
    o->config.dither = o->dither ? o->dither == 2 : wants_dither(o);
    return OPTIONS_RUN;
}

#include "options.h"

#include <string.h>
#include <unistd.h>

#include "options/commands.h"
#include "options/veil_option.h"
#include "refuse.h"

#define AT(field) offsetof(frame_options, field)

static const option_row output_rows[] = {
    {"report", 0, OPTION_PATH, "DIR", AT(report), .help = "a page with the video, the plot and the figures",
     .more = "DIR/index.html, with a strip of frames and the settings. Its plot needs gnuplot."},
    {"view", 0, OPTION_FLAG, NULL, AT(view), .help = "a window; h shows its keys",
     .more = "At the source's pace. Mapped by the GPU, or by the CPU where there is none. Keys: 1 to 4 the study's "
             "formulas, 0 the law in seconds, [ and ] faster and slower, - and + compensation by 1/3 stop, l lock, s "
             "split screen (left and right move it), p plot of the level, space pause, f full screen, h help, q quit."},
    {"loop", 0, OPTION_FLAG, NULL, AT(loop), .help = "then start again",
     .more = "Without it the last frame stays until q is pressed, unless something is written or --frames is given."},
    {"overwrite", 'y', OPTION_FLAG, NULL, AT(overwrite), .help = "replace outputs that are there",
     .more = "Without it they are kept, and the run is refused. A folder is replaced only where pupil made it."},
};

static const option_row frame_rows[] = {
    {"fps", 0, OPTION_NUMBER, "N", AT(source.fps), .low = 0.001, .high = 1e5, .unit = "frames a second",
     .help = "of stills, raw, pan and synth (30)", .more = "Of a camera: one of its frame rates."},
    {"size", 0, OPTION_SIZE, "WxH", AT(source.width), .high = PUPIL_MAX_SIDE_PX, .help = "of pan, synth and cameras"},
    {"frames", 'n', OPTION_COUNT, "N", AT(most), .low = 1, .high = 0x1p40, .unit = "a whole number of frames",
     .help = "at most N frames"},
    {"ss", 0, OPTION_TIME, "TIME", AT(start_s), .high = 1e9, .unit_s = 1.0, .right = "seconds, 500ms, 2min or 00:01:30",
     .help = "begin there: 12.5 (s), 500ms, 00:01:30",
     .more = "Of the input's time, as in ffmpeg; -ss is the same. Frames before are left out, and adaptation begins "
             "there."},
    {"duration", 't', OPTION_TIME, "TIME", AT(duration_s), .low = 1e-6, .high = 1e9, .unit_s = 1.0,
     .right = "seconds above 0, 500ms, 2min or 00:01:30", .help = "only this much: 2min"},
    {"hold", 0, OPTION_COUNT, "N", AT(hold), .initial = "1", .low = 1, .high = 1e6, .help = "show each frame N times",
     .more = "Each time one frame period later."},
    {"keep-going", 0, OPTION_FLAG, NULL, AT(keep_going), .help = "skip bad frames",
     .more = "Damaged and missing ones. They are counted, and the exit status is 3."},
    {"reset-each", 0, OPTION_FLAG, NULL, AT(reset_each), .help = "adapt to each input frame alone",
     .more = "For unrelated pictures. -o FOLDER then has them by the names of the stills, each of its own size."},
    {"max-pixels", 0, OPTION_COUNT, "N", AT(source.max_pixels), .low = 1, .high = 0x1p26, .unit = "a number of pixels",
     .help = "largest frame",
     .more =
         "Frames of more pixels are refused. 67108864 (8192x8192) by default, of stills of over 4194304 pixels at most "
         "256 for each byte of the file: a small file cannot take much memory. A number given here counts alone."},
    {"explain", 0, OPTION_COUNT, "N", AT(explain), .high = 0x1p40, .unit = "a frame's number",
     .help = "why frame N is as bright as it is, in words",
     .more =
         "N counts from 0, as in --stats. What was metered, what holds the level, what clips, and which option changes "
         "it, on standard output. Without outputs the run ends there."},
    {"no-rotate", 0, OPTION_FLAG, NULL, AT(source.as_stored), .help = "frames as they are stored",
     .more = "Not turned upright, which phones leave to the player."},
    {"seed", 0, OPTION_COUNT, "N", AT(source.seed), .low = 1, .high = 0x1p64, .help = "for a pan's default path"},
};

static int parse_veil(const option_value *v)
{
    frame_options *o = v->options;
    o->veil = v->text;
    return veil_option_parse(v->text, &o->eye, v->why) ? OPTIONS_USAGE : OPTIONS_RUN;
}

static const char compare_right[] = "two settings in quotes, such as \"\" \"--key 0.3\" (\"\": as it is)";

static const option_row look_rows[] = {
    {"veil", 0, OPTION_PATH, "EYE", 0, .parse = parse_veil, .help = "veiling glare: eye, eye:AGE or a FILE",
     .more =
         "Light that scatters in an eye and lifts the dark parts of the whole picture. eye: Spencer 1995. eye:AGE: CIE "
         "146:2002 at that age in years. FILE: a line for each Gaussian, its standard deviation in degrees and its "
         "share "
         "of the light. Not for pictures of a camera, whose lens has put its own in: docs/look.md."},
    {"fov", 0, OPTION_NUMBER, "DEGREES", AT(eye.fov_deg), .initial = "54", .low = 0.1, .high = 150, .unit = "degrees",
     .help = "horizontal field of view"},
    {"bloom", 0, OPTION_FLAG, NULL, AT(bloom), .help = "also the glow around lamps",
     .more = "The narrow part of what --veil names, which is the glow around lights: with it the picture has the whole "
             "point "
             "spread function. A FILE of narrow Gaussians alone is a bloom without a veil. By the CPU."},
    {"bloom-above", 0, OPTION_NUMBER, "LIGHT", AT(bloom_above), .initial = "0", .low = 0, .high = 0x1p30,
     .unit = "light in the frames' unit", .help = "with --bloom: only light above this glows",
     .more = "Of a pixel whose largest channel is m, the share of light above LIGHT scatters: (m - LIGHT) / m."},
};

static const option_row compare_rows[] = {
    {"compare", 0, OPTION_PAIR, "A B", AT(compare), .right = compare_right,
     .help = "two settings side by side: --compare \"\" \"--key 0.3\"",
     .more =
         "A and B are options of exposure, mapping and look, each in quotes; \"\" is none. They add to those outside "
         "of the quotes, and are written into the picture: A on the left, B on the right. Of pictures and videos."},
};

static const option_row quiet_row[] = {OPTION_ROW_QUIET(frame_options, quiet)};

static const option_group groups[] = {
    {"outputs (complete or absent)", OPTION_ROWS(frame_output_rows)},
    {NULL, OPTION_ROWS(output_rows)},
    {"frames", OPTION_ROWS(frame_rows)},
    {"exposure", OPTION_ROWS(frame_exposure_rows)},
    {"mapping", OPTION_ROWS(frame_mapping_rows)},
    {"look", OPTION_ROWS(look_rows)},
    {NULL, OPTION_ROWS(compare_rows)},
    {NULL, OPTION_ROWS(quiet_row)},
    {0},
};

const option_command replay_command = {
    .name = "replay",
    .summary = "recorded HDR frames to a display video, with a record of the exposure",
    .usage = "INPUT... [options]",
    .about = "Adapts recorded HDR frames; writes a display video and what the exposure did.\n"
             "  INPUT  .exr .hdr .pfm .png .jpg .tif, a folder, a 'glob*', a video, - (stdin),\n"
             "         pan:PANORAMA[,key=value...], synth:walk, synth:room, ...,\n"
             "         raw:FILE,format=RG10,size=WxH[,key=value...], synth:RECIPE.scene,\n"
             "         v4l2:CAMERA (a path, a number, a name), libcamera:CAMERA",
    .exits = "0 done, 1 failed, 2 usage, 3 done but frames were skipped, 130 interrupted",
    .manual =
        "Recorded HDR frames are metered, adapted to over time, and mapped by Reinhard's operator. Without options "
        "the picture follows the light as the eye does: faster toward light than toward dark, in seconds, at any "
        "frame rate.\n\n"
        "raw:FILE is a file of frames without a header, or a folder of them: pRAA, pRCC, RG10, GREY, YUYV, NV12 and "
        "V4L2's "
        "other formats. Keys: format, size, stride and skip (bytes), black and white (codes), shift (bits), balance "
        "(auto, off, R/G/B), matrix (nine numbers with /), knees (CODE:LIGHT/...).\n\n"
        "Every output is written under a temporary name and renamed when it is complete. After an error there is no "
        "output. Ctrl-C keeps the frames so far; a second Ctrl-C discards them.",
    .groups = groups,
};

/* What --loop requires of the other options. */
static int check_loop(const frame_options *o, pupil_why *why)
{
    if (o->loop && !o->view)
        return pupil_refuse(why, "--loop: needs --view; --hold writes frames several times");
    for (size_t i = 0; o->loop && i < o->input_count; i++)
        if (strcmp(o->inputs[i], "-") == 0)
            return pupil_refuse(why, "--loop: standard input cannot be read again; name a file");
    return 0;
}

/* What --veil and --bloom require of the other options. */
static int check_veil(const frame_options *o, int fov_given, pupil_why *why)
{
    if (fov_given && !o->veil)
        return pupil_refuse(why, "--fov: needs --veil");
    if (o->bloom && !o->veil)
        return pupil_refuse(why, "--bloom: needs --veil, which names the point spread function: --veil eye --bloom");
    if (o->bloom_above > 0 && !o->bloom)
        return pupil_refuse(why, "--bloom-above: needs --bloom");
    if (o->bloom && o->gles)
        return pupil_refuse(why, "--bloom and --gles: one of them; the CPU maps frames with a bloom");
    if (o->veil && o->config.order == PUPIL_ORDER_FUSED)
        return pupil_refuse(why, "--veil and --fused: one of them; a frame's veil is known only after all of it");
    return 0;
}

/* Accepts the names that people know from ffmpeg. */
static void spell_out(int argc, char **argv)
{
    static char start[] = "--ss";
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], "-ss") == 0)
            argv[i] = start;
}

/* Checks options that act only on the default law, or only on video. */
static int check_acting(const frame_options *o, const option_words *words, pupil_why *why)
{
    static const char *const of_seconds[] = {"tau-light", "tau-dark"};
    for (size_t i = 0; i < sizeof of_seconds / sizeof of_seconds[0]; i++)
        if (o->config.law != PUPIL_LAW_SECONDS && options_given(&replay_command, words, of_seconds[i]))
            return pupil_refuse(why, "--%s: belongs to the default law; --formula 1 to 4 have --weight instead",
                                of_seconds[i]);
    if (o->hold > 1 && (o->start_s > 0.0 || o->duration_s > 0.0))
        return pupil_refuse(why,
                            "--hold: gives frames other times than the input has, by which -ss and -t choose them");
    return 0;
}

/* Without outputs nothing is left to do after that frame. */
static int check_explain(frame_options *o, pupil_why *why)
{
    int taken = o->stats && strcmp(o->stats, "-") == 0;
    if (!o->explains)
        return 0;
    for (size_t i = 0; i < o->out_count; i++)
        taken |= strcmp(o->out[i], "-") == 0;
    if (taken)
        return pupil_refuse(why, "--explain: is said on standard output, which -o - or --stats - has taken");
    if (o->most && o->explain >= o->most)
        return pupil_refuse(why, "--explain %llu: frames count from 0, and -n ends the run before",
                            (unsigned long long)o->explain);
    if (!o->out_count && !o->stats && !o->plot && !o->report && !o->view && !o->most)
        o->most = o->explain + 1;
    return 0;
}

/* --- --compare --- */

static int is_among(const option_row *row, const option_row *rows, size_t count)
{
    return row >= rows && row < rows + count;
}

/* Whether the two pictures can have different values: not for options of the file or the machine. */
static int is_of_side(const option_row *row)
{
    static const char *const of_run[] = {"transfer", "output-primaries", "gles", "gles-version", "threads", "dither"};
    for (size_t i = 0; i < sizeof of_run / sizeof *of_run; i++)
        if (strcmp(row->name, of_run[i]) == 0)
            return 0;
    return is_among(row, frame_exposure_rows, FRAME_EXPOSURE_ROWS) ||
           is_among(row, frame_mapping_rows, FRAME_MAPPING_ROWS) ||
           is_among(row, look_rows, sizeof look_rows / sizeof *look_rows);
}

/* Whether an option outside the quotes changes both sides. */
static int is_changed(const option_words *words)
{
    const option_row *row;
    size_t base;
    for (size_t n = 0; (row = options_row(&replay_command, n, &base)); n++)
        if (words->given[n / 64] >> n % 64 & 1 && is_of_side(row))
            return 1;
    return 0;
}

static int check_side(const option_words *words, pupil_why *why)
{
    const option_row *row;
    size_t base;
    if (words->count)
        return pupil_refuse(why, "must be %s", compare_right);
    for (size_t n = 0; (row = options_row(&replay_command, n, &base)); n++)
        if (words->given[n / 64] >> n % 64 & 1 && !is_of_side(row))
            return pupil_refuse(why, "--%s is of both: outside of the quotes", row->name);
    return 0;
}

/* An option of a side replaces options that exclude it. */
static void replace_others(frame_options *o, const option_words *words)
{
    if (options_given(&replay_command, words, "key") && !options_given(&replay_command, words, "key-at"))
        o->config.key_points = 0;
    if ((options_given(&replay_command, words, "law") || options_given(&replay_command, words, "formula")) &&
        !options_given(&replay_command, words, "eye"))
        o->as_eye = 0;
}

static int parse_side(replay_side *side, char **argv, int argc, pupil_why *why)
{
    option_words words;
    frame_options *o = &side->options;
    const int parsed = options_parse(&replay_command, o, argc, argv, &words, why);
    if (parsed == OPTIONS_USAGE || check_side(&words, why))
        return OPTIONS_USAGE;
    replace_others(o, &words);
    if (check_acting(o, &words, why) || check_veil(o, options_given(&replay_command, &words, "fov"), why))
        return OPTIONS_USAGE;
    return frame_options_check(o, options_given(&replay_command, &words, "weight"),
                               options_given(&replay_command, &words, "key"), why);
}

int replay_options_side(const frame_options *options, int which, replay_side *side, pupil_why *why)
{
    static char name[] = "replay";
    const char *text = options->compare[which];
    char *argv[sizeof side->words / 2 + 2] = {name}; /* a word and a space are at least two characters */
    int argc = 1;
    pupil_why words;
    side->options = *options;
    side->label = *text ? text : options->compare_plain;
    if (strlen(text) >= sizeof side->words)
        return pupil_refuse(why, "--compare: a setting of over %zu characters", sizeof side->words - 1);
    strcpy(side->words, text);
    for (char *word = strtok(side->words, " "); word; word = strtok(NULL, " ")) {
        if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
            return pupil_refuse(why, "--compare \"%s\": must be %s", text, compare_right);
        argv[argc++] = word;
    }
    if (!parse_side(side, argv, argc, &words))
        return OPTIONS_RUN;
    const int is_next = *text == '-' && !strpbrk(text, " ="); /* perhaps the next option of the line */
    return pupil_refuse(why, "--compare \"%s\": %s%s%s", text, words.text, is_next ? "; it takes " : "",
                        is_next ? compare_right : "");
}

/* Refuses options that show or measure a single picture. */
static int check_compare(const frame_options *o, pupil_why *why)
{
    static replay_side unused;
    const char *alone = o->stats      ? "--stats"
                        : o->plot     ? "--plot"
                        : o->report   ? "--report"
                        : o->view     ? "--view"
                        : o->gles     ? "--gles"
                        : o->explains ? "--explain"
                                      : NULL;
    if (!o->compare[0])
        return 0;
    if (alone)
        return pupil_refuse(why, "--compare: makes pictures and videos; %s is of one setting", alone);
    if (replay_options_side(o, 0, &unused, why) || replay_options_side(o, 1, &unused, why))
        return -1;
    return o->out_count ? 0 : pupil_refuse(why, "--compare: -o out.mp4 or another output is missing");
}

/* Refuses an output among the inputs: pupil replay in.mp4 out.mp4. */
static int check_inputs(const frame_options *o, pupil_why *why)
{
    const char *last = o->input_count == 2 ? o->inputs[1] : NULL;
    if (last && !strpbrk(last, "*?[%:") && access(o->inputs[0], F_OK) == 0 && access(last, F_OK) != 0)
        return pupil_refuse(why, "%s: there is no such file; if it is the output: pupil replay %s -o %s", last,
                            o->inputs[0], last);
    return 0;
}

int replay_options_parse(frame_options *o, int argc, char **argv, pupil_why *why)
{
    option_words words;
    frame_options_begin(o);
    spell_out(argc, argv);
    const int parsed = options_parse(&replay_command, o, argc, argv, &words, why);
    if (parsed)
        return parsed;
    o->inputs = (const char *const *)words.word;
    o->input_count = (size_t)words.count;
    if (!o->input_count)
        return pupil_refuse(why, "no input: name an HDR file, a folder, a video or synth:walk; 'pupil replay --help' "
                                 "has more");
    o->explains = options_given(&replay_command, &words, "explain");
    if (check_inputs(o, why) || check_explain(o, why) || check_loop(o, why) || check_acting(o, &words, why) ||
        check_veil(o, options_given(&replay_command, &words, "fov"), why))
        return OPTIONS_USAGE;
    if (frame_options_check(o, options_given(&replay_command, &words, "weight"),
                            options_given(&replay_command, &words, "key"), why))
        return OPTIONS_USAGE;
    o->compare_plain = is_changed(&words) ? "as given" : "default";
    return check_compare(o, why) ? OPTIONS_USAGE : OPTIONS_RUN;
}

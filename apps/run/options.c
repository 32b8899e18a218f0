#include "options.h"

#include <math.h>
#include <string.h>

#include "options/colour_options.h"
#include "options/commands.h"
#include "refuse.h"
#include "several.h"
#include "v4l2/format.h"

/* --- values that no kind fits --- */

static int parse_format(const option_value *v)
{
    run_options *r = v->options;
    r->live.capture.fourcc = pupil_v4l2_fourcc(v->text);
    return r->live.capture.fourcc ? OPTIONS_RUN : option_refuse(v, NULL);
}

static int parse_mains(const option_value *v)
{
    static const uint32_t hz[] = {0, 50, 60, 0};
    run_options *r = v->options;
    const int place = option_word(v->text, v->row->value);
    if (place < 0)
        return option_refuse(v, NULL);
    r->live.mains_hz = hz[place];
    r->mains_off = strcmp(v->text, "off") == 0;
    return OPTIONS_RUN;
}

/* Light flickers twice in a period of the mains. */
static int parse_period(const option_value *v)
{
    run_options *r = v->options;
    double s = 0.0;
    if (option_time(v, v->row->low, v->row->high, &s))
        return OPTIONS_USAGE;
    r->live.mains_hz = fabs(s - 0.01) < 1e-5 ? 50 : fabs(s - 1.0 / 120.0) < 1e-5 ? 60 : 0;
    return r->live.mains_hz ? OPTIONS_RUN : option_refuse(v, NULL);
}

/* --device: the first or only one, and the list of all. */
static int parse_device(const option_value *v)
{
    run_options *r = v->options;
    if (!*v->text)
        return option_refuse(v, NULL);
    if (r->devices == RUN_MOST_CAMERAS)
        return pupil_refuse(v->why, "--device %s: at most %d cameras", v->text, RUN_MOST_CAMERAS);
    r->device_name[r->devices++] = v->text;
    r->device = v->text;
    return OPTIONS_RUN;
}

static int parse_camera_ev(const option_value *v)
{
    run_options *r = v->options;
    int count = 1;
    for (const char *c = v->text; *c; c++)
        count += *c == ',';
    if (count >= RUN_MOST_CAMERAS)
        return option_refuse(v, NULL);
    if (option_numbers(v, count, r->camera_ev))
        return OPTIONS_USAGE;
    for (int i = 0; i < count; i++)
        if (!(fabs(r->camera_ev[i]) <= 16.0))
            return option_refuse(v, NULL);
    r->camera_evs = (uint32_t)count;
    return OPTIONS_RUN;
}

static int parse_resume(const option_value *v)
{
    return strcmp(v->text, "-") == 0 ? option_refuse(v, "a file") : option_take(v);
}

/* NIGHT,DAY,SECONDS */
static int parse_day_night(const option_value *v)
{
    run_options *r = v->options;
    double x[3];
    if (option_numbers(v, 3, x))
        return OPTIONS_USAGE;
    if (!(x[0] >= -64.0 && x[0] <= x[1] && x[1] <= 64.0 && x[2] > 0.0 && x[2] <= 1e6))
        return option_refuse(v, NULL);
    r->night_ev = x[0];
    r->day_ev = x[1];
    r->day_night_s = x[2];
    return OPTIONS_RUN;
}

/* --- the table --- */

#define AT(field) offsetof(run_options, field)

const option_row run_device_rows[RUN_DEVICE_ROWS] = {
    {"device", 'd', OPTION_PATH, "CAMERA", AT(device), .parse = parse_device,
     .right = "a path, a number, a camera's name or libcamera:ID",
     .more = "pupil run takes several, which share one exposure (--camera-ev).",
     .help = "path, number, name, libcamera:ID (the first: 'pupil list')"},
};

const option_row run_request_rows[RUN_REQUEST_ROWS] = {
    {"width", 0, OPTION_COUNT32, "N", AT(shown.source.width), .low = 1, .high = PUPIL_MAX_SIDE_PX, .unit = "pixels",
     .help = "picture width"},
    {"height", 0, OPTION_COUNT32, "N", AT(shown.source.height), .low = 1, .high = PUPIL_MAX_SIDE_PX, .unit = "pixels",
     .help = "picture height"},
    {"framerate", 0, OPTION_NUMBER, "N", AT(shown.source.fps), .low = 0.001, .high = 1e5, .unit = "frames a second",
     .help = "frames a second"},
    {"fps", 0, OPTION_NUMBER, "N", AT(shown.source.fps), .low = 0.001, .high = 1e5, .unit = "frames a second",
     .help = "the same"},
    {"format", 0, OPTION_TEXT, "FOURCC", 0, .parse = parse_format,
     .right = "a format's name of up to four letters, as 'pupil list' shows them: YUYV, NV12",
     .help = "pixel format: YUYV, NV12, RG10"},
};

const option_row run_manual_rows[RUN_MANUAL_ROWS] = {
    {"shutter", 0, OPTION_TIME, "TIME", AT(exposure_s), .low = 1e-6, .high = 1000.0, .unit_s = 1e-6,
     .right = "a time: 10ms, 1/100, 0.01s, or a plain number of microseconds, from 1us to 1000s",
     .help = "manual exposure time: 10ms, 1/100, 10000 (us)"},
    {"gain", 0, OPTION_NUMBER, "FACTOR", AT(gain), .low = 0x1p-10, .high = 65536.0,
     .right = "a factor from 0.001 to 65536; 1 is no gain", .help = "manual gain, 1 is none"},
};

const option_row run_end_rows[RUN_END_ROWS] = {
    {"frames", 'n', OPTION_COUNT, "N", AT(shown.most), .low = 1, .high = 0x1p40, .unit = "a whole number of frames",
     .help = "at most N frames"},
    {"timeout", 't', OPTION_TIME, "TIME", AT(seconds), .low = 1e-3, .high = 1e9, .unit_s = 1.0,
     .right = "seconds above 0, or 500ms, 10min", .help = "run this long: 10 (s), 500ms, 10min"},
};

static const option_row mode_rows[] = {
    {"mode", 0, OPTION_CHOICE, "digital|sensor|both", AT(mode),
     .help = "digital: the picture adapts; sensor: exposure and gain are controlled; both (both; digital if there "
             "are no controls)",
     .more = "digital: no control is touched but those of --shutter and --gain. sensor: the picture is the camera's, "
             "without tone curve and adaptation; only a factor hides the steps of the exposure. both: the exposure is "
             "set to what is best for the sensor, "
             "and the picture adapts to the light that the frames show. A step of the exposure is not visible."},
};

static const option_row request_rows[] = {
    {"size", 0, OPTION_SIZE, "WxH", AT(shown.source.width), .high = PUPIL_MAX_SIDE_PX, .help = "both sides at once"},
    {"buffers", 0, OPTION_COUNT32, "N", AT(live.capture.buffers), .low = 2, .high = PUPIL_V4L2_MOST_BUFFERS,
     .help = "buffers in the kernel's queue (4)"},
};

static const option_row control_rows[] = {
    {"mains", 0, OPTION_CHOICE, "auto|50|60|off", 0, .parse = parse_mains, .initial = "auto",
     .help = "anti-flicker for this mains frequency",
     .more =
         "Exposure times are multiples of half a mains period, so that lamps leave no bands. auto: the frequency is "
         "found from bands in the frames, once there are any."},
    {"flicker-period", 0, OPTION_TIME, "TIME", 0, .parse = parse_period, .low = 8e-3, .high = 1.1e-2, .unit_s = 1e-6,
     .right = "10000us (mains of 50 Hz) or 8333us (60 Hz); a plain number is microseconds",
     .help = "the same by its period: 10000us or 8333us"},
    {"row-gains", 0, OPTION_FLAG, NULL, AT(row_gains),
     .help = "correct flicker bands row by row, in exposures below a period",
     .more = "In exposures below 10 ms (50 Hz) or 8.3 ms (60 Hz) lamps leave bands; exposures are that short in bright "
             "light or by --shutter. The CPU corrects them. Frames that are clipped or partly lit by daylight are left "
             "as they are. A daylit area below a tenth of an eighth of the picture's width and height is not detected "
             "and would get bands, so this is an option. With --mains auto the frequency is found first; --mode "
             "digital needs 50 or 60. The last line says how many frames were corrected, and why the last one was not. "
             "Not with --gles or --fused."},
    {"readout", 0, OPTION_TIME, "MS", AT(readout_s), .low = 1e-4, .high = 1.0, .unit_s = 1e-3,
     .right = "25ms, or a plain number of milliseconds, from 0.1 to 1000",
     .help = "for --row-gains: time from first row to last (the driver's)",
     .more = "Within a tenth. The driver's is from PIXEL_RATE and HBLANK, which webcams do not have. Then it is the "
             "number of lines times the line time of the sensor's data sheet, at most the frame period at the fastest "
             "rate."},
    {"shutter-max", 0, OPTION_TIME, "TIME", AT(exposure_max_s), .low = 1e-6, .high = 1000.0, .unit_s = 1e-6,
     .right = "a time: 10ms, 1/100, 0.01s, or a plain number of microseconds, from 1us to 1000s",
     .help = "longest exposure"},
    {"gain-max", 0, OPTION_NUMBER, "FACTOR", AT(gain_max), .low = 0x1p-10, .high = 65536.0,
     .right = "a factor from 0.001 to 65536; 1 is no gain", .help = "largest gain"},
    {"control", 0, OPTION_PATH, "SOCKET", AT(control), .help = "for 'pupil ctl SOCKET'",
     .more = "A Unix socket of mode 0600. Each line is a command, each answer a line of JSON, between frames. pupil "
             "ctl --help has the commands. The socket is removed at the end."},
    {"day-night", 0, OPTION_TEXT, "EV,EV,S", 0, .parse = parse_day_night,
     .right = "two EV of scene light from -64 to 64, night's first, and seconds above 0, for example -3,-1.5,10",
     .help = "detect night and day",
     .more = "Night begins after S seconds below the first EV, day after S seconds above the second. EV is the light "
             "of the scene (scene_ev of --stats), without filters that were announced (pupil ctl). Each change is a "
             "line on standard error; --stats has it for each frame, pupil ctl in its status."},
    {"camera-ev", 0, OPTION_TEXT, "EV,...", 0, .parse = parse_camera_ev,
     .right = "stops from -16 to 16, one for each camera after the first, at most 7",
     .help = "by how many stops the other cameras are more sensitive",
     .more = "With several --device, which share one exposure. The first camera leads: its frames decide. The others "
             "follow with its exposure time times gain, less these stops, each split by its own limits and steps, and "
             "in --mode both with its adaptation. The leader stays within what all cameras can do. %i in the names of "
             "outputs is the camera's number, from 0. A camera that is lost ends its own outputs; the next one then "
             "leads. --control is the first camera's. The last line of each camera says how much more light it saw "
             "than the leader."},
    {"no-frame-rate-priority", 0, OPTION_FLAG, NULL, AT(any_frame_rate),
     .help = "in the dark, expose longer than a frame",
     .more = "After the gain has reached its limit. Frames then come slower."},
    {"white-balance", 0, OPTION_TEXT, "auto|off|R,G,B", AT(colour), .parse = colour_option_balance, .initial = "auto",
     .right = "auto, off, or factors R,G,B from 0.001 to 1024, for example 1.9,1,1.6",
     .help = "of raw mosaics: grey world, none, factors"},
    {"black-level", 0, OPTION_TEXT, "auto|off|CODE", AT(colour), .parse = colour_option_black, .initial = "auto",
     .right = "auto, off, or the code of no light in the camera's format, from 0 to 65534, for example 64 of 10 bits",
     .help = "of raw formats: the sensor's, none, a code"},
    {"knees", 0, OPTION_TEXT, "CODE:LIGHT,...", AT(colour), .parse = colour_option_knees,
     .right = "up to 8 points CODE:LIGHT, both rising, LIGHT above 0 and below 1, for example 1024:0.0156,2048:0.125",
     .help = "of companded raw formats: from code to light",
     .more = "Light is 0 at the black level, 1 at the largest code, and on straight lines between these points."},
    {"matrix", 0, OPTION_TEXT, "auto|off|M", AT(colour), .parse = colour_option_matrix, .initial = "auto",
     .right = "auto, off, or 9 numbers from -16 to 16, row by row, with commas between, that convert the sensor's red, "
              "green and blue to those of the picture",
     .help = "of raw mosaics to Rec.709: the sensor's, none, a matrix"},
    {"control-delay", 0, OPTION_COUNT32, "N", AT(live.delay), .low = 1, .high = 15, .unit = "frames",
     .help = "frames until a control acts (the sensor's, or 3)",
     .more = "Without it, a step of the exposure shows the true delay, which is then used. With a wrong one, steps of "
             "the exposure are visible for some frames."},
    {"curve", 0, OPTION_CHOICE, "auto|linear|unknown", AT(curve), .initial = "auto",
     .help = "whether the camera's values are linear in light",
     .more = "linear: the first exposure step is a full one. unknown: it goes half the way and shows how strongly the "
             "picture responds. auto: linear for mosaics, for grey, and where the driver says so; unknown for other "
             "formats, and for grey of a USB camera (uvcvideo) whose driver does not say."},
    {"resume", 0, OPTION_PATH, "FILE", AT(resume), .parse = parse_resume, .help = "state file (~/.local/state/pupil)",
     .more = "A run begins with the exposure time times gain at which this camera (by driver, bus and card) was at "
             "rest in its last run. It is kept in the file \"cameras\" in $STATE_DIRECTORY, $XDG_STATE_HOME/pupil or "
             "~/.local/state/pupil, or in FILE, which has a line for each camera. It is written after five seconds, "
             "every minute if it has changed, and at the end, after Ctrl-C too. The frames taken before that exposure "
             "is in force, at most 30, are left out. A missing or empty file is no error. In a damaged one the "
             "undamaged lines are used, with a warning. Any other file is refused and left as it is; in the usual "
             "place there is only a warning. A setting that the camera cannot have is not used. Not with --mode "
             "digital, or with both --shutter and --gain."},
    {"no-resume", 0, OPTION_FLAG, NULL, AT(begins_cold), .help = "begin cold",
     .more = "From the camera's present setting. No state is read or written."},
    {"newest", 0, OPTION_FLAG, NULL, AT(live.capture.late), .help = "skip late frames",
     .more = "If several frames are waiting, the newest is taken and the others count as late. Without this option, "
             "frames are skipped once the program turns out to be slower than the camera, but never with --record."},
    {"reopen", 0, OPTION_TIME, "TIME", AT(live.capture.reopen_s), .high = 1e6, .unit_s = 1.0, .initial = "0",
     .right = "seconds, from 0 to 1000000", .help = "wait for a lost camera",
     .more = "Also for one whose stream has stopped. 0: the run ends, with exit status 1."},
};

static const option_row output_rows[] = {
    {"record", 0, OPTION_PATH, "DIR", AT(shown.record), .help = "the camera's frames, for pupil replay",
     .more = "As of pupil record. Their replay has the statistics of the live run."},
    {"view", 0, OPTION_FLAG, NULL, AT(shown.view), .help = "a window; h shows its keys",
     .more = "Each frame as it comes. Keys as of pupil replay --view; space stops the picture, not the run."},
    {"overwrite", 'y', OPTION_FLAG, NULL, AT(shown.overwrite), .help = "replace what is there",
     .more =
         "Without it files and folders are kept, and the run is refused. Patterns in their names are filled in: %Y "
         "%m %d %H %M %S and the others of date(1) by the time of the start; %d alone, or %04d, is the first number "
         "whose file is not there yet."},
    OPTION_ROW_QUIET(run_options, shown.quiet),
};

static const option_group groups[] = {
    {NULL, OPTION_ROWS(run_device_rows)},
    {NULL, OPTION_ROWS(mode_rows)},
    {"camera", OPTION_ROWS(run_request_rows), .brief = ""},
    {NULL, OPTION_ROWS(request_rows), .brief = ""},
    {NULL, OPTION_ROWS(run_manual_rows)},
    {NULL, OPTION_ROWS(control_rows)},
    {"exposure and mapping", OPTION_ROWS(frame_exposure_rows), .base = AT(shown), .brief = "replay"},
    {NULL, OPTION_ROWS(frame_mapping_rows), .base = AT(shown), .brief = "replay"},
    {"outputs (kept when the run ends; -o also takes /dev/videoN)", OPTION_ROWS(frame_output_rows), .base = AT(shown)},
    {NULL, OPTION_ROWS(output_rows)},
    {NULL, OPTION_ROWS(run_end_rows)},
    {0},
};

const option_command run_command = {
    .name = "run",
    .summary = "live frames of a camera, with its exposure under control",
    .usage = "[options]",
    .about = "Controls the exposure of a camera; shows, writes or pipes its picture.",
    .exits = "0 ended (Ctrl-C too), 1 failed, 2 usage, 3 not all recorded, 130 second Ctrl-C",
    .manual =
        "Takes live frames of a V4L2 camera, controls its exposure, and shows, writes or pipes the picture. Ctrl-C, "
        "SIGTERM, SIGHUP, a closed pipe, -n, -t and an unplugged camera end the run with every output complete. A "
        "second Ctrl-C discards what is not complete. Files play at the camera's speed, also where frames were lost. "
        "Controls that pupil changes get their old values back however the run ends, except by SIGKILL.\n\n"
        "On a terminal a line shows frames a second, the latency from the driver's timestamp to the mapped frame, the "
        "metered EV, exposure, gain, the state and lost frames. A pipe gets one line at the beginning and one at "
        "the end.\n\n"
        "Without --width, --height, --framerate and --format the camera stays as it is set. What --shutter and --gain "
        "do not set is controlled; in digital mode it stays as it is.\n\n"
        "docs/camera.md goes from an unknown camera to a stable picture.",
    .instead = "name the camera by -d, for example -d /dev/video0",
    .groups = groups,
};

/* --- what options require of each other --- */

/* Of --row-gains, and of --mains as far as it concerns them. */
static int check_flicker(const run_options *r, pupil_why *why)
{
    const frame_options *o = &r->shown;
    if (r->mode == RUN_DIGITAL && ((r->live.mains_hz && !r->row_gains) || r->any_frame_rate))
        return pupil_refuse(why, "--mains, --flicker-period and --no-frame-rate-priority: need --mode sensor or "
                                 "both; digital leaves the camera as it is");
    if (r->readout_s > 0.0 && !r->row_gains)
        return pupil_refuse(why, "--readout: needs --row-gains");
    if (r->row_gains && (o->gles || o->gles_version))
        return pupil_refuse(why, "--row-gains: is the CPU's work; not with --gles and --gles-version");
    if (r->row_gains && o->config.order == PUPIL_ORDER_FUSED)
        return pupil_refuse(why, "--row-gains: looks at a frame before it is mapped; not with --fused");
    if (r->row_gains && r->mains_off)
        return pupil_refuse(why, "--row-gains: corrects flicker of lamps on the mains; not with --mains off");
    return OPTIONS_RUN;
}

/* Of the limits. */
static int check_limits(const run_options *r, pupil_why *why)
{
    if (r->mode == RUN_DIGITAL && (r->exposure_max_s > 0.0 || r->gain_max > 0.0))
        return pupil_refuse(why, "--shutter-max and --gain-max: need --mode sensor or both; digital leaves the "
                                 "camera as it is");
    if (r->mode == RUN_DIGITAL && r->day_night_s > 0.0)
        return pupil_refuse(why, "--day-night: needs --mode sensor or both; digital does not see the light of the "
                                 "scene");
    if (r->exposure_s > 0.0 && r->exposure_max_s > 0.0)
        return pupil_refuse(why, "--shutter and --shutter-max: one of them");
    if (r->gain > 0.0 && r->gain_max > 0.0)
        return pupil_refuse(why, "--gain and --gain-max: one of them");
    return OPTIONS_RUN;
}

/* Of --resume, --curve and --control-delay, which concern the controlled camera. */
static int check_control(const run_options *r, pupil_why *why)
{
    const int manual = (r->exposure_s > 0.0) + (r->gain > 0.0);
    if (r->resume && (r->mode == RUN_DIGITAL || manual == 2))
        return pupil_refuse(
            why, "--resume: needs an exposure that pupil controls; nothing is controlled with --mode digital, or with "
                 "both --shutter and --gain");
    if (r->resume && r->begins_cold)
        return pupil_refuse(why, "--resume and --no-resume: one of them");
    if (r->mode == RUN_DIGITAL && (r->curve || (r->live.delay && !manual)))
        return pupil_refuse(why, "--curve and (without --shutter and --gain) --control-delay: need --mode sensor or "
                                 "both; digital controls nothing");
    return OPTIONS_RUN;
}

int run_options_parse(run_options *r, int argc, char **argv, pupil_why *why)
{
    option_words words;
    *r = (run_options){.mode = RUN_BEST};
    frame_options_begin(&r->shown);
    const int parsed = options_parse(&run_command, r, argc, argv, &words, why);
    if (parsed)
        return parsed;
    if (frame_options_check(&r->shown, options_given(&run_command, &words, "weight"),
                            options_given(&run_command, &words, "key"), why))
        return OPTIONS_USAGE;
    if (r->mode == RUN_SENSOR && r->shown.config.order == PUPIL_ORDER_FUSED)
        return pupil_refuse(why, "--fused: needs --mode digital or both; in sensor mode the picture is the camera's");
    if (check_flicker(r, why) || check_limits(r, why))
        return OPTIONS_USAGE;
    if (r->camera_evs && r->devices < 2)
        return pupil_refuse(why, "--camera-ev: needs several cameras: --device A --device B");
    return check_control(r, why) || (r->devices > 1 && run_several_check(r, why)) ? OPTIONS_USAGE : OPTIONS_RUN;
}

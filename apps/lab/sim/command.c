/* pupil sim: an exposure loop around a simulated camera. */
#include "sim.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/report_error.h"
#include "file/common/pending.h"
#include "options/commands.h"
#include "options/key_at.h"
#include "output/plot.h"
#include "refuse.h"
#include "source.h"

static const char light_help[] =
    "what the light does; statements are separated by ';', times are from the beginning:\n"
    "  [TIME] EV              0s -1ev                 the light, in stops from where it began\n"
    "  [TIME] step EV         2s step +3ev\n"
    "  [TIME] ramp EV/s TIME  4s ramp -2ev/s 1s\n"
    "  [TIME] flash N frames EV                       6s flash 1 frame +5ev\n"
    "  [TIME] strobe N frames EV every TIME           strobe 1 frame +5ev every 0.5s\n"
    "  [TIME] blink EV SHARE PERIOD                   blink +7ev 1% 2s: a lamp in the picture\n"
    "  [TIME] flicker M FREQUENCY                     flicker 10% 10Hz: whole frames\n"
    "  [TIME] lamp MAINS M [daylight SHARE] [sine | rectified | pwm DUTY]   lamp 50Hz 30%\n"
    "  [TIME] lamp off\n";

static int parse_camera(const option_value *v)
{
    sim_options *o = v->options;
    o->camera = v->text;
    if (strcmp(v->text, "help") != 0)
        return OPTIONS_RUN;
    printf("a camera is key=value,... of these:\n%s", fixture_plant_keys);
    return OPTIONS_HELP;
}

/* The script, or "@FILE", a file with it. */
static int parse_light(const option_value *v)
{
    sim_options *o = v->options;
    const char *path = v->text + 1;
    if (strcmp(v->text, "help") == 0) {
        fputs(light_help, stdout);
        return OPTIONS_HELP;
    }
    if (*v->text != '@') {
        if (strlen(v->text) >= sizeof o->light)
            return pupil_refuse(v->why, "--light: at most %zu characters", sizeof o->light - 1);
        strcpy(o->light, v->text);
        return OPTIONS_RUN;
    }
    FILE *file = fopen(path, "re");
    const size_t length = file ? fread(o->light, 1, sizeof o->light, file) : 0;
    const int failed = !file || ferror(file);
    if (failed)
        pupil_refuse(v->why, "--light: %s: %s", path, strerror(errno));
    if (file)
        fclose(file);
    if (failed)
        return OPTIONS_USAGE;
    if (length == sizeof o->light || memchr(o->light, 0, length))
        return pupil_refuse(v->why, "--light: %s: must be a text of at most %zu characters", path, sizeof o->light - 1);
    o->light[length] = 0;
    return OPTIONS_RUN;
}

static int parse_controller(const option_value *v)
{
    sim_options *o = v->options;
    o->loop.law = fixture_controller_named(v->text);
    return o->loop.law ? OPTIONS_RUN : option_refuse(v, NULL);
}

static int parse_mains(const option_value *v)
{
    static const uint32_t hz[] = {0, 50, 60, PUPIL_SENSOR_MAINS_AUTO};
    sim_options *o = v->options;
    const int place = option_word(v->text, v->row->value);
    if (place < 0)
        return option_refuse(v, NULL);
    o->mains_hz = hz[place];
    return OPTIONS_RUN;
}

static int parse_key_at(const option_value *v)
{
    sim_options *o = v->options;
    o->key_at = v->text;
    return key_at_parse(v->text, o->loop.sensor.key_at, &o->loop.sensor.key_points) ? option_refuse(v, NULL)
                                                                                    : OPTIONS_RUN;
}

#define AT(field) offsetof(sim_options, field)

static const option_row rows[] = {
    {"camera", 'c', OPTION_TEXT, "K=V,...", 0, .parse = parse_camera,
     .help = "the camera; '--camera help' lists what can be set",
     .more = "Delays, lines, laws of gain, noise, bits, curves, drops, wrong metadata. Without it, a linear 12-bit "
             "camera at "
             "30 frames a second with a delay of 3 frames."},
    {"light", 'l', OPTION_TEXT, "SCRIPT", 0, .parse = parse_light,
     .help = "its light ('2s step +3ev'), or @FILE; '--light help' has all",
     .more = "For example '0s -1ev; 2s step +3ev; 4s ramp -2ev/s 1s; 6s flash 1 frame +5ev; lamp 50Hz 30%'."},
    {"scene", 0, OPTION_TEXT, "RECIPE", AT(scene), .help = "a rendered scene (room) with all its lights on",
     .more = "Without it, luminances by their distribution."},
    {"controller", 0, OPTION_CHOICE, "NAME", 0, .parse = parse_controller, .initial = "pupil",
     .words = "pupil|rpi|libipa|softisp|openpilot|integrator0.25|integrator1", .help = "pupil, or a published law"},
    {"delay", 0, OPTION_COUNT32, "N", AT(believed), .low = 1, .high = 16,
     .help = "the delay that the controller is configured with (the camera's)"},
    {"mains", 0, OPTION_CHOICE, "0|50|60|auto", 0, .parse = parse_mains, .initial = "auto",
     .help = "the mains frequency that pupil is configured with"},
    {"key-at", 0, OPTION_TEXT, "EV:KEY,...", 0, .parse = parse_key_at, .right = key_at_right,
     .help = "pupil's key by scene luminance: -1:0.06,5.5:0.18 (0.18)"},
    {"duration", 0, OPTION_NUMBER, "S", AT(duration_s), .low = 0.01, .high = 1e6,
     .right = "a number of seconds from 0.01 to 1000000",
     .help = "seconds, 61 to 1,000,000 frames (10, or 120 frames, after the script's end)"},
    {"stats", 0, OPTION_PATH, "FILE", AT(stats), .help = "each frame as a line of JSON (.jsonl, - is stdout)",
     .more = "What was in force, what was reported of it, what was requested, and the error of the picture."},
    {"plot", 0, OPTION_PATH, "FILE", AT(plot), .help = "light, exposure, gain and error: .svg or .png",
     .more = "Needs gnuplot."},
    OPTION_ROW_OVERWRITE(sim_options, overwrite),
    OPTION_ROW_JSON(sim_options, json, "the summary as an object"),
    {"check", 0, OPTION_FLAG, NULL, AT(check), .help = "exit status 1 where the loop ends wrong",
     .more = "In still light, after 60 frames or 12 delays: what is shown over 0.1 EV from the aim, the sensor over "
             "0.25 EV or half its step from its best setting, a swing of 0.1 EV, a limit that is not named."},
    {"random", 0, OPTION_COUNT, "N", AT(plants), .low = 1, .high = 1e9,
     .help = "N cameras and scripts from seeds; fails where a loop ends wrong",
     .more = "Exit status 1 as with --check, or where a loop requests a value that is not finite. Each such seed is "
             "named with the command that shows it again. A table says how cameras with each fault ended."},
    {"seed", 0, OPTION_COUNT, "S", AT(seed), .high = 0x1p62, .initial = "1",
     .help = "the first seed; '--random 1' shows one"},
    OPTION_ROW_THREADS(sim_options, threads, "0"),
    OPTION_ROW_QUIET(sim_options, quiet),
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command sim_command = {
    .name = "sim",
    .summary = "an exposure loop with a simulated camera",
    .usage = "[options]",
    .about = "Runs an exposure loop with a simulated camera while the light changes.",
    .exits = "0 done, 1 failed, or with --check or --random a loop that ends wrong, 2 usage",
    .manual =
        "Runs one loop with one simulated camera. Prints when it settled, its overshoot, and what it does at rest.",
    .instead = "the light is set by --light",
    .groups = groups,
};

/* 0, or -1 and a sentence for options that exclude each other. */
static int check_together(const sim_options *o, pupil_why *why)
{
    if (o->plants && (o->camera || *o->light || o->scene || o->duration_s > 0.0))
        return pupil_refuse(why, "--random: camera, light, scene and duration are what the seed makes them");
    if (o->plants > 1 && (o->stats || o->plot))
        return pupil_refuse(why, "--random %llu: --stats and --plot are of one run, --random 1",
                            (unsigned long long)o->plants);
    if (o->key_at && o->loop.law->total)
        return pupil_refuse(why, "--key-at: needs --controller pupil; the published laws have one key");
    return 0;
}

/* Sets up the loop of the options; an exit status, and a sentence. */
static int prepare(sim_options *o, pupil_why *why)
{
    if (check_together(o, why))
        return EXIT_USAGE;
    if (o->plot && pupil_plot_check(o->plot, o->overwrite, why))
        return EXIT_FAILED;
    if (o->stats && strcmp(o->stats, "-") != 0 && !o->overwrite && access(o->stats, F_OK) == 0)
        return pupil_pending_keep(o->stats, why), EXIT_FAILED;
    if (o->plants)
        return o->plants == 1 && sim_random_loop(o, o->seed, why) ? EXIT_FAILED : EXIT_DONE;
    if (!*o->light)
        strcpy(o->light, "2s step +3ev; 6s step -3ev");
    if (o->camera && fixture_plant_parse(&o->loop.plant, o->camera, why))
        return EXIT_USAGE;
    pupil_why words;
    if (fixture_light_parse(&o->loop.script, o->light, &words))
        return pupil_refuse(why, "--light: %s", words.text), EXIT_USAGE;
    if (o->scene && sim_luminance(o->scene, o->loop.plant.width, o->loop.plant.height, &o->luminance, why))
        return EXIT_FAILED;
    o->loop.plant.luminance = o->luminance;
    fixture_loop_fit(&o->loop);
    sim_configure(o);
    return EXIT_DONE;
}

/* The exit status of a checked run, and a sentence about what is wrong with it. */
static int sim_check(const fixture_verdict *v, pupil_why *why)
{
    if (!v->is_evaluated)
        return pupil_refuse(why,
                            "--check: the light is not still for long enough at the end; --duration gives it more, "
                            "if it is ever still"),
               EXIT_FAILED;
    return v->wrong ? (pupil_refuse(why, "the loop ends wrong: %s", v->text), EXIT_FAILED) : EXIT_DONE;
}

static int run_one(sim_options *o, pupil_why *why)
{
    sim_run run = {.options = o, .rest = SIM_REST_FRAMES};
    run.frames = sim_frames(o, &run.event);
    run.frame = malloc(run.frames * sizeof *run.frame);
    int failed = run.frame ? fixture_loop_run(&o->loop, run.frames, run.frame, why)
                           : pupil_refuse(why, "not enough memory for %zu frames", run.frames);
    /* lost frames have a number, too */
    while (!failed && run.event + run.rest < run.frames &&
           run.frame[run.event].truth.time_s < fixture_loop_last_s(&o->loop) - 1e-6)
        run.event++;
    while (!failed && run.event > 0 && run.frame[run.event - 1].truth.time_s >= fixture_loop_last_s(&o->loop) - 1e-6)
        run.event--;
    if (!failed)
        run.sum = fixture_loop_sum_of(run.frame, run.frames, run.event, run.rest);
    failed = failed || fixture_evaluate(&o->loop, run.frame, run.frames, &run.verdict, why);
    failed = failed || (o->stats && sim_stats(&run, why)) || (o->plot && sim_plot(&run, why));
    if (!failed && !(o->stats && strcmp(o->stats, "-") == 0))
        sim_summary(&run, stdout);
    free(run.frame);
    if (failed)
        return EXIT_FAILED;
    return o->plants || o->check ? sim_check(&run.verdict, why) : EXIT_DONE;
}

int sim_main(int argc, char **argv)
{
    sim_options o = {.seed = 1, .mains_hz = PUPIL_SENSOR_MAINS_AUTO};
    pupil_why why = {""};
    fixture_loop_default(&o.loop);
    option_words words;
    const int parsed = options_read(&sim_command, &o, argc, argv, &words);
    if (parsed >= 0)
        return parsed;
    int status = prepare(&o, &why);
    if (status == EXIT_DONE)
        status = o.plants > 1 ? sim_random(&o) : run_one(&o, &why);
    free(o.luminance);
    if (*why.text)
        report_error("pupil sim", &why, "");
    if (fflush(stdout) != 0 && status == EXIT_DONE) {
        fputs("pupil sim: standard output cannot be written\n", stderr);
        return EXIT_FAILED;
    }
    return status;
}

/* pupil sim: an exposure loop around a simulated camera. */
#include "sim.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "options/key_at.h"
#include "output/plot.h"
#include "refuse.h"
#include "source.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };
enum { MOST_FRAMES = 1000000, REST_FRAMES = 60 };

static const char help[] =
    "usage: pupil sim [options]\n"
    "An exposure loop around a simulated camera: what it does when the light changes.\n"
    "  -c, --camera K=V,...  the camera; '--camera help' lists what can be set\n"
    "  -l, --light SCRIPT    what the light does, or @FILE ('2s step +3ev'); '--light help' tells more\n"
    "      --scene RECIPE    it looks at a rendered scene (room) with all its lights on\n"
    "      --controller NAME pupil, or a published law: rpi libipa softisp openpilot\n"
    "                        integrator0.25 integrator1 (pupil)\n"
    "      --delay N         the delay that the controller believes in (the camera's own)\n"
    "      --mains HZ        the mains that pupil is told of: 0, 50, 60; auto: it finds them (auto)\n"
    "      --key-at EV:KEY,...   pupil's key by the light of the scene: -1:0.06,5.5:0.18 (0.18)\n"
    "      --duration S      seconds, 61 to 1,000,000 frames (10 after the script's end)\n"
    "      --stats FILE      each frame as a line of JSON (.jsonl, - for standard output)\n"
    "      --plot FILE       light, exposure, gain and error over time, .svg or .png, by gnuplot\n"
    "      --json            the summary as an object\n"
    "      --random N        N cameras and scripts from seeds; fails where a loop swings for ever\n"
    "      --seed S          the first seed (1); '--random 1' shows one as the others are shown\n"
    "      --threads N       for --random; the results are the same (0: one a processor)\n"
    "  -q, --quiet           no progress       -h, --help\n"
    "exit: 0 done, 1 failed, or with --random a loop that swings for ever, 2 usage\n";

static const char light_help[] =
    "what the light does; statements stand apart by ';', times are from the beginning:\n"
    "  [TIME] EV              0s -1ev                 the light, in stops from where it began\n"
    "  [TIME] step EV         2s step +3ev\n"
    "  [TIME] ramp EV/s TIME  4s ramp -2ev/s 1s\n"
    "  [TIME] flash N frames EV                       6s flash 1 frame +5ev\n"
    "  [TIME] strobe N frames EV every TIME           strobe 1 frame +5ev every 0.5s\n"
    "  [TIME] blink EV SHARE PERIOD                   blink +7ev 1% 2s: a lamp in the picture\n"
    "  [TIME] flicker M FREQUENCY                     flicker 10% 10Hz: whole frames\n"
    "  [TIME] lamp MAINS M [daylight SHARE] [sine | rectified | pwm DUTY]   lamp 50Hz 30%\n"
    "  [TIME] lamp off\n";

static int number(const char *option, const char *text, double least, double most, int whole, double *value)
{
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    if (end != text && !*end && *value >= least && *value <= most && (!whole || *value == floor(*value)))
        return 0;
    fprintf(stderr, "pupil sim: --%s %s: must be a %snumber from %.15g to %.15g\n", option, text, whole ? "whole " : "",
            least, most);
    return -1;
}

static int whole(const char *option, const char *text, uint64_t least, uint64_t most, uint64_t *value)
{
    char *end;
    errno = 0;
    *value = strtoull(text, &end, 10);
    if (*text >= '0' && *text <= '9' && !*end && !errno && *value >= least && *value <= most)
        return 0;
    fprintf(stderr, "pupil sim: --%s %s: must be a whole number from %llu to %llu\n", option, text,
            (unsigned long long)least, (unsigned long long)most);
    return -1;
}

static int read_light(const char *text, sim_options *o)
{
    if (*text != '@') {
        if (strlen(text) < sizeof o->light)
            return strcpy(o->light, text), 0;
        return fprintf(stderr, "pupil sim: --light: at most %zu characters\n", sizeof o->light - 1), -1;
    }
    FILE *file = fopen(text + 1, "re");
    const size_t length = file ? fread(o->light, 1, sizeof o->light, file) : 0;
    const int failed = !file || ferror(file);
    if (failed)
        fprintf(stderr, "pupil sim: --light: %s: %s\n", text + 1, strerror(errno));
    if (file)
        fclose(file);
    if (failed)
        return -1;
    if (length == sizeof o->light || memchr(o->light, 0, length)) {
        fprintf(stderr, "pupil sim: --light: %s: must be a text of at most %zu characters\n", text + 1,
                sizeof o->light - 1);
        return -1;
    }
    o->light[length] = 0;
    return 0;
}

static int read_controller(const char *name, sim_options *o)
{
    o->loop.law = fixture_controller_named(name);
    if (o->loop.law)
        return 0;
    fprintf(stderr, "pupil sim: --controller %s: must be one of", name);
    for (size_t i = 0; i < FIXTURE_CONTROLLERS; i++)
        fprintf(stderr, " %s", fixture_controllers[i].name);
    fputc('\n', stderr);
    return -1;
}

static int read_mains(const char *text, sim_options *o)
{
    static const char *const words[] = {"0", "50", "60", "auto"};
    static const uint32_t hz[] = {0, 50, 60, PUPIL_SENSOR_MAINS_AUTO};
    for (size_t i = 0; i < 4; i++)
        if (strcmp(text, words[i]) == 0) {
            o->mains_hz = hz[i];
            return 0;
        }
    fprintf(stderr, "pupil sim: --mains %s: must be 0, 50, 60 or auto\n", text);
    return -1;
}

/* 0; 1: wrong; -1: nothing more is to be done. */
static int read_option(int option, sim_options *o)
{
    uint64_t n = 0;
    int failed;
    switch (option) {
    case 'c':
        if (strcmp(optarg, "help") == 0)
            return fputs("a camera is key=value,... of these:\n", stdout), fputs(fixture_plant_keys, stdout), -1;
        o->camera = optarg;
        return 0;
    case 'l':
        if (strcmp(optarg, "help") == 0)
            return fputs(light_help, stdout), -1;
        return read_light(optarg, o) != 0;
    case 'e':
        o->scene = optarg;
        return 0;
    case 'o':
        return read_controller(optarg, o) != 0;
    case 'd':
        failed = whole("delay", optarg, 1, 16, &n);
        o->believed = (uint32_t)n;
        return failed != 0;
    case 'm':
        return read_mains(optarg, o) != 0;
    case 'k':
        o->key_at = optarg;
        if (key_at_parse(optarg, &o->loop.sensor))
            return fprintf(stderr, "pupil sim: --key-at %s: must be %s\n", optarg, key_at_right), 1;
        return 0;
    case 't':
        return number("duration", optarg, 0.01, 1e6, 0, &o->duration_s) != 0;
    case 's':
        o->stats = optarg;
        return 0;
    case 'p':
        o->plot = optarg;
        return 0;
    case 'j':
        o->json = 1;
        return 0;
    case 'r':
        return whole("random", optarg, 1, 1000000000, &o->plants) != 0;
    case 'S':
        return whole("seed", optarg, 0, UINT64_C(1) << 62, &o->seed) != 0;
    case 'T':
        failed = whole("threads", optarg, 0, 256, &n);
        o->threads = (uint32_t)n;
        return failed != 0;
    case 'q':
        o->quiet = 1;
        return 0;
    case 'h':
        return fputs(help, stdout), -1;
    default:
        return 1;
    }
}

static int read_options(int argc, char **argv, sim_options *o)
{
    static const struct option known[] = {
        {"camera", 1, NULL, 'c'},  {"light", 1, NULL, 'l'},  {"scene", 1, NULL, 'e'},    {"controller", 1, NULL, 'o'},
        {"delay", 1, NULL, 'd'},   {"mains", 1, NULL, 'm'},  {"duration", 1, NULL, 't'}, {"stats", 1, NULL, 's'},
        {"plot", 1, NULL, 'p'},    {"json", 0, NULL, 'j'},   {"random", 1, NULL, 'r'},   {"seed", 1, NULL, 'S'},
        {"threads", 1, NULL, 'T'}, {"key-at", 1, NULL, 'k'}, {"quiet", 0, NULL, 'q'},    {"help", 0, NULL, 'h'},
        {NULL, 0, NULL, 0}};
    int c, wrong = 0;
    optind = 1;
    while (!wrong && (c = getopt_long(argc, argv, "c:l:qh", known, NULL)) != -1)
        wrong = read_option(c, o);
    if (wrong || optind == argc)
        return wrong;
    fprintf(stderr, "pupil sim: %s: it takes no argument; the light is --light's\n", argv[optind]);
    return 1;
}

void sim_tell(sim_options *o)
{
    pupil_sensor_config *c = &o->loop.sensor;
    if (o->believed)
        c->delay_frames = o->believed;
    c->mains_hz = o->mains_hz;
    if (o->key_at)
        key_at_parse(o->key_at, c); /* it was right when it was read */
}

/* What goes together, and the loop that the options stand for; an exit status, and a sentence. */
/* 0, or -1 for options that exclude each other. */
static int check_together(const sim_options *o, pupil_why *why)
{
    if (o->plants && (o->camera || *o->light || o->scene || o->duration_s > 0.0))
        return pupil_refuse(why, "--random: camera, light, scene and duration are what the seed makes them");
    if (o->plants > 1 && (o->stats || o->plot))
        return pupil_refuse(why, "--random %llu: --stats and --plot are of one run, --random 1",
                            (unsigned long long)o->plants);
    if (o->key_at && o->loop.law->total)
        return pupil_refuse(why, "--key-at: is of --controller pupil; the published laws have one key");
    return 0;
}

static int prepare(sim_options *o, pupil_why *why)
{
    if (check_together(o, why))
        return EXIT_USAGE;
    if (o->plot && pupil_plot_check(o->plot, why))
        return EXIT_FAILED;
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
    sim_tell(o);
    return EXIT_DONE;
}

size_t sim_frames(const sim_options *o, size_t *event)
{
    const double frame_s = o->loop.plant.frame_s, last_s = fixture_light_last_s(&o->loop.script);
    const double frames = ceil((o->duration_s > 0.0 ? o->duration_s : last_s + 10.0) / frame_s);
    const size_t count = frames < REST_FRAMES + 1 ? REST_FRAMES + 1
                         : frames > MOST_FRAMES   ? MOST_FRAMES
                                                  : (size_t)frames;
    const double at = ceil(last_s / frame_s - 1e-6);
    const size_t latest = count - REST_FRAMES;
    *event = at < (double)latest ? (size_t)at : latest;
    return count;
}

static int run_one(sim_options *o, pupil_why *why)
{
    sim_run run = {.options = o, .rest = o->plants ? SIM_RANDOM_REST : REST_FRAMES};
    run.frames = sim_frames(o, &run.event);
    run.frame = malloc(run.frames * sizeof *run.frame);
    int failed = run.frame ? fixture_loop_run(&o->loop, run.frames, run.frame, why)
                           : pupil_refuse(why, "not enough memory for %zu frames", run.frames);
    /* frames that never came have a number, too */
    while (!failed && run.event + run.rest < run.frames &&
           run.frame[run.event].truth.time_s < fixture_light_last_s(&o->loop.script) - 1e-6)
        run.event++;
    while (!failed && run.event > 0 &&
           run.frame[run.event - 1].truth.time_s >= fixture_light_last_s(&o->loop.script) - 1e-6)
        run.event--;
    if (!failed)
        run.sum = fixture_loop_sum_of(run.frame, run.frames, run.event, run.rest);
    failed = failed || (o->stats && sim_stats(&run, why)) || (o->plot && sim_plot(&run, why));
    if (!failed && !(o->stats && strcmp(o->stats, "-") == 0))
        sim_summary(&run, stdout);
    free(run.frame);
    if (failed)
        return EXIT_FAILED;
    return o->plants && sim_cycles(&run.sum) ? EXIT_FAILED : EXIT_DONE;
}

int sim_main(int argc, char **argv)
{
    sim_options o = {.seed = 1, .mains_hz = PUPIL_SENSOR_MAINS_AUTO};
    pupil_why why = {""};
    fixture_loop_default(&o.loop);
    const int wrong = read_options(argc, argv, &o);
    if (wrong)
        return wrong > 0 ? EXIT_USAGE : EXIT_DONE;
    int status = prepare(&o, &why);
    if (status == EXIT_DONE)
        status = o.plants > 1 ? sim_random(&o) : run_one(&o, &why);
    free(o.luminance);
    if (*why.text)
        fprintf(stderr, "pupil sim: %s\n", why.text);
    if (fflush(stdout) != 0 && status == EXIT_DONE) {
        fputs("pupil sim: standard output cannot be written\n", stderr);
        return EXIT_FAILED;
    }
    return status;
}

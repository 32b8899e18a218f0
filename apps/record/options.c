#include "options.h"

#include <stdio.h>
#include <string.h>

#include "options/shared_options.h"
#include "refuse.h"
#include "run/options.h"

enum { WIDTH = 256, HEIGHT, FRAMERATE, FORMAT, SHUTTER, GAIN, AUTO };

const char record_help[] = "usage: pupil record [-d CAMERA] [options] DIR\n"
                           "       pupil record INPUT... [options] DIR\n"
                           "A camera's raw frames as they come, into a folder that pupil replay, ffmpeg and mpv\n"
                           "open: lossless, with each frame's number, time, exposure and gain. Ctrl-C ends it.\n"
                           "  -d, --device CAMERA  a path, a number, a name (the first; 'pupil list')\n"
                           "  INPUT                what pupil replay takes, instead of a camera\n"
                           "  -n, --frames N       so many frames     -t, --timeout SECONDS (or 500ms, 10min)\n"
                           "      --width N  --height N  --framerate N         as the camera is set\n"
                           "      --format FOURCC  the camera's format: YUYV, NV12, RG10, ...\n"
                           "exposure (without these no control of the camera is touched)\n"
                           "      --shutter TIME   by hand: 10ms, 1/100, 10000 (us)      --gain FACTOR\n"
                           "      --auto           follow the light with what is not set by hand\n"
                           "  -y, --overwrite      replace a recording that is there\n"
                           "  -q, --quiet  -h, --help\n"
                           "exit: 0 done (by Ctrl-C too), 1 failed, 2 usage, 3 done but frames were lost\n";

static const struct option long_options[] = {
    {"device", required_argument, NULL, 'd'},
    {"frames", required_argument, NULL, 'n'},
    {"timeout", required_argument, NULL, 't'},
    {"width", required_argument, NULL, WIDTH},
    {"height", required_argument, NULL, HEIGHT},
    {"framerate", required_argument, NULL, FRAMERATE},
    {"fps", required_argument, NULL, FRAMERATE},
    {"format", required_argument, NULL, FORMAT},
    {"shutter", required_argument, NULL, SHUTTER},
    {"gain", required_argument, NULL, GAIN},
    {"auto", no_argument, NULL, AUTO},
    {"overwrite", no_argument, NULL, 'y'},
    {"quiet", no_argument, NULL, 'q'},
    {"help", no_argument, NULL, 'h'},
    {NULL, 0, NULL, 0},
};

static int take(int option, const value_text *c, record_options *o)
{
    switch (option) {
    case 'd':
        o->camera = c->text;
        return *c->text ? RECORD_RUN : value_refuse(c, "a camera: a path, a number or a name");
    case 'n':
        return value_whole(c, 1, UINT64_C(1) << 40, "a whole number of frames, 1 or more", &o->most);
    case 't':
        return run_value_time(c, 1.0, 1e-3, 1e9, "seconds above 0, or 500ms, 10min", &o->seconds);
    case WIDTH:
        return run_value_side(c, &o->source.width);
    case HEIGHT:
        return run_value_side(c, &o->source.height);
    case FRAMERATE:
        return value_number(c, 0.001, 1e5, "frames a second, from 0.001 to 100000", &o->source.fps);
    case FORMAT:
        return run_value_format(c, &o->fourcc);
    case SHUTTER:
        return run_value_time(c, 1e-6, 1e-7, 1e4, "a time: 10ms, 1/100, 500us; a plain number is microseconds",
                              &o->exposure_s);
    case GAIN:
        return value_number(c, 0x1p-10, 0x1p16, "a factor from 0.001 to 65536; 1 is none", &o->gain);
    case AUTO:
        o->automatic = 1;
        return RECORD_RUN;
    case 'y':
        o->overwrite = 1;
        return RECORD_RUN;
    default:
        o->quiet = 1;
        return RECORD_RUN;
    }
}

/* The last word is the folder; those before it are inputs. */
static int check(record_options *o, char **words, int count, pupil_why *why)
{
    if (!count)
        pupil_refuse(why, "no folder to record into; 'pupil record --help' tells more");
    else if (o->camera && count > 1)
        pupil_refuse(why, "%s: -d names a camera already, and one folder is recorded into", words[0]);
    else if (count > 1 && (o->fourcc || o->automatic || o->exposure_s > 0 || o->gain > 0))
        pupil_refuse(why,
                     "--format, --shutter, --gain, --auto: are a camera's; %s is taken as it is (-d names "
                     "a camera)",
                     words[0]);
    else {
        o->inputs = (const char *const *)words;
        o->input_count = (size_t)count - 1;
        o->folder = words[count - 1];
        return RECORD_RUN;
    }
    return RECORD_USAGE;
}

int record_options_parse(record_options *o, int argc, char **argv, pupil_why *why)
{
    int option;
    *o = (record_options){0};
    optind = 0; /* from the beginning, also where another command line was read before */
    opterr = 0;
    while ((option = getopt_long(argc, argv, "d:n:t:yqh", long_options, NULL)) != -1) {
        const value_text c = {NULL, option_name(long_options, option), optarg, why};
        if (option == 'h')
            return RECORD_HELP;
        if (option == '?') {
            pupil_refuse(why, "%s: no such option, or its value is missing; 'pupil record --help' lists them",
                         argv[optind - 1]);
            return RECORD_USAGE;
        }
        if (take(option, &c, o))
            return RECORD_USAGE;
    }
    return check(o, argv + optind, argc - optind, why);
}

/* pupil list, probe, run and record on a fake libcamera camera. */
#include "check.h"
#include "scratch.h"

#include <linux/videodev2.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fake_libcamera/fake_libcamera.h"
#include "fake_v4l2/fake_v4l2.h"
#include "list/list.h"
#include "probe/probe.h"
#include "record/record.h"
#include "run/run.h"

static char *slurp(const char *path)
{
    FILE *file = fopen(path, "re");
    char *text = calloc(1, 1 << 20);
    if (!text)
        abort();
    if (file) {
        const size_t got = fread(text, 1, (1 << 20) - 1, file);
        text[got] = 0;
        fclose(file);
    }
    return text;
}

typedef int command(const pupil_live_system *system, int argc, char **argv);

static int list_on(const pupil_live_system *system, int argc, char **argv)
{
    (void)argv;
    return list_cameras(system, argc > 1, stdout, stderr);
}

typedef struct outcome {
    int status;
    char *out, *err;
} outcome;

#define NO_LIBCAMERA 2

static const char *long_id; /* NULL: as it is */

/* In a process of its own, with the sensor (1), the webcam (0), or a libcamera that does not start (2). */
static outcome run_command(command *of, int sensor, const char *const *words)
{
    char *argv[16];
    const char *out = scratch("out.txt"), *err = scratch("err.txt");
    int argc = 0, status = 0;
    for (; words[argc]; argc++)
        argv[argc] = strdup(words[argc]);
    argv[argc] = NULL;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        fake_libcamera_config c;
        fake_v4l2_config none;
        fake_libcamera_config_default(&c);
        c.sensor = sensor;
        c.id = long_id;
        c.no_list = sensor == NO_LIBCAMERA;
        c.fourcc = sensor ? V4L2_PIX_FMT_SRGGB10 : V4L2_PIX_FMT_GREY;
        c.black = sensor ? 4096 : 0;
        c.delay = sensor ? 2 : 3;
        fake_v4l2_config_default(&none);
        none.absent = 1;
        const pupil_live_system system = {.v4l2 = fake_v4l2_system(fake_v4l2_new(&none)),
                                          .libcamera = fake_libcamera_layer(fake_libcamera_new(&c))};
        if (!freopen(out, "we", stdout) || !freopen(err, "we", stderr))
            _exit(99);
        const int result = of(&system, argc, argv);
        fflush(NULL);
        _exit(result);
    }
    waitpid(child, &status, 0);
    while (argc)
        free(argv[--argc]);
    return (outcome){WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(out), slurp(err)};
}

static void done(outcome *o)
{
    free(o->out);
    free(o->err);
}

static void test_list(void)
{
    outcome o = run_command(list_on, 1, (const char *const[]){"list", NULL});
    CHECK_MSG(o.status == 0 && strcmp(o.out, "libcamera:/base/soc/i2c0mux/i2c@1/imx219@10  imx219  libcamera  "
                                             "/base/soc/i2c0mux/i2c@1/imx219@10  RG10 64x48\n") == 0,
              "%d: %s%s", o.status, o.out, o.err);
    done(&o);
    o = run_command(list_on, 1, (const char *const[]){"list", "--json", NULL});
    CHECK_MSG(strstr(o.out, "\"driver\":\t\"libcamera\"") && strstr(o.out, "\"fourcc\":\t\"RG10\""), "%s", o.out);
    done(&o);
}

/* If libcamera does not start, V4L2 cameras are still listed. */
static void test_no_libcamera(void)
{
    outcome o = run_command(list_on, NO_LIBCAMERA, (const char *const[]){"list", NULL});
    CHECK_MSG(o.status == 0 && strcmp(o.out, "no camera that can be asked\n") == 0 &&
                  strcmp(o.err, "pupil list: libcamera does not start: the fake does not\n") == 0,
              "%d: %s%s", o.status, o.out, o.err);
    done(&o);
}

/* Without -d the only camera is used. */
static void test_probe(void)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        outcome o = run_command(probe_on, sensor, (const char *const[]){"probe", "--quick", "-q", NULL});
        CHECK_MSG(o.status == 0, "%d: %s", o.status, o.err);
        CHECK_MSG(strstr(o.out, sensor ? "\nstream     RG10 64x48, 30 frames a second, 4 buffers"
                                       : "\nstream     GREY 64x48, 30 frames a second, 4 buffers"),
                  "%s", o.out);
        CHECK_MSG(
            strstr(o.out, sensor ? "exposure   from 100 us to 1 s by 1 us" : "exposure   from 100 us to 1 s by 100 us"),
            "%s", o.out);
        CHECK_MSG(strstr(o.out, "  exposure proportional, linear light: 1.0"), "%s", o.out);
        CHECK_MSG(strstr(o.out, "controls   ExposureTime: 10000 by default, of 100..1000000\n"), "%s", o.out);
        CHECK_MSG(strstr(o.out, sensor ? "gain       from 1 to 16" : "gain       none"), "%s", o.out);
        CHECK_MSG(strstr(o.out, "  delay of exposure "), "%s", o.out);
        done(&o);
    }
}

static void test_run(void)
{
    const char *stats = scratch("run.csv");
    for (int sensor = 0; sensor < 2; sensor++) {
        outcome o =
            run_command(run_on, sensor,
                        (const char *const[]){"run", "-d", "libcamera:0", "-n", "60", "-y", "--stats", stats, NULL});
        char *text = slurp(stats);
        int lines = 0;
        for (const char *c = text; *c; c++)
            lines += *c == '\n';
        CHECK_MSG(o.status == 0 && lines == 61, "%d, %d lines: %s", o.status, lines, o.err);
        CHECK_MSG(strstr(o.err, "64x48 at 30 frames/s, mode both") && strstr(o.err, "60 frames in "), "%s", o.err);
        CHECK_MSG((strstr(o.err, "is a webcam: libcamera has no true scale of its gain") != NULL) == !sensor, "%s",
                  o.err);
        CHECK_MSG(strstr(text, ",converged,"), "%.2000s", text);
        free(text);
        done(&o);
    }
    outcome o = run_command(run_on, 0, (const char *const[]){"run", "-d", "libcamera:0", "--gain", "4", NULL});
    CHECK_MSG(o.status == 1 && strstr(o.err, "--gain: this camera has gains from 1 to 1"), "%d: %s", o.status, o.err);
    done(&o);
    o = run_command(run_on, 0, (const char *const[]){"run", "-d", "libcamera:0", "--fps", "15", NULL});
    CHECK_MSG(o.status == 1 && strstr(o.err, "libcamera cannot set the frame rate of this camera"), "%d: %s", o.status,
              o.err);
    done(&o);
    o = run_command(run_on, 1,
                    (const char *const[]){"run", "-d", "libcamera:0", "--shutter", "5ms", "--gain", "2", "--fps", "60",
                                          "-n", "30", "-y", "--stats", stats, NULL});
    char *text = slurp(stats);
    CHECK_MSG(o.status == 0 && strstr(text, ",0.0050000000000000001,2,"), "%d: %s %.1500s", o.status, o.err, text);
    free(text);
    done(&o);
}

/* The longest possible id, in the file that keeps the last run's exposure. */
static void test_resume(void)
{
    static char id[256];
    const char *kept = scratch("kept.txt");
    memset(id, 'i', sizeof id - 1);
    long_id = id;
    for (int i = 0; i < 2; i++) {
        outcome o = run_command(
            run_on, 1, (const char *const[]){"run", "-d", "libcamera:0", "-n", "60", "--resume", kept, "-q", NULL});
        CHECK_MSG(o.status == 0 && !*o.err, "%d: %s", o.status, o.err);
        done(&o);
    }
    long_id = NULL;
    char *text = slurp(kept);
    CHECK_MSG(strstr(text, id) && strstr(text, "\tlibcamera\t") && strstr(text, "\timx219\n"), "%s", text);
    int lines = 0;
    for (const char *c = text; *c; c++)
        lines += *c == '\n';
    CHECK_MSG(lines == 2, "%s", text);
    free(text);
}

static void test_record(void)
{
    const char *folder = scratch("shots");
    outcome o = run_command(record_on, 1,
                            (const char *const[]){"record", "-d", "libcamera:", "--auto", "-n", "12", folder, NULL});
    CHECK_MSG(o.status == 0 && strstr(o.err, "recorded 12 frames"), "%d: %s", o.status, o.err);
    done(&o);
    char *text = slurp(scratch("shots/frames.jsonl"));
    int lines = 0;
    for (const char *c = text; *c; c++)
        lines += *c == '\n';
    CHECK_MSG(lines == 12 && strstr(text, "\"exposure_s\""), "%d lines: %.500s", lines, text);
    free(text);
    text = slurp(scratch("shots/recording.json"));
    CHECK_MSG(strstr(text, "imx219") && strstr(text, "64"), "%s", text);
    free(text);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_list();
    test_no_libcamera();
    test_probe();
    test_run();
    test_resume();
    test_record();
    scratch_clear(scratch_folder);
    return check_end();
}

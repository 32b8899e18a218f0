/* --plot: every run can be drawn, regardless of its values; long runs are thinned without losing a spike; failures are
 * sentences. */
#include "output/plot.h"

#include <math.h>

#include "check.h"
#include "output/plot_series.h"
#include "scratch.h"

static pupil_why why;

static frame_log_entry record(size_t i)
{
    frame_log_entry r = {.frame = i, .name = "f", .state = "adapting"};
    r.time_s = (double)i / 30.0;
    r.metered_ev = sin((double)i * 0.01);
    r.p01_ev = r.metered_ev - 3.0;
    r.p99_ev = r.metered_ev + 3.0;
    r.key = 0.18;
    r.output_level = r.aimed_level = 0.15;
    return r;
}

static const plot_value metered = {.offset = offsetof(frame_log_entry, metered_ev), .factor = 1.0};
static const plot_value low = {.offset = offsetof(frame_log_entry, p01_ev)};
static const plot_value high = {.offset = offsetof(frame_log_entry, p99_ev)};

static void check_thinning(size_t count)
{
    frame_log_entry *records = calloc(count, sizeof *records);
    char line[128];
    for (size_t i = 0; i < count; i++)
        records[i] = record(i);
    records[count / 3].metered_ev = 50.0;
    records[count / 2].metered_ev = -50.0;
    records[count / 2].p01_ev = -60.0;
    records[count / 4].metered_ev = NAN;
    records[count / 5].time_s = INFINITY;
    size_t points = 0;
    int up = 0, down = 0;
    double last = -1.0, time_s, a, b;

    FILE *f = tmpfile();
    plot_series(f, records, count, &metered);
    rewind(f);
    while (fgets(line, sizeof line, f)) {
        CHECK(sscanf(line, "%lf %lf", &time_s, &a) == 2 && isfinite(a) && isfinite(time_s) && time_s > last);
        up += a == 50.0;
        down += a == -50.0;
        last = time_s;
        points++;
    }
    fclose(f);
    CHECK_MSG(up == 1 && down == 1 && points <= PLOT_MOST_POINTS, "%d %d %zu", up, down, points);
    CHECK(points >= (count < PLOT_MOST_POINTS ? count - 2 : PLOT_MOST_POINTS / 4));

    double deepest = 0.0;
    f = tmpfile();
    plot_band(f, records, count, &low, &high);
    rewind(f);
    for (points = 0; fgets(line, sizeof line, f); points++) {
        CHECK(sscanf(line, "%lf %lf %lf", &time_s, &a, &b) == 3 && a < b);
        deepest = a < deepest ? a : deepest;
    }
    fclose(f);
    CHECK(deepest == -60.0 && points <= PLOT_MOST_POINTS);
    free(records);
}

static int holds(const char *path, const char *text)
{
    static char content[1 << 20];
    FILE *f = fopen(path, "rb");
    size_t size = f ? fread(content, 1, sizeof content - 1, f) : 0;
    if (f)
        fclose(f);
    content[size] = 0;
    return memmem(content, size, text, strlen(text)) != NULL;
}

static void drawn(const char *name, const frame_log_entry *records, size_t count, const char *title)
{
    CHECK_MSG(pupil_plot_write(scratch(name), 1, records, count, title, &why) == 0, "%s: %s", name, why.text);
    CHECK(scratch_exists(scratch(name)));
}

/* A controlled camera's exposure and gain are drawn, also manual ones or with missing numbers. */
static void check_camera(const frame_log_entry *records)
{
    static frame_log_entry live[300];
    memcpy(live, records, sizeof live);
    for (size_t i = 0; i < 300; i++) {
        live[i].live = 1;
        live[i].exposure_s = live[i].asked_exposure_s = i < 100 ? 0.01 : 0.001;
        live[i].gain = live[i].asked_gain = i < 200 ? 1.0 : 4.0;
        live[i].scene_ev = live[i].metered_ev;
        live[i].camera_key = 0.18;
    }
    drawn("camera.svg", live, 300, "a camera");
    CHECK(holds(scratch("camera.svg"), "exposure, ms") && holds(scratch("camera.svg"), "error, EV"));
    CHECK(holds(scratch("camera.svg"), ">in force<") && !holds(scratch("camera.svg"), "display, linear"));
    for (size_t i = 0; i < 300; i++) {
        live[i].scene_ev = live[i].asked_exposure_s = live[i].gain = live[i].asked_gain = NAN;
        live[i].output_level = 0.0;
    }
    drawn("manual.svg", live, 300, "manual, and black");
    CHECK(holds(scratch("manual.svg"), "exposure, ms") && holds(scratch("manual.svg"), "</svg>"));
}

static void check_drawing(void)
{
    static frame_log_entry records[300];
    for (size_t i = 0; i < 300; i++)
        records[i] = record(i);
    drawn("a.svg", records, 300, "it's \"odd\" `touch hacked` $(id) <&>\n'\nx_1^2");
    CHECK(holds(scratch("a.svg"), "</svg>") && holds(scratch("a.svg"), "x_1^2"));
    CHECK(holds(scratch("a.svg"), "it's \"odd\" `touch hacked` $(id) &lt;&amp;"));
    drawn("a.PNG", records, 300, "");
    CHECK(holds(scratch("a.PNG"), "\x89PNG") && holds(scratch("a.PNG"), "IEND"));
    CHECK(!holds(scratch("a.svg"), "exposure, ms"));
    CHECK(holds(scratch("a.svg"), ">aimed at: key 0.18<") && holds(scratch("a.svg"), "through the tone curve"));
    drawn("one.svg", records, 1, "one frame");
    check_camera(records);
    records[200].key = 0.09;
    drawn("keys.svg", records, 300, "two keys");
    CHECK(holds(scratch("keys.svg"), ">aimed at<") && !holds(scratch("keys.svg"), "key 0"));
    for (size_t i = 0; i < 300; i++)
        records[i].metered_ev = records[i].adapted_ev = records[i].p01_ev = records[i].p99_ev = -3.0;
    drawn("flat.svg", records, 300, "nothing happens");
    for (size_t i = 0; i < 300; i++)
        records[i] = (frame_log_entry){.time_s = 0.0, .metered_ev = NAN, .adapted_ev = -INFINITY, .p01_ev = NAN};
    drawn("nan.svg", records, 300, "no numbers");
    for (size_t i = 0; i < 300; i++)
        records[i].time_s = NAN;
    drawn("timeless.svg", records, 300, "no times");
    CHECK(holds(scratch("timeless.svg"), "</svg>"));
}

static void check_refusals(void)
{
    frame_log_entry one = record(0);
    int before = scratch_entries(scratch_folder);
    CHECK(pupil_plot_write(scratch("x.pdf"), 1, &one, 1, "", &why) != 0 && strstr(why.text, ".svg"));
    CHECK(pupil_plot_write(scratch("x.svg"), 1, &one, 0, "", &why) != 0 && strstr(why.text, "no frame"));
    CHECK(pupil_plot_write(scratch("none/x.svg"), 1, &one, 1, "", &why) != 0 && strstr(why.text, "none"));
    setenv("PATH", scratch_folder, 1);
    CHECK(pupil_plot_write(scratch("x.svg"), 1, &one, 1, "", &why) != 0);
    CHECK_MSG(strcmp(why.text, "--plot needs gnuplot; on Debian: apt-get install gnuplot-nox") == 0, "%s", why.text);
    CHECK(scratch_entries(scratch_folder) == before);

    /* A gnuplot that fails, or writes nothing. */
    scratch_put(scratch("gnuplot"), "#!/bin/sh\necho >&2\necho 'line 7: no such terminal' >&2\necho half\nexit 1\n");
    chmod(scratch("gnuplot"), 0755);
    CHECK(pupil_plot_write(scratch("x.svg"), 1, &one, 1, "", &why) != 0);
    CHECK_MSG(strstr(why.text, "x.svg") && strstr(why.text, "line 7: no such terminal"), "%s", why.text);
    scratch_put(scratch("gnuplot"), "#!/bin/sh\nexit 0\n");
    CHECK(pupil_plot_write(scratch("x.svg"), 1, &one, 1, "", &why) != 0 && strstr(why.text, "said nothing"));
    CHECK(scratch_entries(scratch_folder) == before + 1);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    check_thinning(100);
    check_thinning(PLOT_MOST_POINTS);
    check_thinning(PLOT_MOST_POINTS + 1);
    check_thinning(100000);
    if (system("gnuplot --version >/dev/null 2>&1") == 0)
        check_drawing();
    else
        printf("no gnuplot: nothing drawn\n");
    check_refusals();
    scratch_clear(scratch_folder);
    return check_end();
}

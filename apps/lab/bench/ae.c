/* pupil bench ae: exposure loops on a simulated camera: pupil's and published laws, each test with its limit. */
#include "ae.h"
#include "options/commands.h"
#include "output/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "common/interrupt.h"
#include "refuse.h"

enum { MOST_ROWS = 8000, LABEL = 22 };

/* --- running --- */

int bench_ae_run(bench_ae *b)
{
    static const struct {
        int (*run)(bench_ae *b, const fixture_controller *law);
        const char *makes[2];
    } tests[] = {{bench_ae_settle, {"settle", "overshoot"}},
                 {bench_ae_hunt, {"hunt", ""}},
                 {bench_ae_identify, {"identify", ""}},
                 {bench_ae_calm, {"calm", ""}},
                 {bench_ae_seam, {"seam", ""}},
                 {bench_ae_flicker, {"background", ""}},
                 {bench_ae_mains, {"bands", ""}},
                 {bench_ae_strobe, {"strobe", ""}},
                 {bench_ae_curve, {"curve", ""}},
                 {bench_ae_lies, {"lies", ""}}};
    for (size_t t = 0; t < sizeof tests / sizeof tests[0]; t++) {
        if (b->test && strcmp(b->test, tests[t].makes[0]) != 0 && strcmp(b->test, tests[t].makes[1]) != 0)
            continue;
        for (size_t i = 0; i < FIXTURE_CONTROLLERS; i++) {
            const fixture_controller *law = &fixture_controllers[i];
            if ((!b->law || b->law == law) && tests[t].run(b, law))
                return -1;
        }
    }
    return 0;
}

/* --- as lines --- */

/* JSON has no NAN. */
static void put_number(const char *name, double value)
{
    if (isfinite(value))
        printf("\"%s\":%.6g,", name, value);
    else
        printf("\"%s\":null,", name);
}

static void see_json(void *context, const bench_ae_row *row)
{
    (void)context;
    printf("{\"controller\":\"%s\",\"test\":\"%s\",\"of\":\"%s\",\"gain_law\":\"%s\",\"delay\":%u,\"believed\":%u,",
           row->law->name, row->test, row->of, row->gain_law, row->delay, row->believed);
    put_number("step_ev", row->step_ev);
    put_number("value", row->value);
    put_number("limit", row->limit);
    printf("\"unit\":\"%s\",\"pass\":%s}\n", row->unit, row->pass ? "true" : "false");
}

/* --- as tables --- */

typedef struct kept {
    bench_ae_row row;
    char of[64];
} kept;

typedef struct table {
    kept *row;
    size_t rows;
    int shown; /* progress */
} table;

static void see_table(void *context, const bench_ae_row *row)
{
    table *t = context;
    if (t->rows == MOST_ROWS)
        return;
    kept *k = &t->row[t->rows++];
    k->row = *row;
    snprintf(k->of, sizeof k->of, "%s", row->of);
    if (t->shown)
        fprintf(stderr, "\r\033[K%s: %s", row->law->name, row->test);
}

static void put_value(double value, int frames)
{
    if (isnan(value))
        printf("%8s", "never");
    else
        printf(frames ? "%8.0f" : "%8.4f", value);
}

/* Settling as in the published comparisons: one camera, delay 3, a column for each step. */
static void put_settling(const table *t, const char *test, int frames)
{
    int first = 1;
    for (size_t i = 0; i < 2 * (size_t)FIXTURE_CONTROLLERS; i++) {
        const fixture_controller *law = &fixture_controllers[i / 2];
        const int no_flash = i % 2;
        size_t found = 0;
        for (size_t k = 0; k < t->rows; k++) {
            const bench_ae_row *r = &t->row[k].row;
            if (strcmp(r->test, test) != 0 || r->delay != 3 || r->law != law ||
                (strstr(t->row[k].of, BENCH_AE_NO_FLASH) != NULL) != no_flash ||
                strcmp(r->gain_law, fixture_gain_law_name[FIXTURE_GAIN_RECIPROCAL]) != 0)
                continue;
            if (first)
                printf("%s, %s; delay 3, gain 256/(256-n)\n%-*s%8s%8s%8s%8s%8s%8s%8s%8s\n", test,
                       frames ? "frames to +-0.1 EV" : "EV", LABEL, "", "-6", "-3", "-1", "+1", "+3", "+6", "black",
                       "white");
            if (!found++)
                printf("%-*s", LABEL, no_flash ? "pupil, " BENCH_AE_NO_FLASH : law->name);
            first = 0;
            put_value(r->value, frames);
        }
        if (found)
            putchar('\n');
    }
    if (!first)
        putchar('\n');
}

/* One line for each test, its variant and controller: how many passed, and the worst with its limit. */
static void put_group(const table *t, size_t first, unsigned char *done)
{
    const bench_ae_row *of = &t->row[first].row, *worst = of;
    const int frames = strcmp(of->unit, "frames") == 0;
    size_t count = 0, passed = 0;
    for (size_t k = first; k < t->rows; k++) {
        const bench_ae_row *r = &t->row[k].row;
        if (done[k] || strcmp(r->test, of->test) != 0 || r->law != of->law ||
            strcmp(t->row[k].of, t->row[first].of) != 0)
            continue;
        done[k] = 1;
        count++;
        passed += r->pass != 0;
        if (isnan(r->value) || (!isnan(worst->value) && r->value - r->limit > worst->value - worst->limit))
            worst = r;
    }
    printf("%-11s %-44s %-15s", of->test, t->row[first].of, of->law->name);
    put_value(worst->value, frames);
    printf(frames ? "%8.0f" : "%8.4f", worst->limit);
    printf("%6zu of %zu%s\n", passed, count, passed == count ? "" : "  *");
}

static void put_tables(const table *t)
{
    unsigned char *done = calloc(t->rows + 1, 1);
    put_settling(t, "settle", 1);
    put_settling(t, "overshoot", 0);
    printf("%-11s %-44s %-15s%8s%8s  %s\n", "test", "of", "controller", "worst", "limit", "passed");
    for (size_t k = 0; done && k < t->rows; k++)
        if (!done[k])
            put_group(t, k, done);
    free(done);
}

/* --- options --- */

typedef struct options {
    bench_ae b;
    int json, quiet;
} options;

static int parse_controller(const option_value *v)
{
    options *o = v->options;
    o->b.law = fixture_controller_named(v->text);
    return o->b.law ? OPTIONS_RUN : option_refuse(v, NULL);
}

static int parse_test(const option_value *v)
{
    options *o = v->options;
    for (size_t i = 0; i < BENCH_AE_TESTS; i++)
        if (strcmp(v->text, bench_ae_tests[i]) == 0) {
            o->b.test = bench_ae_tests[i];
            return OPTIONS_RUN;
        }
    return option_refuse(v, NULL);
}

static const option_row rows[] = {
    {"controller", 0, OPTION_CHOICE, "NAME", 0, .parse = parse_controller,
     .words = "pupil|rpi|libipa|softisp|openpilot|integrator0.25|integrator1", .help = "one controller (all)"},
    {"test", 0, OPTION_CHOICE, "NAME", 0, .parse = parse_test,
     .words = "settle|overshoot|hunt|identify|calm|seam|background|bands|strobe|curve|lies", .help = "one test (all)"},
    {"plot", 0, OPTION_PATH, "FILE", offsetof(options, b.plot),
     .help = "instead, a step of +3 EV and one of -3 EV, all loops in one picture (.svg, .png)"},
    OPTION_ROW_OVERWRITE(options, b.overwrite),
    OPTION_ROW_JSON(options, json, "one object a line for each test"),
    OPTION_ROW_QUIET(options, quiet),
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command bench_ae_command = {
    .name = "bench ae",
    .summary = "exposure loops with a simulated camera: pupil's and published laws (also --ae)",
    .usage = "[options]      (also: pupil bench --ae)",
    .about = "Exposure loops with a simulated camera, side by side: how many frames they take, their\n"
             "overshoot, what they do at rest, and with wrong metadata. Each number has its limit.",
    .exits = "0 done, also where a limit is exceeded, 1 failed, 2 usage, 130 interrupted",
    .manual =
        "Compares pupil with published laws: how many frames a step of the light takes with delays from 1 to 4 and "
        "four "
        "laws of gain, the overshoot, what happens at rest, with a wrong delay configured, with flicker, strobes, "
        "nonlinear pictures and cameras whose metadata are wrong. Each number is next to the limit of a good loop. "
        "docs/sim.md describes the tests. Fields of --json: controller, test, of, gain_law, delay, believed, step_ev, "
        "value, limit, unit, pass (null: it never converged).",
    .instead = "see 'pupil bench ae --help'",
    .groups = groups,
};

/* -1: continue; else the exit status. */
static int parse(options *o, int argc, char **argv)
{
    option_words words;
    const int status = options_read(&bench_ae_command, o, argc, argv, &words);
    if (status >= 0 || !o->b.plot || !(o->b.law || o->b.test || o->json))
        return status;
    fputs("pupil bench ae: --plot draws all loops and no test; not with other options\n", stderr);
    return EXIT_USAGE;
}

int bench_ae_main(int argc, char **argv)
{
    options o = {.b = {.see = see_json}};
    bench_ae *b = &o.b;
    table t = {0};
    const int status = parse(&o, argc, argv);
    if (status >= 0)
        return status;
    b->frame = malloc(BENCH_AE_FRAMES * sizeof *b->frame);
    t.row = o.json ? NULL : calloc(MOST_ROWS, sizeof *t.row);
    t.shown = !o.quiet && isatty(STDERR_FILENO);
    if (!o.json) {
        b->see = see_table;
        b->context = &t;
    }
    interrupt_watch();
    int failed = !b->frame || (!o.json && !t.row);
    if (failed)
        pupil_refuse(&b->why, "not enough memory");
    failed = failed || (b->plot && pupil_plot_check(b->plot, b->overwrite, &b->why));
    failed = failed || (b->plot ? bench_ae_plot(b) : bench_ae_run(b));
    if (t.shown)
        fputs("\r\033[K", stderr);
    if (!failed && !o.json && !b->plot)
        put_tables(&t);
    free(b->frame);
    free(t.row);
    if (interrupt_came())
        return fputs("pupil bench ae: interrupted\n", stderr), EXIT_INTERRUPTED;
    if (failed || fflush(stdout) != 0)
        return fprintf(stderr, "pupil bench ae: %s\n", failed ? b->why.text : "standard output cannot be written"),
               EXIT_FAILED;
    return EXIT_DONE;
}

#include "plot.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "file/pending.h"
#include "file/sink_common.h"
#include "plot_series.h"

/* Colours that stay apart for every kind of colour vision: Okabe and Ito, Color Universal Design, 2008. */
#define BLUE      "#0072B2"
#define SKY       "#56B4E9"
#define VERMILION "#D55E00"
#define GREEN     "#009E73"
#define PURPLE    "#CC79A7"
#define ORANGE    "#E69F00"

extern char **environ;

/* ---- what is drawn ------------------------------------------------------------------------------------------------
 */

static double get_time(const pupil_record *r)
{
    return r->time_s;
}

static double get_metered(const pupil_record *r)
{
    return r->metered_ev;
}

static double get_adapted(const pupil_record *r)
{
    return r->adapted_ev;
}

static double get_p01(const pupil_record *r)
{
    return r->p01_ev;
}

static double get_p99(const pupil_record *r)
{
    return r->p99_ev;
}

static double get_level(const pupil_record *r)
{
    return r->output_level;
}

static double get_clipped(const pupil_record *r)
{
    return 100.0 * r->clipped_share;
}

static double get_black(const pupil_record *r)
{
    return 100.0 * r->black_share;
}

static double get_white(const pupil_record *r)
{
    return 100.0 * r->output_white_share;
}

/* ---- the script ---------------------------------------------------------------------------------------------------
 */

/* In single quotes gnuplot takes every character as it is, but a quote, which is doubled, and a line end. */
static void quoted(FILE *out, const char *text)
{
    fputc('\'', out);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', out);
        fputc(iscntrl((unsigned char)*text) ? ' ' : *text, out);
    }
    fputc('\'', out);
}

static void data(FILE *out, const pupil_record *records, size_t count)
{
    static const struct {
        const char *name;
        plot_value *value;
    } series[] = {{"metered", get_metered}, {"adapted", get_adapted}, {"level", get_level},
                  {"clipped", get_clipped}, {"black", get_black},     {"white", get_white}};
    fputs("$range << END\n", out);
    plot_band(out, records, count, get_p01, get_p99);
    fputs("END\n", out);
    for (size_t i = 0; i < sizeof series / sizeof series[0]; i++) {
        fprintf(out, "$%s << END\n", series[i].name);
        plot_series(out, records, count, series[i].value);
        fputs("END\n", out);
    }
}

/* A range that is not empty: gnuplot would widen it too, but with a warning. */
static void axis(FILE *out, char name, double low, double high, double margin, double at_least)
{
    if (low > high)
        low = high = 0.0;
    double more = margin * (high - low);
    if (high - low < at_least)
        more = 0.5 * (at_least - (high - low));
    fprintf(out, "set %crange [%.9g:%.9g]\n", name, low - more, high + more);
}

static void panel(FILE *out, int index, const char *label)
{
    static const double top[] = {0.93, 0.52, 0.29, 0.06};
    fprintf(out, "set tmargin at screen %g\nset bmargin at screen %g\n", top[index], top[index + 1] + 0.025);
    /* A label in a fixed place: gnuplot puts its own beside the numbers, however far out that is. */
    fprintf(out, "set label 1 '%s' at screen 0.016, screen %g center rotate\n", label,
            0.5 * (top[index] + top[index + 1] + 0.025));
    fprintf(out, index == 2 ? "set format x '%%g'\nset xlabel 'time, seconds' offset 0,0.4\n" : "set format x ''\n");
}

static void script(FILE *out, int is_png, const pupil_record *records, size_t count, double key, const char *title)
{
    const char *style = count <= 60 ? "linespoints pt 7 ps 0.5" : "lines";
    double from = INFINITY, to = -INFINITY, low = INFINITY, high = -INFINITY, level = 2.0 * key, nothing = 0.0,
           share = 1;
    plot_range(records, count, get_time, &from, &to);
    plot_range(records, count, get_p01, &low, &high);
    plot_range(records, count, get_p99, &low, &high);
    plot_range(records, count, get_metered, &low, &high);
    plot_range(records, count, get_adapted, &low, &high);
    plot_range(records, count, get_level, &nothing, &level);
    plot_range(records, count, get_clipped, &nothing, &share);
    plot_range(records, count, get_black, &nothing, &share);
    plot_range(records, count, get_white, &nothing, &share);

    fputs(is_png ? "set terminal pngcairo size 1000,760 font 'Sans,11' background '#ffffff'\n"
                 : "set terminal svg size 1000,760 dynamic font 'Helvetica,Arial,sans-serif,14' background '#ffffff'\n",
          out);
    data(out, records, count);
    fputs("set encoding utf8\nset multiplot title ", out);
    quoted(out, title);
    fputs(" noenhanced offset 0,0.3\nset lmargin at screen 0.075\nset rmargin at screen 0.795\n"
          "set border 3 lc '#666666'\nset tics nomirror out scale 0.6\nset grid lc '#dddddd' lt 1 lw 0.7\n"
          "set key at graph 1.015, graph 1.0 left top Left reverse samplen 1.6 spacing 1.25 noenhanced\n",
          out);
    axis(out, 'x', from, to, 0.0, 1e-3);

    panel(out, 0, "scene light, EV (stops)");
    axis(out, 'y', low, high, 0.04, 2.0);
    fprintf(out,
            "plot $range u 1:2:3 w filledcurves fc '" SKY "' fs transparent solid 0.25 noborder t '1 %% to 99 %%', "
            "$metered w %s lw 1.4 lc '" BLUE "' t 'metered', "
            "$adapted w %s lw 2.4 lc '" VERMILION "' t 'adapted'\n",
            style, style);
    panel(out, 1, "display, linear");
    axis(out, 'y', 0.0, 1.05 * level, 0.0, 0.0);
    fprintf(out,
            "plot %.9g w lines dt 2 lw 1.4 lc '#555555' t 'key %g', $level w %s lw 1.8 lc '" GREEN
            "' t 'log-average'\n",
            key, key, style);
    panel(out, 2, "share, %");
    axis(out, 'y', 0.0, 1.05 * share, 0.0, 0.0);
    fprintf(out,
            "plot $clipped w %s lw 1.8 lc '" PURPLE "' t 'input clipped', "
            "$black w %s lw 1.8 dt 3 lc '#000000' t 'input black', "
            "$white w %s lw 1.8 dt 2 lc '" ORANGE "' t 'display at 255'\nunset multiplot\n",
            style, style, style);
}

typedef struct run {
    const pupil_record *records;
    size_t count;
    double key;
    const char *title;
} run;

static void script_of_run(FILE *out, int is_png, const void *context)
{
    const run *r = context;
    script(out, is_png, r->records, r->count, r->key, r->title);
}

/* ---- the program --------------------------------------------------------------------------------------------------
 */

/* The line of gnuplot's complaint that says what is wrong: the last that is not empty (before it, it repeats the script
 * line with a mark under it). */
static void complaint(FILE *errors, char *line, size_t bytes)
{
    char next[256];
    snprintf(line, bytes, "it said nothing");
    rewind(errors);
    while (fgets(next, sizeof next, errors)) {
        size_t length = strlen(next);
        while (length && isspace((unsigned char)next[length - 1]))
            next[--length] = 0;
        if (length)
            snprintf(line, bytes, "%s", next + strspn(next, " "));
    }
}

/* Runs gnuplot with the script at its standard input and the picture from its standard output; no shell, no file name
 * in the script, nothing of the user's settings. 0, an errno, or -1: it failed and said so in `errors`. */
static int gnuplot(FILE *input, int output, FILE *errors)
{
    char *arguments[] = {(char[]){"gnuplot"}, (char[]){"--default-settings"}, (char[]){"-"}, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status, failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawn_file_actions_adddup2(&actions, fileno(input), 0);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&actions, output, 1);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&actions, fileno(errors), 2);
    if (!failed)
        failed = posix_spawnp(&child, "gnuplot", &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        return failed;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return errno;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : -1;
}

/* What gnuplot() gave back, where it is an errno, as a sentence. */
static int not_started(const char *path, int error, char *why, size_t why_bytes)
{
    if (error == ENOENT)
        return pupil_refuse(why, why_bytes, "--plot needs gnuplot; on Debian: apt-get install gnuplot-nox");
    return pupil_refuse(why, why_bytes, "%s: gnuplot cannot be started: %s", path, strerror(error));
}

static int draw(const char *path, FILE *input, FILE *errors, int output, char *why, size_t why_bytes)
{
    char line[256];
    int failed = gnuplot(input, output, errors);
    if (failed > 0)
        return not_started(path, failed, why, why_bytes);
    if (!failed && lseek(output, 0, SEEK_END) > 0)
        return 0;
    complaint(errors, line, sizeof line);
    return pupil_refuse(why, why_bytes, "%s: gnuplot cannot draw it: %s", path, line);
}

/* Whether a plot has a name that says what it is, 1 for .png, 0 for .svg; -1 and a sentence. */
static int kind_of(const char *path, char *why, size_t why_bytes)
{
    const char *ending = strrchr(path, '.');
    if (ending && strcasecmp(ending, ".png") == 0)
        return 1;
    if (ending && strcasecmp(ending, ".svg") == 0)
        return 0;
    return pupil_refuse(why, why_bytes, "%s: a plot is an .svg or a .png file", path);
}

int pupil_plot_check(const char *path, char *why, size_t why_bytes)
{
    pupil_pending pending;
    if (kind_of(path, why, why_bytes) < 0 || pupil_pending_file(&pending, path, why, why_bytes))
        return -1;
    pupil_pending_discard(&pending);
    FILE *nothing = fopen("/dev/null", "r+e");
    int failed = nothing ? gnuplot(nothing, fileno(nothing), nothing) : errno;
    if (nothing)
        fclose(nothing);
    if (failed < 0)
        return pupil_refuse(why, why_bytes, "%s: the gnuplot that is installed fails even with nothing to draw", path);
    return failed ? not_started(path, failed, why, why_bytes) : 0;
}

/* A file without a name or a place: boards may have nowhere to write but where the plot goes. */
static FILE *in_memory(void)
{
    const int fd = memfd_create("plot", MFD_CLOEXEC);
    FILE *file = fd >= 0 ? fdopen(fd, "w+") : NULL;
    if (!file && fd >= 0)
        close(fd);
    return file;
}

int pupil_plot_draw(const char *path, pupil_plot_script *write_script, const void *context, char *why, size_t why_bytes)
{
    pupil_pending pending;
    int is_png = kind_of(path, why, why_bytes);
    if (is_png < 0 || pupil_pending_file(&pending, path, why, why_bytes))
        return -1;

    int failed = -1, output = open(pending.temporary, O_WRONLY | O_TRUNC | O_CREAT | O_CLOEXEC, 0666);
    FILE *input = in_memory(), *errors = in_memory();
    if (output < 0 || !input || !errors) {
        pupil_refuse(why, why_bytes, "%s: the plot cannot be written: %s", path, strerror(errno));
    } else {
        write_script(input, is_png, context);
        failed = fflush(input) != 0 || fseek(input, 0, SEEK_SET) != 0
                     ? pupil_refuse(why, why_bytes, "%s: the plot cannot be written: %s", path, strerror(errno))
                     : draw(path, input, errors, output, why, why_bytes);
    }
    if (input)
        fclose(input);
    if (errors)
        fclose(errors);
    if (output >= 0)
        close(output);
    if (!failed)
        failed = pupil_pending_commit(&pending, why, why_bytes);
    pupil_pending_discard(&pending);
    return failed;
}

int pupil_plot_write(const char *path, const pupil_record *records, size_t count, double key, const char *title,
                     char *why, size_t why_bytes)
{
    const run r = {records, count, key, title};
    if (kind_of(path, why, why_bytes) < 0)
        return -1;
    if (!count)
        return pupil_refuse(why, why_bytes, "%s: there is no frame to plot", path);
    return pupil_plot_draw(path, script_of_run, &r, why, why_bytes);
}

/* The table of options: every row of every command has its help and is in the man page and the completion, accepts its
 * default and both ends of its range, and refuses values just outside. */
#include "check.h"
#include "options/commands.h"
#include "record/options.h"
#include "replay/options.h"

#include <math.h>

static _Alignas(16) unsigned char scratch[1 << 16]; /* as large as any command's struct */
static char *manual;

static int take(const option_row *row, void *options, const char *text, pupil_why *why)
{
    const option_value value = {row, text, text, options, why};
    *why->text = 0;
    return row->parse ? row->parse(&value) : option_take(&value);
}

static void check_taken(const option_command *command, const option_row *row, const char *text)
{
    pupil_why why;
    memset(scratch, 0, sizeof scratch);
    CHECK_MSG(take(row, scratch, text, &why) == OPTIONS_RUN, "pupil %s --%s %s: %s", command->name, row->name, text,
              why.text);
}

/* Refused with the option, its value, and what would be right. */
static void check_refused(const option_command *command, const option_row *row, const char *text, const char *words)
{
    pupil_why why;
    char begins[256];
    snprintf(begins, sizeof begins, "--%s %s: must be ", row->name, *text ? text : "\"\"");
    memset(scratch, 0, sizeof scratch);
    CHECK_MSG(take(row, scratch, text, &why) == OPTIONS_USAGE && strncmp(why.text, begins, strlen(begins)) == 0 &&
                  strstr(why.text, words),
              "pupil %s --%s %s: %s", command->name, row->name, text, why.text);
}

static void check_range(const option_command *command, const option_row *row)
{
    char text[64];
    const int whole = row->kind == OPTION_COUNT || row->kind == OPTION_COUNT32;
    const char *unit = row->kind == OPTION_TIME ? "s" : "";
    const double below = whole ? row->low - 1.0 : nextafter(row->low, -INFINITY);
    const double above = whole ? row->high + 1.0 : nextafter(row->high, INFINITY);
    CHECK_MSG(row->low < row->high, "pupil %s --%s has no range", command->name, row->name);
    snprintf(text, sizeof text, "%.17g%s", row->low, unit);
    check_taken(command, row, text);
    snprintf(text, sizeof text, "%.17g%s", below, unit);
    check_refused(command, row, text, "");
    if (row->high < 0x1p62) {
        snprintf(text, sizeof text, "%.17g%s", row->high, unit);
        check_taken(command, row, text);
        snprintf(text, sizeof text, "%.17g%s", above, unit);
        check_refused(command, row, text, "");
    }
    check_refused(command, row, "", "");
    check_refused(command, row, "nan", "");
    check_refused(command, row, "1x", "");
}

static void check_size(const option_command *command, const option_row *row)
{
    char text[64];
    snprintf(text, sizeof text, "%.0fx%.0f", row->high, row->high);
    check_taken(command, row, text);
    snprintf(text, sizeof text, "%.0fx4", row->high + 1.0);
    check_refused(command, row, text, "WIDTHxHEIGHT");
    snprintf(text, sizeof text, "4x%.0f", row->high + 1.0);
    check_refused(command, row, text, "WIDTHxHEIGHT");
    static const char *const wrong[] = {"", "0x4", "4x0", "64", "64x", "x64", "-4x4", "4x4x4", "4 x4", "4x 4"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        check_refused(command, row, wrong[i], "");
}

/* The completions of `pupil COMMAND WORD` or `pupil COMMAND WORD ""`. */
static const char *completed(const option_command *command, const char *word)
{
    static char text[4096];
    char name[64], empty[] = "", last[64], *words[4] = {name};
    int count = 1;
    snprintf(name, sizeof name, "%s", command->name);
    snprintf(last, sizeof last, "%s", word);
    char *part = strchr(name, ' ');
    if (part) {
        *part = 0;
        words[count++] = part + 1;
    }
    words[count++] = last;
    if (strlen(word) > 2)
        words[count++] = empty;
    FILE *out = fmemopen(text, sizeof text, "w");
    options_complete(pupil_commands, count, words, out);
    fclose(out);
    return text;
}

static void check_choice(const option_command *command, const option_row *row)
{
    char word[64], name[64];
    snprintf(name, sizeof name, "--%s", row->name);
    for (const char *words = option_words_of(row); *words; words += strcspn(words, "|"), words += *words == '|') {
        snprintf(word, sizeof word, "%.*s", (int)strcspn(words, "|"), words);
        check_taken(command, row, word);
        check_refused(command, row, "nonsense", word);
        CHECK_MSG(strstr(completed(command, name), word), "pupil %s %s: %s", command->name, name, word);
    }
    check_refused(command, row, "", "");
}

static void check_row(const option_command *command, const option_row *row)
{
    char name[128], escaped[128] = "\\-\\-";
    CHECK_MSG(row->help && *row->help && row->help[strlen(row->help) - 1] != '.', "pupil %s --%s: help", command->name,
              row->name);
    CHECK_MSG(!row->more || row->more[strlen(row->more) - 1] == '.', "pupil %s --%s: more", command->name, row->name);
    CHECK_MSG((row->kind == OPTION_FLAG) == !row->value, "pupil %s --%s: its value has a name", command->name,
              row->name);
    snprintf(name, sizeof name, "--%s\n", row->name);
    CHECK_MSG(strstr(completed(command, "-"), name), "pupil %s --%s is not completed", command->name, row->name);
    for (const char *c = row->name; *c; c++)
        snprintf(escaped + strlen(escaped), sizeof escaped - strlen(escaped), "%s%c", *c == '-' ? "\\" : "", *c);
    CHECK_MSG(strcmp(row->name, "help") == 0 || strstr(manual, escaped), "%s is not in the man page", escaped);
    if (row->initial)
        check_taken(command, row, row->initial);
    if (row->kind == OPTION_CHOICE)
        check_choice(command, row);
    if (row->parse)
        return;
    if (row->kind == OPTION_SIZE)
        check_size(command, row);
    if (row->kind == OPTION_TEXT || row->kind == OPTION_PATH)
        check_refused(command, row, "", "");
    if (row->kind == OPTION_NUMBER || row->kind == OPTION_COUNT || row->kind == OPTION_COUNT32 ||
        row->kind == OPTION_TIME)
        check_range(command, row);
}

static void check_commands(const option_command *const *commands)
{
    const option_row *row, *other;
    size_t base;
    for (; *commands; commands++) {
        const option_command *c = *commands;
        size_t n = 0;
        if (c->parts) {
            check_commands(c->parts);
            continue;
        }
        for (; (row = options_row(c, n, &base)); n++) {
            check_row(c, row);
            for (size_t k = 0; k < n; k++) {
                other = options_row(c, k, &base);
                CHECK_MSG(strcmp(row->name, other->name) != 0, "pupil %s has two --%s", c->name, row->name);
                CHECK_MSG(!row->letter || row->letter != other->letter, "pupil %s has two -%c", c->name, row->letter);
            }
        }
        CHECK_MSG(n <= OPTION_MOST_ROWS, "pupil %s has %zu options; the parser holds %d", c->name, n, OPTION_MOST_ROWS);
    }
}

static size_t bytes_of(option_kind kind)
{
    return kind == OPTION_COUNT32 || kind == OPTION_CHOICE ? sizeof(uint32_t)
           : kind == OPTION_SIZE                           ? 2 * sizeof(uint32_t)
           : kind == OPTION_NUMBER || kind == OPTION_TIME  ? sizeof(double)
           : kind == OPTION_COUNT                          ? sizeof(uint64_t)
                                                           : 0;
}

/* The default in the help is the value without the option. */
static void check_defaults(const option_command *command, const void *options)
{
    const option_row *row;
    pupil_why why;
    size_t base;
    for (size_t n = 0; (row = options_row(command, n, &base)); n++) {
        const unsigned char *before = (const unsigned char *)options + base + row->offset;
        if (!row->initial || row->parse)
            continue;
        memset(scratch, 0xa5, sizeof scratch);
        CHECK(take(row, scratch, row->initial, &why) == OPTIONS_RUN);
        CHECK_MSG(memcmp(before, scratch + row->offset, bytes_of(row->kind)) == 0, "pupil %s --%s is not %s without it",
                  command->name, row->name, row->initial);
    }
}

static void test_defaults(void)
{
    static frame_options frame;
    static run_options run;
    static record_options record;
    pupil_why why;
    char *replay_words[] = {"replay", "x.exr", NULL}, *run_words[] = {"run", NULL},
         *record_words[] = {"record", "x", NULL};
    CHECK(replay_options_parse(&frame, 2, replay_words, &why) == OPTIONS_RUN);
    CHECK(run_options_parse(&run, 1, run_words, &why) == OPTIONS_RUN);
    CHECK(record_options_parse(&record, 2, record_words, &why) == OPTIONS_RUN);
    check_defaults(&replay_command, &frame);
    check_defaults(&run_command, &run);
    check_defaults(&record_command, &record);
}

/* The words of one command line, and the expected message or result. */
static int parse(const char *line, frame_options *o, pupil_why *why)
{
    static char words[256], *argv[16];
    int argc = 0;
    snprintf(words, sizeof words, "%s", line);
    for (char *word = strtok(words, " "); word; word = strtok(NULL, " "))
        argv[argc++] = word;
    argv[argc] = NULL;
    *why->text = 0;
    return replay_options_parse(o, argc, argv, why);
}

static void says(const char *line, const char *sentence)
{
    frame_options o;
    pupil_why why;
    CHECK_MSG(parse(line, &o, &why) == OPTIONS_USAGE && strstr(why.text, sentence), "%s: %s", line, why.text);
}

static void test_lines(void)
{
    frame_options o;
    pupil_why why;
    says("replay x --metreing spot", "--metreing: no such option of pupil replay; perhaps --metering; 'pupil replay");
    says("replay x --tau-drk=3", "--tau-drk: no such option of pupil replay; perhaps --tau-dark;");
    says("replay x --tau 3", "--tau: no such option of pupil replay; perhaps --tau-light;");
    says("replay x --meter spot", "--meter: no such option of pupil replay; perhaps --meter");
    says("replay x --moon 3", "--moon: no such option of pupil replay; 'pupil replay --help' lists them");
    says("replay x --lo", "--lo: no such option of pupil replay; perhaps --lo");
    says("replay x --xev 1", "--xev: no such option of pupil replay; 'pupil replay --help' lists them");
    says("replay x --shutter 10ms", "--shutter: no such option of pupil replay; it is of pupil run, pupil record;");
    says("replay x --contrast 2", "--contrast: no such option of pupil replay; --tone chooses a curve; the rest is");
    says("replay x -crf 2", "-crf: no such option of pupil replay; coding is ffmpeg's: pupil replay IN -q -o - |");
    says("replay x --exposure 1",
         "--exposure: no such option of pupil replay; a camera's exposure time: pupil run --sh");
    says("replay x --output y", "--output: no such option of pupil replay; -o names outputs; the folder of");
    says("replay x --output=y", "--output: no such option of pupil replay; -o names outputs;");
    says("replay -i x", "-i: no such option of pupil replay; inputs have no option in front: pupil replay IN.mp4");
    if (bench_command.parts) /* this build has the command */
        says("replay x --peers", "it is of pupil bench kernels;");
    says("replay x -d 5", "-d: no such option of pupil replay; it is of pupil run, pupil record");
    says("replay x -qz", "-z: no such option of pupil replay; 'pupil");
    says("replay x --fps", "--fps: its value is missing");
    says("replay x -n", "-n: its value is missing");
    says("replay x --lock=1", "--lock: takes no value");
    says("replay x -n 0", "--frames 0: must be a whole number of frames, 1 or more");
    says("replay x --ev 17", "--ev 17: must be stops, from -16 to 16");
    says("replay x --tau-dark 2e6", "--tau-dark 2e6: must be seconds, from 0 to 1000000");
    says("replay x --transfer pq", "--transfer pq: must be srgb, gamma22 or linear");
    says("replay x --ss 1:75", "--ss 1:75: must be seconds, 500ms, 2min or 00:01:30");
    says("replay x --ss 1:2:3:4", "--ss 1:2:3:4: must be");
    says("replay x --ss 1:-5", "--ss 1:-5: must be");
    says("replay x --ss 1:5s", "--ss 1:5s: must be");
    says("replay x -t 0:00", "--duration 0:00: must be");
    says("replay x --metering moon", "--metering moon: must be uniform, centre or spot");
    CHECK(parse("replay a -yq --fps=24 b -n3 -- --lock -q", &o, &why) == OPTIONS_RUN);
    CHECK(o.overwrite && o.quiet && o.source.fps == 24.0 && o.most == 3 && !o.config.lock && o.input_count == 4);
    CHECK(strcmp(o.inputs[0], "a") == 0 && strcmp(o.inputs[1], "b") == 0 && strcmp(o.inputs[2], "--lock") == 0 &&
          strcmp(o.inputs[3], "-q") == 0);
    CHECK(parse("replay a --fps 24 -n 3 --fps 25 -n 4", &o, &why) == OPTIONS_RUN && o.source.fps == 25.0 &&
          o.most == 4);
    CHECK(parse("replay a -ss 01:02:03.5 -t 90:00", &o, &why) == OPTIONS_RUN && o.start_s == 3723.5 &&
          o.duration_s == 5400.0);
    CHECK(parse("replay a -ss 0:01", &o, &why) == OPTIONS_RUN && o.start_s == 1.0);
    CHECK(parse("replay -o -- a", &o, &why) == OPTIONS_RUN && strcmp(o.out[0], "--") == 0 && o.input_count == 1);
    CHECK(parse("replay a --metering center", &o, &why) == OPTIONS_RUN && strcmp(o.metering, "centre") == 0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    option_commands = pupil_commands;
    size_t bytes;
    FILE *out = open_memstream(&manual, &bytes);
    options_manual(pupil_commands, out);
    fclose(out);
    check_commands(pupil_commands);
    test_defaults();
    test_lines();
    free(manual);
    return check_end();
}

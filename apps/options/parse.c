/* A command line by a table of options. */
#include <getopt.h>
#include <string.h>

#include "common/report_error.h"
#include "option_table.h"
#include "refuse.h"

enum { FIRST_CODE = 256 /* above every letter */ };

const option_command *const *option_commands;

/* What getopt_long reads: the names, and the letters, with a colon after those that take a value. */
typedef struct known {
    struct option name[OPTION_MOST_ROWS + 1];
    char letters[2 * OPTION_MOST_ROWS + 3];
} known;

static void make_known(const option_command *command, known *k)
{
    const option_row *row;
    size_t base;
    char *end = k->letters;
    *end++ = '+'; /* stops at operands, which are gathered below */
    *end++ = ':'; /* distinguishes a missing value from an option that is not known */
    for (size_t n = 0; n < OPTION_MOST_ROWS && (row = options_row(command, n, &base)); n++) {
        const int takes = row->kind == OPTION_FLAG ? no_argument : required_argument;
        k->name[n] = (struct option){row->name, takes, NULL, FIRST_CODE + (int)n};
        k->name[n + 1] = (struct option){NULL, 0, NULL, 0};
        if (row->letter)
            *end++ = row->letter;
        if (row->letter && takes == required_argument)
            *end++ = ':';
    }
    *end = 0;
}

/* The place of the row that getopt_long found. */
static size_t place_of(const option_command *command, int code)
{
    const option_row *row;
    size_t n = 0, base;
    if (code >= FIRST_CODE)
        return (size_t)(code - FIRST_CODE);
    while ((row = options_row(command, n, &base)) && row->letter != code)
        n++;
    return n;
}

static int has(const option_command *command, const char *name, size_t length, char letter)
{
    const option_row *row;
    size_t base;
    for (size_t n = 0; (row = options_row(command, n, &base)); n++)
        if (letter ? row->letter == letter : strncmp(row->name, name, length) == 0 && !row->name[length])
            return 1;
    return 0;
}

/* "; pupil replay and pupil run have it", if other commands have the option, or nothing. */
static void others(const option_command *const *commands, const char *name, size_t length, char letter, char *text,
                   size_t bytes)
{
    for (; commands && *commands; commands++) {
        if ((*commands)->parts)
            others((*commands)->parts, name, length, letter, text, bytes);
        else if (has(*commands, name, length, letter))
            snprintf(text + strlen(text), bytes - strlen(text), "%s pupil %s", *text ? "," : "; it is of",
                     (*commands)->name);
    }
}

/* "; perhaps --metering", or nothing. */
static void perhaps(const option_command *command, const char *name, char *text, size_t bytes)
{
    option_near near;
    const option_row *row;
    size_t base;
    option_near_begin(&near, name);
    for (size_t n = 0; (row = options_row(command, n, &base)); n++)
        option_near_try(&near, row->name);
    if (near.name)
        snprintf(text, bytes, "; perhaps --%s", near.name);
}

/* The same for a name from other programs. */
static void instead(const char *name, char *text, size_t bytes)
{
    const char *sought = option_sought(name);
    if (sought)
        snprintf(text, bytes, "; %s", sought);
}

/* Refuses an option that getopt_long did not take: `code` is its answer, optopt its option. */
static int refuse(const option_command *command, int code, const char *word, pupil_why *why)
{
    char name[128], also[512] = "";
    size_t base;
    const int is_long_name = word[0] == '-' && word[1] != '-' && word[1] && word[2]; /* -crf, as in ffmpeg */
    if (optopt >= FIRST_CODE)
        snprintf(name, sizeof name, "--%s", options_row(command, place_of(command, optopt), &base)->name);
    else if (optopt)
        snprintf(name, sizeof name, "-%c", optopt);
    else
        snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "="), word);
    if (code == ':')
        return pupil_refuse(why, "%s: its value is missing; 'pupil %s --help' has more", name, command->name);
    if (optopt >= FIRST_CODE)
        return pupil_refuse(why, "%s: takes no value", name);
    const char *long_name = optopt ? "" : name + strspn(name, "-");
    others(option_commands, long_name, strlen(long_name), (char)optopt, also, sizeof also);
    if (is_long_name && option_sought(word + 1)) {
        instead(word + 1, also, sizeof also);
        snprintf(name, sizeof name, "%s", word);
    }
    if (!*also)
        instead(optopt ? name + 1 : long_name, also, sizeof also);
    if (!*also)
        perhaps(command, long_name, also, sizeof also);
    return pupil_refuse(why, "%s: no such option of pupil %s%s; 'pupil %s --help' lists them", name, command->name,
                        also, command->name);
}

/* "--output": no option, and getopt_long would take it for the beginning of --output-primaries. */
static int is_sought(const option_command *command, const char *word)
{
    char name[64];
    if (!word || strncmp(word, "--", 2) != 0)
        return 0;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="), word + 2);
    return option_sought(name) && !has(command, name, strlen(name), 0);
}

/* `second`: the word after the value; NULL: none. */
static int take(const option_command *command, size_t place, const char *second, void *options, pupil_why *why)
{
    size_t base;
    const option_row *row = options_row(command, place, &base);
    const option_value value = {row, optarg, second, (char *)options + base, why};
    if (row->kind == OPTION_PAIR && second)
        optind++;
    else if (row->kind == OPTION_PAIR)
        return pupil_refuse(why, "--%s: its second value is missing; must be %s", row->name, row->right);
    if (row->letter == 'h') {
        options_help(command, stdout);
        return OPTIONS_HELP;
    }
    return row->parse ? row->parse(&value) : option_take(&value);
}

int options_parse(const option_command *command, void *options, int argc, char **argv, option_words *words,
                  pupil_why *why)
{
    known k;
    make_known(command, &k);
    *words = (option_words){.word = argv + 1};
    opterr = 0;
    optind = 0; /* start over: another command line may have been read before */
    for (int all = 0; optind < argc;) {
        const int before = optind ? optind : 1;
        if (!all && is_sought(command, argv[before])) {
            optopt = 0;
            return refuse(command, '?', argv[before], why);
        }
        const int code = all ? -1 : getopt_long(argc, argv, k.letters, k.name, NULL);
        if (code == -1) {
            all |= optind > before; /* past "--": nothing but operands */
            if (optind < argc)
                words->word[words->count++] = argv[optind++];
            continue;
        }
        if (code == '?' || code == ':')
            return refuse(command, code, argv[optind > before ? optind - 1 : optind], why);
        const size_t place = place_of(command, code);
        words->given[place / 64] |= UINT64_C(1) << place % 64;
        const int taken = take(command, place, optind < argc ? argv[optind] : NULL, options, why);
        if (taken)
            return taken;
    }
    if (words->count && command->instead)
        return pupil_refuse(why, "%s: it takes no argument; %s", words->word[0], command->instead);
    return OPTIONS_RUN;
}

int options_read(const option_command *command, void *options, int argc, char **argv, option_words *words)
{
    pupil_why why;
    char name[64];
    const int parsed = options_parse(command, options, argc, argv, words, &why);
    if (parsed != OPTIONS_USAGE)
        return parsed == OPTIONS_HELP ? 0 : -1;
    snprintf(name, sizeof name, "pupil %s", command->name);
    report_error(name, &why, "");
    return 2;
}

int options_given(const option_command *command, const option_words *words, const char *name)
{
    const option_row *row;
    size_t base;
    for (size_t n = 0; (row = options_row(command, n, &base)); n++)
        if (strcmp(row->name, name) == 0)
            return (words->given[n / 64] >> n % 64 & 1) != 0;
    return 0;
}

const option_command *options_command(const option_command *const *commands, const char *name)
{
    for (; *commands; commands++) {
        if (strcmp((*commands)->name, name) == 0)
            return *commands;
        const option_command *part = (*commands)->parts ? options_command((*commands)->parts, name) : NULL;
        if (part)
            return part;
    }
    return NULL;
}

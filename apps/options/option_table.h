/* apps/options/option_table.h: the options of a command as rows of a table. A command line is parsed and checked by
 * these rows, and --help, the man page and completion are made from them. */
#ifndef PUPIL_APPS_OPTIONS_OPTION_TABLE_H
#define PUPIL_APPS_OPTIONS_OPTION_TABLE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "pupil/error.h"

typedef struct option_row option_row;

/* The value of one option on a command line. */
typedef struct option_value {
    const option_row *row;
    const char *text;
    const char *second; /* of a pair */
    void *options;      /* the struct that row->offset is in */
    pupil_why *why;
} option_value;

/* What an option takes and, at its offset, sets. Ranges include their ends. */
typedef enum option_kind {
    OPTION_FLAG = 0, /* no value: an int or a uint32_t, to 1 */
    OPTION_NUMBER,   /* a double, low..high */
    OPTION_COUNT,    /* a uint64_t, low..high */
    OPTION_COUNT32,  /* a uint32_t, low..high */
    OPTION_CHOICE,   /* one of the words ("a|b|c") of `value` or `words`: low and its place in a uint32_t */
    OPTION_TIME,     /* 10ms, 1/100, 2min, and where unit_s is 1 also 1:02:03.5; a plain number counts in unit_s: a
                      * double in seconds, low..high */
    OPTION_SIZE,     /* 640x360: two uint32_t, each 1..high */
    OPTION_TEXT,     /* a const char *, not empty */
    OPTION_PATH,     /* the same; completed as a file's name */
    OPTION_PAIR      /* two words: two const char *; empty ones are allowed */
} option_kind;

struct option_row {
    const char *name; /* without its dashes */
    char letter;      /* 0: none */
    option_kind kind;
    const char *value; /* what the value is called; of a choice its words, unless they are in `words` */
    size_t offset;
    double low, high;
    double unit_s;
    const char *unit;                        /* "seconds", in front of the range in a sentence; NULL: a number */
    const char *right;                       /* "must be ..."; NULL: made of kind, unit and range */
    const char *initial;                     /* the default; NULL: none, or `help` says it */
    const char *help;                        /* a phrase without a full stop, for --help and the man page */
    const char *more;                        /* sentences that the man page adds; NULL */
    const char *words;                       /* of a choice with too many for `value`: they follow `help`; NULL */
    int (*parse)(const option_value *value); /* instead of the kind's own; returns as options_parse */
};

/* Rows under one title. */
typedef struct option_group {
    const char *title; /* NULL: continues with the group before */
    const option_row *row;
    size_t rows;
    size_t base;       /* of the rows' struct in the command's */
    const char *brief; /* --help has only the names of the rows, and "as of pupil BRIEF" unless it is ""; NULL */
} option_group;

#define OPTION_ROWS(array) .row = (array), .rows = sizeof(array) / sizeof *(array)

typedef struct option_command option_command;
struct option_command {
    const char *name;                   /* "replay", "bench scene" */
    const char *summary;                /* for `pupil help` */
    const char *usage;                  /* a line for each way to call it, without "pupil NAME" */
    const char *about;                  /* lines of --help before the options */
    const char *exits;                  /* the exit statuses */
    const char *manual;                 /* paragraphs of the man page, with an empty line between */
    const char *instead;                /* of a command without operands: what a user may have meant */
    const option_group *groups;         /* ended by one without rows */
    const option_command *const *parts; /* `pupil bench scene` and so on, ended by NULL; NULL: none */
};

#define OPTION_MOST_ROWS 192 /* of a command, --help among them; test_apps_options_table checks it */

/* What options_parse finds besides the values. */
typedef struct option_words {
    char **word; /* the operands, moved to the front of argv */
    int count;
    uint64_t given[OPTION_MOST_ROWS / 64]; /* a bit for each row */
} option_words;

enum { OPTIONS_RUN = 0, OPTIONS_HELP = 1, OPTIONS_USAGE = -1 /* as pupil_refuse */ };

/* All commands, ended by NULL, so that an option of another command is recognised. NULL: none are known. */
extern const option_command *const *option_commands;

/* Sets the given options in `options`, which has the defaults. OPTIONS_RUN; OPTIONS_HELP if help was asked for, which
 * was then printed on standard output; OPTIONS_USAGE and a sentence that names the option, its value, and the right
 * form. */
int options_parse(const option_command *command, void *options, int argc, char **argv, option_words *words,
                  pupil_why *why);

/* The same with the sentence on standard error. -1: continue; else the exit status. */
int options_read(const option_command *command, void *options, int argc, char **argv, option_words *words);

/* Whether an option was on the command line. */
int options_given(const option_command *command, const option_words *words, const char *name);

/* The sentence of OPTIONS_USAGE: "--NAME TEXT: must be RIGHT"; NULL: as the row says. Returns OPTIONS_USAGE. */
int option_refuse(const option_value *value, const char *right);

/* Parses as the row's kind says; all but option_take are given the range and the place for the result. */
int option_take(const option_value *value);
int option_number(const option_value *value, double low, double high, double *number);
int option_whole(const option_value *value, double low, double high, uint64_t *whole);
int option_time(const option_value *value, double low_s, double high_s, double *seconds);
/* `count` numbers, separated by commas. */
int option_numbers(const option_value *value, int count, double *numbers);
/* The index of the text among words separated by |, or -1. */
int option_word(const char *text, const char *words);

/* The command of a name, "bench" or "bench scene"; NULL. */
const option_command *options_command(const option_command *const *commands, const char *name);

/* The name nearest to a misspelt one: at most two letters off, and fewer than half of them; or one that begins with it.
 */
typedef struct option_near {
    const char *given;
    const char *name; /* NULL: none is near */
    size_t distance;
} option_near;
void option_near_begin(option_near *near, const char *given);
void option_near_try(option_near *near, const char *name);

/* What pupil has instead of an option of this name, as a clause; NULL. */
const char *option_sought(const char *name);

/* The row and the base of a command's n-th option; NULL after the last, which is --help. */
const option_row *options_row(const option_command *command, size_t n, size_t *base);

/* Of a choice: a|b|c. */
const char *option_words_of(const option_row *row);

/* The right form, as in the sentence. */
void option_right(const option_row *row, char *text, size_t bytes);

/* --help of one command; all commands as a man page. */
void options_help(const option_command *command, FILE *out);
void options_manual(const option_command *const *commands, FILE *out);

/* The completion script for bash; and, for the script, all possible last words, a line each. */
void options_completion(FILE *out);
void options_complete(const option_command *const *commands, int count, char **words, FILE *out);

/* Rows that several commands have. */
#define OPTION_ROW_QUIET(type, field)                                                                                  \
    {                                                                                                                  \
        "quiet", 'q', OPTION_FLAG, NULL, offsetof(type, field), .help = "no progress line and no summary"              \
    }
#define OPTION_ROW_OVERWRITE(type, field)                                                                              \
    {                                                                                                                  \
        "overwrite", 'y', OPTION_FLAG, NULL, offsetof(type, field), .help = "replace outputs that are there"           \
    }
#define OPTION_ROW_JSON(type, field, what)                                                                             \
    {                                                                                                                  \
        "json", 0, OPTION_FLAG, NULL, offsetof(type, field), .help = what                                              \
    }
#define OPTION_ROW_THREADS(type, field, without)                                                                       \
    {                                                                                                                  \
        "threads", 0, OPTION_COUNT32, "N", offsetof(type, field), .high = 256, .initial = without,                     \
                                                                  .help = "worker threads, 0: one a processor"         \
    }

#endif

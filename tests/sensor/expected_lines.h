/* A test's lines, compared with a file of this folder; with --write they replace it. */
#ifndef PUPIL_TESTS_EXPECTED_LINES_H
#define PUPIL_TESTS_EXPECTED_LINES_H

#include <stdio.h>
#include <string.h>

#include "check.h"

typedef struct expected_lines {
    const char *name;
    FILE *file; /* NULL: it cannot be opened */
    int writes;
} expected_lines;

/* In place of check_begin. */
static inline expected_lines expected_begin(const char *name, int argc, char **argv)
{
    char path[4096];
    expected_lines e = {.name = name, .writes = argc == 2 && strcmp(argv[1], "--write") == 0};
    check_begin(e.writes ? 1 : argc, argv);
    snprintf(path, sizeof path, PUPIL_SOURCE_DIR "/tests/sensor/%s", name);
    e.file = fopen(path, e.writes ? "w" : "r");
    CHECK_MSG(e.file, "%s", path);
    return e;
}

static inline void expected_line(const expected_lines *e, const char *line)
{
    char expected[256];
    if (e->writes) {
        CHECK(fputs(line, e->file) >= 0);
        return;
    }
    const int is_there = fgets(expected, sizeof expected, e->file) != NULL;
    CHECK_MSG(is_there && strcmp(line, expected) == 0, "%s: %s    now: %s", e->name, is_there ? expected : "\n", line);
}

/* In place of check_end. */
static inline int expected_end(const expected_lines *e)
{
    CHECK(!e->file || fclose(e->file) == 0);
    return check_end();
}

#endif

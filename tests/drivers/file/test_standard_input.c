/* Standard input: how its kind is detected, what stays in the pipe, and calls that a signal interrupts. */
#include "file/standard_input.h"

#include <fcntl.h>

#include "check.h"
#include "nth_call/nth_call.h"
#include "scratch.h"

static pupil_why why;

static int stopping;

static int stop(void)
{
    return stopping;
}

/* Makes standard input a pipe or a file with these bytes; returns the old one, for take_back. */
static int give(const char *bytes, size_t size, int as_file)
{
    int ends[2] = {-1, -1};
    const int saved = dup(STDIN_FILENO);
    if (as_file) {
        ends[0] = open(scratch("input"), O_RDWR | O_CREAT | O_TRUNC, 0600);
        CHECK(write(ends[0], bytes, size) == (ssize_t)size && lseek(ends[0], 0, SEEK_SET) == 0);
    } else {
        CHECK(pipe(ends) == 0 && write(ends[1], bytes, size) == (ssize_t)size);
        close(ends[1]);
    }
    dup2(ends[0], STDIN_FILENO);
    close(ends[0]);
    why.text[0] = 0;
    return saved;
}

static void take_back(int saved)
{
    dup2(saved, STDIN_FILENO);
    close(saved);
}

static const struct {
    const char *bytes;
    size_t size;
    int is_still;
} inputs[] = {{"\x76\x2f\x31\x01 EXR", 8, 1},
              {"\x89PNG....", 8, 1},
              {"#?RADIANCE\n", 11, 1},
              {"PF\n1 1\n", 7, 1},
              {"Pf\n1 1\n", 7, 1},
              {"II*\0....", 8, 1},
              {"MM\0*....", 8, 1},
              {"MM*\0....", 8, 0},
              {"P", 1, 0},
              {"", 0, 0},
              {"YUV4MPEG2 W1 H1\n", 16, 0},
              {"\0\0\0\x10"
               "ftypisom\0\0\2\0\0\0\0\x10moov",
               24, 0}, /* its index comes first: streamed */
              {"\0\0\0\x10"
               "ftypisom\0\0\2\0\0\0\0\x10mdat",
               24, 0}, /* last: read into memory */
              {"\0\0\1\0"
               "ftypisom",
               12, 0},
              {"\0\0\0\x10"
               "ftyp",
               8, 0}};

static void test_kinds(void)
{
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++)
        for (int as_file = 0; as_file < 2; as_file++) {
            char then[256];
            size_t size = 0;
            const int saved = give(inputs[i].bytes, inputs[i].size, as_file);
            const int got = pupil_standard_input_prepare(NULL, &why);
            for (ssize_t more; (more = read(STDIN_FILENO, then + size, sizeof then - size)) > 0;)
                size += (size_t)more;
            take_back(saved);
            CHECK_MSG(got == inputs[i].is_still, "input %zu: %d, %s", i, got, why.text);
            CHECK_MSG(size == inputs[i].size && memcmp(then, inputs[i].bytes, size) == 0, "input %zu: %zu bytes remain",
                      i, size);
        }
}

enum { FAILS, INTERRUPTED, STOPPED };

/* Runs with one call failing or interrupted. Without a request to stop, a signal does not affect a read; otherwise
 * there is a sentence. 0: there is no such call. */
static int run(size_t i, int as_file, int how, unsigned long at)
{
    const char *failed;
    const int saved = give(inputs[i].bytes, inputs[i].size, as_file);
    stopping = how == STOPPED;
    nth_begin(at, how == FAILS ? NTH_FAILS : NTH_INTERRUPTED);
    const int got = pupil_standard_input_prepare(how == FAILS ? NULL : stop, &why);
    nth_end(&failed);
    take_back(saved);
    const char *call = failed ? failed : "none";
    if (got < 0)
        CHECK_MSG(failed && strstr(why.text, "standard input: "), "input %zu, call %lu (%s): %s", i, at, call,
                  why.text);
    else
        CHECK_MSG(got == inputs[i].is_still, "input %zu, call %lu (%s): %d", i, at, call, got);
    CHECK_MSG(got >= 0 || how != INTERRUPTED || strcmp(call, "read") != 0, "input %zu, call %lu: %s", i, at, why.text);
    return failed != NULL;
}

static void test_each_call(void)
{
    static const char *const only[] = {"read",  "pread", "pipe2", "fstat", "memfd_create",
                                       "lseek", "write", "dup2",  NULL};
    nth_only(only);
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++)
        for (int as_file = 0; as_file < 2; as_file++)
            for (int how = FAILS; how <= STOPPED; how++)
                for (unsigned long at = 1; run(i, as_file, how, at);)
                    at++;
    nth_only(NULL);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_kinds();
    test_each_call();
    scratch_clear(scratch_folder);
    return check_end();
}

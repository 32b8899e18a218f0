/* tests/check.h: the whole test framework. A test is a program: exit 0 passed, 1 failed, 76 or 77 skipped
 * (run_test.sh).
 *
 *     int main(int argc, char **argv)
 *     {
 *         check_begin(argc, argv);          // [SEED [all]]
 *         CHECK(2 + 2 == 4);
 *         CHECK_MSG(x < y, "x %g y %g", x, y);
 *         return check_end();
 *     }
 *
 * A failed check prints where, what, the seed and the command that reruns the program with that seed; the program
 * continues.
 */
#ifndef PUPIL_TESTS_CHECK_H
#define PUPIL_TESTS_CHECK_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define CHECK_CANNOT  76
#define CHECK_SKIPPED 77

static struct {
    const char *program;
    uint64_t seed, random;
    unsigned long checks, failures;
    int all;
} check_state;

static inline void check_begin(int argc, char **argv)
{
    check_state.program = argv[0];
    check_state.seed = argc > 1 ? strtoull(argv[1], NULL, 0) : UINT64_C(20261120);
    check_state.random = check_state.seed;
    check_state.all = argc > 2 && strcmp(argv[2], "all") == 0;
}

static inline int check_end(void)
{
    printf("%s: %lu checks, %lu failed\n", check_state.program, check_state.checks, check_state.failures);
    return check_state.failures ? 1 : 0;
}

static inline void check_failed(const char *file, int line, const char *what)
{
    if (check_state.failures++ < 20)
        printf("%s:%d: FAILED: %s   seed %llu, again with: %s %llu\n", file, line, what,
               (unsigned long long)check_state.seed, check_state.program, (unsigned long long)check_state.seed);
}

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        check_state.checks++;                                                                                          \
        if (!(condition))                                                                                              \
            check_failed(__FILE__, __LINE__, #condition);                                                              \
    } while (0)

#define CHECK_MSG(condition, ...)                                                                                      \
    do {                                                                                                               \
        check_state.checks++;                                                                                          \
        if (!(condition)) {                                                                                            \
            check_failed(__FILE__, __LINE__, #condition);                                                              \
            if (check_state.failures <= 20) {                                                                          \
                printf("    ");                                                                                        \
                printf(__VA_ARGS__);                                                                                   \
                printf("\n");                                                                                          \
            }                                                                                                          \
        }                                                                                                              \
    } while (0)

/* Random numbers from the seed: SplitMix64 (Steele, Lea, Flood 2014). */
static inline uint64_t check_random(void)
{
    uint64_t z = (check_state.random += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static inline double check_uniform(void) /* in [0, 1) */
{
    return (double)(check_random() >> 11) * 0x1p-53;
}

/* 1 if the address sanitizer is built in; gcc and clang report that differently. */
#if defined __SANITIZE_ADDRESS__
#define CHECK_SANITIZED 1
#elif defined __has_feature
#if __has_feature(address_sanitizer)
#define CHECK_SANITIZED 1
#endif
#endif
#ifndef CHECK_SANITIZED
#define CHECK_SANITIZED 0
#endif

/* How many of a sweep's cases run: a fifth with the sanitizers, because each takes several times as long. A wrong
 * access or an invalid value shows in few cases as well as in many. The figures are for all cases. */
static inline int check_some(int cases)
{
    return CHECK_SANITIZED ? (cases + 4) / 5 : cases;
}

/* A sweep over pairs tries every n-th one; with `all`, as in the long tests, every pair. */
static inline int check_every(int n)
{
    return check_state.all ? 1 : n;
}

/* The folder of shared images, or NULL: $PUPIL_SHARED, else ../shared next to the checkout (PUPIL_SOURCE_DIR). */
static inline const char *check_shared(void)
{
    static char path[4096];
    struct stat s;
    const char *given = getenv("PUPIL_SHARED");
    if (given)
        snprintf(path, sizeof path, "%s", given);
    else
#ifdef PUPIL_SOURCE_DIR
        snprintf(path, sizeof path, "%s/../shared", PUPIL_SOURCE_DIR);
#else
        snprintf(path, sizeof path, "../shared");
#endif
    strncat(path, "/hdr", sizeof path - strlen(path) - 1);
    if (stat(path, &s) != 0)
        return NULL;
    path[strlen(path) - 4] = 0;
    return path;
}

/* Something is not installed. */
static inline int check_skip(const char *why)
{
    printf("skipped: %s\n", why);
    return CHECK_SKIPPED;
}

/* This machine or this checkout cannot have what the test needs. */
static inline int check_cannot(const char *why)
{
    printf("skipped: %s\n", why);
    return CHECK_CANNOT;
}

#endif

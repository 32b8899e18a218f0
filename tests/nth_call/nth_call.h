/* tests/nth_call/nth_call.h: the n-th call fails that the drivers make to the C library or to a library for files.
 *
 * The linker puts the functions of nth_libc.c, nth_media.c and nth_egl.c in the place of those that they are named
 * after (CMakeLists.txt), for what is linked statically: the drivers, the test. What shared libraries call for
 * themselves is not counted. Freeing and closing is done all the same, and then said to have failed.
 */
#ifndef PUPIL_TESTS_NTH_CALL_H
#define PUPIL_TESTS_NTH_CALL_H

#include <stddef.h>

typedef enum nth_mode {
    NTH_FAILS,       /* by the function's usual error */
    NTH_INTERRUPTED, /* of those that wait: EINTR, which must make no difference */
    NTH_SHORT        /* read and write move a part of what was asked for; nor may that */
} nth_mode;

/* Calls of this thread are counted from now on, and of those that it starts; the one with the number `at`, from 1,
 * fails. 0: none does. */
void nth_begin(unsigned long at, nth_mode mode);

/* No more. How many there were; `failed`: the name of the one that failed, NULL: there was none. */
unsigned long nth_end(const char **failed);

/* Only calls of these functions count from now on, up to a NULL; NULL: all. For where the test's own stand-ins call
 * the others. */
void nth_only(const char *const *names);

/* For the wrappers. Whether this call fails; then errno is set. */
int nth_fails(const char *name, int error);
/* Of read and write: `bytes` becomes less where this call is to be short. */
int nth_moves(const char *name, size_t *bytes, int error);
/* Of calls that wait and otherwise do not fail. */
int nth_waits(const char *name);

/* NTH_CALL(name, type, value where it fails, errno, parameters, arguments): at the beginning of a line, for CMake reads
 * the names. */
#define NTH_CALL(name, type, failure, error, parameters, arguments)                                                    \
    type __real_##name parameters;                                                                                     \
    type __wrap_##name parameters;                                                                                     \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        return nth_fails(#name, error) ? failure : __real_##name arguments;                                            \
    }

#endif

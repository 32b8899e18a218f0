/* tests/nth_call/nth_call.h: makes the n-th call fail that the drivers make to the C library or to a library for files.
 *
 * The linker replaces functions by those of the same name in nth_libc.c and nth_media.c (CMakeLists.txt),
 * for statically linked code: the drivers, the test. Calls within shared libraries are not counted. Freeing and closing
 * still happen, and then report failure.
 */
#ifndef PUPIL_TESTS_NTH_CALL_H
#define PUPIL_TESTS_NTH_CALL_H

#include <stddef.h>

typedef enum nth_mode {
    NTH_FAILS,       /* by the function's usual error */
    NTH_INTERRUPTED, /* of those that wait: EINTR, which must make no difference */
    NTH_SHORT        /* read and write move only a part; that must make no difference either */
} nth_mode;

/* From now on calls of this thread and of those that it starts are counted; call number `at`, from 1, fails. 0: none
 * does. */
void nth_begin(unsigned long at, nth_mode mode);

/* Stops counting. Returns the number of calls; `failed`: the name of the one that failed, NULL: none. */
unsigned long nth_end(const char **failed);

/* From now on only calls of these functions count, up to a NULL; NULL: all. For tests whose own fakes call the
 * others. */
void nth_only(const char *const *names);

/* For the wrappers. Whether this call fails; then errno is set. */
int nth_fails(const char *name, int error);
/* Of read and write: `bytes` becomes less where this call is to be short. */
int nth_moves(const char *name, size_t *bytes, int error);
/* For calls that wait and otherwise do not fail. */
int nth_waits(const char *name);

/* NTH_CALL(name, type, value where it fails, errno, parameters, arguments): at the beginning of a line, because CMake
 * reads the names. */
#define NTH_CALL(name, type, failure, error, parameters, arguments)                                                    \
    type __real_##name parameters;                                                                                     \
    type __wrap_##name parameters;                                                                                     \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        return nth_fails(#name, error) ? failure : __real_##name arguments;                                            \
    }

#endif

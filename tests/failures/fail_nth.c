/* LD_PRELOAD: one call of a kind fails, $PUPIL_FAIL=KIND:NUMBER, counted from 1 at the beginning of main; at the end
 * the total goes into the file $PUPIL_COUNT. KIND is malloc, for every allocation, or a system call (fail_calls.c).
 * With $PUPIL_FAIL_OWN allocations by libraries do not count: libavcodec 59 calls abort if it has no memory for an
 * encoder.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fail_calls.h"

void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t bytes);
void *__libc_realloc(void *old, size_t bytes);
void *__libc_memalign(size_t alignment, size_t bytes);

typedef int main_function(int argc, char **argv, char **environment);
int __libc_start_main(main_function *program, int argc, char **argv, void (*init)(void), void (*fini)(void),
                      void (*loader_fini)(void), void *stack_end);

static atomic_long count;
static atomic_int armed; /* for allocations */
static long fail_at;
static int own_only;

static int is_its_turn(void)
{
    return atomic_fetch_add(&count, 1) + 1 == fail_at;
}

/* Whether the program itself allocates, or the C library on its behalf. */
static int is_own(void *caller)
{
    Dl_info is;
    const char *file = dladdr(caller, &is) ? is.dli_fname : "";
    const char *slash = strrchr(file, '/');
    return strncmp(slash ? slash + 1 : file, "lib", 3) != 0 || strstr(file, "/libc.so");
}

static int fails(void *caller)
{
    if (!atomic_load(&armed) || (own_only && !is_own(caller)))
        return 0;
    if (!is_its_turn())
        return 0;
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t bytes)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_malloc(bytes);
}

void *calloc(size_t n, size_t bytes)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_calloc(n, bytes);
}

void *realloc(void *old, size_t bytes)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_realloc(old, bytes);
}

void *memalign(size_t alignment, size_t bytes)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, bytes);
}

void *aligned_alloc(size_t alignment, size_t bytes)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, bytes);
}

int posix_memalign(void **made, size_t alignment, size_t bytes)
{
    void *memory = fails(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, bytes);
    if (!memory)
        return ENOMEM;
    *made = memory;
    return 0;
}

static void say_count(long n)
{
    const char *path = getenv("PUPIL_COUNT");
    const int fd = path ? open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
    if (fd < 0)
        return;
    dprintf(fd, "%ld\n", n);
    close(fd);
}

static main_function *real_main;

static int wrapped_main(int argc, char **argv, char **environment)
{
    const char *which = getenv("PUPIL_FAIL"), *colon = which ? strchr(which, ':') : NULL;
    char kind[16];
    if (!colon || snprintf(kind, sizeof kind, "%.*s", (int)(colon - which), which) >= (int)sizeof kind)
        return real_main(argc, argv, environment);
    fail_at = atol(colon + 1);
    own_only = getenv("PUPIL_FAIL_OWN") != NULL;
    if (strcmp(kind, "malloc") == 0) {
        atomic_store(&armed, 1);
    } else if (!fail_calls_begin(kind, is_its_turn)) {
        dprintf(2, "fail_nth: %s: is no call that can fail here\n", kind);
        return 77;
    }
    const int status = real_main(argc, argv, environment);
    atomic_store(&armed, 0); /* allocations of the libraries' destructors do not count */
    say_count(atomic_load(&count));
    return status;
}

int __libc_start_main(main_function *program, int argc, char **argv, void (*init)(void), void (*fini)(void),
                      void (*loader_fini)(void), void *stack_end)
{
    __typeof__(&__libc_start_main) next;
    *(void **)&next = dlsym(RTLD_NEXT, "__libc_start_main");
    real_main = program;
    return next(wrapped_main, argc, argv, init, fini, loader_fini, stack_end);
}

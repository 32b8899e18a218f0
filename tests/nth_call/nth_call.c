/* tests/nth_call/nth_call.c: decides which call fails. */
#include "nth_call.h"

#include <errno.h>
#include <stdatomic.h>
#include <string.h>

static atomic_ulong calls;
static atomic_int armed;
static unsigned long fail_at;
static nth_mode how;
static const char *const *only;
static const char *_Atomic first_failed;

void nth_begin(unsigned long at, nth_mode mode)
{
    atomic_store(&calls, 0);
    atomic_store(&first_failed, NULL);
    fail_at = at;
    how = mode;
    atomic_store(&armed, 1);
}

unsigned long nth_end(const char **failed)
{
    atomic_store(&armed, 0);
    *failed = atomic_load(&first_failed);
    return atomic_load(&calls);
}

void nth_only(const char *const *names)
{
    only = names;
}

static int is_counted(const char *name)
{
    if (!only)
        return 1;
    for (const char *const *one = only; *one; one++)
        if (strcmp(*one, name) == 0)
            return 1;
    return 0;
}

static int is_it(const char *name)
{
    if (!atomic_load(&armed) || !is_counted(name) || atomic_fetch_add(&calls, 1) + 1 != fail_at)
        return 0;
    atomic_store(&first_failed, name);
    return 1;
}

int nth_fails(const char *name, int error)
{
    if (how != NTH_FAILS || !is_it(name))
        return 0;
    errno = error;
    return 1;
}

int nth_waits(const char *name)
{
    if (how != NTH_INTERRUPTED || !is_it(name))
        return 0;
    errno = EINTR;
    return 1;
}

int nth_moves(const char *name, size_t *bytes, int error)
{
    if (how == NTH_SHORT && *bytes > 1 && is_it(name))
        *bytes -= *bytes / 2;
    return nth_fails(name, error) || nth_waits(name);
}

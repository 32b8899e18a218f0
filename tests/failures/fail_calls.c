/* The kernel stops each of the chosen system calls by SIGSYS (seccomp(2)), regardless of the caller: also stdio's,
 * which no library can replace. The handler makes the call itself, or lets it fail. All threads are counted together,
 * unlike strace's injection, where the n-th call of one thread hides that of another.
 */
#include "fail_calls.h"

#include <dlfcn.h>
#include <errno.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#if defined(__x86_64__)
#define RESULT(c) ((c)->uc_mcontext.gregs[REG_RAX])
static const int argument_register[] = {REG_RDI, REG_RSI, REG_RDX, REG_R10, REG_R8};
#define ARGUMENT(c, i) ((c)->uc_mcontext.gregs[argument_register[i]])
#elif defined(__aarch64__)
#define RESULT(c)      ((c)->uc_mcontext.regs[0])
#define ARGUMENT(c, i) ((c)->uc_mcontext.regs[i])
#endif

/* 64-bit ARM has only the variants that take a folder. */
#ifndef SYS_rename
#define SYS_rename SYS_renameat
#endif
#ifndef SYS_mkdir
#define SYS_mkdir SYS_mkdirat
#endif

/* The sixth argument, which none of these calls uses: it marks the handler's own calls for the filter. */
#define OWN 0x7075706c66616c6cull

static const struct {
    const char *name;
    int number, error;
} calls[] = {
    {"write", SYS_write, ENOSPC}, {"rename", SYS_rename, EIO},    {"renameat2", SYS_renameat2, EIO},
    {"fsync", SYS_fsync, EIO},    {"openat", SYS_openat, EMFILE}, {"ftruncate", SYS_ftruncate, EIO},
    {"mkdir", SYS_mkdir, EACCES},
};

static fail_calls_decision *decide;
static int error;

/* Reads by the loader and the system's libraries do not count. */
static int is_of_system(int number, const char *path)
{
    static const char *const folders[] = {"/lib", "/usr", "/etc", "/sys", "/proc", "/dev"};
    for (size_t i = 0; number == SYS_openat && i < sizeof folders / sizeof *folders; i++)
        if (strncmp(path, folders[i], strlen(folders[i])) == 0)
            return 1;
    return 0;
}

static void answer(int signal_number, siginfo_t *info, void *context)
{
    ucontext_t *c = context;
    const int before = errno;
    (void)signal_number;
    if (!is_of_system(info->si_syscall, (const char *)ARGUMENT(c, 1)) && decide()) {
        RESULT(c) = -error;
    } else {
        const long done = syscall(info->si_syscall, ARGUMENT(c, 0), ARGUMENT(c, 1), ARGUMENT(c, 2), ARGUMENT(c, 3),
                                  ARGUMENT(c, 4), OWN);
        RESULT(c) = done < 0 ? -errno : done;
    }
    errno = before;
}

static int mask_without_sigsys(const char *function, int how, const sigset_t *set, sigset_t *old)
{
    int (*next)(int, const sigset_t *, sigset_t *);
    sigset_t less;
    *(void **)&next = dlsym(RTLD_NEXT, function);
    if (set && how != SIG_UNBLOCK) {
        less = *set;
        sigdelset(&less, SIGSYS);
        set = &less;
    }
    return next(how, set, old);
}

/* These three replace the C library's, so that SIGSYS keeps our handler; a thread that blocked it would be killed. */
int pthread_sigmask(int how, const sigset_t *set, sigset_t *old)
{
    return mask_without_sigsys("pthread_sigmask", how, set, old);
}

int sigprocmask(int how, const sigset_t *set, sigset_t *old)
{
    return mask_without_sigsys("sigprocmask", how, set, old);
}

int sigaction(int number, const struct sigaction *action, struct sigaction *old)
{
    int (*next)(int, const struct sigaction *, struct sigaction *);
    *(void **)&next = dlsym(RTLD_NEXT, "sigaction");
    return next(number, decide && number == SIGSYS ? NULL : action, old);
}

int fail_calls_begin(const char *name, fail_calls_decision *fails)
{
    size_t i = 0;
    while (i < sizeof calls / sizeof *calls && strcmp(calls[i].name, name) != 0)
        i++;
    if (i == sizeof calls / sizeof *calls)
        return 0;
    error = calls[i].error;
    struct sigaction action = {.sa_sigaction = answer, .sa_flags = SA_SIGINFO | SA_NODEFER};
    enum { LAST = offsetof(struct seccomp_data, args[5]) }; /* its lower half first: both CPUs are little-endian */
    struct sock_filter steps[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)calls[i].number, 0, 5),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, LAST),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)OWN, 0, 2),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, LAST + 4),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)(OWN >> 32), 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const struct sock_fprog program = {.len = sizeof steps / sizeof *steps, .filter = steps};
    if (sigaction(SIGSYS, &action, NULL))
        return 0;
    decide = fails;
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
}

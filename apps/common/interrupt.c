#include "interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#define MOMENT_NS 500000000

static volatile sig_atomic_t came;
static volatile pid_t parent; /* 0: not watched, or gone */
static volatile int64_t gone_ns;

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void look_for_parent(void)
{
    if (!parent || getppid() == parent)
        return;
    parent = 0;
    gone_ns = now_ns();
    if (!came)
        came = 1;
}

static void note(int number)
{
    look_for_parent();
    if (number != SIGALRM && came < 2 && !(came && gone_ns && now_ns() - gone_ns < MOMENT_NS))
        came++;
    alarm(1); /* again each second until the end: the first may come just before a read or write that blocks */
}

void interrupt_with_parent(pid_t is)
{
    parent = is;
    prctl(PR_SET_PDEATHSIG, SIGALRM);
}

void interrupt_watch(void)
{
    static const int ends[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM};
    struct sigaction action = {.sa_handler = note}; /* no SA_RESTART: a blocked read or write returns */
    sigemptyset(&action.sa_mask);
    struct sigaction before;
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        if (ends[i] == SIGHUP && sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler == SIG_IGN)
            continue; /* nohup */
        sigaction(ends[i], &action, NULL);
    }
    action.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &action, NULL);
    sigaction(SIGXFSZ, &action, NULL);
    look_for_parent(); /* it may have ended before its signal was requested */
}

int interrupt_came(void)
{
    return came != 0;
}

int interrupt_again(void)
{
    return came > 1;
}

/* --- fatal signals --- */

static void (*last_act)(void);

static void die(int number)
{
    last_act();
    raise(number); /* SA_RESETHAND: the default action ends the program */
}

void interrupt_fatal(void (*act)(void))
{
    static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGQUIT, SIGSYS, SIGXCPU};
    static unsigned char room[65536]; /* on a full stack a handler cannot run */
    const stack_t stack = {.ss_sp = room, .ss_size = sizeof room};
    struct sigaction action = {.sa_handler = act ? die : SIG_DFL, .sa_flags = SA_RESETHAND | SA_NODEFER | SA_ONSTACK};
    sigemptyset(&action.sa_mask);
    if (act)
        last_act = act;
    sigaltstack(&stack, NULL);
    for (size_t i = 0; i < sizeof fatal / sizeof fatal[0]; i++)
        sigaction(fatal[i], &action, NULL);
}

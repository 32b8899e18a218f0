#include "interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <unistd.h>

static volatile sig_atomic_t came;

static void note(int number)
{
    if (number != SIGALRM && came < 2)
        came++;
    alarm(1); /* knocks again until the end: the first knock may come just before a read or write that blocks */
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
    raise(number); /* SA_RESETHAND: as if there had been no handler */
}

void interrupt_fatal(void (*act)(void))
{
    static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGQUIT, SIGSYS, SIGXCPU};
    static unsigned char room[65536]; /* a stack that is full has no room for a handler */
    const stack_t stack = {.ss_sp = room, .ss_size = sizeof room};
    struct sigaction action = {.sa_handler = act ? die : SIG_DFL, .sa_flags = SA_RESETHAND | SA_NODEFER | SA_ONSTACK};
    sigemptyset(&action.sa_mask);
    if (act)
        last_act = act;
    sigaltstack(&stack, NULL);
    for (size_t i = 0; i < sizeof fatal / sizeof fatal[0]; i++)
        sigaction(fatal[i], &action, NULL);
}

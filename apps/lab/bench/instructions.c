#include "instructions.h"

#include <signal.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

/* The child marks begin and end by stopping itself. */
static void be_counted(void (*run)(void *context), void *context)
{
    if (ptrace(PTRACE_TRACEME, 0, NULL, NULL))
        _exit(1);
    raise(SIGSTOP);
    run(context);
    raise(SIGSTOP);
    _exit(0);
}

long long bench_instructions(void (*run)(void *context), void *context)
{
    long long steps = 0;
    int status = 0;
    const pid_t child = fork();
    if (child < 0)
        return -1;
    if (child == 0)
        be_counted(run, context);
    if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status))
        return -1;
    for (;;) {
        if (ptrace(PTRACE_SINGLESTEP, child, NULL, NULL) || waitpid(child, &status, 0) != child)
            break;
        if (!WIFSTOPPED(status) || WSTOPSIG(status) == SIGSTOP) /* the child has ended, or marked its end */
            break;
        steps++;
    }
    const int marked = WIFSTOPPED(status);
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    return marked ? steps : -1;
}

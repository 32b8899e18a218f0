/* apps/common/interrupt.h: Ctrl-C as a flag, so that a run can remove what is not complete. */
#ifndef PUPIL_APPS_COMMON_INTERRUPT_H
#define PUPIL_APPS_COMMON_INTERRUPT_H

#include <sys/types.h>

/* From now on SIGINT, SIGTERM and SIGHUP (unless it is ignored: nohup) set the flag and interrupt what blocks, and
 * SIGPIPE and SIGXFSZ are ignored: a closed pipe, and a file that may not become larger, are errors of the write. */
void interrupt_watch(void);
int interrupt_came(void);

/* Before interrupt_watch: the end of this parent sets the flag, too. SIGALRM announces it, once for each thread of the
 * parent (PR_SET_PDEATHSIG). All of these count as one signal, and so does the one that a service manager sends with
 * them. */
void interrupt_with_parent(pid_t parent);

int interrupt_again(void); /* twice: the user does not wait for a clean end */

/* Where the program dies of a fault of its own (SIGSEGV, SIGABRT ...) or of SIGQUIT, `act` is called first, with what a
 * signal handler may do. NULL: no longer. */
void interrupt_fatal(void (*act)(void));

#endif

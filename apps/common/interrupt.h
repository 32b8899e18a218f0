/* apps/common/interrupt.h: Ctrl-C as a flag, so that a run can remove incomplete files. */
#ifndef PUPIL_APPS_COMMON_INTERRUPT_H
#define PUPIL_APPS_COMMON_INTERRUPT_H

#include <sys/types.h>

/* From now on SIGINT, SIGTERM and SIGHUP (unless it is ignored: nohup) set the flag and interrupt blocking calls.
 * SIGPIPE and SIGXFSZ are ignored: a closed pipe or a file at its size limit is a write error. */
void interrupt_watch(void);
int interrupt_came(void);

/* Before interrupt_watch: the end of this parent sets the flag, too. SIGALRM announces it, once for each thread of the
 * parent (PR_SET_PDEATHSIG). All of these, and the signal that a service manager sends with them, count as one. */
void interrupt_with_parent(pid_t parent);

int interrupt_again(void); /* a second signal: the user does not wait for a clean end */

/* If the program crashes (SIGSEGV, SIGABRT ...) or gets SIGQUIT, `act` is called first; it may do only what a signal
 * handler may. NULL: no longer. */
void interrupt_fatal(void (*act)(void));

#endif

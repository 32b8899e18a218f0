/* System calls that fail, for fail_nth.c. */
#ifndef FAIL_CALLS_H
#define FAIL_CALLS_H

/* Whether a call of the given kind fails, counted over all threads. */
typedef int fail_calls_decision(void);

/* From now on each system call of this name may fail. 0: there is no such name, or the kernel refuses. */
int fail_calls_begin(const char *name, fail_calls_decision *fails);

#endif

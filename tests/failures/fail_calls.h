/* System calls that fail: of fail_nth.c. */
#ifndef FAIL_CALLS_H
#define FAIL_CALLS_H

/* Decides for a call of the given kind, counted over all threads. */
typedef int fail_calls_decision(void);

/* Starts to ask for each system call of this name whether it fails. 0: it has no such name, or the kernel refuses. */
int fail_calls_begin(const char *name, fail_calls_decision *fails);

#endif

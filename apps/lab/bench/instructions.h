/* apps/lab/bench/instructions.h: how many instructions a function executes, exactly, on any machine. */
#ifndef PUPIL_APPS_LAB_BENCH_INSTRUCTIONS_H
#define PUPIL_APPS_LAB_BENCH_INSTRUCTIONS_H

/* In a child process that is stopped after each instruction, which takes some microseconds: for up to some millions.
 * What the function changes is lost with the child. -1: the system does not allow it. */
long long bench_instructions(void (*run)(void *context), void *context);

#endif

/* tests/resident.h: what the process has in memory, for tests of growth. */
#ifndef PUPIL_TESTS_RESIDENT_H
#define PUPIL_TESTS_RESIDENT_H

#include <stdio.h>
#include <unistd.h>

/* -1: the system does not say. */
static inline long resident_kib(void)
{
    long pages = -1;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return -1;
    if (fscanf(file, "%*d %ld", &pages) != 1)
        pages = -1;
    fclose(file);
    return pages < 0 ? -1 : pages * (sysconf(_SC_PAGESIZE) / 1024);
}

#endif

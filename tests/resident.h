/* tests/resident.h: what the process has in memory, for tests of growth. */
#ifndef PUPIL_TESTS_RESIDENT_H
#define PUPIL_TESTS_RESIDENT_H

#include <stdio.h>

/* From smaps_rollup, which counts the pages. The totals of statm and status are sums of per-processor counters since
   Linux 6.2 and lag behind by up to 2 pages x processors (at least 32) on each (linux/percpu_counter.c), 128 KiB and
   more: they tell a leak from noise only when it is far greater. -1: the system does not say. */
static inline long resident_kib(void)
{
    char line[256];
    long kib = -1;
    FILE *file = fopen("/proc/self/smaps_rollup", "r");
    if (!file)
        return -1;
    while (kib < 0 && fgets(line, sizeof line, file))
        if (sscanf(line, "Rss: %ld kB", &kib) != 1)
            kib = -1;
    fclose(file);
    return kib;
}

#endif

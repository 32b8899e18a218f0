/* tests/resident.h: the memory of the process, for tests of growth. */
#ifndef PUPIL_TESTS_RESIDENT_H
#define PUPIL_TESTS_RESIDENT_H

#include <stdio.h>

/* Heap, stacks and shared memory, without pages of files, of which 64 KiB are loaded whenever a library function first
   runs. From smaps_rollup, which counts pages; the totals of statm and status are sums of per-processor counters since
   Linux 6.2 and lag behind. -1: the system does not say. */
static inline long resident_kib(void)
{
    char line[256];
    long anonymous = -1, shared = -1;
    FILE *file = fopen("/proc/self/smaps_rollup", "r");
    if (!file)
        return -1;
    while (fgets(line, sizeof line, file))
        if (sscanf(line, "Pss_Anon: %ld kB", &anonymous) != 1)
            sscanf(line, "Pss_Shmem: %ld kB", &shared);
    fclose(file);
    return anonymous < 0 || shared < 0 ? -1 : anonymous + shared;
}

#endif

#include "clock.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/progress.h"

#define LEAST_FLUSH (64u << 20) /* twice the last-level cache of a large CPU */
#define MOST_FLUSH  (512u << 20)
#define LINE        64u

static size_t last_cache(void)
{
#ifdef _SC_LEVEL3_CACHE_SIZE
    long bytes = sysconf(_SC_LEVEL3_CACHE_SIZE);
    return bytes > 0 ? (size_t)bytes : 0;
#else
    return 0;
#endif
}

int bench_flush_open(bench_flush *flush)
{
    size_t bytes = 2 * last_cache();
    flush->bytes = bytes < LEAST_FLUSH ? LEAST_FLUSH : bytes > MOST_FLUSH ? MOST_FLUSH : bytes;
    flush->block = calloc(flush->bytes, 1);
    return flush->block ? 0 : -1;
}

void bench_flush_close(bench_flush *flush)
{
    free(flush->block);
    flush->block = NULL;
}

/* Written as well as read: reading alone may leave other cache lines in a core's own cache. */
static void flush_caches(const bench_flush *flush)
{
    volatile unsigned char *block = flush->block;
    for (size_t i = 0; i < flush->bytes; i += LINE)
        block[i]++;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

int bench_race(bench_runner *runner, size_t runners, unsigned rounds, const bench_flush *flush, int (*stop)(void))
{
    double *time_s = malloc(runners * rounds * sizeof *time_s);
    int stopped = 0;
    if (!time_s)
        return -1;
    for (unsigned round = 0; round < rounds && !stopped; round++)
        for (size_t i = 0; i < runners; i++) {
            if (flush)
                flush_caches(flush);
            if (runner[i].prepare)
                runner[i].prepare(runner[i].context);
            double began_s = progress_now_s();
            runner[i].run(runner[i].context);
            time_s[i * rounds + round] = progress_now_s() - began_s;
            stopped = stop && stop();
        }
    for (size_t i = 0; i < runners && !stopped; i++) {
        const double *own = time_s + i * rounds;
        qsort(time_s + i * rounds, rounds, sizeof *time_s, by_size);
        runner[i].median_s = own[rounds / 2];
        runner[i].least_s = own[0];
        runner[i].p99_s = own[rounds - 1 - rounds / 100];
        runner[i].p999_s = own[rounds - 1 - rounds / 1000];
        runner[i].most_s = own[rounds - 1];
    }
    free(time_s);
    return stopped ? -1 : 0;
}

typedef uint64_t lanes __attribute__((vector_size(16)));

unsigned long long bench_read(const void *data, size_t bytes)
{
    const lanes *p = data;
    lanes a = {0}, b = {0}, c = {0}, d = {0};
    for (size_t i = 0; i + 4 <= bytes / sizeof *p; i += 4) {
        a ^= p[i];
        b ^= p[i + 1];
        c ^= p[i + 2];
        d ^= p[i + 3];
    }
    a ^= b ^ c ^ d;
    return a[0] ^ a[1];
}

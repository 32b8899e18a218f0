#include "synth/spread.h"

#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

#define MOST_THREADS 256u

typedef struct shared {
    atomic_size_t next;
    size_t count;
    void (*job)(void *context, size_t i);
    void *context;
    int (*stop)(void);
} shared;

static void *serve(void *argument)
{
    shared *s = argument;
    for (size_t i; !(s->stop && s->stop()) && (i = atomic_fetch_add(&s->next, 1)) < s->count;)
        s->job(s->context, i);
    return NULL;
}

void pupil_spread_run(void *spread, void (*job)(void *context, size_t i), void *context, size_t count)
{
    const pupil_spread *p = spread;
    shared s = {.count = count, .job = job, .context = context, .stop = p->stop};
    pthread_t thread[MOST_THREADS];
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    unsigned wanted = p->threads ? p->threads : processors > 0 ? (unsigned)processors : 1, started = 0;
    if (wanted > MOST_THREADS)
        wanted = MOST_THREADS;
    while (started + 1 < wanted && started + 1 < count && pthread_create(&thread[started], NULL, serve, &s) == 0)
        started++;
    serve(&s);
    while (started)
        pthread_join(thread[--started], NULL);
}

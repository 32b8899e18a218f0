#include "workers.h"

#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

#define MOST_WORKERS 256u

struct workers {
    unsigned count, started;
    pthread_t thread[MOST_WORKERS];
    pthread_mutex_t lock;
    pthread_cond_t begin, end;
    unsigned long round; /* rises with each job */
    unsigned busy;
    int stop;
    worker_job *job;
    void *context;
};

typedef struct seat {
    workers *w;
    unsigned number;
} seat;

static void *serve(void *argument)
{
    seat s = *(seat *)argument;
    unsigned long round = 0;
    free(argument);
    pthread_mutex_lock(&s.w->lock);
    for (;;) {
        while (!s.w->stop && s.w->round == round)
            pthread_cond_wait(&s.w->begin, &s.w->lock);
        if (s.w->stop)
            break;
        round = s.w->round;
        pthread_mutex_unlock(&s.w->lock);
        s.w->job(s.w->context, s.number, s.w->count);
        pthread_mutex_lock(&s.w->lock);
        if (--s.w->busy == 0)
            pthread_cond_signal(&s.w->end);
    }
    pthread_mutex_unlock(&s.w->lock);
    return NULL;
}

workers *workers_open(unsigned count)
{
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (count == 0)
        count = processors > 0 ? (unsigned)processors : 1;
    if (count > MOST_WORKERS)
        count = MOST_WORKERS;
    workers *w = calloc(1, sizeof *w);
    if (!w)
        return NULL;
    w->count = count;
    pthread_mutex_init(&w->lock, NULL);
    pthread_cond_init(&w->begin, NULL);
    pthread_cond_init(&w->end, NULL);
    for (unsigned i = 1; i < count; i++) {
        seat *s = malloc(sizeof *s);
        if (s)
            *s = (seat){w, i};
        if (!s || pthread_create(&w->thread[i], NULL, serve, s) != 0) {
            free(s);
            w->count = i; /* fewer give the same bits */
            break;
        }
        w->started = i;
    }
    return w;
}

unsigned workers_count(const workers *w)
{
    return w->count;
}

void workers_run(workers *w, worker_job *job, void *context)
{
    pthread_mutex_lock(&w->lock);
    w->job = job;
    w->context = context;
    w->busy = w->started;
    w->round++;
    pthread_cond_broadcast(&w->begin);
    pthread_mutex_unlock(&w->lock);
    job(context, 0, w->count);
    pthread_mutex_lock(&w->lock);
    while (w->busy)
        pthread_cond_wait(&w->end, &w->lock);
    pthread_mutex_unlock(&w->lock);
}

void workers_close(workers *w)
{
    if (!w)
        return;
    pthread_mutex_lock(&w->lock);
    w->stop = 1;
    pthread_cond_broadcast(&w->begin);
    pthread_mutex_unlock(&w->lock);
    for (unsigned i = 1; i <= w->started; i++)
        pthread_join(w->thread[i], NULL);
    pthread_mutex_destroy(&w->lock);
    pthread_cond_destroy(&w->begin);
    pthread_cond_destroy(&w->end);
    free(w);
}

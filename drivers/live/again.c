/* The controls of a camera that was opened again. */
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "live_private.h"
#include "refuse.h"

enum { END_WAIT_S = 2 };

struct live_again {
    live_which which;
    pupil_camera *old;
    pthread_t thread;
    pthread_mutex_t lock; /* of what follows */
    pthread_cond_t idle;
    int done, abandoned;
    pupil_camera *camera;
    pupil_why why;
};

static void give_up(live_again *a)
{
    pupil_why unused;
    pupil_camera_close(a->camera, &unused);
    pthread_cond_destroy(&a->idle);
    pthread_mutex_destroy(&a->lock);
    free(a);
}

static void *change(void *of)
{
    live_again *a = of;
    pupil_why unused;
    /* In this order: it may be the same camera, whose stream had stopped. */
    pupil_camera_close(a->old, &unused);
    a->camera = live_controls_open(&a->which, &a->why);
    pthread_mutex_lock(&a->lock);
    a->done = 1;
    const int abandoned = a->abandoned;
    pthread_cond_broadcast(&a->idle);
    pthread_mutex_unlock(&a->lock);
    if (abandoned)
        give_up(a);
    return NULL;
}

live_again *live_again_start(pupil_camera *old, const live_which *which)
{
    pupil_why unused;
    pthread_condattr_t monotonic;
    live_again *a = calloc(1, sizeof *a);
    if (!a) {
        pupil_camera_close(old, &unused);
        return NULL;
    }
    a->which = *which;
    a->old = old;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&a->lock, NULL);
    pthread_cond_init(&a->idle, &monotonic);
    pthread_condattr_destroy(&monotonic);
    if (pthread_create(&a->thread, NULL, change, a) != 0) {
        pupil_camera_close(old, &unused);
        give_up(a);
        return NULL;
    }
    return a;
}

int live_again_ready(live_again **again, pupil_camera **camera, pupil_why *why)
{
    live_again *a = *again;
    pthread_mutex_lock(&a->lock);
    const int done = a->done;
    pthread_mutex_unlock(&a->lock);
    if (!done)
        return 0;
    pthread_join(a->thread, NULL);
    *camera = a->camera;
    pupil_refuse(why, "%s", a->why.text);
    a->camera = NULL;
    give_up(a);
    *again = NULL;
    return 1;
}

void live_again_end(live_again *a)
{
    struct timespec until;
    if (!a)
        return;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += END_WAIT_S;
    pthread_mutex_lock(&a->lock);
    while (!a->done && pthread_cond_timedwait(&a->idle, &a->lock, &until) != ETIMEDOUT)
        ;
    const pthread_t thread = a->thread;
    const int hangs = !a->done;
    a->abandoned = hangs;
    if (hangs) /* under the lock: from its end on all of it is the thread's */
        pthread_detach(thread);
    pthread_mutex_unlock(&a->lock);
    if (hangs)
        return;
    pthread_join(thread, NULL);
    give_up(a);
}

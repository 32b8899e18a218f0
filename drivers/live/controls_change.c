/* From the controls of a camera that is gone to those of the one that came back, by a thread. */
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "live_private.h"
#include "refuse.h"

enum { END_WAIT_S = 2 };

struct live_change {
    live_which which;
    pupil_camera *old;
    pthread_t thread;
    pthread_mutex_t lock; /* of what follows */
    pthread_cond_t idle;
    int done, abandoned;
    pupil_camera *camera;
    pupil_why why;
};

static void give_up(live_change *c)
{
    pupil_why unused;
    pupil_camera_close(c->camera, &unused);
    pthread_cond_destroy(&c->idle);
    pthread_mutex_destroy(&c->lock);
    free(c);
}

static void *run(void *of)
{
    live_change *c = of;
    pupil_why unused;
    /* In this order: it may be the same camera, whose stream had stopped. */
    pupil_camera_close(c->old, &unused);
    c->camera = live_controls_open(&c->which, &c->why);
    pthread_mutex_lock(&c->lock);
    c->done = 1;
    const int abandoned = c->abandoned;
    pthread_cond_broadcast(&c->idle);
    pthread_mutex_unlock(&c->lock);
    if (abandoned)
        give_up(c);
    return NULL;
}

live_change *live_change_start(pupil_camera *old, const live_which *which)
{
    pupil_why unused;
    pthread_condattr_t monotonic;
    live_change *c = calloc(1, sizeof *c);
    if (!c) {
        pupil_camera_close(old, &unused);
        return NULL;
    }
    c->which = *which;
    c->old = old;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&c->lock, NULL);
    pthread_cond_init(&c->idle, &monotonic);
    pthread_condattr_destroy(&monotonic);
    if (pthread_create(&c->thread, NULL, run, c) != 0) {
        pupil_camera_close(old, &unused);
        give_up(c);
        return NULL;
    }
    return c;
}

int live_change_done(live_change **change, pupil_camera **camera, pupil_why *why)
{
    live_change *c = *change;
    pthread_mutex_lock(&c->lock);
    const int done = c->done;
    pthread_mutex_unlock(&c->lock);
    if (!done)
        return 0;
    pthread_join(c->thread, NULL);
    *camera = c->camera;
    pupil_refuse(why, "%s", c->why.text);
    c->camera = NULL;
    give_up(c);
    *change = NULL;
    return 1;
}

void live_change_end(live_change *c)
{
    struct timespec until;
    if (!c)
        return;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += END_WAIT_S;
    pthread_mutex_lock(&c->lock);
    while (!c->done && pthread_cond_timedwait(&c->idle, &c->lock, &until) != ETIMEDOUT)
        ;
    const pthread_t thread = c->thread;
    const int hangs = !c->done;
    c->abandoned = hangs;
    if (hangs) /* under the lock: after it all of this is the thread's */
        pthread_detach(thread);
    pthread_mutex_unlock(&c->lock);
    if (hangs)
        return;
    pthread_join(thread, NULL);
    give_up(c);
}

#include "several.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "common/interrupt.h"
#include "options/commands.h"
#include "refuse.h"

#define BEGIN_S 4.0 /* within this time a camera gives its first frame; otherwise the next one leads */
#define LOST_S  5.0 /* without a frame, or LOST_FRAMES frame periods if that is longer; a camera that ends says so */
enum { LOST_FRAMES = 10 };
enum { QUEUE_FRAMES = 4 }; /* a camera's driver takes these while one is waited for (drivers/v4l2) */
enum { MOMENTS = 8 };      /* frames of the leader: twice QUEUE_FRAMES */
#define POLL_NS 1000000    /* polling, because a condition variable shared by processes does not survive a killed one */

typedef struct shared_camera {
    int64_t until_ns; /* counts as present until then; 0: it has ended */
    double least_s, most_s;
} shared_camera;

typedef struct run_shared {
    pthread_mutex_t lock; /* of everything below except `ended` */
    atomic_int ended;
    uint32_t count;
    uint64_t led_frames;
    int64_t led_ns;       /* when the newest was published */
    run_led led[MOMENTS]; /* by led_frames, in the first camera's sensitivity */
    shared_camera camera[RUN_MOST_CAMERAS];
} run_shared;

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Locks; if a camera's process died with the lock, it has left nothing inconsistent that matters. */
static void take(run_shared *shared)
{
    if (pthread_mutex_lock(&shared->lock) == EOWNERDEAD)
        pthread_mutex_consistent(&shared->lock);
}

static void give(run_shared *shared)
{
    pthread_mutex_unlock(&shared->lock);
}

/* --- options --- */

#define PLACE "%i" /* the camera's number in a path */

static int check_path(const char *path, pupil_why *why)
{
    if (!path || strstr(path, PLACE))
        return OPTIONS_RUN;
    return pupil_refuse(why, "%s: each of several cameras has its own; %s in the name is the camera's number", path,
                        PLACE);
}

/* The same name, or links to the same device: /dev/v4l/by-id has links to /dev/video0. */
static int is_same_device(const char *one, const char *other)
{
    struct stat a, b;
    if (strcmp(one, other) == 0)
        return 1;
    if (stat(one, &a) != 0 || stat(other, &b) != 0)
        return 0;
    return S_ISCHR(a.st_mode) && S_ISCHR(b.st_mode) && a.st_rdev == b.st_rdev;
}

int run_several_check(const run_options *o, pupil_why *why)
{
    const frame_options *shown = &o->shown;
    const char *const others[] = {shown->stats, shown->plot, shown->record};
    if (o->mode == RUN_DIGITAL)
        return pupil_refuse(why, "--device: several cameras share their exposure, which --mode digital does not touch");
    if (o->exposure_s > 0.0 || o->gain > 0.0)
        return pupil_refuse(why, "--shutter and --gain: work with one camera only; several share an exposure");
    if (shown->config.order == PUPIL_ORDER_FUSED)
        return pupil_refuse(why, "--fused: works with one camera only; several share a curve");
    if (o->camera_evs && o->camera_evs != o->devices - 1)
        return pupil_refuse(why, "--camera-ev: has to have a number for each camera but the first: %u", o->devices - 1);
    for (uint32_t i = 0; i < o->devices; i++)
        for (uint32_t k = 0; k < i; k++)
            if (is_same_device(o->device_name[i], o->device_name[k]))
                return pupil_refuse(why, "--device %s: is the same camera as --device %s; name each camera once",
                                    o->device_name[i], o->device_name[k]);
    if (o->control && strstr(o->control, PLACE))
        return pupil_refuse(why, "--control %s: belongs to the first camera only; %s is for outputs", o->control,
                            PLACE);
    for (size_t i = 0; i < shown->out_count; i++)
        if (check_path(shown->out[i], why))
            return OPTIONS_USAGE;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (check_path(others[i], why))
            return OPTIONS_USAGE;
    return OPTIONS_RUN;
}

/* The path with this camera's number in each PLACE; never freed. */
static const char *path_of(const char *path, uint32_t index)
{
    const char *at;
    while (path && (at = strstr(path, PLACE)) != NULL) {
        char *own = NULL;
        if (asprintf(&own, "%.*s%u%s", (int)(at - path), path, index, at + strlen(PLACE)) < 0)
            break;
        path = own;
    }
    return path;
}

void run_several_paths(run_options *o, uint32_t index)
{
    frame_options *shown = &o->shown;
    for (size_t i = 0; i < shown->out_count; i++)
        shown->out[i] = path_of(shown->out[i], index);
    shown->stats = path_of(shown->stats, index);
    shown->plot = path_of(shown->plot, index);
    shown->record = path_of(shown->record, index);
    if (index)
        o->control = NULL;
    o->device = o->device_name[index];
}

static void become(run_several *s, run_options *o, uint32_t index)
{
    setvbuf(stderr, NULL, _IOLBF, 0); /* so that lines of several processes do not mix */
    s->index = index;
    s->ev = index ? o->camera_ev[index - 1] : 0.0;
    run_several_paths(o, index);
}

/* --- processes --- */

static volatile sig_atomic_t came;

static void note(int number)
{
    (void)number;
    came++;
}

static void watch(void)
{
    const struct sigaction action = {.sa_handler = note};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
}

/* The worse of two exit statuses. */
static int worse(int a, int b)
{
    static const int order[] = {EXIT_INTERRUPTED, EXIT_FAILED, EXIT_USAGE, EXIT_INCOMPLETE};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        if (a == order[i] || b == order[i])
            return order[i];
    return EXIT_DONE;
}

/* Ctrl-C reaches all processes, but a signal sent to the first process only that one. The others see the flag, and at
 * once, because SIGALRM wakes them (common/interrupt.h). A second signal is passed on. */
static void pass_on(run_shared *shared, const pid_t *process, sig_atomic_t times)
{
    atomic_store(&shared->ended, 1);
    for (uint32_t i = 0; i < shared->count; i++)
        if (process[i] > 0)
            kill(process[i], times > 1 ? SIGTERM : SIGALRM);
}

static int await(run_shared *shared, pid_t *process, const run_options *o)
{
    int status = EXIT_DONE;
    sig_atomic_t passed = 0;
    for (uint32_t left = shared->count; left > 0;) {
        int how = 0;
        const pid_t gone = waitpid(-1, &how, 0);
        if (came != passed)
            pass_on(shared, process, passed = came);
        if (gone < 0 && errno != EINTR)
            break;
        for (uint32_t i = 0; i < shared->count && gone > 0; i++) {
            if (process[i] != gone)
                continue;
            process[i] = 0;
            left--;
            take(shared);
            shared->camera[i].until_ns = 0;
            give(shared);
            if (WIFSIGNALED(how))
                fprintf(stderr, "pupil run: %s: its process was ended by signal %d\n", o->device_name[i],
                        WTERMSIG(how));
            status = worse(status, WIFEXITED(how) ? WEXITSTATUS(how) : EXIT_FAILED);
        }
    }
    return status;
}

static run_shared *make_shared(uint32_t count)
{
    pthread_mutexattr_t kind;
    run_shared *shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED)
        return NULL;
    pthread_mutexattr_init(&kind);
    pthread_mutexattr_setpshared(&kind, PTHREAD_PROCESS_SHARED);
    pthread_mutexattr_setrobust(&kind, PTHREAD_MUTEX_ROBUST);
    pthread_mutex_init(&shared->lock, &kind);
    pthread_mutexattr_destroy(&kind);
    shared->count = count;
    for (uint32_t i = 0; i < count; i++)
        shared->camera[i].until_ns = now_ns() + (int64_t)(BEGIN_S * 1e9);
    return shared;
}

int run_several_begin(run_several *s, run_options *o)
{
    pid_t process[RUN_MOST_CAMERAS] = {0};
    const pid_t first = getpid();
    s->shared = make_shared(o->devices);
    watch();
    fflush(NULL); /* otherwise each process would write the buffers */
    for (uint32_t i = 0; s->shared && i < o->devices; i++) {
        process[i] = fork();
        if (process[i] == 0) {
            interrupt_with_parent(first);
            become(s, o, i);
            return -1;
        }
        if (process[i] < 0) {
            came++;
            s->shared->count = i;
        }
    }
    if (!s->shared || s->shared->count < o->devices)
        fprintf(stderr, "pupil run: no process can be made for a camera: %s\n", strerror(errno));
    if (!s->shared)
        return EXIT_FAILED;
    const int short_of = s->shared->count < o->devices;
    if (short_of)
        pass_on(s->shared, process, 1);
    const int status = await(s->shared, process, o);
    return short_of ? worse(status, EXIT_FAILED) : status;
}

int run_several_is_over(const run_several *s)
{
    return s->shared && atomic_load(&s->shared->ended);
}

/* --- frames --- */

void run_several_offer(run_several *s, double least_s, double most_s)
{
    if (!s->shared)
        return;
    take(s->shared);
    s->shared->camera[s->index].least_s = least_s * exp2(s->ev);
    s->shared->camera[s->index].most_s = most_s * exp2(s->ev);
    give(s->shared);
}

void run_several_limit(const run_several *s, pupil_sensor_config *c)
{
    double least_s = 0.0, most_s = INFINITY;
    if (!s->shared)
        return;
    take(s->shared);
    for (uint32_t i = 0; i < s->shared->count; i++) {
        const shared_camera *camera = &s->shared->camera[i];
        if (i != s->index && camera->until_ns && camera->most_s > 0.0) {
            least_s = fmax(least_s, camera->least_s * exp2(-s->ev));
            most_s = fmin(most_s, camera->most_s * exp2(-s->ev));
        }
    }
    give(s->shared);
    const double longest_s = c->frame_rate_priority ? fmin(c->exposure_max_s, c->frame_s) : c->exposure_max_s;
    if (longest_s * c->gain_max > most_s)
        c->gain_max = fmax(c->gain_min, most_s / longest_s);
    if (longest_s * c->gain_min > most_s)
        c->exposure_max_s = fmax(c->exposure_min_s, most_s / c->gain_min);
    if (c->exposure_min_s * c->gain_min < least_s)
        c->exposure_min_s = fmin(fmin(c->exposure_max_s, longest_s), least_s / c->gain_min);
}

int run_several_leads(run_several *s, double frame_s)
{
    int leads = 1;
    if (!s->shared)
        return 1;
    const int64_t now = now_ns();
    take(s->shared);
    s->shared->camera[s->index].until_ns = now + (int64_t)(fmax(LOST_S, LOST_FRAMES * frame_s) * 1e9);
    for (uint32_t i = 0; i < s->index; i++)
        leads &= s->shared->camera[i].until_ns <= now;
    give(s->shared);
    return leads;
}

int64_t run_several_stamp(const pupil_frame_info *info)
{
    const int64_t now = now_ns();
    return llabs(now - info->timestamp_ns) < (int64_t)(LOST_S * 1e9) ? info->timestamp_ns : now;
}

void run_several_publish(run_several *s, const run_led *led)
{
    run_shared *shared = s->shared;
    take(shared);
    run_led *own = &shared->led[shared->led_frames % MOMENTS];
    *own = *led;
    own->total_s *= exp2(s->ev);
    own->shown_s *= exp2(s->ev);
    own->scene_ev -= s->ev;
    shared->led_frames++;
    shared->led_ns = now_ns();
    give(shared);
}

/* The newest entry that is not after the moment; if there is none, the oldest kept. */
static const run_led *led_at(const run_shared *shared, int64_t at_ns)
{
    const uint64_t kept = shared->led_frames < MOMENTS ? shared->led_frames : MOMENTS;
    const run_led *found = NULL;
    for (uint64_t back = 1; back <= kept; back++) {
        found = &shared->led[(shared->led_frames - back) % MOMENTS];
        if (found->at_ns <= at_ns)
            break;
    }
    return found;
}

/* Whether the leader has a frame in [from, to] that it has not published yet, predicted from its last two. A slower
 * leader has none for most frames of this camera, and a leader that hangs has none. */
static int is_due(const run_shared *shared, int64_t from_ns, int64_t to_ns)
{
    if (shared->led_frames < 2)
        return 0;
    const int64_t last_ns = shared->led[(shared->led_frames - 1) % MOMENTS].at_ns;
    const int64_t period_ns = last_ns - shared->led[(shared->led_frames - 2) % MOMENTS].at_ns;
    return last_ns < from_ns && last_ns + period_ns - period_ns / 8 <= to_ns && /* an eighth: clocks are not exact */
           now_ns() < shared->led_ns + QUEUE_FRAMES * period_ns;
}

int run_several_read(run_several *s, const pupil_frame_info *info, double frame_s, run_led *led)
{
    const int64_t at_ns = run_several_stamp(info), half_ns = (int64_t)(frame_s * 0.5e9);
    const int64_t until_ns = now_ns() + QUEUE_FRAMES * 2 * half_ns;
    run_shared *shared = s->shared;
    take(shared);
    while (is_due(shared, at_ns - half_ns, at_ns + half_ns) && now_ns() < until_ns && !atomic_load(&shared->ended)) {
        give(shared);
        nanosleep(&(struct timespec){.tv_nsec = POLL_NS}, NULL);
        take(shared);
    }
    const run_led *found = led_at(shared, at_ns + half_ns);
    if (found)
        *led = *found;
    give(shared);
    led->total_s *= exp2(-s->ev);
    led->shown_s *= exp2(-s->ev);
    return found != NULL;
}

void run_several_tell(const run_several *s, char *text, size_t text_bytes)
{
    *text = 0;
    if (!s->shared || !s->seen)
        return;
    const double more_ev = s->seen_ev / (double)s->seen;
    snprintf(text, text_bytes, "; sees %.2f EV %s light than the camera that leads, --camera-ev %+.2f", fabs(more_ev),
             more_ev < 0.0 ? "less" : "more", s->ev);
}

void run_several_end(run_several *s)
{
    if (!s->shared)
        return;
    take(s->shared);
    s->shared->camera[s->index].until_ns = 0;
    give(s->shared);
}

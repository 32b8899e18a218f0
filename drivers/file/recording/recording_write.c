/* drivers/file/recording/recording_write.c: the recorder: a queue of frames, and a thread that brings them to the disk.
 */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "file/common/folder.h"
#include "file/common/write_all.h"
#include "recording.h"
#include "recording_format.h"
#include "recording_mkv.h"
#include "refuse.h"
#include "sink.h"

#define ROOM_USUAL 16
#define ROOM_WAIT  2 /* sources that wait never queue many frames */
#define ROOM_MOST  4096

#define ASK_AGAIN_NS 100000000 /* how often give_up is asked: soon enough after a second Ctrl-C */

typedef struct slot {
    unsigned char *bytes;
    size_t size, capacity;
    pupil_frame_info info;
    float balance[3]; /* the only part of the coding that differs from frame to frame */
} slot;

struct pupil_recorder {
    pupil_recording_about about;
    char folder[PATH_MAX];
    int wait;
    int (*give_up)(void);
    size_t frame_bytes; /* of raw frames */
    pupil_mkv_writer *mkv;
    int frames_fd, lines_fd, made_folder;
    off_t lines_end;
    uint64_t lines;

    slot *slots;
    unsigned room;
    unsigned *free_slots,
        *full_slots; /* numbers of slots: a stack, so that used memory is reused first; a ring buffer */
    pthread_t thread;
    int has_thread;
    pthread_mutex_t lock; /* of all that follows, free_slots and full_slots */
    pthread_cond_t came, left;
    unsigned free_count, full_count, full_first;
    int ending, failed, done, abandoned; /* abandoned: its thread frees it */
    pupil_recorder_counts counts;
    pupil_why why; /* of failed */
};

static void free_recorder(pupil_recorder *r)
{
    pupil_mkv_free(r->mkv);
    if (r->frames_fd >= 0)
        close(r->frames_fd);
    if (r->lines_fd >= 0)
        close(r->lines_fd);
    for (unsigned i = 0; r->slots && i < r->room; i++)
        free(r->slots[i].bytes);
    free(r->slots);
    free(r->free_slots);
    free(r->full_slots);
    pthread_mutex_destroy(&r->lock);
    pthread_cond_destroy(&r->came);
    pthread_cond_destroy(&r->left);
    free(r);
}

/* Waits, with the lock, for the thread to make progress. 1: the wait is given up. */
static int wait_for_disk(pupil_recorder *r)
{
    struct timespec until;
    if (!r->give_up) {
        pthread_cond_wait(&r->left, &r->lock);
        return 0;
    }
    if (r->give_up())
        return 1;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += ASK_AGAIN_NS;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_cond_timedwait(&r->left, &r->lock, &until);
    return 0;
}

static int add_whole(pupil_why *why, uint64_t frames)
{
    if (frames)
        pupil_refuse_add(why, "; the %llu frame%s before %s whole", (unsigned long long)frames, frames == 1 ? "" : "s",
                         frames == 1 ? "is" : "are");
    return -1;
}

static int given_up(const pupil_recorder *r, pupil_why *why)
{
    pupil_refuse(why, "%s: the disk hangs, and is waited for no more", r->folder);
    return add_whole(why, r->counts.written);
}

/* --- the thread --- */

static int fail(pupil_recorder *r, const char *name)
{
    pupil_refuse(&r->why, "%s/%s: cannot be written: %s", r->folder, name, strerror(errno));
    return add_whole(&r->why, r->lines);
}

/* The frame first, then its line: each line has its frame. */
static int write_slot(pupil_recorder *r, const slot *s)
{
    char line[PUPIL_RECORDING_LINE_BYTES];
    if (pupil_mkv_write(r->mkv, s->info.timestamp_ns, s->bytes, s->size))
        return fail(r, PUPIL_RECORDING_FRAMES);
    const size_t length =
        pupil_recording_line(line, r->lines, &s->info,
                             memcmp(s->balance, r->about.coding.balance, sizeof s->balance) == 0 ? NULL : s->balance);
    if (pupil_write_all(r->lines_fd, line, length)) {
        const int error = errno;
        (void)!ftruncate(r->lines_fd, r->lines_end);
        errno = error;
        return fail(r, PUPIL_RECORDING_LINES);
    }
    r->lines_end += (off_t)length;
    r->lines++;
    return 0;
}

static int to_disk(int fd)
{
    errno = folder_flush_file(fd);
    return errno ? -1 : 0;
}

static int complete(pupil_recorder *r)
{
    if (pupil_mkv_finish(r->mkv) || to_disk(r->frames_fd))
        return fail(r, PUPIL_RECORDING_FRAMES);
    return to_disk(r->lines_fd) ? fail(r, PUPIL_RECORDING_LINES) : 0;
}

/* The whole thread, with its end: no signal comes here. */
static void *write_frames(void *argument)
{
    pupil_recorder *r = argument;
    pthread_mutex_lock(&r->lock);
    for (;;) {
        while (!r->full_count && !r->ending)
            pthread_cond_wait(&r->came, &r->lock);
        if (!r->full_count || r->failed)
            break;
        const unsigned number = r->full_slots[r->full_first];
        r->full_first = (r->full_first + 1) % r->room;
        r->full_count--;
        pthread_mutex_unlock(&r->lock);
        const int failed = write_slot(r, &r->slots[number]);
        pthread_mutex_lock(&r->lock);
        r->free_slots[r->free_count++] = number;
        r->counts.written += !failed;
        r->failed = failed;
        pthread_cond_signal(&r->left);
    }
    pthread_mutex_unlock(&r->lock);
    const int failed = r->failed || complete(r);
    pthread_mutex_lock(&r->lock);
    r->failed = failed;
    r->done = 1;
    const int abandoned = r->abandoned;
    pthread_cond_signal(&r->left);
    pthread_mutex_unlock(&r->lock);
    if (abandoned)
        free_recorder(r);
    return NULL;
}

/* --- a frame --- */

static pupil_coding coding_of(const pupil_frame *frame)
{
    static const pupil_coding usual;
    return frame->image.coding ? *frame->image.coding : usual;
}

static int same_shape(const pupil_recording_about *about, const pupil_frame *frame)
{
    pupil_coding coding = coding_of(frame);
    memcpy(coding.balance, about->coding.balance, sizeof coding.balance);
    return frame->image.pixel == about->pixel && frame->image.width == about->width &&
           frame->image.height == about->height && !frame->coded == !about->jpeg &&
           memcmp(&coding, &about->coding, sizeof coding) == 0;
}

/* Copies the frame into the slot's memory, which grows for a larger JPEG. */
static int fill(pupil_recorder *r, slot *s, const pupil_frame *frame)
{
    s->size = r->about.jpeg ? frame->coded_bytes : r->frame_bytes;
    s->info = frame->info;
    const pupil_coding coding = coding_of(frame);
    memcpy(s->balance, coding.balance, sizeof s->balance);
    if (s->size > s->capacity) {
        unsigned char *more = realloc(s->bytes, s->size);
        if (!more)
            return -1;
        s->bytes = more;
        s->capacity = s->size;
    }
    if (r->about.jpeg)
        memcpy(s->bytes, frame->coded, s->size);
    else
        pupil_recording_pack(&frame->image, s->bytes);
    return 0;
}

/* A free slot's number; -1: there is none; -2: the recorder has failed, or is given up. */
static int take_slot(pupil_recorder *r, pupil_why *why)
{
    int number = -1, over = 0;
    pthread_mutex_lock(&r->lock);
    while (r->wait && !r->failed && !r->free_count && !over)
        over = wait_for_disk(r);
    if (over) {
        given_up(r, why);
        number = -2;
    } else if (r->failed) {
        pupil_refuse(why, "%s", r->why.text);
        number = -2;
    } else if (r->free_count) {
        number = (int)r->free_slots[--r->free_count];
    } else {
        r->counts.lost++;
    }
    pthread_mutex_unlock(&r->lock);
    return number;
}

int pupil_recorder_write(pupil_recorder *r, const pupil_frame *frame, pupil_why *why)
{
    if (!same_shape(&r->about, frame))
        return pupil_refuse(why,
                            "%s: a frame of %u x %u pixels came after frames of %u x %u, or of another format or "
                            "coding; a recording has one, so begin another",
                            r->folder, frame->image.width, frame->image.height, r->about.width, r->about.height);
    const int number = take_slot(r, why);
    if (number < 0)
        return number == -1 ? PUPIL_SINK_OK : PUPIL_SINK_FAILED;
    const int failed = fill(r, &r->slots[number], frame);
    pthread_mutex_lock(&r->lock);
    if (failed) {
        r->free_slots[r->free_count++] = (unsigned)number;
    } else {
        r->full_slots[(r->full_first + r->full_count++) % r->room] = (unsigned)number;
        pthread_cond_signal(&r->came);
    }
    pthread_mutex_unlock(&r->lock);
    return failed ? pupil_refuse(why, "%s: no memory for a frame of %zu bytes", r->folder, frame->coded_bytes)
                  : PUPIL_SINK_OK;
}

void pupil_recorder_get_counts(pupil_recorder *r, pupil_recorder_counts *counts)
{
    pthread_mutex_lock(&r->lock);
    *counts = r->counts;
    pthread_mutex_unlock(&r->lock);
}

/* --- open --- */

static int make_files(pupil_recorder *r, const char *camera, pupil_why *why)
{
    r->frames_fd = pupil_recording_create(r->folder, PUPIL_RECORDING_FRAMES, why);
    if (r->frames_fd < 0)
        return -1;
    r->lines_fd = pupil_recording_create(r->folder, PUPIL_RECORDING_LINES, why);
    if (r->lines_fd < 0)
        return -1;
    if (pupil_mkv_create(&r->mkv, r->frames_fd, &r->about))
        return pupil_refuse(why, "%s/" PUPIL_RECORDING_FRAMES ": cannot be written: %s", r->folder, strerror(errno));
    return pupil_recording_about_write(r->folder, &r->about, camera, why);
}

static int make_slots(pupil_recorder *r, unsigned room)
{
    r->room = room > ROOM_MOST ? ROOM_MOST : room ? room : r->wait ? ROOM_WAIT : ROOM_USUAL;
    r->slots = calloc(r->room, sizeof *r->slots);
    r->free_slots = calloc(r->room, sizeof *r->free_slots);
    r->full_slots = calloc(r->room, sizeof *r->full_slots);
    if (!r->slots || !r->free_slots || !r->full_slots)
        return -1;
    for (unsigned i = 0; i < r->room; i++) {
        r->slots[i].capacity = r->frame_bytes;
        r->slots[i].bytes = malloc(r->frame_bytes);
        if (!r->slots[i].bytes)
            return -1;
        r->free_slots[r->free_count++] = i;
    }
    return 0;
}

/* Blocks signals: they are for the threads that wait for them. */
static int start(pupil_recorder *r)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    r->has_thread = pthread_create(&r->thread, NULL, write_frames, r) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return r->has_thread ? 0 : -1;
}

static void describe(pupil_recorder *r, const pupil_frame *first, const pupil_recorder_options *options)
{
    pupil_recording_about *a = &r->about;
    a->pixel = first->image.pixel;
    a->width = first->image.width;
    a->height = first->image.height;
    a->jpeg = first->coded != NULL;
    a->fps = options->fps;
    a->primaries = options->primaries;
    if (first->image.coding)
        a->coding = *first->image.coding;
}

static void remove_all(const pupil_recorder *r)
{
    pupil_recording_remove_files(r->folder);
    if (r->made_folder)
        rmdir(r->folder);
}

static int begin(pupil_recorder *r, const pupil_recorder_options *options, pupil_why *why)
{
    pupil_why words;
    if (pupil_recording_check(&r->about, &words))
        return pupil_refuse(why, "%s: %s", r->folder, words.text);
    r->frame_bytes = pupil_recording_bytes(&r->about);
    if (make_slots(r, options->room))
        return pupil_refuse(why, "%s: no memory for %u frames of %zu bytes that wait for the disk", r->folder, r->room,
                            r->frame_bytes);
    r->made_folder = pupil_recording_make_folder(r->folder, options->overwrite, why);
    if (r->made_folder < 0)
        return -1;
    int failed = make_files(r, options->camera, why);
    if (!failed && start(r))
        failed = pupil_refuse(why, "%s: no thread can be started", r->folder);
    if (failed)
        remove_all(r);
    return failed;
}

int pupil_recorder_open(pupil_recorder **recorder, const char *folder, const pupil_frame *first,
                        const pupil_recorder_options *options, pupil_why *why)
{
    pthread_condattr_t monotonic;
    pupil_recorder *r = calloc(1, sizeof *r);
    *recorder = NULL;
    if (!r)
        return pupil_refuse(why, "%s: not enough memory", folder);
    r->frames_fd = r->lines_fd = -1;
    r->wait = options->wait;
    r->give_up = options->give_up;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&r->lock, NULL);
    pthread_cond_init(&r->came, NULL);
    pthread_cond_init(&r->left, &monotonic);
    pthread_condattr_destroy(&monotonic);
    describe(r, first, options);
    const int too_long = snprintf(r->folder, sizeof r->folder, "%s", folder) >= (int)sizeof r->folder;
    if (too_long || begin(r, options, why)) {
        if (too_long)
            pupil_refuse(why, "the folder's name is too long");
        free_recorder(r);
        return PUPIL_SINK_FAILED;
    }
    *recorder = r;
    return PUPIL_SINK_OK;
}

/* --- close --- */

int pupil_recorder_close(pupil_recorder *r, pupil_why *why)
{
    if (!r)
        return PUPIL_SINK_OK;
    pthread_mutex_lock(&r->lock);
    r->ending = 1;
    pthread_cond_signal(&r->came);
    while (!r->done && !r->abandoned)
        r->abandoned = wait_for_disk(r);
    const pthread_t thread = r->thread;
    const int abandoned = r->abandoned;
    if (abandoned) { /* with the lock: once it is released, the thread owns the recorder */
        given_up(r, why);
        pthread_detach(thread);
    }
    pthread_mutex_unlock(&r->lock);
    if (abandoned)
        return PUPIL_SINK_FAILED;
    pthread_join(thread, NULL);
    const int failed = r->failed;
    if (failed)
        pupil_refuse(why, "%s", r->why.text);
    if (failed && !r->lines)
        remove_all(r);
    free_recorder(r);
    return failed ? PUPIL_SINK_FAILED : PUPIL_SINK_OK;
}

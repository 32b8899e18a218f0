/* tests/fake_v4l2/fake_v4l2.c: the fake's files, maps and clock: the table of system calls. */
#include "fake_v4l2_private.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const fake_settings usual_settings = {1, 100, 16, 0};

#define CALL_NS 1000 /* the time that a call takes */

int fake_fail(int error)
{
    errno = error;
    return -1;
}

static int64_t machine_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* Its format and size if it has only one of each. */
static void set_up(fake_v4l2 *f)
{
    f->fourcc = f->config.only_format ? f->config.only_format : f->fourcc;
    f->width = f->config.width ? f->config.width : f->width;
    f->height = f->config.width ? f->config.height : f->height;
}

static void pass(fake_v4l2 *f, int64_t ns)
{
    f->now_ns = f->config.real_time ? machine_ns() : f->now_ns + ns;
    if (!f->plugged && f->back_ns && f->now_ns >= f->back_ns) {
        f->plugged = 1;
        f->back_ns = 0;
        set_up(f);
        f->node = f->config.back_as;
        f->settings = usual_settings; /* it had lost power */
        f->config.unplug_at = 0;      /* once */
    }
    fake_produce(f);
}

/* --- files --- */

static int kind_of_path(const fake_v4l2 *f, const char *path)
{
    char camera[32];
    snprintf(camera, sizeof camera, "/dev/video%d", f->node);
    if (f->plugged && strcmp(path, camera) == 0)
        return FAKE_CAMERA;
    if (f->plugged && strcmp(path, "/dev/video1") == 0)
        return FAKE_METADATA;
    if (strcmp(path, "/dev/video2") == 0)
        return FAKE_OUTPUT;
    if (f->config.twin && strcmp(path, "/dev/video3") == 0)
        return FAKE_TWIN;
    if (f->config.heaps >= 1 && strcmp(path, "/dev/dma_heap/system") == 0)
        return FAKE_HEAP;
    if (f->config.heaps >= 2 && strcmp(path, "/dev/dma_heap/linux,cma") == 0)
        return FAKE_CONTIGUOUS;
    if (!f->config.media)
        return 0;
    return strcmp(path, "/dev/media0") == 0        ? FAKE_MEDIA
           : strcmp(path, "/dev/v4l-subdev0") == 0 ? FAKE_SENSOR
           : strcmp(path, "/dev/v4l-subdev1") == 0 ? FAKE_RECEIVER
                                                   : 0;
}

static int fake_open(void *context, const char *path)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    pass(f, CALL_NS);
    const int kind = kind_of_path(f, path);
    const int fd = kind ? fake_keep(f, eventfd(0, EFD_CLOEXEC), kind) : fake_fail(ENOENT);
    pthread_mutex_unlock(&f->lock);
    return fd;
}

static int camera_is_open(const fake_v4l2 *f)
{
    int open_files = 0;
    for (int i = 0; i < FAKE_MOST_FILES; i++)
        open_files += f->file[i].kind == FAKE_CAMERA && !f->file[i].gone;
    return open_files > 0;
}

static int fake_close(void *context, int fd)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    fake_file *file = fake_file_of(f, fd);
    int result = fake_fail(EBADF);
    if (file) {
        if (fd == f->owner)
            fake_free_buffers(f);
        if (fd == f->output.owner)
            fake_output_free(f);
        f->unsynced += file->reading;
        file->kind = 0;
        if (!camera_is_open(f))
            f->event_count = f->subscribed = 0;
        result = close(fd);
    }
    pthread_mutex_unlock(&f->lock);
    return result;
}

static int share(fake_v4l2 *f, struct v4l2_exportbuffer *e)
{
    if (f->config.no_share)
        return fake_fail(ENOTTY);
    if (e->index >= f->buffers || e->plane >= fake_areas(f) || f->memory != V4L2_MEMORY_MMAP)
        return fake_fail(EINVAL);
    e->fd = fake_keep(f, dup(f->buffer[e->index].memfd[e->plane]), FAKE_SHARED);
    return e->fd < 0 ? -1 : 0;
}

/* While other threads continue. */
static void sleep_in_write(fake_v4l2 *f)
{
    const double s = f->config.sleep_s;
    const struct timespec t = {(time_t)s, (long)((s - (double)(time_t)s) * 1e9)};
    pthread_mutex_unlock(&f->lock);
    nanosleep(&t, NULL);
    pthread_mutex_lock(&f->lock);
}

static int fake_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    if ((request == VIDIOC_S_CTRL || request == VIDIOC_S_EXT_CTRLS) && ++f->writes == f->config.sleep_at)
        sleep_in_write(f);
    pass(f, CALL_NS);
    fake_file *file = fake_file_of(f, fd);
    int result;
    if (!file)
        result = fake_fail(EBADF);
    else if (file->gone)
        result = fake_fail(ENODEV);
    else if (file->kind == FAKE_SHARED)
        result = fake_dmabuf_ioctl(f, file, request, argument);
    else if (file->kind == FAKE_HEAP || file->kind == FAKE_CONTIGUOUS)
        result = fake_heap_ioctl(f, file->kind, request, argument);
    else if (file->kind >= FAKE_MEDIA)
        result = fake_media_ioctl(f, file->kind, request, argument);
    else if (request == VIDIOC_QUERYCAP)
        result = fake_querycap(f, file->kind, argument);
    else if (file->kind == FAKE_OUTPUT)
        result = f->output.gone ? fake_fail(ENODEV) : fake_output_ioctl(f, fd, request, argument);
    else if (file->kind != FAKE_CAMERA && file->kind != FAKE_TWIN)
        result = fake_fail(ENOTTY);
    else if (request == VIDIOC_EXPBUF)
        result = share(f, argument);
    else
        result = fake_stream_ioctl(f, file->kind == FAKE_TWIN ? -1 : fd, request, argument);
    pthread_mutex_unlock(&f->lock);
    return result;
}

/* --- maps: the offset is the buffer's index and area --- */

static void *fake_mmap(void *context, size_t bytes, int fd, off_t offset)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    const uint32_t index = (uint32_t)(offset >> 16) / PUPIL_V4L2_MOST_AREAS;
    const uint32_t area = (uint32_t)(offset >> 16) % PUPIL_V4L2_MOST_AREAS;
    void *memory = NULL;
    errno = EINVAL;
    if (fd == f->owner && index < f->buffers && area < fake_areas(f) && bytes <= f->buffer[index].bytes[area]) {
        memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, f->buffer[index].memfd[area], 0);
        memory = memory == MAP_FAILED ? NULL : memory;
        fake_note_map(f, memory);
    }
    const fake_file *file = fake_file_of(f, fd);
    struct stat status;
    if (file && file->kind == FAKE_SHARED && offset == 0 && fstat(fd, &status) == 0 && (off_t)bytes <= status.st_size) {
        memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
        memory = memory == MAP_FAILED ? NULL : memory;
    }
    if (fd == f->output.owner)
        memory = fake_output_mmap(f, bytes, offset);
    f->maps += memory != NULL;
    pthread_mutex_unlock(&f->lock);
    return memory;
}

static int fake_munmap(void *context, void *memory, size_t bytes)
{
    fake_v4l2 *f = context;
    const int result = munmap(memory, bytes);
    pthread_mutex_lock(&f->lock);
    f->maps -= result == 0;
    fake_forget_map(f, memory);
    pthread_mutex_unlock(&f->lock);
    return result;
}

static ssize_t fake_write(void *context, int fd, const void *data, size_t bytes)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    pass(f, CALL_NS);
    const fake_file *file = fake_file_of(f, fd);
    ssize_t result;
    if (!file || file->kind != FAKE_OUTPUT)
        result = fake_fail(file ? EINVAL : EBADF);
    else
        result = f->output.gone ? fake_fail(ENODEV) : fake_output_write(f, data, bytes);
    pthread_mutex_unlock(&f->lock);
    return result;
}

/* --- the clock --- */

static short ready_for(fake_v4l2 *f, const struct pollfd *p)
{
    const fake_file *file = fake_file_of(f, p->fd);
    if (!file)
        return POLLNVAL;
    if (file->gone)
        return POLLERR | POLLHUP | POLLPRI;
    if (file->kind == FAKE_OUTPUT)
        return fake_output_ready(f);
    short ready = 0;
    if (f->event_count)
        ready |= p->events & POLLPRI;
    if (f->broken || !f->streaming || (!f->waiting && !f->ready_count))
        return ready | POLLERR;
    if (f->ready_count)
        ready |= p->events & POLLIN;
    return ready;
}

static int fake_poll(void *context, struct pollfd *fds, nfds_t count, int timeout_ms)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    pass(f, CALL_NS);
    const int64_t end_ns = f->now_ns + (int64_t)timeout_ms * 1000000;
    int found = 0;
    for (;;) {
        for (nfds_t i = 0; i < count; i++) {
            fds[i].revents = ready_for(f, &fds[i]);
            found += fds[i].revents != 0;
        }
        if (found || f->now_ns >= end_ns)
            break;
        const fake_file *first = count ? fake_file_of(f, fds[0].fd) : NULL;
        int64_t next_ns = first && first->kind == FAKE_OUTPUT ? fake_output_next_ns(f) : fake_next_ns(f);
        next_ns = next_ns < end_ns ? next_ns : end_ns;
        const int64_t wait_ns = next_ns > f->now_ns ? next_ns - f->now_ns : 1;
        if (f->config.real_time) {
            const struct timespec t = {wait_ns / 1000000000, wait_ns % 1000000000};
            pthread_mutex_unlock(&f->lock);
            nanosleep(&t, NULL);
            pthread_mutex_lock(&f->lock);
        }
        pass(f, wait_ns);
    }
    pthread_mutex_unlock(&f->lock);
    return found;
}

static int64_t fake_now_ns(void *context)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    pass(f, 0);
    const int64_t now_ns = f->now_ns;
    pthread_mutex_unlock(&f->lock);
    return now_ns;
}

/* --- folders --- */

static int fake_list(void *context, const char *folder, void (*found)(void *closure, const char *name), void *closure)
{
    fake_v4l2 *f = context;
    char camera[16];
    if (strcmp(folder, "/dev") != 0)
        return fake_fail(ENOENT);
    pthread_mutex_lock(&f->lock);
    pass(f, CALL_NS);
    snprintf(camera, sizeof camera, "video%d", f->node);
    const struct {
        int there;
        const char *name;
    } names[] = {{1, "null"},
                 {1, "video2"},
                 {f->plugged, "video1"},
                 {f->plugged, camera},
                 {f->config.twin, "video3"},
                 {f->config.media != FAKE_MEDIA_NONE, "media0"},
                 {f->config.media != FAKE_MEDIA_NONE, "v4l-subdev0"}};
    pthread_mutex_unlock(&f->lock);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (names[i].there)
            found(closure, names[i].name);
    return 0;
}

static int fake_device_number(void *context, int fd, uint32_t *major, uint32_t *minor)
{
    fake_v4l2 *f = context;
    pthread_mutex_lock(&f->lock);
    const fake_file *file = fake_file_of(f, fd);
    *major = FAKE_MAJOR;
    *minor = file && file->kind == FAKE_CAMERA ? (uint32_t)f->node : 255;
    pthread_mutex_unlock(&f->lock);
    return file ? 0 : fake_fail(EBADF);
}

static int fake_device_name(void *context, uint32_t major, uint32_t minor, char *name, size_t name_bytes)
{
    return fake_media_name(context, major, minor, name, name_bytes);
}

/* --- creation and end --- */

void fake_unplug(fake_v4l2 *f)
{
    f->plugged = 0;
    f->back_ns = f->config.back_s > 0.0 ? f->now_ns + (int64_t)(f->config.back_s * 1e9) : 0;
    f->streaming = 0;
    for (int i = 0; i < FAKE_MOST_FILES; i++)
        if (f->file[i].kind == FAKE_CAMERA || f->file[i].kind == FAKE_METADATA)
            f->file[i].gone = 1;
}

void fake_v4l2_config_default(fake_v4l2_config *config)
{
    *config = (fake_v4l2_config){.seed = 1, .fps = 30.0, .control_delay = 2};
}

fake_v4l2 *fake_v4l2_new(const fake_v4l2_config *config)
{
    fake_v4l2 *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->config = *config;
    f->system = (pupil_v4l2_system){
        f,           fake_open, fake_close,         fake_ioctl,       fake_mmap,  fake_munmap, fake_poll,
        fake_now_ns, fake_list, fake_device_number, fake_device_name, fake_write, fake_read_ns};
    pthread_mutex_init(&f->lock, NULL);
    f->now_ns = config->real_time ? machine_ns() : INT64_C(1000000000000);
    f->light = 1.0;
    f->plugged = !config->absent;
    f->fourcc = V4L2_PIX_FMT_YUYV;
    f->width = 64;
    f->height = 48;
    set_up(f);
    f->type = config->multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
    f->owner = f->output.owner = -1;
    f->output.fourcc = config->out_format ? config->out_format : V4L2_PIX_FMT_RGB24;
    f->settings = usual_settings;
    for (int i = 0; i < FAKE_SETTINGS; i++)
        f->of_frame[i] = f->settings;
    return f;
}

void fake_v4l2_free(fake_v4l2 *f)
{
    if (!f)
        return;
    fake_free_buffers(f);
    fake_output_free(f);
    free(f->output.shown);
    for (int i = 0; i < FAKE_MOST_FILES; i++)
        if (f->file[i].kind)
            close(f->file[i].fd);
    pthread_mutex_destroy(&f->lock);
    free(f);
}

const pupil_v4l2_system *fake_v4l2_system(fake_v4l2 *f)
{
    return &f->system;
}

void fake_v4l2_reconfigure(fake_v4l2 *f, const fake_v4l2_config *config)
{
    pthread_mutex_lock(&f->lock);
    f->config = *config;
    f->writes = 0;
    pthread_mutex_unlock(&f->lock);
}

void fake_v4l2_light(fake_v4l2 *f, double light)
{
    pthread_mutex_lock(&f->lock);
    f->light = light;
    pthread_mutex_unlock(&f->lock);
}

fake_v4l2_held fake_v4l2_holds(fake_v4l2 *f)
{
    fake_v4l2_held held = {0};
    pthread_mutex_lock(&f->lock);
    held.maps = f->maps;
    held.unsynced = f->unsynced;
    for (int i = 0; i < FAKE_MOST_FILES; i++)
        held.files += f->file[i].kind != 0;
    pthread_mutex_unlock(&f->lock);
    return held;
}

/* tests/fake_v4l2/fake_memory.c: memory that is read slowly, dma-heaps and their dma-bufs.
 *
 * A dma-buf has what the camera wrote only after its sync: a read without one sees the old contents. */
#include "fake_v4l2_private.h"

#include <errno.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define SLOW_TIMES 20

fake_file *fake_file_of(fake_v4l2 *f, int fd)
{
    for (int i = 0; i < FAKE_MOST_FILES; i++)
        if (f->file[i].kind && f->file[i].fd == fd)
            return &f->file[i];
    return NULL;
}

int fake_keep(fake_v4l2 *f, int fd, int kind)
{
    for (int i = 0; fd >= 0 && i < FAKE_MOST_FILES; i++)
        if (!f->file[i].kind) {
            f->file[i] = (fake_file){.fd = fd, .kind = kind};
            return fd;
        }
    if (fd >= 0)
        close(fd);
    return fake_fail(EMFILE);
}

/* --- dma-bufs --- */

int fake_heap_ioctl(fake_v4l2 *f, int kind, unsigned long request, void *argument)
{
    struct dma_heap_allocation_data *ask = argument;
    if (request != DMA_HEAP_IOCTL_ALLOC)
        return fake_fail(ENOTTY);
    const int memfd = memfd_create("fake dma-buf", MFD_CLOEXEC);
    if (memfd >= 0 && ftruncate(memfd, (off_t)ask->len) != 0) {
        close(memfd);
        return fake_fail(ENOMEM);
    }
    const int fd = fake_keep(f, memfd, FAKE_SHARED);
    if (fd < 0)
        return -1;
    fake_file_of(f, fd)->heap = kind;
    ask->fd = (uint32_t)fd;
    return 0;
}

/* Copies what the camera wrote into the dma-buf. */
static int arrive(const fake_v4l2 *f, int fd)
{
    for (uint32_t i = 0; i < f->buffers; i++)
        for (int k = 0; k < PUPIL_V4L2_MOST_AREAS; k++) {
            const fake_buffer *b = &f->buffer[i];
            if (f->memory == V4L2_MEMORY_DMABUF && b->dmabuf[k] == fd && b->memory[k] &&
                pwrite(fd, b->memory[k], b->bytes[k], 0) != (ssize_t)b->bytes[k])
                return fake_fail(EIO);
        }
    return 0;
}

int fake_dmabuf_ioctl(fake_v4l2 *f, fake_file *file, unsigned long request, const void *argument)
{
    const struct dma_buf_sync *sync = argument;
    if (request != DMA_BUF_IOCTL_SYNC)
        return fake_fail(ENOTTY);
    const int end = (sync->flags & DMA_BUF_SYNC_END) != 0;
    f->unsynced += end != file->reading || !(sync->flags & DMA_BUF_SYNC_READ);
    file->reading = !end;
    return end ? 0 : arrive(f, file->fd);
}

int fake_import(fake_v4l2 *f, fake_buffer *own, uint32_t area, int fd, uint32_t bytes, uint32_t least)
{
    const fake_file *file = fake_file_of(f, fd);
    struct stat status;
    if (!file || file->kind != FAKE_SHARED || fstat(fd, &status) != 0 || bytes < least || status.st_size < bytes ||
        (f->config.contiguous && file->heap != FAKE_CONTIGUOUS))
        return fake_fail(EINVAL);
    f->unsynced += file->reading;
    own->dmabuf[area] = fd;
    if (!own->memory[area])
        own->memory[area] = calloc(1, bytes);
    own->bytes[area] = bytes;
    return own->memory[area] ? 0 : fake_fail(ENOMEM);
}

/* --- slow memory --- */

void fake_note_map(fake_v4l2 *f, void *memory)
{
    for (int i = 0; f->config.slow && !f->cached && i < FAKE_MOST_BUFFERS * PUPIL_V4L2_MOST_AREAS; i++)
        if (!f->slow[i]) {
            f->slow[i] = memory;
            return;
        }
}

void fake_forget_map(fake_v4l2 *f, const void *memory)
{
    for (int i = 0; i < FAKE_MOST_BUFFERS * PUPIL_V4L2_MOST_AREAS; i++)
        f->slow[i] = f->slow[i] == memory ? NULL : f->slow[i];
}

int64_t fake_read_ns(void *context, const void *memory, size_t bytes)
{
    fake_v4l2 *f = context;
    int slow = 0;
    pthread_mutex_lock(&f->lock);
    for (int i = 0; i < FAKE_MOST_BUFFERS * PUPIL_V4L2_MOST_AREAS; i++)
        slow |= f->slow[i] && f->slow[i] == memory;
    pthread_mutex_unlock(&f->lock);
    return (int64_t)bytes / 8 * (slow ? SLOW_TIMES : 1); /* 8 GB/s */
}

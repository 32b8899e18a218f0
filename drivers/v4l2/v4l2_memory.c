#include "v4l2/v4l2_memory.h"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <stdlib.h>
#include <string.h>

#define MEASURED_BYTES (256u << 10) /* 5 ms at 50 MB/s, the slowest that is usual */
#define PASSES         3

const char *const pupil_v4l2_heaps[] = {"/dev/dma_heap/system", "/dev/dma_heap/linux,cma", "/dev/dma_heap/reserved",
                                        "/dev/dma_heap/default_cma_region", NULL};

/* The least of a few: the others were interrupted, or came before the caches had it. */
static double read_speed(const pupil_v4l2_system *system, const void *memory, size_t bytes)
{
    int64_t least_ns = INT64_MAX;
    for (int i = 0; i < PASSES; i++) {
        const int64_t ns = system->read_ns(system->context, memory, bytes);
        least_ns = ns < least_ns ? ns : least_ns;
    }
    return (double)bytes * 1e9 / (double)(least_ns > 0 ? least_ns : 1);
}

pupil_v4l2_speed pupil_v4l2_measure(const pupil_v4l2_system *system, const void *memory, size_t bytes)
{
    pupil_v4l2_speed speed = {0};
    const size_t measured = (bytes < MEASURED_BYTES ? bytes : MEASURED_BYTES) / sizeof(uint64_t) * sizeof(uint64_t);
    void *ordinary = measured ? malloc(measured) : NULL;
    if (!ordinary)
        return speed;
    memset(ordinary, 1, measured);
    speed.bytes_s = read_speed(system, memory, measured);
    speed.ordinary = read_speed(system, ordinary, measured);
    free(ordinary);
    return speed;
}

int pupil_v4l2_is_slow(const pupil_v4l2_speed *speed)
{
    return speed->bytes_s > 0.0 && speed->bytes_s * PUPIL_V4L2_SLOW < speed->ordinary;
}

int pupil_v4l2_heap_buffer(const pupil_v4l2_system *system, int heap_fd, size_t bytes)
{
    struct dma_heap_allocation_data ask = {.len = bytes, .fd_flags = O_RDWR | O_CLOEXEC};
    return pupil_v4l2_ioctl(system, heap_fd, DMA_HEAP_IOCTL_ALLOC, &ask) == 0 ? (int)ask.fd : -1;
}

int pupil_v4l2_sync(const pupil_v4l2_system *system, int fd, int start)
{
    struct dma_buf_sync sync = {.flags = DMA_BUF_SYNC_READ | (start ? DMA_BUF_SYNC_START : DMA_BUF_SYNC_END)};
    return pupil_v4l2_ioctl(system, fd, DMA_BUF_IOCTL_SYNC, &sync);
}

#include "memory.h"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <stdlib.h>
#include <string.h>

#define MEASURED_BYTES (256u << 10) /* 5 ms at 50 MB/s, the slowest that is usual */
#define LEAST_PASSES   3
#define MOST_PASSES    16

const char *const pupil_v4l2_heaps[] = {"/dev/dma_heap/system", "/dev/dma_heap/linux,cma", "/dev/dma_heap/reserved",
                                        "/dev/dma_heap/default_cma_region", NULL};

static int64_t sooner(const pupil_v4l2_system *system, const void *memory, size_t bytes, int64_t than_ns)
{
    const int64_t ns = system->read_ns(system->context, memory, bytes);
    return ns < than_ns ? ns : than_ns;
}

static double speed_of(size_t bytes, int64_t ns)
{
    return (double)bytes * 1e9 / (double)(ns > 0 ? ns : 1);
}

/* The smallest of a few times: the others were interrupted, or ran before the caches were warm. By turns, so that a
 * processor's change of clock affects both; small buffers more often, for they are over before the clock has moved far.
 */
pupil_v4l2_speed pupil_v4l2_measure(const pupil_v4l2_system *system, const void *memory, size_t bytes)
{
    pupil_v4l2_speed speed = {0};
    const size_t measured = (bytes < MEASURED_BYTES ? bytes : MEASURED_BYTES) / sizeof(uint64_t) * sizeof(uint64_t);
    void *ordinary = measured ? malloc(measured) : NULL;
    int64_t memory_ns = INT64_MAX, ordinary_ns = INT64_MAX;
    if (!ordinary)
        return speed;
    memset(ordinary, 1, measured);
    for (size_t i = 0; i < LEAST_PASSES || (i < MOST_PASSES && i * measured < MEASURED_BYTES); i++) {
        memory_ns = sooner(system, memory, measured, memory_ns);
        ordinary_ns = sooner(system, ordinary, measured, ordinary_ns);
    }
    speed.bytes_s = speed_of(measured, memory_ns);
    speed.ordinary = speed_of(measured, ordinary_ns);
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

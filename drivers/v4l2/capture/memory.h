/* drivers/v4l2/capture/memory.h: how fast the CPU reads the memory of frames, and memory that it reads fast.
 *
 * Buffers of many boards' cameras are mapped without caches: reading them takes ten times as long as reading ordinary
 * memory, and metering them longer than the sensor's exposure. That is measured, not guessed. */
#ifndef PUPIL_DRIVERS_V4L2_CAPTURE_MEMORY_H
#define PUPIL_DRIVERS_V4L2_CAPTURE_MEMORY_H

#include "v4l2/system.h"

/* Memory that takes more than so many times as long to read as ordinary memory is slow. Nothing is in between: cached
 * memory measures within a factor of 2, uncached at 10 and more. */
#define PUPIL_V4L2_SLOW 3.0

typedef struct pupil_v4l2_speed {
    double bytes_s;  /* of this memory, read; 0: not measured */
    double ordinary; /* of ordinary memory of the same size; 0: not measured */
} pupil_v4l2_speed;

/* Reads up to 256 KiB of it a few times, and as much of ordinary memory: a few ms where it is slow. */
pupil_v4l2_speed pupil_v4l2_measure(const pupil_v4l2_system *system, const void *memory, size_t bytes);
int pupil_v4l2_is_slow(const pupil_v4l2_speed *speed);

/* Heaps for dma-bufs, best first; NULL at the end. Cameras without an MMU of their own need contiguous memory, which
 * only the later ones give. */
extern const char *const pupil_v4l2_heaps[];

/* A dma-buf of an open heap: its file descriptor, or -1 and errno. */
int pupil_v4l2_heap_buffer(const pupil_v4l2_system *system, int heap_fd, size_t bytes);

/* Before the CPU reads a dma-buf that a device has written (start 1), and after it. 0, or -1 and errno. */
int pupil_v4l2_sync(const pupil_v4l2_system *system, int fd, int start);

#endif

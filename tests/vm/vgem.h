/* tests/vm/vgem.h: dma-bufs of the kernel's vgem driver: plain memory that V4L2, EGL and the CPU all reach. */
#ifndef PUPIL_TESTS_VM_VGEM_H
#define PUPIL_TESTS_VM_VGEM_H

#include <stddef.h>

typedef struct vgem_buffer {
    int fd; /* the dma-buf */
    unsigned char *data;
    size_t bytes;
} vgem_buffer;

/* The device's file descriptor, or -1 if there is no vgem. */
int vgem_open(void);

/* A buffer of so many bytes or more, all of them 0x5a. 0, or -1 (errno). */
int vgem_make(int device, size_t bytes, vgem_buffer *buffer);
void vgem_free(vgem_buffer *buffer);

/* Around every access by the CPU (DMA_BUF_IOCTL_SYNC). */
void vgem_begin(const vgem_buffer *buffer);
void vgem_end(const vgem_buffer *buffer);

#endif

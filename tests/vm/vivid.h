/* tests/vm/vivid.h: the kernel's test camera and test monitor (vivid, multi-planar), fed with dma-bufs. */
#ifndef PUPIL_TESTS_VM_VIVID_H
#define PUPIL_TESTS_VM_VIVID_H

#include <stdint.h>

#include "vm/vgem.h"

#define VIVID_BUFFERS 3

typedef struct vivid_node {
    int fd;
    uint32_t type;                        /* a v4l2_buf_type */
    uint32_t width, height, planes;       /* as accepted by the driver */
    uint32_t stride_bytes[2];             /* of each buffer of a frame */
    vgem_buffer buffer[VIVID_BUFFERS][2]; /* of each frame, one or two */
} vivid_node;

/* Calls that return int: 0, or -1 after printing what was refused. */

/* The first capture (output: output) node of vivid. */
int vivid_open(vivid_node *node, int output);

/* Sizes and formats: `padding_bytes` more a row than it needs. Buffers of vgem, which are not queued yet. */
int vivid_start(vivid_node *node, int vgem, uint32_t fourcc, uint32_t width, uint32_t height, uint32_t padding_bytes);
int vivid_queue(vivid_node *node, uint32_t index);
int vivid_stream(vivid_node *node);
/* The index of the next frame that is done, or -1: none within ten seconds. */
int vivid_dequeue(vivid_node *node);
/* Streaming off, and the buffers freed. */
void vivid_stop(vivid_node *node);

#endif

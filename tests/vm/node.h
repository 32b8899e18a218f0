/* tests/vm/node.h: a video node as in v4l2-ctl: its controls, inputs and timings, by file descriptor. */
#ifndef PUPIL_TESTS_VM_NODE_H
#define PUPIL_TESTS_VM_NODE_H

#include <stdint.h>

/* Calls that return int: 0 (or what they ask for), or -1 after printing what was refused. */

/* The n-th (from 0) node of a driver that captures, or, output 1, that takes frames. -1: none. */
int node_find(const char *driver, int output, int n, char path[32]);
int node_open(const char *path); /* the file descriptor */

/* A control by the name that v4l2-ctl -l prints; 0: it has none. */
uint32_t node_control_id(int fd, const char *name);
int node_set(int fd, const char *name, int value); /* of menus the item's index */
int node_get(int fd, const char *name, int *value);

int node_input(int fd, int index);
/* The digital signal at an HDMI connector: the size's timings, at so many frames a second. */
int node_timings(int fd, uint32_t width, uint32_t height, unsigned fps);
/* vivid: from now on this camera's HDMI input sees what the HDMI monitor shows, not the test pattern. */
int node_cable(int fd);
/* The format of an output node, by its fourcc. */
int node_output_format(int fd, uint32_t fourcc, uint32_t width, uint32_t height);

/* Open files of this process, and its maps of video nodes and dma-bufs. */
typedef struct node_held {
    int files, maps;
} node_held;
node_held node_holds(void);

#endif

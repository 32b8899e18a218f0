/* capture.h: a program's own capture loop, in plain V4L2, without pupil. */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

static void (*at_exit_of_capture)(void); /* called before an error ends the program */
static void *capture_memory[VIDEO_MAX_FRAME];
static struct v4l2_buffer capture_buffer; /* of the frame that is dequeued */

static void must(int done, const char *what)
{
    if (done)
        return;
    fprintf(stderr, "full: %s: %s\n", what, strerror(errno));
    if (at_exit_of_capture)
        at_exit_of_capture();
    exit(1);
}

/* Streams YUYV into four buffers, in the size that the camera is set to. */
static struct v4l2_pix_format capture_start(int fd)
{
    static struct v4l2_format format;
    static struct v4l2_requestbuffers request;
    struct v4l2_buffer *b = &capture_buffer;
    format.type = request.type = b->type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = b->memory = V4L2_MEMORY_MMAP;
    request.count = 4;
    must(ioctl(fd, VIDIOC_G_FMT, &format) == 0, "VIDIOC_G_FMT");
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_YUYV;
    must(ioctl(fd, VIDIOC_S_FMT, &format) == 0, "VIDIOC_S_FMT");
    errno = EINVAL; /* the driver may have chosen another format */
    must(format.fmt.pix.pixelformat == V4L2_PIX_FMT_YUYV, "the camera has no YUYV");
    must(ioctl(fd, VIDIOC_REQBUFS, &request) == 0, "VIDIOC_REQBUFS");
    for (b->index = 0; b->index < request.count; b->index++) {
        must(ioctl(fd, VIDIOC_QUERYBUF, b) == 0, "VIDIOC_QUERYBUF");
        void *memory = mmap(NULL, b->length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, (off_t)b->m.offset);
        must(memory != MAP_FAILED && ioctl(fd, VIDIOC_QBUF, b) == 0, "a buffer");
        capture_memory[b->index] = memory;
    }
    must(ioctl(fd, VIDIOC_STREAMON, &format.type) == 0, "VIDIOC_STREAMON");
    return format.fmt.pix;
}

/* The next frame's pixels. */
static const void *capture_next(int fd)
{
    must(ioctl(fd, VIDIOC_DQBUF, &capture_buffer) == 0, "VIDIOC_DQBUF");
    return capture_memory[capture_buffer.index];
}

static int64_t capture_time_ns(void)
{
    return (int64_t)capture_buffer.timestamp.tv_sec * 1000000000 + (int64_t)capture_buffer.timestamp.tv_usec * 1000;
}

static int64_t capture_now_ns(void) /* by the clock of capture_time_ns */
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* The frame period that the driver reports, or a usual one. */
static double capture_frame_s(int fd)
{
    static struct v4l2_streamparm p;
    const struct v4l2_fract *f = &p.parm.capture.timeperframe;
    p.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    return ioctl(fd, VIDIOC_G_PARM, &p) == 0 && f->numerator && f->denominator ? (double)f->numerator / f->denominator
                                                                               : 1.0 / 30.0;
}

/* When the dequeued frame was complete: some drivers stamp the start of its exposure. */
static int64_t capture_end_ns(double frame_s)
{
    const int starts = (capture_buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
    return capture_time_ns() + (starts ? (int64_t)(frame_s * 1e9) : 0);
}

static void capture_done(int fd)
{
    must(ioctl(fd, VIDIOC_QBUF, &capture_buffer) == 0, "VIDIOC_QBUF");
}

/* full DEVICE: a camera's exposure time, gain and picture in a loop of plain V4L2. Pictures go to stdout as RGB24.
 *     cc full.c $(pkg-config --cflags --libs pupil pupil-camera) -o full
 *     ./full /dev/video0 | ffplay -f rawvideo -pixel_format rgb24 -video_size 640x480 - */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <pupil/camera_controls.h>
#include <pupil/pupil.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

static pupil_camera *camera;

static void quit(int signal_number)
{
    pupil_camera_restore(camera); /* every control as it was */
    _exit(128 + signal_number);
}

static void must(int done, const char *what)
{
    if (done)
        return;
    fprintf(stderr, "full: %s: %s\n", what, strerror(errno));
    pupil_camera_restore(camera);
    exit(1);
}

static void *memory[VIDEO_MAX_FRAME];

/* Four buffers of YUYV, queued and streaming; of what size, the camera says. */
static struct v4l2_pix_format start(int fd)
{
    static struct v4l2_format format;
    static struct v4l2_requestbuffers request;
    static struct v4l2_buffer b;
    format.type = request.type = b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = b.memory = V4L2_MEMORY_MMAP;
    request.count = 4;
    must(ioctl(fd, VIDIOC_G_FMT, &format) == 0, "VIDIOC_G_FMT");
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_YUYV;
    must(ioctl(fd, VIDIOC_S_FMT, &format) == 0, "VIDIOC_S_FMT");
    errno = EINVAL; /* what the driver took may be another one */
    must(format.fmt.pix.pixelformat == V4L2_PIX_FMT_YUYV, "the camera has no YUYV");
    must(ioctl(fd, VIDIOC_REQBUFS, &request) == 0, "VIDIOC_REQBUFS");
    for (b.index = 0; b.index < request.count; b.index++) {
        must(ioctl(fd, VIDIOC_QUERYBUF, &b) == 0, "VIDIOC_QUERYBUF");
        memory[b.index] = mmap(NULL, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, (off_t)b.m.offset);
        must(memory[b.index] != MAP_FAILED && ioctl(fd, VIDIOC_QBUF, &b) == 0, "a buffer");
    }
    must(ioctl(fd, VIDIOC_STREAMON, &format.type) == 0, "VIDIOC_STREAMON");
    return format.fmt.pix;
}

/* The controls as `quit` wants them, and the limits of this camera for the sensor. */
static void take_controls(int fd, pupil_sensor_config *config)
{
    static pupil_camera_options options;
    static char why[512];
    options.fd = fd;
    options.subdevice_fd = -1;
    camera = pupil_camera_open(&options, why, sizeof why);
    if (!camera) {
        fprintf(stderr, "full: %s\n", why);
        exit(1);
    }
    signal(SIGINT, quit);
    signal(SIGTERM, quit);
    signal(SIGPIPE, quit);
    pupil_camera_configure(camera, config);
}

int main(int argc, char **argv)
{
    static pupil_image_const in;
    static pupil_image out;
    static pupil_frame_info info;
    static struct v4l2_buffer b;
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    pupil_sensor_config limits;
    pupil_sensor sensor;
    pupil_sensor_setting wanted;
    const int fd = open(argc > 1 ? argv[1] : "/dev/video0", O_RDWR);
    must(fd >= 0, argc > 1 ? argv[1] : "/dev/video0");
    const struct v4l2_pix_format format = start(fd);
    in.width = out.width = format.width;
    in.height = out.height = format.height;
    in.pixel = PUPIL_PIXEL_YUYV;
    in.stride_bytes = format.bytesperline;
    out.pixel = PUPIL_PIXEL_RGB8;
    out.stride_bytes = 3 * (ptrdiff_t)out.width;
    out.data = malloc((size_t)out.stride_bytes * out.height);
    must(out.data != NULL, "the picture");
    pupil_config_default(&config);
    pupil_sensor_config_default(&limits);
    take_controls(fd, &limits);
    must(pupil_init(&pupil, &config) == 0 && pupil_sensor_init(&sensor, &limits) == 0, "the settings");

    b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    b.memory = V4L2_MEMORY_MMAP;
    for (;;) {
        must(ioctl(fd, VIDIOC_DQBUF, &b) == 0, "VIDIOC_DQBUF");
        in.data = memory[b.index];
        info.sequence = b.sequence;
        info.timestamp_ns = (int64_t)b.timestamp.tv_sec * 1000000000 + (int64_t)b.timestamp.tv_usec * 1000;
        pupil_camera_frame(camera, b.sequence, 0);
        pupil_camera_in_force(camera, b.sequence, &info); /* exposure and gain of this very frame */
        must(pupil_process(&pupil, &in, &info, &out) == 0, "a frame");
        pupil_get_stats(&pupil, &stats);
        pupil_sensor_frame(&sensor, &stats, &info);
        pupil_sensor_get(&sensor, &wanted);
        const pupil_camera_setting setting = {wanted.exposure_s, wanted.gain, 0};
        if (wanted.changed || wanted.frames == 1)
            pupil_camera_ask(camera, &setting); /* another thread writes it */
        must(ioctl(fd, VIDIOC_QBUF, &b) == 0, "VIDIOC_QBUF");
        must(fwrite(out.data, (size_t)out.stride_bytes * out.height, 1, stdout) == 1, "stdout");
    }
}

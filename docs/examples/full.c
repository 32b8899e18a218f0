/* full DEVICE: controls exposure time and gain in a capture loop (capture.h), and maps its frames to RGB24 on stdout.
 *     cc full.c $(pkg-config --cflags --libs pupil pupil-camera) -o full
 *     ./full /dev/video0 | ffplay -f rawvideo -pixel_format rgb24 -video_size 640x480 - */
#include "capture.h"

#include <pupil/camera_loop.h>
#include <pupil/pupil.h>
#include <signal.h>

static pupil_camera *camera;

static void give_back(void)
{
    pupil_camera_restore(camera); /* every control as it was before */
}

/* Notes which frame is exposed now: the one after the newest complete frame. */
static void mark(const pupil_frame_info *info, double frame_s)
{
    const uint64_t newest = pupil_camera_newest(info->sequence, capture_end_ns(frame_s), capture_now_ns(), frame_s);
    pupil_camera_frame(camera, newest, 0);
}

static void quit(int signal_number)
{
    give_back();
    _exit(128 + signal_number);
}

int main(int argc, char **argv)
{
    static pupil_t pupil; /* static: fields that are not set are 0 */
    static pupil_config config;
    static pupil_stats stats;
    static pupil_image_const in;
    static pupil_image out;
    static pupil_frame_info info;
    static pupil_camera_options options;
    static pupil_camera_loop loop;
    static pupil_sensor_config sensor_config;
    static pupil_why why;
    const char *device = argc > 1 ? argv[1] : "/dev/video0";
    const int fd = open(device, O_RDWR);
    must(fd >= 0, device);
    const struct v4l2_pix_format format = capture_start(fd);
    in.width = out.width = format.width;
    in.height = out.height = format.height;
    in.pixel = PUPIL_PIXEL_YUYV;
    in.stride_bytes = format.bytesperline;
    out.pixel = PUPIL_PIXEL_RGB8;
    out.stride_bytes = 3 * (ptrdiff_t)out.width;
    out.data = malloc((size_t)out.stride_bytes * out.height);
    options.fd = fd;
    options.subdevice_fd = -1;
    camera = pupil_camera_open(&options, &why);
    must(camera && out.data, why.text);
    at_exit_of_capture = give_back;
    signal(SIGINT, quit);
    signal(SIGTERM, quit);
    signal(SIGPIPE, quit);
    pupil_config_default(&config);
    pupil_sensor_config_default(&sensor_config);
    sensor_config.frame_s = capture_frame_s(fd);
    pupil_camera_configure(camera, &sensor_config); /* limits, steps and gain law of this camera */
    sensor_config.linear = 0;                       /* YUYV has a tone curve */
    must(pupil_init(&pupil, &config) == 0, "the settings");
    must(pupil_camera_loop_begin(&loop, camera, &sensor_config, 0, &why) == 0, why.text);
    for (;;) {
        in.data = capture_next(fd);
        info.sequence = capture_buffer.sequence;
        info.timestamp_ns = capture_time_ns();
        mark(&info, sensor_config.frame_s);
        pupil_camera_in_force(camera, info.sequence, &info); /* exposure and gain of this frame */
        must(pupil_process(&pupil, &in, &info, &out) == 0, "a frame");
        pupil_get_stats(&pupil, &stats);
        mark(&info, sensor_config.frame_s);
        pupil_camera_loop_frame(&loop, &stats, &info); /* asks the camera for the next setting; another thread writes */
        capture_done(fd);
        must(fwrite(out.data, (size_t)out.stride_bytes * out.height, 1, stdout) == 1, "stdout");
    }
}

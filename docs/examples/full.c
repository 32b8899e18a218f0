/* full DEVICE: exposure time, gain and picture in somebody else's capture loop (capture.h). RGB24 goes to stdout.
 *     cc full.c $(pkg-config --cflags --libs pupil pupil-camera) -o full
 *     ./full /dev/video0 | ffplay -f rawvideo -pixel_format rgb24 -video_size 640x480 - */
#include "capture.h"

#include <pupil/camera_controls.h>
#include <pupil/pupil.h>
#include <signal.h>

static pupil_camera *camera;

static void give_back(void)
{
    pupil_camera_restore(camera); /* every control as it was */
}

static void quit(int signal_number)
{
    give_back();
    _exit(128 + signal_number);
}

int main(int argc, char **argv)
{
    static pupil_t pupil; /* static: all zero where nothing is said */
    static pupil_config config;
    static pupil_stats stats;
    static pupil_image_const in;
    static pupil_image out;
    static pupil_frame_info info;
    static pupil_camera_options options;
    static pupil_sensor sensor;
    static pupil_sensor_config sensor_config;
    static pupil_sensor_setting wanted;
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
    pupil_camera_configure(camera, &sensor_config); /* limits, steps and gain law of this camera */
    sensor_config.linear = 0;                       /* YUYV has a tone curve */
    must(pupil_init(&pupil, &config) == 0 && pupil_sensor_init(&sensor, &sensor_config) == 0, "the settings");
    for (;;) {
        in.data = capture_next(fd);
        info.sequence = capture_buffer.sequence;
        info.timestamp_ns = capture_time_ns();
        pupil_camera_frame(camera, info.sequence, 0);
        pupil_camera_in_force(camera, info.sequence, &info); /* exposure and gain of this very frame */
        must(pupil_process(&pupil, &in, &info, &out) == 0, "a frame");
        pupil_get_stats(&pupil, &stats);
        pupil_sensor_frame(&sensor, &stats, &info);
        pupil_sensor_get(&sensor, &wanted);
        pupil_camera_learn(camera, wanted.exposure_delay, wanted.gain_delay);
        const pupil_camera_setting setting = {wanted.exposure_s, wanted.gain, 0};
        if (wanted.changed || wanted.frames == 1)
            pupil_camera_ask(camera, &setting); /* another thread writes it */
        capture_done(fd);
        must(fwrite(out.data, (size_t)out.stride_bytes * out.height, 1, stdout) == 1, "stdout");
    }
}

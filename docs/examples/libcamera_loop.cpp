// Controls the exposure time of a camera of libcamera for ten seconds, and prints a line for each frame.
//     g++ -std=c++17 libcamera_loop.cpp $(pkg-config --cflags --libs libcamera pupil) -o libcamera_loop
#include "libcamera_frames.h" // plain libcamera
#include <pupil/pupil.h>
#include <pupil/sensor.h>

int main()
{
    static Frames frames;
    static pupil_t meter;
    static pupil_sensor sensor;
    static pupil_config config;
    static pupil_sensor_config limits;
    if (!frames.open(320, 240))
        return 1;
    pupil_config_default(&config);
    config.histogram = 1;
    pupil_init(&meter, &config);
    pupil_sensor_config_default(&limits);
    limits.gain_max = 1.0;                               // exposure alone
    limits.delay_frames = frames.stream.bufferCount + 3; // requests in flight, and the sensor's own delay
    pupil_sensor_init(&sensor, &limits);
    frames.first.set(libcamera::controls::AeEnable, false);
    frames.completed = [](libcamera::Request *done, const pupil_image_const &image, libcamera::ControlList *next) {
        static pupil_stats stats;
        static pupil_sensor_setting setting;
        pupil_frame_info info = {};
        info.sequence = done->buffers().begin()->second->metadata().sequence;
        info.exposure_s = done->metadata().get(libcamera::controls::ExposureTime).value_or(0) * 1e-6; // 0: unknown
        pupil_stats_clear(&stats);
        pupil_meter_rows(&meter, &image, 0, image.height, &stats);
        pupil_sensor_frame(&sensor, &stats, &info);
        pupil_sensor_get(&sensor, &setting);
        if (setting.changed)
            next->set(libcamera::controls::ExposureTime, int32_t(setting.exposure_s * 1e6 + 0.5));
        printf("%s %.2f ms\n", pupil_sensor_state_name(setting.state), setting.exposure_s * 1e3);
    };
    frames.run(10);
}

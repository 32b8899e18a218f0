/* meter_only WIDTH HEIGHT: reports how bright another program's frames are. Reads YUYV from stdin and prints a line for
 * each frame; nothing is mapped, and no camera is touched.
 *     cc meter_only.c $(pkg-config --cflags --libs pupil) -o meter_only
 *     v4l2-ctl -d /dev/video0 --stream-mmap --stream-to=- | ./meter_only 640 480 */
#include <pupil/pupil.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
    const int width = argc == 3 ? atoi(argv[1]) : 0, height = argc == 3 ? atoi(argv[2]) : 0;
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    pupil_exposure exposure;
    pupil_image_const frame;
    if (width < 1 || height < 1 || width > (int)PUPIL_MAX_SIDE_PX || height > (int)PUPIL_MAX_SIDE_PX) {
        fprintf(stderr, "usage: meter_only WIDTH HEIGHT <YUYV frames\n");
        return 2;
    }
    memset(&frame, 0, sizeof frame);
    frame.width = (uint32_t)width;
    frame.height = (uint32_t)height;
    frame.pixel = PUPIL_PIXEL_YUYV;
    frame.stride_bytes = (ptrdiff_t)pupil_row_bytes(frame.pixel, frame.width);
    const size_t bytes = (size_t)frame.stride_bytes * frame.height;
    void *memory = malloc(bytes);
    frame.data = memory;
    pupil_config_default(&config);
    int error = memory ? pupil_init(&pupil, &config) : PUPIL_ERR_NULL;
    while (!error && fread(memory, 1, bytes, stdin) == bytes) {
        pupil_stats_clear(&stats);
        error = pupil_meter_rows(&pupil, &frame, 0, frame.height, &stats);
        if (!error)
            error = pupil_adapt(&pupil, &stats, NULL);
        pupil_get_exposure(&pupil, &exposure);
        printf("metered %+.2f EV, adapted %+.2f EV, clipped %.1f %%\n", exposure.metered_ev, exposure.adapted_ev,
               100.0 * (double)stats.clipped / (double)stats.pixels);
    }
    free(memory);
    if (error)
        fprintf(stderr, "meter_only: %s\n", pupil_error_string(error));
    return error != 0;
}

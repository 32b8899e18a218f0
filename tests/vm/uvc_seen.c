#include "vm/uvc_seen.h"

#include <math.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "vm/node.h"

int uvc_await(char path[32])
{
    for (int i = 0; i < 200; i++) {
        if (node_find("uvcvideo", 0, 0, path) == 0)
            return 0;
        usleep(100000);
    }
    return -1;
}

void uvc_unplug(pid_t process)
{
    char unused[32];
    kill(process, SIGTERM);
    waitpid(process, NULL, 0);
    for (int i = 0; i < 200 && node_find("uvcvideo", 0, 0, unused) == 0; i++)
        usleep(100000);
}

uvc_truth uvc_read_truth(const pupil_image_const *image)
{
    const unsigned char *row = image->data;
    uint64_t bits = 0;
    for (uint32_t i = 0; i < UVC_TRUTH_BITS; i++)
        bits |= (uint64_t)(row[2 * (i * UVC_TRUTH_PIXELS + UVC_TRUTH_PIXELS / 2)] > 128) << i;
    return (uvc_truth){bits & 0xffff, bits >> 16 & 0xfff, bits >> 28 & 15, bits >> 32 & 1};
}

double uvc_level(const uvc_truth *t)
{
    return log2(UVC_LIGHT * t->exposure_100us / 100.0 * t->gain_16ths / 16.0) + 3.0 * ((int)t->light - 8);
}

int uvc_meter(const pupil_t *pupil, const pupil_image_const *image, int is_linear, pupil_stats *stats)
{
    pupil_image_const picture = pupil_image_rows(*image, 1, image->height - 1);
    pupil_coding coding = *picture.coding;
    if (is_linear)
        coding.light = PUPIL_LIGHT_LINEAR;
    picture.coding = &coding;
    pupil_stats_clear(stats);
    return pupil_meter_rows(pupil, &picture, 0, picture.height, stats);
}

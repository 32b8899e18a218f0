/* Replaces fake_jpeg.c in a build without libav: MJPG frames are empty. */
#include "fake_v4l2_private.h"

uint32_t fake_jpeg(const fake_v4l2_picture *picture, unsigned char *to, uint32_t room)
{
    (void)picture, (void)to, (void)room;
    return 0;
}

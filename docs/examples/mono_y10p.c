/* mono_y10p WIDTH HEIGHT: the packed 10-bit frames of a mono camera (black level 64), well exposed, as RGB.
 *     cc mono_y10p.c $(pkg-config --cflags --libs pupil) -o mono_y10p
 *     v4l2-ctl -d /dev/video0 --stream-mmap --stream-to=- | ./mono_y10p 640 400 >frames.rgb */
#include <pupil/pupil.h>
#include <stdio.h>
#include <stdlib.h>
static unsigned char frame[4096 / 4 * 5 * 2304], picture[4096 * 2304 * 3];
int main(int argc, char **argv)
{
    const uint32_t width = argc == 3 ? (uint32_t)atoi(argv[1]) : 0, height = argc == 3 ? (uint32_t)atoi(argv[2]) : 0;
    pupil_image_const in = pupil_image_const_of(frame, width, height, PUPIL_PIXEL_GREY10P);
    const pupil_image out = pupil_image_of(picture, width, height, PUPIL_PIXEL_RGB8);
    const size_t bytes = pupil_image_bytes(in.pixel, width, height);
    static pupil_coding coding; /* all zero but the black level */
    pupil_config config;
    pupil_t pupil;
    in.coding = &coding;
    coding.black = 64;
    pupil_config_default(&config);
    int error = width > 4096 || height > 2304 ? PUPIL_ERR_SIZE : pupil_init(&pupil, &config);
    while (!error && fread(frame, 1, bytes, stdin) == bytes && !(error = pupil_process(&pupil, &in, NULL, &out)))
        fwrite(picture, 1, pupil_image_bytes(out.pixel, width, height), stdout);
    return error && fprintf(stderr, "%s\nusage: mono_y10p WIDTH HEIGHT, up to 4096 2304\n", pupil_error_string(error));
}

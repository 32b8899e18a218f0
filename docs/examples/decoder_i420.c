/* decoder_i420 WIDTH HEIGHT: the I420 frames of a decoder, well exposed, as RGB.
 *     cc decoder_i420.c $(pkg-config --cflags --libs pupil) -o decoder_i420
 *     ffmpeg -v error -i film.mkv -f rawvideo -pix_fmt yuv420p - | ./decoder_i420 640 360 >frames.rgb */
#include <pupil/pupil.h>
#include <stdio.h>
#include <stdlib.h>
static unsigned char frame[4096 * 2304 * 3 / 2], picture[4096 * 2304 * 3];
int main(int argc, char **argv)
{
    const uint32_t width = argc == 3 ? (uint32_t)atoi(argv[1]) : 0, height = argc == 3 ? (uint32_t)atoi(argv[2]) : 0;
    const pupil_image_const in = pupil_image_const_of(frame, width, height, PUPIL_PIXEL_I420);
    const pupil_image out = pupil_image_of(picture, width, height, PUPIL_PIXEL_RGB8);
    const size_t bytes = pupil_image_bytes(in.pixel, width, height);
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    int error = width > 4096 || height > 2304 ? PUPIL_ERR_SIZE : pupil_init(&pupil, &config);
    while (!error && fread(frame, 1, bytes, stdin) == bytes && !(error = pupil_process(&pupil, &in, NULL, &out)))
        fwrite(picture, 1, pupil_image_bytes(out.pixel, width, height), stdout);
    return error &&
           fprintf(stderr, "%s\nusage: decoder_i420 WIDTH HEIGHT, up to 4096 2304\n", pupil_error_string(error));
}

/* mat_bgr: a picture in the memory of a cv::Mat (CV_8UC3, blue first), well exposed. OpenCV itself is not needed here.
 *     cc mat_bgr.c $(pkg-config --cflags --libs pupil) -o mat_bgr */
#include <pupil/pupil.h>
#include <stdio.h>
/* To be called with mat.data, mat.cols, mat.rows and mat.step. A region of a larger Mat has the larger one's step. */
static int expose(pupil_t *pupil, const void *data, int cols, int rows, size_t step, void *picture)
{
    const pupil_image out = pupil_image_of(picture, (uint32_t)cols, (uint32_t)rows, PUPIL_PIXEL_BGR8);
    pupil_image_const in = pupil_image_const_of(data, (uint32_t)cols, (uint32_t)rows, PUPIL_PIXEL_BGR8);
    in.stride_bytes = (ptrdiff_t)step;
    return pupil_process(pupil, &in, NULL, &out);
}
int main(void)
{
    static const unsigned char mat[2][8][3] = {{{10, 20, 30}, {10, 20, 30}}, {{20, 10, 40}, {20, 10, 40}}};
    unsigned char picture[2][2][3]; /* of the left two columns */
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    if (pupil_init(&pupil, &config) || expose(&pupil, mat, 2, 2, sizeof mat[0], picture))
        return 1;
    for (int i = 0; i < 4; i++)
        printf("%d %d %d\n", picture[i / 2][i % 2][0], picture[i / 2][i % 2][1], picture[i / 2][i % 2][2]);
    return 0;
}

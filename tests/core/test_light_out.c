/* Outputs of linear display light: encoding them gives the codes of the 8-bit outputs; halves are the rounded floats;
 * alpha; and I420, which is NV12 in three planes. */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"
#include "reference.h"

#include <math.h>

static frame mapped(const frame *in, const pupil_config *config, const pupil_curve *curve, uint32_t pixel,
                    int upside_down)
{
    static const uint32_t sample[PUPIL_PIXEL_COUNT] = {[PUPIL_PIXEL_RGBA32F] = 4,
                                                       [PUPIL_PIXEL_RGB32F] = 4,
                                                       [PUPIL_PIXEL_BGR32F] = 4,
                                                       [PUPIL_PIXEL_RGBA16F] = 2,
                                                       [PUPIL_PIXEL_RGB16F] = 2};
    frame out =
        frame_make(in->image.width, in->image.height, pixel, 3 * (sample[pixel] ? sample[pixel] : 1), upside_down);
    const pupil_image to = frame_writable(&out);
    pupil_t pupil;
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    CHECK(pupil_map_rows(&pupil, curve, &in->image, &to) == PUPIL_OK);
    CHECK_MSG(frame_guards_intact(&out), "format %u", pixel);
    return out;
}

static const void *pixel_at(const frame *f, uint32_t x, uint32_t y)
{
    return (const unsigned char *)f->image.data + (ptrdiff_t)y * f->image.stride_bytes +
           x * pupil_pixel_bytes(f->image.pixel);
}

static struct {
    double samples, half_off;
} figures;

/* From 0 to 1. */
static long double half_value(uint16_t half)
{
    return half < 1024 ? ldexpl(half, -24) : ldexpl(1024 + half % 1024, half / 1024 - 25);
}

static void check_light(const frame *in, const pupil_config *config, const pupil_curve *curve, int turn)
{
    const frame codes = mapped(in, config, curve, PUPIL_PIXEL_RGBA8, turn);
    const frame floats = mapped(in, config, curve, PUPIL_PIXEL_RGBA32F, !turn);
    const frame three = mapped(in, config, curve, PUPIL_PIXEL_RGB32F, turn);
    const frame blue_first = mapped(in, config, curve, PUPIL_PIXEL_BGR32F, !turn);
    const frame halves = mapped(in, config, curve, PUPIL_PIXEL_RGBA16F, turn);
    const frame three_halves = mapped(in, config, curve, PUPIL_PIXEL_RGB16F, !turn);
    for (uint32_t y = 0; y < in->image.height; y++)
        for (uint32_t x = 0; x < in->image.width; x++) {
            const unsigned char *code = pixel_at(&codes, x, y);
            const float *light = pixel_at(&floats, x, y), *blue = pixel_at(&blue_first, x, y);
            const float turned[3] = {blue[2], blue[1], blue[0]};
            const uint16_t *half = pixel_at(&halves, x, y);
            CHECK(memcmp(light, pixel_at(&three, x, y), 12) == 0);
            CHECK(memcmp(light, turned, 12) == 0);
            CHECK(memcmp(half, pixel_at(&three_halves, x, y), 6) == 0);
            for (int c = 0; c < 4; c++) {
                CHECK_MSG(light[c] >= 0.0f && light[c] <= 1.0f && !signbit(light[c]), "%g", light[c]);
                CHECK_MSG(half[c] == frame_half((double)light[c]), "%a is %04x", light[c], half[c]);
            }
            for (int c = 0; c < 3; c++) {
                const int encoded = (int)floorl(ref_encode(config->transfer, light[c]) + 0.5L);
                const int of_half = (int)floorl(ref_encode(config->transfer, half_value(half[c])) + 0.5L);
                CHECK_MSG(encoded == code[c], "transfer %u: light %a is code %d, and %d in 8 bits", config->transfer,
                          light[c], encoded, code[c]);
                CHECK_MSG(abs(of_half - code[c]) <= 1, "half %04x of %a: %d, %d", half[c], light[c], of_half, code[c]);
                figures.samples++;
                figures.half_off += of_half != code[c];
            }
            /* alpha: its code is rounded from a number with an error of at most 2^-17 of a code */
            CHECK_MSG(fabs(255.0 * (double)light[3] - code[3]) <= 0.5 + 0x1p-15, "alpha %g, code %d", light[3],
                      code[3]);
        }
    const frame *const all[] = {&codes, &floats, &three, &blue_first, &halves, &three_halves};
    for (int i = 0; i < 6; i++) {
        frame f = *all[i];
        frame_free(&f);
    }
}

static void check_i420(const frame *in, const pupil_config *config, const pupil_curve *curve, int turn)
{
    frame nv12 = mapped(in, config, curve, PUPIL_PIXEL_NV12, turn),
          i420 = mapped(in, config, curve, PUPIL_PIXEL_I420, !turn);
    const uint32_t w = in->image.width, h = in->image.height;
    for (uint32_t y = 0; y < h; y++)
        CHECK(memcmp(pixel_at(&nv12, 0, y), pixel_at(&i420, 0, y), w) == 0);
    for (uint32_t y = 0; y < (h + 1) / 2; y++) {
        const unsigned char *both =
            (const unsigned char *)nv12.image.chroma + (ptrdiff_t)y * nv12.image.chroma_stride_bytes;
        const unsigned char *cb =
            (const unsigned char *)i420.image.chroma + (ptrdiff_t)y * i420.image.chroma_stride_bytes;
        const unsigned char *cr = (const unsigned char *)i420.image.cr + (ptrdiff_t)y * i420.image.cr_stride_bytes;
        for (uint32_t x = 0; x < (w + 1) / 2; x++)
            CHECK_MSG(both[2 * x] == cb[x] && both[2 * x + 1] == cr[x], "%u %u", x, y);
    }
    frame_free(&nv12);
    frame_free(&i420);
}

int main(int argc, char **argv)
{
    static const uint32_t in_pixel[] = {PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_RGBA16, PUPIL_PIXEL_RGBA8,
                                        PUPIL_PIXEL_RGB10A2, PUPIL_PIXEL_RGB8,    PUPIL_PIXEL_YUYV};
    check_begin(argc, argv);
    for (unsigned i = 0; i < 7; i++)
        for (unsigned n = 0; n < 24; n++) {
            const pupil_curve curve = {.scale = (float)exp2(12.0 * check_uniform() - 6.0),
                                       .inverse_white_squared = n % 3 ? 0.05f : 0,
                                       .gamut = n % 3 ? 3.7f : 0};
            pupil_config config;
            frame in = frame_make(1 + 23 * n % 300, 1 + n % 5, in_pixel[i], 0, n % 2);
            pupil_config_default(&config);
            config.transfer = n % PUPIL_TRANSFER_COUNT;
            config.output_primaries = n % PUPIL_OUTPUT_COUNT;
            if (n % 4 == 0)
                frame_bits(&in, check_uniform);
            else
                frame_lognormal(&in, 0.2, 4, check_uniform);
            check_light(&in, &config, &curve, n % 2);
            check_i420(&in, &config, &curve, n % 2);
            frame_free(&in);
        }
    printf("%.0f samples; of halves %.2f %% are one 8-bit code off\n", figures.samples,
           100.0 * figures.half_off / figures.samples);
    return check_end();
}

/* A photograph as HDR10 and as HLG, BT.2020 of 4:2:0: replay's picture of such a video, and the library's picture of
 * the same codes (I420_10, config.output_primaries). Without chroma they are the same. With chroma they differ at edges
 * of colour: replay interpolates chroma, the library shares it among four pixels. The difference is printed. */
#include "clip.h"
#include "scratch.h"

#include <math.h>

#include "file/file_source.h"
#include "file/video/video_light.h"
#include "file/video/video_source.h"
#include "pupil/pupil.h"

#define SIDE 768 /* of the photograph */

static pupil_why why;
static uint16_t codes[SIDE * SIDE * 3 / 2]; /* planar */

/* Inverse of SMPTE ST 2084 as in BT.2100-2, table 4; 1.0 is 100 cd/m2. */
static double pq(double light)
{
    const double m1 = 2610.0 / 16384, m2 = 2523.0 / 4096 * 128, c1 = 3424.0 / 4096, c2 = 2413.0 / 4096 * 32;
    const double p = pow(fmax(light, 0) / 100, m1);
    return pow((c1 + c2 * p) / (1 + 2392.0 / 4096 * 32 * p), m2);
}

/* BT.2100-2, table 5; 2.03 (203 cd/m2, BT.2408) is reference white, 0.265. */
static double hlg(double light)
{
    const double a = 0.17883277, scene = fmin(fmax(light, 0) * 0.265 / 2.03, 1);
    return scene <= 1.0 / 12 ? sqrt(3 * scene) : a * log(12 * scene - (1 - 4 * a)) + 0.5 - a * log(4 * a);
}

/* From Rec.709: the inverse, by Cramer's rule, of the driver's matrix, which drivers.file.video_light checks. */
static void to_bt2020(const float *rgb, double out[3])
{
    static double m[9];
    if (m[0] == 0)
        CHECK(pupil_light_to_rec709(m, AVCOL_PRI_BT2020) == 0);
    const double r = (double)rgb[0], g = (double)rgb[1], b = (double)rgb[2];
    const double det =
        m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
    out[0] = (r * (m[4] * m[8] - m[5] * m[7]) - m[1] * (g * m[8] - m[5] * b) + m[2] * (g * m[7] - m[4] * b)) / det;
    out[1] = (m[0] * (g * m[8] - m[5] * b) - r * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * b - g * m[6])) / det;
    out[2] = (m[0] * (m[4] * b - g * m[7]) - m[1] * (m[3] * b - g * m[6]) + r * (m[3] * m[7] - m[4] * m[6])) / det;
}

/* Kr and Kb of BT.2020-2, table 4; limited range. Chroma is the mean of each block. */
static void encode(const pupil_image_const *still, double (*curve)(double light), int has_chroma)
{
    for (int y = 0; y < SIDE; y += 2)
        for (int x = 0; x < SIDE; x += 2) {
            double blue = 0, red = 0;
            for (int i = 0; i < 4; i++) {
                const int at_x = x + i % 2, at_y = y + i / 2;
                const float *rgb = (const float *)still->data + 3 * (at_y * SIDE + at_x);
                double c[3];
                to_bt2020(rgb, c);
                for (int k = 0; k < 3; k++)
                    c[k] = fmin(curve(c[k]), 1);
                const double luma = 0.2627 * c[0] + 0.678 * c[1] + 0.0593 * c[2];
                codes[at_y * SIDE + at_x] = (uint16_t)lround(64 + 876 * luma);
                blue += (c[2] - luma) / 1.8814 / 4;
                red += (c[0] - luma) / 1.4746 / 4;
            }
            const int at = SIDE * SIDE + y / 2 * (SIDE / 2) + x / 2;
            codes[at] = (uint16_t)lround(512 + (has_chroma ? 896 * blue : 0));
            codes[at + SIDE * SIDE / 4] = (uint16_t)lround(512 + (has_chroma ? 896 * red : 0));
        }
}

static int code_of(const clip *c, int frame, int component, int x, int y)
{
    (void)c;
    (void)frame;
    return component ? codes[SIDE * SIDE + (component - 1) * SIDE * SIDE / 4 + y * (SIDE / 2) + x]
                     : codes[y * SIDE + x];
}

typedef struct result {
    double level_ev, white_ev;
    unsigned char picture[SIDE * SIDE * 3];
} result;

static void expose(const pupil_image_const *image, uint32_t primaries, uint32_t white_mode, result *r)
{
    const pupil_image out = pupil_image_of(r->picture, SIDE, SIDE, PUPIL_PIXEL_RGB8);
    pupil_config config;
    pupil_exposure exposure;
    pupil_t pupil;
    pupil_config_default(&config);
    config.primaries = primaries;
    config.output_primaries = PUPIL_OUTPUT_BT709;
    config.white_mode = white_mode;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    CHECK(pupil_process(&pupil, image, NULL, &out) == PUPIL_OK && pupil_get_exposure(&pupil, &exposure) == PUPIL_OK);
    r->level_ev = exposure.metered_ev;
    r->white_ev = exposure.white_ev;
}

static void test_film(const char *name, enum AVColorTransferCharacteristic transfer, uint32_t light, int has_chroma)
{
    static result replayed, direct;
    const clip c = {
        "matroska",       "ffv1",           AV_PIX_FMT_YUV420P10, SIDE, SIDE,    1,   AVCOL_SPC_BT2020_NCL, transfer,
        AVCOL_PRI_BT2020, AVCOL_RANGE_MPEG, AVCHROMA_LOC_CENTER,  NULL, code_of, NULL};
    const pupil_coding coding = {.matrix = PUPIL_MATRIX_BT2020, .light = light};
    pupil_image_const image = pupil_image_const_of(codes, SIDE, SIDE, PUPIL_PIXEL_I420_10);
    pupil_source *source;
    pupil_frame f;
    image.coding = &coding;
    CHECK(clip_write(&c, scratch("film.mkv")) == 0);
    CHECK_MSG(pupil_video_source_open(scratch("film.mkv"), NULL, &source, &why) == 0, "%s", why.text);
    CHECK_MSG(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
    for (uint32_t white = PUPIL_WHITE_FOLLOW; white < PUPIL_WHITE_COUNT; white += PUPIL_WHITE_NONE) {
        expose(&f.image, source->primaries, white, &replayed);
        expose(&image, PUPIL_PRIMARIES_BT2020, white, &direct);
        double more = 0, sum = 0, count = sizeof direct.picture;
        for (size_t i = 0; i < sizeof direct.picture; i++) {
            more += abs(direct.picture[i] - replayed.picture[i]) > 1;
            sum += abs(direct.picture[i] - replayed.picture[i]);
        }
        printf("%s%s, white %s: level %.2g EV apart, white %+.2f EV; %.2f %% of the samples by more than a code, %.3f "
               "codes in the mean\n",
               name, has_chroma ? "" : " without chroma", white == PUPIL_WHITE_NONE ? "none" : "follows",
               fabs(direct.level_ev - replayed.level_ev), direct.white_ev - replayed.white_ev, 100 * more / count,
               sum / count);
        CHECK(fabs(direct.level_ev - replayed.level_ev) <= (has_chroma ? 5e-3 : 0));
        CHECK(has_chroma ? sum / count < 5 : sum == 0);
    }
    pupil_source_close(source);
}

int main(int argc, char **argv)
{
    char path[4200];
    const char *input = path;
    pupil_source *source;
    pupil_frame f;
    check_begin(argc, argv);
    scratch_begin();
    if (!check_shared())
        return check_cannot("no folder of shared images");
    snprintf(path, sizeof path, "%s/hdr/riverwalk_768.hdr", check_shared());
    CHECK_MSG(pupil_file_source_open(&input, 1, NULL, &source, &why) == 0, "%s", why.text);
    CHECK_MSG(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
    CHECK(f.image.width == SIDE && f.image.height == SIDE && f.image.pixel == PUPIL_PIXEL_RGB32F &&
          f.image.stride_bytes == SIDE * 12);
    for (int has_chroma = 0; has_chroma < 2; has_chroma++) {
        encode(&f.image, pq, has_chroma);
        test_film("PQ", AVCOL_TRC_SMPTE2084, PUPIL_LIGHT_PQ, has_chroma);
        encode(&f.image, hlg, has_chroma);
        test_film("HLG", AVCOL_TRC_ARIB_STD_B67, PUPIL_LIGHT_HLG, has_chroma);
    }
    pupil_source_close(source);
    return check_end();
}

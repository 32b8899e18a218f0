/* A video by replay (drivers/file/video) and the same codes by the library: the same light, level and picture if chroma
 * is constant, for PQ and HLG to the bit. Otherwise replay interpolates chroma and the library shares it among four
 * pixels: the difference is printed. */
#include "clip.h"
#include "scratch.h"

#include <math.h>

#include "file/video/video_source.h"
#include "pupil/pupil.h"

#define WIDTH  256
#define HEIGHT 128

static pupil_why why;

typedef struct kind {
    const char *name;
    enum AVPixelFormat format;
    uint32_t planar, interleaved, matrix, light;
    enum AVColorSpace space;
    enum AVColorTransferCharacteristic transfer;
    double level_ev; /* how much both may differ: for SDR the library interpolates its tables, least accurately in the
                      * dark first frame */
} kind;

static const kind kinds[] = {{"PQ", AV_PIX_FMT_YUV420P10, PUPIL_PIXEL_I420_10, PUPIL_PIXEL_P010, PUPIL_MATRIX_BT2020,
                              PUPIL_LIGHT_PQ, AVCOL_SPC_BT2020_NCL, AVCOL_TRC_SMPTE2084, 0},
                             {"HLG", AV_PIX_FMT_YUV420P10, PUPIL_PIXEL_I420_10, PUPIL_PIXEL_P010, PUPIL_MATRIX_BT2020,
                              PUPIL_LIGHT_HLG, AVCOL_SPC_BT2020_NCL, AVCOL_TRC_ARIB_STD_B67, 0},
                             {"SDR of 8 bits", AV_PIX_FMT_YUV420P, PUPIL_PIXEL_I420, PUPIL_PIXEL_NV12,
                              PUPIL_MATRIX_BT709, PUPIL_LIGHT_SRGB, AVCOL_SPC_BT709, AVCOL_TRC_BT709, 2e-4}};

/* In frames 0 to 4 luma has all codes of a part of its range, chroma is constant; from 5 on chroma rises along x. */
#define FRAMES 7
static int code_of(const clip *c, int frame, int component, int x, int y)
{
    static const int chroma[FRAMES][2] = {{128, 128}, {150, 110}, {90, 140}, {120, 190}, {128, 128}, {0, 0}, {0, 0}};
    const int bits = av_pix_fmt_desc_get(c->format)->comp[0].depth, ten = bits == 10 ? 4 : 1;
    if (component == 0)
        return (16 + 40 * frame % 120) * ten + (x + y * WIDTH) * 100 * ten / (WIDTH * HEIGHT);
    return frame < 5 ? chroma[frame][component - 1] * ten : (90 + x / 2 + frame) * ten;
}

/* The same codes in the library's format, planar or with interleaved chroma. */
static pupil_image_const codes_as(const clip *c, int frame, uint32_t pixel, void *memory)
{
    const pupil_image_const image = pupil_image_const_of(memory, WIDTH, HEIGHT, pixel);
    const int is_planar = pupil_pixel_planes(pixel) == 3, shift = pixel == PUPIL_PIXEL_P010 ? 6 : 0;
    const size_t bytes = pupil_pixel_bytes(pixel);
    size_t at = 0;
    for (int part = 0; part < (is_planar ? 3 : 2); part++) {
        const int halved = part > 0, each = halved && !is_planar ? 2 : 1;
        for (int y = 0; y < HEIGHT >> halved; y++)
            for (int x = 0; x < WIDTH >> halved; x++)
                for (int i = 0; i < each; i++, at++) {
                    const int code = code_of(c, frame, part + i, x, y) << shift;
                    if (bytes == 2)
                        ((uint16_t *)memory)[at] = (uint16_t)code;
                    else
                        ((uint8_t *)memory)[at] = (uint8_t)code;
                }
    }
    return image;
}

typedef struct result {
    double level_ev;
    unsigned char picture[WIDTH * HEIGHT * 3];
} result;

/* code_light: of the frame from the video. */
static void expose(const pupil_image_const *image, float code_light, result *r)
{
    const pupil_image out = pupil_image_of(r->picture, WIDTH, HEIGHT, PUPIL_PIXEL_RGB8);
    pupil_config config;
    pupil_exposure exposure;
    pupil_stats stats;
    pupil_curve curve;
    pupil_t pupil;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, image, 0, HEIGHT, &stats) == PUPIL_OK);
    stats.code_light = code_light > 0 ? code_light : stats.code_light;
    CHECK(pupil_adapt(&pupil, &stats, NULL) == PUPIL_OK && pupil_get_exposure(&pupil, &exposure) == PUPIL_OK);
    CHECK(pupil_get_curve(&pupil, NULL, &curve) == PUPIL_OK && pupil_map_rows(&pupil, &curve, image, &out) == PUPIL_OK);
    r->level_ev = exposure.metered_ev;
}

/* The share of samples that differ by more than a code. */
static double unlike(const result *a, const result *b)
{
    unsigned more = 0;
    for (size_t i = 0; i < sizeof a->picture; i++)
        more += abs(a->picture[i] - b->picture[i]) > 1;
    return (double)more / (double)sizeof a->picture;
}

static void test_kind(const kind *k)
{
    static uint16_t memory[WIDTH * HEIGHT * 3 / 2];
    static result replayed, planar, interleaved;
    const clip c = {"matroska",      "ffv1",           k->format,         WIDTH, HEIGHT,  FRAMES, k->space, k->transfer,
                    AVCOL_PRI_BT709, AVCOL_RANGE_MPEG, AVCHROMA_LOC_LEFT, NULL,  code_of, NULL};
    const pupil_coding coding = {.matrix = k->matrix, .light = k->light};
    pupil_source *source;
    pupil_frame f;
    double level_ev = 0, chroma_ev = 0, chroma_share = 0;
    CHECK(clip_write(&c, scratch("library.mkv")) == 0);
    CHECK_MSG(pupil_video_source_open(scratch("library.mkv"), NULL, &source, &why) == 0, "%s", why.text);
    for (int n = 0; n < FRAMES; n++) {
        CHECK_MSG(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
        expose(&f.image, f.code_light, &replayed);
        pupil_source_done(source, &f);
        pupil_image_const image = codes_as(&c, n, k->planar, memory);
        image.coding = &coding;
        expose(&image, 0, &planar);
        image = codes_as(&c, n, k->interleaved, memory);
        image.coding = &coding;
        expose(&image, 0, &interleaved);
        CHECK_MSG(!memcmp(&planar, &interleaved, sizeof planar), "%s, frame %d", k->name, n);
        const double off_ev = fabs(planar.level_ev - replayed.level_ev), share = unlike(&planar, &replayed);
        if (n < 5) {
            CHECK_MSG(off_ev <= k->level_ev, "%s, frame %d: %g EV", k->name, n, off_ev);
            CHECK(k->level_ev > 0 || !memcmp(&planar, &replayed, sizeof planar));
            CHECK_MSG(share == 0, "%s, frame %d: %g of the samples differ", k->name, n, share);
            level_ev = fmax(level_ev, off_ev);
        } else {
            chroma_ev = fmax(chroma_ev, off_ev);
            chroma_share = fmax(chroma_share, share);
        }
    }
    printf("%s: constant chroma %.2g EV, pictures to a code; chroma rising half an 8-bit code a sample %.2g EV, %.2f "
           "%% differ by "
           "more than a code\n",
           k->name, level_ev, chroma_ev, 100 * chroma_share);
    pupil_source_close(source);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        test_kind(&kinds[i]);
    return check_end();
}

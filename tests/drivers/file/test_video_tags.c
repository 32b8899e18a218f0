/* How a video frame's tags are used: unspecified ones are filled in as video_pixels.h says, and what cannot be read is
 * refused by name. Frames are as from decoders. */
#include "file/video/video_pixels.h"

#include "check.h"

typedef struct tags {
    enum AVPixelFormat format;
    int height;
    enum AVColorSpace space;
    enum AVColorTransferCharacteristic transfer;
    enum AVColorPrimaries primaries;
    enum AVColorRange range;
} tags;

enum { WIDTH = 16 };

static int width = WIDTH; /* of the frames */

static pupil_why why;

/* A frame of colours; the same format and height give the same codes. */
static AVFrame *frame_of(const tags *t)
{
    AVFrame *f = av_frame_alloc();
    f->format = t->format;
    f->width = width;
    f->height = t->height;
    f->colorspace = t->space;
    f->color_trc = t->transfer;
    f->color_primaries = t->primaries;
    f->color_range = t->range;
    f->chroma_location = AVCHROMA_LOC_LEFT;
    CHECK(av_frame_get_buffer(f, 0) == 0);
    for (int plane = 0; plane < 4 && f->buf[plane]; plane++)
        for (size_t i = 0; i < f->buf[plane]->size; i++)
            f->buf[plane]->data[i] =
                (uint8_t)(i * (size_t)(7 + plane) + 13); /* of more than 8 bits: cropped by the reader */
    return f;
}

static size_t bytes_of(const pupil_image_const *image)
{
    return pupil_image_bytes(image->pixel, image->width, image->height);
}

/* Both frames become the same image, to the bit. */
static void check_alike(const tags *open, const tags *filled_in, size_t number)
{
    pupil_video_pixels a = {0}, b = {0};
    AVFrame *left = frame_of(open), *right = frame_of(filled_in);
    const int failed = pupil_video_pixels_convert(&a, left, &why) || pupil_video_pixels_convert(&b, right, &why);
    CHECK_MSG(!failed, "case %zu: %s", number, why.text);
    if (!failed)
        CHECK_MSG(a.image.pixel == b.image.pixel && a.primaries == b.primaries &&
                      memcmp(a.image.data, b.image.data, bytes_of(&a.image)) == 0,
                  "case %zu: pixels %u and %u, primaries %u and %u", number, a.image.pixel, b.image.pixel, a.primaries,
                  b.primaries);
    pupil_video_pixels_free(&a);
    pupil_video_pixels_free(&b);
    av_frame_free(&left);
    av_frame_free(&right);
}

/* Short names for the tables. */
#define P709  AVCOL_PRI_BT709
#define P2020 AVCOL_PRI_BT2020
#define OPEN  AVCOL_PRI_UNSPECIFIED
#define T709  AVCOL_TRC_BT709
#define PQ    AVCOL_TRC_SMPTE2084
#define HLG   AVCOL_TRC_ARIB_STD_B67
#define T_ANY AVCOL_TRC_UNSPECIFIED
#define M709  AVCOL_SPC_BT709
#define M601  AVCOL_SPC_SMPTE170M
#define M2020 AVCOL_SPC_BT2020_NCL
#define M_ANY AVCOL_SPC_UNSPECIFIED
#define MPEG  AVCOL_RANGE_MPEG
#define JPEG  AVCOL_RANGE_JPEG
#define ANY   AVCOL_RANGE_UNSPECIFIED

/* Wide pictures of few rows: films of 1280 x 536. */
static void test_wide(void)
{
    static const tags open = {AV_PIX_FMT_YUV420P, 16, M_ANY, T709, P709, MPEG};
    static const tags narrow = {AV_PIX_FMT_YUV420P, 16, M601, T709, P709, MPEG};
    static const tags wide = {AV_PIX_FMT_YUV420P, 16, M709, T709, P709, MPEG};
    width = 1278;
    check_alike(&open, &narrow, 1278);
    width = 1280;
    check_alike(&open, &wide, 1280);
    width = WIDTH;
}

static void test_filled_in(void)
{
    static const tags cases[][2] = {
        /* matrix */
        {{AV_PIX_FMT_YUV420P, 16, M_ANY, T709, P709, MPEG}, {AV_PIX_FMT_YUV420P, 16, M601, T709, P709, MPEG}},
        {{AV_PIX_FMT_YUV420P, 576, M_ANY, T709, P709, MPEG}, {AV_PIX_FMT_YUV420P, 576, M601, T709, P709, MPEG}},
        {{AV_PIX_FMT_YUV420P, 578, M_ANY, T709, P709, MPEG}, {AV_PIX_FMT_YUV420P, 578, M709, T709, P709, MPEG}},
        {{AV_PIX_FMT_YUV420P, 16, AVCOL_SPC_RESERVED, T709, P2020, MPEG},
         {AV_PIX_FMT_YUV420P, 16, M2020, T709, P2020, MPEG}},
        {{AV_PIX_FMT_YUV420P10, 16, M_ANY, PQ, P709, MPEG}, {AV_PIX_FMT_YUV420P10, 16, M2020, PQ, P709, MPEG}},
        {{AV_PIX_FMT_YUV444P, 16, AVCOL_SPC_BT470BG, T709, P709, MPEG},
         {AV_PIX_FMT_YUV444P, 16, M601, T709, P709, MPEG}},
        {{AV_PIX_FMT_YUV420P10, 16, AVCOL_SPC_BT470BG, HLG, P709, MPEG},
         {AV_PIX_FMT_YUV420P10, 16, M601, HLG, P709, MPEG}},
        {{AV_PIX_FMT_YUV444P10, 16, AVCOL_SPC_CHROMA_DERIVED_NCL, PQ, P2020, MPEG},
         {AV_PIX_FMT_YUV444P10, 16, M2020, PQ, P2020, MPEG}},
        {{AV_PIX_FMT_YUV444P10, 16, AVCOL_SPC_CHROMA_DERIVED_NCL, PQ, P709, JPEG},
         {AV_PIX_FMT_YUV444P10, 16, M709, PQ, P709, JPEG}},
        {{AV_PIX_FMT_GBRP10, 16, AVCOL_SPC_RGB, PQ, P709, JPEG}, {AV_PIX_FMT_GBRP10, 16, M709, PQ, P709, JPEG}},
        /* primaries */
        {{AV_PIX_FMT_YUV420P, 16, M709, T709, OPEN, MPEG}, {AV_PIX_FMT_YUV420P, 16, M709, T709, P709, MPEG}},
        {{AV_PIX_FMT_YUV420P, 16, M2020, T709, AVCOL_PRI_RESERVED0, MPEG},
         {AV_PIX_FMT_YUV420P, 16, M2020, T709, P2020, MPEG}},
        {{AV_PIX_FMT_YUV420P10, 16, M2020, HLG, AVCOL_PRI_RESERVED, MPEG},
         {AV_PIX_FMT_YUV420P10, 16, M2020, HLG, P2020, MPEG}},
        /* range */
        {{AV_PIX_FMT_YUV420P, 16, M709, T709, P709, ANY}, {AV_PIX_FMT_YUV420P, 16, M709, T709, P709, MPEG}},
        {{AV_PIX_FMT_GRAY8, 16, M709, T709, P709, ANY}, {AV_PIX_FMT_GRAY8, 16, M709, T709, P709, JPEG}},
        {{AV_PIX_FMT_GBRP, 16, AVCOL_SPC_RGB, T709, P709, MPEG},
         {AV_PIX_FMT_GBRP, 16, AVCOL_SPC_RGB, T709, P709, JPEG}},
        {{AV_PIX_FMT_YUVJ422P, 16, M709, T709, P709, ANY}, {AV_PIX_FMT_YUV422P, 16, M709, T709, P709, JPEG}},
        {{AV_PIX_FMT_YUVJ440P, 16, M709, T709, P709, MPEG}, {AV_PIX_FMT_YUV440P, 16, M709, T709, P709, JPEG}},
        {{AV_PIX_FMT_YUVJ411P, 16, M709, T709, P709, MPEG}, {AV_PIX_FMT_YUV411P, 16, M709, T709, P709, JPEG}},
        /* transfer: SDR's curves are one */
        {{AV_PIX_FMT_YUV420P, 16, M709, T_ANY, P709, MPEG}, {AV_PIX_FMT_YUV420P, 16, M709, T709, P709, MPEG}},
        {{AV_PIX_FMT_YUV420P, 16, M709, AVCOL_TRC_BT2020_10, P709, MPEG},
         {AV_PIX_FMT_YUV420P, 16, M709, AVCOL_TRC_IEC61966_2_1, P709, MPEG}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_alike(&cases[i][0], &cases[i][1], i);
}

/* Limited range, full range and limited-range grey differ. */
static void test_differs(void)
{
    static const tags cases[][2] = {
        {{AV_PIX_FMT_GRAY8, 16, M709, T709, P709, MPEG}, {AV_PIX_FMT_GRAY8, 16, M709, T709, P709, JPEG}},
        {{AV_PIX_FMT_YUV420P, 16, M709, AVCOL_TRC_GAMMA22, P709, MPEG},
         {AV_PIX_FMT_YUV420P, 16, M709, AVCOL_TRC_GAMMA28, P709, MPEG}},
        {{AV_PIX_FMT_YUV420P, 16, AVCOL_SPC_FCC, T709, P709, MPEG}, {AV_PIX_FMT_YUV420P, 16, M709, T709, P709, MPEG}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pupil_video_pixels a = {0}, b = {0};
        AVFrame *left = frame_of(&cases[i][0]), *right = frame_of(&cases[i][1]);
        CHECK(pupil_video_pixels_convert(&a, left, &why) == 0 && pupil_video_pixels_convert(&b, right, &why) == 0);
        CHECK_MSG(memcmp(a.image.data, b.image.data, bytes_of(&a.image)) != 0, "case %zu", i);
        pupil_video_pixels_free(&a);
        pupil_video_pixels_free(&b);
        av_frame_free(&left);
        av_frame_free(&right);
    }
}

static void test_refused(void)
{
    static const struct {
        tags tags;
        const char *words;
    } cases[] = {
        {{AV_PIX_FMT_YUV420P, 16, AVCOL_SPC_BT2020_CL, T709, P709, MPEG}, "its colour matrix bt2020c cannot"},
        {{AV_PIX_FMT_YUV420P, 16, (enum AVColorSpace)99, T709, P709, MPEG}, "its colour matrix (unknown) cannot"},
        {{AV_PIX_FMT_YUV420P, 16, M709, AVCOL_TRC_LOG, P709, MPEG}, "its transfer curve log100 cannot"},
        {{AV_PIX_FMT_YUV420P, 16, M709, (enum AVColorTransferCharacteristic)99, P709, MPEG},
         "its transfer curve (unknown) cannot"},
        {{AV_PIX_FMT_YUV420P, 16, M709, T709, AVCOL_PRI_SMPTE428, MPEG}, "its primaries smpte428 cannot"},
        {{AV_PIX_FMT_YUV420P, 16, M709, T709, (enum AVColorPrimaries)99, MPEG}, "its primaries (unknown) cannot"},
        {{AV_PIX_FMT_YUV420P10, 16, (enum AVColorSpace)99, PQ, P2020, MPEG}, "matrix (unknown) cannot be read with PQ"},
        {{AV_PIX_FMT_YUV420P10, 16, M2020, PQ, (enum AVColorPrimaries)99, MPEG},
         "primaries (unknown) cannot be read; bt709, bt2020"},
        {{AV_PIX_FMT_XYZ12LE, 16, M709, T709, P709, JPEG}, "its pixel format xyz12le cannot"},
        {{AV_PIX_FMT_XYZ12BE, 16, M709, T709, P709, JPEG}, "its pixel format xyz12be cannot"},
        {{AV_PIX_FMT_PAL8, 16, M709, T709, P709, JPEG}, "its pixel format pal8 cannot"},
        {{AV_PIX_FMT_GBRPF32LE, 16, M709, T709, P709, JPEG}, "its pixel format gbrpf32le cannot"},
        {{AV_PIX_FMT_MONOWHITE, 16, M709, T709, P709, JPEG}, "its pixel format monow cannot"}};
    pupil_video_pixels p = {0};
    const tags good = {AV_PIX_FMT_YUV420P, 16, M709, T709, P709, MPEG};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        AVFrame *f = frame_of(&cases[i].tags), *then = frame_of(&good);
        CHECK(pupil_video_pixels_convert(&p, f, &why) == -1);
        CHECK_MSG(strstr(why.text, cases[i].words), "case %zu: %s", i, why.text);
        CHECK_MSG(pupil_video_pixels_convert(&p, then, &why) == 0, "after case %zu: %s", i, why.text);
        av_frame_free(&f);
        av_frame_free(&then);
    }
    AVFrame *f = frame_of(&good);
    f->format = AV_PIX_FMT_NONE;
    CHECK(pupil_video_pixels_convert(&p, f, &why) == -1 && strstr(why.text, "its pixel format (unknown) cannot"));
    av_frame_free(&f);
    pupil_video_pixels_free(&p);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_filled_in();
    test_wide();
    test_differs();
    test_refused();
    return check_end();
}

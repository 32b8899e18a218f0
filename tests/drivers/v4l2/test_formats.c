/* Every format of a camera: pixels, layout and colour are as the fake camera drew them. */
#include "check.h"

#include <linux/videodev2.h>
#include <math.h>

#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"
#include "pupil/pupil.h"
#include "v4l2/modes.h"

static pupil_why why;

typedef struct subject {
    fake_v4l2 *fake;
    pupil_source *source;
} subject;

static int open_subject(subject *s, const fake_v4l2_config *config, const pupil_v4l2_options *options)
{
    pupil_v4l2_options o = *options;
    s->fake = fake_v4l2_new(config);
    o.system = fake_v4l2_system(s->fake);
    s->source = NULL;
    why.text[0] = 0;
    return pupil_live_open("v4l2:/dev/video0", NULL, &(pupil_live_options){.capture = o, .hands_off = 1}, &s->source,
                           &why);
}

static void close_subject(subject *s)
{
    pupil_source_close(s->source);
    const fake_v4l2_held held = fake_v4l2_holds(s->fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%d files, %d maps", held.files, held.maps);
    fake_v4l2_free(s->fake);
}

/* The same frame is drawn again into rows of another length, and compared byte by byte. */
static unsigned differing(const pupil_source *source, const pupil_frame *frame, double scale)
{
    const pupil_v4l2_format *f = &pupil_live_capture(source)->format;
    const uint32_t row = (uint32_t)pupil_row_bytes(f->pixel, f->width);
    const uint32_t chroma_row = (uint32_t)pupil_chroma_row_bytes(f->pixel, f->width);
    static unsigned char data[320 * 240 * 4], chroma[320 * 240], cr[320 * 240];
    const fake_v4l2_picture picture = {.seed = 1,
                                       .sequence = pupil_live_frame(source)->sequence,
                                       .fourcc = f->fourcc,
                                       .width = f->width,
                                       .height = f->height,
                                       .stride_bytes = {row, chroma_row, chroma_row},
                                       .ycbcr_enc = f->ycbcr_enc,
                                       .quantization = f->quantization,
                                       .xfer_func =
                                           f->coding.light == PUPIL_LIGHT_DEFAULT ? V4L2_XFER_FUNC_NONE : f->xfer_func,
                                       .scale = scale};
    unsigned wrong = 0;
    fake_v4l2_draw(&picture, data, chroma, cr);
    for (uint32_t y = 0; y < f->height; y++) {
        const unsigned char *got = (const unsigned char *)frame->image.data + (ptrdiff_t)y * frame->image.stride_bytes;
        wrong += memcmp(got, data + (size_t)row * y, row) != 0;
    }
    for (ptrdiff_t y = 0; y < (ptrdiff_t)pupil_chroma_rows(f->pixel, f->height); y++) {
        const pupil_image_const *i = &frame->image;
        const size_t at = (size_t)y * chroma_row;
        wrong += memcmp((const unsigned char *)i->chroma + y * i->chroma_stride_bytes, chroma + at, chroma_row) != 0;
        if (i->cr)
            wrong += memcmp((const unsigned char *)i->cr + y * i->cr_stride_bytes, cr + at, chroma_row) != 0;
    }
    CHECK((frame->image.chroma != NULL) == (pupil_pixel_planes(f->pixel) > 1));
    CHECK((frame->image.cr != NULL) == (pupil_pixel_planes(f->pixel) > 2));
    return wrong;
}

/* The mean log2 luminance of the frame's scene, without any camera. */
static double scene_ev(const pupil_v4l2_format *f, uint32_t sequence, double scale)
{
    const int grey = pupil_pixel_bits(f->pixel) && !pupil_pixel_is_mosaic(f->pixel);
    const double weight[3] = {grey ? 0 : 0.2126, grey ? 1 : 0.7152, grey ? 0 : 0.0722};
    double sum = 0;
    for (uint32_t y = 0; y < f->height; y += 2)
        for (uint32_t x = 0; x < f->width; x += 2) {
            double luminance = 0;
            for (uint32_t c = 0; c < 3; c++)
                luminance += weight[c] * fmin(1, fake_v4l2_scene(1, sequence, x, y, c) * scale / FAKE_SCENE_WHITE);
            sum += log2(luminance);
        }
    return sum / (f->width / 2 * (f->height / 2));
}

static double metered_ev(const pupil_frame *frame)
{
    static pupil_t pupil;
    static pupil_stats stats;
    pupil_config config;
    pupil_exposure exposure = {0};
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    const int error = pupil_meter_rows(&pupil, &frame->image, 0, frame->image.height, &stats);
    CHECK_MSG(error == PUPIL_OK, "%s", pupil_error_string(error));
    CHECK(pupil_adapt(&pupil, &stats, &frame->info) == PUPIL_OK);
    pupil_get_exposure(&pupil, &exposure);
    return exposure.metered_ev;
}

/* Some frames of a format. Codes are rounded to the format's bits, so the mean of their logarithms is near the
 * light's. */
static void check_format(const fake_v4l2_config *config, uint32_t fourcc, double tolerance_ev)
{
    const pupil_v4l2_options options = {.fourcc = fourcc};
    const char *name = pupil_v4l2_fourcc_name(fourcc).text;
    subject s;
    pupil_frame frame;
    CHECK_MSG(open_subject(&s, config, &options) == 0, "%s: %s", name, why.text);
    for (int i = 0; s.source && i < 6; i++) {
        const int got = pupil_source_next(s.source, &frame, &why);
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s: %s", name, why.text);
        if (got != PUPIL_SOURCE_FRAME)
            break;
        const pupil_v4l2_format *f = &pupil_live_capture(s.source)->format;
        const unsigned wrong = differing(s.source, &frame, 1.0);
        CHECK_MSG(f->fourcc == fourcc && wrong == 0, "%s: %u rows differ", name, wrong);
        const double off = metered_ev(&frame) - scene_ev(f, pupil_live_frame(s.source)->sequence, 1.0);
        CHECK_MSG(fabs(off) < tolerance_ev, "%s: metered %g stops off", name, off);
        pupil_source_done(s.source, &frame);
    }
    close_subject(&s);
}

/* All formats of the fake, in every layout, as it reports them. */
static void test_pixels(void)
{
    for (int layout = 0; layout < 8; layout++) {
        fake_v4l2_config config;
        pupil_live_modes modes;
        pupil_v4l2_device device;
        unsigned checked = 0;
        fake_v4l2_config_default(&config);
        config.multiplanar = layout & 1;
        config.extra_bytes = layout & 2 ? 32 : 0;
        config.data_offset = layout == 5 || layout == 7 ? 128 : 0;
        config.no_mmap = layout == 4 || layout == 7;
        fake_v4l2 *fake = fake_v4l2_new(&config);
        CHECK(pupil_v4l2_device_open(&device, fake_v4l2_system(fake), "0", &why) == 0);
        CHECK(pupil_v4l2_modes_read(&device, &modes, &why) == 0);
        for (uint32_t i = 0; i < modes.count; i++)
            if (!modes.mode[i].compressed) {
                /* 8 bits are coarse in the dark; 10 and more are not. */
                const uint32_t pixel = pupil_v4l2_pixel_of(modes.mode[i].fourcc);
                const int coarse = pixel == PUPIL_PIXEL_BAYER8 || pixel == PUPIL_PIXEL_GREY8;
                check_format(&config, modes.mode[i].fourcc, coarse ? 0.01 : 0.005);
                checked++;
            }
        CHECK_MSG(checked == (config.multiplanar ? 53u : 48u), "%u formats", checked);
        pupil_live_modes_free(&modes);
        pupil_v4l2_device_close(&device);
        fake_v4l2_free(fake);
    }
}

/* The light is decoded by the colour that the driver reports. */
static void test_colour(void)
{
    static const uint32_t encodings[] = {V4L2_YCBCR_ENC_601, V4L2_YCBCR_ENC_709, V4L2_YCBCR_ENC_BT2020};
    static const uint32_t transfers[] = {V4L2_XFER_FUNC_SRGB, V4L2_XFER_FUNC_709, V4L2_XFER_FUNC_NONE};
    fake_v4l2_config config;
    fake_v4l2_config_default(&config);
    for (int e = 0; e < 3; e++)
        for (int x = 0; x < 3; x++)
            for (uint32_t q = V4L2_QUANTIZATION_FULL_RANGE; q <= V4L2_QUANTIZATION_LIM_RANGE; q++) {
                config.ycbcr_enc = encodings[e];
                config.xfer_func = transfers[x];
                config.quantization = q;
                check_format(&config, V4L2_PIX_FMT_YUYV, transfers[x] == V4L2_XFER_FUNC_NONE ? 0.015 : 0.005);
                check_format(&config, V4L2_PIX_FMT_NV12, transfers[x] == V4L2_XFER_FUNC_NONE ? 0.015 : 0.005);
                check_format(&config, V4L2_PIX_FMT_UYVY, transfers[x] == V4L2_XFER_FUNC_NONE ? 0.015 : 0.005);
                check_format(&config, V4L2_PIX_FMT_YVU420, transfers[x] == V4L2_XFER_FUNC_NONE ? 0.015 : 0.005);
                check_format(&config, v4l2_fourcc('P', '0', '1', '0'), 0.005);
                if (q == V4L2_QUANTIZATION_FULL_RANGE)
                    check_format(&config, V4L2_PIX_FMT_Y12, 0.005);
            }
    /* HDR10: 1.0 of the scene is 100 cd/m2. */
    config.colorspace = V4L2_COLORSPACE_BT2020;
    config.ycbcr_enc = config.quantization = 0;
    config.xfer_func = V4L2_XFER_FUNC_SMPTE2084;
    check_format(&config, v4l2_fourcc('P', '0', '1', '0'), 0.005);
}

typedef struct said { /* what a driver reports, and how it is interpreted */
    uint32_t fourcc, colorspace, ycbcr_enc, quantization, xfer_func;
    uint32_t matrix, range, light, primaries;
    const char *refusal;
} said;

static void test_defaults(void)
{
    static const said cases[] = {
        {V4L2_PIX_FMT_YUYV, 0, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_LIMITED, PUPIL_LIGHT_SRGB, 0, NULL},
        {V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_SRGB, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_LIMITED, PUPIL_LIGHT_SRGB, 0,
         NULL},
        {V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_JPEG, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_FULL, PUPIL_LIGHT_SRGB, 0,
         NULL},
        {V4L2_PIX_FMT_NV12, V4L2_COLORSPACE_REC709, 0, 0, 0, PUPIL_MATRIX_BT709, PUPIL_RANGE_LIMITED, PUPIL_LIGHT_BT709,
         0, NULL},
        {V4L2_PIX_FMT_NV12, V4L2_COLORSPACE_SMPTE170M, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_LIMITED,
         PUPIL_LIGHT_BT709, 0, NULL},
        {V4L2_PIX_FMT_NV12, V4L2_COLORSPACE_BT2020, 0, 0, 0, PUPIL_MATRIX_BT2020, PUPIL_RANGE_LIMITED,
         PUPIL_LIGHT_BT709, PUPIL_PRIMARIES_BT2020, NULL},
        {V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_SRGB, V4L2_YCBCR_ENC_XV709, V4L2_QUANTIZATION_FULL_RANGE, 0,
         PUPIL_MATRIX_BT709, PUPIL_RANGE_FULL, PUPIL_LIGHT_SRGB, 0, NULL},
        {V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_BT2020, V4L2_YCBCR_ENC_BT2020_CONST_LUM, 0, 0, 0, 0, 0, 0,
         "constant luminance"},
        {V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_SMPTE240M, 0, 0, 0, 0, 0, 0, 0, "SMPTE 240M"},
        {v4l2_fourcc('P', '0', '1', '0'), V4L2_COLORSPACE_BT2020, 0, 0, V4L2_XFER_FUNC_SMPTE2084, PUPIL_MATRIX_BT2020,
         PUPIL_RANGE_LIMITED, PUPIL_LIGHT_PQ, PUPIL_PRIMARIES_BT2020, NULL},
        {V4L2_PIX_FMT_UYVY, V4L2_COLORSPACE_REC709, 0, 0, 0, PUPIL_MATRIX_BT709, PUPIL_RANGE_LIMITED, PUPIL_LIGHT_BT709,
         0, NULL},
        {V4L2_PIX_FMT_YUV420, V4L2_COLORSPACE_JPEG, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_FULL, PUPIL_LIGHT_SRGB, 0,
         NULL},
        {V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_DCI_P3, 0, 0, 0, 0, 0, 0, 0, "DCI-P3; sRGB, Rec. 709, SMPTE 2084 (PQ)"},
        {V4L2_PIX_FMT_XBGR32, V4L2_COLORSPACE_SRGB, 0, V4L2_QUANTIZATION_LIM_RANGE, 0, 0, 0, 0, 0, "limited range"},
        {V4L2_PIX_FMT_BGR24, V4L2_COLORSPACE_BT2020, 0, 0, V4L2_XFER_FUNC_SMPTE2084, 0, 0, 0, 0, "transfer function"},
        {V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_OPRGB, 0, 0, 0, 0, 0, 0, 0, "opRGB"},
        {V4L2_PIX_FMT_GREY, V4L2_COLORSPACE_SRGB, 0, 0, 0, 0, 0, PUPIL_LIGHT_DEFAULT, 0, NULL},
        {V4L2_PIX_FMT_GREY, V4L2_COLORSPACE_SRGB, 0, 0, V4L2_XFER_FUNC_SRGB, 0, 0, PUPIL_LIGHT_SRGB, 0, NULL},
        {V4L2_PIX_FMT_RGB24, V4L2_COLORSPACE_SRGB, 0, 0, 0, 0, 0, 0, 0, NULL},
        {V4L2_PIX_FMT_RGB24, V4L2_COLORSPACE_SRGB, 0, V4L2_QUANTIZATION_LIM_RANGE, 0, 0, 0, 0, 0, "limited range"},
        {V4L2_PIX_FMT_RGB24, V4L2_COLORSPACE_REC709, 0, 0, 0, 0, 0, 0, 0, "transfer function"},
        {V4L2_PIX_FMT_SRGGB10, V4L2_COLORSPACE_REC709, 0, 0, 0, 0, 0, PUPIL_LIGHT_DEFAULT, 0, NULL},
        {V4L2_PIX_FMT_H264, V4L2_COLORSPACE_JPEG, 0, 0, 0, 0, 0, 0, 0, "H264 is not supported; supported: RGGB"},
        {V4L2_PIX_FMT_MJPEG, V4L2_COLORSPACE_JPEG, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_FULL, PUPIL_LIGHT_SRGB, 0,
         NULL},
        {V4L2_PIX_FMT_MJPEG, V4L2_COLORSPACE_SRGB, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_FULL, PUPIL_LIGHT_SRGB, 0,
         NULL},
        {V4L2_PIX_FMT_JPEG, V4L2_COLORSPACE_REC709, 0, 0, 0, PUPIL_MATRIX_BT601, PUPIL_RANGE_FULL, PUPIL_LIGHT_BT709, 0,
         NULL},
        {V4L2_PIX_FMT_MJPEG, V4L2_COLORSPACE_SRGB, V4L2_YCBCR_ENC_709, V4L2_QUANTIZATION_LIM_RANGE, 0,
         PUPIL_MATRIX_BT709, PUPIL_RANGE_LIMITED, PUPIL_LIGHT_SRGB, 0, NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const said *c = &cases[i];
        pupil_v4l2_format f;
        struct v4l2_format answer = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
        answer.fmt.pix = (struct v4l2_pix_format){.width = 64,
                                                  .height = 48,
                                                  .pixelformat = c->fourcc,
                                                  .sizeimage = 64 * 48 * 4,
                                                  .colorspace = c->colorspace,
                                                  .priv = V4L2_PIX_FMT_PRIV_MAGIC,
                                                  .quantization = c->quantization,
                                                  .xfer_func = c->xfer_func};
        answer.fmt.pix.ycbcr_enc = c->ycbcr_enc;
        const int error = pupil_v4l2_format_read(&answer, &f, &why);
        CHECK_MSG((error != 0) == (c->refusal != NULL), "case %zu: %s", i, error ? why.text : "taken");
        if (c->refusal)
            CHECK_MSG(strstr(why.text, c->refusal), "case %zu: %s", i, why.text);
        if (error || c->refusal)
            continue;
        CHECK_MSG(f.coding.light == c->light && f.primaries == c->primaries, "case %zu: light %u", i, f.coding.light);
        if (pupil_pixel_planes(f.pixel) > 1 || f.pixel == PUPIL_PIXEL_YUYV || f.pixel == PUPIL_PIXEL_UYVY ||
            f.compressed)
            CHECK_MSG(f.coding.matrix == c->matrix && f.coding.range == c->range, "case %zu: matrix %u, range %u", i,
                      f.coding.matrix, f.coding.range);
        CHECK(pupil_coding_check(&f.coding, f.pixel, NULL) == PUPIL_OK);
    }
}

/* Limited-range grey goes from 16 to 235, or the equivalent with more bits. */
static void test_limited_grey(void)
{
    static const struct {
        uint32_t fourcc;
        float black, white;
    } cases[] = {{V4L2_PIX_FMT_GREY, 16, 235},
                 {V4L2_PIX_FMT_Y10, 64, 940},
                 {V4L2_PIX_FMT_Y12, 256, 3760},
                 {V4L2_PIX_FMT_Y16, 4096, 60160},
                 {v4l2_fourcc('Y', '1', '0', 'P'), 64, 940},
                 {v4l2_fourcc('Y', '1', '2', 'P'), 256, 3760}};
    for (int i = 0; i < 6; i++) {
        pupil_v4l2_format f;
        struct v4l2_format answer = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
        answer.fmt.pix = (struct v4l2_pix_format){.width = 64,
                                                  .height = 48,
                                                  .pixelformat = cases[i].fourcc,
                                                  .sizeimage = 64 * 48 * 2,
                                                  .colorspace = V4L2_COLORSPACE_SRGB,
                                                  .priv = V4L2_PIX_FMT_PRIV_MAGIC,
                                                  .quantization = V4L2_QUANTIZATION_LIM_RANGE};
        CHECK(pupil_v4l2_format_read(&answer, &f, &why) == 0);
        CHECK_MSG(f.coding.black == cases[i].black && f.coding.white == cases[i].white, "%g %g", (double)f.coding.black,
                  (double)f.coding.white);
        CHECK(pupil_coding_check(&f.coding, f.pixel, NULL) == PUPIL_OK);
    }
}

/* Answers with which no frame can be read. */
static void test_nonsense(void)
{
    static const struct {
        uint32_t fourcc, width, height, stride, size, field;
        const char *refusal;
    } cases[] = {
        {V4L2_PIX_FMT_YUYV, 64, 48, 127, 1 << 20, 0, "a row has 127 bytes"},
        {V4L2_PIX_FMT_YUYV, 64, 48, 128, 6143, 0, "a frame has 6143 bytes; 64x48 of YUYV need 6144"},
        {V4L2_PIX_FMT_NV12, 64, 48, 64, 64 * 72 - 1, 0, "a frame has 4607 bytes"},
        {V4L2_PIX_FMT_YUYV, 64, 48, 128, 17u << 20, 0,
         "a frame has 17825792 bytes; 64x48 of YUYV have 16973824 at most"},
        {V4L2_PIX_FMT_MJPEG, 64, 48, 0, UINT32_MAX, 0, "64x48 of MJPG have 16973824 at most"},
        {V4L2_PIX_FMT_YUV420, 64, 48, 63, 1 << 20, 0, "a row has 63 bytes; 64 pixels of YU12 need 64"},
        {V4L2_PIX_FMT_YUV420, 63, 48, 63, 1 << 20, 0, "a row has 31 bytes; 63 pixels of YU12 need 32"},
        {V4L2_PIX_FMT_YVU420, 64, 48, 64, 64 * 72 - 1, 0, "64x48 of YV12 need 4608"},
        {V4L2_PIX_FMT_NV16, 64, 48, 64, 64 * 96 - 1, 0, "64x48 of NV16 need 6144"},
        {v4l2_fourcc('P', '0', '1', '0'), 64, 48, 129, 1 << 20, 0, "an even number"},
        {V4L2_PIX_FMT_YUYV, 0, 48, 128, 1 << 20, 0, "0x48"},
        {V4L2_PIX_FMT_YUYV, 16385, 48, 0, UINT32_MAX, 0, "16385x48"},
        {V4L2_PIX_FMT_GREY, 16384, 16384, UINT32_MAX, UINT32_MAX, 0, "a frame has"},
        {V4L2_PIX_FMT_SRGGB8, 63, 48, 0, 1 << 20, 0, "63x48"},
        {V4L2_PIX_FMT_SRGGB8, 64, 47, 0, 1 << 20, 0, "64x47"},
        {V4L2_PIX_FMT_SRGGB10P, 66, 48, 0, 1 << 20, 0, "multiple of 4"},
        {V4L2_PIX_FMT_SRGGB10, 64, 48, 129, 1 << 20, 0, "an even number"},
        {V4L2_PIX_FMT_YUYV, 64, 48, 128, 6144, V4L2_FIELD_ALTERNATE, "single fields"},
        {V4L2_PIX_FMT_NV12M, 64, 48, 64, 1 << 20, 0, "memory areas"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        pupil_v4l2_format f;
        struct v4l2_format answer = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
        answer.fmt.pix = (struct v4l2_pix_format){.width = cases[i].width,
                                                  .height = cases[i].height,
                                                  .pixelformat = cases[i].fourcc,
                                                  .field = cases[i].field ? cases[i].field : V4L2_FIELD_NONE,
                                                  .bytesperline = cases[i].stride,
                                                  .sizeimage = cases[i].size,
                                                  .colorspace = V4L2_COLORSPACE_SRGB};
        why.text[0] = 0;
        CHECK_MSG(pupil_v4l2_format_read(&answer, &f, &why) && strstr(why.text, cases[i].refusal), "case %zu: %s", i,
                  why.text);
    }
}

static void test_names(void)
{
    CHECK(pupil_v4l2_fourcc("YUYV") == V4L2_PIX_FMT_YUYV && pupil_v4l2_fourcc("Y10") == V4L2_PIX_FMT_Y10);
    CHECK(pupil_v4l2_fourcc("") == 0 && pupil_v4l2_fourcc("YUYV2") == 0 && pupil_v4l2_fourcc("Y\t") == 0);
    CHECK(strcmp(pupil_v4l2_fourcc_name(V4L2_PIX_FMT_Y16_BE).text, "Y16-BE") == 0);
    CHECK(strcmp(pupil_v4l2_fourcc_name(0).text, "????") == 0);
    CHECK(pupil_v4l2_pixel_of(V4L2_PIX_FMT_Y16_BE) == PUPIL_PIXEL_NONE);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_pixels();
    test_colour();
    test_defaults();
    test_limited_grey();
    test_nonsense();
    test_names();
    return check_end();
}

/* Frames into the fake monitor: every format against the formulas, what is refused, and every call failing. */
#include "check.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <math.h>

#include "fake_v4l2/fake_v4l2.h"
#include "source.h"
#include "v4l2/output/v4l2_sink.h"

static pupil_why why;

static const struct {
    uint32_t fourcc;
    const char *name;
} formats[] = {{V4L2_PIX_FMT_RGB24, "RGB3"},  {V4L2_PIX_FMT_BGR24, "BGR3"},  {V4L2_PIX_FMT_XBGR32, "XR24"},
               {V4L2_PIX_FMT_YUYV, "YUYV"},   {V4L2_PIX_FMT_NV12, "NV12"},   {V4L2_PIX_FMT_YUV420, "YU12"},
               {V4L2_PIX_FMT_UYVY, "UYVY"},   {V4L2_PIX_FMT_NV21, "NV21"},   {V4L2_PIX_FMT_NV16, "NV16"},
               {V4L2_PIX_FMT_YVU420, "YV12"}, {V4L2_PIX_FMT_RGBX32, "XB24"}, {V4L2_PIX_FMT_ABGR32, "AR24"},
               {V4L2_PIX_FMT_RGBA32, "AB24"}};

static int is_rgb(uint32_t fourcc)
{
    return fourcc == V4L2_PIX_FMT_RGB24 || fourcc == V4L2_PIX_FMT_BGR24 || fourcc == V4L2_PIX_FMT_XBGR32 ||
           fourcc == V4L2_PIX_FMT_RGBX32 || fourcc == V4L2_PIX_FMT_ABGR32 || fourcc == V4L2_PIX_FMT_RGBA32;
}

/* --- a frame, and its expected result --- */

typedef struct frame {
    uint32_t width, height;
    uint8_t *rgb;
    pupil_image_const image;
} frame;

/* Random pixels, with every corner of the colour cube. bottom_up: the top row is the last one in memory. */
static frame make_frame(uint32_t width, uint32_t height, int bottom_up)
{
    frame f = {width, height, malloc((size_t)3 * width * height), {0}};
    for (size_t i = 0; i < (size_t)width * height; i++)
        for (uint32_t c = 0; c < 3; c++)
            f.rgb[3 * i + c] = (uint8_t)(i < 8 ? (i >> c & 1 ? 255 : 0) : check_random());
    f.image = (pupil_image_const){.data = bottom_up ? f.rgb + (size_t)3 * width * (height - 1) : f.rgb,
                                  .stride_bytes = bottom_up ? -3 * (ptrdiff_t)width : 3 * (ptrdiff_t)width,
                                  .width = width,
                                  .height = height,
                                  .pixel = PUPIL_PIXEL_RGB8};
    return f;
}

static long double at(const frame *f, uint32_t x, uint32_t y, int c)
{
    x = x < f->width ? x : f->width - 1;
    y = y < f->height ? y : f->height - 1;
    return ((const uint8_t *)f->image.data + (ptrdiff_t)y * f->image.stride_bytes)[3 * x + (uint32_t)c];
}

typedef struct rule {
    long double kr, kb;
    int limited;
} rule;

static long double luma(const rule *r, const frame *f, uint32_t x, uint32_t y)
{
    const long double v = r->kr * at(f, x, y, 0) + (1 - r->kr - r->kb) * at(f, x, y, 1) + r->kb * at(f, x, y, 2);
    return r->limited ? 16 + 219 * v / 255 : v;
}

/* Mean chroma of the pixels from (x, y), two in each of `rows`; which: 0 Cb, 1 Cr. */
static long double chroma(const rule *r, const frame *f, uint32_t x, uint32_t y, uint32_t rows, int which)
{
    long double sum = 0;
    for (uint32_t i = 0; i < 2 * rows; i++) {
        const long double red = at(f, x + i % 2, y + i / 2, 0), blue = at(f, x + i % 2, y + i / 2, 2);
        const long double l = r->kr * red + (1 - r->kr - r->kb) * at(f, x + i % 2, y + i / 2, 1) + r->kb * blue;
        sum += which ? (red - l) / (2 * (1 - r->kr)) : (blue - l) / (2 * (1 - r->kb));
    }
    return fminl(255, 128 + (r->limited ? 224 : 255) * sum / 255 / (2 * rows));
}

static long double rgb_code(const fake_v4l2_screen *s, const rule *r, const frame *f, uint32_t x_byte, uint32_t y)
{
    const uint32_t bytes = s->fourcc == V4L2_PIX_FMT_RGB24 || s->fourcc == V4L2_PIX_FMT_BGR24 ? 3 : 4;
    const int red_first =
        s->fourcc == V4L2_PIX_FMT_RGB24 || s->fourcc == V4L2_PIX_FMT_RGBX32 || s->fourcc == V4L2_PIX_FMT_RGBA32;
    const uint32_t channel = x_byte % bytes;
    if (channel == 3)
        return 255;
    const long double code = at(f, x_byte / bytes, y, (int)(red_first ? channel : 2 - channel));
    return r->limited ? 16 + 219 * code / 255 : code;
}

/* The largest error of a sample in rows of a plane. kind: 0 RGB, 1 Y', 2 YUYV, 3 UYVY, 4 Cb, 5 Cr, 6 Cb Cr, 7 Cr Cb.
 * rows_each: rows of pixels for one of the plane. */
static long double plane_off(const fake_v4l2_screen *s, const rule *r, const frame *f, size_t first, uint32_t stride,
                             int kind, uint32_t rows_each)
{
    const uint32_t pairs = (f->width + 1) / 2;
    const uint32_t rgb_bytes = f->width * (s->fourcc == V4L2_PIX_FMT_RGB24 || s->fourcc == V4L2_PIX_FMT_BGR24 ? 3 : 4);
    const uint32_t bytes[] = {rgb_bytes, f->width, 4 * pairs, 4 * pairs, pairs, pairs, 2 * pairs, 2 * pairs};
    long double most = 0;
    for (uint32_t y = 0; y < f->height; y += rows_each)
        for (uint32_t x = 0; x < bytes[kind]; x++) {
            const uint32_t odd = (x + (kind == 3)) % 2;
            long double want = 0;
            if (kind == 0)
                want = rgb_code(s, r, f, x, y);
            else if (kind == 1 || ((kind == 2 || kind == 3) && !odd))
                want = luma(r, f, kind == 1 ? x : x / 2, y);
            else if (kind == 2 || kind == 3)
                want = chroma(r, f, x / 4 * 2, y, 1, x % 4 > 1);
            else if (kind < 6)
                want = chroma(r, f, 2 * x, y, rows_each, kind == 5);
            else
                want = chroma(r, f, x / 2 * 2, y, rows_each, x % 2 != (kind == 7));
            most = fmaxl(most, fabsl(s->data[first + (size_t)(y / rows_each) * stride + x] - want));
        }
    return most;
}

static void check_screen(const fake_v4l2_screen *s, const rule *r, const frame *f, const char *what)
{
    const uint32_t stride = s->stride_bytes, chroma_rows = (f->height + 1) / 2;
    const size_t second = (size_t)stride * f->height, third = second + (size_t)(stride / 2) * chroma_rows;
    const int planar = s->fourcc == V4L2_PIX_FMT_YUV420, turned = s->fourcc == V4L2_PIX_FMT_YVU420;
    long double most = 0;
    CHECK_MSG(s->width == f->width && s->height == f->height, "%s: %ux%u", what, s->width, s->height);
    if (is_rgb(s->fourcc)) {
        most = plane_off(s, r, f, 0, stride, 0, 1);
    } else if (s->fourcc == V4L2_PIX_FMT_YUYV || s->fourcc == V4L2_PIX_FMT_UYVY) {
        most = plane_off(s, r, f, 0, stride, s->fourcc == V4L2_PIX_FMT_YUYV ? 2 : 3, 1);
    } else {
        most = plane_off(s, r, f, 0, stride, 1, 1);
        if (planar || turned) {
            most = fmaxl(most, plane_off(s, r, f, second, stride / 2, planar ? 4 : 5, 2));
            most = fmaxl(most, plane_off(s, r, f, third, stride / 2, planar ? 5 : 4, 2));
        } else {
            most = fmaxl(most, plane_off(s, r, f, second, stride, s->fourcc == V4L2_PIX_FMT_NV21 ? 7 : 6,
                                         s->fourcc == V4L2_PIX_FMT_NV16 ? 1 : 2));
        }
    }
    CHECK_MSG(most <= 0.51L, "%s: a sample is %Lg codes off", what, most); /* rounding of codes and of the factors */
}

/* --- formats --- */

static pupil_sink *open_sink(fake_v4l2 *fake, const char *path, uint32_t width, uint32_t height)
{
    const pupil_sink_options options = {.width = width, .height = height, .fps = 29.97};
    pupil_sink *sink = NULL;
    why.text[0] = 0;
    const int result = pupil_v4l2_sink_open(&sink, path, &options, fake_v4l2_system(fake), &why);
    CHECK_MSG((result == PUPIL_SINK_OK) == (sink != NULL) && (sink || *why.text), "%s", why.text);
    return sink;
}

static void close_fake(fake_v4l2 *fake)
{
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "%d files and %d maps are left", held.files, held.maps);
    fake_v4l2_free(fake);
}

static void show(const fake_v4l2_config *config, const rule *r, uint32_t width, uint32_t height, const char *what)
{
    fake_v4l2 *fake = fake_v4l2_new(config);
    fake_v4l2_screen screen;
    pupil_sink *sink = open_sink(fake, "/dev/video2", width, height);
    CHECK_MSG(sink != NULL, "%s: %s", what, why.text);
    for (uint64_t i = 1; sink && i <= 7; i++) { /* more than its number of buffers */
        frame f = make_frame(width, height, i % 2 == 0);
        CHECK_MSG(pupil_sink_write(sink, &f.image, NULL, &why) == PUPIL_SINK_OK, "%s: %s", what, why.text);
        CHECK(fake_v4l2_shown(fake, &screen) == i);
        check_screen(&screen, r, &f, what);
        free(f.rgb);
    }
    CHECK(!sink || pupil_sink_finish(sink, &why) == PUPIL_SINK_OK);
    close_fake(fake);
}

static void test_formats(void)
{
    const rule bt601 = {0.299L, 0.114L, 1}, bt709 = {0.2126L, 0.0722L, 1};
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        for (int way = 0; way < 5; way++) {
            fake_v4l2_config c;
            const int yuv = !is_rgb(formats[i].fourcc);
            char what[64];
            fake_v4l2_config_default(&c);
            c.out_format = formats[i].fourcc;
            c.out_write_only = way == 1;
            c.extra_bytes = way == 1 ? 10 : 0;
            rule r = way >= 3 ? bt709 : bt601;
            if (way == 2) /* what was set, sRGB, with the range that RGB has */
                c.out_quantization = V4L2_QUANTIZATION_FULL_RANGE;
            if (way == 3)
                c.out_colorspace = V4L2_COLORSPACE_REC709;
            if (way == 4) {
                c.out_ycbcr_enc = V4L2_YCBCR_ENC_709;
                c.out_quantization = V4L2_QUANTIZATION_LIM_RANGE;
            }
            r.limited = way == 2 ? 0 : yuv || way == 4;
            snprintf(what, sizeof what, "%s, way %d", formats[i].name, way);
            show(&c, &r, 34, 18, what);
            show(&c, &r, 33, 17, what);
            show(&c, &r, 1, 1, what);
        }
}

/* Every grey stays grey, and each of 2^16 colours is within a code. */
static void test_grey(void)
{
    fake_v4l2_config c;
    frame f = make_frame(256, 1, 0);
    fake_v4l2_screen screen;
    fake_v4l2_config_default(&c);
    c.out_format = V4L2_PIX_FMT_NV12;
    for (uint32_t i = 0; i < 256 * 3; i++)
        f.rgb[i] = (uint8_t)(i / 3 / 2 * 2);
    fake_v4l2 *fake = fake_v4l2_new(&c);
    pupil_sink *sink = open_sink(fake, "v4l2:2", 256, 1);
    CHECK(sink && pupil_sink_write(sink, &f.image, NULL, &why) == PUPIL_SINK_OK);
    CHECK(fake_v4l2_shown(fake, &screen) == 1);
    for (uint32_t x = 0; x < 256; x++)
        CHECK(screen.data[256 + x] == 128);
    CHECK(fabs(screen.fps / (30000.0 / 1001.0) - 1.0) < 1e-12);
    CHECK(screen.colorspace == V4L2_COLORSPACE_SRGB);
    pupil_sink_discard(sink);
    close_fake(fake);
    free(f.rgb);
}

/* A format that a user has set stays; else it is RGB24. */
static void test_order(void)
{
    fake_v4l2_config c;
    fake_v4l2_screen screen;
    fake_v4l2_config_default(&c);
    fake_v4l2 *fake = fake_v4l2_new(&c);
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    for (size_t i = 0; i <= sizeof formats / sizeof formats[0]; i++) {
        frame f = make_frame(32, 24, 0);
        if (i) {
            struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_OUTPUT};
            format.fmt.pix = (struct v4l2_pix_format){.width = 8, .height = 8, .pixelformat = formats[i - 1].fourcc};
            const int fd = system->open(system->context, "/dev/video2");
            CHECK(system->ioctl(system->context, fd, VIDIOC_S_FMT, &format) == 0);
            system->close(system->context, fd);
        }
        pupil_sink *sink = open_sink(fake, "/dev/video2", 32, 24);
        CHECK(sink && pupil_sink_write(sink, &f.image, NULL, &why) == PUPIL_SINK_OK);
        fake_v4l2_shown(fake, &screen);
        CHECK(screen.fourcc == formats[i ? i - 1 : 0].fourcc);
        pupil_sink_discard(sink);
        free(f.rgb);
    }
    close_fake(fake);
}

/* --- what is refused --- */

static void refused(const fake_v4l2_config *config, const char *path, uint32_t width, const char *sentence)
{
    fake_v4l2 *fake = fake_v4l2_new(config);
    pupil_sink *sink = open_sink(fake, path, width, 24);
    CHECK_MSG(!sink && strcmp(why.text, sentence) == 0, "'%s'", why.text);
    pupil_sink_discard(sink);
    close_fake(fake);
}

static void test_refusals(void)
{
    fake_v4l2_config usual, c;
    fake_v4l2_config_default(&usual);
    refused(&usual, "/dev/video0", 32,
            "/dev/video0: Fake Camera is not a video output; a display's node is needed, or one "
            "of v4l2loopback");
    refused(&usual, "/dev/video9", 32, "/dev/video9: cannot be opened: No such file or directory");
    refused(&usual, "v4l2:screen", 32,
            "v4l2:screen: an output node is named by its path or number, as v4l2:2 or "
            "/dev/video2");
    refused(&usual, "/dev/video2", 0,
            "/dev/video2: frames of 0 x 24 pixels cannot be written; each side is 1 to 16384");
    c = usual;
    c.out_width = 1920;
    c.out_height = 1080;
    refused(&c, "/dev/video2", 32,
            "/dev/video2: Fake Monitor takes frames of 1920x1080, not of 32x24; it has "
            "1920x1080");
    c = usual;
    c.out_format = V4L2_PIX_FMT_GREY;
    refused(&c, "/dev/video2", 32,
            "/dev/video2: Fake Monitor: it takes GREY; formats that can be written: RGB3, BGR3, XR24, "
            "YUYV, NV12, YU12, UYVY, NV21, NV16, YV12, XB24, AR24, AB24");
    c = usual;
    c.out_format = V4L2_PIX_FMT_YUYV;
    c.out_ycbcr_enc = V4L2_YCBCR_ENC_BT2020;
    refused(&c, "/dev/video2", 32,
            "/dev/video2: Fake Monitor: its Y'CbCr encoding is number 6 of V4L2's; 601 or Rec. "
            "709 can be written");
    CHECK(pupil_is_v4l2_output("/dev/video2") && pupil_is_v4l2_output("v4l2:2") &&
          pupil_is_v4l2_output("/dev/v4l/by-id/x") && !pupil_is_v4l2_output("/dev/shm/video2.mp4") &&
          !pupil_is_v4l2_output("video2") && !pupil_is_v4l2_output("-"));
}

static void write_until(const fake_v4l2_config *config, uint64_t frames, const char *sentence)
{
    fake_v4l2 *fake = fake_v4l2_new(config);
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    frame f = make_frame(32, 24, 0);
    pupil_sink *sink = open_sink(fake, "/dev/video2", 32, 24);
    const int64_t began_ns = system->now_ns(system->context);
    uint64_t i = 0;
    while (sink && i < 20 && pupil_sink_write(sink, &f.image, NULL, &why) == PUPIL_SINK_OK)
        i++;
    CHECK_MSG(i == frames && strcmp(why.text, sentence) == 0, "%llu frames, then '%s'", (unsigned long long)i,
              why.text);
    CHECK(system->now_ns(system->context) - began_ns < INT64_C(7000000000));
    pupil_sink_discard(sink);
    close_fake(fake);
    free(f.rgb);
}

static void test_ends(void)
{
    for (int by_write = 0; by_write < 2; by_write++) {
        fake_v4l2_config c;
        fake_v4l2_config_default(&c);
        c.out_write_only = by_write;
        c.out_gone_at = 5;
        write_until(&c, 4, "/dev/video2: the output is gone");
        c.out_gone_at = 0;
        c.out_stall_at = 5;
        write_until(&c, by_write ? 5 : 7, "/dev/video2: it shows no frame for 5 seconds"); /* 7: three are queued */
    }
    fake_v4l2_config c;
    fake_v4l2_config_default(&c);
    c.start_error = EPIPE;
    write_until(&c, 0, "/dev/video2: does not start: nothing is connected that takes the picture");

    c.start_error = 0;
    fake_v4l2 *fake = fake_v4l2_new(&c);
    frame f = make_frame(30, 24, 0);
    pupil_sink *sink = open_sink(fake, "/dev/video2", 32, 24);
    CHECK(sink && pupil_sink_write(sink, &f.image, NULL, &why) == PUPIL_SINK_FAILED && strstr(why.text, "30 x 24"));
    CHECK(sink && pupil_sink_finish(sink, &why) == PUPIL_SINK_FAILED && strstr(why.text, "no frame"));
    pupil_sink *other = open_sink(fake, "/dev/video2", 32, 24);
    CHECK_MSG(!other && strcmp(why.text, "/dev/video2: refuses the format: another program is writing to it") == 0,
              "%s", why.text);
    pupil_sink_discard(sink);
    close_fake(fake);
    free(f.rgb);
}

/* --- every call fails --- */

/* Returns whether the fault was met. */
static int play(const fake_v4l2_config *config, unsigned long at, unsigned long many, int error)
{
    const pupil_sink_options options = {.width = 32, .height = 24, .fps = 30};
    fake_v4l2 *fake = fake_v4l2_new(config);
    const pupil_v4l2_system *system = fake_v4l2_system(fake);
    fake_faults f;
    pupil_sink *sink = NULL;
    frame picture = make_frame(32, 24, 0);
    const int64_t began_ns = system->now_ns(system->context);
    fake_faults_begin(&f, system, at, many, error);
    why.text[0] = 0;
    int result = pupil_v4l2_sink_open(&sink, "/dev/video2", &options, &f.system, &why);
    for (int i = 0; !result && i < 6; i++)
        result = pupil_sink_write(sink, &picture.image, NULL, &why);
    if (!result && pupil_sink_finish(sink, &why) == PUPIL_SINK_OK)
        sink = NULL;
    else
        result = PUPIL_SINK_FAILED;
    pupil_sink_discard(sink);
    const int64_t took_ns = system->now_ns(system->context) - began_ns;
    CHECK_MSG((result != 0) == (why.text[0] != 0) && !strchr(why.text, '\n'), "call %lu (%s), %s: %d, '%s'", at,
              f.failed, strerror(error), result, why.text);
    CHECK_MSG(took_ns < INT64_C(12000000000), "call %lu (%s), %s: %g s", at, f.failed, strerror(error),
              (double)took_ns * 1e-9);
    CHECK(f.calls < 20000);
    free(picture.rgb);
    close_fake(fake);
    return f.failed != NULL;
}

static void test_calls(void)
{
    static const int errors[] = {EIO, ENODEV, EINTR, EAGAIN, EINVAL, ENOMEM, EBUSY, EPIPE, ENOTTY, EACCES, EMFILE};
    for (int way = 0; way < 3; way++)
        for (size_t e = 0; e < sizeof errors / sizeof errors[0]; e++)
            for (int many = 0; many < 2; many++) {
                fake_v4l2_config c;
                unsigned long at = 1;
                fake_v4l2_config_default(&c);
                c.out_write_only = way == 1;
                c.out_width = way == 2 ? 640 : 0; /* a refusal, with its sizes */
                c.out_height = 480;
                while (play(&c, at, many ? 150 : 1, errors[e]))
                    at++;
                CHECK_MSG(at > 10, "only %lu calls", at);
            }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_formats();
    test_grey();
    test_order();
    test_refusals();
    test_ends();
    test_calls();
    return check_end();
}

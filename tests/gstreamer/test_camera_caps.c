/* Which size and rate a camera is asked for, given what downstream accepts and the camera has; and the caps of its
 * frames. */
#include "gstreamer/camera_caps.h"

#include <linux/videodev2.h>
#include <math.h>

#include "check.h"
#include "gstreamer/picture_format.h"

/* A YUYV camera with three sizes, the smallest with more rates, and a format that is not read. */
static pupil_live_size yuyv_sizes[] = {
    {.width = 320, .height = 240, .max_width = 320, .max_height = 240, .fps = {15, 30, 60}, .rates = 3},
    {.width = 640, .height = 480, .max_width = 640, .max_height = 480, .fps = {30}, .rates = 1},
    {.width = 1920, .height = 1080, .max_width = 1920, .max_height = 1080, .fps = {5}, .rates = 1}};
static pupil_live_size jpeg_sizes[] = {
    {.width = 1280, .height = 720, .max_width = 1280, .max_height = 720, .fps = {30}, .rates = 1}};
static pupil_live_size odd_sizes[] = {
    {.width = 800, .height = 800, .max_width = 800, .max_height = 800, .fps = {30}, .rates = 1}};
static pupil_live_mode webcam_modes[] = {{.fourcc = V4L2_PIX_FMT_YUYV, .read = 1, .size = yuyv_sizes, .sizes = 3},
                                         {.fourcc = V4L2_PIX_FMT_MJPEG, .read = 1, .size = jpeg_sizes, .sizes = 1},
                                         {.fourcc = V4L2_PIX_FMT_H264, .read = 0, .size = odd_sizes, .sizes = 1}};

/* Cameras with stepwise sizes; the last one's range does not begin at a multiple of its step. */
static pupil_live_size scaled_sizes[] = {{.width = 32,
                                          .height = 24,
                                          .max_width = 1920,
                                          .max_height = 1080,
                                          .step_width = 2,
                                          .step_height = 2,
                                          .fps = {10, 50},
                                          .rates = 2,
                                          .fps_between = 1}};
static pupil_live_size uneven_sizes[] = {
    {.width = 33, .height = 20, .max_width = 99, .max_height = 1075, .step_width = 2, .step_height = 10}};
static pupil_live_mode scaled_modes[] = {{.fourcc = V4L2_PIX_FMT_NV12, .read = 1, .size = scaled_sizes, .sizes = 1}};
static pupil_live_mode uneven_modes[] = {{.fourcc = V4L2_PIX_FMT_NV12, .read = 1, .size = uneven_sizes, .sizes = 1}};
static pupil_live_mode sensor_modes[] = {{.fourcc = V4L2_PIX_FMT_SRGGB10, .read = 1}};

enum { WEBCAM, SCALED, UNEVEN, SENSOR };
static const pupil_live_modes cameras[] = {{webcam_modes, 3}, {scaled_modes, 1}, {uneven_modes, 1}, {sensor_modes, 1}};

static void test_ask(void)
{
    static const struct {
        int camera;
        uint32_t fourcc;
        const char *wanted;
        uint32_t width, height;
        double fps;
        const char *refused;
    } cases[] = {
        /* open, or fixed: as wanted, regardless of the camera's list */
        {WEBCAM, 0, "", 0, 0, 0, NULL},
        {WEBCAM, 0, ", width=[1,16384], height=[1,16384], framerate=[0/1,2147483647/1]", 0, 0, 0, NULL},
        {WEBCAM, 0, ", width=322, height=242", 322, 242, 0, NULL},
        {WEBCAM, 0, ", width=322, height=242, framerate=30000/1001", 322, 242, 30000.0 / 1001, NULL},
        {WEBCAM, 0, ", width=322, height=242, framerate=0/1", 322, 242, 0, NULL},
        {WEBCAM, 0, ", framerate=7/1", 0, 0, 7, NULL},
        /* one side; ranges; lists: the nearest mode */
        {WEBCAM, 0, ", width=640", 640, 480, 30, NULL},
        {WEBCAM, 0, ", height=240", 320, 240, 30, NULL},
        {WEBCAM, 0, ", width={320,640}, height={240,480}", 320, 240, 30, NULL},
        {WEBCAM, 0, ", width=[400,16384], height=[1,16384]", 640, 480, 30, NULL},
        {WEBCAM, 0, ", width=[1,1000], height=[1,1000]", 320, 240, 30, NULL},
        {WEBCAM, 0, ", framerate=[10/1,20/1]", 320, 240, 15, NULL},
        {WEBCAM, 0, ", framerate=[0/1,20/1]", 320, 240, 15, NULL},
        {WEBCAM, 0, ", framerate=[40/1,2147483647/1]", 320, 240, 60, NULL},
        {WEBCAM, 0, ", framerate={5/1,7/1}", 1920, 1080, 5, NULL},
        {WEBCAM, 0, ", width=[700,1300], framerate=0/1", 0, 0, 0, "the camera has no mode"},
        {WEBCAM, 0, ", width=[700,1300]", 1280, 720, 30, NULL},
        {WEBCAM, V4L2_PIX_FMT_YUYV, ", width=[700,1300]", 0, 0, 0, "the camera has no mode"},
        {WEBCAM, V4L2_PIX_FMT_H264, ", width=[700,1300]", 0, 0, 0, NULL}, /* as it is set */
        {WEBCAM, 0, ", width=800", 0, 0, 0, "the camera has no mode"},    /* that is not read */
        {SCALED, 0, ", width=[1,1000]", 1000, 720, 30, NULL},
        {SCALED, 0, ", width=[1,1000], framerate=[1/1,20/1]", 1000, 720, 20, NULL},
        {UNEVEN, 0, ", width=[1,1000]", 33, 20, 0, NULL},
        {UNEVEN, 0, ", width=[1,1000], framerate=[0/1,2147483647/1]", 33, 20, 0, NULL},
        {SENSOR, 0, ", width=[1,1000]", 0, 0, 0, NULL},
    };
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        gchar *text = g_strdup_printf("video/x-raw, format=NV12%s", cases[i].wanted);
        GstCaps *wanted = gst_caps_from_string(text);
        camera_asked asked;
        pupil_why why = {""};
        const int failed = camera_caps_ask(wanted, &cameras[cases[i].camera], cases[i].fourcc, &asked, &why);
        CHECK_MSG(failed == (cases[i].refused ? -1 : 0), "%s: %s", text, why.text);
        if (cases[i].refused)
            CHECK_MSG(strstr(why.text, cases[i].refused), "%s: %s", text, why.text);
        CHECK_MSG(asked.width == cases[i].width && asked.height == cases[i].height &&
                      fabs(asked.fps - cases[i].fps) < 1e-9,
                  "%s: %ux%u at %g", text, asked.width, asked.height, asked.fps);
        gst_caps_unref(wanted);
        g_free(text);
    }
}

static void test_stream(void)
{
    static const struct {
        const char *wanted;
        double fps;
        const char *caps, *refused; /* a part of the caps; of the sentence */
    } cases[] = {
        {"video/x-raw", 30, "format=(string)NV12, width=(int)320, height=(int)240, framerate=(fraction)30/1", NULL},
        {"video/x-raw, framerate=30000/1001", 29.97, "framerate=(fraction)30000/1001", NULL},
        {"video/x-raw, framerate=0/1", 30, "framerate=(fraction)0/1", NULL},
        {"video/x-raw, framerate=15/1", 30, NULL, "320x240 at 30 frames a second, and downstream takes"},
        {"video/x-raw, width=640", 30, NULL, "320x240"},
        {"video/x-raw, format={RGB,BGR}", 30, "format=(string)RGB", NULL},
        {"video/x-raw, format=RGB", 30, "colorimetry=(string)sRGB", NULL},
        {"video/x-raw, format=I420, framerate=[1/1,100/1]", 30, "colorimetry=(string)2:3:7:1", NULL},
    };
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
        GstCaps *wanted = gst_caps_from_string(cases[i].wanted);
        GstCaps *formats = gst_caps_from_string(PICTURE_CAPS(PICTURE_FORMATS_OUT));
        pupil_why why = {""};
        GstCaps *caps = camera_caps_of_stream(wanted, formats, 320, 240, cases[i].fps, &why);
        gchar *text = caps ? gst_caps_to_string(caps) : g_strdup(why.text);
        CHECK_MSG(!caps == !cases[i].caps && strstr(text, caps ? cases[i].caps : cases[i].refused), "%s: %s",
                  cases[i].wanted, text);
        CHECK(!caps || gst_caps_is_fixed(caps));
        gst_clear_caps(&caps);
        gst_caps_unref(formats);
        gst_caps_unref(wanted);
        g_free(text);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    gst_init(NULL, NULL);
    test_ask();
    test_stream();
    return check_end();
}

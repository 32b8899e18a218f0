#include "picture_format.h"

static const struct {
    GstVideoFormat format;
    uint32_t in, out;
} formats[] = {
    {GST_VIDEO_FORMAT_P010_10LE, PUPIL_PIXEL_P010, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_I420_10LE, PUPIL_PIXEL_I420_10, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_Y444_16LE, PUPIL_PIXEL_I444_16, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_RGB10A2_LE, PUPIL_PIXEL_RGB10A2, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_NV12, PUPIL_PIXEL_NV12, PUPIL_PIXEL_NV12},
    {GST_VIDEO_FORMAT_I420, PUPIL_PIXEL_I420, PUPIL_PIXEL_I420},
    {GST_VIDEO_FORMAT_YV12, PUPIL_PIXEL_I420, PUPIL_PIXEL_I420}, /* its components are in I420's order */
    {GST_VIDEO_FORMAT_NV21, PUPIL_PIXEL_NV21, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_NV16, PUPIL_PIXEL_NV16, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_YUY2, PUPIL_PIXEL_YUYV, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_UYVY, PUPIL_PIXEL_UYVY, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_RGBA, PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_RGBA8},
    {GST_VIDEO_FORMAT_RGBx, PUPIL_PIXEL_RGBX8, PUPIL_PIXEL_RGBA8},
    {GST_VIDEO_FORMAT_BGRx, PUPIL_PIXEL_BGRX8, PUPIL_PIXEL_BGRX8},
    {GST_VIDEO_FORMAT_RGB, PUPIL_PIXEL_RGB8, PUPIL_PIXEL_RGB8},
    {GST_VIDEO_FORMAT_BGR, PUPIL_PIXEL_BGR8, PUPIL_PIXEL_BGR8},
    {GST_VIDEO_FORMAT_GRAY16_LE, PUPIL_PIXEL_GREY16, PUPIL_PIXEL_NONE},
    {GST_VIDEO_FORMAT_GRAY8, PUPIL_PIXEL_GREY8, PUPIL_PIXEL_NONE},
};

uint32_t picture_pixel_in(GstVideoFormat format)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        if (formats[i].format == format)
            return formats[i].in;
    }
    return PUPIL_PIXEL_NONE;
}

uint32_t picture_pixel_out(GstVideoFormat format)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        if (formats[i].format == format)
            return formats[i].out;
    }
    return PUPIL_PIXEL_NONE;
}

static pupil_image describe(const GstVideoFrame *frame, uint32_t pixel, const pupil_coding *coding)
{
    pupil_image image = {.size_bytes = sizeof image,
                         .pixel = pixel,
                         .data = GST_VIDEO_FRAME_PLANE_DATA(frame, 0),
                         .stride_bytes = GST_VIDEO_FRAME_PLANE_STRIDE(frame, 0),
                         .width = (uint32_t)GST_VIDEO_FRAME_WIDTH(frame),
                         .height = (uint32_t)GST_VIDEO_FRAME_HEIGHT(frame),
                         .coding = coding};
    if (pupil_pixel_planes(pixel) > 1) { /* the plane of component 1, which is Cb in any order of planes */
        const gint plane = GST_VIDEO_FRAME_COMP_PLANE(frame, GST_VIDEO_COMP_U);
        image.chroma = GST_VIDEO_FRAME_PLANE_DATA(frame, plane);
        image.chroma_stride_bytes = GST_VIDEO_FRAME_PLANE_STRIDE(frame, plane);
    }
    if (pupil_pixel_planes(pixel) > 2) {
        const gint plane = GST_VIDEO_FRAME_COMP_PLANE(frame, GST_VIDEO_COMP_V);
        image.cr = GST_VIDEO_FRAME_PLANE_DATA(frame, plane);
        image.cr_stride_bytes = GST_VIDEO_FRAME_PLANE_STRIDE(frame, plane);
    }
    return image;
}

pupil_image_const picture_in(const GstVideoFrame *frame, const pupil_coding *coding)
{
    return pupil_image_as_const(describe(frame, picture_pixel_in(GST_VIDEO_FRAME_FORMAT(frame)), coding));
}

pupil_image picture_out(const GstVideoFrame *frame, const pupil_coding *coding)
{
    return describe(frame, picture_pixel_out(GST_VIDEO_FRAME_FORMAT(frame)), coding);
}

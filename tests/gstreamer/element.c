#include "element.h"

#include "check.h"

pupil_image picture_make(uint32_t pixel, uint32_t width, uint32_t height, int is_random)
{
    const size_t bytes = pupil_image_bytes(pixel, width, height);
    unsigned char *data = calloc(1, bytes);
    for (size_t i = 0; is_random && i < bytes; i++)
        data[i] = (unsigned char)check_random();
    if (is_random && (pixel == PUPIL_PIXEL_I420_10)) /* 10 bits in 16, as GStreamer has them */
        for (size_t i = 1; i < bytes; i += 2)
            data[i] &= 3;
    return pupil_image_of(data, width, height, pixel);
}

gchar *caps_text(const char *format, uint32_t width, uint32_t height, const char *colorimetry)
{
    return g_strdup_printf("video/x-raw, format=%s, width=%u, height=%u, framerate=30/1%s%s", format, width, height,
                           colorimetry ? ", colorimetry=" : "", colorimetry ? colorimetry : "");
}

/* Rows of the picture's k-th plane: 0 the first, 1 chroma, 2 cr. */
typedef struct rows {
    unsigned char *top;
    size_t bytes, stride;
    uint32_t count;
} rows;

static rows plane_of(const pupil_image *p, uint32_t plane)
{
    const rows first = {p->data, pupil_row_bytes(p->pixel, p->width), (size_t)p->stride_bytes, p->height};
    if (plane == 0)
        return first;
    return (rows){plane == 1 ? p->chroma : p->cr, pupil_chroma_row_bytes(p->pixel, p->width),
                  (size_t)(plane == 1 ? p->chroma_stride_bytes : p->cr_stride_bytes),
                  pupil_chroma_rows(p->pixel, p->height)};
}

/* YV12 has Cr before Cb. */
static uint32_t plane_there(const char *format, uint32_t plane)
{
    return plane && strcmp(format, "YV12") == 0 ? 3 - plane : plane;
}

GstBuffer *buffer_of(const char *format, const pupil_image *picture, uint32_t padding, GstClockTime pts)
{
    GstVideoInfo info;
    const GstVideoFormat of = gst_video_format_from_string(format);
    gst_video_info_set_format(&info, of, picture->width, picture->height);
    gsize offset[GST_VIDEO_MAX_PLANES] = {0}, bytes = 0;
    gint stride[GST_VIDEO_MAX_PLANES] = {0};
    const uint32_t planes = pupil_pixel_planes(picture->pixel);
    for (uint32_t k = 0; k < planes; k++) {
        stride[k] = GST_VIDEO_INFO_PLANE_STRIDE(&info, k) + (gint)padding;
        offset[k] = bytes;
        bytes += (gsize)stride[k] * plane_of(picture, k).count;
    }
    if (!padding) {
        bytes = GST_VIDEO_INFO_SIZE(&info);
        memcpy(offset, info.offset, sizeof offset);
    }
    GstBuffer *buffer = gst_buffer_new_allocate(NULL, bytes, NULL);
    gst_buffer_memset(buffer, 0, 0xa5, bytes);
    if (padding)
        gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, of, picture->width, picture->height, planes,
                                       offset, stride);
    for (uint32_t k = 0; k < planes; k++) {
        const rows r = plane_of(picture, k);
        const uint32_t there = plane_there(format, k);
        for (uint32_t y = 0; y < r.count; y++)
            gst_buffer_fill(buffer, offset[there] + (gsize)stride[there] * y, r.top + r.stride * y, r.bytes);
    }
    GST_BUFFER_PTS(buffer) = pts;
    GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
    return buffer;
}

int is_same(GstBuffer *buffer, const GstCaps *caps, const pupil_image *picture)
{
    GstVideoInfo info;
    GstVideoFrame frame;
    int same = 1;
    if (!gst_video_info_from_caps(&info, caps) || !gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ))
        return 0;
    const char *format = gst_video_format_to_string(GST_VIDEO_INFO_FORMAT(&info));
    for (uint32_t k = 0; k < pupil_pixel_planes(picture->pixel); k++) {
        const rows r = plane_of(picture, k);
        const uint32_t there = plane_there(format, k);
        const unsigned char *top = GST_VIDEO_FRAME_PLANE_DATA(&frame, there);
        for (uint32_t y = 0; y < r.count; y++)
            same &=
                !memcmp(top + (size_t)GST_VIDEO_FRAME_PLANE_STRIDE(&frame, there) * y, r.top + r.stride * y, r.bytes);
    }
    gst_video_frame_unmap(&frame);
    return same;
}

GstStructure *next_message(GstBus *bus)
{
    GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT);
    if (!message)
        return NULL;
    GstStructure *structure = gst_structure_copy(gst_message_get_structure(message));
    gst_message_unref(message);
    return structure;
}

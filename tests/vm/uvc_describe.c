/* uvc_describe.c: the descriptors of the camera of uvc_camera.h. Numbers in parentheses are sections of UVC 1.1. */
#include "vm/uvc_describe.h"

#include <string.h>

void uvc_put(uvc_text *t, uint32_t bytes, uint32_t value)
{
    for (uint32_t i = 0; i < bytes; i++)
        t->byte[t->length++] = (uint8_t)(value >> 8 * i);
}

void uvc_put_bytes(uvc_text *t, const int *bytes)
{
    for (; *bytes >= 0; bytes++)
        uvc_put(t, 1, (uint32_t)*bytes);
}

void uvc_describe_device(uvc_text *t)
{
    UVC_PUT(t, 18, 1, 0x00, 0x02, 0xef, 2, 1, 64);        /* USB 2.0, interface association */
    UVC_PUT(t, 0x6b, 0x1d, 0x02, 0x01, 0x00, 0x01, 1, 2); /* the Linux Foundation's number */
    UVC_PUT(t, 0, 1);
}

/* The control interface: camera (1) -> processing (2) -> USB (3); (3.7). */
static void describe_control(uvc_text *t)
{
    UVC_PUT(t, 9, 4, 0, 0, 0, 14, 1, 0, 0);
    UVC_PUT(t, 13, 0x24, 1, 0x10, 0x01, 13 + 18 + 12 + 9, 0);
    uvc_put(t, 4, 48000000);
    UVC_PUT(t, 1, 1);
    /* bits 1 to 3: the exposure mode, its priority, the time */
    UVC_PUT(t, 18, 0x24, 2, 1, 0x01, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0x0e, 0, 0);
    UVC_PUT(t, 12, 0x24, 5, 2, 1, 0, 0, 2, 0x00, 0x02, 0, 0); /* bit 9: gain */
    UVC_PUT(t, 9, 0x24, 3, 3, 0x01, 0x01, 0, 2, 0);
}

static void describe_frame(uvc_text *t, uint32_t index, uint32_t width, uint32_t height)
{
    UVC_PUT(t, 38, 0x24, 5, (int)index, 0);
    uvc_put(t, 2, width);
    uvc_put(t, 2, height);
    uvc_put(t, 4, width * height * 2 * 8 * 5);
    uvc_put(t, 4, width * height * 2 * 8 * 30);
    uvc_put(t, 4, width * height * 2);
    uvc_put(t, 4, UVC_INTERVAL);
    uvc_put(t, 1, 3); /* the number of intervals */
    uvc_put(t, 4, UVC_INTERVAL);
    uvc_put(t, 4, 2 * UVC_INTERVAL);
    uvc_put(t, 4, UVC_LONGEST);
}

/* The streaming interface: YUY2, in bulk from endpoint 1; (3.9). */
static void describe_stream(uvc_text *t)
{
    UVC_PUT(t, 9, 4, 1, 0, 1, 14, 2, 0, 0);
    UVC_PUT(t, 14, 0x24, 1, 1, 14 + 27 + 38 + 38, 0, 0x81, 0, 3, 0, 0, 0, 1, 0);
    UVC_PUT(t, 27, 0x24, 4, 1, 2, 'Y', 'U', 'Y', '2', 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71);
    UVC_PUT(t, 16, 1, 0, 0, 0, 0);
    describe_frame(t, 1, 320, 240);
    describe_frame(t, 2, 640, 480);
    UVC_PUT(t, 7, 5, 0x81, 2, 0x00, 0x02, 0);
}

void uvc_describe_configuration(uvc_text *t)
{
    UVC_PUT(t, 9, 2, 0, 0, 2, 1, 0, 0x80, 250);
    UVC_PUT(t, 8, 11, 0, 2, 14, 3, 0, 0);
    describe_control(t);
    describe_stream(t);
    t->byte[2] = (uint8_t)t->length;
    t->byte[3] = (uint8_t)(t->length >> 8);
}

int uvc_describe_string(uvc_text *t, uint32_t index)
{
    static const char *const words[] = {"", "pupil", "Simulated UVC camera"};
    if (index > 2)
        return -1;
    if (index == 0) {
        UVC_PUT(t, 4, 3, 0x09, 0x04); /* English */
        return 0;
    }
    UVC_PUT(t, 2 + 2 * (int)strlen(words[index]), 3);
    for (const char *p = words[index]; *p; p++)
        uvc_put(t, 2, (uint32_t)*p);
    return 0;
}

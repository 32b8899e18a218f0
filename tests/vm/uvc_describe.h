/* tests/vm/uvc_describe.h: the descriptors of the camera of uvc_camera.h, in USB's byte order: the lowest first. */
#ifndef PUPIL_TESTS_VM_UVC_DESCRIBE_H
#define PUPIL_TESTS_VM_UVC_DESCRIBE_H

#include <stdint.h>

#define UVC_INTERVAL 333333u /* in 100 ns: 30 frames a second; 15 and 5 are the others */
#define UVC_LONGEST  (6 * UVC_INTERVAL)

typedef struct uvc_text {
    uint8_t byte[512];
    uint32_t length;
} uvc_text;

void uvc_put(uvc_text *t, uint32_t bytes, uint32_t value);
void uvc_put_bytes(uvc_text *t, const int *bytes); /* one by one, up to a -1 */
#define UVC_PUT(t, ...) uvc_put_bytes(t, (const int[]){__VA_ARGS__, -1})

void uvc_describe_device(uvc_text *t);
void uvc_describe_configuration(uvc_text *t);
int uvc_describe_string(uvc_text *t, uint32_t index); /* -1: none */

#endif

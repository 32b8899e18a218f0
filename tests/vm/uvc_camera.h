/* tests/vm/uvc_camera.h: a USB camera in user space, which the kernel's uvcvideo drives like a real one.
 *
 * It is the far end of a USB/IP connection (the kernel's vhci_hcd) and implements USB Video Class 1.1: YUYV in bulk
 * transfers, 320x240 and 640x480 at 30, 15 and 5 frames a second, and the controls that webcams have: automatic
 * exposure (manual, aperture priority), its priority over the frame rate, exposure time in 100 us, gain in 16ths.
 *
 * Its picture is light times exposure time times gain, with a horizontal ramp of four stops, as luma: proportional to
 * light, or with sRGB's curve, as for displays. The first row has the true values of the frame.
 */
#ifndef PUPIL_TESTS_VM_UVC_CAMERA_H
#define PUPIL_TESTS_VM_UVC_CAMERA_H

#include <stdint.h>

/* A signal with a value (sigqueue): the light, as uvc_truth has it, from 0 to 15. SIGTERM: unplugged. */
#define UVC_SET_LIGHT SIGUSR1

#define UVC_STOPS 4.0 /* of the ramp, around its middle */
#define UVC_LIGHT 0.1 /* the ramp's middle at 10 ms, gain 1 and no signal */

/* The contents of the first row, in luma, 8 pixels per bit, the lowest bit first: 16 or 235. */
typedef struct uvc_truth {
    uint32_t exposure_100us; /* 16 bits */
    uint32_t gain_16ths;     /* 12 bits */
    uint32_t light;          /* 4 bits: the factor is 8^(light - 8) */
    uint32_t automatic;      /* 1 bit */
} uvc_truth;
#define UVC_TRUTH_BITS   33
#define UVC_TRUTH_PIXELS 8

#endif

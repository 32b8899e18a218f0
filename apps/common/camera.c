#include "camera.h"

#include <stdio.h>

#include "interrupt.h"
#include "refuse.h"

#define LAST_WRITE_S 10.0 /* uvcvideo gives up a control's transfer after 5 (UVC_CTRL_STREAMING_TIMEOUT) */

typedef struct first_camera {
    char *path;
    size_t bytes;
    pupil_why why; /* of the first node that could not be queried */
} first_camera;

static int seen(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *why)
{
    first_camera *first = closure;
    (void)modes;
    if (is)
        snprintf(first->path, first->bytes, "%s", is->path);
    else if (!*first->why.text)
        pupil_refuse(&first->why, "%s", why);
    return is != NULL;
}

int camera_choose(const pupil_live_system *system, const char *asked, char *device, size_t device_bytes, pupil_why *why)
{
    first_camera first = {.path = device, .bytes = device_bytes};
    snprintf(device, device_bytes, "%s", asked ? asked : "");
    if (asked)
        return 0;
    if (pupil_live_cameras(system, 0, seen, &first, why))
        return -1;
    if (*device)
        return 0;
    return pupil_refuse(why, "%s",
                        *first.why.text
                            ? first.why.text
                            : "no camera is there: no /dev/video* gives pictures; dmesg shows what the "
                              "kernel detected of one that is plugged in. Without a camera, try 'pupil replay "
                              "synth:room -o room.mp4'");
}

/* --- its controls --- */

static const pupil_source *guarded;

static void restore(void)
{
    pupil_live_restore(guarded);
}

void camera_guard(const pupil_source *source)
{
    if (source)
        guarded = source;
    interrupt_fatal(source ? restore : NULL);
}

int camera_await_last_write(void)
{
    return pupil_live_await(LAST_WRITE_S, interrupt_again);
}

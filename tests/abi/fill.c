/* fill.c: how much of each object's memory is in use. Fails if less than an eighth is free: an object's size is part of
 * the ABI, and a version with the same soname may need another field. */
#include "core/object.h"
#include "row_gain/row_gain_private.h"
#include "sensor/sensor_private.h"
#include "veil/veil_private.h"
#ifdef WITH_GLES
#include "gles/gles_private.h"
#endif

#include <stdio.h>

static int fill(const char *name, size_t used, size_t bytes)
{
    printf("%s: %zu of %zu bytes in use, %.0f %%\n", name, used, bytes, 100.0 * (double)used / (double)bytes);
    return used > bytes - bytes / 8;
}

int main(void)
{
    int full = fill("pupil_t", sizeof(pupil_object), sizeof(pupil_t));
    full |= fill("pupil_sensor", sizeof(pupil_sensor_object), sizeof(pupil_sensor));
    full |= fill("pupil_row_gain", sizeof(pupil_row_gain_object), sizeof(pupil_row_gain));
    full |= fill("pupil_veil", sizeof(veil_object), sizeof(pupil_veil));
#ifdef WITH_GLES
    full |= fill("pupil_gles", sizeof(gles_object), sizeof(pupil_gles));
#endif
    return full;
}

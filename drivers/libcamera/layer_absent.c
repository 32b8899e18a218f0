/* drivers/libcamera/layer_absent.c: in the place of libcamera where it is not built in. */
#include "layer.h"

const pupil_libcamera_layer *pupil_libcamera_library(void)
{
    return NULL;
}

const char *pupil_libcamera_version(void)
{
    return "";
}

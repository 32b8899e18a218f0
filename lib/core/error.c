#include "pupil/pupil.h"

const char *pupil_version(void)
{
    return "0.1.0";
}

const char *pupil_error_string(int code)
{
    switch (code) {
    case PUPIL_OK:
        return "no error";
    case PUPIL_ERR_NULL:
        return "a required pointer is NULL";
    case PUPIL_ERR_CONFIG:
        return "the configuration is refused; pupil_config_check names the field";
    case PUPIL_ERR_OBJECT:
        return "the object was not made by pupil_init of this version of the library";
    case PUPIL_ERR_SIZE:
        return "width and height must be 1 to 16384 pixels, equal for input and output (of a mosaic even, and equal "
               "or twice the output's)";
    case PUPIL_ERR_STRIDE:
        return "the stride must be at least as long as a row of pixels (either sign)";
    case PUPIL_ERR_ALIGNMENT:
        return "data and stride must be multiples of the sample's size";
    case PUPIL_ERR_PIXEL:
        return "this pixel format cannot be used on this side (input or output)";
    case PUPIL_ERR_ROWS:
        return "rows lie outside the frame or cut a pair of NV12 or a mosaic, or the frame ended before each row came "
               "once";
    case PUPIL_ERR_ORDER:
        return "calls out of order: begin a frame once, give its rows, then end it";
    case PUPIL_ERR_NO_EXPOSURE:
        return "no frame has been adapted to yet, so there is no exposure to map with";
    case PUPIL_ERR_NO_HISTOGRAM:
        return "these statistics have no histogram, which a quantile or a trimmed mean needs";
    case PUPIL_ERR_VALUE:
        return "an argument is not a number or outside its range";
    case PUPIL_ERR_STATS:
        return "these statistics cannot come from metering, or belong to another frame";
    case PUPIL_ERR_CODING:
        return "the image's coding is refused; pupil_coding_check names the field";
    case PUPIL_ERR_GLES_ABSENT:
        return "this library was built without OpenGL ES";
    case PUPIL_ERR_GLES_VERSION:
        return "the context lacks the version of OpenGL ES, a function or an extension that is needed";
    case PUPIL_ERR_GLES_SHADER:
        return "the OpenGL ES driver refuses a shader";
    case PUPIL_ERR_GLES_MEMORY:
        return "the OpenGL ES driver is out of memory";
    case PUPIL_ERR_GLES_CONTEXT:
        return "no OpenGL ES context is current in this thread, or not the one that the object was made in";
    case PUPIL_ERR_GLES_LOST:
        return "the OpenGL ES context is lost: a new one, and a new object in it, can go on from the adapted level";
    case PUPIL_ERR_GLES:
        return "an error of OpenGL ES that should not be";
    default:
        return "not an error code of this version of the library";
    }
}

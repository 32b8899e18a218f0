#include "pupil/pupil.h"

const char *pupil_version(void)
{
    return "0.2.0";
}

const char *pupil_error_string(int code)
{
    static const char *const sentence[] = {
        [-PUPIL_OK] = "no error",
        [-PUPIL_ERR_NULL] =
            "a required pointer is NULL: the object, an image, its data, chroma or cr, or where a result goes; "
            "without a picture there is pupil_meter",
        [-PUPIL_ERR_CONFIG] =
            "the configuration is refused; the check of its header, such as pupil_config_check, names the field",
        [-PUPIL_ERR_OBJECT] =
            "the object was not made by this version of the library: by pupil_init, or the init of its header",
        [-PUPIL_ERR_SIZE] =
            "width and height must be 1 to 16384 pixels, equal for input and output (of a mosaic even, of packed "
            "10 bits a width of a multiple of 4, and equal or twice the output's)",
        [-PUPIL_ERR_STRIDE] =
            "stride_bytes must be at least pupil_row_bytes, chroma_stride_bytes and cr_stride_bytes at least "
            "pupil_chroma_row_bytes (either sign)",
        [-PUPIL_ERR_ALIGNMENT] =
            "data, chroma, cr and their strides must be multiples of the sample's size (float and RGB10A2 4 bytes, "
            "half and more than 8 bits 2)",
        [-PUPIL_ERR_PIXEL] =
            "the input's pixel format cannot be read here; on the CPU every format of pupil/image.h can",
        [-PUPIL_ERR_ROWS] =
            "rows are outside the frame or cut a pair of 4:2:0 or a mosaic, or the frame ended before each row came "
            "once",
        [-PUPIL_ERR_ORDER] = "calls out of order: begin a frame once, give its rows, then end it",
        [-PUPIL_ERR_NO_EXPOSURE] = "no frame has been adapted to yet, so there is no exposure to map with",
        [-PUPIL_ERR_NO_HISTOGRAM] = "these statistics have no histogram, which a quantile or a trimmed mean needs",
        [-PUPIL_ERR_VALUE] = "an argument is not a number or outside its range",
        [-PUPIL_ERR_STATS] = "these statistics cannot come from metering, or belong to another frame",
        [-PUPIL_ERR_CODING] = "the image's coding is refused; pupil_coding_check names the field",
        [-PUPIL_ERR_GLES_ABSENT] = "this library was built without OpenGL ES",
        [-PUPIL_ERR_GLES_VERSION] =
            "the context lacks the version of OpenGL ES, a function or an extension that is needed",
        [-PUPIL_ERR_GLES_SHADER] = "the OpenGL ES driver refuses a shader",
        [-PUPIL_ERR_GLES_MEMORY] = "the OpenGL ES driver is out of memory",
        [-PUPIL_ERR_GLES_CONTEXT] =
            "no OpenGL ES context is current in this thread, or not the one that the object was made in",
        [-PUPIL_ERR_GLES_LOST] =
            "the OpenGL ES context is lost: a new one, and a new object in it, can continue from the adapted level",
        [-PUPIL_ERR_GLES] = "an error of OpenGL ES that should not be",
        [-PUPIL_ERR_SIZE_BYTES] =
            "size_bytes of a struct is not one that any version has had, or it covers a field that is set and that "
            "this version of the library does not know",
        [-PUPIL_ERR_PIXEL_OUT] = "the output's pixel format cannot be written; RGBA8, RGB8, BGRX8, BGR8, NV12, I420, "
                                 "RGBA32F, RGB32F, BGR32F, RGBA16F and RGB16F can",
        [-PUPIL_ERR_NO_LIGHT] =
            "these statistics have no such value: no pixel was metered, or, of pupil_stats_grey_world, a channel has "
            "no light, or the frame was no mosaic metered with config.grey_world",
    };
    if (code > 0 || code <= -(int)(sizeof sentence / sizeof sentence[0]))
        return "not an error code of this version of the library";
    return sentence[-code];
}

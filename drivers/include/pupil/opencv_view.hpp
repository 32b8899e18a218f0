/* pupil/opencv_view.hpp: the memory of a cv::Mat as an image of libpupil, without a copy. pupil/opencv.hpp says how the
 * formats are chosen, and includes this.
 */
#ifndef PUPIL_OPENCV_VIEW_HPP
#define PUPIL_OPENCV_VIEW_HPP

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

#include "pupil/image.h"

namespace pupil_cv
{

namespace detail
{

struct Layout {
    int type;
    int rows, of; /* the Mat has `rows` rows for each `of` of the picture */
};

inline Layout plain(int type)
{
    return Layout{type, 1, 1};
}

/* How a format is laid out in a Mat; type -1: there is no such format. */
inline Layout layout_of(uint32_t pixel)
{
    switch (pixel) {
    case PUPIL_PIXEL_RGBA32F:
        return plain(CV_32FC4);
    case PUPIL_PIXEL_RGB32F:
    case PUPIL_PIXEL_BGR32F:
        return plain(CV_32FC3);
    case PUPIL_PIXEL_RGBA16F:
        return plain(CV_16FC4);
    case PUPIL_PIXEL_RGB16F:
        return plain(CV_16FC3);
    case PUPIL_PIXEL_RGBA16:
        return plain(CV_16UC4);
    case PUPIL_PIXEL_RGB16:
        return plain(CV_16UC3);
    case PUPIL_PIXEL_RGB8:
    case PUPIL_PIXEL_BGR8:
        return plain(CV_8UC3);
    case PUPIL_PIXEL_RGB10A2:
        return plain(CV_32SC1);
    case PUPIL_PIXEL_NV16:
        return Layout{CV_8UC1, 2, 1};
    case PUPIL_PIXEL_P010:
    case PUPIL_PIXEL_I420_10:
        return Layout{CV_16UC1, 3, 2};
    case PUPIL_PIXEL_I444_16:
        return Layout{CV_16UC1, 3, 1};
    default:
        break;
    }
    if (pupil_pixel_planes(pixel) > 1)
        return Layout{CV_8UC1, 3, 2}; /* NV12, NV21, I420 */
    if (pupil_pixel_bits(pixel))      /* grey and mosaics; packed ones as bytes */
        return plain(pupil_pixel_bytes(pixel) == 2 ? CV_16UC1 : CV_8UC1);
    const size_t bytes = pupil_pixel_bytes(pixel); /* RGBA8 and the like; YUYV */
    return plain(bytes == 4 ? CV_8UC4 : bytes == 2 ? CV_8UC2 : -1);
}

inline void refuse(const std::string &sentence)
{
    CV_Error(cv::Error::StsUnsupportedFormat, "pupil: " + sentence);
}

/* What to do about a Mat that no format of pupil fits. */
inline std::string instead_of(int type)
{
    const int depth = CV_MAT_DEPTH(type), channels = CV_MAT_CN(type);
    if (type == CV_8UC2)
        return "name its format: PUPIL_PIXEL_YUYV or PUPIL_PIXEL_UYVY";
    if (depth == CV_32F && channels == 1)
        return "of grey floats use cv::cvtColor(mat, mat, cv::COLOR_GRAY2BGR)";
    if (depth == CV_32F && channels == 4)
        return "use cv::cvtColor(mat, mat, cv::COLOR_BGRA2BGR), or, if red is first, name PUPIL_PIXEL_RGBA32F";
    if ((depth == CV_16U || depth == CV_16F) && (channels == 3 || channels == 4))
        return "blue first it cannot be read: use mat.convertTo(mat, CV_32F" +
               std::string(depth == CV_16U ? ", 1 / 65535.0" : "") + "), or, if red is first, name PUPIL_PIXEL_RGB" +
               (channels == 4 ? "A" : "") + "16" + (depth == CV_16F ? "F" : "");
    if (channels == 1 || channels == 3)
        return "use mat.convertTo(mat, CV_32F) with a factor, after which 1 is white, and three channels";
    return "a picture has one, three or four channels";
}

inline uint32_t pixel_of(int type)
{
    switch (type) {
    case CV_8UC3:
        return PUPIL_PIXEL_BGR8;
    case CV_8UC4:
        return PUPIL_PIXEL_BGRX8;
    case CV_32FC3:
        return PUPIL_PIXEL_BGR32F;
    case CV_8UC1:
        return PUPIL_PIXEL_GREY8;
    case CV_16UC1:
        return PUPIL_PIXEL_GREY16;
    default:
        return PUPIL_PIXEL_NONE;
    }
}

/* Columns of the picture. */
inline int width_of(const cv::Mat &mat, uint32_t pixel, int width)
{
    const uint32_t bits = pupil_pixel_bits(pixel);
    int columns = mat.cols;
    if (bits && !pupil_pixel_bytes(pixel)) /* packed: 5 bytes for 4 pixels, 3 for 2 */
        columns = bits == 10 ? columns / 5 * 4 : columns / 3 * 2;
    if (width < 0 || width > columns)
        refuse("a Mat of " + std::to_string(mat.cols) + " columns has no " + std::to_string(width) + " pixels a row");
    return width ? width : columns;
}

/* The image of a Mat that is read or written; `data` is the caller's, because a const Mat has const data. */
inline pupil_image image_of(const cv::Mat &mat, void *data, uint32_t pixel, int given_width)
{
    if (mat.empty() || mat.dims != 2)
        refuse(mat.empty() ? "the Mat is empty" : "the Mat has " + std::to_string(mat.dims) + " dimensions, not 2");
    const uint32_t named = pixel == PUPIL_PIXEL_NONE ? pixel_of(mat.type()) : pixel;
    if (named == PUPIL_PIXEL_NONE)
        refuse("a Mat of " + cv::typeToString(mat.type()) + " has no format that pupil can guess; " +
               instead_of(mat.type()));
    const Layout layout = layout_of(named);
    if (layout.type < 0)
        refuse("there is no pixel format " + std::to_string(named) + " (pupil_pixel in pupil/image.h)");
    if (mat.type() != layout.type)
        refuse("the named format needs a Mat of " + cv::typeToString(layout.type) + ", not of " +
               cv::typeToString(mat.type()));
    if (mat.rows % layout.rows)
        refuse("the planes of the named format are in one Mat, whose rows are " + std::to_string(layout.rows) + "/" +
               std::to_string(layout.of) + " of the picture's; it has " + std::to_string(mat.rows));
    const uint32_t planes = pupil_pixel_planes(named);
    if (planes == 3 && !mat.isContinuous())
        refuse("three planes in one Mat must be continuous: use mat.clone()");
    if (planes > 1 && named != PUPIL_PIXEL_I444_16 && mat.cols % 2)
        refuse("the planes of the named format need an even number of columns in one Mat");
    const int height = mat.rows / layout.rows * layout.of, width = width_of(mat, named, given_width);
    const int columns = planes > 1 ? mat.cols : width; /* the chroma comes after whole rows, padded or not */
    pupil_image image = pupil_image_of(data, static_cast<uint32_t>(columns), static_cast<uint32_t>(height), named);
    image.width = static_cast<uint32_t>(width);
    if (mat.rows > 1)
        image.stride_bytes = static_cast<std::ptrdiff_t>(mat.step[0]);
    if (planes == 2) {
        image.chroma = static_cast<unsigned char *>(data) + mat.step[0] * static_cast<size_t>(height);
        image.chroma_stride_bytes = image.stride_bytes;
    }
    return image;
}

/* Grey of files and of OpenCV's own conversions is coded; a sensor's, whose format is named, is linear. */
inline pupil_coding display_grey()
{
    pupil_coding coding = pupil_coding();
    coding.size_bytes = sizeof coding;
    coding.light = PUPIL_LIGHT_SRGB;
    return coding;
}

inline bool overlap(const cv::Mat &a, const cv::Mat &b)
{
    return a.datastart && b.datastart && a.data < b.dataend && b.data < a.dataend;
}

} // namespace detail

/* Throws a cv::Exception with pupil's sentence, unless `error` is PUPIL_OK. */
inline void check(int error)
{
    if (error != PUPIL_OK)
        CV_Error(cv::Error::StsBadArg, std::string("pupil: ") + pupil_error_string(error));
}

/* The Mat as an input of libpupil's functions. It must live as long as the view; coding too. */
inline pupil_image_const view(const cv::Mat &mat, uint32_t pixel = PUPIL_PIXEL_NONE,
                              const pupil_coding *coding = nullptr, int width = 0)
{
    static const pupil_coding coded = detail::display_grey();
    pupil_image image = detail::image_of(mat, mat.data, pixel, width);
    const char *why = nullptr;
    if (coding && pupil_coding_check(coding, image.pixel, &why) != PUPIL_OK)
        detail::refuse(why);
    image.coding = coding || pixel != PUPIL_PIXEL_NONE || image.pixel != PUPIL_PIXEL_GREY8 ? coding : &coded;
    return pupil_image_as_const(image);
}

/* The Mat as an output. */
inline pupil_image view_out(cv::Mat &mat, uint32_t pixel = PUPIL_PIXEL_NONE, const pupil_coding *coding = nullptr)
{
    pupil_image image = detail::image_of(mat, mat.data, pixel, 0);
    image.coding = coding;
    return image;
}

} // namespace pupil_cv

#endif

/* pupil/opencv.hpp: pupil in programs that use OpenCV 4. Header only, C++11 or newer; link libpupil, and of OpenCV core
 * (and photo for createTonemapPupil, which needs its headers only where it is used).
 *
 *     pupil_cv::Pupil pupil;
 *     for each frame: pupil.process(frame, picture);        // any Mat in, CV_8UC3 out
 *
 *     cv::Ptr<cv::Tonemap> tonemap = pupil_cv::createTonemapPupil();
 *     tonemap->process(hdr, ldr);                           // CV_32FC3 from 0 to 1, as OpenCV's own operators give
 *
 * A Mat is read where it is, without a copy: also a region of a larger one. Its depth and channels say the format, blue
 * first, as OpenCV has it:
 *
 *     CV_8UC3, CV_8UC4 (the fourth is ignored)   coded as sRGB
 *     CV_32FC3                                   linear light
 *     CV_8UC1                                    grey, coded as sRGB
 *     CV_16UC1                                   grey, linear
 *
 * Every other format of pupil/image.h is named (Given::pixel): red first, YUYV, NV12 and I420 as cv::cvtColor has them
 * (Y' and chroma in one Mat of 3/2 the rows), raw mosaics. What cannot be read throws a cv::Exception that says what
 * would be right.
 *
 * Threads: an object may be used by one thread at a time. Objects are values: a copy continues with the same bits.
 */
#ifndef PUPIL_OPENCV_HPP
#define PUPIL_OPENCV_HPP

#include <chrono>
#include <cstdint>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/photo.hpp>

#include "pupil/pupil.h"

namespace pupil_cv
{

/* --- a Mat as an image --- */

/* What a Mat does not say. */
struct Given {
    uint32_t pixel = PUPIL_PIXEL_NONE;    /* a pupil_pixel; NONE: by depth and channels */
    const pupil_coding *coding = nullptr; /* of Y'CbCr, grey and mosaics: pupil/coding.h */
    int width = 0; /* of packed mosaics and grey, whose Mat has bytes as columns: pixels; 0: all that fit */
    const pupil_frame_info *info = nullptr;
    int type = CV_8UC3; /* of the picture: CV_8UC3 or CV_8UC4, coded for a display, or CV_32FC3, linear from 0 to 1 */
    bool half = false;  /* a mosaic to a picture of half its size */
};

namespace detail
{

struct Layout {
    int type;
    int rows, of; /* the Mat has so many rows for each `of` of the picture */
};

inline Layout plain(int type)
{
    return Layout{type, 1, 1};
}

/* How a format is in a Mat; type -1: there is no such format. */
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
    if (planes > 1 && mat.cols % 2)
        refuse("the planes of the named format need an even number of columns in one Mat");
    const int height = mat.rows / layout.rows * layout.of, width = width_of(mat, named, given_width);
    pupil_image image = pupil_image_of(data, static_cast<uint32_t>(width), static_cast<uint32_t>(height), named);
    if (mat.rows > 1)
        image.stride_bytes = static_cast<std::ptrdiff_t>(mat.step[0]);
    if (planes == 2) {
        image.chroma = static_cast<unsigned char *>(data) + mat.step[0] * static_cast<size_t>(height);
        image.chroma_stride_bytes = image.stride_bytes;
    }
    return image;
}

/* Files and OpenCV's own conversions have grey that is coded; sensors, which are named, have linear grey. */
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

inline pupil_config defaults()
{
    pupil_config config;
    pupil_config_default(&config);
    return config;
}

/* --- a stream of frames --- */

class Pupil
{
  public:
    explicit Pupil(const pupil_config &config = defaults())
    {
        retune_with(config, pupil_init);
    }

    /* New settings from the next frame on; the adapted level is kept. */
    void retune(const pupil_config &config)
    {
        retune_with(config, pupil_retune);
    }

    /* Forgets every frame; the next one sets the level at once. */
    void reset()
    {
        check(pupil_reset(&object_));
    }

    /* Meters, adapts and maps a frame. `picture` is made with given.type, unless it has that type and size already. It
     * may be the frame itself, which is then copied first. */
    void process(cv::InputArray frame, cv::OutputArray picture, const Given &given = Given())
    {
        cv::Mat in = frame.getMat();
        pupil_image_const from = view(in, given.pixel, given.coding, given.width);
        if (given.type != CV_8UC3 && given.type != CV_8UC4 && given.type != CV_32FC3)
            detail::refuse("a picture can be CV_8UC3, CV_8UC4 or CV_32FC3, not " + cv::typeToString(given.type) +
                           "; other formats are written by pupil_process to view_out(mat, pixel)");
        const int divisor = given.half ? 2 : 1;
        picture.create(static_cast<int>(from.height) / divisor, static_cast<int>(from.width) / divisor, given.type);
        cv::Mat out = picture.getMat();
        if (detail::overlap(in, out)) {
            in = in.clone();
            from = view(in, given.pixel, given.coding, given.width);
        }
        const pupil_image to = view_out(out);
        check(pupil_process(&object_, &from, given.info, &to));
    }

    /* The same without a picture. */
    void meter(cv::InputArray frame, const Given &given = Given())
    {
        const cv::Mat in = frame.getMat();
        const pupil_image_const from = view(in, given.pixel, given.coding, given.width);
        check(pupil_meter(&object_, &from, given.info));
    }

    pupil_exposure exposure() const
    {
        pupil_exposure exposure;
        check(pupil_get_exposure(&object_, &exposure));
        return exposure;
    }

    /* For the other functions of pupil/pupil.h. */
    pupil_t *get()
    {
        return &object_;
    }

  private:
    void retune_with(const pupil_config &config, int (*function)(pupil_t *, const pupil_config *))
    {
        const char *why = nullptr;
        if (pupil_config_check(&config, &why) != PUPIL_OK)
            CV_Error(cv::Error::StsBadArg, std::string("pupil: ") + why);
        check(function(&object_, &config));
    }

    pupil_t object_;
};

/* --- in the place of OpenCV's operators --- */

/* A cv::Tonemap: CV_32FC3 out, from 0 to 1, linear for a gamma of 1. Pictures that follow each other are frames of a
 * video, 1/30 s apart: the level moves from one to the next. Call clear() between stills. */
class TonemapPupil CV_FINAL : public cv::Tonemap
{
  public:
    TonemapPupil(float gamma, const pupil_config &config) : pupil_(config), gamma_(1.0f)
    {
        setGamma(gamma);
    }

    void process(cv::InputArray src, cv::OutputArray dst) CV_OVERRIDE
    {
        Given given;
        given.type = CV_32FC3;
        pupil_.process(src, dst, given);
        if (gamma_ < 1.0f || gamma_ > 1.0f)
            cv::pow(dst, 1.0 / static_cast<double>(gamma_), dst);
    }

    float getGamma() const CV_OVERRIDE
    {
        return gamma_;
    }

    void setGamma(float gamma) CV_OVERRIDE
    {
        if (!(gamma > 0.0f))
            CV_Error(cv::Error::StsOutOfRange, "pupil: gamma must be above 0");
        gamma_ = gamma;
    }

    /* The next picture is adapted to at once. */
    void clear() CV_OVERRIDE
    {
        pupil_.reset();
    }

    cv::String getDefaultName() const CV_OVERRIDE
    {
        return "TonemapPupil";
    }

    Pupil &pupil()
    {
        return pupil_;
    }

  private:
    Pupil pupil_;
    float gamma_;
};

inline cv::Ptr<TonemapPupil> createTonemapPupil(float gamma = 1.0f, const pupil_config &config = defaults())
{
    return cv::makePtr<TonemapPupil>(gamma, config);
}

/* --- a video or a camera --- */

/* A loop around cv::VideoCapture:
 *
 *     cv::VideoCapture capture(0);
 *     pupil_cv::Video<cv::VideoCapture> video(capture);
 *     while (video.read(picture)) cv::imshow("pupil", picture);
 *
 * Time is CAP_PROP_POS_MSEC where it advances (of a file its own time, of V4L2 the driver's), else when frames arrive.
 */
template <class Capture> class Video
{
  public:
    explicit Video(Capture &capture, const pupil_config &config = defaults())
        : capture_(capture), pupil_(config), info_(), position_ms_(0.0), arrived_(std::chrono::steady_clock::now())
    {
        info_.size_bytes = sizeof info_;
        info_.timestamp_ns = 1; /* 0 would be unknown */
    }

    /* The next frame, mapped; false where there is none. Given::info is not read. */
    bool read(cv::OutputArray picture, Given given = Given())
    {
        if (!capture_.read(frame_))
            return false;
        const int pos_msec = 0; /* cv::CAP_PROP_POS_MSEC, without opencv2/videoio.hpp */
        const double position_ms = capture_.get(pos_msec), step_ms = position_ms - position_ms_;
        const std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now();
        const double waited_ms = std::chrono::duration<double, std::milli>(now - arrived_).count();
        const bool advances = step_ms > 0.0 && step_ms < 60e3 && position_ms_ > 0.0;
        if (frame_count_++)
            info_.timestamp_ns += static_cast<int64_t>(1e6 * (advances ? step_ms : waited_ms));
        position_ms_ = position_ms;
        arrived_ = now;
        given.info = &info_;
        pupil_.process(frame_, picture, given);
        return true;
    }

    /* The frame before it was mapped. */
    const cv::Mat &frame() const
    {
        return frame_;
    }

    const pupil_frame_info &info() const
    {
        return info_;
    }

    Pupil &pupil()
    {
        return pupil_;
    }

    /* What this loop cannot know, for a log. */
    static const char *unknown()
    {
        return "cv::VideoCapture reports no frame numbers, so lost and stale frames are not noticed; and neither the "
               "exposure time nor the gain of a frame, so the level is that of the picture, not of the scene, and the "
               "camera's own automatic exposure shows as changing light. To control exposure and gain of the same "
               "/dev/video node, use pupil-camera: pupil/camera_loop.h, pkg-config pupil-camera, or in CMake "
               "find_package(pupil) and pupil::pupil_camera. OpenCV's own manual exposure of V4L2 is "
               "CAP_PROP_AUTO_EXPOSURE = 1";
    }

  private:
    Capture &capture_;
    Pupil pupil_;
    cv::Mat frame_;
    pupil_frame_info info_;
    double position_ms_;
    std::chrono::steady_clock::time_point arrived_;
    uint64_t frame_count_ = 0;
};

} // namespace pupil_cv

#endif

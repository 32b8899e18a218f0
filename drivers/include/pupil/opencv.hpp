/* pupil/opencv.hpp: pupil in programs that use OpenCV 4. Header only, C++11 or newer; link libpupil, and
 * opencv_core and opencv_photo.
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

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/photo.hpp>

#include "pupil/opencv_view.hpp"
#include "pupil/pupil.h"

namespace pupil_cv
{

inline pupil_config defaults()
{
    pupil_config config;
    pupil_config_default(&config);
    return config;
}

/* --- a stream of frames --- */

/* What a Mat does not say. */
struct Given {
    uint32_t pixel = PUPIL_PIXEL_NONE;    /* a pupil_pixel; NONE: by depth and channels */
    const pupil_coding *coding = nullptr; /* of Y'CbCr, grey and mosaics: pupil/coding.h */
    int width = 0; /* pixels, where rows are padded, or of packed formats, whose columns are bytes; 0: all that fit */
    const pupil_frame_info *info = nullptr;
    int type = CV_8UC3; /* of the picture: CV_8UC3 or CV_8UC4, coded for a display, or CV_32FC3, linear from 0 to 1 */
    bool half = false;  /* a mosaic to a picture of half its size */
};

class Pupil
{
  public:
    explicit Pupil(const pupil_config &config = defaults()) : fused_(false)
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

    /* Meters, adapts and maps a frame, by as many threads as OpenCV uses (cv::setNumThreads). `picture` is made with
     * given.type, unless it has that type and size already. It may be the frame itself, which is then copied first. */
    void process(cv::InputArray frame, cv::OutputArray picture, const Given &given = Given())
    {
        cv::Mat in = frame.getMat();
        pupil_image_const from = view(in, given.pixel, given.coding, given.width);
        if (given.type != CV_8UC3 && given.type != CV_8UC4 && given.type != CV_32FC3)
            detail::refuse("a picture can be CV_8UC3, CV_8UC4 or CV_32FC3, not " + cv::typeToString(given.type) +
                           "; other formats are written by pupil_process to view_out(mat, pixel)");
        if (given.half && !pupil_pixel_is_mosaic(from.pixel))
            detail::refuse("only mosaics are mapped to half their size");
        const int divisor = given.half ? 2 : 1;
        picture.create(static_cast<int>(from.height) / divisor, static_cast<int>(from.width) / divisor, given.type);
        cv::Mat out = picture.getMat();
        if (detail::overlap(in, out)) {
            in = in.clone();
            from = view(in, given.pixel, given.coding, given.width);
        }
        const pupil_image to = view_out(out);
        const int groups = std::min(cv::getNumThreads(), static_cast<int>(from.height / ROWS_A_GROUP));
        if (groups < 2 || given.half || fused_)
            check(pupil_process(&object_, &from, given.info, &to));
        else
            process_in(groups, from, to, given.info);
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

    /* For the other functions of pupil/pupil.h; but pupil_get_stats does not cover frames that several threads metered.
     */
    pupil_t *get()
    {
        return &object_;
    }

  private:
    /* With fewer rows another thread does not pay; a multiple of 4, as mosaics and planes need (pupil/image.h). */
    enum { ROWS_A_GROUP = 64 };

    /* Row of the frame that a group begins with. */
    static uint32_t first_of(int group, int groups, uint32_t height)
    {
        return static_cast<uint32_t>(static_cast<uint64_t>(height) * static_cast<uint64_t>(group) /
                                     static_cast<uint64_t>(groups) / 4 * 4);
    }

    /* What pupil_process does, by OpenCV's threads. Sums of rows are exact, so the bits are the same. */
    void process_in(int groups, const pupil_image_const &from, const pupil_image &to, const pupil_frame_info *info)
    {
        std::vector<pupil_stats> stats(static_cast<size_t>(groups));
        std::vector<int> errors(static_cast<size_t>(groups));
        const auto rows_of = [&](int group, uint32_t &first) {
            first = first_of(group, groups, from.height);
            const uint32_t next = group + 1 < groups ? first_of(group + 1, groups, from.height) : from.height;
            return pupil_image_rows(from, first, next - first);
        };
        const auto each = [&](const std::function<int(int)> &work) {
            cv::parallel_for_(cv::Range(0, groups), [&](const cv::Range &range) {
                for (int group = range.start; group < range.end; group++)
                    errors[static_cast<size_t>(group)] = work(group);
            });
            for (int error : errors)
                check(error);
        };
        each([&](int group) {
            uint32_t first;
            const pupil_image_const rows = rows_of(group, first);
            pupil_stats_clear(&stats[static_cast<size_t>(group)]);
            return pupil_meter_rows(&object_, &rows, first, from.height, &stats[static_cast<size_t>(group)]);
        });
        for (size_t group = 1; group < stats.size(); group++)
            check(pupil_stats_add(&stats[0], &stats[group]));
        check(pupil_adapt(&object_, &stats[0], info));
        pupil_curve curve;
        if (pupil_get_curve(&object_, info, &curve) != PUPIL_OK)
            check(pupil_curve_before_light(&object_, &curve));
        each([&](int group) {
            pupil_curve of_rows = curve;
            const pupil_image_const rows = rows_of(group, of_rows.first_row);
            const pupil_image out = pupil_image_out_rows(to, of_rows.first_row, rows.height);
            return pupil_map_rows(&object_, &of_rows, &rows, &out);
        });
    }

    void retune_with(const pupil_config &config, int (*function)(pupil_t *, const pupil_config *))
    {
        const char *why = nullptr;
        if (pupil_config_check(&config, &why) != PUPIL_OK)
            CV_Error(cv::Error::StsBadArg, std::string("pupil: ") + why);
        check(function(&object_, &config));
        fused_ = config.order == PUPIL_ORDER_FUSED;
    }

    pupil_t object_;
    bool fused_;
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
 *     cv::VideoCapture capture(0, cv::CAP_V4L2); // with GStreamer, OpenCV's default, frames have no times
 *     pupil_cv::Video<cv::VideoCapture> video(capture);
 *     while (video.read(picture)) cv::imshow("pupil", picture);
 *
 * Time is CAP_PROP_POS_MSEC if it advances (a file's own time, or V4L2's from the driver), else when frames arrive.
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
        const bool advances = step_ms > 0.0 && step_ms < 60e3 && position_ms_ >= 0.0; /* a file begins at 0 */
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

/* OpenCV's Reinhard (Reinhard and Devlin 2005, without local adaptation) and convertTo: a fresh object for each frame,
 * as the object's users make one. */
#include "peers.h"

#include "refuse.h"
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/photo.hpp>

namespace
{

struct opencv {
    cv::Mat in, mapped, out;
    bool failed;
};

void *open_opencv(const float *rgba, uint32_t width, uint32_t height, pupil_why *why)
try {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR); // it warns of its own use of itself
    cv::setNumThreads(1);
    opencv *o = new opencv{cv::Mat(int(height), int(width), CV_32FC3), {}, {}, false};
    float *to = o->in.ptr<float>();
    for (size_t i = 0, pixels = size_t(width) * height; i < pixels; i++)
        for (size_t k = 0; k < 3; k++)
            to[3 * i + k] = rgba[4 * i + k];
    return o;
} catch (const std::exception &e) {
    pupil_refuse(why, "%s", e.what());
    return nullptr;
}

void run_opencv(void *state)
{
    opencv *o = static_cast<opencv *>(state);
    try {
        cv::createTonemapReinhard(2.2f)->process(o->in, o->mapped);
        o->mapped.convertTo(o->out, CV_8U, 255.0);
    } catch (const std::exception &) {
        o->failed = true;
    }
}

double mean_opencv(const void *state)
{
    const opencv *o = static_cast<const opencv *>(state);
    return o->failed || o->out.empty() ? -1.0 : cv::mean(o->out)[1];
}

void close_opencv(void *state)
{
    delete static_cast<opencv *>(state);
}

} // namespace

const bench_peer bench_peer_opencv = {
    "opencv",
    "rgb8",
    "TonemapReinhard(2.2), a fresh object a frame, and convertTo 8U: two means, one power a sample; no white point",
    open_opencv,
    run_opencv,
    mean_opencv,
    close_opencv};

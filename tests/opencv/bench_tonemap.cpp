/* bench_tonemap: createTonemapPupil and OpenCV's createTonemapReinhard alternate on the same frame of 1920 x 1080, from
 * CV_32FC3 to CV_32FC3, each with its defaults; and for a display, to CV_8UC3: pupil_cv::Pupil, and Reinhard with a
 * gamma of 2.2 and convertTo. Fails if OpenCV's takes less than 4 times as long. */
#include "pupil/opencv.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

static double seconds(const std::function<void()> &call)
{
    const int64 begin = cv::getTickCount();
    call();
    return static_cast<double>(cv::getTickCount() - begin) / cv::getTickFrequency();
}

/* How many times as long OpenCV's takes, by the minimum times, because other programs on the machine only add. */
static double compare(const char *what, int threads, const std::function<void()> &pupil,
                      const std::function<void()> &opencv)
{
    double mine = 1e9, theirs = 1e9;
    cv::setNumThreads(threads);
    for (int turn = 0; turn < 9; turn++) {
        mine = std::min(mine, seconds(pupil));
        theirs = std::min(theirs, seconds(opencv));
    }
    std::printf("%s, %d threads: pupil %.1f ms, Reinhard %.1f ms, ratio %.1f\n", what, threads, 1e3 * mine,
                1e3 * theirs, theirs / mine);
    return theirs / mine;
}

/* 12 stops of smooth light in mild colours, with 5 % of noise. Independent noise in each channel is no picture: most of
 * its colours are beyond the display's gamut, where pupil takes three times as long. */
static cv::Mat scene()
{
    cv::RNG random(23);
    cv::Mat stops(9, 16, CV_32FC1), colour(9, 16, CV_32FC3), noise(1080, 1920, CV_32FC3), frame;
    random.fill(stops, cv::RNG::UNIFORM, -6.0, 6.0);
    random.fill(colour, cv::RNG::UNIFORM, -0.2, 0.2);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 0.05);
    cv::cvtColor(stops, stops, cv::COLOR_GRAY2BGR);
    cv::resize(cv::Mat(stops * 0.6931 + colour), frame, noise.size(), 0, 0, cv::INTER_LINEAR);
    cv::exp(frame + noise, frame);
    return frame;
}

int main()
{
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR); /* OpenCV warns about its own code */
    const cv::Mat frame = scene();
    cv::Mat mine, theirs, codes;
    const cv::Ptr<cv::Tonemap> pupil = pupil_cv::createTonemapPupil(), opencv = cv::createTonemapReinhard(),
                               coded = cv::createTonemapReinhard(2.2f);
    pupil_cv::Pupil display;
    double least = 1e9;
    for (int threads : {1, 2}) {
        least = std::min(least, compare(
                                    "floats, defaults", threads, [&] { pupil->process(frame, mine); },
                                    [&] { opencv->process(frame, theirs); }));
        least = std::min(least, compare(
                                    "8 bits for a display", threads, [&] { display.process(frame, codes); },
                                    [&] {
                                        coded->process(frame, theirs);
                                        theirs.convertTo(codes, CV_8U, 255.0);
                                    }));
    }
    return least > 4.0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* bench_tonemap: createTonemapPupil and OpenCV's createTonemapReinhard in turns on the same frame of 1920 x 1080, both
 * from CV_32FC3 to CV_32FC3, each with its defaults. */
#include "pupil/opencv.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>
#include <vector>

static double seconds(cv::Tonemap &tonemap, const cv::Mat &frame, cv::Mat &picture)
{
    const int64 begin = cv::getTickCount();
    tonemap.process(frame, picture);
    return static_cast<double>(cv::getTickCount() - begin) / cv::getTickFrequency();
}

static double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

static double compare(const cv::Mat &frame, int threads, int turns)
{
    cv::Mat of_pupil, of_opencv;
    const cv::Ptr<cv::Tonemap> pupil = pupil_cv::createTonemapPupil(), opencv = cv::createTonemapReinhard();
    std::vector<double> mine, theirs, ratio;
    cv::setNumThreads(threads);
    for (int turn = 0; turn < turns; turn++) {
        mine.push_back(seconds(*pupil, frame, of_pupil));
        theirs.push_back(seconds(*opencv, frame, of_opencv));
        ratio.push_back(theirs.back() / mine.back());
    }
    std::printf(
        "%d threads of OpenCV, one of pupil: pupil %.1f ms, Reinhard %.1f ms, ratio %.1f (medians of %d turns)\n",
        threads, 1e3 * median(mine), 1e3 * median(theirs), median(ratio), turns);
    return median(ratio);
}

int main()
{
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR); /* it warns of its own use of itself */
    cv::Mat frame(1080, 1920, CV_32FC3);
    cv::RNG random(23);
    random.fill(frame, cv::RNG::UNIFORM, -4.0, 3.0);
    cv::exp(frame, frame);
    const double alone = compare(frame, 1, 11);
    compare(frame, cv::getNumberOfCPUs(), 11);
    return alone > 1.0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

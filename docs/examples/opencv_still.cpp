/* opencv_still INPUT.hdr OUTPUT.png: maps an HDR still, by pupil instead of cv::createTonemapReinhard.
 *     apt-get install g++ pkg-config libopencv-dev      (and pupil: docs/guide.md, Building)
 *     c++ opencv_still.cpp $(pkg-config --cflags --libs pupil opencv4) -o opencv_still && ./opencv_still in.hdr out.png
 */
#include <opencv2/imgcodecs.hpp>
#include <pupil/opencv.hpp>

#include <cstdio>

int main(int argc, char **argv)
{
    const cv::Mat light = cv::imread(argc == 3 ? argv[1] : "", cv::IMREAD_UNCHANGED); /* CV_32FC3, blue first */
    cv::Mat floats, codes;
    if (light.empty()) {
        std::fprintf(stderr, "usage: opencv_still INPUT.hdr OUTPUT.png\n");
        return 2;
    }
    cv::Ptr<cv::Tonemap> tonemap = pupil_cv::createTonemapPupil(2.2f);
    tonemap->process(light, floats); /* CV_32FC3, 0..1 */
    floats.convertTo(codes, CV_8U, 255.0);
    return cv::imwrite(argv[2], codes) ? 0 : 1;
}

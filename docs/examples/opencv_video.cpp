/* opencv_video INPUT OUTPUT.avi: what cv::VideoCapture reads (a camera's number, a video, shot%03d.png), well exposed.
 *     apt-get install g++ pkg-config libopencv-dev      (and pupil: docs/guide.md, Building)
 *     c++ opencv_video.cpp $(pkg-config --cflags --libs pupil opencv4) -o opencv_video && ./opencv_video 0 out.avi */
#include <opencv2/videoio.hpp>
#include <pupil/opencv.hpp>

#include <cctype>
#include <cstdio>
#include <cstdlib>

int main(int argc, char **argv)
{
    if (argc != 3) {
        std::fprintf(stderr, "usage: opencv_video INPUT OUTPUT.avi\n");
        return 2;
    }
    const bool is_camera = std::isdigit(static_cast<unsigned char>(argv[1][0])) && !argv[1][1];
    cv::VideoCapture capture;
    /* For a camera OpenCV would use GStreamer, whose frames have no timestamps. */
    if (!(is_camera ? capture.open(std::atoi(argv[1]), cv::CAP_V4L2) : capture.open(argv[1]))) {
        std::fprintf(stderr, "opencv_video: %s cannot be opened\n", argv[1]);
        return 1;
    }
    pupil_cv::Video<cv::VideoCapture> video(capture);
    std::fprintf(stderr, "%s\n", video.unknown());
    cv::VideoWriter writer;
    cv::Mat picture;
    int count = 0;
    for (; count < 3000 && video.read(picture); count++) {
        if (!writer.isOpened())
            writer.open(argv[2], cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30, picture.size());
        writer.write(picture);
    }
    std::printf("%d frames, the last one adapted to %+.2f EV\n", count, video.pupil().exposure().adapted_ev);
    return count ? 0 : 1;
}

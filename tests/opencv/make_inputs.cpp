/* make_inputs FOLDER: in.hdr, of 8 stops of light; in.avi, 50 frames whose codes double in the middle. make_inputs
 * FOLDER check: whether out.png and out.avi are what the examples should have made. */
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>

static int make(const std::string &folder)
{
    cv::Mat light(48, 64, CV_32FC3);
    for (int x = 0; x < 64; x++)
        light.col(x).setTo(cv::Scalar::all(40.0 * std::exp2(x / 8.0)));
    cv::VideoWriter writer(folder + "/in.avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25, cv::Size(64, 48));
    for (int i = 0; i < 50; i++)
        writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(i < 25 ? 60 : 120)));
    return cv::imwrite(folder + "/in.hdr", light) && writer.isOpened() ? 0 : 1;
}

static int check(const std::string &folder)
{
    const cv::Mat picture = cv::imread(folder + "/out.png", cv::IMREAD_UNCHANGED);
    cv::VideoCapture video(folder + "/out.avi");
    cv::Mat frame;
    int frames = 0;
    while (video.read(frame))
        frames++;
    const bool is_still = picture.type() == CV_8UC3 && picture.cols == 64 && picture.rows == 48;
    const int dark = is_still ? picture.at<cv::Vec3b>(24, 2)[1] : -1,
              bright = is_still ? picture.at<cv::Vec3b>(24, 61)[1] : -1;
    std::printf("%d frames; codes of the still from %d to %d\n", frames, dark, bright);
    return frames == 50 && dark >= 0 && dark < 60 && bright > 200 ? 0 : 1;
}

int main(int argc, char **argv)
{
    return argc == 2 ? make(argv[1]) : argc == 3 ? check(argv[1]) : 2;
}

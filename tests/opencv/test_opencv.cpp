/* pupil/opencv.hpp: each format from a Mat, whole and as a region, has the bits of the C functions on memory without
 * padding; what cannot be read throws and says what would be right; and typical Mats. */
#include "pupil/opencv.hpp"

#include <atomic>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

static std::atomic<unsigned long> checks, failures;

static void check(bool holds, int line, const std::string &what)
{
    checks++;
    if (!holds && failures++ < 30)
        std::printf("test_opencv.cpp:%d: FAILED: %s\n", line, what.c_str());
}

#define CHECK(holds)           check((holds), __LINE__, #holds)
#define CHECK_MSG(holds, what) check((holds), __LINE__, what)

/* The call throws a cv::Exception with these words. */
template <class Call> static void throws(int line, const std::string &words, Call call)
{
    std::string said = "nothing was thrown";
    try {
        call();
    } catch (const cv::Exception &e) {
        said = e.what();
        if (said.find(words) != std::string::npos && (said.find("pupil: ") != std::string::npos || words.empty()))
            return check(true, line, "");
    } catch (const std::exception &e) {
        said = std::string("another exception: ") + e.what();
    }
    check(false, line, "'" + words + "' was expected: " + said);
}

#define THROWS(words, ...) throws(__LINE__, words, [&] { __VA_ARGS__; })

static cv::RNG random_numbers(24);

static cv::Mat random_mat(int rows, int columns, int type)
{
    cv::Mat mat(rows, columns, type);
    if (CV_MAT_DEPTH(type) == CV_32F || CV_MAT_DEPTH(type) == CV_16F) {
        cv::Mat light(rows, columns, CV_MAKETYPE(CV_32F, CV_MAT_CN(type)));
        random_numbers.fill(light, cv::RNG::UNIFORM, -5.0, 2.0);
        cv::exp(light, light);
        light.convertTo(mat, CV_MAT_DEPTH(type));
    } else { /* any bits */
        cv::Mat bytes(rows, static_cast<int>(mat.cols * static_cast<int>(mat.elemSize())), CV_8U, mat.data, mat.step);
        random_numbers.fill(bytes, cv::RNG::UNIFORM, 0, 256);
    }
    return mat;
}

/* The same pixels in the middle of a larger Mat. */
static cv::Mat region_of(const cv::Mat &mat)
{
    cv::Mat large = random_mat(mat.rows + 7, mat.cols + 11, mat.type());
    cv::Mat region = large(cv::Rect(5, 3, mat.cols, mat.rows));
    mat.copyTo(region);
    return region;
}

static bool same(const cv::Mat &a, const cv::Mat &b)
{
    if (a.size() != b.size() || a.type() != b.type())
        return false;
    for (int y = 0; y < a.rows; y++)
        if (std::memcmp(a.ptr(y), b.ptr(y), a.elemSize() * static_cast<size_t>(a.cols)))
            return false;
    return true;
}

/* The result of the C functions on memory without padding. */
static cv::Mat in_c(const cv::Mat &mat, uint32_t pixel, uint32_t width, uint32_t height, uint32_t out_pixel, int type,
                    const pupil_coding *coding = nullptr, const pupil_frame_info *info = nullptr)
{
    const cv::Mat plain = mat.clone();
    cv::Mat out(static_cast<int>(height), static_cast<int>(width), type);
    pupil_image_const from = pupil_image_const_of(plain.data, width, height, pixel);
    from.coding = coding;
    const pupil_image to = pupil_image_of(out.data, width, height, out_pixel);
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_process(&pupil, &from, info, &to) == PUPIL_OK);
    return out;
}

static const struct {
    int type;
    uint32_t pixel;
} outs[] = {{CV_8UC3, PUPIL_PIXEL_BGR8}, {CV_8UC4, PUPIL_PIXEL_BGRX8}, {CV_32FC3, PUPIL_PIXEL_BGR32F}};

/* --- each format --- */

static void check_format(uint32_t pixel)
{
    const int width = 40, height = 24;
    const pupil_cv::detail::Layout layout = pupil_cv::detail::layout_of(pixel);
    const bool packed = pupil_pixel_bits(pixel) && !pupil_pixel_bytes(pixel);
    const int columns = packed ? static_cast<int>(pupil_row_bytes(pixel, width)) : width;
    const cv::Mat mat = random_mat(height * layout.rows / layout.of, columns, layout.type), region = region_of(mat);
    for (size_t i = 0; i < sizeof outs / sizeof *outs; i++) {
        const std::string what = "format " + std::to_string(pixel) + " to " + cv::typeToString(outs[i].type);
        const cv::Mat wanted = in_c(mat, pixel, width, height, outs[i].pixel, outs[i].type);
        pupil_cv::Given given;
        given.pixel = pixel;
        given.type = outs[i].type;
        cv::Mat whole, part, exposed;
        pupil_cv::Pupil().process(mat, whole, given);
        CHECK_MSG(same(whole, wanted), what);
        cv::Mat canvas = cv::Mat::zeros(100, 100, given.type), target = canvas(cv::Rect(20, 30, width, height));
        if (pupil_pixel_planes(pixel) == 3)
            THROWS("must be continuous: use mat.clone()", pupil_cv::Pupil().process(region, part, given));
        else
            pupil_cv::Pupil().process(region, target, given);
        CHECK_MSG(pupil_pixel_planes(pixel) == 3 || same(target, wanted), what + ", of a region");
        target.setTo(cv::Scalar::all(0));
        CHECK_MSG(cv::countNonZero(canvas.reshape(1)) == 0, what + ": written outside the region");
    }
    cv::Mat wrong = random_mat(24, 40, layout.type == CV_8UC3 ? CV_8UC4 : CV_8UC3), picture;
    pupil_cv::Given given;
    given.pixel = pixel;
    THROWS("needs a Mat of " + cv::typeToString(layout.type) + ", not of " + cv::typeToString(wrong.type()),
           pupil_cv::Pupil().process(wrong, picture, given));
    CHECK(picture.empty());
}

/* --- what a Mat says by itself --- */

static void check_guesses()
{
    pupil_coding coded = pupil_coding();
    coded.light = PUPIL_LIGHT_SRGB;
    const struct {
        int type;
        uint32_t pixel;
        const pupil_coding *coding;
    } guesses[] = {{CV_8UC1, PUPIL_PIXEL_GREY8, &coded},
                   {CV_16UC1, PUPIL_PIXEL_GREY16, nullptr},
                   {CV_8UC3, PUPIL_PIXEL_BGR8, nullptr},
                   {CV_8UC4, PUPIL_PIXEL_BGRX8, nullptr},
                   {CV_32FC3, PUPIL_PIXEL_BGR32F, nullptr}};
    for (int depth = CV_8U; depth <= CV_16F; depth++)
        for (int channels = 1; channels <= 5; channels++) {
            const int type = CV_MAKETYPE(depth, channels);
            const cv::Mat mat = cv::Mat::zeros(8, 8, type);
            cv::Mat picture;
            uint32_t pixel = PUPIL_PIXEL_NONE;
            for (size_t i = 0; i < sizeof guesses / sizeof *guesses; i++)
                if (guesses[i].type == type) {
                    const cv::Mat light = random_mat(8, 8, type);
                    pixel = guesses[i].pixel;
                    pupil_cv::Pupil().process(light, picture);
                    CHECK_MSG(same(picture, in_c(light, pixel, 8, 8, PUPIL_PIXEL_BGR8, CV_8UC3, guesses[i].coding)),
                              cv::typeToString(type));
                }
            if (pixel == PUPIL_PIXEL_NONE)
                THROWS("a Mat of " + cv::typeToString(type) + " has no format that pupil can guess; ",
                       pupil_cv::Pupil().process(mat, picture));
        }
    cv::Mat picture;
    THROWS("name its format: PUPIL_PIXEL_YUYV", pupil_cv::view(cv::Mat::zeros(2, 2, CV_8UC2)));
    THROWS("COLOR_GRAY2BGR", pupil_cv::view(cv::Mat::zeros(2, 2, CV_32FC1)));
    THROWS("COLOR_BGRA2BGR", pupil_cv::view(cv::Mat::zeros(2, 2, CV_32FC4)));
    THROWS("mat.convertTo(mat, CV_32F, 1 / 65535.0), or, if red is first, name PUPIL_PIXEL_RGB16",
           pupil_cv::view(cv::Mat::zeros(2, 2, CV_16UC3)));
    THROWS("mat.convertTo(mat, CV_32F), or, if red is first, name PUPIL_PIXEL_RGBA16F",
           pupil_cv::view(cv::Mat::zeros(2, 2, CV_16FC4)));
    THROWS("mat.convertTo(mat, CV_32F) with a factor", pupil_cv::view(cv::Mat::zeros(2, 2, CV_64FC3)));
    THROWS("one, three or four channels", pupil_cv::view(cv::Mat::zeros(2, 2, CV_64FC2)));
    const cv::Mat large = cv::Mat::ones(100, 100, CV_32FC3), region = large(cv::Rect(20, 30, 40, 50));
    const pupil_image_const image = pupil_cv::view(region); /* no copy */
    CHECK(image.data == large.ptr<cv::Vec3f>(30) + 20 && image.stride_bytes == 1200 && image.width == 40 &&
          image.height == 50);
    /* blue is in front: the same scene with the channels exchanged has another luminance */
    cv::Mat blue(4, 4, CV_8UC3, cv::Scalar(255, 0, 0)), red(4, 4, CV_8UC3, cv::Scalar(0, 0, 255));
    pupil_cv::Pupil a, b;
    a.meter(blue);
    b.meter(red);
    CHECK(b.exposure().metered_ev - a.exposure().metered_ev > 1.5); /* 0.2126 and 0.0722 */
}

/* --- typical Mats --- */

/* Planes in one Mat with rows longer than the picture's. */
static void check_padded(uint32_t pixel)
{
    const bool whole = pixel == PUPIL_PIXEL_I444_16;
    const cv::Mat mat = random_mat(whole ? 60 : 30, 40, pupil_pixel_bytes(pixel) == 2 || whole ? CV_16UC1 : CV_8UC1);
    pupil_image_const from = pupil_image_const_of(mat.data, 40, 20, pixel);
    from.width = 37;
    pupil_t pupil;
    const pupil_config config = pupil_cv::defaults();
    cv::Mat wanted(20, 37, CV_8UC3), picture;
    const pupil_image to = pupil_cv::view_out(wanted);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_process(&pupil, &from, nullptr, &to) == PUPIL_OK);
    pupil_cv::Given padded;
    padded.pixel = pixel;
    padded.width = 37;
    pupil_cv::Pupil().process(mat, picture, padded);
    CHECK_MSG(same(picture, wanted), "rows with padding of format " + std::to_string(pixel));
}

static void check_odd()
{
    pupil_cv::Pupil pupil;
    cv::Mat picture;
    THROWS("the Mat is empty", pupil.process(cv::Mat(), picture));
    THROWS("the Mat is empty", pupil.process(cv::Mat(0, 5, CV_8UC3), picture));
    const int sizes[] = {4, 4, 4};
    THROWS("3 dimensions", pupil.process(cv::Mat(3, sizes, CV_8UC3), picture));
    THROWS("width and height", pupil.process(cv::Mat(1, 16385, CV_8UC3), picture));
    THROWS("there is no pixel format 99", pupil_cv::view(cv::Mat::zeros(4, 4, CV_8UC3), 99));
    THROWS("of a mosaic even", pupil_cv::Given given; given.pixel = PUPIL_PIXEL_BAYER8;
           pupil.process(cv::Mat(3, 3, CV_8UC1), picture, given));
    THROWS("3/2 of the picture's; it has 4", pupil_cv::view(cv::Mat(4, 4, CV_8UC1), PUPIL_PIXEL_NV12));
    THROWS("even number of columns", pupil_cv::view(cv::Mat(6, 5, CV_8UC1), PUPIL_PIXEL_NV12));
    THROWS("has no 9 pixels a row", pupil_cv::view(cv::Mat(4, 10, CV_8UC1), PUPIL_PIXEL_BAYER10P, nullptr, 9));
    THROWS("can be CV_8UC3, CV_8UC4 or CV_32FC3, not CV_16UC3", pupil_cv::Given given; given.type = CV_16UC3;
           pupil.process(cv::Mat::ones(4, 4, CV_8UC3), picture, given));
    THROWS("only mosaics", pupil_cv::Given given; given.half = true;
           pupil.process(cv::Mat::ones(4, 4, CV_8UC3), picture, given));
    THROWS("key", pupil_config config = pupil_cv::defaults(); config.key = 7; pupil_cv::Pupil wrong(config));
    THROWS("key", pupil_config config = pupil_cv::defaults(); config.key = 7; pupil.retune(config));
    THROWS("output", cv::Mat grey = cv::Mat::zeros(4, 4, CV_8UC1); const pupil_image to = pupil_cv::view_out(grey);
           const cv::Mat ones = cv::Mat::ones(4, 4, CV_8UC3); const pupil_image_const from = pupil_cv::view(ones);
           pupil_cv::check(pupil_process(pupil.get(), &from, nullptr, &to)));
    CHECK(pupil.exposure().frames == 0 && pupil.exposure().state == PUPIL_STATE_EMPTY);

    const cv::Mat light = random_mat(30, 40, CV_32FC3);
    cv::Mat wanted;
    pupil_cv::Pupil().process(light, wanted);
    cv::Mat large = random_mat(300, 400, CV_32FC3);
    for (int y = 0; y < 5; y++) { /* 1 x 1, one column, one row */
        const cv::Rect rect(7 * y, 9 * y, y == 1 ? 1 : y ? 1 + y : 1, y == 2 ? 1 : y ? 1 + 2 * y : 1);
        cv::Mat part, plain;
        pupil_cv::Pupil().process(large(rect), part);
        pupil_cv::Pupil().process(large(rect).clone(), plain);
        CHECK(same(part, plain));
    }
    cv::Mat wide(30, 80, CV_32FC3), left = wide(cv::Rect(0, 0, 40, 30)), right = wide(cv::Rect(40, 0, 40, 30));
    light.copyTo(left);
    pupil_cv::Given floats;
    floats.type = CV_32FC3;
    cv::Mat as_floats;
    pupil_cv::Pupil().process(light, as_floats, floats);
    pupil_cv::Pupil().process(left, right, floats);
    CHECK(same(right, as_floats) && same(left, light));
    cv::Mat in_place = light.clone();
    pupil_cv::Pupil().process(in_place, in_place, floats);
    CHECK(same(in_place, as_floats));
    in_place = light.clone();
    pupil_cv::Pupil().process(in_place, in_place); /* to another type */
    CHECK(same(in_place, wanted));
    /* rows longer than the library's buffer, and the picture one pixel further right */
    cv::Mat both = random_mat(8, 3001, CV_32FC3), here = both.colRange(0, 3000), shifted = both.colRange(1, 3001);
    const cv::Mat before = here.clone();
    pupil_cv::Pupil().process(here, shifted, floats);
    pupil_cv::Pupil().process(before, as_floats, floats);
    CHECK(same(shifted, as_floats));

    cv::Mat_<cv::Vec3b> typed;
    pupil_cv::Pupil().process(light, typed);
    CHECK(same(typed, wanted));
    THROWS("", pupil_cv::Pupil().process(light, typed, floats)); /* OpenCV's own: its type is fixed */
    pupil_cv::Pupil().process(cv::Mat(light * 1.0), picture);
    CHECK(same(picture, wanted));
    cv::UMat on_device, mapped;
    light.copyTo(on_device);
    pupil_cv::Pupil().process(on_device, mapped);
    CHECK(same(mapped.getMat(cv::ACCESS_READ), wanted));
    const std::vector<cv::Vec3b> pixels(12, cv::Vec3b(10, 20, 30));
    pupil_cv::Pupil().process(pixels, picture); /* a vector is a column */
    CHECK(picture.total() == 12);
    std::vector<uchar> memory(64 * 1024);
    cv::Mat far_apart(3, 4, CV_8UC3, memory.data(), 20000);
    far_apart.setTo(cv::Scalar(1, 2, 3));
    pupil_cv::Pupil().process(far_apart, picture);
    CHECK(picture.cols == 4);

    pupil_cv::Given half;
    half.pixel = PUPIL_PIXEL_BAYER10P;
    half.half = true;
    half.width = 32;
    pupil_cv::Pupil().process(random_mat(24, 45, CV_8UC1), picture, half); /* rows with padding */
    CHECK(picture.cols == 16 && picture.rows == 12);
    for (uint32_t pixel : {PUPIL_PIXEL_NV12, PUPIL_PIXEL_I420, PUPIL_PIXEL_I420_10, PUPIL_PIXEL_I444_16})
        check_padded(pixel);
    pupil_cv::Given grey;
    grey.pixel = PUPIL_PIXEL_I444_16;
    pupil_cv::Pupil().process(random_mat(3, 1, CV_16UC1), picture, grey); /* 1 x 1: its chroma is not halved */
    CHECK(picture.total() == 1);
    pupil_coding wrong = pupil_coding();
    wrong.size_bytes = sizeof wrong;
    wrong.matrix = 77;
    grey.coding = &wrong;
    THROWS("matrix must be", pupil_cv::Pupil().process(random_mat(3, 2, CV_16UC1), picture, grey));

    pupil_cv::Pupil first;
    for (int i = 0; i < 4; i++)
        first.process(random_mat(30, 40, CV_32FC3), picture);
    pupil_cv::Pupil second = first;
    cv::Mat one, two;
    first.process(light, one);
    second.process(light, two);
    CHECK(same(one, two) && !same(one, wanted));
    first.reset();
    first.process(light, one);
    CHECK(same(one, wanted));
}

/* --- threads --- */

/* Three frames, the second one dark, by a program in C. */
static std::vector<cv::Mat> three_in_c(const cv::Mat &mat, uint32_t pixel, const pupil_config &config,
                                       pupil_exposure *exposure)
{
    const cv::Mat plain = mat.clone(), dark = cv::Mat::zeros(mat.size(), mat.type());
    std::vector<cv::Mat> pictures;
    pupil_t pupil;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    for (int i = 0; i < 3; i++) {
        pictures.push_back(cv::Mat(260, 320, CV_8UC3));
        const pupil_image_const from = pupil_image_const_of(i == 1 ? dark.data : plain.data, 320, 260, pixel);
        const pupil_image to = pupil_image_of(pictures.back().data, 320, 260, PUPIL_PIXEL_BGR8);
        const pupil_frame_info info = {sizeof info, 0, 40000000 * (i + 1), 0, 0.01 * (i + 1), 2};
        CHECK(pupil_process(&pupil, &from, &info, &to) == PUPIL_OK);
    }
    CHECK(pupil_get_exposure(&pupil, exposure) == PUPIL_OK);
    return pictures;
}

static void check_threads()
{
    pupil_config config = pupil_cv::defaults();
    config.dither = 1;
    for (int threads = 1; threads <= 4; threads++)
        for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++) {
            const pupil_cv::detail::Layout layout = pupil_cv::detail::layout_of(pixel);
            const bool packed = pupil_pixel_bits(pixel) && !pupil_pixel_bytes(pixel);
            const int columns = packed ? static_cast<int>(pupil_row_bytes(pixel, 320)) : 320;
            const cv::Mat mat = random_mat(260 * layout.rows / layout.of, columns, layout.type);
            pupil_exposure wanted_exposure;
            config.order = threads == 4 ? PUPIL_ORDER_FUSED : PUPIL_ORDER_EXACT;
            config.meter_rows = threads == 3 ? 4 : 1;
            const std::vector<cv::Mat> wanted = three_in_c(mat, pixel, config, &wanted_exposure);
            pupil_cv::Pupil pupil(config);
            cv::setNumThreads(threads);
            for (int i = 0; i < 3; i++) {
                const pupil_frame_info info = {sizeof info, 0, 40000000 * (i + 1), 0, 0.01 * (i + 1), 2};
                pupil_cv::Given given;
                cv::Mat picture;
                given.pixel = pixel;
                given.info = &info;
                pupil.process(i == 1 ? cv::Mat(cv::Mat::zeros(mat.size(), mat.type())) : mat, picture, given);
                CHECK_MSG(same(picture, wanted[static_cast<size_t>(i)]),
                          "format " + std::to_string(pixel) + ", " + std::to_string(threads) + " threads");
            }
            const pupil_exposure exposure = pupil.exposure();
            CHECK(std::memcmp(&exposure, &wanted_exposure, sizeof exposure) == 0);
        }
    cv::setNumThreads(-1);
    cv::parallel_for_(
        cv::Range(0, 4),
        [](const cv::Range &range) { /* objects of their own */
                                     for (int i = range.start; i < range.end; i++) {
                                         cv::Mat picture;
                                         pupil_cv::Pupil().process(cv::Mat::ones(200, 200, CV_32FC3), picture);
                                         check(picture.at<cv::Vec3b>(100, 100)[1] == picture.at<cv::Vec3b>(0, 0)[1],
                                               __LINE__, "in a thread");
                                     }
        });
}

/* --- as one of OpenCV's operators --- */

static void check_tonemap()
{
    const cv::Mat light = random_mat(30, 40, CV_32FC3);
    const cv::Ptr<cv::Tonemap> tonemap = pupil_cv::createTonemapPupil();
    cv::Mat picture, again;
    double least, most;
    tonemap->process(light, picture);
    CHECK(picture.type() == CV_32FC3);
    CHECK(same(picture, in_c(light, PUPIL_PIXEL_BGR32F, 40, 30, PUPIL_PIXEL_BGR32F, CV_32FC3)));
    cv::minMaxLoc(picture.reshape(1), &least, &most);
    CHECK(least >= 0.0 && most <= 1.0 && most > 0.9);
    CHECK(tonemap->getGamma() <= 1.0f && tonemap->getGamma() >= 1.0f && tonemap->getDefaultName() == "TonemapPupil");
    tonemap->process(light * 100.0, again);
    CHECK(!same(again, picture)); /* a video: it adapts */
    tonemap->clear();
    tonemap->process(light * 4.0, again);
    CHECK(same(again, picture)); /* stills: their light does not matter */
    tonemap->setGamma(2.2f);
    tonemap->clear();
    tonemap->process(light, again);
    cv::pow(picture, 1.0 / static_cast<double>(2.2f), picture);
    CHECK(same(again, picture));
    THROWS("gamma must be above 0", tonemap->setGamma(0.0f));
    THROWS("no format that pupil can guess", tonemap->process(cv::Mat::zeros(4, 4, CV_64FC3), again));
    pupil_config config = pupil_cv::defaults();
    config.key = 7;
    THROWS("key", pupil_cv::createTonemapPupil(1.0f, config));
}

/* --- a video --- */

struct Recording {
    std::vector<cv::Mat> frames;
    std::vector<double> position_ms;
    size_t next;

    bool read(cv::Mat &frame)
    {
        if (next == frames.size())
            return false;
        frame = frames[next++];
        return true;
    }

    double get(int property) const
    {
        return property == 0 && next ? position_ms[next - 1] : -1.0;
    }
};

static void check_video()
{
    Recording recording = {std::vector<cv::Mat>(7), {0, 40, 80, 20, 60, -1, 40}, 0};
    for (size_t i = 0; i < 7; i++)
        recording.frames[i] = random_mat(8, 8, CV_8UC3);
    pupil_cv::Video<Recording> video(recording);
    cv::Mat picture;
    std::vector<int64_t> times;
    while (video.read(picture)) {
        times.push_back(video.info().timestamp_ns);
        CHECK(picture.type() == CV_8UC3 && same(video.frame(), recording.frames[recording.next - 1]));
    }
    CHECK(times.size() == 7 && times[0] != 0);
    for (size_t i : {1, 2, 4})
        CHECK(times[i] - times[i - 1] == 40000000);
    for (size_t i : {3, 5, 6}) /* back, to an unknown position and from it: by the clock */
        CHECK(times[i] >= times[i - 1] && times[i] - times[i - 1] != 40000000 && times[i] - times[i - 1] != 41000000);
    CHECK(video.pupil().exposure().frames == 7);
    const std::string unknown = pupil_cv::Video<Recording>::unknown();
    for (const char *word :
         {"frame numbers", "exposure time", "gain", "pupil::pupil_camera", "pkg-config pupil-camera"})
        CHECK_MSG(unknown.find(word) != std::string::npos, word);
    recording.frames = {cv::Mat::zeros(4, 4, CV_64FC3)};
    recording.next = 0;
    THROWS("no format that pupil can guess", video.read(picture));
}

int main()
{
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        check_format(pixel);
    check_guesses();
    check_odd();
    check_threads();
    check_tonemap();
    check_video();
    std::printf("%lu checks, %lu failed\n", checks.load(), failures.load());
    return failures != 0;
}

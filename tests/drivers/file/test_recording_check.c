/* What can be recorded: each size, rate and coding that is refused, with its sentence. */
#include "file/recording/recording_format.h"

#include <math.h>

#include "check.h"

static pupil_recording_about usual(uint32_t pixel)
{
    pupil_recording_about about = {.pixel = pixel, .width = 64, .height = 48, .fps = 30.0};
    about.coding.size_bytes = sizeof about.coding;
    return about;
}

static void check(const pupil_recording_about *about, const char *words)
{
    pupil_why why = {""};
    const int failed = pupil_recording_check(about, &why);
    CHECK_MSG(failed == (words ? -1 : 0), "%s: %s", words ? words : "good", why.text);
    CHECK_MSG(!words || strstr(why.text, words), "%s: %s", words ? words : "good", why.text);
}

int main(int argc, char **argv)
{
    static const struct {
        uint32_t pixel, width, height;
        double fps;
        const char *words;
    } cases[] = {{PUPIL_PIXEL_RGB8, 64, 48, 30, NULL},
                 {PUPIL_PIXEL_RGB8, 1, 1, 1e6, NULL},
                 {PUPIL_PIXEL_NONE, 64, 48, 30, "cannot be recorded; inputs of the library can"},
                 {PUPIL_PIXEL_RGB8, 0, 48, 30, "frames of 0 x 48 pixels cannot be recorded"},
                 {PUPIL_PIXEL_RGB8, 64, 0, 30, "frames of 64 x 0 pixels cannot be recorded"},
                 {PUPIL_PIXEL_RGB8, 16385, 48, 30, "frames of 16385 x 48 pixels cannot be recorded"},
                 {PUPIL_PIXEL_RGB8, 64, 16385, 30, "frames of 64 x 16385 pixels cannot be recorded"},
                 {PUPIL_PIXEL_BAYER10, 64, 47, 30, "the height even"},
                 {PUPIL_PIXEL_BAYER10, 63, 48, 30, "the width is a multiple of 2"},
                 {PUPIL_PIXEL_RGB32F, 16384, 16384, 30, "frames of 3221225472 bytes cannot be recorded"},
                 {PUPIL_PIXEL_RGB8, 64, 48, 0, "fps is 0"},
                 {PUPIL_PIXEL_RGB8, 64, 48, -1, "fps is -1"},
                 {PUPIL_PIXEL_RGB8, 64, 48, 1.1e6, "fps is 1.1e+06"},
                 {PUPIL_PIXEL_RGB8, 64, 48, (double)NAN, "must be above 0"}};
    check_begin(argc, argv);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pupil_recording_about about = usual(cases[i].pixel);
        about.width = cases[i].width;
        about.height = cases[i].height;
        about.fps = cases[i].fps;
        check(&about, cases[i].words);
    }
    pupil_recording_about about = usual(PUPIL_PIXEL_RGB8);
    about.coding.range = 99;
    check(&about, "the coding of the frames: ");
    return check_end();
}

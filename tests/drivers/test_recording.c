/* Recordings: every format there and back, bit for bit; cut, full, wrong. */
#include "check.h"
#include "scratch.h"

#include <fcntl.h>

#include "file/recording.h"
#include "recording_frames.h"

static char why[PUPIL_WHY_BYTES];

static const pupil_recorder_options waiting = {.camera = "a \"camera\" \\ \n \xc3\xa9 \xff", .fps = 29.97, .wait = 1};

static void test_round_trip(void)
{
    static const uint32_t sizes[][2] = {{4, 2}, {64, 48}, {36, 22}, {1, 1}, {7, 5}, {3, 8}};
    for (uint32_t pixel = 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            const int odd = sizes[i][0] % 4 || sizes[i][1] % 2;
            if (pixel == PUPIL_PIXEL_BGRX8 || (odd && pixel >= PUPIL_PIXEL_BAYER8))
                continue;
            test_frames frames;
            frames_make(&frames, pixel, sizes[i][0], sizes[i][1], 5);
            const char *folder = scratch("trip");
            CHECK_MSG(frames_record(&frames, folder, &waiting, why) == 5, "pixel %u: %s", pixel, why);
            CHECK_MSG(frames_replay(&frames, folder, why) == 5, "pixel %u %ux%u: %s", pixel, sizes[i][0], sizes[i][1],
                      why);
            scratch_clear(folder);
            frames_free(&frames);
        }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_round_trip();
    scratch_clear(scratch_folder);
    return check_end();
}

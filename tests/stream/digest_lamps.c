/* Row correction gains: 100 Hz light that rises and falls linearly, on a picture of integers, for as long as gains need
 * to start. Every gain of every frame counts.
 */
#include "digest.h"

#include "pupil/row_gain.h"

enum { LAMPS_SIDE = 64, LAMPS_FRAMES = 48 };

uint64_t digest_lamps(void)
{
    static pupil_row_gain lamps;
    static uint16_t pixel[LAMPS_SIDE][LAMPS_SIDE];
    static float gain[LAMPS_SIDE];
    const pupil_image_const image = {.data = pixel,
                                     .stride_bytes = sizeof pixel[0],
                                     .width = LAMPS_SIDE,
                                     .height = LAMPS_SIDE,
                                     .pixel = PUPIL_PIXEL_GREY16};
    uint64_t digest = UINT64_C(0xcbf29ce484222325); /* FNV-1a, as digest.c has it */
    pupil_row_gain_config config;
    int error;
    pupil_row_gain_config_default(&config);
    config.readout_s = 0.025;
    error = pupil_row_gain_init(&lamps, &config);
    for (int64_t i = 1; i <= LAMPS_FRAMES; i++) {
        const pupil_frame_info info = {.timestamp_ns = i * 33366667, .exposure_s = 0x1p-10, .gain = 1.0};
        for (int64_t y = 0; y < LAMPS_SIDE; y++) {
            const int64_t phase = (info.timestamp_ns + y * (25000000 / LAMPS_SIDE)) % 10000000;
            const int64_t light = 700 + 600 * (phase < 5000000 ? phase : 10000000 - phase) / 5000000;
            for (int64_t x = 0; x < LAMPS_SIDE; x++)
                pixel[y][x] = (uint16_t)((4000 + (x * x * 37 + y * y * 91 + x * y * 13) % 9000) * light / 1000);
        }
        error |= pupil_row_gain_frame(&lamps, &image, &info);
        error |= pupil_row_gain_of_rows(&lamps, &info, LAMPS_SIDE, gain);
        for (size_t y = 0; y < LAMPS_SIDE; y++) {
            uint32_t bits;
            __builtin_memcpy(&bits, &gain[y], sizeof bits);
            for (int b = 0; b < 4; b++, bits >>= 8) /* little-endian on every machine */
                digest = (digest ^ (bits & 255)) * UINT64_C(0x100000001b3);
        }
    }
    return (digest ^ (uint64_t)(uint32_t)error) * UINT64_C(0x100000001b3);
}

/* DNG through LibRaw: black is 0 and white is 1, greys are grey and linear, colours are Rec.709's, pictures are
 * upright; damage is refused. */
#include "scratch.h"

#include "file/still/still.h"
#include "write_dng.h"

#include <math.h>

#ifdef PUPIL_COVERAGE /* CMakeLists.txt */
extern void __gcov_dump(void);
_Noreturn void __real__exit(int status);
_Noreturn void __wrap__exit(int status);
_Noreturn void __wrap__exit(int status)
{
    __gcov_dump();
    __real__exit(status);
}
#endif

enum { SIDE = 32, MOST = DNG_HEAD + DNG_MORE + SIDE * SIDE * 3 * 2 };

static pupil_why why;
static uint16_t sample[SIDE * SIDE * 3];
static uint8_t bytes[MOST];
static uint32_t claimed_width; /* 0: its own */

/* As the program reads it, by its first bytes. */
static int load(pupil_still *still, const dng *d, size_t cut)
{
    const size_t size = dng_make(d, bytes);
    if (claimed_width)
        dng_put(bytes + 10 + 12 + 8, claimed_width, 4);
    FILE *file = fopen(scratch("a.dng"), "wb");
    CHECK(size <= MOST && file && fwrite(bytes, 1, size - cut, file) == size - cut && fclose(file) == 0);
    return pupil_still_load(still, scratch("a.dng"), &why);
}

static const float *pixel(const pupil_still *s, uint32_t x, uint32_t y)
{
    return (const float *)s->pixels + ((size_t)y * s->width + x) * 3;
}

/* Four patches of grey, of a mosaic whose sensor sees half of red and 0.8 of blue: black, 0.25, 0.5 and white. */
static void test_grey(int is_linear)
{
    static const uint32_t neutral[3] = {500, 1000, 800};
    const dng d = {SIDE, SIDE, is_linear, 256, 4095, {500, 1000, 800}, 1, sample};
    static const double steps[4] = {0.0, 0.25, 0.5, 1.0};
    pupil_still still = {0};
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++)
            for (uint32_t c = 0; c < (is_linear ? 3u : 1u); c++) {
                const uint32_t colour = is_linear ? c : y % 2 + x % 2;
                const double light = steps[y / 16 * 2 + x / 16] * neutral[colour] / 1000.0;
                sample[is_linear ? (y * SIDE + x) * 3 + c : y * SIDE + x] = (uint16_t)(256.5 + light * (4095 - 256));
            }
    CHECK_MSG(load(&still, &d, 0) == 0, "%s", why.text);
    if (!still.pixels)
        return;
    CHECK(still.width == SIDE && still.height == SIDE && still.pixel == PUPIL_PIXEL_RGB32F);
    CHECK_MSG(fabs((double)still.code_light * (4095 - 256) - 1) < 1e-6, "a code is %g", (double)still.code_light);
    for (uint32_t i = 0; i < 4; i++) {
        const float *p = pixel(&still, i % 2 * 16 + 8, i / 2 * 16 + 8);
        for (int c = 0; c < 3; c++) /* a matrix of four digits, codes of 12 bits */
            CHECK_MSG(fabs((double)p[c] - steps[i]) < 0.004, "linear %d, grey %g, channel %d: %g", is_linear, steps[i],
                      c, (double)p[c]);
    }
    pupil_still_free(&still);
}

/* Pure red of Rec.709, and TIFF's orientations: where the upper left quarter, the only lit one, goes. */
static void test_colour(void)
{
    static const struct {
        uint16_t orientation;
        uint32_t x, y;
    } places[] = {{1, 4, 4}, {3, 27, 27}, {6, 27, 4}, {8, 4, 27}};
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++)
            sample[y * SIDE + x] = x < 16 && y < 16 && x % 2 == 0 && y % 2 == 0 ? 2000 : 0;
    for (size_t i = 0; i < 4; i++) {
        const dng d = {SIDE, SIDE, 0, 0, 4000, {1000, 1000, 1000}, places[i].orientation, sample};
        pupil_still still = {0};
        CHECK_MSG(load(&still, &d, 0) == 0, "%s", why.text);
        if (still.pixels) {
            const float *p = pixel(&still, places[i].x, places[i].y), *dark = pixel(&still, 16, 16);
            CHECK_MSG(fabsf(p[0] - 0.5f) < 0.01f && fabsf(p[1]) < 0.01f && fabsf(p[2]) < 0.01f,
                      "orientation %u: %g %g %g", places[i].orientation, (double)p[0], (double)p[1], (double)p[2]);
            (void)dark;
        }
        pupil_still_free(&still);
        still.as_stored = 1;
        CHECK(load(&still, &d, 0) == 0 && pixel(&still, 4, 4)[0] > 0.4f);
        pupil_still_free(&still);
    }
}

/* Cut anywhere, or with any byte of its header changed, the file is read or refused with a sentence. */
static void test_damage(void)
{
    const dng d = {SIDE, SIDE, 0, 0, 4000, {1000, 1000, 1000}, 1, sample};
    pupil_still still = {0};
    for (size_t cut = 1; cut < SIDE * SIDE * 2 + DNG_HEAD + DNG_MORE; cut += 97)
        if (load(&still, &d, cut) != 0)
            CHECK_MSG(strstr(why.text, "a.dng: ") && !strchr(why.text, '\n'), "cut by %zu: %s", cut, why.text);
    CHECK(load(&still, &d, SIDE * SIDE) != 0); /* half of its pixels */
    claimed_width = 60000;
    CHECK(load(&still, &d, 0) != 0);
    claimed_width = 0;
    pupil_still_free(&still);
}

/* One bit of a DNG changed: LibRaw 0.20 crashes on it. It is refused, and the next file is read. */
static void test_crash(void)
{
    static const char path[] = PUPIL_SOURCE_DIR "/tests/fuzz/seeds/fuzz_dng/crashes_libraw_0.20.dng";
    const dng d = {SIDE, SIDE, 0, 0, 4000, {1000, 1000, 1000}, 1, sample};
    pupil_still still = {0};
    static uint8_t some[1 << 12];
    FILE *file = fopen(path, "rb");
    const size_t size = file ? fread(some, 1, sizeof some, file) : 0;
    CHECK(size > 1000 && fclose(file) == 0);
    if (pupil_read_raw(&still, some, size, &why) != 0) /* later releases may read it */
        CHECK_MSG(strstr(why.text, "is damaged"), "%s", why.text);
    CHECK(load(&still, &d, 0) == 0);
    pupil_still_free(&still);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    const dng any = {SIDE, SIDE, 0, 0, 4000, {1000, 1000, 1000}, 1, sample};
    pupil_still still = {0};
    if (load(&still, &any, 0) != 0 && strstr(why.text, "LibRaw was not found")) {
        puts("skipped: built without LibRaw");
        return 77;
    }
    pupil_still_free(&still);
    test_grey(0);
    test_grey(1);
    test_colour();
    test_damage();
    test_crash();
    scratch_clear(scratch_folder);
    return check_end();
}

/* One object copied in mid-stream, moved, or saved and loaded: each copy continues with the same bits, in both orders
 * and under every law. Also the meaning of exact and fused: fused maps with the curve of the frame before.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#include <math.h>

#define WIDTH  61
#define HEIGHT 33

static void draw(frame *f, int i)
{
    frame_lognormal(f, 0.2 * exp2(3 * sin(i * 0.7)), 1.5, check_uniform);
    if (i % 5 == 0)
        frame_set(f, 3, 4, NAN, INFINITY, -1, 0);
}

static pupil_frame_info info_of(int i)
{
    pupil_frame_info info = {.timestamp_ns = i * INT64_C(33366700) + (i % 3) * 1000, .sequence = (uint64_t)i};
    if (i % 4 != 3) {
        info.exposure_s = 0.01 * (1 + i % 3);
        info.gain = 1 + i % 2;
    }
    return info;
}

static void same_results(const pupil_t *a, const pupil_t *b)
{
    pupil_exposure exposure[2];
    pupil_stats stats[2];
    pupil_curve curve[2];
    CHECK(pupil_get_exposure(a, &exposure[0]) == PUPIL_OK && pupil_get_exposure(b, &exposure[1]) == PUPIL_OK);
    CHECK(memcmp(&exposure[0], &exposure[1], sizeof *exposure) == 0);
    CHECK(pupil_get_stats(a, &stats[0]) == PUPIL_OK && pupil_get_stats(b, &stats[1]) == PUPIL_OK);
    CHECK(memcmp(&stats[0], &stats[1], sizeof *stats) == 0);
    CHECK(pupil_get_curve(a, NULL, &curve[0]) == PUPIL_OK && pupil_get_curve(b, NULL, &curve[1]) == PUPIL_OK);
    CHECK(memcmp(&curve[0], &curve[1], sizeof *curve) == 0);
}

/* pupil_meter leaves the object in the state of pupil_process, byte for byte; frames of both kinds may alternate. */
static void check_meter(uint32_t law, uint32_t order, uint32_t pixel)
{
    static pupil_t processed, metered;
    pupil_config config;
    uint32_t width = WIDTH, height = HEIGHT;
    frame_fit(pixel, &width, &height);
    frame in = frame_make(width, height, pixel, 0, 0), out = frame_make(width, height, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image to = frame_writable(&out);
    pupil_config_default(&config);
    config.law = law;
    config.order = order;
    config.grey_world = 1;
    CHECK(pupil_init(&processed, &config) == PUPIL_OK && pupil_init(&metered, &config) == PUPIL_OK);
    for (int i = 0; i < 9; i++) {
        const pupil_frame_info info = info_of(i), *known = i % 4 == 2 ? NULL : &info;
        draw(&in, i);
        CHECK(pupil_process(&processed, &in.image, known, &to) == PUPIL_OK);
        CHECK((i % 3 == 1 ? pupil_process(&metered, &in.image, known, &to) : pupil_meter(&metered, &in.image, known)) ==
              PUPIL_OK);
        CHECK_MSG(memcmp(&processed, &metered, sizeof processed) == 0, "law %u, order %u, format %u, frame %d", law,
                  order, pixel, i);
    }
    frame_free(&in);
    frame_free(&out);
}

static void check_fork(uint32_t law, uint32_t order)
{
    pupil_config config;
    pupil_t *original = malloc(sizeof *original), *fork = malloc(sizeof *fork);
    unsigned char *saved = malloc(sizeof *original + 1); /* odd address: only bytes are copied */
    frame in = frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGBA32F, 0, 0);
    frame out[2] = {frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGBA8, 0, 0),
                    frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGBA8, 0, 0)};
    const pupil_image to[2] = {frame_writable(&out[0]), frame_writable(&out[1])};
    if (!original || !fork || !saved)
        abort();
    pupil_config_default(&config);
    config.law = law;
    config.order = order;
    memset(original, 0xa5, sizeof *original);
    CHECK(pupil_init(original, &config) == PUPIL_OK);
    for (int i = 0; i < 24; i++) {
        const pupil_frame_info info = info_of(i);
        draw(&in, i);
        if (i == 9 || i == 15) {
            memcpy(saved + 1, original, sizeof *original);
            memset(fork, 0x5a, sizeof *fork);
            memcpy(fork, saved + 1, sizeof *fork);
        }
        CHECK(pupil_process(original, &in.image, &info, &to[0]) == PUPIL_OK);
        if (i < 9)
            continue;
        CHECK(pupil_process(fork, &in.image, &info, &to[1]) == PUPIL_OK);
        CHECK_MSG(memcmp(out[0].memory, out[1].memory, out[0].bytes) == 0, "law %u, order %u, frame %d", law, order, i);
        same_results(original, fork);
    }
    CHECK(memcmp(original, fork, sizeof *fork) == 0);
    frame_free(&in);
    frame_free(&out[0]);
    frame_free(&out[1]);
    free(original);
    free(fork);
    free(saved);
}

/* In fused order a frame is mapped with the curve from before it; the first one exactly. */
static void check_lag(void)
{
    pupil_config config;
    pupil_t exact, fused;
    frame in = frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGB32F, 0, 0);
    frame out[2] = {frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGB8, 0, 0),
                    frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGB8, 0, 0)};
    const pupil_image to[2] = {frame_writable(&out[0]), frame_writable(&out[1])};
    pupil_config_default(&config);
    CHECK(pupil_init(&exact, &config) == PUPIL_OK);
    config.order = PUPIL_ORDER_FUSED;
    CHECK(pupil_init(&fused, &config) == PUPIL_OK);
    for (int i = 0; i < 20; i++) {
        const pupil_frame_info info = info_of(i);
        pupil_curve curve;
        pupil_exposure a, b;
        draw(&in, i);
        if (i == 12)
            CHECK(pupil_reset(&exact) == PUPIL_OK && pupil_reset(&fused) == PUPIL_OK);
        const int before = pupil_get_curve(&fused, &info, &curve);
        CHECK(before == (i == 0 || i == 12 ? PUPIL_ERR_NO_EXPOSURE : PUPIL_OK));
        CHECK(pupil_process(&fused, &in.image, &info, &to[0]) == PUPIL_OK);
        CHECK(pupil_process(&exact, &in.image, &info, &to[1]) == PUPIL_OK);
        if (before == PUPIL_OK)
            CHECK(pupil_map_rows(&fused, &curve, &in.image, &to[1]) == PUPIL_OK);
        CHECK_MSG(memcmp(out[0].memory, out[1].memory, out[0].bytes) == 0, "frame %d", i);
        CHECK(pupil_get_exposure(&exact, &a) == PUPIL_OK && pupil_get_exposure(&fused, &b) == PUPIL_OK);
        CHECK_MSG(memcmp(&a, &b, sizeof a) == 0, "frame %d: the state does not depend on the order", i);
    }
    frame_free(&in);
    frame_free(&out[0]);
    frame_free(&out[1]);
}

/* After reset the object behaves as a new one. */
static void check_reset(void)
{
    pupil_config config;
    pupil_t used, fresh;
    frame in = frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGB32F, 0, 0), out[2];
    for (int i = 0; i < 2; i++)
        out[i] = frame_make(WIDTH, HEIGHT, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image to[2] = {frame_writable(&out[0]), frame_writable(&out[1])};
    pupil_config_default(&config);
    CHECK(pupil_init(&used, &config) == PUPIL_OK && pupil_init(&fresh, &config) == PUPIL_OK);
    for (int i = 0; i < 12; i++) {
        const pupil_frame_info info = i < 6 ? info_of(100 + i) : (pupil_frame_info){.timestamp_ns = i};
        draw(&in, i);
        if (i == 6)
            CHECK(pupil_reset(&used) == PUPIL_OK);
        CHECK(pupil_process(&used, &in.image, &info, &to[0]) == PUPIL_OK);
        if (i < 6)
            continue;
        CHECK(pupil_process(&fresh, &in.image, &info, &to[1]) == PUPIL_OK);
        CHECK(memcmp(out[0].memory, out[1].memory, out[0].bytes) == 0);
        same_results(&used, &fresh);
    }
    frame_free(&in);
    frame_free(&out[0]);
    frame_free(&out[1]);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t law = 0; law < PUPIL_LAW_COUNT; law++)
        for (uint32_t order = 0; order < PUPIL_ORDER_COUNT; order++)
            check_fork(law, order);
    for (uint32_t law = 0; law < PUPIL_LAW_COUNT; law++)
        for (uint32_t order = 0; order < PUPIL_ORDER_COUNT; order++)
            for (uint32_t pixel = PUPIL_PIXEL_RGBA32F; pixel < PUPIL_PIXEL_COUNT; pixel += 1 + law)
                check_meter(law, order, pixel);
    check_lag();
    check_reset();
    return check_end();
}

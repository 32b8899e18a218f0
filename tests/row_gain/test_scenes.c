/* Row correction gains during events: lamps switched off, settings that step, strobes, cuts, windows that come into
 * view, clocks that go back, invalid frames. Gains may come late; they must not make bands.
 */
#include "lamp_rig.h"

static rig_camera c;

static double worse(const rig_seen *s)
{
    return fmax(s->after - s->before, s->day_after - s->day_before);
}

static pupil_row_gain_result result(void)
{
    pupil_row_gain_result r;
    CHECK(pupil_row_gain_get(&c.lamps, &r) == PUPIL_OK);
    return r;
}

/* A camera whose gains are on. */
static void settle(const rig *r)
{
    rig_seen seen = {0};
    rig_open(&c, r);
    for (int i = 0; i < 60; i++)
        seen = rig_next(&c);
    CHECK_MSG(seen.after < 0.02 && seen.before > 0.8, "%g of %g", seen.after, seen.before);
}

/* Takes so many frames; returns the most that gains add in one of them, and the number of frames until they always add
 * less than 0.01 EV. */
static double follow(const char *name, int frames, int *until)
{
    double most = 0;
    *until = 0;
    for (int i = 0; i < frames; i++) {
        const rig_seen seen = rig_next(&c);
        most = fmax(most, worse(&seen));
        if (worse(&seen) > 0.01)
            *until = i + 1;
    }
    const pupil_row_gain_result r = result();
    printf("%-44s gains add at most %.3f EV, for %d frames; after %d: strength %.2f, reason %u\n", name, most, *until,
           frames, r.strength, r.reason);
    return most;
}

static void check_events(void)
{
    const rig r = rig_default();
    int until;
    settle(&r);
    c.r.modulation = 0;
    CHECK(follow("lamps go off", 60, &until) <= 0.01);
    CHECK(result().strength == 0);
    settle(&r);
    c.r.modulation = 0, c.brightness = 0.3;
    CHECK(follow("lamps go off, daylight stays", 60, &until) <= 0.01);
    settle(&r);
    c.r.exposure_s = 5e-3;
    CHECK(follow("exposure from 1 to 5 ms", 30, &until) <= 0.01);
    CHECK(result().strength > 0.9);
    c.r.exposure_s = 1e-2;
    CHECK(follow("exposure to 10 ms", 30, &until) <= 0.01);
    CHECK(result().strength == 0 && result().reason == PUPIL_ROW_GAIN_LONG);
    settle(&r);
    c.brightness = 2;
    CHECK(follow("gain doubled", 5, &until) <= 0.01);
    CHECK(result().strength == 1);
    settle(&r);
    c.scene_x += 100;
    CHECK(follow("a cut", 30, &until) <= 0.01);
    CHECK(result().strength > 0.9);
}

static void check_flashes(void)
{
    const rig r = rig_default();
    int until;
    settle(&r);
    double most = 0;
    for (int i = 0; i < 8; i++) {
        c.flash = 20 * check_uniform();
        c.flash_from = (int)(RIG_H * check_uniform());
        most = fmax(most, follow("a strobe", 8, &until));
    }
    CHECK_MSG(most <= 0.01, "strobes: %g", most);
    CHECK(follow("... and none", 30, &until) <= 0.01);
    CHECK(result().strength > 0.9);
}

/* A band over the first part of the window cannot at once be distinguished from a change of the scene: it takes a tenth
 * of a second, on a thirtieth of the picture. */
static void check_pan_into_window(const char *name, int frames_before)
{
    const rig r = rig_default();
    double most = 0;
    int last = 0;
    settle(&r);
    c.r.pan_px = 1;
    for (int i = 0; i < frames_before; i++)
        (void)rig_next(&c);
    CHECK(result().strength > 0.9);
    c.r.day_inside = 1, c.r.x0 = 1, c.r.x1 = 1, c.r.y1 = 1;
    for (int i = 0; i < 60; i++) {
        c.r.x0 -= 1.0 / RIG_W;
        const rig_seen seen = rig_next(&c);
        most = fmax(most, worse(&seen));
        if (worse(&seen) > 0.01)
            last = i + 1;
    }
    printf("%-44s gains add at most %.3f EV, for %d frames, on %.3f of the picture\n", name, most, last,
           (double)last / RIG_W);
    CHECK(last <= 4);
    CHECK(result().strength == 0);
}

static void check_windows(void)
{
    const rig r = rig_default();
    int until;
    settle(&r);
    c.r.day_inside = 1, c.r.x0 = 0.6, c.r.x1 = 0.93, c.r.y1 = 1;
    CHECK(follow("daylight on a third, at once", 60, &until) <= 0.01);
    CHECK(result().strength == 0);
    c.r.day_inside = 0;
    (void)follow("... and gone", 45, &until);
    CHECK(result().strength > 0.9);

    check_pan_into_window("a pan into a window", 0);
    check_pan_into_window("... that had begun before", 40);
}

static int all_one(void)
{
    for (int y = 0; y < RIG_H; y++)
        if (c.gain[y] != 1.0f)
            return 0;
    return 1;
}

static int are_sane(const float *gain, int count)
{
    for (int y = 0; y < count; y++)
        if (!(gain[y] >= 1.0f / 16 && gain[y] <= 16.0f))
            return 0;
    return 1;
}

static void check_clocks(void)
{
    const rig r = rig_default();
    settle(&r);
    const pupil_row_gain before = c.lamps;
    CHECK(pupil_row_gain_frame(&c.lamps, &c.image, &c.info) == PUPIL_OK); /* the same timestamp */
    CHECK(memcmp(&before, &c.lamps, sizeof before) == 0 && result().strength == 1);
    CHECK(pupil_row_gain_of_rows(&c.lamps, &c.info, RIG_H, c.gain) == PUPIL_OK);
    CHECK(!all_one());

    static const int64_t steps[] = {-1, -1000000000, 10000000000, INT64_MIN, INT64_MAX};
    for (int i = 0; i < 5; i++) {
        pupil_frame_info info = c.info;
        c.lamps = before;
        info.timestamp_ns = i < 3 ? info.timestamp_ns + steps[i] : steps[i];
        CHECK(pupil_row_gain_of_rows(&c.lamps, &info, RIG_H, c.gain) == PUPIL_OK && all_one());
        CHECK(pupil_row_gain_frame(&c.lamps, &c.image, &info) == PUPIL_OK);
        CHECK(result().strength == 0 && result().reason == PUPIL_ROW_GAIN_WAITING);
        CHECK(pupil_row_gain_of_rows(&c.lamps, &info, RIG_H, c.gain) == PUPIL_OK && all_one());
    }
    c.lamps = before;
    pupil_frame_info info = {0};
    CHECK(pupil_row_gain_frame(&c.lamps, &c.image, &info) == PUPIL_OK && result().strength == 0);
    static const int64_t ends[] = {INT64_MAX, INT64_MIN + 33000000}; /* 33 ms later only if integers wrap */
    for (int i = 0; i < 2; i++) {
        info.timestamp_ns = ends[i];
        CHECK(pupil_row_gain_frame(&c.lamps, &c.image, &info) == PUPIL_OK);
        CHECK(result().disagreement == 1 && result().flicker_ev == 0); /* a first frame */
    }

    /* the next frame's gains, before it is metered */
    settle(&r);
    float ahead[RIG_H];
    const pupil_row_gain now = c.lamps;
    (void)rig_next(&c);
    CHECK(pupil_row_gain_of_rows(&now, &c.info, RIG_H, ahead) == PUPIL_OK);
    double off = 0;
    for (int y = 0; y < RIG_H; y++)
        off = fmax(off, fabs(log2((double)ahead[y] / (double)c.gain[y])));
    printf("a frame ahead: gains differ by at most %.4f EV\n", off);
    CHECK(off < 0.01);
}

/* Random pixels: gains are finite, and 1 without light. */
static void check_odd_frames(void)
{
    static float odd[80][80];
    pupil_image_const image = {.data = odd, .stride_bytes = sizeof odd[0], .width = 80, .height = 80};
    pupil_row_gain_config config;
    pupil_row_gain_config_default(&config);
    CHECK(pupil_row_gain_init(&c.lamps, &config) == PUPIL_OK);
    image.pixel = PUPIL_PIXEL_RGBA32F;
    image.width = 20;
    for (int kind = 0; kind < 4; kind++)
        for (int i = 0; i < 40; i++) {
            for (int k = 0; k < 80 * 80; k++) {
                const uint32_t bits = (uint32_t)check_random();
                const float any = (float)check_uniform();
                memcpy(&odd[k / 80][k % 80], kind == 0 ? (const void *)&bits : (const void *)&any, sizeof(float));
                if (kind == 1)
                    odd[k / 80][k % 80] = NAN;
                if (kind == 2)
                    odd[k / 80][k % 80] = 0;
            }
            if (kind == 3) /* wide enough to be analysed */
                image.pixel = PUPIL_PIXEL_GREY8, image.width = 200;
            const pupil_frame_info info = {.timestamp_ns = 1 + i * 33000000, .exposure_s = kind == 3 ? NAN : 1e-3};
            float gain[80];
            CHECK(pupil_row_gain_frame(&c.lamps, &image, &info) == PUPIL_OK);
            CHECK(pupil_row_gain_of_rows(&c.lamps, &info, 80, gain) == PUPIL_OK);
            CHECK(are_sane(gain, 80));
            if (kind < 3)
                CHECK(gain[0] == 1 && result().strength == 0);
        }
    /* one pixel */
    const pupil_frame_info info = {.timestamp_ns = 1};
    float gain;
    image.width = image.height = 1;
    CHECK(pupil_row_gain_frame(&c.lamps, &image, &info) == PUPIL_OK);
    CHECK(pupil_row_gain_of_rows(&c.lamps, &info, 1, &gain) == PUPIL_OK && gain == 1);
}

static void check_refusals(void)
{
    pupil_row_gain_config config;
    const char *why = 0;
    pupil_row_gain other = {{0}};
    pupil_frame_info info = {0};
    float gain[4];
    pupil_row_gain_config_default(&config);
    CHECK(pupil_row_gain_config_check(&config, &why) == PUPIL_OK && !why);
    config.mains_hz = 100;
    CHECK(pupil_row_gain_config_check(&config, &why) == PUPIL_ERR_CONFIG && strstr(why, "mains_hz"));
    CHECK(pupil_row_gain_init(&other, &config) == PUPIL_ERR_CONFIG);
    config.mains_hz = 60, config.readout_s = NAN;
    CHECK(pupil_row_gain_config_check(&config, &why) == PUPIL_ERR_CONFIG && strstr(why, "readout_s"));
    config.readout_s = 0.01, config.size_bytes = 1;
    CHECK(pupil_row_gain_config_check(&config, &why) == PUPIL_ERR_CONFIG && strstr(why, "size_bytes"));
    CHECK(pupil_row_gain_config_check(NULL, &why) == PUPIL_ERR_NULL);
    CHECK(pupil_row_gain_init(NULL, &config) == PUPIL_ERR_NULL && pupil_row_gain_init(&other, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_row_gain_of_rows(&other, &info, 4, gain) == PUPIL_ERR_OBJECT);
    CHECK(pupil_row_gain_frame(&other, &c.image, &info) == PUPIL_ERR_OBJECT);
    CHECK(pupil_row_gain_of_rows(&c.lamps, &info, 0, gain) == PUPIL_ERR_SIZE);
    CHECK(pupil_row_gain_of_rows(&c.lamps, NULL, 4, gain) == PUPIL_ERR_NULL);
    CHECK(pupil_row_gain_frame(&c.lamps, NULL, &info) == PUPIL_ERR_NULL);
    pupil_image_const image = c.image;
    image.pixel = 999;
    CHECK(pupil_row_gain_frame(&c.lamps, &image, &info) == PUPIL_ERR_PIXEL);
    image = c.image;
    image.stride_bytes = 2;
    CHECK(pupil_row_gain_frame(&c.lamps, &image, &info) == PUPIL_ERR_STRIDE);
}

/* A copy continues as the object does. */
static void check_fork(void)
{
    static rig_camera twin;
    const rig r = rig_default();
    settle(&r);
    memcpy(&twin, &c, sizeof c);
    for (int i = 0; i < 5; i++) {
        (void)rig_next(&c);
        CHECK(pupil_row_gain_frame(&twin.lamps, &c.image, &c.info) == PUPIL_OK);
    }
    CHECK(memcmp(&twin.lamps, &c.lamps, sizeof c.lamps) == 0);
    printf("sizeof(pupil_row_gain): %zu bytes\n", sizeof c.lamps);
    CHECK(sizeof c.lamps == PUPIL_ROW_GAIN_OBJECT_BYTES);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    rig_make_wall();
    check_events();
    check_flashes();
    check_windows();
    check_clocks();
    check_fork();
    check_refusals();
    check_odd_frames();
    return check_end();
}

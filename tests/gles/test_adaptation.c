/* The GPU's integer level compared with pupil_adapt over 10,000 frames (2,000 if frames are slow) of steps, ramps,
 * flicker, every dt, exposure and gain, locks and limits; and the picture mapped with it. */
#include <math.h>

#include "frames.h"
#include "gl_test.h"
#include "pupil/gles.h"

#define SECOND_NS UINT64_C(1000000000)
#define SIDE      2

typedef struct light {
    double ev; /* of the scene */
    pupil_frame_info info;
} light;

/* The next frame's time and light: mostly ordinary, some late, simultaneous, or back in time; steps, ramps, flicker. */
static void move(light *l, unsigned number, double frame_s)
{
    const double r = check_uniform();
    double dt_s = frame_s;
    if (r < 0.01)
        dt_s = r < 0.002 ? 0.0 : r < 0.004 ? -0.1 : r < 0.006 ? 100.0 : 3.0 * frame_s;
    l->info.timestamp_ns += (int64_t)(dt_s * 1e9);
    l->info.sequence = number;
    if (number % 400 == 399)
        l->ev = 24.0 * check_uniform() - 12.0;
    else if (number / 400 % 3 == 1)
        l->ev += 0.02 * (check_uniform() - 0.4);
    else if (number / 400 % 3 == 2)
        l->ev += number % 2 ? 0.5 : -0.5;
    if (number % 1000 == 500) {
        l->info.exposure_s = check_uniform() < 0.3 ? 0.0 : exp2(-10.0 * check_uniform());
        l->info.gain = exp2(4.0 * check_uniform());
    }
}

/* A gradient around the light, after the frame's exposure. */
static void draw(frame *f, const light *l)
{
    const double taken = l->info.exposure_s > 0.0 ? l->info.exposure_s * l->info.gain : 1.0;
    const double middle = exp2(l->ev) * (taken > 0.0 ? taken : 1.0);
    frame_gradient(f, middle / 8.0, middle * 8.0);
}

typedef struct pair {
    gl_test *test;
    pupil_gles gles;
    pupil_t follows, alone; /* by the GPU's statistics; by the CPU's own */
    double law, whole;      /* the largest differences so far, in stops */
    int most_codes;
    uint64_t samples, off;
} pair;

static void compare_levels(pair *p)
{
    pupil_exposure follows, alone;
    pupil_gles_status status;
    CHECK(pupil_gles_get_status(&p->gles, &status) == PUPIL_OK && status.level_known);
    CHECK(pupil_get_exposure(&p->follows, &follows) == PUPIL_OK && pupil_get_exposure(&p->alone, &alone) == PUPIL_OK);
    const double level = (double)status.level_q24 * 0x1p-24;
    const double law = fabs(level - follows.adapted_ev), whole = fabs(level - alone.adapted_ev);
    p->law = law > p->law ? law : p->law;
    p->whole = whole > p->whole ? whole : p->whole;
}

static void compare_pictures(pair *p, const frame *f, const light *l)
{
    static uint8_t gpu[SIDE * SIDE * 4], cpu[SIDE * SIDE * 4];
    const pupil_image out = {
        .data = cpu, .stride_bytes = SIDE * 4, .width = SIDE, .height = SIDE, .pixel = PUPIL_PIXEL_RGBA8};
    const pupil_gles_target target = {
        .framebuffer = gl_test_framebuffer(p->test, SIDE, SIDE), .width = SIDE, .height = SIDE, .top_first = 1};
    pupil_curve curve;
    CHECK(pupil_get_curve(&p->follows, &l->info, &curve) == PUPIL_OK);
    CHECK(pupil_map_rows(&p->follows, &curve, &f->image, &out) == PUPIL_OK);
    CHECK(pupil_gles_map(&p->gles, NULL, &target) == PUPIL_OK);
    gl_test_read(p->test, gpu);
    p->samples += sizeof gpu;
    for (size_t i = 0; i < sizeof gpu; i++) {
        const int off = abs(gpu[i] - cpu[i]);
        p->off += off != 0;
        p->most_codes = off > p->most_codes ? off : p->most_codes;
    }
}

static void step(pair *p, const frame *f, const light *l, unsigned number)
{
    pupil_stats stats;
    pupil_frame_info info;
    CHECK(pupil_gles_upload(&p->gles, &f->image) == PUPIL_OK);
    CHECK(pupil_gles_meter(&p->gles, &l->info) == PUPIL_OK);
    CHECK(pupil_gles_collect(&p->gles, 60 * SECOND_NS, &stats, &info) == PUPIL_OK);
    CHECK(info.sequence == number);
    CHECK(pupil_adapt(&p->follows, &stats, &info) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&p->alone, &f->image, 0, SIDE, &stats) == PUPIL_OK);
    CHECK(pupil_adapt(&p->alone, &stats, &l->info) == PUPIL_OK);
    compare_levels(p);
    if (number % 97 == 0)
        compare_pictures(p, f, l);
}

static void open_pair(pair *p, const pupil_config *config)
{
    pupil_gles_config gles_config;
    pupil_why why = {""};
    pupil_gles_config_default(&gles_config);
    gles_config.pixel = PUPIL_PIXEL_RGB32F;
    gles_config.width = gles_config.height = SIDE;
    gles_config.adapt = PUPIL_GLES_ADAPT_GPU;
    CHECK(pupil_init(&p->follows, config) == PUPIL_OK && pupil_init(&p->alone, config) == PUPIL_OK);
    const int error = pupil_gles_init(&p->gles, &gles_config, &p->follows, pupil_egl_get_proc, &why);
    CHECK_MSG(error == PUPIL_OK, "%s", why.text);
}

/* New settings halfway, then another object takes over: the level continues. */
static void change(pair *p, pupil_config *config, unsigned number, unsigned frames)
{
    if (number == frames / 4) {
        config->lock = 1;
    } else if (number == frames / 4 + 50) {
        config->lock = 0;
        config->ev_min = -3.0;
        config->ev_max = 4.5;
    } else if (number == frames / 2) {
        config->ev_min = -32.0;
        config->ev_max = 32.0;
        config->calibration = 12.5;
        pupil_metering_centre(config);
    } else {
        return;
    }
    CHECK(pupil_retune(&p->follows, config) == PUPIL_OK && pupil_retune(&p->alone, config) == PUPIL_OK);
    CHECK(pupil_gles_retune(&p->gles, &p->follows, NULL) == PUPIL_OK);
}

static void run(gl_test *test, const char *what, double frame_s, double tau_light_s, double tau_dark_s, unsigned frames)
{
    static pair p;
    pupil_config config;
    light l = {.ev = 2.0, .info = {.timestamp_ns = 1}};
    p = (pair){.test = test};
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_FIXED;
    config.flicker = 0; /* light that alternates from frame to frame at 240 frames a second is a lamp at 60 Hz */
    config.white = 4.0;
    config.tau_light_s = tau_light_s;
    config.tau_dark_s = tau_dark_s;
    open_pair(&p, &config);
    frame f = frame_make(SIDE, SIDE, PUPIL_PIXEL_RGB32F, 0, 0);
    for (unsigned i = 0; i < frames; i++) {
        move(&l, i, frame_s);
        change(&p, &config, i, frames);
        draw(&f, &l);
        step(&p, &f, &l, i);
    }
    frame_free(&f);
    pupil_gles_close(&p.gles);
    printf("%-22s %u frames: law %.1e stops, law and metering %.1e; %llu of %llu samples off, by %d at most\n", what,
           frames, p.law, p.whole, (unsigned long long)p.off, (unsigned long long)p.samples, p.most_codes);
    CHECK_MSG(p.law <= 2e-6, "%s: %g stops", what, p.law);
    CHECK_MSG(p.whole <= 2e-6 + 1e-5 / log(2.0), "%s: %g stops", what, p.whole);
    CHECK_MSG(p.most_codes <= 1 && (double)p.off <= 1e-4 * (double)p.samples, "%s: %llu samples", what,
              (unsigned long long)p.off);
}

int main(int argc, char **argv)
{
    static gl_test test;
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_BEST);
    if (status)
        return status;
    const unsigned share = gl_test_interprets() || CHECK_SANITIZED ? 5 : 1;
    run(&test, "30 fps", 1.0 / 30.0, 0.3, 0.9, 10000 / share);
    run(&test, "240 fps, slow", 1.0 / 240.0, 2.0, 20.0, 1000 / share);
    run(&test, "1 fps, at once", 1.0, 0.0, 0.1, 500 / share);
    gl_test_close(&test);
    return check_end();
}

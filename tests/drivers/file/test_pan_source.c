/* A camera in a panorama: resampling preserves light, edges and poles are invisible, the path goes where it should. */
#include "scratch.h"

#include "file/pan/pan_path.h"
#include "file/pan/pan_source.h"

static const double pi = 3.14159265358979323846;
static pupil_why why;

typedef void paint(double yaw, double pitch, uint32_t x, uint32_t y, float rgb[3]);

/* A panorama of 2n x n texels, each painted at its centre's direction (radians). */
static pupil_panorama make(uint32_t n, paint *at)
{
    pupil_panorama p;
    pupil_still still = {0};
    still.width = 2 * n;
    still.height = n;
    still.pixel = PUPIL_PIXEL_RGB32F;
    float *texel = still.pixels = malloc((size_t)n * n * 2 * 3 * sizeof(float));
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < 2 * n; x++, texel += 3)
            at(((x + 0.5) / n - 1) * pi, (0.5 - (y + 0.5) / n) * pi, x, y, texel);
    CHECK_MSG(pupil_panorama_make(&p, &still, &why) == 0, "%s", why.text);
    free(still.pixels);
    return p;
}

static void direction(double yaw, double pitch, double d[3])
{
    d[0] = sin(yaw) * cos(pitch);
    d[1] = sin(pitch);
    d[2] = cos(yaw) * cos(pitch);
}

static void constant(double yaw, double pitch, uint32_t x, uint32_t y, float rgb[3])
{
    (void)yaw, (void)pitch, (void)x, (void)y;
    rgb[0] = 0.1f;
    rgb[1] = 1234.567f;
    rgb[2] = -3e-5f;
}

static void smooth(double yaw, double pitch, uint32_t x, uint32_t y, float rgb[3])
{
    double d[3];
    (void)x, (void)y;
    direction(yaw, pitch, d);
    rgb[0] = (float)(2 + d[0] + 0.5 * d[1]);
    rgb[1] = (float)(2 + d[1] * d[2]);
    rgb[2] = (float)(2 + d[2] - d[0] * d[1]);
}

static void checker(double yaw, double pitch, uint32_t x, uint32_t y, float rgb[3])
{
    (void)yaw, (void)pitch;
    rgb[0] = rgb[1] = rgb[2] = (x + y) & 1 ? 1.0f : 0.0f;
}

static void random_texels(double yaw, double pitch, uint32_t x, uint32_t y, float rgb[3])
{
    (void)yaw, (void)pitch, (void)x, (void)y;
    for (int i = 0; i < 3; i++)
        rgb[i] = (float)check_uniform();
}

static pupil_view random_view(void)
{
    pupil_view view = {check_uniform() * 360 - 180, check_uniform() * 180 - 90, 20 + check_uniform() * 100};
    return view;
}

static void test_constant(void)
{
    float pixels[48 * 27 * 3];
    for (uint32_t n = 1; n <= 1024; n *= 4) { /* from magnified to 13 points a side */
        pupil_panorama p = make(n, constant);
        for (int k = 0; k < 20; k++) {
            unsigned long wrong = 0;
            pupil_view view = random_view();
            view.pitch = k < 2 ? 90 - 180 * k : view.pitch;
            pupil_panorama_render(&p, view, pixels, 48, 27);
            for (int i = 0; i < 48 * 27 * 3; i += 3)
                wrong += pixels[i] != 0.1f || pixels[i + 1] != 1234.567f || pixels[i + 2] != -3e-5f;
            CHECK_MSG(wrong == 0, "panorama of %u rows, %lu pixels differ", n, wrong);
        }
        pupil_panorama_free(&p);
    }
}

/* The camera's geometry, implemented again in double. */
static void pixel_direction(pupil_view v, int width, int height, double x, double y, double *yaw, double *pitch)
{
    double focal = width / 2.0 / tan(v.fov / 2 * pi / 180), p = v.pitch * pi / 180, d[3];
    double right = x - width / 2.0, up = height / 2.0 - y;
    d[2] = focal * cos(p) - up * sin(p); /* pitched in the yz plane, then turned */
    d[1] = focal * sin(p) + up * cos(p);
    *yaw = v.yaw * pi / 180 + atan2(right, d[2]);
    *pitch = atan2(d[1], hypot(right, d[2]));
}

static void test_smooth(void)
{
    static float pixels[128 * 72 * 3];
    pupil_panorama p = make(512, smooth);
    for (int k = 0; k < 30; k++) {
        pupil_view view = random_view();
        double worst = -1;
        view.fov = k % 2 ? 40 : 90;
        view.pitch = k < 2 ? 90 - 180 * k : view.pitch;
        pupil_panorama_render(&p, view, pixels, 128, 72);
        for (int y = 0; y < 72; y++)
            for (int x = 0; x < 128; x++) {
                double yaw, pitch;
                float want[3];
                pixel_direction(view, 128, 72, x + 0.5, y + 0.5, &yaw, &pitch);
                smooth(yaw, pitch, 0, 0, want);
                /* A pixel is at most 1/64 rad wide: its mean differs from its centre by under (1/64)^2 / 24 * |second
                 * derivative| (2) in each of two directions, 4e-5; the texels add (2 pi / 1024)^2 / 8 * 2, 1e-5. Near
                 * the poles rows are averaged over an arc of half a texel, (pi / 512) / 2 / cos(pitch) of longitude;
                 * its mean is by the arc's square / 24 inward, times the slope (under 1.5). */
                double flat = fmax(cos(pitch), sin(pi / 1024)), arc = pi / 512 / 2 / flat;
                double allowed = 5e-5 + arc * arc / 24 * flat * 1.5;
                for (int i = 0; i < 3; i++)
                    worst = fmax(worst, fabs((double)pixels[(y * 128 + x) * 3 + i] - (double)want[i]) - allowed);
            }
        CHECK_MSG(worst <= 0, "view %d (%g/%g/%g): %g too far off", k, view.yaw, view.pitch, view.fov, worst);
    }
    pupil_panorama_free(&p);
}

/* No jumps: two directions 1e-4 rad apart differ by at most what the steepest slope between random texels allows. Near
 * a pole that slope is bounded because rows are averaged there. */
static void test_seams(void)
{
    pupil_panorama p = make(64, random_texels);
    for (int k = 0; k < 4000; k++) {
        double yaw = k % 2 ? pi - 5e-5 : check_uniform() * 2 * pi, pitch = (check_uniform() - 0.5) * pi, a[3], b[3];
        float from[3], to[3], one[3], other[3];
        if (k % 2 == 0)
            pitch = (k % 4 ? 1 : -1) * (pi / 2 - 5e-5);
        direction(yaw, pitch, a);
        direction(k % 2 ? yaw + 1e-4 : yaw + pi, pitch, b);
        for (int i = 0; i < 3; i++) {
            from[i] = (float)a[i];
            to[i] = (float)b[i];
        }
        pupil_panorama_sample(&p, from, one);
        pupil_panorama_sample(&p, to, other);
        /* A texel is pi / 64 rad high; at the poles the slope along a row is at most twice that between rows. */
        CHECK_MSG(fabsf(one[0] - other[0]) < 1e-4f * 64 / 3.14f * 4, "yaw %g pitch %g: %g and %g", yaw, pitch,
                  (double)one[0], (double)other[0]);
    }
    pupil_panorama_free(&p);
}

/* The finest pattern, reduced: grey, and equally grey from one step of the camera to the next. */
static void test_checker(void)
{
    float pixels[64 * 36 * 3];
    pupil_panorama p = make(2048, checker);
    double least = 1, most = 0, sum = 0;
    for (int k = 0; k < 40; k++) {
        pupil_view view = {k * 0.11, 3 + k * 0.07, 75};
        pupil_panorama_render(&p, view, pixels, 64, 36); /* 15.6 texels a pixel */
        for (int i = 0; i < 64 * 36 * 3; i += 3) {
            least = fmin(least, (double)pixels[i]);
            most = fmax(most, (double)pixels[i]);
            sum += (double)pixels[i] / (64 * 36 * 40);
        }
    }
    CHECK_MSG(fabs(sum - 0.5) < 1e-4, "mean %g", sum);
    /* Half a texel more of one colour along two edges of a pixel of 15.6 x 15.6 texels is at most 1/31 of it. */
    CHECK_MSG(least > 0.5 - 1 / 31.0 && most < 0.5 + 1 / 31.0, "%g to %g", least, most);
    pupil_panorama_free(&p);
}

/* The six sides of a cube see every direction once: their pixels, weighted by solid angle, sum to the same light as the
 * panorama's texels, weighted by theirs. */
static void test_energy(void)
{
    enum { N = 96 };
    static float pixels[N * N * 3];
    static const pupil_view sides[6] = {{0, 0, 90}, {90, 0, 90}, {180, 0, 90}, {-90, 0, 90}, {0, 90, 90}, {0, -90, 90}};
    double camera = 0, texels = 0, weights = 0;
    for (int k = 0; k < 6; k++) {
        check_state.random = check_state.seed; /* the same texels for each side */
        pupil_panorama p = make(256, random_texels);
        pupil_panorama_render(&p, sides[k], pixels, N, N);
        for (int y = 0; y < N; y++)
            for (int x = 0; x < N; x++) {
                double u = (x + 0.5) / (N / 2.0) - 1, v = (y + 0.5) / (N / 2.0) - 1, w = pow(1 + u * u + v * v, -1.5);
                camera += w * (double)pixels[(y * N + x) * 3];
                weights += w;
            }
        if (k == 5)
            for (int y = 0; y < 256; y++) {
                double row = 0, w = cos((0.5 - (y + 0.5) / 256) * pi);
                for (int x = 0; x < 512; x++)
                    row += (double)p.texels[(size_t)(y + 1) * p.row_floats + (size_t)(x + 1) * 3];
                texels += w * row / 512 * pi / 256 / 2;
            }
        pupil_panorama_free(&p);
    }
    camera /= weights;
    CHECK_MSG(fabs(camera - texels) < 1e-3 * texels, "cameras %.6f, texels %.6f", camera, texels);
}

static void odd(double yaw, double pitch, uint32_t x, uint32_t y, float rgb[3])
{
    (void)yaw, (void)pitch;
    rgb[0] = x == 100 && y == 64 ? NAN : 1;
    rgb[1] = x == 100 && y == 64 ? INFINITY : 1;
    rgb[2] = -2;
}

static void test_odd_texels(void)
{
    static float pixels[256 * 128 * 3];
    pupil_panorama p = make(128, odd);
    pupil_view view = {(100.5 / 256 - 0.5) * 360, 0, 90};
    int bad = 0, bright = 0;
    pupil_panorama_render(&p, view, pixels, 256, 128);
    for (int i = 0; i < 256 * 128 * 3; i += 3) {
        bad += isnan(pixels[i]);
        bright += pixels[i + 1] > 1;
        CHECK(!isnan(pixels[i + 1]) && pixels[i + 2] == -2);
    }
    /* In the middle of this picture a texel is (2 pi / 256) rad * 128 px / rad = 3.14 pixels, and it reaches one texel
     * beyond its own half on each side: 6.3 pixels, so at most 7 pixels a side. */
    CHECK_MSG(bad > 0 && bad <= 49 && bright > 0 && bright <= 49, "%d NaN pixels, %d bright", bad, bright);
    pupil_panorama_free(&p);
}

/* --- paths --- */

static int near_view(pupil_view v, double yaw, double pitch, double fov)
{
    return fabs(remainder(v.yaw - yaw, 360)) < 1e-9 && fabs(v.pitch - pitch) < 1e-9 && fabs(v.fov - fov) < 1e-9;
}

static void test_path(void)
{
    pupil_pan_path path;
    CHECK(pupil_pan_path_read(&path, "170/10@1:-170/-20/40@3:0/0@4", 75, &why) == 0);
    pupil_pan_path_finish(&path, 99);
    CHECK(near_view(pupil_pan_path_at(&path, 0), 170, 10, 75) && near_view(pupil_pan_path_at(&path, 1), 170, 10, 75));
    CHECK(near_view(pupil_pan_path_at(&path, 3), -170, -20, 40));
    CHECK(near_view(pupil_pan_path_at(&path, 4), 0, 0, 75) && near_view(pupil_pan_path_at(&path, 9), 0, 0, 75));
    for (double t = 1; t < 3; t += 1 / 64.0) { /* the short way, across 180, and never back */
        double a = pupil_pan_path_at(&path, t).yaw, b = pupil_pan_path_at(&path, t + 1 / 64.0).yaw;
        CHECK(fabs(a) >= 170 - 1e-9 && remainder(b - a, 360) > 0 && remainder(b - a, 360) < 0.5);
    }
    CHECK(pupil_pan_path_read(&path, "0/0:360/0", 75, &why) == 0);
    pupil_pan_path_finish(&path, 8);
    for (int k = 0; k <= 8; k++) /* two keyframes: even speed */
        CHECK(near_view(pupil_pan_path_at(&path, k), 45 * k, 0, 75));
    CHECK(pupil_pan_path_read(&path, "12/-3", 75, &why) == 0);
    pupil_pan_path_finish(&path, 8);
    CHECK(near_view(pupil_pan_path_at(&path, 0), 12, -3, 75) && near_view(pupil_pan_path_at(&path, 5), 12, -3, 75));
}

/* A lamp to the right, a dark corner to the left and above. */
static void lamp(double yaw, double pitch, uint32_t x, uint32_t y, float rgb[3])
{
    double d[3], light[3], dark[3];
    (void)x, (void)y;
    direction(yaw, pitch, d);
    direction(1.5, 0.1, light);
    direction(-1.8, 0.5, dark);
    double a = d[0] * light[0] + d[1] * light[1] + d[2] * light[2],
           b = d[0] * dark[0] + d[1] * dark[1] + d[2] * dark[2];
    rgb[0] = rgb[1] = rgb[2] = (float)(a > 0.9 ? 100 : b > 0.8 ? 0.001 : 0.2);
}

static void test_default_path(void)
{
    pupil_panorama p = make(128, lamp);
    pupil_view light = {0, 0, 0}, dark = {0, 0, 0};
    pupil_pan_path path, other;
    pupil_panorama_extremes(&p, &light, &dark);
    CHECK_MSG(fabs(light.yaw - 1.5 * 180 / pi) < 15 && fabs(light.pitch - 0.1 * 180 / pi) < 15, "%g/%g", light.yaw,
              light.pitch);
    CHECK_MSG(fabs(dark.yaw + 1.8 * 180 / pi) < 15 && fabs(dark.pitch - 0.5 * 180 / pi) < 15, "%g/%g", dark.yaw,
              dark.pitch);
    for (uint64_t seed = 1; seed < 20; seed++) {
        int saw_light = 0, saw_dark = 0;
        pupil_pan_path_draw(&path, seed, light, dark, 75);
        pupil_pan_path_finish(&path, 10);
        for (int k = 0; k <= 300; k++) {
            pupil_view v = pupil_pan_path_at(&path, k / 30.0);
            saw_light |= fabs(remainder(v.yaw - light.yaw, 360)) < 1 && fabs(v.pitch - light.pitch) < 1;
            saw_dark |= fabs(remainder(v.yaw - dark.yaw, 360)) < 1 && fabs(v.pitch - dark.pitch) < 1;
        }
        CHECK_MSG(saw_light && saw_dark, "seed %llu", (unsigned long long)seed);
    }
    pupil_pan_path_draw(&path, 7, light, dark, 75);
    pupil_pan_path_draw(&other, 7, light, dark, 75);
    CHECK(memcmp(&path, &other, sizeof path) == 0);
    pupil_pan_path_draw(&other, 8, light, dark, 75);
    CHECK(memcmp(&path, &other, sizeof path) != 0);
    pupil_panorama_free(&p);
}

/* --- the source --- */

/* A PFM panorama of 2n x n, one colour. */
static const char *file(const char *name, int width, int height)
{
    const char *path = scratch(name);
    FILE *f = fopen(path, "wb");
    fprintf(f, "PF\n%d %d\n-1.0\n", width, height);
    for (int i = 0; i < width * height; i++)
        fwrite((float[3]){1, 2, 3}, sizeof(float), 3, f);
    CHECK(fclose(f) == 0);
    return path;
}

static void test_source(void)
{
    char spec[2048];
    const pupil_source_options asked = {.fps = 24, .width = 32, .height = 18, .frames = 5, .seed = 3};
    pupil_source *source;
    pupil_frame f;
    snprintf(spec, sizeof spec, "pan:%s", file("a, room.pfm", 64, 32)); /* a comma of the file's own */
    CHECK_MSG(pupil_pan_source_open(spec, &asked, &source, &why) == 0, "%s", why.text);
    CHECK(source->frames == 5 && source->fps == 24);
    for (int n = 0; n < 5; n++) {
        CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME);
        CHECK(f.image.width == 32 && f.image.height == 18 && f.image.pixel == PUPIL_PIXEL_RGB32F);
        CHECK(f.info.sequence == (uint64_t)n && f.info.timestamp_ns == (int64_t)(n * 1e9 / 24 + 0.5));
        CHECK(((const float *)f.image.data)[32 * 18 * 3 - 1] == 3 && strstr(f.name, "a, room.pfm"));
        pupil_source_done(source, &f);
    }
    CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_END);
    pupil_source_close(source);
    strcat(spec, ",size=20x10,duration=0.5,fov=90,path=0/0:10/10");
    CHECK_MSG(pupil_pan_source_open(spec, NULL, &source, &why) == 0, "%s", why.text);
    CHECK(source->frames == 15 && source->fps == 30);
    CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME && f.image.width == 20);
    pupil_source_close(source);
    strcpy(strstr(spec, ",size"), ",path=0/0@0:10/10@2");
    CHECK(pupil_pan_source_open(spec, NULL, &source, &why) == 0 && source->frames == 60);
    CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME && f.image.width == 640);
    pupil_source_close(source);
}

static void test_refusals(void)
{
    static const char *const keys[][2] = {{"fov=200", "5 to 150"},
                                          {"fov=", "5 to 150"},
                                          {"size=640", "640x360"},
                                          {"size=64x0", "640x360"},
                                          {"size=1e9x4", "640x360"},
                                          {"duration=0", "seconds"},
                                          {"duration=nan", "seconds"},
                                          {"speed=3", "path, fov, size and duration"},
                                          {"path=", "yaw/pitch"},
                                          {"path=5", "yaw/pitch"},
                                          {"path=5/5:", "yaw/pitch"},
                                          {"path=0/91", "pitch of -90 to 90"},
                                          {"path=0/0/1", "field of view"},
                                          {"path=0/0@1:1/1", "all keyframes or for none"},
                                          {"path=0/0@1:1/1@1", "rise"},
                                          {"path=inf/0", "yaw/pitch"},
                                          {"fov=60,,", "path, fov, size and duration"},
                                          {"fow=60", "path, fov, size and duration"},
                                          {"sise=4x4", "path, fov, size and duration"},
                                          {"durations=4", "path, fov, size and duration"},
                                          {"duration=100000", "seconds, 0.001 to 86400"},
                                          {"duratiom=4", "path, fov, size and duration"},
                                          {"size=ax4", "640x360"},
                                          {"size=4xa", "640x360"},
                                          {"size=0x4", "640x360"},
                                          {"size=4x99999", "640x360"},
                                          {"size=99999x4", "640x360"},
                                          {"size=4.5x4", "640x360"},
                                          {"size=4x4.5", "640x360"},
                                          {"path=36001/0", "a yaw of -36000 to 36000"},
                                          {"path=0/0/151", "field of view"},
                                          {"path=0/x", "yaw/pitch"},
                                          {"path=0/0/x", "yaw/pitch"},
                                          {"path=0/0@x", "yaw/pitch"},
                                          {"path=0/0@-1", "seconds that rise"},
                                          {"path=0/0@90000", "seconds that rise"}};
    char spec[2048];
    pupil_source *source;
    const char *room = file("room.pfm", 8, 4);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        snprintf(spec, sizeof spec, "pan:%s,%s", room, keys[k][0]);
        CHECK(pupil_pan_source_open(spec, NULL, &source, &why) == PUPIL_SOURCE_FAILED);
        CHECK_MSG(strstr(why.text, "room.pfm: ") && strstr(why.text, keys[k][1]), "%s: %s", keys[k][0], why.text);
    }
    snprintf(spec, sizeof spec, "pan:%s,path=", room);
    while (strlen(spec) < sizeof spec - 8)
        strcat(spec, "0/0:");
    CHECK(pupil_pan_source_open(spec, NULL, &source, &why) == PUPIL_SOURCE_FAILED && strstr(why.text, "keyframes"));
    const pupil_source_options large = {.width = PUPIL_MAX_SIDE_PX + 1, .height = 4}, endless = {.fps = 1e6},
                               high = {.width = 4, .height = PUPIL_MAX_SIDE_PX + 1};
    snprintf(spec, sizeof spec, "pan:%s,duration=86400", room);
    CHECK(pupil_pan_source_open(spec, &large, &source, &why) == PUPIL_SOURCE_FAILED && strstr(why.text, "16385 x 4"));
    CHECK(pupil_pan_source_open(spec, &high, &source, &why) == PUPIL_SOURCE_FAILED && strstr(why.text, "4 x 16385"));
    CHECK(pupil_pan_source_open(spec, &endless, &source, &why) == PUPIL_SOURCE_FAILED &&
          strstr(why.text, "at most 1000000000 frames"));
    snprintf(spec, sizeof spec, "pan:%s", file("square.pfm", 8, 8));
    CHECK(pupil_pan_source_open(spec, NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "square.pfm: 8 x 8") && strstr(why.text, "twice as wide"), "%s", why.text);
    CHECK(pupil_pan_source_open("pan:", NULL, &source, &why) == PUPIL_SOURCE_FAILED && strstr(why.text, "room"));
    CHECK(pupil_pan_source_open("pan:absent.hdr,fov=60", NULL, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, "absent.hdr: "), "%s", why.text);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_constant();
    test_smooth();
    test_seams();
    test_checker();
    test_energy();
    test_odd_texels();
    test_path();
    test_default_path();
    test_source();
    test_refusals();
    scratch_clear(scratch_folder);
    return check_end();
}

/* PUPIL_ACCURACY_LUMA on every shared still, and on a chart of saturated hues, as from a camera: NV12, exposed for the
 * log-average. How much the log-average and the codes of the picture differ from the exact ones, and how many quads are
 * mapped exactly. The table of docs/numerics.md.
 */
#include "check.h"
#include "file/still/still.h"
#include "frames.h"
#include "pupil/pupil.h"

#include <dirent.h>
#include <math.h>

enum { WIDEST = 960, SCALES = 5 };
static const float scales[SCALES] = {0.25f, 0.5f, 1.0f, 2.0f, 4.0f};

typedef struct differences {
    uint64_t off[256], samples;
} differences;

static double mean_of(const differences *d)
{
    double sum = 0.0;
    for (int i = 0; i < 256; i++)
        sum += i * (double)d->off[i];
    return sum / (double)d->samples;
}

/* The difference that this share of the samples does not exceed. */
static int within(const differences *d, double share)
{
    uint64_t below = d->off[0];
    int i = 0;
    while ((double)below < share * (double)d->samples)
        below += d->off[++i];
    return i;
}

static pupil_t begin(uint32_t accuracy)
{
    pupil_config config;
    pupil_t pupil;
    pupil_config_default(&config);
    config.accuracy = accuracy;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    return pupil;
}

static double level_of(uint32_t accuracy, const pupil_image_const *image)
{
    const pupil_t pupil = begin(accuracy);
    pupil_stats stats;
    double mean = 0.0;
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, image, 0, image->height, &stats) == PUPIL_OK);
    CHECK(pupil_stats_mean(&stats, 0.0, 1.0, &mean) == PUPIL_OK);
    return mean;
}

static double srgb_code(double light)
{
    light = light < 0.0 ? 0.0 : light > 1.0 ? 1.0 : light;
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
}

/* The mean light of factor x factor pixels, times `gain`, as R'G'B'. */
static void codes_at(const pupil_still *still, uint32_t factor, uint32_t x, uint32_t y, double gain, double rgb[3])
{
    const float *pixels = still->pixels;
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t j = 0; j < factor; j++)
        for (uint32_t i = 0; i < factor; i++)
            for (int c = 0; c < 3; c++)
                sum[c] += (double)pixels[3 * ((size_t)(y * factor + j) * still->width + x * factor + i) + (size_t)c];
    for (int c = 0; c < 3; c++)
        rgb[c] = srgb_code(gain * sum[c] / (factor * factor));
}

static uint8_t code_of(double value)
{
    return (uint8_t)(value < 0.0 ? 0.0 : value > 255.0 ? 255.0 : value + 0.5);
}

/* BT.601 of limited range (the default), Cb and Cr of four pixels' mean. */
static frame camera_frame(const pupil_still *still)
{
    const pupil_image_const image = {.data = still->pixels,
                                     .stride_bytes = (ptrdiff_t)(still->width * pupil_pixel_bytes(still->pixel)),
                                     .width = still->width,
                                     .height = still->height,
                                     .pixel = still->pixel};
    const double gain = 0.18 / exp2(level_of(PUPIL_ACCURACY_EXACT, &image));
    const uint32_t factor = (still->width + WIDEST - 1) / WIDEST;
    frame f = frame_make(still->width / factor / 2 * 2, still->height / factor / 2 * 2, PUPIL_PIXEL_NV12, 0, 0);
    uint8_t *luma = (uint8_t *)(uintptr_t)f.image.data, *chroma = (uint8_t *)(uintptr_t)f.image.chroma;
    for (uint32_t y = 0; y < f.image.height; y += 2)
        for (uint32_t x = 0; x < f.image.width; x += 2) {
            double cb = 0.0, cr = 0.0;
            for (uint32_t k = 0; k < 4; k++) {
                double rgb[3];
                codes_at(still, factor, x + k % 2, y + k / 2, gain, rgb);
                const double grey = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
                luma[(ptrdiff_t)(y + k / 2) * f.image.stride_bytes + (ptrdiff_t)(x + k % 2)] =
                    code_of(16.0 + 219.0 * grey);
                cb += (rgb[2] - grey) / 1.772;
                cr += (rgb[0] - grey) / 1.402;
            }
            chroma[(ptrdiff_t)(y / 2) * f.image.chroma_stride_bytes + (ptrdiff_t)x] = code_of(128.0 + 56.0 * cb);
            chroma[(ptrdiff_t)(y / 2) * f.image.chroma_stride_bytes + (ptrdiff_t)x + 1] = code_of(128.0 + 56.0 * cr);
        }
    return f;
}

/* Fully saturated hues along x, brightness along y. */
static void chart(pupil_still *still)
{
    float *pixels = calloc((size_t)640 * 480 * 3, sizeof *pixels);
    *still = (pupil_still){.pixels = pixels, .width = 640, .height = 480, .pixel = PUPIL_PIXEL_RGB32F};
    for (size_t i = 0; pixels && i < (size_t)640 * 480; i++)
        for (int c = 0; c < 3; c++) {
            const double turn = fabs(fmod((double)(i % 640) / 640.0 + (double)c / 3.0, 1.0) * 6.0 - 3.0) - 1.0;
            const double part = turn < 0.0 ? 0.0 : turn > 1.0 ? 1.0 : turn;
            pixels[3 * i + (size_t)c] = (float)(part * exp2(-8.0 * (double)(i / 640) / 480.0));
        }
}

static frame map(const frame *f, uint32_t accuracy, float scale, uint32_t out)
{
    const pupil_t pupil = begin(accuracy);
    const float white = scale > 1.0f ? scale : 1.0f;
    const pupil_curve curve = {
        .scale = scale,
        .inverse_white_squared = 1.0f / (white * white),
        .gamut = white > 1.0f ? 1.0f / (1.0f - PUPIL_GAMUT_KNEE) - 1.0f / (white - PUPIL_GAMUT_KNEE) : 0.0f};
    frame to = frame_make(f->image.width, f->image.height, out, 0, 0);
    const pupil_image target = frame_writable(&to);
    CHECK(pupil_map_rows(&pupil, &curve, &f->image, &target) == PUPIL_OK);
    return to;
}

static void add_plane(const void *one, const void *other, ptrdiff_t stride, size_t bytes, uint32_t rows, differences *d)
{
    for (uint32_t y = 0; y < rows; y++)
        for (size_t i = 0; i < bytes; i++) {
            const ptrdiff_t at = (ptrdiff_t)y * stride + (ptrdiff_t)i;
            d->off[abs(((const uint8_t *)one)[at] - ((const uint8_t *)other)[at])]++;
        }
    d->samples += bytes * rows;
}

/* Codes of RGBA8 (alpha is not counted: it is always the same), or of Y', Cb and Cr. */
static differences compare(const frame *f, float scale, uint32_t out)
{
    differences d = {{0}, 0};
    frame exact = map(f, PUPIL_ACCURACY_EXACT, scale, out), luma = map(f, PUPIL_ACCURACY_LUMA, scale, out);
    const pupil_image_const *a = &exact.image, *b = &luma.image;
    add_plane(a->data, b->data, a->stride_bytes, pupil_row_bytes(out, a->width), a->height, &d);
    if (pupil_pixel_planes(out) > 1)
        add_plane(a->chroma, b->chroma, a->chroma_stride_bytes, pupil_chroma_row_bytes(out, a->width),
                  pupil_chroma_rows(out, a->height), &d);
    else
        d.off[0] -= (uint64_t)a->width * a->height, d.samples -= (uint64_t)a->width * a->height;
    frame_free(&exact);
    frame_free(&luma);
    return d;
}

static void judge(const char *name, const pupil_still *still)
{
    static const struct output {
        const char *name;
        uint32_t pixel;
    } outputs[] = {{"NV12", PUPIL_PIXEL_NV12}, {"RGBA8", PUPIL_PIXEL_RGBA8}};
    frame f = camera_frame(still);
    const double by = level_of(PUPIL_ACCURACY_LUMA, &f.image) - level_of(PUPIL_ACCURACY_EXACT, &f.image);
    printf("%s, %u x %u: log-average off by %+.4f EV\n", name, f.image.width, f.image.height, by);
    CHECK_MSG(fabs(by) <= 0.05, "%s: the log-average is off by %g EV", name, by);
    for (int o = 0; o < 2; o++)
        for (int s = 0; s < SCALES; s++) {
            const differences d = compare(&f, scales[s], outputs[o].pixel);
            const int most = within(&d, 0.99);
            printf("    %-5s at a scale of %-4g: %.2f codes on average, 99 %% within %2d, all within %2d\n",
                   outputs[o].name, (double)scales[s], mean_of(&d), most, within(&d, 1.0));
            if (scales[s] >= 0.5f && scales[s] <= 2.0f)
                CHECK_MSG(mean_of(&d) <= 1.5 && most <= 8, "%s, %s at %g: %g, %d", name, outputs[o].name,
                          (double)scales[s], mean_of(&d), most);
        }
    frame_free(&f);
}

int main(int argc, char **argv)
{
    pupil_still still = {0};
    struct dirent *entry;
    char folder[4096], path[8192];
    check_begin(argc, argv);
    chart(&still);
    CHECK(still.pixels != NULL);
    judge("hues", &still);
    pupil_still_free(&still);
    if (!check_shared())
        return check_cannot("no shared images");
    snprintf(folder, sizeof folder, "%s/hdr", check_shared());
    DIR *dir = opendir(folder);
    CHECK(dir != NULL);
    while (dir && (entry = readdir(dir))) {
        const char *dot = strrchr(entry->d_name, '.');
        pupil_why why = {""};
        if (!dot || (strcmp(dot, ".hdr") != 0 && strcmp(dot, ".exr") != 0))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        CHECK_MSG(pupil_still_load(&still, path, &why) == 0, "%s", why.text);
        if (!why.text[0])
            judge(entry->d_name, &still);
    }
    if (dir)
        closedir(dir);
    pupil_still_free(&still);
    return check_end();
}

/* The shared images: their luminance against published figures, and valid but unusual ones against their known
 * contents. */
#include "still_check.h"

static pupil_still still;
static pupil_why said;

typedef struct figures {
    double least, geometric_mean, most; /* of luminances above 0 */
} figures;

/* Rec.709 weights on the stored values. */
static figures measure(void)
{
    figures f = {HUGE_VAL, 0, 0};
    const float *rgb = still.pixels;
    uint64_t count = 0;
    for (uint64_t i = (uint64_t)still.width * still.height; i; i--, rgb += 3) {
        const double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        if (!(y > 0))
            continue;
        f.least = fmin(f.least, y);
        f.most = fmax(f.most, y);
        f.geometric_mean += log(y);
        count++;
    }
    f.geometric_mean = exp(f.geometric_mean / (double)count);
    return f;
}

static void test_figures(const char *shared)
{
    /* Minimum above 0, geometric mean and maximum, as the collection's own list prints them. */
    static const struct {
        const char *name;
        uint32_t width, height;
        figures f;
    } images[] = {
        {"desk_zip.exr", 644, 874, {4.55e-07, 0.279, 201.7}},
        {"goldengate_zip.exr", 1262, 860, {0.000991, 0.0645, 292.3}},
        {"riverwalk_768.hdr", 768, 768, {2.93e-05, 0.194, 75.24}},
        {"adams_place_bridge_1k.hdr", 1024, 512, {0.000338, 0.161, 110.7}},
        {"dikhololo_night_1k.hdr", 1024, 512, {0.000506, 0.0253, 72.57}},
        {"spruit_sunrise_4k.exr", 4096, 2048, {4.38e-05, 0.101, 6.363e+04}},
    };
    for (size_t i = 0; i < sizeof images / sizeof *images; i++) {
        const figures *e = &images[i].f;
        char path[4200];
        figures f;
        snprintf(path, sizeof path, "%s/hdr/%s", shared, images[i].name);
        CHECK_MSG(pupil_still_load(&still, path, &said) == 0, "%s", said.text);
        CHECK(still.width == images[i].width && still.height == images[i].height);
        f = measure();
        printf("%-28s min %.3g, geometric mean %.3g, max %.4g\n", images[i].name, f.least, f.geometric_mean, f.most);
        CHECK(fabs(f.least / e->least - 1) < 1e-2);
        CHECK(fabs(f.geometric_mean / e->geometric_mean - 1) < 1e-2);
        CHECK(fabs(f.most / e->most - 1) < 1e-2);
    }
}

static int load_unusual(const char *shared, const char *name)
{
    char path[4200];
    snprintf(path, sizeof path, "%s/malformed/valid_but_unusual/%s", shared, name);
    return pupil_still_load(&still, path, &said);
}

/* The picture of one file in every compression: lossless ones are the same to the bit. */
static void test_compressions(const char *shared)
{
    static const char *const exact[] = {"f16_uncompressed", "f16_rle",          "f16_zips", "f16_zip",  "f16_piz",
                                        "f16_pxr24",        "f32_uncompressed", "f32_rle",  "f32_zips", "f32_zip",
                                        "f32_piz",          "f32_b44",          "f32_b44a"};
    static const char *const lossy[] = {"f16_b44", "f16_b44a", "f32_pxr24"};
    static float first[2][109 * 65 * 3];
    char name[100];
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++) {
        float *reference = first[exact[i][1] == '3'];
        snprintf(name, sizeof name, "exr/compression_%s.exr", exact[i]);
        CHECK_MSG(load_unusual(shared, name) == 0 && still.width == 109 && still.height == 65, "%s", said.text);
        if (strstr(exact[i], "uncompressed"))
            memcpy(reference, still.pixels, sizeof first[0]);
        CHECK_MSG(memcmp(reference, still.pixels, sizeof first[0]) == 0, "%s", name);
    }
    for (size_t i = 0; i < sizeof lossy / sizeof *lossy; i++) {
        double error = 0;
        snprintf(name, sizeof name, "exr/compression_%s.exr", lossy[i]);
        CHECK_MSG(load_unusual(shared, name) == 0, "%s", said.text);
        for (int k = 0; k < 109 * 65 * 3; k++)
            error += fabs(log2(((float *)still.pixels)[k] + 1e-3) - log2(first[lossy[i][1] == '3'][k] + 1e-3));
        CHECK_MSG(error / (109 * 65 * 3) < 0.1, "%s: %g stops on average", name, error / (109 * 65 * 3));
    }
}

/* All half codes are in this file, each as often as any other. */
static void test_all_halfs(const char *shared)
{
    const float *rgb;
    unsigned nans = 0, infinite = 0, largest = 0, least = 0;
    CHECK(load_unusual(shared, "exr/AllHalfValues.exr") == 0 && still.width == 256 && still.height == 256);
    rgb = still.pixels;
    for (int i = 0; i < 65536; i++, rgb += 3) {
        nans += rgb[0] != rgb[0];
        infinite += isinf(rgb[0]) != 0;
        largest += rgb[0] == 65504;
        least += rgb[0] == 0x1p-24f;
    }
    CHECK(nans == 2 * 1023 && infinite == 2 && largest == 1 && least == 1);
}

static void test_unusual(const char *shared)
{
    static const struct {
        const char *name;
        uint32_t width, height;
        const char *refused; /* a limit that still.h states */
    } files[] = {
        {"exr/BrightRingsNanInf.exr", 800, 800, NULL},
        {"exr/ColorCodedLevels.exr", 512, 512, NULL},
        {"exr/Flowers.exr", 784, 734, NULL},
        {"exr/Garden.exr", 874, 493, NULL},
        {"exr/GrayRampsHorizontal.exr", 800, 800, NULL},
        {"exr/WideColorGamut.exr", 800, 800, NULL},
        {"exr/WideFloatRange.exr", 0, 0, "has the channels G;"},
        {"exr/oiio_nan_bad.exr", 64, 64, NULL},
        {"exr/stripes.exr", 100, 50, NULL},
        {"exr/t01.exr", 400, 300, NULL},
        {"exr/t05.exr", 340, 260, NULL},
        {"exr/t10.exr", 0, 0, "wholly outside its display window"},
        {"exr/t16.exr", 481, 371, NULL},
        {"exr/tinyexr_2by2.exr", 2, 2, NULL},
        {"exr/tinyexr_flaga.exr", 128, 64, NULL},
        {"exr/tinyexr_piz-bug-issue-100.exr", 35, 1, NULL},
        {"exr/tinyexr_tiled_half_1x1_alpha.exr", 0, 0, "has the channels A;"},
        {"hdr/hdrify_rainbow.hdr", 16, 16, NULL},
        {"hdr/image-rs_image1.hdr", 128, 85, NULL},
        {"hdr/image-rs_old-rle.hdr", 551, 276, NULL},
        {"hdr/image-rs_rgbr4x4.hdr", 4, 4, NULL},
        {"hdr/image-rs_scale.hdr", 256, 8, NULL},
        {"hdr/oiio_seed.hdr", 64, 64, NULL},
        {"pfm/hopper.pfm", 128, 128, NULL},
        {"pfm/hopper_be.pfm", 128, 128, NULL},
        {"pfm/oiio_test-1.pfm", 64, 64, NULL},
        {"png16/basi2c16.png", 32, 32, NULL},
        {"png16/basn6a16.png", 32, 32, NULL},
        {"png16/tbbn2c16.png", 32, 32, NULL},
    };
    unsigned read = 0, refused = 0;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const int result = load_unusual(shared, files[i].name);
        if (files[i].refused) {
            CHECK_MSG(result == -1 && strstr(said.text, files[i].refused), "%s", said.text);
            refused++;
            continue;
        }
        CHECK_MSG(result == 0 && still.width == files[i].width && still.height == files[i].height, "%s: %s",
                  files[i].name, said.text);
        read++;
    }
    printf("valid but unusual: %u read, %u refused for stated limits\n", read, refused);
}

/* Two byte orders of one PFM, and one PNG interlaced and not, are the same picture. */
static void test_twins(const char *shared)
{
    static const char *const twins[][2] = {
        {"pfm/hopper.pfm", "pfm/hopper_be.pfm"},      {"png16/basi0g16.png", "png16/basn0g16.png"},
        {"png16/basi2c16.png", "png16/basn2c16.png"}, {"png16/basi4a16.png", "png16/basn4a16.png"},
        {"png16/basi6a16.png", "png16/basn6a16.png"}, {"png16/oi9n2c16.png", "png16/basn2c16.png"}};
    for (size_t i = 0; i < sizeof twins / sizeof *twins; i++) {
        size_t size;
        void *first;
        CHECK_MSG(load_unusual(shared, twins[i][0]) == 0, "%s", said.text);
        size = (size_t)still.width * still.height * 12;
        first = malloc(size);
        if (!first)
            abort();
        memcpy(first, still.pixels, size);
        CHECK_MSG(load_unusual(shared, twins[i][1]) == 0, "%s", said.text);
        CHECK_MSG(memcmp(first, still.pixels, size) == 0, "%s", twins[i][0]);
        free(first);
    }
}

int main(int argc, char **argv)
{
    const char *shared = check_shared();
    check_begin(argc, argv);
    if (!shared)
        return check_cannot("no shared images");
    test_figures(shared);
    test_compressions(shared);
    test_all_halfs(shared);
    test_unusual(shared);
    test_twins(shared);
    pupil_still_free(&still);
    return check_end();
}

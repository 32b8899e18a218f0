/* The log-average of every shared still against long double, with the bounds of tests/core/test_metering.c: 1e-7 from
 * the pixels and 1e-9 from the same floats for a megapixel and more, 2.5e-7 and 5e-8 for any.
 */
#include "check.h"
#include "file/still/still.h"
#include "reference.h"

#include <dirent.h>

static int is_still(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && (!strcmp(dot, ".hdr") || !strcmp(dot, ".exr"));
}

static void meter(const char *path, pupil_still *still)
{
    pupil_why why = {""};
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    ref_meter reference;
    double mean = 0, quantile = 0;
    CHECK_MSG(pupil_still_load(still, path, &why) == 0, "%s", why.text);
    if (why.text[0])
        return;
    const pupil_image_const image = {.data = still->pixels,
                                     .stride_bytes = (ptrdiff_t)(still->width * pupil_pixel_bytes(still->pixel)),
                                     .width = still->width,
                                     .height = still->height,
                                     .pixel = still->pixel};
    const int large = (uint64_t)still->width * still->height >= 1000000;
    pupil_config_default(&config);
    config.histogram_step = 1; /* the reference counts every pixel */
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, &image, 0, image.height, &stats) == PUPIL_OK);
    CHECK(pupil_stats_mean(&stats, 0, 1, &mean) == PUPIL_OK);
    CHECK(pupil_stats_quantile(&stats, 0.5, &quantile) == PUPIL_OK);
    ref_meter_frame(&config, &image, &reference);
    const double from_pixels = ref_relative(mean - reference.mean_of_pixels);
    const double from_floats = ref_relative(mean - reference.mean_of_floats);
    printf("%s: %u x %u, mean %.6f EV, median %.3f EV; relative error %.2g from the pixels, %.2g from the floats\n",
           strrchr(path, '/') + 1, still->width, still->height, mean, quantile, from_pixels, from_floats);
    CHECK(from_pixels <= (large ? 1e-7 : 2.5e-7) && from_floats <= (large ? 1e-9 : 5e-8));
    CHECK(stats.black == reference.black && stats.clipped == reference.clipped && stats.bad == reference.bad);
    CHECK(memcmp(stats.bin, reference.bin, sizeof stats.bin) == 0);
    CHECK(memcmp(stats.peak_bin, reference.peak_bin, sizeof stats.peak_bin) == 0 && stats.peak == reference.peak);
}

int main(int argc, char **argv)
{
    pupil_still still = {0};
    struct dirent *entry;
    unsigned count = 0;
    char folder[4096], path[8192];
    check_begin(argc, argv);
    if (!check_shared())
        return check_cannot("no shared images");
    snprintf(folder, sizeof folder, "%s/hdr", check_shared());
    DIR *dir = opendir(folder);
    CHECK(dir != NULL);
    while (dir && (entry = readdir(dir)))
        if (is_still(entry->d_name)) {
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            meter(path, &still);
            count++;
        }
    if (dir)
        closedir(dir);
    CHECK(count > 0);
    pupil_still_free(&still);
    return check_end();
}

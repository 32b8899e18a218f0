/* config.histogram_step on every shared still: how much white point, quantiles, trimmed mean and held-back level differ
 * from those of every pixel, for the default and for one pixel of each 2n x n. The table of docs/numerics.md.
 */
#include "check.h"
#include "file/still/still.h"
#include "pupil/pupil.h"

#include <dirent.h>
#include <math.h>

enum { VALUES = 5, STEPS = 4 };
static const uint32_t steps[STEPS] = {0, 2, 4, 8};
static const char *const names[VALUES] = {"white point", "median", "95 %", "trimmed mean", "held back"};
/* The promises of docs/numerics.md for the default. */
static const double limit[VALUES] = {0.08, 0.01, 0.03, 0.01, 0.02};

static void figures_of(const pupil_image_const *image, uint32_t step, double value[VALUES])
{
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    pupil_exposure e;
    pupil_config_default(&config);
    config.histogram_step = step;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK && pupil_meter(&pupil, image, NULL) == PUPIL_OK);
    CHECK(pupil_get_stats(&pupil, &stats) == PUPIL_OK && pupil_get_exposure(&pupil, &e) == PUPIL_OK);
    CHECK(pupil_stats_peak_quantile(&stats, config.white_quantile, &value[0]) == PUPIL_OK);
    CHECK(pupil_stats_quantile(&stats, 0.5, &value[1]) == PUPIL_OK);
    CHECK(pupil_stats_quantile(&stats, 0.95, &value[2]) == PUPIL_OK);
    CHECK(pupil_stats_mean(&stats, 0.05, 0.95, &value[3]) == PUPIL_OK);
    value[4] = e.held_back_ev;
}

static void compare(const char *path, pupil_still *still, double worst[STEPS][VALUES])
{
    pupil_why why = {""};
    double exact[VALUES], found[VALUES];
    CHECK_MSG(pupil_still_load(still, path, &why) == 0, "%s", why.text);
    if (why.text[0])
        return;
    const pupil_image_const image = {.data = still->pixels,
                                     .stride_bytes = (ptrdiff_t)(still->width * pupil_pixel_bytes(still->pixel)),
                                     .width = still->width,
                                     .height = still->height,
                                     .pixel = still->pixel};
    figures_of(&image, 1, exact);
    printf("%s, %u x %u:", strrchr(path, '/') + 1, still->width, still->height);
    for (int s = 0; s < STEPS; s++) {
        figures_of(&image, steps[s], found);
        printf(" [%u]", steps[s]);
        for (int v = 0; v < VALUES; v++) {
            printf(" %+.4f", found[v] - exact[v]);
            worst[s][v] = fmax(worst[s][v], fabs(found[v] - exact[v]));
        }
    }
    putchar('\n');
}

int main(int argc, char **argv)
{
    pupil_still still = {0};
    struct dirent *entry;
    double worst[STEPS][VALUES] = {{0}};
    char folder[4096], path[8192];
    check_begin(argc, argv);
    if (!check_shared())
        return check_cannot("no shared images");
    snprintf(folder, sizeof folder, "%s/hdr", check_shared());
    DIR *dir = opendir(folder);
    CHECK(dir != NULL);
    while (dir && (entry = readdir(dir))) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || (strcmp(dot, ".hdr") != 0 && strcmp(dot, ".exr") != 0))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        compare(path, &still, worst);
    }
    if (dir)
        closedir(dir);
    for (int s = 0; s < STEPS; s++)
        for (int v = 0; v < VALUES; v++)
            printf("histogram_step %u: %s off by %.4f EV at most\n", steps[s], names[v], worst[s][v]);
    for (int v = 0; v < VALUES; v++)
        CHECK_MSG(worst[0][v] <= limit[v], "%s: %g EV", names[v], worst[0][v]);
    pupil_still_free(&still);
    return check_end();
}

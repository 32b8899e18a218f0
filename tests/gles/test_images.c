/* Real pictures and a rendered one: the shared stills, the frames of the shared clip, the shared Bayer frame, and the
 * room before and after its lamp is switched on. The GPU's statistics and picture compared with the CPU's. If shaders
 * are interpreted, only every seventh frame of the clip, and the top of the largest still. */
#include <dirent.h>
#include <unistd.h>

#include "file/still/still.h"
#include "same.h"
#include "synth/synth_source.h"

/* With defaults, except for the curve, and without a histogram no setting that needs one. Levels are not quantised,
 * because at a step's edge rounding would cost more than one code. */
static void compare(gl_test *test, const pupil_image_const *image, const char *what, same_figures *all)
{
    static const uint32_t curves[] = {PUPIL_CURVE_REINHARD, PUPIL_CURVE_ADJUST, PUPIL_CURVE_EQUALISE,
                                      PUPIL_CURVE_NORMALISE};
    static unsigned count;
    pupil_config config;
    same_figures figures = {0};
    pupil_config_default(&config);
    config.curve = curves[count++ % 4];
    if (!same_frame(test, image, &config, &figures, what)) {
        config.white_mode = PUPIL_WHITE_FIXED;
        config.white = 8.0;
        config.curve = PUPIL_CURVE_REINHARD;
        CHECK(same_frame(test, image, &config, &figures, what));
    }
    same_judge(&figures, what);
    same_add(all, &figures);
}

static void compare_still(gl_test *test, const char *path, same_figures *all)
{
    pupil_still still = {0};
    pupil_why why = {""};
    CHECK_MSG(pupil_still_load(&still, path, &why) == 0, "%s", why.text);
    const pupil_image_const image = {.data = still.pixels,
                                     .stride_bytes = (ptrdiff_t)(still.width * pupil_pixel_bytes(still.pixel)),
                                     .width = still.width,
                                     .height = still.height > 1024 && gl_test_interprets() ? 256 : still.height,
                                     .pixel = still.pixel};
    if (!why.text[0])
        compare(test, &image, strrchr(path, '/') + 1, all);
    pupil_still_free(&still);
}

/* 768 x 512 samples of 14 bits, little-endian, as its name says. */
static void compare_raw(gl_test *test, const char *path, same_figures *all)
{
    static uint16_t samples[768 * 512];
    const pupil_coding coding = {.bayer = PUPIL_BAYER_RGGB, .balance = {2.0f, 1.0f, 1.5f}};
    const pupil_image_const image = {.data = samples,
                                     .stride_bytes = 768 * 2,
                                     .width = 768,
                                     .height = 512,
                                     .pixel = PUPIL_PIXEL_BAYER14,
                                     .coding = &coding};
    FILE *file = fopen(path, "rb");
    CHECK(file && fread(samples, sizeof samples, 1, file) == 1);
    if (file)
        fclose(file);
    compare(test, &image, strrchr(path, '/') + 1, all);
}

static int ends_with(const char *name, const char *end)
{
    const size_t n = strlen(name), m = strlen(end);
    return n >= m && !strcmp(name + n - m, end);
}

/* Compares one in `every`; returns how many. */
static unsigned compare_folder(gl_test *test, const char *folder, unsigned every, same_figures *all)
{
    struct dirent **names;
    char path[4096];
    unsigned found = 0;
    const int count = scandir(folder, &names, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]->d_name);
        const int is_raw = ends_with(path, "_768x512_rggb14le.raw");
        if (is_raw || ends_with(path, ".hdr") || ends_with(path, ".exr"))
            if (found++ % every == 0)
                (is_raw ? compare_raw : compare_still)(test, path, all);
        free(names[i]);
    }
    if (count >= 0)
        free(names);
    return found;
}

static void compare_shared(gl_test *test, same_figures *all)
{
    char folder[4096], command[10000], scratch[] = "/tmp/pupil-images-XXXXXX";
    if (!check_shared()) {
        printf("the shared images: skipped: no shared images\n");
        return;
    }
    snprintf(folder, sizeof folder, "%s/hdr", check_shared());
    CHECK(compare_folder(test, folder, 1, all) >= 7);
    CHECK(mkdtemp(scratch) != NULL);
    snprintf(command, sizeof command, "tar -xf '%s/roof_hdr10_640x360_28f.tar' -C %s --strip-components=1", folder,
             scratch);
    CHECK(system(command) == 0);
    CHECK(compare_folder(test, scratch, gl_test_interprets() ? 7 : 1, all) == 28);
    snprintf(command, sizeof command, "rm -r %s", scratch);
    CHECK(system(command) == 0);
}

static void compare_room(gl_test *test, same_figures *all)
{
    const pupil_source_options options = {.width = 320, .height = 180, .frames = 4, .first = 299};
    pupil_source *source = NULL;
    pupil_frame frame;
    pupil_why why = {""};
    char what[64];
    unsigned frames = 0;
    const int opened = pupil_synth_source_open("room", &options, &source, &why);
    CHECK_MSG(opened == 0, "%s", why.text);
    while (!opened && frames < 4 && pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME) {
        snprintf(what, sizeof what, "room, frame %u", 299 + frames);
        compare(test, &frame.image, what, all);
        pupil_source_done(source, &frame);
        frames++;
    }
    CHECK_MSG(frames == 4, "%s", why.text);
    pupil_source_close(source);
}

int main(int argc, char **argv)
{
    static gl_test test;
    same_figures all = {0};
    check_begin(argc, argv);
    const int status = gl_test_open(&test, PUPIL_GLES_BEST);
    if (status)
        return status;
    compare_room(&test, &all);
    compare_shared(&test, &all);
    same_judge(&all, "all of them");
    gl_test_close(&test);
    return check_end();
}

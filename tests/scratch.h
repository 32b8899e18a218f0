/* tests/scratch.h: a folder to write into, its contents, and frames to write. */
#ifndef PUPIL_TESTS_SCRATCH_H
#define PUPIL_TESTS_SCRATCH_H

#include "check.h"

#include "pupil/image.h"

#include <dirent.h>
#include <ftw.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

static char scratch_folder[256];

/* Makes the folder. */
static inline void scratch_begin(void)
{
    const char *base = getenv("TMPDIR");
    snprintf(scratch_folder, sizeof scratch_folder, "%s/pupil-test-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(scratch_folder)) {
        perror(scratch_folder);
        exit(1);
    }
}

/* The path of a name in the folder; valid until the program ends. */
static inline const char *scratch(const char *name)
{
    static char paths[64][1024];
    static int used;
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", scratch_folder, name);
    for (int i = 0; i < used; i++)
        if (strcmp(paths[i], path) == 0)
            return paths[i];
    if (used == 64)
        abort();
    return strcpy(paths[used++], path);
}

static inline int scratch_remove(const char *path, const struct stat *s, int type, struct FTW *level)
{
    (void)s, (void)type, (void)level;
    return remove(path);
}

static inline void scratch_clear(const char *path)
{
    nftw(path, scratch_remove, 16, FTW_DEPTH | FTW_PHYS);
}

/* How many entries a folder has, hidden ones too; -1: there is no folder. */
static inline int scratch_entries(const char *path)
{
    DIR *folder = opendir(path);
    int entries = -2; /* "." and ".." */
    if (!folder)
        return -1;
    while (readdir(folder))
        entries++;
    closedir(folder);
    return entries;
}

static inline int scratch_exists(const char *path)
{
    struct stat s;
    return lstat(path, &s) == 0;
}

static inline void scratch_put(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    CHECK(f && fputs(text, f) >= 0);
    if (f)
        fclose(f);
}

static inline int scratch_holds(const char *path, const char *text)
{
    char got[256] = "";
    FILE *f = fopen(path, "r");
    if (!f)
        return 0;
    got[fread(got, 1, sizeof got - 1, f)] = 0;
    fclose(f);
    return strcmp(got, text) == 0;
}

/* Limits files to so many bytes, as on a full disk; 0: no limit. */
static inline void scratch_limit(unsigned long bytes)
{
    struct rlimit limit;
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes ? bytes : limit.rlim_max;
    setrlimit(RLIMIT_FSIZE, &limit);
}

/* A malloc'ed RGB8 image, bottom-up in memory if asked, with a few bytes between the rows. */
static inline pupil_image scratch_image(uint32_t width, uint32_t height, int bottom_up, uint8_t **memory)
{
    pupil_image image = {.width = width, .height = height, .pixel = PUPIL_PIXEL_RGB8};
    const size_t stride = 3 * (size_t)width + 5;
    *memory = malloc(stride * height);
    image.data = bottom_up ? *memory + stride * (height - 1) : *memory;
    image.stride_bytes = bottom_up ? -(ptrdiff_t)stride : (ptrdiff_t)stride;
    return image;
}

static inline uint8_t *scratch_pixel(const pupil_image *image, uint32_t x, uint32_t y)
{
    return (uint8_t *)image->data + (ptrdiff_t)y * image->stride_bytes + 3 * (ptrdiff_t)x;
}

static inline void scratch_noise(const pupil_image *image)
{
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < 3 * image->width; x++)
            scratch_pixel(image, 0, y)[x] = (uint8_t)check_random();
}

/* Smooth, strongly coloured, with four different edges; moves with n. */
static inline void scratch_waves(const pupil_image *image, int n)
{
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            uint8_t *p = scratch_pixel(image, x, y);
            p[0] = (uint8_t)(140 + 100 * sin(x * 0.02 + n * 0.1));
            p[1] = (uint8_t)(90 + 60 * cos(y * 0.017 + x * 0.004));
            p[2] = (uint8_t)(60 + 50 * sin(y * 0.03 - n * 0.07));
        }
}

/* Checks that a call fails, with a sentence (`why`) that begins with the path and has the word. */
#define CHECK_REFUSED_AT(call, path, word)                                                                             \
    do {                                                                                                               \
        why.text[0] = 0;                                                                                               \
        CHECK((call) == -1);                                                                                           \
        CHECK_MSG(strncmp(why.text, path, strlen(path)) == 0 && strstr(why.text, word), "%s", why.text);               \
    } while (0)

#endif

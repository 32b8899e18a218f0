/* tests/vm/compare.h: a frame in a dma-buf on the GPU and on the CPU, and how much they differ. In a header, so that
 * its checks count as the test's own. */
#ifndef PUPIL_TESTS_VM_COMPARE_H
#define PUPIL_TESTS_VM_COMPARE_H

#include <math.h>

#include "check.h"
#include "egl/dmabuf.h"
#include "vm/read_texels.h"
#include "vm/vgem.h"

#define SECOND_NS UINT64_C(1000000000)

typedef struct figures {
    double metering;       /* the log-average's relative difference; the largest */
    uint64_t samples, off; /* mapped samples, and how many differ */
    int most;              /* by how many codes at most */
} figures;

/* How a texture stores a plane: `channels` side by side in memory; the first `compared` are read, and the first
 * `turned` of them are in reverse order. Codes up to `largest`, 255 or 65535. */
typedef struct texel_kind {
    uint32_t channels, compared, turned, largest;
} texel_kind;

/* How many of a texture's channels differ from the codes in memory. */
static unsigned long texels_off(uint32_t texture, const void *data, ptrdiff_t stride_bytes, uint32_t width,
                                uint32_t height, texel_kind kind)
{
    uint32_t *codes = malloc((size_t)width * height * 4 * sizeof *codes);
    unsigned long off = 0;
    if (!codes || read_texels(texture, width, height, kind.largest, codes) != 0) {
        free(codes);
        return ~0ul;
    }
    for (uint32_t y = 0; y < height; y++) {
        const unsigned char *row = (const unsigned char *)data + (ptrdiff_t)y * stride_bytes;
        for (uint32_t i = 0; i < width * kind.channels; i++) {
            const uint32_t code = kind.largest > 255 ? (uint32_t)(row[2 * i] | row[2 * i + 1] << 8) : row[i];
            const uint32_t at = i % kind.channels, channel = at < kind.turned ? kind.turned - 1 - at : at;
            off += at < kind.compared && codes[((size_t)y * width + i / kind.channels) * 4 + channel] != code;
        }
    }
    free(codes);
    return off;
}

static void check_texels(const pupil_dmabuf_textures *textures, const pupil_image_const *image, const char *what)
{
    const uint32_t pixel = image->pixel, planes = pupil_pixel_planes(pixel), bits = pupil_pixel_bits(pixel);
    const uint32_t channels = bits ? 1 : (uint32_t)pupil_pixel_bytes(pixel);
    const texel_kind first = {
        .channels = channels,
        .compared = pixel == PUPIL_PIXEL_BGRX8 || pixel == PUPIL_PIXEL_RGBX8 ? 3 : channels,
        .turned = pixel == PUPIL_PIXEL_UYVY    ? 2
                  : pixel == PUPIL_PIXEL_BGRX8 ? 3
                                               : 0,
        .largest = bits > 8 ? 65535 : 255,
    };
    const texel_kind chroma = {.channels = planes == 2 ? 2 : 1,
                               .compared = planes == 2 ? 2 : 1,
                               .turned = pixel == PUPIL_PIXEL_NV21 ? 2 : 0,
                               .largest = 255};
    unsigned long off =
        texels_off(textures->texture[0], image->data, image->stride_bytes, image->width, image->height, first);
    CHECK_MSG(off == 0, "%s: %lu samples of the texture are not those of the buffer", what, off);
    for (uint32_t i = 1; i < planes; i++) {
        off = texels_off(textures->texture[i], i == 1 ? image->chroma : image->cr,
                         i == 1 ? image->chroma_stride_bytes : image->cr_stride_bytes, image->width / 2,
                         pupil_chroma_rows(pixel, image->height), chroma);
        CHECK_MSG(off == 0, "%s: %lu samples of the chroma's texture are not those of the buffer", what, off);
    }
}

/* Waits for GL to finish, so that the CPU may read what it wrote, and the camera may overwrite what it read. */
static void wait_for_gl(const char *what)
{
    const struct timespec pause = {0, 1000000};
    pupil_fence *fence = pupil_fence_make();
    int done = 0;
    CHECK_MSG(fence != NULL, "%s: no fence", what);
    if (!fence)
        return;
    for (int i = 0; i < 20000 && (done = pupil_fence_done(fence)) == 0; i++)
        nanosleep(&pause, NULL);
    CHECK_MSG(done == 1, "%s: the fence says %d", what, done);
    pupil_fence_close(fence);
}

/* Meters the frame both ways; the GPU's statistics are adapted to. */
static void compare_metering(pupil_gles *gles, pupil_t *pupil, const pupil_image_const *image, figures *all,
                             const char *what)
{
    static pupil_stats gpu, cpu;
    double gpu_mean = 0.0, cpu_mean = 0.0;
    pupil_stats_clear(&gpu);
    pupil_stats_clear(&cpu);
    CHECK(pupil_gles_meter(gles, NULL) == PUPIL_OK);
    CHECK(pupil_gles_collect(gles, 60 * SECOND_NS, &gpu, NULL) == PUPIL_OK);
    CHECK(pupil_meter_rows(pupil, image, 0, image->height, &cpu) == PUPIL_OK);
    CHECK_MSG(gpu.pixels == cpu.pixels && gpu.weight == cpu.weight && gpu.clipped == cpu.clipped && gpu.bad == cpu.bad,
              "%s: %llu pixels, %llu clipped; the CPU has %llu, %llu", what, (unsigned long long)gpu.pixels,
              (unsigned long long)gpu.clipped, (unsigned long long)cpu.pixels, (unsigned long long)cpu.clipped);
    CHECK(pupil_stats_mean(&gpu, 0.0, 1.0, &gpu_mean) == PUPIL_OK);
    CHECK(pupil_stats_mean(&cpu, 0.0, 1.0, &cpu_mean) == PUPIL_OK);
    const double off = fabs(exp2(gpu_mean - cpu_mean) - 1.0);
    CHECK_MSG(off <= 1e-5, "%s: the log-average is off by %g", what, off);
    all->metering = fmax(all->metering, off);
    CHECK(pupil_adapt(pupil, &gpu, NULL) == PUPIL_OK);
}

/* BGRX8's fourth byte is unused: GL may write anything there. */
static void compare_pictures(const vgem_buffer *gpu, const pupil_image *cpu, figures *all, const char *what)
{
    const unsigned char *picture = cpu->data;
    int most = 0;
    vgem_begin(gpu);
    for (size_t i = 0; i < (size_t)cpu->stride_bytes * cpu->height; i++) {
        if (cpu->pixel == PUPIL_PIXEL_BGRX8 && i % 4 == 3)
            continue;
        all->samples++;
        int off = abs(gpu->data[i] - picture[i]);
        all->off += off != 0;
        most = off > most ? off : most;
    }
    vgem_end(gpu);
    all->most = most > all->most ? most : all->most;
    CHECK_MSG(most <= 1, "%s: a sample is %d codes off", what, most);
}

/* After a format's frames. */
static void judge(const figures *all, const char *what)
{
    printf("%-20s metering %.1e relative; %llu of %llu samples off, by %d at most\n", what, all->metering,
           (unsigned long long)all->off, (unsigned long long)all->samples, all->most);
    CHECK_MSG(all->off * 10000 <= all->samples, "%s: more than a sample in 10,000 is off", what);
}

#endif

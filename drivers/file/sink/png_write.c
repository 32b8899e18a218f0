#include "png_write.h"

#include "sink_common.h"

#include "pupil/config.h"
#include "refuse.h"
#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

/* Level 2 and one filter: under half the time of level 3 with libpng's choice of a filter for each row, and a file 5 %
 * larger (a street, 640 x 360). Level 6 takes six times as long for 6 % less. */
#define ZLIB_LEVEL 2
#define FILTERS    PNG_FILTER_SUB

/* All that must survive a longjmp is here, in the caller's stack frame, not in registers. */
typedef struct png_job {
    FILE *file;
    png_structp png;
    png_infop info;
    uint32_t primaries, transfer;
    char problem[256];
} png_job;

static _Noreturn void on_error(png_structp png, png_const_charp message)
{
    png_job *job = png_get_error_ptr(png);
    snprintf(job->problem, sizeof job->problem, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void on_write(png_structp png, png_bytep bytes, size_t size)
{
    png_job *job = png_get_io_ptr(png);
    if (fwrite(bytes, 1, size, job->file) != size)
        png_error(png, strerror(errno));
}

static void on_flush(png_structp png)
{
    (void)png; /* fclose flushes, and says whether it could */
}

/* The chunks that say what the samples mean. cICP (PNG third edition, 11.3.2.6) has the numbers of Rec. ITU-T H.273:
 * primaries 9 (BT.2020), transfer 13 (sRGB), RGB, full range. libpng before 1.6.46 has no call for it; it comes before
 * IDAT. Programs that do not know cICP use cHRM and gAMA; sRGB's curve has the gAMA of 11.3.2.5, which is that of
 * 2.2. */
static void write_colour(png_job *job)
{
    static const png_byte cicp[4] = {9, 13, 0, 1};
    const int wide = job->primaries == PUPIL_PRIMARIES_BT2020, srgb = job->transfer == PUPIL_TRANSFER_SRGB;
    if (wide)
        png_set_cHRM(job->png, job->info, 0.3127, 0.3290, 0.708, 0.292, 0.170, 0.797, 0.131, 0.046);
    else if (!srgb)
        png_set_cHRM(job->png, job->info, 0.3127, 0.3290, 0.640, 0.330, 0.300, 0.600, 0.150, 0.060);
    if (wide || !srgb)
        png_set_gAMA(job->png, job->info, job->transfer == PUPIL_TRANSFER_LINEAR ? 1.0 : 0.45455);
    else
        png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(job->png, job->info);
    if (wide && srgb)
        png_write_chunk(job->png, (png_const_bytep) "cICP", cicp, sizeof cicp);
}

static int encode(png_job *job, const pupil_image_const *image)
{
    if (setjmp(png_jmpbuf(job->png)))
        return -1;
    png_set_write_fn(job->png, job, on_write, on_flush);
    png_set_IHDR(job->png, job->info, image->width, image->height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(job->png, ZLIB_LEVEL);
    png_set_filter(job->png, PNG_FILTER_TYPE_BASE, FILTERS);
    write_colour(job);
    for (uint32_t y = 0; y < image->height; y++)
        png_write_row(job->png, (const uint8_t *)image->data + (ptrdiff_t)y * image->stride_bytes);
    png_write_end(job->png, job->info);
    return 0;
}

int pupil_png_write(const char *path, const char *name, const pupil_image_const *image, uint32_t primaries,
                    uint32_t transfer, pupil_why *why)
{
    png_job job = {.primaries = primaries, .transfer = transfer, .problem = "out of memory"};
    int failed = -1;
    job.file = fopen(path, "wbe");
    if (!job.file)
        return pupil_refuse(why, "%s: cannot be written: %s", name, strerror(errno));
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    if (job.png && (job.info = png_create_info_struct(job.png)) != NULL)
        failed = encode(&job, image);
    png_destroy_write_struct(&job.png, &job.info);
    if (fclose(job.file) != 0 && !failed) {
        snprintf(job.problem, sizeof job.problem, "%s", strerror(errno));
        failed = -1;
    }
    if (failed)
        return pupil_refuse(why, "%s: cannot be written: %s", name, job.problem);
    return 0;
}

/* Linear pictures as files: OpenEXR (openexr.com, "OpenEXR File Layout": one part, scan lines, no compression), PFM
 * (Debevec) and Radiance (Ward, "Real Pixels", Graphics Gems II). All numbers of the first two are little-endian. */
#include "picture_sink.h"

#include <math.h>
#include <string.h>

static void put32(FILE *file, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        putc((int)(v >> (8 * i) & 255), file);
}

static void put_float(FILE *file, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    put32(file, bits);
}

/* With the byte 0 that ends it. */
static void put_name(FILE *file, const char *name)
{
    fwrite(name, 1, strlen(name) + 1, file);
}

static const float *row_of(const pupil_image_const *image, uint32_t y)
{
    return (const float *)(const void *)((const unsigned char *)image->data + (ptrdiff_t)y * image->stride_bytes);
}

/* --- OpenEXR --- */

static void put_attribute(FILE *file, const char *name, const char *type, uint32_t bytes)
{
    put_name(file, name);
    put_name(file, type);
    put32(file, bytes);
}

static void put_box(FILE *file, const char *name, uint32_t width, uint32_t height)
{
    put_attribute(file, name, "box2i", 16);
    put32(file, 0);
    put32(file, 0);
    put32(file, width - 1);
    put32(file, height - 1);
}

static void put_channels(FILE *file, const pupil_exr_channel *channel, size_t count)
{
    uint32_t bytes = 1;
    for (size_t i = 0; i < count; i++)
        bytes += (uint32_t)strlen(channel[i].name) + 17;
    put_attribute(file, "channels", "chlist", bytes);
    for (size_t i = 0; i < count; i++) {
        put_name(file, channel[i].name);
        put32(file, 2); /* 32-bit float */
        put32(file, 0);
        put32(file, 1);
        put32(file, 1);
    }
    putc(0, file);
}

static void put_header(FILE *file, uint32_t width, uint32_t height, const pupil_exr_channel *channel, size_t count)
{
    put32(file, 20000630); /* the magic number */
    put32(file, 2);        /* version 2, nothing special */
    put_channels(file, channel, count);
    put_attribute(file, "compression", "compression", 1);
    putc(0, file);
    put_box(file, "dataWindow", width, height);
    put_box(file, "displayWindow", width, height);
    put_attribute(file, "lineOrder", "lineOrder", 1);
    putc(0, file);
    put_attribute(file, "pixelAspectRatio", "float", 4);
    put_float(file, 1.0f);
    put_attribute(file, "screenWindowCenter", "v2f", 8);
    put_float(file, 0.0f);
    put_float(file, 0.0f);
    put_attribute(file, "screenWindowWidth", "float", 4);
    put_float(file, 1.0f);
    putc(0, file);
}

int pupil_write_exr_channels(FILE *file, uint32_t width, uint32_t height, const pupil_exr_channel *channel,
                             size_t count)
{
    put_header(file, width, height, channel, count);
    long header = ftell(file);
    const uint32_t bytes = width * 4 * (uint32_t)count;
    if (header < 0)
        return -1;
    for (uint32_t y = 0; y < height; y++) { /* where each line begins */
        uint64_t at = (uint64_t)header + (uint64_t)height * 8 + (uint64_t)y * (bytes + 8);
        put32(file, (uint32_t)at);
        put32(file, (uint32_t)(at >> 32));
    }
    for (uint32_t y = 0; y < height; y++) {
        put32(file, y);
        put32(file, bytes);
        for (size_t i = 0; i < count; i++) {
            const unsigned char *row = (const unsigned char *)channel[i].data + (ptrdiff_t)y * channel[i].stride_bytes;
            for (size_t x = 0; x < width; x++)
                put_float(file, ((const float *)(const void *)row)[x * channel[i].step]);
        }
    }
    return ferror(file) ? -1 : 0;
}

int pupil_write_exr(FILE *file, const pupil_image_const *image)
{
    const float *first = image->data;
    const pupil_exr_channel channel[] = {{"B", first + 2, 3, image->stride_bytes},
                                         {"G", first + 1, 3, image->stride_bytes},
                                         {"R", first, 3, image->stride_bytes}};
    return pupil_write_exr_channels(file, image->width, image->height, channel, 3);
}

/* --- PFM --- */

int pupil_write_pfm(FILE *file, const pupil_image_const *image)
{
    fprintf(file, "PF\n%u %u\n-1.0\n", image->width, image->height);
    for (uint32_t y = image->height; y-- > 0;) {
        const float *row = row_of(image, y);
        for (uint32_t i = 0; i < 3 * image->width; i++)
            put_float(file, row[i]);
    }
    return ferror(file) ? -1 : 0;
}

/* --- Radiance --- */

/* Truncated, because readers take the middle of a step. */
static void to_rgbe(const float *rgb, unsigned char rgbe[4])
{
    float most = rgb[0] > rgb[1] ? rgb[0] : rgb[1];
    int exponent;
    most = rgb[2] > most ? rgb[2] : most;
    memset(rgbe, 0, 4);
    if (!(most >= 1e-38f)) /* the smallest that the format holds, about */
        return;
    if (most > 1e38f)
        most = 1e38f;
    frexpf(most, &exponent);
    for (int i = 0; i < 3; i++) {
        float code = ldexpf(rgb[i] > 0.0f ? rgb[i] : 0.0f, 8 - exponent);
        rgbe[i] = (unsigned char)(code < 255.0f ? code : 255.0f);
    }
    rgbe[3] = (unsigned char)(exponent + 128);
}

/* A line in the format's run-length form, in literal runs only; where that form is not allowed, as plain pixels. */
static void put_line(FILE *file, const float *row, uint32_t width)
{
    unsigned char rgbe[4];
    if (width < 8 || width > 32767) {
        for (uint32_t x = 0; x < width; x++) {
            to_rgbe(row + 3 * x, rgbe);
            fwrite(rgbe, 1, 4, file);
        }
        return;
    }
    putc(2, file);
    putc(2, file);
    putc((int)(width >> 8), file);
    putc((int)(width & 255), file);
    for (int channel = 0; channel < 4; channel++)
        for (uint32_t x = 0; x < width; x++) {
            if (x % 128 == 0)
                putc((int)(width - x < 128 ? width - x : 128), file);
            to_rgbe(row + 3 * x, rgbe);
            putc(rgbe[channel], file);
        }
}

int pupil_write_hdr(FILE *file, const pupil_image_const *image)
{
    fprintf(file, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %u +X %u\n", image->height, image->width);
    for (uint32_t y = 0; y < image->height; y++)
        put_line(file, row_of(image, y), image->width);
    return ferror(file) ? -1 : 0;
}

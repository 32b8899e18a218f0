/* MJPG frames under libFuzzer: the input itself, or (every other time) edits of a valid frame, so that code behind the
 * headers is reached. The decoder is kept for inputs of one size, as for a camera. */
#include "drivers/file/write_jpeg.h"

#include <stdlib.h>

#include "file/video/jpeg_frame.h"
#include "file/video/jpeg_parse.h"

#define MOST_SIDE_PX 512

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static pupil_jpeg *decoder(uint32_t width, uint32_t height)
{
    static pupil_jpeg *kept;
    static uint32_t kept_width, kept_height;
    pupil_why why = {""};
    if (kept && kept_width == width && kept_height == height)
        return kept;
    pupil_jpeg_close(kept);
    kept_width = width;
    kept_height = height;
    if (pupil_jpeg_open(&kept, width, height, NULL, &why) && !*why.text)
        abort();
    return kept;
}

static void decode(const uint8_t *bytes, size_t size, uint32_t width, uint32_t height)
{
    uint64_t sum = 0;
    pupil_jpeg *jpeg = decoder(width, height);
    pupil_image_const image;
    pupil_why why = {""};
    if (!jpeg)
        return;
    if (pupil_jpeg_decode(jpeg, bytes, size, &image, &why)) {
        if (!*why.text)
            abort(); /* a refusal without a sentence */
        return;
    }
    if (image.width != width || image.height != height)
        abort();
    for (uint32_t y = 0; y < height; y++)
        for (size_t x = 0; x < pupil_row_bytes(image.pixel, width); x++)
            sum += ((const uint8_t *)image.data)[(ptrdiff_t)y * image.stride_bytes + (ptrdiff_t)x];
    if (sum > UINT64_C(255) * 4 * width * height)
        abort(); /* it cannot be; so that the bytes are read */
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static uint8_t whole[65536];
    pupil_why why;
    if (size < 6)
        return 0;
    if (bytes[0] % 2) {
        pupil_jpeg_shape shape;
        uint8_t *to = malloc(size);
        const int known = to && pupil_jpeg_parse(bytes + 1, size - 1, to, &shape, &why) &&
                          shape.width <= MOST_SIDE_PX && shape.height <= MOST_SIDE_PX;
        free(to);
        decode(bytes + 1, size - 1, known ? shape.width : 16, known ? shape.height : 16);
        return 0;
    }
    const flat_jpeg j = {.width = 1 + bytes[1] % 64,
                         .height = 1 + bytes[2] % 64,
                         .components = bytes[3] % 4 ? 3 : 1,
                         .across = 1u << bytes[3] / 4 % 3,
                         .down = 1 + bytes[3] / 16 % 2,
                         .own_tables = bytes[3] & 32,
                         .standard_tables = bytes[3] & 64,
                         .progressive = bytes[3] & 128,
                         .seed = bytes[4]};
    size_t length = flat_write(&j, whole);
    for (size_t i = 5; i + 2 < size && i < 5 + 3 * 16; i += 3)
        whole[(bytes[i] << 8 | bytes[i + 1]) % length] = bytes[i + 2];
    decode(whole, length, j.width, j.height);
    return 0;
}

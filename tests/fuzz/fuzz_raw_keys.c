/* The keys of raw:FILE,... under libFuzzer: accepted keys describe frames that fit their bytes. */
#include <stdlib.h>
#include <string.h>

#include "raw/raw_source.h"

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static size_t end_of(const void *data, ptrdiff_t stride, size_t row, uint32_t rows)
{
    return data ? (size_t)(uintptr_t)data + (size_t)stride * (rows - 1) + row : 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static pupil_raw_layout layout;
    pupil_why why = {""};
    pupil_image_const image;
    pupil_white_balance colour;
    char *text = malloc(size + 1);
    memcpy(text, bytes, size);
    text[size] = 0;
    const int failed = pupil_raw_layout_read(&layout, text, &why);
    free(text);
    if (failed) {
        if (!*why.text)
            abort(); /* a refusal without a sentence */
        return 0;
    }
    /* As if its frame were in memory at address 64: nothing is read. */
    const size_t frame = pupil_raw_layout_image(&layout, (const void *)(uintptr_t)64, &image);
    const size_t chroma_row = pupil_chroma_row_bytes(layout.pixel, layout.width);
    const uint32_t chroma_rows = pupil_chroma_rows(layout.pixel, layout.height);
    if (!frame ||
        end_of(image.data, image.stride_bytes, pupil_row_bytes(layout.pixel, layout.width), layout.height) >
            64 + frame ||
        end_of(image.chroma, image.chroma_stride_bytes, chroma_row, chroma_rows) > 64 + frame ||
        end_of(image.cr, image.cr_stride_bytes, chroma_row, chroma_rows) > 64 + frame)
        abort();
    (void)pupil_white_balance_begin(&colour, &layout.colour, &layout.coding, layout.pixel, NULL, &why);
    return 0;
}

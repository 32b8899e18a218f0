/* tests/drivers/file/recording_frames.h: frames of any format with random bytes, to be recorded and compared. */
#ifndef PUPIL_TESTS_DRIVERS_RECORDING_FRAMES_H
#define PUPIL_TESTS_DRIVERS_RECORDING_FRAMES_H

#include "check.h"

#include "file/recording/recording.h"
#include "pupil/error.h"
#include "refuse.h"
#include "sink.h"

#define FRAMES_MOST 256

typedef struct test_frames {
    pupil_frame frame[FRAMES_MOST];
    int count;
    pupil_coding coding;
    unsigned char *memory[FRAMES_MOST];
} test_frames;

/* Every field is valid for the format and not all zero. */
static inline pupil_coding frames_coding(uint32_t pixel)
{
    const int mosaic = pupil_pixel_is_mosaic(pixel),
              words = pixel == PUPIL_PIXEL_GREY10 || pixel == PUPIL_PIXEL_BAYER10;
    pupil_coding c = {.matrix = (uint32_t)(check_random() % PUPIL_MATRIX_COUNT),
                      .range = (uint32_t)(check_random() % PUPIL_RANGE_COUNT),
                      .light = (uint32_t)(check_random() % (mosaic ? 2 : PUPIL_LIGHT_COUNT)),
                      .bayer = (uint32_t)(check_random() % PUPIL_BAYER_COUNT),
                      .shift = words ? (uint32_t)(check_random() % 7) : 0,
                      .black = (float)(16.0 * check_uniform()),
                      .white = (float)(200.0 + 55.0 * check_uniform())};
    for (int i = 0; i < 3; i++)
        c.balance[i] = (float)(0.5 + 2.0 * check_uniform());
    for (int i = 0; i < 9; i++)
        c.rgb_from_camera[i] = (float)(4.0 * check_uniform() - 2.0);
    return c;
}

static inline pupil_frame_info frames_info(int n)
{
    pupil_frame_info info = {.timestamp_ns = n ? (int64_t)n * 33366700 + (int64_t)(check_random() % 1000) : 0,
                             .sequence = check_random() | (uint64_t)1 << 63,
                             .exposure_s = 0.03 * check_uniform(),
                             .gain = 1.0 + 15.0 * check_uniform()};
    if (n == 3)
        info = (pupil_frame_info){.timestamp_ns = INT64_MAX, .sequence = 1};
    return info;
}

/* A picture in random memory, with gaps between its rows, or bottom-up. */
static inline pupil_image_const frames_image(uint32_t pixel, uint32_t width, uint32_t height, unsigned char **memory)
{
    const size_t row = pupil_row_bytes(pixel, width), more = 16 * (size_t)(check_random() % 3);
    const size_t chroma_row = pupil_chroma_row_bytes(pixel, width), chroma_rows = pupil_chroma_rows(pixel, height);
    const size_t stride = (row + 15) / 16 * 16 + more, chroma_stride = (chroma_row + 15) / 16 * 16 + more;
    const size_t bytes = stride * height + 2 * chroma_stride * chroma_rows;
    pupil_image_const image = {.width = width, .height = height, .pixel = pixel, .stride_bytes = (ptrdiff_t)stride};
    *memory = malloc(bytes);
    for (size_t i = 0; i < bytes; i++)
        (*memory)[i] = (unsigned char)check_random();
    image.data = *memory;
    if (pupil_pixel_planes(pixel) > 1) {
        image.chroma = *memory + stride * height;
        image.chroma_stride_bytes = (ptrdiff_t)chroma_stride;
    }
    if (pupil_pixel_planes(pixel) > 2) {
        image.cr = *memory + stride * height + chroma_stride * chroma_rows;
        image.cr_stride_bytes = (ptrdiff_t)chroma_stride;
    }
    if (check_random() % 2) {
        image.data = *memory + stride * (height - 1);
        image.stride_bytes = -image.stride_bytes;
        if (image.chroma) {
            image.chroma = (const unsigned char *)image.chroma + chroma_stride * (chroma_rows - 1);
            image.chroma_stride_bytes = -image.chroma_stride_bytes;
        }
    }
    return image;
}

static inline void frames_make(test_frames *f, uint32_t pixel, uint32_t width, uint32_t height, int count)
{
    memset(f, 0, sizeof *f);
    f->count = count;
    f->coding = frames_coding(pixel);
    for (int i = 0; i < count; i++) {
        f->frame[i].image = frames_image(pixel, width, height, &f->memory[i]);
        f->frame[i].image.coding = &f->coding;
        f->frame[i].info = frames_info(i);
        f->frame[i].name = "test";
    }
}

static inline void frames_free(test_frames *f)
{
    for (int i = 0; i < f->count; i++)
        free(f->memory[i]);
}

/* How many frames were taken before it failed; `why` has its sentence. */
static inline int frames_record(const test_frames *f, const char *folder, const pupil_recorder_options *options,
                                pupil_why *why)
{
    pupil_recorder *recorder;
    int n = 0;
    *why->text = 0;
    if (pupil_recorder_open(&recorder, folder, &f->frame[0], options, why))
        return -1;
    while (n < f->count && pupil_recorder_write(recorder, &f->frame[n], why) == PUPIL_SINK_OK)
        n++;
    return pupil_recorder_close(recorder, why) == PUPIL_SINK_OK ? n : n ? -n : -1;
}

static inline int frames_same_rows(const void *a, ptrdiff_t a_stride, const void *b, ptrdiff_t b_stride, size_t row,
                                   uint32_t rows)
{
    for (uint32_t y = 0; y < rows; y++)
        if (memcmp((const char *)a + (ptrdiff_t)y * a_stride, (const char *)b + (ptrdiff_t)y * b_stride, row))
            return 0;
    return 1;
}

static inline int frames_same_image(const pupil_image_const *a, const pupil_image_const *b)
{
    const size_t row = pupil_row_bytes(a->pixel, a->width);
    const size_t chroma_row = pupil_chroma_row_bytes(a->pixel, a->width);
    const uint32_t chroma_rows = pupil_chroma_rows(a->pixel, a->height);
    return a->pixel == b->pixel && a->width == b->width && a->height == b->height &&
           frames_same_rows(a->data, a->stride_bytes, b->data, b->stride_bytes, row, a->height) &&
           frames_same_rows(a->chroma, a->chroma_stride_bytes, b->chroma, b->chroma_stride_bytes, chroma_row,
                            pupil_pixel_planes(a->pixel) > 1 ? chroma_rows : 0) &&
           frames_same_rows(a->cr, a->cr_stride_bytes, b->cr, b->cr_stride_bytes, chroma_row,
                            pupil_pixel_planes(a->pixel) > 2 ? chroma_rows : 0);
}

static inline int frames_same(const pupil_frame *a, const pupil_frame *b)
{
    return frames_same_image(&a->image, &b->image) && memcmp(&a->info, &b->info, sizeof a->info) == 0 &&
           memcmp(a->image.coding, b->image.coding, sizeof *a->image.coding) == 0;
}

/* Where each frame's pixels end in these bytes of a frames.mkv; they are found by content. */
static inline void frames_ends(const test_frames *f, unsigned char *bytes, size_t size, size_t *ends)
{
    unsigned char *from = bytes;
    for (int i = 0; i < f->count; i++) {
        const pupil_image_const *image = &f->frame[i].image;
        const size_t row = pupil_row_bytes(image->pixel, image->width);
        from = memmem(from, size - (size_t)(from - bytes), image->data, row);
        CHECK(from);
        from += row * image->height;
        ends[i] = (size_t)(from - bytes);
    }
}

/* How many frames came back, each unchanged; -1: one differs, or (with a sentence in `why`) the recording fails. */
static inline int frames_replay(const test_frames *f, const char *folder, pupil_why *why)
{
    pupil_source *source;
    pupil_frame frame;
    int n = 0, got;
    *why->text = 0;
    if (pupil_recording_open(folder, NULL, &source, why))
        return -1;
    while ((got = pupil_source_next(source, &frame, why)) == PUPIL_SOURCE_FRAME) {
        if (n >= f->count || !frames_same(&frame, &f->frame[n])) {
            pupil_refuse(why, "frame %d is another", n);
            n = -1;
            break;
        }
        n++;
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
    return got == PUPIL_SOURCE_FAILED ? -1 : n;
}

#endif

/* A raw file under libFuzzer: its keys up to the first line feed, then the file's bytes. Frames are complete and can be
 * metered, or are damaged with a sentence, and no byte beyond the file is read. */
#include "raw/raw_source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz.h"

#define MAX_STEPS  16
#define MAX_PIXELS (256 * 256)

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Random bytes are hardly ever keys: the first corpus folder begins with a file of each family of formats. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    static const char *const keys[] = {"format=RG10,size=8x6,black=64",
                                       "format=pRAA,size=8x6,stride=16,white=1000,knees=512:0.1",
                                       "format=pRCC,size=8x6,balance=1.9/1/1.6",
                                       "format=BA81,size=8x6,skip=5,balance=off",
                                       "format=GREY,size=9x5",
                                       "format=Y10P,size=8x5",
                                       "format=YUYV,size=8x6",
                                       "format=NV12,size=8x6",
                                       "format=RG16,size=8x6,shift=4,matrix=1/0/0/0/1/0/0/0/1"};
    const char *folder = fuzz_corpus(*argc, *argv);
    for (size_t k = 0; folder && k < sizeof keys / sizeof *keys; k++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/seed_%zu", folder, k);
        FILE *file = fopen(path, "wbe");
        if (!file)
            abort();
        fprintf(file, "%s\n", keys[k]);
        for (int i = 0; i < 300; i++)
            fputc(i * 37 % 251, file);
        if (fclose(file))
            abort();
    }
    return 0;
}

/* Reads each pixel: the sanitizer sees a read beyond the frame. */
static void abort_unless_metered(const pupil_image_const *image)
{
    static pupil_stats stats;
    if (fuzz_meter(image, &stats) || stats.bad)
        abort();
}

static void read_frames(pupil_source *source, size_t frame_bytes, size_t file_bytes)
{
    pupil_frame f;
    size_t frames = 0;
    for (int step = 0; step < MAX_STEPS; step++) {
        pupil_why why = {""};
        const int rc = pupil_source_next(source, &f, &why);
        if (rc == PUPIL_SOURCE_END)
            return;
        if (rc != PUPIL_SOURCE_FRAME && !*why.text)
            abort(); /* a damaged frame without a sentence */
        if (rc == PUPIL_SOURCE_FAILED)
            return;
        if (rc == PUPIL_SOURCE_DAMAGED)
            continue;
        if (++frames * frame_bytes > file_bytes)
            abort(); /* more frames than the file has */
        abort_unless_metered(&f.image);
        pupil_source_done(source, &f);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static pupil_raw_layout layout;
    pupil_image_const image;
    pupil_source *source = NULL;
    pupil_why why = {""};
    char text[1024];
    const uint8_t *line = memchr(bytes, '\n', size);
    const size_t keys = line ? (size_t)(line - bytes) : size;
    const int fd = memfd_create("fuzz", MFD_CLOEXEC);
    if (fd < 0)
        abort();
    snprintf(text, sizeof text, "/proc/self/fd/%d,%.*s", fd, keys < 900 ? (int)keys : 900, (const char *)bytes);
    if (line && write(fd, line + 1, size - keys - 1) != (ssize_t)(size - keys - 1))
        abort();
    /* Small, so that time goes into the number of inputs and not into pixels. */
    if (pupil_raw_layout_read(&layout, text, &why) == 0 && (uint64_t)layout.width * layout.height <= MAX_PIXELS) {
        const size_t frame = pupil_raw_layout_image(&layout, bytes, &image);
        if (pupil_raw_source_open(text, NULL, &source, &why) == 0) {
            read_frames(source, frame, line ? size - keys - 1 : 0);
            pupil_source_close(source);
        } else if (!*why.text)
            abort(); /* a refusal without a sentence */
    }
    close(fd);
    return 0;
}

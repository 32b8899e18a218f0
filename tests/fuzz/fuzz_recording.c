/* A recording's three files under libFuzzer: recording.json, a zero byte, frames.jsonl, a zero byte, frames.mkv. Frames
 * are complete, or there is a sentence. */
#include "file/recording/recording.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "fuzz.h"

#define MAX_STEPS 8

enum { FILES = 3 };

static const char *const names[FILES] = {"recording.json", "frames.jsonl", "frames.mkv"};
static char folder[64];

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void clean_up(void)
{
    char path[128];
    for (int i = 0; i < FILES; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        unlink(path);
    }
    rmdir(folder);
}

static void record(uint32_t pixel, const pupil_coding *coding)
{
    static uint16_t samples[8 * 6];
    pupil_recorder *recorder;
    pupil_why why = {""};
    pupil_frame f = {.image = {.data = samples, .width = 8, .height = 6, .pixel = pixel, .coding = coding},
                     .name = "seed"};
    const pupil_recorder_options options = {.camera = "a camera", .fps = 30.0, .overwrite = 1, .wait = 1};
    f.image.stride_bytes = (ptrdiff_t)pupil_row_bytes(pixel, 8);
    if (pupil_recorder_open(&recorder, folder, &f, &options, &why))
        abort();
    for (int n = 0; n < 3; n++) {
        for (int i = 0; i < 8 * 6; i++)
            samples[i] = (uint16_t)(64 + (i + n) * 37 % 900);
        f.info = (pupil_frame_info){
            .sequence = (uint64_t)n, .timestamp_ns = n * 33333333LL, .exposure_s = 0.01, .gain = 2.0};
        if (pupil_recorder_write(recorder, &f, &why))
            abort();
    }
    if (pupil_recorder_close(recorder, &why))
        abort();
}

/* The three files as one input. */
static void keep(const char *corpus, const char *name)
{
    static char text[1 << 16];
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", corpus, name);
    FILE *to = fopen(path, "wbe");
    for (int i = 0; to && i < FILES; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        FILE *from = fopen(path, "rbe");
        if (!from)
            abort();
        const size_t size = fread(text, 1, sizeof text, from);
        if (i)
            fputc(0, to);
        if (fwrite(text, 1, size, to) != size)
            abort();
        fclose(from);
    }
    if (to && fclose(to))
        abort();
}

/* Random bytes do not make a recording: the first corpus folder begins with two. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    const pupil_coding bayer = {.bayer = PUPIL_BAYER_RGGB, .black = 64.0f};
    snprintf(folder, sizeof folder, "/tmp/pupil-fuzz-XXXXXX");
    if (!mkdtemp(folder) || atexit(clean_up))
        abort();
    const char *corpus = fuzz_corpus(*argc, *argv);
    if (corpus) {
        record(PUPIL_PIXEL_BAYER10, &bayer);
        keep(corpus, "seed_bayer");
        record(PUPIL_PIXEL_YUYV, NULL);
        keep(corpus, "seed_yuyv");
    }
    return 0;
}

static void write_file(const char *name, const uint8_t *bytes, size_t size)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wbe");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file))
        abort();
}

static void read_frames(pupil_source *source)
{
    static pupil_stats stats;
    pupil_frame f;
    for (int step = 0; step < MAX_STEPS; step++) {
        pupil_why why = {""};
        const int rc = pupil_source_next(source, &f, &why);
        if (rc < 0 && !*why.text)
            abort(); /* a failure without a sentence */
        if (rc == PUPIL_SOURCE_END || rc == PUPIL_SOURCE_FAILED)
            return;
        if (rc == PUPIL_SOURCE_DAMAGED)
            continue;
        if (f.image.data && fuzz_meter(&f.image, &stats))
            abort(); /* a frame that the library refuses */
        pupil_source_done(source, &f);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    pupil_source *source;
    pupil_why why = {""};
    for (int i = 0; i < FILES; i++) {
        const uint8_t *end = i < FILES - 1 ? memchr(bytes, 0, size) : NULL;
        const size_t of_file = end ? (size_t)(end - bytes) : size;
        write_file(names[i], bytes, of_file);
        bytes += of_file + (end != NULL);
        size -= of_file + (end != NULL);
    }
    if (pupil_recording_open(folder, NULL, &source, &why) == 0) {
        read_frames(source);
        pupil_source_close(source);
    } else if (!*why.text)
        abort(); /* a refusal without a sentence */
    return 0;
}

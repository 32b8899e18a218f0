/* Any bytes as a video: frames, damage or a sentence, but never a crash, a hang or a pixel out of bounds. */
#include "drivers/file/clip.h"

#include "file/video/video_source.h"
#include "fuzz.h"

#include <unistd.h>

/* Small, so that time goes into the number of inputs and not into pixels. */
#define MAX_PIXELS (128 * 128)
#define MAX_FRAMES 8
#define MAX_STEPS  64

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int checks(const clip *c, int frame, int component, int x, int y)
{
    (void)c;
    return 40 + (x / 4 + y / 4 + frame + component) % 2 * 150;
}

/* Random bytes do not find a container: the first corpus folder begins with a clip of each kind. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    static const struct {
        const char *container, *codec;
        enum AVPixelFormat format;
    } kinds[] = {{"matroska", "ffv1", AV_PIX_FMT_YUV420P10},
                 {"mp4", "mpeg4", AV_PIX_FMT_YUV420P},
                 {"avi", "mpeg4", AV_PIX_FMT_YUV420P},
                 {"mjpeg", "mjpeg", AV_PIX_FMT_YUVJ420P},
                 {"mpegts", "mpeg2video", AV_PIX_FMT_YUV420P},
                 {"nut", "ffv1", AV_PIX_FMT_GBRP10},
                 {"yuv4mpegpipe", "wrapped_avframe", AV_PIX_FMT_YUV444P},
                 {"avi", "rawvideo", AV_PIX_FMT_RGB24},
                 {"gif", "gif", AV_PIX_FMT_RGB8}};
    const char *folder = fuzz_corpus(*argc, *argv);
    for (size_t k = 0; folder && k < sizeof kinds / sizeof *kinds; k++) {
        clip c = {kinds[k].container,
                  kinds[k].codec,
                  kinds[k].format,
                  32,
                  24,
                  3,
                  AVCOL_SPC_BT709,
                  AVCOL_TRC_SMPTE2084,
                  AVCOL_PRI_BT2020,
                  AVCOL_RANGE_MPEG,
                  AVCHROMA_LOC_LEFT,
                  NULL,
                  checks,
                  NULL};
        char path[4096];
        snprintf(path, sizeof path, "%s/seed_%zu_%s", folder, k, c.container);
        if (access(path, F_OK) && clip_write(&c, path))
            unlink(path);
    }
    return 0;
}

/* PQ and HLG: codes that the library accepts; each can be read. */
static void abort_unless_metered(const pupil_image_const *image)
{
    static pupil_stats stats;
    if (fuzz_meter(image, &stats) || stats.bad)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pupil_why why;
    pupil_source *source;
    pupil_frame f;
    uint32_t width = 0, height = 0;
    int frames = 0, rc = PUPIL_SOURCE_FRAME;
    if (pupil_video_source_open_bytes(data, size, "fuzz", MAX_PIXELS, NULL, &source, &why))
        return 0;
    for (int step = 0; step < MAX_STEPS && frames < MAX_FRAMES; step++) {
        rc = pupil_source_next(source, &f, &why);
        if (rc == PUPIL_SOURCE_END || rc == PUPIL_SOURCE_FAILED)
            break;
        if (rc == PUPIL_SOURCE_DAMAGED)
            continue;
        const float *p = f.image.data;
        size_t count = f.image.pixel == PUPIL_PIXEL_RGB32F ? (size_t)f.image.width * f.image.height * 3 : 0;
        if (frames++ && (f.image.width != width || f.image.height != height))
            abort(); /* sizes stay */
        width = f.image.width;
        height = f.image.height;
        for (size_t i = 0; i < count; i++)
            if (!(p[i] > -100 && p[i] <= 200))
                abort(); /* light by any table and any matrix */
        if (!count)
            abort_unless_metered(&f.image);
        pupil_source_done(source, &f);
    }
    pupil_source_close(source);
    return 0;
}

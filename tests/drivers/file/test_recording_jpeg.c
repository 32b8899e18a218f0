/* Recordings of a camera's own JPEGs: kept as they came, decoded as the live frames were. */
#include "check.h"
#include "scratch.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>

#include "file/recording/recording.h"
#include "file/video/jpeg_frame.h"
#include "recording_frames.h"
#include "write_jpeg.h"

#define COUNT 6
#define MOST  65536

static pupil_why why;
static const pupil_recorder_options waiting = {.fps = 30, .wait = 1};

typedef struct jpegs {
    uint8_t bytes[COUNT][MOST];
    size_t size[COUNT];
    int broken; /* this frame is damaged; -1: all are whole */
} jpegs;

static void make(jpegs *j, uint32_t width, uint32_t height, uint32_t across, uint32_t down, uint32_t components)
{
    for (int i = 0; i < COUNT; i++) {
        const flat_jpeg flat = {.width = width,
                                .height = height,
                                .components = components,
                                .across = across,
                                .down = down,
                                .seed = check_random(),
                                .own_tables = i % 3 == 2};
        j->size[i] = flat_write(&flat, j->bytes[i]);
        CHECK(j->size[i] < MOST);
    }
    j->broken = -1;
}

/* As a camera's source delivers it. */
static pupil_frame frame_of(const jpegs *j, int i, pupil_jpeg *decoder)
{
    pupil_frame frame = {.name = "jpeg", .coded = j->bytes[i], .coded_bytes = j->size[i]};
    CHECK_MSG(pupil_jpeg_decode(decoder, j->bytes[i], j->size[i], &frame.image, &why) == 0, "%s", why.text);
    frame.info = (pupil_frame_info){.timestamp_ns = i * 33333333, .sequence = (uint64_t)i, .gain = 1.5};
    return frame;
}

static void record(jpegs *j, const char *folder, pupil_jpeg *decoder)
{
    pupil_recorder *recorder = NULL;
    for (int i = 0; i < COUNT; i++) {
        pupil_frame frame = frame_of(j, i, decoder);
        if (i == j->broken) /* its middle is another frame's: the camera's source would not deliver it */
            memset(j->bytes[i] + 2, 0x55, j->size[i] - 2);
        if (!recorder)
            CHECK_MSG(pupil_recorder_open(&recorder, folder, &frame, &waiting, &why) == 0, "%s", why.text);
        CHECK_MSG(pupil_recorder_write(recorder, &frame, &why) == 0, "%s", why.text);
    }
    CHECK(pupil_recorder_close(recorder, &why) == 0);
}

static void replay(const jpegs *j, const char *folder, pupil_jpeg *decoder)
{
    pupil_source *source;
    pupil_frame frame;
    CHECK_MSG(pupil_recording_open(folder, NULL, &source, &why) == 0, "%s", why.text);
    for (int i = 0; i < COUNT; i++) {
        const int got = pupil_source_next(source, &frame, &why);
        if (i == j->broken) {
            CHECK_MSG(got == PUPIL_SOURCE_DAMAGED && strstr(why.text, "frames.mkv: frame 2: "), "%d %s", got, why.text);
            continue;
        }
        CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%d %s", got, why.text);
        if (got != PUPIL_SOURCE_FRAME)
            break;
        const pupil_frame live = frame_of(j, i, decoder);
        CHECK(frames_same(&frame, &live));
        CHECK(frame.coded_bytes == j->size[i] && memcmp(frame.coded, j->bytes[i], j->size[i]) == 0);
        pupil_source_done(source, &frame);
    }
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_END);
    pupil_source_close(source);
}

/* What other programs see: Motion JPEG, with these bytes. */
static void check_opens(const jpegs *j, const char *folder)
{
    char path[1100];
    AVFormatContext *format = NULL;
    AVPacket *packet = av_packet_alloc();
    int n = 0;
    snprintf(path, sizeof path, "%s/frames.mkv", folder);
    av_log_set_level(AV_LOG_QUIET);
    CHECK(avformat_open_input(&format, path, NULL, NULL) == 0);
    CHECK(format && format->nb_streams == 1 && format->streams[0]->codecpar->codec_id == AV_CODEC_ID_MJPEG);
    while (format && av_read_frame(format, packet) == 0 && n < COUNT) {
        CHECK(packet->size == (int)j->size[n] && memcmp(packet->data, j->bytes[n], j->size[n]) == 0);
        av_packet_unref(packet);
        n++;
    }
    CHECK_MSG(n == COUNT, "%d", n);
    av_packet_free(&packet);
    avformat_close_input(&format);
}

int main(int argc, char **argv)
{
    static const uint32_t shapes[][5] = {
        {64, 48, 2, 1, 3}, {64, 48, 2, 2, 3}, {63, 47, 2, 2, 3},
        {64, 48, 1, 1, 3}, {40, 24, 1, 1, 1}, {8, 8, 1, 1, 1}}; /* the last one: more bytes than its pixels have */
    static const pupil_coding codings[] = {{.range = PUPIL_RANGE_FULL},
                                           {.matrix = PUPIL_MATRIX_BT709, .light = PUPIL_LIGHT_SRGB}};
    static jpegs j;
    check_begin(argc, argv);
    scratch_begin();
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int c = 0; c < 2; c++) {
            pupil_jpeg *decoder;
            const char *folder = scratch("jpeg");
            CHECK(pupil_jpeg_open(&decoder, shapes[i][0], shapes[i][1], &codings[c], &why) == 0);
            make(&j, shapes[i][0], shapes[i][1], shapes[i][2], shapes[i][3], shapes[i][4]);
            record(&j, folder, decoder);
            replay(&j, folder, decoder);
            check_opens(&j, folder);
            scratch_clear(folder);
            j.broken = 2;
            record(&j, folder, decoder);
            replay(&j, folder, decoder);
            scratch_clear(folder);
            pupil_jpeg_close(decoder);
        }
    scratch_clear(scratch_folder);
    return check_end();
}

/* The video sink: libav reads back the frames and times that were written. */
#include "scratch.h"

#include "file/file_sink.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

#define FRAMES_MAX 64

static pupil_why why;

/* A decoded video: the stream's tags, every frame's time, and each frame's difference from scratch_waves. */
typedef struct decoded {
    int frames, width, height;
    int64_t time_us[FRAMES_MAX];
    double psnr[FRAMES_MAX];               /* of RGB, dB */
    double mean_difference[FRAMES_MAX][3]; /* decoded minus written, mean of R, G, B, codes */
    AVRational rate;
    AVCodecParameters *tags;
    int pad_repeats; /* the padding column, if there is one, is like its neighbour */
} decoded;

static double clamp(double v)
{
    return v < 0 ? 0 : v > 255 ? 255 : v;
}

/* BT.709 limited range back to RGB, in double and straight from the standard; chroma is sited left in the row and
 * between the rows, and interpolated accordingly. */
static void to_rgb(const AVFrame *f, int x, int y, double rgb[3])
{
    const int wide = (f->width + 1) / 2, high = (f->height + 1) / 2;
    const int x0 = x / 2, x1 = x % 2 && x0 + 1 < wide ? x0 + 1 : x0;
    const int y0 = y / 2, near = y0, far0 = y % 2 ? y0 + 1 : y0 - 1, far = far0 < 0 || far0 >= high ? y0 : far0;
    double c[2];
    for (int i = 0; i < 2; i++) {
        const uint8_t *p = f->data[i + 1];
        const int s = f->linesize[i + 1];
        c[i] = 0.375 * (p[near * s + x0] + p[near * s + x1]) + 0.125 * (p[far * s + x0] + p[far * s + x1]) - 128;
    }
    const double luma = (f->data[0][y * f->linesize[0] + x] - 16) * 255.0 / 219;
    rgb[0] = clamp(luma + c[1] * 255 / 224 * 1.5748);
    rgb[2] = clamp(luma + c[0] * 255 / 224 * 1.8556);
    rgb[1] = clamp((luma - 0.2126 * (luma + c[1] * 255 / 224 * 1.5748) - 0.0722 * (luma + c[0] * 255 / 224 * 1.8556)) /
                   0.7152);
}

static void compare(decoded *d, const AVFrame *f, const pupil_image *image)
{
    const int n = d->frames;
    double squares = 0, sums[3] = {0, 0, 0};
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) {
            double rgb[3];
            to_rgb(f, (int)x, (int)y, rgb);
            for (int i = 0; i < 3; i++) {
                const double difference = rgb[i] - scratch_pixel(image, x, y)[i];
                sums[i] += difference;
                squares += difference * difference;
            }
        }
    const double pixels = (double)image->width * image->height;
    for (int i = 0; i < 3; i++)
        d->mean_difference[n][i] = sums[i] / pixels;
    d->psnr[n] = 10 * log10(255.0 * 255.0 / (squares / (3 * pixels) + 1e-9));
    for (uint32_t y = 0; y < image->height && image->width % 2; y++) {
        const uint8_t *end = f->data[0] + (int)y * f->linesize[0] + image->width;
        d->pad_repeats &= abs(end[0] - end[-1]) <= 12;
    }
}

static void take_frames(decoded *d, AVCodecContext *decoder, AVStream *stream, AVFrame *frame, const pupil_image *image)
{
    while (avcodec_receive_frame(decoder, frame) >= 0) {
        if (d->frames < FRAMES_MAX) {
            scratch_waves(image, d->frames);
            d->time_us[d->frames] = av_rescale_q(frame->pts, stream->time_base, (AVRational){1, 1000000});
            compare(d, frame, image);
        }
        d->frames++;
    }
}

static int decode(const char *path, decoded *d, const pupil_image *image)
{
    AVFormatContext *input = NULL;
    AVCodecContext *decoder;
    AVPacket *packet = av_packet_alloc();
    AVFrame *frame = av_frame_alloc();
    memset(d, 0, sizeof *d);
    d->pad_repeats = 1;
    d->tags = avcodec_parameters_alloc();
    const int opened = avformat_open_input(&input, path, NULL, NULL) >= 0 &&
                       avformat_find_stream_info(input, NULL) >= 0 && input->nb_streams == 1;
    CHECK_MSG(opened, "%s cannot be read back", path);
    if (!opened)
        exit(check_end());
    AVStream *stream = input->streams[0];
    avcodec_parameters_copy(d->tags, stream->codecpar);
    d->rate = stream->avg_frame_rate;
    decoder = avcodec_alloc_context3(avcodec_find_decoder(stream->codecpar->codec_id));
    avcodec_parameters_to_context(decoder, stream->codecpar);
    CHECK(avcodec_open2(decoder, NULL, NULL) >= 0);
    while (av_read_frame(input, packet) >= 0) {
        CHECK(avcodec_send_packet(decoder, packet) >= 0);
        av_packet_unref(packet);
        take_frames(d, decoder, stream, frame, image);
    }
    avcodec_send_packet(decoder, NULL);
    take_frames(d, decoder, stream, frame, image);
    d->width = decoder->width;
    d->height = decoder->height;
    avcodec_free_context(&decoder);
    avformat_close_input(&input);
    av_packet_free(&packet);
    av_frame_free(&frame);
    return d->frames;
}

static uint32_t tagged_primaries = PUPIL_PRIMARIES_BT709, tagged_transfer = PUPIL_TRANSFER_SRGB;

/* Writes `frames` waves; times_ns NULL: without timestamps. */
static void record(const char *path, const pupil_image *image, double fps, int frames, const int64_t *times_ns)
{
    const pupil_sink_options options = {.width = image->width,
                                        .height = image->height,
                                        .fps = fps,
                                        .primaries = tagged_primaries,
                                        .transfer = tagged_transfer};
    const pupil_image_const in = pupil_image_as_const(*image);
    pupil_sink *sink;
    why.text[0] = 0;
    CHECK_MSG(pupil_file_sink_open(path, &options, &sink, &why) == 0, "%s", why.text);
    if (!sink)
        exit(check_end());
    for (int n = 0; n < frames; n++) {
        const pupil_frame_info info = {.timestamp_ns = times_ns ? times_ns[n] : 0, .sequence = (uint64_t)n};
        scratch_waves(image, n);
        CHECK_MSG(pupil_sink_write(sink, &in, times_ns ? &info : NULL, &why) == 0, "%s", why.text);
    }
    CHECK(!scratch_exists(path));
    CHECK_MSG(pupil_sink_finish(sink, &why) == 0, "%s", why.text);
    CHECK(scratch_exists(path) && scratch_entries(scratch_folder) == 1);
}

static void check_picture(const char *path, const decoded *d, const pupil_image *image, double psnr, double mean)
{
    CHECK_MSG(d->width == (int)(image->width + 1) / 2 * 2 && d->height == (int)(image->height + 1) / 2 * 2,
              "%s: %d x %d", path, d->width, d->height);
    for (int n = 0; n < d->frames; n++) {
        CHECK_MSG(d->psnr[n] >= psnr, "%s frame %d: %.2f dB", path, n, d->psnr[n]);
        for (int i = 0; i < 3; i++)
            CHECK_MSG(fabs(d->mean_difference[n][i]) <= mean, "%s frame %d channel %d: mean is off by %.3f", path, n, i,
                      d->mean_difference[n][i]);
    }
    CHECK(d->pad_repeats);
}

static void check_tags(const decoded *d)
{
    if (!avcodec_find_encoder_by_name("libx264"))
        return; /* MPEG-4 part 2 has no such tags, and OpenH264 not all */
    CHECK(d->tags->codec_id == AV_CODEC_ID_H264);
    CHECK(d->tags->color_range == AVCOL_RANGE_MPEG);
    CHECK(d->tags->color_space == AVCOL_SPC_BT709);
    CHECK(d->tags->color_primaries ==
          (tagged_primaries == PUPIL_PRIMARIES_BT2020 ? AVCOL_PRI_BT2020 : AVCOL_PRI_BT709));
    CHECK(d->tags->color_trc == (tagged_transfer == PUPIL_TRANSFER_SRGB      ? AVCOL_TRC_IEC61966_2_1
                                 : tagged_transfer == PUPIL_TRANSFER_GAMMA22 ? AVCOL_TRC_GAMMA22
                                                                             : AVCOL_TRC_LINEAR));
    CHECK(d->tags->chroma_location == AVCHROMA_LOC_LEFT);
    CHECK(d->tags->format == AV_PIX_FMT_YUV420P);
    CHECK(d->tags->sample_aspect_ratio.num == d->tags->sample_aspect_ratio.den);
}

/* An atom's position in the first bytes of a file. */
static long find_atom(const char *path, const char *name)
{
    static char bytes[1 << 20];
    FILE *f = fopen(path, "rb");
    const size_t size = f ? fread(bytes, 1, sizeof bytes, f) : 0;
    const char *at = memmem(bytes, size, name, 4);
    if (f)
        fclose(f);
    return at ? at - bytes : -1;
}

static void test_containers(void)
{
    static const char *const names[] = {"out.mp4", "out.mkv", "out.mov", "OUT.MP4", "a:b.mp4", "with space.mkv"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *path = scratch(names[i]);
        uint8_t *memory;
        const pupil_image image = scratch_image(320, 180, i % 2 == 0, &memory);
        decoded d;
        tagged_primaries = i % 2 ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709;
        tagged_transfer = (uint32_t)i % PUPIL_TRANSFER_COUNT;
        record(path, &image, 30000.0 / 1001, 30, NULL);
        decode(path, &d, &image);
        CHECK_MSG(d.frames == 30, "%d", d.frames);
        check_picture(path, &d, &image, 42, 0.25);
        check_tags(&d);
        for (int n = 0; n < 30; n++) /* Matroska counts milliseconds */
            CHECK_MSG(llabs(d.time_us[n] - (int64_t)(n * 1001e6 / 30000)) <= (strstr(path, ".mkv") ? 501 : 1),
                      "%s frame %d at %lld us", path, n, (long long)d.time_us[n]);
        CHECK(fabs(av_q2d(d.rate) - 30000.0 / 1001) < 1e-3);
        if (!strstr(path, ".mkv")) {
            CHECK(find_atom(path, "moov") > 0 && find_atom(path, "moov") < find_atom(path, "mdat"));
            CHECK(find_atom(path, "colr") > 0);
        }
        printf("%s: %.1f dB, mean off by %.2f %.2f %.2f\n", names[i], d.psnr[0], d.mean_difference[0][0],
               d.mean_difference[0][1], d.mean_difference[0][2]);
        avcodec_parameters_free(&d.tags);
        remove(path);
        free(memory);
    }
}

static void test_sizes(void)
{
    static const uint32_t sizes[][2] = {{1, 1}, {3, 5}, {2, 1}, {1, 2}, {641, 479}, {17, 16}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int mkv = 0; mkv < 2; mkv++) {
            const char *path = scratch(mkv ? "out.mkv" : "out.mp4");
            uint8_t *memory;
            const pupil_image image = scratch_image(sizes[i][0], sizes[i][1], mkv, &memory);
            decoded d;
            record(path, &image, 25, 3, NULL);
            CHECK(decode(path, &d, &image) == 3);
            /* With so few samples, rounding alone is one code of luma and of chroma, 1.6 times that in red and blue. */
            const int few = sizes[i][0] * sizes[i][1] < 1000;
            check_picture(path, &d, &image, few ? 36 : 42, few ? 4 : 0.25);
            check_tags(&d);
            avcodec_parameters_free(&d.tags);
            remove(path);
            free(memory);
        }
}

/* Timestamps that rise are kept, as distances from the first; others count as nominal frames. */
static void test_times(void)
{
    static const int64_t hour = INT64_C(3600000000000), ms = 1000000;
    const struct {
        int frames;
        int64_t given_ns[6];
        int64_t want_us[6];
    } cases[] = {
        {4, {0, 40 * ms, 200 * ms, 201 * ms}, {0, 40000, 200000, 201000}},
        {4, {77 * hour, 77 * hour + 10 * ms, 77 * hour + 20 * ms, 77 * hour + 90 * ms}, {0, 10000, 20000, 90000}},
        {4, {0, 0, 0, 0}, {0, 100000, 200000, 300000}},
        {6, {0, 0, 0, 5 * ms, 10 * ms, 10 * ms}, {0, 100000, 200000, 205000, 210000, 310000}},
        {4, {100 * ms, 150 * ms, 20 * ms, 60 * ms}, {0, 50000, 150000, 190000}},           /* backwards in time */
        {4, {0, 77 * hour, 77 * hour + 30 * ms, 200 * hour}, {0, 100000, 130000, 230000}}, /* a clock that was set */
        {3, {INT64_MIN, INT64_MAX, INT64_MAX}, {0, 100000, 200000}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int mkv = 0; mkv < 2; mkv++) {
            const char *path = scratch(mkv ? "out.mkv" : "out.mp4");
            uint8_t *memory;
            const pupil_image image = scratch_image(32, 32, 0, &memory);
            decoded d;
            record(path, &image, 10, cases[i].frames, cases[i].given_ns);
            CHECK(decode(path, &d, &image) == cases[i].frames);
            for (int n = 0; n < cases[i].frames; n++) /* half a tick: 1/10240 s; 1 ms in Matroska */
                CHECK_MSG(llabs(d.time_us[n] - cases[i].want_us[n]) <= (mkv ? 551 : 50),
                          "%s case %zu frame %d at %lld us", path, i, n, (long long)d.time_us[n]);
            avcodec_parameters_free(&d.tags);
            remove(path);
            free(memory);
        }

    /* Frames that are closer than a tick still come out one by one. */
    int64_t dense_ns[20];
    uint8_t *memory;
    const pupil_image image = scratch_image(16, 16, 0, &memory);
    decoded d;
    for (int n = 0; n < 20; n++)
        dense_ns[n] = n;
    record(scratch("out.mp4"), &image, 240, 20, dense_ns);
    CHECK(decode(scratch("out.mp4"), &d, &image) == 20);
    for (int n = 1; n < 20; n++)
        CHECK(d.time_us[n] > d.time_us[n - 1]);
    avcodec_parameters_free(&d.tags);
    remove(scratch("out.mp4"));
    free(memory);
}

/* The largest side works; more pixels than the highest H.264 level are refused, and nothing is left. */
static void test_large(void)
{
    uint8_t *memory;
    const pupil_image image = scratch_image(PUPIL_MAX_SIDE_PX, 16, 0, &memory);
    const pupil_sink_options options = {.width = PUPIL_MAX_SIDE_PX, .height = PUPIL_MAX_SIDE_PX, .fps = 30};
    const char *path = scratch("out.mp4");
    decoded d;
    pupil_sink *sink;
    if (avcodec_find_encoder_by_name("libx264")) { /* the others stop at half of it */
        record(path, &image, 30, 1, NULL);
        CHECK(decode(path, &d, &image) == 1);
        check_picture(path, &d, &image, 40, 0.25);
        avcodec_parameters_free(&d.tags);
        remove(path);
    }
    free(memory);
    CHECK(pupil_file_sink_open(path, &options, &sink, &why) == -1 && !sink);
    CHECK_MSG(strncmp(why.text, path, strlen(path)) == 0 && strstr(why.text, "16384 x 16384"), "%s", why.text);
    CHECK(scratch_entries(scratch_folder) == 0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_containers();
    test_sizes();
    test_times();
    test_large();
    CHECK(scratch_entries(scratch_folder) == 0);
    scratch_clear(scratch_folder);
    return check_end();
}

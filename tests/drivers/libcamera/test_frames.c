/* Unusual libcamera frames: numbers and timestamps that do not rise, planes in one buffer or in another order, damaged
 * frames, requests that are refused; and how each is handled. */
#include "odd.h"

static void describe(fake_libcamera_config *c, uint32_t fourcc, int sensor)
{
    fake_libcamera_config_default(c);
    c->fourcc = fourcc;
    c->sensor = sensor;
}

/* --- numbers and stamps --- */

static struct {
    uint32_t frame; /* of those that came, from 0 */
    uint32_t sequence[6];
    int64_t stamp_ns[6];
} script;

static int scripted(void *camera, pupil_libcamera_done *done, int timeout_ms)
{
    const int got = it.real->wait(camera, done, timeout_ms);
    if (got == 1 && script.frame < 6) {
        done->sequence = script.sequence[script.frame];
        done->stamp_ns = script.stamp_ns[script.frame++];
    }
    return got;
}

/* Sequence numbers that repeat or restart, and timestamps that are missing or equal: each frame is delivered, with a
 * rising number. */
static void test_numbers(void)
{
    static const uint64_t expected[6] = {7, 8, 10, 11, 12, 13};
    fake_libcamera_config c;
    pupil_source *source;
    pupil_frame frame;
    describe(&c, V4L2_PIX_FMT_GREY, 1);
    odd_begin(&c);
    it.layer.wait = scripted;
    memset(&script, 0, sizeof script);
    const uint32_t given[6] = {7, 8, 10, 10, 3, 4};
    const int64_t stamps[6] = {1000, 2000, 3000, 3000, 0, 4000};
    memcpy(script.sequence, given, sizeof given);
    memcpy(script.stamp_ns, stamps, sizeof stamps);
    CHECK(odd_open(&source, &(pupil_live_options){.capture = {.monotonic = 1}}) == 0);
    for (int i = 0; i < 6; i++) {
        CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
        CHECK_MSG(frame.info.sequence == expected[i], "frame %d has number %llu", i,
                  (unsigned long long)frame.info.sequence);
        CHECK(!stamps[i] || frame.info.timestamp_ns == stamps[i]);
        CHECK((pupil_live_get(source)->times.stamp == PUPIL_LIVE_STAMP_NONE) == !stamps[i]);
    }
    const pupil_live_counts *counts = &pupil_live_get(source)->counts;
    CHECK_MSG(counts->lost == 1 && counts->repeated == 1 && counts->unstamped == 1, "%llu, %llu, %llu",
              (unsigned long long)counts->lost, (unsigned long long)counts->repeated,
              (unsigned long long)counts->unstamped);
    odd_end(source);
}

/* --- planes --- */

static pupil_libcamera_buffer one_piece;

static const pupil_libcamera_buffer *in_one_piece(void *camera, uint32_t index)
{
    one_piece = *it.real->buffer(camera, index);
    one_piece.planes = 1;
    one_piece.dmabuf[0] = 5;
    one_piece.offset_bytes[0] = 64;
    return &one_piece;
}

static int without_sizes(void *camera, pupil_libcamera_done *done, int timeout_ms)
{
    const int got = it.real->wait(camera, done, timeout_ms);
    memset(done->used, 0, sizeof done->used);
    return got;
}

/* Planes in one buffer are contiguous: Cb and Cr, or Cr before Cb. */
static void test_planes(void)
{
    static const struct {
        uint32_t fourcc;
        ptrdiff_t chroma, cr; /* bytes from the first pixel; 0: there is none */
    } cases[] = {{V4L2_PIX_FMT_GREY, 0, 0},
                 {V4L2_PIX_FMT_NV12, 64 * 48, 0},
                 {V4L2_PIX_FMT_YUV420, 64 * 48, 64 * 48 + 32 * 24},
                 {V4L2_PIX_FMT_YVU420, 64 * 48 + 32 * 24, 64 * 48}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_libcamera_config c;
        pupil_source *source;
        pupil_frame frame;
        describe(&c, cases[i].fourcc, 0);
        odd_begin(&c);
        it.layer.buffer = in_one_piece;
        it.layer.wait = without_sizes;
        CHECK_MSG(odd_open(&source, NULL) == 0, "%s", why.text);
        CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
        const unsigned char *first = frame.image.data, *chroma = frame.image.chroma, *cr = frame.image.cr;
        CHECK_MSG(cases[i].chroma ? chroma - first == cases[i].chroma : !chroma, "case %zu", i);
        CHECK_MSG(cases[i].cr ? cr - first == cases[i].cr : !cr, "case %zu", i);
        CHECK(frame.dmabuf && frame.dmabuf->fd[0] == 5 && frame.dmabuf->offset_bytes[0] == 64);
        CHECK(!chroma || frame.dmabuf->offset_bytes[1] == 64 + (uint32_t)cases[i].chroma);
        CHECK(!cr || frame.dmabuf->offset_bytes[2] == 64 + (uint32_t)cases[i].cr);
        odd_end(source);
    }
}

/* --- damaged frames --- */

static unsigned count, damaged_at, short_at, cancelled_at;

static int damaging(void *camera, pupil_libcamera_done *done, int timeout_ms)
{
    const int got = it.real->wait(camera, done, timeout_ms);
    count += got == 1;
    if (got == 1) {
        done->damaged = count == damaged_at;
        done->cancelled = count == cancelled_at;
        done->used[0] = count == short_at ? 100 : count % 2 ? done->used[0] : 0; /* 0: it is not said */
    }
    return got;
}

/* They are left out and counted, also on the way to the newest frame. */
static void test_damaged(void)
{
    for (int newest = 0; newest < 2; newest++) {
        fake_libcamera_config c;
        pupil_source *source;
        pupil_frame frame;
        uint64_t last = 0;
        describe(&c, V4L2_PIX_FMT_GREY, 1);
        odd_begin(&c);
        it.layer.wait = damaging;
        count = 0;
        damaged_at = 3;
        short_at = 5;
        cancelled_at = 7;
        CHECK(odd_open(&source, &(pupil_live_options){.capture = {.late = newest}, .hands_off = newest}) == 0);
        for (int i = 0; i < 12; i++) {
            CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FRAME);
            CHECK(i == 0 || frame.info.sequence > last);
            last = frame.info.sequence;
            fake_libcamera_pass(it.fake, newest ? 0.2 : 0.0);
        }
        const pupil_live_counts *counts = &pupil_live_get(source)->counts;
        CHECK_MSG(counts->flagged == 1 && counts->cut == 1 && counts->cancelled == 1, "%llu flagged, %llu cut, %llu",
                  (unsigned long long)counts->flagged, (unsigned long long)counts->cut,
                  (unsigned long long)counts->cancelled);
        CHECK((counts->late > 0) == newest);
        odd_end(source);
    }
}

/* --- requests that are not taken --- */

static unsigned long queued, refused_from, refused_to;

static int queue(void *camera, uint32_t index, const pupil_libcamera_ask *ask)
{
    queued++;
    return queued >= refused_from && queued < refused_to ? -1 : it.real->queue(camera, index, ask);
}

/* Some requests are refused: the stream is started again when too few are left, and exposure is taken over again. */
static void test_queue_fails(void)
{
    for (int hands_off = 0; hands_off < 2; hands_off++)
        for (unsigned long from = 1; from < 8; from++) {
            fake_libcamera_config c;
            pupil_source *source;
            pupil_frame frame;
            describe(&c, V4L2_PIX_FMT_GREY, 1);
            odd_begin(&c);
            it.layer.queue = queue;
            queued = 0;
            refused_from = from;
            refused_to = from + 3;
            CHECK(odd_open(&source, &(pupil_live_options){.hands_off = hands_off}) == 0);
            for (int i = 0; i < 20; i++)
                CHECK_MSG(odd_next(source, &frame) == PUPIL_SOURCE_FRAME, "from %lu: %s", from, why.text);
            CHECK(pupil_live_get(source)->counts.restarted == 1);
            CHECK(fake_libcamera_automatic(it.fake) == hands_off);
            odd_end(source);
        }
}

static int starts;

static int start_fails(void *camera, pupil_why *words)
{
    if (--starts >= 0)
        return it.real->start(camera, words);
    snprintf(words->text, sizeof words->text, "the stream does not start");
    return -1;
}

/* The first start, or the one after a stall. */
static void test_start_fails(void)
{
    fake_libcamera_config c;
    pupil_source *source;
    pupil_frame frame;
    describe(&c, V4L2_PIX_FMT_GREY, 0);
    odd_begin(&c);
    it.layer.start = start_fails;
    starts = 0;
    CHECK(odd_open(&source, NULL) == PUPIL_SOURCE_FAILED && strstr(why.text, "does not start"));
    odd_end(source);
    for (int hands_off = 0; hands_off < 2; hands_off++) {
        c.dead = 1;
        odd_begin(&c);
        it.layer.start = start_fails;
        starts = 1;
        CHECK(odd_open(&source, &(pupil_live_options){.hands_off = hands_off}) == 0);
        CHECK(odd_next(source, &frame) == PUPIL_SOURCE_FAILED);
        CHECK_MSG(strstr(why.text, "no frame within 5 seconds"), "%s", why.text);
        odd_end(source);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_numbers();
    test_planes();
    test_damaged();
    test_queue_fails();
    test_start_fails();
    return check_end();
}

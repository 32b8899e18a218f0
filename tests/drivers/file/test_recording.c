/* Recordings: every format, written and read back bit for bit; the queue; a full disk; wrong words. */
#include "check.h"
#include "scratch.h"

#include "file/recording/recording.h"
#include "file/recording/recording_format.h"
#include "recording_frames.h"

static pupil_why why;

static const pupil_recorder_options waiting = {.camera = "a \"camera\" \\ \n \xc3\xa9 \xff", .fps = 29.97, .wait = 1};

static void test_round_trip(void)
{
    static const uint32_t sizes[][2] = {{4, 2}, {64, 48}, {36, 22}, {1, 1}, {7, 5}, {3, 8}};
    for (uint32_t pixel = 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            const int odd = sizes[i][0] % 4 || sizes[i][1] % 2;
            if (odd && pupil_pixel_is_mosaic(pixel))
                continue;
            test_frames frames;
            frames_make(&frames, pixel, sizes[i][0], sizes[i][1], 5);
            const char *folder = scratch("trip");
            CHECK_MSG(frames_record(&frames, folder, &waiting, &why) == 5, "pixel %u: %s", pixel, why.text);
            CHECK_MSG(frames_replay(&frames, folder, &why) == 5, "pixel %u %ux%u: %s", pixel, sizes[i][0], sizes[i][1],
                      why.text);
            CHECK(scratch_entries(folder) == 3);
            scratch_clear(folder);
            frames_free(&frames);
        }
}

/* A frame without a coding gets the default one; numbers that JSON cannot express are unknown. */
static void test_unknown(void)
{
    test_frames frames;
    pupil_source *source;
    pupil_frame frame;
    static const pupil_coding usual;
    frames_make(&frames, PUPIL_PIXEL_YUYV, 8, 4, 1);
    frames.frame[0].image.coding = NULL;
    frames.frame[0].info.exposure_s = NAN;
    frames.frame[0].info.gain = INFINITY;
    CHECK(frames_record(&frames, scratch("unknown"), &waiting, &why) == 1);
    static const pupil_source_options smaller = {.max_pixels = 31}, options = {.max_pixels = 32};
    CHECK(pupil_recording_open(scratch("unknown"), &smaller, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK_MSG(strstr(why.text, ": frames of 8 x 4 pixels; at most 31 pixels can be read"), "%s", why.text);
    CHECK(pupil_recording_open(scratch("unknown"), &options, &source, &why) == 0);
    CHECK(source->fps == 29.97 && source->frames == 1);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
    CHECK(memcmp(frame.image.coding, &usual, sizeof usual) == 0);
    CHECK(frame.info.exposure_s == 0 && frame.info.gain == 0);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_END);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_END);
    pupil_source_close(source);
    frames_free(&frames);
}

/* Integers come back exactly, however large, and are quoted if a double would round them. */
static void test_large(void)
{
    static const struct {
        uint64_t sequence;
        int64_t ns;
        const char *line;
    } large[] = {
        {(UINT64_C(1) << 53) - 1, 1 - (INT64_C(1) << 53),
         "\"sequence\":9007199254740991,\"timestamp_ns\":-9007199254740991,"},
        {(UINT64_C(1) << 53) + 1, (INT64_C(1) << 53) + 1,
         "\"sequence\":\"9007199254740993\",\"timestamp_ns\":\"9007199254740993\","},
        {UINT64_MAX, INT64_MIN, "\"sequence\":\"18446744073709551615\",\"timestamp_ns\":\"-9223372036854775808\","},
        {0, INT64_MAX, "\"sequence\":0,\"timestamp_ns\":\"9223372036854775807\","}};
    const char *folder = scratch("large");
    static char lines[4096];
    test_frames frames;
    frames_make(&frames, PUPIL_PIXEL_GREY8, 4, 4, 4);
    for (int i = 0; i < 4; i++) {
        frames.frame[i].info.sequence = large[i].sequence;
        frames.frame[i].info.timestamp_ns = large[i].ns;
    }
    CHECK(frames_record(&frames, folder, &waiting, &why) == 4);
    CHECK_MSG(frames_replay(&frames, folder, &why) == 4, "%s", why.text);
    FILE *f = fopen(scratch("large/frames.jsonl"), "r");
    lines[f ? fread(lines, 1, sizeof lines - 1, f) : 0] = 0;
    fclose(f);
    for (int i = 0; i < 4; i++)
        CHECK_MSG(strstr(lines, large[i].line), "%s", large[i].line);
    scratch_clear(folder);
    frames_free(&frames);
}

/* The number of a frame is also exact; no test can record that many. */
static void test_large_frame(void)
{
    static const uint64_t numbers[] = {0, (UINT64_C(1) << 53) - 1, UINT64_C(1) << 53, (UINT64_C(1) << 53) + 1,
                                       UINT64_MAX};
    const pupil_frame_info info = {.exposure_s = 0.01, .gain = 2.0};
    pupil_frame_info again;
    float balance[3];
    char line[PUPIL_RECORDING_LINE_BYTES];
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        uint64_t frame = 1;
        pupil_recording_line(line, numbers[i], &info, NULL);
        CHECK((strncmp(line, "{\"frame\":\"", 10) == 0) == (numbers[i] >= UINT64_C(1) << 53));
        CHECK_MSG(pupil_recording_line_read(line, &frame, &again, balance, &why) == 0, "%s: %s", line, why.text);
        CHECK_MSG(frame == numbers[i], "%s", line);
    }
}

/* --- the queue --- */

/* More frames at once than one slot and any disk can take: unwritten frames are counted, the others are in order. */
static void test_lost(void)
{
    const pupil_recorder_options one = {.fps = 30, .room = 1};
    test_frames frames;
    pupil_recorder *recorder;
    pupil_recorder_counts counts;
    frames_make(&frames, PUPIL_PIXEL_RGBA32F, 512, 256, 2);
    const char *folder = scratch("lost");
    CHECK(pupil_recorder_open(&recorder, folder, &frames.frame[0], &one, &why) == 0);
    uint64_t given = 0;
    do {
        frames.frame[given % 2].info.sequence = given;
        CHECK(pupil_recorder_write(recorder, &frames.frame[given % 2], &why) == 0);
        given++;
        pupil_recorder_get_counts(recorder, &counts);
    } while (given < 10 || (!counts.lost && given < 200));
    CHECK_MSG(counts.lost > 0, "of %d none", (int)given);
    CHECK(pupil_recorder_close(recorder, &why) == 0);

    pupil_source *source;
    pupil_frame frame;
    uint64_t last = 0, got = 0;
    CHECK(pupil_recording_open(folder, NULL, &source, &why) == 0);
    while (pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME) {
        CHECK(!got || frame.info.sequence > last);
        last = frame.info.sequence;
        CHECK(frames_same_image(&frame.image, &frames.frame[last % 2].image));
        got++;
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
    CHECK_MSG(got + counts.lost == given, "%d + %d of %d", (int)got, (int)counts.lost, (int)given);
    scratch_clear(folder);
    frames_free(&frames);
}

/* --- what is refused --- */

static void check_refused(const test_frames *frames, const char *folder, const char *sentence)
{
    pupil_recorder *recorder = (pupil_recorder *)1;
    CHECK(pupil_recorder_open(&recorder, folder, &frames->frame[0], &waiting, &why) == PUPIL_SINK_FAILED);
    CHECK_MSG(!recorder && strstr(why.text, sentence), "%s", why.text);
}

static void test_refused(void)
{
    test_frames frames;
    frames_make(&frames, PUPIL_PIXEL_BAYER10, 8, 4, 2);
    const char *folder = scratch("refused");
    const char *notes = scratch("refused/notes");
    check_refused(&frames, "", "a recording needs a name");
    check_refused(&frames, scratch("none/inside"), "make it first");
    check_refused(&frames, "/dev/null", "/dev/null: is not a folder that can be used");
    mkdir(folder, 0777);
    CHECK(frames_record(&frames, folder, &waiting, &why) == 2); /* an empty one is used */
    check_refused(&frames, folder, "is a recording already; name another folder, or overwrite it");
    scratch_put(notes, "mine");
    pupil_recorder_options over = waiting;
    over.overwrite = 1;
    CHECK(frames_record(&frames, folder, &over, &why) == -1);
    CHECK_MSG(strstr(why.text, "holds notes, which is not part of a recording"), "%s", why.text);
    CHECK(frames_replay(&frames, folder, &why) == 2 && scratch_holds(notes, "mine"));
    remove(notes);
    CHECK(frames_record(&frames, folder, &over, &why) == 2 && frames_replay(&frames, folder, &why) == 2);
    scratch_clear(folder);

    frames.frame[0].image.pixel = PUPIL_PIXEL_COUNT;
    check_refused(&frames, folder, "refused: frames of pixel format ");
    frames.frame[0].image.pixel = PUPIL_PIXEL_RGBA16F; /* one row too many: Matroska's limit is 2^28 - 4 bytes */
    frames.frame[0].image.width = 8192;
    frames.frame[0].image.height = 4096;
    check_refused(&frames, folder, "refused: frames of 268435456 bytes cannot be recorded; at most 268435452 can");
    frames.frame[0].image.pixel = PUPIL_PIXEL_BAYER10;
    frames.frame[0].image.height = 4;
    frames.frame[0].image.width = 7;
    check_refused(&frames, folder, "refused: frames of 7 x 4 pixels; of bayer10 the width is a multiple of 2");
    frames.frame[0].image.width = 8;
    frames.coding.white = -1;
    check_refused(&frames, folder, "refused: the coding of the frames: white must be");
    frames.coding.white = 0;
    over.fps = 0;
    CHECK(frames_record(&frames, folder, &over, &why) == -1 && strstr(why.text, "fps is 0"));
    CHECK(!scratch_exists(folder));

    frames.frame[1].image.height = 2;
    CHECK(frames_record(&frames, folder, &waiting, &why) == 1); /* the second has another size */
    CHECK(frames_replay(&frames, folder, &why) == 1);
    scratch_clear(folder);
    frames_free(&frames);
}

/* --- the disk is full --- */

#define FULL 100

static size_t mkv_of_full(unsigned char *bytes, size_t most)
{
    FILE *f = fopen(scratch("full/frames.mkv"), "r");
    const size_t size = f ? fread(bytes, 1, most, f) : 0;
    if (f)
        fclose(f);
    return size;
}

/* Files are limited to `limit` bytes. `ends`: where each frame ends in an unlimited recording. */
static void check_full(const test_frames *frames, const size_t *ends, unsigned long limit)
{
    static unsigned char bytes[1 << 17];
    const char *folder = scratch("full");
    int right = 0;
    while (right < FULL && ends[right] <= limit)
        right++;
    scratch_limit(limit);
    const int taken = frames_record(frames, folder, &waiting, &why);
    scratch_limit(0);
    CHECK_MSG(taken < 0 && strstr(why.text, "cannot be written: File too large"), "%lu: %d %s", limit, taken, why.text);
    CHECK_MSG(!right == !strstr(why.text, " before "), "%lu: %s", limit, why.text);
    CHECK_MSG(!right == !scratch_exists(folder), "%lu: a folder without a frame stays", limit);
    const int there = right ? frames_replay(frames, folder, &why) : 0;
    CHECK_MSG(there == right, "%lu: %d of %d: %s", limit, there, right, why.text);
    CHECK_MSG(!right || mkv_of_full(bytes, sizeof bytes) == ends[right - 1], "%lu: not the end of a frame", limit);
    scratch_clear(folder);
}

static void test_full(void)
{
    static unsigned char bytes[1 << 17];
    test_frames frames;
    size_t ends[FULL];
    const char *folder = scratch("full");
    frames_make(&frames, PUPIL_PIXEL_GREY16, 16, 16, FULL);
    CHECK(frames_record(&frames, folder, &waiting, &why) == FULL);
    frames_ends(&frames, bytes, mkv_of_full(bytes, sizeof bytes), ends);
    scratch_clear(folder);
    for (unsigned long limit = 1; limit < 8000; limit += 1 + check_random() % 400)
        check_full(&frames, ends, limit);
    check_full(&frames, ends, ends[FULL - 1]); /* nothing, or a part, of what follows them */
    check_full(&frames, ends, ends[FULL - 1] + 100);
    frames_free(&frames);
}

/* --- recording.json and frames.jsonl --- */

static char text[65536];

/* The recording with one `from` replaced by `to` in one of its files. */
static void check_text(const char *folder, const char *name, const char *from, const char *to, const char *sentence)
{
    char path[1100];

    pupil_source *source = NULL;
    pupil_frame frame;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "r");
    text[fread(text, 1, sizeof text - 1, f)] = 0;
    fclose(f);
    const char *at = strstr(text, from);
    CHECK_MSG(at, "%s is not there", from);
    f = fopen(path, "w");
    fprintf(f, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    fclose(f);
    int got = pupil_recording_open(folder, NULL, &source, &why) ? PUPIL_SOURCE_FAILED : PUPIL_SOURCE_FRAME;
    while (got == PUPIL_SOURCE_FRAME)
        got = pupil_source_next(source, &frame, &why);
    pupil_source_close(source);
    CHECK_MSG(got == PUPIL_SOURCE_FAILED && strstr(why.text, sentence), "%s: %d %s", to, got, why.text);
    scratch_put(path, text);
}

static void test_texts(void)
{
    static const char *const about[][3] = {
        {"{", "", "recording.json:2: that is not JSON"},
        {"\"raw\",", "\"raw\"", "recording.json:10: that is not JSON"},
        {"pupil recording", "else", "recording.json: \"format\" must be \"pupil recording\""},
        {"\"version\":\t1", "\"version\":\t2", "recording.json: \"version\" must be 1"},
        {"bayer12", "bayer13", "recording.json: \"pixel\" must be a pixel format"},
        {"bayer12", "rgb9", "recording.json: \"pixel\" must be a pixel format"},
        {"\"width\":\t8", "\"width\":\t8.5", "recording.json: \"width\" must be a whole number"},
        {"\"width\":\t8", "\"width\":\t-8", "recording.json: \"width\" must be a whole number"},
        {"\"width\":\t8", "\"width\":\t4294967304", "recording.json: \"width\" must be a whole number"},
        {"\"width\":\t8", "\"width\":\t7", "recording.json: frames of 7 x 4 pixels"},
        {"\"width\":\t8", "\"width\":\t10", "frames.mkv: frame 0 has 64 bytes; 10 x 4 pixels of bayer12 have 80"},
        {"\"fps\":\t29", "\"fps\":\t-29", "recording.json: \"fps\" must be a number above 0"},
        {"\"raw\"", "\"cooked\"", "recording.json: \"stored\" must be \"raw\" or \"jpeg\""},
        {"\"shift\":\t0", "\"shift\":\t9", "recording.json: the coding of the frames: shift"},
        {"\"black\":\t1", "\"black\":\tx1", "that is not JSON"},
        {"\"black\"", "\"blank\"", "recording.json: \"black\" is missing; it must be a number"},
        {"balance\":\t[", "balance\":\t[1, ", "\"balance\" must be a list of three numbers"},
        {"\n}", "\n}}", "that is not JSON"},
    };
    static const char *const lines[][3] = {
        {"{", "", "frames.jsonl:1: that is not JSON"},
        {"\"frame\":1", "\"frame\":2", "frames.jsonl:2: \"frame\" is 2; in this line it must be 1"},
        {"\"frame\":1,", "", "frames.jsonl:2: \"frame\" is missing"},
        {"\"gain\":", "\"gain\":\"1\",\"x\":", "frames.jsonl:1: \"gain\" must be a number"},
        {"\"timestamp_ns\":0", "\"timestamp_ns\":0.5", "frames.jsonl:1: \"timestamp_ns\" must be a whole number"},
        {"\"sequence\":\"1", "\"sequence\":\"99", "frames.jsonl:"},
        {"\"timestamp_ns\":0", "\"timestamp_ns\":9007199254740993",
         "a whole number, in quotes where it is 2^53 or more"},
        {"\"frame\":1", "\"frame\":9007199254740993", "frames.jsonl:2: \"frame\" must be a whole number, in quotes"},
        {"\"frame\":1", "\"frame\":\"9007199254740993\"", "\"frame\" is 9007199254740993; in this line it must be 1"},
    };
    test_frames frames;
    frames_make(&frames, PUPIL_PIXEL_BAYER12, 8, 4, 4);
    frames.coding.black = 16;
    frames.coding.shift = 0;
    const char *folder = scratch("texts");
    CHECK(frames_record(&frames, folder, &waiting, &why) == 4);
    for (size_t i = 0; i < sizeof about / sizeof *about; i++)
        check_text(folder, "recording.json", about[i][0], about[i][1], about[i][2]);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        check_text(folder, "frames.jsonl", lines[i][0], lines[i][1], lines[i][2]);
    CHECK(frames_replay(&frames, folder, &why) == 4);
    scratch_put(scratch("texts/frames.mkv"), "no Matroska at all, but long enough for a head");
    CHECK(frames_replay(&frames, folder, &why) == -1 && strstr(why.text, "frames.mkv: is not a Matroska file"));
    scratch_clear(folder);
    CHECK(!pupil_is_recording(folder));
    frames_free(&frames);
}

/* The knees of a companded sensor. */
static void test_knees(void)
{
    test_frames frames;
    const char *folder = scratch("knees");
    frames_make(&frames, PUPIL_PIXEL_BAYER12, 8, 4, 2);
    frames.coding.white = 0;
    frames.coding.knees = 2;
    for (int k = 0; k < 2; k++) {
        frames.coding.knee_code[k] = (float)(1000.5 + 1000 * k);
        frames.coding.knee_light[k] = 0.01f + 0.1f * (float)k;
    }
    CHECK(frames_record(&frames, folder, &waiting, &why) == 2);
    CHECK_MSG(frames_replay(&frames, folder, &why) == 2, "%s", why.text);
    check_text(folder, "recording.json", "knee_light\":\t[", "knee_light\":\t[1, ", "must be a list of eight numbers");
    check_text(folder, "recording.json", "1000.5", "3000.5", "knee_code must rise");
    scratch_clear(folder);
    frames_free(&frames);
}

/* White balance that follows the frames: each has its own; with the first one's balance there is none in the line. */
static void test_balance(void)
{
    test_frames frames;
    pupil_coding coding[6];
    const char *folder = scratch("balance");
    frames_make(&frames, PUPIL_PIXEL_BAYER12, 8, 4, 6);
    for (int i = 0; i < 6; i++) {
        coding[i] = frames.coding;
        for (int k = 0; k < 3 && i % 3; k++)
            coding[i].balance[k] = (float)(1 + 3 * check_uniform());
        frames.frame[i].image.coding = &coding[i];
    }
    memset(coding[4].balance, 0, sizeof coding[4].balance);
    CHECK(frames_record(&frames, folder, &waiting, &why) == 6);
    CHECK_MSG(frames_replay(&frames, folder, &why) == 6, "%s", why.text);
    check_text(folder, "frames.jsonl", "\"balance\":[", "\"balance\":[0,", "must be a list of three factors");
    coding[5].black++;
    CHECK(frames_record(&frames, scratch("other"), &waiting, &why) == 5 && strstr(why.text, "coding"));
    scratch_clear(scratch("other"));
    scratch_clear(folder);
    frames_free(&frames);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_round_trip();
    test_unknown();
    test_large();
    test_large_frame();
    test_lost();
    test_refused();
    test_full();
    test_texts();
    test_balance();
    test_knees();
    scratch_clear(scratch_folder);
    return check_end();
}

/* Raw files: frames are the file's bytes, as many as it has; the keys' meaning; errors are reported. */
#include "scratch.h"

#include "raw/raw_source.h"

static pupil_why why;

/* A file of so many random bytes, which are kept for comparison. */
static uint8_t *make(const char *name, size_t bytes)
{
    uint8_t *content = malloc(bytes);
    FILE *file = fopen(scratch(name), "wb");
    for (size_t i = 0; i < bytes; i++)
        content[i] = (uint8_t)check_random();
    CHECK(file && fwrite(content, 1, bytes, file) == bytes && fclose(file) == 0);
    return content;
}

static pupil_source *open_raw(const char *name, const char *keys)
{
    char text[4096];
    pupil_source *source = NULL;
    snprintf(text, sizeof text, "%.2000s,%.1000s", scratch(name), keys);
    if (pupil_raw_source_open(text, NULL, &source, &why))
        CHECK(source == NULL && !strchr(why.text, '\n'));
    return source;
}

/* Frames of a format are the bytes of the file, row by row and plane by plane. */
static void test_bytes(void)
{
    static const struct {
        const char *format;
        uint32_t pixel, bayer;
        size_t frame_bytes; /* of 8 x 6 */
    } formats[] = {{"pRAA", PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_RGGB, 60},
                   {"pGAA", PUPIL_PIXEL_BAYER10P, PUPIL_BAYER_GBRG, 60},
                   {"pBCC", PUPIL_PIXEL_BAYER12P, PUPIL_BAYER_BGGR, 72},
                   {"RG10", PUPIL_PIXEL_BAYER10, PUPIL_BAYER_RGGB, 96},
                   {"BA10", PUPIL_PIXEL_BAYER10, PUPIL_BAYER_GRBG, 96},
                   {"RG14", PUPIL_PIXEL_BAYER14, PUPIL_BAYER_RGGB, 96},
                   {"BA81", PUPIL_PIXEL_BAYER8, PUPIL_BAYER_BGGR, 48},
                   {"GREY", PUPIL_PIXEL_GREY8, 0, 48},
                   {"Y10P", PUPIL_PIXEL_GREY10P, 0, 60},
                   {"YUYV", PUPIL_PIXEL_YUYV, 0, 96},
                   {"NV12", PUPIL_PIXEL_NV12, 0, 72},
                   {"YU12", PUPIL_PIXEL_I420, 0, 72},
                   {"NV16", PUPIL_PIXEL_NV16, 0, 96},
                   {"P010", PUPIL_PIXEL_P010, 0, 144},
                   {"RGB3", PUPIL_PIXEL_RGB8, 0, 144}};
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        const size_t bytes = formats[i].frame_bytes;
        uint8_t *content = make("a.raw", 3 * bytes);
        char keys[100];
        snprintf(keys, sizeof keys, "format=%s,size=8x6", formats[i].format);
        pupil_source *source = open_raw("a.raw", keys);
        CHECK_MSG(source && source->frames == 3, "%s: %s", keys, why.text);
        for (size_t n = 0; source && n < 3; n++) {
            pupil_frame frame;
            CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME && frame.info.sequence == n);
            CHECK(frame.image.pixel == formats[i].pixel && frame.image.width == 8 && frame.image.height == 6);
            CHECK(frame.image.coding && frame.image.coding->bayer == formats[i].bayer);
            CHECK_MSG(memcmp(frame.image.data, content + n * bytes, bytes) == 0, "%s: frame %zu is another one", keys,
                      n);
            CHECK(!frame.image.chroma || (const uint8_t *)frame.image.chroma ==
                                             (const uint8_t *)frame.image.data + 6 * frame.image.stride_bytes);
            pupil_source_done(source, &frame);
        }
        pupil_frame none;
        CHECK(source && pupil_source_next(source, &none, &why) == PUPIL_SOURCE_END);
        pupil_source_close(source);
        free(content);
    }
}

static void test_layout(void)
{
    pupil_raw_layout l;
    pupil_image_const image;
    CHECK(pupil_raw_layout_read(&l,
                                "a,b.raw,format=RG12,size=4x2,stride=16,skip=7,black=64.5,white=4000,shift=2,"
                                "balance=2/1/1.5,knees=1024:0.0156/2048:0.125,matrix=1/0/0/0/1/0/0/0/1",
                                &why) == 0);
    CHECK(strcmp(l.file, "a,b.raw") == 0 && l.stride_bytes == 16 && l.skip_bytes == 7 && l.coding.white == 4000.0f &&
          l.coding.shift == 2 && l.colour.given_black == 64.5f && l.colour.given_balance[2] == 1.5f &&
          l.colour.knees == 2 && l.colour.knee_light[1] == 0.125f && l.colour.given_matrix[8] == 1.0f);
    CHECK(pupil_raw_layout_image(&l, NULL, &image) == 32);
    CHECK(pupil_raw_layout_read(&l, "a,format=NV12,size=6x5,stride=10", &why) == 0);
    CHECK(pupil_raw_layout_image(&l, NULL, &image) == 80);
    static const char *const wrong[][2] = {
        {"", "raw: needs a file"},
        {"a", "needs format= and size="},
        {"a,format=RG10", "needs size="},
        {"a,size=2x2", "needs format="},
        {"a,format=RGXX,size=2x2", "format=RGXX: a V4L2 format"},
        {"a,format=MJPG,size=2x2", "format=MJPG: a V4L2 format"},
        {"a,format=RG10,size=3x2", "even sides"},
        {"a,format=pRAA,size=6x2", "multiple of 4"},
        {"a,format=RG10,size=0x2", "size=0x2: WIDTHxHEIGHT"},
        {"a,format=RG10,size=4", "size=4: WIDTHxHEIGHT"},
        {"a,format=RG10,size=99999x2", "each 1 to 16384"},
        {"a,format=RG10,size=4x2,stride=7", "a row of 4 pixels of RG10 has 8 bytes"},
        {"a,format=NV12,size=4x2,stride=3", "stride 3"},
        {"a,format=GB14,size=8x6,stride=17", "stride 17: samples of GB14 have two bytes, so it must be even"},
        {"a,format=P010,size=4x2,stride=9", "stride 9: samples of P010"},
        {"a,format=pRAA,size=8x6,stride=17", NULL},
        {"a,format=YUYV,size=4x2,stride=9", NULL},
        {"a,format=RG10,size=4x2,black=-1", "black=-1: a code"},
        {"a,format=RG10,size=4x2,black=nan", "black=nan: a code"},
        {"a,format=RG10,size=4x2,balance=1/2", "balance=1/2: auto, off or R/G/B"},
        {"a,format=RG10,size=4x2,balance=0/0/0", "balance=0/0/0: factors from 0.001 to 1024"},
        {"a,format=RG10,size=4x2,matrix=1/0/0", "nine numbers"},
        {"a,format=RG10,size=4x2,knees=1024", "CODE:LIGHT"},
        {"a,format=RG10,size=4x2,shift=9", "0 to 8"},
        {"a,format=RG10,size=4x2,skip=-1", "a number of bytes"},
        {"a,format=RG10,size=4x2,colour=red", "was expected"},
        {"a,format=RG10,size", "a key and ="},
        {"a,format=RG10 too long for one,size=2x2", "a V4L2 format"},
        {"a,format=YV12,size=2x2", "a V4L2 format"},
        {"a,format=RG10,size=4x2.5", "WIDTHxHEIGHT"},
        {"a,format=RG10,size=4x0", "WIDTHxHEIGHT"},
        {"a,format=RG10,size=4x99999", "WIDTHxHEIGHT"},
        {"a,format=RG10,size=x2", "WIDTHxHEIGHT"},
        {"a,format=RG10,size=4x2,skip=1/2", "a number of bytes"},
        {"a,format=RG10,size=4x2,black=1/2", "black=1/2: a code"},
        {"a,format=RG10,size=4x2,white=65536", "white=65536: a code"},
        {"a,format=RG10,size=4x2,balance=1/2000/1", "factors from 0.001 to 1024"},
        {"a,format=RG10,size=4x2,shift=x", "0 to 8"},
        {"a,format=RG10,size=4x2,knees=1:1/2:2/3:3/4:4/5:5/6:6/7:7/8:8/9:9", "up to 8 points"},
        {"a,format=RG10,size=4x2,knees=1:0.1/2", "up to 8 points"},
        {"a,format=RG10,size=2x3", "even sides"},
        {"a,format=YU12,size=8x2,stride=9", NULL}, /* Cb and Cr at half the stride */
        {"a,format=NV12,size=4x2,stride=4", NULL},
        {"a,format=YU12,size=7x2,stride=7", "stride 7: a row of 7 pixels of YU12"},
        {"a,2=b,format=GREY,size=4x2,balance=auto", NULL}, /* no letter: a name */
        {"a,b,format=GREY,size=4x2", NULL},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        why.text[0] = 0;
        const int refused = pupil_raw_layout_read(&l, wrong[i][0], &why) == -1;
        CHECK_MSG(refused == (wrong[i][1] != NULL) && (!refused || strstr(why.text, wrong[i][1])), "%s: %s",
                  wrong[i][0], why.text);
    }
    /* Nothing is truncated and then mistaken for something else. */
    char *longest = malloc(6000);
    snprintf(longest, 6000, "a,format=GREY,size=4x2,knees=1:0.1/2:%0300d", 3);
    CHECK(pupil_raw_layout_read(&l, longest, &why) == -1 && strstr(why.text, "a key of over 255 bytes"));
    memset(longest, 'a', 5000);
    snprintf(longest + 5000, 1000, ",format=GREY,size=4x2");
    CHECK(pupil_raw_layout_read(&l, longest, &why) == -1 && strstr(why.text, "raw: a path of over 4096 bytes"));
    free(longest);
}

/* The results of next, in order: f a complete frame, d a damaged one. */
static void check_turns(pupil_source *source, const char *turns)
{
    for (; source && *turns; turns++) {
        pupil_frame frame;
        const int got = pupil_source_next(source, &frame, &why);
        CHECK_MSG(got == (*turns == 'f' ? PUPIL_SOURCE_FRAME : PUPIL_SOURCE_DAMAGED), "%s: %d %s", turns, got,
                  why.text);
        if (got == PUPIL_SOURCE_FRAME)
            pupil_source_done(source, &frame);
    }
    pupil_frame none;
    CHECK(source && pupil_source_next(source, &none, &why) == PUPIL_SOURCE_END);
    pupil_source_close(source);
}

static void test_cut(void)
{
    free(make("cut.raw", 3 * 16 + 5));
    check_turns(open_raw("cut.raw", "format=GREY,size=4x4"), "fffd");
    check_turns(open_raw("cut.raw", "format=GREY,size=4x4,skip=5"), "fff");
    check_turns(open_raw("cut.raw", "format=GREY,size=8x8"), "d");
    CHECK(strstr(why.text, "has 53 bytes; a frame of 8x8 GREY has 64"));
    check_turns(open_raw("cut.raw", "format=GREY,size=4x4,skip=1000"), "d");
    CHECK(open_raw("absent.raw", "format=GREY,size=4x4") == NULL && strstr(why.text, "absent.raw: cannot be opened"));
    CHECK(open_raw("cut.raw", "format=RG10,size=2x2,black=1023") == NULL &&
          strstr(why.text, "does not suit RG10: black"));
    CHECK(open_raw("cut.raw", "format=YUYV,size=2x2,black=16") == NULL && strstr(why.text, "does not suit YUYV"));
    CHECK(mkdir(scratch("dumps"), 0777) == 0 && open_raw("dumps", "format=GREY,size=4x4") == NULL);
    CHECK(strstr(why.text, "the folder is empty"));
    free(make("dumps/2.raw", 16));
    free(make("dumps/10.raw", 40));
    free(make("dumps/1.raw", 3));
    check_turns(open_raw("dumps", "format=GREY,size=4x4"), "dfffd");
}

/* The first frame of a still is already balanced: a grey wall that its sensor sees as green comes out grey. */
static void test_balance(void)
{
    uint8_t mosaic[16];
    for (int i = 0; i < 16; i++)
        mosaic[i] = (i / 4) % 2 == 0 ? (i % 2 == 0 ? 50 : 100) : i % 2 == 0 ? 100 : 80;
    FILE *file = fopen(scratch("wall.raw"), "wb");
    CHECK(file && fwrite(mosaic, 1, 16, file) == 16 && fclose(file) == 0);
    static const struct {
        const char *keys;
        float red, blue;
    } balances[] = {{"format=RGGB,size=4x4", 2.0f, 1.25f},
                    {"format=RGGB,size=4x4,balance=off", 1.0f, 1.0f},
                    {"format=RGGB,size=4x4,balance=3/1/4", 3.0f, 4.0f}};
    for (size_t i = 0; i < 3; i++) {
        pupil_frame frame;
        pupil_source *source = open_raw("wall.raw", balances[i].keys);
        CHECK(source && pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
        const float *b = frame.image.coding->balance, green = b[1] ? b[1] : 1.0f;
        const float red = (b[0] ? b[0] : 1.0f) / green, blue = (b[2] ? b[2] : 1.0f) / green;
        CHECK_MSG(red > 0.98f * balances[i].red && red < 1.02f * balances[i].red && blue > 0.98f * balances[i].blue &&
                      blue < 1.02f * balances[i].blue,
                  "%s: %g %g %g", balances[i].keys, (double)b[0], (double)b[1], (double)b[2]);
        pupil_source_close(source);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_bytes();
    test_layout();
    test_cut();
    test_balance();
    scratch_clear(scratch_folder);
    return check_end();
}

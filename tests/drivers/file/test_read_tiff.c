/* TIFF, made tag by tag in both byte orders: what its first directory says, and which kinds are refused because libav
 * would decode them wrongly or not at all. Also other files that libav reads and pupil does not take as pictures. */
#include "file/still/still.h"
#include "file/still/tiff_tags.h"
#include "file/still/upright.h"

#include "clip.h"
#include "scratch.h"

enum { SHORT = 3, LONG = 4, MOST = 512 };

typedef struct tag {
    uint32_t tag, type, value;
} tag;

typedef struct tiff {
    uint8_t bytes[MOST];
    size_t size;
    int is_big;
} tiff;

static pupil_why why;

static void add(tiff *t, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        t->bytes[t->size++] = (uint8_t)(value >> 8 * (t->is_big ? bytes - 1 - i : i));
}

/* A header, one directory, then samples of a quarter of white, except a 0 at the beginning of the second row;
 * StripOffsets has their position. */
static tiff tiff_of(int is_big, const tag *tags, uint32_t count)
{
    tiff t = {.is_big = is_big};
    memcpy(t.bytes, is_big ? "MM\0*" : "II*\0", 4);
    t.size = 4;
    add(&t, 8, 4);
    add(&t, count, 2);
    for (uint32_t i = 0; i < count; i++) {
        add(&t, tags[i].tag, 2);
        add(&t, tags[i].type, 2);
        add(&t, 1, 4);
        if (tags[i].type == SHORT) {
            add(&t, tags[i].value, 2);
            add(&t, 0, 2);
        } else {
            add(&t, tags[i].tag == 273 ? 8 + 2 + 12 * count + 4 : tags[i].value, 4);
        }
    }
    add(&t, 0, 4);
    while (t.size < MOST)
        add(&t, 64, 1);
    t.bytes[8 + 2 + 12 * count + 4 + 4] = 0;
    return t;
}

/* A grey picture of 4 x 2, with one tag replaced or added. */
static tiff picture(int is_big, tag other)
{
    static const tag all[] = {{256, SHORT, 4}, {257, SHORT, 2}, {258, SHORT, 8}, {259, SHORT, 1}, {262, SHORT, 1},
                              {273, LONG, 0},  {277, SHORT, 1}, {278, SHORT, 2}, {279, LONG, 8}};
    tag tags[10];
    uint32_t count = 0, i = 0;
    while (i < 9 && all[i].tag < other.tag)
        tags[count++] = all[i++];
    tags[count++] = other;
    for (i += i < 9 && all[i].tag == other.tag; i < 9; i++)
        tags[count++] = all[i];
    return tiff_of(is_big, tags, count);
}

static void test_find(void)
{
    static const tag tags[] = {{259, SHORT, 7}, {324, LONG, 123456}};
    for (int is_big = 0; is_big < 2; is_big++) {
        tiff t = tiff_of(is_big, tags, 2);
        uint32_t value = 0;
        CHECK(pupil_tiff_find(t.bytes, t.size, 259, &value) && value == 7);
        CHECK(pupil_tiff_find(t.bytes, t.size, 324, &value) && value == 123456);
        CHECK(!pupil_tiff_find(t.bytes, t.size, 256, &value));
        CHECK(!pupil_tiff_find(t.bytes, 8 + 2 + 12 + 11, 324, &value)); /* cut within its entry */
        CHECK(!pupil_tiff_find(t.bytes, 9, 259, &value));
        CHECK(!pupil_tiff_find(t.bytes, 7, 259, &value) && !pupil_is_tiff(t.bytes, 7));
        memset(t.bytes + 4, 0xff, 4); /* a directory far beyond the end */
        CHECK(pupil_is_tiff(t.bytes, t.size) && !pupil_tiff_find(t.bytes, t.size, 259, &value));
        t.bytes[3] ^= 1;
        CHECK(!pupil_is_tiff(t.bytes, t.size));
    }
}

static void test_kinds(void)
{
    static const struct {
        tag tag;
        const char *words; /* NULL: it is read */
    } cases[] = {{{259, SHORT, 1}, NULL},
                 {{324, LONG, 200}, "is a TIFF in tiles; save it in strips"},
                 {{322, SHORT, 4}, "is a TIFF in tiles; save it in strips"}, /* with the offsets of strips */
                 {{259, SHORT, 34676}, "is a TIFF of LogLuv"},
                 {{259, SHORT, 34677}, "is a TIFF of LogLuv"},
                 {{259, SHORT, 32809}, "is a TIFF of compression 32809, which is not read; save it as LZW"},
                 {{259, SHORT, 0}, "is a TIFF of compression 0, which"},
                 {{259, SHORT, 6}, "is a TIFF compressed as JPEG"},
                 {{259, SHORT, 7}, "is a TIFF compressed as JPEG"},
                 {{262, SHORT, 8}, "is a TIFF in CIE L*a*b*, which is not read; convert it"},
                 {{262, SHORT, 9}, "L*a*b*"},
                 {{262, SHORT, 10}, "L*a*b*"},
                 {{262, SHORT, 32844}, "libav lacks this kind of file: "}, /* CIE Log2(L) */
                 {{258, SHORT, 64}, "libav lacks this kind of file: "},
                 {{256, SHORT, 20000}, ""}};
    for (size_t i = 0; i < 2 * sizeof cases / sizeof *cases; i++) {
        const tiff t = picture(i % 2, cases[i / 2].tag);
        pupil_still still = {.most = 1000000};
        why.text[0] = 0;
        const int failed = pupil_read_libav(&still, t.bytes, t.size, &why);
        const char *words = cases[i / 2].words;
        CHECK_MSG(failed == (words ? -1 : 0) && (!words || strstr(why.text, words)), "case %zu: %s", i, why.text);
        CHECK_MSG(words || (still.width == 4 && still.height == 2 && still.pixel == PUPIL_PIXEL_RGB32F), "case %zu", i);
        CHECK_MSG(failed || fabsf(((float *)still.pixels)[0] - 0.0478f) < 1e-4f, "%g",
                  failed ? 0.0 : (double)((float *)still.pixels)[0]); /* code 64: TIFF 6.0 has a gamma of 2.2 */
        pupil_still_free(&still);
    }
}

/* libav takes four planes for green, blue, red and alpha. */
static void test_cmyk(void)
{
    static const tag tags[] = {{256, SHORT, 4}, {257, SHORT, 2}, {258, SHORT, 8}, {259, SHORT, 1}, {262, SHORT, 5},
                               {273, LONG, 0},  {277, SHORT, 4}, {278, SHORT, 2}, {279, LONG, 32}, {284, SHORT, 2}};
    for (int i = 0; i < 4; i++) {
        const tiff t = tiff_of(i % 2, tags, i < 2 ? 10 : 9);
        pupil_still still = {.most = 1000000};
        const int failed = pupil_read_libav(&still, t.bytes, t.size, &why);
        CHECK_MSG(i < 2 ? failed && strstr(why.text, "is a TIFF of CMYK in planes, which is not read") : !failed, "%s",
                  why.text);
        pupil_still_free(&still);
    }
}

/* LZW as it was before TIFF 6.0: libav knows it by its first two bytes. */
static void test_old_lzw(void)
{
    tiff t = picture(0, (tag){259, SHORT, 5});
    pupil_still still = {.most = 1000000};
    t.bytes[8 + 2 + 12 * 9 + 4] = 0;
    t.bytes[8 + 2 + 12 * 9 + 5] = 1;
    CHECK(pupil_read_libav(&still, t.bytes, t.size, &why) == -1);
    CHECK_MSG(strstr(why.text, "libav lacks this kind of file: Old style LZW"), "%s", why.text);
    pupil_still_free(&still);
}

/* Each orientation: where the corner at the bottom left of the stored picture is shown. */
static void test_upright(void)
{
    static const struct {
        uint32_t x, y;
    } black[] = {{0, 1}, {0, 1}, {3, 1}, {3, 0}, {0, 0}, {1, 0}, {0, 0}, {0, 3}, {1, 3}, {0, 1}};
    for (uint32_t i = 0; i < 4 * sizeof black / sizeof *black; i++) {
        const uint32_t orientation = i / 4, is_on_side = orientation >= 5 && orientation <= 8;
        const tiff t = picture(i % 2, (tag){274, SHORT, orientation});
        pupil_still still = {.most = 1000000, .as_stored = i / 2 % 2};
        CHECK_MSG(pupil_read_libav(&still, t.bytes, t.size, &why) == 0, "%s", why.text);
        CHECK(pupil_orientation_of(t.bytes, t.size) == (orientation >= 1 && orientation <= 8 ? orientation : 1));
        const uint32_t width = is_on_side && !still.as_stored ? 2 : 4;
        const size_t at = still.as_stored ? 4 : black[orientation].y * width + black[orientation].x;
        CHECK_MSG(still.width == width && still.height == 8 / width, "orientation %u", orientation);
        for (size_t k = 0; k < 8; k++)
            CHECK_MSG((((float *)still.pixels)[3 * k + 1] == 0.0f) == (k == at), "orientation %u: %zu", orientation, k);
        pupil_still_free(&still);
    }
}

/* The Exif of a WebP and of a PNG; cut off anywhere it is ignored. */
static void test_exif_in_chunks(void)
{
    static const uint8_t png[] = "\x89PNG\r\n\x1a\n\0\0\0\3oddXabccrc.\0\0\0\x1a"
                                 "eXIfMM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0crc.";
    static const uint8_t webp[] = "RIFF\x3c\0\0\0WEBPodd \3\0\0\0abc\0EXIF\x20\0\0\0Exif\0\0"
                                  "MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0";
    CHECK(pupil_orientation_of(webp, sizeof webp - 1) == 6);
    for (size_t size = 0; size < sizeof webp - 1; size++)
        CHECK(pupil_orientation_of(webp, size) == 1);
    CHECK(pupil_orientation_of(png, sizeof png - 1) == 6);
    for (size_t size = 0; size < sizeof png - 1; size++)
        CHECK(pupil_orientation_of(png, size) == 1);
}

static int sample(const clip *c, int frame, int component, int x, int y)
{
    (void)c;
    return 100 + frame + component + x + y;
}

/* The first frame of an SDR video is a picture, also when the video is read from memory. */
static void test_of_video(void)
{
    static const struct {
        clip c;
        const char *words;
    } cases[] = {
        {{.container = "matroska", .codec = "ffv1", .format = AV_PIX_FMT_YUV420P, .transfer = AVCOL_TRC_BT709}, NULL},
        {{.container = "mov", .codec = "png", .format = AV_PIX_FMT_RGB24}, NULL},
        {{.container = "matroska", .codec = "ffv1", .format = AV_PIX_FMT_YUV420P10, .transfer = AVCOL_TRC_SMPTE2084},
         "is a still of PQ or HLG"},
        {{.container = "nut", .codec = "rawvideo", .format = AV_PIX_FMT_BAYER_RGGB8}, "is a still of a mosaic"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        clip c = cases[i].c;
        const char *path = scratch("video");
        size_t size = 0;
        c.width = c.height = 16;
        c.frames = 2;
        c.code = sample;
        c.space = c.format == AV_PIX_FMT_RGB24 ? AVCOL_SPC_RGB : AVCOL_SPC_UNSPECIFIED;
        c.primaries = AVCOL_PRI_UNSPECIFIED;
        if (clip_write(&c, path)) {
            CHECK_MSG(0, "case %zu cannot be written", i);
            continue;
        }
        uint8_t *bytes = clip_load(path, &size);
        pupil_still still = {.most = 1000000};
        why.text[0] = 0;
        const int failed = pupil_read_libav(&still, bytes, size, &why);
        CHECK_MSG(failed == (cases[i].words ? -1 : 0), "case %zu: %s", i, why.text);
        CHECK_MSG(!cases[i].words || strstr(why.text, cases[i].words), "case %zu: %s", i, why.text);
        CHECK(failed || (still.width == 16 && still.height == 16));
        pupil_still_free(&still);
        free(bytes);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_find();
    test_kinds();
    test_cmyk();
    test_old_lzw();
    test_upright();
    test_exif_in_chunks();
    test_of_video();
    scratch_clear(scratch_folder);
    return check_end();
}

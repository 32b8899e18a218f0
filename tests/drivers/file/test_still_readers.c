/* PFM and Radiance files made byte by byte, and what loading says of files that are no image. */
#include "still_check.h"

static pupil_why why;

static void add_floats(bytes *b, const float *values, size_t count, int big_endian)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        uint8_t out[4];
        memcpy(&bits, values + i, 4);
        for (int k = 0; k < 4; k++)
            out[k] = (uint8_t)(bits >> 8 * (big_endian ? 3 - k : k));
        add(b, out, 4);
    }
}

static void test_pfm_kinds(void)
{
    static const struct {
        const char *header;
        int channels, big_endian;
    } kinds[] = {{"PF\n2 2\n-1.0\n", 3, 0},
                 {"PF\n2 2\n1.0\n", 3, 1},
                 {"Pf 2 2 -0.003922\n", 1, 0},
                 {"Pf\r\n2 2\r\n2.5\r\n", 1, 1},
                 {"PF4\n2 2\n-1\n", 4, 0}};
    const float samples[16] = {1, 2, 3, 0.25f, -5, 1e30f, 0x1p-149f, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        int n = kinds[k].channels, grey = n == 1;
        static bytes b;
        pupil_still still = {0};
        b.size = 0;
        add_text(&b, kinds[k].header);
        add_floats(&b, samples, (size_t)n * 4, kinds[k].big_endian);
        CHECK_MSG(read_exact(pupil_read_pfm, &still, b.data, b.size, &why) == 0, "%s", why.text);
        CHECK(still.width == 2 && still.height == 2 && still.pixel == PUPIL_PIXEL_RGB32F && still.exposure_s == 0);
        for (uint32_t y = 0; y < 2 && still.width == 2; y++)
            for (uint32_t x = 0; x < 2; x++) {
                const float *s = samples + n * (int)((1 - y) * 2 + x); /* the file begins with the lowest row */
                CHECK(rgb_is(&still, x, y, s[0], s[grey ? 0 : 1], s[grey ? 0 : 2]));
            }
        check_damage(pupil_read_pfm, b.data, b.size, 500);
        pupil_still_free(&still);
    }
}

static void test_pfm_refusals(void)
{
    static const struct {
        const char *file, *says;
    } cases[] = {
        {"PX\n1 1\n-1\n", "line PF, Pf or PF4"},
        {"PF\n-1 1\n-1\n", "width \"-1\""},
        {"PF\n1 1x\n-1\n", "height \"1x\""},
        {"PF\n0 1\n-1\n", "0 x 1 pixels"},
        {"PF\n99999999999999999999 1\n-1\n", "at most 16384"},
        {"PF\n16384 16384\n-1\n", "at most 67108864 in all"},
        {"PF\n1 1\n0.0\n............", "scale \"0.0\""},
        {"PF\n1 1\nnan\n............", "scale \"nan\""},
        {"PF\n1 1\n-inf\n............", "scale \"-inf\""},
        {"PF\n1 1\n-1,5\n............", "scale \"-1,5\""},
        {"PF\n1 1", "height"},
        {"PF\n1 1\n-1\n...........", "need 12 bytes of samples; the file has 11"},
        {"PF\n8192 8192\n-1\n....", "need 805306368 bytes"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECK_REFUSED(pupil_read_pfm, cases[i].file, strlen(cases[i].file), cases[i].says);
}

static int read_hdr(pupil_still *still, const char *header, const void *pixels, size_t size)
{
    static bytes b;
    b.size = 0;
    add_text(&b, header);
    add(&b, pixels, size);
    return read_exact(pupil_read_radiance, still, b.data, b.size, &why);
}

/* A picture of 2 x 3 whose red is the position in the file: where does each pixel land? */
static void test_radiance_orientations(void)
{
    static const struct {
        const char *line;
        uint32_t width, height;
        int order[6]; /* the positions in the file, row by row from the top left */
    } cases[] = {
        {"-Y 3 +X 2\n", 2, 3, {0, 1, 2, 3, 4, 5}}, {"-Y 3 -X 2\n", 2, 3, {1, 0, 3, 2, 5, 4}},
        {"+Y 3 +X 2\n", 2, 3, {4, 5, 2, 3, 0, 1}}, {"+Y 3 -X 2\n", 2, 3, {5, 4, 3, 2, 1, 0}},
        {"+X 3 -Y 2\n", 3, 2, {0, 2, 4, 1, 3, 5}}, {"-X 3 -Y 2\n", 3, 2, {4, 2, 0, 5, 3, 1}},
        {"+X 3 +Y 2\n", 3, 2, {1, 3, 5, 0, 2, 4}}, {"-X 3 +Y 2\r\n", 3, 2, {5, 3, 1, 4, 2, 0}},
    };
    uint8_t pixels[24];
    for (int i = 0; i < 6; i++) {
        const uint8_t pixel[4] = {(uint8_t)(128 + i), 64, 32, 129};
        memcpy(pixels + 4 * i, pixel, 4);
    }
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        pupil_still still = {0};
        char header[100];
        snprintf(header, sizeof header, "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n%s", cases[k].line);
        CHECK_MSG(read_hdr(&still, header, pixels, 24) == 0, "%s", why.text);
        CHECK(still.width == cases[k].width && still.height == cases[k].height);
        for (uint32_t i = 0; i < 6 && still.width == cases[k].width; i++)
            CHECK_MSG(rgb_is(&still, i % still.width, i / still.width, 1 + cases[k].order[i] / 128., 0.5, 0.25),
                      "%s pixel %u", cases[k].line, i);
        pupil_still_free(&still);
    }
}

static void test_radiance_header(void)
{
    static const uint8_t white[] = {128, 128, 128, 129}, black[] = {255, 255, 255, 0}, least[] = {1, 2, 255, 1};
    static const uint8_t red[] = {128, 0, 0, 129};
    pupil_still still = {0};
    CHECK(read_hdr(&still, "#?RGBE\nEXPOSURE=4\nGAMMA=1\nEXPOSURE= 0.5\nCOLORCORR=1 2 4\n\n-Y 1 +X 1\n", white, 4) ==
          0);
    CHECK(rgb_is(&still, 0, 0, 0.5, 0.25, 0.125) && still.exposure_s == 0);
    /* An exposure of 0 is unknown: LearnOpenGL's newport_loft.hdr has it. */
    CHECK(read_hdr(&still, "#?RADIANCE\nEXPOSURE=0\nEXPOSURE=2\n\n-Y 1 +X 1\n", white, 4) == 0);
    CHECK(rgb_is(&still, 0, 0, 0.5, 0.5, 0.5));
    CHECK(read_hdr(&still, "#?RADIANCE\n\n-Y 1 +X 1\n", black, 4) == 0 && rgb_is(&still, 0, 0, 0, 0, 0));
    CHECK(read_hdr(&still, "#?RADIANCE\n\n-Y 1 +X 1\n", least, 4) == 0);
    CHECK(rgb_is(&still, 0, 0, 0x1p-135, 0x1p-134, 255 * 0x1p-135));

    /* Unspecified primaries leave the bits unchanged; so does Rec.709. */
    CHECK(read_hdr(&still, "#?RADIANCE\nPRIMARIES=0 0 0 0 0 0 0 0\n\n-Y 1 +X 1\n", red, 4) == 0);
    CHECK(rgb_is(&still, 0, 0, 1, 0, 0));
    CHECK(read_hdr(&still, "#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 .313 .329\n\n-Y 1 +X 1\n", red, 4) == 0);
    CHECK(rgb_is(&still, 0, 0, 1, 0, 0));
    CHECK(read_hdr(&still, "#?RADIANCE\nPRIMARIES=nan .33 .3 .6 .15 .06 .313 .329\n\n-Y 1 +X 1\n", red, 4) == 0);
    CHECK(rgb_is(&still, 0, 0, 1, 0, 0));
    /* BT.2020 red in BT.709: Rec. ITU-R BT.2407, annex 2. */
    CHECK(read_hdr(&still, "#?RADIANCE\nPRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n\n-Y 1 +X 1\n", red, 4) ==
          0);
    CHECK(rgb_near(&still, 0, 0, 1.6605, -0.1246, -0.0182, 1e-4));
    /* Radiance's own primaries: only the white point differs, and white stays white. */
    CHECK(read_hdr(&still, "#?RADIANCE\nPRIMARIES=.64 .33 .29 .6 .15 .06 .333 .333\n\n-Y 1 +X 1\n", white, 4) == 0);
    CHECK(rgb_near(&still, 0, 0, 1, 1, 1, 1e-6));
    /* XYZ of the equal-energy white is white; X alone is red beyond the gamut. */
    CHECK(read_hdr(&still, "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", white, 4) == 0);
    CHECK(rgb_near(&still, 0, 0, 1, 1, 1, 1e-6));
    CHECK(read_hdr(&still, "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", red, 4) == 0);
    CHECK(float_at(&still, 0, 0)[0] > 2 && float_at(&still, 0, 0)[1] < 0);
    pupil_still_free(&still);
}

static void test_radiance_runs(void)
{
    static const uint8_t new_kind[] = {2, 2, 0, 9, 128 + 9, 128, 3, 1, 2, 3,       128 + 6, 64, 9,
                                       9, 8, 7, 6, 5,       4,   3, 2, 1, 128 + 8, 129,     1,  130};
    static const uint8_t old_kind[] = {128, 0,   0, 129, 1, 1, 1, 44, 1, 1, 1,   1,
                                       0,   128, 0, 129, 1, 1, 1, 0,  0, 0, 128, 129};
    pupil_still still = {0};
    CHECK(read_hdr(&still, "#?RADIANCE\n\n-Y 1 +X 9\n", new_kind, sizeof new_kind) == 0);
    CHECK(rgb_is(&still, 0, 0, 1, 1 / 128., 9 / 128.) && rgb_is(&still, 2, 0, 1, 3 / 128., 7 / 128.));
    CHECK(rgb_is(&still, 3, 0, 1, 0.5, 6 / 128.) && rgb_is(&still, 8, 0, 2, 1, 2 / 128.));

    /* 1 + 44 + 256 red pixels, a green one, a repeat of length 0, a blue one. */
    CHECK_MSG(read_hdr(&still, "#?RADIANCE\n\n-Y 1 +X 303\n", old_kind, sizeof old_kind) == 0, "%s", why.text);
    CHECK(rgb_is(&still, 0, 0, 1, 0, 0) && rgb_is(&still, 300, 0, 1, 0, 0) && rgb_is(&still, 301, 0, 0, 1, 0) &&
          rgb_is(&still, 302, 0, 0, 0, 1));
    pupil_still_free(&still);
}

static void test_radiance_refusals(void)
{
    static const struct {
        const char *file, *says;
    } cases[] = {
        {"RADIANCE\n\n-Y 1 +X 1\n....", "must begin with"},
        {"#?RADIANCE\n-Y 1 +X 1\n....", "does not end with an empty line"},
        {"#?RADIANCE\nFORMAT=16-bit\n\n-Y 1 +X 1\n....", "FORMAT is \"16-bit\""},
        {"#?RADIANCE\nEXPOSURE=-1\n\n-Y 1 +X 1\n....", "\"EXPOSURE=-1\" needs a number above 0"},
        {"#?RADIANCE\nEXPOSURE=x\n\n-Y 1 +X 1\n....", "\"EXPOSURE=x\" needs a number above 0"},
        {"#?RADIANCE\nCOLORCORR=0 0 0\n\n-Y 1 +X 1\n....", "three numbers above 0"},
        {"#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n....", "EXPOSURE=nan"},
        {"#?RADIANCE\nEXPOSURE=1e20\nEXPOSURE=1e20\n\n-Y 1 +X 1\n....", "EXPOSURE=1e20"},
        {"#?RADIANCE\nCOLORCORR=1 2\n\n-Y 1 +X 1\n....", "three numbers"},
        {"#?RADIANCE\n\n", "ends before its resolution line"},
        {"#?RADIANCE\n\n-Y 1 -Y 1\n....", "not of the form"},
        {"#?RADIANCE\n\n-Y -1 +X 1\n....", "not of the form"},
        {"#?RADIANCE\n\n-Y 1 +X 1 z\n....", "not of the form"},
        {"#?RADIANCE\n\n-Y 0 +X 1\n....", "1 x 0 pixels"},
        {"#?RADIANCE\n\n-Y 99999999999999999999 +X 1\n....", "at most 16384"},
        {"#?RADIANCE\n\n-Y 8192 +X 8192\n....", "at least 98304 bytes"},
        {"#?RADIANCE\n\n-Y 1 +X 2\n\1\1\1\5....", "begins with a repeat"},
        {"#?RADIANCE\n\n-Y 1 +X 2\n....\1\1\1\5", "run over its end"},
        {"#?RADIANCE\n\n-Y 1 +X 8\n\2\2\1\1........", "another length"},
        {"#?RADIANCE\n\n-Y 1 +X 3\n........", "ends early"},
    };
    static const char zero_run[] = "#?RADIANCE\n\n-Y 1 +X 8\n\2\2\0\10\0.......";
    static const char long_run[] = "#?RADIANCE\n\n-Y 2 +X 8\n\2\2\0\10\211............";
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECK_REFUSED(pupil_read_radiance, cases[i].file, strlen(cases[i].file), cases[i].says);
    CHECK_REFUSED(pupil_read_radiance, zero_run, sizeof zero_run - 1, "run of no length");
    CHECK_REFUSED(pupil_read_radiance, long_run, sizeof long_run - 1, "run over its end");
}

static void test_radiance_damage(void)
{
    static bytes b;
    uint8_t line[256];
    add_text(&b, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nPRIMARIES=.7 .3 .2 .7 .1 .1 .3 .3\n\n-Y 6 +X 40\n");
    for (int y = 0; y < 6; y++) {
        size_t n = 0;
        const uint8_t mark[4] = {2, 2, 0, 40};
        memcpy(line, mark, 4);
        n = 4;
        for (int c = 0; c < 4; c++) {
            line[n++] = 20;
            for (int i = 0; i < 20; i++)
                line[n++] = (uint8_t)(120 + i + c);
            line[n++] = 128 + 20;
            line[n++] = 130;
        }
        add(&b, line, n);
    }
    check_damage(pupil_read_radiance, b.data, b.size, 3000);
}

static void test_load(void)
{
    pupil_still still = {0};
    pupil_why said;
    const char *path = scratch("picture.hdr"); /* by its first bytes, regardless of its name */
    write_file(path, "Pf 1 1 -1\n\0\0\200\77", 14);
    CHECK(pupil_still_load(&still, path, &said) == 0 && rgb_is(&still, 0, 0, 1, 1, 1));
    write_file(path, "", 0);
    CHECK(pupil_still_load(&still, path, &said) == -1 && strstr(said.text, "picture.hdr: the file is empty"));
    write_file(path, "GIF89a", 6);
    CHECK(pupil_still_load(&still, path, &said) == -1 && strstr(said.text, "is not an OpenEXR, Radiance, PFM"));
    write_file(path, "P", 1);
    CHECK(pupil_still_load(&still, path, &said) == -1 && strstr(said.text, "is not an OpenEXR, Radiance, PFM"));
    write_file(path, "PF\n40000 40000\n-1\n", 18);
    CHECK(pupil_still_load(&still, path, &said) == -1 && strncmp(said.text, path, strlen(path)) == 0 &&
          strstr(said.text, ".hdr: the header promises 40000 x 40000 pixels; at most 16384 a side are read"));
    write_file(path, "Pf 1\033[31m 1 -1\n", 15); /* control characters in a file do not reach the terminal */
    CHECK(pupil_still_load(&still, path, &said) == -1 && strstr(said.text, "\"1?[31m\""));
    CHECK(pupil_still_load(&still, scratch_folder, &said) == -1 && strstr(said.text, "is a folder"));
    CHECK(pupil_still_load(&still, "/dev/null", &said) == -1 && strstr(said.text, "not a regular file"));
    CHECK(pupil_still_load(&still, scratch("none.exr"), &said) == -1 &&
          strstr(said.text, "none.exr: cannot be opened: No such file"));
    /* Old runs, twelve bytes a line: a file of 98 KB that claims 8192 x 8192 pixels. */
    static uint8_t flat[64 + 8192 * 12];
    size_t flat_bytes = (size_t)snprintf((char *)flat, 64, "#?RADIANCE\n\n-Y 8192 +X 8192\n");
    for (int line = 0; line < 8192; line++) {
        static const uint8_t runs[] = {1, 2, 3, 128, 1, 1, 1, 255, 1, 1, 1, 31}; /* 1 + 255 + 31 * 256 pixels */
        memcpy(flat + flat_bytes, runs, sizeof runs);
        flat_bytes += sizeof runs;
    }
    write_file(path, flat, flat_bytes);
    CHECK(pupil_still_load(&still, path, &said) == -1 && strstr(said.text, "of a file of so few bytes"));
    CHECK(still.capacity_bytes <= 64);
    still.max_pixels = 8192 * 8192 - 1;
    CHECK(pupil_still_load(&still, path, &said) == -1 && strstr(said.text, "at most 67108863 are read"));
    still.max_pixels = 0;
    write_file(path, "Pf 1 1 -1\n\0\0\0\100", 14); /* a refusal does not spoil the still */
    CHECK(pupil_still_load(&still, path, &said) == 0 && rgb_is(&still, 0, 0, 2, 2, 2));
    pupil_still_free(&still);
    CHECK(!still.pixels && !still.file);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_pfm_kinds();
    test_pfm_refusals();
    test_radiance_orientations();
    test_radiance_header();
    test_radiance_runs();
    test_radiance_refusals();
    test_radiance_damage();
    test_load();
    scratch_clear(scratch_folder);
    return check_end();
}

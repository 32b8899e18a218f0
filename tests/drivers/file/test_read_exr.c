/* OpenEXR files: every layout made byte by byte, every compression by the library. */
#include "write_exr.h"

#include <openexr.h>

static pupil_why why;
static bytes file;

#define RGB(type)                                                                                                      \
    {                                                                                                                  \
        {"B", type, 0, 0}, {"G", type, 0, 0},                                                                          \
        {                                                                                                              \
            "R", type, 0, 0                                                                                            \
        }                                                                                                              \
    }
#define RGBA(type)                                                                                                     \
    {                                                                                                                  \
        {"A", type, 0, 0}, {"B", type, 0, 0}, {"G", type, 0, 0},                                                       \
        {                                                                                                              \
            "R", type, 0, 0                                                                                            \
        }                                                                                                              \
    }
#define WINDOW(w, h) .data = {0, 0, (w)-1, (h)-1}, .display = {0, 0, (w)-1, (h)-1}
#define LITTLE(...)                                                                                                    \
    (exr_part)                                                                                                         \
    {                                                                                                                  \
        __VA_ARGS__                                                                                                    \
    }

static int read_part(pupil_still *still, exr_part part)
{
    write_exr(&file, &part, 1);
    return read_exact(pupil_read_exr, still, file.data, file.size, &why);
}

/* Every pixel of the data window has the values written to red, green and blue; other pixels are black. */
static unsigned wrong_pixels(const pupil_still *still, const exr_part *part, int red, int green, int blue)
{
    unsigned wrong = 0;
    for (uint32_t j = 0; j < still->height; j++)
        for (uint32_t i = 0; i < still->width; i++) {
            const int x = part->display[0] + (int)i, y = part->display[1] + (int)j;
            const int inside = x >= part->data[0] && x <= part->data[2] && y >= part->data[1] && y <= part->data[3];
            wrong += !rgb_is(still, i, j, inside ? exr_value(red, x, y) : 0, inside ? exr_value(green, x, y) : 0,
                             inside ? exr_value(blue, x, y) : 0);
        }
    return wrong;
}

static void check_part(exr_part part, int red, int green, int blue)
{
    pupil_still still = {0};
    CHECK_MSG(read_part(&still, part) == 0, "%s", why.text);
    CHECK(still.pixel == PUPIL_PIXEL_RGB32F && still.exposure_s == 0);
    CHECK(still.width == (uint32_t)(part.display[2] - part.display[0] + 1));
    CHECK(still.height == (uint32_t)(part.display[3] - part.display[1] + 1));
    CHECK(wrong_pixels(&still, &part, red, green, blue) == 0);
    check_damage(pupil_read_exr, file.data, file.size, 150);
    pupil_still_free(&still);
}

static void test_layouts(void)
{
    check_part(LITTLE(.channel = RGB(HALF_SAMPLES), WINDOW(7, 5)), 2, 1, 0);
    check_part(LITTLE(.channel = RGB(FLOAT_SAMPLES), WINDOW(7, 5), .exposure_s = 8), 2, 1, 0);
    check_part(LITTLE(.channel = RGBA(HALF_SAMPLES), WINDOW(7, 5)), 3, 2, 1); /* four halfs, one left out */
    check_part(LITTLE(.channel = {{"Y", FLOAT_SAMPLES, 0, 0}}, WINDOW(3, 4)), 0, 0, 0);
    check_part(LITTLE(.channel = RGBA(HALF_SAMPLES), WINDOW(21, 13), .tile = {8, 4}), 3, 2, 1);
    check_part(LITTLE(.channel = RGB(FLOAT_SAMPLES), WINDOW(5, 5), .tile = {64, 64}), 2, 1, 0);
    for (int c = 1; c < 10; c++) /* with any compression, a chunk that would not shrink is stored as it is */
        check_part(LITTLE(.channel = RGB(FLOAT_SAMPLES), WINDOW(9, 1), .compression = c), 2, 1, 0);
    check_part(LITTLE(.channel = {{"B", HALF_SAMPLES, 0, 0},
                                  {"G", FLOAT_SAMPLES, 0, 0},
                                  {"R", HALF_SAMPLES, 0, 0},
                                  {"Z", UINT_SAMPLES, 0, 0}},
                      WINDOW(4, 4)),
               2, 1, 0);
    check_part(LITTLE(.channel = {{"Z", FLOAT_SAMPLES, 0, 0},
                                  {"left.B", HALF_SAMPLES, 0, 0},
                                  {"left.G", HALF_SAMPLES, 0, 0},
                                  {"left.R", HALF_SAMPLES, 0, 0}},
                      WINDOW(4, 4)),
               3, 2, 1);
}

/* What the data window has of the picture; the still's next file begins anew. */
static void check_window(exr_part part, const double window[4])
{
    pupil_still still = {.window = {0.25, 0.25, 0.25, 0.25}};
    CHECK(read_part(&still, part) == 0);
    for (int i = 0; i < 4; i++)
        CHECK_MSG(fabs(still.window[i] - window[i]) < 1e-12, "%d: %g for %g", i, still.window[i], window[i]);
    pupil_still_free(&still);
}

static void test_windows(void)
{
    static const int displays[][4] = {{0, 0, 9, 7}, {-3, -2, 12, 9}, {2, 3, 4, 5}, {8, 6, 20, 20}, {-5, 1, 1, 3}};
    static const double windows[][4] = {
        {0}, {3 / 16., 2 / 12., 10 / 16., 8 / 12.}, {0}, {0, 0, 2 / 13., 2 / 15.}, {5 / 7., 0, 2 / 7., 1}};
    for (size_t i = 0; i < sizeof displays / sizeof *displays; i++)
        for (int tiled = 0; tiled < 2; tiled++) {
            exr_part part = {.channel = RGB(HALF_SAMPLES), .data = {0, 0, 9, 7}, .tile = {tiled * 4, tiled * 4}};
            memcpy(part.display, displays[i], sizeof part.display);
            check_part(part, 2, 1, 0);
            check_window(part, windows[i]);
        }
}

static void test_uint(void)
{
    exr_part part = {.channel = RGB(UINT_SAMPLES), WINDOW(2, 2)};
    pupil_still still = {0};
    CHECK(read_part(&still, part) == 0 && rgb_is(&still, 1, 1, 17, 17, 16)); /* 17.25, 17, 16.75 as whole numbers */
    pupil_still_free(&still);
}

/* Chroma of half the size: exact at the samples, the mean halfway between them. */
static void test_luminance_chroma(void)
{
    const exr_part part = {
        .channel = {{"BY", HALF_SAMPLES, 2, 2}, {"RY", HALF_SAMPLES, 2, 2}, {"Y", FLOAT_SAMPLES, 0, 0}},
        .data = {-4, -2, 3, 3},
        .display = {-4, -2, 3, 3}};
    pupil_still still = {0};
    /* Negative coordinates would make negative chroma; the values are still those of the same position. */
    exr_part shifted = part;
    const int box[4] = {4, 2, 11, 7};
    memcpy(shifted.data, box, sizeof box);
    memcpy(shifted.display, box, sizeof box);
    CHECK_MSG(read_part(&still, shifted) == 0, "%s", why.text);
    for (uint32_t j = 0; j < 6 && still.height == 6; j++)
        for (uint32_t i = 0; i < 8; i++) {
            const int x = 4 + (int)i, y = 2 + (int)j;
            const double cx = i == 7 ? x - 1 : x, cy = j == 5 ? y - 1 : y; /* the last odd ones repeat the edge */
            const double by = 0.25 + cx * 0.5 + cy * 16, ry = by + 0.25, luminance = exr_value(2, x, y);
            const double r = (ry + 1) * luminance, b = (by + 1) * luminance;
            const double g = (luminance - 0.212639 * r - 0.072192 * b) / 0.715169; /* Rec.709/D65 to six digits */
            CHECK(rgb_near(&still, i, j, r, g, b, 1e-5 * r));
        }
    check_damage(pupil_read_exr, file.data, file.size, 500);
    CHECK(read_part(&still, part) == 0 && still.width == 8);
    shifted.channel[0].step_x = 1;
    CHECK(read_part(&still, shifted) == -1 && strstr(why.text, "different sampling"));
    shifted.channel[0].step_x = shifted.channel[1].step_x = 4;
    CHECK(read_part(&still, shifted) == -1 && strstr(why.text, "every 4 x 2 pixels"));
    pupil_still_free(&still);
}

static void test_chromaticities(void)
{
    static const float bt2020[8] = {.708f, .292f, .170f, .797f, .131f, .046f, .3127f, .3290f};
    static const float aces[8] = {.7347f, .2653f, 0, 1, .0001f, -.077f, .32168f, .33767f};
    static const float same[8] = {.64f, .33f, .3f, .6f, .15f, .06f, .3127f, .329f};
    static const float nothing[8] = {0}, odd[8] = {NAN, .33f, .3f, .6f, .15f, .06f, .3127f, .329f};
    static const float line[8] = {.64f, .33f, .64f, .33f, .15f, .06f, .3127f, .329f};
    static const float *const unspecified[] = {same, nothing, odd, line};
    exr_part part = {.channel = RGB(FLOAT_SAMPLES), WINDOW(1, 1), .chromaticities = bt2020};
    pupil_still still = {0};
    /* 0.75, 0.5, 0.25 by the matrix of Rec. ITU-R BT.2407, annex 2. */
    CHECK(read_part(&still, part) == 0 && rgb_near(&still, 0, 0, 0.9333, 0.4709, 0.2157, 2e-4));
    part.chromaticities = aces; /* AP0 to Rec.709 with Bradford: 2.5217 -1.1341 -0.3876 / -0.2765 1.3727 -0.0962 /
                                 * -0.0154 -0.1530 1.1684 (as the ACES configuration of OpenColorIO has it) */
    CHECK(read_part(&still, part) == 0 && rgb_near(&still, 0, 0, 1.2274, 0.4549, 0.2041, 2e-3));
    for (size_t i = 0; i < sizeof unspecified / sizeof *unspecified; i++) {
        part.chromaticities = unspecified[i];
        CHECK(read_part(&still, part) == 0 && rgb_is(&still, 0, 0, 0.75, 0.5, 0.25));
    }
    part = LITTLE(.channel = {{"Y", FLOAT_SAMPLES, 0, 0}}, WINDOW(1, 1), .chromaticities = aces);
    CHECK(read_part(&still, part) == 0 && rgb_is(&still, 0, 0, 0.25, 0.25, 0.25));
    pupil_still_free(&still);
}

/* CIE XYZ is a picture; three such channels in a layer are normals, and the next layer is read. */
static void test_xyz(void)
{
    exr_part part = {.channel = {{"X", FLOAT_SAMPLES, 0, 0}, {"Y", FLOAT_SAMPLES, 0, 0}, {"Z", FLOAT_SAMPLES, 0, 0}},
                     WINDOW(1, 1)};
    pupil_still still = {0};
    /* 0.25, 0.5, 0.75 by the inverse of IEC 61966-2-1: 3.2406 -1.5372 -0.4986 / -0.9689 1.8758 0.0415 /
     * 0.0557 -0.2040 1.0570 */
    CHECK_MSG(read_part(&still, part) == 0, "%s", why.text);
    CHECK(rgb_near(&still, 0, 0, -0.3324, 0.7268, 0.7047, 3e-4));
    /* R, G and B with the axes as primaries are the same; another white is adapted. */
    static const float axes[8] = {1, 0, 0, 1, 0, 0, 1.f / 3, 1.f / 3}, of_d65[8] = {1, 0, 0, 1, 0, 0, .3127f, .329f};
    part = LITTLE(.channel = RGB(FLOAT_SAMPLES), WINDOW(1, 1), .chromaticities = axes);
    CHECK(read_part(&still, part) == 0);
    CHECK(rgb_near(&still, 0, 0, 3.2406 * .75 - 1.5372 * .5 - .4986 * .25, -.9689 * .75 + 1.8758 * .5 + .0415 * .25,
                   .0557 * .75 - .2040 * .5 + 1.0570 * .25, 3e-4));
    part.chromaticities = of_d65;
    const double x = .75 * .95047, z = .25 * 1.08883; /* white is 1, 1, 1 */
    CHECK(read_part(&still, part) == 0);
    CHECK(rgb_near(&still, 0, 0, 3.2406 * x - 1.5372 * .5 - .4986 * z, -.9689 * x + 1.8758 * .5 + .0415 * z,
                   .0557 * x - .2040 * .5 + 1.0570 * z, 3e-4));
    part = LITTLE(.channel = {{"N.X", FLOAT_SAMPLES, 0, 0},
                              {"N.Y", FLOAT_SAMPLES, 0, 0},
                              {"N.Z", FLOAT_SAMPLES, 0, 0},
                              {"lit.Y", FLOAT_SAMPLES, 0, 0}},
                  WINDOW(1, 1));
    CHECK(read_part(&still, part) == 0 && rgb_is(&still, 0, 0, 1, 1, 1));
    part.channel[3].name = "lit.Q";
    CHECK(read_part(&still, part) == -1 && strstr(why.text, "has the channels N.X, N.Y, N.Z, lit.Q;"));
    pupil_still_free(&still);
}

static void test_parts(void)
{
    exr_part parts[3] = {{.channel = {{"Z", FLOAT_SAMPLES, 0, 0}}, WINDOW(4, 4), .type = "scanlineimage"},
                         {.channel = RGB(HALF_SAMPLES), WINDOW(5, 3), .type = "scanlineimage"},
                         {.channel = RGB(FLOAT_SAMPLES), WINDOW(9, 9), .type = "tiledimage", .tile = {4, 4}}};
    exr_part *const second = parts + 1;
    pupil_still still = {0};
    parts[2].channel[0].name = "Blue"; /* names of parts come from here and must differ */
    for (int i = 0; i < 3; i += 2)     /* parts must have one display window; OpenEXR 3.4 refuses others */
        memcpy(parts[i].display, second->display, sizeof second->display);
    write_exr(&file, parts, 3);
    CHECK_MSG(read_exact(pupil_read_exr, &still, file.data, file.size, &why) == 0, "%s", why.text);
    CHECK(still.width == 5 && still.height == 3 && wrong_pixels(&still, second, 2, 1, 0) == 0);
    check_damage(pupil_read_exr, file.data, file.size, 500);
    parts[1].channel[2].name = "S"; /* now none has a picture: the sentence is the first one's */
    write_exr(&file, parts, 3);
    CHECK_REFUSED(pupil_read_exr, file.data, file.size, "has the channels Z; R, G and B, or Y");
    pupil_still_free(&still);
}

static void test_halfs(void)
{
    /* 0x0001, 0x03ff, 0x0400, 0x7bff, 0x7c00, 0x8001, 0xfc00, 0x7e01, 0x8000: written over sample values. */
    static const uint16_t codes[9] = {0x0001, 0x03ff, 0x0400, 0x7bff, 0x7c00, 0x8001, 0xfc00, 0x7e01, 0x8000};
    const float expected[9] = {0x1p-24f, 1023 * 0x1p-24f, 0x1p-14f, 65504, INFINITY, -0x1p-24f, -INFINITY, NAN, -0.f};
    const exr_part part = {.channel = RGB(HALF_SAMPLES), WINDOW(3, 1)};
    pupil_still still = {0};
    write_exr(&file, &part, 1);
    memcpy(file.data + file.size - 18, codes, 18); /* three of B, three of G, three of R */
    CHECK(read_exact(pupil_read_exr, &still, file.data, file.size, &why) == 0);
    for (uint32_t i = 0; i < 9; i++) {
        const float got = float_at(&still, i % 3, 0)[2 - i / 3];
        CHECK(expected[i] != expected[i] ? got != got : got == expected[i] && signbit(got) == signbit(expected[i]));
    }
    pupil_still_free(&still);
}

static void refuse(exr_part part, const char *says)
{
    write_exr(&file, &part, 1);
    CHECK_REFUSED(pupil_read_exr, file.data, file.size, says);
}

static void test_refusals(void)
{
    exr_part part = {.channel = {{"A", HALF_SAMPLES, 0, 0}, {"U\033V", HALF_SAMPLES, 0, 0}}, WINDOW(2, 2)};
    refuse(part, "has the channels A, U?V; R, G and B, or Y (with RY and BY), are needed");
    part = LITTLE(.channel = RGB(HALF_SAMPLES), .data = {0, 0, 1, 1}, .display = {5, 5, 6, 6});
    refuse(part, "wholly outside its display window");
    part = LITTLE(.channel = RGB(HALF_SAMPLES), .data = {0, 0, 1, 1}, .display = {0, 0, 16383, 16383});
    refuse(part, "the header promises 16384 x 16384 pixels; at most 67108864");
    part = LITTLE(.channel = RGB(HALF_SAMPLES), .data = {0, 0, 1, 1}, .display = {0, 0, 40000, 1});
    refuse(part, "at most 16384 a side");
    part = LITTLE(.channel = RGB(HALF_SAMPLES), .data = {0, 0, 1, 1}, .display = {3, 3, 1, 1});
    refuse(part, "damaged OpenEXR header: Invalid display window");
    part = LITTLE(.channel = {{"B", HALF_SAMPLES, 0, 0}, {"G", HALF_SAMPLES, 2, 2}, {"R", HALF_SAMPLES, 0, 0}},
                  WINDOW(2, 2));
    refuse(part, "channel G sampled every 2 x 2 pixels");
    part = LITTLE(.channel = {{"B", HALF_SAMPLES, 0, 0},
                              {"G", HALF_SAMPLES, 0, 0},
                              {"R", HALF_SAMPLES, 0, 0},
                              {"S", HALF_SAMPLES, 2, 2}},
                  WINDOW(4, 4), .tile = {4, 4});
    refuse(part, "subsampl");
    part = LITTLE(.channel = RGB(HALF_SAMPLES), WINDOW(2, 1), .compression = 8);
    write_exr(&file, &part, 1); /* a chunk shorter than its pixels; a library that knows DWAA reports it as damaged */
    file.data[file.size - 16] = 11;
    CHECK_REFUSED(pupil_read_exr, file.data, file.size, "is ");
    part = LITTLE(.channel = RGB(HALF_SAMPLES), WINDOW(2, 2), .compression = 77);
    refuse(part, "is damaged");
    part = LITTLE(.channel = RGB(HALF_SAMPLES), WINDOW(16, 16));
    write_exr(&file, &part, 1);
    CHECK_REFUSED(pupil_read_exr, file.data, file.size - 1, "is damaged or was not written to the end");
    CHECK_REFUSED(pupil_read_exr, file.data, file.size - 96 * 16, "is damaged or was not written to the end");
    part = LITTLE(/* a huge data window in a small file */.channel = RGB(HALF_SAMPLES), WINDOW(1, 1));
    write_exr(&file, &part, 1);
    for (size_t i = 0; i + 30 < file.size; i++)
        if (memcmp(file.data + i, "dataWindow", 10) == 0)
            memcpy(file.data + i + 21 + 8, "\377\37\0\0\377\37\0\0", 8);
    CHECK_REFUSED(pupil_read_exr, file.data, file.size, "8192 x 8192 pixels, more than");
}

/* One chunk of a file that the library writes: constant in each block of 4 x 4, so that B44 is exact too. */
static float block_value(int channel, int x, int y)
{
    return (float)((channel + 1) * (1 + (x / 4 + 3 * (y / 4)) % 7)) / 8;
}

static exr_result_t encode_chunk(exr_context_t out, const exr_chunk_info_t *chunk, int x0, int y0, int is_float,
                                 exr_encode_pipeline_t *encode, int first)
{
    static float samples[4][64 * 64];
    static uint16_t halfs[4][64 * 64];
    exr_result_t result =
        first ? exr_encoding_initialize(out, 0, chunk, encode) : exr_encoding_update(out, 0, chunk, encode);
    for (int c = 0; c < encode->channel_count; c++) {
        for (int i = 0; i < chunk->width * chunk->height; i++) {
            samples[c][i] = block_value(c, x0 + i % chunk->width, y0 + i / chunk->width);
            halfs[c][i] = half_of(samples[c][i]);
        }
        encode->channels[c].encode_from_ptr = is_float ? (uint8_t *)samples[c] : (uint8_t *)halfs[c];
        encode->channels[c].user_pixel_stride = is_float ? 4 : 2;
        encode->channels[c].user_line_stride = chunk->width * (is_float ? 4 : 2);
        encode->channels[c].user_bytes_per_element = is_float ? 4 : 2;
        encode->channels[c].user_data_type = is_float ? EXR_PIXEL_FLOAT : EXR_PIXEL_HALF;
    }
    if (first && result == EXR_ERR_SUCCESS)
        result = exr_encoding_choose_default_routines(out, 0, encode);
    return result == EXR_ERR_SUCCESS ? exr_encoding_run(out, 0, encode) : result;
}

#define WIDE 50
#define HIGH 37
#define TILE 16

static exr_result_t write_by_library(const char *path, exr_compression_t compression, int is_float, int tiled)
{
    static const char *const names[] = {"A", "B", "G", "R"};
    exr_attr_box2i_t window = {0};
    const exr_attr_v2f_t centre = {0};
    exr_context_initializer_t initial = EXR_DEFAULT_CONTEXT_INITIALIZER;
    static const exr_encode_pipeline_t nothing; /* OpenEXR 3.4's own initializer leaves out fields */
    exr_encode_pipeline_t encode = nothing;
    exr_chunk_info_t chunk;
    exr_context_t out;
    int part, first = 1;
    int32_t lines = 1;
    exr_result_t result;
    window.max.x = WIDE - 1;
    window.max.y = HIGH - 1;
    result = exr_start_write(&out, path, EXR_WRITE_FILE_DIRECTLY, &initial);
    result = result ? result : exr_add_part(out, "", tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &part);
    result = result ? result
                    : exr_initialize_required_attr(out, 0, &window, &window, 1, &centre, 1, EXR_LINEORDER_INCREASING_Y,
                                                   compression);
    for (int c = 0; c < 4 && !result; c++)
        result = exr_add_channel(out, 0, names[c], is_float ? EXR_PIXEL_FLOAT : EXR_PIXEL_HALF,
                                 EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (tiled && !result)
        result = exr_set_tile_descriptor(out, 0, TILE, TILE, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
    result = result ? result : exr_write_header(out);
    if (!tiled)
        exr_get_scanlines_per_chunk(out, 0, &lines);
    for (int y = 0; y < HIGH && !result; y += tiled ? TILE : lines)
        for (int x = 0; x < (tiled ? WIDE : 1) && !result; x += TILE, first = 0) {
            result = tiled ? exr_write_tile_chunk_info(out, 0, x / TILE, y / TILE, 0, 0, &chunk)
                           : exr_write_scanline_chunk_info(out, 0, y, &chunk);
            result = result ? result : encode_chunk(out, &chunk, x, y, is_float, &encode, first);
        }
    exr_encoding_destroy(out, &encode);
    exr_finish(&out);
    return result;
}

static void test_compressions(void)
{
    for (int i = 0; i < 8 * 4; i++) { /* NONE, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A */
        const int compression = i / 4, is_float = i & 1, tiled = i >> 1 & 1;
        const char *path = scratch("library.exr");
        pupil_still still = {0};
        pupil_why said = {""};
        unsigned wrong = 0;
        size_t size;
        uint8_t *data;
        /* 3.1.5 writes incompressible B44 chunks in a way that only 3.1.5 reads, so they cannot be tested. */
        if ((compression == EXR_COMPRESSION_B44 || compression == EXR_COMPRESSION_B44A) && (is_float || tiled))
            continue;
        CHECK(write_by_library(path, (exr_compression_t)compression, is_float, tiled) == EXR_ERR_SUCCESS);
        CHECK_MSG(pupil_still_load(&still, path, &said) == 0, "compression %d: %s", compression, said.text);
        CHECK(still.width == WIDE && still.height == HIGH);
        for (uint32_t y = 0; y < still.height; y++)
            for (uint32_t x = 0; x < still.width; x++)
                wrong += !rgb_is(&still, x, y, block_value(3, (int)x, (int)y), block_value(2, (int)x, (int)y),
                                 block_value(1, (int)x, (int)y));
        CHECK_MSG(wrong == 0, "compression %d, float %d, tiled %d: %u wrong", compression, is_float, tiled, wrong);
        data = read_whole(path, &size);
        check_damage(pupil_read_exr, data, size, 50);
        free(data);
        pupil_still_free(&still);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_layouts();
    test_windows();
    test_uint();
    test_luminance_chroma();
    test_chromaticities();
    test_xyz();
    test_parts();
    test_halfs();
    test_refusals();
    test_compressions();
    scratch_clear(scratch_folder);
    return check_end();
}

/* PNG files written by libpng: the effect of their colour chunks on the samples, and every layout. */
#include "still_check.h"

#include <png.h>

static pupil_why why;

typedef struct picture {
    int width, height, bits, type, interlaced;
    int srgb, cicp;  /* 1: the chunk is written */
    int orientation; /* of eXIf; 0: it is not written */
    double gamma;    /* 0: no gAMA */
    const double *chrm;
    uint8_t cicp_data[4];
    const uint8_t *rows;
} picture;

static void collect(png_structp png, png_bytep data, size_t size)
{
    add(png_get_io_ptr(png), data, size);
}

static void flush(png_structp png)
{
    (void)png;
}

static void write_colour(png_structp png, png_infop info, const picture *p)
{
    if (p->srgb)
        png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (p->gamma > 0)
        png_set_gAMA(png, info, p->gamma);
    if (p->chrm)
        png_set_cHRM(png, info, p->chrm[6], p->chrm[7], p->chrm[0], p->chrm[1], p->chrm[2], p->chrm[3], p->chrm[4],
                     p->chrm[5]);
    if (p->type == PNG_COLOR_TYPE_PALETTE) {
        static const png_color palette[2] = {{255, 0, 128}, {10, 20, 30}};
        static const png_byte transparent[1] = {0};
        png_set_PLTE(png, info, palette, 2);
        png_set_tRNS(png, info, transparent, 1, NULL);
    }
}

static void write_png(bytes *out, const picture *p)
{
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    size_t stride;
    png_bytepp rows = calloc((size_t)p->height, sizeof *rows);
    out->size = 0;
    png_set_write_fn(png, out, collect, flush);
    png_set_IHDR(png, info, (png_uint_32)p->width, (png_uint_32)p->height, p->bits, p->type,
                 p->interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    write_colour(png, info, p);
    png_write_info(png, info);
    if (p->cicp)
        png_write_chunk(png, (png_const_bytep) "cICP", p->cicp_data, 4);
    if (p->orientation) {
        uint8_t exif[22] = "MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1";
        exif[19] = (uint8_t)p->orientation;
        png_write_chunk(png, (png_const_bytep) "eXIf", exif, sizeof exif);
    }
    stride = png_get_rowbytes(png, info);
    for (int y = 0; y < p->height; y++)
        rows[y] = (png_bytep)p->rows + (size_t)y * stride;
    png_write_image(png, rows);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    free(rows);
}

static bytes file;

static int read_picture(pupil_still *still, const picture *p)
{
    write_png(&file, p);
    return read_exact(pupil_read_png, still, file.data, file.size, &why);
}

static double srgb(double v)
{
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* What source.h calls code_light: of SDR that of 8-bit sRGB, else of this file's codes; of RGB8 the core knows it. */
static void check_code_light(const pupil_still *s, double wanted)
{
    CHECK_MSG(fabs((double)s->code_light - wanted) <= 1e-6 * wanted, "%g, not %g", (double)s->code_light, wanted);
}

/* One 16-bit pixel of codes 0x1234, 0x8000 and 0xffff through each colour chunk. */
static void test_curves(void)
{
    static const uint8_t pixel[] = {0x12, 0x34, 0x80, 0x00, 0xff, 0xff};
    const double a = 0x1234 / 65535., b = 0x8000 / 65535.;
    picture p = {.width = 1, .height = 1, .bits = 16, .type = PNG_COLOR_TYPE_RGB, .rows = pixel};
    pupil_still still = {0};
    CHECK_MSG(read_picture(&still, &p) == 0, "%s", why.text);
    CHECK(still.pixel == PUPIL_PIXEL_RGB32F && rgb_is(&still, 0, 0, srgb(a), srgb(b), 1));
    check_code_light(&still, srgb(1 / 255.));
    p.gamma = 1;
    CHECK(read_picture(&still, &p) == 0 && rgb_is(&still, 0, 0, a, b, 1));
    check_code_light(&still, 1 / 65535.);
    p.gamma = 0.45455;
    CHECK(read_picture(&still, &p) == 0 && rgb_near(&still, 0, 0, pow(a, 2.2), pow(b, 2.2), 1, 1e-5));
    check_code_light(&still, srgb(1 / 255.));
    p.srgb = 1; /* comes before gAMA */
    p.gamma = 0.45455;
    CHECK(read_picture(&still, &p) == 0 && rgb_is(&still, 0, 0, srgb(a), srgb(b), 1));
    p.cicp = 1; /* comes before everything */
    memcpy(p.cicp_data, "\1\10\0\1", 4);
    CHECK(read_picture(&still, &p) == 0 && rgb_is(&still, 0, 0, a, b, 1));
    memcpy(p.cicp_data, "\1\15\0\1", 4);
    CHECK(read_picture(&still, &p) == 0 && rgb_is(&still, 0, 0, srgb(a), srgb(b), 1));
    memcpy(p.cicp_data, "\1\1\0\1", 4);
    CHECK(read_picture(&still, &p) == 0 &&
          rgb_near(&still, 0, 0, a / 4.5, pow((b + 0.099) / 1.099, 1 / 0.45), 1, 1e-6));
    memcpy(p.cicp_data, "\1\22\0\1", 4); /* HLG: 1/2 is 1/12 of the light */
    CHECK(read_picture(&still, &p) == 0 && rgb_near(&still, 0, 0, a * a / 3, 1 / 12., 1, 1e-5));
    check_code_light(&still, 1 / (3 * 65535. * 65535.));
    memcpy(p.cicp_data, "\1\20\0\1", 4); /* PQ: code 0.5 is 92.25 cd/m2, 1 is 10000 */
    CHECK(read_picture(&still, &p) == 0 && fabsf(float_at(&still, 0, 0)[1] - 0.9225f) < 1e-3f);
    CHECK(fabsf(float_at(&still, 0, 0)[2] - 100) < 1e-3f);
    CHECK(still.code_light > 0 && still.code_light < 1e-6f);
    memcpy(p.cicp_data, "\1\11\0\1", 4);
    CHECK(read_picture(&still, &p) == -1 && strstr(why.text, "cICP transfer"));
    pupil_still_free(&still);
}

static void test_primaries(void)
{
    static const double bt2020[8] = {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290};
    static const double same[8] = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
    static const uint8_t red16[] = {255, 255, 0, 0, 0, 0}, red8[] = {255, 0, 0};
    picture p = {.width = 1, .height = 1, .bits = 16, .type = PNG_COLOR_TYPE_RGB, .rows = red16, .chrm = bt2020};
    pupil_still still = {0};
    /* Rec. ITU-R BT.2407, annex 2. */
    CHECK(read_picture(&still, &p) == 0 && rgb_near(&still, 0, 0, 1.6605, -0.1246, -0.0182, 1e-4));
    p.chrm = same;
    CHECK(read_picture(&still, &p) == 0 && rgb_is(&still, 0, 0, 1, 0, 0));
    p.chrm = NULL;
    p.cicp = 1;
    memcpy(p.cicp_data, "\11\10\0\1", 4);
    CHECK(read_picture(&still, &p) == 0 && rgb_near(&still, 0, 0, 1.6605, -0.1246, -0.0182, 1e-4));
    p.bits = 8;
    p.rows = red8;
    CHECK(read_picture(&still, &p) == 0 && still.pixel == PUPIL_PIXEL_RGB32F &&
          rgb_near(&still, 0, 0, 1.6605, -0.1246, -0.0182, 1e-4));
    p.cicp = 0;
    p.chrm = same;
    CHECK(read_picture(&still, &p) == 0 && still.pixel == PUPIL_PIXEL_RGB8);
    pupil_still_free(&still);
}

/* Every colour type and depth, plain and interlaced, of random samples against the samples themselves. */
static void test_layouts(void)
{
    static const int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
    static uint8_t rows[13 * 11 * 8];
    for (int i = 0; i < 16; i++) {
        const int channels[] = {1, 2, 3, 4}, type = i / 4, wide = i & 1;
        const int n = channels[type], bytes_each = wide ? 2 : 1;
        picture p = {.width = 13,
                     .height = 11,
                     .bits = wide ? 16 : 8,
                     .type = types[type],
                     .interlaced = i >> 1 & 1,
                     .rows = rows,
                     .gamma = wide ? 1 : 0};
        pupil_still still = {0};
        unsigned wrong = 0;
        for (size_t k = 0; k < sizeof rows; k++)
            rows[k] = (uint8_t)check_random();
        CHECK_MSG(read_picture(&still, &p) == 0, "%s", why.text);
        CHECK(still.width == 13 && still.height == 11);
        CHECK(still.pixel == (wide ? PUPIL_PIXEL_RGB32F : PUPIL_PIXEL_RGB8));
        for (int k = 0; k < 13 * 11 * 3 && still.width == 13; k++) {
            const uint8_t *s = rows + (k / 3 * n + (n >= 3 ? k % 3 : 0)) * bytes_each;
            wrong += wide ? ((float *)still.pixels)[k] != (float)((s[0] << 8 | s[1]) / 65535.)
                          : ((uint8_t *)still.pixels)[k] != s[0];
        }
        CHECK_MSG(wrong == 0, "type %d, %d bits, interlaced %d: %u samples wrong", p.type, p.bits, p.interlaced, wrong);
        check_damage(pupil_read_png, file.data, file.size, 100);
        pupil_still_free(&still);
    }
}

static void test_few_bits(void)
{
    static const uint8_t row[] = {0x50}; /* 0101 */
    picture p = {.width = 4, .height = 1, .bits = 1, .type = PNG_COLOR_TYPE_GRAY, .rows = row};
    pupil_still still = {0};
    CHECK(read_picture(&still, &p) == 0 && still.pixel == PUPIL_PIXEL_RGB8);
    check_code_light(&still, 0);
    CHECK(memcmp(still.pixels, "\0\0\0\377\377\377\0\0\0\377\377\377", 12) == 0);
    p.type = PNG_COLOR_TYPE_PALETTE; /* the first colour is transparent; it keeps its value */
    CHECK(read_picture(&still, &p) == 0 && still.pixel == PUPIL_PIXEL_RGB8);
    CHECK(memcmp(still.pixels, "\377\0\200\12\24\36\377\0\200\12\24\36", 12) == 0);
    p.gamma = 1; /* and as float, with a code table of 8 bits */
    CHECK(read_picture(&still, &p) == 0 && rgb_is(&still, 1, 0, 10 / 255., 20 / 255., 30 / 255.));
    pupil_still_free(&still);
}

/* For codes and for floats; TIFF's other orientations use the same code. */
static void test_upright(void)
{
    static const uint8_t rows[] = {1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0};
    static const int shown[] = {5, 3, 1, 6, 4, 2}; /* of rows 1 2, 3 4 and 5 6, turned to the right */
    picture p = {.width = 2, .height = 3, .bits = 8, .type = PNG_COLOR_TYPE_GRAY_ALPHA, .rows = rows, .orientation = 6};
    for (int wide = 0; wide <= 1; wide++) {
        pupil_still still = {0};
        p.gamma = wide; /* linear: as floats */
        CHECK(read_picture(&still, &p) == 0 && still.width == 3 && still.height == 2);
        for (int k = 0; k < 6 && still.width == 3; k++)
            CHECK(wide ? rgb_is(&still, k % 3, k / 3, shown[k] / 255., shown[k] / 255., shown[k] / 255.)
                       : ((uint8_t *)still.pixels)[3 * k + 2] == shown[k]);
        still.as_stored = 1;
        CHECK(read_picture(&still, &p) == 0 && still.width == 2 && still.height == 3);
        pupil_still_free(&still);
    }
}

static uint32_t crc_of(const uint8_t *data, size_t size) /* PNG, annex D */
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
    }
    return ~crc;
}

static void put32(uint8_t *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (24 - 8 * i));
}

static void test_refusals(void)
{
    static const uint8_t pixel[6] = {0};
    picture p = {.width = 1, .height = 1, .bits = 16, .type = PNG_COLOR_TYPE_RGB, .rows = pixel};
    write_png(&file, &p);
    CHECK_REFUSED(pupil_read_png, file.data, 20, "damaged as a PNG file: it ends early");
    CHECK_REFUSED(pupil_read_png, file.data, file.size - 20, "damaged as a PNG file");
    put32(file.data + 33, 0x7fffffff); /* the length of the chunk after IHDR */
    CHECK_REFUSED(pupil_read_png, file.data, file.size, "damaged as a PNG file: it ends early");
    write_png(&file, &p);
    put32(file.data + 16, 8192); /* width and height of IHDR, and its checksum */
    put32(file.data + 20, 8192);
    put32(file.data + 29, crc_of(file.data + 12, 17));
    CHECK_REFUSED(pupil_read_png, file.data, file.size, "8192 x 8192 pixels, more than");
    put32(file.data + 16, 40000);
    put32(file.data + 29, crc_of(file.data + 12, 17));
    CHECK_REFUSED(pupil_read_png, file.data, file.size,
                  "the header promises 40000 x 8192 pixels; at most 16384 a side");
    file.data[29] ^= 1;
    CHECK_REFUSED(pupil_read_png, file.data, file.size, "damaged as a PNG file");
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_curves();
    test_primaries();
    test_layouts();
    test_few_bits();
    test_upright();
    test_refusals();
    return check_end();
}

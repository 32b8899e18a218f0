/* Y'CbCr, grey and mosaics against the standards' formulas (apps/common/pixel_light.h): light, statistics and pictures.
 */
#include <math.h>
#include <string.h>

#include "check.h"
#include "frames.h"
#include "reference.h"

static const uint32_t camera[] = {PUPIL_PIXEL_YUYV,     PUPIL_PIXEL_NV12,    PUPIL_PIXEL_GREY8,   PUPIL_PIXEL_GREY10,
                                  PUPIL_PIXEL_GREY12,   PUPIL_PIXEL_GREY16,  PUPIL_PIXEL_BAYER8,  PUPIL_PIXEL_BAYER10,
                                  PUPIL_PIXEL_BAYER12,  PUPIL_PIXEL_BAYER14, PUPIL_PIXEL_BAYER16, PUPIL_PIXEL_BAYER10P,
                                  PUPIL_PIXEL_BAYER12P, PUPIL_PIXEL_I420,    PUPIL_PIXEL_NV21,    PUPIL_PIXEL_NV16,
                                  PUPIL_PIXEL_UYVY,     PUPIL_PIXEL_BGR8,    PUPIL_PIXEL_BGRX8,   PUPIL_PIXEL_RGBX8,
                                  PUPIL_PIXEL_GREY10P,  PUPIL_PIXEL_GREY12P, PUPIL_PIXEL_BGR32F,  PUPIL_PIXEL_RGB16F,
                                  PUPIL_PIXEL_P010,     PUPIL_PIXEL_I420_10, PUPIL_PIXEL_RGB10A2, PUPIL_PIXEL_I444_16};
#define FORMATS (sizeof camera / sizeof *camera)

static const unsigned char *row_at(const pupil_image_const *image, uint32_t y)
{
    return (const unsigned char *)image->data + (ptrdiff_t)y * image->stride_bytes;
}

/* --- against the formulas --- */

static struct {
    long double ev, code;
    double samples, off;
} worst;

static void check_metering(const pupil_t *pupil, const pupil_config *config, const frame *f, const char *what)
{
    const int mosaic = pupil_pixel_is_mosaic(f->image.pixel);
    const uint32_t step = mosaic ? 2 : 1;
    long double sum = 0, weights[3];
    uint64_t pixels = 0;
    float rounded[3];
    pupil_stats stats;
    double mean;
    ref_weights(config, weights, rounded);
    for (uint32_t y = 0; y < f->image.height; y += step)
        for (uint32_t x = 0; x < f->image.width; x += step) {
            long double rgb[4];
            ref_light(&f->image, x, y, mosaic, rgb);
            const long double l = weights[0] * rgb[0] + weights[1] * rgb[1] + weights[2] * rgb[2];
            sum += log2l(l > config->floor ? l : config->floor);
            pixels++;
        }
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(pupil, &f->image, 0, f->image.height, &stats) == PUPIL_OK);
    CHECK(pupil_stats_mean(&stats, 0, 1, &mean) == PUPIL_OK);
    const long double error = fabsl(mean - sum / (long double)pixels);
    worst.ev = error > worst.ev ? error : worst.ev;
    CHECK_MSG(stats.pixels == pixels && error < 4e-4L, "%s: mean off by %Lg EV", what, error);
}

static void check_mapping(const pupil_t *pupil, const pupil_config *config, const pupil_curve *curve, const frame *f,
                          int halved, const char *what)
{
    const uint32_t step = halved ? 2 : 1, w = f->image.width / step, h = f->image.height / step;
    frame out = frame_make(w, h, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_image to = frame_writable(&out);
    /* Half a code, the rounding of binary32, and, if light comes from a coded value, 7e-6 of light (coding.h). The
     * latter is worth most codes in the dark, where the encoder's slope is 12.92. */
    const int coded = !pupil_pixel_is_mosaic(f->image.pixel) && f->image.coding->light != PUPIL_LIGHT_LINEAR;
    const long double limit = 0.51L + (coded ? 7e-6L * curve->scale * 12.92L * 255 : 0);
    CHECK(pupil_map_rows(pupil, curve, &f->image, &to) == PUPIL_OK);
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            long double rgba[4], code[3];
            ref_light(&f->image, x * step, y * step, halved, rgba);
            ref_map(config, curve, rgba, code);
            for (int k = 0; k < 3; k++) {
                const int got = row_at(&out.image, y)[3 * x + k];
                const long double error = fabsl(got - code[k]);
                worst.code = error > worst.code ? error : worst.code;
                worst.samples++;
                worst.off += got != (int)floorl(code[k] + 0.5L);
                CHECK_MSG(error < limit, "%s, pixel %u %u, channel %d: code %d for %Lg", what, x, y, k, got, code[k]);
            }
        }
    CHECK(frame_guards_intact(&out));
    frame_free(&out);
}

static pupil_coding a_coding(uint32_t pixel, unsigned n)
{
    const uint32_t bits = pupil_pixel_bits(pixel) ? pupil_pixel_bits(pixel) : 8;
    pupil_coding c = {.matrix = n % PUPIL_MATRIX_COUNT, .range = n / 2 % 2, .bayer = n % PUPIL_BAYER_COUNT};
    if (!pupil_pixel_is_mosaic(pixel))
        c.light = n / 3 % PUPIL_LIGHT_COUNT;
    if (n % 3)
        c.black = (float)(4 << (bits - 8)) + (n % 3 == 2 ? 0.37f : 0);
    if (n % 4 == 1)
        c.white = (float)(200 << (bits - 8));
    if (pixel == PUPIL_PIXEL_BAYER10 || pixel == PUPIL_PIXEL_GREY12)
        c.shift = n % 5;
    if (n % 2) {
        const float balance[3] = {1.9f, 1, 1.4f};
        /* a typical daylight matrix; rows sum to 1 */
        const float matrix[9] = {1.6f, -0.5f, -0.1f, -0.2f, 1.5f, -0.3f, 0.02f, -0.5f, 1.48f};
        memcpy(c.balance, balance, sizeof balance);
        if (n % 4 == 3)
            memcpy(c.rgb_from_camera, matrix, sizeof matrix);
    }
    if (pupil_pixel_bits(pixel) && n % 5 == 2) {
        static const float code[3] = {0.25f, 0.4f, 0.75f}, light[3] = {0.004f, 0.03f, 0.3f};
        c.light = PUPIL_LIGHT_DEFAULT;
        c.knees = 1 + n % 3;
        for (uint32_t k = 0; k < c.knees; k++) {
            c.knee_code[k] = code[k] * (float)((1u << bits) - 1);
            c.knee_light[k] = light[k];
        }
    }
    return c;
}

static void against_the_formulas(void)
{
    for (size_t i = 0; i < FORMATS; i++)
        for (unsigned n = 0; n < 24; n++) {
            char what[80];
            uint32_t width = 37 + n, height = 9 + n % 5;
            pupil_config config;
            pupil_t pupil;
            const pupil_coding coding = a_coding(camera[i], n);
            const pupil_curve curve = {.scale = 0.2f * (float)(1 << n % 6),
                                       .inverse_white_squared = n % 3 ? 0.05f : 0,
                                       .gamut = n % 3 ? 3.7f : 0};
            frame_fit(camera[i], &width, &height);
            frame f = frame_make(width, height, camera[i], camera[i] == PUPIL_PIXEL_GREY12 ? 2 : 4, n % 7 == 0);
            const int floats = camera[i] == PUPIL_PIXEL_BGR32F || camera[i] == PUPIL_PIXEL_RGB16F;
            if (n % 4 == 0 && !floats)
                frame_bits(&f, check_uniform);
            else
                frame_lognormal(&f, 0.1, 2, check_uniform);
            f.image.coding = &coding;
            snprintf(what, sizeof what, "pixel %u, coding %u", camera[i], n);
            pupil_config_default(&config);
            CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            check_metering(&pupil, &config, &f, what);
            check_mapping(&pupil, &config, &curve, &f, 0, what);
            if (pupil_pixel_is_mosaic(camera[i]))
                check_mapping(&pupil, &config, &curve, &f, 1, what);
            frame_free(&f);
        }
    printf("worst: metering %.2Lg EV, mapping %.4Lf codes, %.4f %% of %.0f samples off by one\n", worst.ev, worst.code,
           100 * worst.off / worst.samples, worst.samples);
}

/* --- what is exact --- */

typedef struct twin {
    uint32_t pixel, of;
} twin;

static unsigned char *at(const frame *f, uint32_t x, uint32_t y)
{
    const pupil_image image = frame_writable(f);
    return (unsigned char *)image.data + (ptrdiff_t)y * image.stride_bytes + x * pupil_pixel_bytes(image.pixel);
}

static unsigned char *chroma_at(const frame *f, uint32_t y)
{
    const pupil_image image = frame_writable(f);
    return (unsigned char *)image.chroma + pupil_chroma_row_of(image.pixel, y) * image.chroma_stride_bytes;
}

static unsigned char *cr_at(const frame *f, uint32_t y)
{
    const pupil_image image = frame_writable(f);
    return (unsigned char *)image.cr + pupil_chroma_row_of(image.pixel, y) * image.cr_stride_bytes;
}

static unsigned get_word(const unsigned char *at)
{
    uint16_t word;
    memcpy(&word, at, sizeof word);
    return word & 1023u;
}

static void set_word(unsigned char *at, unsigned value)
{
    const uint16_t word = (uint16_t)value;
    memcpy(at, &word, sizeof word);
}

/* Words of 10 bits. */
static void only_10_bits(const frame *f)
{
    const size_t row = pupil_chroma_row_bytes(f->image.pixel, f->image.width);
    for (uint32_t y = 0; y < f->image.height; y++) {
        for (uint32_t x = 0; x < f->image.width; x++)
            set_word(at(f, x, y), get_word(at(f, x, y)));
        for (size_t i = 0; i < row; i += 2) {
            set_word(chroma_at(f, y) + i, get_word(chroma_at(f, y) + i));
            set_word(cr_at(f, y) + i, get_word(cr_at(f, y) + i));
        }
    }
}

/* Copies the pixel x, y of `from`, whose format has the same codes, to `to`. */
static void copy_pixel(const frame *to, const frame *from, uint32_t x, uint32_t y)
{
    const uint32_t pair = x / 2 * 2;
    const unsigned char *rgb = at(from, x, y);
    unsigned char *p = at(to, x, y);
    switch (to->image.pixel) {
    case PUPIL_PIXEL_I420:
        *p = *rgb;
        chroma_at(to, y)[x / 2] = chroma_at(from, y)[pair];
        cr_at(to, y)[x / 2] = chroma_at(from, y)[pair + 1];
        break;
    case PUPIL_PIXEL_I444_16:
        set_word(p, get_word(rgb) << 6);
        set_word(chroma_at(to, y) + 2 * (size_t)x, get_word(chroma_at(from, y) + pair) << 6);
        set_word(cr_at(to, y) + 2 * (size_t)x, get_word(cr_at(from, y) + pair) << 6);
        break;
    case PUPIL_PIXEL_NV21:
        *p = *rgb;
        chroma_at(to, y)[pair] = chroma_at(from, y)[pair + 1];
        chroma_at(to, y)[pair + 1] = chroma_at(from, y)[pair];
        break;
    case PUPIL_PIXEL_NV16:
        *p = *rgb;
        memcpy(chroma_at(to, y) + pair, chroma_at(from, y) + pair, 2);
        break;
    case PUPIL_PIXEL_UYVY:
        p[0] = rgb[1];
        p[1] = rgb[0];
        if (x % 2 == 0) { /* an odd width's last pair is whole */
            p[2] = rgb[3];
            p[3] = rgb[2];
        }
        break;
    case PUPIL_PIXEL_RGBX8:
        memcpy(p, rgb, 3);
        break;
    case PUPIL_PIXEL_P010: /* of I420_10 */
        set_word(p, (get_word(rgb) << 6) | 63);
        set_word(chroma_at(to, y) + 2 * pair, get_word(chroma_at(from, y) + pair) << 6);
        set_word(chroma_at(to, y) + 2 * pair + 2, get_word(cr_at(from, y) + pair) << 6);
        break;
    case PUPIL_PIXEL_RGB16F: /* of RGBA16F */
        memcpy(p, rgb, 6);
        break;
    case PUPIL_PIXEL_BGR32F:
        for (int k = 0; k < 3; k++)
            memcpy(p + 4 * k, rgb + 4 * (2 - k), 4);
        break;
    default: /* blue first */
        for (int k = 0; k < 3; k++)
            p[k] = rgb[2 - k];
    }
}

/* A format that holds the same codes as another, in another order, gives the same statistics and the same picture. */
static void same_codes_same_bits(void)
{
    static const twin twins[] = {{PUPIL_PIXEL_I420, PUPIL_PIXEL_NV12},      {PUPIL_PIXEL_NV21, PUPIL_PIXEL_NV12},
                                 {PUPIL_PIXEL_NV16, PUPIL_PIXEL_NV12},      {PUPIL_PIXEL_UYVY, PUPIL_PIXEL_YUYV},
                                 {PUPIL_PIXEL_BGR8, PUPIL_PIXEL_RGB8},      {PUPIL_PIXEL_BGRX8, PUPIL_PIXEL_RGB8},
                                 {PUPIL_PIXEL_RGBX8, PUPIL_PIXEL_RGB8},     {PUPIL_PIXEL_BGR32F, PUPIL_PIXEL_RGB32F},
                                 {PUPIL_PIXEL_RGB16F, PUPIL_PIXEL_RGBA16F}, {PUPIL_PIXEL_P010, PUPIL_PIXEL_I420_10},
                                 {PUPIL_PIXEL_I444_16, PUPIL_PIXEL_I420_10}};
    for (size_t i = 0; i < sizeof twins / sizeof *twins; i++)
        for (unsigned n = 0; n < 40; n++) {
            const uint32_t w = n < 20 ? 1 + n : 200 + 7 * n, h = 1 + n % 5;
            const int is_444 = twins[i].pixel == PUPIL_PIXEL_I444_16; /* full-range codes are not multiples */
            const pupil_coding coding = {.matrix = n % 3, .range = is_444 ? 0 : n % 2, .light = n % PUPIL_LIGHT_COUNT};
            const pupil_curve curve = {.scale = 0.5f, .inverse_white_squared = 0.05f, .gamut = 3.7f};
            frame a = frame_make(w, h, twins[i].of, 4, n % 3 == 0), b = frame_make(w, h, twins[i].pixel, 8, n % 4 == 0);
            frame to_a = frame_make(w, h, PUPIL_PIXEL_RGB8, 0, 0), to_b = frame_make(w, h, PUPIL_PIXEL_RGB8, 0, 0);
            const pupil_image out_a = frame_writable(&to_a), out_b = frame_writable(&to_b);
            pupil_config config;
            pupil_t pupil;
            pupil_stats stats_a, stats_b;
            frame_bits(&a, check_uniform);
            frame_bits(&b, check_uniform); /* ignored bits are not 0 */
            if (twins[i].of == PUPIL_PIXEL_I420_10)
                only_10_bits(&a);
            for (uint32_t y = 0; y < h; y++)
                for (uint32_t x = 0; x < w; x++)
                    copy_pixel(&b, &a, x, y);
            a.image.coding = b.image.coding = &coding;
            pupil_config_default(&config);
            pupil_metering_centre(&config); /* runs that begin at odd pixels */
            CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            pupil_stats_clear(&stats_a);
            pupil_stats_clear(&stats_b);
            CHECK(pupil_fused_rows(&pupil, &curve, &a.image, 0, h, &out_a, &stats_a) == PUPIL_OK);
            CHECK(pupil_fused_rows(&pupil, &curve, &b.image, 0, h, &out_b, &stats_b) == PUPIL_OK);
            if (is_444) { /* first code of 16 bits: 2^6 times less light than that of 10; with a curve even less */
                CHECK(stats_b.code_light > 0.0f && stats_b.code_light < stats_a.code_light / 32);
                stats_b.code_light = stats_a.code_light;
            }
            CHECK_MSG(memcmp(&stats_a, &stats_b, sizeof stats_a) == 0 && frame_equal(&to_a, &to_b),
                      "pixel %u, %u x %u: other bits than those of %u", twins[i].pixel, w, h, twins[i].of);
            frame_free(&a);
            frame_free(&b);
            frame_free(&to_a);
            frame_free(&to_b);
        }
}

static float light_of(const pupil_image_const *image)
{
    pupil_config config;
    pupil_t pupil;
    pupil_stats stats;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&stats);
    CHECK(pupil_meter_rows(&pupil, image, 0, 1, &stats) == PUPIL_OK);
    return stats.peak;
}

/* At a table's code, light is the curve's value, rounded to the nearest float: grey of each 10-bit code as RGB10A2 and
 * as full-range I420_10, in PQ and HLG. Limited-range P010, whose codes are between the table's, is within the bound of
 * coding.h. */
static void hdr_light(void)
{
    double most[2] = {0, 0};
    for (uint32_t light = PUPIL_LIGHT_PQ; light <= PUPIL_LIGHT_HLG; light++)
        for (uint32_t code = 0; code < 1024; code++) {
            const uint32_t rgb = code | code << 10 | code << 20;
            const uint16_t word = (uint16_t)code, high = (uint16_t)(code << 6), middle = 512;
            const uint16_t middles[2] = {512 << 6, 512 << 6};
            const pupil_coding full = {.light = light, .range = PUPIL_RANGE_FULL}, limited = {.light = light};
            const pupil_image_const packed = {
                .data = &rgb, .width = 1, .height = 1, .pixel = PUPIL_PIXEL_RGB10A2, .coding = &full};
            const pupil_image_const planar = {.data = &word,
                                              .width = 1,
                                              .height = 1,
                                              .pixel = PUPIL_PIXEL_I420_10,
                                              .chroma = &middle,
                                              .cr = &middle,
                                              .coding = &full};
            const pupil_image_const p010 = {.data = &high,
                                            .width = 1,
                                            .height = 1,
                                            .pixel = PUPIL_PIXEL_P010,
                                            .chroma = middles,
                                            .coding = &limited};
            long double exact[4], of_p010[4];
            ref_light(&packed, 0, 0, 0, exact);
            ref_light(&p010, 0, 0, 0, of_p010);
            if (exact[0] > 0x1p-14L) {
                CHECK_MSG(fabsl(light_of(&packed) / exact[0] - 1) < 0x1p-24L * 1.01L,
                          "light %u, code %u: %.9g, not %.9Lg", light, code, light_of(&packed), exact[0]);
                CHECK(light_of(&packed) == light_of(&planar));
            }
            if (of_p010[0] > 0x1p-14L)
                most[light - PUPIL_LIGHT_PQ] =
                    fmax(most[light - PUPIL_LIGHT_PQ], (double)fabsl(light_of(&p010) / of_p010[0] - 1));
        }
    printf("grey of P010: PQ within %.3g of itself, HLG %.3g\n", most[0], most[1]);
    CHECK(most[0] < 7e-5 && most[1] < 3.3e-4);
}

/* To BGR8: RGB8 in the other order. */
static void bgr_out(void)
{
    for (uint32_t w = 1; w < 90; w++) {
        const pupil_curve curve = {.scale = 0.7f, .inverse_white_squared = 0.05f, .gamut = 3.7f};
        frame f = frame_make(w, 2, PUPIL_PIXEL_RGB32F, 0, 0);
        frame rgb = frame_make(w, 2, PUPIL_PIXEL_RGB8, 0, 0), bgr = frame_make(w, 2, PUPIL_PIXEL_BGR8, 5, w % 2 != 0);
        const pupil_image to_rgb = frame_writable(&rgb), to_bgr = frame_writable(&bgr);
        pupil_config config;
        pupil_t pupil;
        frame_lognormal(&f, 0.5, 3, check_uniform);
        pupil_config_default(&config);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK(pupil_map_rows(&pupil, &curve, &f.image, &to_rgb) == PUPIL_OK);
        CHECK(pupil_map_rows(&pupil, &curve, &f.image, &to_bgr) == PUPIL_OK && frame_guards_intact(&bgr));
        for (uint32_t y = 0; y < 2; y++)
            for (uint32_t x = 0; x < w; x++)
                for (int k = 0; k < 3; k++)
                    CHECK(at(&bgr, x, y)[k] == at(&rgb, x, y)[2 - k]);
        frame_free(&f);
        frame_free(&rgb);
        frame_free(&bgr);
    }
}

/* Full range without colour is sRGB grey: bit for bit the codes of RGB8. */
static void grey_is_grey(void)
{
    frame yuv = frame_make(256, 2, PUPIL_PIXEL_NV12, 0, 0), rgb = frame_make(256, 2, PUPIL_PIXEL_RGB8, 0, 0);
    const pupil_coding full = {.range = PUPIL_RANGE_FULL};
    pupil_config config;
    pupil_t pupil;
    pupil_stats a, b;
    for (uint32_t i = 0; i < 512; i++) {
        memset((unsigned char *)frame_writable(&rgb).data + 3 * i, (int)i % 256, 3);
        ((unsigned char *)frame_writable(&yuv).data)[i] = (unsigned char)(i % 256);
        if (i < 256)
            ((unsigned char *)frame_writable(&yuv).chroma)[i] = 128;
    }
    yuv.image.coding = &full;
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&a);
    pupil_stats_clear(&b);
    CHECK(pupil_meter_rows(&pupil, &yuv.image, 0, 2, &a) == PUPIL_OK);
    CHECK(pupil_meter_rows(&pupil, &rgb.image, 0, 2, &b) == PUPIL_OK);
    CHECK(memcmp(&a, &b, sizeof a) == 0 && a.clipped == 2);
    frame_free(&yuv);
    frame_free(&rgb);
}

/* A sensor that is saturated everywhere gives white and clipped, with any balance, not magenta. */
static void full_is_white(void)
{
    for (unsigned n = 0; n < 200; n++) {
        frame f = frame_make(16, 4, PUPIL_PIXEL_BAYER12, 0, 0), out = frame_make(16, 4, PUPIL_PIXEL_RGB8, 0, 0);
        const pupil_image to = frame_writable(&out);
        pupil_coding coding = {.bayer = n % 4, .black = (float)(check_uniform() * 300)};
        const pupil_curve curve = {.scale = 1, .inverse_white_squared = 1}; /* a channel at 1 stays at 1 */
        pupil_config config;
        pupil_t pupil;
        pupil_stats stats;
        coding.white = n % 2 ? 0 : (float)(3000 + check_uniform() * 1000);
        for (int k = 0; k < 3; k++)
            coding.balance[k] = k == (int)n % 3 ? 1 : (float)(1 + 2 * check_uniform());
        for (uint32_t i = 0; i < 64; i++)
            ((uint16_t *)frame_writable(&f).data)[i] = 4095;
        f.image.coding = &coding;
        pupil_config_default(&config);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &f.image, 0, 4, &stats) == PUPIL_OK);
        CHECK_MSG(stats.pixels == 16 && stats.clipped == 16, "%u clipped", (unsigned)stats.clipped);
        CHECK(pupil_map_rows(&pupil, &curve, &f.image, &to) == PUPIL_OK);
        for (int i = 0; i < 16 * 4 * 3; i++)
            CHECK(out.memory[64 + i] == 255);
        frame_free(&f);
        frame_free(&out);
    }
}

/* White of Y'CbCr is clipped and nothing below it is, in each matrix, range and curve. */
static void white_is_clipped(void)
{
    for (uint32_t n = 0; n < 2 * PUPIL_MATRIX_COUNT * PUPIL_LIGHT_COUNT; n++) {
        const uint8_t white = n % 2 ? 255 : 235;
        const uint8_t pair[4] = {white, 128, (uint8_t)(white - 1), 128};
        const pupil_coding coding = {
            .range = n % 2, .matrix = n / 2 % PUPIL_MATRIX_COUNT, .light = n / 2 / PUPIL_MATRIX_COUNT};
        const pupil_image_const image = {
            .data = pair, .stride_bytes = 4, .width = 2, .height = 1, .pixel = PUPIL_PIXEL_YUYV, .coding = &coding};
        pupil_config config;
        pupil_t pupil;
        pupil_stats stats;
        pupil_config_default(&config);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&pupil, &image, 0, 1, &stats) == PUPIL_OK);
        CHECK_MSG(stats.clipped == 1 && stats.peak == (coding.light == PUPIL_LIGHT_PQ ? 100.0f : 1.0f),
                  "coding %u: %u clipped, at most %g", n, (unsigned)stats.clipped, stats.peak);
    }
}

/* NV12 out: BT.601's and BT.709's own formulas on the RGB codes of the same picture. */
static void nv12_out(void)
{
    static const long double kr_kb[PUPIL_MATRIX_COUNT][2] = {{0.299L, 0.114L}, {0.2126L, 0.0722L}, {0.2627L, 0.0593L}};
    long double most = 0;
    for (unsigned n = 0; n < 24; n++) {
        const uint32_t w = 33 + n, h = 5 + n % 4;
        const pupil_coding coding = {.matrix = n % 3, .range = n % 2};
        const long double kr = kr_kb[n % 3][0], kb = kr_kb[n % 3][1], luma = n % 2 ? 255 : 219,
                          chroma = n % 2 ? 255 : 224;
        const pupil_curve curve = {.scale = 0.5f, .inverse_white_squared = 0.05f, .gamut = 3.7f};
        frame f = frame_make(w, h, PUPIL_PIXEL_RGB32F, 0, 0), rgb = frame_make(w, h, PUPIL_PIXEL_RGB8, 0, 0);
        frame yuv = frame_make(w, h, PUPIL_PIXEL_NV12, 3, n % 5 == 0);
        yuv.image.coding = &coding;
        const pupil_image to_rgb = frame_writable(&rgb), to_yuv = frame_writable(&yuv);
        pupil_config config;
        pupil_t pupil;
        if (n % 3)
            frame_lognormal(&f, 0.5, 3, check_uniform);
        else
            frame_fill(&f, 5, 0.001, n % 2 ? 0.001 : 4);
        pupil_config_default(&config);
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        CHECK(pupil_map_rows(&pupil, &curve, &f.image, &to_rgb) == PUPIL_OK);
        CHECK(pupil_map_rows(&pupil, &curve, &f.image, &to_yuv) == PUPIL_OK && frame_guards_intact(&yuv));
        for (uint32_t y = 0; y < h; y++)
            for (uint32_t x = 0; x < w; x++) {
                long double sum[3] = {0, 0, 0};
                const unsigned char *p = row_at(&rgb.image, y) + 3 * x;
                const long double l = (kr * p[0] + (1 - kr - kb) * p[1] + kb * p[2]) / 255;
                long double error = fabsl(row_at(&yuv.image, y)[x] - ((n % 2 ? 0 : 16) + luma * l));
                for (uint32_t k = 0; k < 4; k++) { /* those pixels of its quad that exist */
                    const uint32_t qx = x / 2 * 2 + k % 2 < w ? x / 2 * 2 + k % 2 : w - 1;
                    const uint32_t qy = y / 2 * 2 + k / 2 < h ? y / 2 * 2 + k / 2 : h - 1;
                    for (int c = 0; c < 3; c++)
                        sum[c] += row_at(&rgb.image, qy)[3 * qx + (uint32_t)c] / (4 * 255.0L);
                }
                const long double mean = kr * sum[0] + (1 - kr - kb) * sum[1] + kb * sum[2];
                const unsigned char *uv = (const unsigned char *)yuv.image.chroma +
                                          (ptrdiff_t)(y / 2) * yuv.image.chroma_stride_bytes + x / 2 * 2;
                const long double cb = 128 + chroma * (sum[2] - mean) / (2 * (1 - kb));
                const long double cr = 128 + chroma * (sum[0] - mean) / (2 * (1 - kr));
                error = fmaxl(error, fmaxl(fabsl(uv[0] - fminl(cb, 255)), fabsl(uv[1] - fminl(cr, 255))));
                most = error > most ? error : most;
            }
        frame_free(&f);
        frame_free(&rgb);
        frame_free(&yuv);
    }
    printf("NV12 out: at most %.4Lf codes from the formulas\n", most);
    CHECK(most < 0.51L);
}

/* Mosaics at the limits of the fast metering path: a clip below the coding's white, a floor below the path's own, and
 * factors that make a luminance beyond its range. Every CPU level has the bits of the scalar one, and the level of a
 * flat frame is what the coding says. */
static void mosaic_extremes(void)
{
    for (int n = 0; n < 4; n++) {
        pupil_coding coding = {.black = n % 2 ? 64.25f : 0.0f};
        frame f = frame_make(48, 8, PUPIL_PIXEL_BAYER12, 0, 0);
        pupil_stats scalar, stats;
        double mean;
        for (uint32_t y = 0; y < 8; y++)
            for (uint32_t x = 0; x < 48; x++)
                set_word((unsigned char *)at(&f, 0, y) + 2 * (size_t)x, 1000);
        for (int i = 0; i < 3 && n == 3; i++) {
            coding.balance[i] = 1024.0f;
            for (int k = 0; k < 3; k++)
                coding.rgb_from_camera[3 * i + k] = 16.0f;
        }
        f.image.coding = &coding;
        for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++) {
            pupil_config config;
            pupil_t pupil;
            pupil_config_default(&config);
            config.levels = 1u << level;
            config.clip = n == 1 ? 0.125f : 0.0f;
            config.floor = n == 2 ? 0x1p-20f : 0x1p-14f;
            CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
            pupil_stats_clear(&stats);
            CHECK(pupil_meter_rows(&pupil, &f.image, 0, 8, &stats) == PUPIL_OK);
            if (!level)
                scalar = stats;
            CHECK_MSG(memcmp(&stats, &scalar, sizeof stats) == 0, "level %u, %d", level, n);
        }
        const double black = (double)coding.black, light = (1000.0 - black) / (4095.0 - black);
        CHECK(pupil_stats_mean(&stats, 0, 1, &mean) == PUPIL_OK);
        CHECK_MSG(fabs(mean - log2(n == 3 ? light * 1024.0 * 48.0 : light)) < 1e-5, "%d: %g", n, mean);
        CHECK_MSG(stats.clipped == (n == 1 ? stats.pixels : 0), "%d: %d clipped", n, (int)stats.clipped);
        frame_free(&f);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    against_the_formulas();
    grey_is_grey();
    full_is_white();
    white_is_clipped();
    nv12_out();
    same_codes_same_bits();
    hdr_light();
    bgr_out();
    mosaic_extremes();
    return check_end();
}

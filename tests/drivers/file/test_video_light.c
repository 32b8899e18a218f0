/* Video codes become the light of their standard, checked in long double: SDR as floats, PQ and HLG as codes of the
 * library. */
#include "clip.h"
#include "reference.h"
#include "scratch.h"

#include "file/video/video_light.h"
#include "file/video/video_source.h"

static pupil_why why;

typedef long double real;

static real pq(real e)
{
    real m1 = 0.1593017578125L, m2 = 78.84375L, c1 = 0.8359375L, c2 = 18.8515625L, c3 = 18.6875L;
    real p = powl(e, 1 / m2), above = p - c1 > 0 ? p - c1 : 0;
    return 100 * powl(above / (c2 - c3 * p), 1 / m1);
}

static real hlg(real e)
{
    real a = 0.17883277L, b = 0.28466892L, c = 0.55991073L; /* as printed in BT.2100-2, table 5 */
    return e <= 0.5L ? e * e / 3 : (expl((e - c) / a) + b) / 12;
}

static real srgb(real e)
{
    return e <= 0.04045L ? e / 12.92L : powl((e + 0.055L) / 1.055L, 2.4L);
}

static void test_tables(void)
{
    static float table[PUPIL_LIGHT_CODES];
    static const struct {
        enum AVColorTransferCharacteristic transfer;
        real (*light)(real);
    } curves[] = {{AVCOL_TRC_BT709, srgb},
                  {AVCOL_TRC_IEC61966_2_1, srgb},
                  {AVCOL_TRC_SMPTE2084, pq},
                  {AVCOL_TRC_ARIB_STD_B67, hlg}};
    for (int k = 0; k < 4; k++) {
        CHECK(pupil_light_table(table, curves[k].transfer) == 0);
        for (int i = 0; i < PUPIL_LIGHT_CODES; i += 5) { /* 65535 is a multiple of 5 */
            real want = curves[k].light(i / 65535.0L);
            CHECK_MSG(fabsl(table[i] - want) <= 2e-7L * want + 1e-9L, "curve %d entry %d: %g, not %Lg", k, i, table[i],
                      want);
        }
    }
    /* Published reference points: BT.2408 puts 203 cd/m2 at 58 % PQ; HLG's 75 % is 0.265; 100 cd/m2 is 50.8 % PQ. */
    CHECK(pq(1) == 100 && fabsl(pq(0.5806L) - 2.03L) < 0.005L && fabsl(pq(0.50808L) - 1) < 1e-3L);
    CHECK(fabsl(hlg(0.75L) - 0.26496L) < 2e-5L && fabsl(hlg(1) - 1) < 1e-6L);
    CHECK(pupil_light_table(table, AVCOL_TRC_LOG) == -1);
}

/* Rec. ITU-R BT.2087-0, annex 1, gives this matrix with four digits. */
static const real bt2020_to_709[9] = {1.6605L,  -0.5876L, -0.0728L, -0.1246L, 1.1329L,
                                      -0.0083L, -0.0182L, -0.1006L, 1.1187L};

static void test_matrix(void)
{
    double m[9];
    CHECK(pupil_light_to_rec709(m, AVCOL_PRI_BT2020) == 0);
    for (int i = 0; i < 9; i++)
        CHECK_MSG(fabsl(m[i] - bt2020_to_709[i]) <= 0.6e-4L, "[%d] %g", i, m[i]);
    for (int row = 0; row < 3; row++)
        CHECK(fabs(m[3 * row] + m[3 * row + 1] + m[3 * row + 2] - 1) < 1e-12);
    CHECK(pupil_light_to_rec709(m, AVCOL_PRI_SMPTE428) == -1);
    /* SMPTE EG 432-1: the luminance of P3 with D65. */
    CHECK(pupil_light_luma(m, m + 1, AVCOL_SPC_CHROMA_DERIVED_NCL, AVCOL_PRI_SMPTE432) == 0);
    CHECK(fabs(m[0] - 0.2290) < 1e-4 && fabs(m[1] - 0.0793) < 1e-4);
    CHECK(pupil_light_luma(m, m + 1, AVCOL_SPC_CHROMA_DERIVED_NCL, AVCOL_PRI_SMPTE428) == -1);
}

static int from_list(const clip *c, int frame, int component, int x, int y)
{
    const int(*codes)[3] = (const int(*)[3])c->user;
    (void)x;
    (void)y;
    return codes[frame][component];
}

static int is_coded(const clip *c)
{
    return (c->transfer == AVCOL_TRC_SMPTE2084 || c->transfer == AVCOL_TRC_ARIB_STD_B67) &&
           c->primaries != AVCOL_PRI_SMPTE432;
}

/* The tolerance of a signal, of 65535: half a step of the light table, or half a code of Y' and of Cb or Cr, which
 * counts up to 1.4746 times; codes of limited range are exact. */
static real signal_slack(const clip *c)
{
    return !is_coded(c) ? 0.51L : c->range == AVCOL_RANGE_MPEG ? 1e-3L : 0.5L + 0.5L * 1.8814L + 0.01L;
}

/* The expected value of a frame of constant codes, in Rec.709 or as PQ and HLG in its own primaries; the tolerance. */
static void expected(const clip *c, const int code[3], real (*light)(real), real want[3], real slack[3])
{
    const AVPixFmtDescriptor *d = av_pix_fmt_desc_get(c->format);
    int depth = d->comp[0].depth, rgb = (d->flags & AV_PIX_FMT_FLAG_RGB) != 0, full = c->range == AVCOL_RANGE_JPEG;
    real s = ldexpl(1, depth - 8), top = ldexpl(1, depth) - 1, e[3], linear[3], near[3];
    double m[9], red, blue;
    if (rgb || d->nb_components < 3) {
        for (int i = 0; i < 3; i++)
            e[i] = code[rgb ? i : 0] / top;
    } else {
        real y = full ? code[0] / top : (code[0] - 16 * s) / (219 * s);
        real u = (code[1] - 128 * s) / (full ? top : 224 * s), v = (code[2] - 128 * s) / (full ? top : 224 * s);
        CHECK(pupil_light_luma(&red, &blue, c->space, c->primaries) == 0);
        e[0] = y + 2 * (1 - red) * v;
        e[2] = y + 2 * (1 - blue) * u;
        e[1] = (y - red * e[0] - blue * e[2]) / (1 - red - blue);
    }
    CHECK(pupil_light_to_rec709(m, is_coded(c) ? AVCOL_PRI_BT709 : c->primaries) == 0);
    for (int i = 0; i < 3; i++) {
        e[i] = e[i] < 0 ? 0 : e[i] > 1 ? 1 : e[i];
        linear[i] = light(e[i]);
        near[i] = light(e[i] + signal_slack(c) / 65535) - linear[i] + 1e-6L * linear[i];
    }
    for (int i = 0; i < 3; i++) {
        want[i] = slack[i] = 0;
        for (int j = 0; j < 3; j++) {
            want[i] += m[3 * i + j] * linear[j];
            slack[i] += fabs(m[3 * i + j]) * near[j];
        }
    }
}

static const int codes8[][3] = {{16, 128, 128}, {126, 128, 128}, {235, 128, 128}, {126, 150, 110}, {60, 90, 200}};
static const int codes10[][3] = {{64, 512, 512},  {509, 512, 512}, {940, 512, 512},
                                 {500, 600, 450}, {400, 300, 700}, {720, 500, 560}};
static const int codes12[][3] = {{256, 2048, 2048}, {4095, 2048, 2048}, {2000, 1500, 2500}};
static const int codes16[][3] = {{0, 0, 0}, {65535, 65535, 65535}, {33298, 33298, 33298}, {12000, 50000, 31000}};
static const int greys[][3] = {{0, 0, 0}, {128, 0, 0}, {255, 0, 0}};
static const int greys10[][3] = {{0, 512, 512}, {400, 512, 512}, {1023, 512, 512}};

/* Grey stays grey, to the bit. */
static void check_grey(const pupil_image_const *image)
{
    const float *p = image->data;
    if (image->pixel == PUPIL_PIXEL_I444_16)
        CHECK(*(const uint16_t *)image->chroma == 32768 && *(const uint16_t *)image->cr == 32768);
    else
        CHECK(p[0] == p[1] && p[1] == p[2]);
}

static void test_light(void)
{
    static const struct {
        clip c;
        real (*light)(real);
    } clips[] = {
#define CLIP(format, list, space, transfer, primaries, range, light)                                                   \
    {{"matroska", "ffv1", AV_PIX_FMT_##format, 40, 24, sizeof list / sizeof *list, AVCOL_SPC_##space,                  \
      AVCOL_TRC_##transfer, AVCOL_PRI_##primaries, AVCOL_RANGE_##range, AVCHROMA_LOC_UNSPECIFIED, NULL, from_list,     \
      list},                                                                                                           \
     light}
        CLIP(YUV420P10, codes10, BT2020_NCL, SMPTE2084, BT2020, MPEG, pq),
        CLIP(YUV422P10, codes10, BT2020_NCL, ARIB_STD_B67, BT2020, MPEG, hlg),
        CLIP(YUV420P, codes8, BT709, BT709, BT709, MPEG, srgb),
        CLIP(YUV420P, codes8, SMPTE170M, SMPTE170M, SMPTE170M, MPEG, srgb),
        CLIP(YUV444P, codes8, BT709, BT709, BT709, JPEG, srgb),
        CLIP(YUV411P, codes8, BT470BG, BT709, BT709, MPEG, srgb),
        CLIP(YUV410P, codes8, BT709, BT709, BT709, MPEG, srgb),
        CLIP(YUV444P12, codes12, BT2020_NCL, SMPTE2084, BT2020, JPEG, pq),
        CLIP(GBRP16, codes16, RGB, SMPTE2084, BT2020, JPEG, pq),
        CLIP(GRAY10, greys10, BT2020_NCL, ARIB_STD_B67, BT2020, JPEG, hlg),
        CLIP(YUV420P10, codes10, BT2020_NCL, SMPTE2084, SMPTE432, MPEG, pq),
        CLIP(YUV444P10, codes10, CHROMA_DERIVED_NCL, SMPTE2084, SMPTE432, MPEG, pq),
        CLIP(GBRP16, codes16, RGB, ARIB_STD_B67, SMPTE432, JPEG, hlg),
        CLIP(GBRP16, codes16, RGB, BT709, BT709, JPEG, srgb),
        CLIP(GRAY8, greys, BT709, BT709, BT709, JPEG, srgb),
#undef CLIP
    };
    for (size_t k = 0; k < sizeof clips / sizeof *clips; k++) {
        const clip *c = &clips[k].c;
        pupil_source *source;
        pupil_frame f;
        CHECK(clip_write(c, scratch("light.mkv")) == 0);
        CHECK_MSG(pupil_video_source_open(scratch("light.mkv"), NULL, &source, &why) == 0, "%s", why.text);
        for (int n = 0; n < c->frames; n++) {
            const int *code = ((const int(*)[3])c->user)[n];
            real want[3], slack[3], worst = -INFINITY;
            int rc = pupil_source_next(source, &f, &why), worst_i = 0;
            CHECK_MSG(rc == PUPIL_SOURCE_FRAME, "clip %zu: %s", k, why.text);
            expected(c, code, clips[k].light, want, slack);
            CHECK(f.image.pixel == (is_coded(c) ? PUPIL_PIXEL_I444_16 : PUPIL_PIXEL_RGB32F));
            const real code_light = is_coded(c)              ? 0
                                    : clips[k].light == srgb ? srgb(1 / 255.L)
                                    : clips[k].light == pq   ? pq(1 / 876.L)
                                                             : hlg(1 / 65535.L);
            CHECK_MSG(fabsl(f.code_light - code_light) <= 0.02L * code_light, "clip %zu: %g", k, (double)f.code_light);
            CHECK(source->primaries == (is_coded(c) ? PUPIL_PRIMARIES_BT2020 : PUPIL_PRIMARIES_BT709));
            real p[4];
            for (int i = 0; i < 40 * 24 * 3; i++) {
                ref_light(&f.image, (uint32_t)i / 3 % 40, (uint32_t)i / 120, 0, p);
                if (fabsl(p[i % 3] - want[i % 3]) - slack[i % 3] > worst) {
                    worst = fabsl(p[i % 3] - want[i % 3]) - slack[i % 3];
                    worst_i = i % 3;
                }
            }
            CHECK_MSG(worst <= 0, "clip %zu frame %d: %Lg, not %Lg +- %Lg", k, n, p[worst_i], want[worst_i],
                      slack[worst_i]);
            if (code[1] == code[2] && (code[1] == code[0] || code[1] == 512 || code[1] == 2048 || code[1] == 128))
                check_grey(&f.image);
            CHECK(f.info.timestamp_ns == n * INT64_C(40000000) && f.info.sequence == (uint64_t)n);
            pupil_source_done(source, &f);
        }
        CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_END);
        CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_END);
        CHECK(source->fps == 25);
        pupil_source_close(source);
    }
}

/* Blue rises along x and y; everything else is constant. */
static int ramp(const clip *c, int frame, int component, int x, int y)
{
    (void)c;
    (void)frame;
    return component == 0 ? 600 : component == 2 ? 512 : 440 + 6 * x + 2 * y;
}

static void test_chroma(void)
{
    static const struct {
        enum AVChromaLocation location;
        real x, y; /* of the first chroma sample, in luma samples */
    } sites[] = {{AVCHROMA_LOC_LEFT, 0, 0.5L},
                 {AVCHROMA_LOC_CENTER, 0.5L, 0.5L},
                 {AVCHROMA_LOC_TOPLEFT, 0, 0},
                 {AVCHROMA_LOC_UNSPECIFIED, 0, 0.5L}};
    for (size_t n = 0; n < 2 * sizeof sites / sizeof *sites; n++) {
        const size_t k = n / 2;
        clip c = {
            "matroska",      "ffv1",           AV_PIX_FMT_YUV420P10, 33,   17,   1,   AVCOL_SPC_BT709, AVCOL_TRC_LINEAR,
            AVCOL_PRI_BT709, AVCOL_RANGE_MPEG, sites[k].location,    NULL, ramp, NULL};
        pupil_source *source;
        pupil_frame f;
        c.transfer = n % 2 ? AVCOL_TRC_SMPTE2084 : AVCOL_TRC_LINEAR;
        CHECK(clip_write(&c, scratch("chroma.mkv")) == 0);
        CHECK_MSG(pupil_video_source_open(scratch("chroma.mkv"), NULL, &source, &why) == 0, "%s", why.text);
        CHECK_MSG(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FRAME, "%s", why.text);
        for (int y = 1; y < 15; y++)
            for (int x = 1; x < 31; x++) { /* off the edges, where interpolation has no neighbour */
                real code = 440 + 3 * (x - sites[k].x) + (y - sites[k].y), u = (code - 512) / 896;
                real want = (600 - 64) / 876.0L + 1.8556L * u;
                if (n % 2) { /* exactly */
                    const uint16_t cb = ((const uint16_t *)f.image.chroma)[y * 33 + x];
                    CHECK_MSG(cb == 64 * code, "site %zu (%d, %d): %u, not %Lg", k, x, y, cb, 64 * code);
                    continue;
                }
                real got = ((const float *)f.image.data)[(y * 33 + x) * 3 + 2];
                CHECK_MSG(fabsl(got - want) < 1e-5L, "site %zu (%d, %d): %Lg, not %Lg", k, x, y, got, want);
            }
        pupil_source_close(source);
    }
}

/* What the library cannot express is refused by name. */
static void test_refused(void)
{
    static const struct {
        enum AVColorSpace space;
        enum AVColorPrimaries primaries;
        const char *said;
    } refused[] = {{AVCOL_SPC_BT2020_NCL, AVCOL_PRI_SMPTE428, "primaries smpte428 cannot be read; bt709, bt2020"},
                   {AVCOL_SPC_SMPTE240M, AVCOL_PRI_BT2020, "matrix smpte240m cannot be read with PQ and HLG"}};
    for (size_t k = 0; k < sizeof refused / sizeof *refused; k++) {
        const clip c = {"matroska",
                        "ffv1",
                        AV_PIX_FMT_YUV420P10,
                        32,
                        16,
                        1,
                        refused[k].space,
                        AVCOL_TRC_SMPTE2084,
                        refused[k].primaries,
                        AVCOL_RANGE_MPEG,
                        AVCHROMA_LOC_LEFT,
                        NULL,
                        ramp,
                        NULL};
        pupil_source *source;
        pupil_frame f;
        CHECK(clip_write(&c, scratch("refused.mkv")) == 0);
        CHECK_MSG(pupil_video_source_open(scratch("refused.mkv"), NULL, &source, &why) == 0, "%s", why.text);
        CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FAILED);
        CHECK_MSG(strstr(why.text, refused[k].said) && strstr(why.text, "refused.mkv"), "%s", why.text);
        CHECK(pupil_source_next(source, &f, &why) == PUPIL_SOURCE_FAILED && strstr(why.text, refused[k].said));
        pupil_source_close(source);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_tables();
    test_matrix();
    test_light();
    test_chroma();
    test_refused();
    scratch_clear(scratch_folder);
    return check_end();
}

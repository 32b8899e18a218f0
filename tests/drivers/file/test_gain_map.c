/* Gain maps of JPEG: metadata in each form, the formula, where a map is found, orientations, primaries; what is wrong
 * with a map is said, and the picture is the one without it. */
#include "write_gain_map.h"

#include "file/still/gain_map.h"

#define ONE_NUMBER "hdrgm:Version=\"1.0\" hdrgm:GainMapMin=\"-1\" hdrgm:GainMapMax=\"3\" hdrgm:HDRCapacityMax=\"3\""

static pupil_why said;
static pupil_still still, plain;
static bytes file;

static const gain_map_file usual = {
    .base = {32, 16, 3, 1, 1, .seed = 5, .standard_tables = 1},
    .map = {16, 8, 1, 1, 1, .seed = 2, .standard_tables = 1},
    .xmp = ONE_NUMBER ">",
    .names_map = 1,
    .index = 'M',
};

typedef struct numbers {
    double min_ev[3], max_ev[3], gamma[3], sdr_offset[3], hdr_offset[3];
} numbers;

static const numbers usual_numbers = {
    {-1, -1, -1}, {3, 3, 3}, {1, 1, 1}, {1 / 64., 1 / 64., 1 / 64.}, {1 / 64., 1 / 64., 1 / 64.}};

static void read_plain(const gain_map_file *f)
{
    static uint8_t whole[65536];
    const size_t size = flat_write(&f->base, whole);
    CHECK(read_exact(pupil_read_libav, &plain, whole, size, &said) == 0 && !*plain.notice.text);
}

static double clamp(double value, double most)
{
    return value < 0 ? 0 : value > most ? most : value;
}

/* A code of the map, 0 to 1; ITU-T T.871, 7. */
static double code_at(const flat_jpeg *j, int channel, uint32_t x, uint32_t y)
{
    const double luma = flat_value(j, 0, x / 8, y / 8);
    if (j->components == 1)
        return luma / 255;
    const double cb = flat_value(j, 1, x / 8, y / 8) - 128., cr = flat_value(j, 2, x / 8, y / 8) - 128.;
    return clamp(rint(channel == 0   ? luma + 1.402 * cr
                      : channel == 1 ? luma - 0.344136 * cb - 0.714136 * cr
                                     : luma + 1.772 * cb),
                 255) /
           255;
}

static double code_between(const flat_jpeg *j, int channel, double x, double y)
{
    x = clamp(x, j->width - 1.);
    y = clamp(y, j->height - 1.);
    const uint32_t left = (uint32_t)x, top = (uint32_t)y;
    double sum = 0;
    for (uint32_t i = 0; i < 4; i++) {
        const double wide = i % 2 ? x - left : 1 - (x - left), high = i / 2 ? y - top : 1 - (y - top);
        if (wide * high > 0)
            sum += wide * high * code_at(j, channel, left + i % 2, top + i / 2);
    }
    return sum;
}

/* The picture against the formula, from the one without a map. */
static void check_picture(const gain_map_file *f, const numbers *n, const char *what)
{
    double worst = 0;
    read_plain(f);
    CHECK_MSG(read_exact(pupil_read_libav, &still, file.data, file.size, &said) == 0, "%s: %s", what, said.text);
    CHECK_MSG(!*still.notice.text, "%s: %s", what, still.notice.text);
    CHECK(still.width == plain.width && still.height == plain.height && still.pixel == PUPIL_PIXEL_RGB32F);
    CHECK(still.code_light > 3.03e-4f && !(still.code_light < plain.code_light || still.code_light > plain.code_light));
    for (uint32_t y = 0; y < still.height; y++)
        for (uint32_t x = 0; x < still.width; x++)
            for (int c = 0; c < 3; c++) {
                const double code = code_between(&f->map, c, (x + 0.5) * f->map.width / still.width - 0.5,
                                                 (y + 0.5) * f->map.height / still.height - 0.5);
                const double gain_ev = n->min_ev[c] + (n->max_ev[c] - n->min_ev[c]) * pow(code, 1 / n->gamma[c]);
                const double sdr = (double)float_at(&plain, x, y)[c];
                const double hdr = fmax((sdr + n->sdr_offset[c]) * exp2(gain_ev) - n->hdr_offset[c], 0);
                worst = fmax(worst, fabs((double)float_at(&still, x, y)[c] - hdr) / (hdr + 0.1));
            }
    CHECK_MSG(worst < 3e-4, "%s: %g from the formula", what, worst); /* of 16-bit codes */
}

/* The picture as without a map, to the bit. */
static int is_plain(const pupil_still *s)
{
    return s->width == plain.width && s->height == plain.height && s->pixel == plain.pixel &&
           memcmp(s->pixels, plain.pixels, sizeof(float) * 3 * s->width * s->height) == 0;
}

static void test_forms_of_xmp(void)
{
    static const struct {
        const char *xmp;
        numbers n;
    } cases[] = {
        {ONE_NUMBER ">",
         {{-1, -1, -1}, {3, 3, 3}, {1, 1, 1}, {1 / 64., 1 / 64., 1 / 64.}, {1 / 64., 1 / 64., 1 / 64.}}},
        {"hdrgm:GainMapMax = '2.5'\n hdrgm:Gamma=\" 2 \"\thdrgm:OffsetSDR=\"0\" hdrgm:OffsetHDR=\"0.5\" "
         "hdrgm:BaseRenditionIsHDR=\"False\">",
         {{0, 0, 0}, {2.5, 2.5, 2.5}, {2, 2, 2}, {0, 0, 0}, {0.5, 0.5, 0.5}}},
        {"hdrgm:Gamma=\"0.25\"><hdrgm:GainMapMax>4</hdrgm:GainMapMax><hdrgm:OffsetSDR >6</hdrgm:OffsetSDR >"
         "<hdrgm:OffsetHDR>\n6.5 </hdrgm:OffsetHDR>",
         {{0, 0, 0}, {4, 4, 4}, {0.25, 0.25, 0.25}, {6, 6, 6}, {6.5, 6.5, 6.5}}},
        {"hdrgm:Version=\"1.0\"><hdrgm:GainMapMin><rdf:Seq><rdf:li>-1</rdf:li><rdf:li>0</rdf:li><rdf:li>1e-1</rdf:li>"
         "</rdf:Seq></hdrgm:GainMapMin><hdrgm:GainMapMax>\n<rdf:Seq>\n<rdf:li> 1 </rdf:li>\n<rdf:li>2</rdf:li>\n"
         "<rdf:li>3</rdf:li>\n</rdf:Seq>\n</hdrgm:GainMapMax><hdrgm:Gamma><rdf:Seq><rdf:li>1</rdf:li><rdf:li>2</rdf:li>"
         "<rdf:li>0.5</rdf:li></rdf:Seq></hdrgm:Gamma>",
         {{-1, 0, 0.1}, {1, 2, 3}, {1, 2, 0.5}, {1 / 64., 1 / 64., 1 / 64.}, {1 / 64., 1 / 64., 1 / 64.}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (uint32_t components = 1; components <= 3; components += 2) {
            gain_map_file f = usual;
            f.xmp = cases[i].xmp;
            f.map.components = components;
            write_gain_map(&f, &file);
            check_picture(&f, &cases[i].n, f.xmp);
        }
}

static void test_iso(void)
{
    static const numbers n = {{-1, 0, 0.5}, {1, 2, 3}, {1, 2, 0.5}, {0.25, 0, 0.5}, {0, 0.125, 0.5}};
    const numbers one = {{-1, -1, -1}, {1, 1, 1}, {1, 1, 1}, {0.25, 0.25, 0.25}, {0, 0, 0}};
    for (uint32_t flags = 0; flags < 4; flags++) {
        gain_map_file f = usual;
        f.has_iso = 1;
        f.xmp = flags & 1 ? ONE_NUMBER ">" : NULL; /* ISO's comes first */
        f.iso_flags = 0x40 | (flags & 1 ? 8 : 0) | (flags & 2 ? 0x80 : 0);
        f.map.components = 3;
        f.headroom[1] = 3;
        for (int c = 0; c < 3; c++) {
            const double of[5] = {n.min_ev[c], n.max_ev[c], n.gamma[c], n.sdr_offset[c], n.hdr_offset[c]};
            memcpy(f.iso[c], of, sizeof of);
        }
        write_gain_map(&f, &file);
        check_picture(&f, flags & 2 ? &n : &one, "ISO 21496-1");
    }
}

/* By the index in either order, also behind other pictures, or without one by what the first picture says. */
static void test_places(void)
{
    for (int i = 0; i < 16; i++) {
        gain_map_file f = usual;
        f.index = i % 4 == 0 ? 'M' : i % 4 == 1 ? 'I' : 0;
        f.names_map = i % 4 != 0;
        f.previews = i / 4;
        f.base.progressive = i % 3 == 1;
        f.map.progressive = i % 3 == 2;
        write_gain_map(&f, &file);
        add_text(&file, "a video behind it \xff\xd8\xff\xe1");
        check_picture(&f, &usual_numbers, "a place");
    }
}

static void test_sizes(void)
{
    static const uint32_t sizes[][2] = {{1, 1}, {8, 8}, {7, 40}, {32, 16}, {33, 5}, {100, 60}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (uint32_t components = 1; components <= 3; components += 2) {
            gain_map_file f = usual;
            f.map.width = sizes[i][0];
            f.map.height = sizes[i][1];
            f.base.components = components;
            write_gain_map(&f, &file);
            check_picture(&f, &usual_numbers, "a size");
        }
}

/* A pixel of the upright picture, as stored (Exif 2.3, orientation). */
static const float *stored_at(const pupil_still *s, uint32_t orientation, uint32_t x, uint32_t y)
{
    const uint32_t right = s->width - 1, bottom = s->height - 1;
    switch (orientation) {
    case 2:
        return float_at(s, right - x, y);
    case 3:
        return float_at(s, right - x, bottom - y);
    case 4:
        return float_at(s, x, bottom - y);
    case 5:
        return float_at(s, y, x);
    case 6:
        return float_at(s, y, bottom - x);
    case 7:
        return float_at(s, right - y, bottom - x);
    case 8:
        return float_at(s, right - y, x);
    default:
        return float_at(s, x, y);
    }
}

static void test_orientations(void)
{
    pupil_still stored = {.as_stored = 1};
    gain_map_file f = usual;
    for (f.orientation = 1; f.orientation <= 9; f.orientation++) {
        const uint32_t is_on_side = f.orientation >= 5 && f.orientation <= 8;
        unsigned long wrong = 0;
        write_gain_map(&f, &file);
        CHECK(read_exact(pupil_read_libav, &stored, file.data, file.size, &said) == 0);
        CHECK(read_exact(pupil_read_libav, &still, file.data, file.size, &said) == 0 && !*still.notice.text);
        CHECK(stored.width == 32 && still.width == (is_on_side ? 16 : 32) && still.height == (is_on_side ? 32 : 16));
        for (uint32_t y = 0; y < still.height; y++)
            for (uint32_t x = 0; x < still.width; x++)
                wrong += memcmp(float_at(&still, x, y), stored_at(&stored, f.orientation, x, y), 12) != 0;
        CHECK_MSG(wrong == 0, "orientation %u: %lu pixels", f.orientation, wrong);
    }
    pupil_still_free(&stored);
}

/* The gains of ISO's form can be those of the map's own primaries: here a gain of red alone, in P3. */
static void test_primaries(void)
{
    /* Rec.709 to P3 (SMPTE EG 432-1), both under D65 */
    static const double to_p3[9] = {0.82246, 0.17754, 0, 0.03319, 0.96681, 0, 0.01708, 0.07240, 0.91052};
    static const double to_709[9] = {1.22494, -0.22494, 0, -0.04206, 1.04206, 0, -0.01964, -0.07864, 1.09827};
    const text profile = profile_of(p3, &of_srgb);
    for (uint32_t own = 0; own < 2; own++) {
        gain_map_file f = usual;
        f.xmp = NULL;
        f.has_iso = 1;
        f.iso_flags = own ? 0x80 : 0xc0;
        f.profile = &profile;
        f.iso[0][0] = f.iso[0][1] = f.headroom[1] = 1;
        f.iso[0][2] = f.iso[1][2] = f.iso[2][2] = 1;
        write_gain_map(&f, &file);
        read_plain(&f);
        CHECK(read_exact(pupil_read_libav, &still, file.data, file.size, &said) == 0 && !*still.notice.text);
        double worst = 0;
        for (uint32_t x = 0; x < still.width; x++) {
            const float *sdr = float_at(&plain, x, 9), *hdr = float_at(&still, x, 9);
            double light[3] = {(double)sdr[0], (double)sdr[1], (double)sdr[2]}, in_p3[3];
            for (int c = 0; c < 3; c++)
                in_p3[c] = to_p3[3 * c] * light[0] + to_p3[3 * c + 1] * light[1] + to_p3[3 * c + 2] * light[2];
            in_p3[0] *= 2;
            light[0] *= 2;
            for (int c = 0; c < 3 && own; c++)
                light[c] = to_709[3 * c] * in_p3[0] + to_709[3 * c + 1] * in_p3[1] + to_709[3 * c + 2] * in_p3[2];
            for (int c = 0; c < 3; c++)
                worst = fmax(worst, fabs((double)hdr[c] - light[c]));
        }
        CHECK_MSG(worst < 2e-3, "own primaries %u: %g", own, worst);
    }
}

/* The first picture is the HDR one: the map would make SDR of it. */
static void test_hdr_base(void)
{
    for (int i = 0; i < 4; i++) {
        gain_map_file f = usual;
        f.xmp = i ? NULL : ONE_NUMBER " hdrgm:BaseRenditionIsHDR=\"True\">";
        f.has_iso = i > 0;
        f.iso_flags = i == 1 ? 0x44 : 0x40;
        f.headroom[0] = i == 2 ? 4 : 0;
        f.headroom[1] = 1;
        f.iso[0][1] = f.iso[0][2] = 1;
        write_gain_map(&f, &file);
        read_plain(&f);
        CHECK(read_exact(pupil_read_libav, &still, file.data, file.size, &said) == 0 && !*still.notice.text);
        CHECK_MSG(is_plain(&still) == (i < 3), "case %d", i);
    }
}

static void check_notice(const char *words)
{
    CHECK_MSG(read_exact(pupil_read_libav, &still, file.data, file.size, &said) == 0, "%s: %s", words, said.text);
    CHECK_MSG(is_plain(&still), "%s: not the picture without a map", words);
    CHECK_MSG(strstr(still.notice.text, "is read as SDR, without its gain map: ") == still.notice.text &&
                  strstr(still.notice.text, words),
              "said \"%s\", should say \"%s\"", still.notice.text, words);
}

static void test_wrong_metadata(void)
{
    static const char *const wrong[][2] = {
        {"hdrgm:Version=\"2.0\" hdrgm:GainMapMax=\"1\">", "another version than 1.0"},
        {"hdrgm:Version=\"1.0\">", "no GainMapMax that is a number"},
        {"hdrgm:GainMapMax=\"\">", "no GainMapMax that is a number"},
        {"hdrgm:GainMapMax=\"1,5\">", "no GainMapMax that is a number"},
        {"hdrgm:GainMapMax=\"1 hdrgm:Gamma=1 >", "no GainMapMax that is a number"},
        {"hdrgm:GainMapMax=\"1\" hdrgm:Gamma=\"\">", "no Gamma that is a number"},
        {"hdrgm:GainMapMax=\"1\" hdrgm:Gamma=\"0\">", "the Gamma 0; 0.015625 to 64 is read"},
        {"hdrgm:GainMapMax=\"1\" hdrgm:OffsetSDR=\"-0.1\">", "the OffsetSDR -0.1; 0 to 1024 is read"},
        {"hdrgm:GainMapMax=\"nan\">", "the GainMapMax nan; -32 to 32 is read"},
        {"hdrgm:GainMapMax=\"40\">", "the GainMapMax 40; -32 to 32 is read"},
        {"hdrgm:Version=\"1.0\"><hdrgm:GainMapMax><rdf:Seq><rdf:li>1</rdf:li><rdf:li>2</rdf:li></rdf:Seq>"
         "</hdrgm:GainMapMax>",
         "no GainMapMax that is a number"},
        {"hdrgm:Version=\"1.0\"><hdrgm:GainMapMax><rdf:Seq><rdf:li/><rdf:li>2</rdf:li></rdf:Seq></hdrgm:GainMapMax>",
         "no GainMapMax that is a number"},
        {"hdrgm:Version=\"1.0\"><hdrgm:GainMapMax>1", "no GainMapMax that is a number"},
    };
    gain_map_file f = usual;
    read_plain(&f);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        f.xmp = wrong[i][0];
        write_gain_map(&f, &file);
        check_notice(wrong[i][1]);
    }
}

static void test_wrong_iso(void)
{
    gain_map_file f = usual;
    read_plain(&f);
    f.xmp = NULL;
    f.has_iso = 1;
    f.iso[0][1] = f.headroom[1] = 1;
    const size_t at = write_gain_map(&f, &file) + 2 + 4 + 28;
    check_notice("the Gamma 0; 0.015625 to 64 is read");
    f.iso[0][2] = 1;
    write_gain_map(&f, &file);
    file.data[at + 1] = 1;
    check_notice("of version 1; 0 is read");
    file.data[at + 1] = 0;
    file.data[at + 4] = 0x80; /* three channels, and numbers of one */
    check_notice("cut short");
    file.data[at + 4] = 0;
    memset(file.data + at + 5 + 16 + 4, 0, 4);
    check_notice("the GainMapMin -nan; -32 to 32 is read");
    memset(file.data + at + 4, 8, 1);
    memset(file.data + at + 5, 0, 4);
    check_notice("a denominator of 0");
    f.xmp = ONE_NUMBER ">"; /* then by XMP */
    write_gain_map(&f, &file);
    ((uint8_t *)memmem(file.data, file.size, "21496:-1", 9))[10] = 1;
    check_picture(&f, &usual_numbers, "XMP in place of ISO");
}

/* A map that was left out by a program that copied the metadata; one that is cut; one that is too large. */
static void test_wrong_map(void)
{
    gain_map_file f = usual;
    read_plain(&f);
    for (f.index = 0; f.index <= 'M'; f.index += 'M') {
        const size_t at = write_gain_map(&f, &file), whole = file.size;
        file.size = at;
        check_notice("it is not in the file, which was cut, or written again without it");
        file.size = whole - 20;
        check_notice("");
    }
    f = usual;
    write_gain_map(&f, &file);
    still.most = 2000;
    CHECK(read_exact(pupil_read_libav, &still, file.data, file.size, &said) == 0 && !*still.notice.text);
    f.map.width = f.map.height = 200;
    write_gain_map(&f, &file);
    check_notice("the map cannot be decoded: Picture size 200x200 exceeds");
    still.most = 0;
    f = usual; /* an index of other pictures, and nothing that names a map */
    f.xmp = NULL;
    f.names_map = 0;
    f.previews = 2;
    write_gain_map(&f, &file);
    CHECK(read_exact(pupil_read_libav, &still, file.data, file.size, &said) == 0 && !*still.notice.text);
    CHECK(is_plain(&still));
}

/* From a buffer of exactly the file's size, so that a sanitizer sees reads beyond it. 0: an answer that cannot be. */
static int find_exact(const bytes *b)
{
    uint8_t *copy = malloc(b->size ? b->size : 1);
    pupil_gain_map map;
    pupil_why why = {""};
    memcpy(copy, b->data, b->size);
    const int found = pupil_gain_map_find(copy, b->size, &map, &why);
    int fine = found < 0 ? *why.text != 0 : found == 0 || map.jpeg + map.jpeg_bytes <= copy + b->size;
    for (int c = 0; c < 3 && found > 0; c++)
        fine &= fabs(map.min_ev[c]) <= 32 && fabs(map.max_ev[c]) <= 32 && map.gamma[c] > 0;
    free(copy);
    return fine;
}

/* Cut anywhere, and with any byte zero or changed: a picture, or a sentence. */
static void test_damage(void)
{
    for (int iso = 0; iso < 2; iso++) {
        static bytes damaged;
        gain_map_file f = usual;
        f.xmp = iso ? NULL : f.xmp;
        f.has_iso = iso;
        f.iso_flags = 0xc0;
        f.iso[0][1] = f.iso[0][2] = f.iso[1][2] = f.iso[2][2] = f.headroom[1] = 1;
        f.orientation = 6;
        write_gain_map(&f, &file);
        unsigned long bad = 0;
        for (size_t k = 0; k < 3 * file.size; k++) {
            const size_t i = k % file.size;
            memcpy(damaged.data, file.data, file.size);
            damaged.size = k < file.size ? i : file.size;
            damaged.data[i] = k < 2 * file.size ? 0 : (uint8_t)check_random();
            bad += !find_exact(&damaged);
            if (k % 31) /* the pixels take longer */
                continue;
            if (read_exact(pupil_read_libav, &still, damaged.data, damaged.size, &said)) {
                bad += !*said.text;
                continue;
            }
            for (uint32_t p = 0; p < 3 * still.width * still.height; p++)
                bad += !isfinite(((const float *)still.pixels)[p]);
        }
        CHECK_MSG(bad == 0, "%lu refusals without a sentence, or pixels that are no light", bad);
    }
}

/* The path comes first in the notice of a file, and the next file has none. */
static void test_load(void)
{
    gain_map_file f = usual;
    const char *path = scratch("photograph.jpg");
    file.size = write_gain_map(&f, &file);
    write_file(path, file.data, file.size);
    CHECK(pupil_still_load(&still, path, &said) == 0);
    CHECK(strncmp(still.notice.text, path, strlen(path)) == 0 && strstr(still.notice.text, ".jpg: is read as SDR, "));
    write_gain_map(&f, &file);
    write_file(path, file.data, file.size);
    CHECK(pupil_still_load(&still, path, &said) == 0 && !*still.notice.text);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_forms_of_xmp();
    test_iso();
    test_places();
    test_sizes();
    test_orientations();
    test_primaries();
    test_hdr_base();
    test_wrong_metadata();
    test_wrong_iso();
    test_wrong_map();
    test_damage();
    test_load();
    pupil_still_free(&still);
    pupil_still_free(&plain);
    scratch_clear(scratch_folder);
    return check_end();
}

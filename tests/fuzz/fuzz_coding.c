/* Every format with every coding, chosen by the input's first bytes, so that none is rare: scalar kernels and those of
 * this CPU's best level agree bit for bit in statistics, level and picture; so do a frame and its parts; nothing is
 * read or written outside the rows; a coding is refused exactly if pupil_coding_check says so.
 */
#include "fuzz_picture.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A picture of the format, filled by the input. */
static picture any_picture(uint32_t pixel)
{
    uint32_t width = 1 + take_below(SIDE), height = 1 + take_below(SIDE);
    if (is_mosaic(pixel)) {
        width = (width + 3) / 4 * 4;
        height = (height + 1) / 2 * 2;
    }
    picture p = picture_make(width, height, pixel, 0);
    plane_fill(&p.data);
    if (p.image.chroma)
        plane_fill(&p.chroma);
    if (p.image.cr)
        plane_fill(&p.cr);
    return p;
}

static void start(pupil_t *pupil, uint32_t levels, uint32_t choices)
{
    pupil_config c;
    pupil_config_default(&c);
    c.primaries = choices % 2;
    c.output_primaries = choices / 2 % PUPIL_OUTPUT_COUNT;
    c.transfer = choices / 8 % 3;
    c.white_mode = choices / 32 % 3;
    c.grey_world = choices / 128 % 2;
    c.meter_rows = choices / 256 % 2;
    c.levels = levels;
    MUST(pupil_init(pupil, &c) == PUPIL_OK);
}

/* The statistics in two groups of rows, the lower one first. */
static void check_parts(const pupil_t *pupil, const pupil_image_const *in, const pupil_stats *whole)
{
    static pupil_stats parts;
    const uint32_t cut = take_below(in->height) / 4 * 4;
    const uint32_t first[2] = {cut, 0}, rows[2] = {in->height - cut, cut};
    pupil_stats_clear(&parts);
    for (int i = 0; i < (cut ? 2 : 1); i++) {
        const pupil_image_const part = pupil_image_rows(*in, first[i], rows[i]);
        MUST(pupil_meter_rows(pupil, &part, first[i], in->height, &parts) == PUPIL_OK);
    }
    MUST(memcmp(whole, &parts, sizeof parts) == 0);
}

static void check_levels(const picture *in, const picture *out, uint32_t choices)
{
    static pupil_t scalar, best, before;
    static pupil_stats a, b;
    pupil_exposure ea, eb;
    picture other = picture_like(out);
    const pupil_image_const image = pupil_image_as_const(in->image);
    start(&scalar, 1u << PUPIL_LEVEL_SCALAR, choices);
    start(&best, 0, choices);
    before = best;
    const int error = pupil_process(&scalar, &image, NULL, &out->image);
    MUST(error == (in->refused ? PUPIL_ERR_CODING : PUPIL_OK));
    MUST(pupil_process(&best, &image, NULL, &other.image) == error);
    if (!error) {
        MUST(pupil_get_stats(&scalar, &a) == PUPIL_OK && pupil_get_stats(&best, &b) == PUPIL_OK);
        MUST(pupil_get_exposure(&scalar, &ea) == PUPIL_OK && pupil_get_exposure(&best, &eb) == PUPIL_OK);
        MUST(memcmp(&a, &b, sizeof a) == 0 && memcmp(&ea, &eb, sizeof ea) == 0 && picture_same(out, &other));
        MUST(isfinite(ea.metered_ev) && isfinite(ea.scale) && a.pixels > 0);
        check_parts(&before, &image, &b);
    }
    picture_guarded(out);
    picture_guarded(&other);
    picture_free(&other);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const uint32_t outputs[] = {PUPIL_PIXEL_RGBA8, PUPIL_PIXEL_NV12,    PUPIL_PIXEL_BGR8,
                                       PUPIL_PIXEL_I420,  PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGB16F};
    input = data;
    input_left = size;
    const uint32_t pixel = PUPIL_PIXEL_RGBA32F + take_below(PUPIL_PIXEL_COUNT - 1);
    const pupil_coding coding = take_coding(pixel);
    const uint32_t choices = take_below(512), output = outputs[take_below(6)];
    picture in = any_picture(pixel), out = picture_make(in.image.width, in.image.height, output, GUARD);
    in.image.coding = &coding;
    in.refused = pupil_coding_check(&coding, pixel, NULL) != PUPIL_OK;
    check_levels(&in, &out, choices);
    picture_free(&in);
    picture_free(&out);
    return 0;
}

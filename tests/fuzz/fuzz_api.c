/* Any config, any image, any order of calls. The input's bytes choose all of it. For any bytes: no crash, nothing
 * written outside an output, refused calls change nothing, the level is finite and within the limits, and a frame in
 * pieces gives the same result as the whole frame.
 */
#include "fuzz_picture.h"
#include "pupil/bloom.h"
#include "pupil/look.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct run {
    pupil_t pupil;
    pupil_config config;
    double ev_min, ev_max; /* the widest limits since init: a retune moves the level into new ones, without a jump */
    int alive, in_frame;
    uint32_t frame_width, frame_height;
} run;

static pupil_config take_config(void)
{
    pupil_config c;
    pupil_config_default(&c);
    c.primaries = take_below(20) ? take_below(3) : take_below(9);
    for (int i = 0; i < 9; i++)
        c.rgb_to_xyz[i] = (float)take_double(0.01, 1);
    c.output_primaries = take_below(PUPIL_OUTPUT_COUNT + !take_below(30));
    c.floor = take_below(4) ? 0x1p-14f : (float)take_double(1e-9, 1);
    c.clip = take_below(4) ? 0 : (float)take_double(0, 10);
    c.trim_low = take_below(3) ? 0 : (float)take_double(0, 0.5);
    c.trim_high = take_below(3) ? 1 : (float)take_double(0.5, 1);
    c.histogram = take_below(2);
    c.meter_rows = take_below(3) ? 0 : take_below(10);
    c.grey_world = take_below(2) + !take_below(30);
    for (uint32_t i = take_below(20); i > 0; i--)
        c.weight[take_below(16)][take_below(16)] = (uint8_t)take_below(256);
    c.law = take_below(PUPIL_LAW_COUNT + !take_below(30));
    c.eye_unit_cd_m2 = take_below(8) ? exp2(take_double(-20, 30)) : 0;
    c.lock = !take_below(8);
    c.frame_weight = take_double(1e-7, 1);
    c.tau_light_s = take_double(0, 2);
    c.tau_dark_s = take_double(0, 2);
    c.nominal_frame_s = take_double(1e-3, 1);
    c.ev_min = take_below(2) ? -32 : take_double(-64, 10);
    c.ev_max = take_below(2) ? 32 : take_double(-10, 64);
    c.calibration = take_below(2) ? 1 : take_double(1e-3, 1e3);
    c.key = take_double(0.001, 1);
    c.ev_compensation = take_double(-16, 16);
    c.highlight_share = take_double(0.001, 0.5);
    c.highlight_room_ev = take_double(0, 32);
    c.highlight_ev = take_below(3) ? 0 : take_double(0, 8);
    c.amplification_ev = take_double(0, 32);
    c.order = take_below(2);
    c.white_mode = take_below(3);
    c.white = take_double(0.01, 100);
    c.white_quantile = take_double(0.5, 1);
    c.transfer = take_below(3);
    c.levels = take_below(3) ? 0 : 1u << take_below(PUPIL_LEVEL_COUNT);
    c.curve = take_below(2) ? PUPIL_CURVE_REINHARD : take_below(PUPIL_CURVE_COUNT + !take_below(30));
    c.curve_levels = 2 + take_below(255);
    c.curve_share = take_below(3) ? take_double(0, 0.25) : 0;
    c.curve_ceiling = take_double(1, 4);
    c.curve_range_ev = take_double(2, 16);
    return c;
}

static pupil_frame_info take_info(void)
{
    pupil_frame_info info;
    memset(&info, 0, sizeof info);
    if (take_below(4) == 0)
        take(&info.timestamp_ns, sizeof info.timestamp_ns);
    else
        info.timestamp_ns = (int64_t)take_below(65535) * 1000000;
    if (take_below(2)) {
        info.exposure_s = take_double(1e-4, 1);
        info.gain = take_double(1, 16);
    }
    return info;
}

/* An invalid image: one field of a valid one is overwritten with any int. */
static void spoil(pupil_image *image)
{
    switch (take_below(6)) {
    case 0:
        image->data = NULL;
        break;
    case 1:
        image->stride_bytes = 0;
        image->height = image->height < 2 ? 2 : image->height;
        break;
    case 2:
        image->width = take_below(2) ? 0 : PUPIL_MAX_SIDE_PX + 1 + take_below(999);
        break;
    case 3:
        image->height = take_below(2) ? 0 : 0xffffffffu - take_below(999);
        break;
    case 4:
        image->pixel = PUPIL_PIXEL_COUNT + take_below(999);
        break;
    default:
        image->pixel = PUPIL_PIXEL_NONE;
    }
}

static void check_exposure(const run *r)
{
    pupil_exposure e;
    pupil_curve curve;
    MUST(pupil_get_exposure(&r->pupil, &e) == PUPIL_OK);
    MUST(e.state <= PUPIL_STATE_LOCKED && e.reason <= PUPIL_REASON_RANGE && e.dt_s >= 0);
    const int error = pupil_get_curve(&r->pupil, NULL, &curve);
    MUST(error == (e.frames ? PUPIL_OK : PUPIL_ERR_NO_EXPOSURE));
    if (error)
        return;
    /* the level has a resolution of 2^-52 stops */
    MUST(e.adapted_ev >= r->ev_min - 0x1p-52 && e.adapted_ev <= r->ev_max + 0x1p-52);
    MUST(isfinite(e.metered_ev) && isfinite(e.white_ev) && isfinite(e.scale) && e.scale > 0);
    MUST(curve.knots == 0 || (curve.knots == PUPIL_CURVE_KNOTS && curve.knot_scale > 0 && isfinite(curve.knot_scale)));
    for (uint32_t k = 0; k < curve.knots; k++)
        MUST(curve.knot[k] >= 0 && curve.knot[k] <= 1 && (k == 0 || curve.knot[k] >= curve.knot[k - 1] - 1e-6f));
    MUST(curve.scale > 0 && isfinite(curve.scale) && isfinite(curve.inverse_white_squared) && curve.gamut >= 0);
    MUST(e.rods >= 0 && e.rods <= 1 && curve.rods >= 0 && curve.rods <= 1 && e.cone_pigment <= 1 && e.rod_pigment <= 1);
    MUST(r->config.law == PUPIL_LAW_EYE ? e.cone_cd_m2 > 0 && e.rod_cd_m2 > 0 : e.cone_cd_m2 == 0 && curve.rods == 0);
}

static void check_refused(const run *before, const run *after, int error)
{
    MUST(error == PUPIL_OK || (error < 0 && error >= PUPIL_ERR_CODING) || error == PUPIL_ERR_SIZE_BYTES ||
         error == PUPIL_ERR_PIXEL_OUT);
    MUST(error == PUPIL_OK || memcmp(&before->pupil, &after->pupil, sizeof after->pupil) == 0);
}

/* Groups of input rows must be a multiple of this. */
static uint32_t together(const picture *in, const picture *out)
{
    const uint32_t pair = pupil_pixel_planes(out->image.pixel) > 1 || pupil_pixel_planes(in->image.pixel) > 1 ? 2 : 1;
    const uint32_t smaller = in->image.width / out->image.width;
    return is_mosaic(in->image.pixel) && pair * smaller < 2 ? 2 : pair * smaller;
}

/* The result of pupil_process on a frame from the state `before`: the same in pieces, then only mapped. */
static void check_pieces(run *before, const run *after, const picture *in, const picture *out,
                         const pupil_frame_info *info)
{
    static pupil_stats whole, parts, fused;
    const uint32_t height = in->image.height, group = together(in, out), smaller = in->image.width / out->image.width;
    const uint32_t cut = take_below(height) / group * group;
    const uint32_t first[2] = {cut, 0}, rows[2] = {height - cut, cut};
    const pupil_image_const good = pupil_image_as_const(in->image);
    const int was_fused = before->config.order == PUPIL_ORDER_FUSED;
    picture mapped = picture_like(out), both = picture_like(out);
    pupil_curve curve = {.scale = 1, .inverse_white_squared = 1};
    pupil_exposure a, b;
    const int early = was_fused && pupil_get_curve(&before->pupil, info, &curve) == PUPIL_OK;
    pupil_stats_clear(&parts);
    pupil_stats_clear(&fused);
    for (int i = 0; i < (cut ? 2 : 1); i++) {
        const pupil_image_const part = pupil_image_rows(good, first[i], rows[i]);
        MUST(pupil_meter_rows(&before->pupil, &part, first[i], height, &parts) == PUPIL_OK);
    }
    MUST(pupil_get_stats(&after->pupil, &whole) == PUPIL_OK && memcmp(&whole, &parts, sizeof whole) == 0);
    const pupil_t meter = before->pupil;
    MUST(pupil_adapt(&before->pupil, &parts, info) == PUPIL_OK);
    MUST(pupil_get_exposure(&before->pupil, &a) == PUPIL_OK && pupil_get_exposure(&after->pupil, &b) == PUPIL_OK);
    MUST(memcmp(&a, &b, sizeof a) == 0);
    if (early || pupil_get_curve(&before->pupil, info, &curve) == PUPIL_OK) {
        for (int i = 0; i < (cut ? 2 : 1); i++) {
            const pupil_image_const part = pupil_image_rows(good, first[i], rows[i]);
            const pupil_image to = pupil_image_out_rows(mapped.image, first[i] / smaller, rows[i] / smaller);
            const pupil_image to_both = pupil_image_out_rows(both.image, first[i] / smaller, rows[i] / smaller);
            MUST(pupil_map_rows(&meter, &curve, &part, &to) == PUPIL_OK);
            MUST(pupil_fused_rows(&meter, &curve, &part, first[i], height, &to_both, &fused) == PUPIL_OK);
        }
        MUST(picture_same(&mapped, out) && picture_same(&both, out) && memcmp(&whole, &fused, sizeof whole) == 0);
    }
    picture_free(&mapped);
    picture_free(&both);
}

/* A whole frame; then, from the same state, in pieces: the same statistics, level and picture. */
static void do_process(run *r)
{
    picture in = picture_in(1 + take_below(SIDE), 1 + take_below(SIDE)), out = picture_out(&in);
    const pupil_frame_info info = take_info();
    static run before;
    before = *r;
    pupil_image bad = take_below(2) ? in.image : out.image;
    const int was_in = bad.data == in.image.data;
    spoil(&bad);
    const pupil_image_const bad_in = pupil_image_as_const(was_in ? bad : in.image),
                            good = pupil_image_as_const(in.image);
    const int refused = pupil_process(&r->pupil, &bad_in, &info, was_in ? &out.image : &bad);
    MUST(refused < 0);
    check_refused(&before, r, refused);
    const int error = pupil_process(&r->pupil, &good, &info, &out.image);
    MUST(error == (in.refused ? PUPIL_ERR_CODING : r->in_frame ? PUPIL_ERR_ORDER : PUPIL_OK));
    check_refused(&before, r, error);
    if (!error) {
        static pupil_t metered;
        metered = before.pupil;
        MUST(pupil_meter(&metered, &good, &info) == PUPIL_OK && memcmp(&metered, &r->pupil, sizeof metered) == 0);
        check_pieces(&before, r, &in, &out, &info);
    }
    picture_guarded(&out);
    check_exposure(r);
    picture_free(&in);
    picture_free(&out);
}

static void do_begin(run *r)
{
    const uint32_t width = take_below(SIDE + 2), height = take_below(SIDE + 2);
    const pupil_frame_info info = take_info();
    static run before;
    before = *r;
    const int error = pupil_frame_begin(&r->pupil, width, height, take_below(2) ? &info : NULL);
    MUST(error == (r->in_frame ? PUPIL_ERR_ORDER : width && height ? PUPIL_OK : PUPIL_ERR_SIZE));
    check_refused(&before, r, error);
    if (!error) {
        r->in_frame = 1;
        r->frame_width = width;
        r->frame_height = height;
    }
}

static void do_rows(run *r)
{
    const uint32_t width =
        r->in_frame && take_below(8) && r->frame_width <= SIDE ? r->frame_width : 1 + take_below(SIDE);
    picture in = picture_in(width, 1 + take_below(SIDE)), out = picture_out(&in);
    const pupil_image_const rows = pupil_image_as_const(in.image);
    const uint32_t first = take_below(2) ? 0 : take_below(SIDE);
    static run before;
    before = *r;
    const int error = pupil_frame_rows(&r->pupil, &rows, first, take_below(2) ? &out.image : NULL);
    check_refused(&before, r, error);
    MUST(error != PUPIL_OK || (r->in_frame && first + rows.height <= r->frame_height && rows.width == r->frame_width));
    picture_guarded(&out);
    picture_free(&in);
    picture_free(&out);
}

static void do_end(run *r)
{
    const int error = take_below(4) ? pupil_frame_end(&r->pupil) : pupil_frame_cancel(&r->pupil);
    MUST(r->in_frame ? error == PUPIL_OK || error == PUPIL_ERR_ROWS : error == PUPIL_ERR_ORDER);
    r->in_frame = 0;
    check_exposure(r);
}

static void do_retune(run *r)
{
    const pupil_config c = take_config();
    static run before;
    before = *r;
    const int error = pupil_retune(&r->pupil, &c);
    check_refused(&before, r, error);
    MUST(!error == (!pupil_config_check(&c, NULL) && !r->in_frame));
    if (!error) {
        r->config = c;
        r->ev_min = fmin(r->ev_min, c.ev_min);
        r->ev_max = fmax(r->ev_max, c.ev_max);
    }
    check_exposure(r);
}

/* Statistics of any bytes are refused, or can be adapted to and added up without harm. */
static void do_stats(run *r)
{
    static struct {
        pupil_stats s;
        unsigned char beyond[8192]; /* size_bytes may be any number: that much memory must exist */
    } any;
    static pupil_stats sum, sum_before;
    static run before;
    const pupil_frame_info info = take_info();
    double value;
    before = *r;
    MUST(pupil_get_stats(&r->pupil, &any.s) == PUPIL_OK);
    sum = sum_before = any.s;
    for (uint32_t i = take_below(6); i > 0; i--) {
        const size_t at = take_below(take_below(2) ? 80 : sizeof any.s);
        take((uint8_t *)&any.s + at, 1 + take_below((uint32_t)(sizeof any.s - at < 8 ? sizeof any.s - at : 8)));
    }
    const double low = take_double(0, 1), high = take_double(0, 1);
    if (pupil_stats_mean(&any.s, low, high, &value) == PUPIL_OK)
        MUST(value >= -33 && value <= 33);
    if (pupil_stats_quantile(&any.s, low, &value) == PUPIL_OK)
        MUST(value >= -32 && value <= 32);
    if (pupil_stats_peak_quantile(&any.s, low, &value) == PUPIL_OK)
        MUST(value >= -32 && value <= 32);
    if (pupil_stats_add(&sum, &any.s) != PUPIL_OK)
        MUST(memcmp(&sum, &sum_before, sizeof sum) == 0);
    const int error = pupil_adapt(&r->pupil, &any.s, &info);
    check_refused(&before, r, error);
    check_exposure(r);
}

static void do_map(run *r)
{
    picture in = picture_in(1 + take_below(SIDE), 1 + take_below(SIDE)), out = picture_out(&in);
    const pupil_image_const rows = pupil_image_as_const(in.image);
    pupil_curve curve = {.size_bytes = sizeof curve,
                         .scale = (float)take_double(0, 100),
                         .inverse_white_squared = (float)take_double(0, 2),
                         .gamut = (float)take_double(0, 16),
                         .rods = take_below(3) ? (float)take_double(0, 1.1) : 0};
    if (take_below(3) == 0) {
        curve.knots = take_below(30) ? PUPIL_CURVE_KNOTS : take_below(200);
        curve.levels = take_below(2) ? 0 : take_below(300);
        curve.knot_scale = (float)take_double(0, 1e6);
        for (int k = 0; k < PUPIL_CURVE_KNOTS; k++)
            curve.knot[k] = (float)take_double(0, take_below(500) ? 1 : 2);
    }
    static run before;
    before = *r;
    const int error = pupil_map_rows(&r->pupil, &curve, &rows, &out.image);
    MUST(error == PUPIL_OK || error == PUPIL_ERR_VALUE || (in.refused && error == PUPIL_ERR_CODING));
    MUST(memcmp(&before.pupil, &r->pupil, sizeof r->pupil) == 0);
    picture_guarded(&out);
    picture_free(&in);
    picture_free(&out);
}

/* --- veils: any eye, any rows, any lights --- */

static pupil_veil_config take_veil(const picture *in)
{
    pupil_veil_config c;
    pupil_veil_config_default(&c);
    c.psf = take_below(PUPIL_VEIL_PSF_COUNT + !take_below(30));
    c.width = take_below(20) ? in->image.width : take_below(20000);
    c.height = take_below(4) ? in->image.height : take_below(200);
    c.fov_deg = take_below(4) ? 54 : take_double(0.1, 150);
    c.age_years = take_double(1, 120);
    c.pigment = take_double(0, 1.2);
    c.period = take_below(4) ? 2 : take_double(1, 4);
    c.harmonics = 1 + take_below(PUPIL_VEIL_MOST_HARMONICS + !take_below(30));
    c.gaussians = take_below(4 + 40 * !take_below(30));
    for (uint32_t i = 0; i < c.gaussians && i < PUPIL_VEIL_MOST_GAUSSIANS; i++) {
        c.gaussian[i].sigma = take_double(0.001, 90);
        c.gaussian[i].weight = take_double(0, 0.3);
    }
    return c;
}

static pupil_veil_spot take_spot(const pupil_veil_config *c)
{
    pupil_veil_spot s = {.x_px = take_double(0, c->width), .y_px = take_double(0, c->height)};
    for (int i = 0; i < 3; i++)
        s.rgb[i] = (float)take_double(0, 100);
    return s;
}

/* A refused call changes nothing. */
#define VEIL_CALL(object, call)                                                                                        \
    (veil_before = (object), error = (call), MUST(!error || !memcmp(&veil_before, &(object), sizeof(object))), error)

static void do_veil(run *r)
{
    static pupil_veil veil, veil_before;
    static pupil_veil_light light, rest, light_before;
    static pupil_veil_scratch scratch;
    static float nodes[PUPIL_VEIL_NODES * PUPIL_VEIL_NODES * 3], row[3 * SIDE];
    picture in = picture_in(1 + take_below(SIDE), 1 + take_below(SIDE)), out = picture_out(&in);
    const pupil_image_const rows = pupil_image_as_const(in.image);
    const pupil_veil_config config = take_veil(&in);
    const pupil_curve curve = {.scale = 1, .first_row = take_below(8) ? 0 : take_below(SIDE)};
    const char *why = NULL;
    int error = pupil_veil_config_check(&config, &why);
    MUST(error == PUPIL_OK || (error == PUPIL_ERR_CONFIG && why));
    MUST(pupil_veil_init(&veil, &config) == error);
    MUST(pupil_veil_light_clear(&light) == PUPIL_OK && pupil_veil_light_clear(&rest) == PUPIL_OK);
    if (!error) {
        const pupil_veil_spot spot[2] = {take_spot(&config), take_spot(&config)};
        pupil_veil_result result;
        pupil_stats stats;
        pupil_stats_clear(&stats);
        MUST(pupil_veil_get(&veil, &result) == PUPIL_OK && result.direct >= -1e-9 && result.direct <= 1 + 1e-9);
        for (uint32_t i = 1 + take_below(2); i > 0; i--) {
            light_before = light;
            error = pupil_veil_gather_rows(&veil, &r->pupil, &rows, take_below(8) ? 0 : take_below(SIDE),
                                           take_below(2) ? &stats : NULL, &light);
            MUST(!error || !memcmp(&light, &light_before, sizeof light));
            (void)pupil_veil_light_add(take_below(2) ? &light : &rest, take_below(2) ? &light : &rest);
        }
        MUST(pupil_veil_begin(&veil) == PUPIL_OK);
        (void)VEIL_CALL(veil, pupil_veil_add_light(&veil, &light));
        (void)VEIL_CALL(veil, pupil_veil_add_bells(&veil, take_below(PUPIL_VEIL_BELL_COUNT + 1), take_double(0.1, 50),
                                                   spot, take_below(3)));
        MUST(pupil_veil_solve(&veil) == PUPIL_OK && pupil_veil_get_nodes(&veil, nodes) == PUPIL_OK);
        for (size_t i = 0; i < sizeof nodes / sizeof nodes[0]; i++)
            MUST(nodes[i] >= 0 && nodes[i] <= 0x1p40f);
        if (config.width <= SIDE)
            (void)pupil_veil_evaluate_rows(&veil, take_below(SIDE), take_below(2), row);
    }
    (void)pupil_veil_map_rows(&veil, &r->pupil, &curve, &rows, &out.image, &scratch);
    picture_guarded(&out);
    picture_free(&in);
    picture_free(&out);
}

static void do_bloom(run *r)
{
    static pupil_bloom_scratch scratch;
    picture in = picture_in(1 + take_below(SIDE), 1 + take_below(SIDE)), out = picture_out(&in);
    const pupil_image_const frame = pupil_image_as_const(in.image);
    const pupil_curve curve = {.scale = 1, .first_row = take_below(8) ? 0 : take_below(SIDE)};
    const char *why = NULL;
    pupil_bloom_config c;
    pupil_bloom_config_default(&c);
    c.width = take_below(20) ? frame.width : take_below(200);
    c.height = take_below(20) ? frame.height : take_below(200);
    c.threshold = take_below(2) ? 0 : take_double(-1, 100);
    c.lobes = take_below(6 + 40 * !take_below(30));
    for (uint32_t i = 0; i < c.lobes && i < PUPIL_VEIL_MOST_LOBES; i++) {
        c.lobe[i].sigma = take_double(0.05, take_below(2) ? 5 : 1100);
        c.lobe[i].weight = take_double(0, 0.3);
    }
    const int error = pupil_bloom_config_check(&c, &why);
    const size_t bytes = pupil_bloom_bytes(&c);
    MUST(error == PUPIL_OK || (error == PUPIL_ERR_CONFIG && why));
    MUST(!bytes == (error != PUPIL_OK));
    pupil_bloom *bloom = malloc(bytes ? bytes : sizeof(double));
    MUST(bloom && pupil_bloom_init(bloom, bytes, &c) == error);
    MUST(error || pupil_bloom_init(bloom, bytes - 1, &c) == PUPIL_ERR_VALUE);
    if (!error) {
        (void)pupil_bloom_gather_rows(bloom, &r->pupil, &frame, take_below(4) ? 0 : take_below(SIDE),
                                      take_below(4) ? frame.height : take_below(SIDE), &scratch);
        MUST(pupil_bloom_solve(bloom, &r->pupil) == PUPIL_OK);
        (void)pupil_bloom_map_rows(bloom, NULL, &r->pupil, &curve, &frame, &out.image, &scratch);
    }
    free(bloom);
    picture_guarded(&out);
    picture_free(&in);
    picture_free(&out);
}

static void do_edges(run *r)
{
    picture in = picture_in(1 + take_below(SIDE), 1 + take_below(SIDE)), out = picture_like(&in);
    const pupil_image_const rows = pupil_image_as_const(in.image);
    const uint8_t colour[3] = {(uint8_t)take_below(256), 0, 255};
    uint64_t edges = 0;
    (void)r;
    const int error = pupil_mark_edges(&rows, take_below(PUPIL_EDGE_MOST + 9), colour, &out.image, &edges);
    MUST(error == PUPIL_OK || error == PUPIL_ERR_VALUE || error == PUPIL_ERR_PIXEL || error == PUPIL_ERR_CODING);
    MUST(edges <= (uint64_t)rows.width * rows.height && (error == PUPIL_OK || !edges));
    picture_guarded(&out);
    picture_free(&in);
    picture_free(&out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static void (*const step[])(run *) = {do_process, do_process, do_begin, do_rows, do_rows,  do_end,
                                          do_retune,  do_stats,   do_map,   do_veil, do_bloom, do_edges};
    static run r;
    const char *why = NULL;
    input = data;
    input_left = size;
    memset(&r, 0, sizeof r);
    r.config = take_config();
    const int error = pupil_config_check(&r.config, &why);
    MUST(error == PUPIL_OK || (error == PUPIL_ERR_CONFIG && why != NULL));
    MUST(pupil_init(&r.pupil, &r.config) == error);
    if (error)
        pupil_config_default(&r.config);
    MUST(pupil_init(&r.pupil, &r.config) == PUPIL_OK);
    r.ev_min = r.config.ev_min;
    r.ev_max = r.config.ev_max;
    for (int n = 0; n < 40 && input_left; n++)
        step[take_below(sizeof step / sizeof *step)](&r);
    return 0;
}

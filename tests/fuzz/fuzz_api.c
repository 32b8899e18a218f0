/* Any config, any image, any order of calls. The bytes of the input choose all of it; what must hold, whatever they
 * are: no crash, nothing written outside an output, refused calls leave everything as it was, the level is finite and
 * within the limits, a frame in pieces is the frame.
 */
#include "pupil/pupil.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define SIDE  64
#define GUARD 32
#define ROOM  ((SIDE * 16 + 64) * SIDE + 2 * GUARD)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const uint8_t *input;
static size_t input_left;

/* Fails as a sanitizer would, so that libFuzzer keeps the input. */
#define MUST(condition) ((condition) ? (void)0 : abort())

static void take(void *into, size_t bytes)
{
    const size_t n = bytes < input_left ? bytes : input_left;
    memset(into, 0, bytes);
    memcpy(into, input, n);
    input += n;
    input_left -= n;
}

static uint32_t take_below(uint32_t n)
{
    uint16_t u;
    take(&u, sizeof u);
    return n ? u % n : 0;
}

/* Mostly values near the ones that matter; sometimes any bits. */
static double take_double(double low, double high)
{
    static const double odd[] = {0, -1, NAN, INFINITY, -INFINITY, 1e300, 1e-300, 1};
    const uint32_t kind = take_below(16);
    double any;
    if (kind == 0)
        return odd[take_below(8)];
    if (kind == 1) {
        take(&any, sizeof any);
        return any;
    }
    return low + (high - low) * take_below(1025) / 1024;
}

typedef struct run {
    pupil_t pupil;
    pupil_config config;
    double ev_min, ev_max; /* the widest limits since init: a retune leads the level into new ones, it does not jump */
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
    c.floor = take_below(4) ? 0x1p-14f : (float)take_double(1e-9, 1);
    c.clip = take_below(4) ? 0 : (float)take_double(0, 10);
    c.trim_low = take_below(3) ? 0 : (float)take_double(0, 0.5);
    c.trim_high = take_below(3) ? 1 : (float)take_double(0.5, 1);
    c.histogram = take_below(2);
    for (uint32_t i = take_below(20); i > 0; i--)
        c.weight[take_below(16)][take_below(16)] = (uint8_t)take_below(256);
    c.law = take_below(PUPIL_LAW_COUNT + !take_below(30));
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
    c.order = take_below(2);
    c.white_mode = take_below(3);
    c.white = take_double(0.01, 100);
    c.white_quantile = take_double(0.5, 1);
    c.transfer = take_below(3);
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

typedef struct picture {
    pupil_image image;
    uint8_t *memory;
    size_t bytes, row_bytes, stride;
} picture;

static picture picture_make(uint32_t width, uint32_t height, uint32_t pixel)
{
    static const uint8_t align[PUPIL_PIXEL_COUNT] = {1, 4, 4, 2, 2, 2, 1, 1, 1};
    picture p;
    p.row_bytes = width * pupil_pixel_bytes(pixel);
    p.stride = p.row_bytes + (size_t)align[pixel] * take_below(4);
    p.bytes = p.stride * height + 2 * GUARD;
    p.memory = malloc(p.bytes);
    MUST(p.memory != NULL && p.bytes <= ROOM);
    memset(p.memory, 0xee, p.bytes);
    p.image.data = p.memory + GUARD;
    p.image.stride_bytes = (ptrdiff_t)p.stride;
    if (take_below(2)) {
        p.image.data = p.memory + GUARD + p.stride * (height - 1);
        p.image.stride_bytes = -(ptrdiff_t)p.stride;
    }
    p.image.width = width;
    p.image.height = height;
    p.image.pixel = pixel;
    return p;
}

static void picture_guarded(const picture *p)
{
    for (size_t i = 0; i < p->bytes; i++)
        if (i < GUARD || i >= p->bytes - GUARD || (i - GUARD) % p->stride >= p->row_bytes)
            MUST(p->memory[i] == 0xee);
}

/* A few bytes of the input, over and over: enough for every kind of pixel beside every other. */
static void picture_fill(picture *p)
{
    uint8_t pattern[97];
    const uint32_t n = 1 + take_below(sizeof pattern);
    take(pattern, n);
    for (size_t i = 0; i < p->bytes - 2 * GUARD; i++)
        p->memory[GUARD + i] = pattern[i % n];
}

/* Any int that is no image: one field of a good one is spoilt. */
static void spoil(pupil_image *image)
{
    switch (take_below(6)) {
    case 0:
        image->data = NULL;
        break;
    case 1:
        image->stride_bytes = (ptrdiff_t)take_below(3) - 1;
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
    MUST(e.state <= PUPIL_STATE_LOCKED && e.reason <= PUPIL_REASON_LOCK && e.dt_s >= 0);
    const int error = pupil_get_curve(&r->pupil, NULL, &curve);
    MUST(error == (e.frames ? PUPIL_OK : PUPIL_ERR_NO_EXPOSURE));
    if (error)
        return;
    /* the level is kept in 2^-52 stops */
    MUST(e.adapted_ev >= r->ev_min - 0x1p-52 && e.adapted_ev <= r->ev_max + 0x1p-52);
    MUST(isfinite(e.metered_ev) && isfinite(e.white_ev) && isfinite(e.scale) && e.scale > 0);
    MUST(curve.scale > 0 && isfinite(curve.scale) && isfinite(curve.inverse_white_squared) && curve.gamut >= 0);
}

static void check_refused(const run *before, const run *after, int error)
{
    MUST(error == PUPIL_OK || (error < 0 && error >= PUPIL_ERR_STATS));
    MUST(error == PUPIL_OK || memcmp(&before->pupil, &after->pupil, sizeof after->pupil) == 0);
}

/* A frame at once; then, from the same state, in pieces: the same statistics, level and picture. */
static void do_process(run *r)
{
    const uint32_t width = 1 + take_below(SIDE), height = 1 + take_below(SIDE);
    picture in = picture_make(width, height, PUPIL_PIXEL_RGBA32F + take_below(7));
    picture out = picture_make(width, height, PUPIL_PIXEL_RGBA8 + take_below(3));
    const pupil_frame_info info = take_info();
    static run before;
    static pupil_stats whole, parts;
    before = *r;
    picture_fill(&in);
    pupil_image bad = take_below(2) ? in.image : out.image;
    const int was_in = bad.data == in.image.data;
    spoil(&bad);
    const pupil_image_const bad_in = pupil_image_as_const(was_in ? bad : in.image),
                            good = pupil_image_as_const(in.image);
    const int refused = pupil_process(&r->pupil, &bad_in, &info, was_in ? &out.image : &bad);
    MUST(refused < 0);
    check_refused(&before, r, refused);
    const int error = pupil_process(&r->pupil, &good, &info, &out.image);
    MUST(error == (r->in_frame ? PUPIL_ERR_ORDER : PUPIL_OK));
    check_refused(&before, r, error);
    if (!error) {
        const uint32_t cut = take_below(height);
        const pupil_image_const rows[2] = {pupil_image_rows(good, cut, height - cut), pupil_image_rows(good, 0, cut)};
        MUST(pupil_get_stats(&r->pupil, &whole) == PUPIL_OK);
        pupil_stats_clear(&parts);
        for (int i = 0; i < (cut ? 2 : 1); i++)
            MUST(pupil_meter_rows(&before.pupil, &rows[i], i ? 0 : cut, height, &parts) == PUPIL_OK);
        MUST(memcmp(&whole, &parts, sizeof whole) == 0);
        MUST(pupil_adapt(&before.pupil, &parts, &info) == PUPIL_OK);
        pupil_exposure a, b;
        MUST(pupil_get_exposure(&before.pupil, &a) == PUPIL_OK && pupil_get_exposure(&r->pupil, &b) == PUPIL_OK);
        MUST(memcmp(&a, &b, sizeof a) == 0);
    }
    picture_guarded(&out);
    check_exposure(r);
    free(in.memory);
    free(out.memory);
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
    picture in = picture_make(width, 1 + take_below(SIDE), PUPIL_PIXEL_RGBA32F + take_below(7));
    picture out = picture_make(width, in.image.height, PUPIL_PIXEL_RGBA8 + take_below(3));
    const pupil_image_const rows = pupil_image_as_const(in.image);
    const uint32_t first = take_below(2) ? 0 : take_below(SIDE);
    static run before;
    before = *r;
    picture_fill(&in);
    const int error = pupil_frame_rows(&r->pupil, &rows, first, take_below(2) ? &out.image : NULL);
    check_refused(&before, r, error);
    MUST(error != PUPIL_OK || (r->in_frame && first + rows.height <= r->frame_height && rows.width == r->frame_width));
    picture_guarded(&out);
    free(in.memory);
    free(out.memory);
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

/* Statistics made of any bytes: refused, or adapted to without harm; and added up. */
static void do_stats(run *r)
{
    static pupil_stats s, sum, sum_before;
    static run before;
    const pupil_frame_info info = take_info();
    double value;
    before = *r;
    MUST(pupil_get_stats(&r->pupil, &s) == PUPIL_OK);
    sum = sum_before = s;
    for (uint32_t i = take_below(6); i > 0; i--) {
        const size_t at = take_below(take_below(2) ? 80 : sizeof s);
        take((uint8_t *)&s + at, 1 + take_below((uint32_t)(sizeof s - at < 8 ? sizeof s - at : 8)));
    }
    const double low = take_double(0, 1), high = take_double(0, 1);
    if (pupil_stats_mean(&s, low, high, &value) == PUPIL_OK)
        MUST(value >= -33 && value <= 33);
    if (pupil_stats_quantile(&s, low, &value) == PUPIL_OK)
        MUST(value >= -32 && value <= 32);
    if (pupil_stats_peak_quantile(&s, low, &value) == PUPIL_OK)
        MUST(value >= -32 && value <= 32);
    if (pupil_stats_add(&sum, &s) != PUPIL_OK)
        MUST(memcmp(&sum, &sum_before, sizeof sum) == 0);
    const int error = pupil_adapt(&r->pupil, &s, &info);
    check_refused(&before, r, error);
    check_exposure(r);
}

static void do_map(run *r)
{
    const uint32_t width = 1 + take_below(SIDE), height = 1 + take_below(SIDE);
    picture in = picture_make(width, height, PUPIL_PIXEL_RGBA32F + take_below(7));
    picture out = picture_make(width, height, PUPIL_PIXEL_RGBA8 + take_below(3));
    const pupil_image_const rows = pupil_image_as_const(in.image);
    const pupil_curve curve = {(float)take_double(0, 100), (float)take_double(0, 2), (float)take_double(0, 16)};
    static run before;
    before = *r;
    picture_fill(&in);
    const int error = pupil_map_rows(&r->pupil, &curve, &rows, &out.image);
    MUST(error == PUPIL_OK || error == PUPIL_ERR_VALUE);
    MUST(memcmp(&before.pupil, &r->pupil, sizeof r->pupil) == 0);
    picture_guarded(&out);
    free(in.memory);
    free(out.memory);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static void (*const step[])(run *) = {do_process, do_process, do_begin, do_rows, do_rows,
                                          do_end,     do_retune,  do_stats, do_map};
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

#include "subject.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "camera.h"
#include "frames.h"
#include "pupil/row_gain.h"

const char *const bench_kernel_names[BENCH_KERNELS] = {"meter",       "map",         "fused", "exact", "config-default",
                                                       "fused+white", "fused+every", "curve", "luma"};
const char *const bench_level_names[PUPIL_LEVEL_COUNT] = {"scalar", "neon", "avx2", "avx512", "wasm128"};
const bench_out bench_outs[] = {
    {"rgba8", PUPIL_PIXEL_RGBA8, 1},     {"rgb8", PUPIL_PIXEL_RGB8, 1},       {"bgrx8", PUPIL_PIXEL_BGRX8, 1},
    {"bgr8", PUPIL_PIXEL_BGR8, 1},       {"nv12", PUPIL_PIXEL_NV12, 1},       {"half", PUPIL_PIXEL_RGBA8, 2},
    {"i420", PUPIL_PIXEL_I420, 1},       {"rgba32f", PUPIL_PIXEL_RGBA32F, 1}, {"rgb32f", PUPIL_PIXEL_RGB32F, 1},
    {"rgba16f", PUPIL_PIXEL_RGBA16F, 1}, {"rgb16f", PUPIL_PIXEL_RGB16F, 1},   {NULL, PUPIL_PIXEL_NONE, 0}};

static int is_yuv8(uint32_t pixel)
{
    return bench_is_yuv(pixel) && pixel != PUPIL_PIXEL_P010 && pixel != PUPIL_PIXEL_I420_10 &&
           pixel != PUPIL_PIXEL_I444_16;
}

static void configure(pupil_config *c, bench_which which)
{
    pupil_config_default(c);
    c->white_mode = which >= BENCH_CONFIG ? PUPIL_WHITE_FOLLOW : PUPIL_WHITE_FIXED;
    c->histogram_step = which == BENCH_WHITE_EVERY;
    c->accuracy = which == BENCH_LUMA ? PUPIL_ACCURACY_LUMA : PUPIL_ACCURACY_EXACT;
    c->curve = which == BENCH_CURVE ? PUPIL_CURVE_ADJUST : PUPIL_CURVE_REINHARD;
    c->white = 4.0;
}

/* --- what is run --- */

/* Parts begin at even rows, as those of NV12 and of mosaics must. */
static void part_of(const bench_subject *s, unsigned worker, unsigned count, pupil_image_const *in, pupil_image *out,
                    uint32_t *first)
{
    const uint32_t pairs = (s->in.height + 1) / 2, step = s->in.width / s->out.width;
    const uint32_t begin = 2 * (pairs * worker / count), next = 2 * (pairs * (worker + 1) / count);
    const uint32_t rows = (next < s->in.height ? next : s->in.height) - begin;
    *first = begin;
    *in = pupil_image_rows(s->in, begin, rows);
    *out = pupil_image_out_rows(s->out, begin / step, rows / step);
}

static void work(void *context, unsigned worker, unsigned count)
{
    bench_kernel *k = context;
    bench_subject *s = k->s;
    pupil_image_const in;
    pupil_image out;
    uint32_t first;
    part_of(s, worker, count, &in, &out, &first);
    if (!in.height)
        return;
    pupil_stats *stats = &k->stats[worker];
    pupil_stats_clear(stats);
    const int two_passes = k->which == BENCH_EXACT || k->which == BENCH_CONFIG;
    if (k->which == BENCH_METER || two_passes)
        pupil_meter_rows(&k->pupil, &in, first, s->in.height, stats);
    if (k->which == BENCH_MAP && k->gain)
        pupil_map_rows_with_gains(&k->pupil, &k->curve, &in, k->gain + first, &out);
    else if (k->which == BENCH_MAP || two_passes)
        pupil_map_rows(&k->pupil, &k->curve, &in, &out);
    if (k->which == BENCH_FUSED || k->which >= BENCH_WHITE)
        pupil_fused_rows(&k->pupil, &k->curve, &in, first, s->in.height, &out, stats);
}

void bench_kernel_run(void *context)
{
    bench_kernel *k = context;
    workers_run(k->s->crew, work, k);
}

static void read_part(void *context, unsigned worker, unsigned count)
{
    bench_subject *s = context;
    const size_t lines = s->bytes / 64, begin = lines * worker / count, end = lines * (worker + 1) / count;
    unsigned long long seen = bench_read((const unsigned char *)s->in.data + begin * 64, (end - begin) * 64);
    if (worker == 0)
        s->seen += seen;
}

void bench_read_run(void *context)
{
    workers_run(((bench_subject *)context)->crew, read_part, context);
}

static void copy_part(void *context, unsigned worker, unsigned count)
{
    bench_subject *s = context;
    const size_t begin = s->bytes * worker / count, end = s->bytes * (worker + 1) / count;
    memcpy(s->copy + begin, (const unsigned char *)s->in.data + begin, end - begin);
}

void bench_copy_run(void *context)
{
    workers_run(((bench_subject *)context)->crew, copy_part, context);
}

/* --- opening --- */

/* Sets another light for the same codes. */
static void set_light(pupil_image_const *in, pupil_coding *coding, uint32_t light)
{
    if (light == PUPIL_LIGHT_DEFAULT)
        return;
    *coding = in->coding ? *in->coding : (pupil_coding){0};
    coding->light = light;
    in->coding = coding;
}

int bench_subject_open(bench_subject *s, const bench_options *o, uint32_t pixel, workers *crew)
{
    pupil_config c;
    pupil_t pupil;
    *s = (bench_subject){.crew = crew, .in = bench_frame(pixel, o->width, o->height, 0)};
    set_light(&s->in, &s->coding, o->light);
    s->bytes = bench_frame_bytes(pixel, o->width, o->height);
    s->copy = aligned_alloc(64, (s->bytes + 63) / 64 * 64);
    s->out = bench_room(o->out->pixel, o->width / o->out->step, o->height / o->out->step);
    if (is_yuv8(pixel) && pupil_pixel_planes(o->out->pixel) > 1)
        s->out.coding = s->in.coding; /* as a camera's frames are passed on */
    configure(&c, BENCH_METER);
    if (s->in.data && s->copy && s->out.data && !pupil_init(&pupil, &c) &&
        !pupil_process(&pupil, &s->in, NULL, &s->out) && !pupil_get_curve(&pupil, NULL, &s->curve)) {
        memset(s->copy, 0, s->bytes);
        return 0;
    }
    fprintf(stderr, "pupil bench: not enough memory for frames of %lux%lu pixels\n", (unsigned long)o->width,
            (unsigned long)o->height);
    return -1;
}

void bench_subject_close(bench_subject *s)
{
    free(s->out.data);
    free(s->copy);
    free((void *)(uintptr_t)s->in.data);
    *s = (bench_subject){0};
}

int bench_kernel_open(bench_kernel *k, bench_subject *s, bench_which which, uint32_t level)
{
    pupil_config c;
    uint32_t got;
    if (which == BENCH_LUMA && !is_yuv8(s->in.pixel))
        return -1;
    configure(&c, which);
    c.levels = 1u << level;
    if (pupil_init(&k->pupil, &c) || pupil_get_level(&k->pupil, &got) || got != level)
        return -1;
    k->s = s;
    k->which = which;
    k->level = level;
    k->gain = NULL;
    k->curve = s->curve;
    const int own = which == BENCH_CURVE;
    return own && (pupil_meter(&k->pupil, &s->in, NULL) || pupil_get_curve(&k->pupil, NULL, &k->curve)) ? -1 : 0;
}

uint32_t bench_best_level(void)
{
    pupil_config c;
    pupil_t pupil;
    uint32_t level = PUPIL_LEVEL_SCALAR;
    configure(&c, BENCH_METER);
    if (pupil_init(&pupil, &c) || pupil_get_level(&pupil, &level))
        return PUPIL_LEVEL_SCALAR;
    return level;
}

int bench_kernel_error(uint32_t level, uint32_t pixel, uint32_t light, uint32_t step, int hard, verify_figures *figures)
{
    pupil_coding coding;
    pupil_config c;
    pupil_t pupil;
    pupil_stats stats;
    pupil_curve curve;
    pupil_image_const in = bench_frame(pixel, 480, 270, hard);
    pupil_image out = bench_room(PUPIL_PIXEL_RGB8, 480 / step, 270 / step);
    *figures = (verify_figures){0};
    set_light(&in, &coding, light);
    configure(&c, BENCH_METER);
    c.levels = 1u << level;
    int failed = !in.data || !out.data || pupil_init(&pupil, &c);
    if (!failed) {
        const pupil_image_const mapped = pupil_image_as_const(out);
        failed = pupil_process(&pupil, &in, NULL, &out) || pupil_get_stats(&pupil, &stats) ||
                 pupil_get_curve(&pupil, NULL, &curve);
        if (!failed)
            verify_frame(figures, &c, &in, &curve, &mapped, &stats);
    }
    free((void *)(uintptr_t)in.data);
    free(out.data);
    return failed;
}

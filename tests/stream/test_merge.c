/* A frame cut into groups of rows: any cut, order and number of threads give the bits of the whole frame, in its
 * statistics and its display frame.
 */
#include "check.h"
#include "frames.h"
#include "pupil/pupil.h"

#include <pthread.h>

typedef struct cut {
    uint32_t first[64], rows[64], count;
} cut;

static cut cut_random(uint32_t height)
{
    cut c = {.count = 0};
    uint32_t at = 0;
    while (at < height) {
        const uint32_t some = 1 + (uint32_t)(check_random() % (height - at));
        c.first[c.count] = at;
        c.rows[c.count] = c.count == 63 ? height - at : some > 3 ? some / 3 : some;
        c.count++;
        at += c.rows[c.count - 1];
    }
    for (uint32_t i = c.count; i > 1; i--) { /* Fisher and Yates */
        const uint32_t j = (uint32_t)(check_random() % i);
        const uint32_t first = c.first[i - 1], rows = c.rows[i - 1];
        c.first[i - 1] = c.first[j];
        c.rows[i - 1] = c.rows[j];
        c.first[j] = first;
        c.rows[j] = rows;
    }
    return c;
}

static void random_config(pupil_config *config)
{
    pupil_config_default(config);
    config->histogram = (uint32_t)(check_random() & 1);
    config->histogram_step = check_random() & 1 ? 1u << check_random() % 4 : 0;
    config->floor = check_random() & 1 ? 0x1p-30f : 0x1p-14f;
    config->white_mode = (uint32_t)(check_random() % PUPIL_WHITE_COUNT);
    config->white = 4;
    config->transfer = (uint32_t)(check_random() % PUPIL_TRANSFER_COUNT);
    if (check_random() & 1)
        CHECK(pupil_metering_centre(config) == PUPIL_OK);
}

static frame random_frame(void)
{
    const uint32_t width = 1 + (uint32_t)(check_random() % 300), height = 1 + (uint32_t)(check_random() % 200);
    const uint32_t pixel = PUPIL_PIXEL_RGBA32F + (uint32_t)(check_random() % 7);
    frame f = frame_make(width, height, pixel, 4 * (check_random() % 3), (int)(check_random() & 1));
    if (check_random() & 1)
        frame_odd(&f, check_uniform);
    else
        frame_lognormal(&f, 0.18, 2, check_uniform);
    return f;
}

static frame output_for(const frame *in)
{
    const uint32_t pixel = PUPIL_PIXEL_RGBA8 + (uint32_t)(check_random() % 3);
    return frame_make(in->image.width, in->image.height, pixel, check_random() % 5, (int)(check_random() & 1));
}

static pupil_image rows_of(const frame *f, uint32_t first, uint32_t rows)
{
    pupil_image image = frame_writable(f);
    image.data = (unsigned char *)image.data + (ptrdiff_t)first * image.stride_bytes;
    image.height = rows;
    return image;
}

/* The whole frame against groups that are metered separately, and merged in another order, as a tree. */
static void check_stats(const pupil_t *pupil, const frame *f, const pupil_stats *whole)
{
    const cut c = cut_random(f->image.height);
    static pupil_stats part[64];
    pupil_stats same;
    pupil_stats_clear(&same);
    for (uint32_t i = 0; i < c.count; i++) {
        const pupil_image_const rows = pupil_image_rows(f->image, c.first[i], c.rows[i]);
        pupil_stats_clear(&part[i]);
        CHECK(pupil_meter_rows(pupil, &rows, c.first[i], f->image.height, &part[i]) == PUPIL_OK);
        CHECK(pupil_meter_rows(pupil, &rows, c.first[i], f->image.height, &same) == PUPIL_OK);
    }
    CHECK(memcmp(&same, whole, sizeof same) == 0);
    for (uint32_t left = c.count; left > 1; left--) {
        const uint32_t from = (uint32_t)(check_random() % left), into = (from + 1) % left;
        CHECK(pupil_stats_add(&part[into], &part[from]) == PUPIL_OK);
        if (from != left - 1) /* the last one takes the empty place */
            part[from] = part[left - 1];
    }
    CHECK_MSG(memcmp(&part[0], whole, sizeof *whole) == 0, "%u groups", c.count);
}

/* frame_begin, rows in any order, frame_end against pupil_process; with and without output. */
static void check_by_rows(const pupil_config *config, const frame *f)
{
    pupil_t at_once, by_rows;
    frame out[2] = {output_for(f), {.memory = NULL}};
    out[1] =
        frame_make(f->image.width, f->image.height, out[0].image.pixel,
                   (size_t)llabs(out[0].image.stride_bytes) - f->image.width * pupil_pixel_bytes(out[0].image.pixel),
                   out[0].image.stride_bytes < 0);
    const pupil_image whole_out = frame_writable(&out[0]);
    pupil_config fused = *config;
    fused.order = PUPIL_ORDER_FUSED;
    CHECK(pupil_init(&at_once, &fused) == PUPIL_OK);
    for (int round = 0; round < 3; round++) {
        const pupil_frame_info info = {.timestamp_ns = 1000000 * (round + 1) * (round + 1)};
        const cut c = cut_random(f->image.height);
        if (!round)
            memcpy(&by_rows, &at_once, sizeof by_rows);
        CHECK(pupil_process(&at_once, &f->image, &info, &whole_out) == PUPIL_OK);
        CHECK(pupil_frame_begin(&by_rows, f->image.width, f->image.height, &info) == PUPIL_OK);
        for (uint32_t i = 0; i < c.count; i++) {
            const pupil_image_const rows = pupil_image_rows(f->image, c.first[i], c.rows[i]);
            const pupil_image to = rows_of(&out[1], c.first[i], c.rows[i]);
            CHECK(pupil_frame_rows(&by_rows, &rows, c.first[i], round ? &to : NULL) == PUPIL_OK);
        }
        CHECK(pupil_frame_end(&by_rows) == PUPIL_OK);
        CHECK(!round || memcmp(out[0].memory, out[1].memory, out[0].bytes) == 0);
        pupil_stats stats[2];
        pupil_exposure exposure[2];
        CHECK(pupil_get_stats(&at_once, &stats[0]) == PUPIL_OK && pupil_get_stats(&by_rows, &stats[1]) == PUPIL_OK);
        CHECK(memcmp(&stats[0], &stats[1], sizeof *stats) == 0);
        CHECK(pupil_get_exposure(&at_once, &exposure[0]) == PUPIL_OK);
        CHECK(pupil_get_exposure(&by_rows, &exposure[1]) == PUPIL_OK);
        CHECK(memcmp(&exposure[0], &exposure[1], sizeof *exposure) == 0);
        check_stats(&by_rows, f, &stats[0]);
    }
    CHECK(frame_guards_intact(&out[0]) && frame_guards_intact(&out[1]));
    frame_free(&out[0]);
    frame_free(&out[1]);
}

/* pupil_process in exact order against its four steps; fused_rows against meter_rows and map_rows. */
static void check_steps(const pupil_config *config, const frame *f)
{
    pupil_t at_once, steps;
    pupil_stats stats, fused_stats;
    pupil_curve curve;
    frame out[3];
    for (int i = 0; i < 3; i++)
        out[i] = frame_make(f->image.width, f->image.height, PUPIL_PIXEL_BGRX8, 0, 0);
    const pupil_image to[3] = {frame_writable(&out[0]), frame_writable(&out[1]), frame_writable(&out[2])};
    const pupil_frame_info info = {.timestamp_ns = 5, .exposure_s = 0.01, .gain = 2};
    CHECK(pupil_init(&at_once, config) == PUPIL_OK && pupil_init(&steps, config) == PUPIL_OK);
    CHECK(pupil_process(&at_once, &f->image, &info, &to[0]) == PUPIL_OK);
    pupil_stats_clear(&stats);
    pupil_stats_clear(&fused_stats);
    CHECK(pupil_meter_rows(&steps, &f->image, 0, f->image.height, &stats) == PUPIL_OK);
    CHECK(pupil_adapt(&steps, &stats, &info) == PUPIL_OK);
    CHECK(pupil_get_curve(&steps, &info, &curve) == PUPIL_OK);
    CHECK(pupil_map_rows(&steps, &curve, &f->image, &to[1]) == PUPIL_OK);
    CHECK(memcmp(out[0].memory, out[1].memory, out[0].bytes) == 0);
    const cut c = cut_random(f->image.height);
    for (uint32_t i = 0; i < c.count; i++) {
        const pupil_image_const rows = pupil_image_rows(f->image, c.first[i], c.rows[i]);
        const pupil_image into = rows_of(&out[2], c.first[i], c.rows[i]);
        CHECK(pupil_fused_rows(&steps, &curve, &rows, c.first[i], f->image.height, &into, &fused_stats) == PUPIL_OK);
    }
    CHECK(memcmp(out[0].memory, out[2].memory, out[0].bytes) == 0);
    CHECK(memcmp(&stats, &fused_stats, sizeof stats) == 0);
    for (int i = 0; i < 3; i++)
        frame_free(&out[i]);
}

typedef struct worker {
    const pupil_t *pupil;
    const pupil_curve *curve;
    const frame *in, *out;
    uint32_t first, step;
    pupil_stats stats;
    int result;
} worker;

static void *work(void *argument)
{
    worker *w = argument;
    pupil_stats_clear(&w->stats);
    for (uint32_t y = w->first; y < w->in->image.height; y += w->step) {
        const pupil_image_const row = pupil_image_rows(w->in->image, y, 1);
        const pupil_image to = rows_of(w->out, y, 1);
        w->result |= pupil_fused_rows(w->pupil, w->curve, &row, y, w->in->image.height, &to, &w->stats);
    }
    return NULL;
}

static void check_threads(const pupil_config *config, const frame *f)
{
    static worker w[8];
    pupil_t pupil;
    pupil_stats whole, sum;
    const pupil_curve curve = {.scale = 0.7f, .inverse_white_squared = 0.01f, .gamut = 2};
    frame out[2] = {frame_make(f->image.width, f->image.height, PUPIL_PIXEL_RGB8, 0, 0),
                    frame_make(f->image.width, f->image.height, PUPIL_PIXEL_RGB8, 0, 0)};
    const pupil_image to = frame_writable(&out[0]);
    CHECK(pupil_init(&pupil, config) == PUPIL_OK);
    pupil_stats_clear(&whole);
    CHECK(pupil_fused_rows(&pupil, &curve, &f->image, 0, f->image.height, &to, &whole) == PUPIL_OK);
    for (uint32_t count = 1; count <= 8; count++) {
        pthread_t thread[8];
        memset(out[1].memory, 0xff, out[1].bytes);
        for (uint32_t i = 0; i < count; i++) {
            w[i] = (worker){.pupil = &pupil, .curve = &curve, .in = f, .out = &out[1], .first = i, .step = count};
            CHECK(pthread_create(&thread[i], NULL, work, &w[i]) == 0);
        }
        pupil_stats_clear(&sum);
        for (uint32_t i = 0; i < count; i++) {
            CHECK(pthread_join(thread[i], NULL) == 0 && w[i].result == PUPIL_OK);
            CHECK(pupil_stats_add(&sum, &w[i].stats) == PUPIL_OK);
        }
        CHECK_MSG(memcmp(&sum, &whole, sizeof sum) == 0, "%u threads", count);
        CHECK_MSG(memcmp(out[0].memory, out[1].memory, out[0].bytes) == 0, "%u threads", count);
    }
    frame_free(&out[0]);
    frame_free(&out[1]);
}

/* Everything that cannot be merged is refused and leaves both sides unchanged. */
static void check_refused(void)
{
    pupil_stats a, b, empty, sum, before;
    pupil_config config;
    pupil_t pupil;
    frame f = frame_make(9, 12, PUPIL_PIXEL_RGB8, 0, 0);
    frame_lognormal(&f, 0.2, 1, check_uniform);
    pupil_config_default(&config);
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&a);
    pupil_stats_clear(&empty);
    CHECK(pupil_meter_rows(&pupil, &f.image, 0, 12, &a) == PUPIL_OK);
    sum = before = a;
    CHECK(pupil_stats_add(&sum, &a) == PUPIL_ERR_STATS); /* 24 rows of 12 */
    CHECK(memcmp(&sum, &before, sizeof sum) == 0);
    CHECK(pupil_stats_add(&sum, &empty) == PUPIL_OK && memcmp(&sum, &before, sizeof sum) == 0);
    CHECK(pupil_stats_add(&empty, &sum) == PUPIL_OK && memcmp(&empty, &before, sizeof sum) == 0);
    pupil_stats_clear(&b);
    const pupil_image_const rows = pupil_image_rows(f.image, 0, 3);
    CHECK(pupil_meter_rows(&pupil, &rows, 0, 24, &b) == PUPIL_OK);
    CHECK(pupil_stats_add(&sum, &b) == PUPIL_ERR_STATS && memcmp(&sum, &before, sizeof sum) == 0);
    config.white_mode = PUPIL_WHITE_NONE;
    CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
    pupil_stats_clear(&b);
    CHECK(pupil_meter_rows(&pupil, &rows, 0, 12, &b) == PUPIL_OK);
    pupil_stats_clear(&a);
    config.histogram = 1;
    CHECK(pupil_retune(&pupil, &config) == PUPIL_OK);
    const pupil_image_const others = pupil_image_rows(f.image, 3, 4);
    CHECK(pupil_meter_rows(&pupil, &others, 3, 12, &a) == PUPIL_OK);
    sum = before = a;
    CHECK(pupil_stats_add(&sum, &b) == PUPIL_ERR_STATS && memcmp(&sum, &before, sizeof sum) == 0);
    CHECK(pupil_stats_add(NULL, &b) == PUPIL_ERR_NULL && pupil_stats_add(&sum, NULL) == PUPIL_ERR_NULL);
    CHECK(memcmp(&sum, &before, sizeof sum) == 0);
    frame_free(&f);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (int i = 0; i < 25; i++) {
        pupil_config config;
        frame f = random_frame();
        random_config(&config);
        check_by_rows(&config, &f);
        check_steps(&config, &f);
        if (i < 6)
            check_threads(&config, &f);
        frame_free(&f);
    }
    check_refused();
    return check_end();
}

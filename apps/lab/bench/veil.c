/* pupil bench veil: what a veil costs: lists of lights beside what one might use instead, and frames with one beside
 * frames without. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "clock.h"
#include "common/interrupt.h"
#include "common/progress.h"
#include "common/report_error.h"
#include "instructions.h"
#include "options/commands.h"
#include "pupil/bloom.h"
#include "veil_rivals.h"

/* Instructions are counted in a picture of a tenth of the size: each of them stops the process once. */
enum { SIDE = 600, COUNTED_SIDE = 60, MOST_LIGHTS = 10000, COUNTS = 5 };
#define SIGMA_PX 37.5
#define PERIOD   1.25 /* of a bell that reaches 150 pixels: 750 */

typedef struct options {
    uint64_t rounds;
    uint32_t width, height;
} options;

typedef struct bench {
    options options;
    progress progress;
    pupil_veil veil, counted;
    pupil_veil_spot spot[MOST_LIGHTS];
    veil_lights lights;
    uint32_t harmonics;
    float *rgb;    /* of the list's picture */
    double *exact; /* its second channel */
    veil_pyramid *pyramid;
    veil_fft *fft; /* NULL: without */
    const char *no_fft;
} bench;

static void show(bench *b, const char *what, size_t lights)
{
    if (!progress_due(&b->progress, 0.1))
        return;
    fputs(what, stderr);
    if (lights)
        fprintf(stderr, ", %zu of %d lights", lights, MOST_LIGHTS);
    fflush(stderr);
}

/* --- lists of lights --- */

static void make_veil(const bench *b, uint32_t side, pupil_veil *veil)
{
    pupil_veil_config c;
    pupil_veil_config_default(&c);
    c.psf = PUPIL_VEIL_GAUSSIANS;
    c.width = c.height = side;
    c.period = PERIOD;
    c.harmonics = b->harmonics;
    pupil_veil_init(veil, &c);
}

static void gather(void *context)
{
    bench *b = context;
    pupil_veil_begin(&b->veil);
    pupil_veil_add_bells(&b->veil, PUPIL_VEIL_GAUSSIAN, 4 * SIGMA_PX, b->spot, b->lights.count);
}

static void evaluate(void *context)
{
    bench *b = context;
    pupil_veil_evaluate_rows(&b->veil, 0, SIDE, b->rgb);
}

/* The same lights in a smaller picture. */
static void gather_counted(bench *b)
{
    const double scale = (double)COUNTED_SIDE / SIDE;
    pupil_veil_begin(&b->counted);
    for (size_t i = 0; i < b->lights.count; i++) {
        pupil_veil_spot spot = b->spot[i];
        spot.x_px *= scale;
        spot.y_px *= scale;
        pupil_veil_add_bells(&b->counted, PUPIL_VEIL_GAUSSIAN, 4 * SIGMA_PX * scale, &spot, 1);
    }
}

static void evaluate_counted_row(void *context)
{
    bench *b = context;
    pupil_veil_evaluate_rows(&b->counted, COUNTED_SIDE / 2, 1, b->rgb);
}

static void direct(void *context)
{
    bench *b = context;
    veil_direct(&b->lights, b->rgb);
}

static void fft(void *context)
{
    bench *b = context;
    veil_fft_run(b->fft, &b->lights, b->rgb);
}

static void pyramid(void *context)
{
    bench *b = context;
    veil_pyramid_run(b->pyramid, &b->lights, b->rgb);
}

/* Of what was drawn last: the largest error, in % of the largest value. */
static double error_of(const bench *b)
{
    double peak = 0, most = 0;
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        peak = fmax(peak, b->exact[i]);
        most = fmax(most, fabs((double)b->rgb[3 * i + 1] - b->exact[i]));
    }
    return 100 * most / peak;
}

static double random_share(uint64_t *state) /* Knuth's MMIX generator */
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}

/* In the middles of pixels, where all ways are exact in place. */
static void place(bench *b, size_t count)
{
    uint64_t state = 20261122;
    for (size_t i = 0; i < count; i++) {
        b->spot[i].x_px = floor(random_share(&state) * SIDE) + 0.5;
        b->spot[i].y_px = floor(random_share(&state) * SIDE) + 0.5;
        for (int c = 0; c < 3; c++)
            b->spot[i].rgb[c] = (float)exp2(8 * random_share(&state));
    }
    b->lights = (veil_lights){SIDE, SIGMA_PX, b->spot, count};
}

typedef struct list_row {
    size_t lights;
    double gather_s, evaluate_s, direct_s, fft_s, pyramid_s;
    double error, fft_error, pyramid_error; /* % */
    long long instructions;                 /* of evaluating one row */
} list_row;

/* The other ways, which have no harmonics. The direct sum of many lights takes seconds: once. */
static int measure_rivals(bench *b, size_t lights, list_row *row)
{
    bench_runner runners[] = {{.run = pyramid, .context = b}, {.run = fft, .context = b}};
    bench_runner slow = {.run = direct, .context = b};
    const unsigned rounds = (unsigned)b->options.rounds;
    show(b, "other ways", lights);
    place(b, lights);
    if (bench_race(runners, b->fft ? 2 : 1, rounds, NULL, interrupt_came) ||
        bench_race(&slow, 1, lights < 1000 ? rounds : 1, NULL, interrupt_came))
        return -1;
    veil_exact(&b->lights, 1, b->exact);
    *row = (list_row){
        .lights = lights, .direct_s = slow.least_s, .pyramid_s = runners[0].least_s, .fft_s = runners[1].least_s};
    pyramid(b);
    row->pyramid_error = error_of(b);
    if (b->fft) {
        fft(b);
        row->fft_error = error_of(b);
    }
    return 0;
}

static int measure_series(bench *b, list_row *row)
{
    bench_runner runners[] = {{.run = gather, .context = b}, {.run = evaluate, .context = b}};
    char words[40];
    snprintf(words, sizeof words, "%u harmonics", b->harmonics);
    show(b, words, row->lights);
    place(b, row->lights);
    if (bench_race(runners, 2, (unsigned)b->options.rounds, NULL, interrupt_came))
        return -1;
    veil_exact(&b->lights, 1, b->exact);
    row->gather_s = runners[0].least_s;
    row->evaluate_s = runners[1].least_s;
    row->error = error_of(b);
    gather_counted(b);
    row->instructions = bench_instructions(evaluate_counted_row, b);
    return interrupt_came() ? -1 : 0;
}

/* Up to how many lights the direct sum takes less time: both are straight lines in their number. */
static double crossing(const list_row *few, const list_row *many)
{
    const double lights = (double)(many->lights - few->lights);
    const double direct_s = (many->direct_s - few->direct_s) / lights,
                 ours_s = (many->gather_s - few->gather_s) / lights;
    return (few->evaluate_s + few->gather_s - few->direct_s) / (direct_s - ours_s) + (double)few->lights;
}

static void print_list(bench *b, const list_row row[COUNTS])
{
    progress_clear(&b->progress);
    printf("\n%u harmonics: ms, and the largest error in %% of the peak\n"
           "%7s %9s %9s %13s %9s %9s %9s %8s %8s %8s\n",
           b->harmonics, "lights", "gather", "evaluate", "instructions", "direct", "FFT", "pyramid", "error", "FFT",
           "pyramid");
    for (int i = 0; i < COUNTS; i++) {
        const list_row *r = &row[i];
        printf("%7zu %9.3f %9.3f %13lld %9.3f ", r->lights, r->gather_s * 1e3, r->evaluate_s * 1e3, r->instructions,
               r->direct_s * 1e3);
        b->fft ? printf("%9.3f ", r->fft_s * 1e3) : printf("%9s ", "-");
        printf("%9.3f %8.4f ", r->pyramid_s * 1e3, r->error);
        b->fft ? printf("%8.4f ", r->fft_error) : printf("%8s ", "-");
        printf("%8.3f\n", r->pyramid_error);
    }
    printf("the direct sum, clipped to what a bell reaches, takes less time up to %.0f lights\n",
           crossing(&row[0], &row[3]));
}

static int run_lists(bench *b)
{
    static const size_t counts[COUNTS] = {1, 10, 100, 1000, 10000};
    b->rgb = malloc((size_t)SIDE * SIDE * 3 * sizeof *b->rgb);
    b->exact = malloc((size_t)SIDE * SIDE * sizeof *b->exact);
    b->pyramid = veil_pyramid_open(SIDE, SIGMA_PX);
    b->fft = veil_fft_open(SIDE, SIGMA_PX, &b->no_fft);
    if (!b->rgb || !b->exact || !b->pyramid)
        return -1;
    printf(
        "\nGaussians of sigma %.1f in a picture of %d x %d, one thread; each pixel is evaluated, in three channels.\n"
        "Times are the least of the rounds.\n"
        "instructions: of evaluating a row of %d pixels of a picture that much smaller, counted one by one (-1: the "
        "system does not allow it).\n",
        SIGMA_PX, SIDE, SIDE, COUNTED_SIDE);
    if (!b->fft)
        printf("FFT: %s\n", b->no_fft);
    list_row row[COUNTS];
    for (int i = 0; i < COUNTS; i++)
        if (measure_rivals(b, counts[i], &row[i]))
            return -1;
    for (b->harmonics = 8; b->harmonics <= 16; b->harmonics += 4) {
        make_veil(b, SIDE, &b->veil);
        make_veil(b, COUNTED_SIDE, &b->counted);
        for (int i = 0; i < COUNTS; i++)
            if (measure_series(b, &row[i]))
                return -1;
        print_list(b, row);
        fflush(stdout);
    }
    return 0;
}

/* --- frames --- */

typedef struct frames {
    pupil_t pupil;
    pupil_veil veil;
    pupil_veil_light light;
    pupil_veil_scratch scratch;
    pupil_bloom_scratch bloom_scratch;
    pupil_bloom *bloom;
    pupil_stats stats;
    pupil_curve curve;
    pupil_image_const in;
    pupil_image out;
    float *pixels;
    unsigned long long seen;
} frames;

static void read_only(void *context)
{
    frames *f = context;
    f->seen += bench_read(f->pixels, (size_t)f->in.width * f->in.height * 16 / 64 * 64);
}

static void meter(void *context)
{
    frames *f = context;
    pupil_stats_clear(&f->stats);
    pupil_meter_rows(&f->pupil, &f->in, 0, f->in.height, &f->stats);
}

static void meter_and_gather(void *context)
{
    frames *f = context;
    pupil_stats_clear(&f->stats);
    pupil_veil_light_clear(&f->light);
    pupil_veil_gather_rows(&f->veil, &f->pupil, &f->in, 0, &f->stats, &f->light);
}

static void solve(void *context)
{
    frames *f = context;
    pupil_veil_begin(&f->veil);
    pupil_veil_add_light(&f->veil, &f->light);
    pupil_veil_solve(&f->veil);
}

static void map(void *context)
{
    frames *f = context;
    pupil_map_rows(&f->pupil, &f->curve, &f->in, &f->out);
}

static void map_with_veil(void *context)
{
    frames *f = context;
    pupil_veil_map_rows(&f->veil, &f->pupil, &f->curve, &f->in, &f->out, &f->scratch);
}

enum { GROUP = 16 }; /* rows that are metered and gathered while they are in the cache */

static void meter_groups(frames *f, int with_bloom)
{
    pupil_stats_clear(&f->stats);
    for (uint32_t y = 0; y < f->in.height; y += GROUP) {
        const uint32_t rows = f->in.height - y < GROUP ? f->in.height - y : GROUP;
        const pupil_image_const part = pupil_image_rows(f->in, y, rows);
        pupil_meter_rows(&f->pupil, &part, y, f->in.height, &f->stats);
        if (with_bloom)
            pupil_bloom_gather_rows(f->bloom, &f->pupil, &f->in, y, rows, &f->bloom_scratch);
    }
}

static void meter_in_groups(void *context)
{
    meter_groups(context, 0);
}

static void meter_and_gather_bloom(void *context)
{
    meter_groups(context, 1);
}

static void solve_bloom(void *context)
{
    frames *f = context;
    pupil_bloom_solve(f->bloom, &f->pupil);
}

static void map_with_bloom(void *context)
{
    frames *f = context;
    pupil_bloom_map_rows(f->bloom, NULL, &f->pupil, &f->curve, &f->in, &f->out, &f->bloom_scratch);
}

/* The narrow lobes of the veil's eye. */
static int open_bloom(frames *f)
{
    pupil_bloom_config config;
    pupil_veil_result eye;
    pupil_veil_get(&f->veil, &eye);
    pupil_bloom_config_default(&config);
    config.width = f->in.width;
    config.height = f->in.height;
    config.lobes = eye.lobes;
    memcpy(config.lobe, eye.lobe, sizeof config.lobe);
    const size_t bytes = pupil_bloom_bytes(&config);
    f->bloom = malloc(bytes);
    return f->bloom && !pupil_bloom_init(f->bloom, bytes, &config) ? 0 : -1;
}

static int open_frames(const bench *b, frames *f)
{
    const uint32_t width = b->options.width, height = b->options.height;
    pupil_config config;
    pupil_veil_config eye;
    uint64_t state = 20261122;
    f->pixels = malloc((size_t)width * height * 16);
    void *out = malloc((size_t)width * height * 4);
    if (!f->pixels || !out) {
        free(out);
        return -1;
    }
    for (size_t i = 0; i < (size_t)width * height * 4; i++)
        f->pixels[i] = i % 4 == 3 ? 1.0f : (float)exp2(8 * random_share(&state) - 6);
    f->in = (pupil_image_const){.data = f->pixels,
                                .stride_bytes = (ptrdiff_t)width * 16,
                                .width = width,
                                .height = height,
                                .pixel = PUPIL_PIXEL_RGBA32F};
    f->out = (pupil_image){.data = out,
                           .stride_bytes = (ptrdiff_t)width * 4,
                           .width = width,
                           .height = height,
                           .pixel = PUPIL_PIXEL_RGBA8};
    f->curve = (pupil_curve){.scale = 0.5f, .inverse_white_squared = 0.0625f};
    pupil_config_default(&config);
    config.white_mode = PUPIL_WHITE_NONE;
    pupil_init(&f->pupil, &config);
    pupil_veil_config_default(&eye);
    eye.width = width;
    eye.height = height;
    return pupil_veil_init(&f->veil, &eye) || open_bloom(f) ? -1 : 0;
}

enum { RUNNERS = 10 };

static void print_frames(const options *o, const bench_runner runner[RUNNERS])
{
    const double pixels = (double)o->width * o->height;
    double ns[RUNNERS];
    for (int i = 0; i < RUNNERS; i++)
        ns[i] = runner[i].least_s * 1e9 / pixels;
    const double veil = ns[2] - ns[1] + ns[5] - ns[4] + ns[3], bloom = ns[7] - ns[6] + ns[9] - ns[4] + ns[8];
    printf("A frame of %u x %u, RGBA32F to RGBA8, Spencer's eye, one thread, ns a pixel:\n"
           "  a plain read of the frame      %6.3f\n"
           "  metering                       %6.3f   with gathering     %6.3f   more %6.3f\n"
           "  mapping                        %6.3f   with its veil      %6.3f   more %6.3f\n"
           "  coefficients and nodes                                           %6.3f   (%.3f ms)\n"
           "  the veil in all                                             more %6.3f   (%.2f plain reads)\n",
           o->width, o->height, ns[0], ns[1], ns[2], ns[2] - ns[1], ns[4], ns[5], ns[5] - ns[4], ns[3],
           runner[3].least_s * 1e3, veil, veil / ns[0]);
    printf("  metering                       %6.3f   with bloom's light %6.3f   more %6.3f\n"
           "  mapping                        %6.3f   with its bloom     %6.3f   more %6.3f\n"
           "  octaves                                                          %6.3f   (%.3f ms)\n"
           "  the bloom in all                                            more %6.3f   (%.2f plain reads)\n",
           ns[6], ns[7], ns[7] - ns[6], ns[4], ns[9], ns[9] - ns[4], ns[8], runner[8].least_s * 1e3, bloom,
           bloom / ns[0]);
}

static int run_frames(bench *b)
{
    frames *f = calloc(1, sizeof *f);
    if (!f || open_frames(b, f)) {
        free(f);
        return -1;
    }
    bench_runner runner[RUNNERS] = {{.run = read_only, .context = f},
                                    {.run = meter, .context = f},
                                    {.run = meter_and_gather, .context = f},
                                    {.run = solve, .context = f},
                                    {.run = map, .context = f},
                                    {.run = map_with_veil, .context = f},
                                    {.run = meter_in_groups, .context = f},
                                    {.run = meter_and_gather_bloom, .context = f},
                                    {.run = solve_bloom, .context = f},
                                    {.run = map_with_bloom, .context = f}};
    show(b, "frames", 0);
    const int stopped = bench_race(runner, RUNNERS, (unsigned)b->options.rounds, NULL, interrupt_came);
    progress_clear(&b->progress);
    if (!stopped)
        print_frames(&b->options, runner);
    free(f->bloom);
    free(f->pixels);
    free(f->out.data);
    free(f);
    return stopped;
}

/* --- the command line --- */

#define AT(field) offsetof(options, field)

static const option_row rows[] = {
    {"rounds", 'n', OPTION_COUNT, "N", AT(rounds), .low = 1, .high = 1e6, .initial = "21", .help = "of each, in turns"},
    {"size", 0, OPTION_SIZE, "WxH", AT(width), .high = PUPIL_MAX_SIDE_PX, .initial = "1920x1080",
     .help = "of the frames"},
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command bench_veil_command = {
    .name = "bench veil",
    .summary = "veiling glare: lists of lights and other ways, frames with and without",
    .usage = "[options]",
    .about = "What a veil costs, in turns in one run.",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual =
        "Lists of 1 to 10,000 lights as a Fourier series, and as a sum light by light, a convolution by FFT (with "
        "-DPUPIL_BENCH_PEERS=ON and FFTW) and a pyramid of half sizes as games have it, each with its error "
        "against the sum in double precision. Then frames that are metered and mapped with a veil and without. "
        "docs/look.md explains the figures.",
    .groups = groups,
};

int bench_veil_main(int argc, char **argv)
{
    option_words words;
    bench *b = calloc(1, sizeof *b);
    if (!b) {
        fprintf(stderr, "pupil bench veil: not enough memory\n");
        return EXIT_FAILED;
    }
    b->options = (options){.rounds = 21, .width = 1920, .height = 1080};
    int status = options_read(&bench_veil_command, &b->options, argc, argv, &words);
    if (status < 0 && words.count) {
        fprintf(stderr, "pupil bench veil: %s: it takes options only\n", words.word[0]);
        status = EXIT_USAGE;
    }
    if (status < 0) {
        interrupt_watch();
        progress_begin(&b->progress, 0, 0);
        const int failed = run_frames(b) || run_lists(b);
        progress_clear(&b->progress);
        status = interrupt_came() ? EXIT_INTERRUPTED : failed ? EXIT_FAILED : EXIT_DONE;
        if (status == EXIT_FAILED)
            fprintf(stderr, "pupil bench veil: not enough memory\n");
    }
    free(b->rgb);
    free(b->exact);
    veil_pyramid_close(b->pyramid);
    veil_fft_close(b->fft);
    free(b);
    return status;
}

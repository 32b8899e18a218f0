/* pupil bench veil: what a veil costs: lists of lights compared with alternatives, and frames with a veil compared with
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
#include "pupil/veil.h"
#include "veil_frames.h"
#include "veil_rivals.h"

/* Instructions are counted in a picture of a tenth of the size, because each stops the process once. */
enum { SIDE = 600, COUNTED_SIDE = 60, MOST_LIGHTS = 10000, COUNTS = 5 };
#define SIGMA_PX 37.5
#define PERIOD   1.25 /* of a bell that reaches 150 pixels: 750 */

typedef veil_frames_options options;

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
    progress_add(&b->progress, "%s", what);
    if (lights)
        progress_add(&b->progress, ", %zu of %d lights", lights, MOST_LIGHTS);
    progress_show(&b->progress);
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

/* The largest error of the last drawn picture, in % of the largest value. */
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

/* In the middles of pixels, which all ways represent exactly. */
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

/* The other ways, which have no harmonics. The direct sum of many lights is run once, because it takes seconds. */
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

/* The number of lights up to which the direct sum takes less time; both times are linear in it. */
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

/* --- the command line --- */

#define AT(field) offsetof(options, field)

static const option_row rows[] = {
    {"rounds", 'n', OPTION_COUNT, "N", AT(rounds), .low = 1, .high = 1e6, .initial = "21", .help = "of each, in turns"},
    {"size", 0, OPTION_SIZE, "WxH", AT(width), .high = PUPIL_MAX_SIDE_PX, .initial = "1920x1080",
     .help = "of the frames"},
    {"above", 0, OPTION_NUMBER, "LIGHT", AT(above), .high = 1e9, .initial = "4",
     .help = "of the bloom with a bright pass: what scatters"},
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command bench_veil_command = {
    .name = "bench veil",
    .summary = "veiling glare: lists of lights and other ways, frames with and without",
    .usage = "[options] [PICTURE]",
    .about = "What a veil costs, in turns in one run.",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual =
        "Lists of 1 to 10,000 lights as a Fourier series, and as a sum light by light, a convolution by FFT (with "
        "-DPUPIL_BENCH_PEERS=ON and FFTW) and a pyramid of half sizes as games have it, each with its error "
        "against the sum in double precision. Before that frames that are metered and mapped with a veil, with bloom "
        "and "
        "without: PICTURE repeated over the frame, at a log-average of 0.18, or an even one with grain; and noise, "
        "which "
        "is the worst case. "
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
    b->options = (options){.rounds = 21, .width = 1920, .height = 1080, .above = 4};
    int status = options_read(&bench_veil_command, &b->options, argc, argv, &words);
    if (status < 0 && words.count > 1) {
        fprintf(stderr, "pupil bench veil: %s: it takes one picture\n", words.word[1]);
        status = EXIT_USAGE;
    }
    b->options.picture = words.count ? words.word[0] : NULL;
    if (status < 0) {
        interrupt_watch();
        progress_begin(&b->progress, 0, 0);
        show(b, "frames", 0);
        const int frames = veil_frames_run(&b->options, &b->progress);
        const int failed = frames || run_lists(b);
        progress_clear(&b->progress);
        status = interrupt_came() ? EXIT_INTERRUPTED : failed ? EXIT_FAILED : EXIT_DONE;
        if (status == EXIT_FAILED && frames <= 0)
            fprintf(stderr, "pupil bench veil: not enough memory\n");
    }
    free(b->rgb);
    free(b->exact);
    veil_pyramid_close(b->pyramid);
    veil_fft_close(b->fft);
    free(b);
    return status;
}

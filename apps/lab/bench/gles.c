/* pupil bench gles: metering and mapping on the GPU, in turns with one thread of the CPU and with plain copies of the
 * same bytes; each speed has its error. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "common/interrupt.h"
#include "common/report_error.h"
#include "egl/egl_context.h"
#include "frames.h"
#include "gles_subject.h"
#include "source.h"
#include "subject.h"

enum { MOST_RUNNERS = 2 * BENCH_GLES_PARTS };

typedef struct options {
    uint32_t pixel;         /* 0: the usual four */
    uint32_t width, height; /* 0: the usual two */
    uint32_t version;
    unsigned frames, rounds;
    int json, quiet;
} options;

typedef struct machine {
    pupil_egl *egl;
    gl_calls gl;
    char name[300];       /* for people */
    const char *software; /* the software renderer; NULL: a GPU */
} machine;

/* --- what is given --- */

static void put_text(const char *text)
{
    putchar('"');
    for (; *text; text++)
        if (*text != '"' && *text != '\\' && (unsigned char)*text >= ' ')
            putchar(*text);
    putchar('"');
}

/* The error that belongs to a part: of the mean, of the picture, or of both. */
static int has_mean(bench_part part)
{
    return part == BENCH_GLES_METER || part == BENCH_GLES_FRAME;
}

static int has_picture(bench_part part)
{
    return part == BENCH_GLES_MAP || part == BENCH_GLES_FRAME;
}

static void tell_json(const machine *m, const bench_gles_subject *s, bench_part part, double gpu_s, double cpu_s,
                      const double copy_s[2], const bench_gles_error *e)
{
    pupil_gles_status status = {0};
    pupil_gles_get_status(&s->gles, &status);
    printf("{\"bench\":\"gles\",\"renderer\":");
    put_text(m->name);
    printf(",\"software\":%s,\"gles_version\":%.1f,\"part\":\"%s\",\"format\":\"%s\",\"width\":%lu,\"height\":%lu,"
           "\"bytes\":%zu,\"gpu_ms\":%.4f,\"gpu_ratio_copy\":%.4f",
           m->software ? "true" : "false", (double)status.version / 10.0, bench_part_names[part],
           bench_format_name(s->in.pixel), (unsigned long)s->in.width, (unsigned long)s->in.height, s->bytes,
           gpu_s * 1e3, gpu_s / copy_s[0]);
    if (cpu_s > 0.0)
        printf(",\"cpu_ms\":%.4f,\"cpu_ratio_memcpy\":%.4f,\"ratio_cpu\":%.4f", cpu_s * 1e3, cpu_s / copy_s[1],
               gpu_s / cpu_s);
    if (has_mean(part))
        printf(",\"log_average_error\":%.3g", e->log_average);
    if (has_picture(part))
        printf(",\"code_max\":%d,\"off_by_one\":%.3g", e->code, e->off);
    puts("}");
}

static void tell(const bench_gles_subject *s, bench_part part, double gpu_s, double cpu_s, const double copy_s[2],
                 const bench_gles_error *e)
{
    char size[24];
    snprintf(size, sizeof size, "%lux%lu", (unsigned long)s->in.width, (unsigned long)s->in.height);
    printf("%-8s %-10s %-9s %9.3f %7.2f", bench_format_name(s->in.pixel), size, bench_part_names[part], gpu_s * 1e3,
           gpu_s / copy_s[0]);
    if (cpu_s > 0.0)
        printf(" %9.3f %8.2f %8.2f", cpu_s * 1e3, cpu_s / copy_s[1], gpu_s / cpu_s);
    else
        printf(" %9s %8s %8s", "-", "-", "-");
    if (has_mean(part))
        printf("  %7.1e", e->log_average);
    else if (has_picture(part))
        printf("  %7s", "");
    if (has_picture(part))
        printf("  %d %.5f%%", e->code, 100.0 * e->off);
    putchar('\n');
}

/* --- measuring --- */

static int measure(const options *o, const machine *m, bench_gles_subject *s)
{
    bench_runner runner[MOST_RUNNERS];
    bench_gles_error error;
    pupil_why why;
    size_t n = 0, gpu_at[BENCH_GLES_PARTS], cpu_at[BENCH_GLES_PARTS];
    s->frames = o->frames;
    for (int part = 0; part < BENCH_GLES_PARTS; part++) {
        bench_gles_run *const gpu = bench_gles_gpu(s, (bench_part)part), *const cpu = bench_gles_cpu((bench_part)part);
        gpu_at[part] = cpu_at[part] = MOST_RUNNERS;
        if (!gpu)
            continue;
        runner[gpu_at[part] = n++] = (bench_runner){.run = gpu, .context = s};
        if (cpu)
            runner[cpu_at[part] = n++] = (bench_runner){.run = cpu, .context = s};
    }
    if (bench_gles_compare(s, &error, &why)) { /* warms everything up, too */
        report_error("pupil bench", &why, "");
        return BENCH_FAILED;
    }
    if (bench_race(runner, n, o->rounds, NULL, interrupt_came))
        return interrupt_came() ? BENCH_INTERRUPTED : BENCH_FAILED;
    if (s->error) {
        fprintf(stderr, "pupil bench: %s\n", pupil_error_string(s->error));
        return BENCH_FAILED;
    }
    const double copy_s[2] = {runner[gpu_at[BENCH_GLES_COPY]].median_s / o->frames,
                              runner[cpu_at[BENCH_GLES_COPY]].median_s};
    for (int part = 0; part < BENCH_GLES_PARTS; part++) {
        if (gpu_at[part] == MOST_RUNNERS)
            continue;
        const double gpu_s = runner[gpu_at[part]].median_s / o->frames;
        const double cpu_s = cpu_at[part] == MOST_RUNNERS ? 0.0 : runner[cpu_at[part]].median_s;
        if (o->json)
            tell_json(m, s, (bench_part)part, gpu_s, cpu_s, copy_s, &error);
        else
            tell(s, (bench_part)part, gpu_s, cpu_s, copy_s, &error);
    }
    fflush(stdout);
    return BENCH_DONE;
}

static int measure_format(const options *o, const machine *m, uint32_t pixel, uint32_t width, uint32_t height)
{
    static bench_gles_subject s; /* large for a stack */
    pupil_why why;
    int status = BENCH_FAILED;
    if (!o->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "measuring %s ...\r", bench_format_name(pixel));
    if (bench_gles_open(&s, &m->gl, pupil_egl_get_proc, o->version, pixel, width, height, &why))
        fprintf(stderr, "pupil bench: %s: %s\n", bench_format_name(pixel), why.text);
    else
        status = measure(o, m, &s);
    bench_gles_close(&s);
    return status;
}

static int measure_all(const options *o, const machine *m)
{
    static const uint32_t usual[] = {PUPIL_PIXEL_RGBA32F, PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_NV12, PUPIL_PIXEL_BAYER10};
    static const uint32_t size[2][2] = {{1920, 1080}, {3840, 2160}};
    int status = BENCH_DONE;
    if (!o->json)
        printf("%s\n%s%s%s%u frame%s before each wait, medians of %u rounds in turns with one thread of the CPU;\n"
               "errors against the CPU: of the log-average (relative), of display samples (codes, share that is off)\n"
               "format   size       part         GPU ms   /copy    CPU ms  /memcpy  GPU/CPU  error\n",
               m->name, m->software ? "no GPU: this is " : "", m->software ? m->software : "",
               m->software ? ", a software renderer\n" : "", o->frames, o->frames > 1 ? "s" : "", o->rounds);
    for (unsigned i = 0; i < (o->width ? 1 : 2) && !status; i++)
        for (unsigned f = 0; f < (o->pixel ? 1 : sizeof usual / sizeof usual[0]) && !status; f++)
            status = measure_format(o, m, o->pixel ? o->pixel : usual[f], o->width ? o->width : size[i][0],
                                    o->height ? o->height : size[i][1]);
    return status;
}

/* --- the command line --- */

static int parse_size(const option_value *v)
{
    options *o = v->options;
    if (option_take(v))
        return OPTIONS_USAGE;
    return o->width % 4 == 0 && o->height % 2 == 0 ? OPTIONS_RUN
                                                   : option_refuse(v, "a multiple of 4 by an even number");
}

static int parse_format(const option_value *v)
{
    options *o = v->options;
    o->pixel = bench_format_named(v->text);
    return o->pixel ? OPTIONS_RUN : option_refuse(v, NULL);
}

#define AT(field) offsetof(options, field)

static const option_row rows[] = {
    {"format", 0, OPTION_CHOICE, "NAME", 0, .parse = parse_format, .words = BENCH_FORMAT_WORDS,
     .help = "one input format (rgba32f, rgba16f, nv12, bayer10)"},
    {"size", 0, OPTION_SIZE, "WxH", AT(width), .high = PUPIL_MAX_SIDE_PX, .parse = parse_size,
     .help = "of the frames (1920x1080, then 3840x2160)"},
    {"frames", 0, OPTION_COUNT32, "N", AT(frames), .low = 1, .high = 1000,
     .help = "frames back to back on the GPU before each wait (8; software: 1)"},
    {"rounds", 0, OPTION_COUNT32, "N", AT(rounds), .low = 1, .high = 10000,
     .help = "each is run N times; the median counts (7; software: 3)"},
    {"gles-version", 0, OPTION_CHOICE, "3.0|3.1", AT(version), .low = PUPIL_GLES_ES30,
     .help = "version of OpenGL ES (the best one)"},
    OPTION_ROW_JSON(options, json, "one object a line for each part"),
    OPTION_ROW_QUIET(options, quiet),
};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command bench_gles_command = {
    .name = "bench gles",
    .summary = "the same on the GPU, compared with the CPU and a plain copy; their errors",
    .usage = "[options]",
    .about = "Frames on the GPU, in turns with one thread of the CPU and with plain copies.",
    .exits = "0 done, 1 failed, 2 usage, 130 interrupted",
    .manual = "Measures frames on the GPU in turns with one thread of the CPU, each relative to a plain copy of the "
              "same bytes: texture to texture, and memcpy. Parts: copy, upload (into textures), meter, histogram "
              "(metering with it; ES 3.1), map, frame (all but the histogram). Errors are against the CPU. Where the "
              "renderer is software, a line says so.",
    .instead = "choose formats by --format",
    .groups = groups,
};

int bench_gles_main(int argc, char **argv)
{
    options o = {0};
    static machine m;
    pupil_why why;
    option_words words;
    int status = options_read(&bench_gles_command, &o, argc, argv, &words);
    if (status >= 0)
        return status;
    interrupt_watch();
    const pupil_egl_options context = {.version = o.version};
    if (pupil_egl_open(&m.egl, &context, &why) || gl_calls_load(&m.gl, pupil_egl_get_proc, &why)) {
        report_error("pupil bench", &why, "");
        pupil_egl_close(m.egl);
        return BENCH_FAILED;
    }
    pupil_egl_describe(m.name, sizeof m.name);
    m.software = gl_calls_software(&m.gl);
    o.frames = o.frames ? o.frames : m.software ? 1 : 8; /* software is no faster for many: a minute */
    o.rounds = o.rounds ? o.rounds : m.software ? 3 : 7;
    status = measure_all(&o, &m);
    pupil_egl_close(m.egl);
    return status;
}

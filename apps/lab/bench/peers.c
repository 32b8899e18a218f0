/* pupil bench kernels --peers: pupil's fused and exact mapping in turns with what a user could use instead, on the same
 * frame. */
#include "peers.h"

#include <stdio.h>
#include <string.h>

#include "clock.h"
#include "common/interrupt.h"
#include "plain.h"
#include "subject.h"

enum { ROUNDS = 15, OWN = 2 * PUPIL_LEVEL_COUNT, PLAIN = 2, PEERS = 4, MOST_RUNNERS = 2 + OWN + PLAIN + PEERS };

static const bench_peer *const peers[PEERS] = {&bench_peer_opencv, &bench_peer_ffmpeg, &bench_peer_ffmpeg_least,
                                               &bench_peer_libplacebo};

typedef struct plain_job {
    const bench_subject *s;
    bench_plain *loop;
} plain_job;

typedef struct peer_race {
    const bench_options *o;
    bench_subject s;
    bench_kernel kernel[OWN];
    plain_job plain[PLAIN];
    const bench_peer *peer[PEERS]; /* those that opened, */
    void *state[PEERS];            /* and what they opened */
    bench_runner runner[MOST_RUNNERS];
    size_t own, plains, opened; /* numbers of runners: 2, own, plains, opened */
} peer_race;

static void run_plain(void *context)
{
    const plain_job *j = context;
    j->loop(j->s->in.data, (size_t)j->s->in.width * j->s->in.height, 4.0f, j->s->out.data);
}

static void line_up(peer_race *r)
{
    static bench_plain *const loops[PLAIN] = {bench_plain_usual, bench_plain_fast};
    bench_runner *next = r->runner;
    pupil_why why;
    *next++ = (bench_runner){.run = bench_read_run, .context = &r->s};
    *next++ = (bench_runner){.run = bench_copy_run, .context = &r->s};
    for (uint32_t level = 0; level < PUPIL_LEVEL_COUNT; level++)
        for (int which = BENCH_FUSED; which <= BENCH_EXACT; which++)
            if (!bench_kernel_open(&r->kernel[r->own], &r->s, (bench_which)which, level))
                *next++ = (bench_runner){.run = bench_kernel_run, .context = &r->kernel[r->own++]};
    for (; r->plains < PLAIN; r->plains++) {
        r->plain[r->plains] = (plain_job){&r->s, loops[r->plains]};
        *next++ = (bench_runner){.run = run_plain, .context = &r->plain[r->plains]};
    }
    for (size_t i = 0; i < PEERS; i++) {
        void *state = peers[i]->open(r->s.in.data, r->s.in.width, r->s.in.height, &why);
        if (state) {
            r->peer[r->opened] = peers[i];
            r->state[r->opened++] = state;
            *next++ = (bench_runner){.run = peers[i]->run, .context = state};
        } else {
            fprintf(stderr, "pupil bench: %s: %s\n", peers[i]->name, why.text);
        }
    }
}

static void tell_json(const peer_race *r, const char *name, const char *level, const char *out, const bench_runner *one,
                      double mean)
{
    const bench_options *o = r->o;
    const bench_runner *fused = &r->runner[2];
    printf(
        "{\"bench\":\"peers\",\"kernel\":\"%s\",\"level\":\"%s\",\"format\":\"rgba32f\",\"out\":\"%s\",\"width\":%lu,"
        "\"height\":%lu,\"threads\":1,\"cold\":%s,\"ns_per_px\":%.4f,\"bytes_per_px\":16,\"ratio_read\":%.4f,"
        "\"ratio_memcpy\":%.4f,\"mean_code\":%.1f",
        name, level, out, (unsigned long)o->width, (unsigned long)o->height, o->warm ? "false" : "true",
        one->median_s * 1e9 / ((double)o->width * o->height), one->median_s / r->runner[0].median_s,
        one->median_s / r->runner[1].median_s, mean);
    for (size_t i = 0; i < r->own; i++)
        printf(",\"ratio_%s_%s\":%.4f", bench_kernel_names[r->kernel[i].which], bench_level_names[r->kernel[i].level],
               one->median_s / fused[i].median_s);
    puts("}");
}

static void tell(const peer_race *r, const char *name, const char *level, const char *out, const bench_runner *one,
                 double mean)
{
    const bench_options *o = r->o;
    if (o->json) {
        tell_json(r, name, level, out, one, mean);
        return;
    }
    printf("%-11s %-7s %8.3f %7.2f %9.2f %6.1f", name, level, one->median_s * 1e9 / ((double)o->width * o->height),
           one->median_s / r->runner[0].median_s, one->median_s / r->runner[1].median_s, mean);
    for (size_t i = 0; i < r->own; i++)
        printf(" %*.2f", (int)strlen(bench_level_names[r->kernel[i].level]) + 7,
               one->median_s / r->runner[2 + i].median_s);
    putchar('\n');
}

static double mean_green(const bench_subject *s)
{
    const uint8_t *rgba = s->out.data;
    const size_t pixels = (size_t)s->in.width * s->in.height;
    double sum = 0.0;
    for (size_t i = 0; i < pixels; i++)
        sum += rgba[4 * i + 1];
    return sum / (double)pixels;
}

static void tell_all(peer_race *r)
{
    bench_runner *next = &r->runner[2];
    if (!r->o->json) {
        printf("RGBA float, %lux%lu, 1 thread, %s, median of %u rounds in turns; times as long as pupil's fused and "
               "exact\n%-11s %-7s %8s %7s %9s %6s",
               (unsigned long)r->o->width, (unsigned long)r->o->height, r->o->warm ? "warm" : "cold",
               r->o->rounds ? r->o->rounds : ROUNDS, "", "level", "ns/px", "/read", "/memcpy", "mean");
        for (size_t i = 0; i < r->own; i++)
            printf(" /%s-%s", bench_level_names[r->kernel[i].level], bench_kernel_names[r->kernel[i].which]);
        putchar('\n');
    }
    /* once more, for their picture */
    for (size_t i = 0; i < r->own; i++, next++) {
        bench_kernel_run(&r->kernel[i]);
        tell(r, bench_kernel_names[r->kernel[i].which], bench_level_names[r->kernel[i].level], "rgba8", next,
             mean_green(&r->s));
    }
    for (size_t i = 0; i < r->plains; i++, next++) {
        run_plain(&r->plain[i]);
        tell(r, i ? "plain-fast" : "plain", "C", "rgba8", next, mean_green(&r->s));
    }
    for (size_t i = 0; i < r->opened; i++, next++)
        tell(r, r->peer[i]->name, "peer", r->peer[i]->out, next, r->peer[i]->mean(r->state[i]));
    for (size_t i = 0; i < r->opened && !r->o->json; i++)
        printf("%s%-10s  %s\n", i ? "" : "\n", r->peer[i]->name, r->peer[i]->does);
}

static int race(peer_race *r, const bench_flush *flush)
{
    line_up(r);
    const size_t n = 2 + r->own + r->plains + r->opened;
    if (bench_race(r->runner, n, r->o->rounds ? r->o->rounds : ROUNDS, flush, interrupt_came))
        return interrupt_came() ? BENCH_INTERRUPTED : BENCH_FAILED;
    tell_all(r);
    fflush(stdout);
    return BENCH_DONE;
}

int bench_peers(const bench_options *o, workers *crew, const bench_flush *flush)
{
    static peer_race r; /* one run per process; the kernels are too large for a stack */
    int status = BENCH_FAILED;
    r.o = o;
    if (!bench_subject_open(&r.s, o, PUPIL_PIXEL_RGBA32F, crew))
        status = race(&r, flush);
    for (size_t i = 0; i < r.opened; i++)
        r.peer[i]->close(r.state[i]);
    bench_subject_close(&r.s);
    return status;
}

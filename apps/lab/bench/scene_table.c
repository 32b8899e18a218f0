/* The results of `pupil bench scene`, for a terminal and as JSON. */
#include <string.h>

#include "scene_cost.h"

#define MB 1e-6

double bench_scene_total_s(const bench_scene *s)
{
    return s->load_s + s->prepare_s + s->frames_s;
}

/* A sum reads the picture of every light and writes one; a memcpy of a picture reads one and writes one. */
static double picture_bytes(const bench_scene *s)
{
    return (double)s->width * s->height * 3.0 * sizeof(float);
}

static double sum_bytes(const bench_scene *s)
{
    return picture_bytes(s) * ((double)s->lights + 1.0);
}

static double per_byte(const bench_scene *s, const bench_sums *t)
{
    return t->sum_s / t->copy_s * 2.0 * picture_bytes(s) / sum_bytes(s);
}

/* --- JSON --- */

/* A string by RFC 8259 (JSON). */
static void quoted(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++)
        if ((unsigned char)*text < 0x20 || *text == '"' || *text == '\\')
            fprintf(out, "\\u%04x", (unsigned)(unsigned char)*text);
        else
            fputc(*text, out);
    fputc('"', out);
}

static void json_sums(FILE *out, const bench_scene *s, const char *name, const bench_sums *t)
{
    fprintf(out, ",\"%s\":{\"sum_us\":%.2f,\"memcpy_us\":%.2f,\"read_us\":%.2f,\"ratio_memcpy\":%.4f,", name,
            t->sum_s * 1e6, t->copy_s * 1e6, t->read_s * 1e6, t->sum_s / t->copy_s);
    fprintf(out, "\"ratio_memcpy_per_byte\":%.4f,\"ratio_read\":%.4f}", per_byte(s, t), t->sum_s / t->read_s);
}

void bench_scene_json(FILE *out, const bench_scene *s)
{
    fputs("{\"bench\":\"scene\",\"scene\":", out);
    quoted(out, s->name);
    fprintf(out, ",\"width\":%lu,\"height\":%lu,\"threads\":%u,\"frames\":%llu,\"lights\":%llu",
            (unsigned long)s->width, (unsigned long)s->height, s->threads, (unsigned long long)s->frames,
            (unsigned long long)s->lights);
    fprintf(out, ",\"load_s\":%.4f,\"renders_s\":%.4f,\"render_of_each_s\":[", s->load_s, s->prepare_s);
    for (uint64_t i = 0; i < s->lights; i++)
        fprintf(out, "%s%.4f", i ? "," : "", s->light_s[i]);
    fprintf(out, "],\"frames_s\":%.4f,\"sums_s\":%.4f,\"total_s\":%.4f,\"renders_every_frame_extrapolated_s\":%.1f",
            s->frames_s, s->sums_s, bench_scene_total_s(s), s->load_s + s->prepare_s * (double)s->frames);
    fprintf(out, ",\"sum_bytes\":%.0f,\"memcpy_bytes\":%.0f,\"read_bytes\":%.0f", sum_bytes(s), 2.0 * picture_bytes(s),
            sum_bytes(s) - picture_bytes(s));
    json_sums(out, s, "warm", &s->warm);
    json_sums(out, s, "cold", &s->cold);
    fprintf(out, ",\"image_bytes\":%llu,\"geometry_bytes\":%llu,\"peak_bytes\":%llu}\n",
            (unsigned long long)s->image_bytes, (unsigned long long)s->geometry_bytes,
            (unsigned long long)s->peak_bytes);
}

/* --- tables --- */

static int widest(const bench_scene *s, size_t scenes)
{
    size_t most = 5;
    for (size_t i = 0; i < scenes; i++)
        most = strlen(s[i].name) > most ? strlen(s[i].name) : most;
    return (int)most;
}

static void table_of_renders(FILE *out, const bench_scene *s, size_t scenes, int width)
{
    fprintf(out, "Renders at %lux%lu, %u threads: the picture of every light, once\n", (unsigned long)s->width,
            (unsigned long)s->height, s->threads);
    fprintf(out, "%-*s  load s  all lights s  images MB  geometry MB  peak MB  each light alone s\n", width, "scene");
    for (size_t i = 0; i < scenes; i++) {
        fprintf(out, "%-*s  %6.2f  %12.2f  %9.1f  %11.1f  %7.1f ", width, s[i].name, s[i].load_s, s[i].prepare_s,
                (double)s[i].image_bytes * MB, (double)s[i].geometry_bytes * MB, (double)s[i].peak_bytes * MB);
        for (uint64_t k = 0; k < s[i].lights; k++)
            fprintf(out, " %.2f", s[i].light_s[k]);
        fputc('\n', out);
    }
}

static void row_of_sums(FILE *out, const bench_scene *s, int width, const char *caches, const bench_sums *t)
{
    fprintf(out, "%-*s  %6llu  %6s  %6.0f  %9.0f  %7.0f  %6.1f  %9.1f  %7.2f  %8.2f  %5.2f\n", width, s->name,
            (unsigned long long)s->lights, caches, t->sum_s * 1e6, t->copy_s * 1e6, t->read_s * 1e6, sum_bytes(s) * MB,
            2.0 * picture_bytes(s) * MB, t->sum_s / t->copy_s, per_byte(s, t), t->sum_s / t->read_s);
}

static void table_of_sums(FILE *out, const bench_scene *s, size_t scenes, int width)
{
    fputs("\nA sum of all lights (reads each, writes one), a memcpy of one picture, a plain read of all, in turns\n"
          "on one thread; the sum over the memcpy, over the memcpy by the byte moved, over the read\n",
          out);
    fprintf(out, "%-*s  lights  caches  sum us  memcpy us  read us  sum MB  memcpy MB  /memcpy  per byte  /read\n",
            width, "scene");
    for (size_t i = 0; i < scenes; i++) {
        row_of_sums(out, &s[i], width, "warm", &s[i].warm);
        row_of_sums(out, &s[i], width, "cold", &s[i].cold);
    }
}

static void table_of_sequences(FILE *out, const bench_scene *s, size_t scenes, int width)
{
    fprintf(out, "\nA sequence of %llu frames, measured to its end; and extrapolated, were every frame rendered\n",
            (unsigned long long)s->frames);
    fprintf(out, "%-*s  load + renders + frames = total s  sums alone s  frames/sums  extrapolated s\n", width,
            "scene");
    for (size_t i = 0; i < scenes; i++)
        fprintf(out, "%-*s  %4.2f  %8.2f  %7.2f  %8.2f  %12.2f  %11.2f  %14.0f\n", width, s[i].name, s[i].load_s,
                s[i].prepare_s, s[i].frames_s, bench_scene_total_s(&s[i]), s[i].sums_s, s[i].frames_s / s[i].sums_s,
                s[i].load_s + s[i].prepare_s * (double)s[i].frames);
    for (size_t i = 0; i < scenes; i++)
        if (s[i].frames_s > 1.1 * s[i].sums_s)
            fprintf(out, "%s: %.2f s of its frames are not sums: its sensor, or another task of the machine\n",
                    s[i].name, s[i].frames_s - s[i].sums_s);
}

void bench_scene_table(FILE *out, const bench_scene *s, size_t scenes)
{
    int width = widest(s, scenes);
    table_of_renders(out, s, scenes, width);
    table_of_sums(out, s, scenes, width);
    table_of_sequences(out, s, scenes, width);
}

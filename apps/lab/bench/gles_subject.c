#include "gles_subject.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "frames.h"
#include "refuse.h"

/* A minute: a software renderer may take seconds for a round; a GPU that needs longer hangs. */
#define WAIT_NS UINT64_C(60000000000)

const char *const bench_part_names[BENCH_GLES_PARTS] = {"copy", "upload", "meter", "histogram", "map", "frame"};

static void note(bench_gles_subject *s, int error)
{
    if (error < 0 && !s->error)
        s->error = error;
}

/* --- on the GPU --- */

static void wait_for_all(bench_gles_subject *s)
{
    GLsync fence = s->gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence || s->gl->ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, WAIT_NS) == GL_WAIT_FAILED)
        note(s, PUPIL_ERR_GLES);
    s->gl->DeleteSync(fence);
}

static void copy_on_gpu(void *context)
{
    bench_gles_subject *s = context;
    s->gl->BindFramebuffer(GL_FRAMEBUFFER, s->copied_framebuffer);
    s->gl->ActiveTexture(GL_TEXTURE0);
    s->gl->BindTexture(GL_TEXTURE_2D, s->texture[1]);
    s->gl->Disable(GL_SCISSOR_TEST);
    for (unsigned i = 0; i < s->frames; i++)
        s->gl->CopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, s->copy_width, s->copy_height);
    wait_for_all(s);
}

static void upload_on_gpu(void *context)
{
    bench_gles_subject *s = context;
    for (unsigned i = 0; i < s->frames; i++)
        note(s, pupil_gles_upload(&s->gles, &s->in));
    wait_for_all(s);
}

/* At most three frames are in flight: while the oldest is waited for, the GPU has two more to do. */
static void meter_all(bench_gles_subject *s, pupil_gles *gles)
{
    unsigned got = 0;
    for (unsigned i = 0; i < s->frames; i++) {
        if (i - got == 3 && pupil_gles_collect(gles, WAIT_NS, &s->stats, NULL) == PUPIL_OK)
            got++;
        note(s, pupil_gles_meter(gles, NULL) == PUPIL_OK ? PUPIL_OK : PUPIL_ERR_GLES);
    }
    for (; got < s->frames && !s->error; got++)
        note(s, pupil_gles_collect(gles, WAIT_NS, &s->stats, NULL) == PUPIL_OK ? PUPIL_OK : PUPIL_ERR_GLES);
}

static void meter_on_gpu(void *context)
{
    bench_gles_subject *s = context;
    meter_all(s, &s->gles);
}

static void count_on_gpu(void *context)
{
    bench_gles_subject *s = context;
    meter_all(s, &s->gles_counting);
}

static pupil_gles_target target_of(const bench_gles_subject *s)
{
    return (pupil_gles_target){.framebuffer = s->framebuffer,
                               .width = s->in.width,
                               .height = s->in.height,
                               .top_first = 1,
                               .fit = PUPIL_GLES_STRETCH};
}

static void map_on_gpu(void *context)
{
    bench_gles_subject *s = context;
    const pupil_gles_target target = target_of(s);
    for (unsigned i = 0; i < s->frames; i++)
        note(s, pupil_gles_map(&s->gles, &s->curve, &target));
    wait_for_all(s);
}

static void frame_on_gpu(void *context)
{
    bench_gles_subject *s = context;
    const pupil_gles_target target = target_of(s);
    for (unsigned i = 0; i < s->frames; i++) {
        note(s, pupil_gles_upload(&s->gles, &s->in));
        note(s, pupil_gles_process(&s->gles, &s->plain, NULL, &target));
    }
    wait_for_all(s);
    while (pupil_gles_collect(&s->gles, WAIT_NS, &s->stats, NULL) == PUPIL_OK) /* the next part begins with none in
                                                                                * flight */
        ;
}

bench_gles_run *bench_gles_gpu(const bench_gles_subject *s, bench_part part)
{
    static bench_gles_run *const run[BENCH_GLES_PARTS] = {copy_on_gpu,  upload_on_gpu, meter_on_gpu,
                                                          count_on_gpu, map_on_gpu,    frame_on_gpu};
    return part == BENCH_GLES_HISTOGRAM && !s->open_counting ? NULL : run[part];
}

/* --- on the CPU --- */

static void copy_on_cpu(void *context)
{
    bench_gles_subject *s = context;
    memcpy(s->copy, s->in.data, s->bytes);
}

static void meter(bench_gles_subject *s, const pupil_t *pupil)
{
    pupil_stats_clear(&s->stats);
    note(s, pupil_meter_rows(pupil, &s->in, 0, s->in.height, &s->stats));
}

static void meter_on_cpu(void *context)
{
    bench_gles_subject *s = context;
    meter(s, &s->plain);
}

static void count_on_cpu(void *context)
{
    bench_gles_subject *s = context;
    meter(s, &s->counting);
}

static void map_on_cpu(void *context)
{
    bench_gles_subject *s = context;
    note(s, pupil_map_rows(&s->plain, &s->curve, &s->in, &s->cpu_out));
}

static void frame_on_cpu(void *context)
{
    meter_on_cpu(context);
    map_on_cpu(context);
}

bench_gles_run *bench_gles_cpu(bench_part part)
{
    static bench_gles_run *const run[BENCH_GLES_PARTS] = {copy_on_cpu,  NULL,       meter_on_cpu,
                                                          count_on_cpu, map_on_cpu, frame_on_cpu};
    return run[part];
}

/* --- opening --- */

/* As many bytes as a frame has, in texels of four bytes and rows that every driver takes. */
static void make_copy(bench_gles_subject *s)
{
    const gl_calls *gl = s->gl;
    s->copy_width = s->bytes > (size_t)64 << 20 ? 8192 : s->bytes > 16384 ? 4096 : 64;
    s->copy_height = (GLsizei)((s->bytes / 4 + (size_t)s->copy_width - 1) / (size_t)s->copy_width);
    gl->GenTextures(2, s->texture);
    gl->ActiveTexture(GL_TEXTURE0);
    for (int i = 1; i >= 0; i--) {
        gl->BindTexture(GL_TEXTURE_2D, s->texture[i]);
        gl->TexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, s->copy_width, s->copy_height);
    }
    gl->GenFramebuffers(1, &s->copied_framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, s->copied_framebuffer);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, s->texture[0], 0);
    gl->ClearColor(0.25f, 0.5f, 0.75f, 1.0f);
    gl->Clear(GL_COLOR_BUFFER_BIT); /* so that the driver cannot skip an empty texture */
}

static void make_target(bench_gles_subject *s)
{
    const gl_calls *gl = s->gl;
    gl->GenRenderbuffers(1, &s->renderbuffer);
    gl->BindRenderbuffer(GL_RENDERBUFFER, s->renderbuffer);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, (GLsizei)s->in.width, (GLsizei)s->in.height);
    gl->GenFramebuffers(1, &s->framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, s->framebuffer);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, s->renderbuffer);
}

static int open_frame(bench_gles_subject *s, uint32_t pixel, uint32_t width, uint32_t height)
{
    pupil_config c;
    s->in = bench_frame(pixel, width, height, 0);
    s->bytes = bench_frame_bytes(pixel, width, height);
    s->copy = calloc(s->bytes, 1);
    s->cpu_out = bench_room(PUPIL_PIXEL_RGBA8, width, height);
    s->gpu_out = bench_room(PUPIL_PIXEL_RGBA8, width, height);
    if (!s->in.data || !s->copy || !s->cpu_out.data || !s->gpu_out.data)
        return -1;
    pupil_config_default(&c);
    pupil_init(&s->counting, &c); /* a following white point needs the histogram */
    c.white_mode = PUPIL_WHITE_FIXED;
    c.white = 4.0;
    pupil_init(&s->plain, &c);
    note(s, pupil_process(&s->plain, &s->in, NULL, &s->cpu_out));
    note(s, pupil_get_curve(&s->plain, NULL, &s->curve));
    return s->error;
}

int bench_gles_open(bench_gles_subject *s, const gl_calls *gl, pupil_gles_get_proc get_proc, uint32_t version,
                    uint32_t pixel, uint32_t width, uint32_t height, pupil_why *why)
{
    pupil_gles_config config;
    pupil_why reason = {""};
    memset(s, 0, sizeof *s);
    s->gl = gl;
    if (open_frame(s, pixel, width, height))
        return pupil_refuse(why, "no memory for frames of %lux%lu pixels", (unsigned long)width, (unsigned long)height);
    pupil_gles_config_default(&config);
    config.version = version;
    config.pixel = pixel;
    config.width = width;
    config.height = height;
    if (s->in.coding)
        config.coding = s->in.coding;
    int error = pupil_gles_init(&s->gles, &config, &s->plain, get_proc, &reason);
    if (error)
        return pupil_refuse(why, "%s", *reason.text ? reason.text : pupil_error_string(error));
    s->open = 1;
    s->open_counting = pupil_gles_init(&s->gles_counting, &config, &s->counting, get_proc, NULL) == PUPIL_OK;
    if (s->open_counting)
        note(s, pupil_gles_upload(&s->gles_counting, &s->in));
    note(s, pupil_gles_upload(&s->gles, &s->in));
    make_copy(s);
    make_target(s);
    const GLenum refused = gl->GetError();
    if (refused || s->error)
        return pupil_refuse(why, "the driver refuses textures of %lux%lu pixels (OpenGL ES error 0x%x)",
                            (unsigned long)width, (unsigned long)height, (unsigned)refused);
    return 0;
}

void bench_gles_close(bench_gles_subject *s)
{
    if (s->open)
        pupil_gles_close(&s->gles);
    if (s->open_counting)
        pupil_gles_close(&s->gles_counting);
    s->gl->DeleteFramebuffers(1, &s->framebuffer);
    s->gl->DeleteFramebuffers(1, &s->copied_framebuffer);
    s->gl->DeleteRenderbuffers(1, &s->renderbuffer);
    s->gl->DeleteTextures(2, s->texture);
    free(s->gpu_out.data);
    free(s->cpu_out.data);
    free(s->copy);
    free((void *)(uintptr_t)s->in.data);
}

/* --- errors --- */

int bench_gles_compare(bench_gles_subject *s, bench_gles_error *error, pupil_why *why)
{
    double cpu = 0.0, gpu = 0.0;
    uint64_t off = 0, samples = 0;
    const unsigned frames = s->frames;
    *error = (bench_gles_error){0};
    meter_on_cpu(s);
    note(s, pupil_stats_mean(&s->stats, 0.0, 1.0, &cpu));
    s->frames = 1;
    upload_on_gpu(s);
    meter_on_gpu(s);
    note(s, pupil_stats_mean(&s->stats, 0.0, 1.0, &gpu));
    map_on_cpu(s);
    map_on_gpu(s);
    s->frames = frames;
    s->gl->BindFramebuffer(GL_FRAMEBUFFER, s->framebuffer);
    s->gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    s->gl->ReadPixels(0, 0, (GLsizei)s->in.width, (GLsizei)s->in.height, GL_RGBA, GL_UNSIGNED_BYTE, s->gpu_out.data);
    if (s->error || s->gl->GetError())
        return pupil_refuse(why, "%s", pupil_error_string(s->error ? s->error : PUPIL_ERR_GLES));
    const unsigned char *a = s->cpu_out.data, *b = s->gpu_out.data;
    for (size_t i = 0; i < (size_t)s->in.width * s->in.height * 4; i++) {
        if (i % 4 == 3)
            continue; /* alpha is not light */
        const int apart = abs(a[i] - b[i]);
        error->code = apart > error->code ? apart : error->code;
        off += apart != 0;
        samples++;
    }
    error->off = (double)off / (double)samples;
    error->log_average = exp2(fabs(gpu - cpu)) - 1.0;
    return 0;
}

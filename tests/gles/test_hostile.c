/* GL state left by a caller changes nothing: every call is made in the worst state, and gives the same bits as in a new
 * context. */
#include "session.h"

#define WIDTH  38
#define HEIGHT 22
#define FRAMES 4
#define UNITS  8 /* more than are in use */

/* Objects of the caller's. */
typedef struct rubbish {
    GLuint buffer, vertex_array, sampler, texture, feedback, program, framebuffer, query;
} rubbish;

static session s;

static GLuint caller_program(void)
{
    static const char *const vertex = "#version 300 es\nin vec4 p; void main() { gl_Position = p; }";
    static const char *const fragment = "#version 300 es\nout highp vec4 c; void main() { c = vec4(1.0); }";
    const GLuint program = glCreateProgram();
    const char *const *const texts[2] = {&vertex, &fragment};
    for (int i = 0; i < 2; i++) {
        const GLuint shader = glCreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        glShaderSource(shader, 1, texts[i], NULL);
        glCompileShader(shader);
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    return program;
}

static rubbish rubbish_make(void)
{
    rubbish r = {.program = caller_program()};
    glGenBuffers(1, &r.buffer);
    glGenVertexArrays(1, &r.vertex_array);
    glGenSamplers(1, &r.sampler);
    glGenTextures(1, &r.texture);
    glGenTransformFeedbacks(1, &r.feedback);
    glGenFramebuffers(1, &r.framebuffer);
    glGenQueries(1, &r.query);
    glBindBuffer(GL_ARRAY_BUFFER, r.buffer);
    glBufferData(GL_ARRAY_BUFFER, 64, NULL, GL_STATIC_DRAW);
    glSamplerParameteri(r.sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glSamplerParameteri(r.sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(r.sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(r.sampler, GL_TEXTURE_COMPARE_FUNC, GL_NEVER);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, r.texture);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_R8, 1, 1);
    glBindFramebuffer(GL_FRAMEBUFFER, r.framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, r.texture, 0);
    glDrawBuffers(1, (const GLenum[]){GL_NONE});
    glReadBuffer(GL_NONE);
    return r;
}

static void rubbish_free(const rubbish *r)
{
    glDeleteBuffers(1, &r->buffer);
    glDeleteVertexArrays(1, &r->vertex_array);
    glDeleteSamplers(1, &r->sampler);
    glDeleteTextures(1, &r->texture);
    glDeleteTransformFeedbacks(1, &r->feedback);
    glDeleteFramebuffers(1, &r->framebuffer);
    glDeleteQueries(1, &r->query);
    glDeleteProgram(r->program);
}

static void set_switches(void)
{
    static const GLenum on[] = {GL_BLEND,
                                GL_DEPTH_TEST,
                                GL_STENCIL_TEST,
                                GL_CULL_FACE,
                                GL_SCISSOR_TEST,
                                GL_DITHER,
                                GL_POLYGON_OFFSET_FILL,
                                GL_RASTERIZER_DISCARD,
                                GL_SAMPLE_ALPHA_TO_COVERAGE,
                                GL_SAMPLE_COVERAGE,
                                GL_PRIMITIVE_RESTART_FIXED_INDEX};
    for (size_t i = 0; i < sizeof on / sizeof *on; i++)
        glEnable(on[i]);
    if (session_has_31()) {
        glEnable(GL_SAMPLE_MASK);
        glSampleMaski(0, 0);
    }
    glSampleCoverage(0.0f, GL_FALSE);
    glBlendFunc(GL_ZERO, GL_ONE);
    glDepthFunc(GL_NEVER);
    glStencilFunc(GL_NEVER, 0, 0);
    glCullFace(GL_FRONT_AND_BACK);
    glScissor(1, 1, 1, 1);
    glViewport(3, 3, 1, 1);
    glClearColor(0.5f, 0.5f, 0.5f, 0.5f);
    glColorMask(GL_FALSE, GL_FALSE, GL_TRUE, GL_FALSE);
    glDepthRangef(1.0f, 1.0f);
}

static void set_pixels(const rubbish *r)
{
    static const GLenum skips[] = {GL_UNPACK_SKIP_ROWS,    GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES,
                                   GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_ROW_LENGTH,  GL_PACK_SKIP_ROWS,
                                   GL_PACK_SKIP_PIXELS,    GL_PACK_ROW_LENGTH};
    for (size_t i = 0; i < sizeof skips / sizeof *skips; i++)
        glPixelStorei(skips[i], 1000);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
    glPixelStorei(GL_PACK_ALIGNMENT, 8);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, r->buffer);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, r->buffer);
}

static void set_bindings(const rubbish *r)
{
    static const GLenum targets[] = {GL_ARRAY_BUFFER, GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, GL_UNIFORM_BUFFER,
                                     GL_TRANSFORM_FEEDBACK_BUFFER};
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
        glBindBuffer(targets[i], r->buffer);
    for (GLuint i = 0; i < 4; i++)
        glBindBufferBase(GL_UNIFORM_BUFFER, i, r->buffer);
    for (GLuint i = 0; i < 2 && session_has_31(); i++)
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, r->buffer);
    glBindVertexArray(r->vertex_array);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, (const void *)1024); /* behind the buffer's end */
    glVertexAttribDivisor(0, 1);
    for (GLuint i = 0; i < UNITS; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        glBindTexture(GL_TEXTURE_2D, r->texture);
        glBindSampler(i, r->sampler);
    }
    glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, r->feedback);
    glBindFramebuffer(GL_FRAMEBUFFER, r->framebuffer);
    glUseProgram(r->program);
}

static void spoil(const rubbish *r)
{
    if (!r)
        return;
    set_switches();
    set_pixels(r);
    set_bindings(r);
}

/* The results of a run. */
typedef struct result {
    pupil_stats stats[FRAMES];
    uint8_t rgba[FRAMES][WIDTH * HEIGHT * 4];
    pupil_exposure exposure[FRAMES];
    pupil_gles_status status;
} result;

/* A target with `samples` per pixel, which is then resolved into the test's. */
static GLuint many_samples(GLuint *renderbuffer)
{
    GLuint framebuffer;
    glGenRenderbuffers(1, renderbuffer);
    glBindRenderbuffer(GL_RENDERBUFFER, *renderbuffer);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, 4, GL_RGBA8, WIDTH, HEIGHT);
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, *renderbuffer);
    CHECK(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
    return framebuffer;
}

static void read_picture(const pupil_gles_target *from, uint8_t *rgba)
{
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from->framebuffer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, s.test.framebuffer);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    if (from->framebuffer != s.test.framebuffer)
        glBlitFramebuffer(0, 0, WIDTH, HEIGHT, 0, 0, WIDTH, HEIGHT, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glPixelStorei(GL_PACK_SKIP_ROWS, 0);
    glPixelStorei(GL_PACK_SKIP_PIXELS, 0);
    gl_test_read(&s.test, rgba);
}

static void run_frame(unsigned i, const pupil_gles_target *target, const rubbish *r, result *to)
{
    pupil_frame_info info = session_info(i);
    pupil_curve curve;
    spoil(r);
    CHECK(session_upload(&s, i) == PUPIL_OK);
    spoil(r);
    CHECK(pupil_gles_meter(&s.gles, &info) == PUPIL_OK);
    spoil(r);
    CHECK(pupil_gles_collect(&s.gles, 60000000000u, &to->stats[i], &info) == PUPIL_OK);
    CHECK(pupil_adapt(&s.pupil, &to->stats[i], &info) == PUPIL_OK);
    CHECK(pupil_get_exposure(&s.pupil, &to->exposure[i]) == PUPIL_OK);
    CHECK(pupil_get_curve(&s.pupil, &info, &curve) == PUPIL_OK);
    if (i == FRAMES / 2) {
        spoil(r);
        CHECK(pupil_gles_retune(&s.gles, &s.pupil, NULL) == PUPIL_OK);
    }
    spoil(r);
    CHECK(pupil_gles_map(&s.gles, s.config.adapt == PUPIL_GLES_ADAPT_GPU ? NULL : &curve, target) == PUPIL_OK);
    read_picture(target, to->rgba[i]);
}

static void run(int samples, const rubbish *r, result *to)
{
    GLuint renderbuffer = 0;
    const pupil_config settings = session_settings();
    pupil_gles_target target = s.target;
    CHECK(pupil_init(&s.pupil, &settings) == PUPIL_OK);
    if (samples > 1)
        target.framebuffer = many_samples(&renderbuffer);
    spoil(r);
    CHECK_MSG(session_init(&s) == PUPIL_OK, "%s: %s", session_name(&s), s.why.text);
    for (unsigned i = 0; i < FRAMES; i++)
        run_frame(i, &target, r, to);
    CHECK(pupil_gles_get_status(&s.gles, &to->status) == PUPIL_OK);
    spoil(r);
    pupil_gles_close(&s.gles);
    if (samples > 1) {
        glDeleteFramebuffers(1, &target.framebuffer);
        glDeleteRenderbuffers(1, &renderbuffer);
    }
}

static void compare(uint32_t version, uint32_t adapt, uint32_t pixel, int samples)
{
    static result clean, spoilt;
    CHECK(gl_test_open(&s.test, PUPIL_GLES_BEST) == 0);
    session_set(&s, version, adapt, pixel, WIDTH, HEIGHT);
    memset(&clean, 0, sizeof clean);
    memset(&spoilt, 0, sizeof spoilt);
    run(samples, NULL, &clean);
    const rubbish r = rubbish_make();
    run(samples, &r, &spoilt);
    rubbish_free(&r);
    CHECK_MSG(memcmp(clean.stats, spoilt.stats, sizeof clean.stats) == 0, "%s: statistics", session_name(&s));
    CHECK_MSG(memcmp(clean.rgba, spoilt.rgba, sizeof clean.rgba) == 0, "%s: pictures, %d samples a pixel",
              session_name(&s), samples);
    CHECK_MSG(memcmp(clean.exposure, spoilt.exposure, sizeof clean.exposure) == 0, "%s: levels", session_name(&s));
    CHECK_MSG(memcmp(&clean.status, &spoilt.status, sizeof clean.status) == 0, "%s: status", session_name(&s));
    gl_test_close(&s.test);
}

int main(int argc, char **argv)
{
    GLint most_samples;
    check_begin(argc, argv);
    const int status = gl_test_open(&s.test, PUPIL_GLES_BEST);
    if (status)
        return status;
    const uint32_t newest = session_has_31() ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30;
    glGetIntegerv(GL_MAX_SAMPLES, &most_samples);
    gl_test_close(&s.test);
    const int samples = most_samples < 4 ? 1 : 4; /* softpipe has fewer than the specification requires */
    for (uint32_t version = PUPIL_GLES_ES30; version <= newest; version++) {
        compare(version, PUPIL_GLES_ADAPT_CPU, PUPIL_PIXEL_NV12, samples);
        compare(version, PUPIL_GLES_ADAPT_GPU, PUPIL_PIXEL_BAYER10, 1);
    }
    session_free(&s);
    return check_end();
}

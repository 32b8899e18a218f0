/* Failures in pupil_gles_init and pupil_gles_retune: a named error, a sentence that names the cause, no leaks, and the
 * object unchanged. Failures at run time: test_fallback.c. */
#include "session.h"

static session s;

/* Every shader. */
static int set_kind(int kind)
{
    if (!session_set_kind(&s, kind, PUPIL_PIXEL_NV12))
        return 0;
    s.config.scaled = 1;
    return 1;
}

/* No GL object is left, not even an error, and the object is not open. */
static void check_nothing_left(const char *what)
{
    pupil_gles_status status;
    CHECK_MSG(shim.alive == 0, "%s: %d objects are left", what, shim.alive);
    CHECK_MSG(shim.breaches == 0, "%s: %lu breaches", what, shim.breaches);
    CHECK_MSG(shim.error == GL_NO_ERROR && glGetError() == GL_NO_ERROR, "%s: glGetError still has something", what);
    CHECK_MSG(pupil_gles_get_status(&s.gles, &status) == PUPIL_ERR_OBJECT, "%s: the object is open", what);
    pupil_gles_close(&s.gles);
    gl_test_forget(&s.test); /* what a call without its object provokes */
}

static int init(void)
{
    memset(&s.gles, 0, sizeof s.gles);
    return session_init(&s);
}

/* Init has failed with this error, and `why` has these words. */
static void judge(int error, int expected, const char *words, const char *what)
{
    CHECK_MSG(error == expected, "%s, %s: error %d (\"%s\"), not %d", session_name(&s), what, error, s.why.text,
              expected);
    CHECK_MSG(strstr(s.why.text, words), "%s, %s: \"%s\" does not say \"%s\"", session_name(&s), what, s.why.text,
              words);
    if (error == PUPIL_OK)
        pupil_gles_close(&s.gles);
    check_nothing_left(what);
}

static void refused(int expected, const char *words, const char *what)
{
    judge(init(), expected, words, what);
}

/* --- the caller's errors --- */

static void check_null(void)
{
    set_kind(0);
    memset(&s.gles, 0, sizeof s.gles);
    CHECK(pupil_gles_init(NULL, &s.config, &s.pupil, gl_shim_get_proc, &s.why) == PUPIL_ERR_NULL);
    CHECK(strstr(s.why.text, "NULL"));
    CHECK(pupil_gles_init(&s.gles, NULL, &s.pupil, gl_shim_get_proc, &s.why) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_init(&s.gles, &s.config, NULL, gl_shim_get_proc, &s.why) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_init(&s.gles, &s.config, &s.pupil, NULL, &s.why) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_init(&s.gles, &s.config, &s.pupil, gl_shim_get_proc, NULL) == PUPIL_OK);
    pupil_gles_close(&s.gles);
    check_nothing_left("closed");
    shim.version = "OpenGL ES 2.0";
    CHECK(pupil_gles_init(&s.gles, &s.config, &s.pupil, gl_shim_get_proc, NULL) == PUPIL_ERR_GLES_VERSION);
    set_kind(0);
    memset(&s.pupil, 0, sizeof s.pupil);
    refused(PUPIL_ERR_OBJECT, "pupil_init", "no pupil_t");
    pupil_gles_close(NULL);
}

static void check_config(void)
{
    static const struct {
        size_t offset;
        uint32_t value;
        int error;
        const char *words;
    } wrong[] = {
        {offsetof(pupil_gles_config, size_bytes), 8, PUPIL_ERR_CONFIG, "size_bytes"},
        {offsetof(pupil_gles_config, version), 20, PUPIL_ERR_CONFIG, "version"},
        {offsetof(pupil_gles_config, source), PUPIL_GLES_SOURCE_COUNT, PUPIL_ERR_CONFIG, "source"},
        {offsetof(pupil_gles_config, source), PUPIL_GLES_EXTERNAL, PUPIL_ERR_CONFIG, "EXTERNAL must be"},
        {offsetof(pupil_gles_config, adapt), PUPIL_GLES_ADAPT_COUNT, PUPIL_ERR_CONFIG, "adapt"},
        {offsetof(pupil_gles_config, pixel), PUPIL_PIXEL_NONE, PUPIL_ERR_PIXEL, "pixel format"},
        {offsetof(pupil_gles_config, pixel), PUPIL_PIXEL_COUNT, PUPIL_ERR_PIXEL, "pixel format"},
        {offsetof(pupil_gles_config, width), 0, PUPIL_ERR_SIZE, "width and height"},
        {offsetof(pupil_gles_config, height), PUPIL_MAX_SIDE_PX + 1, PUPIL_ERR_SIZE, "width and height"},
        {offsetof(pupil_gles_config, normalized_16), 1, PUPIL_ERR_CONFIG, "normalized_16"},
        {offsetof(pupil_gles_config, half_size), 1, PUPIL_ERR_CONFIG, "half_size"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        set_kind(0);
        memcpy((char *)&s.config + wrong[i].offset, &wrong[i].value, sizeof wrong[i].value);
        refused(wrong[i].error, wrong[i].words, wrong[i].words);
        CHECK(shim.total == 0); /* GL was not even asked */
    }
    const pupil_coding wrong_coding[] = {{.light = 99}, {.size_bytes = 8}};
    for (size_t i = 0; i < sizeof wrong_coding / sizeof wrong_coding[0]; i++) {
        set_kind(0);
        s.config.coding = &wrong_coding[i];
        refused(PUPIL_ERR_CODING, i ? "size_bytes" : "light", "coding");
        CHECK(shim.total == 0);
    }
    set_kind(0);
    shim.largest_side = 15; /* the frames are 16 wide */
    refused(PUPIL_ERR_SIZE, "larger than the context's textures", "too wide");
}

static void with_settings(const pupil_config *settings, uint32_t version, uint32_t adapt, const char *words)
{
    set_kind(0);
    s.config.version = version;
    s.config.adapt = adapt;
    CHECK(pupil_init(&s.pupil, settings) == PUPIL_OK);
    refused(PUPIL_ERR_CONFIG, words, words);
}

static void check_settings(void)
{
    pupil_config c = session_settings();
    c.grey_world = 1;
    with_settings(&c, PUPIL_GLES_BEST, PUPIL_GLES_ADAPT_CPU, "grey_world");
    c = session_settings(), c.white_mode = PUPIL_WHITE_FOLLOW;
    with_settings(&c, PUPIL_GLES_BEST, PUPIL_GLES_ADAPT_GPU, "white_mode");
    c = session_settings(), c.curve = PUPIL_CURVE_EQUALISE;
    with_settings(&c, PUPIL_GLES_BEST, PUPIL_GLES_ADAPT_GPU, "curve");
    c = session_settings(), c.trim_low = 0.05f;
    with_settings(&c, PUPIL_GLES_BEST, PUPIL_GLES_ADAPT_GPU, "trim_low");
    for (uint32_t law = PUPIL_LAW_SECONDS + 1; law < PUPIL_LAW_COUNT; law++) {
        c = session_settings(), c.law = law;
        with_settings(&c, PUPIL_GLES_BEST, PUPIL_GLES_ADAPT_GPU, "PUPIL_LAW_SECONDS");
    }
}

/* --- missing in the context --- */

static void check_context(void)
{
    static const char *const versions[] = {
        "OpenGL ES 2.0 Mesa", "OpenGL ES-CM 1.1", "4.5 (Core Profile) Mesa", "", "OpenGL ES ",
        "OpenGL ES 3",        "WebGL 2.0"};
    for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
        set_kind(0);
        shim.version = versions[i];
        refused(PUPIL_ERR_GLES_VERSION, "OpenGL ES 3.0 or newer is needed", versions[i]);
        CHECK_MSG(strstr(s.why.text, versions[i]), "%s", s.why.text);
    }
    set_kind(0);
    shim.version = "OpenGL ES 3.0 of old";
    s.config.version = PUPIL_GLES_ES31;
    refused(PUPIL_ERR_GLES_VERSION, "3.1 is asked for; the context has 3.0", "ES 3.1 of 3.0");
    set_kind(0);
    shim.context = GL_CONTEXT_NONE;
    refused(PUPIL_ERR_GLES_CONTEXT, "no OpenGL ES context is current", "no context");
    set_kind(0);
    shim.hidden = "GL_OES_EGL_image_external_essl3";
    s.config.source = PUPIL_GLES_EXTERNAL;
    s.config.pixel = PUPIL_PIXEL_RGBA8;
    refused(PUPIL_ERR_GLES_VERSION, "GL_OES_EGL_image_external_essl3", "an extension");
}

static void check_functions(void)
{
    const int has_31 = session_has_31();
    int i = 0;
    for (; gl_shim_function(i, has_31); i++) {
        set_kind(0);
        s.config.version = PUPIL_GLES_BEST;
        shim.missing = gl_shim_function(i, has_31);
        refused(PUPIL_ERR_GLES_VERSION, shim.missing, shim.missing);
    }
    CHECK(i > 50);
}

/* --- what the driver refuses --- */

/* In the order in which set_kind compiles them. */
static const char *const shaders[4][13] = {
    {"triangle.vert", "meter.frag", "triangle.vert", "reduce.frag", "map.vert", "map.frag", "map.vert",
     "map.frag, scaled"},
    {"meter.comp", "map.vert", "map.frag", "map.vert", "map.frag, scaled"},
    {"triangle.vert", "meter.frag", "triangle.vert", "reduce.frag", "triangle.vert", "weigh.frag", "triangle.vert",
     "adapt.frag", "map.vert", "map.frag", "map.vert", "map.frag, scaled"},
    {"meter.comp", "adapt.comp", "map.vert", "map.frag", "map.vert", "map.frag, scaled"}};

static void check_shaders(int kind)
{
    char words[128];
    unsigned n = 1, program = 1;
    for (; shaders[kind][n - 1]; n++) {
        const char *name = shaders[kind][n - 1];
        set_kind(kind);
        shim.fault = GL_FAULT_COMPILE, shim.nth = n;
        snprintf(words, sizeof words, "the driver does not compile %s: 0:7: made up", name);
        refused(PUPIL_ERR_GLES_SHADER, words, name);
        set_kind(kind);
        shim.fault = GL_FAULT_SOURCE, shim.nth = n;
        refused(PUPIL_ERR_GLES_SHADER, "broken on purpose", name);
        CHECK_MSG(strstr(s.why.text, name), "%s: \"%s\"", name, s.why.text);
        if (strstr(name, ".vert"))
            continue;
        set_kind(kind);
        shim.fault = GL_FAULT_LINK, shim.nth = program++;
        snprintf(words, sizeof words, "the driver does not link %s: 0:7: made up", name);
        refused(PUPIL_ERR_GLES_SHADER, words, name);
    }
    set_kind(kind);
    shim.fault = GL_FAULT_COMPILE, shim.nth = n;
    CHECK(session_init(&s) == PUPIL_OK && !shim.fired); /* there are no more */
    pupil_gles_close(&s.gles);
}

/* If 3.1 fails to compile, 3.0 is tried, unless a histogram is wanted. */
static void check_best(void)
{
    pupil_gles_status status;
    if (!set_kind(1))
        return;
    s.config.version = PUPIL_GLES_BEST;
    shim.fault = GL_FAULT_COMPILE, shim.nth = 1;
    CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why.text);
    CHECK(shim.fired && pupil_gles_get_status(&s.gles, &status) == PUPIL_OK && status.version == PUPIL_GLES_ES30);
    CHECK(session_process(&s, 0) == PUPIL_OK);
    pupil_gles_close(&s.gles);
    check_nothing_left("3.0 in the place of 3.1");
    set_kind(1);
    s.config.version = PUPIL_GLES_BEST;
    pupil_config c;
    pupil_config_default(&c);
    CHECK(pupil_init(&s.pupil, &c) == PUPIL_OK);
    shim.fault = GL_FAULT_COMPILE, shim.nth = 1;
    refused(PUPIL_ERR_GLES_SHADER, "meter.comp", "with a histogram");
}

/* Every n-th allocation fails, until there are no more. */
static void check_memory(int kind)
{
    unsigned n = 1;
    for (; n < 200; n++) {
        char what[64];
        set_kind(kind);
        shim.fault = GL_FAULT_MEMORY, shim.nth = n;
        const int error = init();
        if (error == PUPIL_OK && !shim.fired)
            break;
        snprintf(what, sizeof what, "allocation %u", n);
        judge(error, PUPIL_ERR_GLES_MEMORY, "out of memory", what);
    }
    CHECK_MSG(n > 20 && n < 200, "%u", n);
    printf("%s: %u allocations\n", session_name(&s), n - 1);
    CHECK(session_process(&s, 0) == PUPIL_OK);
    pupil_gles_close(&s.gles);
    check_nothing_left("closed");
    for (n = 1; kind % 2 == 0 && n <= (kind ? 5 : 2); n++) {
        set_kind(kind);
        shim.fault = GL_FAULT_INCOMPLETE, shim.nth = n;
        refused(PUPIL_ERR_GLES, "framebuffer", "an incomplete framebuffer");
    }
}

/* The context is lost at some call of init: at each of the first ones, then at one in nineteen. */
static void check_lost(int kind)
{
    set_kind(kind);
    CHECK(session_init(&s) == PUPIL_OK);
    const unsigned long all = gl_shim_tells_of_loss() ? shim.total : 0;
    pupil_gles_close(&s.gles);
    for (unsigned long n = 1; n <= all; n += n < 10 ? 1 : 19) {
        set_kind(kind);
        shim.lose_at = n;
        const int error = init();
        CHECK_MSG(error == PUPIL_ERR_GLES_LOST, "%s, lost at call %lu of %lu: error %d, \"%s\"", session_name(&s), n,
                  all, error, s.why.text);
        CHECK_MSG(strstr(s.why.text, "lost"), "lost at call %lu: \"%s\"", n, s.why.text);
    }
    gl_shim_begin(1);
    gl_test_forget(&s.test);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const int status = gl_test_open(&s.test, PUPIL_GLES_BEST);
    if (status)
        return status;
    check_null();
    check_config();
    check_settings();
    check_context();
    check_functions();
    check_best();
    for (int kind = 0; kind < 4; kind++)
        if (set_kind(kind)) {
            check_shaders(kind);
            check_memory(kind);
            check_lost(kind);
        }
    gl_shim_begin(1);
    session_free(&s);
    gl_test_close(&s.test);
    return check_end();
}

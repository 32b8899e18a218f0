/* Contexts without a window, on drivers that lack something or fail: a sentence, and nothing leaks. */
#include "fake_egl.h"

#include "check.h"
#include "egl/egl_context.h"

static pupil_why why;

/* Whether a context opens; then it is closed again. Either way nothing leaks. */
static int opens(const pupil_egl_options *options)
{
    pupil_egl *egl;
    why.text[0] = 0;
    const int opened = pupil_egl_open(&egl, options, &why) == 0;
    CHECK(opened == (egl != NULL) && fake.contexts == opened && fake.is_current == opened);
    CHECK_MSG(opened || strlen(why.text) > 10, "'%s'", why.text);
    if (opened)
        CHECK(pupil_egl_display(egl) == eglGetCurrentDisplay() && pupil_egl_get_proc("glFlush"));
    fake.fail_at = 0;
    pupil_egl_close(egl);
    CHECK(fake.contexts == 0 && !fake.is_current);
    return opened;
}

static void test_displays(void)
{
    static const struct {
        const char *extensions;
        int devices;
        EGLenum platform;
    } cases[] = {{"EGL_MESA_platform_surfaceless", 0, EGL_PLATFORM_SURFACELESS_MESA},
                 {"EGL_KHR_platform_gbm EGL_EXT_platform_device", 1, EGL_PLATFORM_GBM_KHR},
                 {"EGL_EXT_platform_device", 1, EGL_PLATFORM_DEVICE_EXT},
                 {"EGL_EXT_platform_device", 0, 0},
                 {"EGL_EXT_platform", 1, 0},
                 {NULL, 1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_egl_begin();
        fake.client_extensions = cases[i].extensions;
        fake.devices = cases[i].devices;
        CHECK_MSG(opens(NULL) && fake.platform == cases[i].platform, "%zu: platform 0x%x: %s", i, fake.platform,
                  why.text);
    }
    fake_egl_begin();
    fake.missing = "eglGetPlatformDisplayEXT";
    CHECK(opens(NULL) && fake.platform == 0);
    fake_egl_begin();
    fake.client_extensions = "EGL_EXT_platform_device";
    fake.missing = "eglQueryDevicesEXT";
    CHECK(opens(NULL) && fake.platform == 0);
}

/* What is asked of EGL in each version, with which attributes. */
static void test_attributes(void)
{
    const pupil_egl_options all = {.debug = 1, .robust = 1};
    fake_egl_begin();
    CHECK(opens(&all) && fake_egl_attribute(EGL_CONTEXT_OPENGL_DEBUG) == EGL_TRUE &&
          fake_egl_attribute(EGL_CONTEXT_OPENGL_ROBUST_ACCESS_EXT) == EGL_TRUE);
    fake.extensions = "EGL_KHR_surfaceless_context"; /* EGL 1.5 by itself */
    CHECK(opens(&all) && fake_egl_attribute(EGL_CONTEXT_OPENGL_ROBUST_ACCESS) == EGL_TRUE &&
          fake_egl_attribute(EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY) == EGL_LOSE_CONTEXT_ON_RESET);
    fake.version = "1.4";
    CHECK(opens(&all) && fake_egl_attribute(EGL_CONTEXT_MAJOR_VERSION) == 3 &&
          fake_egl_attribute(EGL_CONTEXT_MINOR_VERSION) == -1 &&
          fake_egl_attribute(EGL_CONTEXT_OPENGL_ROBUST_ACCESS) == -1);
    fake.extensions = "EGL_KHR_surfaceless_context EGL_KHR_create_context";
    CHECK(opens(&all) && fake_egl_attribute(EGL_CONTEXT_MINOR_VERSION) == 1 &&
          fake_egl_attribute(EGL_CONTEXT_FLAGS_KHR) == EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR);
    static const char *const versions[] = {"2.0", "1.6", "0.9", "Fake EGL", NULL};
    for (size_t i = 0; i < sizeof versions / sizeof *versions; i++) {
        fake.version = versions[i];
        CHECK(opens(&all));
        CHECK((fake_egl_attribute(EGL_CONTEXT_OPENGL_DEBUG) == EGL_TRUE) == (i < 2));
    }
}

static void test_refusals(void)
{
    static const struct {
        uint32_t version, newest;
        const char *extensions, *gl_version, *missing, *says;
    } cases[] = {
        {0, 30, NULL, NULL, NULL, NULL},
        {PUPIL_GLES_ES31, 30, NULL, NULL, NULL, "the driver has no OpenGL ES 3.1: EGL_BAD_ALLOC"},
        {0, 20, NULL, NULL, NULL, "the driver has no OpenGL ES 3.0"},
        {PUPIL_GLES_ES31, 32, NULL, "OpenGL ES 3.0", NULL, "the driver has OpenGL ES 3.0; 3.1 is needed"},
        {0, 32, NULL, "4.6 of another kind", NULL, "the driver has OpenGL ES 0.0; 3.0 is needed"},
        {0, 32, NULL, NULL, "glGetString", "EGL_KHR_get_all_proc_addresses"},
        {0, 32, "EGL_KHR_surfaceless", NULL, NULL, "it lacks EGL_KHR_surfaceless_context"},
        {31 + 1, 32, NULL, NULL, NULL, "version 32 is not a pupil_gles_version"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_egl_begin();
        fake.newest = cases[i].newest;
        fake.extensions = cases[i].extensions ? cases[i].extensions : fake.extensions;
        fake.gl_version = cases[i].gl_version ? cases[i].gl_version : fake.gl_version;
        fake.missing = cases[i].missing;
        const int opened = opens(&(pupil_egl_options){.version = cases[i].version});
        CHECK_MSG(opened == !cases[i].says && (opened || strstr(why.text, cases[i].says)), "%zu: %s", i, why.text);
    }
    fake_egl_begin();
    fake.newest = 0;
    fake.error = 0x2fff;
    CHECK(!opens(NULL) && strstr(why.text, "an EGL error of no name"));
}

static void test_each_call(void)
{
    const pupil_egl_options options = {.robust = 1};
    static const char *const lists[] = {"EGL_MESA_platform_surfaceless EGL_KHR_platform_gbm EGL_EXT_platform_device",
                                        "EGL_EXT_platform_device", ""};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        unsigned long at = 0;
        do {
            fake_egl_begin();
            fake.client_extensions = lists[i];
            fake.fail_at = ++at;
            const int opened = opens(&options);
            CHECK_MSG(opened || fake.failed, "call %lu: %s", at, why.text);
        } while (fake.failed);
        CHECK(at > 4);
    }
    char text[64];
    fake_egl_begin();
    pupil_egl_describe(text, sizeof text);
    CHECK(strcmp(text, "no renderer, OpenGL ES 3.2 Fake") == 0);
    fake.gl_version = NULL;
    pupil_egl_describe(text, sizeof text);
    CHECK(strcmp(text, "no renderer, no OpenGL ES") == 0);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    test_displays();
    test_attributes();
    test_refusals();
    test_each_call();
    pupil_egl_close(NULL);
    return check_end();
}

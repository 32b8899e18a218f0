/* Failures of pupil_gles at run time: a named error, the object unchanged, and a pupil_t that continues, with the CPU
 * or with another object, as if there had never been a GPU. Failures of init: test_faults.c. */
#include <math.h>

#include "session.h"

static session s;

static int open_kind(int kind)
{
    if (!session_set_kind(&s, kind, PUPIL_PIXEL_RGBA16F))
        return 0;
    CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why.text);
    shim.ready = 1;
    shim.late = 1;
    return 1;
}

static void close_kind(void)
{
    pupil_gles_status status;
    pupil_gles_close(&s.gles);
    CHECK_MSG(shim.alive == 0 && shim.breaches == 0, "%s: %d objects are left, %lu breaches", session_name(&s),
              shim.alive, shim.breaches);
    CHECK(pupil_gles_get_status(&s.gles, &status) == PUPIL_ERR_OBJECT);
    pupil_gles_close(&s.gles);
    gl_test_forget(&s.test);
}

/* --- the level --- */

/* Light changes long before the GPU is lost and taken again, so that a frame whose statistics were lost makes no
 * difference: toward constant light, one step over the summed time is the same as two. */
#define SPAN  25
#define LOST  40
#define AGAIN 80
#define END   120

static const pupil_image_const *light_at(unsigned long i)
{
    return &s.frame[i / SPAN % SESSION_FRAMES].image;
}

static void on_cpu(pupil_t *pupil, unsigned long i)
{
    uint8_t codes[16 * 4 * 4];
    const pupil_image out = {
        .data = codes, .stride_bytes = 16 * 4, .width = 16, .height = 4, .pixel = PUPIL_PIXEL_RGBA8};
    const pupil_frame_info info = session_info(i);
    CHECK(pupil_process(pupil, light_at(i), &info, &out) == PUPIL_OK);
}

static int on_gpu(unsigned long i)
{
    const pupil_frame_info info = session_info(i);
    shim.frame = i;
    const int error = pupil_gles_upload(&s.gles, light_at(i));
    return error ? error : pupil_gles_process(&s.gles, &s.pupil, &info, &s.target);
}

static double adapted_ev(const pupil_t *pupil)
{
    pupil_exposure exposure;
    CHECK(pupil_get_exposure(pupil, &exposure) == PUPIL_OK);
    return exposure.adapted_ev;
}

/* The tolerance of metering, 1e-5 relative (pupil/gles.h), is 1.44e-5 stops. */
static void same_level(const pupil_t *pupil, double expected, unsigned long i)
{
    const double off = adapted_ev(pupil) - expected;
    CHECK_MSG(fabs(off) <= 1.44e-5, "%s, frame %lu: %g stops off", session_name(&s), i, off);
}

/* The level on the GPU is that of the pupil_t, which got the same statistics: 2e-6 stops and half of 2^-24. */
static void same_on_gpu(unsigned long i)
{
    pupil_gles_status status;
    CHECK(pupil_gles_get_status(&s.gles, &status) == PUPIL_OK);
    if (s.config.adapt != PUPIL_GLES_ADAPT_GPU)
        return;
    const double off = (double)status.level_q24 * 0x1p-24 - adapted_ev(&s.pupil);
    CHECK_MSG(status.level_known && fabs(off) <= 2e-6 + 0x1p-24, "%s, frame %lu: %g stops off on the GPU",
              session_name(&s), i, off);
}

static void new_context(void)
{
    gl_shim_begin(1); /* of the lost context's objects */
    gl_test_close(&s.test);
    CHECK(gl_test_open(&s.test, PUPIL_GLES_BEST) == 0);
    s.target.framebuffer = gl_test_framebuffer(&s.test, s.config.width, s.config.height);
    shim.late = 1;
}

typedef enum ending { ENDS_LOST, ENDS_WITHOUT_CONTEXT, ENDS_IN_ANOTHER, ENDINGS } ending;

/* Frames on the GPU until it is lost, then on the CPU, then on the GPU in a new context; compared with only the CPU. */
static void check_trajectory(int kind, ending how)
{
    static pupil_t alone;
    const pupil_config settings = session_settings();
    const int expected = how == ENDS_LOST ? PUPIL_ERR_GLES_LOST : PUPIL_ERR_GLES_CONTEXT;
    double before = 0.0;
    if (!open_kind(kind) || (how == ENDS_LOST && !gl_shim_tells_of_loss()))
        return;
    CHECK(pupil_init(&alone, &settings) == PUPIL_OK);
    for (unsigned long i = 0; i < END; i++) {
        on_cpu(&alone, i);
        if (i == LOST) {
            const pupil_t kept = s.pupil;
            shim.lost = how == ENDS_LOST;
            shim.context = how == ENDS_WITHOUT_CONTEXT ? GL_CONTEXT_NONE
                           : how == ENDS_IN_ANOTHER    ? GL_CONTEXT_OTHER
                                                       : GL_CONTEXT_OWN;
            const unsigned long calls = shim.total;
            CHECK(on_gpu(i) == expected);
            CHECK(memcmp(&kept, &s.pupil, sizeof kept) == 0 && shim.total == calls);
            pupil_gles_close(&s.gles);
            CHECK(shim.total == calls); /* nothing is deleted in a lost context, or in another one */
        }
        if (i == AGAIN) {
            new_context();
            CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why.text);
        }
        if (i < LOST || i >= AGAIN) { /* a frame behind */
            CHECK(on_gpu(i) == PUPIL_OK);
            if (i > 0)
                same_level(&s.pupil, before, i);
            if (i > 0 && i != AGAIN)
                same_on_gpu(i);
        } else {
            on_cpu(&s.pupil, i);
            same_level(&s.pupil, adapted_ev(&alone), i);
        }
        before = adapted_ev(&alone);
    }
    close_kind();
}

/* --- one call fails --- */

/* The n-th of some call fails: one frame gets the error; those before and after are right. */
static void check_once(int kind, gl_fault fault, int expected, const char *what)
{
    int failed = 0;
    pupil_gles_status status;
    if (!open_kind(kind))
        return;
    shim.fault = fault, shim.nth = 5;
    for (unsigned long i = 0; i < 30; i++) {
        const int error = session_process(&s, i);
        CHECK_MSG(error == PUPIL_OK || (error == expected && !failed && shim.fired), "%s, %s, frame %lu: error %d",
                  session_name(&s), what, i, error);
        failed += error != PUPIL_OK;
    }
    CHECK_MSG(shim.fired && failed == 1, "%s, %s: %d errors", session_name(&s), what, failed);
    CHECK(pupil_gles_get_status(&s.gles, &status) == PUPIL_OK && status.under_way <= 3);
    CHECK(shim.error == GL_NO_ERROR && pupil_error_string(expected)[0]);
    close_kind();
}

/* --- the caller's errors --- */

static void check_uploads(void)
{
    pupil_image_const image = s.frame[0].image;
    const unsigned long calls = shim.total;
    CHECK(pupil_gles_upload(&s.gles, NULL) == PUPIL_ERR_NULL);
    image.width--;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_SIZE);
    image = s.frame[0].image, image.height++;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_SIZE);
    image = s.frame[0].image, image.height = 0;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_SIZE);
    image = s.frame[0].image, image.pixel = PUPIL_PIXEL_RGBA16;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_PIXEL);
    image = s.frame[0].image, image.pixel = PUPIL_PIXEL_COUNT;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_PIXEL);
    image = s.frame[0].image, image.stride_bytes = 16 * 8 - 8;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_STRIDE);
    image = s.frame[0].image, image.stride_bytes++;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_ALIGNMENT);
    image = s.frame[0].image, image.data = (const char *)image.data + 1;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_ALIGNMENT);
    image = s.frame[0].image, image.data = NULL;
    CHECK(pupil_gles_upload(&s.gles, &image) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_use(&s.gles, 1, 0, 0) == PUPIL_ERR_ORDER); /* of an object for memory */
    CHECK(shim.total == calls);
}

static void refused_target(pupil_gles_target target, int expected, int line)
{
    const pupil_curve curve = {.scale = 1.0f};
    const int on_gpu_too = s.config.adapt == PUPIL_GLES_ADAPT_GPU;
    const pupil_t kept = s.pupil;
    const unsigned long calls = shim.total;
    CHECK_MSG(pupil_gles_map(&s.gles, on_gpu_too ? NULL : &curve, &target) == expected, "line %d", line);
    CHECK_MSG(pupil_gles_process(&s.gles, &s.pupil, NULL, &target) == expected, "line %d", line);
    CHECK(shim.total == calls && memcmp(&kept, &s.pupil, sizeof kept) == 0);
}

static void check_targets(void)
{
#define REFUSED(FIELD, VALUE, ERROR)                                                                                   \
    do {                                                                                                               \
        pupil_gles_target target = s.target;                                                                           \
        target.FIELD = VALUE;                                                                                          \
        refused_target(target, ERROR, __LINE__);                                                                       \
    } while (0)
    REFUSED(width, 0, PUPIL_ERR_SIZE);
    REFUSED(height, 0, PUPIL_ERR_SIZE);
    REFUSED(width, 15, PUPIL_ERR_SIZE); /* config.scaled is 0 */
    REFUSED(height, PUPIL_MAX_SIDE_PX + 1, PUPIL_ERR_SIZE);
    REFUSED(orientation, PUPIL_GLES_ROTATED_90, PUPIL_ERR_SIZE);
    REFUSED(orientation, PUPIL_GLES_ORIENTATION_COUNT, PUPIL_ERR_VALUE);
    REFUSED(fit, PUPIL_GLES_FIT_COUNT, PUPIL_ERR_VALUE);
    REFUSED(x, INT32_MAX, PUPIL_ERR_VALUE);
    REFUSED(y, INT32_MIN, PUPIL_ERR_VALUE);
    REFUSED(from, NAN, PUPIL_ERR_VALUE);
    REFUSED(to, NAN, PUPIL_ERR_VALUE);
    REFUSED(from, -0.1f, PUPIL_ERR_VALUE);
    REFUSED(from, 0.5f, PUPIL_ERR_VALUE); /* to is 0 */
    REFUSED(to, 1.1f, PUPIL_ERR_VALUE);
    CHECK(pupil_gles_process(&s.gles, &s.pupil, NULL, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_process(&s.gles, NULL, NULL, &s.target) == PUPIL_ERR_NULL);
}

static void check_curves(void)
{
    const pupil_curve good = {.scale = 1.0f}, not_a_number = {.scale = NAN},
                      huge = {.scale = 1.0f, .inverse_white_squared = 0x1p20f};
    if (s.config.adapt == PUPIL_GLES_ADAPT_GPU) {
        CHECK(pupil_gles_map(&s.gles, &good, &s.target) == PUPIL_ERR_VALUE);
        return;
    }
    CHECK(pupil_gles_map(&s.gles, NULL, &s.target) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_map(&s.gles, &not_a_number, &s.target) == PUPIL_ERR_VALUE);
    CHECK(pupil_gles_map(&s.gles, &huge, &s.target) == PUPIL_ERR_VALUE);
}

/* Settings that are not possible, and shaders that do not compile: the old ones stay in use. */
static void check_retune(int kind)
{
    pupil_config wrong = session_settings(), histogram = session_settings();
    pupil_t other = s.pupil;
    const int can_count = !(kind & 2); /* in no integer state on the GPU */
    wrong.grey_world = 1;
    CHECK(pupil_retune(&other, &wrong) == PUPIL_OK);
    CHECK(pupil_gles_retune(&s.gles, &other, &s.why) == PUPIL_ERR_CONFIG && strstr(s.why.text, "grey_world"));
    CHECK(pupil_gles_retune(&s.gles, NULL, &s.why) == PUPIL_ERR_NULL);
    histogram.white_mode = PUPIL_WHITE_FOLLOW;
    CHECK(pupil_retune(&other, &histogram) == PUPIL_OK);
    const unsigned long fences = gl_shim_calls("DeleteSync");
    shim.ready = 0; /* retune may compile */
    shim.fault = GL_FAULT_COMPILE, shim.nth = 1;
    const int alive = shim.alive, error = pupil_gles_retune(&s.gles, &other, &s.why);
    CHECK_MSG(error == (can_count ? PUPIL_ERR_GLES_SHADER : PUPIL_ERR_CONFIG), "%d: %s", error, s.why.text);
    CHECK(strstr(s.why.text, can_count ? (kind & 1 ? "meter.comp" : "triangle.vert") : "white_mode"));
    CHECK(shim.alive == alive && gl_shim_calls("DeleteSync") == fences);
    if (can_count) {
        shim.fault = GL_FAULT_MEMORY, shim.nth = 2, shim.fired = 0;
        CHECK(pupil_gles_retune(&s.gles, &other, &s.why) == PUPIL_ERR_GLES_MEMORY);
        CHECK(shim.alive == alive && strstr(s.why.text, "out of memory"));
    }
    shim.fault = GL_FAULT_NONE;
    CHECK(session_process(&s, 7) == PUPIL_OK);
    if (can_count) {
        CHECK_MSG(pupil_gles_retune(&s.gles, &other, &s.why) == PUPIL_OK, "%s", s.why.text);
        CHECK(pupil_gles_retune(&s.gles, &s.pupil, &s.why) == PUPIL_OK);
    }
    shim.ready = 1;
    CHECK(session_process(&s, 8) == PUPIL_OK && session_process(&s, 9) == PUPIL_OK);
}

static void check_callers(int kind)
{
    pupil_stats stats;
    pupil_gles_status status;
    const pupil_curve curve = {.scale = 1.0f};
    if (!open_kind(kind))
        return;
    /* before the first frame */
    CHECK(pupil_gles_meter(&s.gles, NULL) == PUPIL_ERR_ORDER);
    CHECK(pupil_gles_map(&s.gles, kind & 2 ? NULL : &curve, &s.target) == PUPIL_ERR_ORDER);
    CHECK(pupil_gles_process(&s.gles, &s.pupil, NULL, &s.target) == PUPIL_ERR_ORDER);
    CHECK(pupil_gles_collect(&s.gles, 0, &stats, NULL) == PUPIL_GLES_NOTHING);
    check_uploads();
    for (unsigned long i = 0; i < 3; i++)
        CHECK(session_process(&s, i) == PUPIL_OK);
    check_uploads();
    check_targets();
    check_curves();
    check_retune(kind);
    CHECK(pupil_gles_collect(&s.gles, 0, NULL, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_get_status(&s.gles, NULL) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_get_status(NULL, &status) == PUPIL_ERR_NULL);
    close_kind();
    /* of a closed object, and of NULL */
    CHECK(session_process(&s, 10) == PUPIL_ERR_OBJECT);
    CHECK(pupil_gles_process(&s.gles, &s.pupil, NULL, &s.target) == PUPIL_ERR_OBJECT);
    CHECK(pupil_gles_retune(&s.gles, &s.pupil, &s.why) == PUPIL_ERR_OBJECT && strstr(s.why.text, "object"));
    CHECK(pupil_gles_meter(&s.gles, NULL) == PUPIL_ERR_OBJECT);
    CHECK(pupil_gles_collect(&s.gles, 0, &stats, NULL) == PUPIL_ERR_OBJECT);
    CHECK(pupil_gles_map(&s.gles, NULL, &s.target) == PUPIL_ERR_OBJECT);
    CHECK(pupil_gles_upload(NULL, &s.frame[0].image) == PUPIL_ERR_NULL &&
          pupil_gles_use(NULL, 1, 0, 0) == PUPIL_ERR_NULL);
    CHECK(pupil_gles_meter(NULL, NULL) == PUPIL_ERR_NULL && pupil_gles_map(NULL, NULL, NULL) == PUPIL_ERR_NULL);
}

/* The context is lost at each call of a frame in turn. */
static void check_lost_at_work(int kind)
{
    if (!open_kind(kind) || !gl_shim_tells_of_loss())
        return;
    pupil_gles_close(&s.gles);
    for (unsigned long n = 1; n < 250; n += 17) {
        open_kind(kind);
        shim.lose_at = shim.total + n;
        int error = PUPIL_OK;
        for (unsigned long i = 0; i < 3 && !error; i++)
            error = session_process(&s, i);
        CHECK_MSG(error == PUPIL_ERR_GLES_LOST || (!error && !shim.lost), "%s, call %lu: error %d", session_name(&s), n,
                  error);
        CHECK(!shim.lost || session_process(&s, 4) == PUPIL_ERR_GLES_LOST);
        on_cpu(&s.pupil, 5);
        const int lost = shim.lost, alive = shim.alive;
        pupil_gles_close(&s.gles);
        CHECK(lost ? shim.alive == alive : shim.alive == 0);
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
    for (int kind = 0; kind < 4; kind++) {
        for (ending how = ENDS_LOST; how < ENDINGS; how++)
            check_trajectory(kind, how);
        check_once(kind, GL_FAULT_FENCE, PUPIL_ERR_GLES_MEMORY, "a fence");
        check_once(kind, GL_FAULT_WAIT, PUPIL_ERR_GLES_MEMORY, "a wait");
        check_once(kind, GL_FAULT_MAP, PUPIL_ERR_GLES_MEMORY, "a map");
        check_once(kind, GL_FAULT_UNMAP, PUPIL_ERR_GLES, "an unmap");
        check_callers(kind);
        check_lost_at_work(kind);
    }
    gl_shim_begin(1);
    session_free(&s);
    gl_test_close(&s.test);
    return check_end();
}

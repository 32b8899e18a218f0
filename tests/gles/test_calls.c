/* What pupil_gles promises of its calls, checked by a shim over 600 frames: nothing waits, nothing is created after
 * init, nothing is read before its fence has signalled; with a fast and a slow GPU. */
#include <math.h>

#include "session.h"

#define FRAMES     600
#define FEW_FRAMES 120 /* for which the ring wraps a few dozen times */

static session s;

/* Functions that no frame may call. The shim provides what lib/gles asks for, and glFinish or the like would be
 * breaches. */
static void check_promises(const char *what)
{
    CHECK_MSG(shim.breaches == 0, "%s: %lu breaches, above", what, shim.breaches);
    CHECK_MSG(shim.waits == 0, "%s: %lu calls of glClientWaitSync had a timeout", what, shim.waits);
}

static void begin(unsigned late)
{
    gl_shim_begin(1);
    CHECK_MSG(session_init(&s) == PUPIL_OK, "%s: %s", session_name(&s), s.why.text);
    CHECK(shim.breaches == 0 && shim.total > 0);
    shim.ready = 1;
    shim.late = late;
}

static void end(void)
{
    check_promises(session_name(&s));
    CHECK_MSG(shim.alive > 0, "%s: nothing was made?", session_name(&s));
    pupil_gles_close(&s.gles);
    CHECK_MSG(shim.alive == 0, "%s: %d objects are left", session_name(&s), shim.alive);
    CHECK(shim.breaches == 0);
}

/* Each frame's statistics are back with the next one: every frame does the same work. */
static void check_steady(void)
{
    unsigned long a_frame = 0;
    pupil_gles_status status;
    pupil_exposure exposure;
    begin(1);
    for (unsigned long i = 0; i < FRAMES; i++) {
        const unsigned long before = shim.total;
        CHECK(session_process(&s, i) == PUPIL_OK);
        const unsigned long now = shim.total - before;
        if (i == 10)
            a_frame = now;
        CHECK_MSG(i < 10 || now == a_frame, "%s, frame %lu: %lu calls, before %lu", session_name(&s), i, now, a_frame);
    }
    CHECK(pupil_gles_get_status(&s.gles, &status) == PUPIL_OK);
    CHECK(status.metered == FRAMES && status.unmetered == 0 && status.under_way == 1);
    CHECK(pupil_get_exposure(&s.pupil, &exposure) == PUPIL_OK && exposure.frames == FRAMES - 1);
    CHECK(gl_shim_calls("FenceSync") == FRAMES && gl_shim_calls("DeleteSync") == FRAMES - 1);
    CHECK(gl_shim_calls("MapBufferRange") == FRAMES - 1 && gl_shim_calls("UnmapBuffer") == FRAMES - 1);
    CHECK(gl_shim_calls("ReadPixels") == (s.config.version == PUPIL_GLES_ES31      ? 0
                                          : s.config.adapt == PUPIL_GLES_ADAPT_GPU ? 2 * FRAMES
                                                                                   : FRAMES));
    printf("%s: %lu calls a frame\n", session_name(&s), a_frame);
    end();
}

/* At the driver's own speed, mostly slower than this loop. */
static void check_own_time(void)
{
    begin(0);
    for (unsigned long i = 0; i < FRAMES; i++)
        CHECK(session_process(&s, i) == PUPIL_OK);
    end();
}

/* Fences take longer than the ring lasts: frames are still mapped. */
static void check_slow(unsigned late)
{
    pupil_gles_status status;
    const uint64_t expected = (FEW_FRAMES + late - 1) / late * 3; /* three are pending, then all come back at once */
    begin(late);
    for (unsigned long i = 0; i < FEW_FRAMES; i++)
        CHECK(session_process(&s, i) == PUPIL_OK);
    CHECK(pupil_gles_get_status(&s.gles, &status) == PUPIL_OK);
    CHECK_MSG(status.metered + status.unmetered == FEW_FRAMES, "%llu and %llu", (unsigned long long)status.metered,
              (unsigned long long)status.unmetered);
    CHECK_MSG(late <= 3 ? status.unmetered == 0 : status.metered <= expected && status.metered >= expected - 6,
              "late by %u: %llu metered", late, (unsigned long long)status.metered);
    /* Every frame was drawn: the target holds the last one, not the one before, and not the first. */
    const unsigned passes = s.config.version == PUPIL_GLES_ES31      ? 0
                            : s.config.adapt == PUPIL_GLES_ADAPT_GPU ? 4
                                                                     : 2; /* of metering */
    CHECK(gl_shim_calls("DrawArrays") == FEW_FRAMES + passes * status.metered);
    end();
}

/* The individual calls: statistics come in the frames' order, each with its own frame's info. */
static void check_order(unsigned late)
{
    double mean[SESSION_FRAMES];
    unsigned long collected = 0, metered[FEW_FRAMES], count = 0, busy = 0;
    pupil_stats stats;
    pupil_frame_info info;
    for (int k = 0; k < SESSION_FRAMES; k++) {
        pupil_stats_clear(&stats);
        CHECK(pupil_meter_rows(&s.pupil, &s.frame[k].image, 0, s.config.height, &stats) == PUPIL_OK);
        CHECK(pupil_stats_mean(&stats, 0.0, 1.0, &mean[k]) == PUPIL_OK);
    }
    begin(late);
    for (unsigned long i = 0; i < FEW_FRAMES; i++) {
        const pupil_frame_info own = session_info(i);
        CHECK(session_upload(&s, i) == PUPIL_OK);
        while (pupil_gles_collect(&s.gles, 0, &stats, &info) == PUPIL_OK) {
            double log2_luminance = -1000.0;
            const unsigned long of = collected < count ? metered[collected] : FEW_FRAMES;
            collected++;
            CHECK_MSG(info.sequence == of && info.timestamp_ns == session_info(of).timestamp_ns, "%llu, not %lu",
                      (unsigned long long)info.sequence, of);
            CHECK(pupil_stats_mean(&stats, 0.0, 1.0, &log2_luminance) == PUPIL_OK);
            const double off = log2_luminance - mean[of % SESSION_FRAMES];
            CHECK_MSG(fabs(off) < 1.5e-5, "%s: statistics of frame %lu are off by %g stops", session_name(&s), of, off);
        }
        const int error = pupil_gles_meter(&s.gles, &own);
        CHECK(error == PUPIL_OK || error == PUPIL_GLES_BUSY);
        if (error == PUPIL_OK)
            metered[count++] = i;
        else
            busy++;
    }
    CHECK_MSG(collected + 3 >= count && collected <= count, "%lu of %lu came back", collected, count);
    CHECK((busy > 0) == (late > 3));
    end();
}

/* With a timeout collect may wait, and then reports what came; only the caller decides that. */
static void check_timeout(void)
{
    pupil_stats stats;
    begin(0);
    CHECK(session_upload(&s, 0) == PUPIL_OK && pupil_gles_meter(&s.gles, NULL) == PUPIL_OK);
    CHECK(pupil_gles_collect(&s.gles, UINT64_C(60000000000), &stats, NULL) == PUPIL_OK && shim.waits == 1);
    CHECK(pupil_gles_collect(&s.gles, UINT64_C(60000000000), &stats, NULL) == PUPIL_GLES_NOTHING && shim.waits == 1);
    shim.waits = 0;
    end();
}

/* A following white point needs a histogram, which must be cleared before counting. */
static void check_histogram(void)
{
    pupil_config settings;
    session_set(&s, PUPIL_GLES_ES31, PUPIL_GLES_ADAPT_CPU, PUPIL_PIXEL_RGBA16F, 16, 4);
    pupil_config_default(&settings);
    CHECK(pupil_init(&s.pupil, &settings) == PUPIL_OK);
    check_steady();
    check_slow(5);
}

int main(int argc, char **argv)
{
    static const uint32_t pixels[] = {PUPIL_PIXEL_RGBA16F, PUPIL_PIXEL_NV12, PUPIL_PIXEL_BAYER12P};
    check_begin(argc, argv);
    const int status = gl_test_open(&s.test, PUPIL_GLES_BEST);
    if (status)
        return status;
    const int has_31 = session_has_31();
    /* Few rows for 3.1: each takes sixteen groups of compute shaders, which are slow in Mesa's CPU drivers. */
    for (uint32_t version = PUPIL_GLES_ES30; version <= (has_31 ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30); version++)
        for (uint32_t adapt = 0; adapt < PUPIL_GLES_ADAPT_COUNT; adapt++) {
            for (size_t i = 0; i < sizeof pixels / sizeof pixels[0]; i++) {
                session_set(&s, version, adapt, pixels[i], 64, version == PUPIL_GLES_ES31 ? 4 : 48);
                check_steady();
            }
            session_set(&s, version, adapt, PUPIL_PIXEL_RGBA8, 16, 2);
            check_own_time();
            check_slow(3);
            check_slow(5);
            check_order(2);
            check_order(7);
            check_timeout();
        }
    if (has_31)
        check_histogram();
    session_free(&s);
    gl_test_close(&s.test);
    return check_end();
}

/* 100,000 frames, and 200 contexts with an object each, without growth: of memory, of files, of GL's objects. */
#include <dirent.h>
#include <malloc.h>
#include <unistd.h>

#include "resident.h"
#include "session.h"

#define FRAMES  100000
#define WARM_UP 5000 /* of the frames of each kind */
/* A leak in each of 20,000 frames is at least 32 bytes, malloc's smallest block: 625 KiB. Small leaks first fill the
 * holes that shader compilation has left, so resident memory would not show them. */
#define GROWTH_KIB 256
/* Of resident memory: a driver's thread may still touch something large for the first time; a MiB of stack was seen.
 */
#define RESIDENT_KIB 2048

#define CONTEXTS         200
#define WARM_UP_CONTEXTS 60
/* The smallest allocation of a context is hundreds of bytes; GL's objects are counted by the shim. 140 leaks of 4 KiB
 * would be 560. */
#define CONTEXT_GROWTH_KIB 256

static session s;

/* Of malloc's. */
static long in_use_kib(void)
{
    const struct mallinfo2 info = mallinfo2();
    return (long)((info.uordblks + info.hblkhd) / 1024);
}

static int open_files(void)
{
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    while (folder && readdir(folder))
        count++;
    if (folder)
        closedir(folder);
    return count;
}

typedef struct footprint {
    long resident_kib, in_use_kib;
    int files;
} footprint;

static footprint footprint_now(void)
{
    return (footprint){resident_kib(), in_use_kib(), open_files()};
}

static void check_growth(footprint before, long most_kib, const char *what)
{
    const footprint now = footprint_now();
    printf("%s: resident %ld KiB, then %ld KiB; in use %ld KiB, then %ld KiB\n", what, before.resident_kib,
           now.resident_kib, before.in_use_kib, now.in_use_kib);
    CHECK_MSG(now.files == before.files, "%s: %d files, then %d", what, before.files, now.files);
    CHECK(before.resident_kib > 0);
#if !CHECK_SANITIZED /* it keeps freed memory for a while */
    CHECK_MSG(now.in_use_kib - before.in_use_kib <= most_kib, "%s", what);
    CHECK_MSG(now.resident_kib - before.resident_kib <= RESIDENT_KIB, "%s", what);
#else
    (void)most_kib;
#endif
}

static void check_frames(uint32_t version, uint32_t adapt, unsigned long frames)
{
    footprint before = {0};
    int alive = 0;
    gl_shim_begin(1);
    session_set(&s, version, adapt, PUPIL_PIXEL_RGBA8, 16, version == PUPIL_GLES_ES31 ? 1 : 16);
    CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why.text);
    shim.ready = 1;
    shim.late = 1;
    for (unsigned long i = 0; i < frames; i++) {
        if (i == WARM_UP)
            before = footprint_now(), alive = shim.alive;
        const int error = session_process(&s, i);
        CHECK_MSG(error == PUPIL_OK, "frame %lu: %d", i, error);
    }
    check_growth(before, GROWTH_KIB, session_name(&s));
    CHECK_MSG(shim.alive == alive && shim.breaches == 0 && shim.waits == 0, "%d objects, then %d", alive, shim.alive);
    pupil_gles_close(&s.gles);
    CHECK(shim.alive == 0);
}

static void check_contexts(int has_31)
{
    footprint before = {0};
    for (int i = 0; i < CONTEXTS; i++) {
        const uint32_t version = i % 4 == 3 && has_31 ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30;
        pupil_egl *egl = NULL;
        if (i == WARM_UP_CONTEXTS)
            before = footprint_now();
        CHECK_MSG(pupil_egl_open(&egl, NULL, &s.why) == 0, "%s", s.why.text);
        if (!egl)
            return;
        gl_shim_begin(0);
        s.test = (gl_test){.egl = egl};
        session_set(&s, version, PUPIL_GLES_ADAPT_CPU, PUPIL_PIXEL_RGBA8, 16, 1);
        CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why.text);
        CHECK(session_process(&s, 0) == PUPIL_OK && session_process(&s, 1) == PUPIL_OK);
        pupil_gles_close(&s.gles);
        CHECK(shim.alive == 0 && shim.breaches == 0);
        CHECK(gl_test_end(&s.test) == GL_NO_ERROR);
    }
    check_growth(before, CONTEXT_GROWTH_KIB, "contexts");
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    const int status = gl_test_open(&s.test, PUPIL_GLES_BEST);
    if (status)
        return status;
    const int has_31 = session_has_31(), kinds = has_31 ? 4 : 2;
    for (int kind = 0; kind < kinds; kind++)
        check_frames(kind & 2 ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30,
                     kind & 1 ? PUPIL_GLES_ADAPT_GPU : PUPIL_GLES_ADAPT_CPU, FRAMES / (unsigned long)kinds);
    gl_test_close(&s.test);
    check_contexts(has_31);
    session_free(&s);
    return check_end();
}

/* 100,000 frames, and 200 contexts with an object each, without growth: of memory, of files, of GL's objects. */
#include <dirent.h>
#include <unistd.h>

#include "session.h"

#define FRAMES  100000
#define WARM_UP 5000 /* of the frames of each kind */
/* Looked at ten times. What leaks on each of 2,000 frames is 32 bytes at least, malloc's smallest piece: sixteen pages
 * each time. A driver's thread may still touch something large for the first time, which is a step or two. */
#define LOOKS      10
#define MOST_STEPS 2

#define CONTEXTS         200
#define WARM_UP_CONTEXTS 60
/* An object that leaks one buffer of its ring leaks 13 KiB and more, 140 of them 1.8 MiB; the compiler of Mesa's
 * shaders leaves a few hundred KiB of holes behind, which come and go. */
#define CONTEXT_GROWTH_KIB 1024

static session s;

static long resident_kib(void)
{
    long pages = -1;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return -1;
    if (fscanf(file, "%*d %ld", &pages) != 1)
        pages = -1;
    fclose(file);
    return pages < 0 ? -1 : pages * (sysconf(_SC_PAGESIZE) / 1024);
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

#if !defined(__SANITIZE_ADDRESS__) && !defined(__has_feature)
#define __has_feature(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#define KEEPS_FREED 1 /* for a while */
#else
#define KEEPS_FREED 0
#endif

static void check_frames(uint32_t version, uint32_t adapt, unsigned long frames)
{
    const unsigned long look_every = (frames - WARM_UP) / LOOKS;
    long first = -1, resident = -1;
    int files = -1, alive = 0, steps = 0;
    gl_shim_begin(1);
    session_set(&s, version, adapt, PUPIL_PIXEL_RGBA8, 16, version == PUPIL_GLES_ES31 ? 1 : 16);
    CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why);
    shim.ready = 1;
    shim.late = 1;
    for (unsigned long i = 0; i < frames; i++) {
        const int error = session_process(&s, i);
        CHECK_MSG(error == PUPIL_OK, "frame %lu: %d", i, error);
        if (i + 1 == WARM_UP) {
            first = resident = resident_kib();
            files = open_files(), alive = shim.alive;
        } else if (i >= WARM_UP && (i + 1 - WARM_UP) % look_every == 0) {
            const long now = resident_kib();
            steps += now > resident;
            resident = now;
        }
    }
    printf("%s: resident %ld KiB, after %lu frames %ld KiB, in %d steps\n", session_name(&s), first, frames, resident,
           steps);
    CHECK_MSG(first > 0 && (KEEPS_FREED || steps <= MOST_STEPS), "grew %d times of %d", steps, LOOKS);
    CHECK_MSG(open_files() == files, "%d files, then %d", files, open_files());
    CHECK_MSG(shim.alive == alive && shim.breaches == 0 && shim.waits == 0, "%d objects, then %d", alive, shim.alive);
    pupil_gles_close(&s.gles);
    CHECK(shim.alive == 0);
}

static void check_contexts(int has_31)
{
    long before = -1;
    int files = -1;
    for (int i = 0; i < CONTEXTS; i++) {
        const uint32_t version = i % 4 == 3 && has_31 ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30;
        pupil_egl *egl = NULL;
        if (i == WARM_UP_CONTEXTS)
            before = resident_kib(), files = open_files();
        CHECK_MSG(pupil_egl_open(&egl, NULL, s.why, sizeof s.why) == 0, "%s", s.why);
        if (!egl)
            return;
        gl_shim_begin(0);
        s.test = (gl_test){.egl = egl};
        session_set(&s, version, PUPIL_GLES_ADAPT_CPU, PUPIL_PIXEL_RGBA8, 16, 1);
        CHECK_MSG(session_init(&s) == PUPIL_OK, "%s", s.why);
        CHECK(session_process(&s, 0) == PUPIL_OK && session_process(&s, 1) == PUPIL_OK);
        pupil_gles_close(&s.gles);
        CHECK(shim.alive == 0 && shim.breaches == 0);
        CHECK(gl_test_end(&s.test) == GL_NO_ERROR);
    }
    const long after = resident_kib();
    printf("resident after %d contexts %ld KiB, after %d %ld KiB\n", WARM_UP_CONTEXTS, before, CONTEXTS, after);
    CHECK_MSG(before > 0 && (KEEPS_FREED || after - before <= CONTEXT_GROWTH_KIB), "grew by %ld KiB", after - before);
    CHECK_MSG(open_files() == files, "%d files, then %d", files, open_files());
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

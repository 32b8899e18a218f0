/* DNG and the raw files of cameras, through LibRaw: unpacked, demosaiced, balanced as the camera was set, in linear
 * Rec.709 from 0 at black to 1 at white. */
#include "still.h"

#include <errno.h>
#include <libraw/libraw.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "refuse.h"
#include "still_private.h"

#define MOST_SECONDS 60 /* CPU time for one picture */

/* Nothing that depends on the picture: no histogram stretch, no white level taken from it. */
static void set_params(libraw_output_params_t *p, int as_stored)
{
    p->output_bps = 16;
    p->output_color = 1; /* the primaries of sRGB, which are those of Rec.709 */
    p->gamm[0] = p->gamm[1] = 1.0;
    p->no_auto_bright = 1;
    p->adjust_maximum_thr = 0.0f;
    p->use_camera_wb = 1;
    p->use_camera_matrix = 1;
    if (as_stored)
        p->user_flip = 0;
}

/* The child's result, in shared memory; the samples follow, 3 a pixel. */
typedef struct found {
    int result;
    uint32_t width, height;
    float code_light;
    pupil_why why;
} found;

static int take(found *f, uint64_t most, const libraw_processed_image_t *image)
{
    const uint64_t pixels = (uint64_t)image->width * image->height;
    const uint32_t colours = image->colors;
    uint16_t *to = (uint16_t *)(void *)(f + 1);
    if (image->type != LIBRAW_IMAGE_BITMAP || image->bits != 16 || (colours != 1 && colours != 3) ||
        image->data_size < pixels * colours * sizeof(uint16_t) || pixels > most)
        return pupil_still_fail(&f->why, "LibRaw makes no picture of 16 bits of it");
    f->width = image->width;
    f->height = image->height;
    for (uint64_t i = 0; i < pixels; i++)
        for (uint32_t c = 0; c < 3; c++)
            memcpy(to++, image->data + (i * colours + (colours == 3 ? c : 0)) * sizeof *to, sizeof *to);
    return 0;
}

static int fail(int code, pupil_why *why)
{
    return pupil_still_fail(why, "is damaged, or not what its header says: LibRaw: %s", libraw_strerror(code));
}

static int process(libraw_data_t *raw, found *f, uint64_t most)
{
    int code = libraw_unpack(raw);
    if (code == LIBRAW_SUCCESS)
        code = libraw_dcraw_process(raw);
    if (code != LIBRAW_SUCCESS)
        return fail(code, &f->why);
    libraw_processed_image_t *image = libraw_dcraw_make_mem_image(raw, &code);
    if (!image)
        return fail(code, &f->why);
    f->code_light = 1.0f / fmaxf((float)raw->color.maximum, 1.0f); /* less black: it was subtracted */
    const int failed = take(f, most, image);
    libraw_dcraw_clear_mem(image);
    return failed;
}

static int decode(found *f, const pupil_still *still, uint64_t most, const uint8_t *bytes, size_t size)
{
    libraw_data_t *raw = libraw_init(0);
    if (!raw)
        return pupil_still_fail(&f->why, "not enough memory");
    int failed;
    set_params(&raw->params, still->as_stored);
    libraw_set_dataerror_handler(raw, NULL, NULL);                            /* its own writes to standard error */
    const int code = libraw_open_buffer(raw, (void *)(uintptr_t)bytes, size); /* which it only reads */
    const libraw_image_sizes_t *sizes = &raw->sizes;
    if (code == LIBRAW_FILE_UNSUPPORTED)
        failed = -pupil_still_fail(&f->why, "is not a raw file that LibRaw knows"); /* PUPIL_STILL_NOT_RAW */
    else if (code != LIBRAW_SUCCESS)
        failed = fail(code, &f->why);
    else if (pupil_still_size_ok(sizes->raw_width, sizes->raw_height, &f->why))
        failed = -1;
    else
        failed = process(raw, f, most);
    libraw_close(raw);
    return failed;
}

static int copy(pupil_still *still, const found *f, pupil_why *why)
{
    const uint16_t *from = (const uint16_t *)(const void *)(f + 1);
    const size_t samples = (size_t)f->width * f->height * 3;
    if (pupil_still_reserve(still, f->width, f->height, PUPIL_PIXEL_RGB32F, why))
        return -1;
    still->code_light = f->code_light;
    float *to = still->pixels;
    for (size_t i = 0; i < samples; i++)
        to[i] = (float)from[i] / 65535.0f;
    return 0;
}

/* The child's work, with limited CPU time: a damaged file may keep it busy for ever. */
static _Noreturn void child(found *f, const pupil_still *still, uint64_t most, const uint8_t *bytes, size_t size)
{
    const struct rlimit seconds = {MOST_SECONDS, MOST_SECONDS}, none = {0, 0};
    static const int deadly[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    for (size_t i = 0; i < sizeof deadly / sizeof *deadly; i++)
        signal(deadly[i], SIG_DFL); /* not the parent's handlers */
    setrlimit(RLIMIT_CPU, &seconds);
    setrlimit(RLIMIT_CORE, &none);
    f->result = decode(f, still, most, bytes, size);
    _exit(0);
}

/* LibRaw runs in a process of its own: 0.20 crashes on some damaged files (a DNG with a changed bit, found by
 * tests/fuzz/fuzz_dng.c), and that must affect this still only. */
int pupil_read_raw(pupil_still *still, const uint8_t *bytes, size_t size, pupil_why *why)
{
    const uint64_t most = pupil_still_most(still);
    const uint64_t bytes_of_most = sizeof(found) + most * 3 * sizeof(uint16_t); /* allocated only when it is written */
    int status = 0, failed = -1;
    if (bytes_of_most > SIZE_MAX / 2) /* --max-pixels of a 32-bit machine */
        return pupil_still_fail(why, "not enough memory");
    const size_t room = (size_t)bytes_of_most;
    found *f = mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (f == MAP_FAILED)
        return pupil_still_fail(why, "not enough memory");
    const pid_t id = fork();
    if (id == 0)
        child(f, still, most, bytes, size);
    while (id > 0 && waitpid(id, &status, 0) < 0 && errno == EINTR)
        ;
    if (id < 0)
        pupil_still_fail(why, "no process for LibRaw: %s", strerror(errno));
    else if (!WIFEXITED(status) || WEXITSTATUS(status))
        pupil_still_fail(why, "is damaged: LibRaw crashes on it, or takes over %d seconds", MOST_SECONDS);
    else
        failed = f->result ? f->result : copy(still, f, why);
    if (failed && *f->why.text)
        pupil_refuse(why, "%s", f->why.text);
    munmap(f, room);
    return failed;
}

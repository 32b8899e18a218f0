/* apps/lab/bench/gles_subject.h: a frame, and what the GPU and, for comparison, one CPU thread run on it. */
#ifndef PUPIL_APPS_LAB_BENCH_GLES_SUBJECT_H
#define PUPIL_APPS_LAB_BENCH_GLES_SUBJECT_H

#include "clock.h"
#include "frame/gl_calls.h"
#include "pupil/error.h"
#include "pupil/gles.h"

typedef enum bench_part {
    BENCH_GLES_COPY = 0,  /* a plain copy of as many bytes: texture to texture, memory to memory */
    BENCH_GLES_UPLOAD,    /* into the GPU's textures; nothing on the CPU */
    BENCH_GLES_METER,     /* without a histogram */
    BENCH_GLES_HISTOGRAM, /* with it, if the context can */
    BENCH_GLES_MAP,
    BENCH_GLES_FRAME, /* upload, meter, map; on the CPU meter, then map */
    BENCH_GLES_PARTS
} bench_part;

extern const char *const bench_part_names[BENCH_GLES_PARTS];

typedef struct bench_gles_error {
    double log_average; /* relative, against the CPU's */
    int code;           /* largest distance of a display sample to the CPU's, codes */
    double off;         /* share of samples that differ from the CPU's */
} bench_gles_error;

typedef struct bench_gles_subject {
    const gl_calls *gl;
    unsigned frames; /* back to back, before the one wait */
    pupil_image_const in;
    pupil_image cpu_out, gpu_out; /* RGBA8 */
    unsigned char *copy;
    size_t bytes;
    pupil_t plain, counting; /* without and with a histogram */
    pupil_gles gles, gles_counting;
    int open, open_counting;
    pupil_stats stats;
    pupil_curve curve;
    GLuint framebuffer, renderbuffer;      /* what the GPU maps to */
    GLuint texture[2], copied_framebuffer; /* the plain copy's */
    GLsizei copy_width, copy_height;
    int error; /* the first error of a library call */
} bench_gles_subject;

/* The easy frame of a format (frames.h) in the current context. 0, or -1 and a sentence. Closing takes what a failed
 * opening left. */
int bench_gles_open(bench_gles_subject *s, const gl_calls *gl, pupil_gles_get_proc get_proc, uint32_t version,
                    uint32_t pixel, uint32_t width, uint32_t height, pupil_why *why);
void bench_gles_close(bench_gles_subject *s);

/* The function that runs a part; NULL: there is none. The context is the subject. The GPU runs as many frames as the
 * subject says, the CPU one. */
typedef void bench_gles_run(void *subject);
bench_gles_run *bench_gles_gpu(const bench_gles_subject *s, bench_part part);
bench_gles_run *bench_gles_cpu(bench_part part);

/* GPU against CPU on the frame that is timed. 0, or -1 and a sentence. */
int bench_gles_compare(bench_gles_subject *s, bench_gles_error *error, pupil_why *why);

#endif

/* tests/gles/gl_shim.h: a get_proc between lib/gles and the driver. It counts every call, checks pupil_gles's promises
 * about them, and can make any of them fail.
 *
 *     gl_shim_begin();                       // forgets everything
 *     shim.fault = GL_FAULT_COMPILE, shim.nth = 2;
 *     pupil_gles_init(&gles, &config, &pupil, gl_shim_get_proc, &why);
 *     ... shim.alive, shim.breaches, gl_shim_calls("FenceSync")
 *
 * Breaches are printed as they happen. One context at a time.
 */
#ifndef PUPIL_TESTS_GL_SHIM_H
#define PUPIL_TESTS_GL_SHIM_H

#include "pupil/gles.h"

/* What fails; shim.nth says which time, from 1. */
typedef enum gl_fault {
    GL_FAULT_NONE = 0,
    GL_FAULT_MEMORY,     /* Gen*, Create*, TexStorage2D, BufferData: GL_OUT_OF_MEMORY, and nothing is made */
    GL_FAULT_COMPILE,    /* a shader's compile status, with a log: "made up" */
    GL_FAULT_SOURCE,     /* a shader's source gets a line that no compiler takes: "#error broken on purpose" */
    GL_FAULT_LINK,       /* a program's link status, with a log: "made up" */
    GL_FAULT_INCOMPLETE, /* a framebuffer's status */
    GL_FAULT_FENCE,      /* FenceSync gives NULL and GL_OUT_OF_MEMORY */
    GL_FAULT_WAIT,       /* ClientWaitSync gives GL_WAIT_FAILED and GL_OUT_OF_MEMORY */
    GL_FAULT_MAP,        /* MapBufferRange gives NULL and GL_OUT_OF_MEMORY */
    GL_FAULT_UNMAP       /* UnmapBuffer says that the content was lost */
} gl_fault;

typedef enum gl_context { GL_CONTEXT_OWN = 0, GL_CONTEXT_NONE, GL_CONTEXT_OTHER } gl_context;

typedef struct gl_shim {
    /* for the test to set */
    gl_fault fault;
    unsigned nth;
    const char *missing;   /* a function that get_proc does not find */
    const char *hidden;    /* an extension that is not listed */
    const char *version;   /* GL_VERSION's */
    int32_t largest_side;  /* GL_MAX_TEXTURE_SIZE's; 0: the driver's */
    gl_context context;    /* eglGetCurrentContext's */
    int lost;              /* as in a lost context: calls do nothing and return 0, and the reset status says so */
    unsigned long lose_at; /* it is lost at this call, from 1; 0: never */
    int ready;             /* from now on no object may be made */
    unsigned late;         /* 0: the driver's own time. n: a fence signals exactly when shim.frame is n more than when
                            * it was made (the shim waits for it, not pupil_gles) */
    unsigned long frame;   /* the test's frame number */
    /* for the test to read */
    unsigned long total;    /* calls */
    unsigned long waits;    /* of ClientWaitSync with a timeout */
    unsigned long breaches; /* broken promises */
    int fired;              /* the fault has happened */
    int alive;              /* objects and fences made and not yet deleted */
    uint32_t error;         /* the next glGetError, for errors made by the shim */
} gl_shim;

extern gl_shim shim;

/* Resets everything. Leftover objects are deleted: the context must be current, or gone and `in_context` 0. */
void gl_shim_begin(int in_context);

pupil_gles_function gl_shim_get_proc(const char *name);

/* How often a function was called: "FenceSync". */
unsigned long gl_shim_calls(const char *name);

/* Whether the context can report that it is lost: pupil_gles found a function for that. */
int gl_shim_tells_of_loss(void);

/* The name of the i-th function that is used of OpenGL ES 3.0, or with has_31 of 3.1; NULL: there are no more. */
const char *gl_shim_function(int i, int has_31);

#endif

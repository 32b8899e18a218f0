/* tests/gles/gl_shim_private.h: shared by gl_shim.c, gl_shim_calls.c and gl_shim_fences.c. */
#ifndef PUPIL_TESTS_GL_SHIM_PRIVATE_H
#define PUPIL_TESTS_GL_SHIM_PRIVATE_H

#include "gl_shim.h"
#include "gles/gl_functions.h"

enum {
#define CALL_NUMBER(NAME, TYPE) CALL_##NAME,
    GL_FUNCTIONS_30(CALL_NUMBER) CALLS_30,
    CALL_BEFORE_31 = CALLS_30 - 1,
    GL_FUNCTIONS_31(CALL_NUMBER) CALLS
};

/* The functions that gl_shim_get_proc returns. */
#define CALL_DECLARED(NAME, TYPE) __typeof__(*(PFNGL##TYPE##PROC)0) shim_##NAME;
GL_FUNCTIONS_30(CALL_DECLARED)
GL_FUNCTIONS_31(CALL_DECLARED)

/* The driver's. */
extern gl_functions shim_driver;

typedef enum kind { BUFFER, TEXTURE, FRAMEBUFFER, SAMPLER, VERTEX_ARRAY, SHADER, PROGRAM, FENCE } kind;

typedef struct thing {
    kind kind;
    GLuint name;
    GLsync sync;         /* of a fence; of a buffer: the fence after the GPU's write, or NULL */
    int written;         /* of a buffer: by the GPU, and no later fence was seen to have signalled */
    unsigned long frame; /* of a fence: the frame that it was made in */
} thing;

#define THINGS 256
extern thing shim_things[THINGS]; /* the first shim.alive */

void shim_breach(const char *what, unsigned long which);
void shim_make(thing made);
void shim_unmake(kind which, GLuint name, GLsync sync);
thing *shim_find(kind which, GLuint name, GLsync sync);

/* Counts a call. 1: the context is lost, it must do nothing. */
int shim_enter(int call);
/* Whether this call is the one to fail. */
int shim_turn_of(gl_fault fault);
/* The same, with GL_OUT_OF_MEMORY as the error; as in GL, the first error is kept until it is read. */
int shim_fails(gl_fault fault);

/* Of buffers. */
void shim_forget_bindings(void);

#endif

#include "gl_functions.h"

const char *pupil_gl_functions_find(gl_functions *gl, int has_31, pupil_gles_get_proc get_proc)
{
    const char *missing = 0; /* the first one */
#define FIND_FUNCTION(NAME, TYPE)                                                                                      \
    gl->NAME = (PFNGL##TYPE##PROC)get_proc("gl" #NAME);                                                                \
    missing = missing || gl->NAME ? missing : "gl" #NAME;
    GL_FUNCTIONS_30(FIND_FUNCTION)
    if (has_31) {
        GL_FUNCTIONS_31(FIND_FUNCTION)
    }
    return missing;
}

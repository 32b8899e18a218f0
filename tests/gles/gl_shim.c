#include <stdio.h>
#include <string.h>

#include "egl/egl_context.h"
#include "gl_shim_private.h"

#define GUILTY_CONTEXT_RESET 0x8253 /* OpenGL ES 3.2, KHR_robustness */

gl_shim shim;
gl_functions shim_driver;

static const char *const call_names[CALLS] = {
#define CALL_NAME(NAME, TYPE) "gl" #NAME,
    GL_FUNCTIONS_30(CALL_NAME) GL_FUNCTIONS_31(CALL_NAME)};

static unsigned long calls[CALLS];

static int number_of(const char *name)
{
    int i = 0;
    while (i < CALLS && strcmp(call_names[i] + 2, name) != 0)
        i++;
    return i;
}

unsigned long gl_shim_calls(const char *name)
{
    const int i = number_of(name);
    return i < CALLS ? calls[i] : 0;
}

const char *gl_shim_function(int i, int has_31)
{
    return i < (has_31 ? CALLS : CALLS_30) ? call_names[i] : NULL;
}

/* --- live objects --- */

thing shim_things[THINGS];

void shim_breach(const char *what, unsigned long which)
{
    shim.breaches++;
    printf("breach, frame %lu: %s (%lu)\n", shim.frame, what, which);
}

void shim_make(thing made)
{
    if (made.kind != FENCE && shim.ready)
        shim_breach("an object is made after init, of kind", made.kind);
    if (shim.alive == THINGS)
        shim_breach("too many objects", THINGS);
    else
        shim_things[shim.alive++] = made;
}

thing *shim_find(kind which, GLuint name, GLsync sync)
{
    for (int i = 0; i < shim.alive; i++)
        if (shim_things[i].kind == which &&
            (which == FENCE ? shim_things[i].sync == sync : shim_things[i].name == name))
            return &shim_things[i];
    return NULL;
}

void shim_unmake(kind which, GLuint name, GLsync sync)
{
    thing *gone = shim_find(which, name, sync);
    if (!name && !sync) /* allowed, and nothing happens */
        return;
    if (gone)
        *gone = shim_things[--shim.alive];
    else
        shim_breach("what was not made, or is gone, is deleted", name);
}

static void delete_rest(void)
{
    while (shim.alive) {
        const thing rest = shim_things[--shim.alive];
        switch (rest.kind) {
        case BUFFER:
            shim_driver.DeleteBuffers(1, &rest.name);
            break;
        case TEXTURE:
            shim_driver.DeleteTextures(1, &rest.name);
            break;
        case FRAMEBUFFER:
            shim_driver.DeleteFramebuffers(1, &rest.name);
            break;
        case SAMPLER:
            shim_driver.DeleteSamplers(1, &rest.name);
            break;
        case VERTEX_ARRAY:
            shim_driver.DeleteVertexArrays(1, &rest.name);
            break;
        case SHADER:
            shim_driver.DeleteShader(rest.name);
            break;
        case PROGRAM:
            shim_driver.DeleteProgram(rest.name);
            break;
        default:
            shim_driver.DeleteSync(rest.sync);
            break;
        }
    }
}

/* --- faults --- */

int shim_enter(int call)
{
    calls[call]++;
    shim.total++;
    if (shim.total == shim.lose_at)
        shim.lost = 1;
    return shim.lost;
}

int shim_turn_of(gl_fault fault)
{
    if (shim.fault != fault || shim.fired || --shim.nth)
        return 0;
    return shim.fired = 1;
}

int shim_fails(gl_fault fault)
{
    if (!shim_turn_of(fault))
        return 0;
    shim.error = GL_OUT_OF_MEMORY;
    return 1;
}

/* --- get_proc --- */

static int tells_of_loss;

int gl_shim_tells_of_loss(void)
{
    return tells_of_loss;
}

static GLenum GL_APIENTRY my_reset_status(void)
{
    return shim.lost ? GUILTY_CONTEXT_RESET : GL_NO_ERROR;
}

static void *my_current_context(void)
{
    static int other;
    if (shim.context)
        return shim.context == GL_CONTEXT_NONE ? NULL : &other;
    return ((void *(*)(void))pupil_egl_get_proc("eglGetCurrentContext"))();
}

static const pupil_gles_function mine[CALLS] = {
#define CALL_MINE(NAME, TYPE) (pupil_gles_function) shim_##NAME,
    GL_FUNCTIONS_30(CALL_MINE) GL_FUNCTIONS_31(CALL_MINE)};

void gl_shim_begin(int in_context)
{
    if (in_context)
        delete_rest();
    shim = (gl_shim){0};
    tells_of_loss = 0;
    memset(calls, 0, sizeof calls);
    shim_forget_bindings();
}

pupil_gles_function gl_shim_get_proc(const char *name)
{
    const pupil_gles_function found = pupil_egl_get_proc(name);
    if (!found || (shim.missing && !strcmp(shim.missing, name)))
        return NULL;
    if (!strcmp(name, "eglGetCurrentContext"))
        return (pupil_gles_function)my_current_context;
    if (!strncmp(name, "glGetGraphicsResetStatus", strlen("glGetGraphicsResetStatus"))) {
        tells_of_loss = 1;
        return (pupil_gles_function)my_reset_status;
    }
    const int i = strncmp(name, "gl", 2) ? CALLS : number_of(name + 2);
    if (i == CALLS) {
        shim_breach(name, 0);
        return NULL;
    }
#define CALL_DRIVER(NAME, TYPE)                                                                                        \
    if (i == CALL_##NAME)                                                                                              \
        shim_driver.NAME = (PFNGL##TYPE##PROC)found;
    GL_FUNCTIONS_30(CALL_DRIVER)
    GL_FUNCTIONS_31(CALL_DRIVER)
    return mine[i];
}

#include "gl_calls.h"

#include "refuse.h"
#include <stdio.h>
#include <string.h>

int gl_calls_load(gl_calls *gl, pupil_gles_get_proc get_proc, pupil_why *why)
{
    const char *missing = NULL; /* the first one */
#define GL_LOAD(type, name)                                                                                            \
    gl->name = (type)get_proc("gl" #name);                                                                             \
    missing = missing || gl->name ? missing : "gl" #name;
    GL_CALLS(GL_LOAD)
#undef GL_LOAD
    if (missing)
        pupil_refuse(why, "the driver has no %s, which OpenGL ES 3.0 has", missing);
    return missing ? -1 : 0;
}

static GLuint shader(const gl_calls *gl, GLenum kind, GLuint program, const char *text)
{
    const GLuint s = gl->CreateShader(kind);
    gl->ShaderSource(s, 1, &text, NULL);
    gl->CompileShader(s);
    gl->AttachShader(program, s);
    return s;
}

GLuint gl_calls_program(const gl_calls *gl, const char *vertex, const char *fragment)
{
    GLint linked = 0;
    GLuint program = gl->CreateProgram();
    const GLuint v = shader(gl, GL_VERTEX_SHADER, program, vertex);
    const GLuint f = shader(gl, GL_FRAGMENT_SHADER, program, fragment);
    gl->LinkProgram(program); /* fails if a shader was not compiled */
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    gl->DeleteShader(v);
    gl->DeleteShader(f);
    if (!linked) {
        gl->DeleteProgram(program);
        program = 0;
    }
    return program;
}

const char *gl_calls_software(const gl_calls *gl)
{
    static const char *const known[] = {"llvmpipe", "softpipe", "swrast", "lavapipe", "SwiftShader"};
    const char *renderer = (const char *)gl->GetString(GL_RENDERER);
    for (size_t i = 0; renderer && i < sizeof known / sizeof known[0]; i++)
        if (strcasestr(renderer, known[i]))
            return known[i];
    return NULL;
}

void gl_calls_begin(const gl_calls *gl, GLuint framebuffer, GLsizei width, GLsizei height)
{
    static const GLenum off[] = {GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST, GL_STENCIL_TEST, GL_SCISSOR_TEST, GL_DITHER};
    for (size_t i = 0; i < sizeof off / sizeof off[0]; i++)
        gl->Disable(off[i]);
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl->Viewport(0, 0, width, height);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

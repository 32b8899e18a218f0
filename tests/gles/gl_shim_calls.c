/* The calls: most are passed on, some are watched, some can fail. */
#include "gl_shim_private.h"

#include <stdio.h>
#include <string.h>

#define CONTEXT_LOST 0x0507 /* OpenGL ES 3.2 */

/* --- passed on --- */

#define PASS(NAME, PARAMETERS, ARGUMENTS)                                                                              \
    void GL_APIENTRY shim_##NAME PARAMETERS                                                                            \
    {                                                                                                                  \
        if (!shim_enter(CALL_##NAME))                                                                                  \
            shim_driver.NAME ARGUMENTS;                                                                                \
    }

PASS(ActiveTexture, (GLenum a), (a))
PASS(AttachShader, (GLuint a, GLuint b), (a, b))
PASS(BindFramebuffer, (GLenum a, GLuint b), (a, b))
PASS(BindSampler, (GLuint a, GLuint b), (a, b))
PASS(BindTexture, (GLenum a, GLuint b), (a, b))
PASS(BindVertexArray, (GLuint a), (a))
PASS(BlendEquation, (GLenum a), (a))
PASS(BlendFunc, (GLenum a, GLenum b), (a, b))
PASS(Clear, (GLbitfield a), (a))
PASS(ClearColor, (GLfloat a, GLfloat b, GLfloat c, GLfloat d), (a, b, c, d))
PASS(ColorMask, (GLboolean a, GLboolean b, GLboolean c, GLboolean d), (a, b, c, d))
PASS(CompileShader, (GLuint a), (a))
PASS(Disable, (GLenum a), (a))
PASS(DrawArrays, (GLenum a, GLint b, GLsizei c), (a, b, c))
PASS(Enable, (GLenum a), (a))
PASS(Flush, (void), ())
PASS(FramebufferTexture2D, (GLenum a, GLenum b, GLenum c, GLuint d, GLint e), (a, b, c, d, e))
PASS(LinkProgram, (GLuint a), (a))
PASS(MemoryBarrier, (GLbitfield a), (a))
PASS(PixelStorei, (GLenum a, GLint b), (a, b))
PASS(SamplerParameteri, (GLuint a, GLenum b, GLint c), (a, b, c))
PASS(Scissor, (GLint a, GLint b, GLsizei c, GLsizei d), (a, b, c, d))
PASS(TexParameteri, (GLenum a, GLenum b, GLint c), (a, b, c))
PASS(TexSubImage2D, (GLenum a, GLint b, GLint c, GLint d, GLsizei e, GLsizei f, GLenum g, GLenum h, const void *i),
     (a, b, c, d, e, f, g, h, i))
PASS(Uniform1f, (GLint a, GLfloat b), (a, b))
PASS(Uniform1i, (GLint a, GLint b), (a, b))
PASS(Uniform1ui, (GLint a, GLuint b), (a, b))
PASS(Uniform2f, (GLint a, GLfloat b, GLfloat c), (a, b, c))
PASS(Uniform2i, (GLint a, GLint b, GLint c), (a, b, c))
PASS(Uniform2ui, (GLint a, GLuint b, GLuint c), (a, b, c))
PASS(Uniform3f, (GLint a, GLfloat b, GLfloat c, GLfloat d), (a, b, c, d))
PASS(Uniform4f, (GLint a, GLfloat b, GLfloat c, GLfloat d, GLfloat e), (a, b, c, d, e))
PASS(Uniform4i, (GLint a, GLint b, GLint c, GLint d, GLint e), (a, b, c, d, e))
PASS(Uniform4iv, (GLint a, GLsizei b, const GLint *c), (a, b, c))
PASS(Uniform4ui, (GLint a, GLuint b, GLuint c, GLuint d, GLuint e), (a, b, c, d, e))
PASS(Uniform4fv, (GLint a, GLsizei b, const GLfloat *c), (a, b, c))
PASS(Uniform4uiv, (GLint a, GLsizei b, const GLuint *c), (a, b, c))
PASS(UniformMatrix3fv, (GLint a, GLsizei b, GLboolean c, const GLfloat *d), (a, b, c, d))
PASS(UseProgram, (GLuint a), (a))
PASS(Viewport, (GLint a, GLint b, GLsizei c, GLsizei d), (a, b, c, d))

/* --- calls that make and delete --- */

#define GEN(NAME, KIND)                                                                                                \
    void GL_APIENTRY shim_Gen##NAME(GLsizei count, GLuint *names)                                                      \
    {                                                                                                                  \
        if (shim_enter(CALL_Gen##NAME) || shim_fails(GL_FAULT_MEMORY))                                                 \
            return;                                                                                                    \
        shim_driver.Gen##NAME(count, names);                                                                           \
        for (GLsizei i = 0; i < count; i++)                                                                            \
            shim_make((thing){.kind = KIND, .name = names[i]});                                                        \
    }                                                                                                                  \
    void GL_APIENTRY shim_Delete##NAME(GLsizei count, const GLuint *names)                                             \
    {                                                                                                                  \
        if (shim_enter(CALL_Delete##NAME))                                                                             \
            return;                                                                                                    \
        for (GLsizei i = 0; i < count; i++)                                                                            \
            shim_unmake(KIND, names[i], NULL);                                                                         \
        shim_driver.Delete##NAME(count, names);                                                                        \
    }

GEN(Buffers, BUFFER)
GEN(Framebuffers, FRAMEBUFFER)
GEN(Samplers, SAMPLER)
GEN(Textures, TEXTURE)
GEN(VertexArrays, VERTEX_ARRAY)

GLuint GL_APIENTRY shim_CreateShader(GLenum type)
{
    if (shim_enter(CALL_CreateShader) || shim_fails(GL_FAULT_MEMORY))
        return 0;
    const GLuint name = shim_driver.CreateShader(type);
    shim_make((thing){.kind = SHADER, .name = name});
    return name;
}

GLuint GL_APIENTRY shim_CreateProgram(void)
{
    if (shim_enter(CALL_CreateProgram) || shim_fails(GL_FAULT_MEMORY))
        return 0;
    const GLuint name = shim_driver.CreateProgram();
    shim_make((thing){.kind = PROGRAM, .name = name});
    return name;
}

void GL_APIENTRY shim_DeleteShader(GLuint name)
{
    if (shim_enter(CALL_DeleteShader))
        return;
    shim_unmake(SHADER, name, NULL);
    shim_driver.DeleteShader(name);
}

void GL_APIENTRY shim_DeleteProgram(GLuint name)
{
    if (shim_enter(CALL_DeleteProgram))
        return;
    shim_unmake(PROGRAM, name, NULL);
    shim_driver.DeleteProgram(name);
}

void GL_APIENTRY shim_TexStorage2D(GLenum target, GLsizei levels, GLenum internal, GLsizei width, GLsizei height)
{
    if (shim.ready)
        shim_breach("memory of a texture after init, pixels", (unsigned long)(width * height));
    if (!shim_enter(CALL_TexStorage2D) && !shim_fails(GL_FAULT_MEMORY))
        shim_driver.TexStorage2D(target, levels, internal, width, height);
}

void GL_APIENTRY shim_BufferData(GLenum target, GLsizeiptr size, const void *data, GLenum usage)
{
    if (shim.ready)
        shim_breach("memory of a buffer after init, bytes", (unsigned long)size);
    if (!shim_enter(CALL_BufferData) && !shim_fails(GL_FAULT_MEMORY))
        shim_driver.BufferData(target, size, data, usage);
}

/* --- shaders --- */

static const char made_up[] = "0:7: made up";

void GL_APIENTRY shim_ShaderSource(GLuint shader, GLsizei count, const GLchar *const *texts, const GLint *lengths)
{
    const GLchar *more[64];
    if (shim_enter(CALL_ShaderSource))
        return;
    if (shim_turn_of(GL_FAULT_SOURCE) && !lengths && count < 64) {
        memcpy(more, texts, (size_t)count * sizeof *more);
        more[count++] = "\n#error broken on purpose\n";
        texts = more;
    }
    shim_driver.ShaderSource(shader, count, texts, lengths);
}

void GL_APIENTRY shim_GetShaderiv(GLuint shader, GLenum what, GLint *value)
{
    if (shim_enter(CALL_GetShaderiv))
        return;
    shim_driver.GetShaderiv(shader, what, value);
    if (what == GL_COMPILE_STATUS && shim_turn_of(GL_FAULT_COMPILE))
        *value = GL_FALSE;
}

void GL_APIENTRY shim_GetProgramiv(GLuint program, GLenum what, GLint *value)
{
    if (shim_enter(CALL_GetProgramiv))
        return;
    shim_driver.GetProgramiv(program, what, value);
    if (what == GL_LINK_STATUS && shim_turn_of(GL_FAULT_LINK))
        *value = GL_FALSE;
}

void GL_APIENTRY shim_GetShaderInfoLog(GLuint shader, GLsizei bytes, GLsizei *length, GLchar *text)
{
    if (shim_enter(CALL_GetShaderInfoLog))
        return;
    if (shim.fault == GL_FAULT_COMPILE)
        snprintf(text, (size_t)bytes, "%s", made_up);
    else
        shim_driver.GetShaderInfoLog(shader, bytes, length, text);
}

void GL_APIENTRY shim_GetProgramInfoLog(GLuint program, GLsizei bytes, GLsizei *length, GLchar *text)
{
    if (shim_enter(CALL_GetProgramInfoLog))
        return;
    if (shim.fault == GL_FAULT_LINK)
        snprintf(text, (size_t)bytes, "%s", made_up);
    else
        shim_driver.GetProgramInfoLog(program, bytes, length, text);
}

GLint GL_APIENTRY shim_GetUniformLocation(GLuint program, const GLchar *name)
{
    return shim_enter(CALL_GetUniformLocation) ? 0 : shim_driver.GetUniformLocation(program, name);
}

GLenum GL_APIENTRY shim_CheckFramebufferStatus(GLenum target)
{
    if (shim_enter(CALL_CheckFramebufferStatus))
        return 0;
    return shim_turn_of(GL_FAULT_INCOMPLETE) ? GL_FRAMEBUFFER_UNSUPPORTED : shim_driver.CheckFramebufferStatus(target);
}

/* --- what the context reports --- */

GLenum GL_APIENTRY shim_GetError(void)
{
    if (shim_enter(CALL_GetError))
        return CONTEXT_LOST;
    const GLenum made = shim.error, own = shim_driver.GetError();
    shim.error = GL_NO_ERROR;
    return made ? made : own;
}

const GLubyte *GL_APIENTRY shim_GetString(GLenum name)
{
    if (shim_enter(CALL_GetString))
        return NULL;
    return name == GL_VERSION && shim.version ? (const GLubyte *)shim.version : shim_driver.GetString(name);
}

const GLubyte *GL_APIENTRY shim_GetStringi(GLenum name, GLuint index)
{
    if (shim_enter(CALL_GetStringi))
        return NULL;
    const GLubyte *text = shim_driver.GetStringi(name, index);
    return shim.hidden && text && !strcmp((const char *)text, shim.hidden) ? (const GLubyte *)"GL_hidden" : text;
}

void GL_APIENTRY shim_GetIntegerv(GLenum name, GLint *value)
{
    if (shim_enter(CALL_GetIntegerv))
        return;
    shim_driver.GetIntegerv(name, value);
    if (name == GL_MAX_TEXTURE_SIZE && shim.largest_side)
        *value = shim.largest_side;
}

#include "vm/read_texels.h"

#include <GLES3/gl3.h>
#include <stdio.h>

#include "egl/egl_context.h"

static const char vertex[] = "#version 300 es\n"
                             "void main() {\n"
                             "    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);\n"
                             "    gl_Position = vec4(corner * 4.0 - 1.0, 0.0, 1.0);\n"
                             "}\n";
static const char fragment[] = "#version 300 es\n"
                               "precision highp float;\n"
                               "precision highp int;\n"
                               "uniform highp sampler2D source;\n"
                               "uniform float largest;\n"
                               "out uvec4 codes;\n"
                               "void main() {\n"
                               "    vec4 texel = texelFetch(source, ivec2(gl_FragCoord.xy), 0);\n"
                               "    codes = uvec4(texel * largest + 0.5);\n"
                               "}\n";

#define FUNCTIONS(X)                                                                                                   \
    X(PFNGLCREATESHADERPROC, glCreateShader)                                                                           \
    X(PFNGLSHADERSOURCEPROC, glShaderSource)                                                                           \
    X(PFNGLCOMPILESHADERPROC, glCompileShader)                                                                         \
    X(PFNGLCREATEPROGRAMPROC, glCreateProgram)                                                                         \
    X(PFNGLATTACHSHADERPROC, glAttachShader)                                                                           \
    X(PFNGLLINKPROGRAMPROC, glLinkProgram)                                                                             \
    X(PFNGLGETPROGRAMIVPROC, glGetProgramiv)                                                                           \
    X(PFNGLUSEPROGRAMPROC, glUseProgram)                                                                               \
    X(PFNGLGETUNIFORMLOCATIONPROC, glGetUniformLocation)                                                               \
    X(PFNGLUNIFORM1FPROC, glUniform1f)                                                                                 \
    X(PFNGLGENVERTEXARRAYSPROC, glGenVertexArrays)                                                                     \
    X(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray)                                                                     \
    X(PFNGLGENRENDERBUFFERSPROC, glGenRenderbuffers)                                                                   \
    X(PFNGLBINDRENDERBUFFERPROC, glBindRenderbuffer)                                                                   \
    X(PFNGLRENDERBUFFERSTORAGEPROC, glRenderbufferStorage)                                                             \
    X(PFNGLGENFRAMEBUFFERSPROC, glGenFramebuffers)                                                                     \
    X(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer)                                                                     \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, glFramebufferRenderbuffer)                                                     \
    X(PFNGLACTIVETEXTUREPROC, glActiveTexture)                                                                         \
    X(PFNGLBINDTEXTUREPROC, glBindTexture)                                                                             \
    X(PFNGLBINDSAMPLERPROC, glBindSampler)                                                                             \
    X(PFNGLBINDBUFFERPROC, glBindBuffer)                                                                               \
    X(PFNGLVIEWPORTPROC, glViewport)                                                                                   \
    X(PFNGLDISABLEPROC, glDisable)                                                                                     \
    X(PFNGLCOLORMASKPROC, glColorMask)                                                                                 \
    X(PFNGLDRAWARRAYSPROC, glDrawArrays)                                                                               \
    X(PFNGLREADPIXELSPROC, glReadPixels)                                                                               \
    X(PFNGLGETERRORPROC, glGetError)

#define DECLARE(type, name) type name;
static struct {
    FUNCTIONS(DECLARE)
} gl;

static GLuint program, vertex_array, renderbuffer, framebuffer;

static GLuint compile(GLenum kind, const char *source)
{
    GLuint shader = gl.glCreateShader(kind);
    gl.glShaderSource(shader, 1, &source, NULL);
    gl.glCompileShader(shader);
    return shader;
}

int read_texels_open(void)
{
    GLint linked = 0;
#define LOOK_UP(type, name) gl.name = (type)pupil_egl_get_proc(#name);
    FUNCTIONS(LOOK_UP)
    program = gl.glCreateProgram();
    gl.glAttachShader(program, compile(GL_VERTEX_SHADER, vertex));
    gl.glAttachShader(program, compile(GL_FRAGMENT_SHADER, fragment));
    gl.glLinkProgram(program);
    gl.glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) {
        printf("the shader that reads texels does not link\n");
        return -1;
    }
    gl.glGenVertexArrays(1, &vertex_array);
    gl.glGenRenderbuffers(1, &renderbuffer);
    gl.glGenFramebuffers(1, &framebuffer);
    return 0;
}

int read_texels(uint32_t texture, uint32_t width, uint32_t height, uint32_t largest, uint32_t *codes)
{
    gl.glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    gl.glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32UI, (GLsizei)width, (GLsizei)height);
    gl.glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffer);
    gl.glUseProgram(program);
    gl.glUniform1f(gl.glGetUniformLocation(program, "largest"), (float)largest);
    gl.glBindVertexArray(vertex_array);
    gl.glActiveTexture(GL_TEXTURE0);
    gl.glBindTexture(GL_TEXTURE_2D, texture);
    gl.glBindSampler(0, 0);
    gl.glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    gl.glViewport(0, 0, (GLsizei)width, (GLsizei)height);
    gl.glDisable(GL_SCISSOR_TEST);
    gl.glDisable(GL_RASTERIZER_DISCARD);
    gl.glColorMask(1, 1, 1, 1);
    gl.glDrawArrays(GL_TRIANGLES, 0, 3);
    gl.glReadPixels(0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA_INTEGER, GL_UNSIGNED_INT, codes);
    gl.glBindFramebuffer(GL_FRAMEBUFFER, 0);
    GLenum error = gl.glGetError();
    if (error != GL_NO_ERROR)
        printf("reading texels: OpenGL's error 0x%x\n", error);
    return error == GL_NO_ERROR ? 0 : -1;
}

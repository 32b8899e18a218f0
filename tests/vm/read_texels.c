#include "vm/read_texels.h"

#include <GLES3/gl3.h>
#include <stdio.h>

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

static GLuint program, vertex_array, renderbuffer, framebuffer;

static GLuint compile(GLenum kind, const char *source)
{
    GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, NULL);
    glCompileShader(shader);
    return shader;
}

int read_texels_open(void)
{
    GLint linked = 0;
    program = glCreateProgram();
    glAttachShader(program, compile(GL_VERTEX_SHADER, vertex));
    glAttachShader(program, compile(GL_FRAGMENT_SHADER, fragment));
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) {
        printf("the shader that reads texels does not link\n");
        return -1;
    }
    glGenVertexArrays(1, &vertex_array);
    glGenRenderbuffers(1, &renderbuffer);
    glGenFramebuffers(1, &framebuffer);
    return 0;
}

int read_texels(uint32_t texture, uint32_t width, uint32_t height, uint32_t largest, uint32_t *codes)
{
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32UI, (GLsizei)width, (GLsizei)height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffer);
    glUseProgram(program);
    glUniform1f(glGetUniformLocation(program, "largest"), (float)largest);
    glBindVertexArray(vertex_array);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, texture);
    glBindSampler(0, 0);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glViewport(0, 0, (GLsizei)width, (GLsizei)height);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_RASTERIZER_DISCARD);
    glColorMask(1, 1, 1, 1);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glReadPixels(0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA_INTEGER, GL_UNSIGNED_INT, codes);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    GLenum error = glGetError();
    if (error != GL_NO_ERROR)
        printf("reading texels: OpenGL's error 0x%x\n", error);
    return error == GL_NO_ERROR ? 0 : -1;
}

#include "picture.h"

#include "refuse.h"
#include <stdio.h>

static const char vertex_text[] =
    "#version 300 es\n"
    "out vec2 place;\n"
    "void main()\n" /* a triangle over all of the viewport and beyond */
    "{\n"
    "    vec2 corner = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);\n"
    "    place = vec2(corner.x, 1.0 - corner.y);\n"
    "    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);\n"
    "}\n";
static const char fragment_text[] = "#version 300 es\n"
                                    "precision highp float;\n"
                                    "uniform highp sampler2D picture;\n"
                                    "in vec2 place;\n"
                                    "out vec4 result;\n"
                                    "void main()\n"
                                    "{\n"
                                    "    result = vec4(texture(picture, place).rgb, 1.0);\n"
                                    "}\n";

int view_picture_open(view_picture *p, const gl_calls *gl, pupil_why *why)
{
    *p = (view_picture){.gl = gl, .program = gl_calls_program(gl, vertex_text, fragment_text)};
    if (!p->program)
        return pupil_refuse(why, "the driver refuses the shader that shows a picture");
    gl->GenVertexArrays(1, &p->array);
    return 0;
}

void view_picture_close(view_picture *p)
{
    if (!p->gl)
        return;
    p->gl->DeleteTextures(1, &p->texture);
    p->gl->DeleteVertexArrays(1, &p->array);
    p->gl->DeleteProgram(p->program);
    *p = (view_picture){0};
}

static void bind(const view_picture *p)
{
    p->gl->ActiveTexture(GL_TEXTURE0);
    p->gl->BindSampler(0, 0);
    p->gl->BindTexture(GL_TEXTURE_2D, p->texture);
}

void view_picture_take(view_picture *p, const pupil_image_const *rgb8)
{
    static const GLenum unpack[] = {GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
                                    GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES};
    const gl_calls *gl = p->gl;
    const GLsizei width = (GLsizei)rgb8->width, height = (GLsizei)rgb8->height;
    const int fresh = p->width != rgb8->width || p->height != rgb8->height;
    if (fresh) {
        gl->DeleteTextures(1, &p->texture);
        gl->GenTextures(1, &p->texture);
        p->width = rgb8->width;
        p->height = rgb8->height;
    }
    bind(p);
    if (fresh) {
        gl->TexStorage2D(GL_TEXTURE_2D, 1, GL_RGB8, width, height);
        gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    for (size_t i = 0; i < sizeof unpack / sizeof unpack[0]; i++)
        gl->PixelStorei(unpack[i], 0);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, rgb8->data);
}

void view_picture_draw(const view_picture *p, uint32_t width, uint32_t height, float from, float to)
{
    const gl_calls *gl = p->gl;
    const int wide = (uint64_t)p->width * height > (uint64_t)p->height * width; /* bars above and below */
    if (!p->width)
        return;
    const uint32_t w = wide ? width : (uint32_t)((uint64_t)height * p->width / p->height);
    const uint32_t h = wide ? (uint32_t)((uint64_t)width * p->height / p->width) : height;
    const GLint left = (GLint)((float)width * from + 0.5f), right = (GLint)((float)width * to + 0.5f);
    gl_calls_begin(gl, 0, (GLsizei)width, (GLsizei)height);
    gl->Viewport((GLint)(width - w) / 2, (GLint)(height - h) / 2, (GLsizei)w, (GLsizei)h);
    gl->Enable(GL_SCISSOR_TEST);
    gl->Scissor(left, 0, right - left, (GLsizei)height);
    gl->UseProgram(p->program);
    gl->BindVertexArray(p->array);
    bind(p);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->BindVertexArray(0);
    gl->Disable(GL_SCISSOR_TEST);
}

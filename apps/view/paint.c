#include "paint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/font.h"
#include "refuse.h"

enum { MOST_VERTICES = 6 * 8192 }; /* for one GL call; more are drawn in several calls */

typedef struct vertex {
    float x, y;
    unsigned char colour[4];
} vertex;

struct view_paint {
    const gl_calls *gl;
    GLuint program, array, buffer;
    GLint size_at;
    float width, height;
    size_t count;
    vertex v[MOST_VERTICES];
};

static const char vertex_text[] = "#version 300 es\n"
                                  "layout(location = 0) in vec2 place;\n"
                                  "layout(location = 1) in vec4 colour;\n"
                                  "uniform vec2 size;\n"
                                  "out vec4 painted;\n"
                                  "void main()\n"
                                  "{\n"
                                  "    painted = colour;\n"
                                  "    gl_Position = vec4(2.0 * place.x / size.x - 1.0,\n"
                                  "                       1.0 - 2.0 * place.y / size.y, 0.0, 1.0);\n"
                                  "}\n";
static const char fragment_text[] = "#version 300 es\n"
                                    "precision highp float;\n"
                                    "in vec4 painted;\n"
                                    "out vec4 result;\n"
                                    "void main()\n"
                                    "{\n"
                                    "    result = painted;\n"
                                    "}\n";

view_paint *view_paint_open(const gl_calls *gl, pupil_why *why)
{
    view_paint *p = calloc(1, sizeof *p);
    if (!p) {
        pupil_refuse(why, "not enough memory");
        return NULL;
    }
    p->gl = gl;
    p->program = gl_calls_program(gl, vertex_text, fragment_text);
    if (!p->program) {
        pupil_refuse(why, "the driver refuses the shader that paints letters and lines");
        free(p);
        return NULL;
    }
    p->size_at = gl->GetUniformLocation(p->program, "size");
    gl->GenVertexArrays(1, &p->array);
    gl->GenBuffers(1, &p->buffer);
    gl->BindVertexArray(p->array);
    gl->BindBuffer(GL_ARRAY_BUFFER, p->buffer);
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    gl->VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(vertex), (const void *)offsetof(vertex, x));
    gl->VertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(vertex), (const void *)offsetof(vertex, colour));
    gl->BindVertexArray(0);
    return p;
}

void view_paint_close(view_paint *p)
{
    if (!p)
        return;
    p->gl->DeleteProgram(p->program);
    p->gl->DeleteVertexArrays(1, &p->array);
    p->gl->DeleteBuffers(1, &p->buffer);
    free(p);
}

void view_paint_begin(view_paint *p, float width, float height)
{
    p->width = width;
    p->height = height;
    p->count = 0;
}

void view_paint_end(view_paint *p)
{
    const gl_calls *gl = p->gl;
    gl->UseProgram(p->program);
    gl->Uniform2f(p->size_at, p->width, p->height);
    gl->BindVertexArray(p->array);
    gl->BindBuffer(GL_ARRAY_BUFFER, p->buffer);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(p->count * sizeof *p->v), p->v, GL_STREAM_DRAW);
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    gl->DrawArrays(GL_TRIANGLES, 0, (GLsizei)p->count);
    gl->Disable(GL_BLEND);
    gl->BindVertexArray(0);
    p->count = 0;
}

/* Two triangles; the corners are in order around. */
static void quad(view_paint *p, const float corner[4][2], view_colour colour)
{
    static const int order[6] = {0, 1, 2, 0, 2, 3};
    if (p->count + 6 > MOST_VERTICES)
        view_paint_end(p);
    for (int i = 0; i < 6; i++) {
        vertex *v = &p->v[p->count++];
        v->x = corner[order[i]][0];
        v->y = corner[order[i]][1];
        for (int c = 0; c < 4; c++)
            v->colour[c] = (unsigned char)(colour >> (24 - 8 * c));
    }
}

void view_paint_box(view_paint *p, float x, float y, float width, float height, view_colour colour)
{
    const float corner[4][2] = {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
    quad(p, corner, colour);
}

void view_paint_line(view_paint *p, const float from[2], const float to[2], float thick, view_colour colour)
{
    const float dx = to[0] - from[0], dy = to[1] - from[1], length = sqrtf(dx * dx + dy * dy);
    if (!(length > 0.0f))
        return;
    const float nx = -0.5f * thick * dy / length, ny = 0.5f * thick * dx / length;
    const float corner[4][2] = {
        {from[0] + nx, from[1] + ny}, {to[0] + nx, to[1] + ny}, {to[0] - nx, to[1] - ny}, {from[0] - nx, from[1] - ny}};
    quad(p, corner, colour);
}

static void letter(view_paint *p, float x, float y, float scale, view_colour colour, char c)
{
    const unsigned char *rows = font_rows(c);
    for (int row = 0; row < FONT_HEIGHT; row++)
        for (int from = 0, to; from < FONT_WIDTH; from = to + 1) { /* one box for adjacent pixels */
            for (to = from; to < FONT_WIDTH && (rows[row] >> (FONT_WIDTH - 1 - to) & 1); to++)
                ;
            if (to > from)
                view_paint_box(p, x + (float)from * scale, y + (float)row * scale, (float)(to - from) * scale, scale,
                               colour);
        }
}

void view_paint_text(view_paint *p, float x, float y, float scale, view_colour colour, const char *text)
{
    float at = x;
    for (; *text; text++) {
        if (*text == '\n') {
            at = x;
            y += FONT_LINE * scale;
            continue;
        }
        letter(p, at, y, scale, colour, *text);
        at += FONT_STEP * scale;
    }
}

float view_paint_text_width(float scale, const char *text)
{
    int widest = 0, line = 0;
    for (; *text; text++) {
        line = *text == '\n' ? 0 : line + 1;
        widest = line > widest ? line : widest;
    }
    return (float)(widest ? widest * FONT_STEP - 1 : 0) * scale;
}

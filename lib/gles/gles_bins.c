/* The histogram of ES 3.0, which has no atomic counters: each pixel of some rows is a point that is drawn into the bin
 * that it belongs to, and blending counts them (Scheuermann, Hensley: Efficient Histogram Generation Using Scattering
 * on GPUs, 2007). A half counts to 2048, so each row of the frame has its own row of bins, or several. */
#include "gles_private.h"

#define MOST_COUNT    2048 /* above this a half does not have every integer */
#define USUAL_STEP    4    /* a point for each pixel would be slow on small GPUs, which sort points into tiles */
#define LEAST_LARGEST 2048 /* GL_MAX_TEXTURE_SIZE of every ES 3.0 */

static uint32_t bins_in_all(void)
{
    return PUPIL_HISTOGRAM_BINS + PUPIL_PEAK_BINS;
}

/* Whether each of `columns` parts of a row is narrow enough, and has one weight. */
static int can_have(const gles_object *o, const pupil_config *settings, uint32_t columns)
{
    const uint32_t width = o->config.width / o->unit, cells = PUPIL_GRID_SIDE / columns;
    for (uint32_t c = 0; c < PUPIL_GRID_SIDE; c += cells)
        if (pupil_grid_first_in_cell(c + cells, width) - pupil_grid_first_in_cell(c, width) > MOST_COUNT)
            return 0;
    for (int y = 0; y < PUPIL_GRID_SIDE; y++)
        for (uint32_t x = 0; x < PUPIL_GRID_SIDE; x++)
            if (settings->weight[y][x] != settings->weight[y][x / cells * cells])
                return 0;
    return 1;
}

gles_bins pupil_gles_bins_plan(const gles_object *o, const pupil_config *settings)
{
    const uint32_t height = o->config.height / o->unit, largest = (uint32_t)o->largest_side;
    const uint32_t most = largest > LEAST_LARGEST ? largest : LEAST_LARGEST;
    gles_bins b = {.columns = 1, .step = settings->meter_rows ? settings->meter_rows : USUAL_STEP};
    while (b.columns < PUPIL_GRID_SIDE && !can_have(o, settings, b.columns))
        b.columns *= 2;
    while ((height + b.step - 1) / b.step * b.columns > most)
        b.step *= 2;
    b.groups = (height + b.step - 1) / b.step;
    return b;
}

int pupil_gles_bins_make(gles_object *o, pupil_why *why)
{
    const GLsizei rows = (GLsizei)(o->bins.groups * o->bins.columns);
    const int error = pupil_gles_target_make(o, GLES_BINS, GL_R16F, (GLsizei)bins_in_all(), rows, why);
    return error ? error : pupil_gles_target_make(o, GLES_COUNTS, GL_RGBA32UI, (GLsizei)bins_in_all() / 2, 2, why);
}

void pupil_gles_bins_meter(const gles_object *o)
{
    const gl_functions *gl = &o->gl;
    const GLsizei points = (GLsizei)(2 * (o->config.width / o->unit) * o->bins.groups);
    pupil_gles_begin(o, GLES_SCATTER);
    pupil_gles_bind_frame(o);
    gl->BindFramebuffer(GL_FRAMEBUFFER, o->framebuffer[GLES_BINS]);
    gl->Viewport(0, 0, (GLsizei)bins_in_all(), (GLsizei)(o->bins.groups * o->bins.columns));
    gl->ClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    gl->Clear(GL_COLOR_BUFFER_BIT);
    gl->Enable(GL_BLEND);
    gl->BlendEquation(GL_FUNC_ADD);
    gl->BlendFunc(GL_ONE, GL_ONE);
    gl->DrawArrays(GL_POINTS, 0, points);

    pupil_gles_begin(o, GLES_COUNT);
    pupil_gles_bind(o, GLES_UNIT_FRAME, GL_TEXTURE_2D, o->target[GLES_BINS]);
    pupil_gles_bind(o, GLES_UNIT_CHROMA, GL_TEXTURE_2D, o->target[GLES_PARTS]);
    gl->BindFramebuffer(GL_FRAMEBUFFER, o->framebuffer[GLES_COUNTS]);
    gl->Viewport(0, 0, (GLsizei)bins_in_all() / 2, 2);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

/* Metering of a frame, and the ring in which its statistics come back. */
#include "gles_private.h"

static const gles_statistics no_statistics;

void pupil_gles_meter_make(gles_object *o)
{
    const gl_functions *gl = &o->gl;
    for (int i = 0; i < GLES_RING; i++) {
        gl->GenBuffers(1, &o->slot[i].buffer);
        gl->BindBuffer(GL_COPY_WRITE_BUFFER, o->slot[i].buffer);
        gl->BufferData(GL_COPY_WRITE_BUFFER, sizeof(gles_statistics), &no_statistics, GL_STREAM_READ);
    }
    if (o->variant.version == PUPIL_GLES_ES31 && o->variant.level_here) {
        gl->GenBuffers(1, &o->state);
        gl->BindBuffer(GL_COPY_WRITE_BUFFER, o->state);
        gl->BufferData(GL_COPY_WRITE_BUFFER, 4 * sizeof(GLuint), &no_statistics, GL_DYNAMIC_COPY);
    }
}

static void let_go(gles_object *o, gles_slot *slot)
{
    if (slot->fence)
        o->gl.DeleteSync(slot->fence);
    slot->fence = 0;
}

void pupil_gles_meter_drop(gles_object *o)
{
    for (int i = 0; i < GLES_RING; i++)
        let_go(o, &o->slot[i]);
    o->under_way = 0;
}

void pupil_gles_meter_delete(gles_object *o)
{
    pupil_gles_meter_drop(o);
    for (int i = 0; i < GLES_RING; i++)
        o->gl.DeleteBuffers(1, &o->slot[i].buffer);
    o->gl.DeleteBuffers(1, &o->state);
}

/* --- ES 3.1: compute shaders into the slot's buffer --- */

static void meter_31(gles_object *o, const gles_slot *slot)
{
    const gl_functions *gl = &o->gl;
    const size_t bins = offsetof(gles_statistics, peak);
    if (o->histogram) { /* no longer in use: its fence has signalled */
        gl->BindBuffer(GL_COPY_WRITE_BUFFER, slot->buffer);
        gl->BufferSubData(GL_COPY_WRITE_BUFFER, (GLintptr)bins, (GLsizeiptr)(sizeof(gles_statistics) - bins),
                          &no_statistics);
    }
    pupil_gles_begin(o, GLES_METER);
    pupil_gles_bind_frame(o);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, slot->buffer);
    gl->DispatchCompute(GLES_REGION_COLUMNS / o->cells_together, o->region_rows, 1);
    if (o->variant.level_here) {
        gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        gl->UseProgram(o->programs.name[GLES_ADAPT]);
        pupil_gles_adapt_step(o, &slot->info);
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, o->state);
        gl->DispatchCompute(1, 1, 1);
        gl->MemoryBarrier(GL_UNIFORM_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    }
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

/* --- ES 3.0: fragment shaders into integer targets, read into the slot's buffer --- */

static void draw_into(const gles_object *o, int target, GLsizei width, GLsizei height)
{
    o->gl.BindFramebuffer(GL_FRAMEBUFFER, o->framebuffer[target]);
    o->gl.Viewport(0, 0, width, height);
    o->gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

/* From the target that was drawn last. */
static void read_back(const gles_object *o, GLint y, GLsizei width, GLsizei height, size_t to)
{
    o->gl.ReadPixels(0, y, width, height, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                     (void *)to); /* an offset in the pack buffer */
}

static void adapt_30(gles_object *o, const pupil_frame_info *info)
{
    const uint32_t next = o->newest_state ^ 1;
    pupil_gles_begin(o, GLES_WEIGH);
    pupil_gles_bind(o, GLES_UNIT_FRAME, GL_TEXTURE_2D, o->target[GLES_REGIONS]);
    draw_into(o, GLES_COLUMNS, GLES_REGION_COLUMNS, 1);
    pupil_gles_begin(o, GLES_ADAPT);
    pupil_gles_adapt_step(o, info);
    pupil_gles_bind(o, GLES_UNIT_FRAME, GL_TEXTURE_2D, o->target[GLES_COLUMNS]);
    pupil_gles_bind(o, GLES_UNIT_STATE, GL_TEXTURE_2D, o->target[GLES_STATE_0 + o->newest_state]);
    draw_into(o, GLES_STATE_0 + (int)next, 1, 1);
    o->newest_state = next;
    read_back(o, 0, 1, 1, offsetof(gles_statistics, level));
}

static void meter_30(gles_object *o, const gles_slot *slot)
{
    const gl_functions *gl = &o->gl;
    const GLsizei columns = GLES_REGION_COLUMNS, rows = (GLsizei)o->region_rows;
    pupil_gles_begin(o, GLES_METER);
    pupil_gles_bind_frame(o);
    draw_into(o, GLES_PARTS, columns * GLES_PARTS_X, rows * GLES_PARTS_Y);
    pupil_gles_begin(o, GLES_REDUCE);
    pupil_gles_bind(o, GLES_UNIT_FRAME, GL_TEXTURE_2D, o->target[GLES_PARTS]);
    draw_into(o, GLES_REGIONS, columns, rows);

    gl->BindBuffer(GL_PIXEL_PACK_BUFFER, slot->buffer);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl->PixelStorei(GL_PACK_ROW_LENGTH, 0);
    gl->PixelStorei(GL_PACK_SKIP_ROWS, 0);
    gl->PixelStorei(GL_PACK_SKIP_PIXELS, 0);
    read_back(o, 0, columns, rows, offsetof(gles_statistics, region));
    if (o->variant.histogram) {
        pupil_gles_bins_meter(o);
        read_back(o, 0, (PUPIL_HISTOGRAM_BINS + PUPIL_PEAK_BINS) / 2, 1, offsetof(gles_statistics, bin));
        read_back(o, 1, columns, 1, offsetof(gles_statistics, peaks));
    }
    if (o->variant.level_here)
        adapt_30(o, &slot->info);
    gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

int pupil_gles_meter(pupil_gles *gles, const pupil_frame_info *info)
{
    pupil_frame_info own;
    int error = pupil_gles_check(gles);
    if (!error)
        error = pupil_info_read(&own, info);
    if (error)
        return error;
    gles_object *o = gles_object_of(gles);
    if (!o->source[0])
        return PUPIL_ERR_ORDER;
    o->exposure_log2 = pupil_exposure_log2(&o->settings, &o->adaptation, &own);
    if (o->under_way == GLES_RING) {
        o->unmetered++;
        return PUPIL_GLES_BUSY;
    }
    gles_slot *slot = &o->slot[(o->oldest + o->under_way) % GLES_RING];
    slot->info = own;
    if (o->variant.version == PUPIL_GLES_ES31)
        meter_31(o, slot);
    else
        meter_30(o, slot);
    pupil_gles_unbind(o);
    slot->fence = o->gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    o->gl.Flush();     /* or the fence might never signal */
    if (slot->fence) { /* or nothing would report its end */
        o->under_way++;
        o->metered++;
    }
    const int by_gl = pupil_gles_error(o);
    return by_gl || slot->fence ? by_gl : PUPIL_ERR_GLES;
}

/* --- what has come back --- */

int pupil_gles_fetch(gles_object *o, uint64_t timeout_ns, pupil_frame_info *info)
{
    int error = PUPIL_OK;
    gles_slot *slot = &o->slot[o->oldest];
    if (!o->under_way)
        return PUPIL_GLES_NOTHING;
    const GLenum signalled = o->gl.ClientWaitSync(slot->fence, 0, timeout_ns);
    if (signalled == GL_TIMEOUT_EXPIRED)
        return PUPIL_GLES_NOTHING;
    if (signalled == GL_WAIT_FAILED)
        return (error = pupil_gles_error(o)) ? error : PUPIL_ERR_GLES;

    o->gl.BindBuffer(GL_PIXEL_PACK_BUFFER, slot->buffer);
    const gles_statistics *from =
        o->gl.MapBufferRange(GL_PIXEL_PACK_BUFFER, 0, sizeof(gles_statistics), GL_MAP_READ_BIT);
    if (from) {
        pupil_gles_regions_add_up(o, from, &o->stats);
        o->level_known = o->variant.level_here && from->level[2];
        o->level_q24 = (int32_t)from->level[1];
        error = o->gl.UnmapBuffer(GL_PIXEL_PACK_BUFFER) ? PUPIL_OK : PUPIL_ERR_GLES;
    }
    o->gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    if (info)
        *info = slot->info;
    let_go(o, slot);
    o->oldest = (o->oldest + 1) % GLES_RING;
    o->under_way--;
    const int by_gl = pupil_gles_error(o);
    return by_gl ? by_gl : from ? error : PUPIL_ERR_GLES_MEMORY;
}

int pupil_gles_collect_sized(pupil_gles *gles, uint64_t timeout_ns, pupil_stats *stats, size_t stats_bytes,
                             pupil_frame_info *info, size_t info_bytes)
{
    pupil_frame_info of_frame;
    int error = pupil_gles_check(gles);
    if (error)
        return error;
    if (!stats)
        return PUPIL_ERR_NULL;
    if (stats_bytes < sizeof stats->size_bytes || (info && info_bytes < sizeof info->size_bytes))
        return PUPIL_ERR_SIZE_BYTES;
    gles_object *o = gles_object_of(gles);
    error = pupil_gles_fetch(o, timeout_ns, &of_frame);
    if (error)
        return error;
    (void)pupil_versioned_write(stats, stats_bytes, &o->stats, sizeof o->stats);
    if (info)
        (void)pupil_versioned_write(info, info_bytes, &of_frame, sizeof of_frame);
    return PUPIL_OK;
}

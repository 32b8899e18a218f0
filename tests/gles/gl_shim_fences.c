/* The calls for buffers that the GPU writes into, and for the fences after those writes. */
#include "gl_shim_private.h"

static GLuint pack_buffer, copy_buffer, storage[4];

void shim_forget_bindings(void)
{
    for (int i = 0; i < 4; i++)
        storage[i] = 0;
    pack_buffer = copy_buffer = 0;
}

/* Written by the GPU, or by a call that would have to wait for it. */
static void touch(GLuint name, int by_gpu)
{
    thing *buffer = shim_find(BUFFER, name, NULL);
    if (!buffer)
        return;
    if (!by_gpu && buffer->written)
        shim_breach("a buffer is touched before its fence has signalled", name);
    if (by_gpu)
        buffer->written = 1, buffer->sync = NULL;
}

void GL_APIENTRY shim_BindBuffer(GLenum target, GLuint name)
{
    if (shim_enter(CALL_BindBuffer))
        return;
    if (target == GL_PIXEL_PACK_BUFFER)
        pack_buffer = name;
    if (target == GL_COPY_WRITE_BUFFER)
        copy_buffer = name;
    shim_driver.BindBuffer(target, name);
}

void GL_APIENTRY shim_BindBufferBase(GLenum target, GLuint index, GLuint name)
{
    if (shim_enter(CALL_BindBufferBase))
        return;
    if (target == GL_SHADER_STORAGE_BUFFER && index < 4)
        storage[index] = name;
    shim_driver.BindBufferBase(target, index, name);
}

void GL_APIENTRY shim_BufferSubData(GLenum target, GLintptr offset, GLsizeiptr size, const void *data)
{
    if (shim_enter(CALL_BufferSubData))
        return;
    touch(copy_buffer, 0);
    shim_driver.BufferSubData(target, offset, size, data);
}

void GL_APIENTRY shim_DispatchCompute(GLuint x, GLuint y, GLuint z)
{
    if (shim_enter(CALL_DispatchCompute))
        return;
    for (int i = 0; i < 4; i++)
        touch(storage[i], 1);
    shim_driver.DispatchCompute(x, y, z);
}

void GL_APIENTRY shim_ReadPixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type, void *to)
{
    if (shim_enter(CALL_ReadPixels))
        return;
    if (pack_buffer)
        touch(pack_buffer, 1);
    else
        shim_breach("ReadPixels into memory, which waits, pixels", (unsigned long)(width * height));
    shim_driver.ReadPixels(x, y, width, height, format, type, to);
}

GLsync GL_APIENTRY shim_FenceSync(GLenum condition, GLbitfield flags)
{
    if (shim_enter(CALL_FenceSync) || shim_fails(GL_FAULT_FENCE))
        return NULL;
    const GLsync sync = shim_driver.FenceSync(condition, flags);
    for (int i = 0; i < shim.alive; i++)
        if (shim_things[i].kind == BUFFER && shim_things[i].written && !shim_things[i].sync)
            shim_things[i].sync = sync;
    shim_make((thing){.kind = FENCE, .sync = sync, .frame = shim.frame});
    return sync;
}

void GL_APIENTRY shim_DeleteSync(GLsync sync)
{
    if (shim_enter(CALL_DeleteSync))
        return;
    shim_unmake(FENCE, 0, sync);
    shim_driver.DeleteSync(sync);
}

GLenum GL_APIENTRY shim_ClientWaitSync(GLsync sync, GLbitfield flags, GLuint64 timeout_ns)
{
    const GLuint64 minute_ns = UINT64_C(60000000000);
    if (shim_enter(CALL_ClientWaitSync))
        return 0;
    shim.waits += timeout_ns != 0;
    if (shim_fails(GL_FAULT_WAIT))
        return GL_WAIT_FAILED;
    const thing *fence = shim_find(FENCE, 0, sync);
    if (fence && shim.frame < fence->frame + shim.late)
        return GL_TIMEOUT_EXPIRED;
    const GLenum said = shim_driver.ClientWaitSync(sync, flags, shim.late ? minute_ns : timeout_ns);
    for (int i = 0; i < shim.alive; i++)
        if (shim_things[i].kind == BUFFER && shim_things[i].sync == sync &&
            (said == GL_ALREADY_SIGNALED || said == GL_CONDITION_SATISFIED))
            shim_things[i].written = 0, shim_things[i].sync = NULL;
    return said;
}

void *GL_APIENTRY shim_MapBufferRange(GLenum target, GLintptr offset, GLsizeiptr length, GLbitfield access)
{
    if (shim_enter(CALL_MapBufferRange) || shim_fails(GL_FAULT_MAP))
        return NULL;
    touch(pack_buffer, 0);
    return shim_driver.MapBufferRange(target, offset, length, access);
}

GLboolean GL_APIENTRY shim_UnmapBuffer(GLenum target)
{
    if (shim_enter(CALL_UnmapBuffer))
        return GL_FALSE;
    const GLboolean kept = shim_driver.UnmapBuffer(target);
    return shim_turn_of(GL_FAULT_UNMAP) ? GL_FALSE : kept;
}

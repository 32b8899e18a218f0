/* GLib's mutexes and queues for the thread sanitizer, which does not see the originals: they are futexes in a library
 * that was not compiled with it. Only linked to the tests in its builds. */
#include <dlfcn.h>
#include <glib.h>

void __tsan_acquire(void *address);
void __tsan_release(void *address);

static void call(const char *name, GMutex *mutex)
{
    void (*real)(GMutex *) = (void (*)(GMutex *))dlsym(RTLD_NEXT, name);
    real(mutex);
}

void g_mutex_lock(GMutex *mutex)
{
    call("g_mutex_lock", mutex);
    __tsan_acquire(mutex);
}

void g_mutex_unlock(GMutex *mutex)
{
    __tsan_release(mutex);
    call("g_mutex_unlock", mutex);
}

void g_async_queue_push(GAsyncQueue *queue, gpointer data)
{
    void (*real)(GAsyncQueue *, gpointer) = (void (*)(GAsyncQueue *, gpointer))dlsym(RTLD_NEXT, "g_async_queue_push");
    __tsan_release(queue);
    real(queue, data);
}

gpointer g_async_queue_timeout_pop(GAsyncQueue *queue, guint64 timeout)
{
    gpointer (*real)(GAsyncQueue *, guint64) =
        (gpointer(*)(GAsyncQueue *, guint64))dlsym(RTLD_NEXT, "g_async_queue_timeout_pop");
    gpointer data = real(queue, timeout);
    __tsan_acquire(queue);
    return data;
}

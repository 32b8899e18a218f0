/* tests/fake_v4l2/fake_faults.c: a system whose n-th call fails. */
#include "fake_v4l2.h"

#include <errno.h>

static int fails(fake_faults *f, const char *call)
{
    f->calls++;
    if (!f->fail_at || f->calls < f->fail_at || f->calls - f->fail_at >= f->fail_for)
        return 0;
    if (!f->failed)
        f->failed = call;
    errno = f->error;
    return 1;
}

static int faulty_open(void *context, const char *path)
{
    fake_faults *f = context;
    return fails(f, "open") ? -1 : f->inner->open(f->inner->context, path);
}

static int faulty_close(void *context, int fd)
{
    fake_faults *f = context;
    const int result = f->inner->close(f->inner->context, fd);
    return fails(f, "close") ? -1 : result;
}

static int faulty_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    fake_faults *f = context;
    return fails(f, "ioctl") ? -1 : f->inner->ioctl(f->inner->context, fd, request, argument);
}

static void *faulty_mmap(void *context, size_t bytes, int fd, off_t offset)
{
    fake_faults *f = context;
    return fails(f, "mmap") ? NULL : f->inner->mmap(f->inner->context, bytes, fd, offset);
}

static int faulty_munmap(void *context, void *memory, size_t bytes)
{
    fake_faults *f = context;
    const int result = f->inner->munmap(f->inner->context, memory, bytes);
    return fails(f, "munmap") ? -1 : result;
}

static int faulty_poll(void *context, struct pollfd *fds, nfds_t count, int timeout_ms)
{
    fake_faults *f = context;
    return fails(f, "poll") ? -1 : f->inner->poll(f->inner->context, fds, count, timeout_ms);
}

static int64_t faulty_now_ns(void *context)
{
    fake_faults *f = context;
    return f->inner->now_ns(f->inner->context);
}

static int faulty_list(void *context, const char *folder, void (*found)(void *closure, const char *name), void *closure)
{
    fake_faults *f = context;
    return fails(f, "list") ? -1 : f->inner->list(f->inner->context, folder, found, closure);
}

static int faulty_device_number(void *context, int fd, uint32_t *major, uint32_t *minor)
{
    fake_faults *f = context;
    return fails(f, "device_number") ? -1 : f->inner->device_number(f->inner->context, fd, major, minor);
}

static int faulty_device_name(void *context, uint32_t major, uint32_t minor, char *name, size_t name_bytes)
{
    fake_faults *f = context;
    return fails(f, "device_name") ? -1 : f->inner->device_name(f->inner->context, major, minor, name, name_bytes);
}

static ssize_t faulty_write(void *context, int fd, const void *data, size_t bytes)
{
    fake_faults *f = context;
    return fails(f, "write") ? -1 : f->inner->write(f->inner->context, fd, data, bytes);
}

static int64_t faulty_read_ns(void *context, const void *memory, size_t bytes)
{
    fake_faults *f = context;
    return f->inner->read_ns(f->inner->context, memory, bytes);
}

void fake_faults_begin(fake_faults *faults, const pupil_v4l2_system *inner, unsigned long fail_at,
                       unsigned long fail_for, int error)
{
    *faults = (fake_faults){.inner = inner, .fail_at = fail_at, .fail_for = fail_for, .error = error};
    faults->system = (pupil_v4l2_system){
        faults,        faulty_open, faulty_close,         faulty_ioctl,       faulty_mmap,  faulty_munmap, faulty_poll,
        faulty_now_ns, faulty_list, faulty_device_number, faulty_device_name, faulty_write, faulty_read_ns};
}

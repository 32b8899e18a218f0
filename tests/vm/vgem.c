/* Dumb buffers (the kernel's drm_mode.h), exported through PRIME. */
#include "vm/vgem.h"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

/* As in the kernel's include/uapi/drm/drm.h and drm_mode.h; Debian has them in libdrm's headers, from which nothing
 * else is needed. */
struct version {
    int number[3];
    size_t name_bytes;
    char *name;
    size_t date_bytes;
    char *date;
    size_t description_bytes;
    char *description;
};
struct create_dumb {
    uint32_t height, width, bits_per_pixel, flags, handle, pitch_bytes;
    uint64_t size_bytes;
};
struct destroy_dumb {
    uint32_t handle;
};
struct prime_handle {
    uint32_t handle, flags;
    int32_t fd;
};
#define DRM_VERSION            _IOWR('d', 0x00, struct version)
#define DRM_PRIME_HANDLE_TO_FD _IOWR('d', 0x2d, struct prime_handle)
#define DRM_CREATE_DUMB        _IOWR('d', 0xb2, struct create_dumb)
#define DRM_DESTROY_DUMB       _IOWR('d', 0xb4, struct destroy_dumb)

int vgem_open(void)
{
    for (int i = 0; i < 8; i++) {
        char path[32], name[16] = "";
        struct version version = {.name_bytes = sizeof name - 1, .name = name};
        snprintf(path, sizeof path, "/dev/dri/card%d", i);
        int device = open(path, O_RDWR | O_CLOEXEC);
        if (device < 0)
            continue;
        if (ioctl(device, DRM_VERSION, &version) == 0 && strcmp(name, "vgem") == 0)
            return device;
        close(device);
    }
    return -1;
}

int vgem_make(int device, size_t bytes, vgem_buffer *buffer)
{
    struct create_dumb create = {.width = (uint32_t)bytes, .height = 1, .bits_per_pixel = 8};
    *buffer = (vgem_buffer){-1, NULL, bytes};
    if (ioctl(device, DRM_CREATE_DUMB, &create) != 0)
        return -1;
    struct prime_handle export = {.handle = create.handle, .flags = O_RDWR | O_CLOEXEC};
    struct destroy_dumb destroy = {create.handle};
    int failed = ioctl(device, DRM_PRIME_HANDLE_TO_FD, &export);
    ioctl(device, DRM_DESTROY_DUMB, &destroy); /* the dma-buf keeps the memory */
    if (failed)
        return -1;
    buffer->fd = export.fd;
    void *data = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, export.fd, 0);
    if (data == MAP_FAILED) {
        vgem_free(buffer);
        return -1;
    }
    buffer->data = data;
    vgem_begin(buffer);
    memset(data, 0x5a, bytes);
    vgem_end(buffer);
    return 0;
}

void vgem_free(vgem_buffer *buffer)
{
    if (buffer->data)
        munmap(buffer->data, buffer->bytes);
    if (buffer->fd >= 0)
        close(buffer->fd);
    *buffer = (vgem_buffer){-1, NULL, 0};
}

static void sync_access(const vgem_buffer *buffer, uint64_t flags)
{
    struct dma_buf_sync sync = {flags | DMA_BUF_SYNC_RW};
    if (ioctl(buffer->fd, DMA_BUF_IOCTL_SYNC, &sync) != 0)
        perror("DMA_BUF_IOCTL_SYNC");
}

void vgem_begin(const vgem_buffer *buffer)
{
    sync_access(buffer, DMA_BUF_SYNC_START);
}

void vgem_end(const vgem_buffer *buffer)
{
    sync_access(buffer, DMA_BUF_SYNC_END);
}

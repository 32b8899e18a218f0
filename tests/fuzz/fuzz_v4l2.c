/* A driver's answers under libFuzzer: the fake camera's, with some bytes changed, or replaced by an error. The camera's
 * modes are listed, its sensor is looked for, its controls are taken over and written, and its frames are read to their
 * last byte. */
#include "fake_v4l2/fake_v4l2.h"

#include <errno.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <linux/media.h>
#include <linux/videodev2.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"
#include "pupil/camera_controls.h"
#include "v4l2/capture/capture.h"
#include "v4l2/media/media.h"
#include "v4l2/offers/offers.h"

#define MOST_FRAMES 6

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* The rest of the input, which says how each answer is changed; once it is used up, answers are right. The camera's
 * thread also uses it. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static const uint8_t *next_byte;
static size_t bytes_left;
static const pupil_v4l2_system *right;

static uint32_t take(int count)
{
    uint32_t value = 0;
    for (; count > 0 && bytes_left; count--, bytes_left--)
        value = value << 8 | *next_byte++;
    return value;
}

/* Changes up to three bytes. */
static void change(void *answer, size_t size)
{
    for (uint32_t times = take(1) % 4; times > 0 && size; times--) {
        const uint32_t where = take(2);
        ((uint8_t *)answer)[where % size] = (uint8_t)take(1);
    }
}

static uint32_t at_most(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* A kernel never changes the addresses of the caller's arrays, nor their room. */
static void change_topology(struct media_v2_topology *t, const struct media_v2_topology *before)
{
    const int filled = before->ptr_entities != 0;
    t->ptr_entities = before->ptr_entities;
    t->ptr_interfaces = before->ptr_interfaces;
    t->ptr_pads = before->ptr_pads;
    t->ptr_links = before->ptr_links;
    if (!filled)
        return;
    t->num_entities = at_most(t->num_entities, before->num_entities);
    t->num_interfaces = at_most(t->num_interfaces, before->num_interfaces);
    t->num_pads = at_most(t->num_pads, before->num_pads);
    t->num_links = at_most(t->num_links, before->num_links);
    change((void *)(uintptr_t)t->ptr_entities, t->num_entities * sizeof(struct media_v2_entity));
    change((void *)(uintptr_t)t->ptr_interfaces, t->num_interfaces * sizeof(struct media_v2_interface));
    change((void *)(uintptr_t)t->ptr_pads, t->num_pads * sizeof(struct media_v2_pad));
    change((void *)(uintptr_t)t->ptr_links, t->num_links * sizeof(struct media_v2_link));
}

static void change_controls(struct v4l2_ext_controls *all, const struct v4l2_ext_controls *before)
{
    all->controls = before->controls;
    all->count = before->count;
    change(all->controls, all->count * sizeof *all->controls);
}

static void change_buffer(struct v4l2_buffer *b, const struct v4l2_buffer *before)
{
    if (!V4L2_TYPE_IS_MULTIPLANAR(before->type) && before->memory == V4L2_MEMORY_MMAP)
        return;
    b->m = before->m;
    b->length = before->length;
}

static void change_answer(unsigned long request, void *answer)
{
    uint64_t before[128];
    const size_t size = _IOC_SIZE(request);
    /* a file descriptor is the program's, regardless of the driver */
    if (size > sizeof before || !(_IOC_DIR(request) & _IOC_READ) || request == DMA_BUF_IOCTL_SYNC ||
        request == DMA_HEAP_IOCTL_ALLOC || request == VIDIOC_EXPBUF)
        return;
    memcpy(before, answer, size);
    change(answer, size);
    if (request == VIDIOC_G_EXT_CTRLS || request == VIDIOC_S_EXT_CTRLS || request == VIDIOC_TRY_EXT_CTRLS)
        change_controls(answer, (const void *)before);
    else if (request == VIDIOC_QUERYBUF || request == VIDIOC_QBUF || request == VIDIOC_DQBUF)
        change_buffer(answer, (const void *)before);
    else if (request == MEDIA_IOC_G_TOPOLOGY)
        change_topology(answer, (const void *)before);
}

static int changed_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    static const int errors[] = {EINVAL, EIO, ENODEV, EBUSY, ENOTTY, EAGAIN, EPIPE, ENOSPC};
    pthread_mutex_lock(&lock);
    const uint32_t kind = take(1);
    int result = -1;
    if (kind >= 0xf8)
        errno = errors[kind - 0xf8];
    else {
        result = right->ioctl(context, fd, request, argument);
        if (kind >= 0x60 && result >= 0)
            change_answer(request, argument);
    }
    pthread_mutex_unlock(&lock);
    return result;
}

static void abort_without(const pupil_why *why)
{
    if (!*why->text)
        abort(); /* a refusal without a sentence */
}

/* The sanitizer and the end of the map catch reads beyond a frame. */
static void read_all(const pupil_v4l2_frame *f)
{
    static pupil_stats stats;
    static volatile uint8_t seen;
    for (size_t i = 0; f->coded && i < f->coded_bytes; i++)
        seen ^= ((const uint8_t *)f->coded)[i];
    (void)seen;
    if (!f->coded && fuzz_meter(&f->image, &stats))
        abort();
}

static void stream(const pupil_v4l2_system *system, uint32_t memory)
{
    static pupil_v4l2_capture capture;
    pupil_v4l2_frame f;
    pupil_v4l2_sensor sensor;
    char mend[256];
    pupil_why why = {""};
    const pupil_v4l2_options options = {.system = system, .memory = memory, .timeout_s = 0.5};
    if (pupil_v4l2_capture_open(&capture, "/dev/video0", &options, &why)) {
        abort_without(&why);
        return;
    }
    (void)pupil_v4l2_media_sensor(&capture.device, &sensor, &why);
    (void)pupil_v4l2_media_mend(&capture.device, &capture.format, mend, sizeof mend);
    const pupil_camera_calls calls = {.context = system->context, .ioctl = changed_ioctl};
    const pupil_camera_options of = {.calls = &calls, .fd = capture.device.fd, .subdevice_fd = -1};
    pupil_camera *camera = pupil_camera_open(&of, &why);
    pupil_frame_info info = {0};
    for (int n = 0; n < MOST_FRAMES; n++) {
        why.text[0] = 0;
        const int rc = pupil_v4l2_capture_next(&capture, &f, &why);
        if (rc != PUPIL_V4L2_FRAME) {
            if (rc != PUPIL_V4L2_END)
                abort_without(&why);
            break;
        }
        read_all(&f);
        if (camera) {
            pupil_camera_frame(camera, f.sequence, 0);
            pupil_camera_in_force(camera, f.sequence, &info);
            pupil_camera_ask(camera, &(pupil_camera_setting){.exposure_s = 0.001 * (1 + n), .gain = 1.0 + n});
        }
        if (pupil_v4l2_capture_done(&capture, &f, &why))
            break;
    }
    while (camera && pupil_camera_close(camera, &why) == 1)
        abort(); /* no call of the fake's hangs */
    pupil_v4l2_capture_close(&capture);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static pupil_live_offers offers;
    fake_v4l2_config config;
    pupil_why why = {""};
    if (size < 2)
        return 0;
    fake_v4l2_config_default(&config);
    config.multiplanar = bytes[0] & 1;
    config.media = bytes[0] >> 1 & 1 ? FAKE_MEDIA_RIGHT : FAKE_MEDIA_NONE;
    config.heaps = bytes[0] >> 2 & 1;
    config.slow = bytes[0] >> 3 & 1;
    config.no_mmap = bytes[0] >> 4 & 1;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    if (!fake)
        return 0;
    right = fake_v4l2_system(fake);
    pupil_v4l2_system system = *right;
    system.ioctl = changed_ioctl;
    next_byte = bytes + 2;
    bytes_left = size - 2;
    if (bytes[0] >> 5 & 1) {
        memset(&offers, 0, sizeof offers);
        if (pupil_v4l2_offers_read(&offers, &system, "/dev/video0", &why))
            abort_without(&why);
        pupil_live_modes_free(&offers.modes);
    }
    stream(&system, bytes[1] % PUPIL_V4L2_MEMORY_COUNT == PUPIL_V4L2_MEMORY_DMABUF
                        ? PUPIL_V4L2_MEMORY_AUTO
                        : bytes[1] % PUPIL_V4L2_MEMORY_COUNT);
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    if (held.files || held.maps)
        abort(); /* something was left open */
    fake_v4l2_free(fake);
    return 0;
}

/* uvc_camera.c: uvc_camera linear|display [hard|slow|second]: the camera of uvc_camera.h, until SIGTERM. `hard`: a
 * write of a control takes HARD_WRITE_NS, and the camera is not ready for some of them. `slow`: 5 frames a second,
 * regardless of the request; libcamera cannot request a rate. `second`: at another port, and a stop more sensitive.
 *
 * Sources: the kernel's Documentation/usb/usbip_protocol.rst; Universal Serial Bus 2.0, chapter 9; USB Device Class
 * Definition for Video Devices 1.1, and its Uncompressed Payload. */
#include "vm/uvc_camera.h"
#include "vm/uvc_describe.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define PAYLOAD   16384u /* of a bulk transfer, with its header of two bytes */
#define MOST_URBS 64
#define INTERVAL  UVC_INTERVAL

#define HARD_WRITE_NS INT64_C(300000000) /* longer than a frame at 5 a second */
#define HARD_READY    6                  /* writes that are accepted, ... */
#define HARD_NOT      3                  /* ... and then how many are not */

/* Messages between vhci_hcd and the camera (usbip_protocol.rst). */
enum { CMD_SUBMIT = 1, CMD_UNLINK = 2, RET_SUBMIT = 3, RET_UNLINK = 4 };
enum { SPEED_HIGH = 3 };
/* Requests of the class (UVC 1.1, table A-8). */
enum {
    SET_CUR = 0x01,
    GET_CUR = 0x81,
    GET_MIN = 0x82,
    GET_MAX = 0x83,
    GET_RES = 0x84,
    GET_LEN = 0x85,
    GET_INFO = 0x86,
    GET_DEF = 0x87
};

static int link_fd, display, hard, slow, second;
static volatile sig_atomic_t light = 8, ended;

/* --- controls --- */

typedef struct control {
    uint8_t entity, selector, bytes;
    uint32_t least, most, step, usual, now;
} control;

enum { AE_MODE, AE_PRIORITY, EXPOSURE, GAIN, CONTROLS };
/* Entity 1 is the camera, 2 the processing. For the mode, `step` is the set of supported modes: 1 manual, 8 aperture
 * priority (4.2.2.1.2). */
static control controls[CONTROLS] = {
    [AE_MODE] = {1, 0x02, 1, 0, 0, 1 | 8, 8, 8},
    [AE_PRIORITY] = {1, 0x03, 1, 0, 1, 1, 0, 1},
    [EXPOSURE] = {1, 0x04, 4, 1, 5000, 1, 100, 100},
    [GAIN] = {2, 0x04, 2, 16, 1024, 1, 16, 16},
};

/* The negotiated stream: UVC 1.1, table 4-75. */
static struct {
    uint8_t frame; /* from 1 */
    uint32_t interval;
} stream = {1, INTERVAL};

static uint32_t width_of(void)
{
    return stream.frame == 2 ? 640 : 320;
}

static uint32_t height_of(void)
{
    return stream.frame == 2 ? 480 : 240;
}

static uint32_t get(const uint8_t *from, uint32_t bytes)
{
    uint32_t value = 0;
    for (uint32_t i = 0; i < bytes; i++)
        value |= (uint32_t)from[i] << 8 * i;
    return value;
}

/* --- the connection --- */

static void leave(const char *why)
{
    fprintf(stderr, "uvc_camera: %s\n", why);
    exit(ended ? 0 : 1);
}

static void take(void *to, size_t bytes)
{
    for (size_t had = 0; had < bytes;) {
        const ssize_t n = read(link_fd, (char *)to + had, bytes - had);
        if (n == 0 || (n < 0 && errno != EINTR))
            leave("the host is gone");
        had += n > 0 ? (size_t)n : 0;
    }
}

static void give(const void *from, size_t bytes)
{
    for (size_t had = 0; had < bytes;) {
        const ssize_t n = write(link_fd, (const char *)from + had, bytes - had);
        if (n < 0 && errno != EINTR)
            leave("the host is gone");
        had += n > 0 ? (size_t)n : 0;
    }
}

/* `bytes`: the number transferred; data NULL: towards the camera. */
static void answer(uint32_t command, uint32_t number, int status, const void *data, uint32_t bytes)
{
    uint32_t header[12] = {htonl(command), htonl(number), 0, 0, 0, htonl((uint32_t)status), htonl(bytes)};
    give(header, sizeof header);
    if (data && bytes)
        give(data, bytes);
}

/* --- pictures --- */

static struct {
    uint8_t *data;
    uint32_t bytes, sent; /* nothing to send: equal */
    uint8_t toggle;
} frame;

static struct {
    uint32_t number[MOST_URBS], bytes[MOST_URBS], count;
} urbs;

static uint8_t code_of(double value)
{
    value = value < 1.0 ? value : 1.0;
    if (display) /* IEC 61966-2-1 */
        value = value <= 0.0031308 ? 12.92 * value : 1.055 * pow(value, 1 / 2.4) - 0.055;
    return (uint8_t)(16.5 + 219.0 * value);
}

static void draw(void)
{
    const uint32_t width = width_of(), height = height_of();
    const int automatic = controls[AE_MODE].now != 1;
    uint32_t exposure = controls[EXPOSURE].now;
    const uint32_t longest = stream.interval / 1000;
    if (!controls[AE_PRIORITY].now && exposure > longest)
        exposure = longest; /* the frame rate has priority */
    /* its automatic exposure: half a stop too dark, in any light */
    const double total =
        automatic ? 1.27 / pow(8, light - 8) : (1 + second) * (exposure / 100.0) * controls[GAIN].now / 16.0;
    const uint64_t truth =
        (uint64_t)exposure | (uint64_t)controls[GAIN].now << 16 | (uint64_t)light << 28 | (uint64_t)automatic << 32;
    if (frame.bytes != width * height * 2) {
        frame.bytes = width * height * 2;
        frame.data = realloc(frame.data, frame.bytes);
        if (!frame.data)
            leave("no memory");
    }
    for (uint32_t x = 0; x < width; x++) {
        const double stops = UVC_STOPS * ((x + 0.5) / width - 0.5);
        frame.data[2 * x] = code_of(UVC_LIGHT * pow(8, light - 8) * total * exp2(stops));
        frame.data[2 * x + 1] = 128;
    }
    for (uint32_t y = 1; y < height; y++)
        memcpy(frame.data + (size_t)y * width * 2, frame.data, (size_t)width * 2);
    for (uint32_t x = 0; x < UVC_TRUTH_BITS * UVC_TRUTH_PIXELS; x++)
        frame.data[2 * x] = truth >> x / UVC_TRUTH_PIXELS & 1 ? 235 : 16;
    frame.sent = 0;
    frame.toggle ^= 1;
}

/* One payload per waiting transfer: a header of two bytes, which marks the last one. */
static void pump(void)
{
    static uint8_t payload[PAYLOAD];
    while (urbs.count && frame.sent < frame.bytes) {
        const uint32_t room = (urbs.bytes[0] < PAYLOAD ? urbs.bytes[0] : PAYLOAD) - 2, left = frame.bytes - frame.sent;
        const uint32_t now = left < room ? left : room;
        payload[0] = 2;
        payload[1] = (uint8_t)(0x80 | frame.toggle | (now == left ? 2 : 0));
        memcpy(payload + 2, frame.data + frame.sent, now);
        frame.sent += now;
        answer(RET_SUBMIT, urbs.number[0], 0, payload, now + 2);
        urbs.count--;
        memmove(urbs.number, urbs.number + 1, urbs.count * sizeof urbs.number[0]);
        memmove(urbs.bytes, urbs.bytes + 1, urbs.count * sizeof urbs.bytes[0]);
    }
}

/* --- slow writes --- */

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static struct {
    struct {
        uint32_t number, bytes;
        int64_t at_ns;
    } write[8];
    uint32_t count;
} late;

/* Sends the answers that are due; returns when the next one is, or 0. */
static int64_t answer_late(void)
{
    while (late.count && late.write[0].at_ns <= now_ns()) {
        answer(RET_SUBMIT, late.write[0].number, 0, NULL, late.write[0].bytes);
        late.count--;
        memmove(late.write, late.write + 1, late.count * sizeof late.write[0]);
    }
    return late.count ? late.write[0].at_ns : 0;
}

/* 1: the host gets its answer later. */
static int answers_late(uint32_t number, uint32_t bytes)
{
    if (!hard || late.count == sizeof late.write / sizeof late.write[0])
        return 0;
    late.write[late.count].number = number;
    late.write[late.count].bytes = bytes;
    late.write[late.count].at_ns = now_ns() + HARD_WRITE_NS;
    late.count++;
    return 1;
}

/* Whether a write of exposure or gain is accepted. */
static int is_ready(void)
{
    static uint32_t writes;
    return !hard || writes++ % (HARD_READY + HARD_NOT) < HARD_READY;
}

/* --- requests --- */

/* 0, or -1: stalled. */
static int answer_standard(uint8_t request, uint32_t value, uvc_text *out)
{
    switch (request) {
    case 0: /* GET_STATUS */
        uvc_put(out, 2, 0);
        return 0;
    case 6: /* GET_DESCRIPTOR */
        if (value >> 8 == 1)
            uvc_describe_device(out);
        else if (value >> 8 == 2)
            uvc_describe_configuration(out);
        else
            return value >> 8 == 3 ? uvc_describe_string(out, value & 255) : -1;
        return 0;
    case 1: /* CLEAR_FEATURE: the endpoint's halt, with which a stream ends */
        frame.sent = frame.bytes;
        return 0;
    default: /* addresses, configurations, interfaces: as the host requests */
        return 0;
    }
}

static uint32_t interval_for(uint32_t asked)
{
    return slow || asked > 4 * INTERVAL ? UVC_LONGEST : asked > INTERVAL + INTERVAL / 2 ? 2 * INTERVAL : INTERVAL;
}

static int answer_stream(uint8_t request, const uint8_t *data, uint32_t bytes, uvc_text *out)
{
    if (request == SET_CUR && bytes >= 8) {
        stream.frame = data[3] == 2 ? 2 : 1;
        stream.interval = interval_for(get(data + 4, 4));
        return 0;
    }
    if (request == GET_INFO || request == GET_LEN) {
        uvc_put(out, request == GET_INFO ? 1 : 2, request == GET_INFO ? 3 : 34);
        return 0;
    }
    UVC_PUT(out, 1, 0, 1, stream.frame);
    uvc_put(out, 4, request == GET_MAX ? UVC_LONGEST : request == GET_CUR ? stream.interval : INTERVAL);
    UVC_PUT(out, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    uvc_put(out, 4, width_of() * height_of() * 2);
    uvc_put(out, 4, PAYLOAD);
    uvc_put(out, 4, 48000000);
    UVC_PUT(out, 3, 0, 0, 0);
    return 0;
}

static int answer_control(uint8_t request, uint32_t entity, uint32_t selector, const uint8_t *data, uvc_text *out)
{
    if (hard && entity == 0 && selector == 2 && request == GET_CUR) { /* VC_REQUEST_ERROR_CODE_CONTROL: not ready */
        uvc_put(out, 1, 1);
        return 0;
    }
    for (int i = 0; i < CONTROLS; i++) {
        control *c = &controls[i];
        if (c->entity != entity || c->selector != selector)
            continue;
        const uint32_t values[] = {c->now, c->least, c->most, c->step, c->bytes, 3, c->usual};
        if (request == SET_CUR && (i == EXPOSURE || i == GAIN) && !is_ready())
            return -1;
        if (request == SET_CUR)
            c->now = get(data, c->bytes);
        else if (request >= GET_CUR && request <= GET_DEF)
            uvc_put(out, request == GET_LEN ? 2 : request == GET_INFO ? 1 : c->bytes, values[request - GET_CUR]);
        else
            return -1;
        return 0;
    }
    return -1;
}

static void answer_setup(uint32_t number, const uint8_t setup[8], const uint8_t *data, uint32_t bytes)
{
    const uint32_t value = get(setup + 2, 2), index = get(setup + 4, 2), length = get(setup + 6, 2);
    uvc_text out = {.length = 0};
    int failed;
    if ((setup[0] & 0x60) == 0)
        failed = answer_standard(setup[1], value, &out);
    else if ((index & 255) == 1)
        failed = answer_stream(setup[1], data, bytes, &out);
    else
        failed = answer_control(setup[1], index >> 8, value >> 8, data, &out);
    if (failed)
        answer(RET_SUBMIT, number, -EPIPE, NULL, 0);
    else if (setup[0] & 0x80)
        answer(RET_SUBMIT, number, 0, out.byte, out.length < length ? out.length : length);
    else if ((setup[0] & 0x60) == 0 || (index & 255) == 1 || !answers_late(number, bytes))
        answer(RET_SUBMIT, number, 0, NULL, bytes);
}

/* One command of the host. */
static void serve(void)
{
    static uint8_t data[65536];
    uint32_t header[12];
    take(header, sizeof header);
    const uint32_t command = ntohl(header[0]), number = ntohl(header[1]), is_in = ntohl(header[3]);
    const uint32_t endpoint = ntohl(header[4]), bytes = ntohl(header[6]);
    if (command == CMD_UNLINK) {
        const uint32_t victim = ntohl(header[5]);
        int status = 0;
        for (uint32_t i = 0; i < urbs.count; i++)
            if (urbs.number[i] == victim) {
                status = -ECONNRESET;
                urbs.count--;
                memmove(urbs.number + i, urbs.number + i + 1, (urbs.count - i) * sizeof urbs.number[0]);
                memmove(urbs.bytes + i, urbs.bytes + i + 1, (urbs.count - i) * sizeof urbs.bytes[0]);
            }
        answer(RET_UNLINK, number, status, NULL, 0);
        return;
    }
    if (command != CMD_SUBMIT || bytes > sizeof data)
        leave("the host says what is not understood");
    if (!is_in)
        take(data, bytes);
    if (endpoint == 0) {
        answer_setup(number, (const uint8_t *)(header + 10), data, is_in ? 0 : bytes);
    } else if (urbs.count < MOST_URBS) {
        urbs.number[urbs.count] = number;
        urbs.bytes[urbs.count++] = bytes;
        pump();
    }
}

/* --- start and end --- */

static void on_signal(int signal_number, siginfo_t *info, void *context)
{
    (void)context;
    if (signal_number == UVC_SET_LIGHT)
        light = info->si_value.sival_int & 15;
    else
        ended = 1;
}

static void attach(void)
{
    int pair[2];
    char words[64];
    const int fd = open("/sys/devices/platform/vhci_hcd.0/attach", O_WRONLY | O_CLOEXEC);
    if (fd < 0 || socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0)
        leave("there is no vhci_hcd");
    const int length =
        snprintf(words, sizeof words, "%d %d %d %d", second, pair[1], 1 << 16 | (2 + second), SPEED_HIGH);
    if (write(fd, words, (size_t)length) != length)
        leave("vhci_hcd takes no camera");
    close(fd);
    close(pair[1]);
    link_fd = pair[0];
}

/* With priority over the frame rate, a long exposure lengthens the frame. */
static int64_t period_ns(void)
{
    const int64_t exposure_ns = (int64_t)controls[EXPOSURE].now * 100000, usual_ns = (int64_t)stream.interval * 100;
    const int longer = controls[AE_PRIORITY].now && controls[AE_MODE].now == 1 && exposure_ns > usual_ns;
    return longer ? exposure_ns : usual_ns;
}

int main(int argc, char **argv)
{
    const struct sigaction action = {.sa_sigaction = on_signal, .sa_flags = SA_SIGINFO};
    display = argc > 1 && strcmp(argv[1], "display") == 0;
    hard = argc > 2 && strcmp(argv[2], "hard") == 0;
    slow = argc > 2 && strcmp(argv[2], "slow") == 0;
    second = argc > 2 && strcmp(argv[2], "second") == 0;
    if (argc < 2 || (!display && strcmp(argv[1], "linear") != 0) || (argc > 2 && !hard && !slow && !second)) {
        fprintf(stderr, "usage: uvc_camera linear|display [hard|slow|second]\n");
        return 2;
    }
    sigaction(UVC_SET_LIGHT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    attach();
    for (int64_t next_ns = now_ns(); !ended;) {
        struct pollfd p = {link_fd, POLLIN, 0};
        const int64_t answer_ns = answer_late();
        const int64_t until_ns = answer_ns && answer_ns < next_ns ? answer_ns : next_ns;
        const int64_t left_ns = until_ns - now_ns();
        if (poll(&p, 1, left_ns > 0 ? (int)(left_ns / 1000000) + 1 : 0) > 0)
            serve();
        if (now_ns() < next_ns)
            continue;
        next_ns += period_ns();
        next_ns = next_ns < now_ns() ? now_ns() : next_ns;
        if (urbs.count && frame.sent == frame.bytes) { /* a program reads, and has the previous frame */
            draw();
            pump();
        }
    }
    shutdown(link_fd, SHUT_RDWR); /* unplugged */
    return 0;
}

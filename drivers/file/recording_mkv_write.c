/* drivers/file/recording_mkv_write.c: a recording's frames.mkv. */
#include <errno.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

#include "file/recording_mkv.h"
#include "pupil/pupil.h"

#define SIZE_BYTES 8                          /* every size is written with so many: it can be filled in later */
#define UNKNOWN    UINT64_C(0xffffffffffffff) /* a master that goes on to the end of the file (RFC 8794, 6.2) */
#define US_NS      1000                       /* TimestampScale: times are in microseconds */
#define SEEK_BYTES 64                         /* kept free for the SeekHead, which is known at the end */
/* A clock that steps by more than this between frames has been set, not run: it counts as a nominal frame. */
#define GAP_MAX_NS (UINT64_C(3600) * 1000000000)

/* Element IDs (RFC 9559, 5.1). */
enum {
    EBML = 0x1A45DFA3,
    EBML_VERSION = 0x4286,
    EBML_READ = 0x42F7,
    EBML_ID_LENGTH = 0x42F2,
    EBML_SIZE_LENGTH = 0x42F3,
    DOC_TYPE = 0x4282,
    DOC_VERSION = 0x4287,
    DOC_READ = 0x4285,
    VOID = 0xEC,
    SEGMENT = 0x18538067,
    SEEK_HEAD = 0x114D9B74,
    SEEK = 0x4DBB,
    SEEK_ID = 0x53AB,
    SEEK_POSITION = 0x53AC,
    INFO = 0x1549A966,
    SCALE = 0x2AD7B1,
    DURATION = 0x4489,
    MUXER = 0x4D80,
    WRITER = 0x5741,
    TRACKS = 0x1654AE6B,
    TRACK = 0xAE,
    NUMBER = 0xD7,
    UID = 0x73C5,
    TYPE = 0x83,
    LACING = 0x9C,
    LANGUAGE = 0x22B59C,
    CODEC = 0x86,
    DEFAULT_DURATION = 0x23E383,
    VIDEO = 0xE0,
    WIDTH = 0xB0,
    HEIGHT = 0xBA,
    FOURCC = 0x2EB524,
    COLOUR = 0x55B0,
    MATRIX = 0x55B1,
    RANGE = 0x55B9,
    TRANSFER = 0x55BA,
    CLUSTER = 0x1F43B675,
    TIMESTAMP = 0xE7,
    BLOCK = 0xA3,
    CUES = 0x1C53BB6B,
    CUE = 0xBB,
    CUE_TIME = 0xB3,
    CUE_POSITIONS = 0xB7,
    CUE_TRACK = 0xF7,
    CUE_CLUSTER = 0xF1
};

/* Bytes as they are made; all of them are far below the room that each use has. */
typedef struct text {
    unsigned char bytes[2048];
    size_t used;
} text;

static void put(text *t, uint64_t value, int bytes)
{
    while (bytes-- > 0)
        t->bytes[t->used++] = (unsigned char)(value >> 8 * bytes);
}

static void put_id(text *t, uint32_t id)
{
    put(t, id, id > 0xffffff ? 4 : id > 0xffff ? 3 : id > 0xff ? 2 : 1);
}

static void put_size(text *t, uint64_t size)
{
    put(t, UINT64_C(1) << 56 | size, SIZE_BYTES);
}

static void put_whole(text *t, uint32_t id, uint64_t value)
{
    put_id(t, id);
    put_size(t, 8);
    put(t, value, 8);
}

static void put_bytes(text *t, uint32_t id, const void *bytes, size_t size)
{
    put_id(t, id);
    put_size(t, size);
    memcpy(t->bytes + t->used, bytes, size);
    t->used += size;
}

static void put_words(text *t, uint32_t id, const char *words)
{
    put_bytes(t, id, words, strlen(words));
}

static void put_real(text *t, uint32_t id, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_whole(t, id, bits);
}

/* A master: open returns where its content begins, which close needs. */
static size_t open_master(text *t, uint32_t id)
{
    put_id(t, id);
    put_size(t, UNKNOWN);
    return t->used;
}

static void close_master(text *t, size_t begin)
{
    text size = {.used = 0};
    put_size(&size, t->used - begin);
    memcpy(t->bytes + begin - SIZE_BYTES, size.bytes, SIZE_BYTES);
}

static void put_void(text *t, size_t bytes) /* with its head: 1 + SIZE_BYTES at least */
{
    put_id(t, VOID);
    put_size(t, bytes - 1 - SIZE_BYTES);
    memset(t->bytes + t->used, 0, bytes - 1 - SIZE_BYTES);
    t->used += bytes - 1 - SIZE_BYTES;
}

/* The codes of Rec. ITU-T H.273, tables 2 to 4. */
static void put_colour(text *t, const pupil_coding *coding)
{
    static const uint8_t matrices[PUPIL_MATRIX_COUNT] = {6, 1, 9};
    static const uint8_t transfers[PUPIL_LIGHT_COUNT] = {13, 8, 13, 1}; /* usual: sRGB, of Y'CbCr */
    const size_t colour = open_master(t, COLOUR);
    put_whole(t, MATRIX, matrices[coding->matrix]);
    put_whole(t, RANGE, coding->range == PUPIL_RANGE_FULL ? 2 : 1);
    put_whole(t, TRANSFER, transfers[coding->light]);
    close_master(t, colour);
}

static void put_track(text *t, const pupil_recording_about *about)
{
    const uint32_t code = pupil_recording_fourcc(about);
    const unsigned char fourcc[4] = {(unsigned char)code, (unsigned char)(code >> 8), (unsigned char)(code >> 16),
                                     (unsigned char)(code >> 24)};
    const size_t tracks = open_master(t, TRACKS), track = open_master(t, TRACK);
    put_whole(t, NUMBER, 1);
    put_whole(t, UID, 1);
    put_whole(t, TYPE, 1); /* video */
    put_whole(t, LACING, 0);
    put_words(t, LANGUAGE, "und");
    put_words(t, CODEC, about->jpeg ? "V_MJPEG" : "V_UNCOMPRESSED");
    put_whole(t, DEFAULT_DURATION, (uint64_t)(1e9 / about->fps + 0.5));
    const size_t video = open_master(t, VIDEO);
    put_whole(t, WIDTH, about->width);
    put_whole(t, HEIGHT, about->height);
    if (!about->jpeg)
        put_bytes(t, FOURCC, fourcc, sizeof fourcc);
    if (!about->jpeg && (about->pixel == PUPIL_PIXEL_YUYV || about->pixel == PUPIL_PIXEL_NV12))
        put_colour(t, &about->coding);
    close_master(t, video);
    close_master(t, track);
    close_master(t, tracks);
}

/* All of it, in as many calls as the kernel wants. */
static int write_all(int fd, struct iovec *part, int parts)
{
    while (parts) {
        const ssize_t wrote = writev(fd, part, parts);
        if (wrote < 0 && errno == EINTR)
            continue;
        if (wrote <= 0) {
            errno = wrote ? errno : ENOSPC;
            return -1;
        }
        size_t left = (size_t)wrote;
        while (parts && left >= part->iov_len)
            left -= part++->iov_len, parts--;
        if (parts) {
            part->iov_base = (char *)part->iov_base + left;
            part->iov_len -= left;
        }
    }
    return 0;
}

/* What was written in part goes again. */
static int append(pupil_mkv_writer *mkv, struct iovec *part, int parts)
{
    int64_t size = 0;
    for (int i = 0; i < parts; i++)
        size += (int64_t)part[i].iov_len;
    if (write_all(mkv->fd, part, parts)) {
        const int error = errno;
        if (ftruncate(mkv->fd, mkv->end) == 0)
            lseek(mkv->fd, mkv->end, SEEK_SET);
        errno = error;
        return -1;
    }
    mkv->end += size;
    return 0;
}

static int append_text(pupil_mkv_writer *mkv, text *t)
{
    struct iovec part = {t->bytes, t->used};
    return append(mkv, &part, 1);
}

int pupil_mkv_begin(pupil_mkv_writer *mkv, int fd, const pupil_recording_about *about)
{
    text t = {.used = 0};
    char version[64];
    snprintf(version, sizeof version, "pupil %s", pupil_version());
    memset(mkv, 0, sizeof *mkv);
    mkv->fd = fd;
    mkv->period_ns = (uint64_t)(1e9 / about->fps + 0.5);
    mkv->cue_every = 1;
    const size_t ebml = open_master(&t, EBML);
    put_whole(&t, EBML_VERSION, 1);
    put_whole(&t, EBML_READ, 1);
    put_whole(&t, EBML_ID_LENGTH, 4);
    put_whole(&t, EBML_SIZE_LENGTH, 8);
    put_words(&t, DOC_TYPE, "matroska");
    put_whole(&t, DOC_VERSION, 4);
    put_whole(&t, DOC_READ, 2);
    close_master(&t, ebml);
    mkv->seek_at = (int64_t)open_master(&t, SEGMENT);
    put_void(&t, SEEK_BYTES);
    const size_t info = open_master(&t, INFO);
    put_whole(&t, SCALE, US_NS);
    put_words(&t, MUXER, version);
    put_words(&t, WRITER, "pupil record");
    mkv->duration_at = (int64_t)t.used;
    put_void(&t, 2 + SIZE_BYTES + 8); /* the Duration */
    close_master(&t, info);
    put_track(&t, about);
    return append_text(mkv, &t);
}

/* ---- frames ---- */

static uint64_t time_of(pupil_mkv_writer *mkv, int64_t timestamp_ns)
{
    const uint64_t step_ns = (uint64_t)timestamp_ns - (uint64_t)mkv->stamp_ns; /* unsigned: of any two there is one */
    if (mkv->frames)
        mkv->time_ns += timestamp_ns > mkv->stamp_ns && step_ns <= GAP_MAX_NS ? step_ns : mkv->period_ns;
    mkv->stamp_ns = timestamp_ns;
    return mkv->time_ns / US_NS;
}

/* Where there is no more room, every second one goes. */
static void note_cue(pupil_mkv_writer *mkv, uint64_t time_us, uint64_t position)
{
    if (mkv->frames % mkv->cue_every)
        return;
    if (mkv->cues == PUPIL_MKV_CUES) {
        for (unsigned i = 0; i < PUPIL_MKV_CUES / 2; i++)
            mkv->cue[i] = mkv->cue[2 * i];
        mkv->cues = PUPIL_MKV_CUES / 2;
        mkv->cue_every *= 2;
    }
    mkv->cue[mkv->cues].time_us = time_us;
    mkv->cue[mkv->cues++].position = position;
}

int pupil_mkv_frame(pupil_mkv_writer *mkv, int64_t timestamp_ns, const void *bytes, size_t size)
{
    static const unsigned char block[4] = {0x81, 0, 0, 0x80}; /* track 1, at the cluster's time, a key frame */
    const uint64_t block_bytes = sizeof block + size, begin = (uint64_t)(mkv->end - mkv->seek_at);
    const uint64_t time_us = time_of(mkv, timestamp_ns);
    text t = {.used = 0};
    put_id(&t, CLUSTER);
    put_size(&t, (1 + SIZE_BYTES + 8) + (1 + SIZE_BYTES) + block_bytes); /* what follows: a time, a block */
    put_whole(&t, TIMESTAMP, time_us);
    put_id(&t, BLOCK);
    put_size(&t, block_bytes);
    memcpy(t.bytes + t.used, block, sizeof block);
    t.used += sizeof block;
    struct iovec parts[2] = {{t.bytes, t.used}, {(void *)(uintptr_t)bytes, size}};
    if (append(mkv, parts, 2))
        return -1;
    note_cue(mkv, time_us, begin);
    mkv->frames++;
    return 0;
}

/* ---- the end ---- */

#define CUE_BYTES (2 * (1 + SIZE_BYTES) + 3 * (1 + SIZE_BYTES + 8))

static int write_cues(pupil_mkv_writer *mkv)
{
    text t = {.used = 0};
    put_id(&t, CUES);
    put_size(&t, (uint64_t)mkv->cues * CUE_BYTES);
    for (unsigned i = 0; i < mkv->cues; i++) {
        const size_t cue = open_master(&t, CUE);
        put_whole(&t, CUE_TIME, mkv->cue[i].time_us);
        const size_t positions = open_master(&t, CUE_POSITIONS);
        put_whole(&t, CUE_TRACK, 1);
        put_whole(&t, CUE_CLUSTER, mkv->cue[i].position);
        close_master(&t, positions);
        close_master(&t, cue);
        if (t.used + CUE_BYTES > sizeof t.bytes) {
            if (append_text(mkv, &t))
                return -1;
            t.used = 0;
        }
    }
    return t.used ? append_text(mkv, &t) : 0;
}

static int patch(const pupil_mkv_writer *mkv, const text *t, int64_t at)
{
    const ssize_t wrote = pwrite(mkv->fd, t->bytes, t->used, at);
    if (wrote >= 0 && (size_t)wrote < t->used)
        errno = ENOSPC;
    return wrote == (ssize_t)t->used ? 0 : -1;
}

int pupil_mkv_end(pupil_mkv_writer *mkv)
{
    const int64_t whole = mkv->end;
    text seek = {.used = 0}, duration = {.used = 0}, size = {.used = 0};
    if (write_cues(mkv)) {
        const int error = errno;
        (void)!ftruncate(mkv->fd, whole);
        errno = error;
        return -1;
    }
    const unsigned char cues[4] = {CUES >> 24, CUES >> 16 & 0xff, CUES >> 8 & 0xff, CUES & 0xff};
    const size_t head = open_master(&seek, SEEK_HEAD), entry = open_master(&seek, SEEK);
    put_bytes(&seek, SEEK_ID, cues, sizeof cues);
    put_whole(&seek, SEEK_POSITION, (uint64_t)(whole - mkv->seek_at));
    close_master(&seek, entry);
    close_master(&seek, head);
    put_void(&seek, SEEK_BYTES - seek.used);
    put_real(&duration, DURATION, (double)(mkv->frames ? mkv->time_ns + mkv->period_ns : 0) / US_NS);
    put_size(&size, (uint64_t)(mkv->end - mkv->seek_at));
    return patch(mkv, &seek, mkv->seek_at) || patch(mkv, &duration, mkv->duration_at) ||
                   patch(mkv, &size, mkv->seek_at - SIZE_BYTES)
               ? -1
               : 0;
}

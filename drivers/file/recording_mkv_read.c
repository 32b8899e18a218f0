/* drivers/file/recording_mkv_read.c: the frames of a Matroska file with one track, ours or one that another program
 * made of it. Segments, clusters and block groups are gone into, everything else is passed over. */
#include <errno.h>
#include <unistd.h>

#include "file/recording_mkv.h"

enum {
    EBML = 0x1A45DFA3,
    SEGMENT = 0x18538067,
    CLUSTER = 0x1F43B675,
    BLOCK_GROUP = 0xA0,
    BLOCK = 0xA1,
    SIMPLE_BLOCK = 0xA3
};

#define BLOCK_HEAD 4 /* the track's number in a byte, the time in two, flags */

void pupil_mkv_open(pupil_mkv_reader *mkv, int fd, uint64_t size)
{
    *mkv = (pupil_mkv_reader){.fd = fd, .size = size};
}

/* An ID or a size (RFC 8794, 4): as many bytes as the first one's leading zeros say. Its length; 0: none. */
static unsigned number(const unsigned char *bytes, size_t count, unsigned most, int is_size, uint64_t *value)
{
    unsigned length = 1;
    if (!count || !*bytes)
        return 0;
    while (!(*bytes & 0x80 >> (length - 1)))
        length++;
    if (length > most || length > count)
        return 0;
    uint64_t got = is_size ? *bytes & (0x7fu >> (length - 1)) : *bytes, unknown = (UINT64_C(1) << 7 * length) - 1;
    for (unsigned i = 1; i < length; i++)
        got = got << 8 | bytes[i];
    *value = is_size && got == unknown ? UINT64_MAX : got;
    return length;
}

int pupil_mkv_next(pupil_mkv_reader *mkv, uint64_t *begin, uint64_t *bytes)
{
    while (mkv->at < mkv->size) {
        unsigned char head[12]; /* an ID of 4 bytes, a size of 8 */
        const ssize_t got = pread(mkv->fd, head, sizeof head, (off_t)mkv->at);
        uint64_t id = 0, size = 0;
        if (got < 0)
            return -1;
        const unsigned id_bytes = number(head, (size_t)got, 4, 0, &id);
        const unsigned size_bytes = id_bytes ? number(head + id_bytes, (size_t)got - id_bytes, 8, 1, &size) : 0;
        errno = 0;
        if (!size_bytes) /* at the very end: cut */
            return mkv->size - mkv->at < sizeof head && got && *head ? 0 : -1;
        if (!mkv->at && id != EBML)
            return -1;
        const uint64_t content = mkv->at + id_bytes + size_bytes;
        if (id == SEGMENT || id == CLUSTER || id == BLOCK_GROUP) {
            mkv->at = content;
            continue;
        }
        if (content > mkv->size || size > mkv->size - content)
            return 0;
        mkv->at = content + size;
        if (id != BLOCK && id != SIMPLE_BLOCK)
            continue;
        *begin = content + BLOCK_HEAD;
        *bytes = size < BLOCK_HEAD ? 0 : size - BLOCK_HEAD;
        return 1;
    }
    return 0;
}

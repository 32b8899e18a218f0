#include "split_file.h"

#include <errno.h>
#include <string.h>

#include "file/common/regular.h"
#include "refuse.h"

#define ORDER       0x01020304u
#define FNV_BEGIN   UINT64_C(0xcbf29ce484222325) /* Fowler, Noll, Vo; draft-eastlake-fnv */
#define FNV_PRIME   UINT64_C(0x100000001b3)
#define STATS_WORDS (sizeof(pupil_stats) / 8)
#define CURVE_WORDS (sizeof(pupil_curve) / 8)
_Static_assert(sizeof(pupil_stats) % 8 == 0 && sizeof(pupil_curve) % 8 == 0, "whole words");
_Static_assert(sizeof(pupil_stats) <= sizeof(((split_frame *)0)->is), "room for both");

enum { INFO_WORDS = 5 };

uint64_t split_digest(uint64_t digest, const void *bytes, size_t count)
{
    if (!digest)
        digest = FNV_BEGIN;
    for (const unsigned char *b = bytes; count--; b++)
        digest = (digest ^ *b) * FNV_PRIME;
    return digest;
}

static uint64_t digest_of(const split_header *header)
{
    split_header h = *header;
    h.own_digest = 0;
    return split_digest(0, &h, sizeof h);
}

static int is_part(const split_file *f)
{
    return strcmp(f->header.kind, SPLIT_PART) == 0;
}

static size_t words_of(const split_file *f)
{
    return is_part(f) ? STATS_WORDS : CURVE_WORDS;
}

/* --- bytes --- */

static void put(split_file *f, unsigned char byte)
{
    f->digest = (f->digest ^ byte) * FNV_PRIME;
    f->bytes++;
    putc_unlocked(byte, f->stream);
}

/* 7 bits a byte, the lowest first; all but the last have the highest bit. */
static void put_number(split_file *f, uint64_t n)
{
    for (; n > 127; n >>= 7)
        put(f, (unsigned char)(n | 128));
    put(f, (unsigned char)n);
}

/* Small numbers of either sign are short; a 0 is followed by the number of further zeros. */
static void put_words(split_file *f, const uint64_t *word, size_t count)
{
    for (size_t i = 0, zeros; i < count; i += zeros) {
        for (zeros = 0; i + zeros < count && !word[i + zeros]; zeros++)
            ;
        if (zeros) {
            put_number(f, 0);
            put_number(f, zeros - 1);
        } else {
            put_number(f, word[i] << 1 ^ (uint64_t) - (int64_t)(word[i] >> 63));
            zeros = 1;
        }
    }
}

static int get(split_file *f)
{
    const int byte = f->bytes < f->header.bytes ? getc_unlocked(f->stream) : EOF;
    if (byte == EOF)
        return -1;
    f->bytes++;
    return byte;
}

static int get_number(split_file *f, uint64_t *n)
{
    int byte = 128;
    *n = 0;
    for (unsigned shift = 0; byte & 128; shift += 7) {
        byte = shift < 64 ? get(f) : -1;
        if (byte < 0)
            return -1;
        *n |= (uint64_t)(byte & 127) << shift;
    }
    return 0;
}

static int get_words(split_file *f, uint64_t *word, size_t count)
{
    for (size_t i = 0; i < count;) {
        uint64_t n, zeros = 0;
        if (get_number(f, &n) || (!n && get_number(f, &zeros)) || zeros >= count - i)
            return -1;
        word[i++] = n >> 1 ^ (uint64_t) - (int64_t)(n & 1);
        for (; zeros; zeros--)
            word[i++] = 0;
    }
    return 0;
}

/* --- writing --- */

int split_file_create(split_file *f, const char *path, int overwrite, pupil_why *why)
{
    split_header *h = &f->header;
    if (pupil_pending_file(&f->pending, path, overwrite, why))
        return -1;
    f->path = path;
    f->writes = 1;
    f->digest = FNV_BEGIN;
    f->stream = pupil_pending_stream(&f->pending);
    snprintf(h->version, sizeof h->version, "%s", pupil_version());
    h->byte_order = ORDER;
    h->own_bytes = sizeof *h;
    if (!f->stream || fwrite(h, sizeof *h, 1, f->stream) != 1)
        return pupil_refuse(why, "%s: cannot be written: %s", path, strerror(errno));
    return 0;
}

int split_file_write(split_file *f, const split_frame *frame, pupil_why *why)
{
    const pupil_frame_info *info = &frame->info;
    uint64_t word[INFO_WORDS] = {(uint64_t)info->timestamp_ns, info->sequence, 0, 0, frame->pixels};
    memcpy(&word[2], &info->exposure_s, 8);
    memcpy(&word[3], &info->gain, 8);
    put_words(f, word, INFO_WORDS);
    put_words(f, frame->is.words, words_of(f));
    if (is_part(f)) {
        put_number(f, strlen(frame->name));
        for (const char *c = frame->name; *c; c++)
            put(f, (unsigned char)*c);
    }
    f->frames++;
    return ferror(f->stream) ? pupil_refuse(why, "%s: cannot be written: %s", f->path, strerror(errno)) : 0;
}

int split_file_finish(split_file *f, pupil_why *why)
{
    f->header.count = f->frames;
    f->header.bytes = f->bytes;
    f->header.digest = f->digest;
    f->header.own_digest = digest_of(&f->header);
    const int failed = fseek(f->stream, 0, SEEK_SET) || fwrite(&f->header, sizeof f->header, 1, f->stream) != 1;
    const int closed = fclose(f->stream);
    f->stream = NULL;
    if (failed || closed)
        return pupil_refuse(why, "%s: cannot be written: %s", f->path, strerror(errno));
    if (pupil_pending_commit(&f->pending, why))
        return -1;
    f->writes = 0;
    return 0;
}

/* --- reading --- */

static int damaged(const split_file *f, pupil_why *why)
{
    return pupil_refuse(why, "%s: is damaged: it is not what was written; make it again", f->path);
}

/* Checks the records, and that nothing follows them. */
static int check_records(const split_file *f, pupil_why *why)
{
    static unsigned char block[1 << 16];
    uint64_t digest = FNV_BEGIN, bytes = 0;
    for (size_t got; (got = fread(block, 1, sizeof block, f->stream)) > 0; bytes += got)
        digest = split_digest(digest, block, got);
    if (ferror(f->stream))
        return pupil_refuse(why, "%s: cannot be read: %s", f->path, strerror(errno));
    if (bytes != f->header.bytes || digest != f->header.digest)
        return damaged(f, why);
    return fseek(f->stream, sizeof f->header, SEEK_SET) ? pupil_refuse(why, "%s: %s", f->path, strerror(errno)) : 0;
}

int split_file_open(split_file *f, const char *path, const char *kind, pupil_why *why)
{
    split_header *h = &f->header;
    const char *fault;
    f->path = path;
    f->stream = pupil_regular_open(path, why);
    if (!f->stream)
        return -1;
    if (fread(h, sizeof *h, 1, f->stream) != 1 || memcmp(h->kind, "pupil ", 6) != 0)
        return pupil_refuse(why, "%s: is not a file of pupil meter or pupil adapt", path);
    const int is_whole = digest_of(h) == h->own_digest;
    h->kind[sizeof h->kind - 1] = h->version[sizeof h->version - 1] = h->input[sizeof h->input - 1] = 0;
    if (h->byte_order != ORDER || h->own_bytes != sizeof *h || strcmp(h->version, pupil_version()) != 0)
        return pupil_refuse(why, "%s: was made by pupil %s, or on another kind of machine; this is pupil %s", path,
                            h->version, pupil_version());
    if (strcmp(h->kind, kind) != 0)
        return pupil_refuse(why, "%s: has %s, where %s were expected", path,
                            is_part(f) ? "the statistics of pupil meter" : "the curves of pupil adapt",
                            strcmp(kind, SPLIT_PART) == 0 ? "the statistics of pupil meter"
                                                          : "the curves of pupil adapt");
    return !is_whole || pupil_config_check(&h->config, &fault) ? damaged(f, why) : check_records(f, why);
}

static int read_frame(split_file *f, split_frame *frame)
{
    uint64_t word[INFO_WORDS], length = 0;
    if (get_words(f, word, INFO_WORDS) || get_words(f, frame->is.words, words_of(f)) ||
        (is_part(f) && get_number(f, &length)) || length >= sizeof frame->name)
        return -1;
    frame->info = (pupil_frame_info){.timestamp_ns = (int64_t)word[0], .sequence = word[1]};
    memcpy(&frame->info.exposure_s, &word[2], 8);
    memcpy(&frame->info.gain, &word[3], 8);
    frame->pixels = word[4];
    for (uint64_t i = 0; i < length; i++) {
        const int byte = get(f);
        if (byte < 0)
            return -1;
        frame->name[i] = (char)byte;
    }
    frame->name[length] = 0;
    return 0;
}

int split_file_read(split_file *f, split_frame *frame, pupil_why *why)
{
    if (read_frame(f, frame))
        return damaged(f, why);
    f->frames++;
    return f->frames == f->header.count && f->bytes != f->header.bytes ? damaged(f, why) : 0;
}

void split_file_close(split_file *f)
{
    if (f->stream)
        fclose(f->stream);
    if (f->writes)
        pupil_pending_discard(&f->pending);
    f->stream = NULL;
    f->writes = 0;
}

/* tests/drivers/file/each_call.h: an action is repeated, and each time the next of its calls fails
 * (nth_call/nth_call.h). Each time it must end by itself, with the same result as without a fault, or with a sentence
 * and nothing left. */
#ifndef PUPIL_TESTS_DRIVERS_EACH_CALL_H
#define PUPIL_TESTS_DRIVERS_EACH_CALL_H

#include "nth_call/nth_call.h"
#include "pupil/error.h"
#include "scratch.h"
#include "source.h"

typedef struct each_call {
    const char *name;
    /* 0 and the `digest` of what was read, or -1 and a sentence. Closes everything again. */
    int (*act)(const struct each_call *c, uint64_t *digest, pupil_why *why);
    void (*prepare)(const struct each_call *c); /* puts earlier contents into each_call_folder; NULL: none */
    const char *path;                           /* the file that it reads, or writes in each_call_folder */
    const void *given;
    /* The digest of what was written, if its bytes differ each time. NULL: that of all of each_call_folder. */
    uint64_t (*made)(const struct each_call *c);
    int keeps;     /* what was written before the failure stays, as of recordings; or the sentence says what is left */
    int gives_way; /* to a signal, where it waits for a reader */
    unsigned long most; /* so many of its calls fail; 0: all */
} each_call;

/* Where outputs go: empty before each run. */
static const char *each_call_folder;

static inline uint64_t each_call_mix(uint64_t digest, const void *data, size_t bytes)
{
    const unsigned char *at = data;
    for (size_t i = 0; i < bytes; i++)
        digest = (digest ^ at[i]) * UINT64_C(0x100000001b3); /* FNV-1a */
    return digest;
}

/* The digest of a file, or of a folder's files in any order. 0: there is nothing. */
static inline uint64_t each_call_digest(const char *path)
{
    uint64_t digest = 1469598103934665603u;
    DIR *folder = opendir(path);
    struct dirent *entry;
    unsigned char block[4096];
    size_t got;
    if (folder) {
        while ((entry = readdir(folder)) != NULL) {
            char *inside = NULL;
            if (entry->d_name[0] == '.' || asprintf(&inside, "%s/%s", path, entry->d_name) < 0)
                continue;
            digest += each_call_mix(each_call_digest(inside), entry->d_name, strlen(entry->d_name));
            free(inside);
        }
        closedir(folder);
        return digest;
    }
    FILE *file = fopen(path, "rb");
    if (!file)
        return 0;
    while ((got = fread(block, 1, sizeof block, file)) > 0)
        digest = each_call_mix(digest, block, got);
    fclose(file);
    return digest;
}

/* The digest of all frames of a source; closes it. -1 and a sentence if one is damaged. */
static inline int each_call_frames(pupil_source *source, uint64_t *digest, pupil_why *why)
{
    pupil_frame frame;
    int got, noticed = 0;
    while ((got = pupil_source_next(source, &frame, why)) == PUPIL_SOURCE_FRAME) {
        const pupil_image_const *image = &frame.image;
        if (frame.notice) /* it may be another picture */
            noticed = snprintf(why->text, sizeof why->text, "%s", frame.notice);
        for (uint32_t y = 0; y < image->height; y++)
            *digest = each_call_mix(*digest, (const char *)image->data + (ptrdiff_t)y * image->stride_bytes,
                                    pupil_row_bytes(image->pixel, image->width));
        *digest = each_call_mix(*digest, &frame.info.timestamp_ns, sizeof frame.info.timestamp_ns);
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
    return got == PUPIL_SOURCE_END && !noticed ? 0 : -1;
}

static inline void each_call_clear(const each_call *c)
{
    scratch_clear(each_call_folder);
    CHECK(mkdir(each_call_folder, 0777) == 0);
    if (c->prepare)
        c->prepare(c);
}

/* After a failure everything is as before; only what cannot be removed stays. */
static inline int each_call_left(const each_call *c, const char *failed, const char *why, int entries, uint64_t before)
{
    if (c->keeps || strstr(why, "is in place, but the old folder") || strncmp(failed, "unlink", 6) == 0 ||
        strcmp(failed, "rmdir") == 0)
        return 0;
    return scratch_entries(each_call_folder) != entries || each_call_digest(each_call_folder) != before;
}

/* Runs it with one call failing; 0: there are no more calls. `expected`: the digest of a run without a fault. */
static inline int each_call_run(const each_call *c, unsigned long at, nth_mode mode, uint64_t *expected)
{
    const char *failed;
    uint64_t digest = 0;
    pupil_why why = {""};
    each_call_clear(c);
    const uint64_t before = each_call_digest(each_call_folder);
    const int files = scratch_entries("/proc/self/fd"), entries = scratch_entries(each_call_folder);
    nth_begin(at, mode);
    const int result = c->act(c, &digest, &why);
    nth_end(&failed);
    if (!result)
        digest += c->made ? c->made(c) : each_call_digest(each_call_folder);
    if (!at)
        *expected = digest;
    const char *call = failed ? failed : "none";
    if (result) {
        CHECK_MSG((mode == NTH_FAILS || (mode == NTH_INTERRUPTED && c->gives_way)) && failed && strlen(why.text) > 10 &&
                      !strchr(why.text, '\n'),
                  "%s, call %lu (%s), mode %d: '%s'", c->name, at, call, (int)mode, why.text);
        CHECK_MSG(!each_call_left(c, call, why.text, entries, before), "%s, call %lu (%s): is not as before (%s)",
                  c->name, at, call, why.text);
    } else
        CHECK_MSG(digest == *expected && scratch_entries(each_call_folder) < entries + 2,
                  "%s, call %lu (%s), mode %d: succeeds, with something else", c->name, at, call, (int)mode);
    CHECK_MSG(scratch_entries("/proc/self/fd") == files, "%s, call %lu (%s): %d files, then %d", c->name, at, call,
              files, scratch_entries("/proc/self/fd"));
    return failed != NULL;
}

static inline void each_call_sweep(const each_call *c)
{
    uint64_t expected = 0;
    unsigned long calls[3] = {0};
    each_call_folder = scratch("out");
    each_call_run(c, 0, NTH_FAILS, &expected);
    for (int mode = NTH_FAILS; mode <= NTH_SHORT; mode++)
        for (int more = 1; more && (!c->most || calls[mode] < c->most); calls[mode]++)
            more = each_call_run(c, calls[mode] + 1, (nth_mode)mode, &expected);
    printf("%s: %lu calls failed, %lu were interrupted, %lu were short\n", c->name, calls[0] - !c->most, calls[1] - 1,
           calls[2] - 1);
    CHECK(calls[0] > 3);
}

#endif

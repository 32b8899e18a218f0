/* tests/drivers/file/still_check.h: shared by the tests of the still readers: files made byte by byte, damaged ones,
 * and pixels.
 */
#ifndef PUPIL_TESTS_STILL_CHECK_H
#define PUPIL_TESTS_STILL_CHECK_H

#include "scratch.h"

#include "file/still/still.h"
#include "pupil/error.h"

static inline void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0) {
        perror(path);
        exit(1);
    }
}

static inline uint8_t *read_whole(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;
    long length;
    if (file && fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) >= 0) {
        rewind(file);
        bytes = malloc((size_t)length + 1);
        *size = bytes ? fread(bytes, 1, (size_t)length, file) : 0;
    }
    if (!bytes) {
        perror(path);
        exit(1);
    }
    fclose(file);
    return bytes;
}

/* A growing string of bytes. */
typedef struct bytes {
    uint8_t data[65536];
    size_t size;
} bytes;

static inline void add(bytes *b, const void *data, size_t size)
{
    if (size > sizeof b->data - b->size)
        abort();
    memcpy(b->data + b->size, data, size);
    b->size += size;
}

static inline void add_text(bytes *b, const char *text)
{
    add(b, text, strlen(text));
}

static inline const float *float_at(const pupil_still *still, uint32_t x, uint32_t y)
{
    return (const float *)still->pixels + ((size_t)y * still->width + x) * 3;
}

static inline int rgb_is(const pupil_still *still, uint32_t x, uint32_t y, double r, double g, double b)
{
    const float *p = float_at(still, x, y);
    return p[0] == (float)r && p[1] == (float)g && p[2] == (float)b;
}

static inline int rgb_near(const pupil_still *still, uint32_t x, uint32_t y, double r, double g, double b,
                           double tolerance)
{
    const float *p = float_at(still, x, y);
    return fabs(p[0] - r) <= tolerance && fabs(p[1] - g) <= tolerance && fabs(p[2] - b) <= tolerance;
}

/* Reads from a buffer of exactly the file's size, so that a sanitizer sees reads beyond it. */
static inline int read_exact(pupil_still_reader *reader, pupil_still *still, const void *data, size_t size,
                             pupil_why *why)
{
    uint8_t *copy = malloc(size ? size : 1);
    int result;
    if (!copy)
        abort();
    memcpy(copy, data, size);
    why->text[0] = 0;
    result = reader(still, copy, size, why);
    free(copy);
    return result;
}

/* A refusal with the expected words. */
#define CHECK_REFUSED(reader, data, size, words)                                                                       \
    do {                                                                                                               \
        pupil_still refused = {0};                                                                                     \
        pupil_why reason;                                                                                              \
        int refused_result = read_exact(reader, &refused, data, size, &reason);                                        \
        CHECK_MSG(refused_result == -1 && strstr(reason.text, words), "said \"%s\", should say \"%s\"", reason.text,   \
                  words);                                                                                              \
        pupil_still_free(&refused);                                                                                    \
    } while (0)

/* The file cut off anywhere, and with bytes changed anywhere: a clean answer each time, with a sentence if refused. */
static inline void check_damage(pupil_still_reader *reader, const uint8_t *data, size_t size, int rounds)
{
    uint8_t *damaged = malloc(size);
    pupil_still still = {0};
    pupil_why why;
    unsigned long bad = 0;
    for (size_t length = 0; length<size; length += size> 4096 ? 37 : 1)
        bad += read_exact(reader, &still, data, length, &why) && !*why.text;
    for (int i = 0; i < rounds && damaged; i++) {
        memcpy(damaged, data, size);
        for (uint64_t n = check_random() % 4 + 1; n; n--)
            damaged[check_random() % size] = (uint8_t)check_random();
        bad += read_exact(reader, &still, damaged, size, &why) && !*why.text;
    }
    CHECK_MSG(bad == 0, "%lu refusals without a sentence", bad);
    free(damaged);
    pupil_still_free(&still);
}

#endif

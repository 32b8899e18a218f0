/* tests/drivers/file/write_icc.h: ICC profiles of displays, made tag by tag. */
#ifndef PUPIL_TESTS_DRIVERS_WRITE_ICC_H
#define PUPIL_TESTS_DRIVERS_WRITE_ICC_H

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 4000 };

typedef struct text {
    uint8_t at[MOST];
    size_t size;
} text;

static inline void put(text *t, uint32_t value, int count)
{
    for (int i = count; i-- > 0;)
        t->at[t->size++] = (uint8_t)(value >> 8 * i);
}

static inline void put_name(text *t, const char *name)
{
    memcpy(t->at + t->size, name, strlen(name));
    t->size += strlen(name);
}

static inline void put_fixed(text *t, double value)
{
    put(t, (uint32_t)lround(value * 65536), 4);
}

/* A curve as its tag has it. */
typedef struct curve {
    int kind; /* of a parametric one; -1: of a table, or of one number, or of none */
    double numbers[7];
    int count;
} curve;

static inline void put_curve(text *t, const curve *c)
{
    put_name(t, c->kind < 0 ? "curv" : "para");
    put(t, 0, 4);
    if (c->kind < 0)
        put(t, (uint32_t)c->count, 4);
    else
        put(t, (uint32_t)c->kind << 16, 4);
    for (int i = 0; i < c->count; i++) {
        if (c->kind >= 0)
            put_fixed(t, c->numbers[i]);
        else
            put(t, (uint32_t)lround(c->numbers[i] * (c->count == 1 ? 256 : 65535)), 2);
    }
    while (t->size % 4)
        put(t, 0, 1);
}

/* A profile of a display: the primaries as columns of XYZ under D50, and one curve for all. */
static inline text profile_of(const double xyz[9], const curve *c)
{
    static const char *const names[] = {"rXYZ", "gXYZ", "bXYZ", "rTRC", "gTRC", "bTRC"};
    enum { TAGS = 6, FIRST = 132 + 12 * TAGS };
    text t = {.size = 12}, tail = {.size = 0};
    put_name(&t, "mntrRGB XYZ ");
    t.size = 36;
    put_name(&t, "acsp");
    t.size = 128;
    put(&t, TAGS, 4);
    put_curve(&tail, c);
    for (int i = 0; i < TAGS; i++) {
        put_name(&t, names[i]);
        put(&t, (uint32_t)(i < 3 ? FIRST + 20 * i : FIRST + 60), 4);
        put(&t, i < 3 ? 20 : (uint32_t)tail.size, 4);
    }
    for (int i = 0; i < 3; i++) {
        put_name(&t, "XYZ ");
        put(&t, 0, 4);
        for (int r = 0; r < 3; r++)
            put_fixed(&t, xyz[3 * r + i]);
    }
    memcpy(t.at + t.size, tail.at, tail.size);
    t.size += tail.size;
    for (int i = 0; i < 4; i++)
        t.at[i] = (uint8_t)(t.size >> (24 - 8 * i));
    return t;
}

/* As the chapters of ICC.1:2010 and the registry of the ICC have them. */
static const double p3[9] = {0.51512, 0.29198, 0.15710, 0.24120, 0.69225, 0.06657, -0.00105, 0.04189, 0.78407};
static const double srgb[9] = {0.43607, 0.38515, 0.14307, 0.22249, 0.71687, 0.06061, 0.01392, 0.09708, 0.71410};
static const curve of_srgb = {3, {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045}, 5};

#endif

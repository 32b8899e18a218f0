/* tests/drivers/file/write_exr.h: OpenEXR files byte by byte, so that a test can have any layout, valid or not.
 * Uncompressed; one part or several ("OpenEXR File Layout", the format's reference). */
#ifndef PUPIL_TESTS_WRITE_EXR_H
#define PUPIL_TESTS_WRITE_EXR_H

#include "still_check.h"

enum { UINT_SAMPLES, HALF_SAMPLES, FLOAT_SAMPLES };

typedef struct exr_channel {
    const char *name; /* in the order of strcmp */
    int type, step_x, step_y;
} exr_channel;

typedef struct exr_part {
    exr_channel channel[6];  /* up to a NULL name */
    int data[4], display[4]; /* left, top, right, bottom */
    int tile[2];             /* 0: scanlines */
    int mipmap;              /* the tiles announce smaller levels, which are not written */
    const float *chromaticities;
    float exposure_s;
    int compression;  /* what the header claims */
    const char *type; /* of a part of several, and of deep ones */
} exr_part;

/* The value of every sample: exact in half, different in every direction. */
static inline double exr_value(int channel, int x, int y)
{
    return (channel + 1) * 0.25 + x * 0.5 + y * 16.0;
}

static inline void add_int(bytes *b, uint64_t value, int size)
{
    for (int i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(value >> 8 * i);
        add(b, &byte, 1);
    }
}

static inline void add_attribute(bytes *b, const char *name, const char *type, const void *data, size_t size)
{
    add(b, name, strlen(name) + 1);
    add(b, type, strlen(type) + 1);
    add_int(b, size, 4);
    add(b, data, size);
}

static inline void add_channels(bytes *b, const exr_part *part)
{
    static bytes list;
    list.size = 0;
    for (const exr_channel *c = part->channel; c->name; c++) {
        add(&list, c->name, strlen(c->name) + 1);
        add_int(&list, (uint64_t)c->type, 4);
        add_int(&list, 0, 4);
        add_int(&list, (uint64_t)(c->step_x ? c->step_x : 1), 4);
        add_int(&list, (uint64_t)(c->step_y ? c->step_y : 1), 4);
    }
    add_int(&list, 0, 1);
    add_attribute(b, "channels", "chlist", list.data, list.size);
}

static inline int exr_chunks(const exr_part *part)
{
    int width = part->data[2] - part->data[0] + 1, height = part->data[3] - part->data[1] + 1;
    if (!part->tile[0])
        return height;
    return ((width + part->tile[0] - 1) / part->tile[0]) * ((height + part->tile[1] - 1) / part->tile[1]);
}

static inline void add_header(bytes *b, const exr_part *part)
{
    const float one = 1, centre[2] = {0, 0};
    const uint8_t compression = (uint8_t)part->compression, zero = 0;
    add_channels(b, part);
    if (part->chromaticities)
        add_attribute(b, "chromaticities", "chromaticities", part->chromaticities, 32);
    if (part->type) {
        const int32_t chunks = exr_chunks(part);
        add_attribute(b, "chunkCount", "int", &chunks, 4);
    }
    add_attribute(b, "compression", "compression", &compression, 1);
    add_attribute(b, "dataWindow", "box2i", part->data, 16);
    add_attribute(b, "displayWindow", "box2i", part->display, 16);
    if (part->exposure_s > 0)
        add_attribute(b, "expTime", "float", &part->exposure_s, 4);
    add_attribute(b, "lineOrder", "lineOrder", &zero, 1);
    if (part->type)
        add_attribute(b, "name", "string", part->channel[0].name, strlen(part->channel[0].name));
    add_attribute(b, "pixelAspectRatio", "float", &one, 4);
    add_attribute(b, "screenWindowCenter", "v2f", centre, 8);
    add_attribute(b, "screenWindowWidth", "float", &one, 4);
    if (part->tile[0]) {
        uint8_t tiles[9];
        memcpy(tiles, part->tile, 8);
        tiles[8] = (uint8_t)part->mipmap;
        add_attribute(b, "tiles", "tiledesc", tiles, 9);
    }
    if (part->type)
        add_attribute(b, "type", "string", part->type, strlen(part->type));
    add_int(b, 0, 1);
}

/* IEEE binary16 of a value that has one: positive and normal, or zero. */
static inline uint16_t half_of(double value)
{
    int exponent;
    double fraction;
    if (value == 0)
        return 0;
    fraction = frexp(value, &exponent);
    return (uint16_t)((exponent + 14) << 10 | ((int)(fraction * 2048) & 1023));
}

static inline void add_sample(bytes *b, int type, double value)
{
    const float f = (float)value;
    if (type == HALF_SAMPLES)
        add_int(b, half_of(value), 2);
    else if (type == UINT_SAMPLES)
        add_int(b, (uint64_t)value, 4);
    else
        add(b, &f, 4);
}

static inline void add_rows(bytes *b, const exr_part *part, const int box[4])
{
    for (int y = box[1]; y <= box[3]; y++)
        for (int c = 0; part->channel[c].name; c++) {
            const exr_channel *channel = part->channel + c;
            const int sx = channel->step_x ? channel->step_x : 1, sy = channel->step_y ? channel->step_y : 1;
            for (int x = box[0]; x <= box[2] && y % sy == 0; x++)
                if (x % sx == 0)
                    add_sample(b, channel->type, exr_value(c, x, y));
        }
}

static inline void add_chunk(bytes *b, const exr_part *part, int part_number, int chunk, uint64_t table)
{
    int box[4] = {part->data[0], part->data[1] + chunk, part->data[2], part->data[1] + chunk};
    size_t size_at;
    uint32_t size;
    for (int i = 0; i < 8; i++)
        b->data[table + 8 * (size_t)chunk + (size_t)i] = (uint8_t)((uint64_t)b->size >> 8 * i);
    if (part->type)
        add_int(b, (uint64_t)part_number, 4);
    if (part->tile[0]) {
        const int across = (part->data[2] - part->data[0] + part->tile[0]) / part->tile[0];
        const int place[4] = {chunk % across, chunk / across, 0, 0};
        add(b, place, 16);
        for (int i = 0; i < 2; i++) {
            box[i] = part->data[i] + place[i] * part->tile[i];
            box[i + 2] =
                box[i] + part->tile[i] - 1 < part->data[i + 2] ? box[i] + part->tile[i] - 1 : part->data[i + 2];
        }
    } else {
        add_int(b, (uint32_t)box[1], 4);
    }
    size_at = b->size;
    add_int(b, 0, 4);
    add_rows(b, part, box);
    size = (uint32_t)(b->size - size_at - 4);
    memcpy(b->data + size_at, &size, 4);
}

static inline void write_exr(bytes *b, const exr_part *parts, int count)
{
    uint64_t table[4];
    const uint32_t flags = (count == 1 && parts->tile[0] ? 0x200u : 0) | (count > 1 ? 0x1000u : 0);
    b->size = 0;
    add_int(b, 20000630, 4);
    add_int(b, 2 | flags, 4);
    for (int p = 0; p < count; p++)
        add_header(b, parts + p);
    if (count > 1)
        add_int(b, 0, 1);
    for (int p = 0; p < count; p++) {
        table[p] = b->size;
        for (int i = 0; i < exr_chunks(parts + p); i++)
            add_int(b, 0, 8);
    }
    for (int p = 0; p < count; p++)
        for (int i = 0; i < exr_chunks(parts + p); i++)
            add_chunk(b, parts + p, p, i, table[p]);
}

#endif

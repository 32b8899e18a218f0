/* The pixels of a gain map: HDR = (SDR + offset) * 2^gain - offset, where gain = min + (max - min) * code^(1/gamma)
 * (Adobe's Gain Map specification 1.0, "Applying the gain map"; ISO 21496-1:2025, clause 6). */
#include "gain_map.h"

#include <math.h>
#include <stdlib.h>

#include "refuse.h"

/* Entries of a table of gains: 257 for each code of 8 bits, between which codes are interpolated. */
#define CODES 65536

/* What a pixel is multiplied with, by its code. */
static void make_table(const pupil_gain_map *map, int channel, float table[CODES])
{
    const double min_ev = map->min_ev[channel], span_ev = map->max_ev[channel] - min_ev;
    const double exponent = 1 / map->gamma[channel];
    for (int i = 0; i < CODES; i++) {
        const double code = i / (double)(CODES - 1);
        table[i] = (float)exp2(min_ev + span_ev * (exponent < 1 || exponent > 1 ? pow(code, exponent) : code));
    }
}

/* Where a pixel's middle is among the map's, and what share of the next one it gets. */
static uint32_t place(uint32_t at, uint32_t of, uint32_t in, float *share)
{
    const double middle = fmin(fmax((at + 0.5) * in / of - 0.5, 0), in - 1.0);
    const uint32_t before = (uint32_t)middle;
    *share = (float)(middle - before);
    return before;
}

/* The map's row at a row of the picture, between two of its own, in codes of 8 bits. They are whole again before they
 * are mixed, as they were before Y'CbCr: a fifth of one can be 0.1 stops of a dark colour. */
static void make_row(const pupil_image_const *codes, uint32_t y, uint32_t height, float *row)
{
    float share;
    const uint32_t before = place(y, height, codes->height, &share);
    const float *a = pupil_image_rows(*codes, before, 1).data;
    const float *b = before + 1 < codes->height ? pupil_image_rows(*codes, before + 1, 1).data : a;
    for (size_t i = 0; i < 3 * (size_t)codes->width; i++)
        row[i] = rintf(255 * a[i]) + share * (rintf(255 * b[i]) - rintf(255 * a[i]));
}

/* Light below 0, which an offset can leave of black, is black. */
static void apply_row(const pupil_gain_map *map, const float *row, uint32_t map_width, float (*table)[CODES],
                      float *rgb, uint32_t width)
{
    for (uint32_t x = 0; x < width; x++, rgb += 3) {
        float share;
        const uint32_t before = place(x, width, map_width, &share);
        const float *a = row + 3 * (size_t)before, *b = before + 1 < map_width ? a + 3 : a;
        for (int c = 0; c < 3; c++) {
            const float code = a[c] + share * (b[c] - a[c]), gain = table[c][(int)(code * (CODES / 255) + 0.5f)];
            rgb[c] = fmaxf((rgb[c] + (float)map->sdr_offset[c]) * gain - (float)map->hdr_offset[c], 0);
        }
    }
}

int pupil_gain_map_apply(const pupil_gain_map *map, const pupil_image_const *codes, float *rgb, uint32_t width,
                         uint32_t height, pupil_why *why)
{
    float(*table)[CODES] = malloc(3 * sizeof *table), *row = malloc(3 * sizeof *row * codes->width);
    const int missing = !table || !row;
    for (int c = 0; c < 3 && !missing; c++)
        make_table(map, c, table[c]);
    for (uint32_t y = 0; y < height && !missing; y++) {
        make_row(codes, y, height, row);
        apply_row(map, row, codes->width, table, rgb + 3 * (size_t)y * width, width);
    }
    free(table);
    free(row);
    return missing ? pupil_refuse(why, "not enough memory for its gain map") : 0;
}

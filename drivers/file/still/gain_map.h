/* drivers/file/still/gain_map.h: the gain map of an HDR photograph: a JPEG of SDR, and behind it in the file a second,
 * mostly smaller JPEG that says for each place how much brighter the HDR picture is.
 *
 * Metadata of the map: ISO 21496-1:2025 (its binary form, in an APP2 segment of the map), else XMP of Adobe's Gain Map
 * specification 1.0 (namespace hdrgm, in an APP1 segment of the map), which is also that of Ultra HDR 1.0 of Android.
 * Values may be attributes or elements, of one number or of three. The map is found by the Multi-Picture Format (CIPA
 * DC-007), else as a picture that follows, where the XMP or the ISO segment of the first one says that there is a map.
 *
 * The picture is that of a display with all the headroom that the file asks for. Of a file whose first picture is the
 * HDR one, that is the first picture as it is. HDR capacities are not needed for it.
 *
 * Everything here works on bytes that the caller keeps; none is trusted. */
#ifndef PUPIL_DRIVERS_FILE_STILL_GAIN_MAP_H
#define PUPIL_DRIVERS_FILE_STILL_GAIN_MAP_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"

typedef struct pupil_gain_map {
    const uint8_t *jpeg; /* the map itself, within the file's bytes */
    size_t jpeg_bytes;
    /* Of red, green and blue. Gains in stops; offsets in units of the SDR white. */
    double min_ev[3], max_ev[3], gamma[3], sdr_offset[3], hdr_offset[3];
    int has_own_primaries; /* the gains are for the primaries of the map's ICC profile, not of the picture's */
} pupil_gain_map;

/* 1: the file has a map that is to be applied; 0: it has none; -1 and a sentence without its subject: it has one that
 * cannot be used. */
int pupil_gain_map_find(const uint8_t *bytes, size_t size, pupil_gain_map *map, pupil_why *why);

/* Makes HDR light of SDR light, in place: RGB floats, width x height, as stored. `codes` is the decoded map, RGB32F
 * from 0 to 1, of any size: it covers the same picture. 0; -1 and a sentence: no memory. */
int pupil_gain_map_apply(const pupil_gain_map *map, const pupil_image_const *codes, float *rgb, uint32_t width,
                         uint32_t height, pupil_why *why);

#endif

/* drivers/file/video/jpeg_frame.h: decodes one JPEG of a camera's MJPG into an image that libpupil reads, by
 * libavcodec.
 *
 * Nothing is lost on the way: 4:2:2 becomes YUYV, 4:2:0 NV12, grey GREY8, each with the decoder's own samples. 4:4:4,
 * 4:4:0 and 4:1:1, which no pixel format of the library has, become RGB8: the matrix rounds to whole codes. The coding
 * is JFIF's (BT.601 of full range, sRGB's curve) unless the caller gives another.
 *
 * A JPEG's size, tables and end are checked first. One without Huffman tables, as from most webcams, gets those of
 * ITU-T T.81, annex K.3. Application segments (a thumbnail, Exif, AVI1) are not looked at. The same bytes give the same
 * image on every CPU of one libavcodec.
 *
 * Memory for an image is allocated at the first frame (and when the sampling changes); libavcodec keeps its own in a
 * pool, and allocates and frees a few small pieces for each frame.
 *
 * Threads: one thread at a time on an object.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_JPEG_FRAME_H
#define PUPIL_DRIVERS_FILE_VIDEO_JPEG_FRAME_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/error.h"
#include "pupil/image.h"

typedef struct pupil_jpeg pupil_jpeg;

/* For frames of width x height, which each of them must have. coding: matrix, range and light of all frames (light
 * USUAL is sRGB); NULL: JFIF's. 0, or -1 and a sentence without its subject (no memory, a size, a build without
 * libavcodec). */
int pupil_jpeg_open(pupil_jpeg **jpeg, uint32_t width, uint32_t height, const pupil_coding *coding, pupil_why *why);

/* The image is good until the next decode, or close. 0, or -1 and a sentence without its subject that says what is
 * wrong with these bytes; the object stays usable. */
int pupil_jpeg_decode(pupil_jpeg *jpeg, const void *bytes, size_t size, pupil_image_const *image, pupil_why *why);

void pupil_jpeg_close(pupil_jpeg *jpeg); /* NULL is allowed */

#endif

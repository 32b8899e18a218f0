/* drivers/colour/white_balance.h: white balance of raw frames, and with it their black level and the sensor's colour
 * matrix, as the pupil_coding that frames carry (pupil/coding.h; what is clipped in the sensor stays white there).
 *
 *     pupil_white_balance_begin(&colour, &options, &coding, pixel, sensor, &why)   // of the stream's first frame
 *     for each frame:
 *         frame.image.coding = &colour.coding; meter; map;
 *         pupil_white_balance_frame(&colour, &frame.image, &frame.info)
 *
 * Automatic balance: factors that make the average of a frame grey (pupil_stats_grey_world), at most
 * PUPIL_WHITE_BALANCE_MOST each. The first frame with light sets them for the second one; from then on they follow with
 * a time constant of PUPIL_WHITE_BALANCE_TAU_S, at any frame rate. A frame without light, or clipped all over, changes
 * nothing. The same frames give the same factors, bit for bit, so a recording of raw frames is balanced again as it
 * was. Of large frames one row of quads in eight is metered, another one each time, so that it costs little compared
 * with a GPU that does the rest.
 *
 * Formats other than mosaics keep the coding that they came with, except for the black level of grey.
 */
#ifndef PUPIL_DRIVERS_COLOUR_WHITE_BALANCE_H
#define PUPIL_DRIVERS_COLOUR_WHITE_BALANCE_H

#include <stddef.h>
#include <stdint.h>

#include "pupil/camera_controls.h"
#include "pupil/error.h"
#include "pupil/pupil.h"

/* Seconds; chosen so that a person does not see the factors move, and a lamp switched on is grey soon. */
#define PUPIL_WHITE_BALANCE_TAU_S 1.5
/* Chosen: a wall of one colour must not be made grey altogether. */
#define PUPIL_WHITE_BALANCE_MOST 4.0

typedef enum pupil_colour_choice {
    PUPIL_COLOUR_AUTO = 0, /* balance: follows the frames; matrix and black level: the sensor's, where they are known */
    PUPIL_COLOUR_OFF,      /* as the frames came */
    PUPIL_COLOUR_GIVEN
} pupil_colour_choice;

typedef struct pupil_colour_options {
    uint32_t balance, matrix, black; /* a pupil_colour_choice each */
    float given_balance[3];          /* of R, G, B, as coding.balance; not all 0 */
    float given_matrix[9];           /* as coding.rgb_from_camera; not all 0 */
    float given_black;               /* code of the frames' format */
    uint32_t knees;                  /* 0: as the frames came; others: as coding.knees */
    float knee_code[PUPIL_KNEES], knee_light[PUPIL_KNEES];
} pupil_colour_options;

typedef struct pupil_white_balance {
    pupil_coding coding; /* of the next frame */
    pupil_coding first;  /* of the first one: what is to be recorded */
    uint32_t follows;    /* 1: balance is automatic; 0: pupil_white_balance_frame has nothing to do */
    uint32_t looked, began;
    int64_t last_ns;
    double balance[3];
    pupil_t meter;
} pupil_white_balance;

/* `coding` is what the driver says of the frames, NULL: nothing. `sensor` is what is known of it, NULL: nothing. A
 * matrix is for balanced colours: the sensor's own is not used if balance is off. 0, or -1 and a sentence: something
 * given is out of its range, or of no use with this format. */
int pupil_white_balance_begin(pupil_white_balance *colour, const pupil_colour_options *options,
                              const pupil_coding *coding, uint32_t pixel, const pupil_camera_sensor *sensor,
                              pupil_why *why);

/* After a frame: colour->coding is that of the next one. `info` brings the time. */
void pupil_white_balance_frame(pupil_white_balance *colour, const pupil_image_const *image,
                               const pupil_frame_info *info);

#endif

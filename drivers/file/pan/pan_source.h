/* drivers/file/pan/pan_source.h: a pinhole camera that turns in an equirectangular panorama.
 *
 *     pan:room.hdr
 *     pan:room.hdr,duration=20,fov=60,size=1280x720
 *     pan:room.hdr,path=0/0:90/10:180/-20/40
 *     pan:room.hdr,path=-30/0@0:150/5@2:150/5@6
 *
 * FILE is any still of linear light that is twice as wide as high. Nothing in a spec needs quotes in a shell. Keys:
 *   path=KEY:KEY:... keyframes, each yaw/pitch[/fov][@seconds] in degrees: yaw to the right of the panorama's centre,
 *                     pitch upward. Yaws within -180..180 are joined the short way round (170 to -170 is 20 degrees); a
 *                     yaw beyond is taken as it is, so that 0/0:360/0 is a full turn. Keyframes without seconds are
 *                     spread evenly over the duration. The camera moves smoothly, and is at rest before and after.
 *                     Without path it wanders by options.seed, past the darkest and the brightest part of the panorama.
 *                     fov=75 horizontal degrees, 5..150, of keyframes that bring none size=640x360 pixels of a frame
 *                     duration=10 seconds; where the path has seconds, those of its last keyframe are the default
 *                     Values without a key come from options (width and height, frames / fps as duration), else they
 *                     are the defaults above. Where both give a duration, the shorter one holds. Frames: duration *
 *                     fps, rounded, at least one; 30 fps unless options say.
 *
 * Threads: see source.h.
 */
#ifndef PUPIL_DRIVERS_FILE_PAN_PAN_SOURCE_H
#define PUPIL_DRIVERS_FILE_PAN_PAN_SOURCE_H

#include "source.h"

#define PUPIL_PAN_PREFIX "pan:"

int pupil_pan_source_open(const char *spec, const pupil_source_options *options, pupil_source **source, pupil_why *why);

#endif

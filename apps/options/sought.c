/* Names of options that people know from ffmpeg and cameras, and what pupil has instead. */
#include <string.h>

#include "option_table.h"

#define PIPE "pupil replay IN -q -o - | ffmpeg -i - -vf "

static const struct {
    const char *names; /* with | between */
    const char *instead;
} sought[] = {
    {"contrast|saturation|hue|eq|vibrance",
     "--tone chooses a curve; the rest is ffmpeg's: " PIPE "eq=contrast=1.1:saturation=1.2 OUT.mp4"},
    {"sharpness|sharpen|unsharp|denoise|vf|filter", "filters are ffmpeg's: " PIPE "unsharp OUT.mp4"},
    {"scale|resize|resolution|s", "scaling is ffmpeg's: " PIPE "scale=1280:-2 OUT.mp4"},
    {"crop", "cropping is ffmpeg's: " PIPE "crop=640:480 OUT.mp4; --roi meters a part"},
    {"crf|quality|qp|bitrate|preset|codec|vcodec|c|b|pix_fmt",
     "coding is ffmpeg's: pupil replay IN -q -o - | ffmpeg -i - -crf 20 OUT.mp4"},
    {"brightness|bias|exposure-compensation|ec", "--ev 0.5 brightens by half a stop"},
    {"exposure|exposure-time|exposure_absolute",
     "a camera's exposure time: pupil run --shutter 10ms; --ev 0.5 brightens by half a stop"},
    {"gamma", "--transfer gamma22 encodes by 2.2, and --ev brightens"},
    {"tonemap|tone-map|tone-mapping|operator|tmo", "--tone chooses a curve"},
    {"smooth|smoothing|adaptation|adapt-speed", "--tau-light and --tau-dark are times of adaptation, in seconds"},
    {"peak|nits|max-luminance|white-point|whitepoint", "--white is the white point"},
    {"i|input", "inputs have no option in front: pupil replay IN.mp4 -o OUT.mp4"},
    {"output", "-o names outputs; the folder of pupil record is its last word"},
    {"start|seek|from|begin|offset", "-ss 12.5 begins there"},
    {"end|to|stop|length", "-t 10 is so long, from -ss on"},
    {"rotate|autorotate|transpose", "frames come upright; --no-rotate leaves them as stored"},
    {"an|no-audio|mute|audio|no-sound", "sound is copied; without it: pupil replay IN -o - | ffmpeg -i - OUT.mp4"},
    {"iso", "a gain of 4 is two stops: pupil run --gain 4"},
    {"wb|awb", "white balance is of raw frames: balance= of raw:FILE, --white-balance of pupil run"},
    {"f|force|replace", "-y replaces outputs that are there"},
};

const char *option_sought(const char *name)
{
    for (size_t i = 0; *name && i < sizeof sought / sizeof *sought; i++)
        if (option_word(name, sought[i].names) >= 0)
            return sought[i].instead;
    return NULL;
}

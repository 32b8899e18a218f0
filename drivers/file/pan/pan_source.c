/* drivers/file/pan/pan_source.c: a camera in a panorama as a source: the spec, the path, the frames. */
#include "pan_source.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "max_pixels.h"
#include "pan_path.h"
#include "refuse.h"

#define DEFAULT_SEED UINT64_C(1)

typedef struct pan_source {
    pupil_source base;
    char *file; /* the spec up to its first key, without the prefix */
    pupil_panorama panorama;
    pupil_pan_path path;
    uint32_t width, height;
    double fov, duration_s; /* 0: not given */
    float *pixels;
    float code_light; /* of the panorama's file, as in pupil_frame */
    uint64_t sequence;
    pupil_why notice; /* of the panorama's file */
} pan_source;

static int pan_next(pupil_source *source, pupil_frame *frame, pupil_why *why)
{
    pan_source *s = (pan_source *)source;
    (void)why;
    if (s->sequence == source->frames)
        return PUPIL_SOURCE_END;
    double time_s = (double)s->sequence / source->fps;
    pupil_panorama_render(&s->panorama, pupil_pan_path_at(&s->path, time_s), s->pixels, s->width, s->height);
    memset(frame, 0, sizeof *frame);
    frame->image.data = s->pixels;
    frame->image.stride_bytes = (ptrdiff_t)(s->width * 3 * sizeof(float));
    frame->image.width = s->width;
    frame->image.height = s->height;
    frame->image.pixel = PUPIL_PIXEL_RGB32F;
    frame->info.timestamp_ns = (int64_t)(time_s * 1e9 + 0.5);
    frame->code_light = s->code_light;
    frame->notice = s->sequence == 0 && s->notice.text[0] ? s->notice.text : NULL;
    frame->info.sequence = s->sequence++;
    frame->name = s->file;
    return PUPIL_SOURCE_FRAME;
}

static void pan_done(pupil_source *source, pupil_frame *frame)
{
    (void)source;
    (void)frame;
}

static void pan_close(pupil_source *source)
{
    pan_source *s = (pan_source *)source;
    pupil_panorama_free(&s->panorama);
    free(s->pixels);
    free(s->file);
    free(s);
}

static const pupil_source_ops pan_ops = {pan_next, pan_done, pan_close};

/* Where the keys begin: at the first comma that is followed by letters and '='; other commas are the file's own. */
static const char *find_keys(const char *spec)
{
    for (const char *comma = strchr(spec, ','); comma; comma = strchr(comma + 1, ',')) {
        const char *c = comma + 1;
        while (isalpha((unsigned char)*c))
            c++;
        if (c > comma + 1 && *c == '=')
            return comma;
    }
    return spec + strlen(spec);
}

static int read_size(pan_source *s, const char *text)
{
    double width, height;
    text = pupil_pan_number(text, "x", &width);
    if (!text || *text != 'x' || !pupil_pan_number(text + 1, "", &height))
        return -1;
    if (width < 1 || height < 1 || width > PUPIL_MAX_SIDE_PX || height > PUPIL_MAX_SIDE_PX || width != floor(width) ||
        height != floor(height))
        return -1;
    s->width = (uint32_t)width;
    s->height = (uint32_t)height;
    return 0;
}

/* A number from low to high. */
static int read_number(double *value, const char *text, double low, double high)
{
    return pupil_pan_number(text, "", value) && *value >= low && *value <= high ? 0 : -1;
}

/* One "name=value". Paths are kept for later: they need the field of view. */
static int read_key(pan_source *s, const char *key, const char **path, pupil_why *why)
{
    const char *wanted = NULL, *value = strchr(key, '=');
    size_t length = value ? (size_t)(value++ - key) : 0;
    if (length == 4 && !strncmp(key, "path", 4))
        *path = value;
    else if (length == 3 && !strncmp(key, "fov", 3))
        wanted = read_number(&s->fov, value, PUPIL_PAN_MIN_FOV, PUPIL_PAN_MAX_FOV)
                     ? "horizontal degrees, 5 to 150, were expected"
                     : NULL;
    else if (length == 4 && !strncmp(key, "size", 4))
        wanted = read_size(s, value) ? "WIDTHxHEIGHT in pixels, like 640x360, 1 to 16384 a side, was expected" : NULL;
    else if (length == 8 && !strncmp(key, "duration", 8))
        wanted = read_number(&s->duration_s, value, 1e-3, 86400) ? "seconds, 0.001 to 86400, were expected" : NULL;
    else
        wanted = "the keys of a pan are path, fov, size and duration";
    if (!wanted)
        return 0;
    return pupil_refuse(why, "%s: key \"%.80s\": %s", s->file, key, wanted);
}

static int read_spec(pan_source *s, const char *spec, char **keys, const char **path, pupil_why *why)
{
    const char *at;
    if (!strncmp(spec, PUPIL_PAN_PREFIX, strlen(PUPIL_PAN_PREFIX)))
        spec += strlen(PUPIL_PAN_PREFIX);
    at = find_keys(spec);
    s->file = strndup(spec, (size_t)(at - spec));
    *keys = strdup(*at ? at + 1 : at);
    if (!s->file || !*keys)
        return pupil_refuse(why, "%s: not enough memory", spec);
    if (!*s->file)
        return pupil_refuse(why, "pan:: a panorama was expected, like pan:room.hdr or pan:room.exr,fov=60");
    for (char *key = *keys, *next; key && *key; key = next) {
        next = strchr(key, ',');
        if (next)
            *next++ = 0;
        if (read_key(s, key, path, why))
            return -1;
    }
    return 0;
}

static int load(pan_source *s, pupil_why *why)
{
    pupil_why words;
    pupil_still still = {0};
    int rc = pupil_still_load(&still, s->file, why);
    if (!rc && (rc = pupil_panorama_make(&s->panorama, &still, &words)))
        pupil_refuse(why, "%s: %s", s->file, words.text);
    s->notice = still.notice;
    s->code_light = still.code_light;
    pupil_still_free(&still);
    return rc;
}

/* The frames' size, where the spec left it open. */
static int plan_size(pan_source *s, const pupil_source_options *options, pupil_why *why)
{
    if (!s->width) {
        s->width = options && options->width ? options->width : 640;
        s->height = options && options->height ? options->height : 360;
    }
    if (s->width <= PUPIL_MAX_SIDE_PX && s->height <= PUPIL_MAX_SIDE_PX)
        return pupil_check_max_pixels(options, s->width, s->height, PUPIL_PAN_PREFIX, s->file, why);
    return pupil_refuse(why, "%s: frames of %u x %u pixels; 1 to %u a side can be made", s->file, s->width, s->height,
                        PUPIL_MAX_SIDE_PX);
}

/* The duration, and from it the number of frames. If neither is given, a path with times decides. */
static int plan_frames(pan_source *s, const pupil_source_options *options, pupil_why *why)
{
    const double fps = options && options->fps > 0 ? options->fps : 30;
    const uint64_t asked = options ? options->frames : 0;
    const int has_times = s->path.has_times && s->path.times[s->path.count - 1] > 0;
    if (!(s->duration_s > 0))
        s->duration_s = asked ? (double)asked / fps : has_times ? s->path.times[s->path.count - 1] : 10;
    double frames = floor(s->duration_s * fps + 0.5);
    frames = asked && frames > (double)asked ? (double)asked : frames;
    if (!(frames <= 1e9))
        return pupil_refuse(why, "%s: %g s at %g frames a second; at most 1000000000 frames can be made", s->file,
                            s->duration_s, fps);
    s->base.fps = fps;
    s->base.frames = frames > 1 ? (uint64_t)frames : 1;
    return 0;
}

/* Fills in what the spec left open. */
static int plan(pan_source *s, const char *path, const pupil_source_options *options, pupil_why *why)
{
    pupil_why words;
    s->fov = s->fov > 0 ? s->fov : 75;
    if (plan_size(s, options, why))
        return -1;
    if (path && pupil_pan_path_read(&s->path, path, s->fov, &words))
        return pupil_refuse(why, "%s: path: %s", s->file, words.text);
    if (plan_frames(s, options, why))
        return -1;
    if (!path) {
        const uint64_t seed = options && options->seed ? options->seed : DEFAULT_SEED;
        pupil_view brightest = {0, 0, 0}, darkest = {0, 0, 0};
        pupil_panorama_extremes(&s->panorama, &brightest, &darkest);
        pupil_pan_path_draw(&s->path, seed, brightest, darkest, s->fov);
    }
    pupil_pan_path_finish(&s->path, s->duration_s);
    return 0;
}

int pupil_pan_source_open(const char *spec, const pupil_source_options *options, pupil_source **source, pupil_why *why)
{
    char *keys = NULL;
    const char *path = NULL;
    pan_source *s = calloc(1, sizeof *s);
    if (!s) {
        pupil_refuse(why, "%s: not enough memory", spec);
        return PUPIL_SOURCE_FAILED;
    }
    s->base.ops = &pan_ops;
    s->base.obeys = PUPIL_SOURCE_FPS | PUPIL_SOURCE_SIZE | PUPIL_SOURCE_SEED;
    int rc = read_spec(s, spec, &keys, &path, why) || load(s, why) || plan(s, path, options, why);
    free(keys);
    if (!rc && !(s->pixels = malloc((size_t)s->width * s->height * 3 * sizeof *s->pixels))) {
        pupil_refuse(why, "%s: not enough memory for frames of %u x %u", s->file, s->width, s->height);
        rc = -1;
    }
    if (rc) {
        pan_close(&s->base);
        return PUPIL_SOURCE_FAILED;
    }
    *source = &s->base;
    return 0;
}

/* What a user names on a command line, opened by what it is. */
#include "file_source.h"

#include "file/pan/pan_source.h"
#include "file/still/stills_source.h"
#include "file/video/video_source.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "file/still/natural_order.h"
#include "refuse.h"
#include "standard_input.h"

#define STILL_KINDS ".exr, .hdr, .pic, .rgbe, .pfm, .png, .jpg, .tif, .webp, .bmp, .dng or a camera's raw files"

int pupil_is_still(const char *path)
{
    static const char *const extensions[] = {".exr", ".hdr",  ".pic",  ".rgbe", ".pfm", ".png", ".jpg", ".jpeg",
                                             ".tif", ".tiff", ".webp", ".bmp",  ".dng", ".nef", ".nrw", ".cr2",
                                             ".cr3", ".arw",  ".raf",  ".orf",  ".rw2", ".pef", ".srw"};
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    for (size_t i = 0; dot && i < sizeof extensions / sizeof *extensions; i++)
        if (strcasecmp(dot, extensions[i]) == 0)
            return 1;
    return 0;
}

static int starts_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

/* The names that dumps of frames have. */
static int is_headless(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && (strcasecmp(dot, ".raw") == 0 || strcasecmp(dot, ".bin") == 0);
}

/* Inputs that must be the only one. */
static int is_alone(const char *input)
{
    struct stat status;
    if (starts_with(input, "pan:") || strcmp(input, "-") == 0)
        return 1;
    const int is_file = stat(input, &status) == 0 ? !S_ISDIR(status.st_mode) : errno != ENOENT && errno != ENOTDIR;
    return is_file && !pupil_is_still(input);
}

static int add_folder(pupil_paths *paths, const char *folder, pupil_why *why)
{
    size_t before = paths->count;
    if (pupil_paths_folder(paths, folder, pupil_is_still))
        return pupil_refuse(why, "%s: the folder cannot be read: %s", folder, strerror(errno));
    return paths->count > before ? 0 : pupil_refuse(why, "%s: the folder holds no still (" STILL_KINDS ")", folder);
}

static int add_pattern(pupil_paths *paths, const char *pattern, pupil_why *why)
{
    size_t before = paths->count;
    if (pupil_paths_glob(paths, pattern, pupil_is_still))
        return pupil_refuse(why, "%s: the pattern cannot be expanded: %s", pattern, strerror(errno));
    return paths->count > before ? 0 : pupil_refuse(why, "%s: no still (" STILL_KINDS ") matches the pattern", pattern);
}

/* Appends the stills that one input represents. A file with this literal name is preferred to a pattern of the same
 * text. */
static int add_input(pupil_paths *paths, const char *input, pupil_why *why)
{
    struct stat status;
    if (stat(input, &status) == 0) {
        if (S_ISDIR(status.st_mode))
            return add_folder(paths, input, why);
        if (pupil_paths_add(paths, input) == 0)
            return 0;
        return pupil_refuse(why, "no memory for the names of the inputs");
    }
    if (errno == ENOENT && strpbrk(input, "*?["))
        return add_pattern(paths, input, why);
    if (errno == ENOENT && strstr(input, ",format="))
        return pupil_refuse(why, "%s: there is no such file; frames without a header are read as raw:%s", input, input);
    if (errno == ENOENT && strchr(input, '%'))
        return pupil_refuse(why,
                            "%s: there is no such file; a sequence is a pattern in quotes, such as 'seq.*.exr', or "
                            "its folder",
                            input);
    if (!input[0])
        return pupil_refuse(why, "the name of an input is empty");
    return pupil_refuse(why, "%s: cannot be opened: %s", input, strerror(errno));
}

static int open_standard_input(const pupil_source_options *options, pupil_source **source, pupil_why *why)
{
    static const char *const path = "/dev/stdin";
    const int still = pupil_standard_input_prepare(options ? options->stop : NULL, why);
    if (still < 0)
        return PUPIL_SOURCE_FAILED;
    return still ? pupil_stills_source_open(&path, 1, options, source, why)
                 : pupil_video_source_open("-", options, source, why);
}

int pupil_file_source_open(const char *const *inputs, size_t count, const pupil_source_options *options,
                           pupil_source **source, pupil_why *why)
{
    pupil_paths paths = {0};
    int result = 0;
    if (count == 0) {
        pupil_refuse(why, "no input was named; a file, a folder, a pattern, pan:FILE or - is needed");
        return PUPIL_SOURCE_FAILED;
    }
    for (size_t i = 0; i < count; i++)
        if (count > 1 && is_alone(inputs[i])) {
            pupil_refuse(why,
                         "%s: must be the only input; only stills (" STILL_KINDS ") can follow one another, and an "
                         "output is named by -o",
                         inputs[i]);
            return PUPIL_SOURCE_FAILED;
        }
    if (strstr(inputs[0], "://")) {
        pupil_refuse(why,
                     "%s: files are read, not addresses: ffmpeg -i '%s' -map 0:v -c copy -f matroska - | "
                     "pupil replay - -o OUT.mp4",
                     inputs[0], inputs[0]);
        return PUPIL_SOURCE_FAILED;
    }
    if (starts_with(inputs[0], "pan:"))
        return pupil_pan_source_open(inputs[0], options, source, why);
    if (strcmp(inputs[0], "-") == 0)
        return open_standard_input(options, source, why);
    if (is_alone(inputs[0])) {
        result = pupil_video_source_open(inputs[0], options, source, why);
        if (result && why && is_headless(inputs[0]))
            pupil_refuse_add(why, "; frames without a header are read as raw:%s,format=RG10,size=1920x1080", inputs[0]);
        return result;
    }
    for (size_t i = 0; i < count && result == 0; i++)
        result = add_input(&paths, inputs[i], why);
    if (result == 0)
        result = pupil_stills_source_open((const char *const *)paths.path, paths.count, options, source, why);
    else
        result = PUPIL_SOURCE_FAILED;
    pupil_paths_free(&paths);
    return result;
}

/* Finds, before anything is opened, outputs that would overwrite an input, each other or existing files. */
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "file/common/pending.h"
#include "file/file_source.h"
#include "file/recording/recording.h"
#include "file/still/natural_order.h"
#include "frame_options.h"
#include "refuse.h"

enum { MOST_PATHS = FRAME_MOST_OUTPUTS + 5 };

static size_t gather(const frame_options *o, const char *paths[MOST_PATHS])
{
    const char *others[] = {o->stats, o->plot, o->report, o->record, o->control};
    size_t count = 0;
    for (size_t i = 0; i < o->out_count; i++)
        paths[count++] = o->out[i];
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (others[i])
            paths[count++] = others[i];
    return count;
}

static int is_same_node(const struct stat *x, const struct stat *y)
{
    return x->st_dev == y->st_dev && x->st_ino == y->st_ino && (S_ISREG(x->st_mode) || S_ISDIR(x->st_mode));
}

/* The folder that a path is in. */
static int stat_parent(const char *path, struct stat *parent)
{
    char *copy = strdup(path);
    int failed = !copy || stat(dirname(copy), parent) != 0;
    free(copy);
    return failed;
}

/* The last part of a path, without trailing slashes; *length is its length. */
static const char *last_name(const char *path, size_t *length)
{
    size_t end = strlen(path), start;
    while (end > 1 && path[end - 1] == '/')
        end--;
    for (start = end; start && path[start - 1] != '/';)
        start--;
    *length = end - start;
    return path + start;
}

/* Whether two paths are one place: the same file or folder, or, if nothing is there yet, the same name in the same
 * folder. */
static int is_same_place(const char *a, const char *b)
{
    struct stat x, y;
    int a_there = stat(a, &x) == 0, b_there = stat(b, &y) == 0;
    size_t a_length, b_length;
    if (strcmp(a, b) == 0)
        return 1;
    if (strcmp(a, "-") == 0 || strcmp(b, "-") == 0 || a_there != b_there)
        return 0;
    if (a_there)
        return is_same_node(&x, &y);
    const char *a_name = last_name(a, &a_length), *b_name = last_name(b, &b_length);
    return a_length == b_length && memcmp(a_name, b_name, a_length) == 0 && !stat_parent(a, &x) &&
           !stat_parent(b, &y) && is_same_node(&x, &y);
}

/* The files that are read from a recording's folder. */
static int is_recorded(const char *path)
{
    size_t length;
    const char *name = last_name(path, &length);
    return strncmp(name, "frames.", 7) == 0 || strcmp(name, "recording.json") == 0;
}

/* Whether a file is among the files of an input that is a folder or a pattern. */
static int is_among(const struct stat *file, const char *input)
{
    pupil_paths paths = {0};
    struct stat is;
    int found = 0;
    if (stat(input, &is) != 0)
        pupil_paths_glob(&paths, input, NULL);
    else if (S_ISDIR(is.st_mode))
        pupil_paths_folder(&paths, input, pupil_is_recording(input) ? is_recorded : pupil_is_still);
    for (size_t i = 0; i < paths.count && !found; i++)
        found = stat(paths.path[i], &is) == 0 && is_same_node(file, &is);
    pupil_paths_free(&paths);
    return found;
}

/* Whether an output would replace an input: its file, one of its files, or (for an output folder) the folder that it is
 * in. */
static int replaces(const char *output, int may_be_folder, const char *input)
{
    struct stat x, y;
    if (strcmp(output, "-") == 0 || stat(output, &x) != 0 || (S_ISDIR(x.st_mode) && !may_be_folder))
        return 0;
    return (stat(input, &y) == 0 && is_same_node(&x, &y)) || (S_ISREG(x.st_mode) && is_among(&x, input)) ||
           (S_ISDIR(x.st_mode) && !stat_parent(input, &y) && is_same_node(&x, &y));
}

/* Whether an output would replace what an input names. After a prefix come a file's name, which may have commas, and
 * keys after another comma: each part that ends at a comma may be the file. */
static int replaces_named(const char *output, int may_be_folder, const char *input)
{
    if (strncmp(input, "synth:", 6) == 0)
        return 0;
    if (strncmp(input, "pan:", 4) != 0 && strncmp(input, "raw:", 4) != 0)
        return replaces(output, may_be_folder, strcmp(input, "-") == 0 ? "/dev/stdin" : input);
    char *name = strdup(input + 4), *comma = name;
    int found = 0;
    while (comma && !(found = replaces(output, may_be_folder, name)) && (comma = strrchr(name, ',')))
        *comma = 0;
    free(name);
    return found;
}

/* A folder is made next to its final place, and moved there when it is complete, onto nothing or an empty folder. Other
 * files in that folder would make this fail at the very end. */
static int is_inside(const char *path, const char *folder)
{
    char *copy = strdup(path), *above = copy;
    int inside = 0, end = !copy || strcmp(path, "-") == 0;
    while (!end && !inside) {
        above = dirname(above);
        inside = is_same_place(above, folder);
        end = strcmp(above, ".") == 0 || strcmp(above, "/") == 0;
    }
    free(copy);
    return inside;
}

/* Refuses existing files; existing folders are checked when they are written. */
static int check_kept(const frame_options *o, pupil_why *why)
{
    for (size_t i = 0; i < o->out_count + 2 && !o->overwrite; i++) {
        const char *path = i < o->out_count ? o->out[i] : i == o->out_count ? o->stats : o->plot;
        struct stat is;
        if (path && strcmp(path, "-") != 0 && stat(path, &is) == 0 && S_ISREG(is.st_mode)) {
            pupil_pending_keep(path, why);
            return OPTIONS_USAGE;
        }
    }
    return OPTIONS_RUN;
}

int frame_options_check_paths(const frame_options *o, pupil_why *why)
{
    const char *paths[MOST_PATHS];
    size_t count = gather(o, paths);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < i; k++)
            if (is_same_place(paths[i], paths[k])) {
                pupil_refuse(why, "%s: named for two outputs; each needs a place of its own", paths[i]);
                return OPTIONS_USAGE;
            }
        for (size_t k = 0; k < count; k++)
            if (k != i && is_inside(paths[i], paths[k])) {
                pupil_refuse(why, "%s: is inside %s, which is an output, too; each needs a place of its own", paths[i],
                             paths[k]);
                return OPTIONS_USAGE;
            }
        int taken = o->veil && o->eye.psf == PUPIL_VEIL_GAUSSIANS && replaces(paths[i], 0, o->veil); /* --veil's file */
        for (size_t k = 0; k < o->input_count && !taken; k++)
            taken = replaces_named(paths[i], i < o->out_count || paths[i] == o->record, o->inputs[k]);
        if (taken) {
            pupil_refuse(why, "%s: is also an input, and would be replaced", paths[i]);
            return OPTIONS_USAGE;
        }
    }
    return check_kept(o, why);
}

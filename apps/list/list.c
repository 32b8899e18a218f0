/* pupil list: the cameras of the system, and what they offer. */
#include "list.h"

#include <stdlib.h>
#include <string.h>

#include "options/commands.h"
#include "plain_text.h"
#include "source.h"

typedef struct list {
    list_camera *camera;
    size_t count;
    int failed, refused;
    FILE *err;
} list;

static int add(void *closure, const pupil_live_identity *is, pupil_live_modes *modes, const char *why)
{
    list *l = closure;
    if (*why)
        fprintf(l->err, "pupil list: %s\n", why); /* of a camera: what was read until then is listed */
    if (!is) {
        l->refused |= *why != 0;
        return 0;
    }
    list_camera *more = realloc(l->camera, (l->count + 1) * sizeof *more);
    if (!more) {
        l->failed = 1;
        return 1;
    }
    l->camera = more;
    more[l->count].is = *is;
    pupil_plain_text(more[l->count].is.name); /* the name comes from the device */
    pupil_plain_text(more[l->count].is.bus);
    more[l->count].modes = *modes;
    *modes = (pupil_live_modes){0}; /* kept here */
    l->count++;
    return 0;
}

static void print_line(const list_camera *camera, FILE *out)
{
    const pupil_live_identity *d = &camera->is;
    fprintf(out, "%s  %s  %s  %s", d->path, d->name, d->driver, d->bus);
    for (uint32_t i = 0; i < camera->modes.count; i++) {
        const pupil_live_mode *mode = &camera->modes.mode[i];
        char sizes[4096];
        const int read = mode->read;
        pupil_live_mode_text(mode, sizes, sizeof sizes);
        fprintf(out, "%s%s%s%s%s%s", i ? "; " : "  ", read ? "" : "[", mode->name, *sizes ? " " : "", sizes,
                read ? "" : "]");
    }
    fputc('\n', out);
}

int list_cameras(const pupil_live_system *system, int json, FILE *out, FILE *err)
{
    list l = {.err = err};
    pupil_why why = {"not enough memory"};
    char *text = NULL;
    int failed = pupil_live_cameras(system, 1, add, &l, &why) || l.failed;
    if (!failed && json) {
        text = list_json(l.camera, l.count);
        failed = !text;
        if (text)
            fprintf(out, "%s\n", text);
        free(text);
    } else if (!failed) {
        for (size_t i = 0; i < l.count; i++)
            print_line(&l.camera[i], out);
        if (!l.count)
            fputs(l.refused ? "no camera that can be asked\n" : "no camera\n", out);
        if (!l.count && !l.refused)
            fputs("pupil list: no /dev/video* gives pictures; dmesg shows what the kernel detected of a camera that is "
                  "plugged in. Without a camera, try 'pupil replay synth:room -o room.mp4'\n",
                  err);
    }
    if (failed)
        fprintf(err, "pupil list: %s\n", why.text);
    for (size_t i = 0; i < l.count; i++)
        pupil_live_modes_free(&l.camera[i].modes);
    free(l.camera);
    return failed ? EXIT_FAILED : EXIT_DONE;
}

typedef struct list_options {
    int json;
} list_options;

static const option_row rows[] = {OPTION_ROW_JSON(list_options, json, "the same as JSON")};

static const option_group groups[] = {{NULL, OPTION_ROWS(rows)}, {0}};

const option_command list_command = {
    .name = "list",
    .summary = "the cameras that are present, and what they offer",
    .usage = "[--json]",
    .about = "The cameras that are present: a line each with its path, name, driver and bus, and its\n"
             "formats with their sizes and frames a second (in brackets those that pupil does not\n"
             "read). Any of path, number and name can follow v4l2: as an input. Cameras of libcamera\n"
             "follow; their path is the input as it is.",
    .exits = "0 done, with or without a camera, 1 failed, 2 usage",
    .manual = "Lists the cameras, a line each: path, name, driver, bus, and formats with their sizes and frames a "
              "second. Formats that pupil does not read are in brackets.",
    .instead = "'pupil list --help' has more",
    .groups = groups,
};

int list_main(int argc, char **argv)
{
    list_options o = {0};
    option_words words;
    const int parsed = options_read(&list_command, &o, argc, argv, &words);
    if (parsed >= 0)
        return parsed;
    if (o.json && list_json_refusal()) {
        fprintf(stderr, "pupil list: --json: %s\n", list_json_refusal());
        return EXIT_FAILED;
    }
    const int status = list_cameras(NULL, o.json, stdout, stderr);
    if (status == EXIT_DONE && fflush(stdout) != 0) {
        fputs("pupil list: standard output cannot be written\n", stderr);
        return EXIT_FAILED;
    }
    return status;
}

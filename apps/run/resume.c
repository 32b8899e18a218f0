#include "resume.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file/common/pending.h"
#include "file/common/regular.h"
#include "kept.h"
#include "refuse.h"
#include "sensor.h"

enum { MOST_LEFT_OUT = 30, LOCK_TRIES = 20, LOCK_PAUSE_US = 100000 };
#define FIRST_NS   INT64_C(5000000000) /* a run that is killed later can be resumed */
#define EVERY_NS   INT64_C(60000000000)
#define CHANGED_EV 0.05 /* a difference that nobody sees at the start is not worth a write */

/* Reads a camera's line of the file (run_kept_read). A missing file has none. 0, or -1 and a sentence. */
static int read_kept(const char *path, const char *camera, FILE *others, run_kept *kept, pupil_why *why)
{
    pupil_why words;
    FILE *in = pupil_regular_open(path, &words);
    *kept = (run_kept){0};
    if (!in)
        return errno == ENOENT ? 0 : pupil_refuse(why, "%s", words.text);
    const int failed = run_kept_read(in, path, camera, others, kept, why);
    fclose(in);
    return failed;
}

/* Opens the file's folder, and locks it against other runs that end at the same time; the file itself cannot be locked,
 * because it is replaced. A lock that is held for long is not waited for. To be closed; -1: no folder. */
static int lock_folder(const char *path)
{
    char copy[PATH_MAX];
    snprintf(copy, sizeof copy, "%s", path);
    const int folder = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (int i = 0; folder >= 0 && flock(folder, LOCK_EX | LOCK_NB) != 0 && i < LOCK_TRIES; i++)
        usleep(LOCK_PAUSE_US);
    return folder;
}

/* Replaces the file completely, or leaves it as it was. */
static int replace(const char *path, const char *camera, double total_s, pupil_why *why)
{
    pupil_pending pending;
    run_kept unused;
    if (pupil_pending_file(&pending, path, 1, why))
        return -1;
    errno = 0;
    FILE *out = pupil_pending_stream(&pending);
    int failed = 0;
    if (out) {
        run_kept_write(out, camera, total_s);
        failed = read_kept(path, camera, out, &unused, why);
    }
    const int unwritten = !out || ferror(out);
    if ((out && fclose(out) != 0) || unwritten)
        failed = pupil_refuse(why, "%s: cannot be written: %s", path, strerror(errno ? errno : EIO));
    if (!failed)
        failed = pupil_pending_commit(&pending, why);
    pupil_pending_discard(&pending);
    return failed;
}

static int write_kept(const char *path, const char *camera, double total_s, pupil_why *why)
{
    const int folder = lock_folder(path), failed = replace(path, camera, total_s, why);
    if (folder >= 0)
        close(folder);
    return failed;
}

int run_resume_check(const char *path, pupil_why *why)
{
    pupil_pending pending;
    run_kept unused;
    if (!path)
        return 0;
    if (pupil_pending_file(&pending, path, 1, why))
        return -1;
    pupil_pending_discard(&pending);
    return read_kept(path, NULL, NULL, &unused, why);
}

static void name_camera(run_resume *r, const pupil_source *source)
{
    const pupil_live_identity *is = &pupil_live_get(source)->is;
    const char *const names[] = {is->driver, is->bus, is->name};
    char *to = r->camera;
    for (int i = 0; i < 3; i++) {
        if (i)
            *to++ = '\t';
        for (const char *c = names[i]; *c; c++)
            *to++ = iscntrl((unsigned char)*c) ? '?' : *c;
    }
    *to = 0;
    r->reopened = pupil_live_get(source)->counts.reopened;
}

/* Makes all folders of the path up to its last "/". -1: one cannot be made. */
static int make_folders(char *path)
{
    for (char *at = strchr(path + 1, '/'); at; at = strchr(at + 1, '/')) {
        *at = 0;
        const int failed = mkdir(path, 0700) != 0 && errno != EEXIST;
        *at = '/';
        if (failed)
            return -1;
    }
    return 0;
}

/* The usual file, whose folder is made; NULL: impossible. */
static const char *usual_path(char *path, size_t bytes)
{
    static const struct {
        const char *variable, *below;
    } places[] = {{"STATE_DIRECTORY", ""}, {"XDG_STATE_HOME", "/pupil"}, {"HOME", "/.local/state/pupil"}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const char *folder = getenv(places[i].variable);
        if (!folder || *folder != '/') /* by the XDG base directory specification */
            continue;
        const int length = (int)strcspn(folder, ":"); /* systemd separates several by ":" */
        const int n = snprintf(path, bytes, "%.*s%s/cameras", length, folder, places[i].below);
        return n > 0 && (size_t)n < bytes && make_folders(path) == 0 ? path : NULL;
    }
    return NULL;
}

/* A total far outside the camera's range is another camera's, or another program wrote it. */
static int fits(const pupil_source *source, double total_s)
{
    pupil_camera_limits limits;
    pupil_camera *camera = pupil_live_camera(source);
    if (!camera)
        return 0;
    pupil_camera_get_limits(camera, &limits);
    return total_s > 0.5 * limits.exposure_min_s * limits.gain_min &&
           total_s < 2.0 * limits.exposure_max_s * limits.gain_max;
}

void run_resume_begin(run_resume *r, const char *path, const pupil_source *source, pupil_why *warning)
{
    run_kept kept;
    warning->text[0] = 0;
    *r = (run_resume){.path = path, .is_asked = path != NULL};
    if (!path)
        r->path = path = usual_path(r->usual, sizeof r->usual);
    if (!path)
        return;
    name_camera(r, source);
    if (read_kept(path, r->camera, NULL, &kept, warning) != 0)
        r->path = r->is_asked ? path : NULL; /* the file stays as it is */
    else if (kept.is_damaged)
        pupil_refuse(warning, "%s: is damaged; %s", path,
                     kept.total_s > 0.0 ? "what it says of this camera is used" : "it says nothing of this camera");
    r->total_s = kept.total_s;
    if (r->total_s > 0.0 && !fits(source, r->total_s)) {
        pupil_refuse(warning, "%s: %.3g s of exposure time x gain is none that this camera has; it is not used", path,
                     r->total_s);
        r->total_s = 0.0;
    }
    r->waits = r->total_s > 0.0;
}

int run_resume_leaves_out(run_resume *r, const pupil_source *source, const pupil_frame_info *info)
{
    pupil_camera_status status;
    pupil_camera *camera = pupil_live_camera(source);
    if (!r->waits)
        return 0;
    r->waits = camera && r->left_out < MOST_LEFT_OUT;
    if (r->waits) {
        pupil_camera_get_status(camera, &status);
        r->waits = status.written != status.asks || info->sequence < status.exposure_s.from_frame ||
                   info->sequence < status.gain.from_frame;
    }
    r->left_out += r->waits != 0;
    return r->waits;
}

static void *write_beside(void *run_resume_)
{
    run_resume *r = run_resume_;
    write_kept(r->path, r->camera, r->write_s, NULL); /* an error comes again at the end, and is reported there */
    atomic_store(&r->is_busy, 0);
    return NULL;
}

static void join(run_resume *r)
{
    if (r->has_thread)
        pthread_join(r->thread, NULL);
    r->has_thread = 0;
}

void run_resume_frame(run_resume *r, const pupil_source *source, const pupil_sensor_setting *setting, int64_t now_ns)
{
    if (!r->path)
        return;
    if (r->reopened != pupil_live_get(source)->counts.reopened) { /* it may be another camera */
        join(r);
        name_camera(r, source);
        r->rest_s = r->kept_s = 0.0;
    }
    if (run_sensor_is_at_rest(setting))
        r->rest_s = setting->total_s;
    if (!r->kept_ns)
        r->kept_ns = now_ns;
    if (now_ns - r->kept_ns < (r->kept_s > 0.0 ? EVERY_NS : FIRST_NS) || !(r->rest_s > 0.0) ||
        atomic_load(&r->is_busy) || (r->kept_s > 0.0 && fabs(log2(r->rest_s / r->kept_s)) < CHANGED_EV))
        return;
    join(r);
    r->kept_ns = now_ns;
    r->kept_s = r->write_s = r->rest_s;
    atomic_store(&r->is_busy, 1);
    r->has_thread = pthread_create(&r->thread, NULL, write_beside, r) == 0;
    if (!r->has_thread)
        atomic_store(&r->is_busy, 0);
}

int run_resume_end(run_resume *r, pupil_why *why)
{
    if (!r->path)
        return 0;
    join(r);
    if (!(r->rest_s > 0.0))
        return 0;
    return write_kept(r->path, r->camera, r->rest_s, r->is_asked ? why : NULL) && r->is_asked ? -1 : 0;
}

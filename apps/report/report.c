#include "report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base64.h"
#include "file/common/pending.h"
#include "file/sink/png_write.h"
#include "file/sink/sink_common.h"
#include "page.h"
#include "refuse.h"

/* Frames kept during the run, enough for the shown ones to be spread evenly; even, because it is halved. 120 thumbnails
 * of 320x180 are 21 MB. */
#define KEPT 120

/* From this distance on one sees that a frame is darker or brighter than it will become. */
#define TOLD_EV 0.5

struct pupil_report {
    pupil_pending page;
    pupil_pending parts; /* a folder with the parts of the page, never put in place */
    char *folder, *video, *plot, *picture;
    int made_folder, stills;
    report_picture kept[KEPT];
    size_t count;
    uint64_t seen, stride; /* every stride-th frame is kept */
    report_sums sums;
};

/* --- begin and end --- */

/* Whether an existing index.html may be replaced. */
static int may_replace(const char *path, int overwrite, pupil_why *why)
{
    char start[sizeof REPORT_MARK] = "";
    FILE *f = fopen(path, "rbe");
    if (!f)
        return errno == ENOENT ? 0 : pupil_refuse(why, "%s: cannot be read: %s", path, strerror(errno));
    size_t got = fread(start, 1, sizeof start - 1, f);
    fclose(f);
    if (got != sizeof start - 1 || memcmp(start, REPORT_MARK, got) != 0)
        return pupil_refuse(why, "%s: is there already and no report of pupil; name another folder", path);
    if (!overwrite)
        return pupil_refuse(why, "%s: is there already; name another folder, or add -y (--overwrite)", path);
    return 0;
}

static int make_folder(pupil_report *r, pupil_why *why)
{
    struct stat s;
    r->made_folder = mkdir(r->folder, 0777) == 0;
    int error = errno; /* of mkdir; stat overwrites errno */
    if (r->made_folder || (stat(r->folder, &s) == 0 && S_ISDIR(s.st_mode)))
        return 0;
    if (error == ENOENT)
        return pupil_refuse(why, "%s: the folder that it is to be in is not there; make it first", r->folder);
    return pupil_refuse(why, "%s: is not a folder that a report can be put in: %s", r->folder,
                        strerror(error == EEXIST ? ENOTDIR : error));
}

/* "folder/name"; NULL: out of memory. */
static char *inside(const char *folder, const char *name)
{
    char *path;
    return asprintf(&path, "%s/%s", folder, name) < 0 ? NULL : path;
}

static int name_parts(pupil_report *r, pupil_why *why)
{
    r->video = inside(r->parts.temporary, "video.mp4");
    r->plot = inside(r->parts.temporary, "plot.svg");
    r->picture = inside(r->parts.temporary, "picture.png");
    return r->video && r->plot && r->picture ? 0 : pupil_refuse(why, "%s: not enough memory", r->folder);
}

static int begin(pupil_report *r, const char *folder, int overwrite, pupil_why *why)
{
    char *index = inside(folder, "index.html"), *parts = inside(folder, ".parts");
    int failed = -1;
    r->folder = strdup(folder);
    if (!index || !parts || !r->folder)
        pupil_refuse(why, "%s: not enough memory", folder);
    else if (!*folder)
        pupil_refuse(why, "\"\": a report needs the name of a folder");
    else if (!make_folder(r, why) && !may_replace(index, overwrite, why))
        failed = pupil_pending_file(&r->page, index, 1, why) || pupil_pending_folder(&r->parts, parts, 0, why);
    free(index);
    free(parts);
    return failed ? -1 : name_parts(r, why);
}

int pupil_report_begin(pupil_report **report, const char *folder, int overwrite, int stills, pupil_why *why)
{
    pupil_report *r = calloc(1, sizeof *r);
    if (!r)
        return pupil_refuse(why, "%s: not enough memory", folder);
    r->stride = 1;
    r->stills = stills;
    if (begin(r, folder, overwrite, why)) {
        pupil_report_discard(r);
        return -1;
    }
    *report = r;
    return 0;
}

const char *pupil_report_video(const pupil_report *r)
{
    return r->video;
}

const char *pupil_report_plot(const pupil_report *r)
{
    return r->plot;
}

static void forget(report_picture *p)
{
    thumbnail_free(&p->shown);
    thumbnail_free(&p->fixed);
    free(p->name);
    memset(p, 0, sizeof *p);
}

void pupil_report_discard(pupil_report *r)
{
    if (!r)
        return;
    for (size_t i = 0; i < r->count; i++)
        forget(&r->kept[i]);
    pupil_pending_discard(&r->page);
    pupil_pending_discard(&r->parts);
    if (r->made_folder)
        rmdir(r->folder); /* fails if the folder is not empty */
    free(r->folder);
    free(r->video);
    free(r->plot);
    free(r->picture);
    free(r);
}

/* --- frames --- */

int pupil_report_wants(const pupil_report *r)
{
    return r->seen % r->stride == 0;
}

static int keep(pupil_report *r, const pupil_image_const *rgb8, const pupil_image_const *fixed,
                const frame_log_entry *record)
{
    report_picture *p = &r->kept[r->count++];
    p->frame = record->frame;
    p->time_s = record->time_s;
    p->metered_ev = record->metered_ev;
    p->adapted_ev = record->adapted_ev;
    p->name = strdup(record->name ? record->name : "");
    if (!p->name || thumbnail_make(&p->shown, rgb8) || (fixed && thumbnail_make(&p->fixed, fixed)))
        return -1;
    if (r->count < KEPT)
        return 0;
    for (size_t i = 0; i < KEPT; i++)
        if (i % 2)
            forget(&r->kept[i]);
        else if (i) {
            r->kept[i / 2] = r->kept[i];
            memset(&r->kept[i], 0, sizeof r->kept[i]);
        }
    r->count = KEPT / 2;
    r->stride *= 2;
    return 0;
}

int pupil_report_frame(pupil_report *r, const pupil_image_const *rgb8, const pupil_image_const *fixed,
                       const frame_log_entry *record, pupil_why *why)
{
    if (pupil_report_wants(r) && keep(r, rgb8, fixed, record))
        return pupil_refuse(why, "%s: not enough memory for a thumbnail", r->folder);
    if (!r->seen++) {
        r->sums.width = rgb8->width;
        r->sums.height = rgb8->height;
    }
    r->sums.sizes_differ |= r->sums.width != rgb8->width || r->sums.height != rgb8->height;
    r->sums.pixels += (uint64_t)rgb8->width * rgb8->height;
    return 0;
}

/* --- the page --- */

/* A file's bytes as a data URI; 0; 1: longer than `most`; -1 and a sentence. */
static int embed(FILE *out, const char *type, const char *path, uint64_t most, pupil_why *why)
{
    FILE *in = fopen(path, "rbe");
    fprintf(out, "data:%s;base64,", type);
    int failed = in ? base64_write(out, in, most) : -1;
    if (failed < 0)
        pupil_refuse(why, "%s: cannot be read: %s", path, strerror(errno));
    if (in)
        fclose(in);
    return failed;
}

static int put_picture(const pupil_report *r, FILE *out, const thumbnail *t, const char *what,
                       const pupil_report_page *page, pupil_why *why)
{
    pupil_image_const image = thumbnail_image(t);
    if (pupil_png_write(r->picture, r->folder, &image, page->primaries, page->transfer, why))
        return -1;
    fprintf(out, "<img alt=\"%s\" width=\"%lu\" height=\"%lu\" src=\"", what, (unsigned long)t->width,
            (unsigned long)t->height);
    if (embed(out, "image/png", r->picture, UINT64_MAX, why))
        return -1;
    fputs("\">", out);
    return 0;
}

/* Chooses n of the kept frames, evenly spaced. */
static void choose_evenly(const pupil_report *r, size_t n, unsigned char *is_shown)
{
    for (size_t i = 0; i < n; i++)
        is_shown[n > 1 ? (i * (r->count - 1) + (n - 1) / 2) / (n - 1) : 0] = 1;
}

/* The frame farthest from adapted, by at least TOLD_EV, that is neither shown nor next to one that was chosen here. 0:
 * none. */
static size_t farthest(const pupil_report *r, const unsigned char *is_shown)
{
    double most = TOLD_EV;
    size_t best = 0;
    for (size_t i = 1; i + 1 < r->count; i++) {
        const double off = fabs(r->kept[i].metered_ev - r->kept[i].adapted_ev);
        if (off > most && !is_shown[i] && is_shown[i - 1] != 2 && is_shown[i + 1] != 2) {
            most = off;
            best = i;
        }
    }
    return best;
}

/* Chooses at most n frames; returns how many. After a change of a clip's light, adaptation is over before the next of a
 * few evenly spaced frames. So a third are the frames farthest from adapted, of which `told` are found. */
static size_t choose(const pupil_report *r, size_t n, unsigned char *is_shown, size_t *told)
{
    const size_t most_told = r->stills || n == r->count || !farthest(r, is_shown) ? 0 : n / 3;
    choose_evenly(r, n - most_told, is_shown);
    for (*told = 0; *told < most_told; ++*told) {
        const size_t i = farthest(r, is_shown);
        if (!i)
            break;
        is_shown[i] = 2;
    }
    return n - most_told + *told;
}

static int put_strip(const pupil_report *r, FILE *out, const pupil_report_page *page, pupil_why *why)
{
    size_t most = r->stills ? REPORT_MOST_STILLS : REPORT_MOST_FRAMES, n = r->count < most ? r->count : most;
    unsigned char is_shown[KEPT] = {0};
    if (!n)
        return 0;
    size_t told;
    n = choose(r, n, is_shown, &told);
    fprintf(out, "<h2>%s</h2>\n", r->stills ? "Stills" : "Frames");
    if (n < r->seen)
        fprintf(out, "<p class=\"hint\">%zu of %llu, evenly spaced%s%s", n, (unsigned long long)r->seen,
                told ? ", and some farthest from adapted" : "", r->kept[0].fixed.rgb ? "; " : ".</p>\n");
    if (r->kept[0].fixed.rgb)
        fprintf(out, "%sabove: adapted; below: the exposure of the first frame.</p>\n",
                n < r->seen ? "" : "<p class=\"hint\">");
    fputs("<div class=\"strip\">\n", out);
    for (size_t i = 0; i < r->count; i++) {
        const report_picture *p = &r->kept[i];
        if (!is_shown[i])
            continue;
        fputs("<figure>", out);
        if (put_picture(r, out, &p->shown, "adapted", page, why) ||
            (p->fixed.rgb && put_picture(r, out, &p->fixed, "fixed exposure", page, why)))
            return -1;
        report_caption(out, p, r->stills);
        fputs("</figure>\n", out);
    }
    fputs("</div>\n", out);
    return 0;
}

static int put_video(const pupil_report *r, FILE *out, pupil_why *why)
{
    const uint64_t most = (uint64_t)REPORT_MOST_VIDEO_MIB << 20;
    struct stat s;
    if (stat(r->video, &s) != 0)
        return 0;
    if ((uint64_t)s.st_size > most) {
        fprintf(out,
                "<p class=\"note\">The video is left out: it has %lld MiB, and a page holds at most %d. "
                "Ask for it as a file: -o video.mp4</p>\n",
                (long long)(s.st_size >> 20), REPORT_MOST_VIDEO_MIB);
        return 0;
    }
    fputs("<h2>Video</h2>\n<video controls loop muted playsinline src=\"", out);
    int failed = embed(out, "video/mp4", r->video, most, why);
    fputs("\"></video>\n", out);
    return failed;
}

/* Embedded as an image, so that nothing inside it can affect the page. */
static int put_plot(const pupil_report *r, FILE *out, pupil_why *why)
{
    if (access(r->plot, F_OK) != 0)
        return 0;
    fputs(
        "<h2>Exposure over time</h2>\n<div class=\"scroll\"><img class=\"plot\" alt=\"metered and adapted EV, display "
        "level and shares over time\" src=\"",
        out);
    int failed = embed(out, "image/svg+xml", r->plot, UINT64_MAX, why);
    fputs("\"></div>\n<p class=\"hint\">Aimed at: the display's log-average once the level has settled. It is below "
          "the key, "
          "because the tone curve makes bright light darker.</p>\n",
          out);
    return failed;
}

static int put_page(const pupil_report *r, const pupil_report_page *page, FILE *out, pupil_why *why)
{
    report_head(out, page, &r->sums);
    if (put_video(r, out, why) || put_strip(r, out, page, why) || put_plot(r, out, why))
        return -1;
    report_tables(out, page, &r->sums);
    fputs("</main>\n<footer>Made by pupil ", out);
    report_text(out, page->version);
    fputs(". EV is log2 luminance in stops.</footer>\n</html>\n", out);
    return 0;
}

int pupil_report_finish(pupil_report *r, const pupil_report_page *page, pupil_why *why)
{
    FILE *out = pupil_pending_stream(&r->page);
    int failed = -1;
    if (!out) {
        pupil_refuse(why, "%s: cannot be written: %s", r->page.path, strerror(errno));
    } else {
        failed = put_page(r, page, out, why);
        int bad = ferror(out);
        if ((fclose(out) != 0 || bad) && !failed)
            failed = pupil_refuse(why, "%s: cannot be written: %s", r->page.path, strerror(errno));
    }
    if (!failed)
        failed = pupil_pending_commit(&r->page, why);
    pupil_report_discard(r);
    return failed;
}

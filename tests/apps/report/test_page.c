/* --report: correct base64 and thumbnails; a page that loads nothing, runs nothing, and shows exactly what it was
 * given; complete or absent. */
#include "report/report.h"

#include <math.h>

#include "check.h"
#include "report/base64.h"
#include "report/thumbnail.h"
#include "scratch.h"

static pupil_why why;

static void check_base64(void)
{
    /* RFC 4648, section 10 */
    static const char *const vector[][2] = {{"", ""},
                                            {"f", "Zg=="},
                                            {"fo", "Zm8="},
                                            {"foo", "Zm9v"},
                                            {"foob", "Zm9vYg=="},
                                            {"fooba", "Zm9vYmE="},
                                            {"foobar", "Zm9vYmFy"}};
    for (size_t i = 0; i < sizeof vector / sizeof *vector; i++) {
        char text[64] = "";
        FILE *in = tmpfile(), *out = tmpfile();
        fputs(vector[i][0], in);
        rewind(in);
        CHECK(base64_write(out, in, i) == 0);
        rewind(in);
        CHECK(i == 0 || base64_write(out, in, i - 1) == 1);
        rewind(out);
        CHECK(fread(text, 1, sizeof text, out) >= strlen(vector[i][1]));
        CHECK_MSG(strncmp(text, vector[i][1], strlen(vector[i][1])) == 0, "%s", text);
        fclose(in);
        fclose(out);
    }
}

/* Alternating black and white columns are half the light: 0.5 linear, which is code 188. */
static void check_thumbnails(void)
{
    static const uint32_t size[][4] = {
        {640, 2, 320, 1}, {320, 320, 320, 320}, {1, 16384, 1, 320}, {3840, 2160, 320, 180}};
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        uint32_t w = size[i][0], h = size[i][1];
        unsigned char *rgb = malloc((size_t)w * h * 3);
        for (size_t k = 0; k < (size_t)w * h * 3; k++)
            rgb[k] = (unsigned char)((k / 3 % w + k / 3 / w) % 2 ? 255 : 0);
        /* bottom-up, so that the stride is negative */
        pupil_image_const in = {.data = rgb + (size_t)w * 3 * (h - 1),
                                .stride_bytes = -(ptrdiff_t)w * 3,
                                .width = w,
                                .height = h,
                                .pixel = PUPIL_PIXEL_RGB8};
        thumbnail t;
        CHECK(thumbnail_make(&t, &in) == 0 && t.width == size[i][2] && t.height == size[i][3]);
        int wrong = 0;
        for (size_t k = 0; k < (size_t)t.width * t.height * 3; k++)
            if (w == t.width && h == t.height)
                wrong += t.rgb[k] != rgb[(t.height - 1 - k / 3 / t.width) * t.width * 3 + k % (t.width * 3)];
            else
                wrong += abs(t.rgb[k] - 188) > 2; /* boxes of 51.2 rows are not quite balanced */
        CHECK_MSG(wrong == 0, "%ux%u: %d samples", w, h, wrong);
        thumbnail_free(&t);
        free(rgb);
    }
}

static char *slurp(const char *path)
{
    static char text[1 << 22];
    FILE *f = fopen(path, "rb");
    size_t size = f ? fread(text, 1, sizeof text - 1, f) : 0;
    if (f)
        fclose(f);
    text[size] = 0;
    return text;
}

static size_t occurrences(const char *text, const char *word)
{
    size_t n = 0;
    for (; (text = strstr(text, word)) != NULL; text++)
        n++;
    return n;
}

typedef struct run {
    size_t frames;
    int stills, fixed, video;
    size_t calm_to; /* adapted up to this frame, then less and less; 0: never */
} run;

static const char evil[] = "<script>alert('\"&')</script>";

static void page_of(const char *folder, int overwrite, run how)
{
    static unsigned char rgb[40 * 30 * 3];
    pupil_image_const image = {
        .data = rgb, .stride_bytes = 40 * 3, .width = 40, .height = 30, .pixel = PUPIL_PIXEL_RGB8};
    frame_log_entry *records = calloc(how.frames, sizeof *records);
    pupil_report *report = NULL;
    CHECK_MSG(pupil_report_begin(&report, folder, overwrite, how.stills, &why) == 0, "%s", why.text);
    for (size_t i = 0; report && i < how.frames; i++) {
        records[i] = (frame_log_entry){.frame = i,
                                       .name = evil,
                                       .time_s = (double)i / 30.0,
                                       .metered_ev = (double)i,
                                       .adapted_ev = i >= how.calm_to ? i ? 1.5 : NAN : (double)i,
                                       .output_level = 0.18,
                                       .reason = i < 2 ? "amplification" : "",
                                       .process_us = 12.0,
                                       .output_white_share = i == 1 ? 0.5 : 0.0};
        memset(rgb, (int)(i % 256), sizeof rgb);
        const pupil_image_const *fixed = how.fixed && pupil_report_wants(report) ? &image : NULL;
        CHECK(pupil_report_frame(report, &image, fixed, &records[i], &why) == 0);
    }
    if (report && how.video) {
        scratch_put(pupil_report_video(report), "no real video");
        scratch_put(pupil_report_plot(report), "<svg xmlns='http://www.w3.org/2000/svg'/>");
    }
    pupil_report_row rows[] = {{evil, "0.18", "linear", "pupil <replay>"}, {"empty", NULL, NULL, NULL}};
    pupil_report_page page = {.title = evil,
                              .command = "pupil replay 'a b.exr'",
                              .version = "0.2.0",
                              .records = records,
                              .record_count = how.frames,
                              .settings = rows,
                              .setting_count = 2,
                              .figures = rows,
                              .figure_count = 1};
    CHECK_MSG(report && pupil_report_finish(report, &page, &why) == 0, "%s", why.text);
    CHECK_MSG(scratch_entries(folder) == 1, "%d entries", scratch_entries(folder)); /* the page, and nothing else */
    free(records);
}

static void check_page(run how, size_t pictures)
{
    const char *folder = scratch("report");
    page_of(folder, 1, how);
    char *text = slurp(scratch("report/index.html"));
    CHECK(strncmp(text, "<!DOCTYPE html>", 15) == 0 && strstr(text, "</html>\n") != NULL);
    CHECK(strstr(text, "<script") == NULL && strstr(text, "alert('") == NULL);
    CHECK(strstr(text, "&lt;script&gt;alert(&#39;&quot;&amp;&#39;)&lt;/script&gt;") != NULL);
    CHECK(strstr(text, "pupil replay &#39;a b.exr&#39;") != NULL && strstr(text, "pupil &lt;replay&gt;") != NULL);
    CHECK(strstr(text, "default-src 'none'") != NULL && strstr(text, "prefers-color-scheme:dark") != NULL);
    CHECK(occurrences(text, "src=\"") == occurrences(text, "src=\"data:") && strstr(text, "href=") == NULL);
    CHECK(strstr(text, "//") == NULL || how.frames); /* no address; base64 may hold slashes */
    CHECK_MSG(occurrences(text, "src=\"data:image/png;base64,iVBOR") == pictures * (how.fixed ? 2 : 1), "%zu of %zu",
              occurrences(text, "src=\"data:image/png"), pictures);
    CHECK(occurrences(text, "<figure>") == pictures);
    CHECK((strstr(text, how.frames > 1 ? "further (--amplification)</td><td class=\"v\">2<"
                                       : "further (--amplification)</td><td class=\"v\">1<") != NULL) ==
          (how.frames > 0));
    CHECK(strstr(text, "(--floor)") == NULL && strstr(text, "(--highlights)") == NULL);
    CHECK((strstr(text, "data:video/mp4;base64,bm8gcmVhbCB2aWRlbw==\"") != NULL) == how.video);
    CHECK((strstr(text, "data:image/svg+xml;base64,") != NULL) == how.video);
    if (how.frames)
        CHECK(strstr(text, how.stills ? "script&gt;</b>" : "<b>frame 0</b>") != NULL);
    if (how.frames == 2)
        CHECK(strstr(text, "25 / 50") != NULL && strstr(text, "10.00</td><td class=\"u\">ns / pixel") != NULL);
}

/* In a long clip that is adapted throughout, the pictures are evenly spaced: no gap is more than twice another. */
static void check_spacing(size_t frames)
{
    page_of(scratch("report"), 1, (run){.frames = frames, .calm_to = frames});
    char *text = slurp(scratch("report/index.html"));
    unsigned last = 0, least = UINT32_MAX, most = 0, n = 0, frame;
    while ((text = strstr(text, "<b>frame ")) != NULL && sscanf(text, "<b>frame %u", &frame) == 1) {
        if (n++) {
            least = frame - last < least ? frame - last : least;
            most = frame - last > most ? frame - last : most;
        }
        last = frame;
        text++;
    }
    CHECK_MSG(n == REPORT_MOST_FRAMES && most <= 2 * least && last >= frames - frames / 8,
              "%zu frames: %u pictures, gaps %u to %u, the last %u", frames, n, least, most, last);
}

/* If a clip is not adapted at its end, more pictures are from there, and the page says how many there are. */
static void check_told(void)
{
    page_of(scratch("report"), 1, (run){.frames = 1200, .calm_to = 1100});
    const char *text = slurp(scratch("report/index.html"));
    const char *hint = strstr(text, " of 1200, evenly spaced, and some farthest from adapted");
    const unsigned said = hint ? (unsigned)atoi(hint - 2) : 0;
    unsigned n = 0, late = 0, frame;
    for (; (text = strstr(text, "<b>frame ")) != NULL && sscanf(text, "<b>frame %u", &frame) == 1; text++) {
        n++;
        late += frame >= 1100;
    }
    CHECK_MSG(n == said && n <= REPORT_MOST_FRAMES && n >= REPORT_MOST_FRAMES - 2 && late >= 3,
              "%u pictures, %u of them late; the page says %u", n, late, said);
}

static void check_refusals(void)
{
    pupil_report *report = NULL;
    page_of(scratch("mine"), 0, (run){.frames = 1});
    CHECK(pupil_report_begin(&report, scratch("mine"), 0, 0, &why) != 0);
    CHECK_MSG(strstr(why.text, "index.html") && strstr(why.text, "--overwrite"), "%s", why.text);
    page_of(scratch("mine"), 1, (run){.frames = 2});

    mkdir(scratch("theirs"), 0777);
    scratch_put(scratch("theirs/index.html"), "<!DOCTYPE html>\n<title>a home page</title>\n");
    CHECK(pupil_report_begin(&report, scratch("theirs"), 1, 0, &why) != 0 && strstr(why.text, "no report"));
    CHECK(strstr(slurp(scratch("theirs/index.html")), "a home page") != NULL);
    CHECK(pupil_report_begin(&report, scratch("theirs/index.html"), 1, 0, &why) != 0);
    CHECK_MSG(strstr(why.text, "not a folder"), "%s", why.text);
    CHECK(pupil_report_begin(&report, scratch("a/b"), 1, 0, &why) != 0 && strstr(why.text, "make it first"));
    CHECK(pupil_report_begin(&report, "", 1, 0, &why) != 0 && strstr(why.text, "name of a folder"));
    CHECK(report == NULL);

    CHECK(pupil_report_begin(&report, scratch("gone"), 0, 0, &why) == 0);
    scratch_put(pupil_report_video(report), "half a video");
    pupil_report_discard(report);
    CHECK(!scratch_exists(scratch("gone")));
    pupil_report_discard(NULL);
}

/* A video of 64 MiB and a byte, as a sparse file: left out, and the page says so. */
static void check_large_video(void)
{
    pupil_report *report = NULL;
    pupil_report_page page = {.title = "large", .version = "0.2.0"};
    CHECK(pupil_report_begin(&report, scratch("report"), 1, 0, &why) == 0);
    scratch_put(pupil_report_video(report), "");
    CHECK(truncate(pupil_report_video(report), (REPORT_MOST_VIDEO_MIB << 20) + 1) == 0);
    CHECK(pupil_report_finish(report, &page, &why) == 0);
    const char *text = slurp(scratch("report/index.html"));
    CHECK(strstr(text, "<video") == NULL && strstr(text, "at most 64") != NULL);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    check_base64();
    check_thumbnails();
    check_page((run){.frames = 0}, 0);
    check_page((run){.frames = 1, .stills = 1}, 1);
    check_page((run){.frames = 2, .fixed = 1, .video = 1}, 2);
    check_page((run){.frames = 60, .stills = 1}, 60);
    check_page((run){.frames = 61, .stills = 1}, 60);
    check_page((run){.frames = 1000, .fixed = 1}, 12);
    for (size_t frames = 13; frames < 1500; frames += 37 + frames / 7)
        check_spacing(frames);
    check_told();
    check_refusals();
    check_large_video();
    scratch_clear(scratch_folder);
    return check_end();
}

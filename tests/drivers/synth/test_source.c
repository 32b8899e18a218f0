/* synth:walk: its pinned frames, its promised light, any size, and sentences for wrong options. Also the light of
 * low-key scenes. */
#include "synth/synth_source.h"

#include <math.h>
#include <stdatomic.h>

#include "check.h"

#define SUN 20000.0f /* the radiance of the sun's disc in fixtures/scenes/walk.scene */

/* FNV-1a, 64 bit, over the bytes of each float, lowest first, regardless of the machine's byte order. */
static uint64_t digest(const float *values, size_t count)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        for (int k = 0; k < 32; k += 8)
            hash = (hash ^ (bits >> k & 0xff)) * UINT64_C(0x100000001b3);
    }
    return hash;
}

typedef struct facts {
    double log_average_ev;
    float largest;
    size_t odd; /* values that are not finite or not above 0 */
} facts;

static facts look(const pupil_image_const *image)
{
    facts f = {0};
    const float *rgb = image->data;
    size_t pixels = (size_t)image->width * image->height;
    for (size_t i = 0; i < pixels * 3; i++) {
        f.odd += !(rgb[i] > 0.0f && rgb[i] < 1e30f);
        f.largest = rgb[i] > f.largest ? rgb[i] : f.largest;
    }
    for (size_t i = 0; i < pixels; i++)
        f.log_average_ev += log2(0.2126 * rgb[3 * i] + 0.7152 * rgb[3 * i + 1] + 0.0722 * rgb[3 * i + 2]);
    f.log_average_ev /= (double)pixels;
    return f;
}

static pupil_source *opened(const char *name, pupil_source_options options)
{
    pupil_why why = {""};
    pupil_source *source = NULL;
    CHECK_MSG(pupil_synth_source_open(name, &options, &source, &why) == 0, "%s", why.text);
    return source;
}

/* A change of the scene or of the renderer changes these: look at the frames before you pin them again. The digests of
 * tests/scene hold on every CPU. */
static const struct {
    uint64_t frame, digest;
} pinned[] = {{0, UINT64_C(0xee3e9b22667b8212)},
              {60, UINT64_C(0x1bf152b123e21e73)},
              {150, UINT64_C(0x935646f6331d693f)},
              {200, UINT64_C(0xa91c099fe24db7a1)},
              {299, UINT64_C(0xcfe66bac1d74b4ed)}};

/* The digest of the next frame, 0 where there is none. */
static uint64_t next_digest(pupil_source *source)
{
    pupil_why why = {""};
    pupil_frame frame;
    int got = pupil_source_next(source, &frame, &why);
    CHECK_MSG(got == PUPIL_SOURCE_FRAME, "%s", why.text);
    if (got != PUPIL_SOURCE_FRAME)
        return 0;
    CHECK(frame.image.pixel == PUPIL_PIXEL_RGB32F);
    uint64_t found = digest(frame.image.data, (size_t)frame.image.width * frame.image.height * 3);
    pupil_source_done(source, &frame);
    return found;
}

/* The default is pinned; and a frame is the same on any number of threads. */
static void check_digests(void)
{
    for (size_t i = 0; i < sizeof pinned / sizeof *pinned; i++) {
        pupil_source *source =
            opened("walk", (pupil_source_options){.first = pinned[i].frame, .threads = (unsigned)i + 1});
        if (!source)
            return;
        CHECK(source->frames == 300 - pinned[i].frame && source->fps == 30.0);
        uint64_t found = next_digest(source);
        CHECK_MSG(found == pinned[i].digest, "frame %u has digest 0x%016llx", (unsigned)pinned[i].frame,
                  (unsigned long long)found);
        pupil_source_close(source);
    }
}

/* The whole clip, small: names, times, and how the light moves. */
static void check_clip(void)
{
    static facts seen[300];
    pupil_why why;
    pupil_frame frame;
    uint64_t n = 0;
    pupil_source *source = opened("walk", (pupil_source_options){.width = 80, .height = 45});
    if (!source)
        return;
    while (pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME && n < 300) {
        char name[64];
        snprintf(name, sizeof name, "synth:walk frame %u", (unsigned)n);
        CHECK(strcmp(frame.name, name) == 0 && frame.info.sequence == n);
        CHECK(frame.info.timestamp_ns == (int64_t)((n * UINT64_C(1000000000) * 2 + 30) / 60));
        seen[n++] = look(&frame.image);
        pupil_source_done(source, &frame);
    }
    CHECK(n == 300);
    CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_END);
    pupil_source_close(source);
    if (n != 300)
        return;

    double window = seen[150].log_average_ev;
    CHECK_MSG(window - seen[0].log_average_ev > 5.0, "from %g to %g EV", seen[0].log_average_ev, window);
    CHECK_MSG(window - seen[299].log_average_ev > 5.0, "from %g to %g EV", window, seen[299].log_average_ev);
    CHECK_MSG(seen[150].largest == SUN, "the sun is %g", seen[150].largest);
    for (int i = 0; i < 300; i++) {
        CHECK(seen[i].odd == 0);
        double step = i ? seen[i].log_average_ev - seen[i - 1].log_average_ev : 0.0;
        if (i == 60)
            CHECK_MSG(step > 3.0, "the flash is %g stops", step);
        else if (i == 62)
            CHECK_MSG(step < -3.0, "the flash ends with %g stops", step);
        else
            CHECK_MSG(fabs(step) < 1.0, "frame %d jumps by %g stops", i, step);
    }
}

static void check_sizes(void)
{
    static const uint32_t size[][3] = {{1, 1, 5}, {3, 5, 5}, {641, 479, 1}};
    pupil_why why;
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        pupil_frame frame;
        uint64_t n = 0;
        pupil_source *source = opened(
            "walk", (pupil_source_options){
                        .width = size[i][0], .height = size[i][1], .frames = size[i][2], .fps = 24000.0 / 1001.0});
        if (!source)
            continue;
        while (pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME && n++ < size[i][2]) {
            CHECK(frame.image.width == size[i][0] && frame.image.height == size[i][1]);
            CHECK(look(&frame.image).odd == 0);
            pupil_source_done(source, &frame);
        }
        CHECK(n == size[i][2]);
        CHECK(frame.info.timestamp_ns == (n == 5 ? INT64_C(166833333) : 0)); /* 4 x 1001 / 24000 s */
        pupil_source_close(source);
    }
}

/* The light of a low-key scene: the log-average and the brightest light, in EV, and the share of the frame that is
 * `above_ev` brighter than the log-average. Its second frame equals the first, except for a sensor's noise. */
static void check_still(const char *name, double log_average_ev, double brightest_ev, double above_ev, double share)
{
    static float first[96 * 64 * 3];
    pupil_why why = {""};
    pupil_frame frame;
    int same = 0;
    pupil_source *source = opened(name, (pupil_source_options){.width = 96, .height = 64, .frames = 2});
    for (int n = 0; source && n < 2; n++) {
        CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME);
        same = n && memcmp(first, frame.image.data, sizeof first) == 0;
        memcpy(first, frame.image.data, sizeof first);
        pupil_source_done(source, &frame);
    }
    pupil_source_close(source);
    double sum = 0.0, most = 0.0, above = 0.0, ev[96 * 64];
    for (int i = 0; i < 96 * 64; i++) {
        const float *p = &first[3 * i];
        const double light = fmax(0x1p-14, 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]);
        ev[i] = log2(light);
        sum += ev[i] / (96 * 64);
        most = fmax(most, light);
    }
    for (int i = 0; i < 96 * 64; i++)
        above += (ev[i] > sum + above_ev) / (96.0 * 64.0);
    CHECK_MSG(fabs(sum - log_average_ev) < 0.5 && fabs(log2(most) - brightest_ev) < 1.0, "%s: %.2f EV, at most %.2f",
              name, sum, log2(most));
    CHECK_MSG(above > 0.7 * share && above < 1.4 * share, "%s: %.4f of it is brighter by %g stops", name, above,
              above_ev);
    CHECK(same == (strcmp(name, "stars") != 0));
}

static void check_stills(void)
{
    check_still("table", -8.5, 9.35, 4, 0.132);
    check_still("candle", -12.4, 8.1, 4, 0.056);
    check_still("stars", -8.7, -2.8, 1, 0.0067);
    check_still("meadow", -3.1, 0.5, 2, 0.42);
    check_still("leds", -4.7, 6.5, 2, 0.169);
}

static void refused(const char *name, pupil_source_options options, const char *word)
{
    pupil_why why = {""};
    pupil_source *source = NULL;
    CHECK(pupil_synth_source_open(name, &options, &source, &why) == PUPIL_SOURCE_FAILED);
    CHECK(source == NULL);
    CHECK_MSG(strstr(why.text, word) != NULL, "said: %s", why.text);
}

static atomic_int asked, stop_at;

static int stops(void)
{
    return atomic_fetch_add(&asked, 1) >= stop_at;
}

/* A stop at any time: a sentence, no frame with missing rows, and no more frames. */
static void check_stop(void)
{
    for (int at = 0; at < 40; at += 13) {
        const pupil_source_options options = {.width = 16, .height = 16, .threads = 1000, .frames = 3, .stop = stops};
        pupil_why why = {""};
        pupil_source *source = NULL;
        pupil_frame frame;
        asked = 0;
        stop_at = at;
        if (pupil_synth_source_open("leds", &options, &source, &why))
            continue; /* while it was loaded */
        CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FAILED || asked <= at);
        stop_at = 0;
        CHECK(pupil_source_next(source, &frame, &why) != PUPIL_SOURCE_FRAME);
        CHECK(pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_END);
        pupil_source_close(source);
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_digests();
    check_stop();
    check_clip();
    check_sizes();
    check_stills();
    refused("run", (pupil_source_options){0}, "synth:walk");
    refused("walk", (pupil_source_options){.first = 300}, "no frame 300; it has the frames 0 to 299");
    refused("walk", (pupil_source_options){.fps = NAN}, "frames a second");
    refused("walk", (pupil_source_options){.fps = -1.0}, "frames a second");
    refused("walk", (pupil_source_options){.fps = INFINITY}, "frames a second");
    refused("walk", (pupil_source_options){.width = 16385}, "16384x16384");
    refused("walk", (pupil_source_options){.height = UINT32_MAX}, "16384x16384");
    refused("walk", (pupil_source_options){.frames = UINT64_MAX}, "100 years");
    return check_end();
}

#include "stream.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "common/pixel_light.h"
#include "refuse.h"

#define LOW_SIDE     64
#define MOST_WAIT_MS 2000 /* for a write of controls, on the machine's clock */

void probe_unknown(probe_known *is, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(is->why.text, sizeof is->why.text, format, arguments);
    va_end(arguments);
    is->known = 0;
}

int probe_gave_up(const probe_stream *s, probe_known *is)
{
    if (s->state == PROBE_OVER_TIME)
        probe_unknown(is, "there was no time left for it");
    else if (s->state)
        probe_unknown(is, "the stream ended before it");
    return s->state != 0;
}

/* --- a frame --- */

static double share(uint64_t part, uint64_t whole)
{
    return whole ? (double)part / (double)whole : 1.0;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The quantile at a tenth of the pixels, on a grid: the statistics' bins are too wide for black. */
static double low_of(const pupil_image_const *image)
{
    static double value[LOW_SIDE * LOW_SIDE];
    const uint32_t across = image->width < LOW_SIDE ? image->width : LOW_SIDE;
    const uint32_t down = image->height < LOW_SIDE ? image->height : LOW_SIDE;
    for (uint32_t y = 0; y < down; y++)
        for (uint32_t x = 0; x < across; x++) {
            double rgb[4];
            pixel_light(image, x * image->width / across, y * image->height / down, 0, rgb);
            value[y * across + x] = (rgb[0] + rgb[1] + rgb[2]) / 3.0;
        }
    qsort(value, (size_t)across * down, sizeof value[0], compare);
    return value[(size_t)across * down / 10];
}

static void set_coding(probe_stream *s, const pupil_image_const *image)
{
    s->coding = image->coding ? *image->coding : (pupil_coding){0};
    memset(s->coding.balance, 0, sizeof s->coding.balance);
    memset(s->coding.rgb_from_camera, 0, sizeof s->coding.rgb_from_camera);
    s->coding.black = 0.0f;
    if (pupil_pixel_bits(image->pixel))
        s->coding.black = (float)(s->black * (s->coding.white > 0.0f ? (double)s->coding.white
                                                                     : exp2(pupil_pixel_bits(image->pixel)) - 1.0));
}

static int meter(probe_stream *s, const pupil_frame *frame)
{
    pupil_image_const image = frame->image;
    pupil_stats stats;
    double low_ev = 0.0;
    set_coding(s, &image);
    image.coding = &s->coding;
    pupil_stats_clear(&stats);
    if (pupil_meter_rows(&s->pupil, &image, 0, image.height, &stats) != PUPIL_OK ||
        pupil_stats_mean(&stats, PROBE_TRIM, 1.0 - PROBE_TRIM, &s->level.mean_ev) != PUPIL_OK ||
        pupil_stats_peak_quantile(&stats, 1.0 - PROBE_MOST_BAD, &s->level.high_ev) != PUPIL_OK ||
        pupil_stats_quantile(&stats, 0.1, &low_ev) != PUPIL_OK)
        return pupil_refuse(s->why, "%s cannot be metered", frame->name);
    s->level.clipped = share(stats.clipped, stats.pixels);
    s->level.black = share(stats.black, stats.pixels);
    if (s->wants_low)
        s->level.low = image.pixel >= PUPIL_PIXEL_YUYV ? low_of(&image) : s->level.black >= 0.1 ? 0.0 : exp2(low_ev);
    return 0;
}

static void time_it(probe_stream *s, const pupil_frame *frame)
{
    const pupil_live_times *f = &pupil_live_get(s->source)->times;
    const double passed_s = (double)(f->stamp_ns - s->stamp_ns) * 1e-9;
    probe_interval *i = &s->report->interval;
    if (s->any && frame->info.sequence == s->sequence + 1) {
        s->sum_s += passed_s - s->period_s; /* relative to the nominal period, so that squares are small */
        s->square_s += (passed_s - s->period_s) * (passed_s - s->period_s);
        i->least_s = s->intervals ? fmin(i->least_s, passed_s) : passed_s;
        i->most_s = fmax(i->most_s, passed_s);
        s->intervals++;
    }
    if (!s->after_wait) /* otherwise the frame has waited in the queue */
        s->latency_s[s->latencies++ % PROBE_LATENCIES] = (double)(f->taken_ns - f->stamp_ns) * 1e-9;
    s->after_wait = pupil_live_now_ns(s->source) - f->stamp_ns > (int64_t)(s->period_s * 1e9);
    s->sequence = frame->info.sequence;
    s->stamp_ns = f->stamp_ns;
    s->report->latency.stamp = f->stamp;
    s->any = 1;
    s->frames++;
}

int probe_frame(probe_stream *s)
{
    pupil_frame frame;
    if (s->state)
        return s->state;
    if (s->end_ns && pupil_live_now_ns(s->source) >= s->end_ns)
        return s->state = PROBE_OVER_TIME;
    const int got = pupil_source_next(s->source, &frame, s->why);
    if (s->options->stop && s->options->stop())
        return s->state = PROBE_STOPPED;
    if (got == PUPIL_SOURCE_END)
        pupil_refuse(s->why, "%s: its stream ended", s->report->offers.is.path);
    if (got != PUPIL_SOURCE_FRAME)
        return s->state = -1;
    time_it(s, &frame);
    s->state = meter(s, &frame);
    pupil_source_done(s->source, &frame);
    return s->state;
}

int probe_frames(probe_stream *s, unsigned count, probe_level *level)
{
    double least_ev = 0.0, most_ev = 0.0;
    *level = (probe_level){0};
    for (unsigned i = 0; i < count; i++) {
        if (probe_frame(s))
            return s->state;
        level->mean_ev += s->level.mean_ev / count;
        least_ev = i ? fmin(least_ev, s->level.mean_ev) : s->level.mean_ev;
        most_ev = i ? fmax(most_ev, s->level.mean_ev) : s->level.mean_ev;
        level->high_ev = i ? fmax(level->high_ev, s->level.high_ev) : s->level.high_ev;
        level->low += s->level.low / count;
        level->clipped = fmax(level->clipped, s->level.clipped);
        level->black = fmax(level->black, s->level.black);
    }
    level->spread_ev = most_ev - least_ev;
    return 0;
}

int probe_is_good(const probe_level *level)
{
    return level->clipped < PROBE_MOST_BAD && level->black < PROBE_MOST_BAD;
}

/* --- a setting --- */

pupil_camera_setting probe_taken(const probe_stream *s)
{
    pupil_camera_status status;
    pupil_camera_get_status(s->camera, &status);
    return (pupil_camera_setting){.exposure_s = status.exposure_s.taken, .gain = status.gain.taken};
}

int probe_set(probe_stream *s, double exposure_s, double gain, uint64_t *under_way)
{
    const struct timespec ms = {0, 1000000};
    const pupil_camera_setting wanted = {.exposure_s = exposure_s, .gain = gain};
    pupil_camera_status status;
    if (s->state)
        return s->state;
    const uint64_t number = pupil_camera_ask(s->camera, &wanted);
    pupil_camera_get_status(s->camera, &status);
    for (int i = 0; status.written < number && i < MOST_WAIT_MS; i++) {
        nanosleep(&ms, NULL);
        pupil_camera_get_status(s->camera, &status);
    }
    if (status.written < number) {
        pupil_refuse(s->why, "%s: a write of its controls takes longer than %d seconds", s->report->offers.is.path,
                     MOST_WAIT_MS / 1000);
        return s->state = -1;
    }
    /* Frames that have ended meanwhile, by the clock, but were not taken yet. */
    const int from_start = s->report->latency.stamp == PUPIL_LIVE_STAMP_START_OF_EXPOSURE;
    const double passed = (double)(pupil_live_now_ns(s->source) - s->stamp_ns) * 1e-9 / s->period_s - from_start;
    *under_way = s->sequence + 1 + (passed >= 1.0 ? (uint64_t)fmin(passed, 1000.0) : 0);
    s->after_wait |= passed >= 1.0;
    return 0;
}

int probe_settle(probe_stream *s, double exposure_s, double gain)
{
    uint64_t from = 0;
    if (probe_set(s, exposure_s, gain, &from))
        return s->state;
    for (unsigned i = 0; i < 64 && s->sequence + 1 < from + s->settle; i++)
        if (probe_frame(s))
            return s->state;
    return 0;
}

/* --- the working level --- */

/* Measurements are made around this level, log2 0.12. The brightest pixels are a stop and a half below full scale, so
 * that twice the light still fits. */
#define WANTED_EV  (-3.06)
#define ROOM_EV    (-1.5)
#define NEAR_EV    0.4
#define MOST_TRIES 8

/* Exposure first, then gain. */
static void split(const probe_stream *s, double total_s, double *exposure_s, double *gain)
{
    const pupil_camera_limits *l = &s->report->limits;
    *exposure_s = fmin(fmax(total_s / l->gain_min, l->exposure_min_s), s->longest_s);
    *gain = fmin(fmax(total_s / *exposure_s, l->gain_min), l->gain_max);
}

void probe_find_level(probe_stream *s, probe_known *found, double *exposure_s, double *gain)
{
    pupil_camera_setting now = probe_taken(s);
    double total_s = now.exposure_s * now.gain;
    probe_level level = {0};
    int bound = 0;
    for (int i = 0; i < MOST_TRIES && !bound; i++) {
        split(s, total_s, exposure_s, gain);
        if (probe_settle(s, *exposure_s, *gain) || probe_frames(s, 2, &level))
            break;
        now = probe_taken(s);
        const double dark = level.black > 0.5 ? 4.0 : WANTED_EV - level.mean_ev;
        const double off_ev = level.clipped > PROBE_MOST_BAD ? -3.0 : fmin(dark, ROOM_EV - level.high_ev);
        *exposure_s = now.exposure_s;
        *gain = now.gain;
        if (fabs(off_ev) < NEAR_EV && probe_is_good(&level)) {
            found->known = 1;
            return;
        }
        const double before_s = now.exposure_s * now.gain;
        double next_exposure_s, next_gain;
        total_s = before_s * exp2(fmin(fmax(off_ev, -4.0), 4.0));
        split(s, total_s, &next_exposure_s, &next_gain);
        bound = fabs(log2(next_exposure_s * next_gain / before_s)) < 0.1; /* at a limit of the controls */
    }
    if (probe_gave_up(s, found))
        return;
    found->known = probe_is_good(&level) && level.high_ev < -1.0 && level.mean_ev > -9.0;
    if (!found->known)
        probe_unknown(found, "the picture is too %s: point it at something of medium light that does not move",
                      level.clipped >= PROBE_MOST_BAD || level.high_ev >= -1.0 ? "bright" : "dark");
}

/* --- a picture that moves --- */

#define WATCHED_S    0.8
#define LEAST_FRAMES 6
#define MOST_FRAMES  60

int probe_restless(probe_stream *s, double exposure_s, double gain, double *moved_ev)
{
    const double frames = (s->options->quick ? 0.5 * WATCHED_S : WATCHED_S) / s->period_s;
    probe_level level;
    if (probe_settle(s, exposure_s, gain) ||
        probe_frames(s, (unsigned)fmin(fmax(frames, LEAST_FRAMES), MOST_FRAMES), &level))
        return s->state;
    *moved_ev = level.spread_ev;
    return 0;
}

void probe_moves(probe_known *is, double moved_ev)
{
    probe_unknown(is, "the picture moves by itself, by %.2f stops: point it at something that does not move", moved_ev);
}

/* --- what all frames reported --- */

void probe_stream_tell(probe_stream *s)
{
    probe_interval *i = &s->report->interval;
    probe_latency *l = &s->report->latency;
    const pupil_live_counts *counts = &pupil_live_get(s->source)->counts;
    const unsigned kept = s->latencies < PROBE_LATENCIES ? s->latencies : PROBE_LATENCIES;
    i->frames = s->frames;
    i->lost = counts->lost;
    i->damaged = counts->flagged + counts->cut + counts->damaged;
    if (s->intervals > 1) {
        const double n = (double)s->intervals, off_s = s->sum_s / n;
        i->is.known = 1;
        i->mean_s = s->period_s + off_s;
        i->jitter_s = sqrt(fmax(0.0, s->square_s / n - off_s * off_s));
    } else {
        probe_unknown(&i->is, "no two frames came one after the other");
    }
    qsort(s->latency_s, kept, sizeof s->latency_s[0], compare);
    if (l->stamp == PUPIL_LIVE_STAMP_NONE || !kept) {
        probe_unknown(&l->is, "%s", kept ? "its driver does not stamp frames" : "no frame was taken at once");
        return;
    }
    l->is.known = 1;
    l->median_s = s->latency_s[kept / 2];
    l->most_s = s->latency_s[kept - 1];
}

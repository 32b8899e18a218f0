#include "split_input.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "common/interrupt.h"
#include "common/open_input.h"
#include "common/report_error.h"
#include "live/live.h"
#include "options/commands.h"
#include "refuse.h"

static int open_source(split_input *s, pupil_why *why)
{
    const frame_options *o = &s->options->frames;
    if (open_input(o->inputs, o->input_count, &o->source, &s->source, why))
        return -1;
    if (o->source.fps > 0.0 && !(s->source->obeys & PUPIL_SOURCE_FPS))
        return pupil_refuse(why, "--fps: the frames of %s have times of their own", o->inputs[0]);
    if (o->source.width && !(s->source->obeys & PUPIL_SOURCE_SIZE))
        return pupil_refuse(why, "--size: the frames of %s have a size of their own", o->inputs[0]);
    return 0;
}

static int noise(const split_input *s, uint64_t number, pupil_why *why)
{
    return pupil_refuse(
        why,
        "%s: frame %llu is a sensor's noise, and what pupil replay makes of the frames behind it depends "
        "on it: such an input cannot be split",
        s->options->frames.inputs[0], (unsigned long long)number);
}

static int next(split_input *s, pupil_frame *frame, pupil_why *why)
{
    const int got = pupil_source_next(s->source, frame, why);
    s->is_at_end = got == PUPIL_SOURCE_END;
    return got == PUPIL_SOURCE_FRAME ? 1 : got == PUPIL_SOURCE_END ? 0 : -1;
}

/* Finds the unit from the first frame with light; codes have no unit. */
static int find_unit(split_input *s, pupil_why *why)
{
    for (int more = 1; more && !s->scale.known && !interrupt_came();) {
        pupil_frame frame;
        const int got = next(s, &frame, why);
        if (got <= 0)
            return got;
        more = any_scale_concerns(&frame);
        const int failed = any_scale_take(&s->scale, &frame, why);
        pupil_source_done(s->source, &frame);
        if (failed)
            return -1;
        if (s->scale.noise_frames)
            return noise(s, s->number, why);
        s->has_unit = s->scale.known;
        s->unit_stops = s->scale.unit_stops;
        s->unit_frame = s->number++;
    }
    return 0;
}

/* Sets what is known of the unit when the range begins. */
static void begin_unit(split_input *s)
{
    any_scale_forget(&s->scale);
    if (!s->has_unit || s->options->first <= s->unit_frame)
        return;
    s->scale.known = 1;
    s->scale.stops = s->scale.unit_stops = s->unit_stops;
}

static int skip(split_input *s, uint64_t frames, pupil_why *why)
{
    if (s->source->skip)
        s->number += s->source->skip(s->source, frames);
    while (s->number < frames && !s->is_at_end && !interrupt_came()) {
        pupil_frame frame;
        const int got = next(s, &frame, why);
        if (got < 0)
            return -1;
        if (!got)
            break;
        pupil_source_done(s->source, &frame);
        s->number++;
    }
    return 0;
}

int split_input_open(split_input *s, split_options *options, const split_header *unit, pupil_why *why)
{
    *s = (split_input){.options = options};
    options->frames.source.stop = interrupt_came;
    if (open_source(s, why))
        return -1;
    if (unit) {
        s->has_unit = (int)unit->has_unit;
        s->unit_stops = unit->unit_stops;
        s->unit_frame = unit->unit_frame;
    } else {
        if (find_unit(s, why))
            return -1;
        pupil_source_close(s->source);
        s->source = NULL;
        s->number = 0;
        s->is_at_end = 0;
        if (open_source(s, why))
            return -1;
    }
    begin_unit(s);
    return skip(s, options->first, why);
}

int split_input_next(split_input *s, pupil_frame *frame, pupil_why *why)
{
    if (s->is_at_end || interrupt_came())
        return 0;
    if (s->number >= s->options->end) { /* is there another one? */
        const int got = next(s, frame, why);
        if (got > 0)
            pupil_source_done(s->source, frame);
        return got < 0 ? -1 : 0;
    }
    const int got = next(s, frame, why);
    if (got <= 0)
        return got;
    if (any_scale_take(&s->scale, frame, why)) {
        pupil_source_done(s->source, frame);
        return -1;
    }
    if (s->scale.noise_frames) {
        pupil_source_done(s->source, frame);
        return noise(s, s->number, why);
    }
    s->number++;
    return 1;
}

void split_input_done(split_input *s, pupil_frame *frame)
{
    pupil_source_done(s->source, frame);
}

uint64_t split_pixels(const pupil_image_const *image)
{
    enum { ROWS = 16 };
    const size_t bytes = pupil_row_bytes(image->pixel, image->width);
    uint64_t digest = split_digest(0, &image->width, sizeof image->width);
    digest = split_digest(digest, &image->height, sizeof image->height);
    for (uint32_t i = 0; i < ROWS; i++) {
        const uint32_t y = (uint32_t)((uint64_t)image->height * i / ROWS);
        digest = split_digest(digest, (const unsigned char *)image->data + (ptrdiff_t)y * image->stride_bytes, bytes);
    }
    return digest;
}

void split_input_describe(const split_input *s, split_header *header)
{
    const frame_options *o = &s->options->frames;
    for (size_t i = 0; i < o->input_count; i++) {
        const char *slash = strrchr(o->inputs[i], '/'), *name = slash && slash[1] ? slash + 1 : o->inputs[i];
        struct stat is;
        header->input_names = split_digest(header->input_names, name, strlen(name) + 1);
        if (stat(o->inputs[i], &is) == 0 && S_ISREG(is.st_mode))
            header->input_bytes += (uint64_t)is.st_size;
    }
    header->input_count = o->input_count;
    snprintf(header->input, sizeof header->input, "%s", o->inputs[0]);
    header->fps = s->source->fps;
    header->has_unit = s->has_unit != 0;
    header->unit_stops = s->unit_stops;
    header->unit_frame = s->unit_frame;
}

void split_input_close(split_input *s)
{
    pupil_source_close(s->source);
    any_scale_close(&s->scale);
    s->source = NULL;
}

void split_show(progress *line, uint64_t frame)
{
    if (!progress_due(line, 0.1))
        return;
    progress_add(line, "frame %llu", (unsigned long long)frame);
    progress_show(line);
}

void split_tell(const char *what, uint64_t frames, double began_s)
{
    const double took_s = progress_now_s() - began_s;
    fprintf(stderr, "%s %llu frame%s in %.2f s, %.0f a second", what, (unsigned long long)frames,
            frames == 1 ? "" : "s", took_s, took_s > 0.0 ? (double)frames / took_s : 0.0);
}

int split_end(const char *command, int failed, pupil_why *why)
{
    if (interrupt_came()) {
        fprintf(stderr, "%s: interrupted; no output is there\n", command);
        return EXIT_INTERRUPTED;
    }
    if (failed)
        report_error(command, why, "");
    return failed ? EXIT_FAILED : EXIT_DONE;
}

/* tests/drivers/v4l2/fake_source.h: the fake camera opened as a source, and what is left open. */
#ifndef PUPIL_TESTS_DRIVERS_FAKE_SOURCE_H
#define PUPIL_TESTS_DRIVERS_FAKE_SOURCE_H

#include "check.h"

#include "fake_v4l2/fake_v4l2.h"
#include "live/live.h"
#include "pupil/error.h"

typedef struct fake_source {
    fake_v4l2 *fake;
    pupil_source *source; /* NULL: refused */
    int result;
    pupil_why why;
} fake_source;

/* `more` has no system; NULL: no options. */
static inline fake_source fake_source_open(const char *which, const fake_v4l2_config *config,
                                           const pupil_v4l2_options *more)
{
    fake_source s = {.fake = fake_v4l2_new(config)};
    pupil_v4l2_options options = more ? *more : (pupil_v4l2_options){0};
    if (!s.fake)
        abort();
    if (!options.system)
        options.system = fake_v4l2_system(s.fake);
    s.result =
        pupil_live_open(which, NULL, &(pupil_live_options){.capture = options, .hands_off = 1}, &s.source, &s.why);
    return s;
}

static inline int fake_source_next(fake_source *s, pupil_frame *frame)
{
    s->why.text[0] = 0;
    return pupil_source_next(s->source, frame, &s->why);
}

static inline const pupil_live_counts *fake_source_counts(const fake_source *s)
{
    return &pupil_live_capture(s->source)->counts;
}

static inline void fake_source_close(fake_source *s)
{
    pupil_source_close(s->source);
    s->source = NULL;
    const fake_v4l2_held held = fake_v4l2_holds(s->fake);
    CHECK_MSG(held.files == 0 && held.maps == 0 && held.unsynced == 0, "%d files, %d maps are left, %d syncs missing",
              held.files, held.maps, held.unsynced);
    fake_v4l2_free(s->fake);
}

#endif

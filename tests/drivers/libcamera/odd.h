/* tests/drivers/libcamera/odd.h: the fake libcamera camera with its own function table, in which a test replaces some
 * of the fake's functions. */
#ifndef PUPIL_TESTS_LIBCAMERA_ODD_H
#define PUPIL_TESTS_LIBCAMERA_ODD_H

#include "rig.h"

typedef struct odd {
    fake_libcamera *fake;
    const pupil_libcamera_layer *real;
    pupil_libcamera_layer layer;
    pupil_live_system system;
} odd;

/* The table's functions receive the fake, not this; so there can only be one at a time. */
static odd it;

static inline void odd_begin(const fake_libcamera_config *config)
{
    it.fake = fake_libcamera_new(config);
    it.real = fake_libcamera_layer(it.fake);
    it.layer = *it.real;
    it.system = (pupil_live_system){.libcamera = &it.layer};
}

/* Returns pupil_live_open's result. */
static inline int odd_open(pupil_source **source, const pupil_live_options *more)
{
    pupil_live_options options = more ? *more : (pupil_live_options){0};
    options.system = &it.system;
    *source = NULL;
    why.text[0] = 0;
    return pupil_live_open("libcamera:", NULL, &options, source, &why);
}

/* Also for a source that could not be opened (NULL). */
static inline void odd_end(pupil_source *source)
{
    pupil_source_close(source);
    CHECK_MSG(fake_libcamera_opened(it.fake) == 0, "%d cameras are left open", fake_libcamera_opened(it.fake));
    fake_libcamera_free(it.fake);
}

/* Takes the next frame and gives it back at once. */
static inline int odd_next(pupil_source *source, pupil_frame *frame)
{
    const int got = pupil_source_next(source, frame, &why);
    if (got == PUPIL_SOURCE_FRAME)
        pupil_source_done(source, frame);
    return got;
}

#endif

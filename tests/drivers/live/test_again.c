/* A camera comes back while there is no memory or no thread: its frames continue, and its controls are back or reported
 * missing; nothing stays open. */
#include "live/live.h"

#include <time.h>

#include "check.h"
#include "fake_v4l2/fake_v4l2.h"
#include "nth_call/nth_call.h"

static pupil_why why;

static int next(pupil_source *source)
{
    pupil_frame frame;
    const int got = pupil_source_next(source, &frame, &why);
    if (got == PUPIL_SOURCE_FRAME)
        pupil_source_done(source, &frame);
    return got;
}

/* Takes frames until the controls were opened again or could not be; the whole test has a time limit. */
static void await_controls(pupil_source *source)
{
    const struct timespec moment = {0, 1000000};
    while (!pupil_live_camera(source) && strstr(pupil_live_no_controls(source), "are being opened again")) {
        CHECK_MSG(next(source) == PUPIL_SOURCE_FRAME, "%s", why.text);
        nanosleep(&moment, NULL);
    }
}

/* The n-th of these calls fails once the camera is gone. Returns what failed; NULL: there is no such call. */
static const char *comes_back(unsigned long at)
{
    fake_v4l2_config config;
    const char *failed;
    pupil_source *source = NULL;
    fake_v4l2_config_default(&config);
    config.unplug_at = 3;
    config.back_s = 0.1;
    fake_v4l2 *fake = fake_v4l2_new(&config);
    const pupil_live_options options = {.capture = {.system = fake_v4l2_system(fake), .reopen_s = 10.0}};
    CHECK_MSG(pupil_live_open("/dev/video0", NULL, &options, &source, &why) == 0, "%s", why.text);
    for (int i = 0; i < 3; i++)
        CHECK(next(source) == PUPIL_SOURCE_FRAME);
    nth_begin(at, NTH_FAILS);
    CHECK_MSG(next(source) == PUPIL_SOURCE_FRAME, "call %lu: %s", at, why.text);
    CHECK(pupil_live_get(source)->counts.reopened >= 1);
    await_controls(source);
    nth_end(&failed);
    if (failed)
        CHECK_MSG(pupil_live_camera(source) || strlen(pupil_live_no_controls(source)) > 20, "call %lu, %s: '%s'", at,
                  failed, pupil_live_no_controls(source));
    else
        CHECK_MSG(pupil_live_camera(source) != NULL, "%s", pupil_live_no_controls(source));
    CHECK(next(source) == PUPIL_SOURCE_FRAME);
    pupil_source_close(source);
    const fake_v4l2_held held = fake_v4l2_holds(fake);
    CHECK_MSG(held.files == 0 && held.maps == 0, "call %lu: %d files and %d maps are left", at, held.files, held.maps);
    fake_v4l2_free(fake);
    return failed;
}

int main(int argc, char **argv)
{
    static const char *const counted[] = {"calloc", "pthread_create", NULL};
    unsigned long at = 1;
    check_begin(argc, argv);
    nth_only(counted);
    while (comes_back(at))
        at++;
    CHECK_MSG(at > 3, "%lu calls", at - 1); /* the change's own memory and thread, the controls' memory */
    return check_end();
}

/* A disk that hangs: the recorder gives up on request, and what was written before can be replayed. */
#include "check.h"
#include "scratch.h"

#include <pthread.h>
#include <unistd.h>

#include "file/recording/recording.h"
#include "recording_frames.h"

static pupil_why why;

/* write() of all linked code, wrapped by the linker (tests/CMakeLists.txt). */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t moved = PTHREAD_COND_INITIALIZER;
static int hangs, hanging; /* the disk hangs; a write waits for it */

ssize_t __real_write(int fd, const void *bytes, size_t count);
ssize_t __wrap_write(int fd, const void *bytes, size_t count);

ssize_t __wrap_write(int fd, const void *bytes, size_t count)
{
    pthread_mutex_lock(&lock);
    while (hangs) {
        hanging = 1;
        pthread_cond_broadcast(&moved);
        pthread_cond_wait(&moved, &lock);
    }
    hanging = 0;
    pthread_mutex_unlock(&lock);
    return __real_write(fd, bytes, count);
}

static void set_disk(int to)
{
    pthread_mutex_lock(&lock);
    hangs = to;
    pthread_cond_broadcast(&moved);
    pthread_mutex_unlock(&lock);
}

static void await_hang(void)
{
    pthread_mutex_lock(&lock);
    while (!hanging)
        pthread_cond_wait(&moved, &lock);
    pthread_mutex_unlock(&lock);
}

static int asked, patience; /* how often give_up says no, during a wait */

static int give_up(void)
{
    return ++asked > patience;
}

static void await_written(pupil_recorder *recorder, uint64_t count)
{
    pupil_recorder_counts counts;
    do {
        usleep(1000);
        pupil_recorder_get_counts(recorder, &counts);
    } while (counts.written < count);
}

/* `waits`: the source can wait, so write does. Three frames are on the disk when it hangs. */
static void test_hang(int waits)
{
    const pupil_recorder_options options = {.fps = 30, .wait = waits, .give_up = give_up};
    test_frames frames;
    pupil_recorder *recorder = NULL;
    int written = 3;
    frames_make(&frames, PUPIL_PIXEL_GREY8, 16, 8, 30);
    asked = 0;
    patience = 2;
    const char *folder = scratch("hang");
    CHECK_MSG(pupil_recorder_open(&recorder, folder, &frames.frame[0], &options, &why) == 0, "%s", why.text);
    if (!recorder)
        exit(check_end());
    for (int i = 0; i < 3; i++)
        CHECK(pupil_recorder_write(recorder, &frames.frame[i], &why) == 0);
    await_written(recorder, 3);
    set_disk(1);
    for (; written < 30 && pupil_recorder_write(recorder, &frames.frame[written], &why) == 0; written++)
        if (written == 3)
            await_hang();
    /* one frame hangs and one waits for it; a camera's frames are all taken, and lost if there is no room */
    CHECK_MSG(written == (waits ? 5 : 30), "%d frames", written);
    if (waits)
        CHECK_MSG(strstr(why.text, "the disk hangs, and is waited for no more; the 3 frames before are whole"), "%s",
                  why.text);
    CHECK(pupil_recorder_close(recorder, &why) == PUPIL_SINK_FAILED);
    CHECK_MSG(strstr(why.text, "hang: the disk hangs") && strstr(why.text, "the 3 frames before are whole"), "%s",
              why.text);
    CHECK_MSG(asked >= 3, "asked %d times", asked);
    CHECK_MSG(frames_replay(&frames, folder, &why) == 3, "%s",
              why.text); /* as it is now, and as it would be if killed */
    set_disk(0);         /* its thread ends by itself */
    pupil_source *source = NULL;
    for (int whole = 3; whole < 4;) { /* the hanging frame is completed, too; the test has a time limit */
        usleep(1000);
        pupil_frame frame;
        whole = 0;
        CHECK(pupil_recording_open(folder, NULL, &source, &why) == 0);
        while (pupil_source_next(source, &frame, &why) == PUPIL_SOURCE_FRAME) {
            pupil_source_done(source, &frame);
            whole++;
        }
        pupil_source_close(source);
    }
    usleep(20000); /* for leak checkers */
    scratch_clear(folder);
    frames_free(&frames);
}

/* A disk that is only slow is waited for, regardless of how often give_up is called. */
static void *mend(void *unused)
{
    (void)unused;
    usleep(350000);
    set_disk(0);
    return NULL;
}

static void test_slow(void)
{
    const pupil_recorder_options options = {.fps = 30, .wait = 1, .give_up = give_up};
    test_frames frames;
    pupil_recorder *recorder = NULL;
    pthread_t thread;
    frames_make(&frames, PUPIL_PIXEL_GREY8, 16, 8, 30);
    asked = 0;
    patience = 1 << 30;
    const char *folder = scratch("slow");
    CHECK(pupil_recorder_open(&recorder, folder, &frames.frame[0], &options, &why) == 0);
    set_disk(1);
    pthread_create(&thread, NULL, mend, NULL);
    for (int i = 0; i < 30; i++)
        CHECK(pupil_recorder_write(recorder, &frames.frame[i], &why) == 0);
    CHECK_MSG(pupil_recorder_close(recorder, &why) == 0, "%s", why.text);
    pthread_join(thread, NULL);
    CHECK_MSG(frames_replay(&frames, folder, &why) == 30, "%s", why.text);
    scratch_clear(folder);
    frames_free(&frames);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    test_slow();
    test_hang(1);
    test_hang(0);
    return check_end();
}

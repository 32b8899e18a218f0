/* The promise of the sensor's loop, through every sequence of events: whatever happened before, in still light the
 * shown level is right after max(60, 12 x delay_frames) frames, or the limit is named.
 *
 *     test_sensor_exhaustive [--events N] [--segments N] [--every N] [--jobs N] [--shown FAILURES]
 *     test_sensor_exhaustive --again CAMERA TEXT      one sequence, a line for each frame
 *
 * 64 cameras: true delays 1 to 4 and believed delays 1 to 4, full at the top code and 2 % below it, from the first
 * frame on and at rest; with --every only each Nth of them. Each goes through two sets of sequences:
 *
 *   events    in the first 3 x delay + 8 frames (delay: the longer of the true and the believed one) an event may
 *             begin at any frame: all sequences with at most N events, one a frame. An event is one of 18: the light
 *             takes one of the nine other levels; exposure or gain is dead or alive again; the camera's own automatic
 *             comes or goes; info is missing, constant or ahead, or true again; a frame is lost, white or black.
 *   segments  all sequences of N segments of 24 frames: each has one of ten levels of light and one of seven faults
 *             (the six that stay, and none).
 *
 * From equal states at the same frame the walk continues only once: abstract_loop_hash defines equality. After the last
 * frame of each sequence the loop is run in still light twice: with all faults gone, and, where some are left that
 * leave the camera monotone (all but its own automatic), with these. Frames of the run that were reached before are not
 * run again, either. */
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "abstract_loop.h"
#include "check.h"

enum { SEGMENT = 24, JUDGED = 8 /* frames at the end of a run */, LONGEST = 512, SEEN = 1 << 21 };

static const char *const event[] = {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9",
                                    "e", "g", "a", "m", "c", "i", "x", "w", "b"};
enum { EVENTS = sizeof event / sizeof *event };
static const char *const fault[] = {"", "e", "g", "a", "m", "c", "i"};
enum { FAULTS = sizeof fault / sizeof *fault };

/* The counts of a process; the parent adds them up. */
typedef struct tally {
    uint64_t frames, sequences, merged, runs;
    uint64_t of[ABSTRACT_VERDICTS];
} tally;

static tally *mine;
static int camera_number, shown, most_shown;
static const char *program;
static char text[LONGEST];
static uint64_t *seen; /* direct-mapped: a state that was evicted by another one is walked again */

static int is_new(const abstract_loop *loop, uint64_t where)
{
    const uint64_t key = (abstract_loop_hash(loop) ^ where * UINT64_C(0x9e3779b97f4a7c15)) | 1;
    uint64_t *place = &seen[(key >> 8) % SEEN];
    const int is_known = *place == key;
    mine->merged += (uint64_t)is_known;
    *place = key;
    return !is_known;
}

static void failed(abstract_verdict verdict, const char *rest, int frames)
{
    mine->of[verdict]++;
    if (shown >= most_shown)
        return;
    shown++;
    printf("camera %d (%s): %s. Again with:\n    %s --again %d %s%s", camera_number,
           abstract_camera_name(camera_number), abstract_verdict_name[verdict], program, camera_number, text, rest);
    for (int i = 0; i < frames; i++)
        printf(".");
    printf("\n");
    fflush(stdout);
}

/* Still light from here on. */
static void run(const abstract_loop *from, const char *rest)
{
    static abstract_loop loop;
    loop = *from;
    abstract_verdict verdict = abstract_loop_go(&loop, rest);
    const int promised = 12 * loop.believed > 60 ? (int)(12 * loop.believed) : 60;
    mine->runs++;
    for (int i = 0; i < promised + JUDGED && !verdict; i++) {
        if (i % 8 == 0 && i < promised && !is_new(&loop, (uint64_t)(1000000 + i)))
            return;
        verdict = abstract_loop_go(&loop, ".");
        if (i >= promised && !verdict)
            verdict = abstract_loop_judge(&loop);
        if (verdict)
            failed(verdict, rest, i + 1);
    }
}

static void end_of_sequence(const abstract_loop *loop)
{
    const uint32_t faults = loop->camera.faults;
    mine->sequences++;
    run(loop, "n");
    if (faults && !(faults & ABSTRACT_OWN_AUTO))
        run(loop, "");
}

/* Continues from a state with `letters` and this many frames; 0 where the result was walked already, or is wrong. */
static int go_on(abstract_loop *next, const abstract_loop *loop, const char *letters, int frames, uint64_t where)
{
    const size_t length = strlen(text), added = strlen(letters);
    memcpy(text + length, letters, added);
    memset(text + length + added, '.', (size_t)frames);
    text[length + added + (size_t)frames] = 0;
    *next = *loop;
    const abstract_verdict verdict = abstract_loop_go(next, text + length);
    if (verdict)
        failed(verdict, "", 0);
    return !verdict && is_new(next, where);
}

static void walk_events(const abstract_loop *loop, int frames, int events)
{
    const size_t length = strlen(text);
    if (!frames) {
        end_of_sequence(loop);
        return;
    }
    for (int e = -1; e < (events ? EVENTS : 0); e++) {
        abstract_loop next;
        if (e >= 0 && e < ABSTRACT_LEVELS && (uint32_t)e == loop->camera.level)
            continue;
        const int left = events - (e >= 0);
        if (go_on(&next, loop, e < 0 ? "" : event[e], 1, (uint64_t)(frames * 16 + left)))
            walk_events(&next, frames - 1, left);
        text[length] = 0;
    }
}

static void walk_segments(const abstract_loop *loop, int segments)
{
    const size_t length = strlen(text);
    if (!segments) {
        end_of_sequence(loop);
        return;
    }
    for (int level = 0; level < ABSTRACT_LEVELS; level++)
        for (int f = 0; f < FAULTS; f++) {
            abstract_loop next;
            char letters[8];
            snprintf(letters, sizeof letters, "%dn%s", level, fault[f]);
            if (go_on(&next, loop, letters, SEGMENT, (uint64_t)(10000 + segments)))
                walk_segments(&next, segments - 1);
            text[length] = 0;
        }
}

/* Pairs of fault segments after which the loop of 2026-11 stayed wrong, in some cases white for ever. --segments 2
 * finds such pairs, but takes longer. */
static const struct {
    int camera;
    const char *first, *second, *rest;
} once_wrong[] = {
    {0, "9n", "6ne", "n"},   {0, "5na", "4na", "n"},  {0, "7nc", "3na", "n"},  {0, "8nm", "3ng", ""},
    {9, "1ng", "8nm", ""},   {9, "4na", "2ng", ""},   {18, "2nc", "4ne", "n"}, {18, "5nc", "5na", "n"},
    {27, "7nm", "3na", "n"}, {36, "2na", "4ni", ""},  {36, "2na", "9nm", ""},  {36, "1na", "3ne", "n"},
    {36, "7na", "5ne", ""},  {45, "2na", "8ni", "n"}, {45, "4na", "3na", "n"}, {54, "2nm", "4ne", "n"},
};

static void walk_once_wrong(void)
{
    for (size_t i = 0; i < sizeof once_wrong / sizeof *once_wrong; i++) {
        static abstract_loop loop, next;
        const uint64_t frames = abstract_frames;
        camera_number = once_wrong[i].camera;
        text[0] = 0;
        memset(seen, 0, SEEN * sizeof *seen);
        abstract_loop_open(&loop, camera_number);
        (void)go_on(&next, &loop, once_wrong[i].first, SEGMENT, 1);
        (void)go_on(&loop, &next, once_wrong[i].second, SEGMENT, 2);
        run(&loop, once_wrong[i].rest);
        mine->frames += abstract_frames - frames;
    }
}

static void walk(int which, int events, int segments)
{
    static abstract_loop loop;
    const uint64_t frames = abstract_frames;
    camera_number = which;
    text[0] = 0;
    abstract_loop_open(&loop, which);
    const uint32_t delay = loop.camera.delay > loop.believed ? loop.camera.delay : loop.believed;
    memset(seen, 0, SEEN * sizeof *seen);
    if (events)
        walk_events(&loop, 3 * (int)delay + 8, events);
    memset(seen, 0, SEEN * sizeof *seen);
    if (segments)
        walk_segments(&loop, segments);
    mine->frames += abstract_frames - frames;
}

static int again(int which, const char *sequence)
{
    static abstract_loop loop;
    abstract_verdict verdict = ABSTRACT_RIGHT;
    abstract_loop_open(&loop, which);
    printf("camera %d: %s\n", which, abstract_camera_name(which));
    for (const char *at = sequence; *at; at++) {
        const char letter[2] = {*at, 0};
        const abstract_verdict call = abstract_loop_go(&loop, letter);
        verdict = verdict ? verdict : call;
        if (*at == '.')
            abstract_loop_print(&loop);
    }
    verdict = verdict ? verdict : abstract_loop_judge(&loop);
    printf("%s\n", abstract_verdict_name[verdict]);
    return verdict != ABSTRACT_RIGHT;
}

/* The number behind an option, or `usual`. */
static int number(int argc, char **argv, const char *option, int usual)
{
    for (int i = 1; i + 1 < argc; i++)
        if (strcmp(argv[i], option) == 0)
            return atoi(argv[i + 1]);
    return usual;
}

int main(int argc, char **argv)
{
    check_begin(1, argv);
    program = argv[0];
    if (argc == 4 && strcmp(argv[1], "--again") == 0)
        return again(atoi(argv[2]), argv[3]);
    const int events = number(argc, argv, "--events", 1), segments = number(argc, argv, "--segments", 1);
    const int every = number(argc, argv, "--every", CHECK_SANITIZED ? 9 : 1), jobs = number(argc, argv, "--jobs", 1);
    most_shown = number(argc, argv, "--shown", 20) / jobs;
    tally *all = mmap(NULL, (size_t)jobs * sizeof *all, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    tally sum = {0};
    seen = malloc(SEEN * sizeof *seen);
    CHECK(all != MAP_FAILED && seen && every > 0);
    for (int job = 0; job < jobs && !check_state.failures; job++) {
        if (fork() != 0)
            continue;
        mine = &all[job];
        for (int which = every * job; which < ABSTRACT_CAMERAS; which += every * jobs)
            walk(which, events, segments);
        if (job == 0)
            walk_once_wrong();
        exit(0);
    }
    for (int status; wait(&status) > 0;)
        CHECK(status == 0);
    for (int job = 0; job < jobs; job++) {
        sum.frames += all[job].frames;
        sum.sequences += all[job].sequences;
        sum.merged += all[job].merged;
        sum.runs += all[job].runs;
        for (int i = 1; i < ABSTRACT_VERDICTS; i++)
            sum.of[i] += all[job].of[i];
    }
    printf("%d cameras, at most %d events, %d segments: %llu transitions, %llu sequences, %llu runs in still light, "
           "%llu states merged\n",
           (ABSTRACT_CAMERAS + every - 1) / every, events, segments, (unsigned long long)sum.frames,
           (unsigned long long)sum.sequences, (unsigned long long)sum.runs, (unsigned long long)sum.merged);
    for (int i = 1; i < ABSTRACT_VERDICTS; i++)
        CHECK_MSG(sum.of[i] == 0, "%s: %llu", abstract_verdict_name[i], (unsigned long long)sum.of[i]);
    CHECK(sum.frames >= 100000);
    return check_end();
}

/* Replaces recording_*.c in a build without libav or cJSON; recording_format.c still knows what a recording is. */
#include "recording.h"
#include "refuse.h"

static int refuse(const char *folder, pupil_why *why)
{
    return pupil_refuse(why, "%s: this build of pupil has no recordings (it was configured with PUPIL_MEDIA=OFF)",
                        folder);
}

int pupil_recorder_open(pupil_recorder **recorder, const char *folder, const pupil_frame *first,
                        const pupil_recorder_options *options, pupil_why *why)
{
    (void)first, (void)options;
    *recorder = NULL;
    return refuse(folder, why);
}

/* Never called: no object of this type exists. */
int pupil_recorder_write(pupil_recorder *recorder, const pupil_frame *frame, pupil_why *why)
{
    (void)recorder, (void)frame;
    return refuse("", why);
}

void pupil_recorder_get_counts(pupil_recorder *recorder, pupil_recorder_counts *counts)
{
    (void)recorder;
    *counts = (pupil_recorder_counts){0};
}

int pupil_recorder_close(pupil_recorder *recorder, pupil_why *why)
{
    (void)recorder, (void)why;
    return 0;
}

int pupil_recording_open(const char *folder, const pupil_source_options *options, pupil_source **source, pupil_why *why)
{
    (void)options;
    *source = NULL;
    refuse(folder, why);
    return PUPIL_SOURCE_FAILED;
}

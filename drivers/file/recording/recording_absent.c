/* In place of recording_*.c in a build without libav or cJSON; what a recording is, recording_format.c knows. */
#include "recording.h"
#include "refuse.h"

static int refuse(const char *folder, char *why, size_t why_bytes)
{
    return pupil_refuse(why, why_bytes,
                        "%s: this build of pupil has no recordings (it was configured with PUPIL_MEDIA=OFF or "
                        "PUPIL_MEDIA=OFF)",
                        folder);
}

int pupil_recorder_open(pupil_recorder **recorder, const char *folder, const pupil_frame *first,
                        const pupil_recorder_options *options, char *why, size_t why_bytes)
{
    (void)first, (void)options;
    *recorder = NULL;
    return refuse(folder, why, why_bytes);
}

/* Nobody has an object to give these. */
int pupil_recorder_write(pupil_recorder *recorder, const pupil_frame *frame, char *why, size_t why_bytes)
{
    (void)recorder, (void)frame;
    return refuse("", why, why_bytes);
}

void pupil_recorder_get_counts(pupil_recorder *recorder, pupil_recorder_counts *counts)
{
    (void)recorder;
    *counts = (pupil_recorder_counts){0};
}

int pupil_recorder_close(pupil_recorder *recorder, char *why, size_t why_bytes)
{
    (void)recorder, (void)why, (void)why_bytes;
    return 0;
}

int pupil_recording_open(const char *folder, pupil_source **source, char *why, size_t why_bytes)
{
    *source = NULL;
    refuse(folder, why, why_bytes);
    return PUPIL_SOURCE_FAILED;
}

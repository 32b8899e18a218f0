/* Any text as a line of a recording's frames.jsonl: an accepted line is the same once written and read again. */
#include "file/recording/recording_format.h"

#include <stdlib.h>
#include <string.h>

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    pupil_frame_info info, again;
    pupil_why why = {""};
    uint64_t frame, frame_again;
    float balance[3] = {0}, balance_again[3] = {0};
    char line[PUPIL_RECORDING_LINE_BYTES];
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, bytes, size);
    text[size] = 0;
    const int failed = pupil_recording_line_read(text, &frame, &info, balance, &why);
    free(text);
    if (failed && !*why.text)
        abort(); /* a refusal without a sentence */
    if (failed)
        return 0;
    pupil_recording_line(line, frame, &info, balance);
    if (pupil_recording_line_read(line, &frame_again, &again, balance_again, &why) || frame != frame_again ||
        info.sequence != again.sequence || info.timestamp_ns != again.timestamp_ns ||
        memcmp(&info.exposure_s, &again.exposure_s, sizeof info.exposure_s) != 0 ||
        memcmp(&info.gain, &again.gain, sizeof info.gain) != 0 || memcmp(balance, balance_again, sizeof balance) != 0)
        abort();
    return 0;
}

/* tests/fuzz/fuzz_still.h: a libFuzzer target for one still reader; the file that includes this defines READER.
 *
 * The still is kept from input to input, as a sequence of stills does. */
#include "file/still/still.h"

#include "pupil/error.h"
#include <stdlib.h>
#include <string.h>

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static pupil_still still;
    pupil_why why = {""};
    if (READER(&still, bytes, size, &why) != 0) {
        if (!*why.text)
            abort(); /* a refusal without a sentence */
        return 0;
    }
    if (still.width < 1 || still.width > PUPIL_MAX_SIDE_PX || still.height < 1 || still.height > PUPIL_MAX_SIDE_PX ||
        (uint64_t)still.width * still.height * pupil_pixel_bytes(still.pixel) > still.capacity_bytes)
        abort(); /* a picture that its consumer cannot use */
    if (still.capacity_bytes > (size_t)1 << 24)
        pupil_still_free(&still); /* so that the next overrun is near its buffer's end */
    return 0;
}

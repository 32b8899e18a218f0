/* Any text as the file of --resume: refused by a sentence with its name, or read. Then the file that replaces it is
 * read without damage, has the camera's new total and the other cameras' lines, and does not change any more. */
#include "run/kept.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CAMERA  "fake\tfake:1\tFake Camera"
#define TOTAL_S 0.00102

enum { ROOM = 1 << 17 };

typedef struct written {
    char text[ROOM];
    size_t size;
} written;

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* The text that would replace a file with these bytes. -1: it is refused. */
static int replace(const void *bytes, size_t size, run_kept *kept, written *to)
{
    pupil_why why = {""};
    FILE *in = fmemopen((void *)(uintptr_t)bytes, size, "r"), *out = fmemopen(to->text, ROOM, "w");
    if (!in || !out)
        abort();
    run_kept_write(out, CAMERA, TOTAL_S);
    const int failed = run_kept_read(in, "fuzz", CAMERA, out, kept, &why);
    if (fclose(in) || fflush(out) || ferror(out) || ftell(out) < 0)
        abort();
    to->size = (size_t)ftell(out);
    fclose(out);
    if (failed && strncmp(why.text, "fuzz: ", 6) != 0)
        abort();
    return failed;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static written first, second;
    run_kept kept;
    if (!size || replace(bytes, size, &kept, &first))
        return 0;
    if (kept.total_s != 0.0 && !(kept.total_s >= 0x1p-64 && kept.total_s <= 0x1p64))
        abort();
    if (replace(first.text, first.size, &kept, &second) || kept.is_damaged || kept.total_s != TOTAL_S ||
        first.size != second.size || memcmp(first.text, second.text, first.size) != 0)
        abort();
    return 0;
}

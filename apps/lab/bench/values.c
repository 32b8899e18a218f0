#include "bench.h"

#include <stdio.h>
#include <stdlib.h>

#include "pupil/image.h"

int bench_number(const char *option, const char *text, unsigned long least, unsigned long most, unsigned *value)
{
    char *end;
    unsigned long n = strtoul(text, &end, 10);
    if (*end || end == text || *text == '-' || n < least || n > most) {
        fprintf(stderr, "pupil bench: --%s %s: must be a whole number from %lu to %lu\n", option, text, least, most);
        return -1;
    }
    *value = (unsigned)n;
    return 0;
}

int bench_size(const char *text, uint32_t *width, uint32_t *height)
{
    char after;
    if (sscanf(text, "%5ux%5u%c", width, height, &after) == 2 && *width && *height && *width <= PUPIL_MAX_SIDE_PX &&
        *height <= PUPIL_MAX_SIDE_PX)
        return 0;
    fprintf(stderr, "pupil bench: --size %s: must be WxH, each from 1 to %u\n", text, PUPIL_MAX_SIDE_PX);
    return -1;
}

/* Structs of callers of other versions. */
#include "versioned.h"

#include "pupil/error.h"

/* More fields than a later version can be expected to have: size_bytes was never filled in. */
#define MOST_EXTRA_BYTES 4096

const char *pupil_versioned_fault(const void *theirs, size_t size_bytes, size_t our_bytes, size_t first_bytes)
{
    const unsigned char *byte = theirs;
    if (size_bytes < first_bytes || size_bytes > our_bytes + MOST_EXTRA_BYTES)
        return "size_bytes must be the struct's sizeof; a configuration begins with its _config_default";
    for (size_t i = our_bytes; i < size_bytes; i++)
        if (byte[i])
            return "size_bytes covers a field that is set and that this version of the library does not know";
    return 0;
}

const char *pupil_versioned_read(void *ours, size_t our_bytes, size_t first_bytes, const void *theirs,
                                 size_t size_bytes)
{
    const char *fault = pupil_versioned_fault(theirs, size_bytes, our_bytes, first_bytes);
    if (fault)
        return fault;
    const uint32_t size = (uint32_t)our_bytes;
    __builtin_memcpy(ours, theirs, size_bytes < our_bytes ? size_bytes : our_bytes);
    __builtin_memcpy(ours, &size, sizeof size);
    return 0;
}

int pupil_versioned_write(void *theirs, size_t their_bytes, const void *ours, size_t our_bytes)
{
    const size_t common = their_bytes < our_bytes ? their_bytes : our_bytes;
    const uint32_t size = (uint32_t)their_bytes;
    if (their_bytes < sizeof size)
        return PUPIL_ERR_SIZE_BYTES;
    __builtin_memcpy(theirs, ours, common);
    __builtin_memset((unsigned char *)theirs + common, 0, their_bytes - common);
    __builtin_memcpy(theirs, &size, sizeof size);
    return PUPIL_OK;
}

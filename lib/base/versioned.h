/* lib/base/versioned.h: structs that begin with size_bytes, as pupil/abi.h describes them. */
#ifndef PUPIL_BASE_VERSIONED_H
#define PUPIL_BASE_VERSIONED_H

#include <stddef.h>
#include <stdint.h>

/* Bytes of the first release's struct, by its last field then: no caller has a shorter one. */
#define PUPIL_FIRST_BYTES(type, last_field) (offsetof(type, last_field) + sizeof(((type *)0)->last_field))

/* NULL if a caller's struct of `size_bytes` can be read as one of ours, or a sentence. `first_bytes` as above. */
const char *pupil_versioned_fault(const void *theirs, size_t size_bytes, size_t our_bytes, size_t first_bytes);

/* Copies a caller's struct of `size_bytes` over ours, which holds the defaults of what the caller may lack; size_bytes
 * of ours becomes our_bytes. NULL, or a sentence, and ours is untouched. */
const char *pupil_versioned_read(void *ours, size_t our_bytes, size_t first_bytes, const void *theirs,
                                 size_t size_bytes);

/* Copies ours to a caller's struct of `their_bytes`, and sets its size_bytes to that. Fields that it has no room for
 * are left out, fields that ours lacks become 0. PUPIL_ERR_SIZE_BYTES if it has no room for size_bytes itself: nothing
 * is written. */
int pupil_versioned_write(void *theirs, size_t their_bytes, const void *ours, size_t our_bytes);

#endif

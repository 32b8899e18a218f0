/* pupil/abi.h: how a program works with a library that is older or newer than the headers it was compiled with.
 *
 * A struct that may grow begins with `size_bytes`: its sizeof when the caller was compiled. New fields are added at the
 * end only, and 0 (or the default) in a new field means what the library did before it had the field. No field is moved
 * or removed, and no struct has padding, while the soname stays the same: libpupil.so.0.MINOR, from 1.0 on
 * libpupil.so.MAJOR. Structs without size_bytes are frozen. The objects (pupil_t and the like) keep their size.
 *
 * Configurations: begin with pupil_..._config_default, which fills in size_bytes and every field that the caller has.
 *
 * Other inputs (images, their coding, frame info, curves, targets, statistics): size_bytes is 0 or sizeof the struct. 0
 * means the fields of the first release, so initializers such as {.data = pixels, .width = 640} need not name it. A
 * field that was added later is read only where size_bytes covers it.
 *
 * The library reads at most size_bytes. Fields that an older caller lacks have their defaults. A newer caller's fields
 * that the library does not know must be 0. Anything else is refused before anything is touched: configurations and
 * coding by their check, with its sentence, other structs with PUPIL_ERR_SIZE_BYTES.
 *
 * Outputs: an inline function passes the caller's sizeof to a function that ends in _sized (call these from other
 * languages). The library writes at most that many bytes, and sets size_bytes to it. Fields of a newer caller that the
 * library does not know become 0.
 */
#ifndef PUPIL_ABI_H
#define PUPIL_ABI_H

/* Exported from the shared library; everything else is hidden. */
#if defined(__GNUC__)
#define PUPIL_API __attribute__((visibility("default")))
#else
#define PUPIL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define PUPIL_VERSION_MAJOR 0
#define PUPIL_VERSION_MINOR 2
#define PUPIL_VERSION_PATCH 0

/* "0.2.0": the version of the linked library, which may differ from this header's. */
PUPIL_API const char *pupil_version(void);

#ifdef __cplusplus
}
#endif

#endif

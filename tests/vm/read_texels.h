/* tests/vm/read_texels.h: a texture's contents, read by a shader that does not change them. */
#ifndef PUPIL_TESTS_VM_READ_TEXELS_H
#define PUPIL_TESTS_VM_READ_TEXELS_H

#include <stdint.h>

/* 0, or -1 after printing why not. In the current context. */
int read_texels_open(void);

/* The codes (0..largest) of a normalised texture: four channels per texel; missing ones are 0, and largest for alpha.
 * 0, or -1 after printing why not. */
int read_texels(uint32_t texture, uint32_t width, uint32_t height, uint32_t largest, uint32_t *codes);

#endif

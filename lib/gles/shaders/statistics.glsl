// A frame's statistics as a buffer (lib/gles/gles_private.h: gles_statistics).

#define BINS      512u
#define PEAK_BINS 256u

layout(std430, binding = 0) buffer Statistics {
    uvec4 region[REGION_COLUMNS * REGION_ROWS];
    uvec4 level;                 // the state after this frame, where the GPU adapts
    uvec4 peak;                  // x: bits of the brightest channel
    uvec2 bin[BINS + PEAK_BINS]; // 64 bits each, lower word first; those of the brightest channel behind those of L
} statistics;

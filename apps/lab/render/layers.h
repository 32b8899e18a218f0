/* apps/lab/render/layers.h: frames of a scene with depth, normals and more besides the light, as OpenEXR files of many
 * channels. */
#ifndef PUPIL_APPS_LAB_RENDER_LAYERS_H
#define PUPIL_APPS_LAB_RENDER_LAYERS_H

#include "source.h"

/* The layers, and their channels in addition to R, G and B. */
enum {
    LAYER_DEPTH = 1,     /* Z: metres along the camera's axis, infinite where nothing is seen */
    LAYER_NORMAL = 2,    /* N.X, N.Y, N.Z: in the scene's axes, 0 where nothing is seen */
    LAYER_ALBEDO = 4,    /* albedo.R, .G, .B: the material's diffuse reflectance */
    LAYER_OCCLUSION = 8, /* occlusion.Y: openness within LAYERS_RADIUS_M by rays */
    LAYER_SSAO = 16      /* ssao.Y: the same in screen space */
};

#define LAYERS_RADIUS_M 0.5
#define LAYERS_RAYS     12 /* 12 x 12 a pixel */
#define LAYERS_SAMPLES  64

/* "depth,normal": 0 and the layers, or -1. */
int layers_parse(const char *text, unsigned *layers);

/* Renders frames into `path`: one .exr, or a folder of frame_NNNNNN.exr. progress(context, done, total) after each. 0;
 * -1 and a sentence, or because options->stop said so. */
int layers_render(const char *scene, const pupil_source_options *options, unsigned layers, const char *path,
                  int overwrite, void (*progress)(void *context, uint64_t done, uint64_t total), void *context,
                  pupil_why *why);

#endif

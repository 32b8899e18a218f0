/* Replaces lib/gles if the library is built without OpenGL ES (PUPIL_GPU=OFF): every call reports that. */
#include "pupil/gles.h"

#include "base/versioned.h"

static int absent(pupil_why *why)
{
    static const char sentence[] = "this library was built without OpenGL ES (CMake: -DPUPIL_GPU=ON)";
    for (size_t i = 0; why && i < sizeof sentence; i++)
        why->text[i] = sentence[i];
    return PUPIL_ERR_GLES_ABSENT;
}

void pupil_gles_config_default_sized(pupil_gles_config *config, size_t config_bytes)
{
    static const pupil_gles_config defaults; /* all zero */
    if (config)
        (void)pupil_versioned_write(config, config_bytes, &defaults, sizeof defaults);
}

int pupil_gles_init(pupil_gles *gles, const pupil_gles_config *config, const pupil_t *pupil,
                    pupil_gles_get_proc get_proc, pupil_why *why)
{
    (void)gles, (void)config, (void)pupil, (void)get_proc;
    return absent(why);
}

int pupil_gles_retune(pupil_gles *gles, const pupil_t *pupil, pupil_why *why)
{
    (void)gles, (void)pupil;
    return absent(why);
}

int pupil_gles_balance(pupil_gles *gles, const float balance[3])
{
    (void)gles, (void)balance;
    return PUPIL_ERR_GLES_ABSENT;
}

void pupil_gles_close(pupil_gles *gles)
{
    (void)gles;
}

int pupil_gles_upload(pupil_gles *gles, const pupil_image_const *image)
{
    (void)gles, (void)image;
    return PUPIL_ERR_GLES_ABSENT;
}

int pupil_gles_veil(pupil_gles *gles, const float *nodes, float direct)
{
    (void)gles, (void)nodes, (void)direct;
    return PUPIL_ERR_GLES_ABSENT;
}

int pupil_gles_use(pupil_gles *gles, uint32_t texture, uint32_t chroma_texture, uint32_t cr_texture)
{
    (void)gles, (void)texture, (void)chroma_texture, (void)cr_texture;
    return PUPIL_ERR_GLES_ABSENT;
}

int pupil_gles_process(pupil_gles *gles, pupil_t *pupil, const pupil_frame_info *info, const pupil_gles_target *target)
{
    (void)gles, (void)pupil, (void)info, (void)target;
    return PUPIL_ERR_GLES_ABSENT;
}

int pupil_gles_meter(pupil_gles *gles, const pupil_frame_info *info)
{
    (void)gles, (void)info;
    return PUPIL_ERR_GLES_ABSENT;
}

int pupil_gles_collect_sized(pupil_gles *gles, uint64_t timeout_ns, pupil_stats *stats, size_t stats_bytes,
                             pupil_frame_info *info, size_t info_bytes)
{
    (void)gles, (void)timeout_ns, (void)stats, (void)stats_bytes, (void)info, (void)info_bytes;
    return PUPIL_ERR_GLES_ABSENT;
}

int pupil_gles_map(pupil_gles *gles, const pupil_curve *curve, const pupil_gles_target *target)
{
    (void)gles, (void)curve, (void)target;
    return PUPIL_ERR_GLES_ABSENT;
}

int pupil_gles_get_status_sized(const pupil_gles *gles, pupil_gles_status *status, size_t status_bytes)
{
    (void)gles, (void)status, (void)status_bytes;
    return PUPIL_ERR_GLES_ABSENT;
}

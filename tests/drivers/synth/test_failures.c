/* Each C library call of a small scene, from its recipe to its second frame, fails once: a sentence and nothing left,
 * or the same frames, for example with fewer threads. */
#include "drivers/file/each_call.h"

#include "synth/synth_source.h"

static int act(const each_call *c, uint64_t *digest, pupil_why *why)
{
    const pupil_source_options options = {.threads = 3};
    pupil_source *source = NULL;
    if (pupil_synth_source_open(c->path, &options, &source, why)) {
        CHECK(!source);
        return -1;
    }
    *digest = source->frames;
    return each_call_frames(source, digest, why);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    scratch_put(scratch("a.scene"), "size width_px 12 height_px 40\nfps 30\nframes 2\nsamples antialias 1 shadow 1\n"
                                    "sensor exposure_s 0.01 electrons 800 bits 10 bayer none\n"
                                    "camera position_m 0 1.6 0 look_at_m 0 1 -9 fov_degrees 60\n"
                                    "ambient radiance 0.1 0.1 0.1\n"
                                    "material ball diffuse 0.5 0.4 0.3\n"
                                    "sphere material ball position_m 0 1 -9 radius_m 2\n");
    each_call_sweep(&(each_call){.name = "a scene", .act = act, .path = scratch("a.scene")});
    scratch_clear(scratch_folder);
    return check_end();
}

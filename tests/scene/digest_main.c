/* The scene digest: a line for every part of the scene renderer whose bits must be the same for every compiler,
 * optimisation level, CPU and number of threads: "name 0123456789abcdef". Its argument is the folder of the recipes. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mesh.h"
#include "scene.h"
#include "synth/spread.h"

/* --- digests --- */

/* FNV-1a, 64 bits (Fowler, Noll, Vo; draft-eastlake-fnv), of a value's bytes, lowest first. */
static uint64_t add(uint64_t digest, uint64_t value, int bytes)
{
    for (; bytes--; value >>= 8)
        digest = (digest ^ (value & 255)) * UINT64_C(0x100000001b3);
    return digest;
}

static const uint64_t nothing = UINT64_C(0xcbf29ce484222325);

static uint64_t add_double(uint64_t digest, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return add(digest, bits, 8);
}

static uint64_t add_floats(uint64_t digest, const float *value, size_t count)
{
    for (; count--; value++) {
        uint32_t bits;
        memcpy(&bits, value, sizeof bits);
        digest = add(digest, bits, 4);
    }
    return digest;
}

static void fail(const char *why)
{
    fprintf(stderr, "scene digest: %s\n", why);
    exit(1);
}

/* --- what is digested --- */

static void mesh(const char *name, fixture_mesh *m)
{
    uint64_t digest = nothing;
    for (size_t i = 0; i < m->vertices; i++)
        for (int k = 0; k < 3; k++) {
            digest = add_double(digest, m->position[i][k]);
            digest = m->normal ? add_double(digest, m->normal[i][k]) : digest;
        }
    for (size_t i = 0; i < m->triangles; i++)
        for (int k = 0; k < 3; k++)
            digest = add(digest, m->triangle[i][k], 4);
    printf("%s %016llx\n", name, (unsigned long long)digest);
    fixture_mesh_free(m);
}

static void meshes(void)
{
    pupil_why why = {""};
    fixture_mesh m = {0};
    if (fixture_mesh_teapot(&m, 7, &why))
        fail(why.text);
    mesh("mesh-teapot", &m);
    m = (fixture_mesh){0};
    if (fixture_mesh_figure(&m, 96, &why))
        fail(why.text);
    mesh("mesh-figure", &m);
}

/* Two frames of a scene, a line each: light, and the frame's info. */
static void scene(const char *name, const char *recipe, uint32_t side, uint64_t later, unsigned threads)
{
    pupil_spread spread = {.threads = threads};
    fixture_scene_options options = {side, side, 0.0, threads > 1 ? pupil_spread_run : NULL, &spread};
    fixture_scene *s;
    pupil_why why = {""};
    if (fixture_scene_load(&s, recipe, &options, &why))
        fail(why.text);
    fixture_scene_facts f = fixture_scene_facts_of(s);
    size_t samples = (size_t)f.width * f.height * 3;
    float *rgb = malloc(samples * sizeof *rgb);
    for (uint64_t frame = 0; rgb && frame <= later; frame += later) {
        pupil_frame_info info;
        if (fixture_scene_frame(s, frame, rgb, &info, &why))
            fail(why.text);
        uint64_t digest = add_floats(nothing, rgb, samples);
        digest = add(digest, (uint64_t)info.timestamp_ns, 8);
        digest = add_double(add_double(digest, (double)info.exposure_s), (double)info.gain);
        printf("%s-frame-%u-threads-%u %016llx\n", name, (unsigned)frame, threads, (unsigned long long)digest);
    }
    if (!rgb)
        fail("not enough memory");
    free(rgb);
    fixture_scene_free(s);
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"solids", "meshes", "bayer", "three", "walls", "shots"};
    static const char *const stills[] = {"table", "candle", "stars", "meadow", "leds", "lamps"};
    static const unsigned threads[] = {1, 2, 7};
    if (argc != 2)
        fail("its argument is the folder of the recipes");
    meshes();
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        for (size_t k = 0; k < sizeof threads / sizeof threads[0]; k++) {
            char recipe[4096];
            snprintf(recipe, sizeof recipe, "%s/%s.scene", argv[1], names[i]);
            scene(names[i], recipe, 0, 4, threads[k]);
        }
    scene("room", "room", 24, 400, 2);
    scene("walk", "walk", 24, 60, 2);
    for (size_t i = 0; i < sizeof stills / sizeof stills[0]; i++)
        for (size_t k = 0; k < sizeof threads / sizeof threads[0]; k++)
            scene(stills[i], stills[i], 24, 4, threads[k]);
    return 0;
}

/* Every shader text that lib/gles can assemble, checked by glslangValidator, because some drivers' compilers accept
 * errors that others do not. */
#include "check.h"
#include "frames.h"
#include "gles/gles_variant.h"
#include "scratch.h"

#include <ctype.h>

/* As lib/gles/gles_programs.c compiles them. */
static const uint32_t stages_30[] = {GLES_TRIANGLE_VERT, GLES_METER_FRAG, GLES_REDUCE_FRAG, GLES_WEIGH_FRAG,
                                     GLES_ADAPT_FRAG,    GLES_MAP_VERT,   GLES_MAP_FRAG,    GLES_MAP_SCALED_FRAG};
static const uint32_t stages_31[] = {GLES_METER_COMP, GLES_ADAPT_COMP, GLES_MAP_VERT, GLES_MAP_FRAG,
                                     GLES_MAP_SCALED_FRAG};

#define TEXTS 2048
static char *known[TEXTS]; /* each text once, and the file it is in */
static char names[TEXTS][64];
static int count;

static char *put_together(const gles_variant *v, uint32_t shader)
{
    const char *texts[GLES_MOST_TEXTS];
    const uint32_t parts = pupil_gles_shader_texts(v, shader, texts);
    size_t bytes = 1;
    CHECK(parts <= GLES_MOST_TEXTS);
    for (uint32_t i = 0; i < parts; i++)
        bytes += strlen(texts[i]);
    char *whole = calloc(bytes, 1);
    for (uint32_t i = 0; i < parts; i++)
        strcat(whole, texts[i]);
    return whole;
}

/* glslangValidator takes the stage from the file's extension. */
static const char *stage_of(const char *name)
{
    return strstr(name, ".vert") ? "vert" : strstr(name, ".comp") ? "comp" : "frag";
}

static void write_file(const char *name, const char *text)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", scratch_folder, name);
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0);
    CHECK(file && fclose(file) == 0);
}

static void keep(const gles_variant *v, uint32_t shader)
{
    char *text = put_together(v, shader);
    int i = 0;
    while (i < count && strcmp(known[i], text) != 0)
        i++;
    if (i < count || count == TEXTS) {
        CHECK(i < TEXTS);
        free(text);
        return;
    }
    const char *name = pupil_gles_shader_name(shader), *stage = stage_of(name);
    snprintf(names[count], sizeof names[count], "%.*s%s-es%u-pixel%u-%d.%s", (int)strcspn(name, "."), name,
             shader == GLES_MAP_SCALED_FRAG ? "-scaled" : "", v->version, v->pixel, count, stage);
    write_file(names[count], text);
    known[count++] = text;
}

static int is_mosaic(uint32_t pixel)
{
    return pupil_pixel_is_mosaic(pixel);
}

/* Whether pupil_gles_init can use this one. */
static int makes_sense(const gles_variant *v)
{
    const int external = v->source == PUPIL_GLES_EXTERNAL;
    const int coded = !is_mosaic(v->pixel) && (!frame_is_rgb(v->pixel) || v->pixel == PUPIL_PIXEL_RGB10A2);
    return (!external || v->pixel == PUPIL_PIXEL_RGBA8) && (!v->normalized_16 || v->source == PUPIL_GLES_TEXTURES) &&
           (!(v->half_size || v->has_matrix) || is_mosaic(v->pixel)) && (!v->is_linear || coded || external) &&
           (!v->veil || !is_mosaic(v->pixel)) && (!v->histogram || v->version == PUPIL_GLES_ES31);
}

static void keep_all(const gles_variant *v)
{
    const int is_31 = v->version == PUPIL_GLES_ES31;
    const uint32_t *stages = is_31 ? stages_31 : stages_30;
    const size_t stage_count = is_31 ? sizeof stages_31 / sizeof stages_31[0] : sizeof stages_30 / sizeof stages_30[0];
    for (size_t i = 0; i < stage_count; i++) {
        const uint32_t shader = stages[i];
        if (v->level_here || (shader != GLES_WEIGH_FRAG && shader != GLES_ADAPT_FRAG && shader != GLES_ADAPT_COMP))
            keep(v, shader);
    }
}

static void keep_every(void)
{
    for (uint32_t pixel = PUPIL_PIXEL_NONE + 1; pixel < PUPIL_PIXEL_COUNT; pixel++)
        for (uint32_t bits = 0; bits < 256; bits++)
            for (uint32_t source = 0; source < PUPIL_GLES_SOURCE_COUNT; source++) {
                const gles_variant v = {.version = bits & 1 ? PUPIL_GLES_ES31 : PUPIL_GLES_ES30,
                                        .pixel = pixel,
                                        .source = source,
                                        .normalized_16 = bits >> 1 & 1,
                                        .half_size = bits >> 2 & 1,
                                        .is_linear = bits >> 3 & 1,
                                        .has_matrix = bits >> 4 & 1,
                                        .histogram = bits >> 5 & 1,
                                        .level_here = bits >> 6 & 1,
                                        .veil = bits >> 7 & 1};
                if (makes_sense(&v))
                    keep_all(&v);
            }
}

/* 1: glslangValidator accepts the files. */
static int validates(const char *files, const char *if_not)
{
    char command[1024];
    snprintf(command, sizeof command, "cd %s && glslangValidator %s > said 2>&1 || { %s; exit 1; }", scratch_folder,
             files, if_not);
    fflush(stdout);
    return system(command) == 0;
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    if (system("command -v glslangValidator > /dev/null") != 0)
        return check_skip("no glslangValidator (Debian: glslang-tools)");
    scratch_begin();
    keep_every();
    printf("%d texts\n", count);
    CHECK_MSG(count > 100, "%d", count);
    CHECK(validates("*.vert *.frag *.comp", "grep -B3 ERROR said"));

    /* It finds faults, in each stage. */
    static const char *const wrong[] = {"wrong.vert", "wrong.frag", "wrong.comp"};
    for (int i = 0; i < 3; i++) {
        write_file(wrong[i], "#version 310 es\nvoid main() { int x = 1.0; }\n");
        CHECK(!validates(wrong[i], ":"));
    }
    for (int i = 0; i < count; i++)
        free(known[i]);
    scratch_clear(scratch_folder);
    return check_end();
}

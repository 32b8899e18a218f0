/* The comparison video: the twenty weights side by side, in the order of the tables. */
#include "study.h"

#include <stdlib.h>
#include <string.h>

#include "file/sink/sink_common.h"
#include "output/pictures.h"
#include "refuse.h"

#define TILE    200u
#define COLUMNS 5u
#define WIDTH   (COLUMNS * TILE)
#define HEIGHT  (STUDY_WEIGHTS / COLUMNS * TILE)

typedef struct video {
    uint32_t width, height;          /* of the picture within a tile */
    float small[2][TILE * TILE * 3]; /* off, on: the means of the light that falls on a pixel */
    uint8_t frame[HEIGHT][WIDTH][3];
    struct {
        pupil_t pupil;
        float scale; /* of the shown tile; an unchanged state is not mapped again */
        int light;
    } tile[STUDY_WEIGHTS];
} video;

/* The part of [0, size) that falls on pixel i of n; at least one sample. */
static void part(uint32_t i, uint32_t n, uint32_t size, uint32_t *from, uint32_t *to)
{
    *from = (uint32_t)((uint64_t)i * size / n);
    *to = (uint32_t)((uint64_t)(i + 1) * size / n);
    *to = *to > *from ? *to : *from + 1;
}

static void shrink(video *v, const study_images *images)
{
    const uint32_t w = images->width, h = images->height;
    v->width = w >= h ? TILE : (uint32_t)((uint64_t)TILE * w / h + !(TILE * (uint64_t)w / h));
    v->height = h >= w ? TILE : (uint32_t)((uint64_t)TILE * h / w + !(TILE * (uint64_t)h / w));
    for (int s = 0; s < 2; s++)
        for (uint32_t y = 0; y < v->height; y++)
            for (uint32_t x = 0; x < v->width; x++) {
                uint32_t x0, x1, y0, y1;
                double sum[3] = {0.0, 0.0, 0.0};
                part(x, v->width, w, &x0, &x1);
                part(y, v->height, h, &y0, &y1);
                for (uint32_t sy = y0; sy < y1; sy++)
                    for (uint32_t sx = x0; sx < x1; sx++)
                        for (unsigned k = 0; k < 3; k++)
                            sum[k] += (double)images->state[s][((size_t)sy * w + sx) * 3 + k];
                for (unsigned k = 0; k < 3; k++)
                    v->small[s][((size_t)y * v->width + x) * 3 + k] = (float)(sum[k] / ((x1 - x0) * (y1 - y0)));
            }
}

static int begin(video *v, const study_lights *lights, unsigned formula)
{
    int error = PUPIL_OK;
    pupil_config config = lights->config;
    config.law = PUPIL_LAW_ARITHMETIC_SCALE + formula;
    config.transfer = PUPIL_TRANSFER_SRGB; /* as the video states */
    for (unsigned w = 0; w < STUDY_WEIGHTS; w++) {
        config.frame_weight = study_weights[w];
        v->tile[w].light = -1;
        error = error ? error : pupil_init(&v->tile[w].pupil, &config);
    }
    return error;
}

static int draw_tile(video *v, unsigned w, const study_lights *lights, int light)
{
    pupil_curve curve;
    int error = pupil_adapt(&v->tile[w].pupil, &lights->stats[light], NULL);
    if (!error)
        error = pupil_get_curve(&v->tile[w].pupil, NULL, &curve);
    if (error || (v->tile[w].light == light && v->tile[w].scale == curve.scale))
        return error;
    v->tile[w].light = light;
    v->tile[w].scale = curve.scale;
    uint8_t *corner = v->frame[w / COLUMNS * TILE + (TILE - v->height) / 2][w % COLUMNS * TILE + (TILE - v->width) / 2];
    pupil_image_const in = {.data = v->small[light],
                            .stride_bytes = (ptrdiff_t)(v->width * 3 * sizeof(float)),
                            .width = v->width,
                            .height = v->height,
                            .pixel = PUPIL_PIXEL_RGB32F};
    pupil_image out = {.data = corner,
                       .stride_bytes = (ptrdiff_t)sizeof v->frame[0],
                       .width = v->width,
                       .height = v->height,
                       .pixel = PUPIL_PIXEL_RGB8};
    return pupil_map_rows(&v->tile[w].pupil, &curve, &in, &out);
}

static int write_frames(video *v, pictures *o, const study_lights *lights, unsigned which_case,
                        study_progress *progress, void *context, pupil_why *why)
{
    const pupil_image_const image = {.data = v->frame,
                                     .stride_bytes = (ptrdiff_t)sizeof v->frame[0],
                                     .width = WIDTH,
                                     .height = HEIGHT,
                                     .pixel = PUPIL_PIXEL_RGB8};
    for (uint32_t i = 0; i < STUDY_FRAMES; i++) {
        pupil_frame_info info = {.timestamp_ns = (int64_t)i * 1000000000 / STUDY_FPS, .sequence = i};
        for (unsigned w = 0; w < STUDY_WEIGHTS; w++) {
            int error = draw_tile(v, w, lights, study_light_of(which_case, STUDY_FPS, i));
            if (error)
                return pupil_refuse(why, "the video's frame %u: %s", i, pupil_error_string(error));
        }
        if (pictures_write(o, &image, &info, NULL, why))
            return -1;
        if (progress && progress(context, i + 1, STUDY_FRAMES))
            return 1;
    }
    return 0;
}

int study_video(const char *path, const study_images *images, const study_lights *lights, unsigned which_case,
                unsigned formula, study_progress *progress, void *context, pupil_why *why)
{
    const pupil_sink_options options = {.width = WIDTH, .height = HEIGHT, .fps = STUDY_FPS, .overwrite = 1};
    pictures o = {.count = 0};
    video *v = calloc(1, sizeof *v);
    if (!v)
        return pupil_refuse(why, "%s: not enough memory", path);
    shrink(v, images);
    int failed = begin(v, lights, formula) ? pupil_refuse(why, "%s: cannot begin", path)
                                           : pictures_open(&o, path, &options, why);
    if (!failed)
        failed = write_frames(v, &o, lights, which_case, progress, context, why);
    if (!failed)
        failed = pictures_finish(&o, why);
    pictures_discard(&o);
    free(v);
    return failed;
}

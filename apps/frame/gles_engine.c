#include "gles_engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "egl/egl_context.h"
#include "gl_calls.h"
#include "gles_shared.h"
#include "refuse.h"
#include "source.h"

/* Ten seconds: a software renderer may take one for a frame of 16384 x 16384; a GPU that needs longer hangs. */
#define COLLECT_NS UINT64_C(10000000000)

enum { PICTURE = 0, SMALL, ROOMS };

typedef struct gles_room { /* the target of mapping, to be read back */
    GLuint framebuffer, renderbuffer;
    uint32_t width, height;
} gles_room;

struct gles_engine {
    pupil_egl *egl; /* NULL: the context is the caller's */
    pupil_gles_get_proc get_proc;
    gl_calls gl;
    pupil_config settings;
    int no_histogram; /* the context cannot have one, and only the record's quantiles need it */
    pupil_gles_config config;
    pupil_coding coding; /* config.coding is this one */
    pupil_gles gles;     /* for frames as in config */
    int open;
    gles_shared shared;
    int is_shared;   /* the frame that was metered last */
    int is_software; /* Mesa 22.3's renderers crash on dma-bufs of other devices, which they cannot map */
    gles_room room[ROOMS];
    float nodes[PUPIL_VEIL_NODES * PUPIL_VEIL_NODES * 3]; /* of the current veil */
    unsigned char *rgba;                                  /* read back */
    size_t rgba_bytes;
};

static int say(pupil_why *why, int error, const char *what)
{
    return pupil_refuse(why, "%s: %s", what, pupil_error_string(error));
}

/* --- life --- */

int gles_engine_open(gles_engine **work, const pupil_config *config, uint32_t version, pupil_gles_get_proc get_proc,
                     pupil_why *why)
{
    const pupil_egl_options options = {.version = version, .robust = 1};
    gles_engine *g = calloc(1, sizeof *g);
    if (!g)
        return pupil_refuse(why, "not enough memory");
    g->get_proc = get_proc ? get_proc : pupil_egl_get_proc;
    g->settings = *config;
    pupil_gles_config_default(&g->config);
    g->config.version = version;
    g->config.coding = &g->coding;
    g->config.scaled = get_proc != NULL; /* a window has any size */
    if ((!get_proc && pupil_egl_open(&g->egl, &options, why)) || gl_calls_load(&g->gl, g->get_proc, why)) {
        pupil_egl_close(g->egl);
        free(g);
        return -1;
    }
    g->is_software = gl_calls_software(&g->gl) != NULL;
    *work = g;
    return 0;
}

void gles_engine_close(gles_engine *g)
{
    if (!g)
        return;
    if (g->open)
        pupil_gles_close(&g->gles);
    gles_shared_release(&g->shared);
    for (int i = 0; i < ROOMS; i++) {
        g->gl.DeleteFramebuffers(1, &g->room[i].framebuffer);
        g->gl.DeleteRenderbuffers(1, &g->room[i].renderbuffer);
    }
    pupil_egl_close(g->egl);
    free(g->rgba);
    free(g);
}

static int wants_histogram(const pupil_config *c)
{
    return c->trim_low > 0.0f || c->trim_high < 1.0f || c->white_mode == PUPIL_WHITE_FOLLOW ||
           c->curve != PUPIL_CURVE_REINHARD;
}

static int start(gles_engine *g, pupil_t *pupil, pupil_why *why)
{
    pupil_why reason = {""};
    int error = pupil_gles_init(&g->gles, &g->config, pupil, g->get_proc, &reason);
    if (error == PUPIL_ERR_CONFIG && wants_histogram(&g->settings)) { /* in the words of replay's options */
        return pupil_refuse(why, "this OpenGL ES 3.0 has no histogram, which %s",
                            g->settings.curve != PUPIL_CURVE_REINHARD ? "--tone needs"
                            : g->settings.white_mode == PUPIL_WHITE_FOLLOW
                                ? "a white point that follows needs; --white none, or a number, does without"
                                : "--trim needs");
    }
    if (error == PUPIL_ERR_CONFIG && g->settings.histogram) {
        g->no_histogram = 1;
        g->settings.histogram = 0;
        pupil_retune(pupil, &g->settings);
        error = pupil_gles_init(&g->gles, &g->config, pupil, g->get_proc, &reason);
    }
    if (error)
        return pupil_refuse(why, "%s", *reason.text ? reason.text : pupil_error_string(error));
    g->open = 1;
    return 0;
}

/* The same except for the white balance. */
static int is_balanced(const pupil_coding *a, const pupil_coding *b)
{
    pupil_coding with = *a;
    memcpy(with.balance, b->balance, sizeof with.balance);
    return memcmp(&with, b, sizeof with) == 0;
}

/* Makes the object for frames like this one, in memory or in textures. */
static int fit(gles_engine *g, pupil_t *pupil, const pupil_image_const *in, uint32_t source, pupil_why *why)
{
    static const pupil_coding usual;
    const pupil_coding *coding = in->coding ? in->coding : &usual;
    pupil_gles_config *c = &g->config;
    const int is_alike =
        g->open && c->pixel == in->pixel && c->width == in->width && c->height == in->height && c->source == source;
    if (is_alike && memcmp(&g->coding, coding, sizeof *coding) == 0)
        return 0;
    if (is_alike && is_balanced(&g->coding, coding)) {
        g->coding = *coding;
        return pupil_gles_balance(&g->gles, coding->balance)
                   ? (pupil_refuse(why, "the GPU takes no other white balance"), -1)
                   : 0;
    }
    if (g->open)
        pupil_gles_close(&g->gles);
    g->open = 0;
    c->source = source;
    c->normalized_16 = source == PUPIL_GLES_TEXTURES;
    c->pixel = in->pixel;
    c->width = in->width;
    c->height = in->height;
    g->coding = *coding;
    return start(g, pupil, why);
}

int gles_engine_retune(gles_engine *g, pupil_t *pupil, const pupil_config *config, pupil_why *why)
{
    pupil_why reason = {""};
    g->settings = *config;
    if (g->no_histogram)
        g->settings.histogram = 0;
    int error = pupil_retune(pupil, &g->settings);
    if (error)
        return say(why, error, "new settings");
    error = g->open ? pupil_gles_retune(&g->gles, pupil, &reason) : PUPIL_OK;
    if (error)
        pupil_refuse(why, "%s", *reason.text ? reason.text : pupil_error_string(error));
    return error ? -1 : 0;
}

void gles_engine_describe(const gles_engine *g, char *text, size_t text_bytes)
{
    char renderer[256];
    pupil_gles_status status = {0};
    pupil_egl_describe(renderer, sizeof renderer);
    if (g->open && pupil_gles_get_status(&g->gles, &status) == PUPIL_OK)
        snprintf(text, text_bytes, "%s, metering as in ES %lu.%lu%s", renderer, (unsigned long)status.version / 10,
                 (unsigned long)status.version % 10,
                 g->is_shared              ? ", frames without a copy"
                 : *g->shared.refusal.text ? ", frames copied (the driver does not take the camera's dma-bufs)"
                                           : "");
    else
        snprintf(text, text_bytes, "%s", renderer);
}

/* --- a frame --- */

/* Frames may change in size and format. A camera's dma-bufs are read without a copy. */
static int meter(void *self, pupil_t *pupil, const pupil_frame *frame, pupil_stats *stats, pupil_why *why)
{
    gles_engine *g = self;
    const pupil_dmabuf_textures *shared = g->is_software ? NULL : gles_shared_textures(&g->shared, frame);
    g->is_shared = shared != NULL;
    if (fit(g, pupil, &frame->image, shared ? PUPIL_GLES_TEXTURES : PUPIL_GLES_MEMORY, why))
        return -1;
    int error = shared ? pupil_gles_use(&g->gles, shared->texture[0], shared->texture[1], shared->texture[2])
                       : pupil_gles_upload(&g->gles, &frame->image);
    if (error)
        return say(why, error, shared ? "the frame's dma-buf" : "uploading the frame");
    error = pupil_gles_meter(&g->gles, &frame->info);
    if (error < 0)
        return say(why, error, "metering");
    error = pupil_gles_collect(&g->gles, COLLECT_NS, stats, NULL);
    if (error < 0)
        return say(why, error, "reading statistics back");
    if (frame->code_light > 0.0f)
        stats->code_light = frame->code_light;
    return error ? pupil_refuse(why, "the GPU has not metered a frame within ten seconds") : 0;
}

/* --- mapping --- */

void gles_engine_use_veil(gles_engine *g)
{
    g->config.veil = 1;
}

int gles_engine_set_veil(gles_engine *g, const pupil_veil *veil, pupil_why *why)
{
    pupil_veil_result result;
    int error = pupil_veil_get_nodes(veil, g->nodes);
    if (!error)
        error = pupil_veil_get(veil, &result);
    if (!error)
        error = pupil_gles_veil(&g->gles, g->nodes, (float)result.direct);
    return error ? say(why, error, "the veil") : 0;
}

static int make_room(gles_engine *g, gles_room *r, uint32_t width, uint32_t height, pupil_why *why)
{
    const size_t bytes = (size_t)width * height * 4;
    if (bytes > g->rgba_bytes) {
        free(g->rgba);
        g->rgba = malloc(bytes);
        g->rgba_bytes = g->rgba ? bytes : 0;
        if (!g->rgba)
            return pupil_refuse(why, "not enough memory");
    }
    if (r->framebuffer && r->width == width && r->height == height)
        return 0;
    if (!r->framebuffer) {
        g->gl.GenFramebuffers(1, &r->framebuffer);
        g->gl.GenRenderbuffers(1, &r->renderbuffer);
    }
    r->width = width;
    r->height = height;
    g->gl.BindRenderbuffer(GL_RENDERBUFFER, r->renderbuffer);
    g->gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, (GLsizei)width, (GLsizei)height);
    g->gl.BindFramebuffer(GL_FRAMEBUFFER, r->framebuffer);
    g->gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, r->renderbuffer);
    if (g->gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
        return 0;
    r->width = 0; /* to be made again */
    return pupil_refuse(why, "the driver has no framebuffer of %lux%lu pixels", (unsigned long)width,
                        (unsigned long)height);
}

int gles_engine_draw(gles_engine *g, const pupil_curve *curve, const pupil_gles_target *target, pupil_why *why)
{
    const int error = pupil_gles_map(&g->gles, curve, target);
    if (g->is_shared)
        g->gl.Finish(); /* its buffer goes back to the camera, which overwrites it */
    return error ? say(why, error, "mapping") : 0;
}

static void pack(const unsigned char *rgba, const pupil_image *rgb8)
{
    for (uint32_t y = 0; y < rgb8->height; y++) {
        unsigned char *to = pupil_image_out_rows(*rgb8, y, 1).data;
        for (uint32_t x = 0; x < rgb8->width; x++, rgba += 4, to += 3)
            memcpy(to, rgba, 3);
    }
}

static int map(void *self, const pupil_t *pupil, const pupil_curve *curve, const pupil_frame *frame,
               const pupil_image *rgb8, pupil_why *why)
{
    (void)pupil, (void)frame; /* the GPU has both since it metered the frame */
    gles_engine *g = self;
    const int whole = rgb8->width == g->config.width && rgb8->height == g->config.height;
    gles_room *room = &g->room[whole ? PICTURE : SMALL];
    if (make_room(g, room, rgb8->width, rgb8->height, why))
        return -1;
    const pupil_gles_target target = {.framebuffer = room->framebuffer,
                                      .width = rgb8->width,
                                      .height = rgb8->height,
                                      .top_first = 1,
                                      .fit = PUPIL_GLES_STRETCH};
    if (gles_engine_draw(g, curve, &target, why))
        return -1;
    g->gl.BindFramebuffer(GL_FRAMEBUFFER, room->framebuffer);
    g->gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    g->gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    g->gl.ReadPixels(0, 0, (GLsizei)rgb8->width, (GLsizei)rgb8->height, GL_RGBA, GL_UNSIGNED_BYTE, g->rgba);
    const GLenum error = g->gl.GetError();
    if (error)
        return pupil_refuse(why, "reading the picture back: OpenGL ES error 0x%x", (unsigned)error);
    pack(g->rgba, rgb8);
    return 0;
}

const frame_engine_ops gles_engine_ops = {.meter = meter, .map = map};

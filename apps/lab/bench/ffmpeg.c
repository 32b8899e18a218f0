/* ffmpeg's filters: tonemap and zscale on the CPU, and libplacebo, which also runs on the CPU: its Vulkan is Mesa's
 * llvmpipe. */
#include <stdio.h>
#include <stdlib.h>

#include <libavfilter/avfilter.h>
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
#include <libavutil/hwcontext.h>
#include <libavutil/imgutils.h>
#include <libavutil/log.h>
#include <libavutil/mastering_display_metadata.h>

#include "peers.h"
#include "refuse.h"

typedef struct chain {
    AVFilterGraph *graph;
    AVFilterContext *source, *sink;
    AVBufferRef *device;
    AVFrame *in, *out;
    int failed;
} chain;

static void close_chain(void *state)
{
    chain *c = state;
    av_frame_free(&c->out);
    av_frame_free(&c->in);
    avfilter_graph_free(&c->graph);
    av_buffer_unref(&c->device);
    free(c);
}

/* libplacebo maps only what it takes for HDR: linear light with a mastering peak above a display's white. */
static int tag(AVFrame *f)
{
    AVMasteringDisplayMetadata *m = av_mastering_display_metadata_create_side_data(f);
    f->color_range = AVCOL_RANGE_JPEG;
    f->color_primaries = AVCOL_PRI_BT709;
    f->color_trc = AVCOL_TRC_LINEAR;
    f->colorspace = AVCOL_SPC_RGB;
    if (!m)
        return -1;
    m->has_luminance = 1;
    m->min_luminance = av_make_q(1, 1000);
    m->max_luminance = av_make_q(1000, 1);
    return 0;
}

static int fill(AVFrame *f, const float *rgba, uint32_t width, uint32_t height)
{
    static const int plane_of[3] = {2, 0, 1}; /* GBR */
    f->format = AV_PIX_FMT_GBRPF32LE;
    f->width = (int)width;
    f->height = (int)height;
    f->sample_aspect_ratio = av_make_q(1, 1);
    if (av_frame_get_buffer(f, 0) || tag(f))
        return -1;
    for (int k = 0; k < 3; k++)
        for (uint32_t y = 0; y < height; y++) {
            const uint8_t *line = f->data[plane_of[k]] + (ptrdiff_t)y * f->linesize[plane_of[k]];
            for (uint32_t x = 0; x < width; x++)
                ((float *)(uintptr_t)line)[x] = rgba[4 * ((size_t)y * width + x) + (size_t)k];
        }
    return 0;
}

static int configure(chain *c, const char *filters)
{
    char arguments[160];
    AVFilterInOut *outputs = avfilter_inout_alloc(), *inputs = avfilter_inout_alloc();
    snprintf(arguments, sizeof arguments, "video_size=%dx%d:pix_fmt=%d:time_base=1/30:pixel_aspect=1/1", c->in->width,
             c->in->height, (int)AV_PIX_FMT_GBRPF32LE);
    c->graph->nb_threads = 1;
    int failed =
        !outputs || !inputs ||
        avfilter_graph_create_filter(&c->source, avfilter_get_by_name("buffer"), "in", arguments, NULL, c->graph) < 0 ||
        avfilter_graph_create_filter(&c->sink, avfilter_get_by_name("buffersink"), "out", NULL, NULL, c->graph) < 0;
    if (!failed) {
        *outputs = (AVFilterInOut){av_strdup("in"), c->source, 0, NULL};
        *inputs = (AVFilterInOut){av_strdup("out"), c->sink, 0, NULL};
        failed = avfilter_graph_parse_ptr(c->graph, filters, &inputs, &outputs, NULL) < 0;
        for (unsigned i = 0; !failed && c->device && i < c->graph->nb_filters; i++) {
            c->graph->filters[i]->hw_device_ctx = av_buffer_ref(c->device);
            failed = !c->graph->filters[i]->hw_device_ctx;
        }
        failed = failed || avfilter_graph_config(c->graph, NULL) < 0;
    }
    avfilter_inout_free(&outputs);
    avfilter_inout_free(&inputs);
    return failed;
}

static void run_chain(void *state)
{
    chain *c = state;
    av_frame_unref(c->out);
    c->in->pts++;
    if (av_buffersrc_add_frame_flags(c->source, c->in, AV_BUFFERSRC_FLAG_KEEP_REF) < 0 ||
        av_buffersink_get_frame(c->sink, c->out) < 0)
        c->failed = 1;
}

/* Opens a chain and tests it with one frame; `device` NULL: none. */
static chain *open_chain(const char *filters, AVBufferRef *device, const float *rgba, uint32_t width, uint32_t height,
                         pupil_why *why)
{
    chain *c = calloc(1, sizeof *c);
    if (!c) {
        pupil_refuse(why, "not enough memory");
        return NULL;
    }
    c->device = device;
    c->graph = avfilter_graph_alloc();
    c->in = av_frame_alloc();
    c->out = av_frame_alloc();
    if (!c->graph || !c->in || !c->out || fill(c->in, rgba, width, height))
        pupil_refuse(why, "not enough memory");
    else if (configure(c, filters))
        pupil_refuse(why, "this libavfilter cannot run %s", filters);
    else {
        run_chain(c);
        if (!c->failed)
            return c;
        pupil_refuse(why, "no frame came out of %s", filters);
    }
    close_chain(c);
    return NULL;
}

/* The green bytes of planar GBR or of RGBA. */
static double mean_of(const void *state)
{
    const chain *c = state;
    const AVFrame *f = c->out;
    const int step = f->format == AV_PIX_FMT_RGBA ? 4 : 1;
    double sum = 0.0;
    if (c->failed || !f->data[0])
        return -1.0;
    for (int y = 0; y < f->height; y++)
        for (int x = 0; x < f->width; x++)
            sum += f->data[0][(ptrdiff_t)y * f->linesize[0] + x * step + (step == 4)];
    return sum / f->width / f->height;
}

/* tonemap has no mean; it takes the peak from the frame's mastering display. */
#define TO_SRGB "zscale=tin=linear:t=iec61966-2-1:pin=bt709:p=bt709:min=gbr:m=gbr:rin=full:r=full,format=gbrp"

static void *open_usual(const float *rgba, uint32_t width, uint32_t height, pupil_why *why)
{
    av_log_set_level(AV_LOG_QUIET);
    return open_chain("tonemap=reinhard," TO_SRGB ",format=rgba", NULL, rgba, width, height, why);
}

static void *open_least(const float *rgba, uint32_t width, uint32_t height, pupil_why *why)
{
    av_log_set_level(AV_LOG_QUIET);
    return open_chain("tonemap=reinhard:desat=0," TO_SRGB, NULL, rgba, width, height, why);
}

static void *open_libplacebo(const float *rgba, uint32_t width, uint32_t height, pupil_why *why)
{
    AVBufferRef *device = NULL;
    av_log_set_level(AV_LOG_QUIET);
    setenv("LP_NUM_THREADS", "1", 1); /* read by llvmpipe: threads that rasterise */
    if (av_hwdevice_ctx_create(&device, AV_HWDEVICE_TYPE_VULKAN, "llvmpipe", NULL, 0) < 0) {
        pupil_refuse(why, "no Vulkan on the CPU here (Mesa's llvmpipe, of mesa-vulkan-drivers)");
        return NULL;
    }
    return open_chain("hwupload,libplacebo=tonemapping=reinhard:color_trc=iec61966-2-1:dithering=none:format=rgba,"
                      "hwdownload,format=rgba",
                      device, rgba, width, height, why);
}

const bench_peer bench_peer_ffmpeg = {
    "ffmpeg",   "rgba8",   "tonemap=reinhard, zscale to sRGB, RGBA8; planar floats in: no metering, the peak is given",
    open_usual, run_chain, mean_of,
    close_chain};
const bench_peer bench_peer_ffmpeg_least = {
    "ffmpeg-min", "gbrp8",   "the same with desat=0, and 8-bit planes out: the least that these filters can do",
    open_least,   run_chain, mean_of,
    close_chain};
const bench_peer bench_peer_libplacebo = {
    "libplacebo",    "rgba8",   "its filter on Mesa's llvmpipe: meters peak and mean, own tone mapping; made for GPUs",
    open_libplacebo, run_chain, mean_of,
    close_chain};

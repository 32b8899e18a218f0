#include "video_sound.h"

#include <stdlib.h>
#include <string.h>

#include "refuse.h"
#include "video_format.h"
#include "video_io.h"

#define NS ((AVRational){1, 1000000000})

/* Only sound is decoded, and only to identify it. */
#define MOST_PIXELS (1 << 26)

struct pupil_video_sound {
    pupil_video_io io;
    AVFormatContext *from, *to;
    AVPacket *packet;
    unsigned streams;
    int *stream;      /* for each stream of `from`, the index in `to`; -1: not copied */
    int64_t begin_ns; /* the time in `from` at which the video begins */
    int has_packet, ended;
    int error; /* libav's code: the rest cannot be read; 0: it can, or has ended */
};

void pupil_video_sound_close(pupil_video_sound *s)
{
    if (!s)
        return;
    av_packet_free(&s->packet);
    avformat_close_input(&s->from);
    pupil_video_io_close(&s->io);
    free(s->stream);
    free(s);
}

/* A stream with the same coding; NULL: no memory. */
static AVStream *add_to(AVFormatContext *muxer, const AVStream *from)
{
    AVStream *to = avformat_new_stream(muxer, NULL);
    if (!to || avcodec_parameters_copy(to->codecpar, from->codecpar) < 0)
        return NULL;
    to->codecpar->codec_tag = 0; /* that of the other format */
    to->time_base = from->time_base;
    return to;
}

/* Whether a format's writer takes such a stream. Its list of codecs lacks some that it takes, and has some that it
 * refuses when the header is written. So this writes a header to memory and discards it. */
static int takes(const AVOutputFormat *format, const AVStream *from)
{
    AVFormatContext *trial = NULL;
    uint8_t *bytes = NULL;
    int taken = 0;
    if (avformat_alloc_output_context2(&trial, format, NULL, NULL) < 0)
        return 0;
    if (add_to(trial, from) && avio_open_dyn_buf(&trial->pb) >= 0) {
        taken = avformat_write_header(trial, NULL) >= 0;
        avio_close_dyn_buf(trial->pb, &bytes);
        av_free(bytes);
    }
    avformat_free_context(trial);
    return taken;
}

/* Adds a stream with the same coding to the muxer; -1: its format cannot hold it. */
static int add(pupil_video_sound *s, const AVStream *from, pupil_why *why)
{
    if (!takes(s->to->oformat, from)) {
        pupil_refuse(why, "%s has no place for %s", s->to->oformat->name, avcodec_get_name(from->codecpar->codec_id));
        if (takes(av_guess_format("matroska", NULL, NULL), from))
            pupil_refuse_add(why, "; a .mkv has");
        return -1;
    }
    AVStream *to = add_to(s->to, from);
    if (!to) {
        pupil_refuse(why, "not enough memory");
        return -1;
    }
    to->disposition = from->disposition;
    av_dict_copy(&to->metadata, from->metadata, 0);
    return to->index;
}

static int open_streams(pupil_video_sound *s, pupil_why *why)
{
    const unsigned count = s->streams = s->from->nb_streams;
    int copied = 0;
    s->stream = malloc((count ? count : 1) * sizeof *s->stream);
    if (!s->stream)
        pupil_refuse(why, "not enough memory");
    for (unsigned i = 0; s->stream && i < count; i++) {
        AVStream *from = s->from->streams[i];
        s->stream[i] = from->codecpar->codec_type == AVMEDIA_TYPE_AUDIO ? add(s, from, why) : -1;
        copied += s->stream[i] >= 0;
        if (s->stream[i] < 0)
            from->discard = AVDISCARD_ALL;
    }
    return copied;
}

pupil_video_sound *pupil_video_sound_open(AVFormatContext *muxer, const pupil_sink_sound *of, pupil_why *why)
{
    pupil_video_sound *s = calloc(1, sizeof *s);
    why->text[0] = 0;
    if (!s || !(s->packet = av_packet_alloc())) {
        pupil_refuse(why, "not enough memory");
        free(s);
        return NULL;
    }
    s->to = muxer;
    s->begin_ns = of->begin_ns;
    if (pupil_video_io_open(&s->io, of->path, why) == 0 && pupil_video_format_open(&s->from, &s->io, why) == 0 &&
        pupil_video_format_look(s->from, MOST_PIXELS, why) == 0 && open_streams(s, why))
        return s;
    pupil_video_sound_close(s);
    return NULL;
}

/* The next packet that is copied, with its time in the video; 0 at the end. */
static int next(pupil_video_sound *s)
{
    while (!s->ended && !s->has_packet) {
        AVPacket *p = s->packet;
        const int code = av_read_frame(s->from, p);
        if (code < 0) { /* the end, or damage: what comes before it is copied */
            s->error = code == AVERROR(ENOMEM) ? code : AVERROR(s->io.error);
            s->ended = 1;
            break;
        }
        const unsigned i = (unsigned)p->stream_index;
        if (i < s->streams && s->stream[i] >= 0 && p->pts != AV_NOPTS_VALUE) { /* streams may come later */
            const int64_t shift = av_rescale_q(s->begin_ns, NS, s->from->streams[i]->time_base);
            p->pts -= shift;
            p->dts -= p->dts != AV_NOPTS_VALUE ? shift : 0;
            s->has_packet = p->pts + p->duration >= 0;
        }
        if (!s->has_packet)
            av_packet_unref(p);
    }
    return s->has_packet;
}

int pupil_video_sound_write(pupil_video_sound *s, int64_t before_ns)
{
    while (s && next(s)) {
        AVPacket *p = s->packet;
        const AVRational base = s->from->streams[p->stream_index]->time_base;
        if (av_compare_ts(p->pts, base, before_ns, NS) >= 0)
            return 0;
        p->stream_index = s->stream[p->stream_index];
        p->pos = -1;
        av_packet_rescale_ts(p, base, s->to->streams[p->stream_index]->time_base);
        s->has_packet = 0;
        const int code = av_interleaved_write_frame(s->to, p); /* it takes the packet */
        if (code < 0)
            return code;
    }
    return s ? s->error : 0;
}

#include "video_damage.h"

#include <stdio.h>
#include <string.h>

/* The field that carries a packet's number to its frame: libav renamed it in FFmpeg 6. */
#if LIBAVCODEC_VERSION_MAJOR < 60
static void number(AVCodecContext *codec, AVPacket *packet, int64_t n)
{
    (void)packet;
    codec->reordered_opaque = n;
}

static int64_t number_of(const AVFrame *frame)
{
    return frame->reordered_opaque;
}
#else
static void number(AVCodecContext *codec, AVPacket *packet, int64_t n)
{
    (void)codec;
    if (packet)
        packet->opaque = (void *)(intptr_t)n;
}

static int64_t number_of(const AVFrame *frame)
{
    return (intptr_t)frame->opaque;
}
#define COPIES_OPAQUE AV_CODEC_FLAG_COPY_OPAQUE
#endif
#ifndef COPIES_OPAQUE
#define COPIES_OPAQUE 0
#endif

void pupil_video_damage_begin(pupil_video_damage *d, AVCodecContext *codec)
{
    codec->flags |= COPIES_OPAQUE;
    pupil_video_words_of(codec, &d->words);
}

/* Keeps the first message about a packet. */
static void suspect(pupil_video_damage *d, int64_t packet, const char *text)
{
    const int n = d->suspects;
    if (n && d->suspect[n - 1].packet == packet)
        return;
    if (n == PUPIL_VIDEO_SUSPECTS) /* the caller has asked for those left over; never so many at once */
        return;
    d->suspect[n].packet = packet;
    snprintf(d->suspect[n].text, sizeof d->suspect[n].text, "%s", text);
    d->suspects++;
}

void pupil_video_damage_of_next(pupil_video_damage *d, const char *text)
{
    if (*text)
        suspect(d, d->packet + 1, text);
}

static void listen(pupil_video_damage *d)
{
    char text[256];
    if (pupil_video_words_take(&d->words, text))
        suspect(d, d->packet, text);
}

int pupil_video_damage_send(pupil_video_damage *d, AVCodecContext *codec, AVPacket *packet)
{
    number(codec, packet, d->packet + 1);
    const int code = avcodec_send_packet(codec, packet);
    if (code == AVERROR(EAGAIN))
        number(codec, packet, d->packet); /* the one before is still to be decoded */
    else if (packet)
        d->packet++;
    listen(d);
    return code;
}

int pupil_video_damage_receive(pupil_video_damage *d, AVCodecContext *codec, AVFrame *frame)
{
    const int code = avcodec_receive_frame(codec, frame);
    listen(d);
    return code;
}

static int place_of(const pupil_video_damage *d, int64_t packet)
{
    int i = d->suspects - 1;
    while (i >= 0 && d->suspect[i].packet != packet)
        i--;
    return i;
}

/* Its text; 1, or -1 where it has been told. */
static int take(pupil_video_damage *d, int i, char text[256])
{
    const int told = d->suspect[i].told;
    memcpy(text, d->suspect[i].text, sizeof d->suspect[i].text);
    d->suspects--;
    memmove(&d->suspect[i], &d->suspect[i + 1], (size_t)(d->suspects - i) * sizeof d->suspect[0]);
    return told ? -1 : 1;
}

int pupil_video_damage_of_frame(pupil_video_damage *d, const AVFrame *frame, char text[256])
{
    const int i = place_of(d, number_of(frame));
    return i < 0 ? 0 : take(d, i, text);
}

void pupil_video_damage_refused(pupil_video_damage *d, char text[256])
{
    suspect(d, d->packet, "");
    const int i = place_of(d, d->packet);
    text[0] = 0;
    if (i < 0)
        return;
    memcpy(text, d->suspect[i].text, sizeof d->suspect[i].text);
    d->suspect[i].told = 1;
}

int pupil_video_damage_left(pupil_video_damage *d, int at_end, char text[256])
{
    int found = 0;
    while (found != 1 && d->suspects && (at_end || d->suspect[0].packet + PUPIL_VIDEO_SUSPECTS <= d->packet))
        found = take(d, 0, text);
    return found == 1;
}

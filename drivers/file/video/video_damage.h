/* drivers/file/video/video_damage.h: which frames a decoder was unhappy with. Decoders cover up what is damaged, most
 * of them mark nothing, and frames come out later than their packets go in and in another order. So each packet has a
 * number, which its frame brings along, and what libav logs as an error while a packet is decoded is kept under it.
 *
 * Threads: one thread at a time on an object; the decoder may have threads of its own.
 */
#ifndef PUPIL_DRIVERS_FILE_VIDEO_VIDEO_DAMAGE_H
#define PUPIL_DRIVERS_FILE_VIDEO_VIDEO_DAMAGE_H

#include "video_io.h"

/* Packets that can wait for their frames: twice as many as the decoders of H.264 and HEVC hold back (16). */
#define PUPIL_VIDEO_SUSPECTS 32

typedef struct pupil_video_suspect {
    int64_t packet;
    int told; /* its frame, should it come, is left out without another word */
    char text[256];
} pupil_video_suspect;

typedef struct pupil_video_damage {
    pupil_video_words words;
    int64_t packet; /* the number of the last one that the decoder took */
    pupil_video_suspect suspect[PUPIL_VIDEO_SUSPECTS];
    int suspects; /* the first so many, by number */
} pupil_video_damage;

/* Before the codec is opened, and with the object where it stays. */
void pupil_video_damage_begin(pupil_video_damage *damage, AVCodecContext *codec);

/* What demuxing a packet was unhappy with, before the packet is sent. */
void pupil_video_damage_of_next(pupil_video_damage *damage, const char *text);

/* avcodec_send_packet, avcodec_receive_frame. */
int pupil_video_damage_send(pupil_video_damage *damage, AVCodecContext *codec, AVPacket *packet);
int pupil_video_damage_receive(pupil_video_damage *damage, AVCodecContext *codec, AVFrame *frame);

/* What there is to say of a frame's packet: 1 and a text; 0: nothing; -1: it has been told already. */
int pupil_video_damage_of_frame(pupil_video_damage *damage, const AVFrame *frame, char text[256]);

/* The decoder refused the packet that was last sent, which is now told. A text, or "". */
void pupil_video_damage_refused(pupil_video_damage *damage, char text[256]);

/* 1 and a text of a packet whose frame does not come any more: it has waited too long, or (at_end) all are out. */
int pupil_video_damage_left(pupil_video_damage *damage, int at_end, char text[256]);

#endif

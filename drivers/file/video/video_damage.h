/* drivers/file/video/video_damage.h: which frames a decoder reported errors for. Decoders conceal damage, and most mark
 * nothing. Frames come out later than their packets go in, and in another order. So each packet has a number, which its
 * frame carries, and errors that libav logs while a packet is decoded are kept under it.
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
    int told; /* its frame, should it come, is dropped without another message */
    char text[256];
} pupil_video_suspect;

typedef struct pupil_video_damage {
    pupil_video_words words;
    int64_t packet; /* the number of the last one that the decoder took */
    pupil_video_suspect suspect[PUPIL_VIDEO_SUSPECTS];
    int suspects; /* how many are used, in the order of their numbers */
} pupil_video_damage;

/* Call it before the codec is opened; the object must not move afterwards. */
void pupil_video_damage_begin(pupil_video_damage *damage, AVCodecContext *codec);

/* Notes an error of demuxing a packet, before the packet is sent. */
void pupil_video_damage_of_next(pupil_video_damage *damage, const char *text);

/* avcodec_send_packet, avcodec_receive_frame. */
int pupil_video_damage_send(pupil_video_damage *damage, AVCodecContext *codec, AVPacket *packet);
int pupil_video_damage_receive(pupil_video_damage *damage, AVCodecContext *codec, AVFrame *frame);

/* What there is to say of a frame's packet: 1 and a text; 0: nothing; -1: it has been told already. */
int pupil_video_damage_of_frame(pupil_video_damage *damage, const AVFrame *frame, char text[256]);

/* The decoder refused the packet that was last sent, which is now told. A text, or "". */
void pupil_video_damage_refused(pupil_video_damage *damage, char text[256]);

/* 1 and the text of a packet whose frame will not come: it has waited too long, or (at_end) all frames are out. */
int pupil_video_damage_left(pupil_video_damage *damage, int at_end, char text[256]);

#endif

/* tests/nth_call/nth_media.c: functions of the libraries for files and video that may fail: mostly because there is no
 * memory, or the disk is full. */
#include "nth_call.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <openexr.h>
#include <png.h>

#define NO_MEMORY AVERROR(ENOMEM)
#define NO_SPACE  AVERROR(ENOSPC)

/* --- libav --- */
NTH_CALL(av_packet_alloc, AVPacket *, NULL, ENOMEM, (void), ())
NTH_CALL(av_frame_alloc, AVFrame *, NULL, ENOMEM, (void), ())
NTH_CALL(av_malloc, void *, NULL, ENOMEM, (size_t bytes), (bytes))
NTH_CALL(av_calloc, void *, NULL, ENOMEM, (size_t count, size_t bytes), (count, bytes))
NTH_CALL(av_strdup, char *, NULL, ENOMEM, (const char *text), (text))
NTH_CALL(av_buffer_alloc, AVBufferRef *, NULL, ENOMEM, (size_t bytes), (bytes))
NTH_CALL(av_buffer_ref, AVBufferRef *, NULL, ENOMEM, (const AVBufferRef *of), (of))
NTH_CALL(av_frame_get_buffer, int, NO_MEMORY, ENOMEM, (AVFrame * frame, int align), (frame, align))
NTH_CALL(av_frame_make_writable, int, NO_MEMORY, ENOMEM, (AVFrame * frame), (frame))
NTH_CALL(avcodec_alloc_context3, AVCodecContext *, NULL, ENOMEM, (const AVCodec *codec), (codec))
NTH_CALL(avcodec_open2, int, NO_MEMORY, ENOMEM, (AVCodecContext * c, const AVCodec *of, AVDictionary **with),
         (c, of, with))
NTH_CALL(avcodec_parameters_to_context, int, NO_MEMORY, ENOMEM, (AVCodecContext * c, const AVCodecParameters *of),
         (c, of))
NTH_CALL(avcodec_parameters_from_context, int, NO_MEMORY, ENOMEM, (AVCodecParameters * p, const AVCodecContext *of),
         (p, of))
NTH_CALL(avcodec_parameters_copy, int, NO_MEMORY, ENOMEM, (AVCodecParameters * p, const AVCodecParameters *of), (p, of))
NTH_CALL(avcodec_send_packet, int, NO_MEMORY, ENOMEM, (AVCodecContext * c, const AVPacket *packet), (c, packet))
NTH_CALL(avcodec_send_frame, int, NO_MEMORY, ENOMEM, (AVCodecContext * c, const AVFrame *frame), (c, frame))
NTH_CALL(avcodec_receive_frame, int, NO_MEMORY, ENOMEM, (AVCodecContext * c, AVFrame *frame), (c, frame))
NTH_CALL(avcodec_receive_packet, int, NO_MEMORY, ENOMEM, (AVCodecContext * c, AVPacket *packet), (c, packet))
NTH_CALL(avformat_alloc_context, AVFormatContext *, NULL, ENOMEM, (void), ())
NTH_CALL(avformat_alloc_output_context2, int, NO_MEMORY, ENOMEM,
         (AVFormatContext * *made, const AVOutputFormat *format, const char *name, const char *path),
         (made, format, name, path))
NTH_CALL(avformat_find_stream_info, int, NO_MEMORY, ENOMEM, (AVFormatContext * f, AVDictionary **with), (f, with))
NTH_CALL(avformat_new_stream, AVStream *, NULL, ENOMEM, (AVFormatContext * f, const AVCodec *codec), (f, codec))
NTH_CALL(avformat_write_header, int, NO_SPACE, ENOSPC, (AVFormatContext * f, AVDictionary **with), (f, with))
NTH_CALL(av_read_frame, int, NO_MEMORY, ENOMEM, (AVFormatContext * f, AVPacket *packet), (f, packet))
NTH_CALL(av_write_frame, int, NO_SPACE, ENOSPC, (AVFormatContext * f, AVPacket *packet), (f, packet))
NTH_CALL(av_interleaved_write_frame, int, NO_SPACE, ENOSPC, (AVFormatContext * f, AVPacket *packet), (f, packet))
NTH_CALL(avio_alloc_context, AVIOContext *, NULL, ENOMEM,
         (unsigned char *room, int bytes, int writes, void *given, int (*read)(void *, uint8_t *, int),
          int (*write)(void *, uint8_t *, int), int64_t (*seek)(void *, int64_t, int)),
         (room, bytes, writes, given, read, write, seek))
NTH_CALL(avio_open, int, NO_SPACE, ENOSPC, (AVIOContext * *made, const char *path, int flags), (made, path, flags))
NTH_CALL(avio_open_dyn_buf, int, NO_MEMORY, ENOMEM, (AVIOContext * *made), (made))

int __real_avformat_open_input(AVFormatContext **f, const char *path, const AVInputFormat *is, AVDictionary **with);
int __wrap_avformat_open_input(AVFormatContext **f, const char *path, const AVInputFormat *is, AVDictionary **with);
int __wrap_avformat_open_input(AVFormatContext **f, const char *path, const AVInputFormat *is, AVDictionary **with)
{
    if (!nth_fails("avformat_open_input", ENOMEM))
        return __real_avformat_open_input(f, path, is, with);
    avformat_free_context(*f);
    *f = NULL;
    return NO_MEMORY;
}

int __real_av_write_trailer(AVFormatContext *f);
int __wrap_av_write_trailer(AVFormatContext *f);
int __wrap_av_write_trailer(AVFormatContext *f)
{
    const int result = __real_av_write_trailer(f);
    return nth_fails("av_write_trailer", ENOSPC) ? NO_SPACE : result;
}

int __real_avio_closep(AVIOContext **io);
int __wrap_avio_closep(AVIOContext **io);
int __wrap_avio_closep(AVIOContext **io)
{
    const int result = __real_avio_closep(io);
    return nth_fails("avio_closep", ENOSPC) ? NO_SPACE : result;
}

/* --- JSON --- */
NTH_CALL(cJSON_CreateObject, cJSON *, NULL, ENOMEM, (void), ())
NTH_CALL(cJSON_CreateArray, cJSON *, NULL, ENOMEM, (void), ())
NTH_CALL(cJSON_CreateRaw, cJSON *, NULL, ENOMEM, (const char *text), (text))
NTH_CALL(cJSON_CreateString, cJSON *, NULL, ENOMEM, (const char *text), (text))
NTH_CALL(cJSON_AddNumberToObject, cJSON *, NULL, ENOMEM, (cJSON * to, const char *name, double value),
         (to, name, value))
NTH_CALL(cJSON_AddStringToObject, cJSON *, NULL, ENOMEM, (cJSON * to, const char *name, const char *value),
         (to, name, value))
NTH_CALL(cJSON_AddItemToArray, cJSON_bool, 0, ENOMEM, (cJSON * to, cJSON *item), (to, item))
NTH_CALL(cJSON_AddItemToObject, cJSON_bool, 0, ENOMEM, (cJSON * to, const char *name, cJSON *item), (to, name, item))
NTH_CALL(cJSON_Print, char *, NULL, ENOMEM, (const cJSON *item), (item))

/* --- PNG --- */
NTH_CALL(png_create_read_struct, png_structp, NULL, ENOMEM,
         (const char *version, void *given, png_error_ptr error, png_error_ptr warning),
         (version, given, error, warning))
NTH_CALL(png_create_write_struct, png_structp, NULL, ENOMEM,
         (const char *version, void *given, png_error_ptr error, png_error_ptr warning),
         (version, given, error, warning))
NTH_CALL(png_create_info_struct, png_infop, NULL, ENOMEM, (png_const_structrp png), (png))

/* --- OpenEXR --- */
#define NO_EXR EXR_ERR_OUT_OF_MEMORY
NTH_CALL(exr_start_read, int, NO_EXR, ENOMEM, (exr_context_t * made, const char *name, const void *with),
         (made, name, with))
NTH_CALL(exr_get_user_data, int, NO_EXR, ENOMEM, (exr_const_context_t of, void **user), (of, user))
NTH_CALL(exr_get_count, int, NO_EXR, ENOMEM, (exr_const_context_t of, int *count), (of, count))
NTH_CALL(exr_get_storage, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, void *to), (of, part, to))
NTH_CALL(exr_get_data_window, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, void *to), (of, part, to))
NTH_CALL(exr_get_display_window, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, void *to), (of, part, to))
NTH_CALL(exr_get_channels, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, void *to), (of, part, to))
NTH_CALL(exr_get_compression, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, void *to), (of, part, to))
NTH_CALL(exr_get_scanlines_per_chunk, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, int *to), (of, part, to))
NTH_CALL(exr_decoding_initialize, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, const void *chunk, void *to),
         (of, part, chunk, to))
NTH_CALL(exr_decoding_update, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, const void *chunk, void *to),
         (of, part, chunk, to))
NTH_CALL(exr_decoding_run, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, void *to), (of, part, to))
NTH_CALL(exr_decoding_choose_default_routines, int, NO_EXR, ENOMEM, (exr_const_context_t of, int part, void *to),
         (of, part, to))

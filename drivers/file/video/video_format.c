#include "video_format.h"

#include <string.h>

#include "refuse.h"

const char *pupil_libav_words(int code, char buffer[AV_ERROR_MAX_STRING_SIZE])
{
    if (pupil_video_log_text()[0])
        return pupil_video_log_text();
    av_strerror(code, buffer, AV_ERROR_MAX_STRING_SIZE);
    return buffer;
}

static int asks_to_stop(void *opaque)
{
    const pupil_video_io *io = opaque;
    return io->stop && io->stop();
}

/* ISO/IEC 23008-12, 10.2: the first bytes of a still of HEVC, as telephones store their photographs. AVIF is read. */
static int is_heic(AVIOContext *io)
{
    uint8_t head[12];
    return avio_seek(io, 0, SEEK_SET) == 0 && avio_read(io, head, sizeof head) == (int)sizeof head &&
           memcmp(head + 4, "ftyp", 4) == 0 && (memcmp(head + 8, "hei", 3) == 0 || memcmp(head + 8, "mif1", 4) == 0);
}

int pupil_video_format_open(AVFormatContext **format, pupil_video_io *io, pupil_why *why)
{
    char words[AV_ERROR_MAX_STRING_SIZE];
    *format = avformat_alloc_context();
    if (!*format)
        return pupil_refuse(why, "not enough memory");
    (*format)->pb = io->context;
    (*format)->flags |= AVFMT_FLAG_CUSTOM_IO;
    (*format)->interrupt_callback = (AVIOInterruptCB){asks_to_stop, io};
    /* No protocol has this name, so a playlist opens nothing. */
    (*format)->protocol_whitelist = av_strdup("none");
    /* Probed by content, not by name: by name libav accepts any text as a video (its "tty" format). */
    pupil_video_log_clear();
    const int code = avformat_open_input(format, "", NULL, NULL);
    if (code < 0 && io->fd >= 0 && !io->read && !io->error)
        return pupil_refuse(why, "nothing came; an image or a video was expected");
    if (code < 0 && !io->error && is_heic(io->context))
        return pupil_refuse(why, "a HEIC picture, which the installed libav does not read; convert it first "
                                 "(heif-convert IN.heic OUT.png)");
    if (code < 0)
        return pupil_refuse(why, "not an image or a video that can be read: %s",
                            io->error ? strerror(io->error) : pupil_libav_words(code, words));
    return 0;
}

int pupil_video_format_fits(const AVCodecParameters *parameters, int64_t max_pixels, pupil_why *why)
{
    if ((int64_t)parameters->width * parameters->height <= max_pixels)
        return 0;
    return pupil_refuse(why, "frames of %d x %d pixels; at most %lld pixels can be read", parameters->width,
                        parameters->height, (long long)max_pixels);
}

int pupil_video_format_look(AVFormatContext *format, int64_t max_pixels, pupil_why *why)
{
    char words[AV_ERROR_MAX_STRING_SIZE];
    const unsigned count = format->nb_streams; /* more may come while libav looks */
    /* libav drops the size of frames that are too large */
    for (unsigned i = 0; i < count; i++)
        if (!(format->streams[i]->disposition & AV_DISPOSITION_ATTACHED_PIC) &&
            pupil_video_format_fits(format->streams[i]->codecpar, max_pixels, why))
            return -1;
    AVDictionary **limits = av_calloc(count ? count : 1, sizeof *limits);
    for (unsigned i = 0; limits && i < count; i++)
        av_dict_set_int(&limits[i], "max_pixels", max_pixels, 0);
    pupil_video_log_clear();
    const int code = limits ? avformat_find_stream_info(format, limits) : AVERROR(ENOMEM);
    for (unsigned i = 0; limits && i < count; i++)
        av_dict_free(&limits[i]);
    av_free(limits);
    return code < 0 ? pupil_refuse(why, "not a video that can be read: %s", pupil_libav_words(code, words)) : 0;
}

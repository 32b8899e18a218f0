/* drivers/file/sink/png_sinks.h: display frames into one PNG, or a folder of them. file_sink.h chooses. */
#ifndef PUPIL_DRIVERS_FILE_SINK_PNG_SINKS_H
#define PUPIL_DRIVERS_FILE_SINK_PNG_SINKS_H

#include "sink.h"

int pupil_png_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);
int pupil_folder_sink_open(const char *path, const pupil_sink_options *options, pupil_sink **sink, pupil_why *why);

#endif

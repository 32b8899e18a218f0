/* The plugin: what GStreamer loads. */
#include "elements.h"
#include "frame_numbers.h"

#define PACKAGE "pupil"

static gboolean plugin_init(GstPlugin *plugin)
{
    frame_numbers_register();
    return GST_ELEMENT_REGISTER(pupilae, plugin) && GST_ELEMENT_REGISTER(pupilsrc, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, pupil, "Automatic exposure of cameras and of HDR video",
                  plugin_init, PUPIL_PLUGIN_VERSION, "BSD", "pupil", "libpupil")

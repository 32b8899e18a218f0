#include "source_properties.h"

#include <string.h>

#include "v4l2/format.h"

/* As nvarguscamerasrc has them. */
enum { ANTIBANDING_OFF, ANTIBANDING_AUTO, ANTIBANDING_50, ANTIBANDING_60 };
static const uint32_t mains[] = {0, PUPIL_SENSOR_MAINS_AUTO, 50, 60};

static GType antibanding_type(void)
{
    static gsize type;
    static const GEnumValue values[] = {{ANTIBANDING_OFF, "No lamps of mains", "off"},
                                        {ANTIBANDING_AUTO, "Found in the frames", "auto"},
                                        {ANTIBANDING_50, "50 Hz", "50"},
                                        {ANTIBANDING_60, "60 Hz", "60"},
                                        {0, NULL, NULL}};
    if (g_once_init_enter(&type))
        g_once_init_leave(&type, g_enum_register_static("GstPupilAntibanding", values));
    return type;
}

void source_properties_begin(source_properties *p)
{
    memset(p, 0, sizeof *p);
    p->device = g_strdup("/dev/video0");
    p->format = g_strdup("");
    p->ae = p->awb = TRUE;
    p->camera.mains_hz = PUPIL_SENSOR_MAINS_AUTO;
    picture_properties_begin(&p->picture);
}

void source_properties_end(source_properties *p)
{
    g_free(p->device);
    g_free(p->format);
}

void source_properties_write(const source_properties *p, camera_settings *settings)
{
    *settings = p->camera;
    picture_properties_write(&p->picture, &settings->picture);
    settings->lock = settings->picture.lock;
}

/* "LEAST MOST", of numbers above 0; "" or NULL: 0 0. */
static int read_range(const gchar *text, double unit, double *least, double *most)
{
    gchar *end;
    if (!text || !*text) {
        *least = *most = 0.0;
        return 0;
    }
    const double a = g_ascii_strtod(text, &end);
    if (end == text || (*end != ' ' && *end != ','))
        return -1;
    text = end + 1;
    const double b = g_ascii_strtod(text, &end);
    if (end == text || *end || !(a > 0.0) || !(b >= a) || !(b * unit <= 1e4))
        return -1;
    *least = a * unit;
    *most = b * unit;
    return 0;
}

static gchar *range_text(double least, double most, double unit)
{
    char number[2][G_ASCII_DTOSTR_BUF_SIZE];
    if (!(most > 0.0))
        return g_strdup("");
    g_ascii_formatd(number[0], sizeof number[0], "%.9g", least / unit);
    g_ascii_formatd(number[1], sizeof number[1], "%.9g", most / unit);
    return g_strdup_printf("%s %s", number[0], number[1]);
}

#define MICROSECOND_S 1e-6

static const gchar *set_text(source_properties *p, guint id, const gchar *text)
{
    camera_settings *c = &p->camera;
    switch (id) {
    case SOURCE_DEVICE:
        g_free(p->device);
        p->device = g_strdup(text ? text : "");
        return NULL;
    case SOURCE_SENSOR_FORMAT:
        if (text && *text && !pupil_v4l2_fourcc(text))
            return "a format of V4L2 of four letters, as RG10";
        g_free(p->format);
        p->format = g_strdup(text ? text : "");
        return NULL;
    case SOURCE_EXPOSURE_TIME_RANGE:
        return read_range(text, MICROSECOND_S, &c->exposure_min_s, &c->exposure_max_s)
                   ? "two numbers of microseconds, the shortest and the longest, as \"100 20000\""
                   : NULL;
    default:
        return read_range(text, 1.0, &c->gain_min, &c->gain_max) ? "two factors, as \"1 8\"" : NULL;
    }
}

gboolean source_properties_set(source_properties *p, guint id, const GValue *value, const gchar **refused)
{
    *refused = NULL;
    switch (id) {
    case SOURCE_AE_ENABLE:
        p->ae = g_value_get_boolean(value);
        return TRUE;
    case SOURCE_AWB_ENABLE:
        p->awb = g_value_get_boolean(value);
        return TRUE;
    case SOURCE_AE_ANTIBANDING:
        p->camera.mains_hz = mains[g_value_get_enum(value)];
        return TRUE;
    case SOURCE_DEVICE:
    case SOURCE_SENSOR_FORMAT:
    case SOURCE_EXPOSURE_TIME_RANGE:
    case SOURCE_GAIN_RANGE:
        *refused = set_text(p, id, g_value_get_string(value));
        return TRUE;
    default:
        return picture_properties_set(&p->picture, id, value, refused);
    }
}

gboolean source_properties_get(source_properties *p, guint id, GValue *value)
{
    const camera_settings *c = &p->camera;
    gint choice = ANTIBANDING_OFF;
    switch (id) {
    case SOURCE_AE_ENABLE:
        g_value_set_boolean(value, p->ae);
        return TRUE;
    case SOURCE_AWB_ENABLE:
        g_value_set_boolean(value, p->awb);
        return TRUE;
    case SOURCE_AE_ANTIBANDING:
        while (mains[choice] != c->mains_hz)
            choice++;
        g_value_set_enum(value, choice);
        return TRUE;
    case SOURCE_DEVICE:
        g_value_set_string(value, p->device);
        return TRUE;
    case SOURCE_SENSOR_FORMAT:
        g_value_set_string(value, p->format);
        return TRUE;
    case SOURCE_EXPOSURE_TIME_RANGE:
        g_value_take_string(value, range_text(c->exposure_min_s, c->exposure_max_s, MICROSECOND_S));
        return TRUE;
    case SOURCE_GAIN_RANGE:
        g_value_take_string(value, range_text(c->gain_min, c->gain_max, 1.0));
        return TRUE;
    default:
        return picture_properties_get(&p->picture, id, value);
    }
}

static void install_text(GObjectClass *klass, guint id, const gchar *name, const gchar *nick, const gchar *blurb,
                         const gchar *usual, GParamFlags when)
{
    g_object_class_install_property(
        klass, id, g_param_spec_string(name, nick, blurb, usual, G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | when));
}

void source_properties_install(GObjectClass *klass)
{
    const GParamFlags when_closed = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_READY;
    picture_properties_install(klass);
    install_text(klass, SOURCE_DEVICE, "device", "Device",
                 "The camera: /dev/video0, a number, a part of its name, or libcamera:ID", "/dev/video0",
                 GST_PARAM_MUTABLE_READY);
    install_text(klass, SOURCE_SENSOR_FORMAT, "sensor-format", "Format of the sensor",
                 "What the camera is to send, by V4L2's name: RG10, YUYV; empty: what it is set to", "",
                 GST_PARAM_MUTABLE_READY);
    g_object_class_install_property(
        klass, SOURCE_AE_ENABLE,
        g_param_spec_boolean("ae-enable", "Exposure",
                             "Control exposure time and gain; false: leave the camera's controls alone, the picture's "
                             "level alone follows the light",
                             TRUE, when_closed));
    g_object_class_install_property(
        klass, SOURCE_AWB_ENABLE,
        g_param_spec_boolean("awb-enable", "White balance", "Balance the white of raw frames", TRUE, when_closed));
    install_text(klass, SOURCE_EXPOSURE_TIME_RANGE, "exposure-time-range", "Range of exposure time",
                 "Shortest and longest exposure time in microseconds, as \"100 20000\"; empty: the camera's", "",
                 GST_PARAM_MUTABLE_PLAYING);
    install_text(klass, SOURCE_GAIN_RANGE, "gain-range", "Range of gain",
                 "Smallest and largest gain, as \"1 8\"; empty: the camera's", "", GST_PARAM_MUTABLE_PLAYING);
    g_object_class_install_property(
        klass, SOURCE_AE_ANTIBANDING,
        g_param_spec_enum("ae-antibanding", "Mains", "Exposure times that lamps of this mains frequency do not band",
                          antibanding_type(), ANTIBANDING_AUTO,
                          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_PLAYING));
    gst_type_mark_as_plugin_api(antibanding_type(), (GstPluginAPIFlags)0);
}

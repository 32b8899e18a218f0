/* pupilae: HDR or SDR video in, the picture for a display out.
 *
 * Properties come from any thread: they are kept under the object's lock, and the streaming thread takes them before
 * its next frame. The level is forgotten at a flush, at the start of another stream, where the light is coded in
 * another way, and at a discontinuity with a gap of over a second or back in time. Frames that a leaky queue dropped do
 * not count: adaptation counts seconds. Time is running time, so that it also advances in reverse playback.
 */
#include <gst/video/gstvideofilter.h>
#include <gst/video/video.h>
#include <string.h>

#include "colorimetry.h"
#include "elements.h"
#include "frame_numbers.h"
#include "picture_format.h"
#include "picture_properties.h"
#include "pupil/pupil.h"

GST_DEBUG_CATEGORY_STATIC(pupilae_debug);
#define GST_CAT_DEFAULT pupilae_debug

typedef struct GstPupilAe {
    GstVideoFilter parent;

    /* under the object's lock */
    picture_properties wanted;
    gboolean is_changed;
    pupil_exposure exposure; /* of the last frame */

    /* the streaming thread's */
    pupil_t pupil;
    pupil_config config; /* in use: `wanted` and the stream's colours */
    pupil_coding in, out;
    GstClockTime last; /* running time of the last frame; none: GST_CLOCK_TIME_NONE */
    uint32_t posted;   /* the state of the last message */
    pupil_why refused; /* why the last caps were; "" */
} GstPupilAe;

typedef struct GstPupilAeClass {
    GstVideoFilterClass parent_class;
} GstPupilAeClass;

#define PUPIL_AE(object) ((GstPupilAe *)(void *)(object))

static GType gst_pupil_ae_get_type(void);
G_DEFINE_TYPE(GstPupilAe, gst_pupil_ae, GST_TYPE_VIDEO_FILTER)
GST_ELEMENT_REGISTER_DEFINE(pupilae, "pupilae", GST_RANK_NONE, gst_pupil_ae_get_type())

static GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(PICTURE_CAPS(PICTURE_FORMATS_IN)));
static GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(PICTURE_CAPS(PICTURE_FORMATS_OUT)));

/* --- properties --- */

enum { PROP_STATE = PICTURE_PROPERTIES_END, PROP_METERED_EV, PROP_ADAPTED_EV };

static void set_property(GObject *object, guint id, const GValue *value, GParamSpec *spec)
{
    GstPupilAe *self = PUPIL_AE(object);
    const gchar *refused;
    GST_OBJECT_LOCK(self);
    const gboolean is_known = picture_properties_set(&self->wanted, id, value, &refused);
    self->is_changed = TRUE;
    GST_OBJECT_UNLOCK(self);
    if (!is_known)
        G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
    else
        picture_properties_report(spec, value, refused);
}

static void get_property(GObject *object, guint id, GValue *value, GParamSpec *spec)
{
    GstPupilAe *self = PUPIL_AE(object);
    GST_OBJECT_LOCK(self);
    if (id == PROP_STATE)
        g_value_set_enum(value, (gint)self->exposure.state);
    else if (id == PROP_METERED_EV)
        g_value_set_double(value, self->exposure.metered_ev);
    else if (id == PROP_ADAPTED_EV)
        g_value_set_double(value, self->exposure.adapted_ev);
    else if (!picture_properties_get(&self->wanted, id, value))
        G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
    GST_OBJECT_UNLOCK(self);
}

/* --- the stream --- */

/* The level of all frames so far is forgotten. */
static void forget(GstPupilAe *self)
{
    pupil_reset(&self->pupil);
    self->last = GST_CLOCK_TIME_NONE;
}

/* The properties as they are now, with the colours of the stream. */
static void take_properties(GstPupilAe *self)
{
    pupil_config config;
    GST_OBJECT_LOCK(self);
    const gboolean is_changed = self->is_changed;
    picture_properties_write(&self->wanted, &config);
    self->is_changed = FALSE;
    GST_OBJECT_UNLOCK(self);
    if (!is_changed)
        return;
    config.primaries = self->config.primaries;
    memcpy(config.rgb_to_xyz, self->config.rgb_to_xyz, sizeof config.rgb_to_xyz);
    config.output_primaries = self->config.output_primaries;
    config.nominal_frame_s = self->config.nominal_frame_s;
    self->config = config;
    if (pupil_retune(&self->pupil, &config))
        GST_ERROR_OBJECT(self, "the settings are refused"); /* the properties' ranges are the library's */
}

static gboolean start(GstBaseTransform *base)
{
    GstPupilAe *self = PUPIL_AE(base);
    pupil_config_default(&self->config);
    pupil_init(&self->pupil, &self->config);
    self->last = GST_CLOCK_TIME_NONE;
    self->posted = PUPIL_STATE_EMPTY;
    self->refused.text[0] = 0;
    GST_OBJECT_LOCK(self);
    self->is_changed = TRUE;
    memset(&self->exposure, 0, sizeof self->exposure);
    GST_OBJECT_UNLOCK(self);
    return TRUE;
}

static gboolean set_info(GstVideoFilter *filter, GstCaps *in_caps, GstVideoInfo *in, GstCaps *out_caps,
                         GstVideoInfo *out)
{
    GstPupilAe *self = PUPIL_AE(filter);
    const pupil_coding before = self->in;
    const pupil_config config_before = self->config;
    pupil_why why = {""};
    (void)in_caps, (void)out_caps;
    if (colorimetry_in(in, &self->in, &self->config, &why) || colorimetry_out(out, &self->out, &self->config, &why)) {
        if (strcmp(why.text, self->refused.text) != 0) /* once: caps come again before each buffer */
            GST_ELEMENT_ERROR(self, STREAM, FORMAT, ("%s", why.text), (NULL));
        self->refused = why;
        return FALSE;
    }
    self->refused.text[0] = 0;
    self->config.nominal_frame_s = 1.0 / 30.0;
    if (GST_VIDEO_INFO_FPS_N(in) > 0) /* at most what pupil/config.h takes: a picture in eleven days */
        self->config.nominal_frame_s = MIN((double)GST_VIDEO_INFO_FPS_D(in) / (double)GST_VIDEO_INFO_FPS_N(in), 1e6);
    GST_OBJECT_LOCK(self);
    self->is_changed = TRUE; /* before the next frame */
    GST_OBJECT_UNLOCK(self);
    if (before.light != self->in.light || config_before.primaries != self->config.primaries)
        forget(self);
    return TRUE;
}

static gboolean sink_event(GstBaseTransform *base, GstEvent *event)
{
    /* Both are serialised: no frame is being mapped. */
    if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP || GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START)
        forget(PUPIL_AE(base));
    return GST_BASE_TRANSFORM_CLASS(gst_pupil_ae_parent_class)->sink_event(base, event);
}

/* Running time; the timestamp itself where the stream's segment is not one of time, as appsrc's usually is. Of a buffer
 * without a timestamp: a frame after the last one. */
static GstClockTime time_of(GstPupilAe *self, GstBuffer *buffer)
{
    const GstSegment *segment = &GST_BASE_TRANSFORM(self)->segment;
    GstClockTime time = GST_BUFFER_PTS(buffer);
    if (GST_CLOCK_TIME_IS_VALID(time) && segment->format == GST_FORMAT_TIME)
        time = gst_segment_to_running_time(segment, GST_FORMAT_TIME, time);
    if (GST_CLOCK_TIME_IS_VALID(time))
        return time;
    return GST_CLOCK_TIME_IS_VALID(self->last)
               ? self->last + (GstClockTime)(self->config.nominal_frame_s * (double)GST_SECOND)
               : 0;
}

static gboolean is_break(const GstPupilAe *self, GstBuffer *buffer, GstClockTime time)
{
    return GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT) && GST_CLOCK_TIME_IS_VALID(self->last) &&
           (time < self->last || time - self->last > GST_SECOND);
}

static void post_state(GstPupilAe *self, const pupil_exposure *exposure, GstClockTime time)
{
    if (exposure->state == self->posted)
        return;
    GstStructure *structure = gst_structure_new("pupilae", "running-time", G_TYPE_UINT64, (guint64)time, NULL);
    frame_numbers_write(structure, exposure);
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), structure));
    self->posted = exposure->state;
}

static GstFlowReturn transform_frame(GstVideoFilter *filter, GstVideoFrame *in_frame, GstVideoFrame *out_frame)
{
    GstPupilAe *self = PUPIL_AE(filter);
    const GstClockTime time = time_of(self, in_frame->buffer);
    if (is_break(self, in_frame->buffer, time))
        forget(self);
    take_properties(self);
    const pupil_image_const in = picture_in(in_frame, &self->in);
    const pupil_image out = picture_out(out_frame, &self->out);
    const pupil_frame_info info = {.timestamp_ns = (int64_t)time};
    const int error = pupil_process(&self->pupil, &in, &info, &out);
    if (error) {
        GST_ELEMENT_ERROR(self, STREAM, FAILED, ("a frame is refused: %s", pupil_error_string(error)), (NULL));
        return GST_FLOW_ERROR;
    }
    self->last = time;
    pupil_exposure exposure;
    pupil_get_exposure(&self->pupil, &exposure);
    GST_OBJECT_LOCK(self);
    self->exposure = exposure;
    GST_OBJECT_UNLOCK(self);
    frame_numbers_write(frame_numbers_of(out_frame->buffer), &exposure);
    post_state(self, &exposure, time);
    return GST_FLOW_OK;
}

/* --- caps --- */

/* Removes fields that concern one side alone. */
static GstCaps *transform_caps(GstBaseTransform *base, GstPadDirection direction, GstCaps *caps, GstCaps *filter)
{
    GstCaps *other = gst_caps_copy(caps);
    (void)base, (void)direction;
    for (guint i = 0; i < gst_caps_get_size(other); i++)
        gst_structure_remove_fields(gst_caps_get_structure(other, i), "format", "colorimetry", "chroma-site",
                                    "mastering-display-info", "content-light-level", NULL);
    if (filter) {
        GstCaps *both = gst_caps_intersect_full(filter, other, GST_CAPS_INTERSECT_FIRST);
        gst_caps_unref(other);
        other = both;
    }
    return gst_caps_simplify(other);
}

/* Where downstream has no preference: the input's own format, or RGBA for RGB, or NV12. */
static const gchar *usual_format(const GstCaps *in_caps)
{
    const gchar *name = gst_structure_get_string(gst_caps_get_structure(in_caps, 0), "format");
    const GstVideoFormat format = name ? gst_video_format_from_string(name) : GST_VIDEO_FORMAT_UNKNOWN;
    if (format != GST_VIDEO_FORMAT_UNKNOWN && picture_pixel_out(format) != PUPIL_PIXEL_NONE)
        return name;
    return format != GST_VIDEO_FORMAT_UNKNOWN && GST_VIDEO_FORMAT_INFO_IS_RGB(gst_video_format_get_info(format))
               ? "RGBA"
               : "NV12";
}

static GstCaps *fixate_caps(GstBaseTransform *base, GstPadDirection direction, GstCaps *caps, GstCaps *other)
{
    (void)base;
    other = gst_caps_make_writable(gst_caps_truncate(other));
    if (direction != GST_PAD_SINK || gst_caps_is_empty(other))
        return gst_caps_fixate(other);
    GstStructure *structure = gst_caps_get_structure(other, 0);
    gst_structure_fixate_field_string(structure, "format", usual_format(caps));
    const gchar *name = gst_structure_get_string(structure, "format");
    if (name)
        colorimetry_fixate(structure, gst_video_format_from_string(name));
    return gst_caps_fixate(other);
}

/* --- the class --- */

static void install_properties(GObjectClass *klass)
{
    const GParamFlags result = G_PARAM_READABLE | G_PARAM_STATIC_STRINGS;
    picture_properties_install(klass);
    g_object_class_install_property(klass, PROP_STATE,
                                    g_param_spec_enum("state", "State", "The state after the last frame",
                                                      frame_state_type(), PUPIL_STATE_EMPTY, result));
    g_object_class_install_property(klass, PROP_METERED_EV,
                                    g_param_spec_double("metered-ev", "Metered", "log2 of the last frame's light",
                                                        -G_MAXDOUBLE, G_MAXDOUBLE, 0.0, result));
    g_object_class_install_property(
        klass, PROP_ADAPTED_EV,
        g_param_spec_double("adapted-ev", "Adapted", "log2 of the level", -G_MAXDOUBLE, G_MAXDOUBLE, 0.0, result));
}

static void gst_pupil_ae_class_init(GstPupilAeClass *klass)
{
    GObjectClass *object = G_OBJECT_CLASS(klass);
    GstElementClass *element = GST_ELEMENT_CLASS(klass);
    GstBaseTransformClass *base = GST_BASE_TRANSFORM_CLASS(klass);
    GstVideoFilterClass *filter = GST_VIDEO_FILTER_CLASS(klass);
    GST_DEBUG_CATEGORY_INIT(pupilae_debug, "pupilae", 0, "exposure of HDR video");
    object->set_property = set_property;
    object->get_property = get_property;
    install_properties(object);
    gst_type_mark_as_plugin_api(metering_pattern_type(), (GstPluginAPIFlags)0);
    gst_type_mark_as_plugin_api(frame_state_type(), (GstPluginAPIFlags)0);
    gst_element_class_set_static_metadata(
        element, "Automatic exposure of HDR video", "Filter/Effect/Converter/Video",
        "Maps HDR or SDR video (PQ, HLG, BT.2020) to SDR, with a level that adapts as an eye does", "pupil");
    gst_element_class_add_static_pad_template(element, &sink_template);
    gst_element_class_add_static_pad_template(element, &src_template);
    base->start = start;
    base->sink_event = sink_event;
    base->transform_caps = transform_caps;
    base->fixate_caps = fixate_caps;
    filter->set_info = set_info;
    filter->transform_frame = transform_frame;
}

static void gst_pupil_ae_init(GstPupilAe *self)
{
    picture_properties_begin(&self->wanted);
    self->config = self->wanted.config;
    pupil_init(&self->pupil, &self->config);
    self->last = GST_CLOCK_TIME_NONE;
}

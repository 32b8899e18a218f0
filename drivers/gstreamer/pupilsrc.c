/* pupilsrc: a camera whose exposure pupil controls, as a source of pictures.
 *
 * The camera is opened when caps are negotiated, because they say its size and rate, and closed when the element goes
 * to READY, which gives its controls back. Properties come from any thread: they are kept under the object's lock, and
 * the streaming thread takes them before its next frame. Frames that were taken before the pipeline played, or while it
 * was paused, are left out.
 */
#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>
#include <string.h>

#include "camera_caps.h"
#include "camera_stream.h"
#include "colorimetry.h"
#include "elements.h"
#include "frame_numbers.h"
#include "picture_format.h"
#include "source_properties.h"
#include "v4l2/format.h"

GST_DEBUG_CATEGORY_STATIC(pupilsrc_debug);
#define GST_CAT_DEFAULT pupilsrc_debug

enum { BUFFERS = 4 };    /* of the camera; drivers/v4l2/capture/capture.h */
#define AWAIT_S      1.0 /* for a control's write that hangs */
#define MICROSECONDS 1e6

const pupil_live_system *pupilsrc_system;

typedef struct GstPupilSrc {
    GstPushSrc parent;
    gint is_unlocked; /* atomic: waiting calls are to return */

    /* under the object's lock */
    source_properties wanted;
    gboolean is_changed;
    double exposure_s, gain; /* of the last frame; 0: unknown */
    const char *state;
    GstClockTime frame_time; /* 0: closed */

    /* the streaming thread's */
    camera_stream camera;
    pupil_live_modes modes; /* from start on */
    GstVideoInfo info;
    pupil_coding out;
    GstClockTime last; /* timestamp of the last buffer */
    const char *posted;
} GstPupilSrc;

typedef struct GstPupilSrcClass {
    GstPushSrcClass parent_class;
} GstPupilSrcClass;

#define PUPIL_SRC(object) ((GstPupilSrc *)(void *)(object))

static GType gst_pupil_src_get_type(void);
G_DEFINE_TYPE(GstPupilSrc, gst_pupil_src, GST_TYPE_PUSH_SRC)
GST_ELEMENT_REGISTER_DEFINE(pupilsrc, "pupilsrc", GST_RANK_NONE, gst_pupil_src_get_type())

static GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(PICTURE_CAPS(PICTURE_FORMATS_OUT)));

/* --- properties --- */

enum { PROP_EXPOSURE_TIME = SOURCE_PROPERTIES_END, PROP_GAIN, PROP_STATE };

static void set_property(GObject *object, guint id, const GValue *value, GParamSpec *spec)
{
    GstPupilSrc *self = PUPIL_SRC(object);
    const gchar *refused;
    GST_OBJECT_LOCK(self);
    const gboolean is_known = source_properties_set(&self->wanted, id, value, &refused);
    self->is_changed = TRUE;
    GST_OBJECT_UNLOCK(self);
    if (!is_known)
        G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
    else
        picture_properties_report(spec, value, refused);
}

static void get_property(GObject *object, guint id, GValue *value, GParamSpec *spec)
{
    GstPupilSrc *self = PUPIL_SRC(object);
    GST_OBJECT_LOCK(self);
    if (id == PROP_EXPOSURE_TIME)
        g_value_set_double(value, self->exposure_s * MICROSECONDS);
    else if (id == PROP_GAIN)
        g_value_set_double(value, self->gain);
    else if (id == PROP_STATE)
        g_value_set_string(value, self->state);
    else if (!source_properties_get(&self->wanted, id, value))
        G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
    GST_OBJECT_UNLOCK(self);
}

/* --- the camera --- */

/* Sources call `stop` without a context, in the thread that waits. */
static _Thread_local GstPupilSrc *waiting;

static int is_unlocked(void)
{
    return waiting && g_atomic_int_get(&waiting->is_unlocked);
}

static void close_camera(GstPupilSrc *self)
{
    pupil_why why = {""};
    if (!self->camera.source)
        return;
    if (camera_stream_close(&self->camera, &why))
        GST_ELEMENT_WARNING(self, RESOURCE, SETTINGS, ("%s", why.text), (NULL));
    if (pupil_live_await(AWAIT_S, NULL))
        GST_ELEMENT_WARNING(self, RESOURCE, SETTINGS, ("a control's write hangs: the camera keeps what it was set to"),
                            (NULL));
    GST_OBJECT_LOCK(self);
    self->frame_time = 0;
    GST_OBJECT_UNLOCK(self);
}

/* 0; -1: the reason is posted. */
static int open_camera(GstPupilSrc *self, const camera_asked *asked)
{
    camera_settings settings;
    pupil_why why = {""};
    GST_OBJECT_LOCK(self);
    gchar *device = g_strdup(self->wanted.device);
    const pupil_live_options options = {.system = pupilsrc_system,
                                        .hands_off = !self->wanted.ae,
                                        .capture = {.fourcc = pupil_v4l2_fourcc(self->wanted.format),
                                                    .width = asked->width,
                                                    .height = asked->height,
                                                    .fps = asked->fps,
                                                    .buffers = BUFFERS,
                                                    .monotonic = 1,
                                                    .stop = is_unlocked}};
    const pupil_colour_options colours = {.balance = self->wanted.awb ? PUPIL_COLOUR_AUTO : PUPIL_COLOUR_OFF};
    source_properties_write(&self->wanted, &settings);
    self->is_changed = FALSE;
    GST_OBJECT_UNLOCK(self);
    waiting = self;
    const int failed = camera_stream_open(&self->camera, device, &options, &colours, &settings, &why);
    g_free(device);
    if (failed) {
        GST_ELEMENT_ERROR(self, RESOURCE, OPEN_READ, ("%s", why.text), (NULL));
        return -1;
    }
    GST_OBJECT_LOCK(self);
    self->frame_time = (GstClockTime)((double)GST_SECOND / self->camera.source->fps);
    GST_OBJECT_UNLOCK(self);
    self->posted = NULL;
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_latency(GST_OBJECT(self)));
    return 0;
}

/* Finds out at once whether the camera is there, and what it offers. */
static gboolean start(GstBaseSrc *base)
{
    GstPupilSrc *self = PUPIL_SRC(base);
    pupil_live_offers *offers = g_new0(pupil_live_offers, 1);
    pupil_why why = {""};
    GST_OBJECT_LOCK(self);
    gchar *device = g_strdup(self->wanted.device);
    GST_OBJECT_UNLOCK(self);
    const int failed = pupil_live_offers_read(offers, pupilsrc_system, device, &why);
    if (failed) {
        GST_ELEMENT_ERROR(self, RESOURCE, NOT_FOUND, ("%s", why.text), (NULL));
        pupil_live_modes_free(&offers->modes);
    } else {
        self->modes = offers->modes;
    }
    self->last = GST_CLOCK_TIME_NONE;
    g_free(device);
    g_free(offers);
    return !failed;
}

static gboolean stop(GstBaseSrc *base)
{
    GstPupilSrc *self = PUPIL_SRC(base);
    close_camera(self);
    pupil_live_modes_free(&self->modes);
    return TRUE;
}

static gboolean unlock(GstBaseSrc *base)
{
    g_atomic_int_set(&PUPIL_SRC(base)->is_unlocked, 1);
    return TRUE;
}

static gboolean unlock_stop(GstBaseSrc *base)
{
    g_atomic_int_set(&PUPIL_SRC(base)->is_unlocked, 0);
    return TRUE;
}

/* --- caps --- */

static gboolean is_still_taken(GstPupilSrc *self, const GstCaps *wanted)
{
    GstCaps *now = gst_pad_get_current_caps(GST_BASE_SRC_PAD(self));
    const gboolean is_taken = now && self->camera.source && gst_caps_can_intersect(now, wanted);
    if (now)
        gst_caps_unref(now);
    return is_taken;
}

static gboolean negotiate_with(GstPupilSrc *self, GstCaps *wanted)
{
    camera_asked asked;
    pupil_why why = {""};
    GST_OBJECT_LOCK(self);
    const uint32_t fourcc = pupil_v4l2_fourcc(self->wanted.format);
    GST_OBJECT_UNLOCK(self);
    close_camera(self);
    GstCaps *caps = NULL;
    if (camera_caps_ask(wanted, &self->modes, fourcc, &asked, &why) == 0) {
        if (open_camera(self, &asked))
            return FALSE;
        GstCaps *formats = gst_pad_get_pad_template_caps(GST_BASE_SRC_PAD(self));
        const pupil_live_stream *stream = &pupil_live_get(self->camera.source)->stream;
        caps = camera_caps_of_stream(wanted, formats, stream->width, stream->height, self->camera.source->fps, &why);
        gst_caps_unref(formats);
    }
    if (!caps) {
        GST_ELEMENT_ERROR(self, STREAM, FORMAT, ("%s", why.text), (NULL));
        return FALSE;
    }
    const gboolean is_set = gst_base_src_set_caps(GST_BASE_SRC(self), caps);
    gst_caps_unref(caps);
    return is_set;
}

static gboolean negotiate(GstBaseSrc *base)
{
    GstPupilSrc *self = PUPIL_SRC(base);
    GstCaps *of_template = gst_pad_get_pad_template_caps(GST_BASE_SRC_PAD(base));
    GstCaps *wanted = gst_pad_peer_query_caps(GST_BASE_SRC_PAD(base), of_template);
    GstCaps *both = gst_caps_intersect_full(wanted, of_template, GST_CAPS_INTERSECT_FIRST);
    const gboolean is_done = !gst_caps_is_empty(both) && (is_still_taken(self, both) || negotiate_with(self, both));
    gst_caps_unref(of_template);
    gst_caps_unref(wanted);
    gst_caps_unref(both);
    return is_done;
}

static gboolean set_caps(GstBaseSrc *base, GstCaps *caps)
{
    GstPupilSrc *self = PUPIL_SRC(base);
    pupil_config unused;
    pupil_why why = {""};
    pupil_config_default(&unused);
    if (!gst_video_info_from_caps(&self->info, caps) || colorimetry_out(&self->info, &self->out, &unused, &why)) {
        GST_ELEMENT_ERROR(self, STREAM, FORMAT, ("%s", why.text), (NULL));
        return FALSE;
    }
    gst_base_src_set_blocksize(base, (guint)GST_VIDEO_INFO_SIZE(&self->info));
    return TRUE;
}

/* A pool of video frames where downstream brings none, so that no frame is allocated while it plays. */
static gboolean decide_allocation(GstBaseSrc *base, GstQuery *query)
{
    if (gst_query_get_n_allocation_pools(query) == 0) {
        GstCaps *caps;
        gst_query_parse_allocation(query, &caps, NULL);
        const guint bytes = (guint)GST_VIDEO_INFO_SIZE(&PUPIL_SRC(base)->info);
        GstBufferPool *pool = gst_video_buffer_pool_new();
        GstStructure *config = gst_buffer_pool_get_config(pool);
        gst_buffer_pool_config_set_params(config, caps, bytes, 2, 0);
        gst_buffer_pool_set_config(pool, config);
        gst_query_add_allocation_pool(query, pool, bytes, 2, 0);
        gst_object_unref(pool);
    }
    return GST_BASE_SRC_CLASS(gst_pupil_src_parent_class)->decide_allocation(base, query);
}

static gboolean query_latency(GstPupilSrc *self, GstQuery *query)
{
    GST_OBJECT_LOCK(self);
    const GstClockTime frame = self->frame_time;
    GST_OBJECT_UNLOCK(self);
    if (!frame)
        return FALSE;
    gst_query_set_latency(query, TRUE, frame, BUFFERS * frame);
    return TRUE;
}

static gboolean query(GstBaseSrc *base, GstQuery *asked)
{
    return GST_QUERY_TYPE(asked) == GST_QUERY_LATENCY
               ? query_latency(PUPIL_SRC(base), asked)
               : GST_BASE_SRC_CLASS(gst_pupil_src_parent_class)->query(base, asked);
}

/* --- frames --- */

static void take_properties(GstPupilSrc *self)
{
    camera_settings settings;
    pupil_why why = {""};
    GST_OBJECT_LOCK(self);
    const gboolean is_changed = self->is_changed;
    source_properties_write(&self->wanted, &settings);
    self->is_changed = FALSE;
    GST_OBJECT_UNLOCK(self);
    if (is_changed && camera_stream_retune(&self->camera, &settings, &why))
        GST_ELEMENT_WARNING(self, RESOURCE, SETTINGS, ("%s", why.text), (NULL));
}

/* The frame's moment in running time, by any clock; negative: before the pipeline played. Both clocks are read at the
 * same moment: they are read again if this thread was interrupted in between. */
static GstClockTimeDiff moment_of(GstPupilSrc *self, GstClock *clock, const pupil_frame_info *info)
{
    GstClockTime before = 0, after = 0;
    GstClockTimeDiff age = 0;
    for (int i = 0; i < 4; i++) {
        before = gst_clock_get_time(clock);
        age = pupil_live_now_ns(self->camera.source) - info->timestamp_ns;
        after = gst_clock_get_time(clock);
        if (after - before < 100 * GST_USECOND)
            break;
    }
    return GST_CLOCK_DIFF(gst_element_get_base_time(GST_ELEMENT(self)), before + (after - before) / 2) - age;
}

/* The timestamp of a frame; none where the pipeline has no clock. FALSE: it is old, from before the pipeline played or
 * from a pause. At most `patience` frames in a row are old: with a stopped clock there are no newer ones. */
static gboolean stamp(GstPupilSrc *self, const pupil_frame_info *info, int patience, GstClockTime *at)
{
    GstClock *clock = gst_element_get_clock(GST_ELEMENT(self));
    *at = GST_CLOCK_TIME_NONE;
    if (!clock)
        return TRUE;
    const GstClockTimeDiff moment = moment_of(self, clock, info);
    const GstClockTimeDiff least = GST_CLOCK_TIME_IS_VALID(self->last) ? (GstClockTimeDiff)self->last + 1 : 0;
    gst_object_unref(clock);
    *at = (GstClockTime)MAX(moment, least);
    return moment >= least || patience <= 0;
}

/* The next frame that is new. */
static GstFlowReturn take_frame(GstPupilSrc *self, pupil_frame *frame, GstClockTime *at)
{
    pupil_why why = {""};
    waiting = self;
    for (int patience = BUFFERS;; patience--) {
        const int got = pupil_source_next(self->camera.source, frame, &why);
        if (got == PUPIL_SOURCE_END)
            return is_unlocked() ? GST_FLOW_FLUSHING : GST_FLOW_EOS;
        if (got != PUPIL_SOURCE_FRAME) {
            /* For GST_FLOW_ERROR the base class would post a second error. With EOS, files downstream are complete,
             * too. */
            GST_ELEMENT_ERROR(self, RESOURCE, READ, ("%s", why.text), (NULL));
            return GST_FLOW_EOS;
        }
        if (stamp(self, &frame->info, patience, at))
            return GST_FLOW_OK;
        pupil_source_done(self->camera.source, frame);
    }
}

static void write_numbers(const GstPupilSrc *self, GstStructure *to)
{
    const camera_stream *c = &self->camera;
    frame_numbers_write(to, &c->exposure);
    gst_structure_set(to, "state", G_TYPE_STRING, camera_stream_state(c), "reason", G_TYPE_STRING,
                      camera_stream_reason(c), "exposure-time", G_TYPE_DOUBLE, c->info.exposure_s * MICROSECONDS,
                      "gain", G_TYPE_DOUBLE, c->info.gain, "sequence", G_TYPE_UINT64, c->info.sequence, NULL);
}

static void publish(GstPupilSrc *self, GstBuffer *buffer)
{
    const camera_stream *c = &self->camera;
    const char *state = camera_stream_state(c);
    GST_OBJECT_LOCK(self);
    self->exposure_s = c->info.exposure_s;
    self->gain = c->info.gain;
    self->state = state;
    GST_OBJECT_UNLOCK(self);
    write_numbers(self, frame_numbers_of(buffer));
    if (self->posted && strcmp(self->posted, state) == 0)
        return;
    GstStructure *structure =
        gst_structure_new("pupilsrc", "running-time", G_TYPE_UINT64, (guint64)GST_BUFFER_PTS(buffer), NULL);
    write_numbers(self, structure);
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), structure));
    self->posted = state;
}

static GstFlowReturn show(GstPupilSrc *self, pupil_frame *frame, GstBuffer *buffer)
{
    GstVideoFrame picture;
    pupil_why why = {""};
    if (!gst_video_frame_map(&picture, &self->info, buffer,
                             (GstMapFlags)(GST_MAP_WRITE | GST_VIDEO_FRAME_MAP_FLAG_NO_REF))) {
        GST_ELEMENT_ERROR(self, RESOURCE, WRITE, ("a buffer of the pipeline cannot be written"), (NULL));
        return GST_FLOW_ERROR;
    }
    const pupil_image out = picture_out(&picture, &self->out);
    const int failed = camera_stream_show(&self->camera, frame, &out, &why);
    gst_video_frame_unmap(&picture);
    if (!failed)
        return GST_FLOW_OK;
    GST_ELEMENT_ERROR(self, STREAM, FAILED, ("%s", why.text), (NULL));
    return GST_FLOW_ERROR;
}

static GstFlowReturn fill(GstPushSrc *base, GstBuffer *buffer)
{
    GstPupilSrc *self = PUPIL_SRC(base);
    pupil_frame frame;
    GstClockTime at;
    take_properties(self);
    GstFlowReturn flow = take_frame(self, &frame, &at);
    if (flow != GST_FLOW_OK)
        return flow;
    flow = show(self, &frame, buffer);
    pupil_source_done(self->camera.source, &frame);
    if (flow != GST_FLOW_OK)
        return flow;
    GST_BUFFER_PTS(buffer) = at;
    GST_BUFFER_DTS(buffer) = GST_CLOCK_TIME_NONE;
    GST_BUFFER_DURATION(buffer) = self->frame_time;
    GST_BUFFER_OFFSET(buffer) = self->camera.info.sequence;
    GST_BUFFER_OFFSET_END(buffer) = self->camera.info.sequence + 1;
    self->last = at;
    publish(self, buffer);
    return GST_FLOW_OK;
}

/* --- the class --- */

static void finalize(GObject *object)
{
    source_properties_end(&PUPIL_SRC(object)->wanted);
    G_OBJECT_CLASS(gst_pupil_src_parent_class)->finalize(object);
}

static void install_results(GObjectClass *klass)
{
    const GParamFlags flags = G_PARAM_READABLE | G_PARAM_STATIC_STRINGS;
    g_object_class_install_property(klass, PROP_EXPOSURE_TIME,
                                    g_param_spec_double("exposure-time", "Exposure time",
                                                        "Of the last frame, in microseconds; 0: unknown", 0.0, 1e10,
                                                        0.0, flags));
    g_object_class_install_property(
        klass, PROP_GAIN, g_param_spec_double("gain", "Gain", "Of the last frame; 0: unknown", 0.0, 1e5, 0.0, flags));
    g_object_class_install_property(
        klass, PROP_STATE,
        g_param_spec_string("state", "State",
                            "Of the exposure: searching, converged, limited, clipped, flicker, locked; without control "
                            "of the camera that of the level: adapting, settled, limited, locked",
                            "empty", flags));
}

static void gst_pupil_src_class_init(GstPupilSrcClass *klass)
{
    GObjectClass *object = G_OBJECT_CLASS(klass);
    GstElementClass *element = GST_ELEMENT_CLASS(klass);
    GstBaseSrcClass *base = GST_BASE_SRC_CLASS(klass);
    GST_DEBUG_CATEGORY_INIT(pupilsrc_debug, "pupilsrc", 0, "a camera whose exposure pupil controls");
    object->set_property = set_property;
    object->get_property = get_property;
    object->finalize = finalize;
    source_properties_install(object);
    install_results(object);
    gst_element_class_set_static_metadata(element, "Camera with automatic exposure", "Source/Video/Hardware",
                                          "Reads raw sensors and webcams, controls their exposure time and gain, "
                                          "balances white, and maps to a picture for a display",
                                          "pupil");
    gst_element_class_add_static_pad_template(element, &src_template);
    base->start = start;
    base->stop = stop;
    base->unlock = unlock;
    base->unlock_stop = unlock_stop;
    base->negotiate = negotiate;
    base->set_caps = set_caps;
    base->decide_allocation = decide_allocation;
    base->query = query;
    GST_PUSH_SRC_CLASS(klass)->fill = fill;
}

static void gst_pupil_src_init(GstPupilSrc *self)
{
    source_properties_begin(&self->wanted);
    self->state = "empty";
    self->last = GST_CLOCK_TIME_NONE;
    gst_base_src_set_live(GST_BASE_SRC(self), TRUE);
    gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

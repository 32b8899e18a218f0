#include "camera_caps.h"

#include <math.h>

#include "colorimetry.h"
#include "refuse.h"

/* The choice where a range is given: usual, and small enough for any CPU. */
enum { USUAL_WIDTH = 1280, USUAL_HEIGHT = 720, USUAL_FPS = 30 };
/* The longest side of pupil (PUPIL_MAX_SIDE_PX), and of the template. */
enum { MOST_PX = 16384 };

static void fraction_of(double fps, gint *n, gint *d)
{
    gst_util_double_to_fraction(fps, n, d);
}

static void add_rates(GstStructure *structure, const pupil_live_size *size)
{
    GValue rates = G_VALUE_INIT, rate = G_VALUE_INIT;
    gint n, d, n_most, d_most;
    if (!size->rates)
        return;
    if (size->fps_between) {
        fraction_of(size->fps[0], &n, &d);
        fraction_of(size->fps[1], &n_most, &d_most);
        gst_structure_set(structure, "framerate", GST_TYPE_FRACTION_RANGE, n, d, n_most, d_most, NULL);
        return;
    }
    g_value_init(&rates, GST_TYPE_LIST);
    g_value_init(&rate, GST_TYPE_FRACTION);
    for (uint32_t i = 0; i < size->rates; i++) {
        fraction_of(size->fps[i], &n, &d);
        gst_value_set_fraction(&rate, n, d);
        gst_value_list_append_value(&rates, &rate);
    }
    gst_structure_take_value(structure, "framerate", &rates);
    g_value_unset(&rate);
}

static void add_side(GstStructure *structure, const gchar *name, uint32_t least, uint32_t most, uint32_t step)
{
    /* Ranges of GStreamer begin at a multiple of their step. */
    if (!step || most <= least || least % step || most % step)
        gst_structure_set(structure, name, G_TYPE_INT, (gint)least, NULL);
    else
        gst_structure_set(structure, name, GST_TYPE_INT_RANGE, (gint)least, (gint)most, NULL);
}

/* NULL: the camera does not report its sizes. */
static GstCaps *caps_of_modes(const pupil_live_modes *modes, uint32_t fourcc)
{
    GstCaps *caps = gst_caps_new_empty();
    for (uint32_t m = 0; m < modes->count; m++) {
        const pupil_live_mode *mode = &modes->mode[m];
        if (!mode->read || (fourcc && mode->fourcc != fourcc))
            continue;
        for (uint32_t i = 0; i < mode->sizes; i++) {
            const pupil_live_size *size = &mode->size[i];
            GstStructure *structure = gst_structure_new_empty("video/x-raw");
            add_side(structure, "width", size->width, size->max_width, size->step_width);
            add_side(structure, "height", size->height, size->max_height, size->step_height);
            add_rates(structure, size);
            gst_caps_append_structure(caps, structure);
        }
    }
    if (!gst_caps_is_empty(caps))
        return caps;
    gst_caps_unref(caps);
    return NULL;
}

/* 1: the template's whole range: downstream has no preference. */
static int is_open(const GstStructure *structure, const gchar *name)
{
    const GValue *value = gst_structure_get_value(structure, name);
    if (!value)
        return 1;
    if (GST_VALUE_HOLDS_INT_RANGE(value))
        return gst_value_get_int_range_min(value) <= 1 && gst_value_get_int_range_max(value) >= MOST_PX;
    if (GST_VALUE_HOLDS_FRACTION_RANGE(value)) {
        const GValue *least = gst_value_get_fraction_range_min(value), *most = gst_value_get_fraction_range_max(value);
        return gst_value_get_fraction_numerator(least) == 0 && gst_value_get_fraction_numerator(most) == G_MAXINT;
    }
    return GST_VALUE_HOLDS_FRACTION(value) && gst_value_get_fraction_numerator(value) == 0; /* 0/1: any rate */
}

static void read_asked(const GstStructure *structure, camera_asked *asked)
{
    gint width, height, n, d;
    if (gst_structure_get_int(structure, "width", &width) && gst_structure_get_int(structure, "height", &height)) {
        asked->width = (uint32_t)width;
        asked->height = (uint32_t)height;
    }
    if (gst_structure_get_fraction(structure, "framerate", &n, &d) && n > 0)
        asked->fps = (double)n / (double)d;
}

static int is_plain(const GstStructure *structure, const gchar *name)
{
    const GValue *value = gst_structure_get_value(structure, name);
    return is_open(structure, name) || G_VALUE_HOLDS_INT(value) || GST_VALUE_HOLDS_FRACTION(value);
}

int camera_caps_ask(GstCaps *wanted, const pupil_live_modes *modes, uint32_t fourcc, camera_asked *asked,
                    pupil_why *why)
{
    const GstStructure *first = gst_caps_get_structure(wanted, 0);
    const int sides_are_open = is_open(first, "width") + is_open(first, "height");
    *asked = (camera_asked){0};
    if (sides_are_open != 1 && is_plain(first, "width") && is_plain(first, "height") && is_plain(first, "framerate")) {
        read_asked(first, asked);
        return 0;
    }
    GstCaps *offered = caps_of_modes(modes, fourcc);
    if (!offered)
        return 0; /* a sensor behind a media graph: as it is set */
    GstCaps *both = gst_caps_intersect_full(wanted, offered, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(offered);
    if (gst_caps_is_empty(both)) {
        gchar *text = gst_structure_to_string(first);
        pupil_refuse(why, "the camera has no mode of the size and rate that downstream takes (%s)", text);
        g_free(text);
        gst_caps_unref(both);
        return -1;
    }
    both = gst_caps_make_writable(gst_caps_truncate(both));
    GstStructure *chosen = gst_caps_get_structure(both, 0);
    gst_structure_fixate_field_nearest_int(chosen, "width", USUAL_WIDTH);
    gst_structure_fixate_field_nearest_int(chosen, "height", USUAL_HEIGHT);
    if (gst_structure_has_field(chosen, "framerate") && !is_open(chosen, "framerate"))
        gst_structure_fixate_field_nearest_fraction(chosen, "framerate", USUAL_FPS, 1);
    read_asked(chosen, asked);
    gst_caps_unref(both);
    return 0;
}

GstCaps *camera_caps_of_stream(GstCaps *wanted, const GstCaps *formats, uint32_t width, uint32_t height, double fps,
                               pupil_why *why)
{
    gint n, d;
    GstCaps *stream = gst_caps_copy(formats);
    fraction_of(fps, &n, &d);
    const GstStructure *first = gst_caps_get_structure(wanted, 0);
    gint wanted_n, wanted_d; /* the same rate as it was asked for, in another fraction */
    if (gst_structure_get_fraction(first, "framerate", &wanted_n, &wanted_d) &&
        (wanted_n == 0 || fabs((double)wanted_n / wanted_d / fps - 1.0) < 0.01)) {
        n = wanted_n;
        d = wanted_d;
    }
    gst_caps_set_simple(stream, "width", G_TYPE_INT, (gint)width, "height", G_TYPE_INT, (gint)height, "framerate",
                        GST_TYPE_FRACTION, n, d, "pixel-aspect-ratio", GST_TYPE_FRACTION, 1, 1, "interlace-mode",
                        G_TYPE_STRING, "progressive", NULL);
    GstCaps *caps = gst_caps_intersect_full(wanted, stream, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(stream);
    if (gst_caps_is_empty(caps)) {
        gchar *text = gst_caps_to_string(wanted);
        pupil_refuse(why, "the camera has %ux%u at %.4g frames a second, and downstream takes %.300s", width, height,
                     fps, text);
        g_free(text);
        gst_caps_unref(caps);
        return NULL;
    }
    caps = gst_caps_make_writable(gst_caps_truncate(caps));
    GstStructure *structure = gst_caps_get_structure(caps, 0);
    gst_structure_fixate_field_string(structure, "format", "NV12");
    colorimetry_fixate(structure, gst_video_format_from_string(gst_structure_get_string(structure, "format")));
    return gst_caps_fixate(caps);
}

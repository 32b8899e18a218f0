#include "picture_properties.h"

void picture_properties_begin(picture_properties *p)
{
    *p = (picture_properties){0};
    pupil_config_default(&p->config);
    p->config.dither = 1;
}

void picture_properties_write(const picture_properties *p, pupil_config *config)
{
    *config = p->config;
    metering_write(&p->metered, config);
}

/* The number of the configuration that a property sets; NULL: none. */
static double *number_of(picture_properties *p, guint id)
{
    switch (id) {
    case PICTURE_EXPOSURE_VALUE:
        return &p->config.ev_compensation;
    case PICTURE_KEY:
        return &p->config.key;
    case PICTURE_TAU_LIGHT:
        return &p->config.tau_light_s;
    case PICTURE_TAU_DARK:
        return &p->config.tau_dark_s;
    case PICTURE_HIGHLIGHTS:
        return &p->config.highlight_ev;
    case PICTURE_AMPLIFICATION:
        return &p->config.amplification_ev;
    default:
        return NULL;
    }
}

static GType tone_type(void)
{
    static gsize type;
    static const GEnumValue values[] = {
        {PUPIL_CURVE_REINHARD, "Reinhard's curve", "reinhard"},
        {PUPIL_CURVE_NORMALISE, "The frame's range of codes is stretched", "normalise"},
        {PUPIL_CURVE_QUANTISE, "Some levels of brightness", "quantise"},
        {PUPIL_CURVE_EQUALISE, "All codes equally frequent", "equalise"},
        {PUPIL_CURVE_ADJUST, "The scene's range fitted into the display's, contrast with a ceiling", "adjust"},
        {0, NULL, NULL}};
    if (g_once_init_enter(&type))
        g_once_init_leave(&type, g_enum_register_static("GstPupilTone", values));
    return type;
}

static GType accuracy_type(void)
{
    static gsize type;
    static const GEnumValue values[] = {{PUPIL_ACCURACY_EXACT, "Every pixel, as light", "exact"},
                                        {PUPIL_ACCURACY_LUMA, "8-bit Y'CbCr by its luma, which is faster", "luma"},
                                        {0, NULL, NULL}};
    if (g_once_init_enter(&type))
        g_once_init_leave(&type, g_enum_register_static("GstPupilAccuracy", values));
    return type;
}

/* As number_of, of choices. */
static uint32_t *choice_of(picture_properties *p, guint id)
{
    return id == PICTURE_TONE ? &p->config.curve : id == PICTURE_ACCURACY ? &p->config.accuracy : NULL;
}

gboolean picture_properties_set(picture_properties *p, guint id, const GValue *value, const gchar **refused)
{
    double *number = number_of(p, id);
    uint32_t *choice = choice_of(p, id);
    *refused = NULL;
    if (number)
        *number = g_value_get_double(value);
    else if (choice)
        *choice = (uint32_t)g_value_get_enum(value);
    else if (id == PICTURE_AE_LOCK)
        p->config.lock = g_value_get_boolean(value) ? 1 : 0;
    else if (id == PICTURE_DITHER)
        p->config.dither = g_value_get_boolean(value) ? 1 : 0;
    else if (id == PICTURE_AE_METERING)
        p->metered.pattern = (metering_pattern)g_value_get_enum(value);
    else if (id != PICTURE_ROI)
        return FALSE;
    else if (metering_roi_set(&p->metered, g_value_get_string(value)))
        *refused = "x,y,width,height inside the frame, from 0 to 1";
    return TRUE;
}

void picture_properties_report(GParamSpec *spec, const GValue *value, const gchar *refused)
{
    if (refused)
        g_warning("%s=%s is not %s; it stays as it was", spec->name, g_value_get_string(value), refused);
}

gboolean picture_properties_get(picture_properties *p, guint id, GValue *value)
{
    const double *number = number_of(p, id);
    const uint32_t *choice = choice_of(p, id);
    if (number)
        g_value_set_double(value, *number);
    else if (choice)
        g_value_set_enum(value, (gint)*choice);
    else if (id == PICTURE_AE_LOCK)
        g_value_set_boolean(value, p->config.lock != 0);
    else if (id == PICTURE_DITHER)
        g_value_set_boolean(value, p->config.dither != 0);
    else if (id == PICTURE_AE_METERING)
        g_value_set_enum(value, (gint)p->metered.pattern);
    else if (id == PICTURE_ROI)
        g_value_take_string(value, metering_roi_text(&p->metered));
    else
        return FALSE;
    return TRUE;
}

#define FLAGS (G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_PLAYING)

static void install_number(GObjectClass *klass, guint id, const gchar *name, const gchar *nick, const gchar *blurb,
                           double least, double most, double usual)
{
    g_object_class_install_property(klass, id, g_param_spec_double(name, nick, blurb, least, most, usual, FLAGS));
}

void picture_properties_install(GObjectClass *klass)
{
    pupil_config c;
    pupil_config_default(&c);
    metering_install(klass, PICTURE_AE_METERING, PICTURE_ROI);
    g_object_class_install_property(
        klass, PICTURE_AE_LOCK,
        g_param_spec_boolean("ae-lock", "Lock", "Hold the level and the exposure", FALSE, FLAGS));
    g_object_class_install_property(
        klass, PICTURE_DITHER,
        g_param_spec_boolean("dither", "Dither", "Ordered dither, so that smooth ramps have no bands", TRUE, FLAGS));
    g_object_class_install_property(
        klass, PICTURE_TONE,
        g_param_spec_enum("tone", "Tone curve", "Which curve maps the light; all but reinhard follow the histogram",
                          tone_type(), PUPIL_CURVE_REINHARD, FLAGS));
    g_object_class_install_property(
        klass, PICTURE_ACCURACY,
        g_param_spec_enum("accuracy", "Accuracy",
                          "luma: 8-bit Y'CbCr by its luma, in less time, where dither is off and the matrix stays",
                          accuracy_type(), PUPIL_ACCURACY_EXACT, FLAGS));
    install_number(klass, PICTURE_EXPOSURE_VALUE, "exposure-value", "Compensation", "Stops; positive is brighter",
                   -16.0, 16.0, c.ev_compensation);
    install_number(klass, PICTURE_KEY, "key", "Key",
                   "What the log-average of the light becomes in the picture, as a share of white", 0x1p-10, 1.0,
                   c.key);
    install_number(klass, PICTURE_TAU_LIGHT, "tau-light", "Time constant, brighter",
                   "Seconds in which the level follows more light; 0: at once", 0.0, 1e6, c.tau_light_s);
    install_number(klass, PICTURE_TAU_DARK, "tau-dark", "Time constant, darker",
                   "Seconds in which the level follows less light; 0: at once", 0.0, 1e6, c.tau_dark_s);
    install_number(klass, PICTURE_HIGHLIGHTS, "highlights", "Highlights",
                   "Stops by which bright parts may make the picture darker; 0: never", 0.0, 8.0, c.highlight_ev);
    install_number(klass, PICTURE_AMPLIFICATION, "amplification", "Largest amplification",
                   "Stops by which dark video is made brighter at most; beyond them it is mostly noise", 0.0, 32.0,
                   c.amplification_ev);
}

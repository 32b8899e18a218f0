#include "metering.h"

#include <string.h>

GType metering_pattern_type(void)
{
    static gsize type;
    static const GEnumValue values[] = {{METERING_UNIFORM, "All of the frame alike", "matrix"},
                                        {METERING_CENTRE, "The centre more than the corners", "centre-weighted"},
                                        {METERING_SPOT, "The central 5 % alone", "spot"},
                                        {0, NULL, NULL}};
    if (g_once_init_enter(&type))
        g_once_init_leave(&type, g_enum_register_static("GstPupilMetering", values));
    return type;
}

void metering_install(GObjectClass *klass, guint id_pattern, guint id_roi)
{
    const GParamFlags flags = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_PLAYING;
    g_object_class_install_property(klass, id_pattern,
                                    g_param_spec_enum("ae-metering", "Metering", "Which part of the frame is metered",
                                                      metering_pattern_type(), METERING_UNIFORM, flags));
    g_object_class_install_property(
        klass, id_roi,
        g_param_spec_string("roi", "Region",
                            "What is metered in place of ae-metering: x,y,width,height as fractions of the frame, as "
                            "0.25,0.25,0.5,0.5; empty: ae-metering",
                            "", flags));
}

int metering_roi_set(metering *m, const gchar *text)
{
    double roi[4];
    pupil_config config;
    if (!text || !*text) {
        memset(m->roi, 0, sizeof m->roi);
        return 0;
    }
    for (int i = 0; i < 4; i++) {
        gchar *end;
        roi[i] = g_ascii_strtod(text, &end);
        if (end == text || *end != (i < 3 ? ',' : 0))
            return -1;
        text = end + 1;
    }
    pupil_config_default(&config);
    if (pupil_metering_roi(&config, roi[0], roi[1], roi[2], roi[3]))
        return -1;
    memcpy(m->roi, roi, sizeof m->roi);
    return 0;
}

gchar *metering_roi_text(const metering *m)
{
    char number[4][G_ASCII_DTOSTR_BUF_SIZE];
    if (!(m->roi[2] > 0.0))
        return g_strdup("");
    for (int i = 0; i < 4; i++)
        g_ascii_formatd(number[i], sizeof number[i], "%.9g", m->roi[i]);
    return g_strdup_printf("%s,%s,%s,%s", number[0], number[1], number[2], number[3]);
}

void metering_write(const metering *m, pupil_config *config)
{
    if (m->roi[2] > 0.0)
        pupil_metering_roi(config, m->roi[0], m->roi[1], m->roi[2], m->roi[3]);
    else if (m->pattern == METERING_CENTRE)
        pupil_metering_centre(config);
    else if (m->pattern == METERING_SPOT)
        pupil_metering_spot(config);
    else
        pupil_metering_uniform(config);
}

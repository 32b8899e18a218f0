#include "frame_numbers.h"

static const GEnumValue states[] = {{PUPIL_STATE_EMPTY, "No frame with light yet", "empty"},
                                    {PUPIL_STATE_ADAPTING, "On the way to the light of the frames", "adapting"},
                                    {PUPIL_STATE_SETTLED, "Within 0.05 stop of it", "settled"},
                                    {PUPIL_STATE_LIMITED, "At a limit, with the light beyond it", "limited"},
                                    {PUPIL_STATE_LOCKED, "Held by ae-lock", "locked"},
                                    {0, NULL, NULL}};

GType frame_state_type(void)
{
    static gsize type;
    if (g_once_init_enter(&type))
        g_once_init_leave(&type, g_enum_register_static("GstPupilState", states));
    return type;
}

const gchar *frame_state_word(uint32_t state)
{
    return state <= PUPIL_STATE_LOCKED ? states[state].value_nick : "unknown";
}

const gchar *frame_reason_word(uint32_t reason)
{
    static const gchar *const words[] = {"none",         "ev-min",        "ev-max",     "no-light",
                                         "clock-back",   "lock",          "clock-unit", "highlights",
                                         "no-histogram", "amplification", "range"};
    return reason < G_N_ELEMENTS(words) ? words[reason] : "unknown";
}

void frame_numbers_register(void)
{
    static const gchar *const no_tags[] = {NULL}; /* true however the picture is changed: copied with it */
    if (!gst_meta_get_info(FRAME_NUMBERS_META))
        gst_meta_register_custom(FRAME_NUMBERS_META, (const gchar **)(gpointer)no_tags, NULL, NULL, NULL);
}

void frame_numbers_write(GstStructure *to, const pupil_exposure *e)
{
    gst_structure_set(to, "state", G_TYPE_STRING, frame_state_word(e->state), "reason", G_TYPE_STRING,
                      frame_reason_word(e->reason), "metered-ev", G_TYPE_DOUBLE, e->metered_ev, "adapted-ev",
                      G_TYPE_DOUBLE, e->adapted_ev, "scale", G_TYPE_DOUBLE, e->scale, "dt", G_TYPE_DOUBLE, e->dt_s,
                      NULL);
}

GstStructure *frame_numbers_of(GstBuffer *buffer)
{
    GstCustomMeta *meta = gst_buffer_get_custom_meta(buffer, FRAME_NUMBERS_META);
    if (!meta)
        meta = gst_buffer_add_custom_meta(buffer, FRAME_NUMBERS_META);
    GstStructure *structure = gst_custom_meta_get_structure(meta);
    gst_structure_remove_all_fields(structure);
    return structure;
}

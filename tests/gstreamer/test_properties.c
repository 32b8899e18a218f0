/* Each property of both elements: a set value reads back; a text that is not a value is refused, and the property keeps
 * its value. The elements are linked to this program. */
#include "check.h"
#include "element.h"

GST_PLUGIN_STATIC_DECLARE(pupil);

typedef struct property {
    const char *name, *usual, *other; /* as for gst-launch-1.0, and as read back */
} property;

static const property picture[] = {{"ae-lock", "false", "true"},
                                   {"ae-metering", "matrix", "spot"},
                                   {"ae-metering", "matrix", "centre-weighted"},
                                   {"roi", "", "0.25,0.5,0.5,0.25"},
                                   {"exposure-value", "0", "-1.5"},
                                   {"key", "0.18", "0.25"},
                                   {"tau-light", "0.3", "0"},
                                   {"tau-dark", "0.9", "2"},
                                   {"highlights", "2", "0"},
                                   {"amplification", "4", "32"},
                                   {"dither", "true", "false"},
                                   {"tone", "reinhard", "equalise"},
                                   {"accuracy", "exact", "luma"},
                                   {NULL, NULL, NULL}};
static const property camera[] = {{"device", "/dev/video0", "libcamera:0"}, {"sensor-format", "", "RG10"},
                                  {"ae-enable", "true", "false"},           {"awb-enable", "true", "false"},
                                  {"exposure-time-range", "", "100 20000"}, {"gain-range", "", "1 8"},
                                  {"ae-antibanding", "auto", "off"},        {"ae-antibanding", "auto", "50"},
                                  {"ae-antibanding", "auto", "60"},         {NULL, NULL, NULL}};

/* An enum by its nick, everything else as text. */
static void check_is(GstElement *element, const char *name, const char *expected)
{
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), name);
    GValue value = G_VALUE_INIT, wanted = G_VALUE_INIT;
    g_value_init(&value, spec->value_type);
    g_value_init(&wanted, spec->value_type);
    g_object_get_property(G_OBJECT(element), name, &value);
    if (G_VALUE_HOLDS_STRING(&wanted))
        g_value_set_string(&wanted, expected);
    else
        CHECK(gst_value_deserialize(&wanted, expected));
    gchar *text = g_strdup_value_contents(&value);
    CHECK_MSG(gst_value_compare(&value, &wanted) == GST_VALUE_EQUAL, "%s is %s, not %s", name, text, expected);
    g_free(text);
    g_value_unset(&value);
    g_value_unset(&wanted);
}

static void check_all(GstElement *element, const property *all)
{
    for (const property *p = all; p->name; p++) {
        check_is(element, p->name, p->usual);
        gst_util_set_object_arg(G_OBJECT(element), p->name, p->other);
        check_is(element, p->name, p->other);
        if (!*p->usual)
            g_object_set(element, p->name, NULL, NULL); /* as "" */
        else
            gst_util_set_object_arg(G_OBJECT(element), p->name, p->usual);
        check_is(element, p->name, p->usual);
    }
}

static void check_refused(GstElement *element, const char *name, const char *good, const char *const *bad)
{
    gst_util_set_object_arg(G_OBJECT(element), name, good);
    for (; *bad; bad++) {
        gchar *warning = g_strdup_printf("%s=* is not *; it stays as it was", name);
        g_test_expect_message(NULL, G_LOG_LEVEL_WARNING, warning);
        g_object_set(element, name, *bad, NULL);
        g_test_assert_expected_messages();
        check_is(element, name, good);
        g_free(warning);
    }
}

int main(int argc, char **argv)
{
    static const char *const regions[] = {"0.5",         "0,0,1",         "0,0,1,1,1", "a,0,1,1",
                                          "0.5,0,0.6,1", "0,0,0,0.00001", "-1,0,1,1",  NULL};
    static const char *const ranges[] = {"1", "1;2", "1 x", "x 2", "1 2 3", "0 2", "2 1", "1 1e12", "nan 2", NULL};
    static const char *const formats[] = {"RGGB10", "RG\n", NULL};
    check_begin(argc, argv);
    gst_init(NULL, NULL);
    GST_PLUGIN_STATIC_REGISTER(pupil);
    GstElement *filter = gst_object_ref_sink(gst_element_factory_make("pupilae", NULL));
    GstElement *source = gst_object_ref_sink(gst_element_factory_make("pupilsrc", NULL));
    check_all(filter, picture);
    check_all(source, picture);
    check_all(source, camera);
    g_object_set(source, "device", NULL, NULL);
    check_is(source, "device", "");
    check_refused(filter, "roi", "0.25,0.25,0.5,0.5", regions);
    check_refused(source, "roi", "0.25,0.25,0.5,0.5", regions);
    check_refused(source, "exposure-time-range", "100 20000", ranges);
    check_refused(source, "gain-range", "1.5 8", ranges);
    check_refused(source, "sensor-format", "RG10", formats);
    gst_object_unref(filter);
    gst_object_unref(source);
    return check_end();
}

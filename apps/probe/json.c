/* The results of a probe, for programs: the same as the text, with units in the names. */
#include <math.h>

#include "list/list_json.h"
#include "probe.h"

/* NaN and infinities become null. */
static int add_number(cJSON *object, const char *name, double value)
{
    return isfinite(value) ? cJSON_AddNumberToObject(object, name, value) != NULL
                           : cJSON_AddNullToObject(object, name) != NULL;
}

static int add_bool(cJSON *object, const char *name, int value)
{
    return cJSON_AddBoolToObject(object, name, value) != NULL;
}

/* "known": true; or false and "why". */
static int add_known(cJSON *object, const probe_known *is)
{
    return add_bool(object, "known", is->known) && (is->known || list_json_text(object, "why", is->why.text));
}

static int add_stream(cJSON *root, const probe_report *r)
{
    const pupil_live_stream *s = &r->stream;
    cJSON *stream = cJSON_AddObjectToObject(root, "stream"), *colour = cJSON_AddObjectToObject(root, "colour");
    cJSON *memory = cJSON_AddObjectToObject(root, "memory");
    const double none = (double)NAN;
    return stream && colour && memory && list_json_text(stream, "fourcc", s->format) &&
           add_number(stream, "width", s->width) && add_number(stream, "height", s->height) &&
           add_number(stream, "fps", r->fps) && add_number(stream, "buffers", s->buffers) &&
           list_json_text(colour, "colorspace", s->colorspace) && list_json_text(colour, "transfer", s->transfer) &&
           list_json_text(colour, "encoding", s->encoding) && list_json_text(colour, "range", s->range) &&
           list_json_text(memory, "reading", s->reading) && list_json_text(memory, "heap", s->heap) &&
           add_number(memory, "read_bytes_per_s", s->read_bytes_s > 0.0 ? s->read_bytes_s : none) &&
           add_number(memory, "ordinary_bytes_per_s", s->ordinary_bytes_s > 0.0 ? s->ordinary_bytes_s : none);
}

static int add_sensor(cJSON *root, const probe_report *r)
{
    const pupil_camera_sensor *s = &r->offers.sensor;
    char law[96];
    if (!r->offers.has_entity)
        return cJSON_AddNullToObject(root, "sensor") != NULL;
    cJSON *sensor = cJSON_AddObjectToObject(root, "sensor"), *known = NULL;
    if (!sensor || !list_json_text(sensor, "entity", r->offers.entity) ||
        !list_json_text(sensor, "path", r->offers.entity_path))
        return 0;
    if (!r->offers.has_sensor)
        return cJSON_AddNullToObject(sensor, "table") != NULL;
    probe_law_text(&s->gain, law, sizeof law);
    known = cJSON_AddObjectToObject(sensor, "table");
    const double none = (double)NAN;
    return known && list_json_text(known, "name", s->name) && list_json_text(known, "gain_law", law) &&
           add_number(known, "exposure_delay_frames", s->exposure_delay ? s->exposure_delay : none) &&
           add_number(known, "gain_delay_frames", s->gain_delay ? s->gain_delay : none) &&
           add_number(known, "black_of_65535", s->black >= 0.0 ? s->black : none) &&
           add_bool(known, "has_matrix", (int)s->has_matrix) && list_json_text(known, "source", s->source);
}

static int add_control(cJSON *controls, const pupil_live_control *c)
{
    cJSON *object = cJSON_CreateObject();
    if (!object || !cJSON_AddItemToArray(controls, object))
        return 0;
    return list_json_text(object, "name", c->name) && add_number(object, "id", c->id) &&
           add_number(object, "value", c->value) && add_number(object, "least", c->least) &&
           add_number(object, "most", c->most) && add_number(object, "step", c->step) &&
           add_number(object, "default", c->usual) && (!*c->item || list_json_text(object, "item", c->item)) &&
           add_bool(object, "on_sensor", c->on_sensor) && add_bool(object, "automatic", c->automatic);
}

static int add_limits(cJSON *root, const probe_report *r)
{
    const pupil_camera_limits *l = &r->limits;
    char law[96];
    cJSON *limits = cJSON_AddObjectToObject(root, "limits");
    if (!limits || !add_known(limits, &r->has_controls))
        return 0;
    if (!r->has_controls.known)
        return 1;
    probe_law_text(&l->gain, law, sizeof law);
    return add_number(limits, "exposure_min_s", l->exposure_min_s) &&
           add_number(limits, "exposure_max_s", l->exposure_max_s) &&
           add_number(limits, "exposure_step_s", l->exposure_step_s) &&
           add_bool(limits, "has_gain", (int)l->has_gain) && add_number(limits, "gain_min", l->gain_min) &&
           add_number(limits, "gain_max", l->gain_max) &&
           add_number(limits, "gain_min_db", 20.0 * log10(l->gain_min)) &&
           add_number(limits, "gain_max_db", 20.0 * log10(l->gain_max)) &&
           (!l->has_gain || list_json_text(limits, "gain_law", law)) &&
           add_bool(limits, "gain_law_known", (int)l->gain_known);
}

static int add_delay(cJSON *measured, const char *name, const probe_delay *d)
{
    cJSON *object = cJSON_AddObjectToObject(measured, name);
    if (!object || !add_known(object, &d->is))
        return 0;
    return !d->is.known || (add_number(object, "frames", d->frames) && add_number(object, "least_frames", d->least) &&
                            add_number(object, "most_frames", d->most) && add_number(object, "steps", d->steps));
}

static int add_law(cJSON *measured, const char *name, const probe_law *law)
{
    cJSON *object = cJSON_AddObjectToObject(measured, name), *points = NULL;
    if (!object || !add_known(object, &law->is))
        return 0;
    int added =
        !law->is.known || (add_bool(object, "obeyed", law->obeyed) && add_number(object, "slope", law->slope) &&
                           add_number(object, "off_ev", law->off_ev) && add_number(object, "drift_ev", law->drift_ev) &&
                           add_bool(object, "as_told", law->as_told));
    added = added && (points = cJSON_AddArrayToObject(object, "points")) != NULL;
    for (unsigned i = 0; added && i < law->points; i++) {
        const probe_point *p = &law->point[i];
        cJSON *one = cJSON_CreateObject();
        added = one && cJSON_AddItemToArray(points, one) && add_number(one, "exposure_s", p->exposure_s) &&
                add_number(one, "gain", p->gain) && add_number(one, "gain_code", (double)p->code) &&
                add_number(one, "level_ev", p->level_ev) && add_number(one, "off_ev", p->off_ev);
    }
    return added;
}

static int add_black(cJSON *measured, const probe_black *b)
{
    cJSON *object = cJSON_AddObjectToObject(measured, "black");
    if (!object || !add_known(object, &b->is))
        return 0;
    return !b->is.known || (add_number(object, "of_65535", b->share * 65535.0) &&
                            add_bool(object, "at_most", b->at_most) && add_number(object, "exposure_s", b->exposure_s));
}

static int add_times(cJSON *measured, const probe_report *r)
{
    const probe_interval *i = &r->interval;
    cJSON *interval = cJSON_AddObjectToObject(measured, "interval");
    cJSON *latency = cJSON_AddObjectToObject(measured, "latency");
    if (!interval || !latency || !add_known(interval, &i->is) || !add_known(latency, &r->latency.is) ||
        !list_json_text(latency, "stamp", probe_stamp(r->latency.stamp)) ||
        !add_number(interval, "frames", (double)i->frames) || !add_number(interval, "lost", (double)i->lost) ||
        !add_number(interval, "damaged", (double)i->damaged))
        return 0;
    if (i->is.known && !(add_number(interval, "mean_s", i->mean_s) && add_number(interval, "jitter_s", i->jitter_s) &&
                         add_number(interval, "least_s", i->least_s) && add_number(interval, "most_s", i->most_s)))
        return 0;
    return !r->latency.is.known ||
           (add_number(latency, "median_s", r->latency.median_s) && add_number(latency, "most_s", r->latency.most_s));
}

static int add_all(cJSON *root, const probe_report *r)
{
    cJSON *camera = cJSON_AddObjectToObject(root, "camera"), *controls = NULL, *measured = NULL;
    int added = camera && list_json_camera(camera, &r->offers.is, &r->offers.modes) && add_stream(root, r) &&
                add_sensor(root, r) && (controls = cJSON_AddArrayToObject(root, "controls")) != NULL;
    for (unsigned i = 0; added && i < r->offers.controls; i++)
        added = add_control(controls, &r->offers.control[i]);
    return added && add_limits(root, r) && (measured = cJSON_AddObjectToObject(root, "measured")) != NULL &&
           add_number(measured, "seconds", r->seconds) && add_times(measured, r) &&
           add_delay(measured, "exposure_delay", &r->exposure_delay) &&
           add_delay(measured, "gain_delay", &r->gain_delay) && add_law(measured, "exposure", &r->exposure) &&
           add_law(measured, "gain", &r->gain) && add_black(measured, &r->black);
}

char *probe_json(const probe_report *report)
{
    cJSON *root = cJSON_CreateObject();
    char *text = root && add_all(root, report) ? cJSON_Print(root) : NULL;
    cJSON_Delete(root);
    return text;
}

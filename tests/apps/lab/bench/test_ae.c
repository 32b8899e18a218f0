/* pupil bench ae --json: every line is an object with its fields, the filters keep what they name, and pupil keeps the
 * limits of settling and overshoot of docs/sim.md. */
#include <cjson/cJSON.h>
#include <math.h>

#include "check.h"

typedef struct row {
    char controller[24], test[24], of[64], gain_law[24], unit[16];
    double delay, step_ev, value, limit;
    int pass;
} row;

enum { MOST_ROWS = 600 };
static row rows[MOST_ROWS];
static int count;

static void text(const cJSON *object, const char *name, char *into, size_t bytes, int may_be_empty)
{
    const char *found = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
    CHECK_MSG(found && (may_be_empty || *found), "%s is no text", name);
    snprintf(into, bytes, "%s", found ? found : "");
}

/* NAN if it is null and may be. */
static double number(const cJSON *object, const char *name, int may_be_null)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    CHECK_MSG(cJSON_IsNumber(item) || (may_be_null && cJSON_IsNull(item)), "%s is not a number", name);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

static row row_of(const cJSON *object)
{
    row r;
    const cJSON *pass = cJSON_GetObjectItemCaseSensitive(object, "pass");
    text(object, "controller", r.controller, sizeof r.controller, 0);
    text(object, "test", r.test, sizeof r.test, 0);
    text(object, "of", r.of, sizeof r.of, 1);
    text(object, "gain_law", r.gain_law, sizeof r.gain_law, 0);
    text(object, "unit", r.unit, sizeof r.unit, 0);
    r.delay = number(object, "delay", 0);
    CHECK(number(object, "believed", 0) >= 1);
    r.step_ev = number(object, "step_ev", 1);
    r.value = number(object, "value", 1);
    r.limit = number(object, "limit", 0);
    CHECK(cJSON_IsBool(pass) && cJSON_GetArraySize(object) == 11);
    r.pass = cJSON_IsTrue(pass);
    CHECK_MSG(r.pass == (r.value <= r.limit), "%s %s: %g, limit %g, pass %d", r.controller, r.test, r.value, r.limit,
              r.pass);
    return r;
}

/* Reads the lines of a run into rows. */
static void run(const char *arguments)
{
    char command[400], line[1024];
    snprintf(command, sizeof command, "\"$PUPIL_PROGRAM\" bench %s --json", arguments);
    FILE *from = popen(command, "r");
    count = 0;
    CHECK(from != NULL);
    while (from && fgets(line, sizeof line, from)) {
        const char *end = NULL;
        cJSON *object = cJSON_ParseWithOpts(line, &end, 0);
        CHECK_MSG(cJSON_IsObject(object) && end && strcmp(end, "\n") == 0, "no object alone on its line: %s", line);
        if (object && count < MOST_ROWS)
            rows[count++] = row_of(object);
        cJSON_Delete(object);
    }
    CHECK(from && pclose(from) == 0 && count > 0 && count < MOST_ROWS);
}

/* Four laws, four delays, six steps and two starts, each with and without the check for a strobe. */
static void check_settling(void)
{
    run("--ae --test settle --controller pupil");
    CHECK_MSG(count == 4 * 4 * 8 * 2, "%d rows", count);
    for (int i = 0; i < count; i++) {
        const row *r = &rows[i];
        const double d = r->delay, seen = strstr(r->of, "flash_frames 0") ? d + 1 : d + 3;
        const int blind = r->step_ev >= 6; /* over 97 % of the log-normal scene are clipped */
        CHECK(strcmp(r->test, "settle") == 0 && strcmp(r->controller, "pupil") == 0 && strcmp(r->unit, "frames") == 0);
        CHECK_MSG(r->limit == (blind ? fmax(seen, 2 * d + 1) : seen), "D %g, %+g EV %s: limit %g", d, r->step_ev, r->of,
                  r->limit);
        CHECK_MSG(r->pass, "%s, D %g, %+g EV %s: %g frames, %g allowed", r->gain_law, d, r->step_ev, r->of, r->value,
                  r->limit);
    }
    run("ae --test overshoot --controller pupil");
    CHECK_MSG(count == 4 * 4 * 8 * 2, "%d rows", count);
    for (int i = 0; i < count; i++) {
        CHECK(strcmp(rows[i].test, "overshoot") == 0 && strcmp(rows[i].unit, "EV") == 0 && rows[i].limit == 0.05);
        CHECK_MSG(rows[i].pass, "%s, D %g, %+g EV %s: overshoot %g EV", rows[i].gain_law, rows[i].delay,
                  rows[i].step_ev, rows[i].of, rows[i].value);
    }
}

/* Without a filter on the controller each row of pupil has one of every law; a law that never settles has null. */
static void check_filters(void)
{
    static const char *const laws[] = {"pupil",          "rpi",        "libipa", "softisp", "openpilot",
                                       "integrator0.25", "integrator1"};
    int of_law[7] = {0};
    run("ae --test strobe");
    for (int i = 0; i < count; i++) {
        int known = 0;
        for (int k = 0; k < 7; k++)
            if (strcmp(rows[i].controller, laws[k]) == 0)
                known = ++of_law[k];
        CHECK_MSG(known && strcmp(rows[i].test, "strobe") == 0, "%s %s", rows[i].controller, rows[i].test);
        CHECK_MSG(rows[i].pass || strcmp(rows[i].controller, "pupil") != 0, "D %g, %s of %g EV: %g EV", rows[i].delay,
                  rows[i].of, rows[i].step_ev, rows[i].value);
    }
    for (int k = 0; k < 7; k++)
        CHECK_MSG(of_law[k] == 4 * 2 * 4, "%s has %d rows", laws[k], of_law[k]);
    run("ae --test settle --controller integrator1");
    int never = 0;
    for (int i = 0; i < count; i++)
        never += isnan(rows[i].value) && !rows[i].pass;
    CHECK_MSG(never > 0 && count == 4 * 4 * 8, "%d of %d never settled", never, count);
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    if (!getenv("PUPIL_PROGRAM"))
        return check_skip("no program: PUPIL_PROGRAM");
    check_settling();
    check_filters();
    return check_end();
}

/* --stats: values are read back as written, bit for bit; odd names and numbers; complete or absent. */
#include "output/stats_fields.h"
#include "output/stats_file.h"
#include "output/stats_json.h"

#include <math.h>
#include <stddef.h>
#include <unistd.h>

#include "check.h"
#include "scratch.h"

static pupil_why why;

static char *slurp(const char *path)
{
    FILE *f = fopen(path, "rb");
    char *text = calloc(1, 1 << 16);
    CHECK_MSG(f && text && fread(text, 1, (1 << 16) - 1, f) > 0, "%s", path);
    if (f)
        fclose(f);
    return text;
}

static const char awkward[] = "a \"quoted\", name\nwith a line \xff and \xc3\xa9\x01.exr";

/* Every double is a different number without a short decimal form. */
static frame_log_entry sample_record(uint64_t frame)
{
    frame_log_entry r = {
        .frame = frame, .name = frame == 1 ? awkward : "plain.exr", .state = "adapting", .reason = "highlights"};
    for (size_t i = 0; i < pupil_stats_field_count; i++)
        if (pupil_stats_fields[i].kind == STATS_NUMBER) {
            double value = (check_uniform() - 0.5) * exp2((double)(check_random() % 200) - 100.0);
            memcpy((char *)&r + pupil_stats_fields[i].offset, &value, sizeof value);
        }
    if (frame == 2) {
        r.metered_ev = NAN;
        r.scale = -INFINITY;
        r.name = NULL;
    }
    return r;
}

static void write_three(const char *path, frame_log_entry records[3])
{
    pupil_stats_file *file = NULL;
    int opened = pupil_stats_file_open(&file, path, 1, &why) == 0;
    CHECK_MSG(opened, "%s", why.text);
    if (!opened)
        exit(check_end());
    for (uint64_t i = 0; i < 3; i++) {
        records[i] = sample_record(i);
        CHECK(pupil_stats_file_write(file, &records[i], &why) == 0);
    }
    CHECK(!scratch_exists(path));
    CHECK(pupil_stats_file_finish(file, &why) == 0);
    CHECK(scratch_exists(path));
}

/* Without a frame there is no file, and an earlier one stays. */
static void check_empty(void)
{
    pupil_stats_file *file = NULL;
    scratch_put(scratch("empty.csv"), "before");
    CHECK(pupil_stats_file_open(&file, scratch("empty.csv"), 1, &why) == 0);
    CHECK(pupil_stats_file_finish(file, &why) != 0 && strstr(why.text, "empty.csv: nothing was written"));
    char *text = slurp(scratch("empty.csv"));
    CHECK(strcmp(text, "before") == 0);
    free(text);
}

/* The text after "name": in a line, up to the next comma or brace. */
static double json_number(const char *line, const char *name, int *is_null)
{
    char key[64];
    snprintf(key, sizeof key, "\"%s\":", name);
    const char *at = strstr(line, key);
    CHECK_MSG(at != NULL, "no %s in %s", name, line);
    *is_null = at && strncmp(at + strlen(key), "null", 4) == 0;
    return at ? strtod(at + strlen(key), NULL) : 0.0;
}

static void check_json(void)
{
    frame_log_entry records[3];
    write_three(scratch("s.jsonl"), records);
    char *text = slurp(scratch("s.jsonl")), *rest = text;
    for (int i = 0; i < 3; i++) {
        char *line = strsep(&rest, "\n");
        CHECK(line && line[0] == '{' && line[strlen(line) - 1] == '}');
        for (size_t k = 0; line && k < pupil_stats_field_count; k++) {
            const pupil_stats_field *f = &pupil_stats_fields[k];
            int is_null;
            if (f->kind != STATS_NUMBER)
                continue;
            double want = pupil_stats_number(&records[i], f), got = json_number(line, f->name, &is_null);
            CHECK_MSG(isfinite(want) ? !is_null && memcmp(&want, &got, 8) == 0 : is_null, "%s %a %a", f->name, want,
                      got);
        }
    }
    CHECK(rest && *rest == 0); /* three lines, the last one terminated */
    free(text);
    text = slurp(scratch("s.jsonl"));
    CHECK(strstr(text, "\"frame\":2,\"name\":\"\"") != NULL);
    CHECK(strstr(text, "\"name\":\"a \\\"quoted\\\", name\\nwith a line \xef\xbf\xbd and \xc3\xa9\\u0001.exr\"") !=
          NULL);
    CHECK(strstr(text, "\"state\":\"adapting\",\"reason\":\"highlights\"}") != NULL);
    free(text);
}

static void check_csv(void)
{
    frame_log_entry records[3];
    write_three(scratch("s.CSV"), records);
    char *text = slurp(scratch("s.CSV"));
    CHECK(strncmp(text, "frame,name,time_s,", 18) == 0 && strstr(text, ",state,reason\r\n0,plain.exr,") != NULL);
    CHECK(strstr(text, "\r\n1,\"a \"\"quoted\"\", name\nwith a line \xff and \xc3\xa9\x01.exr\",") != NULL);
    char *at = strstr(text, "\r\n2,,");
    CHECK(at != NULL);
    for (size_t k = 2; at && k < pupil_stats_field_count; k++) {
        const pupil_stats_field *f = &pupil_stats_fields[k];
        at = strchr(k == 2 ? at + 4 : at + 1, ',');
        if (!at || f->kind != STATS_NUMBER)
            break;
        double want = pupil_stats_number(&records[2], f), got = strtod(at + 1, NULL);
        CHECK_MSG(isfinite(want) ? memcmp(&want, &got, 8) == 0 : at[1] == ',', "%s %a %a", f->name, want, got);
    }
    CHECK(at && strcmp(at, ",adapting,highlights\r\n") == 0);
    free(text);
}

/* A live camera's records have more fields, behind the others. */
static void check_live(const char *path)
{
    pupil_stats_file *file = NULL;
    frame_log_entry r = sample_record(0);
    r.live = 1;
    r.sequence = UINT64_MAX;
    r.lost = 3;
    r.asked_gain = NAN;
    r.sensor = "converged";
    r.day_night = "night";
    CHECK(pupil_stats_file_open(&file, scratch(path), 1, &why) == 0);
    CHECK(pupil_stats_file_write(file, &r, &why) == 0);
    CHECK(pupil_stats_file_finish(file, &why) == 0);
    char *text = slurp(scratch(path));
    const int csv = strstr(path, ".csv") != NULL;
    CHECK_MSG(strstr(text, csv ? ",adapting,highlights,18446744073709551615,3,0,0,"
                               : "\"reason\":\"highlights\",\"sequence\":1844"),
              "%s", text);
    CHECK(strstr(text, csv ? ",state,reason,sequence,lost,flagged,late," : "\"lost\":3,") != NULL);
    CHECK(strstr(text, csv ? ",converged,,night\r\n"
                           : "\"sensor\":\"converged\",\"sensor_reason\":\"\",\"day_night\":\"night\"}\n") != NULL);
    CHECK(csv || strstr(text, "\"asked_gain\":null") != NULL);
    free(text);
}

static void check_refusals(void)
{
    pupil_stats_file *file = NULL;
    CHECK(pupil_stats_file_open(&file, scratch("s.txt"), 1, &why) != 0 && strstr(why.text, ".csv") != NULL);
    CHECK(pupil_stats_file_open(&file, ".csv", 1, &why) != 0); /* a hidden file without an extension */
    CHECK(pupil_stats_file_open(&file, scratch("none/s.csv"), 1, &why) != 0 && strstr(why.text, "none") != NULL);
    CHECK(file == NULL);
    int before = scratch_entries(scratch_folder);
    CHECK(pupil_stats_file_open(&file, scratch("gone.csv"), 1, &why) == 0);
    pupil_stats_file_discard(file);
    CHECK(scratch_entries(scratch_folder) == before);
    pupil_stats_file_discard(NULL);
}

/* A full disk: /dev/full takes the place of standard output. */
static void check_full(void)
{
    pupil_stats_file *file = NULL;
    frame_log_entry r = sample_record(0);
    fflush(stdout);
    int kept = dup(1);
    FILE *full = fopen("/dev/full", "w");
    CHECK(full && dup2(fileno(full), 1) == 1);
    CHECK(pupil_stats_file_open(&file, "-", 1, &why) == 0);
    int failed = pupil_stats_file_write(file, &r, &why);
    pupil_stats_file_discard(file);
    dup2(kept, 1);
    close(kept);
    fclose(full);
    clearerr(stdout);
    CHECK_MSG(failed && strstr(why.text, "standard output") != NULL, "%s", why.text);
}

/* docs/stats.md must name every field. */
static void check_docs(void)
{
#ifdef PUPIL_SOURCE_DIR
    char *text = slurp(PUPIL_SOURCE_DIR "/docs/stats.md");
    for (size_t i = 0; i < pupil_stats_live_field_count; i++) {
        char cell[64];
        snprintf(cell, sizeof cell, "\n| `%s` |", pupil_stats_fields[i].name);
        CHECK_MSG(strstr(text, cell) != NULL, "%s is not in docs/stats.md", pupil_stats_fields[i].name);
    }
    free(text);
#endif
}

/* .json is one array of the lines of .jsonl; a truncated one is terminated, too. */
static void check_array(void)
{
    frame_log_entry records[3];
    char joined[1 << 15] = "[\n", line[1 << 14];
    write_three(scratch("lines.jsonl"), records);
    pupil_stats_file *file = NULL;
    CHECK(pupil_stats_file_open(&file, scratch("array.json"), 1, &why) == 0);
    for (int i = 0; i < 3; i++)
        CHECK(pupil_stats_file_write(file, &records[i], &why) == 0);
    CHECK(pupil_stats_file_finish(file, &why) == 0);
    char *lines = slurp(scratch("lines.jsonl")), *array = slurp(scratch("array.json"));
    const char *from = lines;
    for (int i = 0; i < 3; i++, from = strchr(from, '\n') + 1) {
        snprintf(line, sizeof line, "%s%.*s", i ? ",\n" : "", (int)strcspn(from, "\n"), from);
        strncat(joined, line, sizeof joined - strlen(joined) - 1);
    }
    strncat(joined, "\n]\n", sizeof joined - strlen(joined) - 1);
    CHECK_MSG(strcmp(array, joined) == 0, "%.200s", array);
    free(lines);
    free(array);
    CHECK(pupil_stats_file_open(&file, scratch("array.txt"), 1, &why) != 0 &&
          strstr(why.text, ".jsonl, .json or .csv"));
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    scratch_begin();
    if (pupil_stats_json_check("s.jsonl", &why) == 0)
        check_json();
    if (pupil_stats_json_check("s.json", &why) == 0)
        check_array();
    check_csv();
    check_empty();
    check_live("live.csv");
    if (pupil_stats_json_check("s.jsonl", &why) == 0)
        check_live("live.jsonl");
    check_refusals();
    if (pupil_stats_json_check("-", &why) == 0)
        check_full();
    check_docs();
    scratch_clear(scratch_folder);
    return check_end();
}

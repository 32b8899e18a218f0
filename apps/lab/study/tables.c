/* The tables as Markdown and as a page, in the layout of the original study. Each formula and case has five by four
 * cells, one for each weight. A cell has the frames of the four thresholds. */
#include "study.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "file/common/pending.h"
#include "file/sink/sink_common.h"
#include "refuse.h"
#include "report/page.h"
#include "report/style.h"

#define COLUMNS 5

static const char *const case_text[STUDY_CASES] = {
    "the lamp is switched on at frame 30",
    "the lamp is switched off at frame 30",
    "on at frame 30, off at frame 60",
    "off at frame 30, on at frame 60",
};

static const char *const formula_text[STUDY_FORMULAS] = {
    "arithmetic average of key / L",
    "arithmetic average of L",
    "geometric average of key / L",
    "geometric average of L",
};

static double ln_r(const study_result *r)
{
    return (r->lights->ev[1] - r->lights->ev[0]) * M_LN2;
}

static const char *state_text(const study_result *r)
{
    return r->float32 ? "binary32, as in the original study" : "the library's";
}

/* --- Markdown --- */

static void markdown_facts(FILE *out, const study_result *r)
{
    const study_cells *c = r->cells;
    fprintf(
        out,
        "# Temporal tone mapping: when the picture has arrived\n\n    %s\n\n"
        "Scene `%s`, %lux%lu, %u frames at %u a second; state: %s. Log-average luminance %.6g (off), %.6g (on): "
        "r = %.3f, %.2f stops.\n"
        "A cell holds the first frame whose 8-bit picture is within D = %llu, %llu, %llu, %llu of its target; %u: not "
        "within the minute.\n"
        "%llu pictures were mapped and compared. The library's own map of the two targets has another code in %llu of "
        "%llu samples (at most %u off).\n\n",
        r->command, r->scene, (unsigned long)c->width, (unsigned long)c->height, STUDY_FRAMES, STUDY_FPS, state_text(r),
        exp2(r->lights->ev[0]), exp2(r->lights->ev[1]), exp(ln_r(r)), r->lights->ev[1] - r->lights->ev[0],
        (unsigned long long)c->threshold[0], (unsigned long long)c->threshold[1], (unsigned long long)c->threshold[2],
        (unsigned long long)c->threshold[3], STUDY_LAST, (unsigned long long)r->renders,
        (unsigned long long)(r->library_differ[0] + r->library_differ[1]), (unsigned long long)r->samples,
        r->library_largest);
    fputs("| final light | u\\* for D | | | |\n|---|---|---|---|---|\n|", out);
    for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
        fprintf(out, " | %llu", (unsigned long long)c->threshold[t]);
    fputs(" |\n", out);
    for (int light = 1; light >= 0; light--) {
        fprintf(out, "| %s", light ? "on" : "off");
        for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
            fprintf(out, " | %.4g", c->u_star[light][t]);
        fputs(" |\n", out);
    }
}

void study_markdown(FILE *out, const study_result *r)
{
    markdown_facts(out, r);
    fputs("\n## Acceptance\n\n| test | what | checked | violations |\n|---|---|--:|--:|\n", out);
    for (unsigned i = 0; i < STUDY_TESTS; i++)
        fprintf(out, "| %s | %s | %lu | %lu |\n", r->tests[i].name, r->tests[i].text, r->tests[i].checked,
                r->tests[i].violations);
    fputs("\n## Weights\n\n| | | | | |\n|--:|--:|--:|--:|--:|\n", out);
    for (unsigned w = 0; w < STUDY_WEIGHTS; w++)
        fprintf(out, "| %.3f%s", study_weights[w], w % COLUMNS == COLUMNS - 1 ? " |\n" : " ");
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++) {
            fprintf(out, "\n## Case %u Formula %u\n\n%s; %s\n\n| | | | | |\n|--:|--:|--:|--:|--:|\n", c + 1, f + 1,
                    case_text[c], formula_text[f]);
            for (unsigned w = 0; w < STUDY_WEIGHTS; w++) {
                const uint16_t *cell = r->cells->frame[f][c][w];
                fprintf(out, "| %u<br>%u<br>%u<br>%u%s", cell[0], cell[1], cell[2], cell[3],
                        w % COLUMNS == COLUMNS - 1 ? " |\n" : " ");
            }
        }
}

/* --- the page --- */

static void page_facts(FILE *out, const study_result *r)
{
    fputs(REPORT_MARK "<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
                      "'none'; img-src 'self'; style-src 'unsafe-inline'\">\n"
                      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                      "<title>Temporal tone mapping: when the picture has arrived</title>\n<style>\n",
          out);
    fputs(report_style, out);
    fputs("th{padding:6px 12px;text-align:left}.cells td{text-align:right;font-variant-numeric:tabular-nums}"
          ".cells small{color:var(--soft)}.late{color:var(--soft)}.bad{color:var(--accent);font-weight:600}\n</style>\n"
          "<main>\n<h1>Temporal tone mapping: when the picture has arrived</h1>\n<pre><code>",
          out);
    report_text(out, r->command);
    fputs("</code></pre>\n<p>Scene ", out);
    report_text(out, r->scene);
    fprintf(
        out,
        ", %lux%lu, %u frames at %u a second; state: %s. Log-average luminance %.6g (off), %.6g (on): r = %.3f, %.2f "
        "stops.</p>\n<p class=\"hint\">A cell holds the weight, then the first frames whose 8-bit picture is within "
        "D = %llu, %llu, %llu, %llu of its target; %u: not within the minute.</p>\n",
        (unsigned long)r->cells->width, (unsigned long)r->cells->height, STUDY_FRAMES, STUDY_FPS, state_text(r),
        exp2(r->lights->ev[0]), exp2(r->lights->ev[1]), exp(ln_r(r)), r->lights->ev[1] - r->lights->ev[0],
        (unsigned long long)r->cells->threshold[0], (unsigned long long)r->cells->threshold[1],
        (unsigned long long)r->cells->threshold[2], (unsigned long long)r->cells->threshold[3], STUDY_LAST);
}

static void page_acceptance(FILE *out, const study_result *r)
{
    fputs("<h2>Acceptance</h2>\n<div class=\"scroll\"><table><tr><th>test<th>what<th>checked<th>violations</tr>\n",
          out);
    for (unsigned i = 0; i < STUDY_TESTS; i++) {
        fprintf(out, "<tr><td>%s<td>", r->tests[i].name);
        report_text(out, r->tests[i].text);
        fprintf(out, "<td class=\"v\">%lu<td class=\"v%s\">%lu</tr>\n", r->tests[i].checked,
                r->tests[i].violations ? " bad" : "", r->tests[i].violations);
    }
    fputs("</table></div>\n", out);
}

static void page_cells(FILE *out, const uint16_t cells[STUDY_WEIGHTS][STUDY_THRESHOLDS])
{
    fputs("<div class=\"scroll\"><table class=\"cells\">\n", out);
    for (unsigned w = 0; w < STUDY_WEIGHTS; w++) {
        fprintf(out, "%s<td><small>%.3f</small>", w % COLUMNS ? "" : "<tr>", study_weights[w]);
        for (unsigned t = 0; t < STUDY_THRESHOLDS; t++)
            fprintf(out, cells[w][t] >= STUDY_LAST ? "<br><span class=\"late\">%u</span>" : "<br>%u", cells[w][t]);
        fputs(w % COLUMNS == COLUMNS - 1 ? "</tr>\n" : "", out);
    }
    fputs("</table></div>\n", out);
}

void study_html(FILE *out, const study_result *r)
{
    page_facts(out, r);
    page_acceptance(out, r);
    fputs("<h2>The state over time</h2>\n", out);
    for (unsigned c = 0; c < STUDY_CASES; c++)
        fprintf(out,
                "<p>Case %u: %s</p>\n<div class=\"scroll\"><img class=\"plot\" src=\"level-case%u.svg\" alt=\"u over "
                "time\"></div>\n",
                c + 1, case_text[c], c + 1);
    for (unsigned f = 0; f < STUDY_FORMULAS; f++)
        for (unsigned c = 0; c < STUDY_CASES; c++) {
            fprintf(out, "<h2>Case %u Formula %u</h2>\n<p class=\"hint\">%s; %s</p>\n", c + 1, f + 1, case_text[c],
                    formula_text[f]);
            page_cells(out, r->cells->frame[f][c]);
        }
    fputs("</main>\n<footer>study.csv and study.md hold the same tables.</footer>\n", out);
}

/* --- files --- */

int study_write(const char *path, study_writer *writer, const study_result *result, pupil_why *why)
{
    pupil_pending pending;
    if (pupil_pending_file(&pending, path, 1, why))
        return -1;
    FILE *f = pupil_pending_stream(&pending);
    int failed = !f;
    if (f) {
        writer(f, result);
        failed = ferror(f) != 0;
        failed |= fclose(f) != 0;
    }
    if (failed)
        pupil_refuse(why, "%s: cannot be written: %s", path, strerror(errno));
    else
        failed = pupil_pending_commit(&pending, why);
    pupil_pending_discard(&pending);
    return failed ? -1 : 0;
}

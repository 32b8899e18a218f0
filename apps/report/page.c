#include "page.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "style.h"

void report_text(FILE *out, const char *text)
{
    for (; text && *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '&')
            fputs("&amp;", out);
        else if (c == '<')
            fputs("&lt;", out);
        else if (c == '>')
            fputs("&gt;", out);
        else if (c == '"')
            fputs("&quot;", out);
        else if (c == '\'')
            fputs("&#39;", out);
        else
            putc((c < 0x20 && c != '\n') || c == 0x7f ? ' ' : c, out);
    }
}

/* --- figures that the records give --- */

typedef struct figures {
    double ev_low, ev_high, level; /* metered light; mean log2 of the display's level */
    double black, clipped, bad, zero, full, most_zero, most_full;
    double read_us, process_us, write_us;
    double length_s; /* from the first frame to the last, plus the last one's own duration */
} figures;

static double larger(double a, double b)
{
    return b > a ? b : a;
}

static figures measure(const pupil_report_page *page)
{
    figures f = {.ev_low = INFINITY, .ev_high = -INFINITY};
    double n = page->record_count ? (double)page->record_count : 1.0;
    for (size_t i = 0; i < page->record_count; i++) {
        const frame_log_entry *r = &page->records[i];
        if (isfinite(r->metered_ev)) {
            f.ev_low = r->metered_ev < f.ev_low ? r->metered_ev : f.ev_low;
            f.ev_high = larger(f.ev_high, r->metered_ev);
        }
        f.level += log2(larger(r->output_level, 0x1p-32)) / n;
        f.black += r->black_share / n;
        f.clipped += r->clipped_share / n;
        f.bad += r->bad_share / n;
        f.zero += r->output_black_share / n;
        f.full += r->output_white_share / n;
        f.most_zero = larger(f.most_zero, r->output_black_share);
        f.most_full = larger(f.most_full, r->output_white_share);
        f.read_us += r->read_us;
        f.process_us += r->process_us;
        f.write_us += r->write_us;
    }
    if (page->record_count > 1)
        f.length_s = (page->records[page->record_count - 1].time_s - page->records[0].time_s) * n / (n - 1.0);
    return f;
}

/* --- the head --- */

static void fact(FILE *out, const char *what, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void fact(FILE *out, const char *what, const char *format, ...)
{
    va_list arguments;
    fputs("<li><b>", out);
    va_start(arguments, format);
    vfprintf(out, format, arguments);
    va_end(arguments);
    fprintf(out, "</b><span>%s</span></li>\n", what);
}

void report_head(FILE *out, const pupil_report_page *page, const report_sums *sums)
{
    figures f = measure(page);
    /* With this policy the browser ensures that nothing is loaded and nothing runs. */
    fputs(REPORT_MARK "<meta charset=\"utf-8\">\n"
                      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
                      "media-src data:; style-src 'unsafe-inline'\">\n"
                      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>",
          out);
    report_text(out, page->title);
    fprintf(out, "</title>\n<style>\n%s</style>\n<main>\n<h1>", report_style);
    report_text(out, page->title);
    fputs("</h1>\n", out);
    if (page->command) {
        fputs("<pre><code>", out);
        report_text(out, page->command);
        fputs("</code></pre>\n", out);
    }
    fputs("<ul class=\"facts\">\n", out);
    if (sums->sizes_differ)
        fact(out, "frames, sizes differ", "%zu", page->record_count);
    else
        fact(out, "frames &times; width &times; height", "%zu &times; %lu &times; %lu", page->record_count,
             (unsigned long)sums->width, (unsigned long)sums->height);
    if (f.length_s > 0.0)
        fact(out, "length", "%.2f s", f.length_s);
    if (f.ev_low <= f.ev_high)
        fact(out, "metered light, EV", "%+.1f &hellip; %+.1f", f.ev_low, f.ev_high);
    if (f.process_us > 0.0)
        fact(out, "frames a second, without reading and writing", "%.0f",
             1e6 * (double)page->record_count / f.process_us);
    fputs("</ul>\n", out);
    if (page->note) {
        fputs("<p class=\"note\">", out);
        report_text(out, page->note);
        fputs("</p>\n", out);
    }
}

void report_caption(FILE *out, const report_picture *picture, int stills)
{
    const char *slash = strrchr(picture->name, '/'), *name = slash ? slash + 1 : picture->name;
    fputs("<figcaption><b>", out);
    if (stills)
        report_text(out, name);
    else
        fprintf(out, "frame %llu", (unsigned long long)picture->frame);
    fputs("</b>", out);
    if (!stills)
        fprintf(out, " &middot; %.2f s", picture->time_s);
    fprintf(out, "<br>metered %+.2f EV, adapted %+.2f</figcaption>", picture->metered_ev, picture->adapted_ev);
}

/* --- the tables --- */

static void row(FILE *out, const pupil_report_row *r)
{
    fputs("<tr><td>", out);
    report_text(out, r->label);
    if (r->command) {
        fputs("<code>", out);
        report_text(out, r->command);
        fputs("</code>", out);
    }
    fputs("</td><td class=\"v\">", out);
    report_text(out, r->value);
    fputs("</td><td class=\"u\">", out);
    report_text(out, r->unit);
    fputs("</td></tr>\n", out);
}

static void number(FILE *out, const char *label, const char *unit, const char *format, double value)
    __attribute__((format(printf, 4, 0)));

static void number(FILE *out, const char *label, const char *unit, const char *format, double value)
{
    char text[64];
    snprintf(text, sizeof text, format, value);
    row(out, &(pupil_report_row){label, text, unit, NULL});
}

static void share(FILE *out, const char *label, double mean, double most)
{
    char text[64];
    snprintf(text, sizeof text, "%.3g / %.3g", 100.0 * mean, 100.0 * most);
    row(out, &(pupil_report_row){label, text, "%", NULL});
}

/* The number of frames that had a reason, if any. */
static void reason(FILE *out, const pupil_report_page *page, const char *label, const char *word)
{
    size_t frames = 0;
    for (size_t i = 0; i < page->record_count; i++)
        frames += page->records[i].reason && strcmp(page->records[i].reason, word) == 0;
    if (frames)
        number(out, label, "", "%.0f", (double)frames);
}

static void own_figures(FILE *out, const pupil_report_page *page, const report_sums *sums)
{
    figures f = measure(page);
    double ns = sums->pixels ? 1e3 / (double)sums->pixels : 0.0;
    number(out, "frames", "", "%.0f", (double)page->record_count);
    if (f.ev_low <= f.ev_high)
        number(out, "range of the metered light", "stops", "%.2f", f.ev_high - f.ev_low);
    number(out, "display log-average, mean", "linear", "%.4f", exp2(f.level));
    share(out, "display samples at 0: mean / worst frame", f.zero, f.most_zero);
    share(out, "display samples at 255: mean / worst frame", f.full, f.most_full);
    reason(out, page, "frames that highlights make darker (--highlights)", "highlights");
    reason(out, page, "frames too dark to be brightened further (--amplification)", "amplification");
    reason(out, page, "frames mostly at or below the floor (--floor)", "range");
    number(out, "input pixels counted as black", "%", "%.3g", 100.0 * f.black);
    number(out, "input pixels counted as clipped", "%", "%.3g", 100.0 * f.clipped);
    number(out, "input pixels NaN or infinite", "%", "%.3g", 100.0 * f.bad);
    number(out, "read", "ns / pixel", "%.2f", f.read_us * ns);
    number(out, "meter + adapt + map", "ns / pixel", "%.2f", f.process_us * ns);
    if (f.write_us * ns >= 0.01) /* otherwise the page is the only output */
        number(out, "write", "ns / pixel", "%.2f", f.write_us * ns);
}

void report_tables(FILE *out, const pupil_report_page *page, const report_sums *sums)
{
    fputs("<div class=\"tables\">\n<section>\n<h2>Figures of this run</h2>\n<table>\n", out);
    own_figures(out, page, sums);
    for (size_t i = 0; i < page->figure_count; i++)
        row(out, &page->figures[i]);
    fputs("</table>\n</section>\n", out);
    if (page->setting_count) {
        fputs("<section>\n<h2>Settings</h2>\n<table>\n", out);
        for (size_t i = 0; i < page->setting_count; i++)
            row(out, &page->settings[i]);
        fputs("</table>\n</section>\n", out);
    }
    fputs("</div>\n", out);
}

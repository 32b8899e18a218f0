/* --help: two short options share a line, so that it fits a screen. */
#include <string.h>

#include "option_table.h"

enum { WIDTH = 90, TEXT_AT = 24, SECOND_AT = 48, LINE_BYTES = 512 };

/* "-o, --out PATH", indented if there is no letter, except as the second on a line. */
static int head(const option_row *row, int indented, char *text)
{
    char letter[8] = "";
    if (row->letter)
        snprintf(letter, sizeof letter, "-%c, ", row->letter);
    else if (indented)
        strcpy(letter, "    ");
    return snprintf(text, LINE_BYTES, "%s%s--%s%s%s", indented ? "  " : "", letter, row->name, row->value ? " " : "",
                    row->value ? row->value : "");
}

static void entry(const option_row *row, int indented, char *text)
{
    int length = head(row, indented, text);
    const int gap = indented && length < TEXT_AT - 1 ? TEXT_AT - length : 2;
    length += snprintf(text + length, LINE_BYTES - (size_t)length, "%*s%s", gap, "", row->help);
    for (const char *c = row->words; c && *c; c++)
        length += snprintf(text + length, LINE_BYTES - (size_t)length, "%s%c", c == row->words ? ": " : "",
                           *c == '|' ? ' ' : *c);
    if (row->initial)
        snprintf(text + length, LINE_BYTES - (size_t)length, " (%s)", row->initial);
}

/* A line, wrapped between words if it is too long. */
static void put_wrapped(const char *text, int indent, FILE *out)
{
    size_t length = strlen(text);
    size_t width = WIDTH;
    while (length > width) {
        size_t cut = width;
        while (cut > 8 && text[cut] != ' ')
            cut--;
        fprintf(out, "%.*s\n%*s", (int)cut, text, indent, "");
        text += cut + 1;
        length -= cut + 1;
        width = WIDTH - (size_t)indent;
    }
    fprintf(out, "%s\n", text);
}

static void put_rows(const option_command *command, size_t first, size_t count, FILE *out)
{
    char line[LINE_BYTES], second[LINE_BYTES];
    size_t base;
    for (size_t n = first; n < first + count; n++) {
        entry(options_row(command, n, &base), 1, line);
        *second = 0;
        if (n + 1 < first + count)
            entry(options_row(command, n + 1, &base), 0, second);
        const size_t at = strlen(line) + 2 < SECOND_AT ? SECOND_AT : strlen(line) + 2;
        if (*second && at + strlen(second) <= WIDTH) {
            fprintf(out, "%-*s%s\n", (int)at, line, second);
            n++;
        } else
            put_wrapped(line, TEXT_AT, out);
    }
}

static void put_brief(const option_command *command, size_t first, size_t count, FILE *out)
{
    char name[LINE_BYTES];
    size_t base;
    int column = 0;
    for (size_t n = first; n < first + count; n++) {
        const int length = head(options_row(command, n, &base), 0, name);
        if (column && column + 2 + length > WIDTH) {
            fputc('\n', out);
            column = 0;
        }
        column += fprintf(out, "%s%s", column ? "  " : "      ", name);
    }
    fputc('\n', out);
}

static void put_usage(const option_command *command, FILE *out)
{
    const char *before = "usage:";
    for (const char *line = command->usage; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        const int length = (int)strcspn(line, "\n");
        fprintf(out, "%-6s pupil %s%s%.*s\n", before, command->name, length ? " " : "", length, line);
        before = "";
    }
}

/* Where the rows of a title end: further groups of the same kind may continue with them. */
static const option_group *last_of(const option_group *g, size_t *rows)
{
    for (*rows = g->rows; g[1].rows && !g[1].title && !g[1].brief == !g->brief; g++)
        *rows += g[1].rows;
    return g;
}

void options_help(const option_command *command, FILE *out)
{
    size_t first = 0, rows;
    put_usage(command, out);
    fprintf(out, "%s\n", command->about);
    for (const option_group *g = command->groups; g && g->rows; g++) {
        const int refers = g->brief && *g->brief;
        if (g->title)
            fprintf(out, "%s%s%s\n", g->title, refers ? ", as of pupil " : "", refers ? g->brief : "");
        g = last_of(g, &rows);
        if (g->brief)
            put_brief(command, first, rows, out);
        else
            put_rows(command, first, rows + !g[1].rows /* and --help */, out);
        first += rows;
    }
    if (command->exits)
        fprintf(out, "exit: %s\n", command->exits);
}

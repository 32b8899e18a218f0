/* The man page of the program: the commands' own texts, and their options. */
#include <ctype.h>
#include <string.h>

#include "option_table.h"
#include "pupil/pupil.h"

enum { WIDTH = 110 };

typedef struct entry {
    const char *term, *text;
} entry;

static const entry inputs[] = {
    {".exr, .hdr, .pfm, .png, .jpg, .tif, .webp, .bmp, .dng",
     "Stills, and raw files of cameras. Several inputs follow one another in the order given."},
    {"a folder, or a pattern in quotes ('frames/*.exr')",
     "Every still in it, in natural order (frame2 before frame10)."},
    {"a video file, or - for standard input",
     "Decoded to linear light: PQ (1.0 is 100 cd/m2), HLG (scene light), or SDR by its tags."},
    {"pan:FILE[,key=value...]",
     "A camera that moves through an equirectangular panorama (.hdr, .exr). Keys: path, fov, size, duration."},
    {"a folder with a recording.json",
     "A recording of pupil record or pupil run --record: the camera's frames with their "
     "times, exposures and gains, bit for bit."},
    {"raw:FILE,format=RG10,size=WxH[,key=value...]", "Frames without a header; PUPIL REPLAY has the keys."},
    {"synth:walk", "A rendered clip: from a dark room to a bright window and back, with a flash on the way."},
    {"synth:SCENE",
     "The frames of a scene: one that is built in (candle, lamps, leds, meadow, room, room-radiosity, stars, "
     "table, walk), or a recipe by its path. fixtures/scenes/README.md describes recipes."},
    {"v4l2:CAMERA", "A camera, by its path, its number or its name (pupil list shows them). A path /dev/video* or "
                    "/dev/v4l/* needs no v4l2: in front."},
    {"libcamera:CAMERA", "A camera of libcamera, by its id or a part of that, by its model, or by its number from 0; "
                         "empty: the first one. Raw frames where it has them."},
    {NULL, NULL},
};

static const char examples[] = "pupil replay synth:walk -o walk.mp4 --report report\n"
                               "pupil replay 'shots/*.exr' --fps 24 --trim 5,95 -o shots.mkv --stats shots.jsonl\n"
                               "pupil replay hdr10.mkv -o - --quiet | mpv -\n"
                               "pupil run --view --mains 50 --stats live.jsonl\n"
                               "pupil run -d 0 --mode sensor --size 1280x720 -o - | mpv -\n"
                               "pupil render room -n 300 -o room.mp4\n"
                               "pupil replay pan:street.hdr,fov=60,duration=20 --plot pan.svg -o pan.mp4\n";

/* A character as itself: troff reads - as a hyphen and \ as an escape. */
static void put_char(char c, FILE *out)
{
    if (c == '-' || c == '\\')
        fputc('\\', out);
    fputc(c, out);
}

static void put_text(const char *text, size_t length, FILE *out)
{
    for (size_t i = 0; i < length; i++)
        put_char(text[i], out);
}

/* An option's name is bold, the text after it is not. */
static void put_word(const char *word, size_t length, int first, FILE *out)
{
    size_t name = 0;
    if (first && (*word == '.' || *word == '\''))
        fputs("\\&", out); /* otherwise it is a troff request */
    if (*word == '-' && length > 1)
        while (name < length && (word[name] == '-' || isalnum((unsigned char)word[name])))
            name++;
    if (name) {
        fputs("\\fB", out);
        put_text(word, name, out);
        fputs("\\fR", out);
    }
    put_text(word + name, length - name, out);
}

/* Words in lines; an empty line begins a paragraph. */
static void put_prose(const char *text, FILE *out)
{
    size_t column = 0;
    while (*text) {
        const size_t length = strcspn(text, " \n");
        if (column && column + 1 + length > WIDTH) {
            fputc('\n', out);
            column = 0;
        } else if (column)
            fputc(' ', out);
        put_word(text, length, column == 0, out);
        column += length + (column > 0);
        text += length;
        if (strncmp(text, "\n\n", 2) == 0) {
            fputs("\n.PP\n", out);
            column = 0;
        }
        text += strspn(text, " \n");
    }
    fputc('\n', out);
}

static void put_entries(const entry *e, FILE *out)
{
    for (; e->term; e++) {
        fputs(".TP\n", out);
        put_word(e->term, strlen(e->term), 1, out);
        fputc('\n', out);
        put_prose(e->text, out);
    }
}

static void put_option(const option_row *row, FILE *out)
{
    char text[4096];
    fputs(".TP\n", out);
    if (row->letter) {
        fputs("\\fB\\-", out);
        fprintf(out, "%c\\fR, ", row->letter);
    }
    fputs("\\fB\\-\\-", out);
    put_text(row->name, strlen(row->name), out);
    fputs("\\fR", out);
    if (row->value) {
        fputs(" \\fI", out);
        put_text(row->value, strlen(row->value), out);
        fputs("\\fR", out);
    }
    fputc('\n', out);
    int length = snprintf(text, sizeof text, "%s", row->help);
    for (const char *c = row->words; c && *c; c++)
        length += snprintf(text + length, sizeof text - (size_t)length, "%s%c", c == row->words ? ": " : "",
                           *c == '|' ? ' ' : *c);
    if (row->initial)
        length += snprintf(text + length, sizeof text - (size_t)length, " (%s)", row->initial);
    snprintf(text + length, sizeof text - (size_t)length, ".%s%s", row->more ? " " : "", row->more ? row->more : "");
    put_prose(text, out);
}

static void put_options(const option_command *command, FILE *out)
{
    char text[512];
    for (const option_group *g = command->groups; g && g->rows; g++) {
        if (g->title) {
            fputs(".SS ", out);
            put_text(g->title, strlen(g->title), out);
            fputc('\n', out);
        }
        if (!g->brief || !*g->brief) {
            for (size_t i = 0; i < g->rows; i++)
                put_option(&g->row[i], out);
            continue;
        }
        int length = snprintf(text, sizeof text, "As of pupil %s:", g->brief);
        for (size_t i = 0; i < g->rows; i++)
            length += snprintf(text + length, sizeof text - (size_t)length, "%s --%s", i ? "," : "", g->row[i].name);
        snprintf(text + length, sizeof text - (size_t)length, ".\n\n");
        put_prose(text, out);
    }
}

static void put_usage(const option_command *const *commands, FILE *out)
{
    for (; *commands; commands++) {
        if ((*commands)->parts) {
            put_usage((*commands)->parts, out);
            continue;
        }
        for (const char *line = (*commands)->usage; *line; line += strcspn(line, "\n"), line += *line == '\n') {
            fprintf(out, "\\fBpupil %s\\fR ", (*commands)->name);
            put_text(line, strcspn(line, "\n"), out);
            fputs("\n.br\n", out);
        }
    }
}

static void put_commands(const option_command *const *commands, FILE *out)
{
    for (; *commands; commands++) {
        if ((*commands)->parts) {
            put_commands((*commands)->parts, out);
            continue;
        }
        if (!(*commands)->groups)
            continue; /* not in this build */
        fputs(".SH PUPIL ", out);
        for (const char *c = (*commands)->name; *c; c++)
            fputc(toupper((unsigned char)*c), out);
        fputc('\n', out);
        put_prose((*commands)->manual, out);
        put_options(*commands, out);
        fprintf(out, ".PP\nExit status: %s.\n", (*commands)->exits);
    }
}

void options_manual(const option_command *const *commands, FILE *out)
{
    fprintf(out,
            ".\\\" made by 'pupil help --man'\n"
            ".TH PUPIL 1 \"\" \"pupil %d.%d.%d\" \"User Commands\"\n"
            ".SH NAME\npupil \\- camera\\-style auto\\-exposure for HDR frames\n.SH SYNOPSIS\n",
            PUPIL_VERSION_MAJOR, PUPIL_VERSION_MINOR, PUPIL_VERSION_PATCH);
    put_usage(commands, out);
    fputs("\\fBpupil help\\fR [COMMAND]\n.br\n\\fBpupil version\\fR\n.br\n\\fBpupil completion bash\\fR\n", out);
    fputs(".SH DESCRIPTION\n", out);
    put_prose(
        "pupil takes HDR frames through metering, adaptation over time and mapping, as a camera's auto-exposure "
        "does. pupil replay takes recorded frames, pupil run those of a live camera. Nothing has to be "
        "configured.\n\n"
        "pupil render, study, bench and sim are for work on pupil itself: only builds with PUPIL_LAB=ON have them.\n\n"
        "An option that is given more than once has its last value, unless it is repeatable.",
        out);
    fputs(".SH INPUTS\n", out);
    put_prose("Of pupil replay and pupil record:", out);
    put_entries(inputs, out);
    put_commands(commands, out);
    fputs(".SH EXIT STATUS\n", out);
    put_prose(
        "0 done; 1 failed; 2 the command line is wrong; 3 done, but frames were skipped or lost; 130 interrupted.",
        out);
    fputs(".SH ENVIRONMENT\n.TP\nTERM\nUnset or dumb: no progress line.\n.SH EXAMPLES\n.nf\n", out);
    put_text(examples, sizeof examples - 1, out);
    fputs(".fi\n.SH SEE ALSO\n.BR ffmpeg (1),\n.BR gnuplot (1)\n", out);
}

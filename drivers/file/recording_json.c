/* drivers/file/recording_json.c: RFC 8259, of which a recording needs one object with plain members. */
#include "file/recording_json.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lists and objects in one another at most: more is no recording. */
#define DEPTH_MOST 16

void pupil_json_begin(pupil_json *json, const char *text)
{
    *json = (pupil_json){.at = text, .line = 1};
}

static char peek(pupil_json *j)
{
    for (; *j->at == ' ' || *j->at == '\t' || *j->at == '\r' || *j->at == '\n'; j->at++)
        j->line += *j->at == '\n';
    return *j->at;
}

static int accept(pupil_json *j, char c)
{
    if (peek(j) != c)
        return 0;
    j->at++;
    return 1;
}

static int pass_string(pupil_json *j)
{
    if (!accept(j, '"'))
        return -1;
    for (; *j->at != '"'; j->at++) {
        if ((unsigned char)*j->at < ' ') /* the end of the text too */
            return -1;
        if (*j->at == '\\' && (unsigned char)*++j->at < ' ')
            return -1;
    }
    j->at++;
    return 0;
}

static int pass_digits(pupil_json *j)
{
    const size_t digits = strspn(j->at, "0123456789");
    j->at += digits;
    return digits ? 0 : -1;
}

static int pass_number(pupil_json *j)
{
    if (*j->at == '-')
        j->at++;
    if (*j->at == '0' ? (j->at++, 0) : pass_digits(j))
        return -1;
    if (*j->at == '.' && (j->at++, pass_digits(j)))
        return -1;
    if (*j->at != 'e' && *j->at != 'E')
        return 0;
    j->at++;
    if (*j->at == '+' || *j->at == '-')
        j->at++;
    return pass_digits(j);
}

static int pass_scalar(pupil_json *j)
{
    static const char *const words[] = {"true", "false", "null"};
    const char c = peek(j);
    if (c == '"')
        return pass_string(j);
    if (c == '-' || (c >= '0' && c <= '9'))
        return pass_number(j);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strncmp(j->at, words[i], strlen(words[i])) == 0) {
            j->at += strlen(words[i]);
            return 0;
        }
    return -1;
}

static int pass_value(pupil_json *j, int depth)
{
    const char c = peek(j), end = c == '[' ? ']' : '}';
    if (c != '[' && c != '{')
        return pass_scalar(j);
    if (depth >= DEPTH_MOST)
        return -1;
    j->at++;
    if (accept(j, end))
        return 0;
    do
        if ((c == '{' && (pass_string(j) || !accept(j, ':'))) || pass_value(j, depth + 1))
            return -1;
    while (accept(j, ','));
    return accept(j, end) ? 0 : -1;
}

int pupil_json_next(pupil_json *json, pupil_json_member *member)
{
    if (!json->begun && !accept(json, '{'))
        return -1;
    if (accept(json, '}'))
        return peek(json) ? -1 : 0;
    if (json->begun && !accept(json, ','))
        return -1;
    json->begun = 1;
    peek(json);
    const char *name = json->at;
    member->line = json->line;
    if (pass_string(json))
        return -1;
    const size_t length = (size_t)(json->at - name) - 2, most = sizeof member->name - 1;
    memcpy(member->name, name + 1, length < most ? length : most);
    member->name[length < most ? length : most] = 0;
    if (!accept(json, ':'))
        return -1;
    peek(json);
    member->value = json->at;
    if (pass_value(json, 0))
        return -1;
    member->length = (size_t)(json->at - member->value);
    return 1;
}

/* ---- values ---- */

int pupil_json_signed(const pupil_json_member *member, int64_t *value)
{
    char *end;
    errno = 0;
    const long long got = strtoll(member->value, &end, 10);
    if (errno || end != member->value + member->length)
        return -1;
    *value = got;
    return 0;
}

int pupil_json_whole(const pupil_json_member *member, uint64_t *value)
{
    char *end;
    errno = 0;
    const unsigned long long got = strtoull(member->value, &end, 10);
    if (errno || *member->value == '-' || end != member->value + member->length)
        return -1;
    *value = got;
    return 0;
}

static int is_number(char c)
{
    return c == '-' || (c >= '0' && c <= '9');
}

int pupil_json_number(const pupil_json_member *member, double *value)
{
    char *end;
    if (member->length == 4 && strncmp(member->value, "null", 4) == 0) {
        *value = NAN;
        return 0;
    }
    if (!is_number(*member->value))
        return -1;
    *value = strtod(member->value, &end);
    return end == member->value + member->length && isfinite(*value) ? 0 : -1;
}

int pupil_json_numbers(const pupil_json_member *member, float *values, size_t count)
{
    pupil_json list = {.at = member->value};
    if (!accept(&list, '['))
        return -1;
    for (size_t i = 0; i < count; i++) {
        char *end;
        if ((i && !accept(&list, ',')) || !is_number(peek(&list)))
            return -1;
        values[i] = strtof(list.at, &end);
        if (!isfinite(values[i]))
            return -1;
        list.at = end;
    }
    return accept(&list, ']') ? 0 : -1;
}

static int hex4(const char *at, unsigned *code)
{
    *code = 0;
    for (int i = 0; i < 4; i++) {
        const char *digits = "0123456789abcdef", *digit = at[i] ? strchr(digits, at[i] | 0x20) : NULL;
        if (!digit)
            return -1;
        *code = *code * 16 + (unsigned)(digit - digits);
    }
    return 0;
}

int pupil_json_string(const pupil_json_member *member, char *text, size_t text_bytes)
{
    static const char escapes[] = "\"\\/bfnrt", stands_for[] = "\"\\/\b\f\n\r\t";
    const char *at = member->value + 1, *end = member->value + member->length - 1;
    size_t used = 0;
    if (*member->value != '"')
        return -1;
    for (; at < end; at++) {
        char c = *at;
        if (c == '\\') {
            const char *escape = strchr(escapes, *++at);
            unsigned code = 0;
            if (!escape && (*at != 'u' || end - at < 5 || hex4(at + 1, &code)))
                return -1;
            c = escape ? stands_for[escape - escapes] : code && code < 0x80 ? (char)code : '?';
            at += escape ? 0 : 4;
        }
        if (used + 1 >= text_bytes)
            return -1;
        text[used++] = c;
    }
    text[used] = 0;
    return 0;
}

/* Bytes of the UTF-8 sequence at s (The Unicode Standard, table 3-7, without its finer bounds); 0: none. */
static size_t utf8_bytes(const unsigned char *s)
{
    const size_t bytes = s[0] < 0x80 ? 1 : s[0] < 0xc2 ? 0 : s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : s[0] < 0xf5 ? 4 : 0;
    for (size_t i = 1; i < bytes; i++)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    return bytes;
}

void pupil_json_quote(char *quoted, const char *text)
{
    *quoted++ = '"';
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        const size_t bytes = utf8_bytes(s);
        if (*s == '"' || *s == '\\')
            *quoted++ = '\\';
        if (*s < ' ' || *s == 0x7f)
            quoted += sprintf(quoted, "\\u%04x", *s);
        else if (bytes == 0)
            *quoted++ = '?';
        else
            for (size_t i = 0; i < bytes; i++)
                *quoted++ = (char)s[i];
        s += bytes ? bytes : 1;
    }
    *quoted++ = '"';
    *quoted = 0;
}

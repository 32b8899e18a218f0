#include "command_line.h"

#include <stdio.h>
#include <string.h>

void command_line(char *text, size_t bytes, int argc, char **argv)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+,./:@%";
    size_t at = (size_t)snprintf(text, bytes, "pupil");
    for (int i = 0; i < argc && at < bytes; i++) {
        const char *quote = *argv[i] && strspn(argv[i], plain) == strlen(argv[i]) ? "" : "'";
        at += (size_t)snprintf(text + at, bytes - at, " %s", quote);
        for (const char *c = argv[i]; *c && at < bytes; c++)
            at += (size_t)snprintf(text + at, bytes - at, *c == '\'' ? "'\\''" : "%c", *c);
        if (at < bytes)
            at += (size_t)snprintf(text + at, bytes - at, "%s", quote);
    }
}

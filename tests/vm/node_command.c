/* node_command.c: what the guests' scripts do to a node, as v4l2-ctl would:
 *     node find DRIVER capture|output N        its path
 *     node set PATH CONTROL VALUE              node get PATH CONTROL
 *     node input PATH N                        node timings PATH WIDTH HEIGHT FPS
 *     node format PATH FOURCC WIDTH HEIGHT     of an output
 *     node cable PATH                          vivid's HDMI input sees its HDMI monitor
 *     node light PID N                         of uvc_camera, by its process */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "vm/node.h"
#include "vm/uvc_camera.h"

static int find(char **words)
{
    char path[32];
    if (node_find(words[0], strcmp(words[1], "output") == 0, atoi(words[2]), path) != 0)
        return 1;
    puts(path);
    return 0;
}

static int act(const char *verb, int fd, char **words)
{
    int value = 0;
    uint32_t fourcc = 0;
    if (strcmp(verb, "set") == 0)
        return node_set(fd, words[0], atoi(words[1]));
    if (strcmp(verb, "input") == 0)
        return node_input(fd, atoi(words[0]));
    if (strcmp(verb, "timings") == 0)
        return node_timings(fd, (uint32_t)atoi(words[0]), (uint32_t)atoi(words[1]), (unsigned)atoi(words[2]));
    if (strcmp(verb, "cable") == 0)
        return node_cable(fd);
    if (strcmp(verb, "format") == 0) {
        for (int i = 0; i < 4 && words[0][i]; i++)
            fourcc |= (uint32_t)words[0][i] << 8 * i;
        return node_output_format(fd, fourcc, (uint32_t)atoi(words[1]), (uint32_t)atoi(words[2]));
    }
    if (strcmp(verb, "get") != 0 || node_get(fd, words[0], &value) != 0)
        return -1;
    printf("%d\n", value);
    return 0;
}

int main(int argc, char **argv)
{
    static const struct {
        const char *verb;
        int words;
    } verbs[] = {{"find", 3},    {"set", 3},    {"get", 2},   {"input", 2},
                 {"timings", 4}, {"format", 4}, {"cable", 1}, {"light", 2}};
    for (size_t i = 0; argc > 1 && i < sizeof verbs / sizeof verbs[0]; i++)
        if (strcmp(argv[1], verbs[i].verb) == 0 && argc == 2 + verbs[i].words) {
            if (i == 0)
                return find(argv + 2);
            if (strcmp(argv[1], "light") == 0)
                return sigqueue(atoi(argv[2]), UVC_SET_LIGHT, (union sigval){.sival_int = atoi(argv[3])}) != 0;
            const int fd = node_open(argv[2]);
            return fd < 0 || act(argv[1], fd, argv + 3) != 0;
        }
    fprintf(stderr, "node: no such verb, or not so many words\n");
    return 2;
}

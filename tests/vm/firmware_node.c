/* firmware_node.c: LD_PRELOAD in the guest of vm.libcamera. libcamera names webcams by their USB controller's firmware
 * node. The guest's controller has its far end in user space (vhci_hcd) and no firmware node: the file
 * /run/firmware_node replaces it. */
#undef _FILE_OFFSET_BITS /* both names of a call are defined here: with it the first would be the second */
#undef _TIME_BITS
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define NODE "/vhci_hcd.0/firmware_node/path"

static const char *place_of(const char *path)
{
    const size_t length = path ? strlen(path) : 0, tail = sizeof NODE - 1;
    return length > tail && strcmp(path + length - tail, NODE) == 0 ? "/run/firmware_node" : path;
}

static void *next_of(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

int stat(const char *path, struct stat *to)
{
    int (*next)(const char *, struct stat *);
    *(void **)&next = next_of("stat");
    return next(place_of(path), to);
}

int stat64(const char *path, struct stat64 *to)
{
    int (*next)(const char *, struct stat64 *);
    *(void **)&next = next_of("stat64");
    return next(place_of(path), to);
}

FILE *fopen(const char *path, const char *mode)
{
    FILE *(*next)(const char *, const char *);
    *(void **)&next = next_of("fopen");
    return next(place_of(path), mode);
}

FILE *fopen64(const char *path, const char *mode)
{
    FILE *(*next)(const char *, const char *);
    *(void **)&next = next_of("fopen64");
    return next(place_of(path), mode);
}

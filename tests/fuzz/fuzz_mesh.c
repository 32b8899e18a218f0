/* Any bytes as a mesh file: triangles whose corners exist, or a sentence. */
#include "mesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* Called by libFuzzer, which has no declaration for it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static int fd = -1;
    char path[32];
    fixture_mesh mesh;
    pupil_why why = {""};
    if (fd < 0)
        fd = memfd_create("mesh", 0);
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    if (ftruncate(fd, 0) || pwrite(fd, bytes, size, 0) != (ssize_t)size)
        return 0;
    if (fixture_mesh_load(&mesh, path, &why)) {
        if (!*why.text)
            abort(); /* a refusal without a sentence */
        return 0;
    }
    if (!mesh.triangles)
        abort();
    fixture_mesh_free(&mesh);
    return 0;
}

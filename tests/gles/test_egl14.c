/* EGL 1.4 without EGL_KHR_get_all_proc_addresses only finds extension functions: a sentence, no crash. This program's
 * own eglGetProcAddress wraps the driver's and finds no others. */
#include <EGL/egl.h>
#include <dlfcn.h>
#include <string.h>

#include "check.h"
#include "egl/egl_context.h"

typedef __eglMustCastToProperFunctionPointerType (*get_proc)(const char *name);

__eglMustCastToProperFunctionPointerType EGLAPIENTRY eglGetProcAddress(const char *name)
{
    union {
        void *object;
        get_proc function;
    } next = {dlsym(RTLD_NEXT, "eglGetProcAddress")};
    return strncmp(name, "gl", 2) == 0 ? NULL : next.function(name);
}

int main(int argc, char **argv)
{
    pupil_egl *egl;
    pupil_why why = {""};
    check_begin(argc, argv);
    CHECK(pupil_egl_open(&egl, NULL, &why) == -1 && egl == NULL);
    if (strstr(why.text, "no driver for OpenGL ES"))
        return check_skip(why.text);
    CHECK_MSG(strstr(why.text, "EGL_KHR_get_all_proc_addresses"), "%s", why.text);
    CHECK(eglGetCurrentContext() == EGL_NO_CONTEXT);
    return check_end();
}

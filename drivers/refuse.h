/* drivers/refuse.h: writes the sentence that says why a call fails, as printf does. */
#ifndef PUPIL_DRIVERS_REFUSE_H
#define PUPIL_DRIVERS_REFUSE_H

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "pupil/error.h"

/* Returns -1. why may be NULL. */
__attribute__((format(printf, 2, 3))) static inline int pupil_refuse(pupil_why *why, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (why)
        vsnprintf(why->text, sizeof why->text, format, arguments);
    va_end(arguments);
    return -1;
}

/* Adds to the sentence that is there. why may be NULL. */
__attribute__((format(printf, 2, 3))) static inline void pupil_refuse_add(pupil_why *why, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (why) {
        const size_t used = strnlen(why->text, sizeof why->text - 1);
        vsnprintf(why->text + used, sizeof why->text - used, format, arguments);
    }
    va_end(arguments);
}

#endif

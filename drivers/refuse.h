/* drivers/refuse.h: a sentence into the caller's buffer, as printf makes it, and -1 to return. */
#ifndef PUPIL_DRIVERS_REFUSE_H
#define PUPIL_DRIVERS_REFUSE_H

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

/* why may be NULL. */
__attribute__((format(printf, 3, 4))) static inline int pupil_refuse(char *why, size_t why_bytes, const char *format,
                                                                     ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (why && why_bytes)
        vsnprintf(why, why_bytes, format, arguments);
    va_end(arguments);
    return -1;
}

#endif

/* drivers/file/common/utf8.h: text for JSON, which is UTF-8, from names, which are any bytes. */
#ifndef PUPIL_DRIVERS_FILE_COMMON_UTF8_H
#define PUPIL_DRIVERS_FILE_COMMON_UTF8_H

/* A copy with U+FFFD for bytes that are not UTF-8. To be freed; NULL: out of memory. */
char *utf8_of(const char *text);

#endif

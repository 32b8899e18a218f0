/* apps/report/base64.h: bytes as text (RFC 4648, section 4), for data URIs. */
#ifndef PUPIL_APPS_REPORT_BASE64_H
#define PUPIL_APPS_REPORT_BASE64_H

#include <stdint.h>
#include <stdio.h>

/* Writes the rest of `in` to `out`, at most `most` bytes of it. 0; 1: there was more; -1: `in` cannot be read (errno).
 * The caller checks ferror(out). */
int base64_write(FILE *out, FILE *in, uint64_t most);

#endif

/* drivers/number.h: numbers in files and in texts, which have a point in every locale. */
#ifndef PUPIL_DRIVERS_NUMBER_H
#define PUPIL_DRIVERS_NUMBER_H

/* strtod as in the C locale, whatever locale the program runs in. */
double pupil_parse_double(const char *text, char **end);

#endif

/* lib/base/fault.h: a configuration is right where all of its rules hold. */
#ifndef PUPIL_BASE_FAULT_H
#define PUPIL_BASE_FAULT_H

#include <stddef.h>

/* A condition on a field, and the sentence that a caller reads where it does not hold. Write the condition that is
 * wanted, never the negation of the one that is refused: then NaN, for which every comparison is false, is refused. */
typedef struct pupil_rule {
    int holds;
    const char *sentence;
} pupil_rule;

/* The sentence of the first rule that does not hold; 0 where all do. */
static inline const char *first_fault(const pupil_rule *rules, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!rules[i].holds)
            return rules[i].sentence;
    return 0;
}

static inline int within(double x, double low, double high)
{
    return x >= low && x <= high; /* false for NaN */
}

#endif

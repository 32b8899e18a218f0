/* lib/base/fault.h: the rules of a configuration, a line each. */
#ifndef PUPIL_BASE_FAULT_H
#define PUPIL_BASE_FAULT_H

static inline int within(double x, double low, double high)
{
    return x >= low && x <= high; /* false for NaN */
}

#define MUST(be_so, sentence)                                                                                          \
    if (!(be_so)) /* NaN is not */                                                                                     \
    return sentence

#endif

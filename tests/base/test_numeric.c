/* The library's real functions against the C library's in long double: the errors that base/numeric.h states, over each
 * whole range and at its ends. */
#include <math.h>

#include "base/numeric.h"
#include "check.h"

enum { TRIES = 20000 };

#define TURN 6.283185307179586476925286766559L

static double between(double low, double high)
{
    return low + (high - low) * check_uniform();
}

static void check_log2(double x)
{
    const long double exact = log2l((long double)x), off = fabsl(pupil_log2(x) - exact);
    CHECK_MSG(off <= 4e-16L + 2e-16L * fabsl(exact), "log2 %.17g: %Lg off", x, off);
}

static void check_exp2(double x)
{
    const long double exact = exp2l((long double)x), off = fabsl(pupil_exp2(x) - exact) / exact;
    CHECK_MSG(off <= 4e-16L, "2^%.17g: %Lg off", x, off);
}

static void check_one_minus_exp(double x)
{
    const long double exact = -expm1l(-(long double)x), off = fabsl(pupil_one_minus_exp(x) - exact);
    CHECK_MSG(off <= 4e-16L * exact, "1 - exp(-%.17g): %Lg off", x, off);
}

static void check_root_and_decay(double x)
{
    const long double root = sqrtl((long double)x), left = expl(-(long double)x);
    CHECK_MSG(fabsl(pupil_root(x) - root) <= 1e-15L * root, "the root of %.17g: %.17g", x, pupil_root(x));
    CHECK_MSG(fabsl(pupil_decay(x) - left) <= 1.2e-14L * left, "exp(-%.17g): %.17g", x, pupil_decay(x));
}

static void check_circle(double x)
{
    const long double part = (long double)x - roundl((long double)x);
    const long double c = cosl(TURN * part), s = sinl(TURN * part);
    double cosine, sine, turned[2] = {0.0, 0.0};
    pupil_circle(x, &cosine, &sine);
    CHECK_MSG(fabsl(cosine - c) <= 1e-15L && fabsl(sine - s) <= 1e-15L, "circle %.17g: %.17g %.17g", x, cosine, sine);
    if (fabs(x) >= 0x1p31)
        return;
    pupil_turn(x, turned);
    CHECK_MSG(fabsl(turned[0] - c) <= 1e-8L && fabsl(turned[1] - s) <= 1e-8L, "turn %.17g: %.17g %.17g", x, turned[0],
              turned[1]);
}

static void check_ends(void)
{
    for (int n = -1000; n <= 1000; n++)
        CHECK(pupil_exp2(n) == ldexp(1.0, n) && pupil_log2(ldexp(1.0, n)) == n);
    CHECK(pupil_one_minus_exp(0.0) == 0.0 && pupil_one_minus_exp(40.0) == 1.0 && pupil_one_minus_exp(1e300) == 1.0);
    CHECK(pupil_root(0.0) == 0.0 && pupil_decay(0.0) == 1.0);
    CHECK(pupil_decay(690.0) == 0.0 && pupil_decay(nextafter(690.0, 0.0)) > 0.0);
    for (int n = -8; n <= 8; n++) {
        check_circle(n / 8.0);
        CHECK(pupil_nearest(n) == n && pupil_nearest(n + 0.25) == n && pupil_nearest(n - 0.25) == n);
        CHECK(pupil_nearest(n + 0.5) == (n < 0 ? n : n + 1)); /* rounded away from 0 */
    }
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    check_ends();
    for (int i = 0; i < TRIES; i++) {
        check_log2(exp2(between(-1022.0, 1023.0)));
        check_log2(between(0.5, 2.0)); /* of a small log2 */
        check_exp2(between(-1000.0, 1000.0));
        check_exp2(between(-1.0, 1.0));
        check_one_minus_exp(exp2(between(-60.0, 6.0)));
        check_root_and_decay(between(0.0, 100.0));
        check_circle(between(-2.0, 2.0));
        check_circle(between(-1.0, 1.0) * exp2(between(0.0, 49.0)));
    }
    return check_end();
}

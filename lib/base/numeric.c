#include "numeric.h"

#define LN2 0x1.62e42fefa39efp-1
/* ln 2 in two parts: the first has 21 trailing zero bits, so that n * LN2_HIGH is exact for n < 2^21. */
#define LN2_HIGH 0x1.62e42feep-1
#define LN2_LOW  0x1.a39ef35793c76p-33

double pupil_log2(double x)
{
    const double two_over_ln2 = 0x1.71547652b82fep+1;
    uint64_t bits = pupil_bits_of_double(x);
    int exponent = (int)(bits >> 52 & 0x7ff) - 1023;
    double m = pupil_double_of_bits((bits & UINT64_C(0x000fffffffffffff)) | UINT64_C(0x3ff0000000000000));

    if (m > 0x1.6a09e667f3bcdp+0) { /* sqrt 2: keeps |s| below 0.172 */
        m *= 0.5;
        exponent++;
    }
    /* ln m = 2 atanh s; the first term left out is s^25 / 25 < 3e-21. */
    double s = (m - 1.0) / (m + 1.0);
    double z = s * s;
    double sum = 0.0;
    for (int k = 23; k >= 1; k -= 2)
        sum = sum * z + 1.0 / k;
    return (double)exponent + s * sum * two_over_ln2;
}

/* exp(t) - 1 for |t| <= 0.35: Taylor; the first term left out is t^16 / 16! < 3e-21. */
static double expm1_near_zero(double t)
{
    double sum = 0.0;
    for (int k = 15; k >= 1; k--)
        sum = (sum + 1.0) * t / k;
    return sum;
}

static int round_to_int(double x)
{
    return (int)(x < 0 ? x - 0.5 : x + 0.5);
}

static double power_of_two(int n)
{
    return pupil_double_of_bits((uint64_t)(n + 1023) << 52);
}

double pupil_exp2(double x)
{
    int n = round_to_int(x);
    return (1.0 + expm1_near_zero((x - n) * LN2)) * power_of_two(n);
}

double pupil_one_minus_exp(double x)
{
    if (x >= 40.0) /* exp(-40) is below half an ulp of 1 */
        return 1.0;
    int n = round_to_int(x / LN2);
    double r = (x - n * LN2_HIGH) - n * LN2_LOW;
    double minus = expm1_near_zero(-r);
    return n == 0 ? -minus : 1.0 - power_of_two(-n) * (1.0 + minus);
}

/* Sine and cosine of a quarter of the angle, at most pi/4, by Taylor; the angle is then doubled twice. The first terms
 * left out are t^11 / 11! < 1.8e-9 of the sine and t^12 / 12! < 1.2e-10 of the cosine; doubling makes them 1e-8. */
void pupil_turn(double x, double cos_sin[2])
{
    const double t = (x - round_to_int(x)) * 0x1.921fb54442d18p+0;
    const double z = t * t;
    const double sine = t * (1.0 - z * (1.0 / 6.0 - z * (1.0 / 120.0 - z * (1.0 / 5040.0 - z / 362880.0))));
    const double half = 1.0 - z * (0.5 - z * (1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40320.0 - z / 3628800.0))));
    const double c = 1.0 - 2.0 * sine * sine;
    const double s = 2.0 * sine * half;
    cos_sin[0] = 1.0 - 2.0 * s * s;
    cos_sin[1] = 2.0 * s * c;
}

double pupil_nearest(double x)
{
    return (double)(int64_t)(x < 0.0 ? x - 0.5 : x + 0.5);
}

void pupil_circle(double turns, double *cosine, double *sine)
{
    const double quarters = pupil_nearest(turns * 4.0);
    const double a = (turns - quarters * 0.25) * 0x1.921fb54442d18p+2, z = a * a; /* |a| <= pi / 4 */
    double c = 0.0, s = 0.0;
    for (int k = 16; k >= 2; k -= 2) { /* Taylor; the first terms left out are a^18 / 18! and a^19 / 19! < 3e-18 */
        c = (1.0 - c) * z / (k * (k - 1));
        s = (1.0 - s) * z / (k * (k + 1));
    }
    c = 1.0 - c;
    s = a * (1.0 - s);
    const int quarter = (int)((int64_t)quarters & 3);
    *cosine = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
    *sine = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
}

double pupil_root(double x)
{
    return x > 0.0 ? pupil_exp2(0.5 * pupil_log2(x)) : 0.0;
}

double pupil_decay(double x)
{
    return x < 690.0 ? pupil_exp2(-0x1.71547652b82fep+0 * x) : 0.0; /* log2 e; 2^-1000 is the last one */
}

/* decimal.c - the double nearest to a decimal number, without the C library.
 *
 * D 10^e is D 5^e 2^e, a whole number times a power of two, or D 2^e over 5^-e.  So it is compared exactly
 * with any M 2^q: both sides are multiplied by 5^-e or shifted until both are whole, and whole numbers of
 * many digits are compared.
 *
 * The doubles from 0 on are in the order of their bits.  The nearest one is the least double c for which the
 * number is below the middle between c and the next double (or is that middle, and c is even).  A bisection
 * over the bits finds it in 63 comparisons.  Most numbers take a quicker way: up to 15 digits and a power of
 * up to 10^22 are two exact doubles, so their product or quotient is rounded once (Clinger 1990, How to read
 * floating point numbers accurately).
 *
 * A middle between doubles has at most 768 significant digits.  So if a number has more than DIGITS, those
 * beyond only say whether it is more than what the first ones say: a 1 stands for them.
 *
 * SIZE.  D has at most 801 digits, so 2661 bits.  The number is at least 10^-325, so -e is at most 1126, and
 * M 5^-e has at most 54 + 2615 bits.  It is below 10^309, so D 5^e has at most 1030.  Nothing is shifted in
 * memory.  So 96 places of 32 bits suffice.
 *
 * Test: tests/unit/test_decimal.c. */
#include "decimal.h"

#include "num/bits.h"

#include <stdbool.h>
#include <stdint.h>

enum { DIGITS = 800, PLACES = 96 };

/* A whole number: count digits of 32 bits, the least first; the last is not 0. */
typedef struct whole {
    int count;
    uint32_t place[PLACES];
} whole;

/* n = n by + plus. */
static void whole_times(whole *n, uint32_t by, uint32_t plus)
{
    uint64_t carry = plus;
    for (int i = 0; i < n->count; i++) {
        carry += (uint64_t)n->place[i] * by;
        n->place[i] = (uint32_t)carry, carry >>= 32;
    }
    if (carry) n->place[n->count++] = (uint32_t)carry;
}

static void whole_times_fives(whole *n, int power)
{
    for (; power >= 13; power -= 13) whole_times(n, 1220703125, 0);
    for (; power > 0; power--) whole_times(n, 5, 0);
}

static int whole_bits(const whole *n)
{
    int bits = 32 * n->count;
    if (n->count)
        for (uint32_t top = n->place[n->count - 1]; !(top >> 31); top <<= 1) bits--;
    return bits;
}

/* The digit i of n 2^by. */
static uint32_t whole_shifted(const whole *n, int by, int i)
{
    int at = i - by / 32, shift = by % 32;
    uint32_t high = at >= 0 && at < n->count ? n->place[at] : 0;
    uint32_t low = at >= 1 && at <= n->count ? n->place[at - 1] : 0;
    return shift ? high << shift | low >> (32 - shift) : high;
}

/* The sign of a 2^by - b; by may be negative. */
static int whole_compared(const whole *a, int by, const whole *b)
{
    int up = by > 0 ? by : 0, down = by < 0 ? -by : 0;
    int long_a = whole_bits(a) + up, long_b = whole_bits(b) + down;
    if (long_a != long_b) return long_a < long_b ? -1 : 1;
    for (int i = (long_a + 31) / 32; i-- > 0;) {
        uint32_t p = whole_shifted(a, up, i), q = whole_shifted(b, down, i);
        if (p != q) return p < q ? -1 : 1;
    }
    return 0;
}

/* D 10^e. */
typedef struct decimal_number {
    whole digits;
    int e;
} decimal_number;

/* Is the number below the middle between the double of these bits and the next one, or is it that middle and
 * the double even?  The next one after the largest double is 2^1024 here. */
static bool decimal_is_below(const decimal_number *n, uint64_t bits)
{
    uint64_t mantissa = bits & (((uint64_t)1 << 52) - 1);
    int exponent = (int)(bits >> 52);
    if (exponent)
        mantissa |= (uint64_t)1 << 52;
    else
        exponent = 1;
    uint64_t m = 2 * mantissa + 1; /* times 2^(exponent - 1076) */
    whole middle = {0}, digits = n->digits;
    for (; m; m >>= 32) middle.place[middle.count++] = (uint32_t)m;
    if (n->e < 0)
        whole_times_fives(&middle, -n->e);
    else
        whole_times_fives(&digits, n->e);
    int sign = whole_compared(&digits, n->e - (exponent - 1076), &middle);
    return sign < 0 || (sign == 0 && !(bits & 1));
}

static double decimal_by_bisection(const decimal_number *n)
{
    const uint64_t infinite = (uint64_t)2047 << 52;
    uint64_t lo = 0, hi = infinite; /* of hi it is so, or hi is infinite */
    while (lo < hi) {
        uint64_t middle = lo + (hi - lo) / 2;
        if (decimal_is_below(n, middle))
            hi = middle;
        else
            lo = middle + 1;
    }
    double x;
    memcpy(&x, &hi, sizeof x);
    return x;
}

static bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }

/* The whole number of the exponent that follows an e; *s: behind it.  Beyond 100000 it is all the same: no
 * text has so many digits. */
static int decimal_exponent(const char **s)
{
    int e = 0;
    bool down = **s == '-';
    *s += **s == '-' || **s == '+';
    for (; is_decimal_digit(**s); ++*s) e = e < 100000 ? 10 * e + (**s - '0') : e;
    return down ? -e : e;
}

double sgt_formula_decimal(const char *text, size_t *length)
{
    static const double ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    decimal_number n = {.e = 0};
    const char *s = text;
    bool point = false, digit = false, rest = false;
    int many = 0; /* significant digits */
    uint64_t small = 0;
    for (;; s++) {
        if (*s == '.' && !point) {
            point = true;
            continue;
        }
        if (!is_decimal_digit(*s)) break;
        digit = true;
        uint32_t d = (uint32_t)(*s - '0');
        if (many == 0 && d == 0) {
            n.e -= point;
        } else if (many < DIGITS) {
            if (many++ < 18) small = 10 * small + d;
            whole_times(&n.digits, 10, d);
            n.e -= point;
        } else {
            rest = rest || d;
            n.e += !point;
        }
    }
    if (!digit) return *length = 0, 0;
    if (*s == 'e' || *s == 'E') {
        const char *exponent = s + 1 + (s[1] == '-' || s[1] == '+');
        if (is_decimal_digit(*exponent)) s++, n.e += decimal_exponent(&s);
    }
    *length = (size_t)(s - text);
    if (many == 0 || many + n.e < -324) return 0;
    if (many + n.e > 309) return (double)INFINITY;
    if (many <= 15 && n.e >= -22 && n.e <= 22)
        return n.e < 0 ? (double)small / ten[-n.e] : (double)small * ten[n.e];
    if (rest) whole_times(&n.digits, 10, 1), n.e--;
    return decimal_by_bisection(&n);
}

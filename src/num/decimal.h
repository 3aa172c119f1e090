// SPDX-License-Identifier: MIT
/* decimal.h - the double nearest to a decimal number: the only reader of them, without the C library.
 *
 * A text says D 10^e, D a whole number.  Most texts take the quick way.  D < 2^62 is h + l, both doubles.
 * With q = h / 10^k rounded, r = fma(-q, 10^k, h) is exact, so D / 10^k = q + (r + l) / 10^k.  (k is at most
 * 22: 10^22 is exact.  Clinger 1990, How to read floating point numbers accurately.)  The second term is
 * computed to a relative 2^-51.  If q plus slightly less of it and q plus slightly more round to the same
 * double, that is the double nearest to D / 10^k, because rounding is monotone.
 *
 * THE OTHERS.  D 10^e is D 5^e 2^e, a whole number times a power of two, or D 2^e over 5^-e.  So it is
 * compared exactly with any M 2^q: both sides are multiplied by 5^-e or shifted until both are whole, and
 * whole numbers of many digits are compared.
 *
 * The doubles from 0 on are in the order of their bits.  The nearest one is the least double c for which the
 * number is below the middle between c and the next double (or is that middle, and c is even).  A bisection
 * over the bits finds it in 63 comparisons, or in 8 where decimal_near says where to look.
 *
 * A middle between doubles has at most 768 significant digits.  So if a number has more than DECIMAL_DIGITS,
 * those beyond only say whether it is more than what the first ones say: a 1 stands for them.
 *
 * SIZE.  D has at most 801 digits, so 2661 bits.  The number is at least 10^-325, so -e is at most 1126, and
 * M 5^-e has at most 54 + 2615 bits.  It is below 10^309, so D 5^e has at most 1030.  Nothing is shifted in
 * memory.  So 96 places of 32 bits suffice.
 *
 * Test: tests/unit/test_decimal.c. */
#ifndef SGT_DECIMAL_H
#define SGT_DECIMAL_H
#include <math.h>
#include <sagitta/fma.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { DECIMAL_DIGITS = 800, DECIMAL_PLACES = 96, DECIMAL_POWER = 22, DECIMAL_QUICK = 18 };
static const double decimal_ten[DECIMAL_POWER + 1] = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
};

/* The double nearest to D 10^e, D < 2^62; NaN if the quick way cannot decide. */
static inline double decimal_quick(uint64_t d, int e)
{
    if (e < -DECIMAL_POWER || e > DECIMAL_POWER) return (double)NAN;
    const double h = (double)d, l = (double)((int64_t)d - (int64_t)h);
    if (e >= 0) return l == 0 ? h * decimal_ten[e] : (double)NAN;
    const double q = h / decimal_ten[-e], more = (sgt_fma(-q, decimal_ten[-e], h) + l) / decimal_ten[-e];
    const double least = q + more * (1 - 0x1p-50), most = q + more * (1 + 0x1p-50);
    return least == most ? least : (double)NAN;
}

/* ------------------------------------------------------- whole numbers of many digits */

/* count digits of 32 bits, the least first; the last is not 0. */
typedef struct decimal_whole { int count; uint32_t place[DECIMAL_PLACES]; } decimal_whole;

/* n = n by + plus. */
static inline void whole_times(decimal_whole *n, uint32_t by, uint32_t plus)
{
    uint64_t carry = plus;
    for (int i = 0; i < n->count; i++) {
        carry += (uint64_t)n->place[i] * by;
        n->place[i] = (uint32_t)carry, carry >>= 32;
    }
    if (carry) n->place[n->count++] = (uint32_t)carry;
}

static inline void whole_times_fives(decimal_whole *n, int power)
{
    for (; power >= 13; power -= 13) whole_times(n, 1220703125, 0);
    for (; power > 0; power--) whole_times(n, 5, 0);
}

static inline int whole_bits(const decimal_whole *n)
{
    int bits = 32 * n->count;
    if (n->count)
        for (uint32_t top = n->place[n->count - 1]; !(top >> 31); top <<= 1) bits--;
    return bits;
}

/* The digit i of n 2^by. */
static inline uint32_t whole_shifted(const decimal_whole *n, int by, int i)
{
    const int at = i - by / 32, shift = by % 32;
    const uint32_t high = at >= 0 && at < n->count ? n->place[at] : 0;
    const uint32_t low = at >= 1 && at <= n->count ? n->place[at - 1] : 0;
    return shift ? high << shift | low >> (32 - shift) : high;
}

/* The sign of a 2^by - b; by may be negative. */
static inline int whole_compared(const decimal_whole *a, int by, const decimal_whole *b)
{
    const int up = by > 0 ? by : 0, down = by < 0 ? -by : 0;
    const int long_a = whole_bits(a) + up, long_b = whole_bits(b) + down;
    if (long_a != long_b) return long_a < long_b ? -1 : 1;
    for (int i = (long_a + 31) / 32; i-- > 0;) {
        const uint32_t p = whole_shifted(a, up, i), q = whole_shifted(b, down, i);
        if (p != q) return p < q ? -1 : 1;
    }
    return 0;
}

/* ------------------------------------------------------------------ the exact way */

/* For e >= 0 digits 2^e, else digits 10^e. */
typedef struct decimal_number { decimal_whole digits; int e; } decimal_number;

/* Is the number below the middle between the double of these bits and the next one, or is it that middle and
 * the double even?  The next one after the largest double is 2^1024 here. */
static inline bool decimal_is_below(const decimal_number *n, uint64_t bits)
{
    uint64_t mantissa = bits & (((uint64_t)1 << 52) - 1);
    int exponent = (int)(bits >> 52);
    if (exponent) mantissa |= (uint64_t)1 << 52;
    else exponent = 1;
    uint64_t m = 2 * mantissa + 1; /* times 2^(exponent - 1076) */
    decimal_whole middle;
    for (middle.count = 0; m; m >>= 32) middle.place[middle.count++] = (uint32_t)m;
    if (n->e < 0) whole_times_fives(&middle, -n->e);
    const int sign = whole_compared(&n->digits, n->e - (exponent - 1076), &middle);
    return sign < 0 || (sign == 0 && !(bits & 1));
}

/* The number to a relative 2^-48, D being the first 18 of its digits: those beyond are less than 2^-56 of it,
 * and the at most 17 conversions and steps are rounded to 2^-53 each.  0 or infinite where one of them may
 * have left the normal doubles. */
static inline double decimal_near(uint64_t d, int e)
{
    double x = (double)d;
    for (int step, left = e < 0 ? -e : e; left > 0; left -= step) {
        step = left < DECIMAL_POWER ? left : DECIMAL_POWER;
        x = e < 0 ? x / decimal_ten[step] : x * decimal_ten[step];
    }
    return x < 0x1p-1000 ? 0 : x > 0x1p1000 ? HUGE_VAL : x;
}

/* near: as decimal_near. */
static inline double decimal_by_bisection(const decimal_number *n, double near)
{
    uint64_t lo = 0, hi = (uint64_t)2047 << 52; /* of hi it is so, or hi is infinite */
    double x = near * (1 - 0x1p-47);
    if (near > 0 && near < HUGE_VAL) {
        memcpy(&lo, &x, sizeof x);
        x = near * (1 + 0x1p-47);
        memcpy(&hi, &x, sizeof x);
    }
    while (lo < hi) {
        const uint64_t middle = lo + (hi - lo) / 2;
        if (decimal_is_below(n, middle)) hi = middle;
        else lo = middle + 1;
    }
    memcpy(&x, &hi, sizeof x);
    return x;
}

/* first: the first of `many` significant digits, among which a point may be, the last of them with 10^e; d:
 * the first 18 of them. */
static inline double decimal_exact(const char *first, ptrdiff_t many, int e, uint64_t d)
{
    const ptrdiff_t size = many + e;
    if (size < -324) return 0;
    if (size > 309) return HUGE_VAL;
    decimal_number n;
    n.digits.count = 0, n.e = e;
    bool rest = false;
    for (ptrdiff_t i = 0; i < many; first++) {
        if (*first == '.') continue;
        if (i++ < DECIMAL_DIGITS) whole_times(&n.digits, 10, (uint32_t)(*first - '0'));
        else rest = rest || *first != '0';
    }
    if (many > DECIMAL_DIGITS) n.e += (int)(many - DECIMAL_DIGITS);
    if (rest) whole_times(&n.digits, 10, 1), n.e--;
    whole_times_fives(&n.digits, n.e);
    if (many > DECIMAL_QUICK) e += (int)(many - DECIMAL_QUICK);
    return decimal_by_bisection(&n, decimal_near(d, e));
}

/* --------------------------------------------------------------------- the reader */

static inline bool decimal_digit(const char *s, const char *end)
{
    return s != end && *s >= '0' && *s <= '9';
}

static inline const char *decimal_zeros(const char *s, const char *end)
{
    while (s != end && *s == '0') s++;
    return s;
}

/* Eight digits at once, the first in the lowest byte: 0x30 to 0x39, which stay below 0x40 with 6 added.  Then
 * pairs of neighbours become one number: 10 a + b, 100 a + b, 10000 a + b (Lemire 2018, Quickly parsing eight
 * digits). */
static inline bool decimal_eight(uint64_t v)
{
    const uint64_t high = 0xf0f0f0f0f0f0f0f0u, ascii = 0x3030303030303030u;
    return (v & high) == ascii && ((v + 0x0606060606060606u) & high) == ascii;
}

static inline uint64_t decimal_of_eight(uint64_t v)
{
    v = ((v & 0x0f0f0f0f0f0f0f0fu) * (1 + (10u << 8))) >> 8;
    v = ((v & 0x00ff00ff00ff00ffu) * (1 + (100u << 16))) >> 16;
    return ((v & 0x0000ffff0000ffffu) * (1 + ((uint64_t)10000 << 32))) >> 32;
}

/* Appends the digits from s on to *d, modulo 2^64; returns where they end. */
static inline const char *decimal_digits(const char *s, const char *end, uint64_t *d)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    for (uint64_t v; end && end - s >= 8; s += 8) {
        memcpy(&v, s, sizeof v);
        if (!decimal_eight(v)) break;
        *d = 100000000 * *d + decimal_of_eight(v);
    }
#endif
    for (; decimal_digit(s, end); s++) *d = 10 * *d + (uint64_t)(*s - '0');
    return s;
}

/* The first 18 of the significant digits. */
static inline uint64_t decimal_leading(const char *first)
{
    uint64_t d = 0;
    for (int i = 0; i < DECIMAL_QUICK; first++)
        if (*first != '.') d = 10 * d + (uint64_t)(*first - '0'), i++;
    return d;
}

/* Adds the exponent that begins at s, "e-12", to *e; returns where it ends, or s if it is none.  Beyond
 * 100000 it is all the same: no text has so many digits. */
static inline const char *decimal_exponent(const char *s, const char *end, int *e)
{
    if (s == end || (*s != 'e' && *s != 'E')) return s;
    const char *at = s + 1;
    const bool down = at != end && *at == '-';
    at += down || (at != end && *at == '+');
    if (!decimal_digit(at, end)) return s;
    int power = 0;
    for (; decimal_digit(at, end); at++) power = power < 100000 ? 10 * power + (*at - '0') : power;
    *e += down ? -power : power;
    return at;
}

/* Reads 12, 1.5, .5, 5., 1e-06, without a sign, as far as it goes up to `end` (NULL: the text ends with a
 * zero byte).  *length: how many characters, 0 if there is no number.  HUGE_VAL: too large for a double. */
static inline double decimal_read(const char *text, const char *end, size_t *length)
{
    uint64_t d = 0;
    int e = 0;
    const char *first = decimal_zeros(text, end), *s = decimal_digits(first, end, &d), *point = s;
    ptrdiff_t many = s - first;
    if (s != end && *s == '.') {
        if (many == 0) first = decimal_zeros(s + 1, end);
        const char *more = many ? s + 1 : first;
        s = decimal_digits(more, end, &d);
        many += s - more, e = -(int)(s - point - 1);
    }
    *length = 0;
    if (s == text + (point != end && *point == '.')) return 0;
    s = decimal_exponent(s, end, &e);
    *length = (size_t)(s - text);
    if (many == 0) return 0;
    /* of more digits: between what the first ones are, and one more */
    const int more = many > DECIMAL_QUICK ? (int)(many - DECIMAL_QUICK) : 0;
    if (more) d = decimal_leading(first);
    const double quick = decimal_quick(d, e + more);
    const bool decided = more ? quick == decimal_quick(d + 1, e + more) : !isnan(quick);
    return decided ? quick : decimal_exact(first, many, e, d);
}

#endif

/* number.c - doubles as text, there and back.
 *
 * strtod and printf round correctly in the C library this is built with.  (What they take for the
 * point is the locale's: number_read and number_print change it.)  But they are slow: with them
 * alone, they took nine tenths of the time of sagitta intersect (a million rays and a conic, csv to
 * csv: 7.5 s, against 1.0 s as it is).  Most numbers take a quicker way to the same bytes.  The
 * quick way declines what it cannot decide, and leaves that to strtod and printf.
 *
 * OUT.  10^k is a double for k = 0 ... 22.  Then x 10^k = p + e exactly, where p is the rounded
 * product and e = fma(x, 10^k, -p) is its rounding error, |e| <= ulp(p) / 2.  The whole number
 * nearest to p + e gives the decimal with k places that is nearest to x.
 *
 * BACK.  A whole number D < 2^62 is h + l, both doubles.  With q = h / 10^k rounded,
 * r = fma(-q, 10^k, h) is exact, so D / 10^k = q + (r + l) / 10^k.  The second term is computed
 * to a relative 2^-51.  If q plus slightly less of it and q plus slightly more round to the same
 * double, that is the double nearest to D / 10^k, because rounding is monotone.
 *
 * Source of "10^22 is exact": Clinger 1990, How to read floating point numbers accurately. */
#include "number.h"

#include <sagitta/fma.h>

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { POWER_MOST = 22, LONGEST = 2000 }; /* a number with more characters is read in the locale "C" only */
static const double power[POWER_MOST + 1] = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
};

/* A decimal: digits / 10^places.  rest: (the decimal - the double it stands for) 10^places. */
typedef struct decimal { uint64_t digits; int places; double rest; } decimal;

/* The double nearest to digits / 10^places, digits < 2^62; NaN if the quick way cannot decide. */
static double double_of(uint64_t digits, int places)
{
    if (places < -POWER_MOST || places > POWER_MOST) return (double)NAN;
    double h = (double)digits, l = (double)((int64_t)digits - (int64_t)h);
    if (places <= 0) return l == 0 ? h * power[-places] : (double)NAN;
    double q = h / power[places], more = (sgt_fma(-q, power[places], h) + l) / power[places];
    double least = q + more * (1 - 0x1p-50), most = q + more * (1 + 0x1p-50);
    return least == most ? least : (double)NAN;
}

/* -------------------------------------------------------------------- in */

static bool number_named(const char *text, const char *name)
{
    return strcasecmp(text, name) == 0 || (*text == '.' && strcasecmp(text + 1, name) == 0);
}

/* Appends the digits from s on to *n; returns where they end. */
static const char *read_digits(const char *s, uint64_t *n)
{
    for (; *s >= '0' && *s <= '9'; s++) *n = 10 * *n + (uint64_t)(*s - '0');
    return s;
}

static const char *skip_zeros(const char *s)
{
    while (*s == '0') s++;
    return s;
}

/* Reads 12, 1.5, .5, 5., 1e-06, without a sign; false: another form, or the quick way cannot decide. */
static bool read_quick(const char *text, double *value)
{
    uint64_t digits = 0;
    const char *first = skip_zeros(text), *s = read_digits(first, &digits), *point = s;
    ptrdiff_t many = s - first, places = 0;
    if (*s == '.') {
        first = many ? s + 1 : skip_zeros(s + 1);
        s = read_digits(first, &digits);
        many += s - first, places = s - point - 1;
    }
    if (s == text + (*point == '.') || many > 18 || places > 2 * POWER_MOST) return false;
    if (*s == 'e' || *s == 'E') {
        bool down = *++s == '-';
        s += *s == '-' || *s == '+';
        int exponent = 0;
        for (first = s; *s >= '0' && *s <= '9' && s - first < 4; s++) exponent = 10 * exponent + (*s - '0');
        if (s == first) return false;
        places += down ? exponent : -exponent;
    }
    if (*s) return false;
    *value = double_of(digits, (int)places);
    return !isnan(*value);
}

/* By strtod, with the locale's point in place of a point. */
static bool read_slowly(const char *text, double *value)
{
    const char *mark = localeconv()->decimal_point, *point = strchr(text, '.');
    char own[LONGEST], *end;
    if (point && strcmp(mark, ".") != 0) {
        int before = (int)(point - text),
            all = snprintf(own, sizeof own, "%.*s%s%s", before, text, mark, point + 1);
        if (all >= (int)sizeof own) return false;
        text = own;
    } else if (strcmp(mark, ".") != 0 && strstr(text, mark)) {
        return false;
    }
    *value = strtod(text, &end);
    return end != text && *end == 0 && isfinite(*value);
}

bool number_read(const char *text, double *value)
{
    const char *bare = text + (*text == '+' || *text == '-');
    double sign = *text == '-' ? -1 : 1;
    if (read_quick(bare, value)) return *value *= sign, true;
    if (number_named(bare, "inf")) return *value = sign * HUGE_VAL, true;
    if (number_named(bare, "nan")) return *value = (double)NAN, true;
    if (!strchr("0123456789.", *bare) || !*bare) return false; /* strtod takes blanks, "infinity", "nan(x)" */
    return read_slowly(text, value);
}

bool number_read_integer(const char *text, long lowest, long highest, long *value)
{
    if (!strchr("+-0123456789", *text)) return false;
    char *end;
    errno = 0;
    *value = strtol(text, &end, 10);
    return end != text && *end == 0 && errno == 0 && *value >= lowest && *value <= highest;
}

/* ------------------------------------------------------------------- out */

static const double QUICK_LEAST = 1e-20, QUICK_MOST = 1e15;  /* the range of the quick way */

/* The power of ten of the first digit: 10^E <= x < 10^(E + 1), x within QUICK_LEAST and QUICK_MOST. */
static int first_place(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int binary = (int)(bits >> 52) - 1023;                       /* 2^binary <= x, -67 ... 49 */
    /* by log10 2 = 1233/4096: right, or one too large */
    int guess = (binary * 1233 + 4096 * 100) / 4096 - 100 + 1;
    /* x power[-guess] rounds up to 1 only if x is the double nearest to that power of ten, and then it
     * prints as that power */
    return (guess >= 0 ? x >= power[guess] : x * power[-guess] >= 1) ? guess : guess - 1;
}

/* x rounded to `places` decimal places, half to even as printf does; x 10^places < 10^17.  *p: the double
 * nearest to x 10^places. */
static decimal number_rounded(double x, int places, double *p)
{
    *p = x * power[places];
    double e = sgt_fma(x, power[places], -*p);
    int64_t digits = llrint(*p);
    double half = *p - (double)digits; /* exact */
    /* If p has a fraction, e is less than half of p's last bit, and matters only if p is half way between
     * whole numbers.  If p has none, |e| may be up to 8; and p is even if |e| is 1/2 or more. */
    int64_t more = half == 0 ? llrint(e) : fabs(half) == 0.5 && half * e > 0 ? (int64_t)(2 * half) : 0;
    return (decimal){(uint64_t)(digits + more), places, (double)more - half - e};
}

/* Does the decimal read back as x?  1: yes, it is off by less than a quarter of an ulp (just below a
 * power of two doubles are half an ulp apart).  0: no, it is off by more than half an ulp.
 * -1: undecided.  p = x 10^places is 2^52 to 2^53 ulps. */
static int reads_back(const decimal *d, double x, double p)
{
    double off = fabs(d->rest);
    if (off > p * (0x1p-53 * (1 + 0x1p-40))) return 0;
    if (off < p * (0x1p-54 * (1 - 0x1p-40))) return 1;
    double back = double_of(d->digits, d->places);
    return isnan(back) ? -1 : back == x;
}

/* The shortest of 15, 16, 17 digits that reads back as x > 0.  false: the quick way cannot decide. */
static bool shortest_quick(double x, decimal *d)
{
    if (!(x >= QUICK_LEAST && x < QUICK_MOST)) return false;
    int first = first_place(x), back = 0;
    for (int digits = 15; digits <= 17 && !back; digits++) {
        int places = digits - 1 - first;
        if (digits == 15 && places > POWER_MOST) places = POWER_MOST; /* tries fewer than 15 digits */
        if (places > POWER_MOST) return false;
        double p;
        *d = number_rounded(x, places, &p);
        back = digits == 17 ? 1 : reads_back(d, x, p);
    }
    return back == 1;
}

/* Prints a whole number; returns how many characters. */
static int digits_of(char *text, uint64_t n)
{
    char backward[20];
    int at = sizeof backward;
    for (; n >= 100000000; n /= 100000000) { /* two chains of divisions that run in parallel */
        uint32_t low = (uint32_t)(n % 100000000);
        for (int i = 0; i < 8; i++, low /= 10) backward[--at] = (char)('0' + low % 10);
    }
    uint32_t high = (uint32_t)n;
    do backward[--at] = (char)('0' + high % 10), high /= 10; while (high > 0);
    memcpy(text, backward + at, sizeof backward - (size_t)at);
    return (int)sizeof backward - at;
}

static char *number_put(char *to, const char *from, int count)
{
    return memcpy(to, from, (size_t)count), to + count;
}

/* Prints digits / 10^places as %.*g does, without trailing zeros. */
static int lay_out(char text[NUMBER_SIZE], bool minus, uint64_t digits, int places, int precision)
{
    char d[20], *to = text;
    for (; digits % 10 == 0; places--) digits /= 10;
    int count = digits_of(d, digits), first = count - 1 - places, whole = first + 1;
    if (minus) *to++ = '-';
    if (first < -4 || first >= precision) {
        *to++ = d[0];
        if (count > 1) *to++ = '.', to = number_put(to, d + 1, count - 1);
        *to++ = 'e', *to++ = first < 0 ? '-' : '+';
        if (abs(first) < 10) *to++ = '0';
        to += digits_of(to, (uint64_t)abs(first));
    } else if (whole <= 0) {
        to = number_put(number_put(to, "0.000", 2 - whole), d, count);
    } else if (count > whole) {
        to = number_put(number_put(to, d, whole), ".", 1);
        to = number_put(to, d + whole, count - whole);
    } else {
        to = number_put(number_put(to, d, count), "00000000000000000", whole - count);
    }
    *to = 0;
    return (int)(to - text);
}

/* Prints the shortest decimal that reads back; returns how many digits it has. */
static int shortest(char text[NUMBER_SIZE], double value)
{
    for (int digits = 15;; digits++) {
        snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
        if (digits == 17 || strtod(text, NULL) == value) return digits;
    }
}

/* Puts a point in place of the locale's; returns the length. */
static int with_point(char text[NUMBER_SIZE])
{
    const char *mark = localeconv()->decimal_point;
    char *at = strcmp(mark, ".") != 0 ? strstr(text, mark) : NULL;
    if (at) *at = '.', memmove(at + 1, at + strlen(mark), strlen(at + strlen(mark)) + 1);
    return (int)strlen(text);
}

int number_print(char text[NUMBER_SIZE], double value, bool hexadecimal)
{
    decimal d;
    if (!isfinite(value))
        return snprintf(text, NUMBER_SIZE, "%s", isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
    if (hexadecimal) return snprintf(text, NUMBER_SIZE, "%a", value), with_point(text);
    if (value == 0) return snprintf(text, NUMBER_SIZE, signbit(value) ? "-0" : "0");
    if (shortest_quick(fabs(value), &d)) return lay_out(text, value < 0, d.digits, d.places, 15);
    shortest(text, value);
    return with_point(text);
}

int number_print_count(char text[NUMBER_SIZE], long long value)
{
    bool minus = value < 0;
    if (minus) *text = '-';
    int length = minus + digits_of(text + minus, minus ? 0 - (uint64_t)value : (uint64_t)value);
    text[length] = 0;
    return length;
}

/* The digits left out are a part of the last digit kept: 0.4 of it, say; or 0.6 if it was rounded up, and
 * then the gap is 0.4.  41 digits are exact to a relative 2^-80. */
double number_print_gap(double value)
{
    char text[2 * NUMBER_SIZE], tail[3 * NUMBER_SIZE], unit[NUMBER_SIZE];
    decimal d;
    if (!isfinite(value) || value == 0) return 0;
    if (shortest_quick(fabs(value), &d)) return fabs(d.rest) / power[d.places] * (1 + 0x1p-50);
    int digits = shortest(unit, value);
    snprintf(text, sizeof text, "%.40e", fabs(value)); /* d.ddd ... e+dd */
    char *e = strchr(text, 'e');
    int last = (int)strtol(e + 1, NULL, 10) - digits + 1;
    *e = 0;
    snprintf(tail, sizeof tail, "0.%se%d", text + digits + 1, last);
    snprintf(unit, sizeof unit, "1e%d", last);
    double gap = strtod(tail, NULL);
    return fmin(gap, strtod(unit, NULL) - gap) * (1 + 0x1p-50);
}

/* Adds half a unit of the third digit and rounds to three digits: not less than x. */
double number_round_up(double x)
{
    char text[NUMBER_SIZE];
    double raised = x * 1.005;
    if (raised >= QUICK_LEAST && raised < 1e2) {
        double p;
        decimal d = number_rounded(raised, 2 - first_place(raised), &p);
        double value = double_of(d.digits, d.places);
        if (!isnan(value)) return fmax(x, value);
    }
    snprintf(text, sizeof text, "%.2e", raised);
    return fmax(x, strtod(text, NULL));
}

int number_print_short(char text[NUMBER_SIZE], double value, int digits)
{
    if (isnan(value) || value == 0) return text[0] = value == 0 ? '0' : '-', text[1] = 0, 1;
    double size = fabs(value);
    if (size >= QUICK_LEAST && size < QUICK_MOST) {
        double p;
        int places = digits - 1 - first_place(size);
        if (places >= 0 && places <= POWER_MOST)
            return lay_out(text, value < 0, number_rounded(size, places, &p).digits, places, digits);
    }
    return snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
}

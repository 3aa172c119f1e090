// SPDX-License-Identifier: MIT
/* number.c - doubles as text, there and back.
 *
 * strtod and printf round correctly in the C library this is built with.  (What they take for the
 * point is the locale's: number_read and number_print change it.)  But they are slow: with them
 * alone, they took nine tenths of the time of sagitta intersect (a million rays and a conic, csv to
 * csv: 7.5 s, against 1.0 s as it is).  Most numbers take a quicker way to the same bytes.  The
 * quick way declines what it cannot decide, and leaves that to strtod and printf.
 *
 * OUT.  x = m 2^e with m < 2^53, so x 10^k = m 5^k 2^(e + k).  For k = 0 ... 54 the whole number m 5^k has
 * at most 179 bits, and is made exactly.  Its upper bits are x 10^k rounded down, the others say
 * what is left: so the nearest decimal is found without any rounding.
 *
 * BACK: num/decimal.h. */
#include "number.h"

#include "../num/decimal.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { LONGEST = 2000 }; /* a longer hexadecimal number is read in the locale "C" only */

/* A decimal: digits / 10^places. */
typedef struct decimal {
    uint64_t digits;
    int places;
    int left;   /* of what was rounded, what is left, or if negative missing, in units of its last digit */
} decimal;

/* -------------------------------------------------------------------- in */

static bool number_named(const char *text, const char *name)
{
    return strcasecmp(text, name) == 0 || (*text == '.' && strcasecmp(text + 1, name) == 0);
}

/* By strtod, which takes the locale's point. */
static bool read_hexadecimal(const char *text, double *value)
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

size_t number_read_first(const char *text, const char *end, double *value)
{
    size_t length;
    const bool sign = text != end && (*text == '+' || *text == '-');
    *value = decimal_read(text + sign, end, &length);
    if (length == 0 || !isfinite(*value)) return 0;
    if (sign && *text == '-') *value = -*value;
    return length + sign;
}

bool number_read_decimal(const char *text, const char *end, double *value)
{
    const size_t length = number_read_first(text, end, value);
    return length && (end ? text + length == end : !text[length]);
}

bool number_read(const char *text, double *value)
{
    const char *bare = text + (*text == '+' || *text == '-');
    double sign = *text == '-' ? -1 : 1;
    if (number_read_decimal(text, NULL, value)) return true;
    if (number_named(bare, "inf")) return *value = sign * HUGE_VAL, true;
    if (number_named(bare, "nan")) return *value = (double)NAN, true;
    return *bare == '0' && (bare[1] == 'x' || bare[1] == 'X') && read_hexadecimal(text, value);
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

static const double QUICK_LEAST = 1e-38, QUICK_MOST = 1e15;  /* the range of the quick way */

enum { FIVES = 27 };
static const uint64_t five[FIVES + 1] = { /* 5^k; five[27] < 2^63 */
    1u, 5u, 25u, 125u, 625u, 3125u, 15625u, 78125u, 390625u, 1953125u, 9765625u, 48828125u, 244140625u,
    1220703125u, 6103515625u, 30517578125u, 152587890625u, 762939453125u, 3814697265625u, 19073486328125u,
    95367431640625u, 476837158203125u, 2384185791015625u, 11920928955078125u, 59604644775390625u,
    298023223876953125u, 1490116119384765625u, 7450580596923828125u,
};

static const uint64_t ten[] = {
    1u, 10u, 100u, 1000u, 10000u, 100000u, 1000000u, 10000000u, 100000000u, 1000000000u, 10000000000u,
    100000000000u, 1000000000000u, 10000000000000u, 100000000000000u, 1000000000000000u, 10000000000000000u,
    100000000000000000u, 1000000000000000000u,
};

/* x 10^places = whole + fraction / 2^64, and less than 2^-64 more if `more`. */
typedef struct magnified {
    uint64_t whole, fraction;
    /* of x, in the same scale, in units of 2^-56, rounded down: with 17 digits from 0.55 2^56 to 12 2^56 */
    uint64_t half_ulp;
    int places;
    bool more, power_of_two;
} magnified;

/* The low 64 bits of a b + carry; *high: the others. */
static uint64_t product(uint64_t a, uint64_t b, uint64_t carry, uint64_t *high)
{
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 wide;
    wide all = (wide)a * b + carry;
    return *high = (uint64_t)(all >> 64), (uint64_t)all;
#else
    const uint64_t half = 0xffffffffu, low = (a & half) * (b & half);
    const uint64_t middle = (a >> 32) * (b & half) + (low >> 32);
    const uint64_t other = (a & half) * (b >> 32) + (middle & half);
    const uint64_t sum = other << 32 | (low & half);
    *high = (a >> 32) * (b >> 32) + (middle >> 32) + (other >> 32) + (sum + carry < sum);
    return sum + carry;
#endif
}

/* 64 bits of n[1], n[2], n[3], from bit `at` on, -64 <= at < 192; n[0] = n[4] = 0. */
static uint64_t bits_at(const uint64_t n[5], int at)
{
    const uint64_t *limb = n + (at + 64) / 64;
    const int shift = (at + 64) % 64;
    return shift ? limb[0] >> shift | limb[1] << (64 - shift) : limb[0];
}

/* Of m 5^places 2^-shift, where the product may have more than 128 bits. */
static void scale_far(magnified *to, uint64_t m, int shift)
{
    const int more = to->places > FIVES ? to->places - FIVES : 0;
    uint64_t n[5] = {0}, ulp[5] = {0}, high = 0;
    n[1] = product(m, five[to->places - more], 0, &n[2]);
    n[1] = product(n[1], five[more], 0, &high);
    n[2] = product(n[2], five[more], high, &n[3]);
    ulp[1] = product(five[to->places - more], five[more], 0, &ulp[2]);
    to->whole = bits_at(n, shift);
    to->fraction = bits_at(n, shift - 64);
    to->half_ulp = bits_at(ulp, shift - 55);
    /* 5^k is odd, so n ends in as many zeros as m */
    to->more = shift > 64 && (shift >= 64 + 53 || (m & (((uint64_t)1 << (shift - 64)) - 1)));
}

/* Sets x 10^places so that its whole part has so many digits, at most 17.  false: not the quick way.
 *
 * log2(1 + f) is f, or at most 0.09 more, for 0 <= f <= 1.  So the upper half of the bits of x is its log2,
 * but for that, and times log10 2 the power of ten of its first digit, or sometimes one less.  (The factor is
 * too small by a relative 5e-11.  No power of ten in the range but 1 is so near to a power of two.) */
static inline bool number_scale(double x, int digits, magnified *to)
{
    if (!(x >= QUICK_LEAST && x < QUICK_MOST)) return false;
    enum { LEAST_PLACE = 39 };  /* what is shifted right is not negative */
    const uint64_t one = (uint64_t)1 << 52;
    const int64_t log10_2 = 1292913986; /* in 2^-32 */
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const uint64_t m = (bits & (one - 1)) | one;
    const int e = (int)(bits >> 52) - 1075;
    const int64_t place = ((int64_t)(bits >> 32) - (1023 << 20)) * log10_2 + ((int64_t)LEAST_PLACE << 52);
    for (int k = digits - 1 + LEAST_PLACE - (int)(place >> 52);; k--) {
        const int shift = -(e + k);
        if (k < 0 || k > 2 * FIVES || shift < 1) return false;
        to->places = k, to->power_of_two = m == one, to->more = false;
        uint64_t high, low = k <= FIVES ? product(m, five[k], 0, &high) : 0;
        if (k <= FIVES && shift < 64) {
            to->whole = high << (64 - shift) | low >> shift;
            to->fraction = low << (64 - shift);
            to->half_ulp = shift > 55 ? five[k] >> (shift - 55) : five[k] << (55 - shift);
        } else if (k <= FIVES && shift > 64 && shift < 119) {
            to->whole = high >> (shift - 64);
            to->fraction = high << (128 - shift) | low >> (shift - 64);
            to->more = low << (128 - shift) != 0;
            to->half_ulp = five[k] >> (shift - 55);
        } else {
            scale_far(to, m, shift);
        }
        if (to->whole < ten[digits]) return true;
    }
}

/* Rounds to a unit of 1, 10 or 100, half to even, as printf does. */
static inline decimal rounded_to(const magnified *x, unsigned unit)
{
    const uint64_t q = x->whole / unit, middle = (uint64_t)1 << 63;
    const unsigned r = (unsigned)(x->whole % unit), border = unit > 1 ? unit / 2 : 1;
    const unsigned above = unit > 1 ? r : (unsigned)(x->fraction >> 63);
    const bool rest = (unit > 1 ? x->fraction : x->fraction & (middle - 1)) || x->more;
    const bool up = (above > border) | ((above == border) & (rest | (q & 1)));
    return (decimal){q + up, x->places - (unit == 100 ? 2 : unit == 10), (int)r - (up ? (int)unit : 0)};
}

/* How far off it is, in units of 2^-56, but for a unit. */
static inline uint64_t off_by(const decimal *d, const magnified *x)
{
    const uint64_t part = x->fraction >> 8, sign = 0 - (uint64_t)(d->left < 0);
    return ((((uint64_t)(int64_t)d->left << 56) + part) ^ sign) - sign;
}

/* The shortest of 15, 16, 17 digits that reads back as x > 0: one that is off by less than half an ulp.
 * (Just below a power of two doubles are half an ulp apart.)  false: too close to tell.  The processor cannot
 * foresee which of 16 and 17 digits it is, so there is no branch on that. */
static inline bool shortest_quick(double x, magnified *all, decimal *d)
{
    enum { SLACK = 2 };
    if (!number_scale(x, 17, all)) return false;
    const uint64_t least = (all->power_of_two ? all->half_ulp / 2 : all->half_ulp) - SLACK,
                   most = all->half_ulp + SLACK;
    const uint64_t units = (most >> 56) + 1;
    if ((all->whole + units) % 100 <= 2 * units) { /* else 15 digits are further away than `most` */
        *d = rounded_to(all, 100);
        const uint64_t off15 = off_by(d, all);
        if (off15 <= most) return off15 < least;
    }
    const decimal d16 = rounded_to(all, 10), d17 = rounded_to(all, 1);
    const uint64_t off16 = off_by(&d16, all);
    const bool shorter = off16 < least;
    d->digits = shorter ? d16.digits : d17.digits;
    d->places = shorter ? d16.places : d17.places;
    d->left = shorter ? d16.left : d17.left;
    return shorter || off16 > most;
}

/* |d - x|, or hardly more. */
static double gap_of(const decimal *d, const magnified *x)
{
    const double part = 0x1p-64 * (double)(d->left < 0 ? 0 - x->fraction : x->fraction + x->more);
    const int whole = d->left < 0 ? -d->left - (x->fraction > 0) : d->left;
    double gap = ((double)whole + part) * (1 + 0x1p-50);
    int places = x->places;
    for (; places > DECIMAL_POWER; places -= DECIMAL_POWER) gap /= decimal_ten[DECIMAL_POWER];
    return gap / decimal_ten[places];
}

static const char pairs[] = "00010203040506070809101112131415161718192021222324252627282930313233343536373839"
                            "40414243444546474849505152535455565758596061626364656667686970717273747576777879"
                            "8081828384858687888990919293949596979899";

/* How many digits n has, at most 19; 1 for 0. */
static int number_digits(uint64_t n)
{
    if (n >= ten[14]) return 15 + (n >= ten[15]) + (n >= ten[16]) + (n >= ten[17]) + (n >= ten[18]);
    int count = 1;
    for (; n >= ten[8]; n /= ten[8]) count += 8;
    for (; n >= 10; n /= 10) count++;
    return count;
}

static inline char *put_pair(char *to, uint32_t n) { return memcpy(to, pairs + 2 * n, 2), to + 2; }

/* Prints n < 10^8, with leading zeros.  All digits are made at once, in parts of a word: two of 32 bits with
 * four digits, four of 16 bits with two, eight bytes.  Rounded down, 10486 / 2^20 is 1/100 for numbers below
 * 10^4, and 103 / 2^10 is 1/10 for those below 100.  (Below, 0xd1b71759 / 2^45 is 1/10^4 for all of 32
 * bits.) */
static inline char *put_eight(char *to, uint32_t n)
{
    const uint64_t fours = n / 10000 | (uint64_t)(n % 10000) << 32;
    const uint64_t upper = (fours * 10486 >> 20) & 0x0000007f0000007fu;
    const uint64_t twos = upper | (fours - 100 * upper) << 16;
    const uint64_t tens = (twos * 103 >> 10) & 0x000f000f000f000fu;
    const uint64_t ones = (tens | (twos - 10 * tens) << 8) + 0x3030303030303030u;
    for (int i = 0; i < 8; i++) to[i] = (char)(ones >> 8 * i & 255); /* one store, or two */
    return to + 8;
}

/* The same twice, a and then b: with vectors both at once. */
static inline void put_sixteen(char *to, uint32_t a, uint32_t b)
{
#ifdef __SSE2__
    const __m128i both = _mm_set_epi32(0, (int)b, 0, (int)a), myriad = _mm_set1_epi32(10000);
    const __m128i quotient = _mm_srli_epi64(_mm_mul_epu32(both, _mm_set1_epi32((int)0xd1b71759u)), 45);
    const __m128i rest = _mm_sub_epi32(both, _mm_mul_epu32(quotient, myriad));
    const __m128i fours = _mm_or_si128(quotient, _mm_slli_epi64(rest, 32));
    const __m128i upper = _mm_srli_epi16(_mm_mulhi_epu16(fours, _mm_set1_epi16(10486)), 4);
    const __m128i lower = _mm_sub_epi16(fours, _mm_mullo_epi16(upper, _mm_set1_epi16(100)));
    const __m128i twos = _mm_or_si128(upper, _mm_slli_epi32(lower, 16));
    const __m128i tens = _mm_srli_epi16(_mm_mullo_epi16(twos, _mm_set1_epi16(103)), 10);
    const __m128i ones = _mm_sub_epi16(twos, _mm_mullo_epi16(tens, _mm_set1_epi16(10)));
    const __m128i digits = _mm_or_si128(tens, _mm_slli_epi16(ones, 8));
    _mm_storeu_si128((__m128i *)(void *)to, _mm_add_epi8(digits, _mm_set1_epi8('0')));
#else
    put_eight(put_eight(to, a), b);
#endif
}

/* Prints n with so many digits, with leading zeros, as they follow a point.  18 characters are written. */
static char *put_places(char *to, uint64_t n, int count)
{
    n *= ten[18 - count];
    const uint64_t eight = 100000000;
    put_sixteen(put_pair(to, (uint32_t)(n / (eight * eight))), (uint32_t)(n / eight % eight),
                (uint32_t)(n % eight));
    return to + count;
}

/* Prints a whole number of so many digits. */
static char *put_whole(char *to, uint64_t n, int count)
{
    char *const end = to + count, *at = end;
    if (count <= 2) return memcpy(to, pairs + 2 * n + (count == 1), 2), end;
    for (; count > 8; count -= 8, n /= 100000000) put_eight(at -= 8, (uint32_t)(n % 100000000));
    uint32_t part = (uint32_t)n;
    for (; count > 1; count -= 2, part /= 100) put_pair(at -= 2, part % 100);
    if (count) at[-1] = (char)('0' + part);
    return end;
}

/* Prints digits / 10^places, what x was rounded to, as %.*g does, without trailing zeros. */
static int lay_out(char text[NUMBER_SIZE], double x, uint64_t digits, int places, int precision)
{
    char *to = text;
    const bool minus = x < 0;
    for (; digits % 100000000 == 0; places -= 8) digits /= 100000000;
    for (; digits % 10 == 0; places--) digits /= 10;
    const int count = number_digits(digits), first = count - 1 - places;
    *to = '-';
    to += minus;
    if (first < -4 || first >= precision) {
        const uint64_t unit = ten[count - 1];
        *to++ = (char)('0' + digits / unit);
        if (count > 1) *to++ = '.', to = put_places(to, digits % unit, count - 1);
        *to++ = 'e', *to++ = first < 0 ? '-' : '+';
        to = put_pair(to, (uint32_t)abs(first));
    } else if (first < 0) {
        memcpy(to, "0.000", 5);
        to = put_places(to + 1 - first, digits, count);
    } else if (places > 0) {
        /* The whole part is that of |x|, or one more if it was rounded up.  A division takes longer. */
        const uint64_t unit = ten[places];
        uint64_t whole = (uint64_t)(int64_t)fabs(x), rest = digits - whole * unit;
        if (rest >= unit) whole++, rest -= unit;
        to = put_whole(to, whole, first + 1);
        *to++ = '.';
        to = put_places(to, rest, places);
    } else {
        to = put_whole(to, digits * ten[-places], first + 1);
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
    magnified all;
    decimal d;
    if (!isfinite(value))
        return snprintf(text, NUMBER_SIZE, "%s", isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
    if (hexadecimal) return snprintf(text, NUMBER_SIZE, "%a", value), with_point(text);
    if (value == 0) return snprintf(text, NUMBER_SIZE, signbit(value) ? "-0" : "0");
    if (shortest_quick(fabs(value), &all, &d)) return lay_out(text, value, d.digits, d.places, 15);
    shortest(text, value);
    return with_point(text);
}

int number_print_count(char text[NUMBER_SIZE], long long value)
{
    bool minus = value < 0;
    if (minus) *text = '-';
    const uint64_t size = minus ? 0 - (uint64_t)value : (uint64_t)value;
    char *end = put_whole(text + minus, size, number_digits(size));
    *end = 0;
    return (int)(end - text);
}

/* The digits left out are a part of the last digit kept: 0.4 of it, say; or 0.6 if it was rounded up, and
 * then the gap is 0.4.  41 digits are exact to a relative 2^-80. */
static double gap_slowly(double value)
{
    char text[2 * NUMBER_SIZE], tail[3 * NUMBER_SIZE], unit[NUMBER_SIZE];
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

int number_print_with_gap(char text[NUMBER_SIZE], double value, double *gap)
{
    magnified all;
    decimal d;
    if (!isfinite(value) || value == 0) return *gap = 0, number_print(text, value, false);
    if (shortest_quick(fabs(value), &all, &d))
        return *gap = gap_of(&d, &all), lay_out(text, value, d.digits, d.places, 15);
    return *gap = gap_slowly(value), number_print(text, value, false);
}

/* Adds half a unit of the third digit and rounds to three digits: not less than x.  (From 101 on half a unit
 * is less than was added.)  false: not the quick way. */
static bool rounded_up(double x, decimal *d)
{
    const double raised = x * 1.005;
    magnified three;
    if (!(raised < 1e2) || !number_scale(raised, 3, &three)) return false;
    *d = rounded_to(&three, 1);
    return d->digits > 100 || decimal_quick(d->digits, -d->places) >= x;
}

double number_round_up(double x)
{
    char text[NUMBER_SIZE];
    decimal d;
    const double value = rounded_up(x, &d) ? decimal_quick(d.digits, -d.places) : (double)NAN;
    if (!isnan(value)) return fmax(x, value);
    snprintf(text, sizeof text, "%.2e", x * 1.005);
    return fmax(x, strtod(text, NULL));
}

int number_print_up(char text[NUMBER_SIZE], double x)
{
    decimal d;
    if (rounded_up(x, &d)) return lay_out(text, x, d.digits, d.places, 15);
    return number_print(text, number_round_up(x), false);
}

int number_print_short(char text[NUMBER_SIZE], double value, int digits)
{
    if (isnan(value) || value == 0) return text[0] = value == 0 ? '0' : '-', text[1] = 0, 1;
    magnified few;
    if (number_scale(fabs(value), digits, &few)) {
        decimal d = rounded_to(&few, 1);
        return lay_out(text, value, d.digits, d.places, digits);
    }
    return snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
}

/* fuzz_interval.c - bytes as intervals, and the operations of sagitta/interval.h on them.
 *
 * A result contains what the operation makes of the ends of its arguments and of numbers between them, in
 * long double, whose own rounding is allowed for; the result for a part of an argument lies in the result
 * for the whole; an empty argument gives the empty result, one with a NaN all numbers; a result is never
 * NaN, and what is not empty is in order.  tests/interval holds them to MPFR; here is what nobody thought
 * of drawing. */
#include "fuzz.h"

#include <sagitta/interval.h>

typedef long double wide;

static const char *now = "";
static sgt_interval now_x, now_y;

#define HOLDS(condition, r, ...)                                                                             \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            fprintf(stderr, "    %s of [%a, %a], [%a, %a] is [%a, %a]\n", now, now_x.lo, now_x.hi, now_y.lo, \
                    now_y.hi, (r).lo, (r).hi);                                                               \
            REQUIRE(condition, __VA_ARGS__);                                                                 \
        }                                                                                                    \
    } while (0)

typedef enum operation {
    SUM,
    DIFFERENCE,
    PRODUCT,
    QUOTIENT,
    SQUARE,
    ROOT,
    ABSOLUTE,
    POWER,
    NEGATIVE,
    HULL,
    INTERSECTION,
    OPERATIONS
} operation;
static const char *const names[] = {"sum",      "difference", "product",  "quotient", "square",      "root",
                                    "absolute", "power",      "negative", "hull",     "intersection"};

static sgt_interval apply(operation op, sgt_interval x, sgt_interval y, int n)
{
    switch (op) {
    case SUM: return sgt_interval_sum(x, y);
    case DIFFERENCE: return sgt_interval_difference(x, y);
    case PRODUCT: return sgt_interval_product(x, y);
    case QUOTIENT: return sgt_interval_quotient(x, y);
    case SQUARE: return sgt_interval_square(x);
    case ROOT: return sgt_interval_square_root(x);
    case ABSOLUTE: return sgt_interval_absolute(x);
    case POWER: return sgt_interval_power(x, n);
    case NEGATIVE: return sgt_interval_negative(x);
    case HULL: return sgt_interval_hull(x, y);
    default: return sgt_interval_intersection(x, y);
    }
}

/* Of two numbers; NaN: there is none.  *err: how far it can be off. */
static wide at(operation op, wide x, wide y, int n, wide *err)
{
    wide r = 0;
    switch (op) {
    case SUM: r = x + y; break;
    case DIFFERENCE: r = x - y; break;
    case PRODUCT: r = x * y; break;
    case QUOTIENT: r = y != 0 ? x / y : (wide)NAN; break;
    case SQUARE: r = x * x; break;
    case ROOT: r = x >= 0 ? sqrtl(x) : (wide)NAN; break;
    case ABSOLUTE: r = fabsl(x); break;
    case POWER: {
        unsigned left = n < 0 ? 0u - (unsigned)n : (unsigned)n;
        wide p = 1;
        for (unsigned i = 0; i < left && p != 0 && fabsl(p) < 0x1p16000L; i++) p *= x;
        if (!(fabsl(p) < 0x1p16000L)) p = NAN;
        r = n < 0 ? (p != 0 ? 1 / p : (wide)NAN) : p;
        break;
    }
    case NEGATIVE: r = -x; break;
    case HULL: r = x; break;
    default: r = x == y ? x : (wide)NAN; break;
    }
    *err = fabsl(r) * (op == POWER ? 0x1p-52L : 0x1p-63L) + 0x1p-16000L;
    if (op == ABSOLUTE || op == NEGATIVE || op == HULL || op == INTERSECTION) *err = 0;
    return r;
}

static int numbers(sgt_interval x, double out[5])
{
    if (!(x.lo <= x.hi)) return 0;
    double lo = x.lo < -DBL_MAX ? -DBL_MAX : x.lo, hi = x.hi > DBL_MAX ? DBL_MAX : x.hi;
    if (!(lo <= hi)) return 0; /* beyond the largest double */
    int count = 0;
    out[count++] = lo, out[count++] = hi;
    double middle = sgt_interval_middle(x);
    REQUIRE(middle >= x.lo && middle <= x.hi && isfinite(middle), "the middle of [%a, %a] is %a", x.lo, x.hi,
            middle);
    out[count++] = middle;
    if (lo <= 0 && hi >= 0) out[count++] = 0;
    if (lo <= 1 && hi >= 1) out[count++] = 1;
    return count;
}

/* Holds a NaN, and so nothing is known of it. */
static bool unknown(sgt_interval x) { return isnan(x.lo) || isnan(x.hi); }
static bool is_unary(operation op) { return op >= SQUARE && op <= NEGATIVE; }

static sgt_interval part_of(sgt_interval x, unsigned how)
{
    double inner[5];
    int n = numbers(x, inner);
    if (n < 3) return x;
    double a = inner[how % 3], b = inner[(how / 3) % 3];
    return a < b ? (sgt_interval){a, b} : (sgt_interval){b, a};
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes b = {.at = data, .left = size};
    unsigned what = take_byte(&b), how = take_byte(&b);
    operation op = (operation)(what % OPERATIONS);
    int n = (int)(int8_t)take_byte(&b) / (how & 1 ? 1 : 16);
    sgt_interval x, y;
    x.lo = take_number(&b), x.hi = take_number(&b), y.lo = take_number(&b), y.hi = take_number(&b);
    if (how & 2 && x.lo > x.hi) x = (sgt_interval){x.hi, x.lo};
    if (how & 2 && y.lo > y.hi) y = (sgt_interval){y.hi, y.lo};
    now = names[op], now_x = x, now_y = y;
    sgt_interval r = apply(op, x, y, n);
    HOLDS(!isnan(r.lo) && !isnan(r.hi), r, "NaN");
    HOLDS(r.lo <= r.hi || (r.lo == HUGE_VAL && r.hi == -HUGE_VAL), r, "empty otherwise");
    bool blind = unknown(x) || (!is_unary(op) && unknown(y)),
         empty = x.lo > x.hi || (!is_unary(op) && y.lo > y.hi);
    if (op != HULL && op != INTERSECTION) {
        if (blind && !empty) HOLDS(r.lo == -HUGE_VAL && r.hi == HUGE_VAL, r, "of a NaN all is possible");
        if (empty && !blind) HOLDS(r.lo > r.hi, r, "of nothing nothing");
    }
    double in_x[5], in_y[5];
    int many_x = numbers(x, in_x), many_y = is_unary(op) ? 1 : numbers(y, in_y);
    if (is_unary(op)) in_y[0] = 1;
    for (int i = 0; i < many_x; i++)
        for (int j = 0; j < many_y; j++) {
            wide err, v = at(op, in_x[i], in_y[j], n, &err);
            if (isnan(v) || isinf(v)) continue; /* beyond a long double */
            HOLDS(v + err >= (wide)r.lo && v - err <= (wide)r.hi, r, "%a, %a, n %d: %Lg is outside", in_x[i],
                  in_y[j], n, v);
        }
    /* a result as tight as is promised: two doubles farther out at most, where it is one operation on
     * numbers */
    if (x.lo == x.hi && (is_unary(op) || y.lo == y.hi) && many_x && many_y && op != POWER && op != HULL) {
        wide err, v = at(op, in_x[0], in_y[0], n, &err);
        if (fabsl(v) < 0x1p1023L)
            HOLDS(r.lo > r.hi || ((wide)moved(r.lo, 2) >= v - err && (wide)moved(r.hi, -2) <= v + err), r,
                  "too wide: %Lg", v);
    }
    if (many_x && (is_unary(op) || many_y) && !blind) {
        sgt_interval inner = apply(op, part_of(x, how >> 2), part_of(y, how >> 4), n);
        HOLDS(sgt_interval_is_in(inner, r), r, "of a part it is [%a, %a]", inner.lo, inner.hi);
    }
    if (x.lo <= x.hi) {
        double width = sgt_interval_width(x), greatest = sgt_interval_greatest(x);
        HOLDS(!((wide)width * (1 + 0x1p-60L) < (wide)x.hi - (wide)x.lo) && greatest >= fabs(x.lo) &&
                  greatest >= fabs(x.hi),
              x, "width %a, greatest %a", width, greatest);
        HOLDS(sgt_interval_has(x, x.lo) && !(sgt_interval_is_positive(x) && x.lo <= 0) &&
                  sgt_interval_is_negative(x) == (x.hi < 0),
              x, "what is told of its signs");
    }
    return 0;
}

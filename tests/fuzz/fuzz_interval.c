// SPDX-License-Identifier: MIT
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
    CUBE_ROOT,
    EXPONENTIAL,
    LOGARITHM,
    SINE,
    COSINE,
    TANGENT,
    ARC_SINE,
    ARC_COSINE,
    ARC_TANGENT,
    HYPERBOLIC_SINE,
    HYPERBOLIC_COSINE,
    HYPERBOLIC_TANGENT,
    ANGLE,
    HYPOTENUSE,
    REAL_POWER,
    HULL,
    INTERSECTION,
    OPERATIONS
} operation;
static const char *const names[] = {
    "sum", "difference", "product", "quotient", "square", "root", "absolute", "power", "negative",
    "cube_root", "exponential", "logarithm", "sine", "cosine", "tangent", "arc_sine", "arc_cosine",
    "arc_tangent", "hyperbolic_sine", "hyperbolic_cosine", "hyperbolic_tangent", "angle", "hypotenuse",
    "real_power", "hull", "intersection"};

/* The elementary functions of one number, from CUBE_ROOT on. */
typedef struct elementary { sgt_interval (*of)(sgt_interval); wide (*at)(wide); } elementary;
static const elementary elementaries[] = {
    {sgt_interval_cube_root, cbrtl},
    {sgt_interval_exponential, expl},
    {sgt_interval_logarithm, logl},
    {sgt_interval_sine, sinl},
    {sgt_interval_cosine, cosl},
    {sgt_interval_tangent, tanl},
    {sgt_interval_arc_sine, asinl},
    {sgt_interval_arc_cosine, acosl},
    {sgt_interval_arc_tangent, atanl},
    {sgt_interval_hyperbolic_sine, sinhl},
    {sgt_interval_hyperbolic_cosine, coshl},
    {sgt_interval_hyperbolic_tangent, tanhl}};

static bool is_elementary(operation op) { return op >= CUBE_ROOT && op <= REAL_POWER; }

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
    case ANGLE: return sgt_interval_angle(x, y);
    case HYPOTENUSE: return sgt_interval_hypotenuse(x, y);
    case REAL_POWER: return sgt_interval_real_power(x, y);
    case INTERSECTION: return sgt_interval_intersection(x, y);
    default: return elementaries[op - CUBE_ROOT].of(x);
    }
}

/* Of numbers for which it is defined; long double's is within some units of its last place. */
static wide elementary_at(operation op, wide x, wide y)
{
    switch (op) {
    case ANGLE: return x == 0 && y == 0 ? (wide)NAN : atan2l(x == 0 ? 0 : x, y);
    case HYPOTENUSE: return hypotl(x, y);
    case REAL_POWER: return x < 0 || (x == 0 && y <= 0) ? (wide)NAN : powl(x, y);
    default: return elementaries[op - CUBE_ROOT].at(x);
    }
}

/* Sine, cosine and tangent tell nothing there. */
static bool is_far(operation op, sgt_interval x)
{
    return op >= SINE && op <= TANGENT && !(x.lo >= -SGT_TURN_LIMIT && x.hi <= SGT_TURN_LIMIT);
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
    case INTERSECTION: r = x == y ? x : (wide)NAN; break;
    default: r = elementary_at(op, x, y); break;
    }
    *err = fabsl(r) * (op == POWER ? 0x1p-52L : 0x1p-63L) + 0x1p-16000L;
    if (is_elementary(op)) *err = fabsl(r) * 0x1p-60L + 0x1p-16000L;
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
static bool is_unary(operation op) { return op >= SQUARE && op <= HYPERBOLIC_TANGENT; }

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
        if (fabsl(v) < 0x1p1023L && !is_far(op, x))
            HOLDS(r.lo > r.hi || ((wide)moved(r.lo, 2) >= v - err && (wide)moved(r.hi, -2) <= v + err), r,
                  "too wide: %Lg", v);
    }
    if (many_x && (is_unary(op) || many_y) && !blind) {
        sgt_interval inner = apply(op, part_of(x, how >> 2), part_of(y, how >> 4), n);
        /* an end may be the best one or two doubles farther, and so not in the order of the values */
        sgt_interval about = r;
        if (is_elementary(op) && r.lo <= r.hi) about = (sgt_interval){moved(r.lo, -2), moved(r.hi, 2)};
        HOLDS(sgt_interval_is_in(inner, about), r, "of a part it is [%a, %a]", inner.lo, inner.hi);
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

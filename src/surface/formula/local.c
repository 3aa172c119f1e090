// SPDX-License-Identifier: MIT
/* local.c - one operation of a formula on a row of points (local.h). */
#include "local.h"

#include <string.h>

#define ROWS_OF(NAME) \
    SGT_KERNEL                                                                                             \
    static void NAME(size_t n, const double *restrict a, const double *restrict b, double *restrict v,     \
                     double *restrict va, double *restrict vb, double *restrict vaa, double *restrict vab, \
                     double *restrict vbb)

/* An operation on one operand: x is a number, y the result. */
#define OF_ONE(NAME, VALUE, FIRST, SECOND)                                                            \
    ROWS_OF(NAME##_second)                                                                               \
    {                                                                                                 \
        (void)b, (void)vb, (void)vab, (void)vbb;                                                      \
        LANES for (size_t i = 0; i < n; i++) {                                               \
            double x = a[i], y = VALUE, f = FIRST;                                                    \
            v[i] = y, va[i] = f, vaa[i] = SECOND;                                                     \
        }                                                                                             \
    }                                                                                                 \
    ROWS_OF(NAME##_first)                                                                                \
    {                                                                                                 \
        (void)b, (void)vb, (void)vaa, (void)vab, (void)vbb;                                           \
        LANES for (size_t i = 0; i < n; i++) {                                               \
            double x = a[i], y = VALUE;                                                               \
            v[i] = y, va[i] = FIRST;                                                                  \
        }                                                                                             \
    }                                                                                                 \
    ROWS_OF(NAME##_value)                                                                                \
    {                                                                                                 \
        (void)b, (void)va, (void)vb, (void)vaa, (void)vab, (void)vbb;                                 \
        LANES for (size_t i = 0; i < n; i++) {                                               \
            double x = a[i];                                                                          \
            v[i] = VALUE;                                                                             \
        }                                                                                             \
    }

/* Of two operands, x and w. */
#define OF_TWO(NAME, VALUE, BY_A, BY_B, AA, AB, BB)                                                   \
    ROWS_OF(NAME##_second)                                                                               \
    {                                                                                                 \
        LANES for (size_t i = 0; i < n; i++) {                                               \
            double x = a[i], w = b[i], y = VALUE, f = BY_A, g = BY_B;                                 \
            v[i] = y, va[i] = f, vb[i] = g, vaa[i] = AA, vab[i] = AB, vbb[i] = BB;                    \
            (void)f, (void)g;                                                                         \
        }                                                                                             \
    }                                                                                                 \
    ROWS_OF(NAME##_first)                                                                                \
    {                                                                                                 \
        (void)vaa, (void)vab, (void)vbb;                                                              \
        LANES for (size_t i = 0; i < n; i++) {                                               \
            double x = a[i], w = b[i], y = VALUE;                                                     \
            v[i] = y, va[i] = BY_A, vb[i] = BY_B;                                                     \
        }                                                                                             \
    }                                                                                                 \
    ROWS_OF(NAME##_value)                                                                                \
    {                                                                                                 \
        (void)va, (void)vb, (void)vaa, (void)vab, (void)vbb;                                          \
        LANES for (size_t i = 0; i < n; i++) {                                               \
            double x = a[i], w = b[i];                                                                \
            v[i] = VALUE;                                                                             \
        }                                                                                             \
    }

#define UNDEFINED (double)NAN

/* A number that is NaN if x or w is, else y. */
SGT_INLINE double if_both(double x, double w, double y)
{
    return chosen(MASK((x == x) & (w == w)), y, UNDEFINED);
}

SGT_INLINE double divided(double x, double w) { return chosen(MASK(w != 0), x / w, UNDEFINED); }
SGT_INLINE double divided_or_0(double x, double w) { return chosen(MASK(w != 0), x / w, 0); }

OF_TWO(add, x + w, 1, 1, 0, 0, 0)
OF_TWO(subtract, x - w, 1, -1, 0, 0, 0)
OF_TWO(multiply, x * w, w, x, 0, 1, 0)
OF_TWO(divide, divided(x, w), divided(1, w), -divided(y, w), 0, divided(-1, w * w), 2 * divided(y, w * w))
OF_TWO(least, if_both(x, w, x <= w ? x : w), x <= w ? 1 : 0, x <= w ? 0 : 1, 0, 0, 0)
OF_TWO(most, if_both(x, w, x >= w ? x : w), x >= w ? 1 : 0, x >= w ? 0 : 1, 0, 0, 0)
OF_TWO(hypot_of, lane_hypot(x, w), divided_or_0(x, y), divided_or_0(w, y), divided(g * g, y),
       -divided(f * g, y), divided(f * f, y))
/* atan2(x, w): x is the y of the point */
OF_TWO(angle, lane_atan2(x, w), divided(divided(w, lane_hypot(x, w)), lane_hypot(x, w)),
       -divided(divided(x, lane_hypot(x, w)), lane_hypot(x, w)), 2 * f * g, g * g - f * f, -2 * f * g)
/* x^w, x > 0; at x = 0 it is 0 for w > 0.  A loop for each power: two in one loop need more registers than
 * there are. */
SGT_INLINE double log_or_0(double x) { return chosen(MASK(x > 0), lane_log(x), 0); }

SGT_KERNEL
static void rows_of_power(size_t n, const double *a, const double *b, double less, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = lane_power(a[i], b[i] - less);
}
ROWS_OF(real_power_value)
{
    (void)va, (void)vb, (void)vaa, (void)vab, (void)vbb;
    rows_of_power(n, a, b, 0, v);
}
ROWS_OF(real_power_first)
{
    (void)vaa, (void)vab, (void)vbb;
    rows_of_power(n, a, b, 0, vb), rows_of_power(n, a, b, 1, va);
    LANES for (size_t i = 0; i < n; i++) {
        double w = b[i], y = vb[i], log = log_or_0(a[i]);
        v[i] = y, va[i] *= w, vb[i] = y * log;
    }
}
ROWS_OF(real_power_second)
{
    rows_of_power(n, a, b, 0, vb), rows_of_power(n, a, b, 1, va), rows_of_power(n, a, b, 2, vaa);
    LANES for (size_t i = 0; i < n; i++) {
        double w = b[i], y = vb[i], less = va[i], log = log_or_0(a[i]), g = y * log;
        v[i] = y, va[i] = w * less, vb[i] = g;
        vaa[i] *= w * (w - 1), vab[i] = less * (1 + w * log), vbb[i] = g * log;
    }
}

OF_ONE(copy, x, 1, y - y)
OF_ONE(square, x * x, 2 * x, 2 + (y - y))
OF_ONE(negative, -x, -1, y - y)
OF_ONE(absolute, fabs(x), x < 0 ? -1.0 : 1.0, y - y)
OF_ONE(square_root, sqrt(x), divided(0.5, y), divided(divided(-0.25, y), x))
OF_ONE(cube_root, lane_cbrt(x), divided(divided(1.0 / 3, y), y), divided(divided(divided(-2.0 / 9, y), y), x))
OF_ONE(exponential, lane_exp(x), y, f)
OF_ONE(logarithm, lane_log(x), divided(1, x), -f * f + (y - y))
OF_ONE(sine, lane_sin(x), lane_cos(x), -y + 0 * f)
OF_ONE(cosine, lane_cos(x), -lane_sin(x), -y + 0 * f)
OF_ONE(tangent, lane_tan(x), 1 + y * y, 2 * y * f)
OF_ONE(arc_sine, lane_asin(x), divided(1, sqrt((1 - x) * (1 + x))), x * f * f * f + (y - y))
OF_ONE(arc_cosine, lane_acos(x), divided(-1, sqrt((1 - x) * (1 + x))), x * f * f * f + (y - y))
OF_ONE(arc_tangent, lane_atan(x), 1 / (1 + x * x), -2 * x * f * f + (y - y))
OF_ONE(sine_h, lane_sinh(x), lane_cosh(x), y + 0 * f)
OF_ONE(cosine_h, lane_cosh(x), lane_sinh(x), y + 0 * f)
OF_ONE(tangent_h, lane_tanh(x), (1 - y) * (1 + y), -2 * y * f)

SGT_KERNEL
void sgt_row_scaled(size_t n, double by, const double *a, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = by * a[i];
}

SGT_KERNEL
void sgt_row_product(size_t n, const double *a, const double *b, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = a[i] * b[i];
}

SGT_KERNEL
void sgt_row_products(size_t n, const double *va, const double *a, const double *vb, const double *b,
                      double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = va[i] * a[i] + vb[i] * b[i];
}

/* Of a^e, e < 0, with a^-e in v: its value, e v / a, and e (e - 1) v / a^2. */
SGT_KERNEL
static void rows_inverse(size_t n, double e, const double *restrict a, double *restrict v, double *restrict f,
                         double *restrict s)
{
    LANES for (size_t i = 0; i < n; i++) {
        double y = divided(1, v[i]), by = divided(y, a[i]);
        v[i] = y, f[i] = e * by, s[i] = e * (e - 1) * divided(by, a[i]);
    }
}

/* Powers go by few numbers at a time, for the sake of the stack. */
enum { POWER_BLOCK = 16 };

/* a^e by squaring; 1 if e is not above 0. */
static void rows_raised(size_t n, int e, const double *a, double *out)
{
    double square[POWER_BLOCK];
    for (size_t i = 0; i < n; i++) square[i] = a[i], out[i] = 1;
    for (; e > 0; e >>= 1) {
        if (e & 1) sgt_row_product(n, out, square, out);
        if (e > 1) sgt_row_product(n, square, square, square);
    }
}

typedef void power_rows(size_t n, int e, const double *a, bool first, double *v, double *va, double *vaa);

/* a^e.  With p = a^(|e| - 2), v = (p a) a, whatever else is wanted. */
static void power_block(size_t n, int e, const double *a, bool first, double *v, double *va, double *vaa)
{
    double p[POWER_BLOCK], f[POWER_BLOCK], s[POWER_BLOCK];
    rows_raised(n, (e < 0 ? -e : e) - 2, a, p);
    if (e == -1) memcpy(v, a, n * sizeof *v);
    else sgt_row_product(n, p, a, f), sgt_row_product(n, f, a, v);
    if (e < 0) rows_inverse(n, e, a, v, f, s);
    else if (first) sgt_row_scaled(n, e, f, f);
    if (e > 0 && vaa) sgt_row_scaled(n, (double)e * (e - 1), p, p);
    if (first) memcpy(va, f, n * sizeof *va);
    if (vaa) memcpy(vaa, e < 0 ? s : p, n * sizeof *vaa);
}

/* sqrt(a)^e, e odd and 3 or more. */
static void half_power_block(size_t n, int e, const double *a, bool first, double *v, double *va,
                             double *vaa)
{
    double s[POWER_BLOCK], p[POWER_BLOCK];
    square_root_value(n, a, NULL, s, NULL, NULL, NULL, NULL, NULL);
    rows_raised(n, e - 2, s, p);
    sgt_row_product(n, p, s, v), sgt_row_product(n, v, s, v);
    if (first) sgt_row_scaled(n, 0.5 * e, p, va);
    if (!vaa) return;
    rows_raised(n, e - 4, s, vaa);
    for (size_t i = 0; e == 3 && i < n; i++) vaa[i] = divided(1, s[i]);
    sgt_row_scaled(n, 0.25 * e * (e - 2.0), vaa, vaa);
}

static void in_blocks(power_rows *power, size_t n, int e, const double *a, bool first, formula_local out)
{
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < POWER_BLOCK ? n - i : POWER_BLOCK;
        power(few, e, a + i, first, out.v + i, first ? out.va + i : NULL, out.vaa ? out.vaa + i : NULL);
    }
}

void sgt_formula_local(formula_op op, int e, size_t n, const double *a, const double *b, bool first,
                       formula_local out)
{
    typedef void rows(size_t, const double *restrict, const double *restrict, double *restrict,
                      double *restrict, double *restrict, double *restrict, double *restrict,
                      double *restrict);
#define OF(OP, NAME) [OP] = {NAME##_value, NAME##_first, NAME##_second}
    static rows *const of[][3] = {
        OF(FORMULA_ADD, add),           OF(FORMULA_SUB, subtract),     OF(FORMULA_MUL, multiply),
        OF(FORMULA_DIV, divide),        OF(FORMULA_MIN, least),        OF(FORMULA_MAX, most),
        OF(FORMULA_HYPOT, hypot_of),    OF(FORMULA_ATAN2, angle),      OF(FORMULA_REAL_POWER, real_power),
        OF(FORMULA_SQUARE, square),     OF(FORMULA_NEG, negative),     OF(FORMULA_ABS, absolute),
        OF(FORMULA_SQRT, square_root),  OF(FORMULA_CBRT, cube_root),   OF(FORMULA_EXP, exponential),
        OF(FORMULA_LOG, logarithm),     OF(FORMULA_SIN, sine),         OF(FORMULA_COS, cosine),
        OF(FORMULA_TAN, tangent),       OF(FORMULA_ASIN, arc_sine),    OF(FORMULA_ACOS, arc_cosine),
        OF(FORMULA_ATAN, arc_tangent),  OF(FORMULA_SINH, sine_h),      OF(FORMULA_COSH, cosine_h),
        OF(FORMULA_TANH, tangent_h),    OF(FORMULA_COPY, copy)};
    if (op == FORMULA_POWER) in_blocks(power_block, n, e, a, first, out);
    else if (op == FORMULA_HALF_POWER) in_blocks(half_power_block, n, e, a, first, out);
    else of[op][out.vaa ? 2 : first](n, a, b, out.v, out.va, out.vb, out.vaa, out.vab, out.vbb);
}

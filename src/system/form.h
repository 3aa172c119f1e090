// SPDX-License-Identifier: MIT
/* form.h - numbers that depend on two parameters, linear but for a bound: Taylor models of the first order.
 *
 * A form is the set of functions x of (U, V) in [-1, 1]^2 with
 *
 *     |x(U, V) - (c + a U + b V)| <= e   wherever x is defined.
 *
 * An operation returns a form that contains what it does to members of its arguments, where it has a value:
 * of a root that may be of negative numbers, it is that of the part which is not negative.  So a form of a
 * ray says nothing of rays that do not get there, and all of those that do.  (Makino and Berz 2003, Int. J.
 * Pure Appl. Math. 4, 379; with e in place of their intervals.  Comba and Stolfi 1993 call it affine
 * arithmetic.)
 *
 * Test: tests/unit/test_form.c.
 *
 * WHY NOT INTERVALS.  Each surface of a lens undoes what another has done.  Intervals forget that, and after
 * six surfaces are wider than the lens.  What a form leaves out is of second order in the size of the box.
 *
 * ROUNDING.  Each coefficient is rounded some times.  What that loses is at most ROUND of the magnitudes that
 * were added up, and is added to e, which itself is made larger by ROUND, and by a number that no underflow
 * reaches.  A NaN or an infinity in a form says that nothing is known.  So tests are written to be false for
 * them. */
#ifndef SGT_SYSTEM_FORM_H
#define SGT_SYSTEM_FORM_H
#include "trace.h"

#include <sagitta/interval.h>

typedef struct linear { double c, a, b, e; } linear;

#define FORM_ROUND (8 * SGT_U)
#define FORM_LEAST 0x1p-900

/* The same with e made sound: `size` is the sum of the magnitudes that were rounded. */
SGT_INLINE linear form_made(double c, double a, double b, double e, double size)
{
    return (linear){c, a, b, e * (1 + FORM_ROUND) + FORM_ROUND * size + FORM_LEAST};
}

SGT_INLINE linear form_of(double c) { return (linear){c, 0, 0, 0}; }
SGT_INLINE double form_linear(linear x) { return fabs(x.a) + fabs(x.b); }
SGT_INLINE double form_size(linear x) { return fabs(x.c) + form_linear(x); }

SGT_INLINE bool form_is_zero(linear x) { return form_size(x) == 0 && x.e == 0; }

/* A form that contains an interval; nothing is known of the ends. */
SGT_INLINE linear form_between(sgt_interval x)
{
    double c = sgt_interval_middle(x), e = larger(x.hi - c, c - x.lo);
    return form_made(c, 0, 0, e, fabs(c) + e);
}

SGT_INLINE sgt_interval form_range(linear x)
{
    double by = form_linear(x) + x.e, off = FORM_ROUND * (fabs(x.c) + by) + FORM_LEAST;
    return (sgt_interval){x.c - by - off, x.c + by + off};
}

SGT_INLINE bool form_below(linear x, double limit) { return form_range(x).hi < limit; }
SGT_INLINE bool form_above(linear x, double limit) { return form_range(x).lo > limit; }

SGT_INLINE linear form_negative(linear x) { return (linear){-x.c, -x.a, -x.b, x.e}; }
SGT_INLINE linear form_wider(linear x, double by)
{
    return (linear){x.c, x.a, x.b, (x.e + by) * (1 + FORM_ROUND)};
}

SGT_INLINE linear form_sum(linear x, linear y)
{
    linear s = {x.c + y.c, x.a + y.a, x.b + y.b, x.e + y.e};
    return form_made(s.c, s.a, s.b, s.e, form_size(s));
}

SGT_INLINE linear form_difference(linear x, linear y) { return form_sum(x, form_negative(y)); }
SGT_INLINE linear form_plus(linear x, double k) { return form_made(x.c + k, x.a, x.b, x.e, fabs(x.c + k)); }

/* Times a number known exactly. */
SGT_INLINE linear form_scaled(linear x, double k)
{
    linear s = {x.c * k, x.a * k, x.b * k, x.e * fabs(k)};
    return form_made(s.c, s.a, s.b, s.e, form_size(s));
}

/* (c + l)(c' + l') with l, l' linear.  Of l l' the squares are known in sign: a a' U^2 is from 0 to a a'. */
SGT_INLINE linear form_product(linear x, linear y)
{
    double aa = x.a * y.a, bb = x.b * y.b, ab = fabs(x.a * y.b + x.b * y.a);
    double half = 0.5 * (fabs(aa) + fabs(bb)), e = half + ab;
    e += x.e * (form_size(y) + y.e) + y.e * form_size(x);
    return form_made(x.c * y.c + 0.5 * (aa + bb), x.c * y.a + y.c * x.a, x.c * y.b + y.c * x.b, e,
                     form_size(x) * form_size(y));
}

/* l^2 is between 0 and (|a| + |b|)^2. */
SGT_INLINE linear form_square(linear x)
{
    double l = form_linear(x), half = 0.5 * l * l;
    return form_made(x.c * x.c + half, 2 * x.c * x.a, 2 * x.c * x.b, half + x.e * (2 * form_size(x) + x.e),
                     form_size(x) * form_size(x));
}

/* The root of what is not negative.  With s the root of c, w = sqrt(x) - s has
 * sqrt(x) = s + (x - c) / 2s - w^2 / 2s, and |w| is greatest at the lower end.  If x may be 0 the root is
 * only between 0 and that of the upper end. */
SGT_INLINE linear form_root(linear x)
{
    sgt_interval range = form_range(x);
    if (!(range.lo > 0)) {
        double top = range.hi > 0 ? sqrt(range.hi) : range.hi == range.hi ? 0 : range.hi;
        return form_made(0.5 * top, 0, 0, 0.5 * top, top);
    }
    double s = sqrt(x.c), w = s - sqrt(range.lo) + FORM_ROUND * s, by = 0.5 / s, half = 0.5 * by * w * w;
    return form_made(s - half, x.a * by, x.b * by, x.e * by + half, s + half + form_linear(x) * by);
}

/* 1 / x = 1/c - (x - c) / c^2 + (x - c)^2 / (c^2 x).  Nothing is known if 0 may be in x. */
SGT_INLINE linear form_inverse(linear x)
{
    sgt_interval range = form_range(x);
    double least = range.lo > 0 ? range.lo : range.hi < 0 ? -range.hi : (double)NAN;
    double i = 1 / x.c, by = -i * i, d = form_linear(x) + x.e, half = 0.5 * d * d * i * i / least;
    double sign = i < 0 ? -1 : 1;
    return form_made(i + sign * half, x.a * by, x.b * by, x.e * i * i + half,
                     fabs(i) + half + form_linear(x) * i * i);
}

SGT_INLINE linear form_quotient(linear x, linear y) { return form_product(x, form_inverse(y)); }

typedef struct form3 { linear x, y, z; } form3;

SGT_INLINE linear form_dot(form3 a, form3 b)
{
    return form_sum(form_product(a.x, b.x), form_sum(form_product(a.y, b.y), form_product(a.z, b.z)));
}

/* a . x of three numbers known exactly. */
SGT_INLINE linear form_along(form3 a, sgt_vec3 x)
{
    return form_sum(form_scaled(a.x, x.x), form_sum(form_scaled(a.y, x.y), form_scaled(a.z, x.z)));
}

#endif

// SPDX-License-Identifier: MIT
/* check.c - does a surface keep its promises?  (sgt_check)
 *
 * Each ray is walked in SAMPLES steps: in front of its span, in it, and behind it.  Each promise below is
 * tried on the way.  SOUND says that no fault was found: what no two neighbouring samples show is not
 * seen.
 *
 * THE ROUNDING is finite and not negative wherever F is defined.
 *
 * THE SPAN holds every root, and only one if it says so.  Two neighbours of unlike sign, with F defined
 * between them, hold a root.  A sign is certain only if |F| is beyond what rounding can do:
 * - the surface's own bound (without one: 8 ulps of the terms x Fx, y Fy, z Fz);
 * - what the rounding of o + t d does to F, at most 2^-51 of |o| + |t d| in each coordinate.
 *
 * The pair is narrowed to where signs stop being certain.  If all of it lies outside the span, so does the
 * root.  Two such pairs in the span are two roots.  A pole changes sign, too, but |F| grows toward it: no
 * root.  If a built-in surface has a rim, roots beyond it are not accepted (surfaces.h), and its span need
 * not hold them.
 *
 * THE FIRST root's stretch, if it is single, is tried in the same way.  Of the roots that are seen and
 * certainly accepted, none may lie before it, at most one in it, and none behind it if none is in it.
 *
 * MANY AT ONCE give what one at a time gives.  `values` is called at POINTS_AT_ONCE points of the ray, and
 * at FEW of them, with gradients and without; `spans` for RAYS_AT_ONCE of the rays, and for what is left.
 * Bits are compared.  Nobody reads these, so they are not compared: the bits of a NaN, the gradient where
 * F is NaN, a span that the ray misses.  Behind the output stands a number that must not change.
 *
 * THE GRADIENT is compared with central differences
 *
 *     D(h) = (F(p + h e) - F(p - h e)) / 2h = F_e + h^2 F_eee / 6 + ... + noise / h
 *
 * (Press et al. 2007, section 5.7).  No single h is right: 1e-5 of the distance to the edge of a sphere is
 * right near it, and lost in noise far away.  So h runs down by eights, from the distance between samples
 * to 2^-42 of it, or of |p|.  For two neighbours D(8h), D(h) the difference is 63/64 of the truncation of
 * the first, and 64 times that of the second.  With the noise of both, it is the doubt of D(h).  The h
 * with the least doubt is taken.  If a smaller h differs by more than four times doubt and noise (a pole
 * between the larger steps, say), only the h from there on are looked at.  A comparison is made if
 * - the doubt is below 2^-16 of the gradient (else there is nothing to compare with);
 * - F is defined on both sides, and the two one-sided differences agree to 2^-6 (at a kink they do not,
 *   and a gradient there is one of several);
 * - the surface gives a number (NaN: not defined here).
 *
 * It shows a fault if the two differ by more than each of these:
 * - 8 times the doubt;
 * - 4 times what 16 ulps of the coordinates do to the surface's gradient (near an edge that is much: a
 *   gradient is as good as the rounding of its argument);
 * - 2^-26 of the gradient.
 *
 * And a second row of steps, shorter by 0.7, has to show the same.  Noise is not bounded on a surface
 * without `rounding`, and can once look like agreement.
 *
 * So a gradient that is off by 1e-3 in one component is seen, unless that component is below 2^-16 of the
 * gradient.  One that is off by less than 1e-8 is not seen.
 *
 * THE ENCLOSURE is asked over stretches of many widths, about points of each stretch and about the roots
 * that were seen, and at single points.
 * - F at samples, with their doubt as above, has to be in it.
 * - grad . d there has to be in the interval of the slope, but for 2^-26, and what 2^-44 of the place does
 *   to the gradient.
 * - If that interval is bounded, and F defined, each difference quotient has to be in it.  That is the
 *   mean value theorem, on which every proof rests: a slope that is bounded where F jumps is a fault.
 * - An empty interval is a fault if F is defined on both sides of a sample.
 *
 * MANY ENCLOSURES, of `encloses`, are tried in the same way.  What is said of CELLS_AT_ONCE cells, from all
 * of the ray down to points, and of FEW of them, is compared bit by bit with what is said of each alone.
 *
 * THE CLEARANCE is tried at points of the ray.  On lines through them, along the ray, the gradient and six
 * others, no certain change of sign may be nearer. */
#include "../num/bits.h"
#include "../surface/builtin.h"

#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>

#include <float.h>
#include <math.h>
#include <string.h>

enum {
    SAMPLES = 256,
    POINTS = 16,
    LEVELS = 18,
    POINTS_AT_ONCE = 67,
    CELLS_AT_ONCE = 37,
    FEW = 3,
    RAYS_AT_ONCE = 35,
    WIDTHS = 9,
    WITHIN = 5
};
static const double CUT = 1000; /* lengths of d, if neither ray nor span has an end */

typedef struct check_sample { double t, f, doubt; int sign; sgt_vec3 p, n; } check_sample;

typedef struct check {
    sgt_surface s;
    const sgt_ray *ray;
    sgt_span span;
    double rim2;       /* of a built-in surface; beyond it no root is accepted */
    int inside;        /* roots found in the span */
    sgt_span first;    /* the stretch of the first root, if it is single; */
    double from;       /* where the ray begins; */
    int in_first;      /* roots found in that stretch, */
    bool behind;       /* and whether one was found behind it: */
    sgt_vec3 beyond;
    sgt_fault fault;
    sgt_vec3 where;
} check;

static bool fail(check *c, sgt_fault fault, sgt_vec3 where)
{
    c->fault = fault, c->where = where;
    return false;
}

/* The greatest component, in magnitude, that is not NaN. */
static double check_greatest(sgt_vec3 v)
{
    return maximum_number(fabs(v.x), maximum_number(fabs(v.y), fabs(v.z)));
}

static double value_at(const check *c, sgt_vec3 p, sgt_vec3 *grad)
{
    return c->s.ops->value(c->s.self, p, grad);
}

static double check_terms_of(sgt_vec3 p, sgt_vec3 n)
{
    double sum = fabs(p.x * n.x) + fabs(p.y * n.y) + fabs(p.z * n.z);
    return sum < HUGE_VAL ? sum : 0; /* a gradient with a NaN bounds nothing */
}

/* F at t, and its sign if that is certain.  false: `rounding` broke its promise. */
static bool check_look(check *c, double t, check_sample *a)
{
    sgt_vec3 o = c->ray->o, d = c->ray->d, n = {0};
    *a = (check_sample){.t = t, .p = {o.x + t * d.x, o.y + t * d.y, o.z + t * d.z}};
    a->f = value_at(c, a->p, &n);
    a->n = n;
    if (isnan(a->f)) return true;
    sgt_vec3 moved = {fabs(o.x) + fabs(t * d.x), fabs(o.y) + fabs(t * d.y), fabs(o.z) + fabs(t * d.z)};
    double doubt = 0x1p-50 * check_terms_of(moved, n);
    if (c->s.ops->rounding) {
        double own = c->s.ops->rounding(c->s.self, a->p);
        if (isfinite(a->f) && !(own >= 0 && own < HUGE_VAL)) return fail(c, SGT_WRONG_ROUNDING, a->p);
        doubt += own;
    } else {
        doubt += 0x1p-50 * (check_terms_of(a->p, n) + fabs(a->f));
    }
    a->doubt = doubt;
    a->sign = a->f > doubt ? 1 : a->f < -doubt ? -1 : 0;
    return true;
}

/* --------------------------------------------------------------- gradient */

static double *component(sgt_vec3 *v, int i) { return i == 0 ? &v->x : i == 1 ? &v->y : &v->z; }

/* The noise of F near p: the surface's bound, but no less than an honest bound can be.  Without a bound,
 * terms may cancel unseen (the 1 - 1 in the vertex of 1 - sqrt(1 - r^2)).  They are taken to be as large
 * as F changes over `across`. */
static double noise_at(const check *c, sgt_vec3 p, double f, sgt_vec3 n, double across)
{
    double floor = 0x1p-51 * (fabs(f) + check_terms_of(p, n));
    if (!c->s.ops->rounding)
        return 4 * (floor + 0x1p-51 * check_terms_of((sgt_vec3){across, across, across}, n));
    double own = c->s.ops->rounding(c->s.self, p);
    return own > floor ? own : floor;
}

/* dF/dx_i by differences.  doubt: infinite if there is nothing to compare with.  kink: how far the one-sided
 * differences disagree.  bend: how the surface's own gradient varies along i. */
typedef struct compared { double slope, doubt, kink; sgt_vec3 bend; } compared;

/* With steps from `longest` down. */
static compared difference(const check *c, sgt_vec3 p, double f, sgt_vec3 n, int i, double longest)
{
    compared best = {.doubt = HUGE_VAL, .kink = HUGE_VAL};
    double before = (double)NAN, x = *component(&p, i), h = longest;
    double big = check_greatest(p), noise = noise_at(c, p, f, n, longest), noise_before = (double)NAN;
    for (int level = 0; level < LEVELS && h > 0x1p-42 * maximum_number(big, longest); level++, h *= 0.125) {
        sgt_vec3 right = p, left = p, nr = {0}, nl = {0};
        *component(&right, i) = x + h, *component(&left, i) = x - h;
        double ahead = *component(&right, i) - x, behind = x - *component(&left, i); /* exact */
        double width = ahead + behind, fr = value_at(c, right, &nr), fl = value_at(c, left, &nl);
        double beside
            = maximum_number(noise_at(c, right, fr, nr, longest), noise_at(c, left, fl, nl, longest));
        double slope = (fr - fl) / width, own = maximum_number(noise, beside) * 2 / width;
        double now = fabs(slope - before) + own + noise_before;
        /* a finer structure than the steps before showed */
        if (fabs(slope - best.slope) > 4 * (best.doubt + own)) best.doubt = HUGE_VAL;
        if (now < best.doubt) { /* false for NaN */
            best.slope = slope, best.doubt = now;
            best.kink = fabs((fr - f) / ahead - (f - fl) / behind);
            best.bend = (sgt_vec3){(nr.x - nl.x) / width, (nr.y - nl.y) / width, (nr.z - nl.z) / width};
        }
        before = slope, noise_before = own;
    }
    return best;
}

/* Do steps from `longest` down show the gradient at p to be wrong? */
static bool is_wrong(const check *c, sgt_vec3 p, double f, sgt_vec3 n, double longest)
{
    compared d[3];
    double size = 0;
    for (int i = 0; i < 3; i++) {
        d[i] = difference(c, p, f, n, i, longest);
        double own = fabs(*component(&n, i));
        if (d[i].doubt < HUGE_VAL) size = maximum_number(size, fabs(d[i].slope));
        if (own < HUGE_VAL) size = maximum_number(size, own);
    }
    for (int i = 0; i < 3; i++) {
        double own = *component(&n, i), slack = 0;
        if (isnan(own) || !(d[i].doubt <= 0x1p-16 * size) || !(d[i].kink <= 0x1p-6 * size)) continue;
        if (isinf(own)) return true;
        for (int j = 0; j < 3; j++) slack += 0x1p-49 * fabs(*component(&p, j) * *component(&d[j].bend, i));
        if (isnan(slack)) continue;
        if (!(fabs(own - d[i].slope) <= 8 * d[i].doubt + 4 * slack + 0x1p-26 * size)) return true;
    }
    return false;
}

static bool check_gradient(check *c, double t, double spacing)
{
    check_sample a;
    sgt_vec3 d = c->ray->d, n = {(double)NAN, (double)NAN, (double)NAN};
    if (!check_look(c, t, &a)) return false;
    double f = value_at(c, a.p, &n), big = check_greatest(a.p);
    if (!isfinite(f)) return true;
    double longest = maximum_number(spacing * check_greatest(d), 0x1p-10 * big);
    if (!is_wrong(c, a.p, f, n, longest) || !is_wrong(c, a.p, f, n, 0.7 * longest)) return true;
    return fail(c, SGT_WRONG_GRADIENT, a.p);
}

/* --------------------------------------------------------------- enclosure */

/* Is F defined here, and around as far as the rounding of o + t d can reach, and farther? */
static bool well_defined(check *c, double t)
{
    sgt_vec3 o = c->ray->o, d = c->ray->d;
    double far = check_greatest(o), along = check_greatest(d);
    double off = 0x1p-44 * (far / along + fabs(t));
    for (int i = -1; i <= 1; i++)
        if (isnan(value_at(
                c,
                (sgt_vec3){o.x + (t + i * off) * d.x, o.y + (t + i * off) * d.y, o.z + (t + i * off) * d.z},
                NULL)))
            return false;
    return true;
}

/* By how much a sample can be off: its own doubt, and the noise if the surface has no `rounding`. */
static double doubt_of(const check *c, const check_sample *a, double across)
{
    double size = check_greatest(c->ray->d);
    return 2 * a->doubt + (c->s.ops->rounding ? 0 : noise_at(c, a->p, a->f, a->n, across * size));
}

/* Is grad . d outside of the interval of the slope?  It may be by 2^-26, which `value` is free to be wrong
 * by, and by what 2^-44 of the place, either way, does to it. */
static bool steeper(const check *c, const check_sample *a, sgt_interval slope)
{
    sgt_vec3 d = c->ray->d, o = c->ray->o, left = {0}, right = {0};
    double now = a->n.x * d.x + a->n.y * d.y + a->n.z * d.z, doubt = 0x1p-26 * check_terms_of(a->n, d),
           bend = 0;
    if (!(now + doubt < slope.lo || now - doubt > slope.hi || slope.lo > slope.hi)) return false;
    double far = check_greatest(o), along = check_greatest(d), off = 0x1p-44 * (far + fabs(a->t) * along);
    for (int i = 0; i < 3; i++) {
        sgt_vec3 p = a->p, q = a->p;
        *component(&p, i) -= off, *component(&q, i) += off;
        value_at(c, p, &left), value_at(c, q, &right);
        bend += fabs((right.x - left.x) * d.x + (right.y - left.y) * d.y + (right.z - left.z) * d.z);
    }
    doubt += 2 * bend;
    return now + doubt < slope.lo || now - doubt > slope.hi || slope.lo > slope.hi;
}

static const double KEPT = 0x1.23456789abcdep+100; /* stands behind the last output that is asked for */

/* `encloses` of n cells of the ray.  No slopes are asked for if slope_lo is NULL. */
static void check_ask_many(const check *c, size_t n, const double t_lo[], const double t_hi[],
                           sgt_enclosures out)
{
    double o[3][CELLS_AT_ONCE], d[3][CELLS_AT_ONCE];
    const sgt_ray *r = c->ray;
    for (size_t i = 0; i < n; i++)
        o[0][i] = r->o.x, o[1][i] = r->o.y, o[2][i] = r->o.z, d[0][i] = r->d.x, d[1][i] = r->d.y,
        d[2][i] = r->d.z;
    sgt_rays rays = {.o = {o[0], o[1], o[2]}, .d = {d[0], d[1], d[2]}};
    encloses_of(c->s.ops)(c->s.self, n, rays, t_lo, t_hi, out);
}

/* One cell, by `enclose` or by `encloses`.  NaN if `encloses` writes beyond it. */
static sgt_interval check_ask(const check *c, bool many, double lo, double hi, sgt_interval *slope)
{
    const double none = (double)NAN;
    double out[4][2] = {{none, KEPT}, {none, KEPT}, {none, KEPT}, {none, KEPT}};
    if (!many) return c->s.ops->enclose(c->s.self, c->ray, (sgt_interval){lo, hi}, slope);
    check_ask_many(c, 1, &lo, &hi, (sgt_enclosures){out[0], out[1], out[2], out[3]});
    for (int k = 0; k < 4; k++)
        if (!(out[k][1] == KEPT)) return *slope = (sgt_interval){none, none};
    *slope = (sgt_interval){out[2][0], out[3][0]};
    return (sgt_interval){out[0][0], out[1][0]};
}

/* Compares samples in [lo, hi] with the enclosure over it. */
static bool check_enclosure(check *c, bool many, double lo, double hi, double across)
{
    static const double where[WITHIN] = {0, 0.109, 0.382, 0.691, 1};
    const sgt_fault fault = many ? SGT_WRONG_ENCLOSURES : SGT_WRONG_ENCLOSURE;
    sgt_interval slope, g = check_ask(c, many, lo, hi, &slope);
    bool bounded = slope.lo > -HUGE_VAL && slope.hi < HUGE_VAL, defined = true;
    check_sample before = {.f = (double)NAN}, a;
    double doubt_before = 0;
    for (int i = 0; i < WITHIN; i++) {
        double t = i == WITHIN - 1 ? hi : lo + (hi - lo) * where[i], doubt;
        if (i && !(t > before.t)) continue;
        if (!check_look(c, t, &a)) return false;
        bool regular = isfinite(a.f) && isfinite(a.n.x) && isfinite(a.n.y) && isfinite(a.n.z);
        defined = defined && !isnan(a.f);
        doubt = doubt_of(c, &a, across);
        if (g.lo > g.hi && isfinite(a.f) && well_defined(c, t)) return fail(c, fault, a.p);
        if (regular && g.lo <= g.hi && (a.f + doubt < g.lo || a.f - doubt > g.hi)) return fail(c, fault, a.p);
        /* the slope says something */
        if (regular && !(g.lo > g.hi) && (slope.lo > -HUGE_VAL || slope.hi < HUGE_VAL)) {
            if (steeper(c, &a, slope)) return fail(c, fault, a.p);
            double width = t - before.t, quotient = (a.f - before.f) / width,
                   off = (doubt + doubt_before) / width * (1 + 0x1p-20);
            if (bounded && i && defined && (quotient + off < slope.lo || quotient - off > slope.hi))
                return fail(c, fault, a.p);
        }
        before = a, doubt_before = doubt;
        if (!regular) defined = false;
    }
    return true;
}

/* Stretches about t, from `longest` down to t alone. */
static bool check_enclosures(check *c, double t, double longest, double across)
{
    if (!c->s.ops->enclose) return true;
    for (int level = 0; level < WIDTHS; level++, longest *= 0x1p-6) {
        double lo = t - 0.382 * longest, hi = t + 0.618 * longest;
        if (level == WIDTHS - 1) lo = hi = t;
        if (!(fabs(lo) <= DBL_MAX && fabs(hi) <= DBL_MAX)) continue;
        if (!check_enclosure(c, false, lo, hi, across)) return false;
        if (encloses_of(c->s.ops) && !check_enclosure(c, true, lo, hi, across)) return false;
    }
    return true;
}

/* --------------------------------------------------------------- clearance */

static bool check_approach(check *c, check_sample *a, double b);

/* Is there no change of sign before `clear`, but at a pole, on a line through p?  u: of unit length; t
 * counts lengths. */
static bool check_line(check *c, sgt_vec3 p, sgt_vec3 u, double clear)
{
    static const double at[] = {0.1,  0.25,  0.5,    0.75,        0.9,        0.97,
                                0.99, 0.999, 0.9999, 1 - 0x1p-20, 1 - 0x1p-30};
    enum { HALF = sizeof at / sizeof at[0] };
    const sgt_ray *own = c->ray, line = {.o = p, .d = u};
    check_sample last = {.sign = 0}, a;
    c->ray = &line;
    for (int i = -HALF; i <= HALF && c->fault == SGT_SOUND; i++) {
        if (!check_look(c, i < 0 ? -clear * at[-i - 1] : i > 0 ? clear * at[i - 1] : 0, &a)) break;
        if (isnan(a.f)) last.sign = 0;
        if (a.sign * last.sign < 0) {
            check_sample left = last, right = a;
            double high = maximum_number(fabs(left.f), fabs(right.f));
            if (check_approach(c, &left, right.t) && check_approach(c, &right, left.t)
                && minimum_number(fabs(left.f), fabs(right.f)) <= high) fail(c, SGT_WRONG_CLEARANCE, left.p);
        }
        if (a.sign) last = a;
    }
    c->ray = own;
    return c->fault == SGT_SOUND;
}

/* Tries the clearance at t: along the ray, the gradient, and six other directions. */
static bool check_clearance(check *c, double t, double extent)
{
    static const sgt_vec3 others[] = {{1, 0, 0},     {0, 1, 0},     {0, 0, 1},
                                      {0.6, 0, 0.8}, {0.8, 0.6, 0}, {0, -0.6, 0.8}};
    check_sample a;
    if (!c->s.ops->clearance) return true;
    if (!check_look(c, t, &a)) return false;
    sgt_vec3 d = c->ray->d;
    double clear = c->s.ops->clearance(c->s.self, a.p), length = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    double most = 4 * (extent * length + fabs(a.p.x) + fabs(a.p.y) + fabs(a.p.z)),
           steep = sqrt(a.n.x * a.n.x + a.n.y * a.n.y + a.n.z * a.n.z);
    if (!(clear > 0)) return true;
    if (clear > most) clear = most;
    if (length > 0 && length < HUGE_VAL &&
        !check_line(c, a.p, (sgt_vec3){d.x / length, d.y / length, d.z / length}, clear))
        return false;
    if (steep > 0 && steep < HUGE_VAL &&
        !check_line(c, a.p, (sgt_vec3){a.n.x / steep, a.n.y / steep, a.n.z / steep}, clear))
        return false;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (!check_line(c, a.p, others[i], clear)) return false;
    return true;
}

/* ------------------------------------------------------------------- span */

/* Moves *a, of certain sign, as near to b as its sign stays certain; b has another sign.  false: F is not
 * defined between them, or a promise was broken on the way. */
static bool check_approach(check *c, check_sample *a, double b)
{
    for (int i = 0; i < 100; i++) {
        check_sample m;
        double t = 0.5 * a->t + 0.5 * b;
        if (!(t > minimum_number(a->t, b) && t < maximum_number(a->t, b))) return true; /* neighbours */
        if (!check_look(c, t, &m) || isnan(m.f)) return false;
        if (m.sign == a->sign) *a = m;
        else b = t;
    }
    return true;
}

/* Counts a root between a and b for the stretch of the first root.  Not if it is so near the start that it
 * may not be accepted. */
static bool check_first(check *c, const check_sample *a, const check_sample *b)
{
    sgt_vec3 o = c->ray->o;
    double apart = a->t - c->from,
           near = 0x1p-40 * (fabs(a->t) + fabs(b->t) + fabs(o.x) + fabs(o.y) + fabs(o.z));
    near += 0x1p-44 * check_terms_of(a->p, a->n) /
            fabs(a->n.x * c->ray->d.x + a->n.y * c->ray->d.y + a->n.z * c->ray->d.z);
    if (!c->first.single || !(apart > near && apart > 16 * (b->t - a->t))) return true;
    if (b->t < c->first.lo) return fail(c, SGT_WRONG_FIRST, b->p);
    if (a->t > c->first.hi) c->behind = true, c->beyond = a->p;
    if (a->t >= c->first.lo && b->t <= c->first.hi && ++c->in_first > 1)
        return fail(c, SGT_WRONG_FIRST, b->p);
    if (!(a->t > c->first.hi || b->t < c->first.lo)) c->in_first += c->in_first == 0; /* on its end */
    return true;
}

/* Tries the promises at a change of sign between a and b. */
static bool check_root(check *c, check_sample a, check_sample b)
{
    double high = maximum_number(fabs(a.f), fabs(b.f)), spacing = b.t - a.t;
    if (!check_approach(c, &a, b.t) || !check_approach(c, &b, a.t)) return c->fault == SGT_SOUND;
    if (minimum_number(fabs(a.f), fabs(b.f)) > high) return true; /* a pole */
    if (a.p.x * a.p.x + a.p.y * a.p.y > c->rim2 || b.p.x * b.p.x + b.p.y * b.p.y > c->rim2) return true;
    if (!check_gradient(c, a.t, spacing) || !check_gradient(c, b.t, spacing)) return false;
    if (!check_enclosures(c, a.t, spacing, spacing) || !check_clearance(c, a.t, spacing)) return false;
    if (b.t < c->span.lo || a.t > c->span.hi) return fail(c, SGT_WRONG_SPAN, b.t < c->span.lo ? b.p : a.p);
    if (a.t >= c->span.lo && b.t <= c->span.hi && ++c->inside > 1 && c->span.single)
        return fail(c, SGT_WRONG_SPAN, b.p);
    return check_first(c, &a, &b);
}

/* Tries one stretch of the ray, wholly in front of the span, in it, or behind it. */
static bool check_stretch(check *c, double lo, double hi)
{
    check_sample last = {.sign = 0}, a;
    if (!(lo < hi)) return true;
    for (int i = 0; i <= SAMPLES; i++) {
        double t = i == 0 ? lo : i == SAMPLES ? hi : lo + (hi - lo) * (i / (double)SAMPLES);
        if (!check_look(c, t, &a)) return false;
        if (isnan(a.f)) last.sign = 0;
        if (a.sign * last.sign < 0 && !check_root(c, last, a)) return false;
        if (a.sign) last = a;
    }
    /* beside round fractions, where symmetry may hide a fault */
    for (int i = 0; i < POINTS; i++) {
        double t = lo + (hi - lo) * ((i + 0.382) / POINTS), spacing = (hi - lo) / (4 * POINTS);
        if (!check_gradient(c, t, spacing)) return false;
        if (i % 4 == 1 && (!check_enclosures(c, t, hi - lo, spacing) || !check_clearance(c, t, hi - lo)))
            return false;
    }
    return true;
}

/* ------------------------------------------------------------ many at once */

static bool same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

static bool check_values(check *c, double lo, double hi)
{
    double p[3][POINTS_AT_ONCE], f[POINTS_AT_ONCE + 1], grad[3][POINTS_AT_ONCE + 1];
    sgt_vec3 o = c->ray->o, d = c->ray->d;
    for (int i = 0; i < POINTS_AT_ONCE; i++) {
        double t = lo + (hi - lo) * ((i + 0.382) / POINTS_AT_ONCE);
        p[0][i] = o.x + t * d.x, p[1][i] = o.y + t * d.y, p[2][i] = o.z + t * d.z;
    }
    for (int way = 0; way < 4; way++) {
        size_t n = way & 1 ? FEW : POINTS_AT_ONCE, from = way & 1 ? POINTS_AT_ONCE - FEW : 0;
        bool slopes = way < 2;
        f[n] = grad[0][n] = grad[1][n] = grad[2][n] = KEPT;
        for (size_t i = 0; i < n; i++) f[i] = grad[0][i] = grad[1][i] = grad[2][i] = KEPT;
        c->s.ops->values(
            c->s.self, n, (sgt_points){{p[0] + from, p[1] + from, p[2] + from}},
            (sgt_values){f, {slopes ? grad[0] : NULL, slopes ? grad[1] : NULL, slopes ? grad[2] : NULL}});
        for (size_t i = 0; i < n; i++) {
            sgt_vec3 at = {p[0][from + i], p[1][from + i], p[2][from + i]}, g = {0};
            double one = value_at(c, at, &g);
            bool good = same(one, f[i]) &&
                        (!slopes || isnan(one) ||
                         (same(g.x, grad[0][i]) && same(g.y, grad[1][i]) && same(g.z, grad[2][i])));
            if (!good) return fail(c, SGT_WRONG_VALUES, at);
        }
        if (!(f[n] == KEPT && grad[0][n] == KEPT && grad[1][n] == KEPT && grad[2][n] == KEPT))
            return fail(c, SGT_WRONG_VALUES, o);
    }
    return true;
}

/* Cells of every width, from `length` down, and points. */
static bool check_cells(check *c, double lo, double hi)
{
    double a[CELLS_AT_ONCE], b[CELLS_AT_ONCE], out[4][CELLS_AT_ONCE + 1];
    sgt_vec3 o = c->ray->o;
    for (int i = 0; i < CELLS_AT_ONCE; i++) {
        double length = hi - lo, at = lo + length * ((i * 7 % CELLS_AT_ONCE + 0.382) / CELLS_AT_ONCE);
        for (int k = i % 12; k > 0; k--) length *= 0x1p-4;
        a[i] = maximum_number(lo, at - 0.4 * length), b[i] = minimum_number(hi, at + 0.6 * length);
        if (i % 12 == 11) b[i] = a[i];
    }
    for (int way = 0; way < 4; way++) {
        size_t n = way & 1 ? FEW : CELLS_AT_ONCE, from = way & 1 ? CELLS_AT_ONCE - FEW : 0;
        bool slopes = way < 2;
        for (int k = 0; k < 4; k++)
            for (size_t i = 0; i <= n; i++) out[k][i] = KEPT;
        check_ask_many(c, n, a + from, b + from,
                       (sgt_enclosures){out[0], out[1], slopes ? out[2] : NULL, slopes ? out[3] : NULL});
        for (size_t i = 0; i < n; i++) {
            sgt_interval slope, g = check_ask(c, true, a[from + i], b[from + i], &slope);
            bool good = same(g.lo, out[0][i]) && same(g.hi, out[1][i]) &&
                        (!slopes || (same(slope.lo, out[2][i]) && same(slope.hi, out[3][i])));
            if (!good) return fail(c, SGT_WRONG_ENCLOSURES, o);
        }
        for (int k = 0; k < 4; k++)
            if (!(out[k][n] == KEPT)) return fail(c, SGT_WRONG_ENCLOSURES, o);
    }
    return true;
}

/* Compares n rays at once with single rays: `firsts` if tmin is not NULL, else `spans`. */
static bool check_spans(check *c, size_t n, double o[3][RAYS_AT_ONCE], double d[3][RAYS_AT_ONCE],
                        const double *tmin, const double *tmax)
{
    double lo[RAYS_AT_ONCE + 1], hi[RAYS_AT_ONCE + 1], seed[RAYS_AT_ONCE + 1];
    bool single[RAYS_AT_ONCE + 1];
    if (!n) return true;
    if (tmin ? !c->s.ops->first : !c->s.ops->span)
        return fail(c, tmin ? SGT_WRONG_FIRSTS : SGT_WRONG_SPANS, (sgt_vec3){o[0][0], o[1][0], o[2][0]});
    lo[n] = hi[n] = seed[n] = KEPT, single[n] = true;
    sgt_rays many = {.o = {o[0], o[1], o[2]}, .d = {d[0], d[1], d[2]}, .tmin = tmin, .tmax = tmax};
    sgt_fault fault = tmin ? SGT_WRONG_FIRSTS : SGT_WRONG_SPANS;
    (tmin ? c->s.ops->firsts : c->s.ops->spans)(c->s.self, n, many, (sgt_spans){lo, hi, seed, single});
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = {o[0][i], o[1][i], o[2][i]}, .d = {d[0][i], d[1][i], d[2][i]},
                       .tmin = tmin ? tmin[i] : 0, .tmax = tmax ? tmax[i] : 0};
        sgt_span one = (tmin ? c->s.ops->first : c->s.ops->span)(c->s.self, &ray);
        if (tmin && !one.single && !single[i]) continue;
        if (one.lo > one.hi && lo[i] > hi[i] && one.single == single[i]) continue;
        if (!(same(one.lo, lo[i]) && same(one.hi, hi[i]) && same(one.seed, seed[i]) &&
              one.single == single[i]))
            return fail(c, fault, ray.o);
    }
    return lo[n] == KEPT && hi[n] == KEPT && seed[n] == KEPT && single[n]
               ? true
               : fail(c, fault, (sgt_vec3){o[0][0], o[1][0], o[2][0]});
}

static bool check_ray(check *c)
{
    const sgt_ray *r = c->ray;
    sgt_span s = {.lo = -HUGE_VAL, .hi = HUGE_VAL};
    if (c->s.ops->span) s = c->s.ops->span(c->s.self, r);
    if (isnan(s.lo) || isnan(s.hi)) return fail(c, SGT_WRONG_SPAN, r->o);
    double lo = r->tmin, hi = explicit_end(r);
    bool by = s.lo > s.hi; /* the ray misses: all of it is outside */
    if (!(lo > -HUGE_VAL)) lo = !by && isfinite(s.lo) && s.lo < hi ? s.lo : minimum_number(0, hi) - CUT;
    if (!(hi < HUGE_VAL)) hi = !by && isfinite(s.hi) && s.hi > lo ? s.hi : maximum_number(0, lo) + CUT;
    c->span = by ? (sgt_span){.lo = HUGE_VAL, .hi = HUGE_VAL} : s;
    c->inside = c->in_first = 0, c->behind = false;
    c->first = (sgt_span){.single = false}, c->from = lo;
    if (c->s.ops->first) {
        sgt_ray own = *r;
        own.tmax = explicit_end(r);
        c->first = c->s.ops->first(c->s.self, &own), c->from = own.tmin;
    }
    if (c->s.ops->values && !check_values(c, lo, hi)) return false;
    if (encloses_of(c->s.ops) && !check_cells(c, lo, hi)) return false;
    if (by) return check_stretch(c, lo, hi);
    double in = maximum_number(lo, s.lo), out = minimum_number(hi, s.hi);
    if (!(check_stretch(c, lo, minimum_number(s.lo, hi)) && check_stretch(c, in, out)
          && check_stretch(c, maximum_number(s.hi, lo), hi))) return false;
    if (!c->behind || c->in_first) return true;
    /* Two roots between samples are not seen.  Do the ends of the first root's stretch show one? */
    check_sample a, b;
    if (!check_look(c, maximum_number(c->first.lo, c->from), &a) || !check_look(c, c->first.hi, &b))
        return false;
    return a.sign * b.sign > 0 ? fail(c, SGT_WRONG_FIRST, c->beyond) : true;
}

/* The square of the rim of a built-in surface; infinite without one. */
static double rim2_of_builtin(sgt_surface s)
{
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        if (row->ops != s.ops) continue;
        for (const sgt_param *p = row->params; p->name; p++) {
            const char *a = p->name, *b = "semi_diameter";
            while (*a && *a == *b) a++, b++;
            if (*a || *b) continue;
            double rim = *(const double *)(const void *)((const char *)s.self + p->offset);
            if (rim > 0) return rim * rim;
        }
    }
    return HUGE_VAL;
}

static bool is_usable(const sgt_ray *r)
{
    double big = check_greatest(r->d);
    return isfinite(r->o.x) && isfinite(r->o.y) && isfinite(r->o.z) && isfinite(r->d.x) && isfinite(r->d.y) &&
           isfinite(r->d.z) && big >= DBL_MIN && r->tmin < HUGE_VAL &&
           explicit_end(r) >= r->tmin;
}

/* Tries RAYS_AT_ONCE rays at a time, the last few with the rest of the arrays empty. */
static void check_all_spans(check *c, size_t n, const sgt_ray rays[], bool firsts)
{
    double o[3][RAYS_AT_ONCE], d[3][RAYS_AT_ONCE], tmin[RAYS_AT_ONCE], tmax[RAYS_AT_ONCE];
    size_t k = 0;
    for (size_t i = 0; i < n; i++) {
        if (!is_usable(&rays[i])) continue;
        o[0][k] = rays[i].o.x, o[1][k] = rays[i].o.y, o[2][k] = rays[i].o.z;
        d[0][k] = rays[i].d.x, d[1][k] = rays[i].d.y, d[2][k] = rays[i].d.z;
        tmin[k] = rays[i].tmin, tmax[k] = explicit_end(&rays[i]);
        if (++k < RAYS_AT_ONCE) continue;
        if (!check_spans(c, k, o, d, firsts ? tmin : NULL, firsts ? tmax : NULL)) return;
        k = 0;
    }
    check_spans(c, k, o, d, firsts ? tmin : NULL, firsts ? tmax : NULL);
}

sgt_fault sgt_check(sgt_surface s, size_t n, const sgt_ray rays[], sgt_vec3 *where)
{
    double rim2
        = s.ops ? rim2_of_builtin(s) : HUGE_VAL; /* the table has the public operations */
    s = in_set(s);
    check c = {.s = s, .fault = SGT_SOUND, .where = {(double)NAN, (double)NAN, (double)NAN}};
    if (sgt_arithmetic()) {
        c.fault = SGT_WRONG_ARITHMETIC;
    } else if (!s.ops || !s.ops->value || !is_whole(s.ops) ||
        (is_catalogue(s.ops) && s.ops->own_->object(s.self).reason)) {
        c.fault = SGT_NO_VALUE;
    } else {
        c.rim2 = rim2;
        for (size_t i = 0; i < n; i++) {
            if (!is_usable(&rays[i])) continue; /* an invalid ray says nothing of the surface */
            c.ray = &rays[i];
            if (!check_ray(&c)) break;
        }
        if (s.ops->spans && c.fault == SGT_SOUND) check_all_spans(&c, n, rays, false);
        if (s.ops->firsts && c.fault == SGT_SOUND) check_all_spans(&c, n, rays, true);
        if (offers_encloses(s.ops) && !s.ops->enclose && c.fault == SGT_SOUND)
            fail(&c, SGT_WRONG_ENCLOSURES, rays[0].o);
    }
    if (where) *where = c.where;
    return c.fault;
}

const char *sgt_fault_text(sgt_fault fault)
{
    switch (fault) {
    case SGT_SOUND: return "sound: no fault was found";
    case SGT_WRONG_GRADIENT:
        return "wrong gradient: it differs from differences of F (it must not be normalised)";
    case SGT_WRONG_SPAN:
        return "wrong span: a root lies outside it, or two inside one that is said to be single";
    case SGT_WRONG_ROUNDING: return "wrong rounding: not finite or negative where F is defined";
    case SGT_WRONG_VALUES:
        return "wrong values: they differ from value in a bit, or write where they are not asked to";
    case SGT_WRONG_SPANS: return "wrong spans: they differ from span in a bit, or there is no span";
    case SGT_WRONG_CLEARANCE: return "wrong clearance: the surface is nearer than it says";
    case SGT_WRONG_ENCLOSURE:
        return "wrong enclosure: F or its slope leaves the interval, or F is defined where it says it is "
               "nowhere";
    case SGT_WRONG_FIRST:
        return "wrong first: a root that counts lies before it, or two in it, or none in it and one behind";
    case SGT_WRONG_FIRSTS: return "wrong firsts: they differ from first in a bit, or there is no first";
    case SGT_WRONG_ENCLOSURES:
        return "wrong encloses: F or its slope leaves an interval, or a cell's depends on its neighbours, or "
               "there is no enclose";
    case SGT_WRONG_ARITHMETIC:
        return "wrong arithmetic: this thread flushes small numbers to zero, or does not round to nearest";
    case SGT_NO_VALUE:
        return "no value: the surface has no function F, a table of a wrong size, or a parameter that is not "
               "valid";
    }
    return "?";
}

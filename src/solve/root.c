// SPDX-License-Identifier: MIT
/* root.c - one equation in one unknown, g(t) = 0, by Newton's method with safeguards.
 *
 * The solver never calls its caller.  sgt_root_next is told g and g' at r.t, and answers with the next t.
 * It goes through these stages:
 *
 *     search    No change of sign is known.  Newton from the seed, as long as each step is at most 0.6 of the
 *               one before: that is convergence (a double root has 1/2), and nothing else is worth following.
 *               A step out of the span goes to its end.  Then the ends.  Then SAMPLES points in van der
 *               Corput's order: 1/2, 1/4, 3/4 ... of the span, or of the floating-point numbers in it if an
 *               end is infinite
 *     bracket   g(lo) and g(hi) have certain, opposite signs.  A Newton step is taken if it lands inside and
 *               is at most half the step before the last; else the middle is taken.  So steps shrink by two
 *               in two, or give way (Brent 1973, chapter 4; Press et al. 2007, section 9.4).  From the 17th
 *               on, every other middle is taken among the floating-point numbers, not the reals.  So a root
 *               near zero in a bracket of 1e300 costs 150 steps and not 2000
 *     probe     |g| <= g_err at a candidate.  Is there a change of sign across it?  Both sides are evaluated,
 *               at a distance that the slope says is safe, four times as wide each time until the sign is
 *               certain.  Opposite signs: HIT, with the probes as the proof.  Equal signs: GRAZE
 *
 * A SMALL STEP IS NOT CONVERGENCE.  So a step below the tolerance is made longer by the tolerance on
 * purpose.  It overshoots a true root, and gives the change of sign on both sides of it.  And it exposes a
 * slope that is too steep, which only makes steps small.
 *
 * NaN MEANS UNDEFINED THERE.  The way back is halved toward a point known to be defined: the last iterate,
 * or an end of the bracket.  Before such a point is known, it goes to the ends of the span, and its
 * samples.  (Halving toward the ray's origin is often done.  It can return to the same t, and |t -
 * t_before| = 0 then passes for convergence.)  A bracket that closes in on a NaN inside is UNDEFINED, not
 * a root.
 *
 * THE BUDGET bounds everything: each stage either narrows, or is counted.
 *
 * THE QUICK FORM (root_quickly of root.h; step.h has its steps and says what they claim) has three stages of
 * its own before these: Newton's steps, and a look on either side of the root.  It needs no look if a lower
 * bound on |g'| is known.  It ends without an answer instead of searching on.  Then the caller begins anew,
 * mostly on a longer stretch.  It has the state of this solver, and is inline for speed: most ordinary rays
 * end in it. */
#include "root.h"

#include "../num/bits.h"
#include "ways.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* Of fixed size, so that a program and a library of different versions agree on it. */
_Static_assert(sizeof(struct sgt_root_private) == 256, "sgt_root.private_ has another size");
#define P(name) (r->private_.name)

enum { SAMPLES = 32, RETREATS_MAX = 128 };

static double ulp(double t)
{
    double a = fabs(t) * DBL_EPSILON;
    return a > DBL_TRUE_MIN ? a : DBL_TRUE_MIN;
}

/* The place of x in the order of the floating-point numbers, as an integer: -inf ... +inf. */
static int64_t order_of(double x)
{
    int64_t i;
    memcpy(&i, &x, sizeof i);
    return i < 0 ? INT64_MIN - i : i;
}

static double number_at(int64_t i)
{
    double x;
    if (i < 0) i = INT64_MIN - i;
    memcpy(&x, &i, sizeof x);
    return x;
}

/* Nearly the number that is a fraction of the way from lo to hi in that order.  Infinite ends are clipped. */
static double among_numbers(double lo, double hi, double fraction)
{
    int64_t a = order_of(lo < -DBL_MAX ? -DBL_MAX : lo), b = order_of(hi > DBL_MAX ? DBL_MAX : hi);
    return number_at((int64_t)((double)a * (1 - fraction) + (double)b * fraction));
}

static double root_middle(double lo, double hi) { return 0.5 * lo + 0.5 * hi; }

static bool finish(sgt_root *r, sgt_status status)
{
    r->status = status;
    P(done) = true;
    return false;
}

/* Ends at t, with the change of sign between lo and hi. */
static bool finish_between(sgt_root *r, double t)
{
    if (P(hole) > r->lo && P(hole) < r->hi) return finish(r, SGT_UNDEFINED);
    r->t = t;
    r->t_err = maximum_number(t - r->lo, r->hi - t);
    return finish(r, SGT_HIT);
}

static bool go(sgt_root *r, double t, sgt_move move)
{
    if (r->evals >= P(budget)) {
        if (!isnan(P(last))) r->t = P(last);
        r->t_err = P(bracketed) ? maximum_number(r->t - r->lo, r->hi - r->t) : HUGE_VAL;
        return finish(r, SGT_EXHAUSTED);
    }
    t = t < r->lo ? r->lo : t > r->hi ? r->hi : t;
    r->t = t < -DBL_MAX ? -DBL_MAX : t > DBL_MAX ? DBL_MAX : t; /* never at infinity */
    r->move = move;
    return true;
}

/* The i-th of van der Corput's fractions, i = 1, 2, ...: 1/2, 1/4, 3/4, 1/8 ... */
static double fraction_of(int i)
{
    double f = 0, b = 0.5;
    for (; i; i >>= 1, b *= 0.5)
        if (i & 1) f += b;
    return f;
}

static double root_sample(const sgt_root *r, int i)
{
    double f = fraction_of(i);
    return isfinite(r->lo) && isfinite(r->hi) ? r->lo * (1 - f) + r->hi * f : among_numbers(r->lo, r->hi, f);
}

sgt_root sgt_root_begin(sgt_span span, const sgt_options *opt)
{
    sgt_options o = opt ? *opt : (sgt_options){0};
    WENT(WAY_ROOT);
    sgt_root root = {.lo = span.lo,
                     .hi = span.hi,
                     .t_err = HUGE_VAL,
                     .move = SGT_SEED,
                     .status = SGT_UNPROVEN},
             *r = &root;
    P(g_lo) = P(g_hi) = P(last) = P(g_last) = P(hole) = P(candidate) = NAN;
    P(step) = P(step_before) = HUGE_VAL;
    P(single) = span.single;
    P(t_tol) = o.t_tol;
    P(f_tol) = o.f_tol;
    P(budget) = o.max_evals ? o.max_evals : SGT_DEFAULT_EVALS;
    root.t = span.seed;
    if (!(span.lo <= span.hi) || !sgt_options_valid(opt) || span.lo == HUGE_VAL || span.hi == -HUGE_VAL) {
        root.t = NAN;
        finish(r, SGT_INVALID);
        return root;
    }
    if (!isfinite(root.t)) root.t = root_sample(r, 1);
    if (!isfinite(span.lo) && !isfinite(span.hi) && !isfinite(span.seed)) root.t = 0;
    root.t = root.t < span.lo ? span.lo : root.t > span.hi ? span.hi : root.t;
    return root;
}

/* Narrows the bracket, or makes one, by g at t, which is defined; an uncertain sign does nothing. */
static void note(sgt_root *r, double t, double g)
{
    int s = root_sign_of(r, g);
    if (s && P(bracketed)) {
        if (!(t >= r->lo && t <= r->hi)) return;
        if (s == P(sign_lo)) r->lo = t, P(g_lo) = g;
        else r->hi = t, P(g_hi) = g;
    } else if (s) {
        /* all certain signs so far are equal: any of those points may be an end */
        double other = NAN, gother = NAN;
        if (s * P(sign_lo) < 0) other = r->lo, gother = P(g_lo);
        if (s * P(sign_hi) < 0) other = r->hi, gother = P(g_hi);
        if (s * P(sign_last) < 0) other = P(last), gother = P(g_last);
        if (t == r->lo) P(g_lo) = g, P(sign_lo) = s;
        if (t == r->hi) P(g_hi) = g, P(sign_hi) = s;
        if (!isnan(other)) {
            bool up = t < other;
            r->lo = up ? t : other, P(g_lo) = up ? g : gother;
            r->hi = up ? other : t, P(g_hi) = up ? gother : g;
            P(sign_lo) = up ? s : -s, P(sign_hi) = -P(sign_lo);
            P(bracketed) = true;
            P(step) = P(step_before) = r->hi - r->lo;
        }
    }
}

void sgt_root_tell(sgt_root *r, double t, double g)
{
    note(r, t, g);
    if (!P(bracketed)) P(last) = t, P(g_last) = g, P(sign_last) = root_sign_of(r, g);
}

static bool bisect(sgt_root *r)
{
    bool endless = !(r->lo > -HUGE_VAL && r->hi < HUGE_VAL);
    double m = endless ? among_numbers(r->lo, r->hi, 0.5) : root_middle(r->lo, r->hi);
    P(bisections)++;
    if (P(bisections) > 16 && (P(bisections) & 1) == 0) m = among_numbers(r->lo, r->hi, 0.5);
    if (!(m > r->lo && m < r->hi)) m = root_middle(r->lo, r->hi);
    if (!(m > r->lo && m < r->hi)) /* neighbours */
        return finish_between(r, fabs(P(g_lo)) < fabs(P(g_hi)) ? r->lo : r->hi);
    P(step_before) = P(step) = r->hi - r->lo;
    return go(r, m, SGT_BISECT);
}

/* No change of sign is known, and Newton is of no use any more: the ends, then samples. */
static bool look_elsewhere(sgt_root *r)
{
    if (isnan(P(g_lo)) && isfinite(r->lo) && P(sampled) < 1) return P(sampled) = 1, go(r, r->lo, SGT_SEED);
    if (isnan(P(g_hi)) && isfinite(r->hi) && P(sampled) < 2) return P(sampled) = 2, go(r, r->hi, SGT_SEED);
    if (P(sampled) < 2) P(sampled) = 2;
    if (P(single) && P(sign_lo) * P(sign_hi) > 0) {
        r->t = NAN;
        return finish(r, SGT_MISS);
    }
    P(sampled)++;
    if (P(sampled) > 2 + SAMPLES) {
        bool undefined = isnan(P(last));
        r->t = NAN;
        return finish(r, undefined ? SGT_UNDEFINED : SGT_UNPROVEN);
    }
    P(step) = P(step_before) = HUGE_VAL;
    return go(r, root_sample(r, P(sampled) - 2), SGT_MARCH);
}

/* g is NaN at r.t: goes back. */
static bool retreat(sgt_root *r)
{
    P(hole) = r->t;
    P(retreats)++;
    if (P(retreats) > RETREATS_MAX) return r->t = NAN, finish(r, SGT_UNDEFINED);
    if (P(bracketed)) { /* toward the better end, then the other, in turn */
        bool left = (fabs(P(g_lo)) < fabs(P(g_hi))) == ((P(retreats) & 1) != 0);
        double end = left ? r->lo : r->hi, m = root_middle(r->t, end);
        if (m == r->t || m == end) return r->t = NAN, finish(r, SGT_UNDEFINED);
        P(step_before) = P(step) = r->hi - r->lo;
        return go(r, m, SGT_RETREAT);
    }
    if (isnan(P(last)) || P(sampled) > 0) return look_elsewhere(r);
    double m = root_middle(r->t, P(last));
    if (m == r->t || m == P(last)) return look_elsewhere(r);
    P(step_before) = P(step) = HUGE_VAL;
    return go(r, m, SGT_RETREAT);
}

/* ---- is there a change of sign across the candidate? */

static bool probe_next(sgt_root *r)
{
    double c = P(candidate);
    for (int side = -1; side <= 1; side += 2) {
        int *seen = side < 0 ? &P(sign_left) : &P(sign_right), sign_end = side < 0 ? P(sign_lo) : P(sign_hi);
        double end = side < 0 ? r->lo : r->hi, gend = side < 0 ? P(g_lo) : P(g_hi), t;
        if (*seen != 0) continue;
        t = c + side * P(width);
        if (side < 0 ? t <= end : t >= end) { /* the end of the stretch */
            if (sign_end != 0) {
                *seen = sign_end;
                continue;
            }
            if (!isnan(gend) || c == end) { /* nothing is certain on this side */
                r->t = c;
                r->t_err = P(width);
                return finish(r, SGT_GRAZE);
            }
            t = end;
        }
        P(side) = side;
        return go(r, t, SGT_PROBE);
    }
    double width = P(width);
    r->t = c;
    r->lo = maximum_number(r->lo, c - width), r->hi = minimum_number(r->hi, c + width);
    r->t_err = maximum_number(c - r->lo, r->hi - c);
    return finish(r, P(sign_left) * P(sign_right) < 0 ? SGT_HIT : SGT_GRAZE);
}

static bool root_probe_begin(sgt_root *r, double g, double slope)
{
    if (P(least) > 0) { /* a lower bound on |g'| makes a look beside the root needless */
        certified known = certified_of(r->t, g, r->g_err, root_searched(r));
        r->t_err = known.tau_err;
        if (known.inside) return finish(r, SGT_HIT);
    }
    double w = 2 * (fabs(g) + r->g_err) / fabs(slope);
    P(candidate) = r->t;
    P(sign_left) = P(sign_right) = P(side) = 0;
    if (!isfinite(w)) w = 0; /* the slope is of no use: begin at an ulp and widen */
    P(width) = maximum_number(maximum_number(w, P(t_tol)), ulp(r->t));
    if (g == 0 && r->g_err == 0 && P(bracketed)) { /* the root itself */
        r->t_err = 0;
        return finish(r, SGT_HIT);
    }
    return probe_next(r);
}

/* Takes g at a probe; *more is then what sgt_root_next returns.  false: the candidate is given up, and
 * Newton goes on from here. */
static bool probe_tell(sgt_root *r, double g, bool *more)
{
    int side = P(side) < 0 ? -1 : 1, s = isnan(g) ? 0 : root_sign_of(r, g);
    P(side) = 0;
    if (P(bracketed) && s != 0 && s != (side < 0 ? P(sign_lo) : P(sign_hi))) return false;
    if (s == 0) {
        P(width) *= 4;
        if (isnan(g) || !isfinite(P(width))) { /* the candidate lies at the edge of the domain */
            r->t = P(candidate);
            r->t_err = P(width);
            *more = finish(r, SGT_GRAZE);
            return true;
        }
        if (r->t == r->lo) P(g_lo) = g;
        if (r->t == r->hi) P(g_hi) = g;
    } else {
        *(side < 0 ? &P(sign_left) : &P(sign_right)) = s;
    }
    *more = probe_next(r);
    return true;
}

bool sgt_root_next(sgt_root *r, double g, double slope)
{
    bool more = false;
    if (P(done)) return false;
    r->evals++;
    if (P(side) != 0 && probe_tell(r, g, &more)) return more;
    if (isnan(g)) return retreat(r);

    note(r, r->t, g);
    P(last) = r->t, P(g_last) = g, P(sign_last) = root_sign_of(r, g);
    if (P(f_tol) > 0 && fabs(g) <= P(f_tol)) {
        double off = fabs(g) + r->g_err;
        r->t_err = off > 0 ? 2 * off / fabs(slope) : 0; /* twice the first order, to cover the second */
        if (off > 0 && !(r->t_err > 0 && r->t_err < HUGE_VAL)) /* the slope says nothing */
            r->t_err = maximum_number(r->t - r->lo, r->hi - r->t);
        return finish(r, SGT_HIT);
    }
    if (root_sign_of(r, g) == 0) return root_probe_begin(r, g, slope);

    double t = r->t, tol = maximum_number(P(t_tol), 2 * ulp(t));
    bool bracketed = P(bracketed);
    if (bracketed && r->hi - r->lo <= 2 * tol)
        return finish_between(r, fabs(P(g_lo)) < fabs(P(g_hi)) ? r->lo : r->hi);

    double step = step_of(g, slope), allowed = bracketed ? 0.5 * fabs(P(step_before)) : 0.6 * fabs(P(step));
    /* a root at 0 has no ulp at which steps of a half would stop */
    bool crawls = r->evals > 200 && (r->evals & 1);
    if (isfinite(step) && step != 0 && fabs(step) <= allowed && !crawls) {
        double next = t - step;
        if (fabs(step) <= tol) {
            if (P(overshoots) > 4) { /* the slope is too steep, and not to be believed */
                P(overshoots) = 0;
                return bracketed ? bisect(r) : look_elsewhere(r);
            }
            next -= copysign(0.5 * tol * power_of_two(P(overshoots)), step);
            P(overshoots)++;
            step = tol; /* may be repeated */
        }
        if (bracketed ? next > r->lo && next < r->hi : next >= r->lo && next <= r->hi) {
            P(step_before) = P(step), P(step) = step;
            if (next != t) return go(r, next, SGT_NEWTON);
        } else if (!bracketed && isfinite(next < r->lo ? r->lo : r->hi) &&
                   isnan(next < r->lo ? P(g_lo) : P(g_hi))) {
            P(step) = P(step_before) = fabs((next < r->lo ? r->lo : r->hi) - t);
            return go(r, next, SGT_NEWTON); /* to the end */
        }
    }
    return bracketed ? bisect(r) : look_elsewhere(r);
}

const char *sgt_status_text(sgt_status status)
{
    switch (status) {
    case SGT_HIT: return "hit";
    case SGT_GRAZE: return "graze";
    case SGT_MISS: return "miss";
    case SGT_UNPROVEN: return "unproven";
    case SGT_UNDEFINED: return "undefined";
    case SGT_EXHAUSTED: return "exhausted";
    case SGT_STOPPED: return "stopped";
    case SGT_INVALID: return "invalid";
    }
    return "?";
}

const char *sgt_move_text(sgt_move move)
{
    switch (move) {
    case SGT_SEED: return "seed";
    case SGT_MARCH: return "march";
    case SGT_NEWTON: return "newton";
    case SGT_BISECT: return "bisect";
    case SGT_RETREAT: return "retreat";
    case SGT_PROBE: return "probe";
    }
    return "?";
}

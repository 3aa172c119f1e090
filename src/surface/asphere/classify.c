// SPDX-License-Identifier: MIT
/* classify.c - every root of an asphere on a stretch of a ray, in order, none missed.
 *
 * THE STRETCH is the chord of the rim.  Without a rim it is the chord of the nearer of two cylinders: the
 * equator, and the cylinder beyond which the highest term of P outgrows all the others together.  The
 * second comes from Cauchy's bound on the roots of a polynomial, with z <= z0 + |n| sqrt(rho / a) along the
 * ray.
 *
 * THE CELLS [m - h, m + h] cover it (solve/cells.h has the march).  Let e and e' be the rounding of G and G'
 * at m, and M >= |G''| over the cell (poly.c).
 *
 *  1. |G| > |G'| h + M h^2 / 2 + e + e' h:  no root in the cell.
 *  2. z - P and s have no value in common:  no root.  This test is for far from the surface.
 *  3. |G'| - e' > M h:  G is monotone.  There is one root if the signs at the ends differ, and none if they
 *     agree.  The signs must be certain.  If one is not, the end is moved; at last G there is evaluated in
 *     twice the precision.
 *  4. None of these, and M h^2 below 2 e:  G is within a few e of zero all over the cell.  The march goes on
 *     with G in twice the precision.  If that does not help, the cell joins an undecided stretch.
 *  5. Otherwise h is halved.
 *
 * For small h tests 1 or 3 hold unless G and G' vanish together, so the march ends.  If the signs at the ends
 * of an undecided stretch are like, it is UNPROVEN whether the ray touches there or just does not.
 *
 * THE ROOT.  A bracket goes to the solver of solve/root.c.  Its result goes to sgt_poly_settle of poly.c,
 * from an origin moved to the root.
 *
 * THE START.  The rule that ignores a root at the ray's start is not applied to undecided stretches: the
 * root may lie anywhere in them.  Nor is it applied to a root whose t_err is wider than that rule.
 *
 * UNDER PROOF a root has to be the only one in t -+ t_err (sgt_poly_unique), and its side of the rim has to
 * be certain. */
#include "../../num/bits.h"
#include "../../solve/cells.h"
#include "../../solve/root.h"
#include "asphere.h"

#include <limits.h>
#include <sagitta/interval.h>

typedef struct cell_walk {
    const shape *s;
    const sgt_ray *ray;
    tally *told;
    local q;
    sgt_list *list; /* NULL: only one root is wanted */
    bool spent, fine;
    bool dark;      /* the root at hand stands for an undecided stretch, not for a cell with a monotone G */
} cell_walk;

static sample cell_look(cell_walk *w, double tau, sgt_move move, double lo, double hi)
{
    w->spent = w->spent || spent(w->told);
    if (w->told->stopped || w->spent) return (sample){.g = NAN, .slope = NAN};
    sample e = w->fine ? sgt_poly_sample_fine(w->s, w->ray, &w->q, tau) : sgt_poly_sample(w->s, &w->q, tau);
    observe(w->s, w->ray, w->told, &w->q, tau, move, lo, hi);
    return e;
}

static double cell_middle(double a, double b) { return 0.5 * a + 0.5 * b; }

static int cell_sign_at(const sample *e) { return e->g > e->g_err ? 1 : e->g < -e->g_err ? -1 : 0; }

/* The smallest e with 2^e > 1.01 (of / by)^(2 / n), for of > 0 and by > 0.  1024 if the quotient overflows.
 * Write 1.01^n (of / by)^2 = f 2^E with 1/2 <= f < 1.  The condition is then 2^(e n) > f 2^E.  It is true
 * if e n >= E and false if e n <= E - 1, so e = E / n, rounded up.  Only f is rounded, by a few u, and 1.01
 * has room for that.  A quotient that underflows is raised to the smallest normal number. */
static int power_above_root(double of, double by, int n)
{
    int E, more, e;
    double y = larger(of / by, DBL_MIN);
    if (!(y < HUGE_VAL)) return 1024;
    y = binary_mantissa(y, &E);
    double f = y * y;
    for (int i = 0; i < n; i++) f *= 1.01;
    (void)binary_mantissa(f, &more);
    E = 2 * E + more;
    for (e = E / n - 1; e * n < E;) e++;
    return e;
}

/* The square of the radius beyond which no root can lie.  Infinite if no such radius is known. */
static double reach2(const shape *s, const sgt_ray *ray)
{
    double scale = scale_of(ray->d), l = ray->d.x * scale, m = ray->d.y * scale, n = ray->d.z * scale,
           a = l * l + m * m;
    double near_axis = -(ray->o.x * l + ray->o.y * m) / a, z0, k1 = 1 + s->k;
    z0 = fabs(local_at(ray, near_axis, 0).z);
    int top = s->terms - 1;
    double b[8] = {0}, lead, growth = 2 * fabs(n) / sqrt(a);
    for (int i = 0; i <= top; i++) b[i] = fabs(s->a[i]);
    if (k1 == 0) b[0] = fabs(s->a[0] + 0.5 * s->c);  /* a paraboloid is a term like the others */
    else if (k1 < 0 && s->c != 0) growth += 1 / sqrt(-k1); /* a hyperboloid grows as its asymptote */
    else b[0] += top > 0 ? fabs(s->c) : -fabs(s->c); /* an ellipsoid: its sag is at most |c| rho */
    while (top > 0 && b[top] == 0) top--;
    lead = b[top];
    double count = top + 3;
    if (!(lead > 0 && lead < HUGE_VAL && a > 0 && z0 < HUGE_VAL && growth < HUGE_VAL)) return HUGE_VAL;
    /* The largest of the roots of count z0 / lead, count growth / lead and count b[i] / lead.  It is
     * rounded up to a power of two, so that lengths times 2^k give the same cells times 2^k. */
    int exponent = INT_MIN, next;
    if (z0 > 0) exponent = power_above_root(count * z0, lead, 2 * (top + 1));
    if (growth > 0) {
        next = power_above_root(count * growth, lead, 2 * top + 1);
        if (next > exponent) exponent = next;
    }
    for (int i = 0; i < top; i++) {
        if (!(b[i] > 0)) continue;
        next = power_above_root(count * b[i], lead, 2 * (top - i));
        if (next > exponent) exponent = next;
    }
    if (exponent == INT_MIN) return 1;
    return exponent <= 1000 ? power_of_two(exponent) : HUGE_VAL;
}

typedef struct found { meeting at; sgt_status status; double distance; bool any; } found;

/* At the equator the two sheets of G are too close to tell which one the root is on.  But F itself is
 * continuous up to there.  If F certainly has unlike signs on the two sides of t, and is defined on both,
 * it has a root between them.  (It is then defined between them too, since rho is convex.) */
static bool crosses_sheet(cell_walk *w, meeting *at)
{
    double tau = at->t / w->q.scale - w->q.t0,
           d = larger(at->t_err / w->q.scale, 4 * DBL_EPSILON * fabs(tau));
    for (int i = 0; i < 24 && !w->told->stopped && !w->spent; i++, d *= 2) {
        sample l = cell_look(w, tau - d, SGT_PROBE, tau - d, tau + d),
               r = cell_look(w, tau + d, SGT_PROBE, tau - d, tau + d);
        int left = sgt_poly_side(w->s, &l), right = sgt_poly_side(w->s, &r);
        if (!left || !right) continue;
        if (left == right) return false;
        meeting_place(at, &w->q, tau, d);
        /* v is lost in its rounding, but on the surface it equals phi. */
        double dp, rho = at->p.x * at->p.x + at->p.y * at->p.y;
        polynomial(w->s->terms, w->s->a, rho, &dp);
        at->v = sqrt(larger(1 - w->s->ck * w->s->c * rho, DBL_MIN));
        double inverse = -w->s->c / at->v - 2 * dp;
        at->n = (sgt_vec3){at->p.x * inverse, at->p.y * inverse, 1};
        return true;
    }
    return false;
}

/* An undecided stretch about tmin may hold an accepted root behind the start as well as the start itself.
 * Where numbers overflow nothing is known, and the answer is yes. */
static bool may_count(const cell_walk *w, const meeting *at)
{
    meeting end = *at;
    end.t += end.t_err, end.t_err = 0;
    /* As in accepted(). */
    double terms = at->v * (fabs(at->p.x * at->n.x) + fabs(at->p.y * at->n.y) + fabs(at->p.z)) * w->q.scale;
    bool told = at->slope < HUGE_VAL && fabs(terms) < HUGE_VAL &&
                at->p.x * at->p.x + at->p.y * at->p.y < HUGE_VAL;
    return !told || accepted(&end, w->ray, HUGE_VAL, w->q.scale);
}

/* Is it a root that is not accepted as computed, but may be (ends_hide)? */
static bool hides(const shape *s, const meeting *at, const sgt_ray *ray, double scale)
{
    double terms = at->v * (fabs(at->p.x * at->n.x) + fabs(at->p.y * at->n.y) + fabs(at->p.z));
    return !accepted(at, ray, HUGE_VAL, scale)
           && ends_hide(at, ray, s->rim2, terms > 0 ? START_ULPS * terms / at->slope * scale : 0);
}

/* Is the interval of `at` within the last hit's t_err?  It may then be the same root. */
static bool within_last(const sgt_list *list, const meeting *at)
{
    sgt_interval about = sgt_about(at->t, at->t_err);
    return list->count > 0 && list->last.status == SGT_HIT && about.lo >= list->last.lo
           && about.hi <= list->last.hi;
}

/* Keeps the root if it is accepted and is the one wanted so far. */
static void keep(cell_walk *w, meeting *at, double v_err, sgt_status status, double seed, found *best)
{
    if (at->v < -v_err) return; /* the other sheet */
    if (at->t - at->t_err > w->ray->tmax) return; /* the march goes slightly beyond the end */
    if (!(at->v > v_err)) status = crosses_sheet(w, at) ? SGT_HIT : SGT_UNPROVEN;
    bool proof = w->told->opt->proof != SGT_ESTIMATE;
    bool hidden = proof && rim_hidden(at, w->s->rim2);
    if (!accepted(at, w->ray, hidden ? HUGE_VAL : w->s->rim2, w->q.scale)) {
        if (!(w->dark && may_count(w, at)) && !hides(w->s, at, w->ray, w->q.scale)) return;
        status = SGT_UNPROVEN;
    } else if (hidden) {
        status = SGT_UNPROVEN;
    }
    if (proof && status == SGT_HIT && !sgt_poly_unique(w->s, w->ray, at, w->told)) status = SGT_UNPROVEN;
    if (w->told->stopped) return;
    if (w->list) {
        /* At the equator both sheets of G have a root, and F has one. */
        if (status == SGT_HIT && !proof && sgt_list_same(w->list, at->t, at->t_err)) return;
        if (status == SGT_UNPROVEN && !proof && within_last(w->list, at))
            return; /* and what lies between them is about that one */
        if (status > 0) add_hit(w->list, at, status, asphere_f(w->s, at->p), SGT_NEWTON, w->ray, w->told);
        else add_stretch(w->list, w->told, status, w->ray, at->t - at->t_err, at->t + at->t_err);
        return;
    }
    double distance = fabs(at->t / w->q.scale - seed);
    if (best->any && !(distance < best->distance)) return;
    *best = (found){.at = *at, .status = status, .distance = distance, .any = true};
}

/* Takes what the signs at the ends of tau +- tau_err prove, for a root too flat to settle. */
static void cell_take(cell_walk *w, double tau, double tau_err, double lo, double hi, sgt_status status,
                      double seed, found *best)
{
    meeting at = {.sag = NAN};
    sample e = cell_look(w, tau, SGT_PROBE, lo, hi);
    double inverse = -w->s->c / larger(e.v, DBL_MIN) - 2 * e.dp;
    meeting_place(&at, &w->q, tau, tau_err);
    at.v = e.v, at.slope = fabs(e.slope);
    at.n = (sgt_vec3){at.p.x * inverse, at.p.y * inverse, 1};
    double bend = sgt_poly_bend(w->s, &w->q, &e, tau_err); /* not below that of w */
    keep(w, &at, e.v_err + fabs(w->s->ck) * (fabs(e.dw) + fabs(w->q.n) + bend * tau_err) * tau_err, status,
         seed, best);
}

/* Settles the root at t0 + tau.  If a t_tol hides on which side of tmax it is, or whether it is the start,
 * it is settled once more with t_tol = 0. */
static bool cell_settle(cell_walk *w, double tau, meeting *at, double *v_err)
{
    const sgt_options *opt = w->told->opt;
    bool settled = sgt_poly_settle(w->s, w->ray, w->q.t0, tau, at, v_err, w->told);
    double near = smaller(fabs(at->t - w->ray->tmax), fabs(at->t - w->ray->tmin));
    if (!settled || !(opt->t_tol > 0) || near > END_ERRORS * at->t_err) return settled;
    sgt_options sharp = *opt;
    sharp.t_tol = 0;
    w->told->opt = &sharp;
    settled = sgt_poly_settle(w->s, w->ray, w->q.t0, tau, at, v_err, w->told);
    w->told->opt = opt;
    return settled;
}

/* Finds the one root in [lo, hi].  The signs at both ends are certain; |G'| is at least `least` all over. */
static void cell_polish(cell_walk *w, double lo, const sample *at_lo, double hi, const sample *at_hi,
                        double least, double seed, found *best)
{
    for (;;) {
        sgt_root r = sgt_root_begin(
            (sgt_span){.lo = lo, .hi = hi, .seed = lo - at_lo->g * (hi - lo) / (at_hi->g - at_lo->g)},
            &(sgt_options){.t_tol = 0});
        sgt_root_tell(&r, lo, at_lo->g);
        sgt_root_tell(&r, hi, at_hi->g);
        r.private_.least = least;
        sample e;
        do {
            e = cell_look(w, r.t, r.evals ? r.move : SGT_NEWTON, r.lo, r.hi);
            r.g_err = e.g_err;
        } while (sgt_root_next(&r, e.g, e.slope) && !w->told->stopped && !w->spent);
        if (w->told->stopped || w->spent) return;
        /* G is monotone here.  So a status other than SGT_HIT only means that rounding hides where it
         * crosses. */
        double err = larger(r.t - lo, hi - r.t), v_err;
        if (r.status == SGT_HIT && r.t_err < err) err = r.t_err;
        meeting at;
        if (cell_settle(w, r.t, &at, &v_err) &&
            (at.t - w->q.t0 * w->q.scale) + at.t_lo >= lo * w->q.scale - at.t_err &&
            (at.t - w->q.t0 * w->q.scale) + at.t_lo <= hi * w->q.scale + at.t_err) {
            keep(w, &at, v_err, SGT_HIT, seed, best);
            return;
        }
        if (w->fine) {
            cell_take(w, r.t, err, lo, hi, SGT_HIT, seed, best);
            return;
        }
        w->fine = true; /* a flat root, not known well enough to settle */
    }
}

static sgt_hit parallel(const shape *s, const sgt_ray *ray, tally *told)
{
    double rho = ray->o.x * ray->o.x + ray->o.y * ray->o.y, phi, slope, v_err, dp, edge = s->ck * s->c * rho;
    if (edge > 1 + 16 * SGT_U || rho > s->rim2 * (1 + 16 * SGT_U))
        return hit_without(SGT_MISS, ray, told->evals);
    double sag = conic_sag(s->c, s->k, rho, &phi, &slope) + polynomial(s->terms, s->a, rho, &dp);
    double scale = scale_of(ray->d), t0 = (sag - ray->o.z) / (ray->d.z * scale);
    meeting at;
    bool settled = fabs(t0) < HUGE_VAL && sgt_poly_settle(s, ray, t0, 0, &at, &v_err, told);
    if (told->stopped) return hit_without(SGT_STOPPED, ray, told->evals);
    if (!settled || !(at.v > v_err)) return hit_without(SGT_UNPROVEN, ray, told->evals);
    bool on_rim =
        told->opt->proof != SGT_ESTIMATE && rim_hidden(&at, s->rim2) && accepted(&at, ray, HUGE_VAL, scale);
    if (on_rim || hides(s, &at, ray, scale)) {
        sgt_interval about = sgt_about(at.t, at.t_err);
        return hit_undecided(SGT_UNPROVEN, ray, told->evals, about.lo, about.hi);
    }
    if (!accepted(&at, ray, s->rim2, scale)) return hit_without(SGT_MISS, ray, told->evals);
    return hit_at(&at, SGT_HIT, asphere_f(s, at.p), SGT_NEWTON, ray, told);
}

/* ------------------------------------------------------------------------ the march */

/* A march.  e: the sample in the middle of the cell at hand; bend >= |G''| over the cell; steep: a bound
 * from below on |G'(m)|.  right: the sample at the end; left: that at left_at, mostly where the cell
 * begins.  begin: where the march began, or from where a root at the start is taken. */
typedef struct asphere_cells {
    cell_walk *w;
    sample e, left, right;
    double left_at, bend, steep, begin, least, seed;
    int moved;
    found *best;
} asphere_cells;

static bool cells_spent(void *self)
{
    const asphere_cells *s = self;
    return s->w->told->stopped || s->w->spent
           || (s->best->any && s->w->told->opt->pick != SGT_NEAR_SEED);
}

static int left_sign(void *self, cells *c, double tau)
{
    asphere_cells *s = self;
    s->left = cell_look(s->w, tau, SGT_MARCH, c->k.tau, c->k.hi), s->left_at = tau;
    return cell_sign_at(&s->left);
}

static bool cells_dark(void *self, cells *c, sgt_status status)
{
    asphere_cells *s = self;
    cell_walk *w = s->w;
    double lo = c->dark.lo, hi = c->dark.hi;
    w->dark = true;
    cell_take(w, cell_middle(lo, hi), 0.5 * (hi - lo), lo, hi, status == SGT_HIT ? SGT_HIT : SGT_UNPROVEN,
              s->seed, s->best);
    w->dark = false;
    return !w->told->stopped && !w->spent;
}

/* From here on in twice the precision. */
static cells_kind sharper(asphere_cells *s)
{
    s->w->fine = true, s->left_at = (double)NAN;
    return CELLS_AGAIN;
}

/* The ray starts on the surface: takes a sample before the start, as far back as G is monotone. */
static void before_the_start(asphere_cells *s, cells *c)
{
    cell_walk *w = s->w;
    for (int i = 0; c->k.tau == s->begin && !cell_sign_at(&s->left) && i < 8; i++) {
        double tau = c->k.tau, m = c->at.m,
               back = tau - 4 * (s->left.g_err + fabs(s->left.g)) / fabs(s->e.slope) * power_of_two(i),
               far = m - back;
        if (!(s->steep > sgt_poly_bend(w->s, &w->q, &s->e, far) * far)) break;
        sample behind = cell_look(w, back, SGT_MARCH, tau, c->k.hi);
        if (cell_sign_at(&behind)) s->left = behind, c->k.tau = s->begin = s->left_at = back;
    }
}

/* The signs at the ends of a monotone cell.  NOISE: rounding hides both.  A shorter cell helps if only the
 * far one is hidden. */
static cells_kind asphere_ends(asphere_cells *s, cells *c)
{
    cell_walk *w = s->w;
    s->right = cell_look(w, c->at.end, SGT_MARCH, c->k.tau, c->k.hi);
    if (s->left_at != c->k.tau) left_sign(s, c, c->k.tau);
    before_the_start(s, c);
    int a = cell_sign_at(&s->left), b = cell_sign_at(&s->right);
    if (c->k.tau == s->begin && !a && !w->fine) return sharper(s);
    if (a && !b && s->moved++ < 16) {
        c->k.h = 0.75 * c->at.h;
        return CELLS_AGAIN;
    }
    s->moved = 0;
    if (!w->fine && (!a || !b)) return sharper(s);
    c->touches = false; /* |G| is not looked at */
    return a || b ? CELLS_MONOTONE : CELLS_NOISE;
}

static cells_kind asphere_classify(void *self, cells *c)
{
    asphere_cells *s = self;
    cell_walk *w = s->w;
    double m = c->at.m, h = c->at.h;
    s->e = cell_look(w, m, SGT_MARCH, c->k.tau, c->k.hi);
    if (w->told->stopped || w->spent) return CELLS_AGAIN;
    const sample *e = &s->e;
    double slope = fabs(e->slope), bend = s->bend = sgt_poly_bend(w->s, &w->q, e, h);
    s->steep = slope - e->slope_err;
    if (fabs(e->g) > (slope + e->slope_err) * h + 0.5 * bend * h * h + e->g_err
        || sgt_poly_apart(w->s, &w->q, e, h))
        return CELLS_EMPTY;
    if (s->steep > bend * h) return asphere_ends(s, c);
    if (bend * h * h > 2 * e->g_err && h > larger(2 * DBL_EPSILON * fabs(m), s->least)) return CELLS_OPEN;
    if (!w->fine) return sharper(s);
    c->touches = false;
    return CELLS_NOISE;
}

static cells_kind asphere_settle(void *self, cells *c)
{
    asphere_cells *s = self;
    cell_walk *w = s->w;
    double m = c->at.m, h = c->at.h, end = c->at.end, tau = c->k.tau, least = s->steep - s->bend * h;
    int a = cell_sign_at(&s->left), b = cell_sign_at(&s->right);
    if (a * b < 0) {
        /* `least` is not of what lies before the cell */
        cell_polish(w, tau, &s->left, end, &s->right, tau < m - h ? 0 : least, s->seed, s->best);
    } else if (!a || !b) { /* by the least slope, the root is this near that end */
        const sample *at = a ? &s->right : &s->left;
        double off = (fabs(at->g) + at->g_err) / least * (1 + 0x1p-20);
        if (off < h) cell_take(w, a ? end : tau, off, tau, end, SGT_UNPROVEN, s->seed, s->best);
        else cell_take(w, m, h, tau, end, SGT_UNPROVEN, s->seed, s->best);
    }
    if (w->told->stopped || w->spent) return CELLS_AGAIN; /* before the root of this cell was reported */
    s->left = s->right, s->left_at = end;
    return a * b > 0 ? CELLS_EMPTY : CELLS_MONOTONE;
}

static sgt_hit cell_march(const shape *s, const sgt_ray *ray, double seed, tally *told, sgt_list *list)
{
    const sgt_options *opt = told->opt;
    cell_walk w = {.s = s, .ray = ray, .told = told, .list = list};
    if (!(s->domain2 > TINY)) return hit_without(SGT_UNPROVEN, ray, told->evals); /* r^2 is out of range */
    if (ray->d.x == 0 && ray->d.y == 0) return parallel(s, ray, told);
    /* Without a rim, the equator of a nearly flat base may be far beyond. */
    stretch chord = sgt_chord(ray, s->rim2 < HUGE_VAL ? s->domain2 : smaller(s->domain2, reach2(s, ray)));
    double scale = scale_of(ray->d), lo = larger(chord.lo, ray->tmin), hi = smaller(chord.hi, ray->tmax);
    if (chord.lo > chord.hi || lo > hi) return hit_without(SGT_MISS, ray, told->evals);
    lo /= scale, hi /= scale;
    if (!(lo < hi)) lo -= 0x1p-1074, hi += 0x1p-1074; /* one point, or both ends have underflowed */
    hi += 0x1p-44 * fabs(hi); /* include a root at tmax: accepted() has the last word */
    /* The point of the stretch nearest the vertex.  The stretch itself may be far from it. */
    w.q = local_at(ray, smaller(larger(nearest_to_vertex(ray), lo), hi), 0);
    if (!direction_is_whole(&w.q, ray->d)) return hit_without(SGT_UNPROVEN, ray, told->evals);
    /* Outward, as hi.  Twice the precision shows what the sum rounds. */
    twofold from = two_sum(lo, -w.q.t0);
    lo = from.hi - (from.lo < 0 ? 2 * SGT_U * fabs(from.hi) : 0), hi -= w.q.t0;
    if (chord.hi > ray->tmax) hi += 4 * SGT_U * fabs(w.q.t0); /* that was rounded too */
    if (!(lo > -HUGE_VAL && hi < HUGE_VAL)) return hit_without(SGT_UNPROVEN, ray, told->evals);
    if (!(fabs(seed) < HUGE_VAL)) seed = w.q.t0;

    found best = {.any = false};
    double away = fabs(w.q.x) + fabs(w.q.y) + fabs(w.q.z) + 0x1p-60 * (hi - lo);
    asphere_cells m = {.w = &w, .left_at = (double)NAN, .begin = lo, .seed = seed, .best = &best,
                       .least = 0x1p-90 * smaller(away, hi - lo)}; /* smaller cells are not divided */
    cells c = {.k = {.tau = lo, .hi = hi, .h = 0.1 * (hi - lo), .growth = 2}, .back = lo, .leap = 1.5};
    cells_march(&c, &m, (cells_ops){cells_spent, asphere_classify, asphere_settle, left_sign, cells_dark});
    if (told->stopped || (w.spent && !(best.any && opt->pick != SGT_NEAR_SEED))) {
        sgt_hit hit = hit_without(told->stopped ? SGT_STOPPED : SGT_EXHAUSTED, ray, told->evals);
        double reached = (w.q.t0 + cells_reached(&c)) * w.q.scale;
        hit.lo = smaller(larger(reached, ray->tmin), ray->tmax); /* hi was moved outward */
        return hit;
    }
    if (!best.any) return hit_without(SGT_MISS, ray, told->evals);
    if (best.status < 0) {
        sgt_interval about = sgt_about(best.at.t, best.at.t_err);
        return hit_undecided(best.status, ray, told->evals, about.lo, about.hi);
    }
    return hit_at(&best.at, best.status, asphere_f(s, best.at.p), SGT_NEWTON, ray, told);
}

sgt_hit sgt_asphere_march(const shape *s, const sgt_ray *ray, double seed, tally *told, sgt_list *list)
{
    sgt_hit hit = cell_march(s, ray, seed, told, list);
    if (list && hit.status > 0) sgt_list_add(list, &hit);
    else if (list && hit.status < 0)
        add_stretch(list, told, hit.status, ray, hit.lo, hit.hi); /* what was not searched */
    return hit;
}

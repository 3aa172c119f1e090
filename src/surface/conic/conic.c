// SPDX-License-Identifier: MIT
/* conic.c - plane, sphere and conic, in closed form with a bound on the error.
 *
 * THE EQUATION.  The sag z = s(x, y) is s = c r^2 / (1 + phi), with phi = sqrt(1 - (1 + k) c^2 r^2).  It is
 * the sheet v = 1 - (1 + k) c z >= 0 (there phi = v) of the quadric
 *     c (r^2 + (1 + k) z^2) - 2 z = 0.
 * Along x + tau l, y + tau m, z + tau n this is A tau^2 - 2 B tau + C = 0 with
 *     A = c (l^2 + m^2 + (1 + k) n^2)
 *     B = n - c (x l + y m + (1 + k) z n)
 *     C = c (r^2 + (1 + k) z^2) - 2 z          (c r^2 from a point of the vertex plane).
 * The roots are C / q and q / A, with q = B + sign(B) sqrt(B^2 - A C) and sign(0) = +1.  These forms never
 * subtract like numbers (Press et al. 2007, section 5.6).  They never divide by c, R or 1 + k, so a plane,
 * a paraboloid and a nearly flat surface are no special cases.  C / q is the root near the vertex plane.
 *
 * v is linear along the ray, so one comparison tells whether a root is on the sheet (Spencer and Murty
 * 1962, J. Opt. Soc. Am. 52, 672).  At a root |A tau - B| = sqrt(D), with D = B^2 - A C.  So g' = grad F .
 * d = -+ sqrt(D) / v.
 *
 * WHY APART.  Both roots are known without a search.  As a user's surface (own_ = NULL) a conic costs 6.6
 * times the instructions one by one, 25 times in a batch, 38 times under proof.  (Conics of
 * tests/cost/cases.c, 400 rays, by callgrind for x86-64-v3, as all prices in this folder.)
 *
 * EASY, AWAY.  They answer nearly every ray: conic/easy.h.  SIDE: rays that run along the surface, or into
 * a bowl from the side, or start on the surface: conic/side.h.
 *
 * QUICK.  In doubles, from the vertex plane.  Let u = 2^-53, and Aa, Ba, Ca the sums of the magnitudes of
 * the terms of A, B and C.  Each coefficient is off by at most 6 u of its sum; the roundings are counted
 * below.  Rounding in D adds at most u of B^2 + |A C|.  To first order the root moves by
 *     (dA tau^2 + 2 dB |tau| + dC) / (2 sqrt D),
 * and the quotient itself rounds by 4 u |tau|.  Hence
 *     tau_err = 3.25 u (Aa tau^2 + 2 Ba |tau| + Ca) / sqrt D + 4.25 u |tau|.
 * First order is enough because a ray with D below 2^-20 of Ba^2 + Aa Ca is passed on.  So the relative
 * change of D is below 2^-28, and 3.25 in place of 3 covers the higher orders.
 *
 * The quick form also answers far roots and misses.  It passes on
 * - roots whose terms at the start are more than twice those at the root (a start too far away);
 * - a sheet within rounding of the equator;
 * - a slope above 8;
 * - a t that is not sharp;
 * - terms so small that one of their squares has underflowed.
 *
 * Without it, by the careful form at once, rays that meet a ball 50 degrees and more from its vertex make a
 * picture of the ball cost 1.23 times as much.  Rays that it passes on cost 0.82.  Of 400,000 hostile rays
 * 9299 get another status, most of them with |k| above 1e18: there the careful form is out of range.
 *
 * CAREFUL.  It answers all that the quick form passes on.  It uses the same formulas from the point nearest
 * the vertex, in twice the precision.  Coordinates are scaled to 1 by a power of two, and the equation is
 * divided by another.  So c from 1e-300 to 1e300 neither overflows nor vanishes.  A, B and C are then off
 * by at most 27 u^2 of their terms: a sum 3 u^2, a product 5 u^2, and the longest chain is (1 + k) z^2 in
 * C.  EPS = 2^-100 = 64 u^2 covers that, the quotient and the square root.  Only within EPS of a tangent is
 * the sign of D undecided, and so whether there is a root.  That is reported as a graze.
 *
 * UNDER PROOF the other root, 2 sqrt(D) / |A| away, has to be off the sheet or farther than t_err from t
 * (careful_proof; in the quick form 0.99 of half that).  The side of the rim has to be certain
 * (rim_hidden).
 *
 * Times, worst cases: docs/data/one_ray.md, random.md. */
#include "../../num/bits.h"
#include "../../solve/ways.h"
#include "side.h"
#include "../sag/poly.h"
#include "../sag/second.h"

static const double EPS = 0x1p-100;
static const double D_MIN = 0x1p-20;

static bool conic_before(const meeting *a, const meeting *b)
{
    return a->t < b->t || (a->t == b->t && a->t_lo < b->t_lo);
}

/* ------------------------------------------------------------------- easy */

/* For a ray that easy_at has not met, with explicit ends.  A direction of unusual length is scaled by a
 * power of two.  For usual lengths that would change no bit. */
static easy_answer easy_else(const bowl *s, const sgt_ray *ray, const sgt_options *opt, lane *e)
{
    sgt_ray q = *ray;
    double t_tol = opt->t_tol, scale = 1;
    for (int lengths = 0; lengths < 2; lengths++) {
        bool first = opt->pick != SGT_NEAR_SEED, far_gone = false;
        for (int picks = 0; picks <= far_gone; picks++, first = false) {
            bool met = (lengths || picks) && easy_at(s, first, &q, t_tol, e);
            if (!met && !picks) {
                verdicts v = {.away = 0};
                if (s->c == 0)
                    v.away = plane_away(s, &q);
                else
                    v = easy_away(s, &q);
                if (v.away != 0) return EASY_MISS;
                far_gone = first && v.far_gone != 0;
            }
            if (!met && !nearby_at(s, first, &q, t_tol, e)) continue;
            return easy_unscaled(e, scale);
        }
        scale = scale_of(ray->d);
        if (lengths || usual_direction(scale) || !ends_are_whole(ray, scale)) break;
        q = along_scaled(&q, scale), t_tol /= scale;
    }
    return EASY_NOT;
}

/* The first root of a ray that starts on the surface, along a direction scaled as above. */
SGT_NARROW(easy_answer, sgt_conic_on_first,
           (const bowl *s, const sgt_ray *ray, const sgt_options *opt, lane *e))
{
    if (s->c == 0 || s->proof || opt->pick == SGT_NEAR_SEED || ray->tmin != 0) return EASY_NOT;
    double scale = scale_of(ray->d);
    const bool usual = usual_direction(scale);
    if (!usual && !ends_are_whole(ray, scale)) return EASY_NOT;
    if (usual) scale = 1;
    const sgt_ray along = along_scaled(ray, scale);
    if (!starts_on(s, &along)) return EASY_NOT;
    const double t_tol = opt->t_tol / scale;
    const side_start q = leaves_from(s, &along);
    if (q.away) return EASY_MISS;
    side_answer on = {.away = 0};
    if (q.met) {
        const side_place r = left_in_doubles(s, q.tau, q.tau_err, q.inverse, q.met, &along);
        on.e = side_hit(s, &r.at, r.tau, r.tau_err, r.inverse, r.wanted, &along, t_tol);
    } else
        on = met_from_on(s, &along, t_tol);
    *e = on.e;
    return on.away ? EASY_MISS : on.e.hit ? easy_unscaled(e, scale) : EASY_NOT;
}

/* From the side, else from on it, along a direction scaled as above. */
SGT_NARROW(easy_answer, sgt_conic_side_else,
           (const bowl *s, const sgt_ray *ray, const sgt_options *opt, lane *e))
{
    double scale = scale_of(ray->d);
    bool usual = usual_direction(scale), first = opt->pick != SGT_NEAR_SEED;
    if (!usual && !ends_are_whole(ray, scale)) return EASY_NOT;
    if (usual) scale = 1;
    const sgt_ray along = along_scaled(ray, scale);
    const double t_tol = opt->t_tol / scale;
    side_guess guess = side_guess_of(s, first, &along);
    side_answer side = {.away = guess.away};
    if (!side.away) side = met_from_side(s, first, guess.at, &along, t_tol);
    if (!(side.away | side.e.hit)) side = met_from_on(s, &along, t_tol);
    *e = side.e;
    return side.away ? EASY_MISS : side.e.hit ? easy_unscaled(e, scale) : EASY_NOT;
}

/* ------------------------------------------------------------------ quick */

typedef struct conic_verdict { bool accepted, certain; } conic_verdict;

typedef struct quadric { double c, k, k1, abs_k1, A, Aa, Ba, Ca, S; } quadric;

SGT_INLINE conic_verdict quick_root(meeting *at, double tau, const quadric *g, const local *q,
                                    const sgt_ray *ray, double rim2, const sgt_options *opt)
{
    conic_verdict r;
    double spread = (g->Aa * tau * tau + 2 * g->Ba * fabs(tau) + g->Ca);
    double tau_err = 3.25 * SGT_U * spread / g->S + 4.25 * SGT_U * fabs(tau);
    meeting_place(at, q, tau, tau_err);
    double cz = g->c * at->p.z, w = g->k1 * cz;
    at->v = 1 - w;
    at->slope = g->S;
    double v_err = 8 * SGT_U * (1 + fabs(w)) + 2 * fabs(g->k1 * g->c * q->n) * tau_err;
    double inverse = -g->c / at->v;
    at->n = (sgt_vec3){at->p.x * inverse, at->p.y * inverse, 1};
    double cr2 = g->c * (at->p.x * at->p.x + at->p.y * at->p.y);
    double terms = fabs(cr2) + fabs(w * at->p.z) + 2 * fabs(at->p.z);
    snap(at, g->c, g->k, square_radius(at->p.x, at->p.y), 0, 0);
    bool off_sheet = at->v < -v_err;
    double until = larger(END_ERRORS * (at->t_err + SGT_U * fabs(at->t)),
                          TINY); /* this near an end, the careful form decides */
    double steep = at->slope / q->scale,
           from_start =
               (at->t - ray->tmin - 8 * SGT_U * fabs(at->t)) * steep
               - START_ULPS * at->v * (fabs(at->p.x * at->n.x) + fabs(at->p.y * at->n.y) + fabs(at->p.z));
    /* Written so that NaN is not certain.  Tiny roots are left to the careful form. */
    r.certain = off_sheet || (at->v > 16 * v_err && spread <= 2 * terms &&
                              at->n.x * at->n.x + at->n.y * at->n.y <= STEEP2 && at->t_err < HUGE_VAL &&
                              sharp(at, opt->t_tol) && !(fabs(at->t - ray->tmax) <= until) &&
                              !(fabs(from_start) <= until * steep) &&
                              (opt->proof == SGT_ESTIMATE ||
                               !(rim_hidden(at, rim2) || fabs(g->A) * at->t_err > 0.99 * g->S * q->scale)));
    r.accepted = !off_sheet && accepted(at, ray, rim2, q->scale);
    return r;
}

typedef enum quick_answer { QUICK_HARD, QUICK_MISS, QUICK_HIT } quick_answer;

SGT_INLINE quick_answer conic_quick(double c, double k, double rim2, bool started, const sgt_ray *ray,
                                    const sgt_options *opt, meeting *out)
{
    local q = local_at_vertex_plane(ray);
    quadric g = {.c = c, .k = k, .k1 = 1 + k, .abs_k1 = fabs(1 + k)};
    double a = q.l * q.l + q.m * q.m, n2 = q.n * q.n, ca = fabs(c);
    double B = q.n - c * (q.x * q.l + q.y * q.m), C = c * (q.x * q.x + q.y * q.y);
    g.A = c * (a + g.k1 * n2);
    g.Aa = ca * (a + g.abs_k1 * n2);                     /* l^2, +, (1+k) n n, +, c: 5 roundings */
    g.Ba = fabs(q.n) + ca * (q.xa * fabs(q.l) + q.ya * fabs(q.m));   /* x itself, *, +, c, -: 5 */
    g.Ca = ca * (q.xa * q.xa + q.ya * q.ya);             /* x twice, *, +, c: 5 */
    double D = B * B - g.A * C, size = g.Ba * g.Ba + g.Aa * g.Ca;
    double r2 = q.xa * q.xa + q.ya * q.ya;
    /* If not, something has underflowed. */
    bool ranges = size > TINY && g.Aa > TINY && (r2 > TINY || r2 + q.xa + q.ya == 0) &&
                  (fabs(ray->o.z) > 0x1p-900 || ray->o.z == 0);
    if (D < -D_MIN * size && ranges) return QUICK_MISS;
    if (!(D > D_MIN * size && ranges)) return QUICK_HARD;
    g.S = sqrt(D);
    double b = B + copysign(g.S, B), tau = C / b; /* the other root is b / A; infinite where A = 0 */
    conic_verdict near = quick_root(out, tau, &g, &q, ray, rim2, opt);
    /* The other root does not matter if the near one is accepted, and is the one asked for or certainly the
     * first. */
    bool bounded = fabs(g.A) > 0x1p-40 * g.Aa;
    bool behind = bounded ? b * g.A > 0 &&
                                fabs(b) > fabs(g.A) * (larger(tau, 0) + 0x1p-20 * (fabs(q.t0) + fabs(tau)))
                          : g.Aa == 0;
    if (near.certain && near.accepted && (opt->pick == SGT_NEAR_SEED || behind)) return QUICK_HIT;
    meeting other;
    conic_verdict far = {.certain = g.Aa == 0};
    if (bounded) far = quick_root(&other, b / g.A, &g, &q, ray, rim2, opt);
    /* One of the two roots is the start, provided that its sheet exists. */
    if (started && fabs(g.A) > 0x1p-10 * g.Aa && D > 0x1p-10 * size) {
        double to_near = fabs(out->t - ray->tmin), to_far = fabs(other.t - ray->tmin);
        if (to_near < 0.25 * to_far) near = (conic_verdict){.accepted = false, .certain = true};
        if (to_far < 0.25 * to_near) far = (conic_verdict){.accepted = false, .certain = true};
    }
    if (!near.certain || !far.certain) return QUICK_HARD;
    if (!near.accepted && !far.accepted) return QUICK_MISS;
    if (far.accepted && !(near.accepted && (opt->pick == SGT_NEAR_SEED || conic_before(out, &other))))
        *out = other;
    return QUICK_HIT;
}

/* --------------------------------------------------------------- careful */

typedef struct careful_quadric {
    twofold x, y, z;        /* the local origin, in units of U */
    twofold k1, A, B, C;    /* times beta, in units of U */
    double Aa, Ba, Ca;      /* the sums of the magnitudes of their terms */
    double gamma, beta, U;  /* c U = gamma / beta, both powers of two away from it, none above 2 */
    double c, k;
    local q;
} careful_quadric;

typedef struct careful_root {
    meeting at;
    bool ends, accepted;  /* by the ends; by the rim too */
    bool hidden;        /* t_err is far wider than rounding, and hides it */
    int sheet;    /* 1 on it, 0 unknown, -1 off it */
    double terms; /* of the rule of the start, at the equator too */
} careful_root;

SGT_INLINE twofold sum3(twofold a, twofold b, twofold c) { return twofold_sum(twofold_sum(a, b), c); }

SGT_INLINE careful_quadric careful_setup(double c, double k, const sgt_ray *ray)
{
    careful_quadric g = {.c = c, .k = k};
    double t0 = nearest_to_vertex(ray);
    local q = g.q = local_at(ray, t0, 0);
    twofold x = coordinate(ray->o.x, q.l, t0, 0), y = coordinate(ray->o.y, q.m, t0, 0),
            z = coordinate(ray->o.z, q.n, t0, 0);
    double big = maximum_number(fabs(x.hi), maximum_number(fabs(y.hi), fabs(z.hi)));
    int place, curve;
    (void)binary_mantissa(big > 0 ? big : 1, &place);
    double mantissa = binary_mantissa(c, &curve);
    if (!(big > 0)) place = curve > -1000 ? -curve : 1000; /* through the vertex: scaled by the radius */
    g.U = power_of_two(place > 1000 ? 1000 : place < -1000 ? -1000 : place);
    int power = curve + (place > 1000 ? 1000 : place < -1000 ? -1000 : place);
    g.gamma = times_power_of_two(mantissa, power < 0 ? power : 0);
    g.beta = power_of_two(power < 0 ? 0 : -power);
    x = g.x = twofold_times_power(x, 1 / g.U), y = g.y = twofold_times_power(y, 1 / g.U),
    z = g.z = twofold_times_power(z, 1 / g.U);

    twofold k1 = g.k1 = two_sum(1, k), r2 = twofold_sum(twofold_product(x, x), twofold_product(y, y));
    twofold a = twofold_sum(two_product(q.l, q.l), two_product(q.m, q.m)),
            kn2 = twofold_product(k1, two_product(q.n, q.n));
    twofold xl = twofold_scaled(x, q.l), ym = twofold_scaled(y, q.m), kz = twofold_product(k1, z);
    g.A = twofold_scaled(twofold_sum(a, kn2), g.gamma);
    g.B = twofold_difference(two_product(g.beta, q.n),
                             twofold_scaled(sum3(xl, ym, twofold_scaled(kz, q.n)), g.gamma));
    g.C = twofold_difference(twofold_scaled(twofold_sum(r2, twofold_product(kz, z)), g.gamma),
                             twofold_scaled(z, 2 * g.beta));
    double ga = fabs(g.gamma);
    g.Aa = ga * (a.hi + fabs(kn2.hi));
    g.Ba = g.beta * fabs(q.n) + ga * (fabs(xl.hi) + fabs(ym.hi) + fabs(kz.hi * q.n));
    g.Ca = ga * (r2.hi + fabs(kz.hi * z.hi)) + 2 * g.beta * fabs(z.hi);
    if (power < -960) { /* gamma, or what it leaves of a twofold, is subnormal */
        double lost = 0x1p-1070 / EPS, size = 1 + fabs(x.hi) + fabs(y.hi) + fabs(kz.hi);
        g.Aa += lost * (1 + fabs(k1.hi));
        g.Ba += lost * (1 + fabs(k1.hi)) * size;
        g.Ca += lost * size * size;
    }
    if (place_underflows(&q)) {
        double lost = 0x1p-1070 / g.U / EPS;
        g.Ba += lost * ga * (2 + fabs(k1.hi));
        g.Ca += lost * 2 * (g.beta + ga * (fabs(x.hi) + fabs(y.hi) + fabs(kz.hi)));
    }
    return g;
}

/* Sets ends, accepted and hidden from `at`, whose v, slope and n are those of the rule of the start. */
SGT_INLINE void conic_judge(careful_root *r, const meeting *at, const sgt_ray *ray, double rim2, double scale)
{
    r->ends = accepted(at, ray, HUGE_VAL, scale);
    r->accepted = r->ends && !(at->p.x * at->p.x + at->p.y * at->p.y > rim2);
    if (r->ends) r->hidden = at->p_err > 0x1p-40 * (fabs(at->p.x) + fabs(at->p.y)) && rim_hidden(at, rim2);
    else r->hidden = at->t + at->t_err >= ray->tmin && at->t - at->t_err <= ray->tmax
                  && ends_hide(at, ray, rim2, r->terms > 0 ? START_ULPS * r->terms / at->slope * scale : 0);
}

SGT_INLINE careful_root careful_root_at(const careful_quadric *g, twofold tau, double tau_err, double S,
                                        const sgt_ray *ray, double rim2)
{
    const local *q = &g->q;
    careful_root r;
    twofold t = twofold_sum(twofold_times_power(tau, g->U), twofold_of(q->t0));
    twofold px = twofold_sum(g->x, twofold_scaled(tau, q->l)),
            py = twofold_sum(g->y, twofold_scaled(tau, q->m)),
            pz = twofold_sum(g->z, twofold_scaled(tau, q->n));
    twofold w = twofold_scaled(twofold_product(g->k1, pz), g->gamma),
            v = twofold_difference(twofold_of(g->beta), w);
    double length = fabs(q->l) + fabs(q->m) + fabs(q->n), slack = 1 + 16 * SGT_U;
    if (g->U < 0x1p-800) tau_err += 0x1p-1070 / g->U; /* error-free products are not, so near zero */
    r.at.t = t.hi * q->scale;
    r.at.t_lo = t.lo * q->scale;
    r.at.t_err = (fabs(t.lo) + g->U * tau_err + 8 * SGT_TWOFOLD * fabs(t.hi)) * slack * q->scale;
    if (!(fabs(r.at.t) < HUGE_VAL)) r.at.t_err = HUGE_VAL;
    /* Their squares underflow. */
    bool away = (px.hi != 0 || py.hi != 0) && larger(fabs(px.hi), fabs(py.hi)) * g->U < 0x1p-400;
    if (fabs(r.at.t) < TINY && (r.at.t != 0 || r.at.t_err != 0 || away)) r.at.t_err += TINY_ERROR;
    r.at.p = (sgt_vec3){px.hi * g->U, py.hi * g->U, pz.hi * g->U};
    r.at.p_err = g->U * (length * tau_err + SGT_U * (fabs(px.hi) + fabs(py.hi) + fabs(pz.hi))) * slack;
    if (r.at.p_err < TINY && (r.at.p_err != 0 || away)) r.at.p_err += TINY_ERROR;
    if (!(r.at.p_err < HUGE_VAL)) r.at.t_err = HUGE_VAL; /* a point beyond the largest double */
    double v_err = EPS * (g->beta + fabs(w.hi)) + 2 * fabs(g->k1.hi * g->gamma * q->n) * tau_err;
    r.sheet = v.hi > v_err ? 1 : v.hi < -v_err ? -1 : 0;
    r.at.v = v.hi;
    r.at.slope = S;
    double steep = -g->gamma / larger(v.hi, DBL_MIN); /* finite at the equator too */
    r.at.n = (sgt_vec3){px.hi * steep, py.hi * steep, 1};
    snap(&r.at, g->c, g->k, square_radius(r.at.p.x, r.at.p.y), 0, 0);
    r.terms = g->U * (fabs(g->gamma) * (px.hi * px.hi + py.hi * py.hi) + fabs(v.hi * pz.hi));
    conic_judge(&r, &r.at, ray, rim2, q->scale);
    return r;
}

/* Is the root off the sheet, the start or beyond tmax, however t is computed?  Then it is not accepted.
 * (Settled, t moves by less than 2 t_err, and t_err only shrinks.) */
SGT_INLINE bool careful_away(const careful_root *r, const sgt_ray *ray, double scale)
{
    double after = r->at.t - ray->tmin, width = START_ULPS * r->terms / r->at.slope * scale;
    return r->sheet < 0 ||
           (!r->ends && !r->hidden &&
            (after + 3 * r->at.t_err <= width * (1 - 0x1p-20) || r->at.t - 3 * r->at.t_err > ray->tmax));
}

/* Settles a t near zero further, where twice the precision is not enough for its last bits.  Nobody asks
 * for those of a root that is not accepted.  On a ray that leaves the surface that root is the start, and
 * settling it made such rays cost up to 5 times the instructions (from points on conics, any way). */
static careful_root refined(double c, double k, careful_root r, const local *q, const sgt_ray *ray,
                            double rim2, tally *w)
{
    if (r.at.t_err <= 8 * SGT_U * fabs(r.at.t) || !(r.at.t_err < HUGE_VAL)) return r;
    if (careful_away(&r, ray, q->scale)) return r;
    shape s = {.c = c, .k = k, .ck = (1 + k) * c, .rim2 = rim2};
    careful_root again = r;
    double v_err;
    if (!sgt_poly_settle(&s, ray, r.at.t / q->scale, r.at.t_lo / q->scale, &again.at, &v_err, w)) return r;
    if (!(again.at.t_err < r.at.t_err && fabs(again.at.t - r.at.t) <= r.at.t_err + again.at.t_err)) return r;
    /* At the equator a v in one double may be lost in its rounding, and the rule of the start with it. */
    meeting judged = again.at;
    judged.v = r.at.v, judged.slope = r.at.slope, judged.n = r.at.n;
    conic_judge(&again, &judged, ray, rim2, q->scale);
    return again;
}

/* Both roots in order of t.  If they touch, r[0] tells where.  If the second cannot be told from infinity,
 * it is farther than `away`, if it exists.  Otherwise the two are at least `gap` apart. */
typedef struct careful_pair {
    careful_root r[2];
    bool near_second, far_exists, touches;
    double away, gap;
} careful_pair;

/* Returns SGT_HIT if the roots exist; whether each is accepted and on the sheet is in *p. */
static sgt_status careful_roots(double c, double k, double rim2, const sgt_ray *ray, careful_pair *p,
                                tally *w)
{
    careful_quadric g = careful_setup(c, k, ray);
    twofold A = g.A, B = g.B, C = g.C, AC = twofold_product(A, C), BB = twofold_product(B, B),
            D = twofold_difference(BB, AC);
    double dA = EPS * g.Aa, dB = EPS * g.Ba, dC = EPS * g.Ca;
    double size = g.Ba * g.Ba + g.Aa * g.Ca;
    double dD = 2 * (2 * fabs(B.hi) * dB + fabs(A.hi) * dC + fabs(C.hi) * dA) + EPS * (BB.hi + fabs(AC.hi));
    bool touches = g.Ba == 0 && g.Ca == 0; /* in the vertex plane, through the vertex */
    if (!((size > 0x1p-600 || touches) && size < HUGE_VAL)) return SGT_UNPROVEN; /* out of range even so */
    if (D.hi < -dD) return SGT_MISS;

    if (D.hi <= 4 * dD) { /* two roots closer than can be told apart, or none */
        if (!(fabs(A.hi) > 2 * dA)) return SGT_UNPROVEN;
        double half_gap = sqrt(D.hi + 2 * dD);
        p->touches = true;
        p->r[0] = careful_root_at(&g, twofold_quotient(B, A), 2 * half_gap / fabs(A.hi), half_gap, ray, rim2);
        /* In lengths of d. */
        if (!(fabs(p->r[0].at.t) < HUGE_VAL && p->r[0].at.t_err < HUGE_VAL)) return SGT_UNPROVEN;
        bool may = p->r[0].sheet >= 0 && p->r[0].ends;
        if (p->r[0].sheet >= 0 && p->r[0].hidden) return SGT_UNPROVEN;
        if (may && w->opt->proof != SGT_ESTIMATE && rim_hidden(&p->r[0].at, rim2)) return SGT_UNPROVEN;
        return may && p->r[0].accepted ? SGT_GRAZE : SGT_MISS;
    }
    twofold S = twofold_root(D), b = B.hi < 0 ? twofold_difference(B, S) : twofold_sum(B, S);
    p->far_exists = fabs(A.hi) > 2 * dA;
    p->gap = p->far_exists ? 2 * S.hi / fabs(A.hi) * (1 - 0x1p-40) * g.U * g.q.scale : HUGE_VAL;
    p->away = p->far_exists || g.Aa == 0 ? HUGE_VAL : 0.25 * fabs(b.hi) / dA * g.U * g.q.scale;
    twofold tau[2] = {twofold_quotient(C, b), p->far_exists ? twofold_quotient(b, A) : twofold_of(NAN)};
    careful_root r[2];
    for (int i = 0; i < 2; i++) {
        double s = fabs(tau[i].hi), e = (dA * s * s + 2 * dB * s + dC) / S.hi + EPS * s;
        r[i] = refined(c, k, careful_root_at(&g, tau[i], e, S.hi, ray, rim2), &g.q, ray, rim2, w);
    }
    p->near_second = p->far_exists && conic_before(&r[1].at, &r[0].at); /* false for NaN */
    p->r[0] = r[p->near_second], p->r[1] = r[!p->near_second];
    return SGT_HIT;
}

/* Is the root accepted, or may it be, as far as the rim can be told? */
static bool careful_may(const careful_root *r, double rim2)
{
    return r->accepted || (r->ends && rim_hidden(&r->at, rim2));
}

/* Is root i, on the sheet as far as can be told, proven?  It has to be the only one in [t - t_err, t +
 * t_err], with its side of the rim certain. */
static bool careful_proof(const careful_pair *p, int i, double rim2)
{
    const meeting *at = &p->r[i].at;
    return (p->r[!i].sheet < 0 || 2 * at->t_err < p->gap) && !rim_hidden(at, rim2);
}

/* If it returns UNPROVEN for one root, *out is that root.  Otherwise *out is unchanged. */
static sgt_status careful(double c, double k, double rim2, const sgt_ray *ray, meeting *out, tally *w)
{
    sgt_pick pick = w->opt->pick;
    bool proof = w->opt->proof != SGT_ESTIMATE;
    careful_pair p = {.touches = false};
    sgt_status status = careful_roots(c, k, rim2, ray, &p, w);
    if (status == SGT_GRAZE || p.touches) *out = p.r[0].at;
    if (status != SGT_HIT) return status;
    const careful_root *near = &p.r[p.near_second];
    /* A is within its rounding of 0.  The far root is 2^90 times farther than the near one, if it exists. */
    if (p.away < HUGE_VAL) {
        bool near_accepted = near->accepted && near->sheet > 0, after = ray->tmax >= p.away,
             before_it = ray->tmin <= -p.away;
        if (near_accepted ? before_it && pick != SGT_NEAR_SEED : after || before_it) return SGT_UNPROVEN;
    }
    const careful_root *wanted[2] = {pick == SGT_NEAR_SEED ? near : &p.r[0],
                                     pick == SGT_NEAR_SEED ? &p.r[!p.near_second] : &p.r[1]};
    for (int i = 0; i < (p.far_exists ? 2 : 1); i++) {
        const careful_root *r = wanted[i];
        if (r->sheet < 0) continue;
        if (!(r->at.t_err < HUGE_VAL)) return SGT_UNPROVEN; /* out of range */
        if (!(proof ? careful_may(r, rim2) : r->accepted) && !r->hidden) continue;
        *out = r->at;
        return !r->hidden && r->sheet > 0 && (!proof || careful_proof(&p, (int)(r - p.r), rim2))
                   ? SGT_HIT
                   : SGT_UNPROVEN;
    }
    return SGT_MISS;
}

/* ---------------------------------------------------------------- planes */

/* The ray lies in the plane, so every point within the rim is a root.  UNPROVEN: no t inside is known. */
static sgt_status in_plane(double rim2, const sgt_ray *ray, meeting *out)
{
    stretch chord = sgt_chord(ray, rim2);
    double lo = larger(chord.lo, ray->tmin), hi = chord.hi < ray->tmax ? chord.hi : ray->tmax;
    if (!(lo <= hi)) return SGT_MISS;
    local q = local_at(ray, start_within(ray, 0, lo, hi, 0, rim2) / scale_of(ray->d), 0);
    meeting_place(out, &q, 0, 0);
    out->v = 1, out->slope = 0, out->n = (sgt_vec3){0, 0, 1}, out->sag = 0;
    bool inside = out->p.x * out->p.x + out->p.y * out->p.y <= rim2 && out->t >= lo && out->t <= hi;
    if (inside && out->t_err < HUGE_VAL && out->p_err < HUGE_VAL) return SGT_GRAZE;
    out->t_err = (double)NAN;
    return SGT_UNPROVEN;
}

/* n tau = -z.  Exact but for the quotient, and t0_lo carries the remainder. */
SGT_INLINE sgt_status plane(double rim2, const sgt_ray *ray, bool proof, meeting *out)
{
    if (ray->d.z == 0) return ray->o.z != 0 ? SGT_MISS : in_plane(rim2, ray, out);
    local q = local_at_vertex_plane(ray);
    /* The remainder has underflowed. */
    if (fabs(ray->o.z) < 0x1p-900 && ray->o.z != 0) q.t0_err += 0x1p-1074 / fabs(q.n);
    meeting_place(out, &q, 0, 0);
    out->v = 1, out->slope = fabs(q.n), out->n = (sgt_vec3){0, 0, 1}, out->sag = 0;
    if (out->t - out->t_err > ray->tmax || out->t + out->t_err < ray->tmin) return SGT_MISS;
    /* So nearly parallel that t, or the point, is out of range. */
    if (!(out->t_err < HUGE_VAL && out->p_err < HUGE_VAL)) return SGT_UNPROVEN;
    bool ends = accepted(out, ray, HUGE_VAL, q.scale);
    if (ends ? proof && rim_hidden(out, rim2) : ray->o.z != 0 && ends_hide(out, ray, rim2, 0))
        return SGT_UNPROVEN;
    return accepted(out, ray, rim2, q.scale) ? SGT_HIT : SGT_MISS;
}

/* -------------------------------------------------------------- together */

static double conic_f(double c, double k, sgt_vec3 p)
{
    double phi, slope;
    return p.z - conic_sag(c, k, p.x * p.x + p.y * p.y, &phi, &slope);
}

/* tried: easy_at has not met it. */
SGT_NARROW(sgt_hit, sgt_conic_first,
           (double c, double k, double semi_diameter, bool tried, const sgt_ray *ray,
            const sgt_options *opt))
{
    double rim2 = rim2_of(semi_diameter);
    meeting at = {.t_err = (double)NAN};
    tally w = {.opt = opt, .budget = 100}; /* for settling, which takes nine at most */
    sgt_status status;
    bowl b;
    lane e;
    if (!ray_valid(ray) || !conic_valid(c, k, semi_diameter)) return hit_without(SGT_INVALID, ray, 0);
    if (!rim_in_range(rim2)) return hit_without(SGT_UNPROVEN, ray, 0);
    bool usual = bowl_of(c, k, rim2, opt->proof != SGT_ESTIMATE, &b),
         met = usual && !tried && easy_at(&b, opt->pick != SGT_NEAR_SEED, ray, opt->t_tol, &e);
    if (usual && !met) {
        lane other; /* not e, so that e stays in registers */
        easy_answer answer = sgt_conic_on_first(&b, ray, opt, &other);
        if (answer == EASY_NOT) answer = easy_else(&b, ray, opt, &other);
        if (answer == EASY_MISS) return hit_without(SGT_MISS, ray, 0);
        met = answer == EASY_HIT;
        if (!met && c != 0) answer = sgt_conic_side_else(&b, ray, opt, &other);
        if (answer == EASY_MISS) return hit_without(SGT_MISS, ray, 0);
        met = answer == EASY_HIT;
        if (met) e = other;
    }
    if (met) {
        double f = conic_f(c, k, (sgt_vec3){e.px, e.py, e.pz});
        if (opt->watch)
            tell(&w, SGT_SEED, e.t, f, e.nx * ray->d.x + e.ny * ray->d.y + ray->d.z, e.t - e.t_err,
                 e.t + e.t_err);
        return w.stopped ? hit_without(SGT_STOPPED, ray, 1) : hit_of_lane(&e, 1, f);
    }
    if (c == 0) {
        status = plane(rim2, ray, opt->proof != SGT_ESTIMATE, &at);
    } else {
        bool started = usual && starts_on(&b, ray) != 0;
        quick_answer answer = conic_quick(c, k, rim2, started, ray, opt, &at);
        status = answer == QUICK_HIT ? SGT_HIT : SGT_MISS;
        if (answer == QUICK_HARD) at.t_err = (double)NAN, status = careful(c, k, rim2, ray, &at, &w);
    }
    if (w.stopped) return hit_without(SGT_STOPPED, ray, w.evals);
    if (status <= 0) {
        sgt_interval about = sgt_about(at.t, at.t_err);
        bool known = at.t_err < HUGE_VAL && status == SGT_UNPROVEN;
        if (known) return hit_undecided(status, ray, w.evals, about.lo, about.hi);
        return hit_without(status, ray, w.evals);
    }
    double f = isnan(at.sag) ? conic_f(c, k, at.p) : at.p.z - at.sag; /* the same number */
    return hit_at(&at, status, f, w.evals ? SGT_NEWTON : SGT_SEED, ray, &w);
}

/* easy_at, else the rest.  A ray that easy_at meets is valid: it has finite o and d, n^2 > 2^-200, and tmin <
 * t <= tmax.  So are then c and k. */
SGT_INLINE sgt_hit conic_easily(const sgt_conic *s, bool proof, const sgt_ray *ray, const sgt_options *opt)
{
    const double c = s->c, k = s->k, rim = s->semi_diameter;
    bowl b;
    lane e;
    bool usual = !opt->watch && rim >= 0 && rim < HUGE_VAL && bowl_of(c, k, rim2_of(rim), proof, &b);
    if (!usual || !easy_at(&b, opt->pick != SGT_NEAR_SEED, ray, opt->t_tol, &e))
        return sgt_conic_first(c, k, rim, usual, ray, opt);
    return hit_of_lane(&e, 1, conic_f(c, k, (sgt_vec3){e.px, e.py, e.pz}));
}

SGT_NOINLINE static sgt_hit conic_prove(const sgt_conic *s, const sgt_ray *ray, const sgt_options *opt)
{
    return conic_easily(s, true, ray, opt);
}

static sgt_hit conic_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)
{
    WENT(WAY_CLOSED);
    return opt->proof != SGT_ESTIMATE ? conic_prove(self, ray, opt) : conic_easily(self, false, ray, opt);
}

sgt_hit sgt_conic_meet(double c, double k, double semi_diameter, const sgt_ray *ray, const sgt_options *opt)
{
    const sgt_conic s = {.c = c, .k = k, .semi_diameter = semi_diameter};
    return conic_meet(&s, ray, opt);
}

static void unproven_about(sgt_list *list, const meeting *at, const sgt_ray *ray, tally *w)
{
    add_stretch(list, w, SGT_UNPROVEN, ray, at->t - at->t_err, at->t + at->t_err);
}

/* Every root, by the careful form. */
SGT_NARROW(sgt_status, sgt_conic_all,
           (double c, double k, double semi_diameter, const sgt_ray *ray, const sgt_options *opt,
            sgt_list *list))
{
    double rim2 = rim2_of(semi_diameter);
    tally w = {.opt = opt, .budget = 100};
    careful_pair p = {.away = HUGE_VAL};
    WENT(WAY_CLOSED);
    if (!conic_valid(c, k, semi_diameter)) return SGT_INVALID;
    sgt_status status = SGT_UNPROVEN;
    bool proof = opt->proof != SGT_ESTIMATE;
    p.r[0].at.t_err = (double)NAN;
    if (rim_in_range(rim2))
        status = c == 0 ? plane(rim2, ray, proof, &p.r[0].at) : careful_roots(c, k, rim2, ray, &p, &w);
    if (c == 0) p.r[0].accepted = true, p.r[0].sheet = 1;
    if (status == SGT_UNPROVEN && (c == 0 || p.touches) && p.r[0].at.t_err < HUGE_VAL)
        unproven_about(list, &p.r[0].at, ray, &w);
    else if (status == SGT_UNPROVEN) add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, HUGE_VAL);
    if (status < 0 || status == SGT_MISS) return SGT_MISS;
    if (p.away < HUGE_VAL && ray->tmin <= -p.away)
        add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, -p.away);
    double reached = ray->tmin;
    for (int i = 0; i < (p.far_exists ? 2 : 1) && !w.stopped; i++) {
        const careful_root *r = &p.r[i];
        if (status == SGT_HIT
            && (r->sheet < 0
                || (r->at.t_err < HUGE_VAL && !r->hidden && !(proof ? careful_may(r, rim2) : r->accepted))))
            continue;
        /* Out of range. */
        if (!(r->at.t_err < HUGE_VAL)) add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, HUGE_VAL);
        else if (status == SGT_HIT
                 && (r->sheet == 0 || r->hidden || (proof && c != 0 && !careful_proof(&p, i, rim2))))
            unproven_about(list, &r->at, ray, &w);
        else
            add_hit(list, &r->at, status, isnan(r->at.sag) ? conic_f(c, k, r->at.p) : r->at.p.z - r->at.sag,
                    SGT_SEED, ray, &w);
        if (!w.stopped) reached = r->at.t + r->at.t_err;
    }
    list->evals = w.evals;
    if (w.stopped) add_stretch(list, &w, SGT_STOPPED, ray, reached, HUGE_VAL);
    else if (p.away < HUGE_VAL && ray->tmax >= p.away)
        add_stretch(list, &w, SGT_UNPROVEN, ray, p.away, HUGE_VAL);
    return SGT_MISS;
}

static sgt_status conic_all(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    const sgt_conic *s = self;
    return sgt_conic_all(s->c, s->k, s->semi_diameter, ray, opt, list);
}

static double conic_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const sgt_conic *s = self;
    double phi, slope, sag = conic_sag(s->c, s->k, p.x * p.x + p.y * p.y, &phi, &slope);
    if (grad) *grad = (sgt_vec3){-2 * p.x * slope, -2 * p.y * slope, 1};
    return p.z - sag;
}

static double conic_rounding(const void *self, sgt_vec3 p)
{
    const sgt_conic *s = self;
    double r2 = p.x * p.x + p.y * p.y, phi, slope, sag = conic_sag(s->c, s->k, r2, &phi, &slope);
    return 1.01 * SGT_U * (conic_sag_rounding(s->c, s->k, r2, sag, phi) + fabs(p.z - sag));
}

static sgt_span conic_span(const void *self, const sgt_ray *ray)
{
    const sgt_conic *s = self;
    return sgt_sag_span(s->c, s->k, s->semi_diameter, ray, true);
}

static sgt_interval conic_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const sgt_conic *s = self;
    shape h = {.c = s->c, .k = s->k, .ck = (1 + s->k) * s->c};
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    return conic_valid(s->c, s->k, s->semi_diameter) ? sgt_sag_enclose(&h, ray, 0, t, slope) : *slope;
}

static size_t conic_lanes(const void *self, const sgt_tile *tile, const sgt_options *opt)
{
    const sgt_conic *s = self;
    return sgt_conic_lanes(s->c, s->k, s->semi_diameter, tile, opt);
}

static bool conic_unique(const void *self, const sgt_tile *tile, double rim2, mask unique[],
                         sgt_interval others[])
{
    const sgt_conic *s = self;
    return sgt_conic_unique(s->c, s->k, s->semi_diameter, tile, rim2, unique, others);
}

static bool conic_on(const void *self, size_t n, const double *const p[3], double on[])
{
    const sgt_conic *s = self;
    sgt_conic_on(s->c, s->k, n, p, on);
    return true;
}

static bool conic_behind(const void *self, size_t n, const sgt_rays *rays, double side[])
{
    const sgt_conic *s = self;
    sgt_conic_behind(s->c, s->k, n, rays, side);
    return true;
}

static size_t conic_leave(const void *self, const sgt_tile *tile, double behind[])
{
    const sgt_conic *s = self;
    return sgt_conic_leave(s->c, s->k, s->semi_diameter, tile, behind);
}

static bool conic_values_rounded(const void *self, const sgt_shared *shared, const double *const rows[3],
                                 size_t n, sgt_points p, sgt_values out, double own[])
{
    const sgt_conic *s = self;
    const shape h = {.c = s->c, .k = s->k, .ck = (1 + s->k) * s->c};
    (void)shared, (void)rows;
    sgt_sag_values_rounded(&h, n, p, out, own);
    return true;
}

static bool conic_even_sag(const void *self, sgt_even_sag *sag)
{
    const sgt_conic *s = self;
    *sag = (sgt_even_sag){.c = s->c, .k = s->k, .semi_diameter = s->semi_diameter};
    return conic_valid(s->c, s->k, s->semi_diameter);
}

static const struct sgt_builtin_ops conic_builtin = {.meet = conic_meet,
                                                     .all = conic_all,
                                                     .lanes = conic_lanes,
                                                     .unique = conic_unique,
                                                     .on = conic_on,
                                                     .behind = conic_behind,
                                                     .leave = conic_leave,
                                                     .even_sag = conic_even_sag,
                                                     .values_rounded = conic_values_rounded};

const sgt_surface_ops sgt_conic_ops = {
    .name = "conic", .value = conic_value, .span = conic_span, .rounding = conic_rounding,
    .enclose = conic_enclose, .own_ = &conic_builtin, .second = sgt_conic_second,
    .parameters = sgt_conic_parameters, .by_parameter = sgt_conic_by_parameter};

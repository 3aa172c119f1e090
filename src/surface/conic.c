/* conic.c - plane, sphere and conic, by closed form with a bound.
 *
 * THE EQUATION.  z = s(x, y) with s = c r^2 / (1 + phi), phi = sqrt(1 - (1 + k) c^2 r^2), is the
 * sheet  v = 1 - (1 + k) c z >= 0  (there phi = v) of the quadric
 *     c (r^2 + (1 + k) z^2) - 2 z = 0.
 * Along x + tau l, y + tau m, z + tau n it is A tau^2 - 2 B tau + C = 0 with
 *     A = c (l^2 + m^2 + (1 + k) n^2)
 *     B = n - c (x l + y m + (1 + k) z n)
 *     C = c (r^2 + (1 + k) z^2) - 2 z          (c r^2 from a point of the vertex plane)
 * and  q = B + sign(B) sqrt(B^2 - A C),  tau = C / q  or  q / A,  sign(0) = +1: no subtraction
 * of like numbers, and no division by c, R or 1 + k, so a plane, a paraboloid and a nearly flat
 * surface are no special cases (Press et al. 2007, section 5.6; the sheet: Spencer and Murty
 * 1962, J. Opt. Soc. Am. 52, 672).  Since v is linear along the ray, each root belongs to the
 * sheet or not by one comparison.  The first form is the root near the vertex plane.
 * At a root |A tau - B| = sqrt(D), D = B^2 - A C, so g' = grad F . d = -+ sqrt(D) / v.
 *
 * EASY.  Nearly every ray of an optical system: one lane of vector code, and one ray alone the same way.  From the
 * vertex plane, with explicit fma, and Aa >= |A|, Ba >= |B|, |C| the sums of the magnitudes of their terms; x is rounded
 * twice, A is off by 4 u Aa, B by 5 u Ba, C by 7 u |C|, D by u (D + |AC|) beyond what these make of it.  To first order
 *     |dtau| <= u ((2.5 Aa tau^2 + 5 Ba |tau| + 3.5 |C|) / S + 3.5 |tau|),   S = sqrt D, tau = C / b, |b| = |B| + S.
 * Let Ba^2 + Aa |C| <= q D.  Then Ba <= sqrt(q) S, |C| = |tau b| <= (1 + sqrt q) S |tau| and Aa |C| <= q D, Aa tau^2 <=
 * q S |tau|.  So q = 4/3 gives |dtau| <= 20.2 u |tau|, q = 4 gives 34 u |tau|; 24 and 48 are taken, and q > 4, a
 * ray that grazes, is not accepted.  What t0 + t0_lo is off by, 9 u^2 |t0|, moves the start along the ray's image in the
 * vertex plane and is no more than 2^-30 of an ulp of t0 to tau.  Not accepted either: S > 4 |n|, a start so far
 * off that its terms are more than those at the root; |w| = |(1 + k) c z| > 1 - 2^-8, near the equator, or on
 * another sheet; and where the first root is asked for, one whose other may be before it: that is b / A, whose
 * magnitude is the greater, and which is behind if b A > 0.  |c| lies within 2^+-60, n^2 above 2^-200 and r below 2^300:
 * then what underflows is too small to matter, and what overflows makes D infinite or NaN, or t no number that is greater
 * than tmin by a part of itself.
 *
 * AWAY.  A ray that certainly misses, by the same coefficients and with much room for their rounding: D below -2^-20 of
 * its terms; or D above 2^-10 of them, so that either root is right to a part in 2^40, and each of the two off the sheet,
 * beyond the rim, before or behind the ends by a part in 2^20, or the start itself.  Which of the two the start is, the
 * distances from tmin tell, by a factor of 4; t0 - tmin is off by 3 u |t0|, so roots closer together than that could be
 * taken for each other, but there the rule of the start (2^-50 |t| of it) hides both.
 *
 * QUICK.  In doubles, from the vertex plane.  With u = 2^-53, each coefficient is off by at most
 * 6 u of the sum of its terms' magnitudes, written A', B', C' (counted below); rounding in D is
 * at most a further u of B^2 + |A C|.  To first order the root moves by
 *     (dA tau^2 + 2 dB |tau| + dC) / (2 sqrt D),
 * and the quotient itself rounds by 4 u |tau|; hence
 *     tau_err = 3.25 u (A' tau^2 + 2 B' |tau| + C') / sqrt D + 4.25 u |tau|.
 * First order is enough because D below 2^-20 of B'^2 + A' C' is not accepted: then the relative
 * change of D is below 2^-28, and 3.25 for 3 covers what is left out.  Roots far off and misses are found here.
 * Not accepted either: roots whose terms at the start are more than twice those at the root (a
 * start too far off), a sheet that is within rounding of the equator, a slope above 8, a t that is
 * not sharp, and terms so small that a square of theirs has underflown.
 *
 * CAREFUL.  All that the quick form does not accept: the same formulas from the point nearest
 * the vertex, in twice the precision, with coordinates scaled by a power of two to 1 and the
 * equation divided by another, so that c from 1e-300 to 1e300 neither overflow nor vanish.  A, B
 * and C are then off by at most 27 u^2 of their terms (a sum 3 u^2, a product 5 u^2; the longest
 * chain is that of (1 + k) z^2 in C); EPS = 2^-100 = 64 u^2 stands for that, and for the quotient's
 * and the root's part.  The sign of D, and so whether there is a root, is undecided only within EPS of
 * a tangent: that is called a graze.
 *
 * Times, worst cases: docs/accuracy.md. */
#include "form.h"
#include "sweep.h"

static const double EPS = 0x1p-100;
static const double D_MIN = 0x1p-20;

static bool before(const meeting *a, const meeting *b) { return a->t < b->t || (a->t == b->t && a->t_lo < b->t_lo); }

/* x - x is 0 for a finite x, NaN for another. */
SGT_INLINE bool conic_valid(double c, double k, double semi_diameter)
{
    return (c - c) + (k - k) + (semi_diameter - semi_diameter) == 0 && semi_diameter >= 0;
}

/* ------------------------------------------------------------------- easy */

/* What a surface brings to all its rays; extra n^2 + |A| >= Aa; rim2 is finite, so that no infinite point is inside. */
typedef struct bowl { double c, abs_c, k1, ck, extra, rim2; } bowl;

/* false: no ray is easy. */
SGT_INLINE bool bowl_of(double c, double k, double rim2, bowl *s)
{
    *s = (bowl){c, fabs(c), 1 + k, (1 + k) * c, 1 + k < 0 ? 2 * fabs(1 + k) * fabs(c) : 0, rim2 < 0x1p600 ? rim2 : 0x1p600};
    return (c == 0 || (fabs(c) > 0x1p-60 && fabs(c) < 0x1p60)) && fabs(k) < 0x1p60 && rim_in_range(rim2);
}

SGT_INLINE near_root easy_start(const bowl *s, bool first, double ox, double oy, double oz, double l, double m, double n)
{
    double t0, t0_lo, x, y;
    to_vertex_plane(ox, oy, oz, l, m, n, &t0, &t0_lo, &x, &y);
    double xl = x * l, ym = y * m, a = l * l + m * m, n2 = n * n;
    double A = s->c * fma(s->k1, n2, a), B = fma(-s->c, xl + ym, n), C = s->c * (x * x + y * y);
    double Aa = fma(s->extra, n2, fabs(A)), Ba = fma(s->abs_c, fabs(xl) + fabs(ym), fabs(n));
    double D = fma(B, B, -A * C), size = fma(Ba, Ba, Aa * fabs(C)), D4 = (D + D) + (D + D);
    double b = B + copysign(sqrt(D), B), tau = C / b, small = t0_lo + tau, t = t0 + small, reach = fabs(t) + fabs(small);
    double n4 = (n2 + n2) + (n2 + n2), n16 = (n4 + n4) + (n4 + n4); /* sums: products are what there is most of */
    double tau_err = (D4 >= size + size + size ? 24 * SGT_U : 48 * SGT_U) * fabs(tau);
    double none = (double)NAN, t_err = fma(1.01 * SGT_U, reach, tau_err); /* one choice after another: shorter than masks */
    t_err = D4 > size ? t_err : none;
    t_err = D <= n16 ? t_err : none;
    t_err = n2 > 0x1p-200 ? t_err : none;
    if (first) t_err = copysign(1, b) * A > 0x1p-40 * Aa ? t_err : none;
    return (near_root){.x = x, .y = y, .tau = tau, .t = t, .t_err = t_err, .tau_err = tau_err, .t0 = t0, .small = small};
}

SGT_INLINE lane easy_end(const bowl *s, const near_root *r, double l, double m, double n, double tmin, double tmax, double t_tol)
{
    double pz = r->tau * n, w = s->ck * pz, g = -s->c / (1 - w);
    return lane_of(r, l, m, n, tmin, tmax, t_tol, pz, g, fabs(r->tau), s->rim2, MASK(fabs(w) < 1 - 0x1p-8));
}

/* t0 + tau does not count; its point is (x, y, 0) + tau d. */
SGT_INLINE mask gone(const bowl *s, double x, double y, double t0, double tau, double l, double m, double n, double tmin, double tmax)
{
    double px = fma(tau, l, x), py = fma(tau, m, y), t = t0 + tau, slack = 0x1p-20 * (fabs(t0) + fabs(tau));
    return MASK(s->ck * (tau * n) > 1 + 0x1p-8) | MASK(px * px + py * py > s->rim2 * (1 + 0x1p-20)) | MASK(t - slack > tmax) | MASK(t + slack < tmin);
}

/* The ray starts on the quadric: its root nearest tmin is the start itself, which does not count (sag.h).  At the start
 * G = z - c (r^2 + (1 + k) z^2) / 2 is off by 6 u of its terms, so that root is within (|G| + 6 u terms) / S of tmin, and as
 * much again makes up for G's curvature, where D is above 2^-10 of its terms; half of what the rule allows is left. */
SGT_INLINE mask starts_on(const bowl *s, double ox, double oy, double oz, double l, double m, double n, double tmin)
{
    double x = fma(tmin, l, ox), y = fma(tmin, m, oy), z = fma(tmin, n, oz), r2 = x * x + y * y, w = s->ck * z;
    double G = z - 0.5 * fma(s->c, r2, w * z), terms = fma(s->abs_c, r2, fabs(z) * (1 + fabs(w)));
    return MASK(fabs(G) + 6 * SGT_U * terms < 0.5 * START_ULPS * fma(s->abs_c, r2, fabs(z * (1 - w)))) & MASK(terms > 0x1p-600);
}

/* Neither root counts; and of the far one alone (a plane has none). */
typedef struct verdicts { mask away, far_gone; } verdicts;

SGT_INLINE verdicts easy_away(const bowl *s, double ox, double oy, double oz, double l, double m, double n, double tmin, double tmax)
{
    double t0, t0_lo, x, y;
    to_vertex_plane(ox, oy, oz, l, m, n, &t0, &t0_lo, &x, &y);
    double xl = x * l, ym = y * m, a = l * l + m * m, n2 = n * n, r2 = x * x + y * y;
    double A = s->c * fma(s->k1, n2, a), B = fma(-s->c, xl + ym, n), C = s->c * r2;
    double Aa = fma(s->extra, n2, fabs(A)), Ba = fma(s->abs_c, fabs(xl) + fabs(ym), fabs(n));
    double D = fma(B, B, -A * C), size = fma(Ba, Ba, Aa * fabs(C)), S = sqrt(larger(D, 0)), b = B + copysign(S, B), near = C / b, far = b / A;
    double to_near = fabs((t0 - tmin) + near), to_far = fabs((t0 - tmin) + far);
    mask usual = MASK(n2 > 0x1p-200) & MASK(a + n2 < 0x1p200) & MASK(r2 < 0x1p600) & MASK(size < 0x1p600) & MASK(tmin <= tmax) & MASK(tmin < HUGE_VAL) & MASK(tmax > -HUGE_VAL);
    mask real = MASK(D > 0x1p-10 * size), start = starts_on(s, ox, oy, oz, l, m, n, tmin), two = MASK(fabs(A) > 0x1p-10 * Aa);
    mask far_gone = (two & (gone(s, x, y, t0, far, l, m, n, tmin, tmax) | (start & MASK(to_far < 0.25 * to_near)))) | (MASK(Aa == 0) & MASK(s->c == 0));
    mask near_gone = gone(s, x, y, t0, near, l, m, n, tmin, tmax) | (start & two & MASK(to_near < 0.25 * to_far));
    far_gone &= usual & real;
    return (verdicts){(usual & MASK(D < -0x1p-20 * size)) | (far_gone & near_gone), far_gone};
}

/* A plane: the same with tau = 0. */
SGT_INLINE near_root plane_start(double ox, double oy, double oz, double l, double m, double n)
{
    double t0, t0_lo, x, y;
    to_vertex_plane(ox, oy, oz, l, m, n, &t0, &t0_lo, &x, &y);
    double t = t0 + t0_lo, reach = fabs(t) + fabs(t0_lo);
    mask good = MASK(n * n > 0x1p-200);
    return (near_root){.x = x, .y = y, .t = t, .t_err = chosen(good, 1.01 * SGT_U * reach, (double)NAN), .t0 = t0, .small = t0_lo};
}

SGT_INLINE lane plane_end(const bowl *s, const near_root *r, double l, double m, double n, double tmin, double tmax, double t_tol)
{
    return lane_of(r, l, m, n, tmin, tmax, t_tol, 0, 0, 0, s->rim2, MASK(true));
}

SGT_INLINE bool easy_at(const bowl *s, bool first, sgt_vec3 o, sgt_vec3 d, double tmin, double tmax, double t_tol, lane *e)
{
    near_root r = s->c == 0 ? plane_start(o.x, o.y, o.z, d.x, d.y, d.z) : easy_start(s, first, o.x, o.y, o.z, d.x, d.y, d.z);
    *e = s->c == 0 ? plane_end(s, &r, d.x, d.y, d.z, tmin, tmax, t_tol) : easy_end(s, &r, d.x, d.y, d.z, tmin, tmax, t_tol);
    return e->hit != 0;
}

typedef enum easy_answer { EASY_NOT, EASY_MISS, EASY_HIT } easy_answer;

/* A ray that is not met at once; its ends have been made explicit.  A direction of unusual length is scaled, by a power of
 * two: of the usual ones that would change no bit. */
SGT_CLONES
static easy_answer easy_else(const bowl *s, const sgt_ray *ray, const sgt_options *opt, lane *e)
{
    sgt_vec3 o = ray->o, d = ray->d;
    double tmin = ray->tmin, tmax = ray->tmax, t_tol = opt->t_tol, scale = 1;
    for (int lengths = 0; lengths < 2; lengths++) {
        bool first = opt->pick != SGT_NEAR_SEED, far_gone = false;
        for (int picks = 0; picks <= far_gone; picks++, first = false) {
            if ((lengths || picks) && easy_at(s, first, o, d, tmin, tmax, t_tol, e)) {
                e->t *= scale, e->t_err *= scale, e->t_lo *= scale;
                return e->t_err < HUGE_VAL && fabs(e->t) > LEAST_T ? EASY_HIT : EASY_NOT;
            }
            if (picks) break;
            verdicts v = easy_away(s, o.x, o.y, o.z, d.x, d.y, d.z, tmin, tmax);
            if (v.away != 0) return EASY_MISS;
            far_gone = first && v.far_gone != 0;
        }
        scale = scale_of(d);
        if (lengths || (scale > 0x1p-40 && scale < 0x1p40)) break;
        d = (sgt_vec3){d.x * scale, d.y * scale, d.z * scale}, tmin /= scale, tmax /= scale, t_tol /= scale;
    }
    return EASY_NOT;
}

/* Between the two loops. */
typedef struct bowl_room {
    _Alignas(64) double x[SGT_TILE];
    double y[SGT_TILE], tau[SGT_TILE], t[SGT_TILE], t_err[SGT_TILE], tau_err[SGT_TILE], t0[SGT_TILE], small[SGT_TILE];
    sweep_ends ends;
} bowl_room;

SGT_INLINE size_t sweep_bowl(const bowl *self, bool plane, bool first, bool rich, const sgt_tile *tile, bowl_room *room)
{
    const bowl own = *self, *s = &own; /* no output is a part of it */
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0], *m = tile->rays.d[1],
                 *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax, *t_tol = tile->t_tol;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        near_root r = plane ? plane_start(ox[i], oy[i], oz[i], l[i], m[i], n[i]) : easy_start(s, first, ox[i], oy[i], oz[i], l[i], m[i], n[i]);
        room->x[i] = r.x, room->y[i] = r.y, room->tau[i] = r.tau, room->t[i] = r.t, room->t_err[i] = r.t_err;
        if (rich) room->tau_err[i] = r.tau_err, room->t0[i] = r.t0, room->small[i] = r.small;
    }
    sweep_to to = sweep_to_of(tile, &room->ends);
    mask all = MASK(true);
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        near_root r = {.x = room->x[i], .y = room->y[i], .tau = room->tau[i], .t = room->t[i], .t_err = room->t_err[i]};
        if (rich) r.tau_err = room->tau_err[i], r.t0 = room->t0[i], r.small = room->small[i];
        lane e = plane ? plane_end(s, &r, l[i], m[i], n[i], tmin[i], tmax[i], t_tol[i]) : easy_end(s, &r, l[i], m[i], n[i], tmin[i], tmax[i], t_tol[i]);
        SWEEP_STORE(to, i, e, rich);
        all &= e.hit;
    }
    return sweep_told(tile, &room->ends, 1, all);
}

/* The verdicts of all rays. */
SGT_CLONES_WIDE
static void conic_sweep_away(const bowl *self, const sgt_tile *tile, mask *away, mask *far_gone)
{
    const bowl own = *self, *s = &own;
    const double *ox = tile->rays.o[0], *oy = tile->rays.o[1], *oz = tile->rays.o[2], *l = tile->rays.d[0], *m = tile->rays.d[1],
                 *n = tile->rays.d[2], *tmin = tile->rays.tmin, *tmax = tile->rays.tmax;
    size_t count = tile->n;
    LANES for (size_t i = 0; i < count; i++) {
        verdicts v = easy_away(s, ox[i], oy[i], oz[i], l[i], m[i], n[i], tmin[i], tmax[i]);
        away[i] = v.away, far_gone[i] = v.far_gone;
    }
}

#define SWEEP_BOWL(name, plane, first, rich)                                                        \
    SGT_CLONES_WIDE static size_t name(const bowl *s, const sgt_tile *tile, bowl_room *room)        \
    {                                                                                               \
        return sweep_bowl(s, plane, first, rich, tile, room);                                       \
    }

SWEEP_BOWL(conic_sweep_plane, true, false, false)
SWEEP_BOWL(conic_sweep_plane_rich, true, false, true)
SWEEP_BOWL(conic_sweep_near, false, false, false)
SWEEP_BOWL(conic_sweep_first, false, true, false)
SWEEP_BOWL(conic_sweep_near_rich, false, false, true)
SWEEP_BOWL(conic_sweep_first_rich, false, true, true)

static size_t sweep_near(const bowl *s, bool rich, const sgt_tile *tile, bowl_room *room)
{
    if (s->c == 0) return rich ? conic_sweep_plane_rich(s, tile, room) : conic_sweep_plane(s, tile, room);
    return rich ? conic_sweep_near_rich(s, tile, room) : conic_sweep_near(s, tile, room);
}

/* First hits that are found at once, as is usual where a surface bulges toward the ray; where many are not, those whose
 * far root, which comes first, does not count; and misses. */
size_t sgt_conic_sweep(double c, double k, double semi_diameter, const sgt_tile *tile, const sgt_options *opt)
{
    bowl_room room;
    bowl s;
    signed char *status = tile->hits.status;
    mask away[SGT_TILE], far_gone[SGT_TILE];
    if (!conic_valid(c, k, semi_diameter) || !bowl_of(c, k, rim2_of(semi_diameter), &s)) {
        memset(status, SGT_HARD, tile->n);
        return tile->n;
    }
    bool rich = tile->hits.t_lo || tile->hits.p_err, first = opt->pick != SGT_NEAR_SEED && c != 0;
    bool hollow = first && c * tile->rays.d[2][0] < 0; /* as the first ray sees it: a guess, which costs time or saves it */
    size_t hard = tile->n;
    if (hollow) memset(status, SGT_HARD, tile->n);
    else hard = !first ? sweep_near(&s, rich, tile, &room) : rich ? conic_sweep_first_rich(&s, tile, &room) : conic_sweep_first(&s, tile, &room);
    if (8 * hard <= tile->n) return hard; /* one by one */
    conic_sweep_away(&s, tile, away, far_gone);
    if (first) { /* the near roots, all of them: those found before come out the same */
        for (size_t i = 0; i < tile->n; i++)
            if (status[i] == SGT_HIT) far_gone[i] = MASK(true);
        sweep_near(&s, rich, tile, &room);
    }
    hard = 0;
    for (size_t i = 0; i < tile->n; i++) {
        bool met = status[i] == SGT_HIT && (!first || far_gone[i]);
        status[i] = met ? SGT_HIT : away[i] ? SGT_MISS : SGT_HARD;
        if (!met && tile->hits.evals) tile->hits.evals[i] = 0;
        hard += status[i] == SGT_HARD;
    }
    return hard;
}

/* ------------------------------------------------------------------ quick */

typedef struct verdict { bool counts, certain; } verdict;

typedef struct quadric { double c, k, k1, abs_k1, A, Aa, Ba, Ca, S; } quadric;

SGT_INLINE verdict quick_root(meeting *at, double tau, const quadric *g, const local *q, const sgt_ray *ray, double rim2, double t_tol)
{
    verdict r;
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
    /* written so that NaN is not certain; a tiny root is in the hands of the careful form */
    r.certain = off_sheet || (at->v > 16 * v_err && spread <= 2 * terms && at->n.x * at->n.x + at->n.y * at->n.y <= STEEP2 && at->t_err < HUGE_VAL && sharp(at, t_tol));
    r.counts = !off_sheet && counts(at, ray, rim2, q->scale);
    return r;
}

typedef enum quick_answer { QUICK_HARD, QUICK_MISS, QUICK_HIT } quick_answer;

SGT_INLINE quick_answer quick(double c, double k, double rim2, bool started, const sgt_ray *ray, const sgt_options *opt, meeting *out)
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
    bool ranges = size > TINY && g.Aa > TINY && (r2 > TINY || r2 + q.xa + q.ya == 0) && (fabs(ray->o.z) > 0x1p-900 || ray->o.z == 0); /* else something has underflown */
    if (D < -D_MIN * size && ranges) return QUICK_MISS;
    if (!(D > D_MIN * size && ranges)) return QUICK_HARD;
    g.S = sqrt(D);
    double b = B + copysign(g.S, B), tau = C / b; /* the other root is b / A: away where A = 0 */
    verdict near = quick_root(out, tau, &g, &q, ray, rim2, opt->t_tol);
    /* the other is of no interest where the near one counts and is wanted, or is certainly the first */
    bool bounded = fabs(g.A) > 0x1p-40 * g.Aa;
    bool behind = bounded ? b * g.A > 0 && fabs(b) > fabs(g.A) * (larger(tau, 0) + 0x1p-20 * (fabs(q.t0) + fabs(tau))) : g.Aa == 0;
    if (near.certain && near.counts && (opt->pick == SGT_NEAR_SEED || behind)) return QUICK_HIT;
    meeting other;
    verdict far = {.certain = g.Aa == 0};
    if (bounded) far = quick_root(&other, b / g.A, &g, &q, ray, rim2, opt->t_tol);
    if (bounded && D > 0x1p-10 * size && started) { /* one of the two is the start, as long as there is a sheet of it */
        double to_near = fabs(out->t - ray->tmin), to_far = fabs(other.t - ray->tmin);
        if (to_near < 0.25 * to_far) near = (verdict){.counts = false, .certain = true};
        if (to_far < 0.25 * to_near) far = (verdict){.counts = false, .certain = true};
    }
    if (!near.certain || !far.certain) return QUICK_HARD;
    if (!near.counts && !far.counts) return QUICK_MISS;
    if (far.counts && !(near.counts && (opt->pick == SGT_NEAR_SEED || before(out, &other)))) *out = other;
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
    bool counts;  /* by rim and ends */
    int sheet;    /* 1 on it, 0 cannot be told, -1 off it */
} careful_root;

SGT_INLINE twofold sum3(twofold a, twofold b, twofold c) { return twofold_sum(twofold_sum(a, b), c); }

SGT_INLINE careful_quadric careful_setup(double c, double k, const sgt_ray *ray)
{
    careful_quadric g = {.c = c, .k = k};
    double t0 = nearest_to_vertex(ray);
    local q = g.q = local_at(ray, t0, 0);
    twofold x = coordinate(ray->o.x, q.l, t0, 0), y = coordinate(ray->o.y, q.m, t0, 0), z = coordinate(ray->o.z, q.n, t0, 0);
    double big = fmax(fabs(x.hi), fmax(fabs(y.hi), fabs(z.hi)));
    int place, curve;
    frexp(big > 0 ? big : 1, &place);
    double mantissa = frexp(c, &curve);
    if (!(big > 0)) place = curve > -1000 ? -curve : 1000; /* through the vertex: the radius is the measure */
    g.U = ldexp(1, place > 1000 ? 1000 : place < -1000 ? -1000 : place);
    int power = curve + (place > 1000 ? 1000 : place < -1000 ? -1000 : place);
    g.gamma = ldexp(mantissa, power < 0 ? power : 0);
    g.beta = ldexp(1, power < 0 ? 0 : -power);
    x = g.x = twofold_times_power(x, 1 / g.U), y = g.y = twofold_times_power(y, 1 / g.U), z = g.z = twofold_times_power(z, 1 / g.U);

    twofold k1 = g.k1 = two_sum(1, k), r2 = twofold_sum(twofold_product(x, x), twofold_product(y, y));
    twofold a = twofold_sum(two_product(q.l, q.l), two_product(q.m, q.m)), kn2 = twofold_product(k1, two_product(q.n, q.n));
    twofold xl = twofold_scaled(x, q.l), ym = twofold_scaled(y, q.m), kz = twofold_product(k1, z);
    g.A = twofold_scaled(twofold_sum(a, kn2), g.gamma);
    g.B = twofold_difference(two_product(g.beta, q.n), twofold_scaled(sum3(xl, ym, twofold_scaled(kz, q.n)), g.gamma));
    g.C = twofold_difference(twofold_scaled(twofold_sum(r2, twofold_product(kz, z)), g.gamma), twofold_scaled(z, 2 * g.beta));
    double ga = fabs(g.gamma);
    g.Aa = ga * (a.hi + fabs(kn2.hi));
    g.Ba = g.beta * fabs(q.n) + ga * (fabs(xl.hi) + fabs(ym.hi) + fabs(kz.hi * q.n));
    g.Ca = ga * (r2.hi + fabs(kz.hi * z.hi)) + 2 * g.beta * fabs(z.hi);
    return g;
}

SGT_INLINE careful_root careful_root_at(const careful_quadric *g, twofold tau, double tau_err, double S, const sgt_ray *ray, double rim2)
{
    const local *q = &g->q;
    careful_root r;
    twofold t = twofold_sum(twofold_times_power(tau, g->U), twofold_of(q->t0));
    twofold px = twofold_sum(g->x, twofold_scaled(tau, q->l)), py = twofold_sum(g->y, twofold_scaled(tau, q->m)),
            pz = twofold_sum(g->z, twofold_scaled(tau, q->n));
    twofold w = twofold_scaled(twofold_product(g->k1, pz), g->gamma), v = twofold_difference(twofold_of(g->beta), w);
    double length = fabs(q->l) + fabs(q->m) + fabs(q->n), slack = 1 + 16 * SGT_U;
    if (g->U < 0x1p-800) tau_err += 0x1p-1070 / g->U; /* error-free products are not, so near zero */
    r.at.t = t.hi * q->scale;
    r.at.t_lo = t.lo * q->scale;
    r.at.t_err = (fabs(t.lo) + g->U * tau_err + 8 * SGT_TWOFOLD * fabs(t.hi)) * slack * q->scale;
    bool away = (px.hi != 0 || py.hi != 0) && larger(fabs(px.hi), fabs(py.hi)) * g->U < 0x1p-400; /* their squares underflow */
    if (fabs(r.at.t) < TINY && (r.at.t != 0 || r.at.t_err != 0 || away)) r.at.t_err += TINY_ERROR;
    r.at.p = (sgt_vec3){px.hi * g->U, py.hi * g->U, pz.hi * g->U};
    r.at.p_err = g->U * (length * tau_err + SGT_U * (fabs(px.hi) + fabs(py.hi) + fabs(pz.hi))) * slack;
    if (r.at.p_err < TINY && (r.at.p_err != 0 || away)) r.at.p_err += TINY_ERROR;
    double v_err = EPS * (g->beta + fabs(w.hi)) + 2 * fabs(g->k1.hi * g->gamma * q->n) * tau_err;
    r.sheet = v.hi > v_err ? 1 : v.hi < -v_err ? -1 : 0;
    r.at.v = v.hi;
    r.at.slope = S;
    double steep = -g->gamma / fmax(v.hi, DBL_MIN); /* at the very equator: as steep as a double can say */
    r.at.n = (sgt_vec3){px.hi * steep, py.hi * steep, 1};
    snap(&r.at, g->c, g->k, square_radius(r.at.p.x, r.at.p.y), 0, 0);
    r.counts = counts(&r.at, ray, rim2, q->scale);
    return r;
}

/* A t near zero is settled further, where twice the precision is not enough for its last bits. */
static careful_root refined(double c, double k, careful_root r, const local *q, const sgt_ray *ray, double rim2, tally *w)
{
    if (r.at.t_err <= 8 * SGT_U * fabs(r.at.t) || !(r.at.t_err < HUGE_VAL)) return r;
    shape s = {.c = c, .k = k, .ck = (1 + k) * c, .rim2 = rim2};
    careful_root again = r;
    double v_err;
    if (!sgt_form_settle(&s, ray, r.at.t / q->scale, r.at.t_lo / q->scale, &again.at, &v_err, w)) return r;
    if (!(again.at.t_err < r.at.t_err && fabs(again.at.t - r.at.t) <= r.at.t_err + again.at.t_err)) return r;
    again.counts = counts(&again.at, ray, rim2, q->scale);
    return again;
}

/* Both roots, in order of t; of a graze the first alone.  A second that cannot be told from infinity is
 * farther than `away`, if anywhere. */
typedef struct careful_pair { careful_root r[2]; bool near_second, far_exists; double away; } careful_pair;

/* SGT_HIT: the roots are there, if they count and are on the sheet. */
static sgt_status careful_roots(double c, double k, double rim2, const sgt_ray *ray, careful_pair *p, tally *w)
{
    careful_quadric g = careful_setup(c, k, ray);
    twofold A = g.A, B = g.B, C = g.C, AC = twofold_product(A, C), BB = twofold_product(B, B), D = twofold_difference(BB, AC);
    double dA = EPS * g.Aa, dB = EPS * g.Ba, dC = EPS * g.Ca;
    double size = g.Ba * g.Ba + g.Aa * g.Ca;
    double dD = 2 * (2 * fabs(B.hi) * dB + fabs(A.hi) * dC + fabs(C.hi) * dA) + EPS * (BB.hi + fabs(AC.hi));
    bool touches = g.Ba == 0 && g.Ca == 0; /* in the vertex plane, through the vertex */
    if (!((size > 0x1p-600 || touches) && size < HUGE_VAL)) return SGT_UNPROVEN; /* out of range even so */
    if (D.hi < -dD) return SGT_MISS;

    if (D.hi <= 4 * dD) { /* two roots, or none, closer together than can be told apart */
        if (!(fabs(A.hi) > 2 * dA)) return SGT_UNPROVEN;
        double half_gap = sqrt(D.hi + 2 * dD);
        p->r[0] = careful_root_at(&g, twofold_quotient(B, A), 2 * half_gap / fabs(A.hi), half_gap, ray, rim2);
        return p->r[0].sheet >= 0 && p->r[0].counts ? SGT_GRAZE : SGT_MISS;
    }
    twofold S = twofold_root(D), b = B.hi < 0 ? twofold_difference(B, S) : twofold_sum(B, S);
    p->far_exists = fabs(A.hi) > 2 * dA;
    p->away = p->far_exists || g.Aa == 0 ? HUGE_VAL : 0.25 * fabs(b.hi) / dA * g.U * g.q.scale;
    twofold tau[2] = {twofold_quotient(C, b), p->far_exists ? twofold_quotient(b, A) : twofold_of(NAN)};
    careful_root r[2];
    for (int i = 0; i < 2; i++) {
        double s = fabs(tau[i].hi), e = (dA * s * s + 2 * dB * s + dC) / S.hi + EPS * s;
        r[i] = refined(c, k, careful_root_at(&g, tau[i], e, S.hi, ray, rim2), &g.q, ray, rim2, w);
    }
    p->near_second = p->far_exists && before(&r[1].at, &r[0].at); /* not of NaN */
    p->r[0] = r[p->near_second], p->r[1] = r[!p->near_second];
    return SGT_HIT;
}

static sgt_status careful(double c, double k, double rim2, const sgt_ray *ray, meeting *out, tally *w)
{
    sgt_pick pick = w->opt->pick;
    careful_pair p;
    sgt_status status = careful_roots(c, k, rim2, ray, &p, w);
    if (status == SGT_GRAZE) *out = p.r[0].at;
    if (status != SGT_HIT) return status;
    const careful_root *near = &p.r[p.near_second];
    /* A within its rounding of 0: the far root is farther than the near one by 2^90, if anywhere */
    if (p.away < HUGE_VAL) {
        bool near_counts = near->counts && near->sheet > 0, after = ray->tmax >= p.away, before_it = ray->tmin <= -p.away;
        if (near_counts ? before_it && pick != SGT_NEAR_SEED : after || before_it) return SGT_UNPROVEN;
    }
    const careful_root *wanted[2] = {pick == SGT_NEAR_SEED ? near : &p.r[0], pick == SGT_NEAR_SEED ? &p.r[!p.near_second] : &p.r[1]};
    for (int i = 0; i < (p.far_exists ? 2 : 1); i++) {
        const careful_root *r = wanted[i];
        if (r->sheet < 0) continue;
        if (!(r->at.t_err < HUGE_VAL)) return SGT_UNPROVEN; /* out of range */
        if (!r->counts) continue;
        *out = r->at;
        return r->sheet > 0 ? SGT_HIT : SGT_UNPROVEN;
    }
    return SGT_MISS;
}

/* ---------------------------------------------------------------- planes */

/* n tau = -z: exact but for the quotient, and t0_lo carries that. */
SGT_INLINE sgt_status plane(double rim2, const sgt_ray *ray, meeting *out)
{
    if (ray->d.z == 0 && ray->o.z != 0) return SGT_MISS;
    local q = ray->d.z != 0 ? local_at_vertex_plane(ray) : local_at(ray, 0, 0);
    double start = ray->tmin > -HUGE_VAL ? ray->tmin : ray->tmax < 0 ? ray->tmax : 0;
    if (ray->d.z == 0) q = local_at(ray, start / q.scale, 0); /* in the plane: every point is a root */
    if (ray->d.z != 0 && fabs(ray->o.z) < 0x1p-900 && ray->o.z != 0) q.t0_err += 0x1p-1074 / fabs(q.n); /* the remainder has underflown */
    meeting_place(out, &q, 0, 0);
    out->v = 1, out->slope = fabs(q.n), out->n = (sgt_vec3){0, 0, 1}, out->sag = 0;
    if (!(out->t_err < HUGE_VAL)) return SGT_UNPROVEN; /* so nearly parallel that t is out of range */
    if (ray->d.z != 0) return counts(out, ray, rim2, q.scale) ? SGT_HIT : SGT_MISS;
    return out->p.x * out->p.x + out->p.y * out->p.y <= rim2 ? SGT_GRAZE : SGT_UNPROVEN;
}

/* -------------------------------------------------------------- together */

static double conic_f(double c, double k, sgt_vec3 p)
{
    double phi, slope;
    return p.z - conic_sag(c, k, p.x * p.x + p.y * p.y, &phi, &slope);
}

SGT_INLINE sgt_hit meet(double c, double k, double semi_diameter, const sgt_ray *ray, const sgt_options *opt)
{
    double rim2 = rim2_of(semi_diameter);
    meeting at;
    tally w = {.opt = opt, .budget = 100}; /* of settling, that takes nine at most */
    sgt_status status;
    bowl b;
    lane e;
    if (!conic_valid(c, k, semi_diameter)) return hit_without(SGT_INVALID, ray, 0);
    if (!rim_in_range(rim2)) return hit_without(SGT_UNPROVEN, ray, 0);
    bool usual = bowl_of(c, k, rim2, &b), met = usual && easy_at(&b, opt->pick != SGT_NEAR_SEED, ray->o, ray->d, ray->tmin, ray->tmax, opt->t_tol, &e);
    if (usual && !met) {
        lane other; /* not e, which is to stay in registers */
        easy_answer answer = easy_else(&b, ray, opt, &other);
        if (answer == EASY_MISS) return hit_without(SGT_MISS, ray, 0);
        met = answer == EASY_HIT;
        if (met) e = other;
    }
    if (met) {
        double f = conic_f(c, k, (sgt_vec3){e.px, e.py, e.pz});
        if (opt->watch) tell(&w, SGT_SEED, e.t, f, e.nx * ray->d.x + e.ny * ray->d.y + ray->d.z, e.t - e.t_err, e.t + e.t_err);
        return w.stopped ? hit_without(SGT_STOPPED, ray, 1) : hit_of_lane(&e, 1, f);
    }
    if (c == 0) {
        status = plane(rim2, ray, &at);
    } else {
        bool started = usual && starts_on(&b, ray->o.x, ray->o.y, ray->o.z, ray->d.x, ray->d.y, ray->d.z, ray->tmin) != 0;
        quick_answer answer = quick(c, k, rim2, started, ray, opt, &at);
        status = answer == QUICK_HIT ? SGT_HIT : answer == QUICK_MISS ? SGT_MISS : careful(c, k, rim2, ray, &at, &w);
    }
    if (w.stopped) return hit_without(SGT_STOPPED, ray, w.evals);
    if (status <= 0) return hit_without(status, ray, w.evals);
    double f = isnan(at.sag) ? conic_f(c, k, at.p) : at.p.z - at.sag; /* the same number */
    return hit_at(&at, status, f, w.evals ? SGT_NEWTON : SGT_SEED, ray, &w);
}

SGT_CLONES
sgt_hit sgt_conic_meet(double c, double k, double semi_diameter, const sgt_ray *ray, const sgt_options *opt)
{
    return meet(c, k, semi_diameter, ray, opt);
}

SGT_CLONES
static sgt_hit conic_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)
{
    const sgt_conic *s = self;
    return meet(s->c, s->k, s->semi_diameter, ray, opt);
}

/* Every root, by the careful form. */
sgt_status sgt_conic_all(double c, double k, double semi_diameter, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    double rim2 = rim2_of(semi_diameter);
    tally w = {.opt = opt, .budget = 100};
    careful_pair p = {.away = HUGE_VAL};
    if (!conic_valid(c, k, semi_diameter)) return SGT_INVALID;
    sgt_status status = SGT_UNPROVEN;
    if (rim_in_range(rim2)) status = c == 0 ? plane(rim2, ray, &p.r[0].at) : careful_roots(c, k, rim2, ray, &p, &w);
    if (c == 0) p.r[0].counts = true, p.r[0].sheet = 1;
    if (status == SGT_UNPROVEN) add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, HUGE_VAL);
    if (status < 0 || status == SGT_MISS) return SGT_MISS;
    if (p.away < HUGE_VAL && ray->tmin <= -p.away) add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, -p.away);
    double reached = ray->tmin;
    for (int i = 0; i < (p.far_exists ? 2 : 1) && !w.stopped; i++) {
        const careful_root *r = &p.r[i];
        if (status == SGT_HIT && (r->sheet < 0 || (r->at.t_err < HUGE_VAL && !r->counts))) continue;
        if (!(r->at.t_err < HUGE_VAL)) add_stretch(list, &w, SGT_UNPROVEN, ray, -HUGE_VAL, HUGE_VAL); /* out of range */
        else if (status == SGT_HIT && r->sheet == 0) add_stretch(list, &w, SGT_UNPROVEN, ray, r->at.t - r->at.t_err, r->at.t + r->at.t_err);
        else add_hit(list, &r->at, status, isnan(r->at.sag) ? conic_f(c, k, r->at.p) : r->at.p.z - r->at.sag, SGT_SEED, ray, &w);
        if (!w.stopped) reached = r->at.t + r->at.t_err;
    }
    if (w.stopped) add_stretch(list, &w, SGT_STOPPED, ray, reached, HUGE_VAL);
    else if (p.away < HUGE_VAL && ray->tmax >= p.away) add_stretch(list, &w, SGT_UNPROVEN, ray, p.away, HUGE_VAL);
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

static size_t conic_sweep(const void *self, const sgt_tile *tile, const sgt_options *opt)
{
    const sgt_conic *s = self;
    return sgt_conic_sweep(s->c, s->k, s->semi_diameter, tile, opt);
}

static const struct sgt_own conic_own = {.meet = conic_meet, .all = conic_all, .sweep = conic_sweep};

const sgt_surface_ops sgt_conic_ops = {.name = "conic", .value = conic_value, .span = conic_span, .rounding = conic_rounding, .own_ = &conic_own};

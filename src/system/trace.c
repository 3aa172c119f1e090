/* trace.c - a ray through a row of surfaces: place, meet, clip, bend, and on.
 *
 * WHERE THE RAY IS.  Between elements the point is kept as base + offset, the base being
 * the origin of the element just passed, the offset in global axes but small.  The next
 * element then sees (base - its origin) + offset, and both are of the size of the lens,
 * wherever in the world the lens stands: at 1e9 from the global origin a sum of the two
 * would have lost 1e-7 at every surface.  Only the ray handed back is added up.
 *
 * THE LAUNCH may be far away all the same.  There a turn, a subtraction that is not exact,
 * or a direction made of unit length, puts the ray aside by an ulp of its distance.  So
 * where one of the three is needed the launch point is first moved along the ray to its foot
 * nearest the first element's origin, with error-free sums and products: base - origin + t0 d
 * is right to an ulp of what is left of it, whatever t0 is, d being the direction as given.
 * The t of the first hit, and of the steps that a watcher sees on the way to it, has t0 (as
 * a length) added again.
 *
 * THE BENDING (Spencer & Murty 1962, J. Opt. Soc. Am. 52, 672; there by components, here in
 * vectors).  With d the direction, N the unit normal turned so that c = d . N >= 0 and
 * r = n1 / n2, the part of d along the surface is multiplied by r, and what is along N
 * fills the length up to one:
 *
 *     d' = r d + (c' - r c) N,   c'^2 = Q = 1 - r^2 s^2,   s^2 = |d x N|^2 = 1 - c^2,
 *
 * total internal reflection where Q < 0.  Q decides between the two, and each of its forms
 * cancels somewhere: 1 - c^2 is of no use near the normal, nor 1 - r^2 s^2 at grazing
 * incidence between like indices.  So
 *     s^2 <= 1/2:  Q = (1 - r s) (1 + r s), s from the cross product;
 *     s^2 >  1/2:  Q = (n2 - n1) (n2 + n1) / n2^2 + (r c)^2, where n2 - n1 is exact when
 *                  the indices are within a factor of two, and TIR needs r < sqrt 2.
 * In either the rounding of Q is a few 2^-53 of 1: no more than an ulp or two of the angle
 * of incidence makes of it.  A mirror: d' = d - 2 (d . q) q / (q . q), q along the normal,
 * any length.
 *
 * The normal is the gradient as the surface gives it, never normalised there.  Near the
 * equator of a sphere its components grow without bound, so it is scaled by a power of two
 * first; one infinite component is a normal along that axis; two, a NaN, or none but zeros
 * name no direction, and such a ray is SGT_LOST, with SGT_UNDEFINED as the reason (unless
 * the indices are equal: then no normal is needed).
 *
 * d stays of unit length to 2^-50; a direction that already is so is left as it is, to the
 * bit, and so is one that passes between equal indices. */
#include <sagitta/system.h>

#include "../surface/conic.h"

/* ------------------------------------------------------------------ vectors */

SGT_INLINE sgt_vec3 plus(sgt_vec3 a, sgt_vec3 b) { return (sgt_vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
SGT_INLINE sgt_vec3 minus(sgt_vec3 a, sgt_vec3 b) { return (sgt_vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
SGT_INLINE sgt_vec3 times(double a, sgt_vec3 b) { return (sgt_vec3){a * b.x, a * b.y, a * b.z}; }
SGT_INLINE bool is_finite(sgt_vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }
SGT_INLINE bool is_zero(sgt_vec3 a) { return a.x == 0 && a.y == 0 && a.z == 0; }
SGT_INLINE double largest(sgt_vec3 a) { return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))); }

/* a . b, rounded once or nearly so (Ogita, Rump & Oishi 2005, SIAM J. Sci. Comput. 26, 1955). */
SGT_INLINE double dot(sgt_vec3 a, sgt_vec3 b)
{
    twofold x = two_product(a.x, b.x), y = two_product(a.y, b.y), z = two_product(a.z, b.z);
    twofold s = two_sum(x.hi, y.hi), t = two_sum(s.hi, z.hi);
    return t.hi + (t.lo + (s.lo + (x.lo + (y.lo + z.lo))));
}

/* a b - c d within 2 ulps (Kahan; Jeannerod, Louvet & Muller 2013, Math. Comp. 82, 2245). */
SGT_INLINE double difference_of_products(double a, double b, double c, double d)
{
    double w = c * d, e = fma(-c, d, w);
    return fma(a, b, -w) + e;
}

/* |a x b|^2 */
SGT_INLINE double cross_squared(sgt_vec3 a, sgt_vec3 b)
{
    double x = difference_of_products(a.y, b.z, a.z, b.y);
    double y = difference_of_products(a.z, b.x, a.x, b.z);
    double z = difference_of_products(a.x, b.y, a.y, b.x);
    return x * x + y * y + z * z;
}

/* |a|^2 - 1 within 2^-52, for |a| near 1: each fma rounds a number of at most 1. */
SGT_INLINE double excess(sgt_vec3 a) { return fma(a.x, a.x, fma(a.y, a.y, fma(a.z, a.z, -1))); }

/* Leaves |d| = 1 within an ulp, by one Newton step for 1/sqrt: |d|^-1 = 1 - e/2 + O(e^2). */
SGT_INLINE sgt_vec3 corrected(sgt_vec3 d)
{
    double half = 0.5 * excess(d);
    return (sgt_vec3){d.x - half * d.x, d.y - half * d.y, d.z - half * d.z};
}

/* 2^-50: what plain normalising, by root and quotient, may be off by; closer than that to
 * unit length there is nothing to gain. */
SGT_INLINE bool is_unit(sgt_vec3 d) { return fabs(excess(d)) <= 0x1p-50; }

/* To unit length; false: zero, subnormal or not finite. */
SGT_INLINE bool make_unit(sgt_vec3 *d)
{
    if (!is_finite(*d) || !(largest(*d) >= DBL_MIN)) return false;
    if (is_unit(*d)) return true;
    sgt_vec3 v = times(scale_of(*d), *d);
    double length = sqrt(dot(v, v));
    *d = corrected((sgt_vec3){v.x / length, v.y / length, v.z / length});
    return true;
}

/* -------------------------------------------------------------------- poses */

SGT_INLINE bool is_turned(const sgt_pose *pose) { return !(is_zero(pose->ex) && is_zero(pose->ey) && is_zero(pose->ez)); }

SGT_INLINE sgt_vec3 to_local(const sgt_pose *pose, sgt_vec3 a)
{
    return (sgt_vec3){dot(a, pose->ex), dot(a, pose->ey), dot(a, pose->ez)};
}

SGT_INLINE sgt_vec3 to_global(const sgt_pose *pose, sgt_vec3 a)
{
    sgt_vec3 ex = pose->ex, ey = pose->ey, ez = pose->ez;
    return (sgt_vec3){dot(a, (sgt_vec3){ex.x, ey.x, ez.x}), dot(a, (sgt_vec3){ex.y, ey.y, ez.y}),
                      dot(a, (sgt_vec3){ex.z, ey.z, ez.z})};
}

/* A ray on its way: at base + offset, in global axes, t0 behind its launch. */
typedef struct state {
    sgt_vec3 base, offset, d;
    double t0;       /* of the first element only: how far the launch point was moved */
    double index;    /* of the medium it is in */
    twofold path;    /* index * length so far */
} state;

/* (base - origin) + t0 d, one coordinate, right to an ulp of the sum. */
SGT_INLINE double moved(double base, double origin, double t0, double d)
{
    return twofold_sum(two_sum(base, -origin), two_product(t0, d)).hi;
}

/* At launch, d as it was given: the foot of the perpendicular from the first element's origin,
 * where it is of use. */
SGT_INLINE void move_launch(state *at, const sgt_pose *pose, sgt_vec3 d)
{
    sgt_vec3 o = pose->origin, q = minus(at->base, o), v = times(scale_of(d), d); /* v: exact */
    bool exact = two_sum(at->base.x, -o.x).lo == 0 && two_sum(at->base.y, -o.y).lo == 0 && two_sum(at->base.z, -o.z).lo == 0;
    if ((exact && !is_turned(pose) && is_unit(d)) || !is_finite(q)) return;
    double v2 = dot(v, v), t0 = -dot(q, v) / v2;
    if (!isfinite(t0)) return;
    at->offset = (sgt_vec3){moved(at->base.x, o.x, t0, v.x), moved(at->base.y, o.y, t0, v.y), moved(at->base.z, o.z, t0, v.z)};
    at->base = o;
    at->t0 = t0 * sqrt(v2);
}

/* A watcher of the first element, told the t of the launch ray. */
typedef struct shifted { sgt_watch *watch; void *data; double t0; } shifted;

static int watch_shifted(void *data, const sgt_step *step)
{
    const shifted *s = data;
    sgt_step own = *step;
    own.t += s->t0, own.lo += s->t0, own.hi += s->t0;
    return s->watch(s->data, &own);
}

/* The same for the answer; t_err takes over what t as one double cannot hold, and the rounding
 * of t0 * |v|: a dot product, a root and a product. */
static void shift_hit(sgt_hit *hit, double t0)
{
    hit->lo += t0, hit->hi += t0;
    if (hit->status <= 0) {
        hit->t += t0; /* NaN, or the best so far */
        return;
    }
    twofold t = two_sum(t0, hit->t);
    hit->t = t.hi;
    hit->t_lo += t.lo;
    hit->t_err = (hit->t_err + fabs(t.lo) + 3 * SGT_U * fabs(t0)) * (1 + 4 * SGT_U);
    hit->lo = fmin(hit->lo, hit->t - hit->t_err);
    hit->hi = fmax(hit->hi, hit->t + hit->t_err);
}

/* ------------------------------------------------------------------ meeting */

SGT_INLINE bool is_inside(const sgt_hit *hit, double rim2) { return !(hit->p.x * hit->p.x + hit->p.y * hit->p.y > rim2); }

/* The hit that is meant; *inside: within the clear aperture.  The whole line first.  A root
 * outside the aperture, or no decision, is asked again on the chord of the ray with the
 * aperture's cylinder, which only an answer inside overrules.  The chord is made longer by
 * 2^-20 at both ends, so that a root on the rim is not taken for the start of the ray (see
 * sgt_ray): those within are told from those without by their r^2 alone. */
static sgt_hit meet(sgt_surface surface, sgt_ray ray, double semi_diameter, const sgt_options *opt, bool *inside)
{
    double rim2 = semi_diameter < 1e150 ? rim2_of(semi_diameter) : HUGE_VAL; /* wider holds whatever can be met */
    sgt_hit hit = sgt_intersect(surface, ray, opt);
    *inside = hit.status > 0 && is_inside(&hit, rim2);
    if (*inside || !(rim2 < HUGE_VAL)) return hit;
    if (hit.status == SGT_MISS || hit.status == SGT_STOPPED || hit.status == SGT_INVALID) return hit;

    stretch chord = sgt_chord(&ray, rim2);
    double more = 0x1p-20 * (chord.hi - chord.lo);
    if (!(chord.lo < chord.hi && more < HUGE_VAL)) return hit; /* beside the cylinder, or along it: no other root */
    ray.tmin = chord.lo - more, ray.tmax = chord.hi + more;
    if (ray.tmax == 0 && ray.tmin >= 0) return hit;            /* underflow: that would stand for infinity */
    sgt_hit other = sgt_intersect(surface, ray, opt);
    other.evals += hit.evals;
    hit.evals = other.evals;
    if (other.status == SGT_STOPPED) return other;
    if (!(other.status > 0 && is_inside(&other, rim2))) return hit;
    *inside = true;
    return other;
}

/* ------------------------------------------------------------------ bending */

/* A vector along n with components of at most 2 and one of at least 1 (or 2^-51, where n is
 * subnormal); false: n names no direction. */
SGT_INLINE bool along_normal(sgt_vec3 n, sgt_vec3 *q)
{
    if (isnan(n.x) || isnan(n.y) || isnan(n.z)) return false;
    int infinite = !isfinite(n.x) + !isfinite(n.y) + !isfinite(n.z);
    if (infinite == 1) {
        *q = (sgt_vec3){!isfinite(n.x) ? copysign(1, n.x) : 0, !isfinite(n.y) ? copysign(1, n.y) : 0,
                        !isfinite(n.z) ? copysign(1, n.z) : 0};
        return true;
    }
    if (infinite > 1 || is_zero(n)) return false;
    *q = times(scale_of(n), n);
    return true;
}

SGT_INLINE sgt_fate reflect(sgt_vec3 *d, sgt_vec3 n)
{
    sgt_vec3 q;
    if (!along_normal(n, &q)) return SGT_LOST;
    double k = 2 * dot(*d, q) / dot(q, q);
    *d = corrected(minus(*d, times(k, q)));
    return SGT_PASSED;
}

SGT_INLINE sgt_fate refract(sgt_vec3 *d, sgt_vec3 n, double n1, double n2)
{
    sgt_vec3 q;
    if (n1 == n2) return SGT_PASSED;
    if (!along_normal(n, &q)) return SGT_LOST;
    double length = sqrt(dot(q, q)), c = dot(*d, q) / length, r = n1 / n2;
    double s2 = cross_squared(*d, q) / dot(q, q), s = sqrt(s2);
    double Q = s2 <= 0.5 ? (1 - r * s) * (1 + r * s) : (n2 - n1) / n2 * ((n2 + n1) / n2) + r * c * (r * c);
    if (Q < 0) return SGT_TIR;
    double along = copysign(sqrt(Q), c) - r * c;
    *d = corrected(plus(times(r, *d), times(along / length, q)));
    return fabs(dot(*d, *d) - 1) < 0x1p-40 ? SGT_PASSED : SGT_LOST; /* LOST: indices too unlike for a double */
}

/* --------------------------------------------------------------- the trace */

static sgt_passage not_met(sgt_status why)
{
    const double none = (double)NAN;
    return (sgt_passage){
        .hit = {.status = why, .t = none, .t_err = none, .t_lo = none, .lo = none, .hi = none, .f = none, .p_err = none,
                .p = {none, none, none}, .n = {none, none, none}},
        .opl = none,
    };
}

SGT_INLINE bool is_index(double index) { return index > 0 && isfinite(index); }

/* One element: its passage, and the ray behind it in *at where it passed. */
SGT_INLINE sgt_fate pass(const sgt_element *e, state *at, const sgt_options *opt, sgt_passage *passage)
{
    bool mirror = e->index == SGT_MIRROR, turned = is_turned(&e->pose), inside;
    double n1 = at->index, n2 = e->index == 0 || mirror ? n1 : e->index;
    *passage = not_met(SGT_INVALID);
    if (!is_index(n1) || !is_index(n2) || !(e->semi_diameter >= 0)) return SGT_LOST;

    sgt_ray ray = {.o = plus(minus(at->base, e->pose.origin), at->offset), .d = at->d, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    if (turned) {
        ray.o = to_local(&e->pose, ray.o), ray.d = to_local(&e->pose, ray.d);
        if (!make_unit(&ray.d)) return SGT_LOST;
    }
    sgt_options own = *opt;
    /* 32 ulps of the aperture: a point is not known better than that, and t, over a thin gap, need
     * not be.  But of the launch point's coordinates where they are less: an aperture may be put
     * at 1e10, to stand for none */
    if (own.t_tol == 0) own.t_tol = 0x1p-48 * fmin(e->semi_diameter, largest(ray.o));
    shifted shift = {opt->watch, opt->watch_data, at->t0};
    if (at->t0 != 0 && opt->watch) own.watch = watch_shifted, own.watch_data = &shift;
    sgt_hit hit = meet(e->surface, ray, e->semi_diameter, &own, &inside);
    if (at->t0 != 0) shift_hit(&hit, at->t0);
    passage->hit = hit;
    if (hit.status == SGT_MISS) return SGT_MISSED;
    if (hit.status < 0) return SGT_LOST;

    twofold path = twofold_sum(at->path, two_product(n1, hit.t));
    path = twofold_sum(path, twofold_of(n1 * hit.t_lo));
    passage->opl = path.hi;
    if (!inside) return SGT_CLIPPED;

    sgt_vec3 d = ray.d;
    sgt_fate fate = mirror ? reflect(&d, hit.n) : refract(&d, hit.n, n1, n2);
    if (fate == SGT_LOST) { /* no normal there */
        *passage = not_met(SGT_UNDEFINED);
        passage->hit.evals = hit.evals;
    }
    if (fate != SGT_PASSED) return fate;
    passage->direction = d;
    if (mirror || n1 != n2) { /* else the global direction stays as it is, to the bit */
        at->d = turned ? to_global(&e->pose, d) : d;
        if (turned) make_unit(&at->d);
    }
    at->base = e->pose.origin;
    at->offset = turned ? to_global(&e->pose, hit.p) : hit.p;
    at->t0 = 0;
    at->index = n2;
    at->path = path;
    return SGT_PASSED;
}

SGT_CLONES
size_t sgt_trace(size_t n, const sgt_element e[], double index_before, sgt_ray *ray, sgt_passage passages[],
                 sgt_fate *fate, const sgt_options *opt)
{
    sgt_options options = opt ? *opt : (sgt_options){0};
    if (options.pick == SGT_PICK_DEFAULT) options.pick = SGT_NEAR_SEED;
    state at = {.base = ray->o, .d = ray->d, .index = index_before == 0 ? 1 : index_before};
    sgt_fate last = SGT_PASSED;
    size_t passed = 0;
    if (!make_unit(&at.d) || !is_finite(at.base)) {
        last = SGT_LOST;
        if (passages && n) passages[0] = not_met(SGT_INVALID);
    } else {
        sgt_vec3 launch = ray->d;
        ray->d = at.d;
        if (n) move_launch(&at, &e[0].pose, launch);
    }
    while (last == SGT_PASSED && passed < n) {
        sgt_passage passage;
        last = pass(&e[passed], &at, &options, &passage);
        if (passages) passages[passed] = passage;
        if (last != SGT_PASSED) break;
        passed++;
        ray->o = plus(at.base, at.offset), ray->d = at.d;
    }
    if (fate) *fate = last;
    return passed;
}

const char *sgt_fate_text(sgt_fate fate)
{
    switch (fate) {
    case SGT_PASSED: return "passed";
    case SGT_CLIPPED: return "clipped";
    case SGT_TIR: return "tir";
    case SGT_MISSED: return "missed";
    case SGT_LOST: return "lost";
    }
    return "?";
}

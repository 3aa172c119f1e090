// SPDX-License-Identifier: MIT
/* trace.h - one ray at one element: the arithmetic that the single trace and the batch share.
 *
 * The inline functions have no branches but those that an element decides for all rays alike.  So a loop
 * around them becomes vector code.  If such a formula cannot answer, it says so, and sgt_pass does.
 *
 * WHERE THE RAY IS.  Between elements the point is kept as base + offset.  base is the origin of the
 * element just passed (at launch, of the first element).  offset is in global axes, but small.  The next
 * element sees (base - its origin) + offset.  Both terms are of the size of the lens, wherever in the
 * world the lens stands.  At 1e9 from the global origin, a sum of base and offset would lose 1e-7 at every
 * surface. Only the ray that is returned is added up.
 *
 * THE LAUNCH may be far away all the same.  There an ulp of the distance puts the ray aside in three
 * operations: a turn, a subtraction that is not exact, making the direction of unit length.  If one of
 * them is needed, the launch point is first moved along the ray to its foot, the point nearest the first
 * element's origin, with error-free sums and products.  o - origin + t0 d is right to an ulp of what is
 * left of it, whatever t0 is; d is the direction as given.  t0 (as a length) is added again to the t of
 * the first hit, and of the steps that a watcher sees on the way to it.
 *
 * THE BENDING (Spencer & Murty 1962, J. Opt. Soc. Am. 52, 672; there by components, here in vectors).  Let
 * d be the direction, n the gradient as the surface gives it, G = n . n, g = d . n, r = n1 / n2.  The part
 * of d along the surface is multiplied by r.  The part along n fills the length up to one:
 *
 *     d' = r d + f n,   G f^2 + 2 r g f = 1 - r^2 = k.
 *
 * The root that goes on through the surface is, without a subtraction of like numbers,
 *
 *     f = k / (r g + sign(g) sqrt(D)),   D = (r g)^2 + k G.
 *
 * D / G = Q = 1 - r^2 s^2, with s the sine of incidence.  D < 0 is total internal reflection.  k is
 * computed as (n2 - n1) (n2 + n1) / n2^2.  There are two forms of D:
 *
 *     k >= -1/2   D = (r g)^2 + k G.  For k >= 0 it is right to a few roundings.  For k < 0 it cancels near
 *                 the limit, where (r g)^2 is |k| G.  That costs little while |k| is small, at any incidence
 *     k < -1/2    D = G - r^2 |d x n|^2.  It is of no use at grazing incidence between like indices.  But
 *                 these are not alike, and total reflection comes before
 *
 * In either form the rounding of Q is a few 2^-53 of 1 (at most 12 have been observed).  An error of
 * an ulp or two in the angle of incidence has the same effect.  A mirror: d' = d - 2 (g / G) n.
 *
 * This takes one square root and one quotient a ray; n is never normalised.  One Newton step brings d' to
 * unit length within 2^-52.  If it began farther off than 2^-25, the indices are too unlike for doubles,
 * and the ray is lost.  A direction that is of unit length to 2^-50 is left as it is, to the bit, by a
 * change of frame.  So is one that passes between equal indices.
 *
 * t_err AND p_err ARE THOSE OF THE RAY AS GIVEN, not of the ray that the surface is shown.  The given ray
 * is the launch ray, or the doubles of the passage before: p, direction.  Rounding puts the shown ray
 * aside.  At the root, points of the two with the same t are at most e apart.  To first order the roots
 * then differ by
 *
 *     |n . e| / |n . d|,
 *
 * with n the gradient.  The parts of e follow; u = 2^-53, and |.| is the sum of the absolute components:
 *
 *     u |o_i| in each coordinate      a sum, base - origin and the offset; or a launch moved to its foot
 *     what base - origin has lost     exact, the same for all rays
 *     3 u |offset|, 3 u |o|           a product with the axes of the element before, or of this one: each of
 *                                     its three roundings is at most u times a vector no longer than this
 *     (3 + 1) u |t| for each of them  the same for the direction, and making it of unit length
 *     2 u |d_i t| in each coordinate  making the direction of a launch: a product, a correction
 *     4 u |t| at a launch that turns  lengths along the axes are off by 2^-51
 *
 * A launch ray that needs none of it is shown as it is.  Besides, t counts lengths: if |d|^2 - 1 = x, t is
 * off by |t x| / 2.  x is computed from -1 on, and off by u times each sum on the way.
 *
 * The second order is the first one squared, times the curvature over the cosine of incidence.  A
 * sixteenth is added for it.  That is enough down to |n . d| = 2^-22 |n|, if radii of curvature are an
 * eighth of |o| + |t| or more.  Below that, 2^-22 |n| replaces n . d: there the given ray may as well miss
 * the surface, or meet it twice. */
#ifndef SGT_SYSTEM_TRACE_H
#define SGT_SYSTEM_TRACE_H
#include "../surface/sag/sag.h"
#include "aperture.h"
#include <sagitta/system.h>

/* ------------------------------------------------------------------ vectors */

SGT_INLINE sgt_vec3 plus(sgt_vec3 a, sgt_vec3 b) { return (sgt_vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
SGT_INLINE sgt_vec3 minus(sgt_vec3 a, sgt_vec3 b) { return (sgt_vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
SGT_INLINE sgt_vec3 times(double a, sgt_vec3 b) { return (sgt_vec3){a * b.x, a * b.y, a * b.z}; }
SGT_INLINE bool is_zero(sgt_vec3 a) { return a.x == 0 && a.y == 0 && a.z == 0; }
SGT_INLINE double largest(sgt_vec3 a) { return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z))); }
SGT_INLINE double dot(sgt_vec3 a, sgt_vec3 b) { return sgt_fma(a.x, b.x, sgt_fma(a.y, b.y, a.z * b.z)); }

/* a b - c d within 2 ulps (Kahan; Jeannerod, Louvet & Muller 2013, Math. Comp. 82, 2245). */
SGT_INLINE double difference_of_products(double a, double b, double c, double d)
{
    double w = c * d, e = sgt_fma(-c, d, w);
    return sgt_fma(a, b, -w) + e;
}

/* ---------------------------------------------------------------- unit length */

/* The most that plain normalising leaves of |d|^2 - 1; below it nothing can be gained. */
static const double UNIT = 0x1p-50;
static const double NEAR_UNIT = 0x1p-25; /* from here one Newton step leads to 3/8 of UNIT */

/* |a|^2 - 1 within 2^-52, for |a| near 1: each fma rounds a number of at most 1. */
SGT_INLINE double excess(sgt_vec3 a) { return sgt_fma(a.x, a.x, sgt_fma(a.y, a.y, sgt_fma(a.z, a.z, -1))); }

/* d made of unit length by one Newton step for 1/sqrt, e the excess: |d|^-1 = 1 - e/2 + 3/8 e^2 - ... */
SGT_INLINE sgt_vec3 corrected(sgt_vec3 d, double e)
{
    double by = -0.5 * e;
    return (sgt_vec3){sgt_fma(by, d.x, d.x), sgt_fma(by, d.y, d.y), sgt_fma(by, d.z, d.z)};
}

/* The same, but a direction of unit length stays as it is.  (So does a component of -0: the 0 in x + 0 x
 * is positive.) */
SGT_INLINE sgt_vec3 kept_unit(sgt_vec3 d, double e) { return corrected(d, fabs(e) <= UNIT ? -0.0 : e); }

/* ------------------------------------------------------------------- launch */

/* One coordinate of (o - origin) + t0 d, right to an ulp of the sum. */
SGT_INLINE double moved(double o, double origin, double t0, double d)
{
    return twofold_sum(two_sum(o, -origin), two_product(t0, d)).hi;
}

/* Can the launch point stay, because a sum is all that is needed from there?  No if anything is not
 * finite. */
SGT_INLINE bool stays(sgt_vec3 o, sgt_vec3 d, sgt_vec3 origin, bool turned)
{
    double lost = fabs(two_sum(o.x, -origin.x).lo) + fabs(two_sum(o.y, -origin.y).lo) +
                  fabs(two_sum(o.z, -origin.z).lo);
    return lost == 0 && fabs(excess(d)) <= (turned ? -1 : UNIT);
}

/* A ray before its first element, seen from that element, with d of unit length.  It begins t0 (a length)
 * behind its launch.  t0 is -0 only if the ray was left as it is (stays).  A foot at the launch itself has
 * +0. */
typedef struct launched { sgt_vec3 offset, d; double t0; } launched;

SGT_INLINE launched launch_from(sgt_vec3 o, sgt_vec3 d, sgt_vec3 origin, bool turned)
{
    double e = excess(d);
    sgt_vec3 q = minus(o, origin), v = times(scale_of(d), d); /* v is exact */
    double length = sqrt(dot(v, v)), inverse = 1 / length, t0 = dot(q, v) * inverse * -inverse;
    sgt_vec3 made = times(inverse, v), kept = kept_unit(d, e);
    made = corrected(made, excess(made));
    bool near = fabs(e) <= NEAR_UNIT, stay = stays(o, d, origin, turned);
    sgt_vec3 foot = {moved(o.x, origin.x, t0, v.x), moved(o.y, origin.y, t0, v.y),
                     moved(o.z, origin.z, t0, v.z)};
    q = plus(q, (sgt_vec3){0, 0, 0}); /* no -0 */
    return (launched){.offset = {stay ? q.x : foot.x, stay ? q.y : foot.y, stay ? q.z : foot.z},
                      .d = {near ? kept.x : made.x, near ? kept.y : made.y, near ? kept.z : made.z},
                      .t0 = stay ? -0.0 : t0 * length + 0.0};
}

/* A hit seen from the launch; NaN stays NaN.  t_err takes what t as one double cannot hold, and the
 * rounding of t0: a dot product (1.5 of it in a root), that root, and a product. */
typedef struct hit_place { double t, t_lo, t_err; } hit_place;

SGT_INLINE hit_place from_launch(double t0, hit_place h)
{
    twofold t = two_sum(t0, h.t);
    return (hit_place){t.hi, h.t_lo + t.lo, (h.t_err + fabs(t.lo) + 4 * SGT_U * fabs(t0)) * (1 + 4 * SGT_U)};
}

/* -------------------------------------------------------------------- poses */

/* Each component of to_local and to_global is off by at most 3 u |a|; so may the axes be. */
SGT_INLINE bool is_turned(const sgt_pose *pose)
{
    return !(is_zero(pose->ex) && is_zero(pose->ey) && is_zero(pose->ez));
}
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

/* Is there no clear aperture?  Also true for NaN, which is_sound rejects. */
SGT_INLINE bool is_open(double semi_diameter) { return !(semi_diameter > 0 && semi_diameter < NO_RIM); }

/* The t_tol of a trace, in lengths:
 *
 *     with an aperture        32 ulps of it.  A point is not known better than that, and t over a thin gap
 *                             need not be.  If the launch point's coordinates are less, 32 ulps of these: an
 *                             aperture may be set to 1e10, to stand for none
 *     without one (open)      32 ulps of the distance at which the ray passes the vertex, |o x d|.  That is
 *                             about what an aperture would have to be, and not more if the ray comes from
 *                             afar */
SGT_INLINE double tolerance(bool open, double semi_diameter, sgt_vec3 o, sgt_vec3 d)
{
    if (open) {
        double by = largest((sgt_vec3){o.y * d.z - o.z * d.y, o.z * d.x - o.x * d.z, o.x * d.y - o.y * d.x});
        return by < HUGE_VAL ? 0x1p-48 * by : 0; /* 0 for NaN */
    }
    double far = largest(o);
    return 0x1p-48 * (far < semi_diameter ? far : semi_diameter);
}

/* ------------------------------------------------------------- the ray as given */

/* By how much an element's frame puts a ray aside: the factors of e in the head of this file. */
typedef struct aside { double own, made, offset, o, way; sgt_vec3 lost; } aside;

/* turned: the element's frame; turned_before: that of the element before. */
SGT_INLINE aside aside_of(sgt_vec3 base, sgt_vec3 origin, bool turned, bool first, bool turned_before)
{
    const double u = SGT_U * (1 + 0x1p-4);
    aside a = {.own = u, .made = first ? 2 * u : 0};
    a.offset = turned_before ? 3 * u : 0, a.o = turned ? 3 * u : 0;
    a.way = (turned ? first ? 8 * u : 4 * u : 0) + (turned_before ? 4 * u : 0);
    if (first) return a; /* base is the origin */
    a.lost.x = fabs(two_sum(base.x, -origin.x).lo);
    a.lost.y = fabs(two_sum(base.y, -origin.y).lo);
    a.lost.z = fabs(two_sum(base.z, -origin.z).lo);
    return a;
}

SGT_INLINE bool was_moved(double t0) { return copysign(1, t0) > 0 || t0 < 0; }
SGT_INLINE double absolute(sgt_vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }
SGT_INLINE double bounded(double a) { return a > 0x1p900 ? 0x1p900 : a < -0x1p900 ? -0x1p900 : a; }

/* A ray that an element has met: its offset in front (state), and in the element's frame o, d, the gradient
 * and t. */
typedef struct met_ray { sgt_vec3 offset, o, d, n; double t; } met_ray;

/* What is added to t_err and p_err because the ray was put aside.  turns: the element's frame or the one
 * before is turned.  moved: 0 for a launch ray that stays, else 1. */
typedef struct widening { double t, p; } widening;

SGT_INLINE widening widening_by(aside a, bool first, bool turns, double moved, met_ray ray)
{
    const sgt_vec3 o = ray.o, d = ray.d, n = ray.n;
    const double t = ray.t;
    double own = a.own * moved, made = a.made * moved * fabs(t), anywhere = 0;
    sgt_vec3 e = {own * fabs(o.x), own * fabs(o.y), own * fabs(o.z)};
    if (first) e = plus(e, (sgt_vec3){made * fabs(d.x), made * fabs(d.y), made * fabs(d.z)});
    else e = plus(e, a.lost);
    if (turns) anywhere = a.o * absolute(o) + a.way * fabs(t) + (first ? 0 : a.offset * absolute(ray.offset));
    sgt_vec3 normal = {bounded(n.x), bounded(n.y), bounded(n.z)}; /* a component may be infinite */
    sgt_vec3 size = {fabs(normal.x), fabs(normal.y), fabs(normal.z)};
    double all = size.x + size.y + size.z, slope = larger(fabs(dot(normal, d)), 0x1p-22 * all);
    double slip = (dot(e, size) + anywhere * all) / slope;
    double z = sgt_fma(d.z, d.z, -1), yz = sgt_fma(d.y, d.y, z), xyz = sgt_fma(d.x, d.x, yz); /* excess */
    double longer = 0.5 * (fabs(xyz) + SGT_U * (fabs(z) + fabs(yz) + fabs(xyz))) * fabs(t);
    double more = (slip + longer) * (1 + 8 * SGT_U);
    double apart = (absolute(e) + anywhere + slip) * (1 + 8 * SGT_U);
    return (widening){more > 0 ? more : 0, apart > 0 ? apart : 0}; /* NaN: no normal */
}

/* --------------------------------------------------------- aperture and path */

/* The square of the clear aperture.  If that would be lost to underflow, the square of the aperture times
 * 2^900, made negative.  Nothing is inside a negative square to the loops; is_inside decides then. */
SGT_INLINE double aperture2_of(double semi_diameter)
{
    double aperture2 = rim2_of(semi_diameter), large = 0x1p900 * semi_diameter;
    return rim_in_range(aperture2) ? aperture2 : -rim2_of(large);
}

SGT_INLINE bool is_inside(sgt_vec3 p, double aperture2)
{
    if (aperture2 < 0) p.x *= 0x1p900, p.y *= 0x1p900, aperture2 = -aperture2;
    return !(p.x * p.x + p.y * p.y > aperture2);
}

/* That square, or one that holds all points whose squares are lost. */
SGT_INLINE double aperture2_around(double aperture2) { return aperture2 < 0 ? TINY : aperture2; }

/* Is a root outside the aperture, or an undecided answer, worth another search?  It is on the chord of the
 * ray with the aperture's cylinder (cut_to_chord).  The chord is made longer by 2^-20 at both ends, so
 * that a root on the rim is not taken for the start of the ray (sgt_ray).  Then r^2 alone tells roots
 * inside from roots outside.  If cut_to_chord is false there is no other root: the ray is beside the
 * cylinder, or along it, or out of range. */
SGT_INLINE bool is_worth_more(sgt_status status)
{
    return status != SGT_MISS && status != SGT_STOPPED && status != SGT_INVALID;
}

/* Is it a root near the seed, and was that asked for? */
SGT_INLINE bool is_near(sgt_status status, const sgt_options *opt)
{
    return status == SGT_HIT && opt->pick == SGT_NEAR_SEED;
}

SGT_INLINE bool cut_to_chord(sgt_ray *ray, double aperture2)
{
    /* beside a large z, x and y might be too small to square */
    sgt_ray flat = {.o = ray->o, .d = {ray->d.x, ray->d.y, 0}};
    stretch chord = sgt_chord(&flat, aperture2_around(aperture2));
    double more = 0x1p-20 * (chord.hi - chord.lo);
    ray->tmin = chord.lo - more, ray->tmax = chord.hi + more;
    return chord.lo < chord.hi && more < HUGE_VAL;
}

/* After that answer on the chord, may a root be inside?  A user's surface without `enclose`, without a
 * proof, is marched along; a march that has found nothing is UNPROVEN wherever it is.  Then the ray is
 * reported by the root outside. */
SGT_INLINE bool may_be_inside(sgt_surface s, const sgt_options *opt, sgt_status status)
{
    bool searched = opt->proof != SGT_ESTIMATE || s.ops->own_ || s.ops->enclose;
    return status < 0 && (searched || status == SGT_STOPPED || status == SGT_EXHAUSTED);
}

/* path + index (t + t_lo), off by some u^2 of the magnitudes: not of the sum, which may cancel. */
SGT_INLINE twofold longer(twofold path, double index, double t, double t_lo)
{
    twofold more = two_product(index, t), sum = two_sum(path.hi, more.hi);
    return quick_two_sum(sum.hi, sum.lo + (path.lo + sgt_fma(index, t_lo, more.lo)));
}

/* The hit that is meant on such a chord; *inside is set if it is inside.  A root where the chord is longer
 * than the aperture does not hide another. */
sgt_hit sgt_ask_inside(sgt_surface surface, sgt_ray chord, double aperture2, const sgt_options *opt,
                       bool *inside);

/* ------------------------------------------------------------------ bending */

/* How an element bends all rays alike: not at all, back, or on, with D in one of its two forms; or by its
 * phase, as an ideal lens (phase.h) or in waves (waves.h). */
typedef enum bend_kind { STRAIGHT, BACK, ON, ON_BY_SINE, BY_PHASE, BY_WAVES } bend_kind;
typedef struct bending { bend_kind kind; double r, k; } bending;

SGT_INLINE bending bending_of(double n1, double n2, bool mirror)
{
    double r = n1 / n2, k = (n2 - n1) / n2 * ((n2 + n1) / n2);
    return (bending){mirror ? BACK : n1 == n2 ? STRAIGHT : k >= -0.5 ? ON : ON_BY_SINE, r, k};
}

/* The direction behind the surface, and G, D and the excess it was made with. */
typedef struct bent { sgt_vec3 d; double G, D, e; } bent;

SGT_INLINE bent bent_by(bend_kind kind, double r, double k, sgt_vec3 d, sgt_vec3 n)
{
    bent b = {.G = dot(n, n), .D = 0};
    double g = dot(d, n), f;
    if (kind == BACK) {
        r = 1, f = -2 * g / b.G;
    } else {
        double rg = r * g;
        if (kind == ON) {
            b.D = sgt_fma(k, b.G, rg * rg);
        } else {
            sgt_vec3 c = {difference_of_products(d.y, n.z, d.z, n.y),
                          difference_of_products(d.z, n.x, d.x, n.z),
                          difference_of_products(d.x, n.y, d.y, n.x)};
            b.D = sgt_fma(-r * r, dot(c, c), b.G);
        }
        f = k / (rg + copysign(sqrt(b.D), g));
    }
    b.d = (sgt_vec3){sgt_fma(f, n.x, r * d.x), sgt_fma(f, n.y, r * d.y), sgt_fma(f, n.z, r * d.z)};
    b.e = excess(b.d);
    b.d = corrected(b.d, b.e);
    return b;
}

/* No square of a component that matters is lost or infinite; false for NaN. */
SGT_INLINE bool in_range(double G) { return G >= 0x1p-200 && G <= 0x1p200; }

/* `if_so` if the bending is good, else 0; 0 for NaN.  Selects only, no branches. */
SGT_INLINE double where_good(bent b, double if_so)
{
    double a = b.G >= 0x1p-200 ? if_so : 0, c = b.G <= 0x1p200 ? a : 0, d = b.D >= 0 ? c : 0;
    return fabs(b.e) <= NEAR_UNIT ? d : 0;
}

/* ------------------------------------------------------------ a ray on its way */

/* The ray is at base + offset, in global axes, t0 behind its launch. */
typedef struct state {
    sgt_vec3 base, offset, d;
    double t0;       /* first element only: how far the launch point was moved; -0: not */
    bool first, turned; /* before the first element; the element just passed is turned */
    double index;    /* of the medium the ray is in */
    twofold path;    /* the sum of index * length so far */
} state;

SGT_INLINE bool is_index(double index) { return index > 0 && index < HUGE_VAL; }
SGT_INLINE double index_behind(const sgt_element *e, double n1)
{
    return e->index == 0 || e->index == SGT_MIRROR ? n1 : e->index;
}

/* Does the element ask for nothing that later versions may have? */
SGT_INLINE bool is_plain(const sgt_element *e)
{
    return ROOM_IS_ZERO(e);
}

/* Are the numbers of the element valid (sgt_trace)?  Is it plain, are its aperture and its phase sound: that
 * is asked apart. */
SGT_INLINE bool is_sound(const sgt_element *e, double n1)
{
    return is_index(n1) && is_index(index_behind(e, n1)) && e->semi_diameter >= 0;
}

SGT_INLINE bool is_aperture_sound(const sgt_element *e)
{
    return !e->aperture || sgt_aperture_sound(e->aperture);
}

/* Does an item of its aperture clip a ray that is met at p?  The element is sound. */
SGT_INLINE bool is_obstructed(const sgt_element *e, sgt_vec3 p)
{
    return e->aperture && sgt_aperture_clips(e->aperture, p.x, p.y) >= 0;
}

/* Sets *at to the ray before its first element (NULL: there is none).  false: the ray is not valid. */
bool sgt_launch(const sgt_ray *ray, const sgt_element *first, double index, state *at);

/* Takes the ray through one element.  sound: it is plain, its aperture and its phase are sound.  Sets
 * *passage, and *at if the ray passes.  If met is not NULL, it is the answer of the surface on the ray's
 * line; its lo, hi and f are not read. */
sgt_fate sgt_pass(const sgt_element *e, bool sound, state *at, const sgt_options *opt, const sgt_hit *met,
                  sgt_passage *passage);

/* The passage of a ray without a hit, with the status `why`. */
sgt_passage sgt_not_met(sgt_status why);

/* Write what is wanted of ray i. */
SGT_INLINE void tell_vector(double *const out[3], size_t i, sgt_vec3 a)
{
    if (out[0]) out[0][i] = a.x, out[1][i] = a.y, out[2][i] = a.z;
}

SGT_INLINE void tell_number(double *out, size_t i, double a) { if (out) out[i] = a; }

SGT_INLINE void tell_passage(const sgt_passages *out, size_t i, const sgt_passage *p)
{
    put_hit(&out->hits, i, &p->hit);
    tell_vector(out->direction, i, p->direction);
    tell_number(out->opl, i, p->opl);
}

#endif

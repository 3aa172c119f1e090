// SPDX-License-Identifier: MIT
/* system.h - rays through a row of surfaces, in the order given: a lens.
 *
 * Every function may run in any number of threads on the same elements.  Nothing is
 * allocated. */
#ifndef SAGITTA_SYSTEM_H
#define SAGITTA_SYSTEM_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* -------------------------------------------------------------------- elements */

/* Takes local coordinates to global: p = origin + x ex + y ey + z ez. */
typedef struct sgt_pose {
    sgt_vec3 origin;      /* length */
    sgt_vec3 ex, ey, ez;  /* axes: of unit length and at right angles.  All zero: no turn,
                             and no cost */
} sgt_pose;

/* The pose at `origin` whose axes are the global ones turned by Rz Ry Rx.  The angles are
 * in degrees, right-handed.  Multiples of 90 are exact. */
SGT_API sgt_pose sgt_pose_tilted(sgt_vec3 origin, sgt_vec3 degrees);

/* The cosines and sines of n angles, within 0.65 ulp and the same bits on every system.
 * cosine[i] and sine[i] are, to the bit, ex.x and ex.y of sgt_pose_tilted by degrees[i]
 * about z.  They are NaN if the angle is not finite.  The arrays must not overlap. */
SGT_API void sgt_turns(size_t n, const double degrees[], double cosine[], double sine[]);

/* ------------------------------------------------------------------- apertures */

/* The shape of an item of an aperture, and the members that it needs.  x and y are seen
 * from its centre, along axes that are turned by `degrees`. */
typedef enum sgt_aperture_shape {
    SGT_CIRCLE = 1,  /* radius */
    SGT_ANNULUS,     /* radius and inner, at most radius: between the two circles */
    SGT_RECTANGLE,   /* half: |x| <= half.x and |y| <= half.y */
    SGT_ELLIPSE,     /* half: its half axes along x and y */
    SGT_POLYGON,     /* count, at least 3, and vertices in order, either way round.  It
                        need not be convex.  If sides cross each other, a point is inside
                        where a line from it to far outside crosses an odd number */
    SGT_SPIDER       /* arms, width, length: strips from the centre outward, at equal
                        angles, the first along x */
} sgt_aperture_shape;

typedef struct sgt_vec2 { double x, y; } sgt_vec2;

/* One item.  Lengths are in the element's frame.  Sizes are 0 or above, and may be
 * infinite.  Members that its shape has no use for are not read. */
typedef struct sgt_aperture_item {
    sgt_aperture_shape shape;
    bool            obscuring;  /* false: what is outside of it is clipped.  true: what
                                   is inside of it (a spider: usually) */
    sgt_vec2        centre;     /* at most 2^500 in magnitude */
    double          degrees;    /* the turn about the centre, from x toward y, finite.
                                   Multiples of 90 are exact */
    double          radius, inner;  /* circle, annulus */
    sgt_vec2        half;           /* rectangle, ellipse */
    const sgt_vec2 *vertices;       /* polygon: seen from the centre, at most 2^500 in
                                       magnitude */
    size_t          count;          /* polygon: of vertices */
    int             arms;           /* spider: 1 to 64 */
    double          width;          /* spider: of an arm, from side to side */
    double          length;         /* spider: of an arm, from the centre.  0: no end */
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_aperture_item;

/* A list of items.  Each clips by itself: a ray passes if no item clips it.  The list and
 * what it points to stay the caller's, and may serve many elements.  Example:
 *
 *     sgt_vec2 corners[] = {{-3, -2}, {3, -2}, {3, 2}, {0, 3}, {-3, 2}};
 *     sgt_aperture_item items[] = {
 *         {.shape = SGT_POLYGON, .vertices = corners, .count = 5, .degrees = 30},
 *         {.shape = SGT_CIRCLE, .radius = 0.8, .obscuring = true},
 *         {.shape = SGT_SPIDER, .arms = 3, .width = 0.1, .obscuring = true},
 *     };
 *     sgt_aperture stop = {.count = 3, .items = items};
 *     sgt_conic plane = {0};
 *     sgt_element e = {.surface = {&sgt_conic_ops, &plane}, .aperture = &stop};
 *
 * WHERE IT IS JUDGED.  At the point that is met, by its x and y in the element's frame,
 * whatever its z.  Items do not change which root is meant, as semi_diameter does.  If an
 * item clips that root, the ray is clipped, even if another root would pass.  Nor does a
 * proof (options.proof) know of them.
 *
 * EDGES ARE SOFT.  A point on an edge passes, from either side.  So does one that is
 * beyond it by at most
 *
 *     2^-45 of radius + |centre.x| + |centre.y|    circle, annulus, with its own radius
 *     2^-45 of |x - centre.x| + |y - centre.y|     the others, along the axes of the item
 *              + |centre.x| + |centre.y|           or of the arm
 *     2^-500 and 2^-45 of that side's |x| + |y|    more, a polygon; in any direction
 *
 * The inner end of an arm is not an edge: what is on it is inside of the arm.  A centred
 * circle clips the points that a semi_diameter of its radius clips. */
typedef struct sgt_aperture {
    size_t count;                    /* 0: no item.  Below 2^31 */
    const sgt_aperture_item *items;
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_aperture;

/* ---------------------------------------------------------------------- phases */

typedef enum sgt_phase_kind {
    SGT_IDEAL_LENS = 1,
    SGT_PHASE_SAG,       /* W = s(x, y), the sag of the surface `waves` */
    SGT_PHASE_FUNCTION,  /* W = F(x, y, z) of the surface `waves` */
    SGT_FACETS           /* no phase: the facets of a Fresnel surface, with the slopes of
                            the sag of the surface `waves` */
} sgt_phase_kind;

/* Bounds of a user's W for proofs of sgt_aim; of the built-in sags and formulas they are
 * known, and of a quadric; of other built-in bodies and level sets they are not.  Without
 * bounds such proofs are
 * undecided at the phase.
 *
 *     self      of `waves`
 *     box       x, y and z
 *     gradient  written: each derivative of W lies in it, all over the box, whatever
 *               rounding does here
 *     second    the same of the second derivatives: xx, xy, xz, yy, yz, zz
 *
 * Returns false if it does not know, or W may be undefined in the box. */
typedef bool sgt_waves_bounds(const void *self, const sgt_interval box[3],
                              sgt_interval gradient[3], sgt_interval second[6]);

/* What an element does to light instead of, or besides, refraction by its surface.
 *
 * AN IDEAL LENS is thin and without aberration: PARAXIAL of OpticStudio.  Its surface is
 * meant to be a plane, sgt_conic {0}.  A ray is met there at (x, y), comes with the
 * direction (l, m, n), and goes on by its slopes in the element's frame, u = l / |n| and
 * v = m / |n|:
 *
 *     n2 u' = n1 u - x / f,    n2 v' = n1 v - y / f,    f = focal_length
 *
 * n1 and n2 are the indices in front and behind.  n keeps its sign.  So f > 0 focuses
 * parallel light, whichever way along z it goes.  From afar the focus is n2 f behind.
 * If index is SGT_MIRROR, n2 = n1, and n changes its sign.  l and m are those that the
 * ray would have behind such a lens without the mirror.
 *
 * THE PATH.  opl is that of an ideal image.  Rays that come from one point of the object
 * plane have the same opl from there to its image, that of the ray through the vertex.
 * The object plane is at object_distance in front of the vertex, on the side the light
 * comes from; below 0 it is behind (the light converges to it).  From afar, an object
 * point is a direction, and opl is counted from a wavefront through the vertex.  The same
 * holds behind the lens if the image is at infinity.  For rays from other planes opl
 * follows from this, and is not that of an image.  The ray's place and direction do not
 * depend on it.
 *
 * The path is added at the point that is met.  With w = (u, v), w' that behind, the same
 * with 0 for the ray through the vertex, p = (x, y) and S(w) = sqrt(1 + w^2) it is
 *
 *     W = n2 p . (w' + w0') / (S(w') + S(w0')) - n1 p . (w + w0) / (S(w) + S(w0)),
 *     w0 = w - p / object_distance,    n2 w0' = n1 w0.
 *
 * W > 0 makes opl longer.  On the axis, from afar, it is nearly -p^2 / (2 f).  The
 * passage's opl has W in it if the ray passed the element.
 *
 * ROUNDING.  A component of the direction behind is off by at most 2^-50, if |n| is 2^-50
 * n1 / n2 or more.  W is off by at most 2^-47 of
 *
 *     (p^2 / |f| (1 + |n2 - n1| / n2) + |n2 - n1| |p|) (1 + |p| / (n2 |f|))
 *
 * apart from what x, y and the direction in front are off by; opl is then rounded once.
 * t_err and p_err are those of the hit.  If n is so small that W overflows, opl is not
 * finite.
 *
 * On a surface that is not a plane, (x, y) is that of the point, slopes are changed there
 * as above, and W is that of a plane: paths are not equal then.
 *
 * TWO POWERS.  If focal_length_y is not 0, f is focal_length along x and focal_length_y
 * along y: PARAX_XY of OpticStudio.  One of them may be infinite: a cylinder.  W is the
 * formula above with these slopes.  It makes paths equal for the rays of the two
 * sections, y = 0 and x = 0, from a point there to its line focus.  The rays between them
 * are those of no wavefront (the field of directions has a curl of order x y), so that no
 * path could be right for all: there W is a convention of this library, for a ray
 * parallel to the axis -(x^2 / fx + y^2 / fy) / (1 + S(w')).  In ROUNDING |f| is the
 * shorter one.
 *
 * A PHASE IN WAVES is what a grating, a diffractive lens or a hologram adds.  At a point
 * of the surface it is W waves, a function of the point in the element's frame.  W is
 * given as a surface: `waves` is not met, its function is read.
 *
 *     SGT_PHASE_SAG       W = s(x, y), of a sag F = z - s(x, y): those of surfaces.h, a
 *                         sgt_formula_sag, or a user's.  z of the point has no say
 *     SGT_PHASE_FUNCTION  W = F(x, y, z): a sgt_formula, or a user's surface
 *
 * So a grating of 600 lines per length across y is the sgt_polynomial_xy of 600 y, or the
 * formula "600*y".  Terms of r^2 are a sgt_even_asphere, Zernike's a sgt_zernike, and a
 * hologram of two points is a formula of two roots.  Coefficients are in waves.
 * semi_diameter, a ball or a box of `waves` are not read.
 *
 * The eikonal jumps by S = per_wave W.  per_wave is the order times the vacuum
 * wavelength, in the unit of the lens.  With N the unit normal, G = per_wave grad W, and
 * (.)_t the part along the surface, a ray goes on along d':
 *
 *     t = n1 d_t + G_t,    n2 d' = t +- sqrt(n2^2 - |t|^2) N,    opl grows by S.
 *
 * The sign is the one that goes on through the surface (by d . N), or for SGT_MIRROR,
 * with n2 = n1, the one that goes back.  S > 0 is more path.  S that falls outward
 * converges.  (Welford 1975, Opt. Commun. 14, 322.)  If |t| > n2 there is no such ray:
 * SGT_EVANESCENT; sgt_phase_at says for which per_wave there would be.
 *
 * ROUNDING.  G is off by what `value` of `waves` is off by, and two roundings.  t is off
 * by at most 2^-50 (n1 + |G|) more, which moves d' by 1 / (n2 cosine) times that, the
 * cosine that of the angle behind.  The fate is right, unless |t| is that near to n2.  S
 * is off by per_wave times the rounding of F.
 *
 * SGT_LOST, SGT_UNDEFINED is a ray where W or its gradient is NaN.
 *
 * FACETS, of a Fresnel surface: FRESNELS of OpticStudio.  The ray is met where the
 * surface of the element is, a plane as a rule.  There it is refracted, or reflected, by
 * the normal (-s_x, -s_y, 1) of the sag z = s(x, y) of `waves`, in lengths; per_wave is
 * not read.  So facets are infinitely fine, and have no height.  Behind them there is no
 * wavefront: the steps between facets are of no known height, and the field of directions
 * is no gradient of a path.  opl is NaN from there on, and so is its error.
 *
 * SGT_TIR: the facet reflects totally.  SGT_LOST, SGT_UNDEFINED: the ray would meet the
 * facet from behind, or would not leave the surface on the side that it should.  A
 * component of the direction behind is off by 2^-50 n1 / (n2 cosine) at most, besides
 * what the slopes of s are off by; the cosine is that of the angle behind to the
 * facet. */
typedef struct sgt_phase {
    sgt_phase_kind kind;
    double focal_length;     /* of an ideal lens: length, 2^-500 to 2^500 in magnitude.
                                With focal_length_y that along x, and may be infinite */
    double object_distance;  /* of an ideal lens: length, as above.  0 or infinite: from
                                afar.  Else 2^-500 to 2^500 in magnitude */
    sgt_surface waves;       /* of a phase in waves: W, as above; of facets: their sag.
                                It needs `value`; for derivatives `second`, for errors
                                `rounding` */
    double per_wave;         /* of a phase in waves: length, finite.  0: no phase */
    sgt_waves_bounds *bounds; /* of waves that are a user's; NULL: none are known */
    double focal_length_y;   /* of an ideal lens: as focal_length, along y, or infinite
                                (but not both).  0: the same as along x */
    unsigned long long reserved_[2]; /* leave it zero */
} sgt_phase;

/* The index of a mirror.  Indices stay positive behind it. */
#define SGT_MIRROR (-1.0)

/* A surface in a row.  Members that are left zero have their defaults: at the origin, not
 * turned, the index as in front, no aperture.  Example:
 *
 *     sgt_conic front = {.c = 1 / 22.0}, back = {.c = -1 / 435.0};
 *     sgt_element lens[] = {
 *         {.surface = {&sgt_conic_ops, &front}, .index = 1.62, .semi_diameter = 9.5},
 *         {.surface = {&sgt_conic_ops, &back}, .pose = {.origin = {0, 0, 3}},
 *          .index = 1},
 *     };
 */
typedef struct sgt_element {
    sgt_surface surface;        /* parameters in the element's own frame */
    sgt_pose    pose;           /* of that frame */
    double      index;          /* refractive index behind it, above 0 and finite.
                                   SGT_MIRROR: it reflects.  0: as in front */
    double      semi_diameter;  /* of the clear aperture, length; soft by a part in 2^44.
                                   0, or 2^500 and more: none.  It also says which root
                                   is meant (sgt_trace) */
    const sgt_aperture *aperture; /* what else clips at the point that is met.  NULL:
                                     nothing */

    const sgt_phase *phase;       /* NULL: it refracts or reflects.  Else what it does to
                                     light.  It may serve many elements */

    unsigned long long reserved_[6]; /* leave it zero: else a ray that comes here is
                                        SGT_LOST with hit.status SGT_INVALID */
} sgt_element;

/* What became of a ray at an element.  Negative is undecided, as everywhere.  One byte,
 * alone and in arrays. */
typedef enum SGT_ONE_BYTE sgt_fate {
    SGT_PASSED  =  1,
    SGT_CLIPPED =  2,  /* met outside the clear aperture and certainly not inside it.  For
                          a user's surface without `enclose`, and without a proof: no root
                          was found inside.  Or met where an item of `aperture` clips */
    SGT_TIR     =  3,  /* total internal reflection */
    SGT_EVANESCENT = 4, /* a phase in waves asks for a direction that there is not: this
                           order does not exist for the ray (sgt_phase_at) */
    SGT_MISSED  =  0,  /* the surface is certainly not on the ray's line */
    SGT_LOST    = -1   /* hit.status says why */
} sgt_fate;

/* "passed", "clipped", "tir", "evanescent", "missed" or "lost". */
SGT_API const char *sgt_fate_text(sgt_fate fate);

/* ------------------------------------------------------------------- one ray */

/* An element as a ray met it, in the element's own frame.
 *
 * WHICH RAY t_err IS ABOUT.  For the first element it is the launch ray as given, with a
 * direction of any length.  For the others it is the ray from hit.p of the passage
 * before, along the direction of that passage: these very doubles, taken from frame to
 * frame by the axes and origins as stored.  The surface is shown that ray as rounded into
 * its frame.  What the rounding does to the root is in t_err, lo, hi and p_err.
 *
 * WHERE IT IS LESS.  If the ray nearly touches, |n . d| < 2^-22 |n|, that effect is
 * included only in part: the given ray may as well have two roots nearby, or none.
 * status, fate and what a proof says are about the rounded ray.  t_err of a graze is
 * also as good as its first order.
 *
 * LENGTHS.  hit.t is the length along the ray from the element before, or from its start
 * (ray->o) at element 1, in the unit of the lens, however long ray->d is.  Axes whose
 * length is 1 to rounding change lengths by 2^-51: the first t is of the global frame,
 * the others are of that of their element. */
typedef struct sgt_passage {
    sgt_hit  hit;        /* hit.t is a length (LENGTHS above) */
    sgt_vec3 direction;  /* behind the surface, of unit length; zero unless passed */
    double   opl;        /* the sum of index * length from the launch to here.  A stretch
                            travelled backwards (t < 0) is negative.  What phases add is
                            in it */
    unsigned long long reserved_[2];
} sgt_passage;

/* Traces a ray through the elements e[0], e[1] ... in this order.  Returns how many it
 * passed: `elements` is all of them.  (n counts rays, here and everywhere.)
 *
 *     ray           in: the launch ray.  The whole line of it is traced; tmin and tmax
 *                   are not read.  At return: it starts at the last point passed, in the
 *                   global frame, with a direction of unit length
 *     index_before  the refractive index in front of e[0]; 0: 1
 *     passages      NULL, or room for all.  passages[i] says how e[i] was met, the one
 *                   that stopped the ray included.  It is stored before a watcher
 *                   (options.watch) hears of an evaluation at the next element
 *     fate          NULL, or what became of the ray at last
 *     opt           NULL, or the options
 *
 * WHICH ROOT.  Of the roots on the line the one near the surface's own guess is taken,
 * unless options.pick says otherwise.  The guess is span.seed.  If a user's surface gives
 * none, the guess is the point of the line that is nearest the origin of the surface's
 * frame.  If that root lies outside the clear aperture and another lies inside, the one
 * inside is taken.
 *
 * A PROOF (options.proof) is asked for at each root.  With SGT_PROVE_FIRST the root has
 * to be the only accepted one within the clear aperture; without an aperture, on the
 * line.  A ray for which that cannot be said is SGT_LOST, UNPROVEN.  (With options.pick
 * SGT_FIRST it is as sgt_intersect has it.)
 *
 * SGT_LOST with hit.status SGT_INVALID: a bad ray; an index that is negative (but
 * SGT_MIRROR) or not finite; an aperture with an item that is not as its shape needs it
 * (NaN, a negative size, inner > radius, fewer than 3 vertices, an unknown shape); a
 * phase of an unknown kind, with a length out of range, or with `waves` that has no
 * `value`, is a built-in surface with an invalid parameter, or is no sag where it has to
 * be; a member for later versions that is not zero.  sgt_explain_trace says which.
 *
 * SGT_LOST with SGT_UNDEFINED: no normal at the point, or no direction behind it, as the
 * indices are too unlike; at an ideal lens, a direction along its plane (n = 0). */
SGT_API size_t sgt_trace(size_t elements, const sgt_element e[], double index_before,
                         sgt_ray *ray, sgt_passage passages[], sgt_fate *fate,
                         const sgt_options *opt);

/* What clips at a point. */
enum {
    SGT_BY_NONE          = -1,
    SGT_BY_SEMI_DIAMETER = -2,
    SGT_BY_UNSOUND       = -3  /* semi_diameter or aperture is not as it has to be */
};

typedef struct sgt_clipping {
    int    by;     /* the index of the first item that clips, or one of those above */
    double size;   /* the number that was judged (sgt_clipped_by); 0: nothing clips.
                      NaN: unsound */
    double limit;  /* the number that `size` is beyond; 0 and NaN as for `size` */
    unsigned long long reserved_[2];
} sgt_clipping;

/* What of an element clips the point p, the hit.p of a passage; only x and y are read.
 * The semi_diameter comes first, then the items in order.
 *
 *     semi_diameter   size: the distance from the origin; limit: semi_diameter
 *     circle          size: the distance from the centre; limit: radius
 *     annulus         size: the same; limit: radius or inner, whichever it is beyond; of
 *                     an obscuring one the nearer
 *     the others      size: how far the point is beyond the edge, above 0; limit: 0
 *
 * For those others, the distance is taken
 *
 *     rectangle   from the line of a side: of a point outside the largest, of one inside
 *                 (the item obscures) the least
 *     ellipse     from the edge, to first order; if that is not defined, from the middle
 *                 of a side of the box about it
 *     polygon     from the nearest side
 *     spider      of a point outside: as for a rectangle, from the nearest arm.  Of one
 *                 inside: from the sides and the outer end of the arm that the point is
 *                 deepest in */
SGT_API sgt_clipping sgt_clipped_by(const sgt_element *e, sgt_vec3 p);

/* A phase in waves as it acts on one ray. */
typedef struct sgt_phased {
    double   waves;          /* W */
    sgt_vec3 gradient;       /* of W, 1/length */
    double   along, limit;   /* |t| and n2: it passes if along is less */
    sgt_interval per_wave;   /* the ray passes with the per_wave inside of this, to some
                                roundings of its ends: an order with order * wavelength.
                                lo > hi: with none */
    unsigned long long reserved_[2];
} sgt_phased;

/* What the phase of e does to a ray that comes along d, of unit length and in the
 * element's frame, and meets e as `hit` (p and n are read).
 *
 *     index_before  the refractive index in front of e; 0: 1
 *
 * All is NaN if e has no phase in waves, or it is not sound. */
SGT_API sgt_phased sgt_phase_at(const sgt_element *e, double index_before, sgt_vec3 d,
                                const sgt_hit *hit);

/* ------------------------------------------------------------------ many rays */

/* What became of many rays.  An array that is NULL is not wanted. */
typedef struct sgt_traced {
    sgt_fate *fate;         /* as sgt_trace has it */
    int      *passed;       /* how many elements the ray passed */
    double   *o[3], *d[3];  /* the ray at return, as sgt_trace leaves it.  These may be
                               the arrays the rays came in.  Give all three of one, or
                               none */
    double   *opl;          /* at the last point passed; 0: there is none; NaN: a bad
                               ray */
    unsigned long long reserved_[2]; /* leave it zero: else every ray is SGT_LOST, with
                                        hit.status SGT_INVALID */
} sgt_traced;

/* One element as many rays met it.  An array that is NULL is not wanted.  If a ray did
 * not reach the element: status SGT_MISS, evals 0, the direction zero, all else NaN. */
typedef struct sgt_passages {
    sgt_hits hits;
    double  *direction[3], *opl;
    unsigned long long reserved_[2]; /* leave it zero, and that of hits: as sgt_traced */
} sgt_passages;

/* sgt_trace of n rays, each bit for bit the same (a NaN for a NaN).  Returns how many
 * rays passed all elements.
 *
 *     elements      how many there are in e
 *     index_before  the refractive index in front of e[0]; 0: 1
 *     n             how many rays; each array of rays, out and passages has n numbers
 *     rays          the launch rays, global frame; o is a length, tmin and tmax are not
 *                   read
 *     out           written: what became of each ray
 *     passages      NULL, or one entry for each element
 *     opt           NULL, or the options
 *
 * Rays are taken through all elements some hundred at a time, in the processor's cache.
 * If options.watch is set, they run one by one, in order; sgt_step.ray is then the index
 * of the ray.  Nothing is allocated; the stack needed is below 80 KiB. */
SGT_API size_t sgt_trace_batch(size_t elements, const sgt_element e[],
                               double index_before, size_t n, sgt_rays rays,
                               sgt_traced out, const sgt_passages passages[],
                               const sgt_options *opt);

/* Why are rays SGT_LOST with SGT_INVALID?  As sgt_explain_intersect: false, and `error`
 * names the first argument that makes no sense, an element by its place from 0.  `out`
 * and `passages` are those of a batch, or NULL. */
SGT_API bool sgt_explain_trace(size_t elements, const sgt_element e[],
                               double index_before, const sgt_ray *ray,
                               const sgt_options *opt, const sgt_traced *out,
                               const sgt_passages passages[], sgt_error *error);

#ifdef __cplusplus
}
#endif
#endif

// SPDX-License-Identifier: MIT
/* analysis.h - what a designer looks at: the rays of a field through a lens and where
 * they end, spots, wavefronts, and the curves of a field.  Part of sagitta_lens.
 *
 * Lengths are in the unit of the lens, angles in degrees, wavelengths in micrometres.
 *
 * THREADS AND PARTS.  Functions that take a const launcher may run in any number of
 * threads, if its allocator may.  The answer for a ray depends on that ray alone, so rays
 * may be traced in parts; sums over rays are exact, and rounded once.  Bits do not depend
 * on threads or parts.
 *
 *     sgt_launcher *from = sgt_launcher_new(lens, NULL, &error);
 *     sgt_field_beam beam;
 *     sgt_launch_field(from, lens->field_kind, &lens->field[0], &beam, &error);
 *     sgt_trace_pupil(from, &beam, lens->element, lens->index_before,
 *                     &(sgt_pupil_rays){n, at, end}, NULL, &error);
 *     sgt_spot spot = sgt_spot_of(1, &(sgt_ends){n, end, 1}, NULL);
 *     sgt_launcher_free(from); */
#ifndef SAGITTA_ANALYSIS_H
#define SAGITTA_ANALYSIS_H
#include <sagitta/aim.h>
#include <sagitta/lens.h>
#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------- the rays of a field */

/* A lens and its pupil, from which rays are launched. */
typedef struct sgt_launcher sgt_launcher;

/* Zeros are the defaults. */
typedef struct sgt_launcher_options {
    const sgt_allocator *allocator; /* NULL: malloc.  It lasts as long as the launcher */
    const sgt_lens_aim  *aim;       /* NULL: as the lens says */
    double wavelength;              /* um, at which pupil and fields are defined if the
                                       lens has no primary wavelength.  0: none */
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_launcher_options;

/* The lens has to last as long as the launcher.  NULL: `error` (may be NULL) says why:
 * no memory, or (aimed at the real stop) the marginal ray does not get there.
 *
 * THE PUPIL is that of the first-order data: the paraxial image of the stop in object
 * space, of the size that the lens defines. */
SGT_API sgt_launcher *sgt_launcher_new(const sgt_lens *lens,
                                       const sgt_launcher_options *opt,
                                       sgt_error *error);
SGT_API void          sgt_launcher_free(sgt_launcher *from); /* NULL: nothing */

/* The first-order data by which rays are launched. */
SGT_API const sgt_first_order *sgt_launcher_data(const sgt_launcher *from);

/* The rays of one field.  z is global. */
typedef struct sgt_field_beam {
    bool     finite;        /* all start at `object`; else all run along `direction`, and
                               start on one plane wavefront, in front of all surfaces */
    sgt_vec3 object, direction;
    double   pupil, radius; /* z and semi-diameter of the entrance pupil */
    double   cone;          /* the slope of the marginal rays of a telecentric object;
                               else 0 */
    double   front, wave;   /* a z in front of the pupil and of all surfaces; the
                               wavefront is the plane direction . p = wave */
    sgt_vec2 shift, scale;  /* of the pupil, by vignetting */
    sgt_vec2 turn;          /* the cosine and sine of its turn, by vignetting */
    unsigned long long reserved_[4];
} sgt_field_beam;

/* Sets the beam of a field.
 *
 *     kind   what field->x and field->y are
 *     field  degrees or lengths, as `kind` says, and the vignetting
 *     beam   written
 *
 * Before vignetting, chief rays go through the centre of the pupil:
 *   angles a, b        slopes tan a in x, tan b in y: a positive field climbs
 *   object heights     from that point
 *   paraxial heights   the slope or the object that paraxial rays bring there
 *   real heights       the chief ray that meets the image there, as the lens aims
 *                      (whatever aim the launcher was given)
 * false: `error` (may be NULL) names the key that is missing or does not fit. */
SGT_API bool sgt_launch_field(const sgt_launcher *from, sgt_field_kind kind,
                              const sgt_lens_field *field, sgt_field_beam *beam,
                              sgt_error *error);

/* The ray through x, y of the unit circle of the paraxial entrance pupil.  Vignetting
 * does not count. */
SGT_API sgt_ray sgt_field_ray(const sgt_field_beam *beam, double x, double y);

typedef struct sgt_launched {
    sgt_ray   ray;
    sgt_aimed status; /* SGT_MET: there it is.
                         SGT_NO_SUCH_RAY: proven, there is none.  See WHAT IS PROVEN
                         SGT_AIMED_UNDECIDED: none was found, and it is not proven that
                         there is none */
    bool      folded; /* neighbouring rays reach the stop in reversed order.  So the pupil
                         folds back on itself here, and another ray of the field may
                         reach the same point */
    sgt_vec2  wanted; /* if the lens is aimed at the stop: the point of the stop, in its
                         frame */
    /* Unless SGT_MET: */
    double    within;     /* proven: there is none with |u|, |v| <= within, in radii of
                             the paraxial entrance pupil; 0: not proven */
    sgt_attempt nearest;  /* the search that came nearest, with u and v in these radii */
    unsigned long long reserved_[4];
} sgt_launched;

/* The rays of a field through points of the pupil, after vignetting.
 *
 *     beam             of the field (sgt_launch_field)
 *     e, index_before  the lens at the wavelength of the rays (sgt_lens_at)
 *     count, at        the points, in the unit circle
 *     out              written: `count` rays
 *
 * If the lens is aimed at the stop they meet e[stop] there (sgt_aim).  A telecentric
 * object has a cone in the pupil's place: u, v are slopes, in units of its marginal
 * ray's.
 *
 * WHAT IS PROVEN.  A ray that is found may be clipped: apertures do not count.  The rays
 * of a field have no bound, so the search has one: some hundred pupil radii.
 * SGT_NO_SUCH_RAY covers all rays of the field except those that a rim clips before they
 * are bent (sgt_beam_bounds).  The ray through the point 0, 0 is searched for among these
 * as well: it is a reference even if it is clipped.  If no rim bounds the rays,
 * SGT_NO_SUCH_RAY is never the answer: the status is SGT_AIMED_UNDECIDED, and `within`
 * says which part holds no such ray.
 *
 * false: `error` (may be NULL) says why, such as no memory. */
SGT_API bool sgt_launch_rays(const sgt_launcher *from, const sgt_field_beam *beam,
                             const sgt_element e[], double index_before, size_t count,
                             const sgt_pupil_point at[], sgt_launched out[],
                             sgt_error *error);

/* The same rays by column, of a launcher that does not aim (SGT_LENS_AIM_PUPIL): all are
 * there, none is folded, and no element is needed.
 *
 *     count, at  the points, in the unit circle
 *     o, d       written: three arrays each, of `count` numbers; o is a length
 *
 * false: the launcher aims, or as sgt_launch_rays; then nothing is set. */
SGT_API bool sgt_launch_columns(const sgt_launcher *from, const sgt_field_beam *beam,
                                size_t count, const sgt_pupil_point at[],
                                double *const o[3], double *const d[3]);

/* ------------------------------------------------------------------- where rays end */

typedef struct sgt_ray_end {
    double     px, py, weight; /* of the point of the pupil */
    sgt_aimed  aimed;    /* unless SGT_MET, no ray was traced */
    sgt_fate   fate;     /* SGT_LOST also where none was traced */
    sgt_status status;   /* of the hit at the element where it ended; SGT_EXHAUSTED where
                            no ray was traced */
    size_t     element;  /* which, from 0; the last if it passed */
    bool       folded;
    bool       proven;   /* passed, with a hit (not a graze) at every element.  If a proof
                            was asked for, every one of these hits is proven */
    int        evals;
    double     t_err;    /* the largest of its elements */
    double     condition; /* the largest 1 / cos of its angles of incidence: a surface
                             off along its normal moves t by that factor */
    /* Where it met the last element, and its direction in front of it, in that frame; NaN
     * unless it passed. */
    sgt_vec3 p, d;
    double   opl;        /* from the object, or the common wavefront, to p: a phase of the
                            last element is not in it */
    /* Bounds, to first order: how far x and y of p are off (infinite: not known), and the
     * path to the foot of a perpendicular from a fixed point near p (sgt_trace_error).
     * opl is off by more, as p moves.  The rounding of the launch ray is in them. */
    double p_err, opl_err;
    /* A bound on the error of d, an angle in radians.  NaN unless the lens is afocal or
     * sgt_trace_chief set it. */
    double d_err;
    double within;       /* unless aimed is SGT_MET: as in sgt_launched */
    unsigned long long reserved_[4];
} sgt_ray_end;

/* Points of the pupil, and the ends of the rays through them. */
typedef struct sgt_pupil_rays {
    size_t count;
    const sgt_pupil_point *at; /* `count` points, in the unit circle */
    sgt_ray_end *end;          /* written: `count` ends */
} sgt_pupil_rays;

/* Traces the rays of a field through points of the pupil.
 *
 *     beam             of the field (sgt_launch_field)
 *     e, index_before  the lens at the wavelength of the rays (sgt_lens_at)
 *     rays             the points and the ends
 *     opt              NULL, or for sgt_trace
 *
 * false: `error` (may be NULL) says why. */
SGT_API bool sgt_trace_pupil(const sgt_launcher *from, const sgt_field_beam *beam,
                             const sgt_element e[], double index_before,
                             const sgt_pupil_rays *rays, const sgt_options *opt,
                             sgt_error *error);

/* sgt_trace_pupil of one ray, the chief ray: it goes through the point 0, 0 of the pupil,
 * and nothing clips it, since it is a reference even if it is obscured.
 *
 *     out  written: one end
 */
SGT_API bool sgt_trace_chief(const sgt_launcher *from, const sgt_field_beam *beam,
                             const sgt_element e[], double index_before,
                             sgt_ray_end *out, sgt_error *error);

/* For an afocal image space: sets out[i] to end[i], with angles in place of the point.
 * p.x and p.y are the angles of d from `axis`, in milliradians: toward x of the frame of
 * the last element, and across x and the axis.  `axis` is of unit length, in that frame.
 * p.z is 0, and p_err bounds the error of either angle, in milliradians.  out may be
 * end. */
SGT_API void sgt_ends_as_angles(const sgt_vec3 *axis, size_t count,
                                const sgt_ray_end end[], sgt_ray_end out[]);

/* ---------------------------------------------------------------------------- spots */

/* Rays of one field and wavelength, with the weight of that wavelength. */
typedef struct sgt_ends { size_t count; const sgt_ray_end *end; double weight; } sgt_ends;

typedef struct sgt_spot {
    size_t   rays, passed;
    sgt_vec2 reference;            /* distances are from here */
    double   rms, rms_x, rms_y;    /* root of the weighted mean of squares */
    double   geometric;            /* the largest distance */
    double   error;                /* a bound on what rounding does to rms */
    unsigned long long reserved_[4];
} sgt_spot;

/* The spot of some groups of rays together, in the frame of the last element.  A ray
 * weighs as its point of the pupil times its group.  reference: NULL, the centroid; what
 * is given is taken as exact.  With no ray that passed and weighs, or a reference that is
 * NaN, all lengths are NaN. */
SGT_API sgt_spot sgt_spot_of(size_t groups, const sgt_ends group[],
                             const sgt_vec2 *reference);

/* The radius of the first dark ring of the Airy disc, 1.21966989 lambda N, with the
 * wavelength and the answer in the same unit. */
SGT_API double sgt_airy_radius(double wavelength, double working_f_number);

/* ----------------------------------------------------------------------- wavefronts */

/* The kinds of surface to which paths are compared. */
typedef enum sgt_reference_kind {
    SGT_REFERENCE_SPHERE,   /* about `centre`, through the exit pupil */
    SGT_REFERENCE_INFINITE, /* the same of infinite radius, where the exit pupil is at
                               infinity: in the limit paths go to the foot of the
                               perpendicular from the centre on the ray */
    SGT_REFERENCE_PLANE     /* for light that leaves as parallel rays: a plane through
                               the centre, across the chief ray */
} sgt_reference_kind;

/* The surface to which paths are compared. */
typedef struct sgt_reference {
    sgt_reference_kind kind;
    sgt_vec3 centre;  /* where the chief ray met the last element, in its frame */
    sgt_vec3 along;   /* the direction of the chief ray there */
    double   radius;  /* positive: the centre lies in the direction of the light */
    double   index;   /* of the image space */
    double   opl, opl_err, p_err; /* of the chief ray */
    unsigned long long reserved_[4];
} sgt_reference;

/* The reference of a chief ray that passed.  The radius is the distance from the centre
 * to the axial point of the paraxial exit pupil (Welford 1986, 7.1), taken on the z axis
 * of the last element, which bends no light here.
 *
 *     data             first-order data at the primary wavelength
 *     e, index_before  the lens at the wavelength of the ray (sgt_lens_at)
 *     chief            as sgt_trace_chief left it
 *     afocal           take a plane, not a sphere
 *     out              written; lengths in the unit of the lens
 *
 * false: the chief ray did not pass, as `error` says. */
SGT_API bool sgt_reference_of(const sgt_lens *lens, const sgt_first_order *data,
                              const sgt_element e[], double index_before,
                              const sgt_ray_end *chief, bool afocal, sgt_reference *out,
                              sgt_error *error);

/* The optical path of a ray up to the reference, less that of the chief ray; a length.
 * Positive: the ray's path is longer.  *error (may be NULL): a bound, to first order, on
 * what rounding does to it.  NaN: the ray did not pass, or misses the sphere. */
SGT_API double sgt_opd(const sgt_reference *of, const sgt_ray_end *end, double *error);

typedef struct sgt_wavefront {
    size_t rays, passed;
    double mean, rms;        /* weighted; the root of the mean square about the mean */
    double least, most;      /* most - least: peak to valley */
    double error;            /* a bound on what rounding does to each of the numbers */
    unsigned long long reserved_[4];
} sgt_wavefront;

/* Of path differences opd[i] +- error[i] of end[i], weighted as the points of the
 * pupil. */
SGT_API sgt_wavefront sgt_wavefront_of(size_t count, const sgt_ray_end end[],
                                       const double opd[], const double error[]);

/* Values at points of the unit circle: each array has `count` numbers, the values in any
 * unit. */
typedef struct sgt_pupil_values {
    size_t count;
    const double *x, *y, *value, *weight;
} sgt_pupil_values;

/* The least-squares fit of the first `terms` Zernike polynomials.
 *
 *     order       SGT_NOLL: the mean square of each over the circle is 1.  SGT_FRINGE:
 *                 its value at the edge is 1 (sgt_zernike of surfaces.h, `normalised` 1
 *                 and 0)
 *     terms       how many polynomials
 *     at          the values; a point with a NaN does not count
 *     coefficient [terms], written, in the unit of the values
 *     residual    NULL, or written: the root of the weighted mean square that is left
 *     allocator   NULL: malloc
 *
 * By Householder's reflections: a coefficient is good to some roundings times the
 * condition of the points.  false: no memory, or the points do not determine all
 * coefficients: `error` (may be NULL) says which. */
SGT_API bool sgt_zernike_fit(sgt_zernike_order order, size_t terms,
                             const sgt_pupil_values *at, double coefficient[],
                             double *residual, const sgt_allocator *allocator,
                             sgt_error *error);

/* --------------------------------------------------------------- sums from many places
 *
 * The same for rays that come in parts, from threads or machines: parts of any size, in
 * any order, added one by one or merged, make the same bits.
 *
 *     sgt_sums *a = sgt_sums_new(SGT_SUMS_SPOT, &about, NULL), *b = ...
 *     sgt_sums_add(a, n, end, NULL, NULL);        in one place
 *     size = sgt_sums_write(b, room, bytes);      in another, after the like
 *     sgt_sums_merge(a, b);                       of what sgt_sums_read made of bytes
 *     spot = sgt_sums_spot(a, false);
 *
 * Each sum is exact, whatever its summands, and rounded once.  Among infinities and NaN
 * their set decides: a NaN, or infinities of both signs, make it NaN. */
typedef struct sgt_sums sgt_sums;

typedef enum sgt_sums_kind {
    SGT_SUMS_SPOT = 1,       /* of points, about a given one */
    SGT_SUMS_WAVEFRONT       /* of path differences */
} sgt_sums_kind;

/* Empty sums.
 *
 *     about      of a spot: the reference, taken as exact; NULL: 0, 0
 *     allocator  NULL: malloc.  It lasts as long as the sums
 *
 * NULL: no memory. */
SGT_API sgt_sums *sgt_sums_new(sgt_sums_kind kind, const sgt_vec2 *about,
                               const sgt_allocator *allocator);
SGT_API void      sgt_sums_free(sgt_sums *sums); /* NULL: nothing */

/* Adds rays.  opd, error: of a wavefront, as for sgt_wavefront_of; else NULL. */
SGT_API void sgt_sums_add(sgt_sums *sums, size_t count, const sgt_ray_end end[],
                          const double opd[], const double error[]);

/* Adds all that `more` has.  false: it is of another kind, or about another point, and
 * nothing is added. */
SGT_API bool sgt_sums_merge(sgt_sums *sums, const sgt_sums *more);

/* What the rays so far make; sums can still be added to.
 *
 *     centroid  false: about the reference, as sgt_spot_of of one group.  true: about the
 *               centroid; `geometric` is NaN, since it needs the rays once more
 *
 * Of sums of another kind all lengths are NaN, and counts 0. */
SGT_API sgt_spot      sgt_sums_spot(const sgt_sums *sums, bool centroid);
SGT_API sgt_wavefront sgt_sums_wavefront(const sgt_sums *sums);

/* The sums as bytes, the same on every system: a head with a version, and a checksum.
 * Returns how many bytes they take; they are written only if `room` suffices. */
SGT_API size_t sgt_sums_write(const sgt_sums *sums, size_t room, unsigned char bytes[]);

/* The sums of bytes.  NULL: `error` (may be NULL) says what is wrong with them, and has
 * `name` as its file: not sums, of a later version, cut off or damaged; or no memory. */
SGT_API sgt_sums *sgt_sums_read(const char *name, size_t size,
                                const unsigned char bytes[],
                                const sgt_allocator *allocator, sgt_error *error);

/* ------------------------------------------------------------------ curves of a field */

typedef struct sgt_field_point {
    sgt_aimed aimed;             /* unless SGT_MET, no chief ray was traced */
    sgt_fate fate;               /* of the chief ray; SGT_LOST also if none was traced */
    size_t   element;            /* where it ended */
    sgt_vec2 image;              /* where it met the image */
    double   error;              /* a bound on what is off there */
    /* Along z of the image surface, from where the chief ray meets it: where rays near
     * it meet in the plane of the field and the axis, and across that plane. */
    double   tangential, sagittal;
    double   ideal;              /* the height of an image without distortion, signed
                                    along the field; NaN: there is none */
    double   distortion;         /* (height - ideal) / ideal; NaN on the axis */
    double   within;             /* unless aimed is SGT_MET: as in sgt_launched */
    /* If the lens is afocal, image, error and ideal are angles from z of the image, in
     * milliradians.  distortion compares tangents of angles; it is NaN for an object at a
     * distance.  tangential and sagittal are vergences at the image: index / distance. */
    size_t   lacks;              /* 0; or the first element, counted from 1, that bends
                                    the chief ray and has no second derivatives:
                                    tangential and sagittal are NaN then, and error is
                                    infinite */
    unsigned long long reserved_[4];
} sgt_field_point;

typedef enum sgt_distortion {
    SGT_DISTORTION_TAN,   /* efl tan(angle); of an object at a distance: magnification
                             times its height */
    SGT_DISTORTION_THETA, /* efl times the angle, in radians */
    /* The same two for an image surface that need not stand at the focus: the ideal
     * height is scaled by the height of the paraxial chief ray on its vertex plane, over
     * that at the focus.  So the distortion of a field goes to 0 towards the axis.  If
     * the lens is afocal or has no focus, they are the two above */
    SGT_DISTORTION_TAN_SURFACE,
    SGT_DISTORTION_THETA_SURFACE
} sgt_distortion;

/* Astigmatism along the real chief ray of a field, and distortion.
 *
 *     e, index_before  the lens at a wavelength (sgt_lens_at)
 *     data             first-order data at that wavelength
 *     distortion       by which definition
 *     out              written; lengths in the unit of the lens
 *
 * Foci are found by the derivatives of the trace.  If there is a plane of symmetry, they
 * are those of Coddington's equations.  If there is none, rays near the chief ray may
 * pass it on one side; the focus is then where their distance from it, measured within
 * the section, is zero.  The tangential plane of a field on the axis is along y.
 * Apertures and vignetting have no effect, so the chief ray may be obscured.
 * false: `error` (may be NULL) says why. */
SGT_API bool sgt_field_curve(const sgt_launcher *from, const sgt_field_beam *beam,
                             const sgt_element e[], double index_before,
                             const sgt_first_order *data, sgt_distortion distortion,
                             sgt_field_point *out, sgt_error *error);

/* First-order data along the real chief ray of a field (lens.h).
 *
 *     um     the wavelength, um.  NaN: the primary one; none if the lens gives none
 *     field  its number, from 1
 *     out    written; lengths in the unit of the lens
 *
 * The ray goes through the centre of the stop, or of the paraxial pupil if the object is
 * telecentric, whatever clips it.  false: *out is NaN, and `error` (may be NULL) says
 * why.  If the ray is to blame, error->file is empty. */
SGT_API bool sgt_field_parabasal(const sgt_lens *lens, double um, size_t field,
                                 sgt_parabasal *out, sgt_error *error);

#ifdef __cplusplus
}
#endif
#endif

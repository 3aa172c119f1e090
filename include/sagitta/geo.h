// SPDX-License-Identifier: MIT
/* geo.h - the Earth as surfaces: a height over the ellipsoid, a level of normal gravity,
 * a height over a geoid.
 *
 * This is a library of its own, sagitta_geo.  It is built if GeographicLib is found; link
 * both.  To sagitta these surfaces are as a user's are.
 *
 * UNITS.  All lengths are metres, in the Earth-centred Earth-fixed frame: z through the
 * north pole, x through latitude and longitude 0.  F is positive outside.
 *
 * CERTAINTY.  Each surface offers span, first, rounding and enclose.  So it is certain
 * that the first hit is the first and that a miss is one, and both can be proven.  A
 * proof rests on the error analysis in src/geo, and on GeographicLib: its up vector has
 * to be right to 1e-10, its normal gravity to 8 units of 2^-53 (observed: 3e-16, and 4).
 *
 * INVALID parameters make F NaN, and the answer negative (SGT_UNDEFINED or SGT_UNPROVEN).
 * `object` of the row in sgt_geo_builtins says what is wrong with them. */
#ifndef SAGITTA_GEO_H
#define SAGITTA_GEO_H
#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>
#ifdef __cplusplus
extern "C" {
#endif

/* The points at geodetic height h over an ellipsoid of revolution.
 *
 * F = (height of p) - h, a distance: its gradient is the up vector, of length 1, and |F|
 * is the clearance.  Inside the ellipsoid the height is that of the nearest point of it,
 * with the up vector there.
 *
 * Invalid, beyond the ranges below: a number that is not finite; h at or below -0.99 of
 * the least radius of curvature (-b^2 / a of an oblate one: -6335 km on WGS84), where the
 * surface begins to fold.  Parameters for sensitivities: h. */
typedef struct sgt_geodetic_height {
    double a;  /* equatorial radius, m; 0 ... 1e100.  0: WGS84, its f included */
    double f;  /* flattening (a - b) / a, below 1; below 0: prolate.  0 is a
                  sphere.  If a is 0, f must be 0 */
    double h;  /* height, m; at most 1e100 */
} sgt_geodetic_height;

/* The level surface of WGS84's normal gravity (Somigliana's closed form, centrifugal part
 * included) that passes through geodetic height h on the equator; h = 0 is the ellipsoid
 * itself.  Or, with potential not 0, that of normal potential U = potential.
 *
 * A level of gravity has a second sheet beyond the geostationary radius (42164 km), where
 * U, with its centrifugal part, is the same again.  That sheet is not part of this
 * surface: only the closed one about the Earth is, wherever a ray comes from.
 *
 * F = GM / U - GM / (U of the level), in metres, and nearly a distance: its gradient is 1
 * to a part in 100 at 1000 km and below.  NaN outside the sphere of 42000 km.
 * Parameters for sensitivities: h, or potential if that is given. */
typedef struct sgt_level_gravity {
    double h;          /* m; -100 km ... 10000 km.  With a potential it is 0 */
    double potential;  /* U, m^2/s^2; between that of the two ends of h.  0: by h */
} sgt_level_gravity;

/* A geoid, read from a grid; see sgt_geoid_open. */
typedef struct sgt_geoid sgt_geoid;

/* The points h above a geoid given by a grid of its heights N over WGS84:
 *     F = (geodetic height) - N(latitude, longitude) - h,
 * with latitude and longitude of the point of the ellipsoid below p.
 *
 * BETWEEN THE NODES N is by bicubic convolution (Keys 1981, a = -1/2): through every
 * height of the grid, with a continuous gradient.  So Newton's method and normals meet no
 * kinks at the lines of the grid, as they would with bilinear interpolation.  It is
 * also nearer to the geoid: GeographicLib's manual has, of a 15' grid of EGM96, a largest
 * error of 1.2 m bilinear and 0.2 m cubic.  PROJ interpolates bilinearly and differs by
 * as much.
 *
 * WHAT IS LEFT.  The curvature jumps at every line.  The surface has a real corner at
 * each pole, where the meridians' slopes meet; the gradient given there is up.  A ray
 * that touches the surface at the pole itself takes hundreds of evaluations, or spends
 * all of max_evals.  A 15' grid shows nothing below 30 km, whatever its interpolation:
 * slopes of the surface are those of the grid, not of the sea.
 * Parameters for sensitivities: h. */
typedef struct sgt_geoid_height {
    const sgt_geoid *geoid;
    double           h;  /* m; above -6000 km */
} sgt_geoid_height;

/* Reads a grid in NOAA's .gtx format that covers the globe, such as egm96_15.gtx of
 * proj-data.  This is the only function of the library that allocates.
 * NULL: it failed.  `error` (may be NULL) then names the file and what is wrong with it
 * (cut off, too long, absurd, a hole, a pole of more than one height). */
SGT_API sgt_geoid *sgt_geoid_open(const char *path, sgt_error *error);
SGT_API void       sgt_geoid_close(sgt_geoid *geoid);  /* NULL is nothing */

/* The path of egm96_15.gtx as PROJ's data are installed: in the folders of PROJ_DATA and
 * PROJ_LIB, then where PROJ was when this was built, then in the usual ones.
 * false: it is nowhere, or its path has `size` characters or more, as `error` (may be
 * NULL) says. */
SGT_API bool sgt_geoid_find(char *path, size_t size, sgt_error *error);

/* N in m, at a latitude of -90 ... 90 and a longitude, in degrees; NaN elsewhere. */
SGT_API double sgt_geoid_undulation(const sgt_geoid *geoid, double latitude,
                                    double longitude);

/* A place over an ellipsoid.  Any longitude is read; what is written is above -180 and up
 * to 180, and 0 on the axis. */
typedef struct sgt_geodetic_place {
    double latitude;      /* of the up vector, degrees north, -90 ... 90 */
    double longitude;     /* degrees east */
    double height;        /* m */
    double reserved_[2];  /* 0 */
} sgt_geodetic_place;

/* LATITUDE, LONGITUDE, HEIGHT, in and out.  `over` is the ellipsoid; its h is not used.
 * NULL is WGS84.  Heights are over the ellipsoid, also where the surface is a geoid: the
 * height over that is (height - N).  The functions have no state and can be called in
 * any thread.
 *
 * Accuracy, observed (tests/geo/test_places.cpp): near the ground points are right to
 * 3 nm and places to 3 nm; there and back keeps the height to 4 nm.  Elsewhere the
 * errors grow as a + |h|: for f = -1 ... 0.5 they were below 7 units of 2^-53 of it, for
 * f = -5 and 0.9 up to 26.  A place deeper
 * than the least radius of curvature (-6335 km on WGS84) leads to a point whose own
 * place is another one.
 *
 * NaN: a latitude or an elevation beyond +-90, a number that is not finite, an invalid
 * ellipsoid. */

/* The ellipsoid of a surface of this library, for the functions below: that of a
 * sgt_geodetic_height, with h = 0; else WGS84.  false: it is another surface.  `over`
 * may be NULL. */
SGT_API bool sgt_geodetic_ellipsoid(sgt_surface s, sgt_geodetic_height *over);

/* The ray from a place, along an azimuth (degrees, clockwise from north) and an elevation
 * (degrees above the plane square to the up vector; -90 is down).  d is of unit length to
 * 4 units of 2^-53.  At a pole azimuths count from the meridian of `longitude`. */
SGT_API sgt_ray sgt_geodetic_ray(const sgt_geodetic_height *over, sgt_geodetic_place from,
                                 double azimuth, double elevation);

/* The place of a point. */
SGT_API sgt_geodetic_place sgt_geodetic_place_of(const sgt_geodetic_height *over,
                                                 sgt_vec3 p);

/* The same of n places, by column: the same bits.  place: latitudes, longitudes, heights;
 * look: azimuths, elevations, or NULL: then d is not written and may be NULL. */
SGT_API void sgt_geodetic_rays(const sgt_geodetic_height *over, size_t n,
                               const double *const place[3], const double *const look[2],
                               double *const o[3], double *const d[3]);
SGT_API void sgt_geodetic_places(const sgt_geodetic_height *over, size_t n,
                                 const double *const p[3], double *const place[3]);

extern SGT_API const sgt_surface_ops sgt_geodetic_height_ops, sgt_level_gravity_ops,
    sgt_geoid_height_ops;

/* As sgt_builtins() (surfaces.h): "geodetic_height", "level_gravity", "geoid".  A geoid
 * is a pointer too, which no row can describe.  A reader of "geoid" opens its `file`
 * (sgt_geoid_find if none is named) and puts it in. */
SGT_API const sgt_builtin *sgt_geo_builtins(void);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_GEO_H */

// SPDX-License-Identifier: MIT
// place.cpp - latitude, longitude and height: of a point, and of where a ray begins and looks.
//
// With latitude B and longitude L the up vector is n = (cos B cos L, cos B sin L, sin B), and the place at
// height h is
//     p = N (cos B cos L, cos B sin L, (1 - e^2) sin B) + h n,  N = a / sqrt(1 - e^2 sin^2 B).
// GeographicLib's Geocentric has this as Forward, and its inverse as Reverse (Vermeille 2002; Karney 2011).
// East = (-sin L, cos L, 0) and north = n x east complete the frame, so a direction of azimuth A and
// elevation E is cos E (sin A east + cos A north) + sin E n.  sincosd reduces degrees exactly: a quarter turn
// has a sine of exactly 1, the poles lie on the axis, and longitudes 180 and -180 are one meridian.
//
// Observed by tests/geo/test_places.cpp against long double: in units of 2^-53 (a + |h|) the point is off
// by at most 3.4 on WGS84 and 4.6 elsewhere (f = -1 ... 0.5), a place by 2.9 and 3.8, the height there and
// back by 4.9 and 5.7; the direction by 2.7 units, its length by 2.5.
#include "earth.hpp"

#include <GeographicLib/Math.hpp>

namespace {

using GeographicLib::Math;

// The ellipsoid that is meant: NULL is WGS84.  false: its numbers are out of range.
bool known(const sgt_geodetic_height *over)
{
    if (!over) return true;
    if (over->a == 0) return over->f == 0;
    return over->a > 0 && over->a <= 1e100 && over->f < 1 && over->f >= -1e100;
}

struct places {
    geo::ellipsoid own;
    bool good;

    explicit places(const sgt_geodetic_height *over)
        : own(over && over->a != 0 && known(over) ? geo::ellipsoid(over->a, over->f) : geo::wgs84()),
          good(known(over))
    {
    }

    sgt_vec3 point(double latitude, double longitude, double height) const
    {
        sgt_vec3 p = {geo::nothing, geo::nothing, geo::nothing};
        if (good && std::fabs(latitude) <= 90 && std::isfinite(longitude) && std::isfinite(height))
            own.geocentric.Forward(latitude, longitude, height, p.x, p.y, p.z);
        return p;
    }

    sgt_geodetic_place place(const sgt_vec3 &p) const
    {
        sgt_geodetic_place q = {geo::nothing, geo::nothing, geo::nothing, {}};
        if (!good || !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return q;
        const geo::foot foot = own.below(p);
        q.latitude = foot.latitude, q.longitude = foot.longitude == -180 ? 180 : foot.longitude;
        q.height = foot.h; // the maximum of earth.hpp: an error of the latitude changes it by its square
        return q;
    }
};

sgt_vec3 direction(double latitude, double longitude, double azimuth, double elevation)
{
    if (!(std::fabs(latitude) <= 90 && std::isfinite(longitude) && std::isfinite(azimuth) &&
          std::fabs(elevation) <= 90))
        return {geo::nothing, geo::nothing, geo::nothing};
    double sb, cb, sl, cl, sa, ca, se, ce;
    Math::sincosd(latitude, sb, cb), Math::sincosd(longitude, sl, cl);
    Math::sincosd(azimuth, sa, ca), Math::sincosd(elevation, se, ce);
    const double east = ce * sa, north = ce * ca, outward = sgt_fma(se, cb, -north * sb); // from the axis
    return {sgt_fma(outward, cl, -east * sl), sgt_fma(outward, sl, east * cl), sgt_fma(north, cb, se * sb)};
}

} // namespace

bool sgt_geodetic_ellipsoid(sgt_surface s, sgt_geodetic_height *over)
{
    const sgt_geodetic_height *own = static_cast<const sgt_geodetic_height *>(s.self);
    const bool height = s.ops == &sgt_geodetic_height_ops;
    if (!height && s.ops != &sgt_level_gravity_ops && s.ops != &sgt_geoid_height_ops) return false;
    if (over) *over = height ? sgt_geodetic_height{own->a, own->f, 0} : sgt_geodetic_height{0, 0, 0};
    return true;
}

sgt_ray sgt_geodetic_ray(const sgt_geodetic_height *over, sgt_geodetic_place from, double azimuth,
                         double elevation)
{
    sgt_ray ray = {};
    ray.o = places(over).point(from.latitude, from.longitude, from.height);
    ray.d = direction(from.latitude, from.longitude, azimuth, elevation);
    return ray;
}

sgt_geodetic_place sgt_geodetic_place_of(const sgt_geodetic_height *over, sgt_vec3 p)
{
    return places(over).place(p);
}

void sgt_geodetic_rays(const sgt_geodetic_height *over, size_t n, const double *const place[3],
                       const double *const look[2], double *const o[3], double *const d[3])
{
    const places all(over);
    for (size_t i = 0; i < n; i++) {
        const double latitude = place[0][i], longitude = place[1][i];
        const sgt_vec3 p = all.point(latitude, longitude, place[2][i]);
        o[0][i] = p.x, o[1][i] = p.y, o[2][i] = p.z;
        if (!look) continue;
        const sgt_vec3 v = direction(latitude, longitude, look[0][i], look[1][i]);
        d[0][i] = v.x, d[1][i] = v.y, d[2][i] = v.z;
    }
}

void sgt_geodetic_places(const sgt_geodetic_height *over, size_t n, const double *const p[3],
                         double *const place[3])
{
    const places all(over);
    for (size_t i = 0; i < n; i++) {
        const sgt_geodetic_place q = all.place({p[0][i], p[1][i], p[2][i]});
        place[0][i] = q.latitude, place[1][i] = q.longitude, place[2][i] = q.height;
    }
}

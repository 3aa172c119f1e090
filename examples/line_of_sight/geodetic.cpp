// SPDX-License-Identifier: MIT
// geodetic.cpp - the two conversions of GeographicLib (Karney 2011) that are needed.
#include "geodetic.h"

#include <GeographicLib/Geocentric.hpp>

geodetic geodetic_of(sgt_vec3 p)
{
    geodetic g;
    GeographicLib::Geocentric::WGS84().Reverse(p.x, p.y, p.z, g.latitude, g.longitude, g.height);
    return g;
}

sgt_vec3 geodetic_point(geodetic g)
{
    sgt_vec3 p;
    GeographicLib::Geocentric::WGS84().Forward(g.latitude, g.longitude, g.height, p.x, p.y, p.z);
    return p;
}

// SPDX-License-Identifier: MIT
// table.cpp - the table of the surfaces about the Earth, like the library's sgt_builtins().
#include "earth.hpp"

#include <cfloat>

namespace {

constexpr sgt_param number(const char *name, std::size_t offset, int length, int time = 0)
{
    return {name, {length, 0, 0, time}, offset, 1, -DBL_MAX, DBL_MAX, SGT_PARAM_REAL, nullptr, {}};
}

const sgt_param geodetic_height[] = {number("a", offsetof(sgt_geodetic_height, a), 1),
                                     number("f", offsetof(sgt_geodetic_height, f), 0),
                                     number("h", offsetof(sgt_geodetic_height, h), 1),
                                     {}};
const sgt_param level_gravity[] = {number("h", offsetof(sgt_level_gravity, h), 1),
                                   number("potential", offsetof(sgt_level_gravity, potential), 2, -2),
                                   {}};
const sgt_param geoid[] = {number("h", offsetof(sgt_geoid_height, h), 1), {}};

const sgt_builtin builtins[] = {
    {"geodetic_height", &sgt_geodetic_height_ops, sizeof(sgt_geodetic_height), geodetic_height,
     geo::object_to_geodetic_height, nullptr, SGT_FAMILY_OTHER, nullptr, {}},
    {"level_gravity", &sgt_level_gravity_ops, sizeof(sgt_level_gravity), level_gravity,
     geo::object_to_level_gravity, nullptr, SGT_FAMILY_OTHER, nullptr, {}},
    {"geoid", &sgt_geoid_height_ops, sizeof(sgt_geoid_height), geoid, geo::object_to_geoid_height, nullptr,
     SGT_FAMILY_OTHER, nullptr, {}},
    {},
};

} // namespace

const sgt_builtin *sgt_geo_builtins(void) { return builtins; }

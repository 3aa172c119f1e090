// table.cpp - the table of the surfaces about the Earth, like the library's sgt_builtins.
#include "earth.hpp"

#include <cfloat>

namespace {

constexpr double MOST = DBL_MAX;

const sgt_param geodetic_height[] = {
    {"a", "length", offsetof(sgt_geodetic_height, a), 1, -MOST, MOST, SGT_REAL},
    {"f", "1", offsetof(sgt_geodetic_height, f), 1, -MOST, MOST, SGT_REAL},
    {"h", "length", offsetof(sgt_geodetic_height, h), 1, -MOST, MOST, SGT_REAL},
    {}};
const sgt_param level_gravity[] = {
    {"h", "length", offsetof(sgt_level_gravity, h), 1, -MOST, MOST, SGT_REAL},
    {"potential", "length^2/s^2", offsetof(sgt_level_gravity, potential), 1, -MOST, MOST, SGT_REAL},
    {}};
const sgt_param geoid[] = {{"h", "length", offsetof(sgt_geoid_height, h), 1, -MOST, MOST, SGT_REAL}, {}};

} // namespace

const sgt_builtin sgt_geo_builtins[] = {
    {"geodetic_height", &sgt_geodetic_height_ops, sizeof(sgt_geodetic_height), geodetic_height,
     geo::object_to_geodetic_height, nullptr},
    {"level_gravity", &sgt_level_gravity_ops, sizeof(sgt_level_gravity), level_gravity,
     geo::object_to_level_gravity, nullptr},
    {"geoid", &sgt_geoid_height_ops, sizeof(sgt_geoid_height), geoid, geo::object_to_geoid_height, nullptr},
    {},
};

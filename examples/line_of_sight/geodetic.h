// SPDX-License-Identifier: MIT
/* geodetic.h - latitude, longitude and height of a point, by GeographicLib, for C. */
#ifndef LINE_OF_SIGHT_GEODETIC_H
#define LINE_OF_SIGHT_GEODETIC_H
#include <sagitta/sagitta.h>
#ifdef __cplusplus
extern "C" {
#endif

/* Degrees, and metres over WGS84. */
typedef struct geodetic { double latitude, longitude, height; } geodetic;

geodetic geodetic_of(sgt_vec3 p);
sgt_vec3 geodetic_point(geodetic g);

#ifdef __cplusplus
}
#endif
#endif

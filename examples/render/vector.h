// SPDX-License-Identifier: MIT
/* vector.h - three numbers: a point, a direction, or a colour (linear light, 1 is white). */
#ifndef RENDER_VECTOR_H
#define RENDER_VECTOR_H
#include <sagitta/sagitta.h>

#include <math.h>

typedef sgt_vec3 vec3;

static inline vec3 add(vec3 a, vec3 b) { return (vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline vec3 subtract(vec3 a, vec3 b) { return (vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline vec3 scaled(vec3 a, double s) { return (vec3){s * a.x, s * a.y, s * a.z}; }
static inline vec3 along(vec3 o, double t, vec3 d) { return add(o, scaled(d, t)); }
static inline vec3 filtered(vec3 a, vec3 b) { return (vec3){a.x * b.x, a.y * b.y, a.z * b.z}; }
static inline vec3 mixed(vec3 a, vec3 b, double u) { return along(a, u, subtract(b, a)); }
static inline double dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double length(vec3 a) { return sqrt(dot(a, a)); }
static inline double largest(vec3 a) { return fmax(a.x, fmax(a.y, a.z)); }

static inline vec3 cross(vec3 a, vec3 b)
{
    return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline vec3 unit(vec3 a) { return scaled(a, 1 / length(a)); }

/* Two directions at right angles to n, which is of unit length, and to each other. */
static inline void across(vec3 n, vec3 *u, vec3 *v)
{
    *u = unit(cross(fabs(n.x) < 0.5 ? (vec3){1, 0, 0} : (vec3){0, 1, 0}, n));
    *v = cross(n, *u);
}

#endif

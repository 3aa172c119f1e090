// SPDX-License-Identifier: MIT
/* vec3.h - sums and products of vectors, and frames. */
#ifndef SGT_LENS_VEC3_H
#define SGT_LENS_VEC3_H
#include <sagitta/system.h>

#include <math.h>

static inline double dot3(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static inline double length3(sgt_vec3 a) { return sqrt(dot3(a, a)); }

/* a + t b */
static inline sgt_vec3 along3(sgt_vec3 a, double t, sgt_vec3 b)
{
    return (sgt_vec3){a.x + t * b.x, a.y + t * b.y, a.z + t * b.z};
}

static inline sgt_vec3 minus3(sgt_vec3 a, sgt_vec3 b) { return along3(a, -1, b); }

static inline sgt_vec3 cross3(sgt_vec3 a, sgt_vec3 b)
{
    return (sgt_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline sgt_vec3 unit3(sgt_vec3 a)
{
    double length = length3(a);
    return (sgt_vec3){a.x / length, a.y / length, a.z / length};
}

/* The distance of the line o + t d from the z axis. */
static inline double axis_distance3(sgt_vec3 o, sgt_vec3 d)
{
    double across = hypot(d.x, d.y);
    return across == 0 ? hypot(o.x, o.y) : fabs(o.x * d.y - o.y * d.x) / across;
}

/* Directions into the frame of an element, and out of it. */
static inline sgt_vec3 out_of3(const sgt_pose *p, sgt_vec3 a)
{
    if (dot3(p->ex, p->ex) == 0) return a;
    return along3(along3(along3((sgt_vec3){0, 0, 0}, a.x, p->ex), a.y, p->ey), a.z, p->ez);
}

static inline sgt_vec3 into3(const sgt_pose *p, sgt_vec3 a)
{
    if (dot3(p->ex, p->ex) == 0) return a;
    return (sgt_vec3){dot3(a, p->ex), dot3(a, p->ey), dot3(a, p->ez)};
}

#endif

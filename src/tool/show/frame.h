// SPDX-License-Identifier: MIT
/* frame.h - points and directions from an element's own frame to the global one (out) and back (in). */
#ifndef TOOL_FRAME_H
#define TOOL_FRAME_H
#include <math.h>
#include <stdbool.h>
#include <sagitta/system.h>

static inline double vector_dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double vector_length(sgt_vec3 a) { return sqrt(vector_dot(a, a)); }
static inline sgt_vec3 vector_along(sgt_vec3 o, sgt_vec3 d, double t) /* o + t d */
{
    return (sgt_vec3){o.x + t * d.x, o.y + t * d.y, o.z + t * d.z};
}
/* The distance of the line o + t d from the z axis. */
static inline double vector_axis_distance(sgt_vec3 o, sgt_vec3 d)
{
    double across = hypot(d.x, d.y);
    return across == 0 ? hypot(o.x, o.y) : fabs(o.x * d.y - o.y * d.x) / across;
}
static inline sgt_vec3 vector_minus(sgt_vec3 a, sgt_vec3 b) { return vector_along(a, b, -1); }

/* Is the frame turned?  Axes that are all zero mean that it is not. */
static inline bool frame_turned(const sgt_pose *pose)
{
    return vector_dot(pose->ex, pose->ex) != 0;
}

static inline sgt_vec3 frame_direction_out(const sgt_pose *pose, sgt_vec3 v)
{
    if (!frame_turned(pose)) return v;
    const sgt_vec3 *x = &pose->ex, *y = &pose->ey, *z = &pose->ez;
    return (sgt_vec3){v.x * x->x + v.y * y->x + v.z * z->x, v.x * x->y + v.y * y->y + v.z * z->y,
                      v.x * x->z + v.y * y->z + v.z * z->z};
}

static inline sgt_vec3 frame_direction_in(const sgt_pose *pose, sgt_vec3 v)
{
    if (!frame_turned(pose)) return v;
    return (sgt_vec3){vector_dot(v, pose->ex), vector_dot(v, pose->ey), vector_dot(v, pose->ez)};
}

static inline sgt_vec3 frame_point_out(const sgt_pose *pose, sgt_vec3 p)
{
    return vector_along(pose->origin, frame_direction_out(pose, p), 1);
}

static inline sgt_vec3 frame_point_in(const sgt_pose *pose, sgt_vec3 p)
{
    return frame_direction_in(pose, vector_minus(p, pose->origin));
}

#endif

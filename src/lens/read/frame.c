// SPDX-License-Identifier: MIT
/* frame.c - the running frame of a lens.
 *
 * A turn is a product of three turns about one axis each; multiples of 90 degrees are exact
 * (sgt_pose_tilted).  Each product rounds, and after many breaks the axes would no longer be of
 * unit length and at right angles.  So each is followed by one Newton step for the nearest
 * rotation, R (3 - R^T R) / 2 (Higham 2008, Functions of Matrices, 8.3), which squares the error. */
#include "frame.h"

static sgt_vec3 scaled(double a, sgt_vec3 v) { return (sgt_vec3){a * v.x, a * v.y, a * v.z}; }

static sgt_vec3 added(sgt_vec3 a, sgt_vec3 b) { return (sgt_vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }

static double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* R v: a direction of the frame, seen from outside. */
static sgt_vec3 outward(const sgt_pose *r, sgt_vec3 v)
{
    return added(added(scaled(v.x, r->ex), scaled(v.y, r->ey)), scaled(v.z, r->ez));
}

static sgt_vec3 mended(sgt_vec3 v, sgt_vec3 a, sgt_vec3 b)
{
    double own = (3 - dot(v, v)) / 2, along_a = -dot(v, a) / 2, along_b = -dot(v, b) / 2;
    return added(scaled(own, v), added(scaled(along_a, a), scaled(along_b, b)));
}

static sgt_pose axes_of(sgt_vec3 degrees)
{
    sgt_pose p = sgt_pose_tilted((sgt_vec3){0, 0, 0}, degrees);
    if (dot(p.ex, p.ex) == 0) p.ex.x = p.ey.y = p.ez.z = 1;
    return p;
}

/* The axes of a turn within a turned frame: `outer` times `inner`. */
static sgt_pose turned_by(const sgt_pose *outer, const sgt_pose *inner)
{
    sgt_pose r = {.origin = outer->origin, .ex = outward(outer, inner->ex), .ey = outward(outer, inner->ey),
                  .ez = outward(outer, inner->ez)};
    return (sgt_pose){.origin = r.origin, .ex = mended(r.ex, r.ey, r.ez), .ey = mended(r.ey, r.ez, r.ex),
                      .ez = mended(r.ez, r.ex, r.ey)};
}

static bool is_nothing(sgt_vec3 v) { return v.x == 0 && v.y == 0 && v.z == 0; }

static bool is_straight(const sgt_pose *p)
{
    return p->ex.x == 1 && p->ey.y == 1 && p->ez.z == 1 && p->ex.y == 0 && p->ex.z == 0 && p->ey.x == 0 &&
           p->ey.z == 0 && p->ez.x == 0 && p->ez.y == 0;
}

void sgt_frame_advance(running *at, double thickness)
{
    at->z += thickness;
    sgt_vec3 way = {0, 0, thickness};
    at->pose.origin = added(at->pose.origin, at->turned ? scaled(thickness, at->pose.ez) : way);
}

static void shift_by(running *at, sgt_vec3 shift)
{
    at->pose.origin = added(at->pose.origin, at->turned ? outward(&at->pose, shift) : shift);
}

static void turn_by(running *at, sgt_vec3 degrees)
{
    if (is_nothing(degrees)) return;
    sgt_pose turn = axes_of(degrees), now = at->pose;
    if (!at->turned) now.ex = now.ey = now.ez = (sgt_vec3){0, 0, 0}, now.ex.x = now.ey.y = now.ez.z = 1;
    at->pose = turned_by(&now, &turn);
    at->turned = !is_straight(&at->pose);
    if (!at->turned) at->pose.ex = at->pose.ey = at->pose.ez = (sgt_vec3){0, 0, 0};
}

void sgt_frame_break(running *at, sgt_vec3 shift, sgt_vec3 tilt, bool tilt_first)
{
    const sgt_vec3 x = {tilt.x, 0, 0}, y = {0, tilt.y, 0}, z = {0, 0, tilt.z};
    if (!tilt_first) shift_by(at, shift);
    turn_by(at, tilt_first ? z : x);
    turn_by(at, y);
    turn_by(at, tilt_first ? x : z);
    if (tilt_first) shift_by(at, shift);
}

sgt_pose sgt_frame_pose(const running *at, sgt_vec3 decenter, sgt_vec3 tilt)
{
    running own = *at;
    shift_by(&own, decenter);
    if (!at->turned) /* in one step, so that the axes are those of sgt_pose_tilted to the bit */
        return is_nothing(tilt) ? own.pose : sgt_pose_tilted(own.pose.origin, tilt);
    sgt_pose turn = axes_of(tilt);
    return is_nothing(tilt) ? own.pose : turned_by(&own.pose, &turn);
}

// SPDX-License-Identifier: MIT
/* view.c - the axes of a picture.
 *
 * right, up and toward are right-handed, so no picture is a mirror image: y-z is seen from -x, x-z from +y.
 *
 * THE VIEW IN SPACE is the y-z section, whose eye at -x is moved by BESIDE toward the light's source and by
 * ABOVE toward +y.  With s, c of the first and S, C of the second angle:
 *
 *     toward = (-C c, S, -C s),  right = (-s, 0, c),  up = toward x right = (S c, C, S s) */
#include "view.h"

#include "../show/frame.h"

#include <string.h>

static const double BESIDE = 40, ABOVE = 20; /* degrees */

static const struct {
    const char *name, *title;
} named[] = {
    [VIEW_YZ] = {"yz", "y-z section"},
    [VIEW_XZ] = {"xz", "x-z section"},
    [VIEW_3D] = {"3d", "view in space"},
};

view_axes view_of(view_plane plane)
{
    const sgt_vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
    if (plane == VIEW_YZ) return (view_axes){plane, z, y, {-1, 0, 0}};
    if (plane == VIEW_XZ) return (view_axes){plane, z, x, y};
    const double degree = atan(1) / 45;
    double s = sin(BESIDE * degree), c = cos(BESIDE * degree), S = sin(ABOVE * degree),
           C = cos(ABOVE * degree);
    return (view_axes){plane, {-s, 0, c}, {S * c, C, S * s}, {-C * c, S, -C * s}};
}

const char *view_title(view_plane plane) { return named[plane].title; }

spot view_spot(const view_axes *v, sgt_vec3 p)
{
    return (spot){vector_dot(v->right, p), vector_dot(v->up, p)};
}

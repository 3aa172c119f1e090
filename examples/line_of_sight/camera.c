// SPDX-License-Identifier: MIT
/* camera.c - the orbit, and the line of sight.
 *
 * The orbit is a circle about the centre of the Earth, run through at Kepler's rate n = sqrt(GM / r^3) and
 * fixed in inertial space (no oblateness turns its plane: a scan lasts minutes).  In the plane of the node
 * N and M = 90 degrees on from it the camera is at r (N cos u + M sin u), u = start + n t, and flies toward
 * -N sin u + M cos u.  The Earth turns below: in the frame fixed to it the node's longitude falls at the
 * rate of its rotation, and all else stays as it is.
 *
 * A line of sight is what it is at the instant of the line: the time that light takes, aberration and
 * refraction are left out (they are of the order of 1 m, 20 m and, straight down, nothing on the ground).
 *
 * The camera's line lies across the track.  It is rolled, then pitched with the craft: a pixel at an angle
 * a to the right of the middle looks along down cos(b) + right sin(b) with b = a + roll, and then all of it
 * is turned about `right`:
 *     down -> down cos(pitch) + ahead sin(pitch). */
#include "camera.h"

#include <math.h>

/* WGS84 (NIMA TR8350.2, 2000): m^3/s^2, rad/s, m. */
static const double GM = 3.986004418e14, ROTATION = 7.292115e-5, EQUATOR = 6378137;

static sgt_vec3 sum(double a, sgt_vec3 x, double b, sgt_vec3 y)
{
    return (sgt_vec3){a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z};
}

static sgt_vec3 cross(sgt_vec3 a, sgt_vec3 b)
{
    return (sgt_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

station camera_station(const camera *c, double seconds)
{
    double r = EQUATOR + c->altitude, u = c->start + sqrt(GM / r) / r * seconds,
           node = c->node - ROTATION * seconds;
    sgt_vec3 N = {cos(node), sin(node), 0};
    sgt_vec3 M = {-sin(node) * cos(c->inclination), cos(node) * cos(c->inclination), sin(c->inclination)};
    station s = {.down = sum(-cos(u), N, -sin(u), M), .ahead = sum(-sin(u), N, cos(u), M)};
    s.right = cross(s.down, s.ahead);
    s.place = sum(-r, s.down, 0, s.down);
    return s;
}

double camera_angle(const camera *c, int pixel) { return c->field * ((pixel + 0.5) / c->pixels - 0.5); }

sgt_vec3 camera_look(const camera *c, const station *s, double angle)
{
    double b = angle + c->roll;
    sgt_vec3 down = sum(cos(c->pitch), s->down, sin(c->pitch), s->ahead);
    return sum(cos(b), down, sin(b), s->right);
}

// SPDX-License-Identifier: MIT
/* camera.c - a pinhole on a Bezier path.
 *
 * The path is evaluated by de Casteljau's scheme: points between neighbours, at u of the way,
 * until one is left.  It begins at the first control point and ends at the last. */
#include "camera.h"

static vec3 bezier(const path *p, double u)
{
    vec3 point[MOST_POINTS];
    for (int i = 0; i < p->count; i++) point[i] = p->point[i];
    for (int left = p->count - 1; left > 0; left--)
        for (int i = 0; i < left; i++) point[i] = mixed(point[i], point[i + 1], u);
    return point[0];
}

bool camera_is_good(const scene *s, double u)
{
    const vec3 ahead = subtract(bezier(&s->camera.look_at, u), bezier(&s->camera.position, u));
    return length(cross(ahead, s->camera.up)) > 1e-9 * length(ahead) * length(s->camera.up);
}

view camera_at(const scene *s, double u)
{
    view v = {.eye = bezier(&s->camera.position, u)};
    vec3 ahead = unit(subtract(bezier(&s->camera.look_at, u), v.eye)),
         right = unit(cross(ahead, s->camera.up));
    double step = 2 * tan(s->camera.field / 2) / s->height; /* of a pixel, at distance 1 */
    v.right = scaled(right, step);
    v.down = scaled(cross(ahead, right), step);
    v.corner = along(along(ahead, -0.5 * s->width, v.right), -0.5 * s->height, v.down);
    return v;
}

vec3 camera_direction(const view *v, double x, double y)
{
    return unit(along(along(v->corner, x, v->right), y, v->down));
}

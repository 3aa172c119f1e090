/* scene.h - what a picture of a lens shows, in the lens's unit of length; nothing is drawn here. */
#ifndef TOOL_SCENE_H
#define TOOL_SCENE_H
#include "../job/job.h"

typedef struct spot { double z, y; } spot;   /* in the plane of the picture; z to the right */

/* A ray as it is drawn: from its start through each point that it met. */
typedef struct path {
    size_t field, count;
    spot *at;              /* [count] */
    sgt_fate fate;
} path;

enum { OUTLINE_POINTS = 65 };

/* The section x = 0 of an element, from -half to +half of its own y. */
typedef struct outline {
    spot at[OUTLINE_POINTS];
    double half;              /* half its height; 0: nothing to draw */
    /* the own y about which it is drawn; 0 unless an aperture lies beside the axis */
    double middle;
    spot up, ahead;           /* its own y and z axes in the picture */
    bool mirror, stop, dummy; /* dummy: the medium does not change, and it is not the last */
    /* [strokes], of a surface that is not a sag: its section; `half` is then 0 */
    spot (*stroke)[2];
    size_t strokes;
    spot (*blocked)[2];       /* [blocked_count]: pieces of it that the element's apertures clip */
    size_t blocked_count;
    double lens;              /* the sign of the focal length of an ideal lens; 0: it is none */
    double back;              /* +1 or -1: the side of its own z that is away from the light */
} outline;

typedef struct scene {
    const job *job;
    path *path;
    size_t paths, capacity;
    double *reach;            /* for each element: how far from its axis rays met it */
    outline *outline;         /* [job->lens.count] */
    spot low, high;           /* everything lies between these corners */
    double lead;              /* how far rays are drawn beyond the lens */
} scene;

scene scene_begin(const job *j);

/* Adds a ray.  point[0]: its start; point[i]: where it met element i - 1; in the global frame.
 * direction: used if the ray missed or was lost, to show where it was going. */
void scene_add(scene *s, size_t field, size_t points, const sgt_vec3 point[], sgt_fate fate,
               sgt_vec3 direction);

/* To be called when all rays are added: finds the outlines and the extent. */
void scene_finish(scene *s);

/* Is there glass to draw between element i and the next? */
bool scene_glass_behind(const scene *s, size_t i);

/* An end of an outline (side: 0 lower, 1 upper), moved along its own y to height `half`. */
spot scene_corner(const outline *o, int side, double half);

#endif

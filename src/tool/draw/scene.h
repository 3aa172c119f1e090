/* scene.h - what a picture of a lens shows, in lengths of the lens and without a pen. */
#ifndef TOOL_SCENE_H
#define TOOL_SCENE_H
#include "../job/job.h"

typedef struct spot { double z, y; } spot;   /* the plane of the picture; z to the right */

/* A ray as it is drawn: from where it started through each point it met. */
typedef struct path {
    size_t field, count;
    spot *at;              /* [count] */
    sgt_fate fate;
} path;

enum { OUTLINE_POINTS = 65 };

/* The section x = 0 of an element, from -half to +half of its own y. */
typedef struct outline {
    spot at[OUTLINE_POINTS];
    double half;              /* 0: there is nothing to draw */
    spot up, ahead;           /* its own y and z axes in the picture */
    bool mirror, stop, dummy; /* dummy: the medium does not change, and it is not the last */
    /* of a surface that is no sag: its section, of which the rest here knows nothing */
    spot (*stroke)[2];
    size_t strokes;
    double back;              /* the side of its own z away from the light: +1 or -1 */
} outline;

typedef struct scene {
    const job *job;
    path *path;
    size_t paths, capacity;
    double *reach;            /* how far from its axis rays met each element */
    outline *outline;         /* [job->lens.count] */
    spot low, high;           /* all of it lies between */
    double lead;              /* how far rays are drawn beyond the lens */
} scene;

scene scene_begin(const job *j);

/* A ray: point[0] is its start, point[i] where it met element i - 1; global.  Of a ray that
 * missed or was lost, direction says where it was going. */
void scene_add(scene *s, size_t field, size_t points, const sgt_vec3 point[], sgt_fate fate,
               sgt_vec3 direction);

/* When all rays are in: outlines and extent. */
void scene_finish(scene *s);

/* Is there glass to be drawn from element i to the next? */
bool scene_glass_behind(const scene *s, size_t i);

/* An end of an outline (side: 0 lower, 1 upper) carried on along its own y to height `half`. */
spot scene_corner(const outline *o, int side, double half);

#endif

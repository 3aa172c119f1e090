// SPDX-License-Identifier: MIT
/* scene.h - what a picture of a lens shows, in the lens's unit of length; nothing is drawn here. */
#ifndef TOOL_SCENE_H
#define TOOL_SCENE_H
#include "outline.h"

/* A ray as it is drawn: from its start through each point that it met. */
typedef struct ray_path {
    size_t field, wavelength, count;
    sgt_vec3 *at; /* [count], in the global frame */
    sgt_fate fate;
} ray_path;

typedef struct scene scene;
struct scene {
    const job *job;
    view_axes view;
    ray_path *path;
    size_t paths, capacity;
    sgt_footprint *reach; /* [job->lens.count] */
    outline *outline;     /* [job->lens.count] */
    sgt_vec3 low, high;   /* a box about all elements */
    spot least, most;     /* everything lies between these corners of the picture */
    double lead;          /* how far rays are drawn beyond the lens */
    bool by_wavelength;   /* colours tell wavelengths, as there are several and only one field */
    scene *others;        /* [other_count]: the lens in other configurations, drawn behind it in grey */
    size_t other_count;
    const char *configurations; /* their numbers and names; NULL: there is one lens */
};

scene scene_begin(const job *j, view_plane plane);

/* Adds a ray.  point[0]: its start; point[i]: where it met element i - 1; in the global frame.
 * direction: used if the ray missed or was lost, to show where it was going. */
void scene_add(scene *s, size_t field, size_t wavelength, size_t points, const sgt_vec3 point[],
               sgt_fate fate, sgt_vec3 direction);

/* To be called when all rays are added: finds the outlines and the extent, with that of the others. */
void scene_finish(scene *s);

/* Is there glass to draw between element i and the next? */
bool scene_glass_behind(const scene *s, size_t i);

/* Does the lens have one straight axis? */
bool scene_straight(const scene *s);

#endif

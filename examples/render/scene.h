// SPDX-License-Identifier: MIT
/* scene.h - what there is to see: plain numbers, read from a scene file (read.c). */
#ifndef RENDER_SCENE_H
#define RENDER_SCENE_H
#include "vector.h"

#include <sagitta/lens.h>
#include <sagitta/surfaces.h>

enum {
    MOST_OBJECTS = 256,  /* surfaces: whole objects, parts of others, and regions that clip */
    MOST_KNOTS = 512,
    MOST_CLIPS = 4,
    MOST_LIGHTS = 16,
    MOST_POINTS = 16,
    MOST_COLOURS = 8,
    MOST_TRACKS = 32,
    MOST_KEYS = 64,
    MOST_DEPTH = 12
};

/* A vector of a frame, in the world. */
static inline vec3 turned(const sgt_pose *p, vec3 v)
{
    return along(along(scaled(p->ex, v.x), v.y, p->ey), v.z, p->ez);
}

/* A colour that may change from place to place, in the object's own frame. */
typedef enum pattern_kind { PATTERN_PLAIN, PATTERN_CHECKS, PATTERN_BLEND } pattern_kind;
enum { BY_TRAP = 4 };
typedef struct pattern {
    pattern_kind kind;
    int count;
    vec3 colour[MOST_COLOURS];
    double size;       /* of a check */
    int by;            /* of a blend, by x, y, z, the distance from the origin (3) or a trap (BY_TRAP), */
    double from, to;   /* from here (the first colour) to there (the last) */
    double trap[4];
} pattern;

typedef struct material {
    pattern pattern;
    double diffuse, specular, shininess;  /* Phong's */
    double reflection;
    double index;      /* of refraction; 0: opaque */
    vec3 absorption;   /* of light on its way inside, per length */
} material;

typedef enum normal_kind {
    NORMAL_GRADIENT,   /* of F, as the library gives it */
    NORMAL_DIFFERENCE, /* from six more values of F */
    NORMAL_POTENTIAL   /* of the orbit continued: level sets only */
} normal_kind;

/* A surface in its place. */
typedef struct object {
    sgt_surface surface;
    sgt_pose pose;             /* own frame to world: p = origin + scale (x ex + y ey + z ez) */
    double scale;
    sgt_options options;
    normal_kind normal;
    bool sheet;                /* may end: where F falls along a ray need not be where something is entered */
    material material;
    bool bounded;              /* F > 0 wherever a ray is outside of the surface's span */
    sgt_lens *read;            /* what holds the surface's parameters, */
    union {
        sgt_julia julia;
        sgt_mandelbrot mandelbrot;
    } own;                     /* but for those of a level set, which a film may change */
    bool automatic;            /* its iterations are as many as a pixel resolves (levels.h) */
} object;

/* A tree of objects, as a row: a knot, then its first child with all that is below it, then the next
 * child. */
typedef enum operation { PART, UNION, INTERSECTION, DIFFERENCE } operation;
typedef struct knot {
    operation op;
    int object;   /* of a part: which of the scene's */
    int end;      /* the first knot that is not below this one */
} knot;

/* A body is clipped where it is not inside a ball or a box, or not inside a region, or not outside of it. */
typedef enum clip_kind { CLIP_BALL, CLIP_BOX, CLIP_INSIDE, CLIP_OUTSIDE } clip_kind;
typedef struct clip {
    clip_kind kind;
    sgt_pose pose;    /* of ball and box: own frame to world, and scale */
    double scale;
    vec3 half;        /* of a box: half its edges; of a ball: its radius, thrice */
    int knot;         /* of a region */
} clip;

/* What is met: an object, or several by their tree; and what of it is clipped away. */
typedef struct body {
    int knot;
    int first, parts;  /* the objects of the tree: a row of the scene's */
    int clips;
    clip clip[MOST_CLIPS];
} body;

typedef struct light { vec3 position, colour; double radius; } light;

/* A Bezier path: a single point stays where it is. */
typedef struct path { int count; vec3 point[MOST_POINTS]; } path;

/* A number, or a few, along a curve in time. */
typedef enum track_kind {
    TRACK_POSITION, TRACK_LOOK_AT, TRACK_FIELD, TRACK_EXPOSURE, TRACK_C, TRACK_SLICE
} track_kind;
static const char *const TRACK_NAMES[] = {"position", "look_at", "field", "exposure", "c", "slice"};
typedef struct track {
    track_kind kind;
    bool bezier;               /* values are the control points of one curve; else Catmull-Rom through them */
    int object;                /* of c and slice; -1: all that have it */
    int count;
    double time[MOST_KEYS];    /* seconds; of a Bezier curve its begin and end */
    double value[MOST_KEYS][4];
} track;
typedef struct film { int frames; double rate; int tracks; track track[MOST_TRACKS]; } film;

typedef struct scene {
    int width, height, samples, depth;
    double exposure;
    struct { path position, look_at; vec3 up; double field; } camera;  /* field: across the height, radians */
    /* haze: where 1/e of a thing is seen; 0: none */
    struct { vec3 zenith, horizon, ground; double haze; } sky;
    /* reach 0: to the sky; rays 0: no occlusion */
    struct { double strength, reach; int rays; } ambient;
    int lights, objects, knots, bodies;
    light light[MOST_LIGHTS];
    object object[MOST_OBJECTS];
    knot knot[MOST_KNOTS];
    body body[MOST_OBJECTS];
    film film;                 /* frames 0: there is none */
} scene;

#endif

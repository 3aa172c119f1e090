/* scene.h - what there is to see: plain numbers, read from a scene file (read.c). */
#ifndef RENDER_SCENE_H
#define RENDER_SCENE_H
#include "vector.h"

#include <sagitta/lens.h>

enum {
    MOST_OBJECTS = 64,
    MOST_LIGHTS = 16,
    MOST_POINTS = 16,
    MOST_COLOURS = 8,
    MOST_DEPTH = 12
};

/* A colour that may change from place to place, in the object's own frame. */
typedef enum pattern_kind { PATTERN_PLAIN, PATTERN_CHECKS, PATTERN_BLEND } pattern_kind;
typedef struct pattern {
    pattern_kind kind;
    int count;
    vec3 colour[MOST_COLOURS];
    double size;       /* of a check */
    int by;            /* of a blend, by x, y, z or the distance from the origin (3), */
    double from, to;   /* from here (the first colour) to there (the last) */
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

typedef struct object {
    sgt_surface surface;
    sgt_pose pose;             /* own frame to world: p = origin + scale (x ex + y ey + z ez) */
    double scale;
    sgt_options options;
    normal_kind normal;
    bool sheet;                /* may end: where F falls along a ray need not be where something is entered */
    material material;
    sgt_lens *read;            /* what holds the surface's parameters */
} object;

typedef struct light { vec3 position, colour; double radius; } light;

/* A Bezier path: a single point stays where it is. */
typedef struct path { int count; vec3 point[MOST_POINTS]; } path;

typedef struct scene {
    int width, height, samples, depth;
    double exposure;
    struct { path position, look_at; vec3 up; double field; } camera;  /* field: across the height, radians */
    /* haze: where 1/e of a thing is seen; 0: none */
    struct { vec3 zenith, horizon, ground; double haze; } sky;
    /* reach 0: to the sky; rays 0: no occlusion */
    struct { double strength, reach; int rays; } ambient;
    int lights, objects;
    light light[MOST_LIGHTS];
    object object[MOST_OBJECTS];
} scene;

#endif

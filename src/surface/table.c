/* table.c - the built-in surfaces as data: type, operations, parameters. */
#include "orbit.h"

#include <float.h>

#define ANY -DBL_MAX, DBL_MAX
#define CURVATURE(type) {"curvature", "1/length", offsetof(type, c), 1, ANY, SGT_REAL}
#define CONIC(type) {"conic", "1", offsetof(type, k), 1, ANY, SGT_REAL}
#define SEMI_DIAMETER(type) {"semi_diameter", "length", offsetof(type, semi_diameter), 1, 0, DBL_MAX, SGT_REAL}
#define END {0}

static const sgt_param plane[] = {SEMI_DIAMETER(sgt_conic), END};
static const sgt_param sphere[] = {CURVATURE(sgt_conic), SEMI_DIAMETER(sgt_conic), END};
static const sgt_param conic[] = {CURVATURE(sgt_conic), CONIC(sgt_conic), SEMI_DIAMETER(sgt_conic), END};
static const sgt_param asphere[] = {CURVATURE(sgt_asphere), CONIC(sgt_asphere), SEMI_DIAMETER(sgt_asphere),
                                    {"coefficients", "1/length^(2i+1)", offsetof(sgt_asphere, a), 8, ANY, SGT_REAL}, END};

#define SLICE(type)                                                                                                       \
    {"at", "1", offsetof(type, at), 4, -1e6, 1e6, SGT_VECTOR}, {"slice", "1", offsetof(type, at) + 3 * sizeof(double), 1, -1e6, 1e6, SGT_REAL}, \
    {"ex", "1/length", offsetof(type, ex), 4, -1e100, 1e100, SGT_VECTOR}, {"ey", "1/length", offsetof(type, ey), 4, -1e100, 1e100, SGT_VECTOR}, \
    {"ez", "1/length", offsetof(type, ez), 4, -1e100, 1e100, SGT_VECTOR}, {"escape", "1", offsetof(type, escape), 1, 1, 1e6, SGT_REAL},  \
    {"iterations", "1", offsetof(type, iterations), 1, 1, SGT_LEVELS, SGT_WHOLE}, {"power", "1", offsetof(type, power), 1, 2, 8, SGT_WHOLE}

static const sgt_param julia[] = {{"c", "1", offsetof(sgt_julia, c), 4, -1e6, 1e6, SGT_VECTOR}, SLICE(sgt_julia), END};
static const sgt_param mandelbrot[] = {SLICE(sgt_mandelbrot), END};

const sgt_builtin sgt_builtins[] = {
    {"plane", &sgt_conic_ops, sizeof(sgt_conic), plane, NULL},
    {"sphere", &sgt_conic_ops, sizeof(sgt_conic), sphere, NULL},
    {"conic", &sgt_conic_ops, sizeof(sgt_conic), conic, NULL},
    {"even_asphere", &sgt_asphere_ops, sizeof(sgt_asphere), asphere, NULL},
    {"julia", &sgt_julia_ops, sizeof(sgt_julia), julia, sgt_julia_object},
    {"mandelbrot", &sgt_mandelbrot_ops, sizeof(sgt_mandelbrot), mandelbrot, sgt_mandelbrot_object},
    {0},
};

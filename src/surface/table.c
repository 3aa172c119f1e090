/* table.c - the built-in surfaces as data: type, operations, parameters. */
#include <float.h>
#include <sagitta/surfaces.h>

#define ANY -DBL_MAX, DBL_MAX
#define CURVATURE(type) {"curvature", "1/length", offsetof(type, c), 1, ANY}
#define CONIC(type) {"conic", "1", offsetof(type, k), 1, ANY}
#define SEMI_DIAMETER(type) {"semi_diameter", "length", offsetof(type, semi_diameter), 1, 0, DBL_MAX}
#define END {0}

static const sgt_param plane[] = {SEMI_DIAMETER(sgt_conic), END};
static const sgt_param sphere[] = {CURVATURE(sgt_conic), SEMI_DIAMETER(sgt_conic), END};
static const sgt_param conic[] = {CURVATURE(sgt_conic), CONIC(sgt_conic), SEMI_DIAMETER(sgt_conic), END};
static const sgt_param asphere[] = {CURVATURE(sgt_asphere), CONIC(sgt_asphere), SEMI_DIAMETER(sgt_asphere),
                                    {"coefficients", "1/length^(2i+1)", offsetof(sgt_asphere, a), 8, ANY}, END};

const sgt_builtin sgt_builtins[] = {
    {"plane", &sgt_conic_ops, sizeof(sgt_conic), plane},
    {"sphere", &sgt_conic_ops, sizeof(sgt_conic), sphere},
    {"conic", &sgt_conic_ops, sizeof(sgt_conic), conic},
    {"even_asphere", &sgt_asphere_ops, sizeof(sgt_asphere), asphere},
    {0},
};

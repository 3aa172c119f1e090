/* builtins.c - the built-in surfaces as data: type, operations, parameters. */
#include "../surface/departure/departure.h"
#include "../surface/orbit/orbit.h"
#include "dispatch.h"

#include <float.h>

#define ANY_REAL -DBL_MAX, DBL_MAX
#define CURVATURE(type) {"curvature", "1/length", offsetof(type, c), 1, ANY_REAL, SGT_REAL}
#define CONIC(type) {"conic", "1", offsetof(type, k), 1, ANY_REAL, SGT_REAL}
#define SEMI_DIAMETER(type)                                                               \
    {                                                                                     \
        "semi_diameter", "length", offsetof(type, semi_diameter), 1, 0, DBL_MAX, SGT_REAL \
    }
#define END {0}

static const sgt_param plane_params[] = {SEMI_DIAMETER(sgt_conic), END};
static const sgt_param sphere_params[] = {CURVATURE(sgt_conic), SEMI_DIAMETER(sgt_conic), END};
static const sgt_param conic_params[] = {CURVATURE(sgt_conic), CONIC(sgt_conic), SEMI_DIAMETER(sgt_conic),
                                         END};
static const sgt_param asphere_params[] = {
    CURVATURE(sgt_asphere),
    CONIC(sgt_asphere),
    SEMI_DIAMETER(sgt_asphere),
    {"coefficients", "1/length^(2i+1)", offsetof(sgt_asphere, a), 8, ANY_REAL, SGT_REAL},
    END};

#define SLICE(type)                                                                      \
    {"at", "1", offsetof(type, at), 4, -1e6, 1e6, SGT_VECTOR},                           \
        {"slice", "1", offsetof(type, at) + 3 * sizeof(double), 1, -1e6, 1e6, SGT_REAL}, \
        {"ex", "1/length", offsetof(type, ex), 4, -1e100, 1e100, SGT_VECTOR},            \
        {"ey", "1/length", offsetof(type, ey), 4, -1e100, 1e100, SGT_VECTOR},            \
        {"ez", "1/length", offsetof(type, ez), 4, -1e100, 1e100, SGT_VECTOR},            \
        {"escape", "1", offsetof(type, escape), 1, 1, 1e6, SGT_REAL},                    \
        {"iterations", "1", offsetof(type, iterations), 1, 1, SGT_LEVELS, SGT_WHOLE},    \
    {                                                                                    \
        "power", "1", offsetof(type, power), 1, 2, 8, SGT_WHOLE                          \
    }

static const sgt_param julia_params[] = {
    {"c", "1", offsetof(sgt_julia, c), 4, -1e6, 1e6, SGT_VECTOR}, SLICE(sgt_julia), END};
static const sgt_param mandelbrot_params[] = {SLICE(sgt_mandelbrot), END};

#define BASE(type) CURVATURE(type), CONIC(type), SEMI_DIAMETER(type)
#define NORM(type, key, of) {key, "length", offsetof(type, of), 1, ANY_REAL, SGT_REAL}
#define LIST(type, key, unit, of, most) {key, unit, offsetof(type, of), most, ANY_REAL, SGT_LIST}
#define TABLE(type, key, unit, of, most) {key, unit, offsetof(type, of), most, ANY_REAL, SGT_TABLE}

static const sgt_param odd_asphere_params[] = {
    BASE(sgt_odd_asphere),
    {"coefficients", "1/length^i", offsetof(sgt_odd_asphere, a), 16, ANY_REAL, SGT_REAL},
    END};
static const sgt_param polynomial_xy_params[] = {
    BASE(sgt_polynomial_xy), TABLE(sgt_polynomial_xy, "coefficients", "1/length^(i+j-1)", a, 32), END};
static const sgt_param chebyshev_params[] = {BASE(sgt_chebyshev), NORM(sgt_chebyshev, "norm_x", norm_x),
                                             NORM(sgt_chebyshev, "norm_y", norm_y),
                                             TABLE(sgt_chebyshev, "coefficients", "length", a, 64), END};
static const sgt_param zernike_params[] = {
    BASE(sgt_zernike),
    NORM(sgt_zernike, "norm", norm),
    {"order", "noll|fringe", offsetof(sgt_zernike, order), 1, 1, 2, SGT_WORD},
    {"normalised", "1", offsetof(sgt_zernike, normalised), 1, 0, 1, SGT_TRUTH},
    LIST(sgt_zernike, "coefficients", "length", a, 5151),
    END};
static const sgt_param q_con_params[] = {BASE(sgt_q_con), NORM(sgt_q_con, "norm", norm),
                                         LIST(sgt_q_con, "coefficients", "length", a, 64), END};
static const sgt_param q_bfs_params[] = {CURVATURE(sgt_q_bfs), SEMI_DIAMETER(sgt_q_bfs),
                                         NORM(sgt_q_bfs, "norm", norm),
                                         LIST(sgt_q_bfs, "coefficients", "length", a, 64), END};
static const sgt_param grid_params[] = {BASE(sgt_grid), NORM(sgt_grid, "step_x", step_x),
                                        NORM(sgt_grid, "step_y", step_y),
                                        TABLE(sgt_grid, "sag", "length", z, 4096), END};
static const sgt_param sum_params[] = {
    BASE(sgt_sum), {"terms", "1", offsetof(sgt_sum, terms), 16, ANY_REAL, SGT_TERMS}, END};
static const sgt_param toroidal_params[] = {
    CURVATURE(sgt_toroidal),
    CONIC(sgt_toroidal),
    {"curvature_x", "1/length", offsetof(sgt_toroidal, c_x), 1, ANY_REAL, SGT_REAL},
    SEMI_DIAMETER(sgt_toroidal),
    {"coefficients", "1/length^(2i+1)", offsetof(sgt_toroidal, a), 8, ANY_REAL, SGT_REAL},
    END};
static const sgt_param biconic_params[] = {
    {"curvature_x", "1/length", offsetof(sgt_biconic, c_x), 1, ANY_REAL, SGT_REAL},
    {"conic_x", "1", offsetof(sgt_biconic, k_x), 1, ANY_REAL, SGT_REAL},
    {"curvature_y", "1/length", offsetof(sgt_biconic, c_y), 1, ANY_REAL, SGT_REAL},
    {"conic_y", "1", offsetof(sgt_biconic, k_y), 1, ANY_REAL, SGT_REAL},
    SEMI_DIAMETER(sgt_biconic),
    END};
static const sgt_param cylinder_params[] = {
    {"curvature", "1/length", offsetof(sgt_biconic, c_y), 1, ANY_REAL, SGT_REAL},
    {"conic", "1", offsetof(sgt_biconic, k_y), 1, ANY_REAL, SGT_REAL},
    SEMI_DIAMETER(sgt_biconic),
    END};
static const sgt_param quadric_params[] = {
    {"squares", "1", offsetof(sgt_quadric, squares), 3, ANY_REAL, SGT_VECTOR},
    {"products", "1", offsetof(sgt_quadric, products), 3, ANY_REAL, SGT_VECTOR},
    {"linear", "length", offsetof(sgt_quadric, linear), 3, ANY_REAL, SGT_VECTOR},
    {"constant", "length^2", offsetof(sgt_quadric, constant), 1, ANY_REAL, SGT_REAL},
    END};
static const sgt_param ellipsoid_params[] = {
    {"a", "length", offsetof(sgt_ellipsoid, a), 1, ANY_REAL, SGT_REAL},
    {"f", "1", offsetof(sgt_ellipsoid, f), 1, ANY_REAL, SGT_REAL},
    END};
static const sgt_param torus_params[] = {
    {"major", "length", offsetof(sgt_torus, major), 1, ANY_REAL, SGT_REAL},
    {"minor", "length", offsetof(sgt_torus, minor), 1, ANY_REAL, SGT_REAL},
    END};

/* The objections are the same in all sets of instructions. */
#define OBJECT(type) SGT_EXPORT(sgt_objection, sgt_##type##_object, (const void *self), (self))
OBJECT(julia)
OBJECT(mandelbrot) OBJECT(odd_asphere) OBJECT(polynomial_xy) OBJECT(toroidal) OBJECT(biconic) OBJECT(cylinder)
    OBJECT(zernike) OBJECT(chebyshev) OBJECT(q_con) OBJECT(q_bfs) OBJECT(grid) OBJECT(sum) OBJECT(quadric)
        OBJECT(torus) OBJECT(ellipsoid) SGT_DISPATCH_VOID(sgt_grid_prepare, (void *self), (self))

#define CATALOGUE(type)                                                                        \
    {                                                                                          \
#type, &sgt_##type##_ops, sizeof(sgt_##type), type##_params, sgt_##type##_object, NULL \
    }

            const sgt_builtin sgt_builtins[] = {
                {"plane", &sgt_conic_ops, sizeof(sgt_conic), plane_params, NULL, NULL},
                {"sphere", &sgt_conic_ops, sizeof(sgt_conic), sphere_params, NULL, NULL},
                {"conic", &sgt_conic_ops, sizeof(sgt_conic), conic_params, NULL, NULL},
                {"even_asphere", &sgt_asphere_ops, sizeof(sgt_asphere), asphere_params, NULL, NULL},
                {"julia", &sgt_julia_ops, sizeof(sgt_julia), julia_params, sgt_julia_object, NULL},
                {"mandelbrot", &sgt_mandelbrot_ops, sizeof(sgt_mandelbrot), mandelbrot_params,
                 sgt_mandelbrot_object, NULL},
                CATALOGUE(odd_asphere),
                CATALOGUE(polynomial_xy),
                CATALOGUE(toroidal),
                CATALOGUE(biconic),
                {"cylinder", &sgt_biconic_ops, sizeof(sgt_biconic), cylinder_params, sgt_cylinder_object,
                 NULL},
                CATALOGUE(zernike),
                CATALOGUE(chebyshev),
                CATALOGUE(q_con),
                CATALOGUE(q_bfs),
                {"grid", &sgt_grid_ops, sizeof(sgt_grid), grid_params, sgt_grid_object, sgt_grid_prepare},
                CATALOGUE(sum),
                CATALOGUE(quadric),
                CATALOGUE(torus),
                CATALOGUE(ellipsoid),
                {0},
};

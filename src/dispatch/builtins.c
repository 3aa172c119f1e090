// SPDX-License-Identifier: MIT
/* builtins.c - the built-in surfaces as data: sgt_builtins(), made of the rows of types.def. */
#include "dispatch.h"

#include <sagitta/surfaces.h>

#include <float.h>
#include <math.h>
#include <string.h>

#define ANY_REAL -DBL_MAX, DBL_MAX
#define ROW(...) ROW_OF(__VA_ARGS__) /* ANY_REAL is two arguments */
#define ROW_OF(key, at_0, by_i, by_j, at, most, least, greatest, of_kind, of_words) \
    {.name = key, .unit = {at_0, by_i, by_j, 0}, .offset = at, .count = most, .lo = least, .hi = greatest, \
     .kind = of_kind, .words = of_words}
#define NUMBERS(kind, type, key, of, most, at_0, by_i, by_j) \
    ROW(key, at_0, by_i, by_j, offsetof(type, of), most, ANY_REAL, kind, NULL)
#define REAL(type, key, of, length) NUMBERS(SGT_PARAM_REAL, type, key, of, 1, length, 0, 0)
#define REALS(...) NUMBERS(SGT_PARAM_REAL, __VA_ARGS__)
#define LIST(...) NUMBERS(SGT_PARAM_LIST, __VA_ARGS__)
#define TABLE(...) NUMBERS(SGT_PARAM_TABLE, __VA_ARGS__)
#define TERMS(type, key, of, most) NUMBERS(SGT_PARAM_TERMS, type, key, of, most, 0, 0, 0)
#define VECTOR(type, key, of, count, limit, length) \
    ROW(key, length, 0, 0, offsetof(type, of), count, -limit, limit, SGT_PARAM_VECTOR, NULL)
#define RANGE(kind, type, key, of, lo, hi, words) \
    ROW(key, 0, 0, 0, offsetof(type, of), 1, lo, hi, kind, words)

#define CURVATURE(type) REAL(type, "curvature", c, -1)
#define RIM(type) \
    ROW("semi_diameter", 1, 0, 0, offsetof(type, semi_diameter), 1, 0, DBL_MAX, SGT_PARAM_REAL, NULL)
#define BASE(type) CURVATURE(type), REAL(type, "conic", k, 0), RIM(type)
#define SLICE(type)                                                  \
    VECTOR(type, "at", at, 4, 1e6, 0),                               \
        RANGE(SGT_PARAM_REAL, type, "slice", at[3], -1e6, 1e6, NULL),      \
        VECTOR(type, "ex", ex, 4, 1e100, -1),                        \
        VECTOR(type, "ey", ey, 4, 1e100, -1),                        \
        VECTOR(type, "ez", ez, 4, 1e100, -1),                        \
        RANGE(SGT_PARAM_REAL, type, "escape", escape, 1, 1e6, NULL),       \
        RANGE(SGT_PARAM_WHOLE, type, "iterations", iterations, 1, 10000, NULL), \
        RANGE(SGT_PARAM_WHOLE, type, "power", power, 2, 8, NULL)

/* Numbers that a specimen points to, row by row. */
#define ROWS(rows, columns, ...) {(const double[]){__VA_ARGS__}, rows, columns}

static void grid_prepare(void *self) { sgt_grid_measure(self); }

#define LISTED(...) __VA_ARGS__
#define TYPE(KIND, type, NAME, file, formula, where, specimen, params, prepare) \
    sgt_objection sgt_##type##_object(const void *self);                        \
    static const sgt_param type##_params[] = {LISTED params, {0}};              \
    static const sgt_##NAME type##_specimen = {LISTED specimen};
#include "../types.def"
#undef TYPE

/* A cylinder is a biconic.  Its row has other names for the numbers. */
sgt_objection sgt_cylinder_object(const void *self)
{
    const sgt_biconic *s = self;
    sgt_objection no = sgt_biconic_object(self);
    if (!(s->semi_diameter >= 0 && s->semi_diameter < HUGE_VAL)) return no;
    if (no.reason) no.param = fabs(s->c_x) < HUGE_VAL && fabs(s->c_y) < HUGE_VAL ? "conic" : "curvature";
    return no;
}

/* Of conics and even aspheres the ranges of the parameters say it all. */
#define OBJECT_CONIC(type) NULL
#define OBJECT_ASPHERE(type) NULL
#define OBJECT_DEPARTURE(type) sgt_##type##_object
#define OBJECT_QUADRIC(type) sgt_##type##_object
#define OBJECT_BODY(type) sgt_##type##_object
#define OBJECT_LEVEL_SET(type) sgt_##type##_object
#define SGT_FAMILY_QUADRIC SGT_FAMILY_BODY
#define TYPE(KIND, type, NAME, file, formula, where, specimen, params, prepare)                    \
    {#type, &sgt_##NAME##_ops, sizeof(sgt_##NAME), type##_params, OBJECT_##KIND(type), prepare,    \
     SGT_FAMILY_##KIND, &type##_specimen, {0}},

static const sgt_builtin builtins[] = {
#include "../types.def"
    {0},
};

const sgt_builtin *sgt_builtins(void) { return builtins; }

const sgt_builtin *sgt_builtin_of(sgt_surface s)
{
    const sgt_builtin *b = builtins;
    while (b->type && b->ops != s.ops) b++;
    return b;
}

const double *sgt_number_of(sgt_surface s, const char *key)
{
    for (const sgt_builtin *b = builtins; b->type; b++)
        for (const sgt_param *p = b->params; b->ops == s.ops && p->name; p++)
            if (p->kind == SGT_PARAM_REAL && strcmp(p->name, key) == 0)
                return (const void *)((const char *)s.self + p->offset);
    return NULL;
}

/* For F = z - s(x, y), dF/dz is exactly 1 at every z.  For bodies and level sets it is not, at the two points
 * of the axis that are tried. */
bool sgt_is_sag(sgt_surface s)
{
    sgt_vec3 low = {0, 0, 0}, high = low; /* a value that is NaN need not set them */
    s.ops->value(s.self, (sgt_vec3){0, 0, 0}, &low);
    s.ops->value(s.self, (sgt_vec3){0, 0, 1}, &high);
    return low.z == 1 && high.z == 1;
}

// SPDX-License-Identifier: MIT
/* operations.h - the operations of a built-in type as a program sees them: each jumps to that of a set.
 *
 * The library itself does not call them: a surface that comes in is given the operations of its set
 * (in_set). */
#ifndef SGT_DISPATCH_OPERATIONS_H
#define SGT_DISPATCH_OPERATIONS_H

#include "../surface/builtin.h"
#include "dispatch.h"

#if SGT_SETS > 1
#define SETS_OF(NAME)                                                                                    \
    extern const sgt_surface_ops sgt_##NAME##_ops_base, sgt_##NAME##_ops_v3, sgt_##NAME##_ops_v4;        \
    static const sgt_surface_ops *const NAME##_in_set[] = {&sgt_##NAME##_ops_base, &sgt_##NAME##_ops_v3, \
                                                           &sgt_##NAME##_ops_v4};
#else
#define SETS_OF(NAME)                                   \
    extern const sgt_surface_ops sgt_##NAME##_ops_base; \
    static const sgt_surface_ops *const NAME##_in_set[] = {&sgt_##NAME##_ops_base};
#endif

#define OPERATION(NAME, TYPE, WHICH, PARAMETERS, ARGUMENTS) \
    static TYPE NAME##_##WHICH PARAMETERS { return NAME##_in_set[sgt_set()]->WHICH ARGUMENTS; }
#define OPERATION_VOID(NAME, WHICH, PARAMETERS, ARGUMENTS) \
    static void NAME##_##WHICH PARAMETERS { NAME##_in_set[sgt_set()]->WHICH ARGUMENTS; }

#define ALL_HAVE(NAME)                                                                              \
    SETS_OF(NAME)                                                                                   \
    static const struct sgt_builtin_ops NAME##_builtin = {.in_set = NAME##_in_set};                 \
    OPERATION(NAME, double, value, (const void *self, sgt_vec3 p, sgt_vec3 *grad), (self, p, grad)) \
    OPERATION(NAME, sgt_span, span, (const void *self, const sgt_ray *ray), (self, ray))            \
    OPERATION(NAME, double, rounding, (const void *self, sgt_vec3 p), (self, p))                    \
    OPERATION(NAME, sgt_interval, enclose,                                                          \
              (const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope),          \
              (self, ray, t, slope))
/* What is wrong with the parameters; the same in all sets. */
#define OBJECTION(NAME)                                     \
    sgt_objection sgt_##NAME##_object(const void *self);    \
    sgt_objection sgt_##NAME##_object(const void *self)     \
    {                                                       \
        return NAME##_in_set[SGT_BASE]->own_->object(self); \
    }
#define DERIVATIVES(NAME)                                                                          \
    OPERATION_VOID(NAME, second, (const void *self, size_t n, sgt_points p, double *const out[6]), \
                   (self, n, p, out))                                                              \
    OPERATION(NAME, size_t, parameters, (const void *self), (self))                                \
    OPERATION_VOID(NAME, by_parameter,                                                             \
                   (const void *self, size_t j, size_t n, sgt_points p, sgt_values out),           \
                   (self, j, n, p, out))
#define MANY(NAME)                                                                           \
    OPERATION_VOID(NAME, values, (const void *self, size_t n, sgt_points p, sgt_values out), \
                   (self, n, p, out))                                                        \
    OPERATION_VOID(NAME, spans, (const void *self, size_t n, sgt_rays rays, sgt_spans out),  \
                   (self, n, rays, out))
#define FIRSTS(NAME)                                                                         \
    OPERATION(NAME, sgt_span, first, (const void *self, const sgt_ray *ray), (self, ray))    \
    OPERATION_VOID(NAME, firsts, (const void *self, size_t n, sgt_rays rays, sgt_spans out), \
                   (self, n, rays, out))
#define CELLS(NAME)                                                                                        \
    OPERATION_VOID(NAME, encloses,                                                                         \
                   (const void *self, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,     \
                    sgt_enclosures out),                                                                   \
                   (self, n, rays, t_lo, t_hi, out))

#define PUBLIC_TABLE(NAME, SAID, ...)                     \
    const sgt_surface_ops sgt_##NAME##_ops = {            \
        .name = SAID, .own_ = &NAME##_builtin,            \
        .value = NAME##_value, .span = NAME##_span,       \
        .rounding = NAME##_rounding,                      \
        .enclose = NAME##_enclose, __VA_ARGS__};
#define TABLE_OF_DERIVATIVES(NAME) \
    .second = NAME##_second, .parameters = NAME##_parameters, .by_parameter = NAME##_by_parameter
#define TABLE_OF_MANY(NAME) TABLE_OF_DERIVATIVES(NAME), .values = NAME##_values, .spans = NAME##_spans
#define TABLE_OF_FIRSTS(NAME) TABLE_OF_MANY(NAME), .first = NAME##_first, .firsts = NAME##_firsts

/* The tables by the kind of types.def. */
#define OF_CONIC(NAME, SAID) \
    ALL_HAVE(NAME) DERIVATIVES(NAME) PUBLIC_TABLE(NAME, SAID, TABLE_OF_DERIVATIVES(NAME))
#define OF_ASPHERE OF_CONIC
#define OF_DEPARTURE(NAME, SAID) \
    ALL_HAVE(NAME) OBJECTION(NAME) DERIVATIVES(NAME) MANY(NAME) \
    PUBLIC_TABLE(NAME, SAID, TABLE_OF_MANY(NAME))
#define OF_QUADRIC(NAME, SAID)                                              \
    ALL_HAVE(NAME) OBJECTION(NAME) DERIVATIVES(NAME) MANY(NAME) FIRSTS(NAME) \
    PUBLIC_TABLE(NAME, SAID, TABLE_OF_FIRSTS(NAME))
#define OF_BODY(NAME, SAID)                                                             \
    ALL_HAVE(NAME) OBJECTION(NAME) DERIVATIVES(NAME) MANY(NAME) FIRSTS(NAME)            \
    OPERATION(NAME, double, clearance, (const void *self, sgt_vec3 p), (self, p))       \
    PUBLIC_TABLE(NAME, SAID, TABLE_OF_FIRSTS(NAME), .clearance = NAME##_clearance)
#define OF_IMPLICIT(NAME, SAID)                                        \
    ALL_HAVE(NAME) OBJECTION(NAME) DERIVATIVES(NAME) MANY(NAME) CELLS(NAME) \
    PUBLIC_TABLE(NAME, SAID, TABLE_OF_MANY(NAME), .encloses = NAME##_encloses)
#define OF_LEVEL_SET(NAME, SAID)                                                 \
    ALL_HAVE(NAME) OBJECTION(NAME)                                               \
    OPERATION(NAME, double, estimate, (const void *self, sgt_vec3 p), (self, p)) \
    PUBLIC_TABLE(NAME, SAID, .estimate = NAME##_estimate)

#endif

/* quad.h - roots and traces in 113 bits, to tell the errors of doubles by.
 *
 * Which root is meant, and which elements a ray passes, the library's own certain answer says;
 * where it lies is worked out here, without any of its code: by Newton's method (quad.c) on the
 * definitions of the surfaces (formulas.hpp). */
#ifndef TOOL_QUAD_H
#define TOOL_QUAD_H
#include <float.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include <stdbool.h>
#ifdef __cplusplus
extern "C" {
#endif

#if LDBL_MANT_DIG == 113
typedef long double quad;
#elif defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 quad;
#else
typedef double quad; /* the command is then built with QUAD_MISSING */
#endif

typedef struct quad3 { quad x, y, z; } quad3;

/* A usage error in a command that was built without such numbers, or without C++, in which the
 * formulas are written. */
void quad_check(void);

/* The formula of a surface, kept until the command ends; NULL: there is none for its type. */
typedef struct quad_formula quad_formula;
const quad_formula *quad_formula_of(sgt_surface s);

/* What is zero on the surface, and its gradient, along that of F there. */
quad quad_value(const quad_formula *f, quad3 p, quad3 *grad);

/* The root of s on the ray near *t, which a Newton iteration leaves in *t; false: it does not
 * come to rest at the last bits (a double root).  Of the ray o and d alone are read. */
bool quad_meet(sgt_surface s, const sgt_ray *ray, quad *t);

/* ray through the elements that `passed` says, each met near where seen[] says; the point on the
 * last of them (global) and the optical path length.  false: an iteration does not come to rest,
 * or comes to rest so far from what was seen that it is another root. */
bool quad_trace(size_t passed, const sgt_element e[], double index_before, const sgt_ray *ray,
                const sgt_passage seen[], quad3 *point, quad *path);

quad quad_distance(quad3 a, sgt_vec3 b);

#ifdef __cplusplus
}
#endif
#endif

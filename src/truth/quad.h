// SPDX-License-Identifier: MIT
/* quad.h - roots and traces in 113 bits, to measure the errors of doubles.
 *
 * The library's own certain answer says which root is meant, and which elements a ray passes.
 * Where the root lies is computed here without any code of the library: by Newton's method
 * (quad.c) on the definitions of the surfaces (formulas.hpp, text.hpp). */
#ifndef TRUTH_QUAD_H
#define TRUTH_QUAD_H
#include <float.h>
#include <sagitta/formula.h>
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
typedef double quad; /* a stand-in: QUAD_MISSING is then defined */
#endif

typedef struct quad3 { quad x, y, z; } quad3;

/* false: this was built without such numbers, or without C++, in which the formulas are written. */
bool quad_there(void);

/* The formula of a surface, which lasts until the command ends; NULL: there is none for its type.  Of a
 * surface that is a text there is one after quad_formula_read. */
typedef struct quad_formula quad_formula;
const quad_formula *quad_formula_of(sgt_surface s);

/* Takes the text and the n parameters as the definition of s, an sgt_formula or sgt_formula_sag (text.hpp).
 * Returns the column, from 1, of what is not understood; 0: nothing. */
size_t quad_formula_read(sgt_surface s, const char *text, size_t n, const sgt_named parameter[]);

/* A function that is zero on the surface, and its gradient, which there is along that of F. */
quad quad_value(const quad_formula *f, quad3 p, quad3 *grad);

/* Finds the root of s on the ray near *t, by Newton's method, and stores it in *t.  false: the
 * iteration does not settle (a double root).  Only o and d of the ray are read. */
bool quad_meet(sgt_surface s, const sgt_ray *ray, quad *t);

/* Traces a ray through the first `passed` elements, each met near the place in seen[].  *point: on
 * the last of them (global); *path: the optical path length.  false: an iteration does not settle,
 * or settles so far from seen[] that it is another root. */
bool quad_trace(size_t passed, const sgt_element e[], double index_before, const sgt_ray *ray,
                const sgt_passage seen[], quad3 *point, quad *path);

quad quad_distance(quad3 a, sgt_vec3 b);

#ifdef __cplusplus
}
#endif
#endif

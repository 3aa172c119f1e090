// SPDX-License-Identifier: MIT
/*
 * formula.h - a surface from its formula as text: "x^4 + y^4 + z^4 = a".
 *
 * sgt_formula_read makes a tape of the text: a row of steps, each with one operation.
 * Everything that a surface can offer (sagitta.h, sgt_surface_ops) is worked out from the
 * tape: F, its gradient, the rounding of both, enclosures, second derivatives and those
 * by the parameters.  So a formula is proven and differentiated as a built-in type is.
 *
 * TWO SURFACES.  sgt_formula_ops is the set F(x, y, z) = 0, clipped by a ball or a box.
 * sgt_formula_sag_ops is the sag z = s(x, y), clipped by a rim, as those of surfaces.h.
 *
 * GRAMMAR
 *
 *     formula   sum, or sum = sum, which stands for the difference (no = in a sag)
 *     sum       terms with + and - between
 *     term      factors with * and / between
 *     factor    -factor, or a power
 *     power     atom, or atom ^ factor: -x^2 is -(x^2), and 2^-x, x^y^z = x^(y^z)
 *     atom      a number, a name, (sum), or a function of sums with commas between
 *     names     x, y, z, r = sqrt(x^2 + y^2), pi, and those of the parameters: a letter,
 *               then letters, digits and _.  A sag has no z.  A product needs the
 *               sign *
 *     functions sqrt cbrt exp log sin cos tan asin acos atan sinh cosh tanh abs of one
 *               argument; atan2 (y, x), min, max, hypot of two
 *
 * A number is the double nearest to it.  pi is the number itself: an interval.  So is all
 * that is worked out of numbers and parameters alone.
 *
 * A POWER with a whole exponent is a product, or 1 over a product; u^0 is 1.  With any
 * other exponent e it is exp(e log b), defined where b > 0 (and where b = 0, if e > 0).
 * An exponent is whole if it is made of numbers alone, and exactly: 2, -(1 + 1), 4/2, up
 * to 2^20.  A parameter's value can change, so x^p is exp(p log x), also for p = 2.
 *
 * UNDEFINED is a root of a negative number, a logarithm of 0 or less, an arc sine or
 * cosine beyond 1, a quotient by 0, atan2(0, 0), and all that is made of it.  F is NaN
 * there.  If numbers alone are not defined, such as 1/0, the text is refused, and so is
 * one that is the same everywhere.  A ray through the very place where atan2(0, 0) is
 * asked is left undecided; so is what depends on sin, cos or tan of more than 2^26.
 *
 * THE VERTEX.  r^n cos(n atan2(y, x)) and r^n sin(n atan2(y, x)), n a whole number up to
 * 64, are worked out as the polynomials that they are, and even powers of r as those of
 * x^2 + y^2.  So they are defined and have a slope at x = y = 0, where atan2(y, x) has
 * neither.  The factors may stand apart in a product, with more of r, as in
 * a*r^4/b*cos(2*atan2(y, x)).  But a sum in parentheses is not multiplied out, as in
 * r^2*(1 + cos(2*atan2(y, x))).  A quotient takes nothing from r: r^2/r is not defined
 * at 0.
 *
 * THE SAME FUNCTION.  A tape has the value of the text at each point where the text is
 * defined.  It is not defined elsewhere, except at such a vertex.  It may be rounded
 * otherwise: equal parts are worked out once, x*x is x^2, sqrt(u^2) is abs(u).
 *
 * Nothing is allocated.  Only sgt_formula_set changes a tape.  So any number of threads
 * may use it while none sets it.
 */
#ifndef SAGITTA_FORMULA_H
#define SAGITTA_FORMULA_H

#include <sagitta/sagitta.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a formula may name beyond x, y, z, r, pi and the functions, which are reserved.
 * Its value is finite. */
typedef struct sgt_named { const char *name; double value; } sgt_named;

/* Of which variables a formula is. */
typedef enum sgt_formula_kind {
    SGT_FORMULA_XYZ, /* x, y, z, r: for sgt_formula */
    SGT_FORMULA_XY   /* x, y, r: for sgt_formula_sag */
} sgt_formula_kind;

/* A formula that has been read. */
typedef struct sgt_tape sgt_tape;

/* The longest text (bytes), the deepest nesting of parentheses and powers, and how many
 * parameters there may be. */
enum {
    SGT_LONGEST_FORMULA = 32768,
    SGT_DEEPEST_FORMULA = 200,
    SGT_MOST_FORMULA_PARAMETERS = 256
};

/* How many bytes of room suffice for the text with n parameters; 0 if it is too long, or
 * n too large.  Less may do. */
SGT_API size_t sgt_formula_room(const char *text, size_t n);

/* Reads a text and returns its tape.
 *
 *     text        zero-ended; it need not stay
 *     kind        which variables it may have.  With SGT_FORMULA_XYZ it must have one of
 *                 x, y, z, r; a sag may be a number
 *     n           how many parameters there are
 *     parameters  their names, which need not stay, and their values.  A parameter need
 *                 not be used
 *     room        where the tape is kept, aligned as for a double.  It must stay, and not
 *                 move, as long as the tape is used
 *     size        of room, in bytes (sgt_formula_room)
 *
 * NULL: *error (may be NULL) says what is wrong, "expected a number, a name or (, not )",
 * with the column.  Column 0: a parameter or the room is to blame. */
SGT_API sgt_tape *sgt_formula_read(const char *text, sgt_formula_kind kind, size_t n,
                                   const sgt_named parameters[], void *room, size_t size,
                                   sgt_error *error);

/* Gives the parameters other values, n as when it was read.  false: one is not finite, as
 * `error` (may be NULL) says, and nothing is changed. */
SGT_API bool sgt_formula_set(sgt_tape *tape, const double values[], sgt_error *error);

/* F(x, y, z) = 0 within a ball about the origin, or a box, or both.  Points outside are
 * not of the surface; at its border that is so up to rounding. */
typedef struct sgt_formula {
    const sgt_tape *tape;     /* of SGT_FORMULA_XYZ */
    double          ball;     /* radius, length; 0: no ball */
    sgt_vec3        lo, hi;   /* corners of the box, length; both zero: no box */
} sgt_formula;

/* The sag z = s(x, y), F = z - s(x, y). */
typedef struct sgt_formula_sag {
    const sgt_tape *tape;          /* of SGT_FORMULA_XY */
    double          semi_diameter; /* of the rim, length; 0: none (surfaces.h) */
} sgt_formula_sag;

/* parameters: those given to sgt_formula_read, in that order. */
SGT_API extern const sgt_surface_ops sgt_formula_ops;
SGT_API extern const sgt_surface_ops sgt_formula_sag_ops;

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_FORMULA_H */

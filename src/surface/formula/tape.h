// SPDX-License-Identifier: MIT
/* tape.h - a formula that has been read: steps over registers, and the numbers they share.
 *
 * A STEP does one operation on one or two operands and puts the result in a register.  Registers 0, 1, 2
 * hold x, y, z and are never written.  The others are used again as soon as their number is not needed
 * any more (read.c).  So a tape of any length runs in FORMULA_REGISTERS registers, for a row of points at a
 * time, on the stack.
 *
 * UNIFORM is what does not depend on the point: numbers, pi, parameters, and what is made of them alone.
 * Uniforms have steps of their own, which sgt_formula_set runs once, in intervals; evaluation at points takes
 * the middle.  A step of points has one uniform operand at most: with two it would be uniform itself.  Of a
 * sum, a product, a minimum, a maximum and a hypot it is b; of the others it may be a.
 *
 * A step never writes a register that it reads, so operands and result do not overlap.
 *
 * An operand is the number of a register, or FORMULA_UNIFORM + the index of a uniform. */
#ifndef SGT_SURFACE_FORMULA_TAPE_H
#define SGT_SURFACE_FORMULA_TAPE_H

#include <sagitta/formula.h>

enum { FORMULA_REGISTERS = 48, FORMULA_UNIFORMS = 1024, FORMULA_UNIFORM = 0x8000 };

typedef enum formula_op {
    FORMULA_ADD, FORMULA_SUB, FORMULA_MUL, FORMULA_DIV, FORMULA_MIN, FORMULA_MAX,
    FORMULA_HYPOT,       /* sqrt(a^2 + b^2) */
    FORMULA_ATAN2,       /* atan2(a, b): a is the y */
    FORMULA_REAL_POWER,  /* a^b */
    FORMULA_POWER,       /* a^n, n whole: 3 and more, or -1 and less */
    FORMULA_HALF_POWER,  /* sqrt(a)^n, n odd, 3 and more */
    FORMULA_SQUARE, FORMULA_NEG, FORMULA_ABS,
    FORMULA_SQRT, FORMULA_CBRT, FORMULA_EXP, FORMULA_LOG,
    FORMULA_SIN, FORMULA_COS, FORMULA_TAN, FORMULA_ASIN, FORMULA_ACOS, FORMULA_ATAN,
    FORMULA_SINH, FORMULA_COSH, FORMULA_TANH,
    FORMULA_COPY,        /* a: only as the last step, if the formula is a variable or a uniform */
    /* uniforms only */
    FORMULA_NUMBER,      /* `number` */
    FORMULA_PI,
    FORMULA_PARAMETER    /* the parameter n */
} formula_op;

/* No function of num/functions.h is off by more than this many u of its result. */
enum { FORMULA_FUNCTION_ULPS = 32 };

enum { FORMULA_OF_X = 1, FORMULA_OF_Y = 2, FORMULA_OF_Z = 4 };

typedef struct formula_step {
    unsigned char op;
    unsigned char of;        /* on which of x, y, z the result depends */
    unsigned short out;      /* a register, 3 or more */
    unsigned short a, b;     /* operands; b of the first nine operations only */
    int n;                   /* of FORMULA_POWER, FORMULA_HALF_POWER */
} formula_step;

/* a, b: indices of earlier uniforms. */
typedef struct formula_uniform {
    unsigned char op;
    unsigned short a, b;
    int n;                   /* of FORMULA_POWER, FORMULA_HALF_POWER and FORMULA_PARAMETER */
    double number;
} formula_uniform;

/* All pointers point into the room.  The result is what the last step puts out. */
struct sgt_tape {
    sgt_formula_kind kind;
    int steps, uniforms, parameters, registers; /* registers: how many are used, with x, y, z */
    bool jumps;              /* a step is an atan2, whose cut F may cross */
    /* Of x and y: the first three steps make s = x^2 + y^2, and the others read s alone. */
    bool radial;
    double c, k;             /* of x and y: a conic that is near the sag at the vertex; 0: none is known */
    const formula_step *step;
    const formula_uniform *uniform;
    sgt_interval *value;     /* of each uniform */
    double *middle;          /* of these; NaN if a uniform is not defined, or has an end at infinity */
    double *given;           /* the values of the parameters */
};

/* One operation on intervals, as interval.h has it (enclose.c).  FORMULA_COPY is a.  All numbers for the
 * operations of uniforms only.  What is compiled once (apply.c) calls that of the base set. */
sgt_interval sgt_formula_interval(formula_op op, int n, sgt_interval a, sgt_interval b);
sgt_interval sgt_formula_interval_base(formula_op op, int n, sgt_interval a, sgt_interval b);

/* The same of uniforms: all numbers if it is not known whether it is defined (apply.c). */
sgt_interval sgt_formula_uniform(formula_op op, int n, sgt_interval a, sgt_interval b);

/* The conic c, k of a tape of x and y (enclose.c). */
void sgt_formula_vertex(const sgt_tape *tape, double *c, double *k);
void sgt_formula_vertex_base(const sgt_tape *tape, double *c, double *k);

#endif

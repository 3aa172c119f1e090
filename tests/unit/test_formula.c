// SPDX-License-Identifier: MIT
/* Texts of formulas and the tapes made of them (src/surface/formula).
 *
 * Random trees of operations are printed as text, with as few parentheses as the grammar needs, or more, and
 * worked out as they are.  The tape has to have the same value at random points.  How well that value is
 * known is seen by working the tree out with noise at each operation: what the noise does not move by 10^-12
 * times a number, rounding cannot move by more than 10^-19 times it.  And each tape is held to what tape.h
 * says of tapes (tape_run.h). */
#include "unit.h"

#include "tape_run.h"

#include <ctype.h>

enum { PARAMETERS = 4, TEXT = 40000 };
static const sgt_named parameters[PARAMETERS] = {{"a", 1.5}, {"b", -0.25}, {"k2", 3}, {"long_name", 0.75}};

/* ------------------------------------------------------------------- reading */

static const unsigned char GUARD = 0xa5;
enum { GUARDS = 64 };

/* The room is as large as sgt_formula_room says, or smaller by `less`; what is around it must not change. */
static sgt_tape *read_in(const char *text, sgt_formula_kind kind, size_t less, sgt_error *error)
{
    static unsigned char *block; /* of the tape that was read last */
    size_t size = sgt_formula_room(text, PARAMETERS);
    REQUIRE(size > less, "the room of %zu is not larger than %zu", size, less);
    size -= less;
    free(block);
    block = malloc(size + 2 * GUARDS);
    REQUIRE(block, "out of memory");
    memset(block, GUARD, size + 2 * GUARDS);
    *error = (sgt_error){.column = 99999, .words = "untouched"};
    sgt_tape *t = sgt_formula_read(text, kind, PARAMETERS, parameters, block + GUARDS, size, error);
    for (int i = 0; i < GUARDS; i++)
        REQUIRE(block[i] == GUARD && block[GUARDS + size + (size_t)i] == GUARD,
                "%.60s: written beside the room", text);
    if (t) {
        REQUIRE(error->column == 99999, "%.60s: an error and a tape", text);
        REQUIRE((unsigned char *)t == block + GUARDS, "%.60s: the tape is elsewhere", text);
        tape_check(t);
    } else {
        size_t length = 0;
        while (length < sizeof error->words && error->words[length]) length++;
        REQUIRE(length > 5 && length < sizeof error->words, "%.60s: a sentence of %zu", text, length);
        REQUIRE(error->column <= strlen(text) + 1, "%.60s: column %zu", text, error->column);
    }
    return t;
}

static sgt_tape *tape_of(const char *text)
{
    sgt_error error;
    sgt_tape *t = read_in(text, SGT_FORMULA_XYZ, 0, &error);
    REQUIRE(t, "%.60s: column %d: %s", text, (int)error.column, error.words);
    return t;
}

static long double value_of(const char *text, double x, double y, double z)
{
    return tape_value(tape_of(text), (const long double[]){(long double)x, (long double)y, (long double)z});
}

/* ------------------------------------------------------------- random trees */

enum { TREES = 400, NUMBERS = 40 };
enum { NUMBER, VARIABLE, RADIUS, PI, PARAMETER, BINARY, POWER, MINUS, FUNCTION };
typedef struct tree {
    int kind; /* NUMBER ... */
    int which; /* variable, parameter, or row of the table below */
    char sign; /* of BINARY */
    struct tree *a, *b;
    char text[NUMBERS]; /* of NUMBER */
} tree;

static tree trees[TREES];
static int grown;

static const struct {
    const char *name;
    formula_op op;
    int arguments;
} table[] = {
    {"sqrt", FORMULA_SQRT, 1}, {"cbrt", FORMULA_CBRT, 1},   {"exp", FORMULA_EXP, 1},
    {"log", FORMULA_LOG, 1},   {"sin", FORMULA_SIN, 1},     {"cos", FORMULA_COS, 1},
    {"tan", FORMULA_TAN, 1},   {"asin", FORMULA_ASIN, 1},   {"acos", FORMULA_ACOS, 1},
    {"atan", FORMULA_ATAN, 1}, {"sinh", FORMULA_SINH, 1},   {"cosh", FORMULA_COSH, 1},
    {"tanh", FORMULA_TANH, 1}, {"abs", FORMULA_ABS, 1},     {"min", FORMULA_MIN, 2},
    {"max", FORMULA_MAX, 2},   {"hypot", FORMULA_HYPOT, 2}, {"atan2", FORMULA_ATAN2, 2},
};

static tree *planted(int kind)
{
    REQUIRE(grown < TREES, "too many trees");
    trees[grown] = (tree){.kind = kind};
    return trees + grown++;
}

static tree *number_tree(generator *g, bool whole)
{
    tree *t = planted(NUMBER);
    if (whole)
        sprintf(t->text, "%d", below(g, 7));
    else if (chance(g, 0.5))
        sprintf(t->text, "%d", below(g, 12));
    else
        sprintf(t->text, chance(g, 0.5) ? "%.3g" : "%.17g", log_uniform(g, 1e-2, 1e2));
    return t;
}

static tree *leaf(generator *g)
{
    double what = uniform(g, 0, 1);
    if (what < 0.25) return number_tree(g, false);
    tree *t = planted(what < 0.75 ? VARIABLE : what < 0.85 ? PARAMETER : what < 0.97 ? RADIUS : PI);
    t->which = below(g, t->kind == VARIABLE ? 3 : PARAMETERS);
    return t;
}

static tree *binary(char sign, tree *a, tree *b)
{
    tree *t = planted(BINARY);
    return t->sign = sign, t->a = a, t->b = b, t;
}

static tree *function_tree(const char *name, tree *a, tree *b)
{
    tree *t = planted(FUNCTION);
    while (strcmp(table[t->which].name, name) != 0) t->which++;
    return t->a = a, t->b = b, t;
}

static tree *variable_tree(int which)
{
    tree *t = planted(VARIABLE);
    return t->which = which, t;
}

static tree *minus_tree(tree *a)
{
    tree *t = planted(MINUS);
    return t->a = a, t;
}

/* cos(n atan2(y, x)) or a sine, in some form. */
static tree *wave(generator *g)
{
    tree *angle = function_tree("atan2", variable_tree(1), variable_tree(0)), *n = planted(NUMBER);
    sprintf(n->text, "%d", 1 + below(g, chance(g, 0.9) ? 5 : 40));
    if (chance(g, 0.3)) n = minus_tree(n);
    if (chance(g, 0.8)) angle = chance(g, 0.5) ? binary('*', n, angle) : binary('*', angle, n);
    if (chance(g, 0.2)) angle = minus_tree(angle);
    return function_tree(chance(g, 0.5) ? "sin" : "cos", angle, NULL);
}

static tree *grow(generator *g, int depth)
{
    double what = uniform(g, 0, 1);
    if (depth == 0 || grown > TREES / 2 || what < 0.1) return leaf(g);
    if (what < 0.14) return wave(g);
    if (what < 0.2) { /* with a power of r, and perhaps more */
        tree *power = planted(POWER), *more = chance(g, 0.5) ? grow(g, depth - 1) : NULL;
        power->a = planted(RADIUS), power->b = number_tree(g, true);
        tree *t = chance(g, 0.5) ? binary('*', power, wave(g)) : binary('*', wave(g), power);
        return !more ? t : chance(g, 0.3) ? binary('/', t, more) : binary('*', more, t);
    }
    if (what < 0.24) return minus_tree(grow(g, depth - 1));
    if (what < 0.38) {
        tree *t = planted(POWER), *e;
        t->a = grow(g, depth - 1);
        if (chance(g, 0.7))
            e = number_tree(g, true);
        else if (chance(g, 0.4))
            e = planted(NUMBER), strcpy(e->text, chance(g, 0.5) ? "0.5" : "1.5");
        else
            e = grow(g, depth - 1);
        t->b = chance(g, 0.2) ? minus_tree(e) : e;
        return t;
    }
    if (what < 0.52) {
        tree *t = planted(FUNCTION);
        t->which = below(g, COUNT_OF(table));
        t->a = grow(g, depth - 1);
        if (table[t->which].arguments == 2) t->b = grow(g, depth - 1);
        return t;
    }
    tree *a = grow(g, depth - 1);
    /* equal parts in one formula */
    tree *b = chance(g, 0.1) ? a : grow(g, depth - 1);
    return binary("++--***/"[below(g, 8)], a, b);
}

/* -------------------------------------------------------------- tree to text */

static char written[TEXT];
static int length;

static void put(const char *text)
{
    REQUIRE(length + (int)strlen(text) < TEXT, "too long");
    length += sprintf(written + length, "%s", text);
}

/* How tightly it binds: a sum 1, a product 2, a minus or a power 3, an atom 4. */
static int tightness(const tree *t)
{
    switch (t->kind) {
    case BINARY:
        return t->sign == '+' || t->sign == '-' ? 1 : 2;
    case POWER:
    case MINUS:
        return 3;
    default:
        return 4;
    }
}

static void print(generator *g, const tree *t, int least)
{
    bool inside = tightness(t) < least || chance(g, 0.05);
    if (chance(g, 0.1)) put(chance(g, 0.8) ? " " : chance(g, 0.5) ? "\t" : "\r\n");
    if (inside) put("(");
    switch (t->kind) {
    case NUMBER:
        put(t->text);
        break;
    case VARIABLE:
        put(t->which == 0 ? "x" : t->which == 1 ? "y" : "z");
        break;
    case RADIUS:
        put("r");
        break;
    case PI:
        put("pi");
        break;
    case PARAMETER:
        put(parameters[t->which].name);
        break;
    case BINARY: {
        char sign[2] = {t->sign, 0};
        int own = tightness(t);
        print(g, t->a, own);
        put(sign);
        print(g, t->b, own + 1);
        break;
    }
    case POWER:
        print(g, t->a, 4);
        put("^");
        print(g, t->b, 3);
        break;
    case MINUS:
        put("-");
        print(g, t->a, 3);
        break;
    case FUNCTION:
        put(table[t->which].name);
        put("(");
        print(g, t->a, 0);
        if (t->b) put(","), print(g, t->b, 0);
        put(")");
        break;
    }
    if (inside) put(")");
    if (chance(g, 0.05)) put(" ");
}

/* ------------------------------------------------------------- tree to value */

/* Beyond this, or below, rounding may make an infinity or a 0 of it. */
static const long double HUGE_ONE = 1e300L;

typedef struct working {
    generator noise;
    long double size;
    const long double *point;
    bool wild;
} working;

static bool is_whole(const tree *t, int *n)
{
    if (t->kind == MINUS && is_whole(t->a, n)) return *n = -*n, true;
    if (t->kind != NUMBER || strspn(t->text, "0123456789") != strlen(t->text)) return false;
    return *n = atoi(t->text), true;
}

/* Made of numbers alone, or u^0, which is 1. */
static bool is_constant(const tree *t)
{
    int n;
    if (t->kind == POWER && is_whole(t->b, &n) && n == 0) return true;
    if (t->kind == VARIABLE || t->kind == RADIUS || t->kind == PARAMETER) return false;
    return (!t->a || is_constant(t->a)) && (!t->b || is_constant(t->b));
}

/* Is the number near an end of where the operation is defined?  A rounding may take it across, and the few
 * tries at changed numbers may all miss that. */
static bool near_end(formula_op op, const tree *of, long double a)
{
    const long double end = op == FORMULA_ASIN || op == FORMULA_ACOS ? 1 : 0;
    if (end == 0 && op != FORMULA_SQRT && op != FORMULA_LOG && op != FORMULA_REAL_POWER) return false;
    return !is_constant(of) && fabsl(fabsl(a) - end) < 1e-9L;
}

static long double work(working *w, const tree *t)
{
    long double v = 0, a = t->a ? work(w, t->a) : 0, b = 0;
    int n;
    bool power = t->kind == POWER && is_whole(t->b, &n);
    if (t->b && !power) b = work(w, t->b);
    switch (t->kind) {
    case NUMBER:
        return (long double)strtod(t->text, NULL);
    case VARIABLE:
        return w->point[t->which];
    case RADIUS:
        v = hypotl(w->point[0], w->point[1]);
        break;
    case PI:
        return acosl(-1);
    case PARAMETER:
        return (long double)parameters[t->which].value;
    case MINUS:
        return -a;
    case POWER:
        if (power)
            v = n == 0 ? (isnan(a) ? a : 1) : op_value(FORMULA_POWER, n, a, 0);
        else
            v = op_value(FORMULA_REAL_POWER, 0, a, b);
        if (!power && near_end(FORMULA_REAL_POWER, t->a, a)) w->wild = true;
        /* 9 - 9 is a whole exponent, and so is 4/2; is 3*(1/3)? */
        if (!power && is_constant(t->b) && fabsl(b - roundl(b)) < 1e-9L) w->wild = true;
        break;
    case BINARY:
        v = op_value(t->sign == '+'   ? FORMULA_ADD
                     : t->sign == '-' ? FORMULA_SUB
                     : t->sign == '*' ? FORMULA_MUL
                                      : FORMULA_DIV,
                     0, a, b);
        break;
    case FUNCTION: {
        formula_op op = table[t->which].op;
        v = op_value(op, 0, a, b);
        if (near_end(op, t->a, a)) w->wild = true;
        /* intervals know nothing beyond */
        if (op >= FORMULA_SIN && op <= FORMULA_TAN && fabsl(a) > 0x1p26L) w->wild = true;
        break;
    }
    }
    if (!isnan(v) && !(fabsl(v) < HUGE_ONE && (v == 0 || fabsl(v) > 1 / HUGE_ONE))) w->wild = true;
    if (w->size != 0) v *= 1 + w->size * (long double)uniform(&w->noise, -1, 1);
    return v;
}

/* What it says of a formula that is not defined anywhere, or is no function of the point. */
static bool is_refusal(const char *text)
{
    return strstr(text, "numbers alone") || strstr(text, "quotient by 0") || strstr(text, "whole exponent") ||
           strstr(text, "has none of x, y, z");
}

static void test_trees(void **state)
{
    (void)state;
    generator g = seeded("random trees");
    long compared = 0, undefined = 0, refused = 0, unknown = 0, resolved = 0, doubtful = 0;
    const long n_of_trees = scaled(40000);
    for (long i = 0; i < n_of_trees; i++) {
        sgt_error error;
        grown = 0, length = 0;
        const tree *t = grow(&g, 1 + below(&g, 6));
        print(&g, t, 0);
        sgt_tape *tape = read_in(written, SGT_FORMULA_XYZ, 0, &error);
        for (int k = 0; k < 4; k++) {
            long double point[3], v[6];
            for (int j = 0; j < 3; j++) point[j] = (long double)(log_uniform(&g, 0.05, 4) * either_sign(&g));
            bool wild = false, moved = false;
            long double spread = 0;
            for (int j = 0; j < 6; j++) {
                working w = {g, j ? 1e-12L : 0, point, false};
                w.noise.state += (uint64_t)j;
                v[j] = work(&w, t);
                wild = wild || w.wild || isinf(v[j]);
                moved = moved || isnan(v[j]) != isnan(v[0]);
                if (!isnan(v[j])) spread = fmaxl(spread, fabsl(v[j] - v[0]));
            }
            if (!tape) {
                REQUIRE(is_refusal(error.words), "%s: column %zu: %s", written, error.column, error.words);
                bool constant = strstr(error.words, "has none of") != NULL;
                /* 1/sin(pi) is not defined, and large in long double; sqrt(sin(pi)) is not known to be */
                if (strstr(error.words, "not known")) doubtful += k == 0, constant = true;
                REQUIRE(constant || wild || moved || isnan(v[0]), "%s: %Lg, and yet: %s", written, v[0],
                        error.words);
                refused += k == 0;
                continue;
            }
            if (wild || moved || spread > 1e-5L * fabsl(v[0])) {
                unknown++;
                continue;
            }
            long double got = tape_value(tape, point);
            undefined += isnan(v[0]), compared++;
            if (k == 0 && strstr(written, "atan2")) resolved += tape_count(tape, FORMULA_ATAN2) == 0;
            if (isnan(v[0]))
                REQUIRE(isnan(got), "%s at %Lg, %Lg, %Lg: %Lg, but it is not defined", written, point[0],
                        point[1], point[2], got);
            else
                REQUIRE(fabsl(got - v[0]) <= 1e-3L * spread + 1e-16L * fabsl(v[0]) + 1e-300L,
                        "%s at %Lg, %Lg, %Lg: %.17Lg, not %.17Lg (%Lg)", written, point[0], point[1],
                        point[2], got, v[0], spread);
        }
    }
    print_message(
        "%ld values compared, %ld of them undefined, %ld not known well; %ld texts refused, %ld in doubt; "
        "%ld lost atan2\n",
        compared, undefined, unknown, refused, doubtful, resolved);
    REQUIRE(compared > 2 * undefined && compared > unknown && resolved > 0, "too few");
    REQUIRE(refused < n_of_trees / 5 && doubtful < 20 + refused / 10, "too many texts are refused");
}

/* ------------------------------------------------------ precedence, by hand */

static void test_precedence(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value;
    } rows[] = {
        /* at x = 2, y = 3, z = 5 */
        {"-x^2", -4},
        {"(-x)^2", 4},
        {"2^-x", 0.25},
        {"x^y^x", 512},
        {"(x^y)^x", 64},
        {"-x^-y", -0.125},
        {"x-y-z", -6},
        {"x-(y-z)", 4},
        {"x/y/z", 2.0 / 15},
        {"x/(y/z)", 10.0 / 3},
        {"x*-y", -6},
        {"x--y", 5},
        {"x---y", -1},
        {"x+y*z", 17},
        {"(x+y)*z", 25},
        {"x*y^2", 18},
        {"x = y", -1},
        {"x = y - z", 4},
        {"x - y = z - 1", -5},
        {"\tx\n+\r\ny ", 5},
        {"atan2(y, x) - atan(y/x) + x", 2},
        {"max(x, y) - min(y, z)", 0},
        {"hypot(y, x+2)", 5},
        {"abs(x-y)", 1},
        {"x^0.5*x^0.5", 2},
        {"x^-2*(x^-2)^2", 1.0 / 64},
        {"z/2*2", 5},
        {"2/z", 0.4},
        {"x*1e-1", 0.2},
        {"(((x)))", 2},
        {"cbrt(x^3)", 2},
        {"x^(4/2)", 4},
        {"x^(3-2)", 2},
        {"x^-(1+1)", 0.25},
        {"r^2", 13},
        {"z^a - sqrt(z)^3 + x", 2},
        {"long_name + k2*x", 6.75},
        {"-(x-y)", 1},
        {"x + -y", -1},
        {"x*y*x", 12},
        {"0*x+3", 3},
        {"x-x", 0},
    };
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        long double got = value_of(rows[i].text, 2, 3, 5);
        REQUIRE(fabsl(got - (long double)rows[i].value) <= 1e-15L * (1 + fabsl(got)), "%s: %Lg, not %g",
                rows[i].text, got, rows[i].value);
    }
}

/* -------------------------------------------------------------------- errors */

static void test_errors(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t column;
        const char *says;
    } rows[] = {
        {"", 1, "there is no formula"},
        {"  \n", 1, "there is no formula"},
        {"2x", 2, "expected an operator before x: write * to multiply"},
        {"x y", 3, "expected an operator before y"},
        {"2(x)", 2, "expected an operator before ("},
        {"(x)(y)", 4, "expected an operator before ("},
        {"x 2", 3, "expected an operator before 2"},
        {"sin(x 2)", 7, "expected an operator before 2"},
        {"2e*x", 2, "expected an operator before e"},
        {"2exp(x)", 2, "expected an operator before exp"},
        {"x.5", 2, "expected an operator before .5"},
        {"1.2.3*x", 4, "one point"},
        {".*x", 1, "a point alone"},
        {"sin x", 5, "expected ( after sin, as in sin(x)"},
        {"x+sin", 6, "expected ( after sin"},
        {"atan2", 6, "expected ( after atan2, as in atan2(y, x)"},
        {"x+foo", 3, "foo is not known; there are x, y, z, r, pi, a, b, k2, long_name"},
        {"foo(x)", 1, "foo is not known; functions: sqrt cbrt exp"},
        {"ln(x)", 1, "ln is not known: write log(u)"},
        {"xy", 1, "xy is not known"},
        {"_x", 1, "_x is not known"},
        {"abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz", 1, "abcdefghijklmnopqrstu... is not known"},
        {"(x", 3, "expected ), as there is a ( in column 1"},
        {"x+(y*sin(z)", 12, "there is a ( in column 3"},
        {"sin(x", 6, "there is a ( in column 4"},
        {"x)", 2, "this ) has no ("},
        {"x**2", 2, "^, not **"},
        {"1,5*x", 2, "decimals have a point"},
        {"(1,5)*x", 3, "decimals have a point"},
        {"sin(1,5)", 6, "sin takes one argument"},
        {"atan2(y)", 8, "atan2 takes two arguments, y and x"},
        {"hypot(x, y, z)", 11, "hypot takes two arguments"},
        {"sin()", 5, "expected a number, a name or (, not )"},
        {"x+", 3, "expected a number, a name or (, not the end"},
        {"+x", 1, "expected a number, a name or (, not +"},
        {"x*/y", 3, "expected a number, a name or (, not /"},
        {"x^", 3, "not the end"},
        {"()", 2, "not )"},
        {"x=", 3, "not the end"},
        {"=x", 1, "not ="},
        {"x==y", 3, "one = is meant, not two"},
        {"x=y=z", 4, "one = at most"},
        {"(x=y)", 3, "not within parentheses"},
        {"sin(x=y)", 6, "not within parentheses"},
        {"x - y \xc2\xb2", 7, "only ASCII"},
        {"x \xe2\x88\x92 y", 3, "only ASCII"},
        {"x\x01", 2, "control character"},
        {"[x]", 1, "[ has no meaning in a formula: use ( and )"},
        {"x!", 2, "! has no meaning"},
        {"|x| - 1", 1, "| has no meaning in a formula: write abs(u)"},
        {"x<y", 2, "< has no meaning"},
        {"1e400*x", 1, "larger than the largest double"},
        {"x/0", 2, "a quotient by 0"},
        {"x+1/0", 4, "a quotient by 0"},
        {"x/(1-1)", 2, "a quotient by 0"},
        {"x+sqrt(-1)", 3, "not defined"},
        {"x*log(0)", 3, "not defined"},
        {"x*log(-pi)", 3, "not defined"},
        {"x+atan2(0,0)", 3, "not defined"},
        {"x+asin(2)", 3, "not defined"},
        {"x+0^-1", 4, "not defined"},
        {"x+(-8)^(1/3)", 7, "not defined"},
        {"x*exp(1000)", 3, "too large"},
        {"x+0/sin(pi)", 4, "not known or not defined"},
        {"x+sqrt(min(sin(pi),0))", 3, "not known or not defined"},
        {"x+atan2(0,abs(sin(pi)))", 3, "not known or not defined"},
        {"x+log(sin(1e9))", 3, "not known or not defined"},
        {"x*1e300*(1e300*1e300)", 15, "too large"},
        {"x^1e7", 2, "whole exponent"},
        {"x^-2000000", 2, "whole exponent"},
        {"3", 1, "F is the same everywhere"},
        {"a = pi", 1, "F is the same everywhere"},
        {"x^0", 1, "F is the same everywhere"},
    };
    static const struct {
        const char *text;
        size_t column;
        const char *says;
    } sags[] = {
        {"x+z", 3, "a sag has no z"},
        {"z = x^2", 1, "a sag has no z"},
        {"x = y", 3, "a sag has no ="},
        {"q", 1, "there are x, y, r, pi, a"},
    };
    sgt_error error;
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        REQUIRE(!read_in(rows[i].text, SGT_FORMULA_XYZ, 0, &error), "%s: no error", rows[i].text);
        REQUIRE(error.column == rows[i].column && strstr(error.words, rows[i].says), "%s: column %d: %s",
                rows[i].text, (int)error.column, error.words);
    }
    for (size_t i = 0; i < COUNT_OF(sags); i++) {
        REQUIRE(!read_in(sags[i].text, SGT_FORMULA_XY, 0, &error), "%s: no error", sags[i].text);
        REQUIRE(error.column == sags[i].column && strstr(error.words, sags[i].says), "%s: column %d: %s",
                sags[i].text, (int)error.column, error.words);
    }
    /* Each byte that no formula has is told as what it is. */
    for (int c = 1; c < 256; c++) {
        if (isalnum(c) || strchr("_ \t\n\r+-*/^(),.=", c)) continue;
        const char text[] = {'x', '+', (char)c, 0}, *says = c >= 0x80 ? "only ASCII"
                                                            : c < ' ' || c > '~'
                                                                ? "a control character"
                                                                : " has no meaning in a formula";
        REQUIRE(!read_in(text, SGT_FORMULA_XYZ, 0, &error), "byte %02x: no error", c);
        REQUIRE(error.column == 3 && strstr(error.words, says), "byte %02x: column %d: %s", c,
                (int)error.column, error.words);
    }
    REQUIRE(!sgt_formula_read("2x", SGT_FORMULA_XYZ, 0, NULL, NULL, 0, NULL), "no error wanted");
    REQUIRE(!sgt_formula_read(NULL, SGT_FORMULA_XYZ, 0, NULL, NULL, 0, &error), "no text");
    REQUIRE(sgt_formula_room(NULL, 0) == sgt_formula_room("", 0), "no text is no formula");
    REQUIRE(read_in("3*a", SGT_FORMULA_XY, 0, &error) != NULL, "a sag may be a number: %s", error.words);
}

static void test_parameters(void **state)
{
    (void)state;
    static const struct {
        sgt_named given[2];
        const char *says;
    } rows[] = {
        {{{"x", 1}, {"q", 1}}, "the parameter x has a meaning of its own"},
        {{{"q", 1}, {"z", 1}}, "the parameter z has a meaning of its own"},
        {{{"q", 1}, {"r", 1}}, "the parameter r has"},
        {{{"q", 1}, {"pi", 1}}, "the parameter pi has"},
        {{{"sin", 1}, {"q", 1}}, "the parameter sin has"},
        {{{"2a", 1}, {"q", 1}}, "the parameter 2a is no name: a letter, then letters, digits and _"},
        {{{"_a", 1}, {"q", 1}}, "is no name"},
        {{{"a b", 1}, {"q", 1}}, "is no name"},
        {{{"", 1}, {"q", 1}}, "is no name"},
        {{{NULL, 1}, {"q", 1}}, "is no name"},
        {{{"q", 1}, {"q", 2}}, "the parameter q is given twice"},
        {{{"q", 1}, {"p", (double)NAN}}, "the parameter p is not finite"},
        {{{"q", (double)INFINITY}, {"p", 1}}, "the parameter q is not finite"},
        {{{"q\n\xc3", 1}, {"p", 1}}, "the parameter q?? is no name"},
    };
    static double room[2000];
    static sgt_named many[SGT_MOST_FORMULA_PARAMETERS + 1];
    static char names[SGT_MOST_FORMULA_PARAMETERS + 1][8];
    sgt_error error;
    for (size_t i = 0; i < COUNT_OF(rows); i++)
        for (int kind = SGT_FORMULA_XYZ; kind <= SGT_FORMULA_XY; kind++) {
            error = (sgt_error){.column = 77};
            REQUIRE(
                !sgt_formula_read("x+y", (sgt_formula_kind)kind, 2, rows[i].given, room, sizeof room, &error),
                "row %zu: no error", i);
            REQUIRE(error.column == 0 && strstr(error.words, rows[i].says), "row %zu: column %d: %s", i,
                    (int)error.column, error.words);
        }
    for (int i = 0; i <= SGT_MOST_FORMULA_PARAMETERS; i++)
        sprintf(names[i], "p%d", i), many[i] = (sgt_named){names[i], i};
    sgt_tape *t = sgt_formula_read("x+p255", SGT_FORMULA_XYZ, SGT_MOST_FORMULA_PARAMETERS, many, room,
                                   sizeof room, &error);
    REQUIRE(t && tape_value(t, (const long double[]){1, 0, 0}) == 256, "256 parameters: %s", error.words);
    REQUIRE(!sgt_formula_read("x+p255", SGT_FORMULA_XYZ, SGT_MOST_FORMULA_PARAMETERS + 1, many, room,
                              sizeof room, &error) &&
                strstr(error.words, "more than 256 parameters"),
            "257 parameters: %s", error.words);
    REQUIRE(sgt_formula_room("x", SGT_MOST_FORMULA_PARAMETERS + 1) == 0, "the room for 257 parameters");
}

/* ------------------------------------------------- equal parts, simpler parts */

static void test_shared(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int steps;
        formula_op op;
        int many;
    } rows[] = {
        {"x", 1, FORMULA_COPY, 1},
        {"x^2 + x^2*y", 3, FORMULA_SQUARE, 1},
        {"sin(x*y) + cos(y*x)", 4, FORMULA_MUL, 1},
        {"(x+y)*(y+x)", 2, FORMULA_SQUARE, 1},
        {"min(x,y) - min(y,x)", 2, FORMULA_MIN, 1},
        {"hypot(x,z) + hypot(z,-x)", 2, FORMULA_HYPOT, 1},
        {"sqrt(z*y) * sqrt(y*z)", 3, FORMULA_SQRT, 1},
        {"x*2*pi - 2*x*pi", 3, FORMULA_MUL, 2},
        {"0.1*x - 0.10*x", 2, FORMULA_MUL, 1},
        {"x*1 + 0 - 0", 1, FORMULA_COPY, 1},
        {"1*x/1", 1, FORMULA_COPY, 1},
        {"x^1", 1, FORMULA_COPY, 1},
        {"--x", 1, FORMULA_COPY, 1},
        {"-(-x)*y", 1, FORMULA_MUL, 1},
        {"x*x", 1, FORMULA_SQUARE, 1},
        {"x*x*x*x^2", 1, FORMULA_POWER, 1},
        {"x^3/2", 2, FORMULA_MUL, 1},
        {"x/3", 1, FORMULA_DIV, 1},
        {"x^0.5", 1, FORMULA_SQRT, 1},
        {"x^-1.5", 2, FORMULA_POWER, 1},
        {"x^2.5", 1, FORMULA_HALF_POWER, 1},
        {"sqrt(x)^3", 1, FORMULA_HALF_POWER, 1},
        {"(x^2)^1.5", 2, FORMULA_ABS, 1},
        {"x^(1/3)", 1, FORMULA_REAL_POWER, 1},
        {"x^k2", 1, FORMULA_REAL_POWER, 1},
        {"x^(2*k2)", 1, FORMULA_REAL_POWER, 1},
        {"x - x", 1, FORMULA_SUB, 1},
        {"0*x", 1, FORMULA_MUL, 1},
        {"sqrt(x)^2", 2, FORMULA_SQUARE, 1},
        {"sqrt(x^2)", 1, FORMULA_ABS, 1},
        {"abs(x)^2", 1, FORMULA_SQUARE, 1},
        {"abs(x)^4 + (-x)^4", 2, FORMULA_POWER, 1},
        {"abs(sqrt(x))", 1, FORMULA_SQRT, 1},
        {"cos(-x) - cos(x)", 2, FORMULA_COS, 1},
        {"sin(-x) + sin(x)", 2, FORMULA_SIN, 1},
        {"x^0*y", 1, FORMULA_COPY, 1},
        {"log(x)^0 + y", 4, FORMULA_LOG, 1},
        {"(x^-2)^0 + y", 4, FORMULA_POWER, 1},
        {"sqrt(x^2 + y^2)", 1, FORMULA_HYPOT, 1},
        {"sqrt(x^2 + a^2)", 3, FORMULA_SQRT, 1},
        {"r^2", 3, FORMULA_HYPOT, 0},
        {"r*r - x^2", 4, FORMULA_HYPOT, 0},
        {"sqrt(x*x + y*y)^4", 4, FORMULA_HYPOT, 0},
        {"hypot(x, z)^2", 3, FORMULA_HYPOT, 0},
        {"r^3", 2, FORMULA_POWER, 1},
        {"r^-2", 4, FORMULA_HYPOT, 0},
        {"(x^2+y^2)*cos(2*atan2(y,x))", 3, FORMULA_COS, 0},
        {"x*(2+3)*(4-3)", 1, FORMULA_MUL, 1},
    };
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        const sgt_tape *t = tape_of(rows[i].text);
        REQUIRE(t->steps == rows[i].steps && tape_count(t, rows[i].op) == rows[i].many,
                "%s: %d steps, %d of the kind", rows[i].text, t->steps, tape_count(t, rows[i].op));
    }
    /* constants are numbers where they are exact, and intervals where not */
    REQUIRE(tape_of("x*(1/4 + sqrt(4))")->uniforms == 1, "2.25");
    const sgt_tape *t = tape_of("x*(1/3)");
    REQUIRE(t->uniforms == 3 && t->value[2].lo < t->value[2].hi, "1/3 is an interval");
    const double below_pi = 3.141592653589793; /* the double nearest to pi is below it */
    t = tape_of("x*pi");
    REQUIRE(t->uniforms == 1 && t->value[0].lo == below_pi && t->value[0].hi == nextafter(below_pi, 4),
            "pi is an interval");
}

/* r^n cos(n theta): where they become polynomials, where not, and their values, which are those of the text.
 */
static void test_polar(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int angles, roots;
    } rows[] = {
        {"r^2*cos(2*atan2(y,x))", 0, 0},
        {"r*cos(atan2(y,x))", 0, 0},
        {"r*sin(atan2(y,x)) - y*1", 0, 0},
        {"cos(3*atan2(y,x))*a*r^3", 0, 0},
        {"a*r^4*cos(3*atan2(y,x))", 0, 1},
        {"a*r^5*cos(3*atan2(y,x))/b", 0, 0},
        {"r*x*r*sin(atan2(y,x)*2)*z", 0, 0},
        {"-r^3*sin(-3*atan2(y,x))", 0, 0},
        {"r^3*cos(-atan2(y,x)*3)", 0, 0},
        {"(r^2*cos(2*atan2(y,x)))^3", 0, 0},
        {"r^6*cos(2*atan2(y,x))^3", 0, 0},
        {"r^5*cos(2*atan2(y,x))^3", 1, 1},
        {"(a*r)^2*cos(2*atan2(y,x))", 0, 0},
        {"r^2*(a*cos(2*atan2(y,x)))", 0, 0},
        {"sqrt(x^2+y^2)^2*cos(2*atan2(y,x))", 0, 0},
        {"r^3*cos(atan2(y,x))*cos(2*atan2(y,x))", 0, 0},
        {"r^3*cos(2*atan2(y,x))*cos(2*atan2(y,x))", 1, 1},
        {"r^64*cos(64*atan2(y,x))", 0, 0},
        {"r^70*sin(63*atan2(y,x))", 0, 1},
        {"r^65*cos(65*atan2(y,x))", 1, 1},
        {"r*cos(2*atan2(y,x))", 1, 1},
        {"r^2*cos(2*atan2(x,y))", 1, 0},
        {"r^2*cos(a*atan2(y,x))", 1, 0},
        {"r^2*cos(1.5*atan2(y,x))", 1, 0},
        {"r^4/r^2*cos(2*atan2(y,x))", 0, 0},
        {"r^2/(1+z)*cos(2*atan2(y,x))", 0, 0},
        {"x/r^2*cos(2*atan2(y,x))", 1, 0},
        {"r^2*(1+cos(2*atan2(y,x)))", 1, 0},
        {"r^2*cos(2*atan2(y,x)+a)", 1, 0},
        {"cos(2*atan2(y,x))", 1, 0},
        {"r^2", 0, 0},
        {"r^4 - r^6/a", 0, 0},
        {"1/r^2", 0, 0},
        {"r^3", 0, 1},
    };
    generator g = seeded("polar");
    char formula[200];
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        const sgt_tape *t = tape_of(rows[i].text);
        REQUIRE(tape_count(t, FORMULA_ATAN2) == rows[i].angles &&
                    tape_count(t, FORMULA_HYPOT) == rows[i].roots,
                "%s: %d angles, %d roots", rows[i].text, tape_count(t, FORMULA_ATAN2),
                tape_count(t, FORMULA_HYPOT));
    }
    for (int n = 1; n <= 64; n++)
        for (int sine = 0; sine < 2; sine++)
            for (int more = 0; more < 3; more++) {
                sprintf(formula, "r^%d*%s(%d*atan2(y,x))", n + more, sine ? "sin" : "cos", n);
                const sgt_tape *t = tape_of(formula);
                REQUIRE(tape_count(t, FORMULA_ATAN2) == 0 && tape_count(t, FORMULA_HYPOT) == (more == 1),
                        "%s", formula);
                REQUIRE(tape_value(t, (const long double[]){0, 0, 0}) == 0, "%s is not 0 at the vertex",
                        formula);
                for (int k = 0; k < 20; k++) {
                    long double x = (long double)uniform(&g, -1.5, 1.5),
                                y = (long double)uniform(&g, -1.5, 1.5);
                    long double r = hypotl(x, y), size = powl(r, n + more), angle = n * atan2l(y, x);
                    long double want = size * (sine ? sinl(angle) : cosl(angle));
                    long double got = tape_value(t, (const long double[]){x, y, 0});
                    REQUIRE(fabsl(got - want) <= 1e-17L * n * size, "%s at %Lg, %Lg: %Lg, not %Lg", formula,
                            x, y, got, want);
                }
            }
    const sgt_tape *t = tape_of("r^3*cos(3*atan2(y,x)) + r^3*sin(3*atan2(y,x))");
    REQUIRE(tape_count(t, FORMULA_SQUARE) == 2 && t->steps <= 9, "cosine and sine share: %d steps", t->steps);
}

/* ---------------------------------------------------------------- registers */

/* The text `first`, then n times `part`, then n times `last`. */
static const char *repeated(const char *first, const char *part, int n, const char *middle, const char *last)
{
    length = 0;
    put(first);
    for (int i = 0; i < n; i++) put(part);
    put(middle);
    for (int i = 0; i < n; i++) put(last);
    return written;
}

static void full_tree(int depth, int *number)
{
    char text[40];
    if (depth == 0) {
        sprintf(text, "sin(%d*x)", ++*number);
        put(text);
        return;
    }
    put("("), full_tree(depth - 1, number), put(depth % 2 ? "*" : "+"), full_tree(depth - 1, number),
        put(")");
}

static void test_registers(void **state)
{
    (void)state;
    sgt_error error;
    /* chains as deep as may be, and as long */
    const sgt_tape *t = tape_of(repeated("", "x+(y*(", 99, "z", "))"));
    REQUIRE(t->registers <= 5, "a chain to the right: %d registers", t->registers);
    t = tape_of(repeated("", "sin(", 199, "z", ")"));
    REQUIRE(t->steps == 199 && t->registers <= 5, "functions: %d registers", t->registers);
    t = tape_of(repeated("x", "+sin(x+z)*y", 2500, "", ""));
    REQUIRE(t->registers <= 7, "a wide sum: %d registers", t->registers);
    length = 0;
    for (int i = 0; i < 1000; i++) {
        char text[40];
        sprintf(text, "%ssin(%d*x)*cos(%d*y)", i ? "+" : "", i % 700 + 2, i % 300 + 2);
        put(text);
    }
    t = read_in(written, SGT_FORMULA_XYZ, 0, &error);
    REQUIRE(!t && error.column == 0 &&
                strstr(error.words, "intermediate results at once, and there may be 45"),
            "1000 terms that share much: %s", error.words);
    /* a full tree of 2^10 leaves needs 11 registers and one for the result, if nothing is shared */
    int number = 0;
    length = 0;
    full_tree(9, &number);
    t = tape_of(written);
    REQUIRE(t->registers <= 3 + 11, "a full tree: %d registers", t->registers);
    /* 44 parts that are needed again later, and too many of them */
    for (int n = 40; n <= 50; n += 10) {
        length = 0;
        for (int pass = 0; pass < 2; pass++) {
            put(pass ? ")*(0" : "x*(1");
            for (int i = 0; i < n; i++) {
                char text[40];
                sprintf(text, pass ? "+y^%d*sin(%d*x)" : "-z*sin(%d*x)", pass ? i + 2 : i + 2, i + 2);
                put(text);
            }
        }
        put(")");
        t = read_in(written, SGT_FORMULA_XYZ, 0, &error);
        if (n == 40)
            REQUIRE(t, "40 shared parts: %s", error.words);
        else
            REQUIRE(!t && strstr(error.words, "intermediate results at once"), "50 shared parts: %s",
                    error.words);
    }
}

/* --------------------------------------------------------------- large texts */

static void test_large(void **state)
{
    (void)state;
    sgt_error error;
    static char text[100001];
    static double room[1 << 20];
    /* 10^5 characters */
    memset(text, '1', 100000);
    REQUIRE(sgt_formula_room(text, 0) == 0, "a room for 10^5 characters");
    REQUIRE(!sgt_formula_read(text, SGT_FORMULA_XYZ, 0, NULL, room, sizeof room, &error) &&
                error.column == SGT_LONGEST_FORMULA + 1 && strstr(error.words, "at most 32768 characters"),
            "10^5 characters: %s", error.words);
    /* one less than too many is a number that is too large */
    text[SGT_LONGEST_FORMULA] = 0;
    REQUIRE(!read_in(text, SGT_FORMULA_XYZ, 0, &error) && error.column == 1, "32768 digits: %s", error.words);
    /* 10^4 parentheses, functions, powers; any number of minuses */
    static const struct {
        const char *part;
        size_t column;
    } deep[] = {{"(", 201},           {"sin(", 4 * 200 + 1},    {"x^", 2 * 200 + 2},
                {"-(", 2 * 200 + 2},  {"x*(", 3 * 200 + 3},     {"hypot(x,", 8 * 200 + 1},
                {"x^(", 3 * 100 + 2}, {"x+y*z^-(", 8 * 100 + 6}};
    for (size_t i = 0; i < COUNT_OF(deep); i++) {
        repeated("", deep[i].part, (int)(10000 / strlen(deep[i].part)), "x", "");
        REQUIRE(!read_in(written, SGT_FORMULA_XYZ, 0, &error) && error.column == deep[i].column &&
                    strstr(error.words, "nested more than 200 deep"),
                "many %s: column %d: %s", deep[i].part, (int)error.column, error.words);
    }
    const sgt_tape *t = tape_of(repeated("", "-", 10001, "x", ""));
    REQUIRE(t->steps == 1 && t->step[0].op == FORMULA_NEG, "10001 minuses");
    repeated("", "(", 200, "x", ")");
    REQUIRE(tape_of(written)->steps == 1, "200 parentheses");
    /* the longest text, of different parts */
    length = 0;
    put("x");
    for (int i = 0; length < SGT_LONGEST_FORMULA - 30; i++) {
        char part[40];
        sprintf(part, "+sin(x*y+%d)/%d", i % 800, i % 800 + 1);
        put(part);
    }
    t = read_in(written, SGT_FORMULA_XYZ, 0, &error);
    REQUIRE(t || strstr(error.words, "at once") || strstr(error.words, "there may be 1024"),
            "the longest: %s", error.words);
    /* as many numbers as there may be, and one more */
    for (int n = FORMULA_UNIFORMS; n <= FORMULA_UNIFORMS + 1; n++) {
        length = 0;
        put("0");
        for (int i = 0; i < n; i++) {
            char part[40];
            sprintf(part, "+x*%d.5", i);
            put(part);
        }
        t = read_in(written, SGT_FORMULA_XYZ, 0, &error);
        if (n == FORMULA_UNIFORMS)
            REQUIRE(t && t->uniforms == n, "%d numbers: %s", n, error.words);
        else
            REQUIRE(!t && error.column == 0 && strstr(error.words, "has 1025 numbers"), "1025: %s",
                    error.words);
    }
    /* waves: as many nodes as they can make */
    length = 0;
    put("x");
    for (int i = 0; length < SGT_LONGEST_FORMULA - 60; i++) {
        char part[60];
        sprintf(part, "+r^%d*%s(%d*atan2(y,x))", 63 - i % 60, i % 2 ? "sin" : "cos", 63 - i % 60);
        put(part);
    }
    t = read_in(written, SGT_FORMULA_XYZ, 0, &error);
    REQUIRE(t || strstr(error.words, "at once"), "many waves: %s", error.words);
}

/* A room that is too small is said to be, and how much is missing; and nothing is written beyond it. */
static void test_rooms(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "x",
        "x^2 + y^2 + z^2 = a",
        "a*r^4*cos(3*atan2(y,x)) + z^1.5/b",
        "sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x)",
        "r^63*cos(63*atan2(y,x))",
    };
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        sgt_error error;
        size_t all = sgt_formula_room(texts[i], PARAMETERS), refused = 0;
        char missing[40];
        for (size_t less = 0; less < all; less++) {
            sgt_tape *t = read_in(texts[i], SGT_FORMULA_XYZ, less, &error);
            REQUIRE(t || less > 0, "%s: %s", texts[i], error.words);
            if (t) continue;
            refused++;
            sprintf(missing, " %zu more suffice", less);
            REQUIRE(error.column == 0 && strstr(error.words, "the room is too small") &&
                        strstr(error.words, missing),
                    "%s, %zu less: column %d: %s", texts[i], less, (int)error.column, error.words);
        }
        REQUIRE(refused > all / 8, "%s: only %zu of %zu rooms are too small", texts[i], refused, all);
        REQUIRE(!sgt_formula_read(texts[i], SGT_FORMULA_XYZ, PARAMETERS, parameters, NULL, all, &error) &&
                    strstr(error.words, "room"),
                "no room");
    }
}

/* ------------------------------------------------------------------ other values */

static void test_set(void **state)
{
    (void)state;
    static const char *const text = "a*x + b^2*y + sqrt(k2)*z + exp(long_name)/a";
    double values[PARAMETERS] = {2, 3, 4, 0}, bad[PARAMETERS] = {7, 7, 7, NOT};
    static const long double point[3] = {1, 2, 3};
    sgt_tape *t = tape_of(text);
    long double before = tape_value(t, point), want = 1.5L + 2 / 16.0L + sqrtl(3) * 3 + expl(0.75L) / 1.5L;
    REQUIRE(fabsl(before - want) < 1e-17L * 40, "%Lg, not %Lg", before, want);
    sgt_error error;
    bad[3] = NOT;
    REQUIRE(!sgt_formula_set(t, bad, &error) && tape_value(t, point) == before,
            "a NaN is refused, and nothing changed");
    REQUIRE(strcmp(error.words, "value 4 is not finite") == 0 && !*error.file, "%s", error.words);
    bad[3] = FAR;
    REQUIRE(!sgt_formula_set(t, bad, NULL) && t->given[0] == 1.5 && tape_value(t, point) == before,
            "so is infinity");
    REQUIRE(sgt_formula_set(t, values, NULL), "other values");
    tape_check(t);
    REQUIRE(tape_value(t, point) == 2 + 18 + 6 + 0.5L, "%Lg", tape_value(t, point));
    /* as if it had been read with them */
    sgt_named given[PARAMETERS];
    static double room[2000];
    for (int i = 0; i < PARAMETERS; i++) given[i] = (sgt_named){parameters[i].name, values[i]};
    sgt_tape *other = sgt_formula_read(text, SGT_FORMULA_XYZ, PARAMETERS, given, room, sizeof room, NULL);
    REQUIRE(other && other->uniforms == t->uniforms, "read anew");
    for (int i = 0; i < t->uniforms; i++)
        REQUIRE(same_bits(t->value[i].lo, other->value[i].lo) &&
                    same_bits(t->value[i].hi, other->value[i].hi) &&
                    same_bits(t->middle[i], other->middle[i]),
                "uniform %d", i);
    /* not defined any more: 1/0, sqrt(-1); the middle is NaN */
    values[0] = 0, values[2] = -1;
    REQUIRE(sgt_formula_set(t, values, NULL), "no error: these values are finite");
    tape_check(t);
    int undefined = 0;
    for (int i = 0; i < t->uniforms; i++) undefined += isnan(t->middle[i]);
    REQUIRE(undefined == 2, "%d undefined uniforms", undefined);
    REQUIRE(isnan(tape_value(t, point)), "F is not defined");
    REQUIRE(sgt_formula_set(tape_of("x+y"), bad, NULL) == false, "parameters that are not used are checked");
}

/* The value is in the interval, which is as narrow as it may be. */
static void test_intervals(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "x^4 + y^4 + z^4 = a",
        "exp(x)*sin(y/3)*pi + log(2+z^2)/7",
        "r^3*cos(2*atan2(y,x)) + tan(x)^3",
        "hypot(x, z)^k2 + atan2(x*y, z) + cbrt(x)",
        "min(x, y/3)*max(z, 1/7) + abs(x - 0.1) + x^(1/3)*2^y",
        "asin(x/9) + acos(y/9) + atan(z) + sinh(x) + cosh(y) + tanh(z) + sqrt(2 + x^-3)",
    };
    generator g = seeded("intervals of tapes");
    long n = scaled(4000);
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        const sgt_tape *t = tape_of(texts[i]);
        for (long k = 0; k < n; k++) {
            sgt_vec3 p = random_point(&g, 3);
            long double v =
                tape_value(t, (const long double[]){(long double)p.x, (long double)p.y, (long double)p.z});
            sgt_interval r = tape_interval(t, p);
            if (isnan(v)) continue;
            long double width = (long double)r.hi - (long double)r.lo;
            REQUIRE(v >= (long double)r.lo - 0.01L * width && v <= (long double)r.hi + 0.01L * width,
                    "%s at %g, %g, %g: %Lg is not in [%a, %a]", texts[i], p.x, p.y, p.z, v, r.lo, r.hi);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_trees),      cmocka_unit_test(test_precedence), cmocka_unit_test(test_errors),
        cmocka_unit_test(test_parameters), cmocka_unit_test(test_shared),     cmocka_unit_test(test_polar),
        cmocka_unit_test(test_registers),  cmocka_unit_test(test_large),      cmocka_unit_test(test_rooms),
        cmocka_unit_test(test_set),        cmocka_unit_test(test_intervals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

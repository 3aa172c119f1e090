// SPDX-License-Identifier: MIT
/* grammar.c - a text as the nodes of a graph.
 *
 * The text is read once, from left to right, with one word of foresight: each rule of the grammar (formula.h)
 * is told from the others by its first word.  So there is one function for sums and one for factors, which
 * call each other (Wirth 1976, Algorithms + Data Structures = Programs, 5).  Terms need none: a sum keeps the
 * term it is in.  How deep the functions call each other is counted, and so their stack has a bound.
 *
 * Each operation goes into the graph at once (graph.c), products by way of polar.c.
 *
 * FAULTS.  The first one is told.  After it the word is the end of the text for all, so each function
 * returns.
 *
 * Test: tests/unit/test_formula.c. */
#include "grammar.h"

typedef struct formula_function {
    const char *name;
    formula_op op;
    int arguments;
} formula_function;
static const formula_function functions[] = {
    {"sqrt", FORMULA_SQRT, 1}, {"cbrt", FORMULA_CBRT, 1},   {"exp", FORMULA_EXP, 1},
    {"log", FORMULA_LOG, 1},   {"sin", FORMULA_SIN, 1},     {"cos", FORMULA_COS, 1},
    {"tan", FORMULA_TAN, 1},   {"asin", FORMULA_ASIN, 1},   {"acos", FORMULA_ACOS, 1},
    {"atan", FORMULA_ATAN, 1}, {"sinh", FORMULA_SINH, 1},   {"cosh", FORMULA_COSH, 1},
    {"tanh", FORMULA_TANH, 1}, {"abs", FORMULA_ABS, 1},     {"min", FORMULA_MIN, 2},
    {"max", FORMULA_MAX, 2},   {"hypot", FORMULA_HYPOT, 2}, {"atan2", FORMULA_ATAN2, 2},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };
static const char *const variables[] = {"x", "y", "z", "r", "pi"};
enum { VARIABLE_Z = 2, VARIABLE_R, VARIABLE_PI, VARIABLES };

static const formula_function *function_named(const char *text, size_t length)
{
    for (int i = 0; i < FUNCTIONS; i++)
        if (sgt_scan_is(text, length, functions[i].name)) return functions + i;
    return NULL;
}

static int variable_named(const char *text, size_t length)
{
    for (int i = 0; i < VARIABLES; i++)
        if (sgt_scan_is(text, length, variables[i])) return i;
    return -1;
}

bool sgt_grammar_reserves(const char *name, size_t length)
{
    return variable_named(name, length) >= 0 || function_named(name, length);
}

/* ------------------------------------------------------------------- names */

/* What users write who have another language in mind. */
static const struct {
    const char *name, *instead;
} elsewhere[] = {
    {"ln", "log(u)"},
    {"pow", "u^v"},
    {"sqr", "u^2"},
    {"fabs", "abs(u)"},
    {"arcsin", "asin(u)"},
    {"arccos", "acos(u)"},
    {"arctan", "atan(u)"},
    {"arctan2", "atan2(y, x)"},
    {"phi", "atan2(y, x)"},
    {"theta", "atan2(y, x)"},
    {"rho", "r"},
    {"PI", "pi"},
    {"Pi", "pi"},
    {"e", "exp(1)"},
    {"fmin", "min(u, v)"},
    {"fmax", "max(u, v)"},
    {"log10", "log(u)/log(10)"},
    {"log2", "log(u)/log(2)"},
    {"X", "x"},
    {"Y", "y"},
    {"Z", "z"},
    {"R", "r"},
};

static void name_unknown(formula_reader *r)
{
    const formula_scan *s = &r->scan;
    const char *name = s->text + s->start;
    formula_fault *f = sgt_formula_blame(&r->fault, sgt_scan_column(s));
    f = sgt_formula_say(sgt_formula_say_part(f, name, s->length), " is not known");
    for (size_t i = 0; i < sizeof elsewhere / sizeof *elsewhere; i++)
        if (sgt_scan_is(name, s->length, elsewhere[i].name)) {
            sgt_formula_say(sgt_formula_say(f, ": write "), elsewhere[i].instead);
            return;
        }
    if (s->text[s->at] == '(') {
        f = sgt_formula_say(f, "; functions:");
        for (int i = 0; i < FUNCTIONS; i++) sgt_formula_say(sgt_formula_say(f, " "), functions[i].name);
        return;
    }
    f = sgt_formula_say(f,
                        r->kind == SGT_FORMULA_XY ? "; there are x, y, r, pi" : "; there are x, y, z, r, pi");
    for (size_t i = 0; i < r->names && i < 8; i++) sgt_formula_say(sgt_formula_say(f, ", "), r->name[i].name);
    if (r->names > 8) sgt_formula_say(f, ", ...");
}

static polar_value read_name(formula_reader *r)
{
    const formula_scan *s = &r->scan;
    const char *name = s->text + s->start;
    size_t which = 0;
    int node = 0, variable = variable_named(name, s->length);
    while (which < r->names && !sgt_scan_is(name, s->length, r->name[which].name)) which++;
    if (variable == VARIABLE_Z && r->kind == SGT_FORMULA_XY)
        sgt_formula_say(sgt_formula_blame(&r->fault, sgt_scan_column(s)),
                        "a sag has no z: it is s(x, y) in z = s(x, y)");
    else if (variable == VARIABLE_PI)
        node = sgt_graph_pi(&r->graph);
    else if (variable == VARIABLE_R)
        node = sgt_graph_of(&r->graph, FORMULA_HYPOT, 0, 1);
    else if (variable >= 0)
        node = variable;
    else if (which < r->names)
        node = sgt_graph_parameter(&r->graph, (int)which);
    else
        name_unknown(r);
    sgt_scan_next(&r->scan);
    return sgt_polar_of(&r->graph, &r->waves, node);
}

/* ----------------------------------------------------------------- grammar */

static polar_value read_sum(formula_reader *r, size_t open);

static bool reader_goes_deeper(formula_reader *r)
{
    if (r->depth < SGT_DEEPEST_FORMULA) return r->depth++, true;
    formula_fault *f = sgt_formula_blame(&r->fault, sgt_scan_column(&r->scan));
    f = sgt_formula_say(f, "parentheses and powers are nested more than ");
    sgt_formula_say(sgt_formula_say_number(f, SGT_DEEPEST_FORMULA), " deep");
    r->scan.word = WORD_END;
    return false;
}

static void arguments_wrong(formula_reader *r, const formula_function *function)
{
    formula_fault *f = sgt_formula_blame(&r->fault, sgt_scan_column(&r->scan));
    f = sgt_formula_say(f, function->name);
    f = sgt_formula_say(f, function->arguments == 1 ? " takes one argument" : " takes two arguments");
    if (function->op == FORMULA_ATAN2)
        sgt_formula_say(f, ", y and x");
    else if (function->arguments == 1)
        sgt_formula_say(f, "; decimals have a point, not a comma");
}

static polar_value read_function(formula_reader *r, const formula_function *function)
{
    int argument[2] = {0, 0};
    size_t column = sgt_scan_column(&r->scan), open;
    sgt_scan_next(&r->scan);
    if (r->scan.word != '(') {
        formula_fault *f = sgt_formula_blame(&r->fault, sgt_scan_column(&r->scan));
        f = sgt_formula_say(sgt_formula_say(f, "expected ( after "), function->name);
        sgt_formula_say(f, ", as in ");
        f = sgt_formula_say(f, function->name);
        sgt_formula_say(f, function->arguments == 1 ? "(x)" : "(y, x)");
    }
    open = sgt_scan_column(&r->scan);
    sgt_scan_next(&r->scan);
    for (int i = 0; i < function->arguments; i++) {
        argument[i] = sgt_polar_node(&r->graph, &r->waves, read_sum(r, open));
        if (r->scan.word != (i == function->arguments - 1 ? ')' : ',')) arguments_wrong(r, function);
        sgt_scan_next(&r->scan);
    }
    r->graph.column = column;
    return sgt_polar_of(&r->graph, &r->waves,
                        sgt_graph_of(&r->graph, function->op, argument[0], argument[1]));
}

/* A number, a name, a function or a sum in parentheses. */
static polar_value read_atom(formula_reader *r)
{
    polar_value value = {.rest = 0, .first = -1};
    const formula_scan *s = &r->scan;
    const formula_function *function =
        s->word == WORD_NAME ? function_named(s->text + s->start, s->length) : NULL;
    if (s->word == WORD_NUMBER) {
        value.rest = sgt_graph_number(&r->graph, s->number);
        sgt_scan_next(&r->scan);
    } else if (s->word == WORD_NAME && !function) {
        value = read_name(r);
    } else if (s->word != WORD_NAME && s->word != '(') {
        sgt_scan_expected(s, "a number, a name or (");
        r->scan.word = WORD_END;
    } else if (reader_goes_deeper(r)) {
        if (function) {
            value = read_function(r, function);
        } else {
            size_t open = sgt_scan_column(s);
            sgt_scan_next(&r->scan);
            value = read_sum(r, open);
            if (s->word == ',')
                sgt_formula_say(sgt_formula_blame(&r->fault, sgt_scan_column(s)),
                                "a comma stands between arguments only; decimals have a point");
            sgt_scan_next(&r->scan);
        }
        r->depth--;
    }
    return value;
}

/* A power with its minus: -x^2 is -(x^2). */
static polar_value read_factor(formula_reader *r)
{
    bool negative = false;
    for (; r->scan.word == '-'; sgt_scan_next(&r->scan)) negative = !negative;
    polar_value value = read_atom(r);
    if (r->scan.word == '^' && reader_goes_deeper(r)) {
        size_t column = sgt_scan_column(&r->scan);
        sgt_scan_next(&r->scan);
        polar_value exponent = read_factor(r);
        r->graph.column = column;
        value = sgt_polar_power(&r->graph, &r->waves, value, exponent);
        r->depth--;
    }
    return negative ? sgt_polar_negative(&r->graph, value) : value;
}

/* What follows a sum has to end it.  open: the column of its parenthesis, or 0. */
static void sum_ends(formula_reader *r, size_t open)
{
    const formula_scan *s = &r->scan;
    formula_fault *f;
    if (r->fault.found || s->word == ',' || (s->word == ')' && open) || (s->word == WORD_END && !open))
        return;
    if (s->word == '=' && !open) return;
    f = sgt_formula_blame(&r->fault, sgt_scan_column(s));
    if (s->word == ')') {
        sgt_formula_say(f, "this ) has no (");
    } else if (s->word == '=') {
        sgt_formula_say(f, "= stands between two sums, not within parentheses");
    } else if (s->word == WORD_END) {
        f = sgt_formula_say_number(sgt_formula_say(f, "expected ), as there is a ( in column "), open);
    } else {
        f = sgt_formula_say(f, "expected an operator before ");
        f = sgt_formula_say_part(f, s->text + s->start, s->length);
        sgt_formula_say(f, ": write * to multiply");
    }
}

static polar_value read_sum(formula_reader *r, size_t open)
{
    formula_graph *g = &r->graph;
    polar_value sum = {.rest = 0, .first = -1};
    size_t column = 0;
    for (int sign = 0;; column = sgt_scan_column(&r->scan), sgt_scan_next(&r->scan)) {
        polar_value term = read_factor(r);
        while (r->scan.word == '*' || r->scan.word == '/') {
            bool quotient = r->scan.word == '/';
            size_t here = sgt_scan_column(&r->scan);
            sgt_scan_next(&r->scan);
            if (!quotient && r->scan.word == '*')
                sgt_formula_say(sgt_formula_blame(&r->fault, here), "a power is written with ^, not **");
            polar_value factor = read_factor(r);
            g->column = here;
            term = quotient ? sgt_polar_quotient(g, &r->waves, term, factor)
                            : sgt_polar_product(g, &r->waves, term, factor);
        }
        g->column = column;
        if (sign) {
            int a = sgt_polar_node(g, &r->waves, sum), b = sgt_polar_node(g, &r->waves, term);
            sum = sgt_polar_of(g, &r->waves, sgt_graph_of(g, sign == '+' ? FORMULA_ADD : FORMULA_SUB, a, b));
        } else {
            sum = term;
        }
        sign = r->scan.word;
        if (sign != '+' && sign != '-') break;
    }
    sum_ends(r, open);
    return sum;
}

int sgt_grammar_read(formula_reader *r)
{
    formula_scan *s = &r->scan;
    sgt_scan_next(s);
    if (s->word == WORD_END) sgt_formula_say(sgt_formula_blame(&r->fault, 1), "there is no formula");
    int node = sgt_polar_node(&r->graph, &r->waves, read_sum(r, 0));
    if (s->word == '=' && r->kind == SGT_FORMULA_XY) {
        sgt_formula_say(sgt_formula_blame(&r->fault, sgt_scan_column(s)),
                        "a sag has no =: it is s(x, y) in z = s(x, y)");
    } else if (s->word == '=') {
        size_t column = sgt_scan_column(s);
        sgt_scan_next(s);
        if (s->word == '=')
            sgt_formula_say(sgt_formula_blame(&r->fault, sgt_scan_column(s)), "one = is meant, not two");
        int other = sgt_polar_node(&r->graph, &r->waves, read_sum(r, 0));
        r->graph.column = column;
        node = sgt_graph_of(&r->graph, FORMULA_SUB, node, other);
        if (s->word == '=')
            sgt_formula_say(sgt_formula_blame(&r->fault, sgt_scan_column(s)), "a formula has one = at most");
    }
    if (s->word == ',')
        sgt_formula_say(sgt_formula_blame(&r->fault, sgt_scan_column(s)),
                        "a comma stands between arguments only; decimals have a point");
    if (!r->fault.found && !r->graph.full && r->kind == SGT_FORMULA_XYZ && !r->graph.node[node].of)
        sgt_formula_say(sgt_formula_blame(&r->fault, 1),
                        "the formula has none of x, y, z, r: F is the same everywhere");
    return node;
}

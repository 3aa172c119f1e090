// SPDX-License-Identifier: MIT
/* read.c - a formula from its text: the room, and the tape in it.
 *
 * grammar.c makes a graph of the text.  schedule.c makes steps of the graph.
 *
 * THE ROOM has the tape itself, the values of the parameters, the nodes, and at its end the table of their
 * hashes and the waves (polar.h).  The steps and uniforms are written behind the nodes, and then moved to the
 * front.
 *
 * How many nodes a text makes: at most one for each character, for an operator has two operands, and what is
 * simplified to more than one node is longer (x^1.5 makes three).  A wave that becomes a polynomial of degree
 * 63, the longest, makes ROOM_WAVE more at most: five squares and five products of complex numbers.  The
 * tests and the fuzzer read each text in a room that is just as large as sgt_formula_room says.
 *
 * Test: tests/unit/test_formula.c, tests/fuzz/fuzz_formula.c. */
#include "grammar.h"
#include "schedule.h"

#include <sagitta/interval.h>

#include <string.h>

/* -------------------------------------------------------------------- room */

/* Nodes of any text, and of each wave. */
enum { ROOM_NODES = 16, ROOM_WAVE = 56 };
enum { ROOM_ALIGNED = sizeof(double) };

static size_t room_rounded(size_t bytes) { return (bytes + ROOM_ALIGNED - 1) / ROOM_ALIGNED * ROOM_ALIGNED; }

/* How long a text is; SGT_LONGEST_FORMULA + 1 if it is longer. */
static size_t text_length(const char *text)
{
    size_t length = 0;
    while (length <= SGT_LONGEST_FORMULA && text[length]) length++;
    return length;
}

typedef struct room_plan {
    size_t head, tail, buckets, waves, all;
} room_plan;

/* A node becomes a uniform, which is larger than a step.  Those of waves are all steps. */
static room_plan room_for(const char *text, size_t length, size_t n)
{
    const size_t node = sizeof(formula_node);
    const size_t uniform = sizeof(formula_uniform) + sizeof(sgt_interval) + sizeof(double);
    room_plan plan = {
        .head = room_rounded(sizeof(sgt_tape)) + n * sizeof(double), .buckets = 16, .waves = length};
    while (plan.buckets < length) plan.buckets *= 2;
    plan.tail = room_rounded(plan.buckets * sizeof(int) + plan.waves * sizeof(polar_wave));
    plan.all = plan.head + (length + ROOM_NODES) * (node + uniform) + plan.tail;
    for (size_t i = 0; i + 5 <= length; i++)
        if (memcmp(text + i, "atan2", 5) == 0)
            plan.all += room_rounded(ROOM_WAVE * (node + sizeof(formula_step)));
    return plan;
}

size_t sgt_formula_room(const char *text, size_t n)
{
    size_t length = text ? text_length(text) : 0;
    if (length > SGT_LONGEST_FORMULA || n > SGT_MOST_FORMULA_PARAMETERS) return 0;
    return room_for(text, length, n).all;
}

static void room_too_small(formula_fault *fault, size_t size, size_t wanted)
{
    formula_fault *f = sgt_formula_blame(fault, 0);
    f = sgt_formula_say_number(sgt_formula_say(f, "the room is too small: it has "), size);
    f = sgt_formula_say_number(sgt_formula_say(f, " bytes, "), wanted > size ? wanted - size : 0);
    sgt_formula_say(f, " more suffice");
}

/* ------------------------------------------------------------------ the tape */

static void parameters_checked(formula_fault *fault, size_t n, const sgt_named parameters[])
{
    if (n > SGT_MOST_FORMULA_PARAMETERS) {
        formula_fault *f = sgt_formula_say(sgt_formula_blame(fault, 0), "there are more than ");
        sgt_formula_say(sgt_formula_say_number(f, SGT_MOST_FORMULA_PARAMETERS), " parameters");
        return;
    }
    for (size_t i = 0; i < n && !fault->found; i++) {
        const char *name = parameters[i].name ? parameters[i].name : "", *what = NULL;
        size_t length = text_length(name);
        if (!sgt_scan_is_name(name))
            what = " is no name: a letter, then letters, digits and _";
        else if (sgt_grammar_reserves(name, length))
            what = " has a meaning of its own";
        else if (!isfinite(parameters[i].value))
            what = " is not finite";
        for (size_t j = 0; j < i && !what; j++)
            if (sgt_scan_is(name, length, parameters[j].name)) what = " is given twice";
        if (!what) continue;
        formula_fault *f = sgt_formula_say(sgt_formula_blame(fault, 0), "the parameter ");
        sgt_formula_say(sgt_formula_say_part(f, name, length), what);
    }
}

/* Does the tape make s = x^2 + y^2 first, and read neither x nor y, nor their squares, afterwards? */
static bool is_radial(const sgt_tape *tape)
{
    const formula_step *s = tape->step;
    if (tape->kind != SGT_FORMULA_XY || tape->steps < 4 || s[2].op != FORMULA_ADD) return false;
    if (s[0].op != FORMULA_SQUARE || s[1].op != FORMULA_SQUARE || s[0].a + s[1].a != 1) return false;
    if (s[2].a + s[2].b != s[0].out + s[1].out) return false;
    unsigned long long other = 3ULL | 1ULL << s[0].out | 1ULL << s[1].out;
    for (int i = 3; i < tape->steps; i++) {
        unsigned long long reads = s[i].a < FORMULA_UNIFORM ? 1ULL << s[i].a : 0;
        if (s[i].op <= FORMULA_REAL_POWER && s[i].b < FORMULA_UNIFORM) reads |= 1ULL << s[i].b;
        if (reads & other) return false;
        other &= ~(1ULL << s[i].out);
    }
    return true;
}

/* Puts the tape together at the begin of the room; behind the nodes there are `left` bytes. */
static sgt_tape *tape_made(formula_reader *r, int result, sgt_tape *tape, size_t head, char *behind,
                           size_t left)
{
    formula_needs needs = sgt_schedule_needs(&r->graph, result);
    size_t uniforms = (size_t)needs.uniforms, steps = (size_t)needs.steps;
    size_t numbers = uniforms * (sizeof(sgt_interval) + sizeof(double)),
           written = uniforms * sizeof(formula_uniform);
    size_t all = numbers + written + steps * sizeof(formula_step);
    if (all > left) return r->graph.full = true, NULL;
    formula_uniform *uniform = (formula_uniform *)(void *)(behind + numbers);
    formula_step *step = (formula_step *)(void *)(behind + numbers + written);
    int registers = sgt_schedule_write(&r->graph, result, uniform, step);
    if (registers > FORMULA_REGISTERS || needs.uniforms > FORMULA_UNIFORMS) {
        formula_fault *f = sgt_formula_blame(&r->fault, 0);
        if (registers > FORMULA_REGISTERS) {
            f = sgt_formula_say_number(sgt_formula_say(f, "the formula needs "), (size_t)registers - 3);
            f = sgt_formula_say(f, " intermediate results at once, and there may be ");
            sgt_formula_say_number(f, FORMULA_REGISTERS - 3);
        } else {
            f = sgt_formula_say_number(sgt_formula_say(f, "the formula has "), uniforms);
            f = sgt_formula_say(f, " numbers and parameters, with what is made of them, and there may be ");
            sgt_formula_say_number(f, FORMULA_UNIFORMS);
        }
        return NULL;
    }
    char *base = (char *)tape + head;
    memmove(base, behind, all);
    tape->kind = r->kind, tape->parameters = (int)r->names;
    tape->steps = needs.steps, tape->uniforms = needs.uniforms, tape->registers = registers;
    tape->given = (double *)(void *)((char *)tape + room_rounded(sizeof *tape));
    tape->value = (sgt_interval *)(void *)base;
    tape->middle = (double *)(void *)(base + uniforms * sizeof(sgt_interval));
    tape->uniform = (const formula_uniform *)(const void *)(base + numbers);
    tape->step = (const formula_step *)(const void *)(base + numbers + written);
    tape->jumps = false;
    for (size_t i = 0; i < steps; i++) tape->jumps = tape->jumps || tape->step[i].op == FORMULA_ATAN2;
    tape->radial = is_radial(tape);
    return tape;
}

static sgt_tape *tape_read(formula_reader *r, size_t length, void *room, size_t size)
{
    const room_plan plan = room_for(r->scan.text, length, r->names);
    double values[SGT_MOST_FORMULA_PARAMETERS];
    const size_t given = room ? size : 0;
    size = size < plan.all ? size - size % ROOM_ALIGNED : plan.all;
    if (!room || size < plan.head + plan.tail + 4 * sizeof(formula_node))
        return room_too_small(&r->fault, given, plan.all), NULL;
    char *first = (char *)room + plan.head, *end = (char *)room + size, *table = end - plan.tail;
    size_t fit = (size_t)(table - first) / sizeof(formula_node);
    r->graph = (formula_graph){.node = (formula_node *)(void *)first,
                               .most = (int)fit,
                               .bucket = (int *)(void *)table,
                               .buckets = (int)plan.buckets,
                               .fault = &r->fault};
    r->waves = (polar_waves){.wave = (polar_wave *)(void *)(table + plan.buckets * sizeof(int)),
                             .most = (int)plan.waves};
    sgt_graph_begin(&r->graph);
    int result = sgt_grammar_read(r);
    if (r->fault.found && !r->graph.full) return NULL;
    sgt_tape *tape = NULL;
    if (!r->graph.full) {
        char *behind = first + (size_t)r->graph.count * sizeof(formula_node);
        tape = tape_made(r, result, room, plan.head, behind, (size_t)(end - behind));
    }
    if (r->graph.full) return r->fault.found = false, room_too_small(&r->fault, given, plan.all), NULL;
    if (!tape) return NULL;
    for (size_t i = 0; i < r->names; i++) values[i] = r->name[i].value;
    sgt_formula_set(tape, values, NULL);
    return tape;
}

sgt_tape *sgt_formula_read(const char *text, sgt_formula_kind kind, size_t n, const sgt_named parameters[],
                           void *room, size_t size, sgt_error *error)
{
    formula_reader r = {.kind = kind, .names = n, .name = parameters, .scan = {.text = text ? text : ""}};
    sgt_tape *tape = NULL;
    size_t length = text_length(r.scan.text);
    r.scan.fault = &r.fault;
    parameters_checked(&r.fault, n, parameters);
    if (length > SGT_LONGEST_FORMULA) {
        formula_fault *f = sgt_formula_blame(&r.fault, SGT_LONGEST_FORMULA + 1);
        f = sgt_formula_say_number(sgt_formula_say(f, "a formula has at most "), SGT_LONGEST_FORMULA);
        sgt_formula_say(f, " characters");
    }
    if (!r.fault.found) tape = tape_read(&r, length, room, size);
    if (!tape && error) *error = r.fault.error;
    return tape;
}

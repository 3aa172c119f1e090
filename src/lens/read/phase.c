// SPDX-License-Identifier: MIT
/* phase.c - reads the phase of a surface: an ideal lens, or `phase`, which is one in waves (system.h).
 *
 *     phase: "600*y"                                          W as a formula, order 1
 *     phase: {waves: "a*r^2 + b*r^4", a: -50, b: 0.2, order: 2}
 *     phase: {waves: {type: zernike, norm: 4, order: fringe, coefficients: [0, 0, 0, -2]}}
 *     phase: {lines: 600, turn: 90}                           W = 600 y, turned from x toward y
 *     phase: {points: [[0, 0, -200], [0, 0, 100]], wavelength: 0.5145, converges: true}
 *
 * W is the sag of the surface `waves`, or a formula.  Lines are the polynomial T (y cos a - x sin a).
 *
 * A HOLOGRAM is what two beams of light of the wavelength L0 leave on the surface, from a point P1 and from
 * P2, or (`converges`) to P2.  At Q its phase is that of the beams' difference, in waves
 *
 *     (|Q - P1| - |Q - P2|) / L0,    or    -(|Q - P1| + |Q - P2|) / L0,
 *
 * up to a constant, so |Q - P| - |P| stands for each distance.  That is Q . (Q - 2 P) / (|Q - P| + |P|),
 * which loses no digits where P is far away.
 *
 * A WAVELENGTH L.  per_wave is order * L in the unit of the lens, so there is a phase for each wavelength.
 * Those of the file are made once.  At another wavelength an element has to point to a phase that lasts:
 * these are in a list, which only grows.  Several threads may ask at once, so a new entry is put at its head
 * by an exchange that fails if another thread was faster; two entries of one wavelength are alike. */
#include "phase.h"

#include "formula.h"
#include "surface.h"

#include "../../text/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------------------ ideal lenses */

/* A length of a phase, finite: not zero, and not beyond what sgt_phase takes. */
static double phase_length(source *s, const node *n, const char *key, double x)
{
    if (x == 0) tree_fail(s, n->line, key, "must not be zero");
    if (!(fabs(x) >= 0x1p-500 && fabs(x) <= 0x1p500))
        tree_fail(s, n->line, key, "must be from 4e-151 to 3e150 in magnitude, not %g", x);
    return x;
}

/* A focal length; of a lens of two powers it may be infinite. */
static double focal_length(source *s, const node *n, const char *key, bool two)
{
    const double f = tree_read_number(s, n, key, two ? NUMBER_MAYBE_INFINITE : NUMBER_FINITE);
    return isfinite(f) ? phase_length(s, n, key, f) : f;
}

/* An ideal lens: a plane with a phase. */
void sgt_read_ideal(source *s, const node *map, const char *others, sgt_element *e)
{
    const node *f = tree_take(map, "focal_length"), *fy = tree_take(map, "focal_length_y"),
               *from = tree_take(map, "object_distance");
    const node *other = tree_take(map, "phase"), *facets = tree_take(map, "facets");
    sgt_phase *phase = tree_room(s, 1, sizeof *phase);
    if (!f) tree_fail(s, map->line, "focal_length", "missing; an ideal lens has one");
    if (other) tree_fail(s, other->line, "phase", "an ideal lens has no other phase");
    if (facets) tree_fail(s, facets->line, "facets", "an ideal lens has none");
    phase->kind = SGT_IDEAL_LENS;
    phase->focal_length = focal_length(s, f, "focal_length", fy != NULL);
    if (fy) phase->focal_length_y = focal_length(s, fy, "focal_length_y", true);
    if (fy && isinf(phase->focal_length) && isinf(phase->focal_length_y))
        tree_fail(s, fy->line, "focal_length_y", "infinite, and so is focal_length: a lens has some power");
    /* 0: not given, see ../open/conjugate.c */
    if (from) phase->object_distance = tree_read_number(s, from, "object_distance", NUMBER_MAYBE_INFINITE);
    if (from && isfinite(phase->object_distance))
        phase_length(s, from, "object_distance", phase->object_distance);
    char known[200];
    snprintf(known, sizeof known, "type, focal_length, focal_length_y, object_distance%s", others);
    tree_finish(s, map, known);
    e->surface = (sgt_surface){&sgt_conic_ops, tree_room(s, 1, sizeof(sgt_conic))};
    e->phase = phase;
}

/* ------------------------------------------------------------------ phases in waves */

static sgt_surface read_lines(source *s, const node *n, const node *turn)
{
    sgt_polynomial_xy *self = tree_room(s, 1, sizeof *self);
    double *a = tree_room(s, 4, sizeof *a);
    const double lines = tree_read_number(s, n, "lines", NUMBER_FINITE);
    if (lines == 0)
        tree_fail(s, n->line, "lines",
                  "must not be zero: a grating without lines is none; order: 0 switches it off");
    double degrees = turn ? tree_read_number(s, turn, "turn", NUMBER_FINITE) : 0, cosine, sine;
    sgt_turns(1, &degrees, &cosine, &sine);
    a[1] = lines * cosine, a[2] = 0 - lines * sine;
    self->a = (sgt_numbers){a, 2, 2};
    return (sgt_surface){&sgt_polynomial_xy_ops, self};
}

static sgt_surface read_hologram(source *s, const node *points, const node *wavelength, const node *converges,
                                 double unit)
{
    static const char text[] = "w*((x*(x - 2*x1) + y*(y - 2*y1) + z*(z - 2*z1))"
                               "/(sqrt((x - x1)^2 + (y - y1)^2 + (z - z1)^2) + sqrt(x1^2 + y1^2 + z1^2))"
                               " + u*(x*(x - 2*x2) + y*(y - 2*y2) + z*(z - 2*z2))"
                               "/(sqrt((x - x2)^2 + (y - y2)^2 + (z - z2)^2) + sqrt(x2^2 + y2^2 + z2^2)))";
    enum { NUMBERS = 8 };
    double p[2][3];
    const bool through = converges && tree_read_truth(s, converges, "converges");
    if (points->kind != NODE_LIST || points->count != 2)
        tree_fail(s, points->line, "points", "must be two points, like [[0, 0, -200], [0, 0, 100]]");
    for (int i = 0; i < 2; i++) {
        const node *n = points->item[i];
        if (n->kind != NODE_LIST || n->count != 3)
            tree_fail(s, n->line, "points", "must be two points of three numbers");
        tree_read_numbers(s, n, "points", 3, p[i]);
        if (p[i][0] == 0 && p[i][1] == 0 && p[i][2] == 0)
            tree_fail(s, n->line, "points", "a point must not be the vertex itself");
    }
    if (p[0][0] == p[1][0] && p[0][1] == p[1][1] && p[0][2] == p[1][2] && !through)
        tree_fail(s, points->line, "points", "are one point, whose two beams leave no fringes");
    if (!wavelength) tree_fail(s, points->line, "wavelength", "missing: of the light of both beams");
    const double um = tree_read_number(s, wavelength, "wavelength", NUMBER_FINITE);
    if (!(um > 0)) tree_fail(s, wavelength->line, "wavelength", "must be positive, not %g", um);
    if (isinf(unit / um)) tree_fail(s, wavelength->line, "wavelength", "%g is too small", um);
    const sgt_named number[NUMBERS] = {{"x1", p[0][0]},
                                       {"y1", p[0][1]},
                                       {"z1", p[0][2]},
                                       {"x2", p[1][0]},
                                       {"y2", p[1][1]},
                                       {"z2", p[1][2]},
                                       {"w", through ? -unit / um : unit / um},
                                       {"u", through ? 1 : -1}};
    const size_t size = sgt_formula_room(text, NUMBERS);
    sgt_formula *self = tree_room(s, 1, sizeof *self);
    sgt_error e = {0};
    self->tape =
        sgt_formula_read(text, SGT_FORMULA_XYZ, NUMBERS, number, tree_room(s, size / 8 + 1, 8), size, &e);
    if (!self->tape) tree_fail(s, points->line, "points", "%s", e.words);
    sgt_named *named = tree_room(s, NUMBERS, sizeof *named);
    memcpy(named, number, sizeof number);
    formula_text *kept = tree_room(s, 1, sizeof *kept);
    *kept = (formula_text){self, text, named, NUMBERS, s->formula};
    s->formula = kept;
    return (sgt_surface){&sgt_formula_ops, self};
}

static sgt_surface read_waves(source *s, const node *map, const node *n)
{
    if (n->kind == NODE_SCALAR) return sgt_read_function(s, map, n, "waves");
    const sgt_builtin *row;
    tree_map(s, n, "waves");
    const sgt_surface waves = sgt_read_surface(s, n, SURFACE_NO_RIM, "", &row);
    if (waves.ops != &sgt_formula_ops && row->family != SGT_FAMILY_CONIC &&
        row->family != SGT_FAMILY_ASPHERE && row->family != SGT_FAMILY_DEPARTURE)
        tree_fail(s, n->line, "waves", "a %s is no sag; a phase is a sag, in waves, or a formula", row->type);
    return waves;
}

/* The facets of a Fresnel surface: a sag, whose slopes they have. */
void sgt_read_facets(whole_lens *w, source *s, const node *n, size_t i)
{
    const sgt_builtin *row;
    sgt_phase *phase = tree_room(s, 1, sizeof *phase);
    tree_map(s, n, "facets");
    phase->kind = SGT_FACETS, phase->waves = sgt_read_surface(s, n, SURFACE_NO_RIM, "", &row);
    if (!sgt_is_sag(phase->waves))
        tree_fail(s, n->line, "facets", "a %s is no sag; facets have the slopes of one", row->type);
    w->element[i].phase = phase;
}

static const char PHASE_KEYS[] =
    "order; waves (a formula, with its parameters, or a surface), or lines (and turn), or points (with "
    "wavelength, converges)";

/* A phase that is one word: not a number, which is meant as lines, and not nothing at all. */
static void refuse_word(source *s, const node *n)
{
    static const char *const nothing[] = {"", "~", "null", "Null", "NULL"};
    double lines;
    if (number_read(n->text, &lines))
        tree_fail(s, n->line, "phase",
                  "%.60s waves are the same everywhere; a grating of so many lines is {lines: %.60s}",
                  n->text, n->text);
    for (size_t i = 0; i < sizeof nothing / sizeof *nothing; i++)
        if (strcmp(n->text, nothing[i]) == 0)
            tree_fail(s, n->line, "phase",
                      "must be a formula of x, y, r or z, or a map, as {lines: 600}; leave the key out where "
                      "there is none");
}

/* Keys that are left and are those of another kind of phase. */
static void refuse_keys_of_others(source *s, const node *map)
{
    static const char *const of[][2] = {
        {"turn", "lines"}, {"wavelength", "points"}, {"converges", "points"}};
    for (size_t i = 0; i < map->count; i++)
        for (size_t k = 0; k < sizeof of / sizeof *of; k++)
            if (!map->taken[i] && strcmp(map->key[i]->text, of[k][0]) == 0)
                tree_fail(s, map->key[i]->line, of[k][0], "belongs to `%s`, which is not given", of[k][1]);
}

static double read_order(source *s, const node *n)
{
    const double order = tree_read_number(s, n, "order", NUMBER_FINITE);
    if (order != floor(order)) tree_fail(s, n->line, "order", "must be a whole number, not %g", order);
    return order;
}

/* An order of 0 is no phase: the light behaves as if the surface had none. */
void sgt_read_phase(whole_lens *w, source *s, const node *n, size_t i)
{
    const node *map = n->kind == NODE_SCALAR ? tree_node(s, NODE_MAP, n->line) : n;
    if (n->kind == NODE_SCALAR) refuse_word(s, n);
    tree_map(s, map, "phase");
    const node *order = tree_take(map, "order"), *lines = tree_take(map, "lines");
    const node *waves = n->kind == NODE_SCALAR ? n : tree_take(map, "waves"),
               *points = tree_take(map, "points");
    const double unit = sgt_lens_unit(&w->lens);
    sgt_phase *phase = tree_room(s, 1, sizeof *phase);
    if (!w->order) w->order = tree_room(s, w->lens.count, sizeof *w->order);
    if ((waves != NULL) + (lines != NULL) + (points != NULL) != 1)
        tree_fail(s, n->line, "phase", "must have one of waves, lines and points");
    if (!w->lens.wavelength)
        tree_fail(s, n->line, "wavelengths", "missing, and a phase (of element %zu) is in waves", i + 1);
    if (isnan(unit))
        tree_fail(
            s, n->line, "units",
            "must be mm, cm, m, um or in for a phase (of element %zu), which adds wavelengths to lengths",
            i + 1);
    w->order[i] = order ? read_order(s, order) : 1;
    for (size_t k = 0; k < w->lens.wavelengths; k++)
        if (!isfinite(w->order[i] * w->lens.wavelength[k] / unit))
            tree_fail(s, order ? order->line : n->line, "order", "%g is too large", w->order[i]);
    if (lines)
        phase->waves = read_lines(s, lines, tree_take(map, "turn"));
    else if (waves)
        phase->waves = read_waves(s, map, waves);
    else
        phase->waves =
            read_hologram(s, points, tree_take(map, "wavelength"), tree_take(map, "converges"), unit);
    refuse_keys_of_others(s, map);
    tree_finish(s, map, PHASE_KEYS);
    phase->kind = phase->waves.ops == &sgt_formula_ops ? SGT_PHASE_FUNCTION : SGT_PHASE_SAG;
    if (w->order[i] != 0) w->element[i].phase = phase;
}

/* ------------------------------------------------------------------ at a wavelength */

struct other_phases {
    double um;
    struct other_phases *next;
    sgt_phase phase[];
};

/* Which of the wavelengths of the file it is; the number of them if it is none. */
static size_t place_of_wavelength(const sgt_lens *l, double um)
{
    for (size_t k = 0; l->wavelength && k < l->wavelengths; k++)
        if (l->wavelength[k] == um) return k;
    return l->wavelengths;
}

static void set_wavelength(const whole_lens *w, double um, sgt_phase phase[])
{
    const double unit = sgt_lens_unit(&w->lens);
    for (size_t i = 0; w->order && i < w->lens.count; i++) {
        const sgt_phase *own = w->element[i].phase;
        if (!own || own->kind == SGT_IDEAL_LENS || own->kind == SGT_FACETS) continue;
        phase[i] = *own;
        phase[i].per_wave = w->order[i] * um / unit;
    }
}

/* NULL: no memory. */
static const sgt_phase *at_other_wavelength(const whole_lens *w, double um)
{
    struct other_phases *head = __atomic_load_n(&w->other_phases, __ATOMIC_ACQUIRE);
    for (const struct other_phases *p = head; p; p = p->next)
        if (p->um == um) return p->phase;
    const size_t size = w->lens.count * sizeof(sgt_phase);
    const sgt_allocator *a = &w->memory.allocator;
    struct other_phases *own = a->resize(a->context, NULL, sizeof *own + size);
    if (!own) return NULL;
    memcpy(own->phase, w->phase_at + w->lens.primary * w->lens.count, size);
    set_wavelength(w, um, own->phase);
    own->um = um, own->next = head;
    struct other_phases **at = &((whole_lens *)(uintptr_t)w)->other_phases;
    while (!__atomic_compare_exchange_n(at, &own->next, own, false, __ATOMIC_RELEASE, __ATOMIC_RELAXED))
        continue;
    return own->phase;
}

bool sgt_put_phases(const whole_lens *w, double um, sgt_element element[])
{
    if (!w->phase_at) return true;
    const sgt_lens *l = &w->lens;
    const size_t place = isnan(um) ? l->primary : place_of_wavelength(l, um);
    const sgt_phase *phase = place < l->wavelengths ? w->phase_at + place * l->count
                             : w->order             ? at_other_wavelength(w, um)
                                                    : w->phase_at + l->primary * l->count;
    for (size_t i = 0; phase && i < l->count; i++)
        if (phase[i].kind) element[i].phase = &phase[i];
    return phase != NULL;
}

void sgt_make_phases(whole_lens *w, source *s)
{
    const sgt_lens *l = &w->lens;
    if (!w->order) return;
    w->phase_at = tree_room(s, l->wavelengths * l->count, sizeof *w->phase_at);
    for (size_t k = 0; k < l->wavelengths; k++)
        set_wavelength(w, l->wavelength[k], w->phase_at + k * l->count);
    sgt_put_phases(w, l->wavelength[l->primary], w->element);
}

void sgt_free_phases(whole_lens *w)
{
    const sgt_allocator *a = &w->memory.allocator;
    for (struct other_phases *p = w->other_phases, *next; p; p = next) {
        next = p->next;
        a->resize(a->context, p, 0);
    }
    w->other_phases = NULL;
}

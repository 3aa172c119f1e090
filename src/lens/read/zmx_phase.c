// SPDX-License-Identifier: MIT
/* zmx_phase.c - surfaces of a .zmx file that have a phase, as keys of the lens file.
 *
 * With the letters of zmx_shape.c, and Phi a phase in radians:
 *     DGRATING   conic(r); lines at equal distances along y, P1 of them in a micrometre; the order is P2
 *     BINARY_1   conic(r) + even(r); Phi = sum of a_i (x/R)^a (y/R)^b, in the order x, y, x^2, xy ...; N =
 *                X1, R = X2, a_i = X(2+i); the order is P0, as in the next and of Zernike's
 *     BINARY_2   the same with Phi = sum of a_i (r/R)^(2i)
 *     BINARY_3   two zones, inside and outside of the radius P3.  Inside conic(r); outside a conic of the
 *                radius P1 (0: flat) and the constant P2, moved to meet it; P8 not 0: not moved.  N = X1, and
 *                then four numbers for each i: a power of r^(2i) and a phase (r/P3)^(2i) inside, a power and
 *                a phase (r/P4)^(2i) outside.  The orders are P5 and P6.  P7 has no published meaning
 *     FZERNPHA   conic(r); Phi / 2 pi is the sum of a_i Z_i, in the fringe order; SZERNPHA in Noll's
 *     HOLOGRM1   conic(r); the phase of two beams of the wavelength P7 from the points P1 P2 P3 and P4 P5
 *                P6; the order is P8.  HOLOGRM2: the second beam converges to its point
 *
 * A phase adds order * wavelength * Phi / 2 pi to the path, and its gradient to the direction, in reflection
 * as in transmission.  An order of 0 is no phase, and is not 1.  (OpticStudio's help, How diffractive
 * surfaces are modeled; Binary 3; Hologram 1.  Signs, units and orders of terms were found again in numbers
 * that it left in public files.)
 *
 * WHERE ZONES MEET, min(r, P3) and max(r, P3) make one formula of both: beyond the edge the inner one stays
 * as it is there, and the outer one has what it is there taken off.  So shape and path are continuous. */
#include "phase.h"
#include "zmx.h"

#include <math.h>

static const double TURN = 6.283185307179586477;

static node *phase_of(zmx *z, size_t line, double order)
{
    node *phase = tree_node(z->s, NODE_MAP, line);
    sgt_zmx_set_number(z, phase, "order", line, order);
    return phase;
}

static node *waves_of(zmx *z, size_t line, const char *type, node *coefficients)
{
    node *waves = tree_node(z->s, NODE_MAP, line);
    sgt_zmx_set_word(z, waves, "type", line, type);
    tree_set(z->s, waves, "coefficients", coefficients);
    return waves;
}

static void set_text(zmx *z, node *map, const char *key, size_t line, const char *text)
{
    node *word = tree_word(z->s, line, text);
    word->quoted = true;
    tree_set(z->s, map, key, word);
}

static size_t parm_line(const zmx_surface *f) { return f->parm_line ? f->parm_line : f->line; }

static void write_grating(zmx *z, const zmx_surface *f, node *map)
{
    const double um = sgt_unit_named(z->units ? z->units : "");
    node *phase = phase_of(z, parm_line(f), f->parm[2]);
    if (isnan(um))
        tree_fail(z->s, f->line, "UNIT", "missing, and surface %zu is a grating", sgt_zmx_number_of(z, f));
    sgt_zmx_write_standard(z, f, map);
    if (f->parm[1] == 0) return; /* without lines */
    sgt_zmx_set_number(z, phase, "lines", parm_line(f), f->parm[1] * um);
    tree_set(z->s, map, "phase", phase);
}

/* -------------------------------------------------------------------- polynomials */

/* t = r^2/norm^2 as a word: a1 t + a2 t^2 + ... by Horner's rule. */
static const char *horner(zmx *z, const char *t, const char *letter, size_t count)
{
    const char *sum = tree_print(z->s, "%s%zu", letter, count);
    for (size_t i = count; i-- > 1;) sum = tree_print(z->s, "(%s%zu + %s*%s)", letter, i, t, sum);
    return tree_print(z->s, "%s*%s", t, sum);
}

static void set_numbered(zmx *z, node *map, const char *letter, size_t line, size_t count, const double x[],
                         size_t step)
{
    for (size_t i = 0; i < count; i++)
        sgt_zmx_set_number(z, map, tree_print(z->s, "%s%zu", letter, i + 1), line, x[i * step]);
}

/* Powers of r; more than an even asphere has are a formula. */
static void set_radial(zmx *z, const zmx_surface *f, node *phase)
{
    enum { EVENS = 8, MOST = 100 };
    zmx_terms t = sgt_zmx_terms(z, f, 1, MOST);
    if (t.count > EVENS) {
        set_text(z, phase, "waves", t.line,
                 tree_print(z->s, "%s/(2*pi)", horner(z, "r^2/norm^2", "a", t.count)));
        sgt_zmx_set_number(z, phase, "norm", t.line, t.norm);
        set_numbered(z, phase, "a", t.line, t.count, t.value, 1);
        return;
    }
    for (size_t i = 0; i < t.count; i++)
        t.value[i] = sgt_zmx_by_norm(z, f, t.line, t.value[i] / TURN, t.norm, 2 * (i + 1));
    if (t.count)
        tree_set(z->s, phase, "waves",
                 waves_of(z, t.line, "even_asphere", tree_numbers(z->s, t.line, t.count, t.value)));
}

static void set_polynomial(zmx *z, const zmx_surface *f, node *phase)
{
    zmx_xy *xy = tree_room(z->s, 1, sizeof *xy);
    const size_t line = sgt_zmx_polynomial(z, f, xy);
    for (size_t i = 0; i < xy->rows; i++)
        for (size_t j = 0; j < xy->width[i]; j++) xy->factor[i][j] /= TURN;
    if (xy->rows)
        tree_set(z->s, phase, "waves", waves_of(z, line, "polynomial_xy", sgt_zmx_rows(z, line, xy)));
}

/* The phase, if there is one: without terms the surface has none. */
static void set_phase(zmx *z, node *map, node *phase)
{
    if (tree_take(phase, "waves")) tree_set(z->s, map, "phase", phase);
}

static void write_binary(zmx *z, const zmx_surface *f, node *map)
{
    node *phase = phase_of(z, parm_line(f), f->parm[0]);
    sgt_zmx_write_asphere(z, f, map);
    if (f->type->name[7] == '1')
        set_polynomial(z, f, phase);
    else
        set_radial(z, f, phase);
    set_phase(z, map, phase);
}

/* -------------------------------------------------------------------------- zones */

enum { ZONE_TERMS = 40, OF_TERM = 4 }; /* a power and a phase inside, a power and a phase outside */

/* Is the outer zone of another shape than the inner one? */
static bool differs(const zmx_surface *f, const double *x, size_t count)
{
    const double c = f->parm[1] == 0 ? 0 : 1 / f->parm[1];
    bool other = c != f->curvature || (c != 0 && f->parm[2] != f->conic);
    for (size_t i = 0; i < count; i++) other = other || x[OF_TERM * i] != x[OF_TERM * i + 2];
    return other;
}

static void write_two_shapes(zmx *z, const zmx_surface *f, node *map, const double *x, size_t count,
                             size_t line)
{
    static const char conics[] = "c*min(r^2, edge^2)/(1 + sqrt(1 - (1 + k)*c^2*min(r^2, edge^2)))"
                                 " + d*max(r^2, edge^2)/(1 + sqrt(1 - (1 + q)*d^2*max(r^2, edge^2)))"
                                 " - d*edge^2/(1 + sqrt(1 - (1 + q)*d^2*edge^2))";
    const char *powers = "";
    sgt_zmx_set_word(z, map, "type", f->line, "formula");
    if (count)
        powers = tree_print(z->s, " + %s + %s - %s", horner(z, "min(r^2, edge^2)", "s", count),
                            horner(z, "max(r^2, edge^2)", "t", count), horner(z, "edge^2", "t", count));
    set_text(z, map, "sag", f->line, tree_print(z->s, "%s%s", conics, powers));
    sgt_zmx_set_number(z, map, "c", f->curvature_line, f->curvature);
    sgt_zmx_set_number(z, map, "k", f->conic_line, f->conic);
    sgt_zmx_set_number(z, map, "d", f->parm_line, f->parm[1] == 0 ? 0 : 1 / f->parm[1]);
    sgt_zmx_set_number(z, map, "q", f->parm_line, f->parm[2]);
    sgt_zmx_set_number(z, map, "edge", f->parm_line, f->parm[3]);
    set_numbered(z, map, "s", line, count, x, OF_TERM);
    set_numbered(z, map, "t", line, count, x + 2, OF_TERM);
}

static void write_one_shape(zmx *z, const zmx_surface *f, node *map, const double *x, size_t count)
{
    enum { EVENS = 8 };
    zmx_surface as_asphere = *f;
    if (count > EVENS)
        tree_fail(z->s, f->line, "XDAT", "surface %zu: more than %d powers of r", sgt_zmx_number_of(z, f),
                  (int)EVENS);
    for (size_t i = 1; i <= EVENS; i++) as_asphere.parm[i] = i <= count ? x[OF_TERM * (i - 1)] : 0;
    sgt_zmx_write_asphere(z, &as_asphere, map);
}

static void write_zones(zmx *z, const zmx_surface *f, node *map)
{
    size_t line, number = sgt_zmx_number_of(z, f);
    const double *extra = sgt_zmx_extras(z, f, 1 + OF_TERM * ZONE_TERMS, &line), *x = &extra[2], n = extra[1];
    if (!(n >= 0 && n <= (double)ZONE_TERMS && n == floor(n)))
        tree_fail(z->s, line, "XDAT", "surface %zu has %g terms (XDAT 1), which is no whole number up to %d",
                  number, n, (int)ZONE_TERMS);
    if (!(f->parm[3] > 0 && f->parm[4] > f->parm[3]))
        tree_fail(z->s, parm_line(f), "PARM", "surface %zu: zones out to %g and %g (PARM 3, 4) do not rise",
                  number, f->parm[3], f->parm[4]);
    if (f->parm[7] != 0)
        tree_fail(z->s, f->parm_line, "PARM", "surface %zu: what PARM 7 of BINARY_3 means is not published",
                  number);
    size_t count = (size_t)n, used = 0;
    for (size_t i = 0; i < f->extras; i++)
        if (f->extra[i].number > 1 + OF_TERM * count && f->extra[i].value != 0)
            sgt_zmx_tally(z, ZMX_UNUSED, f->extra[i].line, "XDAT"); /* beyond those that are counted */
    for (size_t i = 0; i < OF_TERM * count; i++)
        if (x[i] != 0) used = i / OF_TERM + 1;
    count = used;
    const bool two = differs(f, x, count);
    if (two && f->parm[8] != 0)
        tree_fail(z->s, f->parm_line, "PARM",
                  "surface %zu: PARM 8 lets the sag jump where the zones meet, and what light does at such a "
                  "step is "
                  "not in the file; zones that meet (PARM 8 = 0) are read",
                  number);
    if (two)
        write_two_shapes(z, f, map, x, count, line);
    else
        write_one_shape(z, f, map, x, count);
    if (!count) return;
    node *phase = phase_of(z, line, 1);
    const char *inner = horner(z, "min(r^2, edge^2)/edge^2", "a", count);
    const char *outer = horner(z, "max(r^2, edge^2)/rim^2", "b", count),
               *there = horner(z, "edge^2/rim^2", "b", count);
    set_text(z, phase, "waves", line, tree_print(z->s, "(m*%s + n*(%s - %s))/(2*pi)", inner, outer, there));
    sgt_zmx_set_number(z, phase, "m", f->parm_line, f->parm[5]);
    sgt_zmx_set_number(z, phase, "n", f->parm_line, f->parm[6]);
    sgt_zmx_set_number(z, phase, "edge", f->parm_line, f->parm[3]);
    sgt_zmx_set_number(z, phase, "rim", f->parm_line, f->parm[4]);
    set_numbered(z, phase, "a", line, count, x + 1, OF_TERM);
    set_numbered(z, phase, "b", line, count, x + 3, OF_TERM);
    tree_set(z->s, map, "phase", phase);
    tree_remark(
        z->s, SGT_REMARK_TURNED, f->line, f->type->name,
        "a phase that is continuous where its zones meet; how OpticStudio counts the path there is not "
        "published");
}

/* ------------------------------------------------------------ Zernike's, holograms */

/* PARM 1: whether the terms go on beyond their radius, as they do here. */
static void write_zernike_phase(zmx *z, const zmx_surface *f, node *map)
{
    node *phase = phase_of(z, parm_line(f), f->parm[0]),
         *waves = sgt_zmx_zernike(z, f, f->type->name[0] == 'F');
    sgt_zmx_write_standard(z, f, map);
    if (!waves) return;
    tree_set(z->s, phase, "waves", waves);
    tree_set(z->s, map, "phase", phase);
    if (f->parm[1] == 0)
        tree_remark(z->s, SGT_REMARK_TURNED, f->line, f->type->name,
                    "Zernike terms that go on beyond their radius; in OpticStudio they end there");
}

static void write_hologram(zmx *z, const zmx_surface *f, node *map)
{
    const size_t line = parm_line(f);
    const bool one = f->parm[1] == f->parm[4] && f->parm[2] == f->parm[5] && f->parm[3] == f->parm[6];
    if (f->parm[8] == 0 || (one && f->type->name[7] == '1')) { /* order 0; one point, and so no fringes */
        sgt_zmx_write_standard(z, f, map);
        return;
    }
    node *phase = phase_of(z, line, f->parm[8]), *points = tree_node(z->s, NODE_LIST, line);
    if (!(f->parm[7] > 0))
        tree_fail(z->s, line, "PARM", "surface %zu: a hologram of the wavelength %g (PARM 7) is not read",
                  sgt_zmx_number_of(z, f), f->parm[7]);
    for (int i = 0; i < 2; i++) tree_append(z->s, points, tree_numbers(z->s, line, 3, &f->parm[1 + 3 * i]));
    sgt_zmx_write_standard(z, f, map);
    tree_set(z->s, phase, "points", points);
    sgt_zmx_set_number(z, phase, "wavelength", line, f->parm[7]);
    if (f->type->name[7] == '2') sgt_zmx_set_word(z, phase, "converges", line, "true");
    tree_set(z->s, map, "phase", phase);
}

static const zmx_type phases[] = {
    {"DGRATING", .parms = 2, .round = true, .write = write_grating},
    {"BINARY_1", .parms = 8, .zeroth = true, .round = true, .extras = true, .write = write_binary},
    {"BINARY_2", .parms = 8, .zeroth = true, .round = true, .extras = true, .write = write_binary},
    {"BINARY_3", .parms = 8, .round = true, .extras = true, .write = write_zones},
    {"FZERNPHA", .parms = 1, .zeroth = true, .round = true, .extras = true, .write = write_zernike_phase},
    {"SZERNPHA", .parms = 1, .zeroth = true, .round = true, .extras = true, .write = write_zernike_phase},
    {"HOLOGRM1", .parms = 8, .round = true, .write = write_hologram},
    {"HOLOGRM2", .parms = 8, .round = true, .write = write_hologram},
};

const zmx_type *sgt_zmx_type(piece name)
{
    for (size_t i = 0; i < sizeof phases / sizeof *phases; i++)
        if (sgt_reader_is(name, phases[i].name)) return &phases[i];
    return sgt_zmx_shape(name);
}

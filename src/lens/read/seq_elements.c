// SPDX-License-Identifier: MIT
/* seq_elements.c - the surfaces of a sequence file become surfaces and breaks of the lens file.
 *
 * FRAMES.  XDE YDE ZDE move the vertex; then ADE BDE CDE turn about the new x, the new y, the new z.  In CODE
 * V alpha and beta turn left-handed, gamma right-handed: so the tilt of a break is (-ADE, -BDE, CDE).  The
 * telescope tests/data/seq/ray-optics__threemir.seq proves it: with this sign its five beams are sharp, and
 * with the other one they miss a mirror.
 *     plain   a break, the surface, its thickness along the new z
 *     DAR     the surface alone: the thickness is along the old z, from the old vertex
 *     BEN     the tilt again behind the surface, and the thickness along that z: so the axis follows a mirror
 *     REV     the surface, a plane that does nothing, and behind it the break that undoes one with these
 * numbers
 *
 * THE IMAGE.  The thickness of SI is a defocus: it is added to that of the last surface.  PIM puts the image
 * at the paraxial focus; the number in the file may be left from before, and the focus is what CODE V would
 * take.
 *
 * Paraxial data, fields and the pupil are those of the axis without moves, as in CODE V. */
#include "seq.h"

#include <math.h>
#include <string.h>

static void set_numbers(seq *q, node *map, const char *key, size_t line, size_t count, const double x[])
{
    tree_set(q->s, map, key, tree_numbers(q->s, line, count, x));
}

static bool is_image(const seq *q, const seq_surface *f) { return f == &q->surface[q->count - 1]; }
static size_t number_of(const seq *q, const seq_surface *f) { return (size_t)(f - q->surface); }

/* -------------------------------------------------------- radius or curvature */

/* Without RDM: radii if no curvature can be so large, curvatures if no radius so small, else refused. */
static seq_bend unsaid_bend(seq *q)
{
    double least = INFINITY, most = 0;
    size_t line = 0;
    for (size_t i = 0; i < q->count; i++) {
        const seq_surface *f = &q->surface[i];
        if (f->bend != SEQ_UNSAID || f->curve.value == 0) continue;
        if (!line) line = f->curve.line;
        least = fmin(least, fabs(f->curve.value)), most = fmax(most, fabs(f->curve.value));
    }
    if (!line) return SEQ_RADIUS;
    const bool known = q->pupil && strcmp(q->pupil_key, "EPD") == 0;
    const double half = known ? q->pupil_size : 0;
    const bool radii = least > 1 && least * half >= 1 && least >= half / 4, bends = most < 1 && most <= half;
    if (radii == bends)
        tree_fail(q->s, line, "RDM",
                  "is missing, and the numbers of its surfaces may be radii or curvatures: write RDM in "
                  "front of them "
                  "if they are radii, RDM N if they are curvatures");
    tree_remark(q->s, SGT_REMARK_TURNED, line, "RDM",
                "%s, since it is missing: the others would not let the pupil pass",
                radii ? "radii" : "curvatures");
    return radii ? SEQ_RADIUS : SEQ_CURVATURE;
}

/* ------------------------------------------------------------------- shape */

static void set_curve(seq *q, node *map, const seq_surface *f)
{
    if (f->curve.value != 0)
        sgt_seq_set_number(q, map, f->bend == SEQ_RADIUS ? "radius" : "curvature", f->curve.line,
                           f->curve.value);
}

/* All powers as one formula: the lens file's even asphere ends with r^16. */
static void write_high_asphere(seq *q, node *map, const seq_surface *f, size_t powers)
{
    const double c = f->bend == SEQ_RADIUS && f->curve.value != 0 ? 1 / f->curve.value : f->curve.value;
    const char *sum = tree_print(q->s, "a%d", (int)(2 * powers + 2));
    for (size_t i = powers - 1; i-- > 0;) sum = tree_print(q->s, "(a%d + r^2*%s)", (int)(2 * i + 4), sum);
    node *text =
        tree_word(q->s, f->line, tree_print(q->s, "c*r^2/(1 + sqrt(1 - (1 + k)*c^2*r^2)) + r^4*%s", sum));
    text->quoted = true;
    sgt_seq_set_word(q, map, "type", f->line, "formula");
    tree_set(q->s, map, "sag", text);
    sgt_seq_set_number(q, map, "c", f->curve.line, c);
    sgt_seq_set_number(q, map, "k", f->line, f->conic.value);
    for (size_t i = 0; i < powers; i++)
        sgt_seq_set_number(q, map, tree_print(q->s, "a%d", (int)(2 * i + 4)), f->power_line, f->power[i]);
}

static void write_shape(seq *q, node *map, const seq_surface *f)
{
    enum { EVEN = 7 }; /* up to r^16 */
    size_t powers = SEQ_POWERS;
    double k = f->conic.value;
    while (powers && f->power[powers - 1] == 0) powers--;
    if (powers && (f->shape == SEQ_SPHERE || f->shape == SEQ_CONIC))
        tree_fail(q->s, f->power_line, "ASP", "surface %zu has powers of r, but it is %s", number_of(q, f),
                  f->shape == SEQ_SPHERE ? "a sphere (SPH)" : "a conic (CON)");
    if (k != 0 && f->shape == SEQ_SPHERE) {
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, f->conic.line, "K", "a conic constant of a sphere (SPH)");
        k = 0;
    }
    if (powers > EVEN) {
        write_high_asphere(q, map, f, powers);
        return;
    }
    const bool flat = f->curve.value == 0;
    sgt_seq_set_word(q, map, "type", f->line,
                     powers   ? "even_asphere"
                     : flat   ? "plane"
                     : k == 0 ? "sphere"
                              : "conic");
    set_curve(q, map, f);
    if (k != 0 && !flat) sgt_seq_set_number(q, map, "conic", f->conic.line, k);
    if (powers) {
        double coefficient[EVEN + 1] = {0}; /* the first is of r^2 */
        memcpy(coefficient + 1, f->power, powers * sizeof *coefficient);
        set_numbers(q, map, "coefficients", f->power_line, powers + 1, coefficient);
    }
}

/* W = the sum of C_n r^(2n) / HWL, both in lengths of the lens. */
static void write_phase(seq *q, node *map, const seq_surface *f)
{
    static const struct {
        const char *units;
        int power;
        double factor;
    } lengths[] = {{"mm", -6, 1}, {"cm", -7, 1}, {"in", -6, 25.4}};
    const seq_phase *p = f->phase;
    size_t terms = SEQ_TERMS;
    if (!p) return;
    for (int k = 0; k < 3; k++)
        if (p->source[k] != p->source[3 + k] || p->imaginary[0] != p->imaginary[1])
            tree_fail(q->s, p->line, "DIF",
                      "its two beams (HX1 to HZ2, HV1, HV2) differ: the phase that they add is not read");
    while (terms && p->term[terms - 1] == 0) terms--;
    if (!terms) return;
    if (!p->wavelength.line) tree_fail(q->s, p->line, "DIF", "surface %zu has no HWL", number_of(q, f));
    double length = 0, wave[SEQ_TERMS];
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        if (strcmp(q->units ? q->units : "mm", lengths[i].units) == 0)
            length = sgt_seq_scaled(q, &p->wavelength, lengths[i].power) / lengths[i].factor;
    const double order = p->order.line ? p->order.value : 1;
    for (size_t i = 0; i < terms; i++) {
        wave[i] = p->term[i] / length;
        if (!isfinite(wave[i])) tree_fail(q->s, p->line, "HCO", "C%zu is too large", i + 1);
    }
    if (order != floor(order) || fabs(order) > 1e6)
        tree_fail(q->s, p->order.line, "HOR", "%g is no whole number", order);
    node *phase = tree_node(q->s, NODE_MAP, p->line), *waves = tree_node(q->s, NODE_MAP, p->line);
    sgt_seq_set_number(q, phase, "order", p->line, order);
    sgt_seq_set_word(q, waves, "type", p->line, "even_asphere");
    set_numbers(q, waves, "coefficients", p->line, terms, wave);
    tree_set(q->s, phase, "waves", waves);
    tree_set(q->s, map, "phase", phase);
    tree_remark(q->s, SGT_REMARK_TURNED, p->line, "DIF",
                "a phase of the sum of C_n r^(2n) / HWL waves%s%s: the format is not published in whole",
                p->order.line ? "" : ", of order 1, since HOR is missing",
                p->turned ? "" : ", about the axis, since HCT is missing");
}

/* --------------------------------------------------------------- apertures */

static void put_aperture(seq *q, node *list, const seq_aperture *a)
{
    static const char *const types[] = {"circle", "rectangle", "ellipse"};
    node *item = tree_node(q->s, NODE_MAP, a->line);
    sgt_seq_set_word(q, item, "type", a->line, types[a->outline]);
    if (a->outline == SEQ_CIRCLE) {
        sgt_seq_set_number(q, item, "radius", a->line, a->half[0]);
    } else {
        sgt_seq_set_number(q, item, "half_width", a->line, a->half[0]);
        sgt_seq_set_number(q, item, "half_height", a->line, a->half[1]);
    }
    if (a->centre[0] != 0 || a->centre[1] != 0) set_numbers(q, item, "offset", a->line, 2, a->centre);
    if (a->turn != 0) {
        sgt_seq_set_number(q, item, "turn", a->line, a->turn);
        tree_remark(q->s, SGT_REMARK_TURNED, a->line, "ARO",
                    "turned from x toward y: which way is not published");
    }
    if (a->class == SEQ_OBSCURES) sgt_seq_set_word(q, item, "obscures", a->line, "true");
    tree_append(q->s, list, item);
}

static void write_apertures(seq *q, node *map, const seq_surface *f)
{
    static const char *const keys[] = {"CIR", "REX", "ELX"};
    node *list = NULL;
    double edge = 0, rim = 0;
    size_t edge_line = 0;
    for (size_t i = 0; i < f->apertures; i++) {
        const seq_aperture *a = &f->aperture[i];
        const bool round = a->outline == SEQ_CIRCLE, whole = round || (a->given[0] && a->given[1]);
        const bool sized = whole && a->half[0] > 0 && (round || a->half[1] > 0);
        if (a->class == SEQ_EDGE) { /* drawn, and no more */
            if (round && a->half[0] > edge) edge = a->half[0], edge_line = a->line;
            continue;
        }
        if (a->class == SEQ_HOLE || !sized) {
            tree_remark(q->s, SGT_REMARK_LEFT_OUT, a->line, keys[a->outline], "%s",
                        a->class == SEQ_HOLE ? "a hole: it is drawn, and blocks no ray"
                        : whole              ? "an aperture without a size"
                                             : "an aperture with one of its two halves");
            continue;
        }
        if (!q->aperture_line) q->aperture_line = a->line;
        if (round && a->class == SEQ_CLEAR && rim == 0 && a->centre[0] == 0 && a->centre[1] == 0) {
            rim = a->half[0];
            sgt_seq_set_number(q, map, "semi_diameter", a->line, rim);
            continue;
        }
        if (!list) list = tree_node(q->s, NODE_LIST, a->line);
        put_aperture(q, list, a);
    }
    if (list) tree_set(q->s, map, "apertures", list);
    if (edge > 0 && edge != rim) sgt_seq_set_number(q, map, "draw_to", edge_line, edge);
}

/* ------------------------------------------------------------------- moves */

static bool any(const double x[], size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (x[i] != 0) return true;
    return false;
}

/* A break with these moves and a thickness, or the one that undoes it. */
static node *put_break(seq *q, node *list, const seq_surface *f, bool moves, bool back, double thickness)
{
    const double sign = back ? -1 : 1, *m = f->move;
    const double shift[3] = {sign * m[0] + 0, sign * m[1] + 0, sign * m[2] + 0},
                 tilt[3] = {-sign * m[3] + 0, -sign * m[4] + 0, sign * m[5] + 0};
    const size_t line = f->move_line ? f->move_line : f->line;
    node *map = tree_node(q->s, NODE_MAP, line);
    sgt_seq_set_word(q, map, "type", line, "break");
    if (moves && any(shift, 3)) set_numbers(q, map, "decenter", line, shift[2] != 0 ? 3 : 2, shift);
    if (any(tilt, 3)) set_numbers(q, map, "tilt", line, 3, tilt);
    if (back) sgt_seq_set_word(q, map, "order", line, "tilt_first");
    sgt_seq_set_number(q, map, "thickness", f->thickness.line, thickness);
    map->inline_ = true;
    tree_append(q->s, list, map);
    return map;
}

/* A turn about one axis is the same in any order, so that the surface can have it as its own. */
static void set_own_move(seq *q, node *map, const seq_surface *f)
{
    const double tilt[3] = {0 - f->move[3], 0 - f->move[4], f->move[5]};
    if (any(f->move, 3)) set_numbers(q, map, "decenter", f->move_line, 3, f->move);
    if (any(tilt, 3)) set_numbers(q, map, "tilt", f->move_line, 3, tilt);
}

static bool turns_once(const seq_surface *f)
{
    return (f->move[3] != 0) + (f->move[4] != 0) + (f->move[5] != 0) <= 1;
}

static void require_idle(seq *q, const seq_surface *f)
{
    if (f->curve.value != 0 || f->mirror || f->glass.line || f->apertures || f->phase || f->power_line ||
        number_of(q, f) == q->stop || is_image(q, f))
        tree_fail(q->s, f->kind_line, "REV",
                  "surface %zu is no plane that does nothing: whether REV moves the surface is not published",
                  number_of(q, f));
    tree_remark(q->s, SGT_REMARK_TURNED, f->kind_line, "REV",
                "a break behind its surface, which undoes one with these numbers");
}

/* ---------------------------------------------------------------- surfaces */

static void put_seq_surface(seq *q, node *list, const seq_surface *f, double thickness, node **step)
{
    const bool last = is_image(q, f), moved = any(f->move, SEQ_MOVES);
    node *map = tree_node(q->s, NODE_MAP, f->line);
    const bool alone = moved && f->kind == SEQ_RETURN && !last, own = alone && turns_once(f);
    const bool before = moved && f->kind != SEQ_REVERSE && !own,
               behind = moved && !last && before && (alone || (f->kind == SEQ_BEND && any(f->move + 3, 3)));
    const bool undone = moved && f->kind == SEQ_REVERSE, broken = behind || undone;
    if (f->kind == SEQ_REVERSE && moved) require_idle(q, f);
    if (before) put_break(q, list, f, true, false, 0);
    write_shape(q, map, f);
    if (!last) sgt_seq_set_number(q, map, "thickness", f->thickness.line, broken ? 0 : thickness);
    if (!last) sgt_seq_set_medium(q, map, f, false);
    if (last && (f->mirror || f->glass.line))
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, f->line, "SI", "what is behind the image");
    if (number_of(q, f) == q->stop) sgt_seq_set_word(q, map, "stop", q->stop_line, "true");
    if (own) set_own_move(q, map, f);
    write_apertures(q, map, f);
    write_phase(q, map, f);
    if (f->name && *f->name) {
        node *name = tree_word(q->s, f->name_line, f->name);
        name->quoted = true;
        tree_set(q->s, map, "name", name);
    }
    map->inline_ = !tree_take(map, "coefficients") && !tree_take(map, "phase");
    tree_append(q->s, list, map);
    *step = map;
    if (broken) *step = put_break(q, list, f, f->kind != SEQ_BEND, f->kind != SEQ_BEND, thickness);
}

/* PIM: the thickness in front of the image, with the number in the file beside it. */
static void write_focus(seq *q, node *step, double defocus)
{
    node **place = NULL, *map = tree_node(q->s, NODE_MAP, q->focus_line);
    for (size_t i = 0; i < step->count; i++)
        if (strcmp(step->key[i]->text, "thickness") == 0) place = &step->item[i];
    sgt_seq_set_word(q, map, "solve", q->focus_line, "paraxial_focus");
    if (defocus != 0) sgt_seq_set_number(q, map, "offset", q->focus_line, defocus);
    map->is = tree_room(q->s, 1, sizeof *map->is);
    map->inline_ = true, map->is->stored = *place, map->is->record = "PIM", map->is->rules = true;
    map->is->stored->line = (uint32_t)q->focus_line;
    *place = map;
}

static void put_object(seq *q, node *root)
{
    const seq_surface *f = &q->surface[0];
    node *map = tree_node(q->s, NODE_MAP, f->line);
    if (f->mirror) tree_fail(q->s, f->line, "SO", "the object is a mirror");
    if (any(f->move, SEQ_MOVES)) tree_fail(q->s, f->move_line, "SO", "an object that is moved is not read");
    if (f->power_line) tree_fail(q->s, f->power_line, "SO", "an object with powers of r is not read");
    if (isfinite(f->thickness.value)) {
        if (!(f->thickness.value >= 0))
            tree_fail(q->s, f->thickness.line, "SO", "the object stands behind the first surface");
        sgt_seq_set_number(q, map, "distance", f->thickness.line, f->thickness.value);
        if (f->curve.value != 0)
            tree_remark(q->s, SGT_REMARK_LEFT_OUT, f->curve.line, "SO",
                        "the curvature of the object; rays start from a plane");
    }
    sgt_seq_set_medium(q, map, f, true);
    if (map->count) tree_set(q->s, root, "object", map);
    if (f->apertures)
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, f->aperture[0].line, "SO", "an aperture of the object");
}

/* CODE V's chief rays go through the middle of the stop.  In an ordinary lens the paraxial pupil has them
 * there but for its aberrations; where something is moved up to the stop, it does not. */
static void write_aim(seq *q, node *root)
{
    const size_t stop = q->stop ? q->stop : 1;
    size_t i = 1;
    while (i <= stop && !any(q->surface[i].move, SEQ_MOVES)) i++;
    if (i > stop) return;
    sgt_seq_set_word(q, root, "aim", q->surface[i].move_line, "stop");
    tree_remark(
        q->s, SGT_REMARK_TURNED, q->surface[i].move_line, "STO",
        "a lens whose rays are aimed at the stop, since surface %zu, in front of it or it itself, is moved",
        i);
}

static void tell_models(seq *q)
{
    for (const seq_model *m = q->model; m < q->model + q->models; m++)
        tree_remark(q->s, SGT_REMARK_TURNED, m->line, "S",
                    "nd %.10g and Vd %.10g: the fictitious glass %.*s of %zu surface%s, which is approximate",
                    m->nd, m->vd, sgt_reader_width(m->code), m->code.begin, m->count,
                    m->count == 1 ? "" : "s");
    if (q->other_models)
        tree_remark(q->s, SGT_REMARK_TURNED, q->other_models_line, "S",
                    "nd and Vd: other fictitious glasses of %zu surface%s, which are approximate",
                    q->other_models, q->other_models == 1 ? "" : "s");
}

static void tell_what_was_taken(seq *q)
{
    if (!q->stop)
        tree_remark(q->s, SGT_REMARK_NOTE, q->first, "STO",
                    "taken as the first surface, since none is marked");
    if (q->crossings)
        tree_remark(q->s, SGT_REMARK_NOTE, q->crossing_line, "IC",
                    "the ordinary one of two points of a ray on a surface, at %zu surface%s", q->crossings,
                    q->crossings == 1 ? "" : "s");
    tell_models(q);
    if (q->aperture_line && !q->uses_apertures)
        tree_remark(
            q->s, SGT_REMARK_NOTE, q->aperture_line, "CIR",
            "apertures clip rays here; CODE V asks for CA, which is not in the file (--no-apertures)");
}

void sgt_seq_write_surfaces(seq *q, node *root)
{
    node *list = tree_node(q->s, NODE_LIST, q->surface[1].line), *step = NULL;
    seq_surface *const image = &q->surface[q->count - 1];
    const seq_bend unsaid = unsaid_bend(q);
    for (size_t i = 0; i < q->count; i++)
        if (q->surface[i].bend == SEQ_UNSAID) q->surface[i].bend = unsaid;
    put_object(q, root);
    tree_expect(q->s, list, q->count - 1);
    for (seq_surface *f = q->surface + 1; f < image; f++) {
        double thickness = f->thickness.value;
        if (f == image - 1) thickness += image->thickness.value;
        if (!isfinite(thickness))
            tree_fail(q->s, f->thickness.line, "S", "surface %zu is infinitely far from the next",
                      number_of(q, f));
        put_seq_surface(q, list, f, thickness, &step);
    }
    if (q->focus_line) write_focus(q, step, image->thickness.value);
    put_seq_surface(q, list, image, 0, &step);
    write_aim(q, root);
    tree_set(q->s, root, "surfaces", list);
    tell_what_was_taken(q);
}

// SPDX-License-Identifier: MIT
/* seq_surface.c - the commands of a surface in a sequence file.
 *
 * SO r t, S r t and SI r t have a radius (RDM) or a curvature, a thickness, perhaps a glass, and REFL: a
 * mirror, behind which the medium is that in front.  0 is a plane in both manners.  SHAPES: SPH; CON with K;
 * ASP with K and A r^4 + B r^6 + ... + H r^18 + J r^20.  XDE YDE ZDE ADE BDE CDE move and turn, in any order;
 * DAR, BEN and REV say what that does to the axes behind (seq_elements.c).  CIR is a radius, REX REY and ELX
 * ELY are halves; EDG and HOL block no rays. */
#include "seq.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* From here on a thickness is infinite: CODE V writes 1e10 and more. */
static const double SEQ_FAR = 1e10;

/* The surfaces that a command is of.  Long ranges again and again would take quadratic time. */
static seq_surface *first_of(seq *q)
{
    enum { MOST = 4000000 };
    q->work += q->to - q->from;
    if (q->work > MOST)
        tree_fail(q->s, sgt_seq_line(q), q->row->name, "too many ranges of surfaces in one file");
    return &q->surface[q->from];
}

static seq_surface *after_last(seq *q) { return &q->surface[q->to] + 1; }

/* ---------------------------------------------------------------- the line */

static double thickness_of(seq *q, const seq_word *w)
{
    double x = INFINITY;
    if (!sgt_seq_is(w->text, "inf") && !sgt_seq_is(w->text, "infinity")) x = sgt_seq_number_in(q, w);
    return fabs(x) >= SEQ_FAR ? (double)INFINITY : x;
}

static bool says_mirror(seq *q, const seq_word *w)
{
    const piece t = w->text;
    if (!w->quoted && t.end - t.begin >= 4 && sgt_seq_is((piece){t.begin, t.begin + 4}, "refl")) return true;
    if (q->words && sgt_seq_is(t, "tir"))
        tree_fail(q->s, w->line, q->row->name,
                  "TIR is not read: what becomes of the rays that pass is not known");
    return false;
}

static bool says_refraction(const seq_word *w)
{
    const piece t = w->text;
    return !w->quoted && t.end - t.begin >= 4 && sgt_seq_is((piece){t.begin, t.begin + 4}, "refr");
}

/* glass and mode, where they stand. */
static void surface_medium(seq *q, seq_surface *f)
{
    const seq_word *w = sgt_seq_more(q);
    f->mirror = false, f->glass = (seq_word){.line = 0};
    if (!w) return;
    if (!says_mirror(q, w) && !says_refraction(w)) {
        if (!sgt_seq_is(w->text, "air") || w->quoted) f->glass = *w;
        w = sgt_seq_more(q);
        if (!w) return;
        if (!says_mirror(q, w) && !says_refraction(w))
            tree_fail(q->s, w->line, q->row->name, "\"%.*s\" behind the glass is neither REFL nor REFR",
                      sgt_reader_width(w->text), w->text.begin);
    }
    f->mirror = says_mirror(q, w);
}

enum { OBJECT, NEXT, IMAGE };

/* The surface that the line is of: a new one, or that of its number. */
static seq_surface *line_surface(seq *q)
{
    const unsigned which = sgt_seq_asked(q);
    const piece word = q->word[0].text;
    const size_t line = sgt_seq_line(q);
    const bool numbered = which == NEXT && word.end - word.begin > 1;
    size_t number = q->count;
    if (numbered) {
        number = 0;
        for (const char *c = word.begin + 1; c < word.end && number < SIZE_MAX / 20; c++)
            number = 10 * number + (size_t)(*c - '0');
    }
    if (which == OBJECT && q->count) tree_fail(q->s, line, "SO", "a second object; a lens has one");
    if (which == IMAGE && q->image_line) tree_fail(q->s, line, "SI", "a second image; a lens has one");
    if (which != OBJECT && !q->count && !(numbered && number == 0))
        tree_fail(q->s, line, q->row->name, "a surface stands before the object, SO");
    if (number > q->count || (number == q->count && q->image_line))
        tree_fail(q->s, line, "S", "there is no surface %zu here", number);
    if (which == IMAGE) q->image_line = line;
    if (number == q->count) {
        q->surface = tree_grow(q->s, q->surface, q->count, &q->room, sizeof *q->surface);
        q->surface[q->count++] = (seq_surface){.line = line};
    }
    q->current = number;
    return &q->surface[number];
}

static void surface_line(seq *q)
{
    seq_surface *f = line_surface(q);
    const size_t line = sgt_seq_line(q);
    f->curve = (seq_number){sgt_seq_number(q), line}, f->bend = q->bend;
    const seq_word t = sgt_seq_needed(q);
    f->thickness = (seq_number){thickness_of(q, &t), t.line};
    surface_medium(q, f);
}

/* The name of a solve in the place of a number: THI S3 HMY 0. */
static bool names_solve(seq *q)
{
    double x;
    const seq_word *w = q->next < q->words ? &q->word[q->next] : NULL;
    if (!w || sgt_seq_number_of(w->text, &x) || sgt_seq_is(w->text, "inf") || sgt_seq_is(w->text, "infinity"))
        return false;
    tree_remark(q->s, SGT_REMARK_TURNED, w->line, q->row->name,
                "the number that is stored: %.*s is a solve or pickup", sgt_reader_width(w->text),
                w->text.begin);
    q->next = q->words;
    return true;
}

static void surface_thickness(seq *q)
{
    if (names_solve(q)) return;
    const seq_word w = sgt_seq_needed(q);
    const double t = thickness_of(q, &w);
    for (seq_surface *f = first_of(q); f < after_last(q); f++) f->thickness = (seq_number){t, w.line};
}

/* RDY CUY: of the section in y, which is that of a surface of revolution; RDX CUX: of that in x. */
static void read_bend(seq *q)
{
    if (names_solve(q)) return;
    const size_t line = sgt_seq_line(q);
    const double x = sgt_seq_number(q);
    const bool other = sgt_seq_asked(q) > SEQ_CURVATURE;
    if (other && x != 0) tree_fail(q->s, line, q->row->name, "a surface of two curvatures is not read");
    for (seq_surface *f = first_of(q); f < after_last(q) && !other; f++)
        f->curve = (seq_number){x, line}, f->bend = (seq_bend)sgt_seq_asked(q);
}

static void surface_glass(seq *q)
{
    const size_t at = q->next;
    for (seq_surface *f = first_of(q); f < after_last(q); f++) {
        const bool mirror = f->mirror;
        q->next = at;
        sgt_seq_needed(q), q->next = at;
        surface_medium(q, f);
        f->mirror = f->mirror || mirror;
    }
}

static void surface_stop(seq *q)
{
    if (q->from == 0 || (q->image_line && q->from == q->count - 1))
        tree_fail(q->s, sgt_seq_line(q), "STO", "the %s cannot be the stop", q->from ? "image" : "object");
    q->stop = q->from, q->stop_line = sgt_seq_line(q);
}

static void read_label(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const char *text = sgt_seq_text(q);
    for (seq_surface *f = first_of(q); f < after_last(q); f++) f->name = text, f->name_line = line;
}

/* ------------------------------------------------------------------- shape */

static void surface_shape(seq *q)
{
    for (seq_surface *f = first_of(q); f < after_last(q); f++) f->shape = (seq_shape)sgt_seq_asked(q);
}

static void surface_conic(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const double k = sgt_seq_number(q);
    for (seq_surface *f = first_of(q); f < after_last(q); f++) f->conic = (seq_number){k, line};
}

static void read_power(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const double a = sgt_seq_number(q);
    for (seq_surface *f = first_of(q); f < after_last(q); f++)
        f->power[sgt_seq_asked(q)] = a, f->power_line = line;
}

static void read_fresnel(seq *q)
{
    if (sgt_seq_number(q) != 0)
        tree_fail(q->s, sgt_seq_line(q), "CUF", "the base curvature of a Fresnel surface is not read");
}

/* Which of the two points of a ray on a surface counts. */
static void read_crossing(seq *q)
{
    const seq_word w = sgt_seq_needed(q);
    if (!sgt_seq_is(w.text, "y") && !sgt_seq_is(w.text, "yes"))
        tree_fail(q->s, w.line, "IC",
                  "\"%.*s\" is not read: it may be the other point of a ray on its surface",
                  sgt_reader_width(w.text), w.text.begin);
    if (q->crossings++ == 0) q->crossing_line = w.line;
}

static seq_phase *own_phase(seq *q)
{
    seq_surface *f = first_of(q);
    if (q->from != q->to || !f->phase)
        tree_fail(q->s, sgt_seq_line(q), q->row->name, "stands without a DIF DOE of this surface");
    return f->phase;
}

static void read_diffraction(seq *q)
{
    const seq_word w = sgt_seq_needed(q);
    if (!sgt_seq_is(w.text, "doe") || q->from != q->to)
        tree_fail(q->s, w.line, "DIF", "\"%.*s\" is not read: DOE, of one surface, is",
                  sgt_reader_width(w.text), w.text.begin);
    seq_surface *f = first_of(q);
    f->phase = tree_room(q->s, 1, sizeof *f->phase);
    f->phase->line = w.line;
}

static void phase_order(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const double m = sgt_seq_number(q);
    own_phase(q)->order = (seq_number){m, line};
}

static void read_design_wavelength(seq *q)
{
    const seq_word w = sgt_seq_needed(q);
    sgt_seq_wave(q, &w, 0);
    own_phase(q)->wavelength = w;
}

static void read_symmetry(seq *q)
{
    const seq_word w = sgt_seq_needed(q);
    if (!sgt_seq_is(w.text, "r"))
        tree_fail(q->s, w.line, "HCT", "\"%.*s\" is not read: the order of its terms is not published",
                  sgt_reader_width(w.text), w.text.begin);
    own_phase(q)->turned = true;
}

/* HX1 to HZ2: where the two beams of a hologram come from, 0 to 5; HV1, HV2: is there such a point? */
static void read_source(seq *q)
{
    const double x = sgt_seq_number(q);
    own_phase(q)->source[sgt_seq_asked(q)] = x;
}

static void read_real(seq *q)
{
    const seq_word w = sgt_seq_needed(q);
    const bool real = sgt_seq_is(w.text, "rea") || sgt_seq_is(w.text, "real");
    if (!real && !sgt_seq_is(w.text, "vir") && !sgt_seq_is(w.text, "virtual"))
        tree_fail(q->s, w.line, q->row->name, "\"%.*s\" is not read: REA or VIR is", sgt_reader_width(w.text),
                  w.text.begin);
    own_phase(q)->imaginary[sgt_seq_asked(q)] = !real;
}

static void read_phase_term(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const double c = sgt_seq_number(q);
    if (q->term < 1 || q->term > SEQ_TERMS)
        tree_fail(q->s, line, "HCO", "terms C1 to C%d are read", (int)SEQ_TERMS);
    own_phase(q)->term[q->term - 1] = c;
}

/* ------------------------------------------------------------------- moves */

static void read_move(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const double x = sgt_seq_number(q);
    for (seq_surface *f = first_of(q); f < after_last(q); f++)
        f->move[sgt_seq_asked(q)] = x, f->move_line = line;
}

static void read_kind_of_move(seq *q)
{
    for (seq_surface *f = first_of(q); f < after_last(q); f++)
        f->kind = (seq_move)sgt_seq_asked(q), f->kind_line = sgt_seq_line(q);
}

/* --------------------------------------------------------------- apertures */

static bool same_piece(piece a, piece b)
{
    const size_t length = (size_t)(a.end - a.begin);
    return length == (size_t)(b.end - b.begin) && (length == 0 || memcmp(a.begin, b.begin, length) == 0);
}

/* The aperture of this outline, class and label, so that REX and REY are one. */
static seq_aperture *aperture_of(seq *q, seq_surface *f, seq_outline outline)
{
    for (size_t i = 0; i < f->apertures; i++) {
        const seq_aperture a = f->aperture[i];
        if (a.outline != outline || a.class != q->class || !same_piece(a.label, q->label)) continue;
        for (size_t j = i; j + 1 < f->apertures; j++) f->aperture[j] = f->aperture[j + 1];
        f->aperture[f->apertures - 1] = a; /* it is the last one now */
        return &f->aperture[f->apertures - 1];
    }
    if (f->apertures == SEQ_APERTURES)
        tree_fail(q->s, sgt_seq_line(q), q->row->name, "more than %d apertures of one surface",
                  (int)SEQ_APERTURES);
    f->aperture = tree_grow(q->s, f->aperture, f->apertures, &f->aperture_room, sizeof *f->aperture);
    f->aperture[f->apertures] = (seq_aperture){.outline = outline, .class = q->class, .label = q->label};
    return &f->aperture[f->apertures++];
}

/* CIR 0; REX, REY 1; ELX, ELY 2: twice the outline, and 1 for y. */
static void surface_aperture(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const double half = sgt_seq_number(q);
    for (seq_surface *f = first_of(q); f < after_last(q); f++) {
        seq_aperture *a = aperture_of(q, f, (seq_outline)(sgt_seq_asked(q) / 2));
        a->half[sgt_seq_asked(q) % 2] = half, a->given[sgt_seq_asked(q) % 2] = true, a->line = line;
    }
}

/* ADX, ADY, ARO: of the aperture that was given last, or the last of the class and label that are named. */
static void read_aperture_place(seq *q)
{
    const size_t line = sgt_seq_line(q);
    const double x = sgt_seq_number(q);
    for (seq_surface *f = first_of(q); f < after_last(q); f++) {
        size_t i = f->apertures;
        while (i > 0 && ((q->classed && f->aperture[i - 1].class != q->class) ||
                         (q->label.begin && !same_piece(f->aperture[i - 1].label, q->label))))
            i--;
        if (i == 0) tree_fail(q->s, line, q->row->name, "there is no aperture that it could be of");
        *(sgt_seq_asked(q) < 2 ? &f->aperture[i - 1].centre[sgt_seq_asked(q)] : &f->aperture[i - 1].turn) = x;
    }
}

/* --------------------------------------------------------------- the table */

static const char NOT_PUBLISHED[] = "what it does is not published, and a wrong guess would be another lens";
static const char CODES[] = "by its name a code of what an optimisation may vary";
static const char SHAPES[] = "the formula of this shape is not published in whole";
static const char EDITS[] = "commands that rearrange surfaces are not carried out";
static const seq_command surface_commands[] = {
    /* the most frequent first */
    {"S", SEQ_READ, surface_line, SEQ_NO_SURFACE | NEXT, NULL},
    {"STO", SEQ_READ, surface_stop, 0, NULL},
    {"CIR", SEQ_READ, surface_aperture, SEQ_Z | SEQ_L | 0, NULL},
    {"THC", SEQ_IDLE, NULL, 0, NULL},
    {"CCY", SEQ_IDLE, NULL, 0, NULL},
    {"GLC", SEQ_IDLE, NULL, 0, NULL},
    {"K", SEQ_READ, surface_conic, SEQ_Z, NULL},
    {"A", SEQ_READ, read_power, SEQ_Z | 0, NULL},
    {"B", SEQ_READ, read_power, SEQ_Z | 1, NULL},
    {"C", SEQ_READ, read_power, SEQ_Z | 2, NULL},
    {"D", SEQ_READ, read_power, SEQ_Z | 3, NULL},
    {"E", SEQ_READ, read_power, SEQ_Z | 4, NULL},
    {"F", SEQ_READ, read_power, SEQ_Z | 5, NULL},
    {"G", SEQ_READ, read_power, SEQ_Z | 6, NULL},
    {"H", SEQ_READ, read_power, SEQ_Z | 7, NULL},
    {"J", SEQ_READ, read_power, SEQ_Z | 8, NULL},
    {"ASP", SEQ_READ, surface_shape, SEQ_ASPHERE, NULL},
    {"CON", SEQ_READ, surface_shape, SEQ_CONIC, NULL},
    {"SPH", SEQ_READ, surface_shape, SEQ_SPHERE, NULL},
    {"XDE", SEQ_READ, read_move, SEQ_Z | 0, NULL},
    {"YDE", SEQ_READ, read_move, SEQ_Z | 1, NULL},
    {"ZDE", SEQ_READ, read_move, SEQ_Z | 2, NULL},
    {"ADE", SEQ_READ, read_move, SEQ_Z | 3, NULL},
    {"BDE", SEQ_READ, read_move, SEQ_Z | 4, NULL},
    {"CDE", SEQ_READ, read_move, SEQ_Z | 5, NULL},
    {"DAR", SEQ_READ, read_kind_of_move, SEQ_RETURN, NULL},
    {"BEN", SEQ_READ, read_kind_of_move, SEQ_BEND, NULL},
    {"REV", SEQ_READ, read_kind_of_move, SEQ_REVERSE, NULL},
    {"SO", SEQ_READ, surface_line, SEQ_NO_SURFACE | OBJECT, NULL},
    {"SI", SEQ_READ, surface_line, SEQ_NO_SURFACE | IMAGE, NULL},
    {"SLB", SEQ_TEXT, read_label, 0, NULL},
    {"THI", SEQ_READ, surface_thickness, SEQ_Z, NULL},
    {"RDY", SEQ_READ, read_bend, SEQ_Z | SEQ_RADIUS, NULL},
    {"CUY", SEQ_READ, read_bend, SEQ_Z | SEQ_CURVATURE, NULL},
    {"RDX", SEQ_READ, read_bend, SEQ_CURVATURE + 1, NULL},
    {"CUX", SEQ_READ, read_bend, SEQ_CURVATURE + 1, NULL},
    {"GLA", SEQ_READ, surface_glass, SEQ_Z, NULL},
    {"CUF", SEQ_READ, read_fresnel, 0, NULL},
    {"REX", SEQ_READ, surface_aperture, SEQ_Z | SEQ_L | 2, NULL},
    {"REY", SEQ_READ, surface_aperture, SEQ_Z | SEQ_L | 3, NULL},
    {"ELX", SEQ_READ, surface_aperture, SEQ_Z | SEQ_L | 4, NULL},
    {"ELY", SEQ_READ, surface_aperture, SEQ_Z | SEQ_L | 5, NULL},
    {"ADX", SEQ_READ, read_aperture_place, SEQ_Z | SEQ_L | 0, NULL},
    {"ADY", SEQ_READ, read_aperture_place, SEQ_Z | SEQ_L | 1, NULL},
    {"ARO", SEQ_READ, read_aperture_place, SEQ_Z | SEQ_L | 2, NULL},
    {"DIF", SEQ_READ, read_diffraction, 0, NULL},
    {"HOR", SEQ_READ, phase_order, 0, NULL},
    {"HWL", SEQ_READ, read_design_wavelength, 0, NULL},
    {"HCT", SEQ_READ, read_symmetry, 0, NULL},
    {"HCO", SEQ_READ, read_phase_term, SEQ_W, NULL},
    {"HV1", SEQ_READ, read_real, 0, NULL},
    {"HV2", SEQ_READ, read_real, 1, NULL},
    {"HX1", SEQ_READ, read_source, 0, NULL},
    {"HY1", SEQ_READ, read_source, 1, NULL},
    {"HZ1", SEQ_READ, read_source, 2, NULL},
    {"HX2", SEQ_READ, read_source, 3, NULL},
    {"HY2", SEQ_READ, read_source, 4, NULL},
    {"HZ2", SEQ_READ, read_source, 5, NULL},
    /* what is fixed, may vary, or varies with others in an optimisation */
    {"CCX", SEQ_IDLE, NULL, 0, NULL},
    {"KC", SEQ_IDLE, NULL, 0, NULL},
    {"HCC", SEQ_IDLE, NULL, 0, NULL},
    {"AC", SEQ_IDLE, NULL, 0, NULL},
    {"BC", SEQ_IDLE, NULL, 0, NULL},
    {"CC", SEQ_IDLE, NULL, 0, NULL},
    {"DC", SEQ_IDLE, NULL, 0, NULL},
    {"EC", SEQ_IDLE, NULL, 0, NULL},
    {"FC", SEQ_IDLE, NULL, 0, NULL},
    {"GC", SEQ_IDLE, NULL, 0, NULL},
    {"HC", SEQ_IDLE, NULL, 0, NULL},
    {"JC", SEQ_IDLE, NULL, 0, NULL},
    {"XDC", SEQ_LEFT, NULL, 0, CODES},
    {"YDC", SEQ_LEFT, NULL, 0, CODES},
    {"ZDC", SEQ_LEFT, NULL, 0, CODES},
    {"ADC", SEQ_LEFT, NULL, 0, CODES},
    {"BDC", SEQ_LEFT, NULL, 0, CODES},
    {"CDC", SEQ_LEFT, NULL, 0, CODES},
    {"IC", SEQ_READ, read_crossing, 0, NULL},
    {"PIK", SEQ_SOLVE, NULL, 0, NULL},
    {"HMY", SEQ_SOLVE, NULL, 0, NULL},
    {"HCY", SEQ_SOLVE, NULL, 0, NULL},
    {"UMY", SEQ_SOLVE, NULL, 0, NULL},
    {"UCY", SEQ_SOLVE, NULL, 0, NULL},
    {"IMY", SEQ_SOLVE, NULL, 0, NULL},
    {"ICY", SEQ_SOLVE, NULL, 0, NULL},
    {"AMY", SEQ_SOLVE, NULL, 0, NULL},
    {"ET", SEQ_SOLVE, NULL, 0, NULL},
    {"HMX", SEQ_SOLVE, NULL, 0, NULL},
    {"HCX", SEQ_SOLVE, NULL, 0, NULL},
    {"UMX", SEQ_SOLVE, NULL, 0, NULL},
    {"UCX", SEQ_SOLVE, NULL, 0, NULL},
    {"IMX", SEQ_SOLVE, NULL, 0, NULL},
    {"ICX", SEQ_SOLVE, NULL, 0, NULL},
    {"AMX", SEQ_SOLVE, NULL, 0, NULL},
    {"RET", SEQ_REFUSED, NULL, 0, NOT_PUBLISHED},
    {"GLB", SEQ_REFUSED, NULL, 0, NOT_PUBLISHED},
    {"XOD", SEQ_REFUSED, NULL, 0, NOT_PUBLISHED},
    {"YOD", SEQ_REFUSED, NULL, 0, NOT_PUBLISHED},
    {"ZOD", SEQ_REFUSED, NULL, 0, NOT_PUBLISHED},
    {"TAN", SEQ_REFUSED, NULL, 0, NOT_PUBLISHED},
    {"XYZ", SEQ_REFUSED, NULL, 0, NOT_PUBLISHED},
    {"XTO", SEQ_REFUSED, NULL, 0, SHAPES},
    {"YTO", SEQ_REFUSED, NULL, 0, SHAPES},
    {"CYL", SEQ_REFUSED, NULL, 0, SHAPES},
    {"AAS", SEQ_REFUSED, NULL, 0, SHAPES},
    {"SPS", SEQ_REFUSED, NULL, 0, SHAPES},
    {"UDS", SEQ_REFUSED, NULL, 0, SHAPES},
    {"INS", SEQ_REFUSED, NULL, 0, EDITS},
    {"DEL", SEQ_REFUSED, NULL, 0, EDITS},
    {"COP", SEQ_REFUSED, NULL, 0, EDITS},
};

_Static_assert(sizeof surface_commands / sizeof *surface_commands <= (size_t)SEQ_COMMANDS, "seq counts them");

const seq_table sgt_seq_surface_commands = {sizeof surface_commands / sizeof *surface_commands,
                                            surface_commands};

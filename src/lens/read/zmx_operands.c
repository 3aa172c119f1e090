// SPDX-License-Identifier: MIT
/* zmx_operands.c - the operands of several configurations in a .zmx file, behind MNUM.
 *
 *     MNUM n c               n configurations; the surfaces and the system are those of c, the active one
 *     THIC 3 1 1.222 ...     of surface 3, in configuration 1, the thickness is 1.222
 *
 * WHICH ARE READ.  THIC, CRVT, CONN, SDIA and GLSS of a surface, PAR1 to PAR8 and PRAM (its fifth field is
 * the parameter), WAVE of a wavelength, XFIE and YFIE of a field, APER of the pupil.
 *
 * WHY THEIR MEANING IS CERTAIN.  The format is not published.  But the file has the active configuration
 * twice: in its surfaces, and in the rows of these operands.  So an operand is taken only if its value for
 * the active configuration is the one that the lens has (AS_GOOD_AS, as one may be printed shorter); of PRAM,
 * whose fields are less sure, only if that is not 0.  One that has no such row, or another value there, is
 * left out with a remark; so is one whose place a pickup or solve gives.  An operand that has one value in
 * all configurations says nothing, and neither do those in `idle`, which no ray depends on. */
#include "zmx.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double AS_GOOD_AS = 1e-9, FAR_AWAY = 1e10;

/* What an operand is of; the reader of its place. */
typedef enum target { SURFACE, PARAMETER, GLASS, WAVE, FIELD, PUPIL } target;
static const struct { const char *key; target of; unsigned which; } known[] = {
    {"THIC", SURFACE, 0}, {"CRVT", SURFACE, 1}, {"CONN", SURFACE, 2}, {"SDIA", SURFACE, 3},
    {"GLSS", GLASS, 0},
    {"PAR1", PARAMETER, 1}, {"PAR2", PARAMETER, 2}, {"PAR3", PARAMETER, 3}, {"PAR4", PARAMETER, 4},
    {"PAR5", PARAMETER, 5}, {"PAR6", PARAMETER, 6}, {"PAR7", PARAMETER, 7}, {"PAR8", PARAMETER, 8},
    {"PRAM", PARAMETER, 0}, {"WAVE", WAVE, 0}, {"XFIE", FIELD, 0}, {"YFIE", FIELD, 1}, {"APER", PUPIL, 0},
};
enum { KNOWN = sizeof known / sizeof known[0] };

/* Rows that are unused, a comment, a title, a weight in the merit function, a coating. */
static const char *const idle[] = {"MOFF", "MCOM", "LTTL", "CWGT", "COTN"};

void sgt_zmx_operand(zmx *z, piece key)
{
    zmx_operand o = {.line = z->lines.line, .known = KNOWN};
    double number[2];
    for (size_t i = 0; i < sizeof idle / sizeof *idle; i++)
        if (sgt_reader_is(key, idle[i])) return;
    o.key = sgt_zmx_copy(z, key);
    for (size_t i = 0; i < KNOWN; i++)
        if (sgt_reader_is(key, known[i].key)) o.known = i;
    bool fine = z->lines.whole;
    for (int i = 0; i < 2; i++)
        fine = fine && sgt_reader_number(sgt_reader_word(&z->rest), &number[i]) && number[i] >= 0 &&
               number[i] <= 1e6 && number[i] == floor(number[i]);
    const piece value = sgt_reader_word(&z->rest);
    fine = fine && value.begin < value.end;
    if (fine) {
        o.at = (size_t)number[0], o.configuration = (size_t)number[1], o.text = sgt_zmx_copy(z, value);
        if (!sgt_reader_number(value, &o.value)) o.value = (double)NAN;
    }
    if (fine && sgt_reader_is(key, "PRAM")) {
        double object = -1, parameter = -1;
        sgt_reader_number(sgt_reader_word(&z->rest), &object);
        sgt_reader_number(sgt_reader_word(&z->rest), &parameter);
        if (object == 0 && parameter >= 1 && parameter <= ZMX_PARMS) o.parameter = (size_t)parameter;
    } else if (o.known < KNOWN) {
        o.parameter = known[o.known].which;
    }
    z->operand = tree_grow(z->s, z->operand, z->operands, &z->operand_room, sizeof *z->operand);
    z->operand[z->operands++] = o;
}

/* --------------------------------------------------------------- places */

static bool is_picked(const zmx_surface *f, zmx_picked what, size_t parm)
{
    for (size_t i = 0; i < f->picks; i++)
        if (f->pick[i].what == what && (what != ZMX_PICK_PARM || f->pick[i].parm == parm)) return true;
    return what == ZMX_PICK_THICKNESS && f->focus_line;
}

static double *in_list(zmx *z, zmx_lists newer, zmx_lists older, size_t place)
{
    zmx_list *list = &z->list[z->list[newer].line ? newer : older];
    return list->line && place >= 1 && place <= list->count ? &list->value[place - 1] : NULL;
}

static double *of_surface(zmx_surface *f, unsigned which)
{
    switch (which) {
    case 0: return is_picked(f, ZMX_PICK_THICKNESS, 0) ? NULL : &f->thickness;
    case 1: return is_picked(f, ZMX_PICK_CURVATURE, 0) ? NULL : &f->curvature;
    case 2: return &f->conic;
    default: return &f->size;
    }
}

/* The line of a number that the surface had not given. */
static void mark_given(zmx_surface *f, const zmx_operand *o)
{
    size_t *const lines[] = {&f->thickness_line, &f->curvature_line, &f->conic_line, &f->size_line};
    const bool parameter = known[o->known].of == PARAMETER;
    size_t *line = parameter ? &f->parm_line : lines[known[o->known].which];
    if (!*line) *line = o->line;
    if (parameter) f->parms_given |= 1u << o->parameter;
}

/* The number that an operand gives; NULL: it has no place in this lens.  *scale: as the lens has it. */
static double *operand_place(zmx *z, const zmx_operand *o, double *scale)
{
    *scale = 1;
    if (o->known == KNOWN || !o->text || isnan(o->value)) return NULL;
    const target of = known[o->known].of;
    const unsigned which = known[o->known].which;
    if ((of == SURFACE || of == PARAMETER) && o->at >= z->count) return NULL;
    zmx_surface *f = &z->surface[o->at];
    switch (of) {
    case SURFACE: return of_surface(f, which);
    case PARAMETER:
        if (!o->parameter || is_picked(f, ZMX_PICK_PARM, o->parameter)) return NULL;
        return &f->parm[o->parameter];
    case WAVE:
        return z->list[ZMX_WAVM].line ? in_list(z, ZMX_WAVM, ZMX_WAVM, o->at)
                                      : in_list(z, ZMX_WAVN, ZMX_WAVL, o->at);
    case FIELD:
        return which ? in_list(z, ZMX_YFLN, ZMX_YFLD, o->at) : in_list(z, ZMX_XFLN, ZMX_XFLD, o->at);
    case PUPIL:
        if (!z->pupil || strcmp(z->pupil, "stop_size") == 0) return NULL;
        if (strcmp(z->pupil, "semi_diameter") == 0) *scale = 0.5;
        return &z->pupil_size;
    case GLASS: break;
    }
    return NULL;
}

static double operand_value(const zmx_operand *o, double scale)
{
    return known[o->known].of == SURFACE && known[o->known].which == 0 && fabs(o->value) >= FAR_AWAY
               ? copysign(HUGE_VAL, o->value)
               : o->value * scale;
}

/* The name in quotes, "" for air; NULL: it is none that is read. */
static const char *glass_of(zmx *z, const zmx_operand *o)
{
    const size_t length = o->text ? strlen(o->text) : 0;
    if (length < 2 || o->text[0] != '"' || o->text[length - 1] != '"') return NULL;
    const char *name = tree_text(z->s, o->text + 1, length - 2);
    return strcmp(name, "MIRROR") == 0 || strcmp(name, "___BLANK") == 0 || strchr(name, '"') ? NULL : name;
}

/* Is this what the lens has, in its active configuration? */
static bool has_lens(zmx *z, const zmx_operand *o)
{
    if (o->known < KNOWN && known[o->known].of == GLASS) {
        const char *name = glass_of(z, o);
        if (!name || o->at >= z->count) return false;
        const zmx_glass *g = &z->surface[o->at].glass;
        return g->medium == ZMX_AIR ? !*name
                                    : g->medium == ZMX_GLASS && !g->picked && strcmp(g->name, name) == 0;
    }
    double scale;
    const double *place = operand_place(z, o, &scale);
    if (!place) return false;
    const double is = *place, said = operand_value(o, scale);
    if (strcmp(o->key, "PRAM") == 0 && is == 0) return false;
    return is == said || fabs(is - said) <= AS_GOOD_AS * fmax(fabs(is), fabs(said));
}

/* ------------------------------------------------------------- operands */

static int by_operand(const void *left, const void *right)
{
    const zmx_operand *a = left, *b = right;
    const int key = strcmp(a->key, b->key);
    if (key) return key;
    if (a->at != b->at) return a->at < b->at ? -1 : 1;
    if (a->parameter != b->parameter) return a->parameter < b->parameter ? -1 : 1;
    return a->line < b->line ? -1 : a->line > b->line;
}

static void put_operand(zmx *z, const zmx_operand *o)
{
    double scale;
    if (known[o->known].of != GLASS) {
        double *place = operand_place(z, o, &scale);
        *place = operand_value(o, scale);
        if (known[o->known].of == SURFACE || known[o->known].of == PARAMETER)
            mark_given(&z->surface[o->at], o);
        return;
    }
    const char *name = glass_of(z, o);
    z->surface[o->at].glass =
        (zmx_glass){.medium = *name ? ZMX_GLASS : ZMX_AIR, .line = o->line, .name = name};
}

/* Does it give all configurations the same, the active one among them? */
static bool says_nothing(const zmx *z, const zmx_operand *o, size_t count)
{
    bool active = false;
    for (size_t i = 0; i < count; i++) {
        if (!o[i].text || !o->text || strcmp(o[i].text, o->text) != 0) return false;
        active = active || o[i].configuration == z->configuration;
    }
    return active;
}

/* Are all its rows read, each configuration at most once, and has the lens the value of the active one? */
static bool is_operand_taken(zmx *z, const zmx_operand *o, size_t count)
{
    bool active = false, seen[1001] = {false};
    for (size_t i = 0; i < count; i++) {
        const size_t k = o[i].configuration;
        if (o[i].known == KNOWN || !o[i].text || k < 1 || k > z->configurations || k > 1000 || seen[k])
            return false;
        seen[k] = true;
        if (known[o[i].known].of == GLASS ? !glass_of(z, &o[i]) : isnan(o[i].value)) return false;
        if (k != z->configuration) continue;
        if (!has_lens(z, &o[i])) return false;
        active = true;
    }
    return active;
}

size_t sgt_zmx_configure(zmx *z, size_t wanted)
{
    size_t taken = 0;
    if (z->operands) qsort(z->operand, z->operands, sizeof *z->operand, by_operand);
    for (size_t i = 0, end; i < z->operands; i = end) {
        const zmx_operand *o = &z->operand[i];
        for (end = i + 1; end < z->operands && strcmp(z->operand[end].key, o->key) == 0 &&
                          z->operand[end].at == o->at && z->operand[end].parameter == o->parameter; end++)
            continue;
        if (says_nothing(z, o, end - i)) continue;
        if (is_operand_taken(z, o, end - i)) {
            taken++;
            for (size_t k = i; k < end && wanted != z->configuration; k++)
                if (z->operand[k].configuration == wanted) put_operand(z, &z->operand[k]);
        } else if (z->configurations > 1) {
            tree_remark(z->s, SGT_REMARK_LEFT_OUT, o->line, o->key,
                        o->known == KNOWN
                            ? "what it gives the other configurations (%zu, number %zu)"
                            : "what it gives the other configurations (%zu, number %zu): it does not give "
                              "the active one what the lens has, or its place has a pickup or solve",
                        end - i, o->at);
        }
    }
    return taken;
}

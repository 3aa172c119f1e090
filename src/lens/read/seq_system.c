// SPDX-License-Identifier: MIT
/* seq_system.c - what a sequence file says of the lens as a whole.
 *
 * WAVELENGTHS (WL) are in nanometres; REF counts them from 1.  PUPIL: EPD is the diameter of the entrance
 * pupil, FNO the focal length over it, NA the numerical aperture in the image, NAO that at the object, n sin
 * u; the last one holds.  FIELDS: XAN YAN are angles in degrees whose tangents are slopes, XOB YOB heights of
 * the object, XIM YIM paraxial and XRI YRI real heights of the image; the kind that is given last holds.
 *
 * VIGNETTING.  VUY and VLY are the parts of the half pupil that are cut off at its upper and at its lower
 * edge: it reaches from -(1 - VLY) to 1 - VUY.  A lens file has d + y (1 - c), so c = (VUY + VLY)/2 and d =
 * (VLY - VUY)/2.  Where both are different, readers of other programs scale each half by itself, which has
 * the same edges and other points within: a remark says so.
 *
 * NOT SAID.  Without RDM, CODE V takes what its user has set.  Here the numbers of surfaces are radii, or
 * curvatures, if only one of them can be: the beam of EPD does not pass a sphere of a smaller diameter.
 * seq_elements.c decides, and else refuses. */
#include "seq.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void read_nothing(seq *q) { q->next = q->words; }

static void read_lens(seq *q)
{
    if (q->count) tree_fail(q->s, sgt_seq_line(q), "LEN", "a second lens in one file");
    q->next = q->words;
}

static void read_title(seq *q) { q->name_line = sgt_seq_line(q), q->name = sgt_seq_text(q); }

static bool says_no(seq *q)
{
    const seq_word *w = sgt_seq_more(q);
    if (!w || sgt_seq_is(w->text, "y") || sgt_seq_is(w->text, "yes")) return false;
    if (!sgt_seq_is(w->text, "n") && !sgt_seq_is(w->text, "no"))
        tree_fail(q->s, w->line, q->row->name, "\"%.*s\" is neither Y nor N", sgt_reader_width(w->text),
                  w->text.begin);
    return true;
}

static void read_manner(seq *q) { q->bend = says_no(q) ? SEQ_CURVATURE : SEQ_RADIUS; }

static void system_unit(seq *q)
{
    static const char *const units[][2] = {{"m", "mm"},  {"mm", "mm"}, {"c", "cm"},
                                           {"cm", "cm"}, {"i", "in"},  {"in", "in"}};
    const seq_word w = sgt_seq_needed(q);
    q->units = NULL, q->units_line = w.line;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (sgt_seq_is(w.text, units[i][0])) q->units = units[i][1];
    if (!q->units)
        tree_fail(q->s, w.line, "DIM", "\"%.*s\" is no known unit: M, C or I", sgt_reader_width(w.text),
                  w.text.begin);
}

static void system_reference(seq *q)
{
    const size_t line = sgt_seq_line(q);
    q->reference = (seq_number){(double)sgt_seq_whole(q, 1), line};
}

static void system_pupil(seq *q)
{
    static const char *const keys[] = {"semi_diameter", "f_number", "image_na", "object_na"};
    if (q->pupil && strcmp(q->pupil_key, q->row->name) != 0)
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, q->pupil_line, q->pupil_key,
                    "another pupil stands behind it, %s, and holds", q->row->name);
    q->pupil_line = sgt_seq_line(q), q->pupil_key = q->row->name, q->pupil = keys[sgt_seq_asked(q)];
    q->pupil_size = sgt_seq_number(q);
    if (!(q->pupil_size > 0))
        tree_fail(q->s, q->pupil_line, q->pupil_key, "a pupil of the size %g is none", q->pupil_size);
    if (sgt_seq_asked(q) == 0) q->pupil_size /= 2;
}

/* One number of a list, counted from 1; those in front of it that are not there are 0. */
static void set_one(seq *q, seq_list *list, size_t place, double x)
{
    enum { MOST = 1000 };
    if (place > MOST) tree_fail(q->s, sgt_seq_line(q), q->row->name, "there is no number %zu", place);
    while (list->count < place) {
        list->value = tree_grow(q->s, list->value, list->count, &list->room, sizeof *list->value);
        list->value[list->count++] = 0;
    }
    list->value[place - 1] = x;
}

static void system_values(seq *q)
{
    const unsigned which = sgt_seq_asked(q);
    seq_list *list = &q->list[which];
    const size_t place = which == SEQ_WTW ? q->term : q->field;
    list->line = sgt_seq_line(q);
    if (which <= SEQ_YRI) q->fields = (int)(which & ~1u);
    if (place) {
        set_one(q, list, place, sgt_seq_number(q));
        return;
    }
    list->count = 0;
    for (const seq_word *w = sgt_seq_more(q); w; w = sgt_seq_more(q)) {
        list->value = tree_grow(q->s, list->value, list->count, &list->room, sizeof *list->value);
        list->value[list->count++] = sgt_seq_number_in(q, w);
    }
    if (!list->count) tree_fail(q->s, list->line, q->row->name, "a value is missing behind it");
}

/* WL a b c, or WL Wk a: nanometres. */
static void system_wavelengths(seq *q)
{
    seq_list *list = &q->list[SEQ_WL];
    size_t place = q->term;
    list->line = sgt_seq_line(q);
    if (place > list->count + 1) tree_fail(q->s, list->line, "WL", "there is no wavelength %zu", place);
    if (!place) list->count = 0;
    if (q->next == q->words) tree_fail(q->s, list->line, "WL", "a value is missing behind it");
    while (q->next < q->words && (!place || place == q->term)) {
        const seq_word w = sgt_seq_needed(q);
        const double um = sgt_seq_scaled(q, &w, -3);
        if (!(um > 0 && isfinite(um)))
            tree_fail(q->s, w.line, "WL", "\"%.*s\" is no wavelength", sgt_reader_width(w.text),
                      w.text.begin);
        const size_t at = place ? place - 1 : list->count;
        if (at == list->count) {
            list->value = tree_grow(q->s, list->value, list->count, &list->room, sizeof *list->value);
            list->count++;
        }
        list->value[at] = um;
        if (place) place++;
    }
}

/* TEM and PRE: where indices are those of the catalogue. */
static void system_condition(seq *q)
{
    const double usual = sgt_seq_asked(q) ? 760 : 20, x = sgt_seq_number(q);
    if (x != usual)
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, sgt_seq_line(q), q->row->name,
                    "indices are those at %g, and not at %g", usual, x);
}

static void read_polarisation(seq *q)
{
    if (!says_no(q)) tree_remark(q->s, SGT_REMARK_LEFT_OUT, sgt_seq_line(q), "POL", "polarisation");
}

static void read_clipping(seq *q) { q->uses_apertures = true, q->next = q->words; }

/* GO ends the lens behind its image; in front of the lens it ends an option. */
static void read_go(seq *q)
{
    if (q->count && !q->image_line)
        tree_fail(q->s, sgt_seq_line(q), "GO", "the lens ends here without an image surface, SI");
    q->ended = q->count > 0;
}

static void read_focus(seq *q) { q->focus_line = sgt_seq_line(q), q->next = q->words; }

static void read_private_block(seq *q)
{
    q->in_private = true, q->private_line = sgt_seq_line(q);
    q->ums = 0, q->um_room = 0, q->um = NULL;
}

static void read_restore(seq *q)
{
    tree_fail(q->s, sgt_seq_line(q), q->row->name, "the lens is in another file, which is not read");
}

/* --------------------------------------------------------------- the table */

static const seq_command system_commands[] = {
    {"GO", SEQ_TEXT, read_go, 0, NULL},
    {"PIM", SEQ_READ, read_focus, 0, NULL},
    {"RDM", SEQ_READ, read_manner, 0, NULL},
    {"LEN", SEQ_TEXT, read_lens, 0, NULL},
    {"TIT", SEQ_TEXT, read_title, 0, NULL},
    {"DIM", SEQ_READ, system_unit, 0, NULL},
    {"WL", SEQ_READ, system_wavelengths, SEQ_Z, NULL},
    {"REF", SEQ_READ, system_reference, SEQ_Z, NULL},
    {"WTW", SEQ_READ, system_values, SEQ_Z | SEQ_WTW, NULL},
    {"EPD", SEQ_READ, system_pupil, SEQ_Z | 0, NULL},
    {"FNO", SEQ_READ, system_pupil, SEQ_Z | 1, NULL},
    {"NA", SEQ_READ, system_pupil, SEQ_Z | 2, NULL},
    {"NAO", SEQ_READ, system_pupil, SEQ_Z | 3, NULL},
    {"XAN", SEQ_READ, system_values, SEQ_Z | SEQ_XAN, NULL},
    {"YAN", SEQ_READ, system_values, SEQ_Z | SEQ_YAN, NULL},
    {"XOB", SEQ_READ, system_values, SEQ_Z | SEQ_XOB, NULL},
    {"YOB", SEQ_READ, system_values, SEQ_Z | SEQ_YOB, NULL},
    {"XIM", SEQ_READ, system_values, SEQ_Z | SEQ_XIM, NULL},
    {"YIM", SEQ_READ, system_values, SEQ_Z | SEQ_YIM, NULL},
    {"XRI", SEQ_READ, system_values, SEQ_Z | SEQ_XRI, NULL},
    {"YRI", SEQ_READ, system_values, SEQ_Z | SEQ_YRI, NULL},
    {"WTF", SEQ_READ, system_values, SEQ_Z | SEQ_WTF, NULL},
    {"VUX", SEQ_READ, system_values, SEQ_Z | SEQ_VUX, NULL},
    {"VLX", SEQ_READ, system_values, SEQ_Z | SEQ_VLX, NULL},
    {"VUY", SEQ_READ, system_values, SEQ_Z | SEQ_VUY, NULL},
    {"VLY", SEQ_READ, system_values, SEQ_Z | SEQ_VLY, NULL},
    {"TEM", SEQ_READ, system_condition, 0, NULL},
    {"PRE", SEQ_READ, system_condition, 1, NULL},
    {"POL", SEQ_READ, read_polarisation, 0, NULL},
    {"CA", SEQ_READ, read_clipping, 0, NULL},
    {"ZOO", SEQ_ZOOM, NULL, 0, NULL},
    {"PRV", SEQ_READ, read_private_block, 0, NULL},
    {"RES", SEQ_READ, read_restore, 0, NULL},
    {"IN", SEQ_READ, read_restore, 0, NULL},
    {"INI", SEQ_TEXT, read_nothing, 0, NULL},
    {"WID", SEQ_LEFT, NULL, 0, "how rays of wide fields are aimed; --aim real aims them at the stop"},
    /* coatings, what an optimisation may vary, and how it does; listings, and names of files that are written
     */
    {"CWL", SEQ_IDLE, NULL, 0, NULL},
    {"CUM", SEQ_IDLE, NULL, 0, NULL},
    {"THM", SEQ_IDLE, NULL, 0, NULL},
    {"CLS", SEQ_IDLE, NULL, 0, NULL},
    {"DER", SEQ_IDLE, NULL, 0, NULL},
    {"WTC", SEQ_IDLE, NULL, 0, NULL},
    {"DLF", SEQ_IDLE, NULL, 0, NULL},
    {"VAL", SEQ_IDLE, NULL, 0, NULL},
    {"EFL", SEQ_IDLE, NULL, 0, NULL},
    {"LIS", SEQ_IDLE, NULL, 0, NULL},
    {"SAV", SEQ_IDLE, NULL, 0, NULL},
    {"OUT", SEQ_IDLE, NULL, 0, NULL},
    {"AUT", SEQ_OPTION, NULL, 0, NULL},
    {"TOL", SEQ_OPTION, NULL, 0, NULL},
    {"VIE", SEQ_OPTION, NULL, 0, NULL},
    {"DRA", SEQ_OPTION, NULL, 0, NULL},
};

_Static_assert(sizeof system_commands / sizeof *system_commands <= (size_t)SEQ_COMMANDS, "seq counts them");

const seq_table sgt_seq_system_commands = {sizeof system_commands / sizeof *system_commands, system_commands};

/* -------------------------------------------------------------- the system */

static const char *list_key(size_t which)
{
    for (size_t i = 0; i < sizeof system_commands / sizeof *system_commands; i++)
        if (system_commands[i].read == system_values && (system_commands[i].which & (SEQ_Z - 1)) == which)
            return system_commands[i].name;
    return "WL";
}

double sgt_seq_wavelength(const seq *q, size_t i) { return q->list[SEQ_WL].value[i]; }

static double value_or(const seq_list *list, size_t i, double otherwise)
{
    return i < list->count ? list->value[i] : otherwise;
}

/* Weights, unless all are 1.  One that is missing is 1. */
static void put_weights(seq *q, node *root, const char *key, size_t which, size_t count)
{
    const seq_list *list = &q->list[which];
    bool even = true;
    if (!list->line || !count) return;
    double *weight = tree_room(q->s, count, sizeof *weight);
    for (size_t i = 0; i < count; i++) {
        weight[i] = value_or(list, i, 1);
        even = even && weight[i] == 1;
    }
    if (list->count < count)
        tree_remark(q->s, SGT_REMARK_TURNED, list->line, list_key(which),
                    "1 where it lacks a number: it has %zu", list->count);
    if (list->count > count)
        tree_remark(q->s, SGT_REMARK_LEFT_OUT, list->line, list_key(which),
                    "all but the first %zu of its %zu "
                    "numbers",
                    count, list->count);
    if (!even) tree_set(q->s, root, key, tree_numbers(q->s, list->line, count, weight));
}

static void put_wavelengths(seq *q, node *root)
{
    const seq_list *um = &q->list[SEQ_WL];
    if (!um->count) {
        tree_remark(q->s, SGT_REMARK_NOTE, q->first, "WL", "the file gives no wavelengths");
        return;
    }
    if (q->reference.line && q->reference.value > (double)um->count)
        tree_fail(q->s, q->reference.line, "REF", "there is no wavelength %g", q->reference.value);
    tree_set(q->s, root, "wavelengths", tree_numbers(q->s, um->line, um->count, um->value));
    put_weights(q, root, "wavelength_weights", SEQ_WTW, um->count);
    if (um->count == 1) return;
    const size_t middle = (um->count + 1) / 2;
    if (!q->reference.line)
        tree_remark(q->s, SGT_REMARK_TURNED, um->line, "REF",
                    "%zu, the wavelength in the middle: the file does not say the reference", middle);
    sgt_seq_set_number(q, root, "primary", q->reference.line ? q->reference.line : um->line,
                       q->reference.line ? q->reference.value : (double)middle);
}

static void put_pupil(seq *q, node *root)
{
    if (!q->pupil) {
        tree_remark(q->s, SGT_REMARK_NOTE, q->first, "EPD",
                    "the file gives no size of the pupil: give rays by --rays, or a pupil");
        return;
    }
    if (strcmp(q->pupil_key, "NA") == 0)
        tree_remark(q->s, SGT_REMARK_NOTE, q->pupil_line, "NA",
                    "taken as n' u' of the paraxial marginal ray, 1 / (2 F-number)");
    node *map = tree_node(q->s, NODE_MAP, q->pupil_line);
    sgt_seq_set_number(q, map, q->pupil, q->pupil_line, q->pupil_size);
    tree_set(q->s, root, "pupil", map);
}

static bool vignettes(const seq *q, size_t fields)
{
    for (size_t which = SEQ_VUX; which <= SEQ_VLY; which++)
        for (size_t i = 0; i < q->list[which].count && i < fields; i++)
            if (q->list[which].value[i] != 0) return true;
    return false;
}

static void put_vignetting(seq *q, node *root, size_t fields)
{
    static const char *const keys[][2] = {{"dx", "cx"}, {"dy", "cy"}};
    size_t line = 0, uneven = 0;
    for (size_t which = SEQ_VUX; which <= SEQ_VLY; which++) {
        const seq_list *list = &q->list[which];
        if (list->line) line = list->line;
        if (list->count > fields)
            tree_remark(q->s, SGT_REMARK_LEFT_OUT, list->line, list_key(which),
                        "all but the first %zu of its %zu numbers", fields, list->count);
    }
    if (!vignettes(q, fields)) return;
    node *all = tree_node(q->s, NODE_LIST, line);
    for (size_t i = 0; i < fields; i++) {
        node *map = tree_node(q->s, NODE_MAP, line);
        map->inline_ = true;
        for (int k = 0; k < 2; k++) {
            const double up = value_or(&q->list[SEQ_VUX + 2 * k], i, 0),
                         low = value_or(&q->list[SEQ_VLX + 2 * k], i, 0);
            if (low != up) sgt_seq_set_number(q, map, keys[k][0], line, (low - up) / 2), uneven++;
            if (low + up != 0) sgt_seq_set_number(q, map, keys[k][1], line, (low + up) / 2);
        }
        tree_append(q->s, all, map);
    }
    tree_set(q->s, root, "vignetting", all);
    if (uneven)
        tree_remark(q->s, SGT_REMARK_TURNED, line, "VUY",
                    "a pupil that is moved and scaled as a whole to its two edges: what CODE V does between "
                    "different ones is not published");
}

/* Of kinds of fields in front of the one that holds. */
static void tell_other_fields(seq *q)
{
    for (size_t which = SEQ_XAN; which <= SEQ_YRI; which++)
        if (q->list[which].line && (int)(which & ~(size_t)1) != q->fields)
            tree_remark(q->s, SGT_REMARK_LEFT_OUT, q->list[which].line, list_key(which),
                        "fields of another kind stand behind it, %s, and hold",
                        list_key((size_t)q->fields + 1));
}

static void put_fields(seq *q, node *root)
{
    static const char *const types[] = {NULL, "object_height", "paraxial_image_height", "real_image_height"};
    if (q->fields < 0) {
        tree_remark(q->s, SGT_REMARK_NOTE, q->first, "YAN",
                    "the file gives no fields; one on the axis is taken");
        put_weights(q, root, "field_weights", SEQ_WTF, 1);
        put_vignetting(q, root, 1);
        return;
    }
    const seq_list *x = &q->list[q->fields], *y = x + 1, *less = x->count < y->count ? x : y;
    const size_t count = x->count > y->count ? x->count : y->count, line = y->line ? y->line : x->line;
    bool plane = true, askew = false;
    tell_other_fields(q);
    if (less->line && less->count < count)
        tree_remark(q->s, SGT_REMARK_TURNED, less->line, list_key((size_t)(less - q->list)),
                    "0 where it lacks a number: it has %zu for %zu fields", less->count, count);
    for (size_t i = 0; i < count; i++) {
        plane = plane && value_or(x, i, 0) == 0;
        askew = askew || (value_or(x, i, 0) != 0 && value_or(y, i, 0) != 0);
    }
    if (askew && q->fields == SEQ_XAN)
        tree_remark(q->s, SGT_REMARK_NOTE, x->line, "XAN",
                    "of a field with two angles both are taken as slopes: its chief ray has tan x and tan y");
    if (types[q->fields / 2]) tree_set(q->s, root, "field_type", tree_word(q->s, line, types[q->fields / 2]));
    node *list = tree_node(q->s, NODE_LIST, line);
    list->inline_ = plane;
    for (size_t i = 0; i < count; i++) {
        const double at[2] = {value_or(x, i, 0), value_or(y, i, 0)};
        tree_append(q->s, list, plane ? tree_number(q->s, line, at[1]) : tree_numbers(q->s, line, 2, at));
    }
    tree_set(q->s, root, "fields", list);
    put_weights(q, root, "field_weights", SEQ_WTF, count);
    put_vignetting(q, root, count);
}

void sgt_seq_write_system(seq *q, node *root)
{
    if (q->name && *q->name) {
        node *name = tree_word(q->s, q->name_line, q->name);
        name->quoted = true;
        tree_set(q->s, root, "name", name);
    }
    if (!q->units)
        tree_remark(q->s, SGT_REMARK_NOTE, q->first, "DIM",
                    "lengths are taken as millimetres: the file says no unit");
    sgt_seq_set_word(q, root, "units", q->units ? q->units_line : q->first, q->units ? q->units : "mm");
    put_wavelengths(q, root);
    put_pupil(q, root);
    put_fields(q, root);
}

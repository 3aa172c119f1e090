// SPDX-License-Identifier: MIT
/* zmx_system.c - what a .zmx file says of the lens as a whole: pupil, fields, wavelengths.
 *
 * PUPIL.  ENPD d is the diameter of the entrance pupil, FNUM the f-number of the image space (focal length
 * over that diameter) or the paraxial working one, OBNA the numerical aperture n sin u or the angle u of the
 * marginal ray at the object, FLOA says that the stop's DIAM, a semi-diameter, defines the pupil.
 *
 * FIELDS.  FTYP says how many fields and wavelengths are in use: the lists behind their keywords are often
 * longer.  Where those of the fields are shorter, the fields that they have are read: some versions list no
 * more than twelve.  Angles are those whose tangents are the slopes of the chief ray; of 90 degrees there is
 * no tangent, and the others are read without that field.  (OpticStudio's help, System Explorer: Aperture,
 * Fields, Wavelengths.) */
#include "zmx.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static void append(zmx *z, zmx_list *list, double x)
{
    list->value = tree_grow(z->s, list->value, list->count, &list->room, sizeof *list->value);
    list->value[list->count++] = x;
}

static void left_out(zmx *z, const char *words)
{
    tree_remark(z->s, SGT_REMARK_LEFT_OUT, z->lines.line, z->row->key, "%s", words);
}

static void read_mode(zmx *z)
{
    piece mode = sgt_zmx_needed(z);
    if (!sgt_reader_is(mode, "SEQ"))
        tree_fail(z->s, z->lines.line, "MODE",
                  "\"%.*s\" is not sequential: there is no row of surfaces to read", sgt_reader_width(mode),
                  mode.begin);
}

static void read_unit(zmx *z)
{
    static const char *const units[][2] = {{"MM", "mm"}, {"CM", "cm"}, {"IN", "in"}, {"METER", "m"}};
    piece unit = sgt_zmx_needed(z);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (sgt_reader_is(unit, units[i][0])) z->units = units[i][1], z->units_line = z->lines.line;
    if (!z->units)
        tree_fail(z->s, z->lines.line, "UNIT", "\"%.*s\" is no known unit", sgt_reader_width(unit),
                  unit.begin);
}

static void read_name(zmx *z)
{
    const char *name = sgt_zmx_text(z);
    if (name) z->name = name, z->name_line = z->lines.line;
}

/* A paragraph of a note becomes comments, in lines of some COLUMNS; blank ones only between others. */
void sgt_zmx_end_note(zmx *z)
{
    enum { COLUMNS = 100 };
    if (z->note_length == 0) return;
    const char *at = z->note, *end = at + z->note_length;
    z->note_length = 0;
    for (; z->blank_notes && z->s->comments; z->blank_notes--) tree_comment(z->s, "");
    z->blank_notes = 0;
    while (at < end) {
        const char *cut = end - at <= COLUMNS ? end : at + COLUMNS;
        while (cut < end && cut > at && *cut != ' ') cut--;
        if (cut == at)
            while (cut < end && (cut == at || *cut != ' ')) cut++;
        tree_comment(z->s, tree_text(z->s, at, (size_t)(cut - at)));
        for (at = cut; at < end && *at == ' '; at++) continue;
    }
}

/* NOTE code text: code 0 is a text, in pieces of CHARACTERS if it is long, 4 the end of one. */
static void read_note(zmx *z)
{
    enum { CHARACTERS = 200 };
    piece text = z->rest, code = sgt_zmx_field(z);
    bool coded = code.end - code.begin == 1 && *code.begin >= '0' && *code.begin <= '9';
    if (coded) text = z->rest;
    if (text.begin < text.end) text.begin++; /* one blank */
    if (!z->note_goes_on) sgt_zmx_end_note(z);
    if (text.begin == text.end && (!coded || *code.begin == '0')) z->blank_notes++;
    size_t characters = 0;
    for (const char *c = text.begin; c < text.end; c++) {
        z->note = tree_grow(z->s, z->note, z->note_length, &z->note_room, 1);
        z->note[z->note_length++] = *c;
        characters += ((unsigned char)*c & 0xC0) != 0x80;
    }
    z->note_goes_on = characters >= CHARACTERS;
}

static void set_pupil(zmx *z, const char *pupil, double size)
{
    if (z->pupil_line)
        tree_fail(z->s, z->lines.line, z->row->key, "the pupil is already defined in line %zu",
                  z->pupil_line);
    z->pupil_line = z->lines.line, z->pupil_key = z->row->key;
    z->pupil = pupil, z->pupil_size = size;
}

static void read_diameter(zmx *z) { set_pupil(z, "semi_diameter", sgt_zmx_number(z) / 2); }
static void read_float(zmx *z) { set_pupil(z, "stop_size", 1); }

/* FNUM: 0 is that of the image space, 1 the paraxial working one.  OBNA: 0 is n sin, 1 degrees. */
static void read_kind_of_pupil(zmx *z)
{
    static const char *const pupils[] = {"f_number", "working_f_number", "object_na", "object_angle"};
    double size = sgt_zmx_number(z);
    size_t kind = sgt_zmx_whole_or(z, 0);
    if (kind > 1) tree_fail(z->s, z->lines.line, z->row->key, "field 2: %zu is neither 0 nor 1", kind);
    set_pupil(z, pupils[z->row->which + kind], size);
}

static void read_environment(zmx *z)
{
    double celsius = sgt_zmx_number(z), atmospheres = sgt_zmx_number_or(z, 1),
           adjusted = sgt_zmx_number_or(z, 0);
    if (adjusted != 0 && (celsius != 20 || atmospheres != 1))
        tree_remark(z->s, SGT_REMARK_LEFT_OUT, z->lines.line, "ENVD",
                    "the change of indices to %g degrees Celsius and %g atmospheres", celsius,
                    atmospheres);
}

/* TEMP and PRES of older files. */
static void read_condition(zmx *z)
{
    double usual = (double)z->row->which, x = sgt_zmx_number(z);
    if (x != usual)
        tree_remark(z->s, SGT_REMARK_LEFT_OUT, z->lines.line, z->row->key,
                    "indices are those at %g, and not at %g", usual, x);
}

static void read_gcat(zmx *z)
{
    if (!z->makers) z->makers = tree_node(z->s, NODE_LIST, z->lines.line);
    for (piece word = sgt_zmx_field(z); word.begin < word.end; word = sgt_zmx_field(z))
        tree_append(z->s, z->makers, tree_word(z->s, z->lines.line, sgt_zmx_copy(z, word)));
}

static void read_aiming(zmx *z)
{
    sgt_zmx_number_or(z, 0);
    double how = sgt_zmx_number_or(z, 0);
    if (how != 0 && how != 1 && how != 2)
        left_out(z, "ray aiming of an unknown kind; rays go by the paraxial pupil");
    else z->aiming = (int)how, z->aiming_line = z->lines.line;
}

static void read_apodisation(zmx *z)
{
    if (sgt_zmx_number_or(z, 0) != 0)
        left_out(z, "the apodisation: all rays of the pupil have the same weight");
}

/* ROPD: 2 is the exit pupil. */
static void read_reference(zmx *z)
{
    if (sgt_zmx_number_or(z, 2) != 2)
        left_out(z, "what path differences refer to: here it is the sphere about the exit pupil, or a plane");
}

/* FTYP type telecentric fields wavelengths normalised iterated afocal ...: whether fields are normalised over
 * a circle or a rectangle, and how often solves are iterated, has no effect on rays. */
static void read_field_type(zmx *z)
{
    size_t type = sgt_zmx_whole(z), telecentric = sgt_zmx_whole_or(z, 0);
    if (type > 3) tree_fail(z->s, z->lines.line, "FTYP", "fields of the type %zu are not read", type);
    z->field_type = (unsigned)type, z->ftyp_line = z->lines.line;
    z->telecentric = telecentric != 0;
    z->fields = sgt_zmx_whole_or(z, SIZE_MAX), z->waves = sgt_zmx_whole_or(z, SIZE_MAX);
    sgt_zmx_number_or(z, 0), sgt_zmx_number_or(z, 0);
    z->afocal = sgt_zmx_number_or(z, 0) != 0;
}

static void read_values(zmx *z)
{
    zmx_list *list = &z->list[z->row->which];
    list->line = z->lines.line;
    for (piece word = sgt_zmx_field(z); word.begin < word.end; word = sgt_zmx_field(z))
        append(z, list, sgt_zmx_number_in(z, word));
}

/* WAVM i um weight: in any order; a NaN is one that was not given. */
static void read_wavelength(zmx *z)
{
    enum { MOST = 1000 };
    zmx_list *um = &z->list[ZMX_WAVM], *weight = &z->list[ZMX_WAVM_WEIGHT];
    size_t i = sgt_zmx_whole(z);
    double x = sgt_zmx_number(z), w = sgt_zmx_number_or(z, 1);
    if (i < 1 || i > MOST)
        tree_fail(z->s, z->lines.line, "WAVM", "field 1: %zu is not between 1 and %d", i, MOST);
    while (um->count < i) append(z, um, (double)NAN), append(z, weight, 1);
    if (!isnan(um->value[i - 1])) tree_fail(z->s, z->lines.line, "WAVM", "a second WAVM %zu", i);
    um->value[i - 1] = x, weight->value[i - 1] = w;
    um->line = weight->line = z->lines.line;
}

static void read_primary(zmx *z) { z->primary = sgt_zmx_whole(z), z->primary_line = z->lines.line; }

static void read_configurations(zmx *z)
{
    z->configurations = sgt_zmx_whole(z), z->configuration = sgt_zmx_whole_or(z, 1);
    z->configuration_line = z->lines.line;
}

/* --------------------------------------------------------------- the table */

static const zmx_record system_rows[] = {
    /* the most frequent first */
    {"WAVM", ZMX_MANY, read_wavelength, 0},
    {"MODE", ZMX_ONCE, read_mode, 0},
    {"UNIT", ZMX_ONCE, read_unit, 0},
    {"NAME", ZMX_LOOSE, read_name, 0},
    {"NOTE", ZMX_FREE, read_note, 0},
    {"ENPD", ZMX_MANY, read_diameter, 0},
    {"FNUM", ZMX_MANY, read_kind_of_pupil, 0},
    {"OBNA", ZMX_MANY, read_kind_of_pupil, 2},
    {"FLOA", ZMX_MANY, read_float, 0},
    {"ENVD", ZMX_ONCE, read_environment, 0},
    {"TEMP", ZMX_ONCE, read_condition, 20},
    {"PRES", ZMX_ONCE, read_condition, 1},
    {"GCAT", ZMX_MANY, read_gcat, 0},
    {"RAIM", ZMX_ONCE, read_aiming, 0},
    {"GFAC", ZMX_ONCE, read_apodisation, 0},
    {"FTYP", ZMX_ONCE, read_field_type, 0},
    {"XFLN", ZMX_ONCE, read_values, ZMX_XFLN},
    {"YFLN", ZMX_ONCE, read_values, ZMX_YFLN},
    {"FWGN", ZMX_ONCE, read_values, ZMX_FWGN},
    {"XFLD", ZMX_ONCE, read_values, ZMX_XFLD},
    {"YFLD", ZMX_ONCE, read_values, ZMX_YFLD},
    {"FWGT", ZMX_ONCE, read_values, ZMX_FWGT},
    {"WAVN", ZMX_ONCE, read_values, ZMX_WAVN},
    {"WWGN", ZMX_ONCE, read_values, ZMX_WWGN},
    {"WAVL", ZMX_ONCE, read_values, ZMX_WAVL},
    {"WWGT", ZMX_ONCE, read_values, ZMX_WWGT},
    {"PWAV", ZMX_ONCE, read_primary, 0},
    {"ROPD", ZMX_ONCE, read_reference, 0},
    {"VDXN", ZMX_ONCE, read_values, ZMX_VIGNETTING},
    {"VDYN", ZMX_ONCE, read_values, ZMX_VIGNETTING + 1},
    {"VCXN", ZMX_ONCE, read_values, ZMX_VIGNETTING + 2},
    {"VCYN", ZMX_ONCE, read_values, ZMX_VIGNETTING + 3},
    {"VANN", ZMX_ONCE, read_values, ZMX_VIGNETTING + 4},
    {"ZVDX", ZMX_ONCE, read_values, ZMX_VIGNETTING + 5},
    {"ZVDY", ZMX_ONCE, read_values, ZMX_VIGNETTING + 6},
    {"ZVCX", ZMX_ONCE, read_values, ZMX_VIGNETTING + 7},
    {"ZVCY", ZMX_ONCE, read_values, ZMX_VIGNETTING + 8},
    {"ZVAN", ZMX_ONCE, read_values, ZMX_VIGNETTING + 9},
    {"MNUM", ZMX_ONCE, read_configurations, 0},
};

_Static_assert(sizeof system_rows / sizeof *system_rows <= (size_t)ZMX_RECORDS, "zmx counts them");

/* Preferences, data for drawings and tolerances, polarisation (POLS), how a pupil is shifted for
 * aiming (PUSH), margins of automatic semi-diameters (SDMA), the frame that is printed as global (GLRS), a
 * sum over the file (CSUM). */
const zmx_table sgt_zmx_system_records = {sizeof system_rows / sizeof *system_rows, system_rows,
                                          "VERS AUTH IWDP PFIL LANG PUSH SDMA OMMA HYPR PICB POLS "
                                          "GLRS GSTD NSCD COFN LUID EERA TOL  MOFF CSUM "};

/* -------------------------------------------------------------- the system */

static const char *key_of_list(size_t which)
{
    for (size_t i = 0; i < sizeof system_rows / sizeof *system_rows; i++)
        if (system_rows[i].read == read_values && system_rows[i].which == which) return system_rows[i].key;
    return "WAVM";
}

/* Which of two lists is in the file: the newer one, the older one, or none. */
static zmx_list *either(zmx *z, size_t newer, size_t older)
{
    return &z->list[z->list[newer].line ? newer : older];
}

/* Whether the list has so many numbers; one that is not there has none and need not. */
static void require_count(zmx *z, const zmx_list *list, size_t count)
{
    if (list->line && list->count < count)
        tree_fail(z->s, list->line, key_of_list((size_t)(list - z->list)),
                  "FTYP has %zu of them in use, but there are %zu", count, list->count);
}

/* Weights, unless all are 1. */
static void write_weights(zmx *z, node *root, const char *key, const zmx_list *weight, size_t count)
{
    bool even = true;
    require_count(z, weight, count);
    for (size_t i = 0; i < count && weight->line; i++) even = even && weight->value[i] == 1;
    if (!even) tree_set(z->s, root, key, tree_numbers(z->s, weight->line, count, weight->value));
}

static void write_wavelengths(zmx *z, node *root)
{
    size_t which = z->list[ZMX_WAVM].line ? ZMX_WAVM : z->list[ZMX_WAVN].line ? ZMX_WAVN : ZMX_WAVL;
    const zmx_list *um = &z->list[which], *weight = &z->list[which + 1]; /* its weights are the next list */
    size_t count = z->waves == SIZE_MAX ? um->count : z->waves;
    const char *key = um->line ? key_of_list((size_t)(um - z->list)) : "FTYP";
    if (count > um->count)
        tree_fail(z->s, um->line ? um->line : z->ftyp_line, key,
                  "FTYP has %zu wavelengths in use, but there are %zu", count, um->count);
    for (size_t i = 0; i < count; i++)
        if (!(um->value[i] > 0))
            tree_fail(z->s, um->line, key, "wavelength %zu is %s", i + 1,
                      isnan(um->value[i]) ? "missing" : "not above 0");
    if (z->primary_line && (z->primary < 1 || z->primary > count))
        tree_fail(z->s, z->primary_line, "PWAV", "there is no wavelength %zu", z->primary);
    if (count) tree_set(z->s, root, "wavelengths", tree_numbers(z->s, um->line, count, um->value));
    write_weights(z, root, "wavelength_weights", weight, count);
    if (z->primary_line && count > 1)
        tree_set(z->s, root, "primary", tree_number(z->s, z->primary_line, (double)z->primary));
}

static void write_pupil(zmx *z, node *root)
{
    const char *why = NULL;
    if (!z->pupil) {
        tree_remark(z->s, SGT_REMARK_NOTE, z->line, "ENPD",
                    "the file gives no size of the pupil: give rays by --rays, or a pupil");
        return;
    }
    if (!(z->pupil_size > 0)) why = "the pupil, which has no size";
    if (strcmp(z->pupil, "object_angle") == 0 && z->pupil_size >= 90)
        why = "the pupil: a cone of 90 degrees and more is none";
    if (why) {
        tree_remark(z->s, SGT_REMARK_LEFT_OUT, z->pupil_line, z->pupil_key, "%s", why);
        return;
    }
    node *map = tree_node(z->s, NODE_MAP, z->pupil_line),
         *size = tree_number(z->s, z->pupil_line, z->pupil_size);
    if (strcmp(z->pupil, "stop_size") == 0) {
        if (!z->stop || !(z->surface[z->stop].size > 0))
            tree_fail(z->s, z->pupil_line, "FLOA", "the pupil is of the size of the stop, but there is no %s",
                      z->stop ? "DIAM of it" : "stop");
        size = tree_word(z->s, z->pupil_line, "true");
        tree_remark(z->s, SGT_REMARK_TURNED, z->pupil_line, "FLOA",
                    "the paraxial image of the stop at its DIAM");
    }
    tree_set(z->s, map, z->pupil, size);
    tree_set(z->s, root, "pupil", map);
}

static double value_or_0(const zmx_list *list, size_t i) { return i < list->count ? list->value[i] : 0; }

/* The fields that are read, by their places in the lists. */
typedef struct used_fields {
    const zmx_list *x, *y;
    size_t *place, count;
} used_fields;

/* How many of `wanted` fields the lists have.  A list that is there may lack some that the other has. */
static size_t listed_fields(zmx *z, const used_fields *u, size_t wanted)
{
    const zmx_list *more = u->x->count > u->y->count ? u->x : u->y, *less = more == u->x ? u->y : u->x;
    const size_t count = wanted < more->count ? wanted : more->count;
    if (wanted != SIZE_MAX && count < wanted)
        tree_remark(z->s, SGT_REMARK_LEFT_OUT, more->line ? more->line : z->ftyp_line,
                    more->line ? key_of_list((size_t)(more - z->list)) : "FTYP",
                    "%zu of the %zu fields in use: they are not in the file", wanted - count, wanted);
    if (less->line && less->count < count)
        tree_remark(z->s, SGT_REMARK_TURNED, less->line, key_of_list((size_t)(less - z->list)),
                    "0 where it lacks a number: it has %zu for %zu fields", less->count, count);
    return count;
}

static used_fields choose_fields(zmx *z)
{
    used_fields u = {.x = either(z, ZMX_XFLN, ZMX_XFLD), .y = either(z, ZMX_YFLN, ZMX_YFLD)};
    const size_t listed = listed_fields(z, &u, z->fields);
    u.place = tree_room(z->s, listed ? listed : 1, sizeof *u.place);
    for (size_t i = 0; i < listed; i++) {
        const double a = value_or_0(u.x, i), b = value_or_0(u.y, i);
        const bool tall = fabs(a) < 90;
        const zmx_list *list = tall ? u.y : u.x;
        if (z->field_type != 0 || (tall && fabs(b) < 90)) u.place[u.count++] = i;
        else
            tree_remark(z->s, SGT_REMARK_LEFT_OUT, list->line, key_of_list((size_t)(list - z->list)),
                        "field %zu, an angle of %g degrees: it must be less than 90", i + 1, tall ? b : a);
    }
    if (u.count == 0 && (listed || (z->fields != 0 && z->fields != SIZE_MAX)))
        tree_remark(z->s, SGT_REMARK_NOTE, z->ftyp_line ? z->ftyp_line : 1, "FTYP",
                    "no field is left; one on the axis is taken");
    return u;
}

/* Factors of VDXN and its kin, one map a field; those of other pupils (ZVDX ...) are left out. */
static void write_vignetting(zmx *z, node *root, const used_fields *u)
{
    static const char *const keys[] = {"dx", "dy", "cx", "cy", "angle"};
    enum { KEYS = sizeof keys / sizeof keys[0] };
    size_t line = 0;
    for (size_t which = ZMX_VIGNETTING; which < ZMX_LISTS; which++)
        for (size_t i = 0; i < u->count; i++) {
            if (value_or_0(&z->list[which], u->place[i]) == 0) continue;
            if (which < ZMX_VIGNETTING + KEYS) line = z->list[which].line;
            else {
                sgt_zmx_tally(z, ZMX_VIGNETTED, z->list[which].line, key_of_list(which));
                break;
            }
        }
    if (!line) return;
    node *list = tree_node(z->s, NODE_LIST, line);
    for (size_t i = 0; i < u->count; i++) {
        node *map = tree_node(z->s, NODE_MAP, line);
        map->inline_ = true;
        for (size_t k = 0; k < KEYS; k++) {
            double factor = value_or_0(&z->list[ZMX_VIGNETTING + k], u->place[i]);
            if (factor != 0) tree_set(z->s, map, keys[k], tree_number(z->s, line, factor));
        }
        tree_append(z->s, list, map);
    }
    tree_set(z->s, root, "vignetting", list);
}

/* A weight that is missing is 1. */
static void write_field_weights(zmx *z, node *root, const used_fields *u)
{
    const zmx_list *weight = either(z, ZMX_FWGN, ZMX_FWGT);
    double *own = tree_room(z->s, u->count, sizeof *own);
    for (size_t i = 0; i < u->count; i++)
        own[i] = u->place[i] < weight->count ? weight->value[u->place[i]] : 1;
    if (weight->line && weight->count <= u->place[u->count - 1])
        tree_remark(z->s, SGT_REMARK_TURNED, weight->line, key_of_list((size_t)(weight - z->list)),
                    "1 where it lacks a number: it has %zu", weight->count);
    write_weights(z, root, "field_weights", &(zmx_list){own, u->count, u->count, weight->line}, u->count);
}

static void write_fields(zmx *z, node *root)
{
    static const char *const types[] = {NULL, "object_height", "paraxial_image_height", "real_image_height"};
    const used_fields u = choose_fields(z);
    const size_t line = u.y->line ? u.y->line : u.x->line;
    bool plane = true;
    for (size_t i = 0; i < u.count; i++) plane = plane && value_or_0(u.x, u.place[i]) == 0;
    if (z->field_type)
        tree_set(z->s, root, "field_type", tree_word(z->s, z->ftyp_line, types[z->field_type]));
    if (!u.count) return;
    node *list = tree_node(z->s, NODE_LIST, line);
    list->inline_ = plane;
    for (size_t i = 0; i < u.count; i++) {
        const double at[2] = {value_or_0(u.x, u.place[i]), value_or_0(u.y, u.place[i])};
        tree_append(z->s, list, plane ? tree_number(z->s, line, at[1]) : tree_numbers(z->s, line, 2, at));
    }
    tree_set(z->s, root, "fields", list);
    write_field_weights(z, root, &u);
    write_vignetting(z, root, &u);
}

void sgt_zmx_write_system(zmx *z, node *root)
{
    if (z->name) {
        node *name = tree_word(z->s, z->name_line, z->name);
        name->quoted = true;
        tree_set(z->s, root, "name", name);
    }
    if (z->units) tree_set(z->s, root, "units", tree_word(z->s, z->units_line, z->units));
    if (z->makers && z->makers->count) tree_set(z->s, root, "makers", z->makers);
    write_wavelengths(z, root);
    write_pupil(z, root);
    if (z->aiming && z->telecentric) /* as OpticStudio does */
        tree_remark(z->s, SGT_REMARK_LEFT_OUT, z->aiming_line, "RAIM",
                    "ray aiming: OpticStudio ignores it where the object is telecentric; --aim real aims");
    else if (z->aiming)
        tree_set(z->s, root, "aim", tree_word(z->s, z->aiming_line, z->aiming == 1 ? "stop" : "real_stop"));
    if (z->afocal) tree_set(z->s, root, "afocal", tree_word(z->s, z->ftyp_line, "true"));
    write_fields(z, root);
}

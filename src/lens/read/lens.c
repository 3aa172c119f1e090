// SPDX-License-Identifier: MIT
/* lens.c - makes a lens of the tree of its file.
 *
 * Vertices stand where the running frame is (frame.c): without breaks, on the axis at the running
 * sum of the thicknesses, the first at z = 0.  `decenter` and `tilt` of a surface move and turn
 * its own frame only.  If one surface gives `origin` instead, all must.
 *
 * The keys are read in the order in which they depend on each other: the wavelengths say how
 * long a list of indices must be.  The media are kept, so that the indices at any wavelength can
 * be had of a lens that was read once. */
#include "lens.h"

#include "aperture.h"
#include "frame.h"
#include "../base/reader.h"
#include "phase.h"
#include "surface.h"
#include "tolerance.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const double NANOMETRES = 100; /* micrometres: light so long is rarer than a slip of the unit */

static double positive_number(source *s, const node *n, const char *key, number_range range)
{
    double x = tree_read_number(s, n, key, range);
    if (!(x > 0)) tree_fail(s, n->line, key, "must be positive, not %g", x);
    return x;
}

static double *number_list(source *s, const node *n, const char *key, size_t *count)
{
    double *list = tree_room(s, n->kind == NODE_LIST ? n->count : 0, sizeof *list);
    *count = tree_read_numbers(s, n, key, SIZE_MAX, list);
    return list;
}

/* As many numbers as there are `what`, none negative; ones if n is NULL. */
static double *weights_of(source *s, const node *n, const char *key, size_t count, const char *what)
{
    size_t many = count;
    double *weight = n ? number_list(s, n, key, &many) : tree_room(s, count, sizeof *weight);
    if (many != count)
        tree_fail(s, n->line, key, "has %zu number%s, but there %s %zu %s%s", many, many == 1 ? "" : "s",
                  count == 1 ? "is" : "are", count, what, count == 1 ? "" : "s");
    for (size_t i = 0; i < count; i++) {
        if (!n) weight[i] = 1;
        if (!(weight[i] >= 0))
            tree_fail(s, n->item[i]->line, key, "must not be negative, but is %g", weight[i]);
    }
    return weight;
}

/* Which of the words, separated by |, from 0. */
static int word_of(source *s, const node *n, const char *key, const char *words)
{
    const char *given = tree_read_text(s, n, key), *word = words;
    for (int number = 0;; number++) {
        size_t length = strcspn(word, "|");
        if (strlen(given) == length && strncmp(given, word, length) == 0) return number;
        if (!word[length]) break;
        word += length + 1;
    }
    tree_fail(s, n->line, key, "must be one of %s, not \"%.60s\"", words, given);
}

/* The medium that `index` or `glass` of a map gives; else `otherwise`. */
static medium medium_of(whole_lens *w, const node *map, const char *in, medium otherwise)
{
    source *s = w->media.source;
    const node *index = tree_take(map, "index");
    node *glass = tree_take(map, "glass");
    if (glass && index)
        tree_fail(s, glass->line, "glass", "given beside index; one of them says the medium");
    const char *key = *in ? tree_print(s, "%s%s", in, glass ? "glass" : "index") : glass ? "glass" : "index";
    if (glass) return sgt_medium_of_glass(&w->media, glass, key);
    return index ? sgt_medium_of_index(&w->media, index, key, w->lens.wavelengths) : otherwise;
}

static void read_makers(whole_lens *w, source *s)
{
    const node *n = tree_take(s->root, "makers");
    if (!n) return;
    if (n->kind != NODE_LIST)
        tree_fail(s, n->line, "makers", "must be a list of names, like [SCHOTT, OHARA]");
    const char **maker = tree_room(s, n->count, sizeof *maker);
    for (size_t i = 0; i < n->count; i++)
        maker[w->media.makers++] = tree_read_text(s, n->item[i], "makers");
    w->media.maker = maker;
}

/* Numbers in micrometres, or spectral lines: [F, d, 0.6562725]. */
static double *wavelength_list(source *s, const node *n, size_t *count)
{
    if (n->kind != NODE_LIST || n->count == 0)
        tree_fail(s, n->line, "wavelengths",
                  "must be a list of micrometres or spectral lines, like [F, 0.5876]");
    double *list = tree_room(s, n->count, sizeof *list);
    *count = n->count;
    for (size_t i = 0; i < n->count; i++) {
        const node *one = n->item[i];
        list[i] = one->kind == NODE_SCALAR ? sgt_spectral_line(one->text) : (double)NAN;
        tree_mark_number(one);
        if (isnan(list[i])) list[i] = positive_number(s, one, "wavelengths", NUMBER_FINITE);
    }
    return list;
}

static void read_wavelengths(sgt_lens *l, source *s)
{
    const node *n = tree_take(s->root, "wavelengths"), *primary = tree_take(s->root, "primary");
    l->wavelengths = 1;
    double *list = n ? wavelength_list(s, n, &l->wavelengths) : NULL;
    for (size_t i = 0; list && i < l->wavelengths; i++)
        if (list[i] >= NANOMETRES)
            tree_remark(s, SGT_REMARK_NOTE, n->item[i]->line, "wavelengths",
                        "taken as %g micrometres; for %g nanometres write %g", list[i], list[i],
                        list[i] / 1000);
    l->wavelength = list;
    l->wavelength_weight = weights_of(s, tree_take(s->root, "wavelength_weights"), "wavelength_weights",
                                      l->wavelengths, "wavelength");
    if (!primary && l->wavelengths > 1)
        tree_remark(s, SGT_REMARK_NOTE, n->line, "primary",
                    "missing: the first of %zu wavelengths, %.9g, is taken for focal length and pupil; "
                    "primary: 1 says that it is meant", l->wavelengths, list[0]);
    if (!primary) return;
    double place = tree_read_number(s, primary, "primary", NUMBER_FINITE);
    if (!(place >= 1 && place <= (double)l->wavelengths) || place != floor(place))
        tree_fail(s, primary->line, "primary", "must be a whole number from 1 to %zu, not %g", l->wavelengths,
                  place);
    l->primary = (size_t)place - 1;
}

static void read_object(whole_lens *w, source *s)
{
    sgt_lens *l = &w->lens;
    l->object_distance = HUGE_VAL;
    w->medium[0] = (medium){.kind = MEDIUM_NUMBER, .number = 1};
    const node *map = tree_take(s->root, "object");
    if (!map) return;
    tree_map(s, map, "object");
    const node *n = tree_take(map, "distance");
    if (n) l->object_distance = tree_read_number(s, n, "object.distance", NUMBER_MAYBE_INFINITE) + 0;
    if (!(l->object_distance >= 0))
        tree_fail(s, n->line, "object.distance", "must be 0 or more, not %g", l->object_distance);
    const node *slope = tree_take(map, "slope");
    double slopes[2] = {0, 0};
    if (slope && (slope->kind != NODE_LIST || slope->count != 2))
        tree_fail(s, slope->line, "object.slope", "must be two numbers, [along x, along y]");
    if (slope) tree_read_numbers(s, slope, "object.slope", 2, slopes);
    if (slope && !isfinite(l->object_distance))
        tree_fail(s, slope->line, "object.slope", "the object must be at a distance");
    l->object_slope = (sgt_vec2){slopes[0], slopes[1]};
    const node *telecentric = tree_take(map, "telecentric");
    l->telecentric = telecentric && tree_read_truth(s, telecentric, "object.telecentric");
    if (l->telecentric && !isfinite(l->object_distance))
        tree_fail(s, telecentric->line, "object.telecentric", "the object must be at a distance");
    w->medium[0] = medium_of(w, map, "object.", w->medium[0]);
    if (w->medium[0].kind == MEDIUM_BEFORE)
        tree_fail(s, w->medium[0].line, w->medium[0].key,
                  "nothing is in front of the object to be the same as");
    tree_finish(s, map, "distance, slope, telecentric, index or glass");
}

static const struct { const char *key; sgt_pupil_kind kind; } pupil_keys[] = {
    {"semi_diameter", SGT_PUPIL_RADIUS}, {"f_number", SGT_PUPIL_F_NUMBER},
    {"working_f_number", SGT_PUPIL_WORKING_F_NUMBER}, {"object_na", SGT_PUPIL_OBJECT_NA},
    {"object_angle", SGT_PUPIL_OBJECT_ANGLE}, {"stop_size", SGT_PUPIL_STOP_SIZE},
};
enum { PUPIL_KEYS = sizeof pupil_keys / sizeof pupil_keys[0] };
static const double RIGHT_ANGLE = 90;

static void read_pupil(sgt_lens *l, source *s)
{
    const node *afocal = tree_take(s->root, "afocal");
    l->afocal = afocal && tree_read_truth(s, afocal, "afocal");
    const node *aim = tree_take(s->root, "aim");
    if (aim) l->aim = (sgt_lens_aim)word_of(s, aim, "aim", "pupil|stop|real_stop");
    l->pupil_size = l->pupil_distance = (double)NAN;
    const node *map = tree_take(s->root, "pupil");
    if (!map) return;
    tree_map(s, map, "pupil");
    for (int i = 0; i < PUPIL_KEYS; i++) {
        const node *n = tree_take(map, pupil_keys[i].key);
        char key[40];
        snprintf(key, sizeof key, "pupil.%s", pupil_keys[i].key);
        if (!n) continue;
        if (l->pupil) tree_fail(s, n->line, key, "a second size of the pupil; give one");
        l->pupil = pupil_keys[i].kind;
        if (l->pupil != SGT_PUPIL_STOP_SIZE) l->pupil_size = positive_number(s, n, key, NUMBER_FINITE);
        else if (!tree_read_truth(s, n, key)) l->pupil = SGT_PUPIL_NONE;
        if (l->pupil == SGT_PUPIL_OBJECT_ANGLE && !(l->pupil_size < RIGHT_ANGLE))
            tree_fail(s, n->line, key, "must be below 90 degrees, not %g", l->pupil_size);
    }
    const node *diameter = tree_take(map, "diameter"), *n = tree_take(map, "distance");
    if (diameter && l->pupil)
        tree_fail(s, diameter->line, "pupil.diameter", "a second size of the pupil; give one");
    if (diameter) {
        l->pupil = SGT_PUPIL_RADIUS;
        l->pupil_size = positive_number(s, diameter, "pupil.diameter", NUMBER_FINITE) / 2;
    }
    const node *na = tree_take(map, "image_na");
    if (na && l->pupil) tree_fail(s, na->line, "pupil.image_na", "a second size of the pupil; give one");
    if (na) {
        l->pupil = SGT_PUPIL_WORKING_F_NUMBER;
        l->pupil_size = 1 / (2 * positive_number(s, na, "pupil.image_na", NUMBER_FINITE));
        if (!isfinite(l->pupil_size)) tree_fail(s, na->line, "pupil.image_na", "too small");
    }
    if (n) l->pupil_distance = tree_read_number(s, n, "pupil.distance", NUMBER_FINITE);
    tree_finish(s, map,
                "semi_diameter or diameter, f_number, working_f_number, image_na, object_na, object_angle or "
                "stop_size; distance");
}

static const char FIELD_KINDS[] = "angle|object_height|paraxial_image_height|real_image_height";

static double field_number(const sgt_lens *l, source *s, const node *n)
{
    double x = tree_read_number(s, n, "fields", NUMBER_FINITE);
    if (l->field_kind == SGT_FIELD_ANGLE && !(fabs(x) < RIGHT_ANGLE))
        tree_fail(s, n->line, "fields", "must be between -90 and 90 degrees, not %g", x);
    return x;
}

/* One map a field, with some of the factors. */
static void read_vignetting(sgt_lens_field field[], size_t fields, source *s)
{
    const node *list = tree_take(s->root, "vignetting");
    if (!list) return;
    if (list->kind != NODE_LIST || list->count != fields)
        tree_fail(s, list->line, "vignetting",
                  "must be a list with a map for each field, like [{}, {cy: 0.2}]");
    for (size_t i = 0; i < fields; i++) {
        const node *map = list->item[i];
        tree_map(s, map, "vignetting");
        const struct { const char *key; double *to; } factor[] = {
            {"dx", &field[i].dx}, {"dy", &field[i].dy}, {"cx", &field[i].cx}, {"cy", &field[i].cy},
            {"angle", &field[i].angle}};
        for (int k = 0; k < 5; k++) {
            const node *n = tree_take(map, factor[k].key);
            if (n) *factor[k].to = tree_read_number(s, n, factor[k].key, NUMBER_FINITE);
        }
        tree_finish(s, map, "dx, dy, cx, cy, angle");
    }
}

/* A field is a number, along y, or [x, y]. */
static void read_fields(sgt_lens *l, source *s)
{
    const node *kind = tree_take(s->root, "field_type"), *list = tree_take(s->root, "fields");
    if (kind) l->field_kind = (sgt_field_kind)word_of(s, kind, "field_type", FIELD_KINDS);
    if (l->field_kind == SGT_FIELD_OBJECT_HEIGHT && !isfinite(l->object_distance))
        tree_fail(s, kind->line, "field_type", "object_height, but the object is at infinity");
    if (list && (list->kind != NODE_LIST || list->count == 0))
        tree_fail(s, list->line, "fields",
                  "must be a list of numbers, like [0, 5], or of pairs, like [[3, 4]]");
    l->fields = list ? list->count : 1;
    sgt_lens_field *field = tree_room(s, l->fields, sizeof *field);
    const double *weight = weights_of(s, tree_take(s->root, "field_weights"), "field_weights", l->fields,
                                      "field");
    for (size_t i = 0; i < l->fields; i++) {
        field[i].weight = weight[i];
        if (!list) continue;
        const node *n = list->item[i];
        if (n->kind == NODE_MAP || (n->kind == NODE_LIST && n->count != 2))
            tree_fail(s, n->line, "fields", "must be a number, or a pair [x, y]");
        bool pair = n->kind == NODE_LIST;
        if (pair) field[i].x = field_number(l, s, n->item[0]);
        field[i].y = field_number(l, s, pair ? n->item[1] : n);
    }
    read_vignetting(field, l->fields, s);
    l->field = field;
}

/* ---------------------------------------------------------------- surfaces */

static sgt_vec3 read_vector(source *s, const node *n, const char *key)
{
    double v[3] = {0};
    if (n && (n->kind != NODE_LIST || n->count != 3))
        tree_fail(s, n->line, key, "must be three numbers, [x, y, z]");
    if (n) tree_read_numbers(s, n, key, 3, v);
    return (sgt_vec3){v[0], v[1], v[2]};
}

static bool nonzero(sgt_vec3 v) { return v.x != 0 || v.y != 0 || v.z != 0; }

static bool is_place(sgt_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static bool is_break(const node *map)
{
    const node *type = tree_take(map, "type");
    return type && type->kind == NODE_SCALAR && strcmp(type->text, "break") == 0;
}

static void advance(source *s, const node *thickness, running *at)
{
    if (!thickness) return;
    sgt_frame_advance(at, tree_read_number(s, thickness, "thickness", NUMBER_FINITE));
    if (!is_place(at->pose.origin))
        tree_fail(s, thickness->line, "thickness", "the next vertex is beyond the largest number");
}

static void read_break(source *s, const node *map, bool placed, bool last, running *at)
{
    const node *decenter = tree_take(map, "decenter"), *order = tree_take(map, "order");
    const node *thickness = tree_take(map, "thickness");
    double shift[3] = {0};
    if (placed) tree_fail(s, map->line, "type", "a break has no meaning where surfaces have an origin");
    if (decenter && (decenter->kind != NODE_LIST || decenter->count < 2 || decenter->count > 3))
        tree_fail(s, decenter->line, "decenter", "must be two or three numbers, [x, y] or [x, y, z]");
    if (decenter) tree_read_numbers(s, decenter, "decenter", 3, shift);
    bool tilt_first = order && word_of(s, order, "order", "decenter_first|tilt_first") == 1;
    sgt_frame_break(at, (sgt_vec3){shift[0], shift[1], shift[2]},
                    read_vector(s, tree_take(map, "tilt"), "tilt"), tilt_first);
    if (!is_place(at->pose.origin))
        tree_fail(s, map->line, "decenter", "the next vertex is beyond the largest number");
    if (!thickness && !last) tree_fail(s, map->line, "thickness", "missing; 0 if that is meant");
    advance(s, thickness, at);
    tree_finish(s, map, "type, decenter, tilt, order, thickness");
}

/* Reads the frame of a surface. */
static void read_place(source *s, const node *map, bool placed, running *at, sgt_element *e,
                       sgt_lens_surface *about)
{
    const node *origin = tree_take(map, "origin"), *thickness = tree_take(map, "thickness");
    const node *decenter = tree_take(map, "decenter"), *tilt = tree_take(map, "tilt");
    if (placed && !origin) tree_fail(s, map->line, "origin", "missing; if one surface has it, all must");
    if (origin && thickness)
        tree_fail(s, thickness->line, "thickness", "given beside origin; origin alone places a surface");
    if (origin && decenter)
        tree_fail(s, decenter->line, "decenter", "given beside origin; add it to origin");
    sgt_vec3 shift = read_vector(s, decenter, "decenter"), turn = read_vector(s, tilt, "tilt");
    if (origin) {
        sgt_vec3 vertex = read_vector(s, origin, "origin");
        e->pose = nonzero(turn) ? sgt_pose_tilted(vertex, turn) : (sgt_pose){.origin = vertex};
        about->z = vertex.z;
        about->off_axis = vertex.x != 0 || vertex.y != 0 || nonzero(turn);
        return;
    }
    e->pose = sgt_frame_pose(at, shift, turn);
    about->z = at->z;
    about->folded = at->turned || at->pose.origin.x != 0 || at->pose.origin.y != 0 ||
                    at->pose.origin.z != at->z;
    if (!is_place(e->pose.origin))
        tree_fail(s, decenter->line, "decenter", "the vertex is beyond the largest number");
    advance(s, thickness, at);
}

/* Do the two say the same index at every wavelength, as far as can be seen? */
static bool same_medium(const medium *a, const medium *b, size_t wavelengths)
{
    if (a->kind == MEDIUM_GLASS || b->kind == MEDIUM_GLASS) {
        const sgt_glass *g = a->glass, *h = b->glass;
        return a->kind == b->kind && g->formula == h->formula && g->count == h->count &&
               memcmp(g->coefficient, h->coefficient, g->count * sizeof *g->coefficient) == 0;
    }
    size_t many = a->kind == MEDIUM_LIST || b->kind == MEDIUM_LIST ? wavelengths : 1;
    for (size_t i = 0; i < many; i++) {
        double x = a->kind == MEDIUM_LIST ? a->list[i] : a->number;
        if (x != (b->kind == MEDIUM_LIST ? b->list[i] : b->number)) return false;
    }
    return true;
}

/* For a message. */
static const char *medium_name(source *s, const medium *m)
{
    if (m->kind == MEDIUM_GLASS) return m->glass->name;
    if (m->kind == MEDIUM_LIST) return "another medium than the object's";
    return tree_print(s, "a medium of index %g", m->number);
}

/* The medium behind a surface; *now is that in front of it, and then that behind it.
 *
 * If it is left out, books and other programs mean air, and who puts a plane into a glass means that glass.
 * So it may be left out only where both are the same: at a mirror, behind the last surface, and while light
 * is in the medium of the object. */
static void read_medium(whole_lens *w, source *s, const node *map, size_t i, const medium **now)
{
    const node *mirror = tree_take(map, "mirror");
    medium as_before = {.kind = MEDIUM_BEFORE}, *own = &w->medium[i + 1];
    bool reflects = mirror && tree_read_truth(s, mirror, "mirror");
    w->about[i].mirror = reflects;
    *own = medium_of(w, map, "", as_before);
    bool said = reflects || own->line != 0; /* line 0: as_before */
    if (!said && i + 1 < w->lens.count && !same_medium(*now, &w->medium[0], w->lens.wavelengths))
        tree_fail(s, map->line, "glass",
                  "missing, and light comes to this surface in %s: say what is behind it, glass: air, "
                  "or glass: same (as in front of it)", medium_name(s, *now));
    if (own->kind == MEDIUM_BEFORE) return;
    if (!reflects) {
        *now = own;
        return;
    }
    if (!same_medium(own, *now, w->lens.wavelengths)) {
        char known[40] = "the same";
        if ((*now)->kind == MEDIUM_NUMBER) snprintf(known, sizeof known, "%.17g", (*now)->number);
        tree_fail(s, own->line, own->key,
                  "must be left out or %s: behind a mirror light is in the same medium as before", known);
    }
    *own = as_before;
}

static const char OTHER_KEYS[] =
    "; semi_diameter, apertures, draw_to, name, thickness, index, glass, mirror, stop, "
    "decenter, tilt, origin, phase, facets";

static void read_shape(source *s, const node *map, sgt_element *e, sgt_lens_surface *about)
{
    const node *type = tree_take(map, "type");
    if (type && type->kind == NODE_SCALAR && strcmp(type->text, "ideal") == 0) {
        sgt_read_ideal(s, map, OTHER_KEYS, e);
        const sgt_phase *p = e->phase;
        about->type = "ideal",
        about->focal_length = p->focal_length_y == 0 ? p->focal_length : p->focal_length_y;
        return;
    }
    const sgt_builtin *row;
    e->surface = sgt_read_surface(s, map, SURFACE_NO_RIM, OTHER_KEYS, &row);
    about->type = row->type;
}

static void read_surface(whole_lens *w, source *s, const node *map, size_t i, bool placed, bool last,
                         running *at, const medium **now)
{
    sgt_lens *l = &w->lens;
    sgt_element *e = &w->element[i];
    sgt_lens_surface *about = &w->about[i];
    about->line = map->line;
    read_place(s, map, placed, at, e, about);
    read_medium(w, s, map, i, now);
    const node *stop = tree_take(map, "stop"), *rim = tree_take(map, "semi_diameter");
    const node *name = tree_take(map, "name"), *size = tree_take(map, "draw_to");
    const node *apertures = tree_take(map, "apertures"), *phase = tree_take(map, "phase");
    const node *facets = tree_take(map, "facets");
    if (apertures) e->aperture = sgt_read_apertures(s, apertures);
    about->name = name ? tree_read_text(s, name, "name") : "";
    if (stop && tree_read_truth(s, stop, "stop")) {
        if (l->stop_marked) tree_fail(s, stop->line, "stop", "a second stop; a lens has one");
        l->stop_marked = true, l->stop = i;
    }
    if (phase && facets) tree_fail(s, facets->line, "facets", "a surface with facets has no phase");
    if (phase) sgt_read_phase(w, s, phase, i);
    if (facets) sgt_read_facets(w, s, facets, i);
    if (rim) e->semi_diameter = tree_read_number(s, rim, "semi_diameter", NUMBER_FINITE);
    if (!(e->semi_diameter >= 0)) tree_fail(s, rim->line, "semi_diameter", "must not be negative");
    about->size = size ? positive_number(s, size, "draw_to", NUMBER_FINITE) : e->semi_diameter;
    read_shape(s, map, e, about);
    if (!placed && !last && !tree_take(map, "thickness"))
        tree_fail(s, map->line, "thickness", "missing; 0 if that is meant");
}

static const node *surface_list(source *s)
{
    const node *list = tree_take(s->root, "surfaces");
    if (!list) tree_fail(s, s->root->line, "surfaces", "missing; a lens has at least one surface");
    if (list->kind != NODE_LIST || list->count == 0)
        tree_fail(s, list->line, "surfaces", "must be a list of at least one surface, like [{type: plane}]");
    return list;
}

static void read_surfaces(whole_lens *w, source *s, const node *list)
{
    sgt_lens *l = &w->lens;
    bool placed = false;
    for (size_t i = 0; i < list->count; i++) {
        tree_map(s, list->item[i], "surfaces");
        const node *origin = tree_take(list->item[i], "origin");
        if (origin) placed = true, read_vector(s, origin, "origin");
        l->count += !is_break(list->item[i]);
    }
    if (!l->count) tree_fail(s, list->line, "surfaces", "has breaks only; a lens has at least one surface");
    w->element = tree_room(s, l->count, sizeof *w->element);
    w->about = tree_room(s, l->count, sizeof *w->about);
    running at = {.z = 0};
    const medium *now = &w->medium[0];
    for (size_t i = 0, k = 0; i < list->count; i++) {
        const node *map = list->item[i];
        bool last = i + 1 == list->count;
        tree_map(s, map, "surfaces");
        if (is_break(map)) read_break(s, map, placed, last, &at);
        else read_surface(w, s, map, k++, placed, last, &at, &now);
    }
    l->element = w->element, l->surface = w->about;
}

/* -------------------------------------------------------------- the indices */

/* Fills in the indices at a wavelength.  Returns the medium that has none there, or NULL. */
static const medium *fill_indices(const whole_lens *w, double um, sgt_element element[], double *before,
                                  char why[WHY_SIZE])
{
    const medium *none = NULL;
    double index = *before = sgt_medium_index(&w->medium[0], &w->lens, um, 1, why);
    if (isnan(index)) none = &w->medium[0];
    for (size_t i = 0; i < w->lens.count; i++) {
        char other[WHY_SIZE];
        index = sgt_medium_index(&w->medium[i + 1], &w->lens, um, index, none ? other : why);
        if (isnan(index) && !none) none = &w->medium[i + 1];
        if (element) element[i].index = w->about[i].mirror ? SGT_MIRROR : index;
    }
    return none;
}

bool sgt_lens_at(const sgt_lens *lens, double um, sgt_element element[], double *index_before,
                 sgt_error *error)
{
    const whole_lens *w = (const void *)lens;
    char why[WHY_SIZE];
    sgt_error unread;
    reader r = {.file = lens->file, .error = error ? error : &unread};
    if (element) {
        memcpy(element, lens->element, lens->count * sizeof *element);
        if (!sgt_put_phases(w, um, element)) return sgt_reader_fail(&r, 0, "", "no memory");
    }
    const medium *none = fill_indices(w, um, element, index_before, why);
    if (!none) return true;
    return sgt_reader_fail(&r, none->line, none->key, "%s", why);
}

bool sgt_lens_glass(const sgt_lens *lens, size_t place, sgt_glass *glass, size_t *line)
{
    const whole_lens *w = (const void *)lens;
    const medium *m = place <= lens->count ? &w->medium[place] : NULL;
    if (!m || m->kind != MEDIUM_GLASS) return false;
    *glass = *m->glass;
    if (line) *line = m->line;
    return true;
}

bool sgt_lens_formula(const sgt_lens *lens, size_t place, const char **text, const sgt_named **parameters,
                      size_t *n)
{
    if (place < 1 || place > lens->count) return false;
    const formula_text *f = sgt_formula_of(lens, lens->element[place - 1].surface);
    if (!f) return false;
    *text = f->text, *parameters = f->parameter, *n = f->count;
    return true;
}

const formula_text *sgt_formula_of(const sgt_lens *lens, sgt_surface s)
{
    const whole_lens *w = (const void *)lens;
    const formula_text *f = w->formula;
    while (f && f->self != s.self) f = f->next;
    return f;
}

/* ------------------------------------------------------------------- a lens */

void sgt_read_lens(whole_lens *w, source *s)
{
    sgt_lens *l = &w->lens;
    tree_map(s, s->root, NULL);
    s->in_lens = true;
    l->line = s->root->line;
    const node *name = tree_take(s->root, "name"), *units = tree_take(s->root, "units");
    const node *list = surface_list(s);
    l->name = name ? tree_read_text(s, name, "name") : "";
    l->units = units ? tree_read_text(s, units, "units") : "";
    w->medium = tree_room(s, list->count + 1, sizeof *w->medium);
    read_makers(w, s);
    read_wavelengths(l, s);
    read_object(w, s);
    read_pupil(l, s);
    read_fields(l, s);
    read_surfaces(w, s, list);
    sgt_make_phases(w, s);
    sgt_read_tolerances(w, s, tree_take(s->root, "tolerances"));
    tree_take(s->root, "configurations"); /* ../open/configure.c */
    tree_finish(s, s->root,
                "name, units, wavelengths, wavelength_weights, primary, makers, object, pupil, aim, afocal, "
                "fields, field_type, field_weights, vignetting, surfaces, tolerances, configurations");
    char why[WHY_SIZE];
    fill_indices(w, l->wavelength ? l->wavelength[l->primary] : (double)NAN, w->element, &l->index_before,
                 why);
}

void sgt_read_one_surface(whole_lens *w, source *s)
{
    sgt_lens *l = &w->lens;
    const sgt_builtin *row;
    if (s->root->kind != NODE_MAP)
        tree_fail(s, s->root->line, NULL, "must be a map of keys and values, as {type: sphere, radius: 20}");
    tree_map(s, s->root, NULL);
    w->element = tree_room(s, 1, sizeof *w->element);
    w->about = tree_room(s, 1, sizeof *w->about);
    w->medium = tree_room(s, 2, sizeof *w->medium);
    w->medium[0] = (medium){.kind = MEDIUM_NUMBER, .number = 1};
    w->element[0].surface = sgt_read_surface(s, s->root, SURFACE_OWN_RIM, "", &row);
    w->element[0].index = 1;
    w->about[0] = (sgt_lens_surface){.type = row->type, .name = "", .line = s->root->line};
    *l = (sgt_lens){.file = l->file, .line = s->root->line, .name = "", .units = "", .wavelengths = 1,
                    .wavelength_weight = weights_of(s, NULL, "", 1, ""), .object_distance = HUGE_VAL,
                    .pupil_size = (double)NAN, .pupil_distance = (double)NAN, .fields = 1,
                    .field = tree_room(s, 1, sizeof *l->field), .count = 1, .element = w->element,
                    .surface = w->about, .index_before = 1};
}

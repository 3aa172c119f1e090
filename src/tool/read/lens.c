/* lens.c - reads a lens file.
 *
 * The vertices stand on the axis at the running sum of the thicknesses, the first at z = 0.
 * `decenter` shifts and `tilt` turns the frame of its own element only.  If one entry gives
 * `origin` instead, all must.
 *
 * The keys are read in the order in which they depend on each other: the wavelengths say how
 * long a list of indices must be.
 *
 * A wavelength that the file does not list serves glasses, and indices that are one number. */
#include "lens.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "surface.h"

#include <stdio.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

static const double NANOMETRES = 100; /* micrometres: light so long is rarer than a slip of the unit */

static double positive(const document *d, const node *n, const char *key, number_range range)
{
    double x = document_number(d, n, key, range);
    if (!(x > 0)) document_fail(d, n, key, "must be positive, not %g", x);
    return x;
}

static double *number_list(const document *d, const node *n, const char *key, size_t *count)
{
    double *list = memory_take(n->kind == NODE_LIST ? n->count : 0, sizeof *list);
    *count = document_numbers(d, n, key, SIZE_MAX, list);
    return list;
}

/* A refractive index: a number, or a list with one for each wavelength. */
static double index_at(const lens *l, const node *n, const char *key)
{
    const document *d = &l->source;
    if (n->kind != NODE_LIST) return positive(d, n, key, NUMBER_FINITE);
    if (n->count != l->wavelengths)
        document_fail(d, n, key, "has %zu number%s, but the lens has %zu wavelength%s", n->count,
                      n->count == 1 ? "" : "s", l->wavelengths, l->wavelengths == 1 ? "" : "s");
    double chosen = 0;
    for (size_t i = 0; i < n->count; i++) {
        double x = positive(d, n->item[i], key, NUMBER_FINITE);
        if (i + 1 == l->chosen) chosen = x;
    }
    if (l->chosen == 0)
        document_fail(d, n, key, "is for the wavelengths of the file; %g micrometres is none of them",
                      l->wavelength);
    return chosen;
}

/* The index that `index` or `glass` of a map gives, or `otherwise`. */
static double medium_of(const lens *l, const node *map, const char *in, double otherwise)
{
    const document *d = &l->source;
    const node *index = document_take(map, "index");
    node *glass = document_take(map, "glass");
    char key[30];
    if (glass && index) document_fail(d, glass, "glass", "given beside index; one of them says the medium");
    snprintf(key, sizeof key, "%s%s", in, glass ? "glass" : "index");
    if (glass) return glass_index(d, glass, key, l->wavelength, &l->makers);
    return index ? index_at(l, index, key) : otherwise;
}

static void read_makers(lens *l)
{
    const document *d = &l->source;
    const node *n = document_take(d->root, "makers");
    if (!n) return;
    if (n->kind != NODE_LIST) document_fail(d, n, "makers", "must be a list of names, like [SCHOTT, OHARA]");
    l->makers.name = memory_take(n->count, sizeof *l->makers.name);
    for (size_t i = 0; i < n->count; i++)
        l->makers.name[l->makers.count++] = document_text(d, n->item[i], "makers");
}

/* wavelength: from 1; 0: um is meant. */
static void read_wavelengths(lens *l, size_t wavelength, double um)
{
    const document *d = &l->source;
    const node *n = document_take(d->root, "wavelengths");
    l->wavelengths = 1, l->wavelength = (double)NAN;
    double *list = n ? number_list(d, n, "wavelengths", &l->wavelengths) : NULL;
    for (size_t i = 0; list && i < l->wavelengths; i++)
        if (positive(d, n->item[i], "wavelengths", NUMBER_FINITE) >= NANOMETRES)
            note("%s:%zu: wavelengths: taken as %g micrometres; for %g nanometres write %g", d->source,
                 n->item[i]->line, list[i], list[i], list[i] / 1000);
    if (wavelength > l->wavelengths)
        fail_usage("--wavelength %zu: %s has %zu wavelength%s", wavelength, d->source, l->wavelengths,
                   l->wavelengths == 1 ? "" : "s");
    l->chosen = wavelength;
    if (wavelength == 0) l->wavelength = um;
    for (size_t i = 0; list && i < l->wavelengths && !l->chosen; i++)
        if (list[i] == um) l->chosen = i + 1;
    if (list && l->chosen) l->wavelength = list[l->chosen - 1];
}

static void read_object(lens *l)
{
    const document *d = &l->source;
    l->object_distance = HUGE_VAL, l->object_index = 1;
    const node *map = document_take(d->root, "object");
    if (!map) return;
    document_map(d, map, "object");
    const node *n = document_take(map, "distance");
    if (n) l->object_distance = positive(d, n, "object.distance", NUMBER_MAYBE_INFINITE);
    l->object_index = medium_of(l, map, "object.", 1);
    document_finish(d, map, "distance, index or glass");
}

static void read_pupil(lens *l)
{
    const document *d = &l->source;
    l->pupil_semi_diameter = l->pupil_distance = (double)NAN;
    const node *map = document_take(d->root, "pupil");
    if (!map) return;
    document_map(d, map, "pupil");
    const node *n = document_take(map, "semi_diameter");
    if (n) l->pupil_semi_diameter = positive(d, n, "pupil.semi_diameter", NUMBER_FINITE);
    n = document_take(map, "distance");
    if (n) l->pupil_distance = document_number(d, n, "pupil.distance", NUMBER_FINITE);
    document_finish(d, map, "semi_diameter, distance");
}

static void read_fields(lens *l)
{
    const document *d = &l->source;
    const node *n = document_take(d->root, "fields");
    l->fields = 1;
    l->field = n ? number_list(d, n, "fields", &l->fields) : memory_take(1, sizeof *l->field);
    for (size_t i = 0; i < l->fields; i++)
        if (!(fabs(l->field[i]) < 90))
            document_fail(d, n->item[i], "fields", "must be between -90 and 90 degrees, not %g", l->field[i]);
}

static sgt_vec3 read_vector(const document *d, const node *n, const char *key)
{
    double v[3] = {0};
    if (n && (n->kind != NODE_LIST || n->count != 3))
        document_fail(d, n, key, "must be three numbers, [x, y, z]");
    if (n) document_numbers(d, n, key, 3, v);
    return (sgt_vec3){v[0], v[1], v[2]};
}

static bool nonzero(sgt_vec3 v) { return v.x != 0 || v.y != 0 || v.z != 0; }

/* Reads the frame of an entry.  *next_z: z of its vertex by the thicknesses so far. */
static void read_place(const document *d, const node *map, bool placed, double *next_z, sgt_element *e,
                       lens_surface *s)
{
    const node *origin = document_take(map, "origin"), *thickness = document_take(map, "thickness");
    const node *decenter = document_take(map, "decenter"), *tilt = document_take(map, "tilt");
    if (placed && !origin) document_fail(d, map, "origin", "missing; if one surface has it, all must");
    if (origin && thickness)
        document_fail(d, thickness, "thickness", "given beside origin; origin alone places a surface");
    if (origin && decenter) document_fail(d, decenter, "decenter", "given beside origin; add it to origin");

    sgt_vec3 at = read_vector(d, origin, "origin"), turn = read_vector(d, tilt, "tilt");
    if (!origin) {
        at = read_vector(d, decenter, "decenter");
        at.z += *next_z;
        if (!isfinite(at.z))
            document_fail(d, decenter, "decenter", "the vertex is beyond the largest number");
    }
    s->z = origin ? at.z : *next_z;
    s->off_axis = origin && (at.x != 0 || at.y != 0 || nonzero(turn));
    e->pose = nonzero(turn) ? sgt_pose_tilted(at, turn) : (sgt_pose){.origin = at};
    if (thickness) *next_z += document_number(d, thickness, "thickness", NUMBER_FINITE);
    if (!isfinite(*next_z))
        document_fail(d, thickness, "thickness", "the next vertex is beyond the largest number");
}

/* The medium behind an entry; `before` is the index in front of it. */
static void read_medium(const lens *l, const node *map, double before, sgt_element *e, lens_surface *s)
{
    const document *d = &l->source;
    const node *mirror = document_take(map, "mirror"), *index = document_take(map, "index");
    const node *glass = document_take(map, "glass");
    s->mirror = mirror && document_truth(d, mirror, "mirror");
    s->index = medium_of(l, map, "", before);
    if (s->mirror && s->index != before)
        document_fail(d, index ? index : glass, index ? "index" : "glass",
                      "must be left out or %.17g: behind a mirror light is in the same medium as before",
                      before);
    e->index = s->mirror ? SGT_MIRROR : s->index;
}

static void read_surfaces(lens *l)
{
    const document *d = &l->source;
    const node *list = document_take(d->root, "surfaces");
    if (!list) document_fail(d, d->root, "surfaces", "missing; a lens has at least one surface");
    if (list->kind != NODE_LIST || list->count == 0)
        document_fail(d, list, "surfaces", "must be a list of at least one surface, like [{type: plane}]");
    l->count = list->count;
    l->element = memory_take(l->count, sizeof *l->element);
    l->surface = memory_take(l->count, sizeof *l->surface);

    bool placed = false;
    for (size_t i = 0; i < l->count; i++) {
        document_map(d, list->item[i], "surfaces");
        const node *origin = document_take(list->item[i], "origin");
        if (origin) placed = true, read_vector(d, origin, "origin");
    }
    double z = 0, before = l->object_index;
    for (size_t i = 0; i < l->count; i++) {
        const node *map = list->item[i];
        sgt_element *e = &l->element[i];
        lens_surface *s = &l->surface[i];
        const sgt_builtin *type;
        document_map(d, map, "surfaces");
        read_place(d, map, placed, &z, e, s);
        read_medium(l, map, before, e, s);
        const node *stop = document_take(map, "stop"), *rim = document_take(map, "semi_diameter");
        if (stop && document_truth(d, stop, "stop")) {
            if (l->stop_marked) document_fail(d, stop, "stop", "a second stop; a lens has one");
            l->stop_marked = true, l->stop = i;
        }
        if (rim) e->semi_diameter = document_number(d, rim, "semi_diameter", NUMBER_FINITE);
        if (!(e->semi_diameter >= 0)) document_fail(d, rim, "semi_diameter", "must not be negative");
        e->surface = surface_read(d, map, SURFACE_NO_RIM,
                                  "; semi_diameter, thickness, index, glass, mirror, stop, decenter, "
                                  "tilt, origin",
                                  &type);
        s->type = type->type;
        before = s->index;

        if (!placed && i + 1 < l->count && !document_take(map, "thickness"))
            document_fail(d, map, "thickness", "missing; 0 if that is meant");
    }
}

static lens read_lens(const char *path, size_t wavelength, double um)
{
    input file = input_read(path);
    lens l = {.source = document_parse(file.name, file.text, file.length)};
    const document *d = &l.source;
    const char *behind = strrchr(path, '/');
    if (behind) l.source.folder = memory_text(path, (size_t)(behind + 1 - path));
    document_map(d, d->root, NULL);
    const node *name = document_take(d->root, "name"), *units = document_take(d->root, "units");
    l.name = name ? document_text(d, name, "name") : "";
    l.units = units ? document_text(d, units, "units") : "";
    read_makers(&l);
    read_wavelengths(&l, wavelength, um);
    read_object(&l);
    read_pupil(&l);
    read_fields(&l);
    read_surfaces(&l);
    document_finish(d, d->root, "name, units, wavelengths, makers, object, pupil, fields, surfaces");
    return l;
}

lens lens_read(const char *path, size_t wavelength) { return read_lens(path, wavelength, (double)NAN); }

lens lens_read_at(const char *path, double um) { return read_lens(path, 0, um); }

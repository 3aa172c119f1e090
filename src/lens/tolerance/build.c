// SPDX-License-Identifier: MIT
/* build.c - the lens of a point of the box, by edits.
 *
 * All that the entries put off is written for every point, also what is 0 there.  So the lens of a point does
 * not hang on which lens it was made of.  Numbers that several entries put off, such as a thickness that is
 * also a compensator, are off by the sum.
 *
 * CURVATURE.  n fringes of test light mean that the gap to the test plate grows by n half waves from the
 * vertex to the radius h: c' h^2 / 2 - c h^2 / 2 = n wavelength / 2, so c' = c + n wavelength / h^2.  A
 * radius that is off is R' = R + d; both together c' = 1 / R' + n wavelength / h^2.
 *
 * PLACE.  Entry j moves its surfaces as one body: p becomes c + R (p - c) + d.  The axes x, y, z of R and d
 * are those of its first surface as designed, with the pivot c on that z.  Several entries act in their order
 * in the file.  The file of the lens has decenter and tilt of a surface in its running frame A: its vertex is
 * at A's origin plus A decenter, its axes are A turned by T = Rz Ry Rx of tilt.  So A = P T^-1 with P the
 * axes as designed; from the new ones P' and the way v of the vertex follow decenter' = decenter + A^-1 v and
 * T' = A^-1 P', and of a product Rz(c) Ry(b) Rx(a) the angles are
 *
 *     a = atan2(T32, T33), b = atan2(-T31, hypot(T32, T33)),
 *     c = atan2(T13 sin a - T12 cos a, T22 cos a - T23 sin a),
 *
 * where c, which is that of T Rx(a)^-1, makes good what rounding does to a where b is near 90 degrees.
 *
 * SHAPE.  A plane, sphere or conic becomes the same base with polynomials of Zernike. */
#include "tolerance.h"

#include "../../text/number.h"
#include "../base/vec3.h"

#include <stdio.h>
#include <string.h>

enum { PATH = 64, EDITS = 9 };

static bool refuse_entry(const sgt_tolerancing *t, size_t i, const char *words, sgt_error *error)
{
    char about[SGT_TOLERANCE_SIZE], why[sizeof error->words];
    sgt_tolerance_text(&t->entry[i], about);
    snprintf(why, sizeof why, "%s", words);
    *error = (sgt_error){.line = t->entry[i].line};
    snprintf(error->file, sizeof error->file, "%s", t->of->file);
    snprintf(error->key, sizeof error->key, "tolerances[%zu]", i + 1);
    snprintf(error->words, sizeof error->words, "%s: %.1000s", about, why);
    return false;
}

/* -------------------------------------------------------------------- as designed */

static double number_given(const sgt_lens *lens, size_t surface, const char *key, double otherwise)
{
    char path[PATH];
    double x;
    snprintf(path, sizeof path, "surfaces[%zu].%s", surface, key);
    return sgt_lens_get(lens, path, &x, NULL) ? x : otherwise;
}

static bool file_gives(const sgt_lens *lens, size_t surface, const char *key)
{
    char path[PATH], text[2];
    snprintf(path, sizeof path, "surfaces[%zu].%s", surface, key);
    return sgt_lens_get_text(lens, path, sizeof text, text, NULL) != SIZE_MAX;
}

static sgt_vec3 vector_of(const sgt_lens *lens, size_t surface, const char *key)
{
    char path[24];
    sgt_vec3 v = {0, 0, 0};
    double *const to[] = {&v.x, &v.y, &v.z};
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s[%d]", key, i + 1);
        *to[i] = number_given(lens, surface, path, 0);
    }
    return v;
}

static off_surface *off_surface_of(sgt_tolerancing *t, size_t number)
{
    for (size_t i = 0; i < t->surfaces; i++)
        if (t->surface[i].number == number) return &t->surface[i];
    off_surface *o = &t->surface[t->surfaces++];
    *o = (off_surface){.number = number, .by_radius = true};
    return o;
}

static bool indices_of(sgt_tolerancing *t, off_surface *o, sgt_error *error)
{
    const sgt_lens *l = t->base;
    sgt_element *e = sgt_arena_take(&t->memory, l->count * sizeof *e);
    o->index = sgt_arena_take(&t->memory, l->wavelengths * sizeof *o->index);
    if (!e || !o->index) return false;
    for (size_t k = 0; k < l->wavelengths; k++) {
        double before;
        if (!sgt_lens_at(l, l->wavelength ? l->wavelength[k] : (double)NAN, e, &before, error)) return false;
        o->index[k] = e[o->number - 1].index;
    }
    return true;
}

static bool as_designed(sgt_tolerancing *t, off_surface *o, sgt_error *error)
{
    const sgt_lens *l = t->base;
    const size_t i = o->number;
    if (o->curved) {
        o->curvature = number_given(l, i, "curvature", 0), o->radius = number_given(l, i, "radius", HUGE_VAL);
        if (isinf(o->radius)) o->curvature = 0;
        o->by_radius = o->by_radius && file_gives(l, i, "radius");
    }
    if (o->thick) o->thickness = number_given(l, i, "thickness", 0);
    if (o->indexed && !indices_of(t, o, error)) return false;
    o->pose = l->element[i - 1].pose;
    if (dot3(o->pose.ex, o->pose.ex) == 0) o->pose.ex.x = o->pose.ey.y = o->pose.ez.z = 1;
    if (!o->placed) return true;
    o->by_origin = file_gives(l, i, "origin");
    o->decenter = vector_of(l, i, o->by_origin ? "origin" : "decenter"), o->tilt = vector_of(l, i, "tilt");
    return true;
}

static void mark_off(off_surface *o, const sgt_tolerance *e)
{
    switch (e->kind) {
    case SGT_TOLERANCE_FRINGES:
        o->by_radius = false, o->fringed = true; /* fall through */
    case SGT_TOLERANCE_RADIUS:
        o->curved = true;
        return;
    case SGT_TOLERANCE_THICKNESS:
        o->thick = true;
        return;
    case SGT_TOLERANCE_INDEX:
        o->indexed = true;
        return;
    case SGT_TOLERANCE_IRREGULARITY:
        o->shaped = true, o->rim = e->over;
        if (o->terms < e->term) o->terms = e->term;
        return;
    default:
        o->placed = true;
    }
}

bool sgt_off_surfaces(sgt_tolerancing *t, sgt_error *error)
{
    t->surface = sgt_arena_take(&t->memory, t->of->count * sizeof *t->surface);
    if (!t->surface) return false;
    for (size_t i = 0; i < t->count; i++)
        for (size_t k = t->entry[i].first; k <= t->entry[i].last; k++) {
            off_surface *o = off_surface_of(t, k);
            if (o->shaped && t->entry[i].kind == SGT_TOLERANCE_IRREGULARITY && o->rim != t->entry[i].over)
                return refuse_entry(t, i, "over must be the same in all irregularities of a surface", error);
            mark_off(o, &t->entry[i]);
        }
    for (size_t k = 0; k < t->surfaces; k++) {
        off_surface *o = &t->surface[k];
        if (!as_designed(t, o, error)) return false;
        t->edits += EDITS;
        t->text += EDITS * PATH + (8 + o->terms + t->of->wavelengths) * NUMBER_SIZE;
    }
    return true;
}

/* ------------------------------------------------------------------------ a point */

typedef struct building {
    const sgt_tolerancing *t;
    const double *value;
    sgt_edit *edit;
    size_t edits;
    char *text; /* what is free of the room for text */
} building;

static double sum_of(const building *b, size_t surface, sgt_tolerance_kind kind, size_t term)
{
    double sum = 0;
    for (size_t i = 0; i < b->t->count; i++) {
        const sgt_tolerance *e = &b->t->entry[i];
        if (e->first == surface && e->kind == kind && e->term == term) sum += b->value[i];
    }
    return sum;
}

static sgt_edit *edit_of(building *b, size_t surface, const char *key)
{
    sgt_edit *e = &b->edit[b->edits++];
    *e = (sgt_edit){.kind = SGT_EDIT_SET, .path = b->text};
    b->text += snprintf(b->text, PATH, "surfaces[%zu].%s", surface, key) + 1;
    return e;
}

static void put_number(building *b, size_t surface, const char *key, double x)
{
    edit_of(b, surface, key)->number = x;
}

static void put_text(building *b, size_t surface, const char *key, const char *text)
{
    sgt_edit *e = edit_of(b, surface, key);
    e->kind = SGT_EDIT_SET_TEXT, e->text = text;
}

/* The numbers, each off by so much. */
static void put_list(building *b, size_t surface, const char *key, size_t count, const double x[], double off)
{
    sgt_edit *e = edit_of(b, surface, key);
    e->kind = SGT_EDIT_SET_TEXT, e->text = b->text;
    *b->text++ = '[';
    for (size_t i = 0; i < count; i++) {
        if (i) *b->text++ = ',', *b->text++ = ' ';
        b->text += number_print(b->text, x[i] + off, false);
    }
    *b->text++ = ']', *b->text++ = 0;
}

/* n fringes as lengths: n waves over the square of the radius, summed over the entries. */
static double power_of_fringes(const building *b, size_t surface)
{
    double sum = 0;
    for (size_t i = 0; i < b->t->count; i++) {
        const sgt_tolerance *e = &b->t->entry[i];
        if (e->first == surface && e->kind == SGT_TOLERANCE_FRINGES)
            sum += b->value[i] * (e->wavelength / b->t->um) / (e->over * e->over);
    }
    return sum;
}

static void put_curvature(building *b, const off_surface *o)
{
    const double off = sum_of(b, o->number, SGT_TOLERANCE_RADIUS, 0);
    if (o->fringed && strcmp(b->t->of->surface[o->number - 1].type, "plane") == 0 && !o->shaped)
        put_text(b, o->number, "type", "sphere");
    if (o->by_radius)
        put_number(b, o->number, "radius", o->radius + off);
    else {
        const double c = off != 0 ? 1 / (o->radius + off) : o->curvature;
        put_number(b, o->number, "curvature", c + power_of_fringes(b, o->number));
    }
}

static void put_shape(building *b, const off_surface *o)
{
    enum { TERMS = 49 };
    double coefficient[TERMS] = {0};
    for (size_t i = 0; i < b->t->count; i++) {
        const sgt_tolerance *e = &b->t->entry[i];
        if (e->first == o->number && e->kind == SGT_TOLERANCE_IRREGULARITY)
            coefficient[e->term - 1] += b->value[i] * (e->wavelength / b->t->um) / 2;
    }
    put_text(b, o->number, "type", "zernike");
    put_number(b, o->number, "norm", o->rim);
    put_text(b, o->number, "order", "fringe");
    put_list(b, o->number, "coefficients", o->terms, coefficient, 0);
}

static void put_index(building *b, const off_surface *o)
{
    const double off = sum_of(b, o->number, SGT_TOLERANCE_INDEX, 0);
    const size_t n = b->t->of->wavelengths;
    if (n == 1)
        put_number(b, o->number, "index", o->index[0] + off);
    else
        put_list(b, o->number, "index", n, o->index, off);
}

/* A vector turned as by Rz Ry Rx of one angle about an axis of a frame. */
static sgt_vec3 turned_about(const sgt_pose *frame, const sgt_pose *turn, sgt_vec3 v)
{
    return out_of3(frame, out_of3(turn, into3(frame, v)));
}

static const off_surface *of_number(const sgt_tolerancing *t, size_t number)
{
    const off_surface *o = t->surface;
    while (o->number != number) o++;
    return o;
}

/* Moves a pose by an entry.  *turned is set if its axes have changed. */
static void move_by(const building *b, size_t i, sgt_pose *p, bool *turned)
{
    const sgt_tolerance *e = &b->t->entry[i];
    const sgt_pose *frame = &of_number(b->t, e->first)->pose;
    const double d = b->value[i];
    sgt_vec3 by = {0, 0, 0};
    double *const part[] = {&by.x, &by.y, &by.z};
    if (d == 0) return;
    if (e->kind <= SGT_TOLERANCE_DECENTER_Z) {
        *part[e->kind - SGT_TOLERANCE_DECENTER_X] = d;
        p->origin = along3(p->origin, 1, out_of3(frame, by));
        return;
    }
    *part[e->kind - SGT_TOLERANCE_TILT_X] = d;
    const sgt_pose turn = sgt_pose_tilted((sgt_vec3){0, 0, 0}, by);
    const sgt_vec3 pivot = along3(frame->origin, e->pivot, frame->ez);
    if (e->first != e->last || e->pivot != 0 || minus3(p->origin, pivot).x != 0 || p->origin.y != pivot.y ||
        p->origin.z != pivot.z)
        p->origin = along3(pivot, 1, turned_about(frame, &turn, minus3(p->origin, pivot)));
    p->ex = turned_about(frame, &turn, p->ex), p->ey = turned_about(frame, &turn, p->ey);
    p->ez = turned_about(frame, &turn, p->ez);
    *turned = true;
}

static void put_place(building *b, const off_surface *o)
{
    static const double DEGREES = 57.29577951308232;
    sgt_pose p = o->pose;
    bool turned = false;
    for (size_t i = 0; i < b->t->count; i++) {
        const sgt_tolerance *e = &b->t->entry[i];
        if (e->first <= o->number && e->last >= o->number && e->kind >= SGT_TOLERANCE_DECENTER_X &&
            e->kind <= SGT_TOLERANCE_TILT_Z)
            move_by(b, i, &p, &turned);
    }
    /* the running frame: the columns of P T^-1 are P times the rows of T */
    sgt_pose t = sgt_pose_tilted((sgt_vec3){0, 0, 0}, o->tilt), a = o->pose;
    if (dot3(t.ex, t.ex) == 0) t.ex.x = t.ey.y = t.ez.z = 1;
    if (o->by_origin)
        a = (sgt_pose){.ex = {1, 0, 0}, .ey = {0, 1, 0}, .ez = {0, 0, 1}};
    else {
        a.ex = out_of3(&o->pose, (sgt_vec3){t.ex.x, t.ey.x, t.ez.x});
        a.ey = out_of3(&o->pose, (sgt_vec3){t.ex.y, t.ey.y, t.ez.y});
        a.ez = out_of3(&o->pose, (sgt_vec3){t.ex.z, t.ey.z, t.ez.z});
    }
    const sgt_vec3 way = into3(&a, minus3(p.origin, o->pose.origin)), d = along3(o->decenter, 1, way);
    const sgt_vec3 x = into3(&a, p.ex), y = into3(&a, p.ey), z = into3(&a, p.ez);
    const double at[] = {d.x, d.y, d.z};
    const double about_x = atan2(y.z, z.z), s = sin(about_x), c = cos(about_x);
    const double turn[] = {about_x, atan2(-x.z, hypot(y.z, z.z)),
                           atan2(s * z.x - c * y.x, c * y.y - s * z.y)};
    const double angle[] = {turned ? DEGREES * turn[0] : o->tilt.x, turned ? DEGREES * turn[1] : o->tilt.y,
                            turned ? DEGREES * turn[2] : o->tilt.z};
    put_list(b, o->number, o->by_origin ? "origin" : "decenter", 3, at, 0);
    put_list(b, o->number, "tilt", 3, angle, 0);
}

bool sgt_build_at(const sgt_tolerancing *t, sgt_lens *lens, const double value[], sgt_error *error)
{
    const sgt_allocator a = t->memory.allocator;
    if (!t->edits) return true;
    sgt_edit *edit = a.resize(a.context, NULL, t->edits * sizeof *edit + t->text);
    if (!edit) {
        *error = (sgt_error){.line = 0};
        snprintf(error->words, sizeof error->words, "no memory");
        return false;
    }
    building b = {.t = t, .value = value, .edit = edit, .text = (char *)(edit + t->edits)};
    for (size_t k = 0; k < t->surfaces; k++) {
        const off_surface *o = &t->surface[k];
        if (o->shaped) put_shape(&b, o);
        if (o->curved) put_curvature(&b, o);
        if (o->thick)
            put_number(&b, o->number, "thickness",
                       o->thickness + sum_of(&b, o->number, SGT_TOLERANCE_THICKNESS, 0));
        if (o->placed) put_place(&b, o);
        if (o->indexed) put_index(&b, o);
    }
    const bool fine = sgt_lens_edit(lens, b.edits, edit, error);
    a.resize(a.context, edit, 0);
    return fine;
}

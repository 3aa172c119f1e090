// SPDX-License-Identifier: MIT
/* elements.c - draws the elements of a scene.
 *
 * In a section, glass is the area between two faces, and its edges join their ends: flat rings where one face
 * is wider, then a cylinder.  In the view in space it is the convex hull of both faces as they are seen,
 * which is what a lens covers whose faces are convex; it lets what is behind shine through, so the order does
 * not matter. */
#include "elements.h"

#include "../show/frame.h"

#include <math.h>
#include <stdlib.h>

static const double ARROW_LENGTH = 7, ARROW_WIDTH = 4, HATCH_STEP = 5, HATCH_LENGTH = 5, GROOVE_LENGTH = 3,
                    STOP_TICK = 13;
static const double dashes[] = {3, 3};

/* -------------------------------------------------------------------- glass */

static void glass_section(const page *p, const outline *a, const outline *b)
{
    double half = fmax(a->half, b->half);
    sgt_vec3 line[2 * OUTLINE_POINTS + 4];
    size_t n = 0;
    for (int k = 0; k < OUTLINE_POINTS; k++) line[n++] = a->at[k];
    line[n++] = outline_corner(a, 1, half);
    line[n++] = outline_corner(b, 1, half);
    for (int k = OUTLINE_POINTS - 1; k >= 0; k--) line[n++] = b->at[k];
    line[n++] = outline_corner(b, 0, half);
    line[n++] = outline_corner(a, 0, half);
    page_line(p, line, n);
    cairo_close_path(p->cr);
    cairo_set_source_rgb(p->cr, 0.89, 0.93, 0.96);
    cairo_fill(p->cr);
}

/* The edge of a glass element, and the flat rings that join it to the faces. */
static void glass_edges(const page *p, const outline *a, const outline *b)
{
    double half = fmax(a->half, b->half);
    for (int side = 0; side < 2; side++) {
        const sgt_vec3 edge[] = {outline_corner(a, side, a->half), outline_corner(a, side, half),
                                 outline_corner(b, side, half), outline_corner(b, side, b->half)};
        page_line(p, edge, 4);
        page_stroke(p, PAGE_SURFACE, 0.15);
    }
}

static int by_place(const void *left, const void *right)
{
    const page_dot *a = left, *b = right;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return a->y < b->y ? -1 : a->y > b->y;
}

/* Is c to the left of the way from a to b, or on it? */
static bool turns_back(page_dot a, page_dot b, page_dot c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) <= 0;
}

/* The convex hull of points (A. M. Andrew 1979, Information Processing Letters 9, 216): its lower and its
 * upper chain, over the points from left to right.  Returns how many corners it has. */
static size_t hull_of(page_dot dot[], size_t count, page_dot hull[])
{
    size_t n = 0;
    qsort(dot, count, sizeof *dot, by_place);
    for (int chain = 0; chain < 2; chain++)
        for (size_t i = 0, first = n; i < count; i++) {
            page_dot d = dot[chain ? count - 1 - i : i];
            while (n >= first + 2 && turns_back(hull[n - 2], hull[n - 1], d)) n--;
            hull[n++] = d;
        }
    return n;
}

/* The rim of a face, widened to half the height `half` by a flat ring. */
static void widened_rim(const outline *o, double half, sgt_vec3 rim[RIM_POINTS + 1])
{
    sgt_vec3 middle = {0, 0, 0};
    for (int k = 0; k < RIM_POINTS; k++) middle = vector_along(middle, o->rim[k], 1.0 / RIM_POINTS);
    for (int k = 0; k <= RIM_POINTS; k++)
        rim[k] = vector_along(middle, vector_minus(o->rim[k % RIM_POINTS], middle), half / o->half);
}

/* A glass as it is seen in space: the hull of its faces and of their rims, that are as wide as the wider. */
static void glass_in_space(const page *p, const outline *a, const outline *b)
{
    enum { MOST = 2 * (RIM_POINTS + OUTLINE_POINTS) };
    const double half = fmax(a->half, b->half);
    page_dot dot[MOST], hull[2 * MOST];
    size_t n = 0;
    for (int face = 0; face < 2; face++) {
        const outline *o = face ? b : a;
        sgt_vec3 rim[RIM_POINTS + 1];
        widened_rim(o, half, rim);
        for (int k = 0; k < RIM_POINTS + OUTLINE_POINTS; k++) {
            page_dot d = page_at(p, k < RIM_POINTS ? rim[k] : o->at[k - RIM_POINTS]);
            if (isfinite(d.x) && isfinite(d.y)) dot[n++] = d;
        }
        if (half > o->half) page_line(p, rim, RIM_POINTS + 1);
        page_stroke(p, PAGE_THIN, 0.35);
    }
    n = hull_of(dot, n, hull);
    for (size_t i = 0; i < n; i++) cairo_line_to(p->cr, hull[i].x, hull[i].y);
    cairo_close_path(p->cr);
    cairo_set_source_rgba(p->cr, 0.45, 0.62, 0.76, 0.22);
    cairo_fill_preserve(p->cr);
    page_stroke(p, PAGE_SURFACE, 0.35);
}

/* The face of a mirror as it is seen in space, with the holes of its apertures. */
static void mirror_in_space(const page *p, const outline *o)
{
    for (size_t k = 0; k < o->pieces; k++)
        if (o->piece[k].kind == PIECE_SURFACE) page_line(p, o->piece[k].at, o->piece[k].count);
    cairo_set_fill_rule(p->cr, CAIRO_FILL_RULE_EVEN_ODD);
    cairo_set_source_rgba(p->cr, 0.55, 0.55, 0.6, 0.3);
    cairo_fill(p->cr);
}

void elements_fill(const page *p)
{
    const scene *s = p->scene;
    for (size_t i = 0; i < s->job->lens.count; i++) {
        const outline *o = &s->outline[i];
        if (scene_glass_behind(s, i))
            (s->view.plane == VIEW_3D ? glass_in_space : glass_section)(p, o, o + 1);
        if (o->mirror && s->view.plane == VIEW_3D) mirror_in_space(p, o);
    }
}

/* ----------------------------------------------------------------- surfaces */

/* Strokes along a piece of a section, each from it by `ahead` along z and by `back` along the section. */
static void strokes_along(const page *p, const outline *o, const outline_piece *at, double ahead_by,
                          double back_by)
{
    const page_dot ahead = page_along(p, o->ahead);
    double rest = HATCH_STEP / 2;
    for (size_t k = 1; k < at->count; k++) {
        page_dot a = page_at(p, at->at[k - 1]), b = page_at(p, at->at[k]);
        double length = hypot(b.x - a.x, b.y - a.y), done = rest;
        for (; done < length; done += HATCH_STEP) {
            double u = done / length, along = back_by / length;
            double x = a.x + u * (b.x - a.x), y = a.y + u * (b.y - a.y);
            cairo_move_to(p->cr, x, y);
            cairo_line_to(p->cr, x + ahead_by * ahead.x - along * (b.x - a.x),
                          y + ahead_by * ahead.y - along * (b.y - a.y));
        }
        rest = done - length;
    }
    page_stroke(p, PAGE_THIN, 0.35);
}

/* Bars from the aperture outward, drawn over the glass if that is wider. */
static void stop_bars(const page *p, const outline *o)
{
    const page_dot up = page_along(p, o->up);
    for (int side = 0; side < 2; side++) {
        double length = side ? STOP_TICK : -STOP_TICK;
        page_dot d = page_at(p, outline_corner(o, side, o->half));
        cairo_move_to(p->cr, d.x, d.y);
        cairo_line_to(p->cr, d.x + length * up.x, d.y + length * up.y);
        page_stroke(p, PAGE_BLOCKED, 0);
    }
}

/* The sign of an ideal lens: arrow heads at its ends, outward if it focuses, else inward. */
static void arrow_heads(const page *p, const outline *o)
{
    const page_dot up = page_along(p, o->up), ahead = page_along(p, o->ahead);
    for (int side = 0; side < 2; side++) {
        double along = (side ? -1 : 1) * o->lens * ARROW_LENGTH;
        page_dot tip = page_at(p, outline_corner(o, side, o->half));
        for (int barb = -1; barb <= 1; barb += 2) {
            double across = barb * ARROW_WIDTH;
            cairo_move_to(p->cr, tip.x, tip.y);
            cairo_line_to(p->cr, tip.x + along * up.x + across * ahead.x,
                          tip.y + along * up.y + across * ahead.y);
        }
    }
    page_stroke(p, PAGE_SURFACE, 0.15);
}

static void pieces_stroke(const page *p, const outline *o)
{
    bool space = p->scene->view.plane == VIEW_3D;
    for (size_t k = 0; k < o->pieces; k++) {
        const outline_piece *at = &o->piece[k];
        if (at->kind == PIECE_BLOCKED) continue;
        if (at->kind == PIECE_SURFACE && o->stop && o->dummy && !space) continue; /* a hole, and no surface */
        bool fine = at->kind == PIECE_FINE;
        if (o->mirror && !space && !fine) /* behind it, aslant */
            strokes_along(p, o, at, HATCH_LENGTH * o->back, HATCH_LENGTH);
        if (o->phase && !space && !fine) /* across it, on the side of the light: as grooves */
            strokes_along(p, o, at, -GROOVE_LENGTH * o->back, 0);
        page_line(p, at->at, at->count);
        if (o->dummy) cairo_set_dash(p->cr, dashes, 2, 0);
        if (o->dummy || fine)
            page_stroke(p, PAGE_THIN, o->stop && !fine ? 0 : 0.5);
        else
            page_stroke(p, o->mirror ? PAGE_MIRROR : PAGE_SURFACE, 0.15);
        cairo_set_dash(p->cr, NULL, 0, 0);
    }
}

void elements_stroke(const page *p)
{
    const scene *s = p->scene;
    for (size_t i = 0; i < s->job->lens.count; i++) {
        const outline *o = &s->outline[i];
        for (size_t k = 0; k < o->strokes; k++) page_line(p, o->stroke[k], 2);
        page_stroke(p, o->mirror ? PAGE_MIRROR : PAGE_SURFACE, 0.15);
        if (scene_glass_behind(s, i) && s->view.plane != VIEW_3D) glass_edges(p, o, o + 1);
        pieces_stroke(p, o);
        if (o->lens != 0) arrow_heads(p, o);
        if (o->stop && o->half > 0) stop_bars(p, o);
    }
    for (size_t i = 0; i < s->job->lens.count; i++) /* over all else */
        for (size_t k = 0; k < s->outline[i].pieces; k++) {
            const outline_piece *at = &s->outline[i].piece[k];
            if (at->kind != PIECE_BLOCKED) continue;
            page_line(p, at->at, at->count);
            cairo_set_source_rgba(p->cr, 0, 0, 0, 0.4);
            if (at->solid && !p->pale) cairo_fill_preserve(p->cr);
            page_stroke(p, PAGE_BLOCKED, 0);
        }
}

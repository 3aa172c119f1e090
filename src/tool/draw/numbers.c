// SPDX-License-Identifier: MIT
/* numbers.c - places the numbers of the elements.
 *
 * A number stands beyond the upper end of its element.  If another number or an element is in the way it
 * moves aside, then farther out, row by row, and a fine line leads to it; then the same below the lower end.
 * If all that is taken it is left out.  So are those beyond NUMBERED, as the time grows by the square.
 * Elements are numbered in the order of light, so what stands close together gets a staircase. */
#include "numbers.h"

#include "../base/memory.h"
#include "chart_draw.h"

#include <math.h>
#include <stdio.h>

static const double SIZE = CHART_SMALL, FIRST = 9, ROW = 10.5, AWAY = 1.5, LETTER = 6.5, UNDER = 4,
                    STOP_BEYOND = 13, PAGE_EDGE = 4;
enum { ROWS = 6, NUMBERED = 400 };

static chart_box box_of(const page *p, const char *text, page_dot middle)
{
    double half = chart_width(p->cr, text) / 2 + AWAY, high = 0.36 * SIZE + AWAY;
    return (chart_box){middle.x - half, middle.y - high, middle.x + half, middle.y + high};
}

static bool line_meets(page_dot a, page_dot b, chart_box in)
{
    return chart_line_enters(a.x, a.y, b.x, b.y, &in);
}

/* ---------------------------------------------------------------- obstacles */

/* A line on the page, and the box about it. */
typedef struct obstacle { size_t count; page_dot *at; chart_box about; } obstacle;
typedef struct obstacles { obstacle *all; size_t count, room; } obstacles;

static void add_obstacle(obstacles *o, const page *p, const sgt_vec3 at[], size_t count)
{
    obstacle line = {0, memory_take(count, sizeof *line.at), {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (size_t i = 0; i < count; i++) {
        page_dot d = page_at(p, at[i]);
        if (!isfinite(d.x + d.y)) continue;
        line.at[line.count++] = d;
        line.about = (chart_box){fmin(line.about.left, d.x), fmin(line.about.top, d.y),
                                  fmax(line.about.right, d.x), fmax(line.about.bottom, d.y)};
    }
    o->all = memory_room(o->all, o->count, &o->room, sizeof *o->all);
    o->all[o->count++] = line;
}

static obstacles obstacles_of(const page *p)
{
    const scene *s = p->scene;
    obstacles o = {0};
    for (size_t i = 0; i < s->job->lens.count; i++) {
        const outline *a = &s->outline[i];
        for (size_t k = 0; k < a->pieces; k++) add_obstacle(&o, p, a->piece[k].at, a->piece[k].count);
        for (size_t k = 0; k < a->strokes; k++) add_obstacle(&o, p, a->stroke[k], 2);
        for (int side = 0; a->stop && a->half > 0 && side < 2; side++) {
            const sgt_vec3 bar[] = {outline_corner(a, side, a->half),
                                    outline_corner(a, side, a->half + STOP_BEYOND / p->scale)};
            add_obstacle(&o, p, bar, 2);
        }
        double half = scene_glass_behind(s, i) ? fmax(a->half, a[1].half) : 0;
        for (int side = 0; half > 0 && side < 2; side++) {
            const sgt_vec3 edge[] = {outline_corner(a, side, a->half), outline_corner(a, side, half),
                                     outline_corner(a + 1, side, half),
                                     outline_corner(a + 1, side, a[1].half)};
            add_obstacle(&o, p, edge, 4);
        }
    }
    return o;
}

static bool is_free(const page *p, const obstacles *o, const element_numbers *done, const number *n)
{
    chart_box here = box_of(p, n->text, n->at);
    for (size_t i = 0; i < done->count; i++) {
        const number *m = &done->number[i];
        chart_box there = box_of(p, m->text, m->at);
        if (chart_boxes_meet(&here, &there) || (n->led && line_meets(n->from, n->to, there)) ||
            (m->led && line_meets(m->from, m->to, here)))
            return false;
    }
    for (size_t i = 0; i < o->count; i++) {
        const obstacle *line = &o->all[i];
        const chart_box wide = {line->about.left - 1, line->about.top - 1, line->about.right + 1,
                                 line->about.bottom + 1};
        if (!chart_boxes_meet(&here, &wide)) continue;
        for (size_t k = 1; k < line->count; k++)
            if (line_meets(line->at[k - 1], line->at[k], here)) return false;
    }
    return true;
}

/* ------------------------------------------------------------------- places */

/* Where a number's line begins, and the way outward, of length 1. */
static void number_anchor(const page *p, size_t i, int side, page_dot *from, page_dot *out)
{
    const scene *s = p->scene;
    const outline *o = &s->outline[i];
    double sign = side ? 1 : -1, half = o->half;
    *out = (page_dot){0, -sign};
    if (scene_glass_behind(s, i)) half = fmax(half, o[1].half);
    if (i > 0 && scene_glass_behind(s, i - 1)) half = fmax(half, o[-1].half);
    *from = page_at(p, o->half > 0 ? outline_corner(o, side, half) : o->at[0]);
    if (o->half > 0) {
        page_dot up = page_along(p, o->up);
        double length = hypot(up.x, up.y);
        if (length > 0.1) *out = (page_dot){sign * up.x / length, sign * up.y / length};
    }
    /* what has no section, or none that is the outermost: its highest or lowest point */
    bool space = s->view.plane == VIEW_3D;
    for (size_t k = 0; k < o->strokes + (space ? RIM_POINTS : 0); k++) {
        if (k >= o->strokes && o->half == 0) break;
        page_dot d = page_at(p, k < o->strokes ? o->stroke[k][0] : o->rim[k - o->strokes]);
        if (sign * (from->y - d.y) > 0) *from = d;
        if (space) *out = (page_dot){0, -sign};
    }
    double beyond = o->stop && o->half > 0 && !space ? fmax(0, STOP_BEYOND - p->scale * (half - o->half)) : 0;
    *from = (page_dot){from->x + beyond * out->x, from->y + beyond * out->y};
}

/* Puts a number into a row, and moves it aside by so many letters. */
static void number_in_row(number *n, page_dot from, page_dot out, int row, double aside)
{
    double far = FIRST + row * ROW, beside = aside * LETTER;
    if (out.x + out.y > 0) beside = -beside; /* the same order to the right, or downward, on both sides */
    n->from = from;
    n->at = (page_dot){from.x + far * out.x - beside * out.y, from.y + far * out.y + beside * out.x};
    n->to = (page_dot){n->at.x - UNDER * out.x, n->at.y - UNDER * out.y};
    n->led = row > 0 || fabs(aside) > 1;
}

/* To which side a number may move: +1 or -1; 0: to both.  That of a glass's face goes away from the face
 * before it, and that of the first away from the next: so numbers have the order of the faces. */
static int side_of(const page *p, size_t i, int side, page_dot from, page_dot out)
{
    const scene *s = p->scene;
    size_t other = i > 0 && scene_glass_behind(s, i - 1) ? i - 1 : scene_glass_behind(s, i) ? i + 1 : i;
    if (other == i) return 0;
    page_dot there, unused;
    number_anchor(p, other, side, &there, &unused);
    double beyond = out.x * (there.y - from.y) - out.y * (there.x - from.x);
    return (out.x + out.y > 0 ? -beyond : beyond) > 0 ? -1 : 1;
}

/* Looks for a place row by row; false: there is none. */
static bool place_number(const page *p, const obstacles *o, const element_numbers *done, size_t i,
                         double width, number *n)
{
    static const double aside[] = {0, 0.8, -0.8, 1.6, -1.6, 2.4, -2.4};
    enum { ASIDE = sizeof aside / sizeof aside[0] };
    for (int side = 1; side >= 0; side--) {
        page_dot from, out;
        number_anchor(p, i, side, &from, &out);
        const int allowed = side_of(p, i, side, from, out);
        for (int k = 0; k < ROWS * ASIDE; k++) {
            if (allowed * aside[k % ASIDE] < 0) continue;
            number_in_row(n, from, out, k / ASIDE, aside[k % ASIDE]);
            chart_box at = box_of(p, n->text, n->at);
            if (at.left > PAGE_EDGE && at.right < width - PAGE_EDGE && is_free(p, o, done, n)) return true;
        }
    }
    return false;
}

element_numbers numbers_of(const page *p, double width)
{
    const size_t count = p->scene->job->lens.count;
    element_numbers n = {
        .number = memory_take(count, sizeof *n.number), .top = HUGE_VAL, .bottom = -HUGE_VAL};
    obstacles o = obstacles_of(p);
    chart_font(p->cr, SIZE, false);
    for (size_t i = 0; i < count; i++) {
        number *new = &n.number[n.count];
        snprintf(new->text, sizeof new->text, "%zu", i + 1);
        if (i >= NUMBERED || !place_number(p, &o, &n, i, width, new)) {
            n.left_out++;
            continue;
        }
        chart_box at = box_of(p, new->text, new->at);
        n.top = fmin(n.top, at.top), n.bottom = fmax(n.bottom, at.bottom);
        n.count++;
    }
    return n;
}

void numbers_draw(const page *p, const element_numbers *n, double down)
{
    chart_font(p->cr, SIZE, false);
    for (size_t i = 0; i < n->count; i++) {
        const number *one = &n->number[i];
        if (!one->led) continue;
        cairo_move_to(p->cr, one->from.x, one->from.y + down);
        cairo_line_to(p->cr, one->to.x, one->to.y + down);
        page_stroke(p, 0.4, 0.6);
    }
    for (size_t i = 0; i < n->count; i++) {
        const number *one = &n->number[i];
        cairo_move_to(p->cr, one->at.x - chart_width(p->cr, one->text) / 2, one->at.y + 0.36 * SIZE + down);
        cairo_text_path(p->cr, one->text);
        cairo_set_source_rgb(p->cr, 1, 1, 1);
        cairo_set_line_width(p->cr, 2.5);
        cairo_stroke_preserve(p->cr);
        cairo_set_source_rgb(p->cr, 0.1, 0.1, 0.1);
        cairo_fill(p->cr);
    }
}

/* picture.c - draws a scene on a page, with cairo.
 *
 * Both directions have the same scale.  The page has a fixed width, and the height that the
 * lens needs.  Drawn from back to front: glass, axis, rays, surfaces, marks of rays that ended.
 * The title is above and the legend with the scale bar below, so no text covers a line.  All
 * sizes are points. */
#include "picture.h"

#include "legend.h"

#include <cairo-svg.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double PICTURE_WIDTH = 900, MARGIN = 34, TOP = 68, PLOT_HIGHEST = 460, PLOT_LOWEST = 110;
static const double THIN = 0.5, SURFACE = 0.9, MIRROR = 1.6;
static const double ARROW_LENGTH = 7, ARROW_WIDTH = 4;
static const double HATCH_STEP = 5, HATCH_LENGTH = 5, STOP_TICK = 13, AXIS_BEYOND = 12, RAY = 0.6,
                    RAY_MANY = 0.3;
enum { MANY_RAYS = 60 };

void picture_check(void) {}

/* ---------------------------------------------------------------- page */

typedef struct page {
    cairo_t *cr;
    double scale, left, middle;   /* x = left + scale z, y = middle - scale y */
    double height, legend_top;
} page;

typedef struct picture_dot { double x, y; } picture_dot;

static picture_dot on_page(const page *p, spot s)
{
    return (picture_dot){p->left + p->scale * s.z, p->middle - p->scale * s.y};
}

static page page_of(const scene *s, double legend_height)
{
    double z = s->high.z - s->low.z, y = s->high.y - s->low.y, room = PICTURE_WIDTH - 2 * MARGIN;
    page p = {.scale = fmin(room / z, PLOT_HIGHEST / y)};
    if (!(p.scale > 0 && isfinite(p.scale))) p.scale = 1;
    double plot = fmax(PLOT_LOWEST, p.scale * y);
    p.left = MARGIN + (room - p.scale * z) / 2 - p.scale * s->low.z;
    p.middle = TOP + plot / 2 + p.scale * (s->low.y + s->high.y) / 2;
    p.legend_top = TOP + plot + MARGIN;
    p.height = p.legend_top + legend_height + MARGIN / 2;
    return p;
}

static void line_to(const page *p, spot s)
{
    picture_dot d = on_page(p, s);
    cairo_line_to(p->cr, d.x, d.y);
}

static void picture_stroke(const page *p, double width, double grey)
{
    cairo_set_source_rgb(p->cr, grey, grey, grey);
    cairo_set_line_width(p->cr, width);
    cairo_stroke(p->cr);
}

/* ------------------------------------------------------------ elements */

static void draw_glass(const page *p, const outline *a, const outline *b)
{
    double half = fmax(a->half, b->half);
    for (int k = 0; k < OUTLINE_POINTS; k++) line_to(p, a->at[k]);
    line_to(p, scene_corner(a, 1, half));
    line_to(p, scene_corner(b, 1, half));
    for (int k = OUTLINE_POINTS - 1; k >= 0; k--) line_to(p, b->at[k]);
    line_to(p, scene_corner(b, 0, half));
    line_to(p, scene_corner(a, 0, half));
    cairo_close_path(p->cr);
    cairo_set_source_rgb(p->cr, 0.89, 0.93, 0.96);
    cairo_fill(p->cr);
}

/* The edge of a glass element, and the flat rings that join it to the faces. */
static void draw_edges(const page *p, const outline *a, const outline *b)
{
    double half = fmax(a->half, b->half);
    for (int side = 0; side < 2; side++) {
        line_to(p, scene_corner(a, side, a->half));
        line_to(p, scene_corner(a, side, half));
        line_to(p, scene_corner(b, side, half));
        line_to(p, scene_corner(b, side, b->half));
        picture_stroke(p, SURFACE, 0.15);
    }
}

static void draw_hatching(const page *p, const outline *o)
{
    double rest = HATCH_STEP / 2;
    for (int k = 1; k < OUTLINE_POINTS; k++) {
        picture_dot a = on_page(p, o->at[k - 1]), b = on_page(p, o->at[k]);
        double length = hypot(b.x - a.x, b.y - a.y), done = rest;
        for (; done < length; done += HATCH_STEP) {
            double u = done / length, along = HATCH_LENGTH / length;
            double x = a.x + u * (b.x - a.x), y = a.y + u * (b.y - a.y);
            cairo_move_to(p->cr, x, y);
            cairo_line_to(p->cr, x + HATCH_LENGTH * o->back * o->ahead.z - along * (b.x - a.x),
                          y - HATCH_LENGTH * o->back * o->ahead.y - along * (b.y - a.y));
        }
        rest = done - length;
    }
    picture_stroke(p, THIN, 0.35);
}

/* Bars from the aperture outward, drawn over the glass if that is wider. */
static void draw_stop(const page *p, const outline *o)
{
    for (int side = 0; side < 2; side++) {
        double sign = side ? 1 : -1;
        picture_dot d = on_page(p, scene_corner(o, side, o->half));
        cairo_move_to(p->cr, d.x, d.y);
        cairo_line_to(p->cr, d.x + sign * STOP_TICK * o->up.z, d.y - sign * STOP_TICK * o->up.y);
        picture_stroke(p, LEGEND_STOP_WIDTH, 0);
    }
}

/* The sign of an ideal lens: arrow heads at its ends, outward if it focuses, else inward. */
static void draw_arrows(const page *p, const outline *o)
{
    for (int side = 0; side < 2; side++) {
        double along = (side ? -1 : 1) * o->lens * ARROW_LENGTH;
        picture_dot tip = on_page(p, scene_corner(o, side, o->half));
        for (int barb = -1; barb <= 1; barb += 2) {
            double across = barb * ARROW_WIDTH;
            cairo_move_to(p->cr, tip.x, tip.y);
            cairo_line_to(p->cr, tip.x + along * o->up.z + across * o->ahead.z,
                          tip.y - along * o->up.y - across * o->ahead.y);
        }
    }
    picture_stroke(p, SURFACE, 0.15);
}

static void draw_surfaces(const page *p, const scene *s)
{
    static const double dashes[] = {3, 3};
    for (size_t i = 0; i < s->job->lens.count; i++) {
        const outline *o = &s->outline[i];
        for (size_t k = 0; k < o->strokes; k++) {
            line_to(p, o->stroke[k][0]);
            line_to(p, o->stroke[k][1]);
            picture_stroke(p, o->mirror ? MIRROR : SURFACE, 0.15);
        }
        if (o->half == 0) continue;
        if (scene_glass_behind(s, i)) draw_edges(p, o, &s->outline[i + 1]);
        if (o->mirror) draw_hatching(p, o);
        if (o->lens != 0) draw_arrows(p, o);
        if (o->stop) {
            draw_stop(p, o);
            if (o->dummy) continue; /* a hole, and no surface */
        }
        for (int k = 0; k < OUTLINE_POINTS; k++) line_to(p, o->at[k]);
        if (o->dummy) cairo_set_dash(p->cr, dashes, 2, 0);
        picture_stroke(p, o->dummy ? THIN : o->mirror ? MIRROR : SURFACE, o->dummy ? 0.5 : 0.15);
        cairo_set_dash(p->cr, NULL, 0, 0);
    }
}

/* What the apertures of an element clip in this plane. */
static void draw_blocked(const page *p, const scene *s)
{
    for (size_t i = 0; i < s->job->lens.count; i++) {
        const outline *o = &s->outline[i];
        for (size_t k = 0; k < o->blocked_count; k++) {
            line_to(p, o->blocked[k][0]);
            line_to(p, o->blocked[k][1]);
            picture_stroke(p, LEGEND_STOP_WIDTH, 0);
        }
    }
}

static void draw_axis(const page *p, const scene *s)
{
    static const double dashes[] = {12, 3, 2, 3};
    for (size_t i = 0; i < s->job->lens.count; i++)
        if (s->job->lens.surface[i].off_axis || s->job->lens.surface[i].folded)
            return; /* a folded system has no one axis */
    cairo_set_dash(p->cr, dashes, 4, 0);
    line_to(p, (spot){s->low.z - AXIS_BEYOND / p->scale, 0});
    line_to(p, (spot){s->high.z + AXIS_BEYOND / p->scale, 0});
    picture_stroke(p, THIN, 0.6);
    cairo_set_dash(p->cr, NULL, 0, 0);
}

/* ---------------------------------------------------------------- rays */

static void draw_rays(const page *p, const scene *s)
{
    size_t fields = s->job->fields ? s->job->fields : 1;
    for (size_t i = 0; i < s->paths; i++) {
        const path *r = &s->path[i];
        for (size_t k = 0; k < r->count; k++) line_to(p, r->at[k]);
        legend_colour(p->cr, r->field);
        cairo_set_line_width(p->cr, s->paths / fields > MANY_RAYS ? RAY_MANY : RAY);
        cairo_stroke(p->cr);
    }
}

static void draw_marks(const page *p, const scene *s)
{
    for (size_t i = 0; i < s->paths; i++) {
        const path *r = &s->path[i];
        if (r->fate == SGT_PASSED) continue;
        picture_dot d = on_page(p, r->at[r->count - 1]);
        legend_colour(p->cr, r->field);
        legend_mark(p->cr, r->fate, d.x, d.y);
    }
}

/* ---------------------------------------------------------------- text */

static void draw_title(const page *p, const job *j)
{
    const lens *l = &j->lens;
    char text[200] = "y-z section";
    size_t length = 0;
    for (size_t i = 0; i < j->wavelengths && !isnan(l->wavelength) && length < sizeof text; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s%g", i ? ", " : "",
                                   j->at[i].lens.wavelength);
    if (length && length < sizeof text)
        snprintf(text + length, sizeof text - length, " \302\265m, y-z section");
    const char *file = strrchr(l->of->file, '/'), *title = *l->name ? l->name : file ? file + 1 : l->of->file;
    cairo_set_source_rgb(p->cr, 0, 0, 0);
    cairo_select_font_face(p->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    cairo_set_font_size(p->cr, 15);
    cairo_move_to(p->cr, MARGIN, 26);
    cairo_show_text(p->cr, title);
    cairo_select_font_face(p->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(p->cr, LEGEND_FONT);
    cairo_set_source_rgb(p->cr, 0.35, 0.35, 0.35);
    cairo_move_to(p->cr, MARGIN, 42);
    cairo_show_text(p->cr, text);
}

static double measured_legend(const scene *s)
{
    cairo_surface_t *nowhere = cairo_recording_surface_create(CAIRO_CONTENT_COLOR, NULL);
    cairo_t *cr = cairo_create(nowhere);
    double height = legend_draw(cr, s, MARGIN, PICTURE_WIDTH - MARGIN, 0, 1);
    cairo_destroy(cr);
    cairo_surface_destroy(nowhere);
    return height;
}

void picture_write(const char *file, const scene *s)
{
    page p = page_of(s, measured_legend(s));
    cairo_surface_t *surface = cairo_svg_surface_create(file, PICTURE_WIDTH, p.height);
    p.cr = cairo_create(surface);
    cairo_set_line_cap(p.cr, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(p.cr, CAIRO_LINE_JOIN_ROUND);
    cairo_set_source_rgb(p.cr, 1, 1, 1);
    cairo_paint(p.cr);
    for (size_t i = 0; i < s->job->lens.count; i++)
        if (scene_glass_behind(s, i)) draw_glass(&p, &s->outline[i], &s->outline[i + 1]);
    draw_axis(&p, s);
    draw_rays(&p, s);
    draw_surfaces(&p, s);
    draw_blocked(&p, s);
    draw_marks(&p, s);
    draw_title(&p, s->job);
    legend_draw(p.cr, s, MARGIN, PICTURE_WIDTH - MARGIN, p.legend_top, p.scale);
    cairo_destroy(p.cr);
    cairo_surface_finish(surface);
    cairo_status_t status = cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    if (status != CAIRO_STATUS_SUCCESS) fail_input("%s: %s", file, cairo_status_to_string(status));
}

// SPDX-License-Identifier: MIT
/* picture.c - draws a scene on a page, with cairo.
 *
 * Both directions have the same scale.  The page has a fixed width, and the height that the lens needs.  From
 * top to bottom: the title, the plot with its rulers, the legend; so no text covers a line.  In the plot,
 * from back to front: glass, axis, rays, surfaces, marks of rays that ended, numbers of elements.  The
 * numbers may need room above and below the lens: they are placed first, and the lens is moved down by it.
 *
 * All sizes are points.  A png has two pixels a point. */
#include "picture.h"

#include "../base/memory.h"
#include "../read/surface.h"
#include "chart_draw.h"
#include "elements.h"
#include "legend.h"
#include "numbers.h"
#include "ruler.h"
#include "sheet.h"

#include <math.h>
#include <string.h>

static const double PICTURE_WIDTH = 900, MARGIN = 24, TOP = 78, INSIDE = 14, PLOT_HIGHEST = 460,
                    PLOT_LOWEST = 110;
static const double TITLE_FONT = 15, LINE_FONT = 10.5, AXIS_BEYOND = 12, CORNER = 80, RAY = 0.6,
                    RAY_MANY = 0.3;
/* of a beam: more rays are thinner; still more let shine through what is behind */
static const double MANY_RAYS = 60, FULL_RAYS = 150, FAINTEST = 0.12;

/* --------------------------------------------------------------------- page */

typedef struct layout {
    page page;
    element_numbers numbers;
    double down;           /* by how much the numbers move the lens down */
    frame_box plot;        /* with the numbers */
    const char *missing;   /* what is not shown, in words; may be empty */
    double legend, height; /* the top of the legend; of the page */
} layout;

/* Sets the scale, and puts the lens in the middle of a plot that begins at left; returns where it ends below.
 */
static double lay_scale(page *p, double left)
{
    const scene *s = p->scene;
    double wide = s->most.right - s->least.right, high = s->most.up - s->least.up, plot = PLOT_LOWEST;
    double room = PICTURE_WIDTH - MARGIN - left - 2 * INSIDE;
    p->scale = fmin(room / wide, PLOT_HIGHEST / high);
    p->left = left + INSIDE + room / 2, p->base = TOP + INSIDE + plot / 2;
    if (!(p->scale > 0 && isfinite(p->scale))) p->scale = 1;
    if (wide >= 0 && high >= 0) { /* else there is nothing to draw */
        plot = fmax(PLOT_LOWEST, p->scale * high);
        p->left -= p->scale * (s->least.right + s->most.right) / 2;
        p->base = TOP + INSIDE + plot / 2 + p->scale * (s->least.up + s->most.up) / 2;
    }
    return TOP + plot + 2 * INSIDE;
}

/* "level set, not drawn: element 2; 3 elements without a number", or "". */
static const char *missing_from(const scene *s, size_t left_out)
{
    const char *sets = "";
    for (size_t i = 0; i < s->job->lens.count; i++)
        if (surface_is_level_set(s->job->element[i].surface))
            sets = memory_print("%s%s%zu", sets, *sets ? ", " : "level set, not drawn: element ", i + 1);
    return left_out ? memory_print("%s%s%zu element%s without a number", sets, *sets ? "; " : "", left_out,
                                   left_out == 1 ? "" : "s")
                    : sets;
}

/* Finds the layout by a page that is drawn nowhere.  The ruler's width depends on its numbers, and they on
 * the scale, that depends on the width; one more round is enough, as the ruler only gets narrower. */
static layout lay_out(const scene *s)
{
    layout l = {.page = {.cr = sheet_nowhere(), .scene = s},
                .plot = {MARGIN, TOP, PICTURE_WIDTH - MARGIN, 0}};
    page *p = &l.page;
    bool space = s->view.plane == VIEW_3D;
    l.plot.bottom = lay_scale(p, l.plot.left);
    if (!space) l.plot.left = MARGIN + ruler_width(p, &l.plot);
    l.plot.bottom = lay_scale(p, l.plot.left);
    l.numbers = numbers_of(p, PICTURE_WIDTH);
    l.down = fmax(0, TOP + INSIDE / 2 - l.numbers.top);
    l.plot.bottom = l.down + fmax(l.plot.bottom, l.numbers.bottom + INSIDE / 2);
    l.legend = l.plot.bottom + (space ? 0 : RULER_HEIGHT) + INSIDE / 2;
    l.missing = missing_from(s, l.numbers.left_out);
    l.height = l.legend + MARGIN / 2 +
               legend_draw(p->cr, s, l.missing, MARGIN, PICTURE_WIDTH - MARGIN, 0, space ? p->scale : 0);
    p->base += l.down;
    sheet_forget(p->cr);
    return l;
}

static void draw_axis(const page *p)
{
    static const double dashes[] = {12, 3, 2, 3};
    const scene *s = p->scene;
    if (!scene_straight(s)) return; /* a folded system has no one axis */
    double more = AXIS_BEYOND / p->scale;
    double low = s->view.plane == VIEW_3D ? s->low.z : s->least.right;
    double high = s->view.plane == VIEW_3D ? s->high.z : s->most.right;
    const sgt_vec3 axis[] = {{0, 0, low - more}, {0, 0, high + more}};
    cairo_set_dash(p->cr, dashes, 4, 0);
    page_line(p, axis, 2);
    page_stroke(p, PAGE_THIN, 0.6);
    cairo_set_dash(p->cr, NULL, 0, 0);
}

/* --------------------------------------------------------------------- rays */

static void draw_rays(const page *p)
{
    const scene *s = p->scene;
    size_t beams = s->by_wavelength ? s->job->wavelengths : s->job->fields ? s->job->fields : 1;
    double rays = (double)s->paths / (double)beams;
    for (size_t i = 0; i < s->paths; i++) {
        const ray_path *r = &s->path[i];
        page_line(p, r->at, r->count);
        legend_ray(p->cr, s, r, fmax(FAINTEST, fmin(1, FULL_RAYS / rays)));
        cairo_set_line_width(p->cr, rays > MANY_RAYS ? RAY_MANY : RAY);
        cairo_stroke(p->cr);
        cairo_set_dash(p->cr, NULL, 0, 0);
    }
}

/* The lens in its other configurations, behind it: lines only. */
static void draw_others(const page *p)
{
    for (size_t i = 0; i < p->scene->other_count; i++) {
        page pale = *p;
        pale.scene = &p->scene->others[i], pale.pale = true;
        for (size_t k = 0; k < pale.scene->paths; k++) {
            page_line(&pale, pale.scene->path[k].at, pale.scene->path[k].count);
            page_stroke(&pale, RAY_MANY, 0);
        }
        elements_stroke(&pale);
    }
}

static void draw_marks(const page *p)
{
    const scene *s = p->scene;
    for (size_t i = 0; i < s->paths; i++) {
        const ray_path *r = &s->path[i];
        if (r->fate == SGT_PASSED) continue;
        page_dot d = page_at(p, r->at[r->count - 1]);
        if (!isfinite(d.x + d.y)) continue;
        legend_ray(p->cr, s, r, 1);
        cairo_set_dash(p->cr, NULL, 0, 0);
        legend_mark(p->cr, r->fate, d.x, d.y);
    }
}

/* -------------------------------------------------------------------- title */

/* "y-z section; 0.4861, 0.5876 um; 20 of 21 rays passed" */
static const char *facts_of(const scene *s)
{
    const job *j = s->job;
    size_t passed = 0;
    const char *text = view_title(s->view.plane);
    for (size_t i = 0; i < s->paths; i++) passed += s->path[i].fate == SGT_PASSED;
    for (size_t i = 0; i < j->wavelengths && !isnan(j->lens.wavelength); i++)
        text = memory_print("%s%s%g", text, i ? ", " : "; ", j->at[i].lens.wavelength);
    return memory_print("%s%s; %s", text, isnan(j->lens.wavelength) ? "" : " \302\265m",
                        s->paths ? memory_print("%zu of %zu ray%s passed", passed, s->paths,
                                                s->paths == 1 ? "" : "s")
                                 : "no rays");
}

/* "fields: object height 0, 3, 5 mm" */
static const char *fields_of(const job *j)
{
    static const char *const kinds[] = {
        [SGT_FIELD_ANGLE] = "angle", [SGT_FIELD_OBJECT_HEIGHT] = "object height",
        [SGT_FIELD_PARAXIAL_IMAGE_HEIGHT] = "paraxial image height",
        [SGT_FIELD_REAL_IMAGE_HEIGHT] = "real image height",
    };
    const bool angle = j->field_kind == SGT_FIELD_ANGLE;
    if (!j->fields) return "rays of a file";
    const char *text = memory_print("field%s: %s", j->fields == 1 ? "" : "s", kinds[j->field_kind]);
    for (size_t i = 0; i < j->fields; i++) {
        const sgt_lens_field at = j->field[i];
        text = memory_print("%s%s%s", text, i ? ", " : " ",
                            at.x != 0 ? memory_print("(%g, %g)", at.x, at.y) : memory_print("%g", at.y));
    }
    return memory_print("%s%s%.20s", text, angle ? "\302\260" : " ", angle ? "" : j->lens.units);
}

static void draw_title(cairo_t *cr, const scene *s)
{
    const lens *l = &s->job->lens;
    const char *file = strrchr(l->of->file, '/'), *title = *l->name ? l->name : file ? file + 1 : l->of->file;
    const double room = PICTURE_WIDTH - 2 * MARGIN - (s->view.plane == VIEW_3D ? CORNER + MARGIN : 0);
    chart_font(cr, TITLE_FONT, true);
    chart_grey(cr, 0);
    chart_text(cr, MARGIN, MARGIN + TITLE_FONT - 3, 0, room, title);
    chart_font(cr, LINE_FONT, false);
    chart_grey(cr, 0.35);
    chart_text(cr, MARGIN, MARGIN + TITLE_FONT + LINE_FONT + 2, 0, room, facts_of(s));
    const char *fields = fields_of(s->job);
    if (s->configurations) fields = memory_print("%s; %s", fields, s->configurations);
    chart_text(cr, MARGIN, MARGIN + TITLE_FONT + LINE_FONT * (1 + CHART_LINE) + 2, 0, room, fields);
}

/* --------------------------------------------------------------------- file */

static void draw_page(cairo_t *cr, const void *what)
{
    const layout *l = what;
    page p = l->page;
    p.cr = cr;
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    bool space = p.scene->view.plane == VIEW_3D;
    if (!space) ruler_draw(&p, &l->plot);
    draw_others(&p);
    elements_fill(&p);
    draw_axis(&p);
    draw_rays(&p);
    elements_stroke(&p);
    draw_marks(&p);
    numbers_draw(&p, &l->numbers, l->down);
    if (space) ruler_directions(&p, (page_dot){PICTURE_WIDTH - MARGIN - CORNER / 2, MARGIN + CORNER / 2});
    draw_title(cr, p.scene);
    legend_draw(cr, p.scene, l->missing, MARGIN, PICTURE_WIDTH - MARGIN, l->legend, space ? p.scale : 0);
}

void picture_write(const char *file, picture_kind kind, const scene *s)
{
    layout l = lay_out(s);
    sheet_write(file, kind, PICTURE_WIDTH, l.height, draw_page, &l);
}

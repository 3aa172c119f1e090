/* picture.c - draws a scene on a page, with cairo.
 *
 * Both directions have the same scale.  The page has a fixed width, and the height that the lens needs.  From
 * top to bottom: the title, the plot with its rulers, the legend; so no text covers a line.  In the plot,
 * from back to front: glass, axis, rays, surfaces, marks of rays that ended, numbers of elements.  The
 * numbers may need room above and below the lens: they are placed first, and the lens is moved down by it.
 *
 * All sizes are points.  A png has two pixels a point. */
#include "picture.h"

#include "elements.h"
#include "legend.h"
#include "numbers.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const double PICTURE_WIDTH = 900, LEFT = 34, MARGIN = 34, TOP = 76, PLOT_HIGHEST = 460,
                    PLOT_LOWEST = 110;
static const double AXIS_BEYOND = 12, RAY = 0.6, RAY_MANY = 0.3, PNG_PIXELS = 2;
enum { MANY_RAYS = 60 };

void picture_check(const char *option) { (void)option; }

picture_format picture_format_of(const char *option, const char *path)
{
    static const char *const endings[] = {
        [PICTURE_SVG] = ".svg", [PICTURE_PNG] = ".png", [PICTURE_PDF] = ".pdf"};
    size_t length = strlen(path);
    for (int k = PICTURE_SVG; k <= PICTURE_PDF; k++)
        if (length > 4 && strcmp(path + length - 4, endings[k]) == 0) return (picture_format)k;
    fail_usage("--%s %s: the name must end in .svg, .png or .pdf", option, path);
}

/* --------------------------------------------------------------------- page */

/* Where things are on the page.  The plot is the box of what is drawn of the lens, without its numbers. */
typedef struct layout {
    page page;
    element_numbers numbers;
    double down;           /* by how much the numbers move the lens down */
    double bottom, height; /* of the plot with its numbers; of the page */
} layout;

static void lay_scale(page *p, const scene *s, double *plot)
{
    double wide = s->most.right - s->least.right, high = s->most.up - s->least.up;
    double room = PICTURE_WIDTH - LEFT - MARGIN;
    *p = (page){.cr = p->cr, .scene = s, .scale = fmin(room / wide, PLOT_HIGHEST / high)};
    *plot = PLOT_LOWEST;
    p->left = LEFT + room / 2, p->base = TOP + *plot / 2;
    if (!(p->scale > 0 && isfinite(p->scale))) p->scale = 1;
    if (!(wide >= 0 && high >= 0)) return; /* nothing to draw */
    *plot = fmax(PLOT_LOWEST, p->scale * high);
    p->left -= p->scale * (s->least.right + s->most.right) / 2;
    p->base = TOP + *plot / 2 + p->scale * (s->least.up + s->most.up) / 2;
}

/* Finds the layout by a page that is drawn nowhere. */
static layout lay_out(const scene *s)
{
    cairo_surface_t *nowhere = cairo_recording_surface_create(CAIRO_CONTENT_COLOR, NULL);
    layout l = {.page = {.cr = cairo_create(nowhere)}};
    double plot;
    lay_scale(&l.page, s, &plot);
    l.numbers = numbers_of(&l.page, PICTURE_WIDTH);
    l.down = fmax(0, TOP - l.numbers.top);
    l.bottom = l.down + fmax(TOP + plot, l.numbers.bottom);
    l.height = l.bottom + MARGIN + MARGIN / 2 +
               legend_draw(l.page.cr, s, MARGIN, PICTURE_WIDTH - MARGIN, 0, l.page.scale);
    l.page.base += l.down;
    cairo_destroy(l.page.cr);
    cairo_surface_destroy(nowhere);
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
    size_t fields = s->job->fields ? s->job->fields : 1;
    for (size_t i = 0; i < s->paths; i++) {
        const ray_path *r = &s->path[i];
        page_line(p, r->at, r->count);
        legend_ray(p->cr, s, r);
        cairo_set_line_width(p->cr, s->paths / fields > MANY_RAYS ? RAY_MANY : RAY);
        cairo_stroke(p->cr);
        cairo_set_dash(p->cr, NULL, 0, 0);
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
        legend_ray(p->cr, s, r);
        cairo_set_dash(p->cr, NULL, 0, 0);
        legend_mark(p->cr, r->fate, d.x, d.y);
    }
}

/* -------------------------------------------------------------------- title */

/* Adds to a text as far as there is room. */
static void add_words(char *text, size_t size, const char *format, ...) LIKE_PRINTF(3, 4);
static void add_words(char *text, size_t size, const char *format, ...)
{
    size_t length = strlen(text);
    va_list values;
    va_start(values, format);
    vsnprintf(text + length, size - length, format, values);
    va_end(values);
}

/* "y-z section; 0.4861, 0.5876 um; 20 of 21 rays passed" */
static void print_facts(char *text, size_t size, const scene *s)
{
    const job *j = s->job;
    size_t passed = 0;
    for (size_t i = 0; i < s->paths; i++) passed += s->path[i].fate == SGT_PASSED;
    snprintf(text, size, "%s", view_title(s->view.plane));
    for (size_t i = 0; i < j->wavelengths && !isnan(j->lens.wavelength); i++)
        add_words(text, size, "%s%g", i ? ", " : "; ", j->at[i].lens.wavelength);
    if (!isnan(j->lens.wavelength)) add_words(text, size, " \302\265m");
    if (s->paths)
        add_words(text, size, "; %zu of %zu ray%s passed", passed, s->paths, s->paths == 1 ? "" : "s");
    else
        add_words(text, size, "; no rays");
}

/* "fields: object height 0, 3, 5 mm" */
static void print_fields(char *text, size_t size, const job *j)
{
    static const char *const kinds[] = {
        [SGT_FIELD_ANGLE] = "angle",
        [SGT_FIELD_OBJECT_HEIGHT] = "object height",
        [SGT_FIELD_PARAXIAL_IMAGE_HEIGHT] = "paraxial image height",
        [SGT_FIELD_REAL_IMAGE_HEIGHT] = "real image height",
    };
    bool angle = j->field_kind == SGT_FIELD_ANGLE;
    snprintf(text, size, j->fields ? "field%s: %s" : "rays of a file", j->fields == 1 ? "" : "s",
             kinds[j->field_kind]);
    for (size_t i = 0; i < j->fields; i++) {
        add_words(text, size, i ? ", " : " ");
        if (j->field[i].x != 0)
            add_words(text, size, "(%g, %g)", j->field[i].x, j->field[i].y);
        else
            add_words(text, size, "%g", j->field[i].y);
    }
    if (j->fields) add_words(text, size, "%s%.20s", angle ? "\302\260" : " ", angle ? "" : j->lens.units);
}

static void draw_title(cairo_t *cr, const scene *s)
{
    const lens *l = &s->job->lens;
    const char *file = strrchr(l->of->file, '/'), *title = *l->name ? l->name : file ? file + 1 : l->of->file;
    const double room = PICTURE_WIDTH - 2 * MARGIN;
    char text[600];
    cairo_set_source_rgb(cr, 0, 0, 0);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    cairo_set_font_size(cr, 15);
    page_text(cr, MARGIN, 26, room, title);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, LEGEND_FONT);
    cairo_set_source_rgb(cr, 0.35, 0.35, 0.35);
    print_facts(text, sizeof text, s);
    page_text(cr, MARGIN, 42, room, text);
    print_fields(text, sizeof text, s->job);
    page_text(cr, MARGIN, 57, room, text);
}

/* --------------------------------------------------------------------- file */

static cairo_surface_t *surface_for(const char *file, picture_format format, double height)
{
    if (format == PICTURE_SVG) return cairo_svg_surface_create(file, PICTURE_WIDTH, height);
    if (format == PICTURE_PNG)
        return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(PNG_PIXELS * PICTURE_WIDTH),
                                          (int)ceil(PNG_PIXELS * height));
    cairo_surface_t *pdf = cairo_pdf_surface_create(file, PICTURE_WIDTH, height);
    /* else cairo writes the time of day, and two files of one picture differ */
    cairo_pdf_surface_set_metadata(pdf, CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
    return pdf;
}

void picture_write(const char *file, picture_format format, const scene *s)
{
    layout l = lay_out(s);
    page *p = &l.page;
    cairo_surface_t *surface = surface_for(file, format, l.height);
    p->cr = cairo_create(surface);
    if (format == PICTURE_PNG) cairo_scale(p->cr, PNG_PIXELS, PNG_PIXELS);
    cairo_set_line_cap(p->cr, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(p->cr, CAIRO_LINE_JOIN_ROUND);
    cairo_set_source_rgb(p->cr, 1, 1, 1);
    cairo_paint(p->cr);
    elements_fill(p);
    draw_axis(p);
    draw_rays(p);
    elements_stroke(p);
    draw_marks(p);
    numbers_draw(p, &l.numbers, l.down);
    draw_title(p->cr, s);
    legend_draw(p->cr, s, MARGIN, PICTURE_WIDTH - MARGIN, l.bottom + MARGIN, p->scale);
    cairo_status_t status = cairo_status(p->cr);
    cairo_destroy(p->cr);
    if (format == PICTURE_PNG && status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_write_to_png(surface, file);
    cairo_surface_finish(surface);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    if (status != CAIRO_STATUS_SUCCESS) fail_input("%s: %s", file, cairo_status_to_string(status));
}

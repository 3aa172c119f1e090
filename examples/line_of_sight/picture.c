// SPDX-License-Identifier: MIT
/* picture.c - the page: to the left the swath on a map, to the right the camera's own image, painted with
 * what each ray cost.
 *
 * On the map four pixels that are neighbours are the corners of a patch, of the colour of their mean;
 * pixels of a scan that is too coarse for that are dots. */
#include "picture.h"

#include "colours.h"
#include "fail.h"
#include "geodetic.h"
#include "map.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double WIDTH = 1060, HEIGHT = 604, TOP = 86, PLOT = 420, LEGEND = TOP + PLOT + 46;
static const double MAP_LEFT = 62, MAP_WIDTH = 480, IMAGE_LEFT = 610, IMAGE_WIDTH = 420;
enum { COARSE = 24, CLASSES = 6, TRACK_POINTS = 200 };

bool picture_can(void) { return true; }

/* ------------------------------------------------------------------- map */

typedef struct range { double lo, hi; } range;

static range range_of(size_t n, const double x[])
{
    range r = {HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < n; i++) r.lo = fmin(r.lo, x[i]), r.hi = fmax(r.hi, x[i]); /* a NaN is passed by */
    return r;
}

static double place_in(range r, double x) { return r.hi > r.lo ? (x - r.lo) / (r.hi - r.lo) : 0; }

static void draw_patches(cairo_t *cr, const map *m, const scan *s, const double value[], range r)
{
    int stride = 1 + s->camera.pixels / 1001, skip = 1 + s->camera.lines / 1001; /* no finer than the page */
    cairo_set_antialias(cr, CAIRO_ANTIALIAS_NONE);
    for (int line = 0; line + skip < s->camera.lines; line += skip)
        for (int pixel = 0; pixel + stride < s->camera.pixels; pixel += stride) {
            const size_t corner[4] = {scan_index(s, line, pixel), scan_index(s, line, pixel + stride),
                                      scan_index(s, line + skip, pixel + stride),
                                      scan_index(s, line + skip, pixel)};
            double sum = 0;
            bool there = true;
            for (int k = 0; k < 4; k++) {
                spot at;
                sum += value[corner[k]];
                there = there && !isnan(value[corner[k]]) &&
                        map_spot(m, s->latitude[corner[k]], s->longitude[corner[k]], &at);
                if (there) (k ? cairo_line_to : cairo_move_to)(cr, at.x, at.y);
            }
            if (!there) {
                cairo_new_path(cr);
                continue;
            }
            colours_set(cr, colours_viridis(place_in(r, sum / 4)));
            cairo_fill(cr);
        }
    cairo_set_antialias(cr, CAIRO_ANTIALIAS_DEFAULT);
}

static void draw_dots(cairo_t *cr, const map *m, const scan *s, const double value[], range r)
{
    for (size_t i = 0; i < s->rays; i++) {
        spot at;
        if (isnan(value[i]) || !map_spot(m, s->latitude[i], s->longitude[i], &at)) continue;
        colours_set(cr, colours_viridis(place_in(r, value[i])));
        cairo_arc(cr, at.x, at.y, 2, 0, 6.2831853);
        cairo_fill(cr);
    }
}

/* An arrow that ends where the last line was taken. */
static void draw_track(cairo_t *cr, size_t n, const double latitude[], const double longitude[], const map *m)
{
    spot at, before = {0}, first = {0};
    bool near = false;
    for (size_t i = 0; i < n; i++) {
        bool is = map_spot(m, latitude[i], longitude[i], &at);
        if (is) (near ? cairo_line_to : cairo_move_to)(cr, at.x, at.y);
        if (i == 0) first = at;
        if (i + 1 < n) before = at;
        near = is;
    }
    colours_set(cr, TRACK);
    cairo_set_line_width(cr, 2);
    cairo_stroke(cr);
    double length = hypot(at.x - before.x, at.y - before.y);
    if (hypot(at.x - first.x, at.y - first.y) < 8) {
        cairo_arc(cr, at.x, at.y, 3, 0, 6.2831853);
    } else {
        double x = (at.x - before.x) / length, y = (at.y - before.y) / length;
        cairo_move_to(cr, at.x + 6 * x, at.y + 6 * y);
        cairo_line_to(cr, at.x - 6 * x - 5 * y, at.y - 6 * y + 5 * x);
        cairo_line_to(cr, at.x - 6 * x + 5 * y, at.y - 6 * y - 5 * x);
    }
    cairo_fill(cr);
}

static void draw_map(cairo_t *cr, const scan *s, bool by_height)
{
    const double *value = by_height ? s->height : s->incidence;
    size_t n = s->rays + TRACK_POINTS;
    /* what is to be on the map: points, and the track */
    double *latitude = malloc(2 * n * sizeof *latitude), *longitude = latitude + n;
    if (!latitude) fail_input("out of memory for the picture");
    for (size_t i = 0; i < s->rays; i++) latitude[i] = s->latitude[i], longitude[i] = s->longitude[i];
    for (int i = 0; i < TRACK_POINTS; i++) {
        geodetic g = geodetic_of(
            camera_station(&s->camera, s->camera.line_time * (s->camera.lines - 1) * i / (TRACK_POINTS - 1))
                .place);
        latitude[s->rays + (size_t)i] = g.latitude, longitude[s->rays + (size_t)i] = g.longitude;
    }
    map m = {.left = MAP_LEFT, .top = TOP, .width = MAP_WIDTH, .height = PLOT};
    map_fit(&m, n, latitude, longitude);
    range r = range_of(s->rays, value);
    cairo_save(cr);
    cairo_rectangle(cr, m.left, m.top, m.width, m.height);
    cairo_clip(cr);
    if (s->camera.lines < COARSE || s->camera.pixels < COARSE) draw_dots(cr, &m, s, value, r);
    else draw_patches(cr, &m, s, value, r);
    cairo_restore(cr);
    map_graticule(&m, cr);
    cairo_save(cr);
    cairo_rectangle(cr, m.left, m.top, m.width, m.height);
    cairo_clip(cr);
    draw_track(cr, TRACK_POINTS, latitude + s->rays, longitude + s->rays, &m);
    cairo_restore(cr);
    map_scale_bar(&m, cr);
    free(latitude);
}

static void draw_map_legend(cairo_t *cr, const scan *s, bool by_height)
{
    char words[80];
    range r = range_of(s->rays, by_height ? s->height : s->incidence);
    double left = MAP_LEFT, wide = 230;
    if (s->met) {
        for (double x = 0; x < wide; x++)
            colours_box(cr, left + x, LEGEND, 1, 12, colours_viridis(x / (wide - 1)));
        const char *unit = by_height ? " m" : "\302\260";
        int places = by_height           ? (r.hi - r.lo > 20    ? 0
                                            : r.hi - r.lo > 0.2 ? 2
                                                                : 9)
                     : r.hi - r.lo > 0.2 ? 1
                                         : 4;
        colours_set(cr, INK);
        snprintf(words, sizeof words, "%.*f%s", places, r.lo, unit);
        colours_text(cr, left, LEGEND + 27, 0, words);
        snprintf(words, sizeof words, "%.*f%s", places, r.hi, unit);
        colours_text(cr, left + wide, LEGEND + 27, 1, words);
        if (places < 4) {
            snprintf(words, sizeof words, "%.*f%s", places, (r.lo + r.hi) / 2, unit);
            colours_text(cr, left + wide / 2, LEGEND + 27, 0.5, words);
        }
        colours_text(cr, left + wide + 12, LEGEND + 11, 0,
                     by_height ? "height over WGS84" : "angle of incidence");
    }
    colours_box(cr, left + wide + 12, LEGEND + 21, 22, 2, TRACK);
    colours_set(cr, INK);
    colours_text(cr, left + wide + 40, LEGEND + 27, 0, "below the camera");
}

/* ----------------------------------------------------------------- image */

/* Of the rays that met the Earth: classes 0 ... CLASSES - 2 are so many evaluations more than the least,
 * the last class: more still. */
typedef struct costs { int least, most; size_t count[CLASSES]; } costs;

static int class_of(const costs *c, int evals)
{
    return evals - c->least < CLASSES - 1 ? evals - c->least : CLASSES - 1;
}

static unsigned class_colour(int class) { return colours_viridis((class + 0.5) / CLASSES); }

static costs costs_of(const scan *s)
{
    costs c = {.least = 1 << 30, .most = 0};
    for (size_t i = 0; i < s->rays; i++) {
        if (s->status[i] <= 0) continue;
        if (s->evals[i] < c.least) c.least = s->evals[i];
        if (s->evals[i] > c.most) c.most = s->evals[i];
    }
    for (size_t i = 0; i < s->rays; i++)
        if (s->status[i] > 0) c.count[class_of(&c, s->evals[i])]++;
    return c;
}

/* Time runs upward, as the camera flies; the left of the track is left. */
static void draw_image(cairo_t *cr, const scan *s, const costs *c)
{
    int wide = s->camera.pixels < 840 ? s->camera.pixels : 840,
        high = s->camera.lines < 840 ? s->camera.lines : 840;
    cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, wide, high);
    if (cairo_surface_status(image) != CAIRO_STATUS_SUCCESS) fail_input("out of memory for the picture");
    for (int y = 0; y < high; y++) {
        uint32_t *row = (uint32_t *)(void *)(cairo_image_surface_get_data(image) +
                                             (ptrdiff_t)y * cairo_image_surface_get_stride(image));
        for (int x = 0; x < wide; x++) {
            int line = (int)((long long)(high - 1 - y) * s->camera.lines / high),
                pixel = (int)((long long)x * s->camera.pixels / wide);
            size_t i = scan_index(s, line, pixel);
            row[x] = s->status[i] > 0   ? class_colour(class_of(c, s->evals[i]))
                     : s->status[i] < 0 ? (unsigned)UNDECIDED
                                        : (unsigned)MISSED;
        }
    }
    cairo_surface_mark_dirty(image);
    cairo_save(cr);
    cairo_translate(cr, IMAGE_LEFT, TOP);
    cairo_scale(cr, IMAGE_WIDTH / wide, PLOT / high);
    cairo_set_source_surface(cr, image, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cr), CAIRO_FILTER_NEAREST);
    cairo_paint(cr);
    cairo_restore(cr);
    cairo_surface_destroy(image);
    cairo_rectangle(cr, IMAGE_LEFT - 0.5, TOP - 0.5, IMAGE_WIDTH + 1, PLOT + 1);
    colours_set(cr, INK);
    cairo_set_line_width(cr, 1);
    cairo_stroke(cr);
}

static void draw_image_axes(cairo_t *cr, const scan *s)
{
    char words[40];
    double bottom = TOP + PLOT;
    colours_set(cr, INK);
    colours_text(cr, IMAGE_LEFT, bottom + 17, 0, "pixel 0");
    colours_text(cr, IMAGE_LEFT + IMAGE_WIDTH / 2, bottom + 17, 0.5,
                 "left   \342\200\224   across the track   \342\200\224   right");
    snprintf(words, sizeof words, "%d", s->camera.pixels - 1);
    if (s->camera.pixels > 1) colours_text(cr, IMAGE_LEFT + IMAGE_WIDTH, bottom + 17, 1, words);
    colours_text(cr, IMAGE_LEFT - 7, bottom, 1, "line 0");
    snprintf(words, sizeof words, "%d", s->camera.lines - 1);
    if (s->camera.lines > 1) colours_text(cr, IMAGE_LEFT - 7, TOP + 10, 1, words);
}

/* A box and its words, on the next line if there is no room on this. */
static void draw_entry(cairo_t *cr, spot *at, unsigned code, const char *words)
{
    cairo_text_extents_t size;
    cairo_text_extents(cr, words, &size);
    if (at->x > IMAGE_LEFT && at->x + 18 + size.x_advance > IMAGE_LEFT + IMAGE_WIDTH)
        *at = (spot){IMAGE_LEFT, at->y + 18};
    colours_box(cr, at->x, at->y, 12, 12, code);
    colours_set(cr, INK);
    at->x += 18 + colours_text(cr, at->x + 18, at->y + 10, 0, words) + 16;
}

static void draw_image_legend(cairo_t *cr, const scan *s, const costs *c)
{
    char words[80];
    spot at = {IMAGE_LEFT, LEGEND};
    for (int class = 0; class < CLASSES; class++) {
        if (!c->count[class]) continue;
        double share = 100.0 * (double)c->count[class] / (double)s->rays;
        if (class < CLASSES - 1 || c->most == c->least + class)
            snprintf(words, sizeof words, "%d evaluation%s: %.3g %%", c->least + class,
                     c->least + class == 1 ? "" : "s", share);
        else snprintf(words, sizeof words, "%d to %d: %.3g %%", c->least + class, c->most, share);
        draw_entry(cr, &at, class_colour(class), words);
    }
    size_t missed = s->rays - s->met - s->undecided;
    snprintf(words, sizeof words, "past the Earth: %.3g %%", 100.0 * (double)missed / (double)s->rays);
    if (missed) draw_entry(cr, &at, MISSED, words);
    snprintf(words, sizeof words, "undecided: %zu", s->undecided);
    draw_entry(cr, &at, UNDECIDED, words);
}

void picture_write(const char *file, const scan *s, const char *title, bool by_height)
{
    costs c = costs_of(s);
    cairo_surface_t *page = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)WIDTH, (int)HEIGHT);
    cairo_t *cr = cairo_create(page);
    colours_set(cr, PAPER);
    cairo_paint(cr);
    colours_set(cr, INK);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    cairo_set_font_size(cr, 13);
    cairo_text_extents_t size;
    cairo_text_extents(cr, title, &size);
    cairo_set_font_size(cr, 13 * fmin(1, (WIDTH - 2 * MAP_LEFT) / size.x_advance));
    colours_text(cr, MAP_LEFT, 24, 0, title);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, 12);
    colours_text(cr, MAP_LEFT, TOP - 28, 0, "the swath, on a map of equal areas");
    colours_text(cr, IMAGE_LEFT, TOP - 28, 0, "the camera's image: evaluations of F for each ray");
    draw_map(cr, s, by_height);
    draw_map_legend(cr, s, by_height);
    draw_image(cr, s, &c);
    draw_image_axes(cr, s);
    draw_image_legend(cr, s, &c);
    cairo_destroy(cr);
    char part[PICTURE_NAME];
    picture_part(part, file);
    cairo_status_t status = cairo_surface_write_to_png(page, part);
    cairo_surface_destroy(page);
    const bool good = status == CAIRO_STATUS_SUCCESS && rename(part, file) == 0;
    if (good) return;
    const char *why = status == CAIRO_STATUS_SUCCESS ? strerror(errno) : cairo_status_to_string(status);
    remove(part);
    fail_input("%s: %s", file, why);
}

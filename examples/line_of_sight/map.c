// SPDX-License-Identifier: MIT
/* map.c - Lambert's azimuthal equal-area projection (Snyder 1987, section 24), its graticule and a scale bar.
 *
 * With u the unit vector of a latitude and longitude, and up, east and north those of the map's middle,
 *     x = k u . east,  y = k u . north,  k = sqrt(2 / (1 + u . up)),  in radii of the Earth.
 * Geodetic latitudes are put in as if the Earth were a sphere: it is a picture. */
#include "map.h"

#include "colours.h"

#include <math.h>
#include <stdio.h>

static const double DEGREE = 0.017453292519943295769, RADIUS = 6371; /* km */
static const double ROUND = -0.85; /* of u . up: nearer to the point opposite the middle nothing is drawn */
enum { SAMPLES = 240, LABELS = 80 };

static void unit(double latitude, double longitude, double u[3])
{
    u[0] = cos(DEGREE * latitude) * cos(DEGREE * longitude),
    u[1] = cos(DEGREE * latitude) * sin(DEGREE * longitude), u[2] = sin(DEGREE * latitude);
}

static bool flat(const map *m, double latitude, double longitude, spot *km)
{
    double u[3];
    unit(latitude, longitude - m->longitude, u);
    double s = sin(DEGREE * m->latitude), c = cos(DEGREE * m->latitude), up = c * u[0] + s * u[2],
           k = RADIUS * sqrt(2 / (1 + fmax(ROUND, up)));
    *km = (spot){k * u[1], k * (c * u[2] - s * u[0])};
    return up > ROUND;
}

bool map_spot(const map *m, double latitude, double longitude, spot *at)
{
    spot km;
    bool near = flat(m, latitude, longitude, &km);
    *at = (spot){m->left + m->width / 2 + m->scale * km.x, m->top + m->height / 2 - m->scale * km.y};
    return near;
}

void map_fit(map *m, size_t n, const double latitude[], const double longitude[])
{
    double mean[3] = {0}, u[3];
    spot low = {0}, high = {0}, km;
    for (size_t i = 0; i < n; i++) {
        if (isnan(latitude[i])) continue;
        unit(latitude[i], longitude[i], u);
        for (int j = 0; j < 3; j++) mean[j] += u[j];
    }
    m->latitude = atan2(mean[2], hypot(mean[0], mean[1])) / DEGREE,
    m->longitude = atan2(mean[1], mean[0]) / DEGREE;
    for (size_t i = 0; i < n; i++) {
        if (isnan(latitude[i]) || !flat(m, latitude[i], longitude[i], &km)) continue;
        low.x = fmin(low.x, km.x), low.y = fmin(low.y, km.y), high.x = fmax(high.x, km.x),
        high.y = fmax(high.y, km.y);
    }
    double x = fmax(fmax(high.x, -low.x), 0.5), y = fmax(fmax(high.y, -low.y), 0.5);
    m->scale = 0.94 * fmin(m->width / x, m->height / y) / 2;
}

/* -------------------------------------------------------------- graticule */

typedef struct label { double x, y, wide; } label;
typedef struct labels { label taken[LABELS]; int count; } labels;

/* Where nothing is yet. */
static bool put(labels *l, cairo_t *cr, double x, double y, double align, const char *words)
{
    cairo_text_extents_t size;
    cairo_text_extents(cr, words, &size);
    double from = x - align * size.x_advance;
    for (int i = 0; i < l->count; i++)
        if (fabs(y - l->taken[i].y) < 14 && from < l->taken[i].x + l->taken[i].wide + 8 &&
            from + size.x_advance + 8 > l->taken[i].x)
            return false;
    if (l->count == LABELS) return false;
    l->taken[l->count++] = (label){from, y, size.x_advance};
    colours_set(cr, INK);
    colours_text(cr, from, y, 0, words);
    return true;
}

static void name_degrees(char words[static 24], double degrees, char positive, char negative)
{
    double a = fabs(degrees) < 1e-9 ? 0 : degrees;
    snprintf(words, 24, "%.7g\302\260%.1s", fabs(a),
             a > 0   ? (char[]){positive, 0}
             : a < 0 ? (char[]){negative, 0}
                     : "");
}

/* A step from `from` to `to`, part of a line: labelled where it goes over an edge. */
typedef enum side { NO_SIDE = -1, LEFT, BELOW, ABOVE, SIDES } side;

static bool label_crossing(const map *m, cairo_t *cr, labels *l, side s, spot from, spot to,
                           const char *words)
{
    double edge = s == LEFT    ? m->left
                  : s == BELOW ? m->top + m->height
                               : m->top,
           a = (s == LEFT ? from.x : from.y) - edge, b = (s == LEFT ? to.x : to.y) - edge;
    if ((a < 0) == (b < 0)) return false;
    double part = a / (a - b), x = from.x + part * (to.x - from.x), y = from.y + part * (to.y - from.y);
    if (s == LEFT ? y < m->top + 4 || y > m->top + m->height - 4
                  : x < m->left + 4 || x > m->left + m->width - 4)
        return false;
    if (s == LEFT) return put(l, cr, x - 7, y + 4, 1, words);
    return put(l, cr, x, s == BELOW ? y + 17 : y - 7, 0.5, words);
}

/* One parallel (fixed: its latitude) or meridian, the other coordinate from ... to; NO_SIDE: drawn, else
 * labelled there. */
static bool line_of(const map *m, cairo_t *cr, labels *l, side s, bool parallel, double fixed, double from,
                    double to)
{
    char words[24];
    double turned = remainder(fixed, 360);
    spot before = {0};
    bool drawn = false, labelled = false;
    if (parallel) name_degrees(words, fixed, 'N', 'S');
    else if (fabs(fabs(turned) - 180) < 1e-9) snprintf(words, sizeof words, "180\302\260");
    else name_degrees(words, turned, 'E', 'W');
    for (int i = 0; i <= SAMPLES; i++) {
        double other = from + (to - from) * i / SAMPLES;
        spot at;
        bool near = parallel ? map_spot(m, fixed, other, &at) : map_spot(m, other, fixed, &at);
        if (near && drawn && s == NO_SIDE) cairo_line_to(cr, at.x, at.y);
        else if (near && s == NO_SIDE) cairo_move_to(cr, at.x, at.y);
        else if (near && drawn) labelled |= label_crossing(m, cr, l, s, before, at, words);
        before = at, drawn = near;
    }
    return labelled;
}

static double step_for(double degrees)
{
    static const double steps[] = {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        if (degrees / steps[i] <= 7) return steps[i];
    return 30;
}

/* Labelled on the side where most of its kind are, or on the next that it comes to, or beside itself. */
static void label_line(const map *m, cairo_t *cr, labels *l, bool parallel, double fixed, double from,
                       double to)
{
    static const side order[2][SIDES] = {{BELOW, ABOVE, LEFT}, {LEFT, ABOVE, BELOW}};
    for (int i = 0; i < SIDES; i++)
        if (line_of(m, cr, l, order[parallel][i], parallel, fixed, from, to)) return;
    spot at;
    /* a circle about a pole, all of it on the map */
    if (!parallel || !map_spot(m, fixed, m->longitude + 90, &at)) return;
    if (at.x < m->left + 20 || at.x > m->left + m->width - 20 || at.y < m->top + 20 ||
        at.y > m->top + m->height - 20)
        return;
    char words[24];
    name_degrees(words, fixed, 'N', 'S');
    put(l, cr, at.x + 3, at.y + 12, 0, words);
}

void map_graticule(const map *m, cairo_t *cr)
{
    labels l = {.count = 0};
    double high = m->height / m->scale / RADIUS / DEGREE, wide = m->width / m->scale / RADIUS / DEGREE,
           reach = 0.55 * hypot(high, wide);
    double low = fmax(-90, m->latitude - reach), top = fmin(90, m->latitude + reach),
           greatest = fmax(-low, top);
    double step = step_for(high), across = step_for(wide / fmax(cos(DEGREE * m->latitude), 0.2)),
           round = fmin(180, 1.2 * reach / fmax(cos(DEGREE * greatest), 0.01));
    if (round == 180) across = fmax(across, 15);
    cairo_save(cr);
    cairo_rectangle(cr, m->left, m->top, m->width, m->height);
    cairo_clip(cr);
    for (int labelling = 0; labelling < 2; labelling++) {
        for (double k = ceil((low + 1e-9) / step); k * step < top; k++) {
            if (labelling) label_line(m, cr, &l, true, k * step, m->longitude - round, m->longitude + round);
            else line_of(m, cr, &l, NO_SIDE, true, k * step, m->longitude - round, m->longitude + round);
        }
        for (double k = ceil((m->longitude - round) / across); k * across < m->longitude + round - 1e-9;
             k++) {
            if (labelling) label_line(m, cr, &l, false, k * across, low, top);
            else line_of(m, cr, &l, NO_SIDE, false, k * across, low, top);
        }
        if (labelling) break;
        colours_set(cr, FAINT);
        cairo_set_line_width(cr, 0.7);
        cairo_stroke(cr);
        cairo_restore(cr);
    }
    cairo_rectangle(cr, m->left - 0.5, m->top - 0.5, m->width + 1, m->height + 1);
    colours_set(cr, INK);
    cairo_set_line_width(cr, 1);
    cairo_stroke(cr);
}

/* The longest of 1, 2 or 5 times a power of ten km that is at most a quarter of the map. */
void map_scale_bar(const map *m, cairo_t *cr)
{
    char words[24];
    double most = m->width / 4 / m->scale, power = pow(10, floor(log10(most))),
           km = power * (most >= 5 * power   ? 5
                         : most >= 2 * power ? 2
                                             : 1);
    double x = m->left + m->width - 14 - km * m->scale, y = m->top + m->height - 14;
    colours_box(cr, x - 8, y - 18, km * m->scale + 16, 26, PAPER);
    colours_box(cr, x, y, km * m->scale, 2, INK);
    colours_box(cr, x, y - 4, 1, 6, INK);
    colours_box(cr, x + km * m->scale - 1, y - 4, 1, 6, INK);
    if (km < 1) snprintf(words, sizeof words, "%.9g m", 1e3 * km);
    else snprintf(words, sizeof words, "%.9g km", km);
    colours_set(cr, INK);
    colours_text(cr, x + km * m->scale / 2, y - 6, 0.5, words);
}

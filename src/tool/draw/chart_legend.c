// SPDX-License-Identifier: MIT
/* chart_legend.c - what marks, lines and flat colours mean: entries from left to right, in as many rows as
 * they need.
 *
 * An entry stands for a name with a look.  The same name with the same look in several panels has one entry.
 */
#include "chart_draw.h"

#include "../base/memory.h"

#include <math.h>
#include <string.h>

static const double ENTRY_ROW = 17, ENTRY_LINE = 22, ENTRY_MARK = 12, ENTRY_GAP = 6, ENTRIES_APART = 20;

/* One of the four is set. */
typedef struct chart_entry {
    const char *name;
    const chart_series *series;
    const chart_circle *circle;
    const chart_rule *rule;
    const chart_map *map;
    size_t kind;
} chart_entry;

typedef struct chart_entries { chart_entry *entry; size_t count, capacity; } chart_entries;

static bool alike(const chart_entry *a, const chart_entry *b)
{
    const chart_series *s = a->series, *t = b->series;
    if (strcmp(a->name, b->name) != 0) return false;
    if (s && t)
        return s->colour == t->colour && s->mark == t->mark && s->dash == t->dash && s->line == t->line;
    if (a->circle && b->circle) return a->circle->dash == b->circle->dash;
    if (a->rule && b->rule) return a->rule->dash == b->rule->dash && a->rule->upright == b->rule->upright;
    return a->map && b->map && a->kind == b->kind;
}

static void enter(chart_entries *list, chart_entry e)
{
    if (!e.name || !*e.name) return;
    for (size_t i = 0; i < list->count; i++)
        if (alike(&list->entry[i], &e)) return;
    list->entry = memory_room(list->entry, list->count, &list->capacity, sizeof *list->entry);
    list->entry[list->count++] = e;
}

static chart_entries entries_of(const chart *c)
{
    chart_entries list = {NULL, 0, 0};
    for (size_t k = 0; k < c->panels; k++) {
        const chart_panel *p = &c->panel[k];
        for (size_t i = 0; i < p->series_count; i++)
            enter(&list, (chart_entry){.name = p->series[i].name, .series = &p->series[i]});
        for (size_t i = 0; p->map && p->map->kinds && i < p->map->kind_count; i++)
            enter(&list, (chart_entry){.name = p->map->kinds[i], .map = p->map, .kind = i});
    }
    for (size_t k = 0; k < c->panels; k++) {
        const chart_panel *p = &c->panel[k];
        for (size_t i = 0; i < p->circles; i++)
            enter(&list, (chart_entry){.name = p->circle[i].name, .circle = &p->circle[i]});
        for (size_t i = 0; i < p->rules; i++)
            enter(&list, (chart_entry){.name = p->rule[i].name, .rule = &p->rule[i]});
    }
    return list;
}

/* Lines need long samples, to show their dashes. */
static double sample_width(const chart_entry *e)
{
    return (e->series && e->series->line) || (e->rule && !e->rule->upright) ? ENTRY_LINE : ENTRY_MARK;
}

static void draw_swatch(cairo_t *cr, size_t kind, double x, double y)
{
    double rgb[3];
    chart_kind_colour(kind, rgb);
    cairo_rectangle(cr, x, y - 5, ENTRY_MARK, 10);
    cairo_set_source_rgb(cr, rgb[0], rgb[1], rgb[2]);
    cairo_fill(cr);
}

static void draw_sample(cairo_t *cr, const chart_entry *e, double x, double y)
{
    double width = sample_width(e);
    cairo_new_path(cr);
    if (e->series) chart_series_sample(cr, e->series, x, y, width);
    if (e->circle) chart_circle_sample(cr, e->circle, x, y, width);
    if (e->rule) chart_rule_sample(cr, e->rule, x, y, width);
    if (e->map) draw_swatch(cr, e->kind, x, y);
}

double chart_legend(cairo_t *cr, const chart *c, double left, double right, double top, bool draw)
{
    chart_entries list = entries_of(c);
    if (list.count == 0) return 0;
    double x = left, y = top + ENTRY_ROW / 2;
    chart_font(cr, CHART_NORMAL, false);
    chart_grey(cr, 0.2);
    if (c->legend_title) {
        if (draw) chart_text(cr, x, y + 0.35 * CHART_NORMAL, 0, right - left, c->legend_title);
        x += fmin(chart_width(cr, c->legend_title), right - left) + ENTRY_GAP + 4;
    }
    for (size_t i = 0; i < list.count; i++) {
        const chart_entry *e = &list.entry[i];
        double start = sample_width(e) + ENTRY_GAP,
               wide = fmin(start + chart_width(cr, e->name), right - left);
        if (x > left && x + wide > right) x = left, y += ENTRY_ROW;
        if (draw) {
            chart_grey(cr, 0.2);
            chart_text(cr, x + start, y + 0.35 * CHART_NORMAL, 0, wide - start, e->name);
            draw_sample(cr, e, x, y);
        }
        x += wide + ENTRIES_APART;
    }
    return y + ENTRY_ROW / 2 - top;
}

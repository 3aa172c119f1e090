/* glass.c - a glass as a lens file names it: its index at a wavelength.
 *
 * The catalogue is read when the first name is met, once: first the table that ships, then each --glass in
 * its order, since of glasses with one name and no maker to decide the last that was added is taken. */
#include "glass.h"

#include "../base/memory.h"

#include <math.h>
#include <sagitta/lens.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

static const char **folder;
static size_t folders, folder_capacity;

void glass_folder(const char *path)
{
    folder = memory_room(folder, folders, &folder_capacity, sizeof *folder);
    folder[folders++] = path;
}

static void add_catalogue(sgt_catalogue *c, const char *path)
{
    sgt_lens_error e;
    if (sgt_catalogue_add(c, path, &e)) return;
    if (e.line) fail_input("%s:%zu: %s%s%s", e.file, e.line, e.key, *e.key ? ": " : "", e.words);
    fail_input("%s: %s%s%s", e.file, e.key, *e.key ? ": " : "", e.words);
}

static const sgt_catalogue *catalogue(void)
{
    static sgt_catalogue *all;
    if (all) return all;
    sgt_catalogue *c = sgt_catalogue_new(NULL);
    if (!c) fail_input("out of memory");
    add_catalogue(c, NULL);
    for (size_t i = 0; i < folders; i++) add_catalogue(c, folder[i]);
    return all = c;
}

static sgt_glass glass_named(const document *d, const node *n, const char *key, const glass_makers *makers)
{
    const char *name = document_text(d, n, key);
    const sgt_catalogue *c = catalogue();
    sgt_glass g, other;
    sgt_lens_error e;
    if (!sgt_catalogue_find(c, name, makers->count, makers->name, &g, &e))
        document_fail(d, n, key, "%s", e.words);
    for (size_t i = 0; strcasecmp(name, g.name) == 0 && sgt_catalogue_glass(c, i, &other); i++)
        if (strcasecmp(other.name, g.name) == 0 && strcasecmp(other.maker, g.maker) != 0) {
            note("%s:%zu: %s: %s is that of %s; %s has one, too", d->source, n->line, key, g.name, g.maker,
                 other.maker);
            break;
        }
    if (g.remark) note("%s:%zu: %s: %s: %s", d->source, n->line, key, g.name, g.remark);
    return g;
}

static sgt_glass glass_of_map(const document *d, node *map, const char *key)
{
    document_map(d, map, key);
    const node *nd = document_take(map, "nd"), *vd = document_take(map, "vd");
    const node *slope = document_take(map, "dPgF"), *sellmeier = document_take(map, "sellmeier");
    document_finish(d, map, "nd, vd, dPgF; or sellmeier");
    if (sellmeier && (nd || vd || slope))
        document_fail(d, sellmeier, "sellmeier", "given beside nd, vd or dPgF");
    sgt_glass g = {.name = "the glass"};
    if (sellmeier) {
        size_t most = sellmeier->kind == NODE_LIST ? sellmeier->count : 0;
        double *c = memory_take(most + 1, sizeof *c); /* the first is 0: n^2 = 1 + ... */
        g.formula = 2, g.coefficient = c;
        g.count = 1 + document_numbers(d, sellmeier, "sellmeier", SIZE_MAX, c + 1);
        if (g.count % 2 == 0)
            document_fail(d, sellmeier, "sellmeier", "must be pairs: K1, L1, K2, L2 ...; it has %zu numbers",
                          g.count - 1);
        return g;
    }
    if (!nd || !vd) document_fail(d, map, nd ? "vd" : "nd", "missing; a model glass has nd and vd");
    double *c = memory_take(3, sizeof *c);
    c[0] = document_number(d, nd, "nd", NUMBER_FINITE), c[1] = document_number(d, vd, "vd", NUMBER_FINITE);
    if (slope) c[2] = document_number(d, slope, "dPgF", NUMBER_FINITE);
    if (!(c[0] > 0)) document_fail(d, nd, "nd", "must be positive, not %g", c[0]);
    if (!(c[1] >= 0)) document_fail(d, vd, "vd", "must not be negative, but is %g", c[1]);
    note("%s:%zu: %s: a model of nd and vd: its index is approximate", d->source, map->line, key);
    g.formula = SGT_FORMULA_MODEL, g.count = 3, g.coefficient = c;
    return g;
}

static sgt_glass glass_of_pairs(const document *d, const node *list, const char *key)
{
    double *c = memory_take(2 * list->count, sizeof *c);
    sgt_glass g = {.name = "the list", .formula = SGT_FORMULA_PAIRS};
    g.count = 2 * list->count, g.coefficient = c;
    for (size_t i = 0; i < list->count; i++) {
        const node *pair = list->item[i];
        if (pair->kind != NODE_LIST || pair->count != 2)
            document_fail(d, pair, key,
                          "must be pairs of a wavelength and an index, like [[0.4861, 1.5224]]");
        document_numbers(d, pair, key, 2, c + 2 * i);
        if (i && !(c[2 * i] > c[2 * i - 2])) document_fail(d, pair, key, "the wavelengths must rise");
    }
    if (list->count) g.from = c[0], g.to = c[2 * list->count - 2];
    return g;
}

double glass_index(const document *d, node *n, const char *key, double um, const glass_makers *makers)
{
    if (n->kind == NODE_SCALAR && strcasecmp(n->text, "air") == 0) return 1;
    if (isnan(um))
        document_fail(d, n, key,
                      "needs a wavelength: wavelengths in the file, or --wavelength in micrometres");
    sgt_glass g = n->kind == NODE_SCALAR ? glass_named(d, n, key, makers)
                  : n->kind == NODE_MAP  ? glass_of_map(d, n, key)
                                         : glass_of_pairs(d, n, key);
    const char *fault = sgt_glass_fault(&g);
    if (fault) document_fail(d, n, key, "%s", fault);
    double index = sgt_glass_index(&g, um);
    if (isnan(index)) document_fail(d, n, key, "%s has no index at %g micrometres", g.name, um);
    if (!sgt_glass_covers(&g, um))
        note("%s:%zu: %s: %g micrometres is outside the range of %s, %g to %g", d->source, n->line, key, um,
             g.name, g.from, g.to);
    return index;
}

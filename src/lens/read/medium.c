// SPDX-License-Identifier: MIT
/* medium.c - a medium as a lens file names it, and its index at a wavelength.
 *
 * The table of glasses that ships is read when the first name is met, if the caller gave none.
 * A name is looked up once: a lens has few glasses, and many surfaces of each.  An edited lens takes
 * the glasses that it had, with what was told of them. */
#include "medium.h"

#include "../glass/forms.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static bool same_name(const char *a, const char *b)
{
    while (*a && sgt_lower(*a) == sgt_lower(*b)) a++, b++;
    return *a == *b;
}

const sgt_catalogue *sgt_source_glasses(source *s, size_t line, const char *key)
{
    if (s->options->glasses) return s->options->glasses;
    if (s->own_glasses) return s->own_glasses;
    sgt_error e;
    s->own_glasses = sgt_catalogue_new(&s->arena->allocator);
    if (!s->own_glasses) tree_fail(s, 0, NULL, "no memory");
    if (!sgt_catalogue_add(s->own_glasses, NULL, &e))
        tree_fail(s, line, key, "the table of glasses: %s:%zu: %s", e.file, e.line, e.words);
    return s->own_glasses;
}

/* A copy of which nothing lies in the catalogue. */
static const sgt_glass *own_copy(source *s, sgt_glass g)
{
    sgt_glass *copy = tree_room(s, 1, sizeof *copy);
    double *c = tree_room(s, g.count, sizeof *c);
    if (g.count) memcpy(c, g.coefficient, g.count * sizeof *c);
    g.coefficient = c;
    if (g.name) g.name = tree_text(s, g.name, strlen(g.name));
    if (g.maker) g.maker = tree_text(s, g.maker, strlen(g.maker));
    if (g.remark) g.remark = tree_text(s, g.remark, strlen(g.remark));
    if (g.file) g.file = tree_text(s, g.file, strlen(g.file));
    *copy = g;
    return copy;
}

/* A name of six digits is a MIL number: 517642 is nd 1.517, vd 64.2 (MIL-G-174). */
static bool mil_number(const char *name, double nd_vd[2])
{
    if (strlen(name) != 6 || strspn(name, "0123456789") != 6) return false;
    double digits = 0;
    for (int i = 0; i < 6; i++) digits = 10 * digits + (name[i] - '0');
    double first = floor(digits / 1000);
    nd_vd[0] = (1000 + first) / 1000, nd_vd[1] = (digits - 1000 * first) / 10;
    return true;
}

/* What a name that is none may mean. */
static const char *name_hint(const char *name)
{
    if (same_name(name, "mirror")) return "; write mirror: true";
    bool number = *name && strspn(name, "0123456789.") == strlen(name);
    return number ? "; write an index as index: 1.5" : "; or give a catalogue that has it: --glass PATH";
}

/* Which other makers have the name of glass g, and how far their glass is from it. */
static void tell_others(source *s, const sgt_catalogue *c, const sgt_glass *g, size_t line, const char *key)
{
    double nd = sgt_glass_index(g, sgt_spectral_line("d"));
    const char *list = "";
    sgt_glass other, before;
    for (size_t i = 0; sgt_catalogue_glass(c, i, &other); i++) {
        if (!same_name(other.name, g->name) || same_name(other.maker, g->maker)) continue;
        bool told = false; /* the maker has it twice */
        for (size_t j = 0; j < i && !told && sgt_catalogue_glass(c, j, &before); j++)
            told = same_name(before.name, other.name) && same_name(before.maker, other.maker);
        if (told) continue;
        double apart = sgt_glass_index(&other, sgt_spectral_line("d")) - nd;
        list = tree_print(s, "%s%s%s (%s)", list, *list ? ", " : "", other.maker,
                          isnan(apart)           ? "no nd"
                          : fabs(apart) < 0.5e-5 ? "nd the same"
                                                 : tree_print(s, "nd %+.5f", apart));
    }
    if (*list)
        tree_remark(s, SGT_REMARK_NOTE, line, key,
                    "taken as %s of %s, nd %.5f; also of %s.  makers: [%s] or glass: %s %s chooses", g->name,
                    g->maker, nd, list, g->maker, g->maker, g->name);
}

static bool same_makers(const media *a, const media *b)
{
    bool same = a->makers == b->makers;
    for (size_t i = 0; same && i < a->makers; i++) same = strcmp(a->maker[i], b->maker[i]) == 0;
    return same;
}

/* Remembers a glass, and the remarks from `told` on. */
static void remember(media *m, const char *name, const sgt_glass *own, size_t told)
{
    source *s = m->source;
    if (m->known == KNOWN_MOST) return;
    known_glass *k = &m->known_glass[m->known++];
    *k = (known_glass){.name = name, .glass = own, .remarks = s->remarks - told};
    if (!k->remarks) return;
    sgt_lens_remark *kept = tree_room(s, k->remarks, sizeof *kept);
    memcpy(kept, s->remark + told, k->remarks * sizeof *kept);
    k->remark = kept;
}

/* A glass that the lens had before it was edited; NULL: none of that name. */
static const sgt_glass *glass_kept(media *m, const char *name, size_t line, const char *key)
{
    source *s = m->source;
    const media *old = m->before;
    if (!old || !same_makers(m, old)) return NULL;
    for (size_t i = 0; i < old->known; i++) {
        const known_glass *k = &old->known_glass[i];
        if (strcmp(k->name, name) != 0) continue;
        const size_t told = s->remarks;
        for (size_t j = 0; j < k->remarks; j++) tree_remark_again(s, &k->remark[j], line, key);
        const sgt_glass *own = own_copy(s, *k->glass);
        remember(m, name, own, told);
        return own;
    }
    return NULL;
}

static const sgt_glass *glass_named(media *m, const node *n, const char *key)
{
    source *s = m->source;
    const char *name = tree_read_text(s, n, key);
    double mil[3] = {0};
    for (size_t i = 0; i < m->known; i++)
        if (strcmp(m->known_glass[i].name, name) == 0) return m->known_glass[i].glass;
    const sgt_glass *kept = glass_kept(m, name, n->line, key);
    if (kept) return kept;
    const size_t told = s->remarks;
    sgt_glass g = {.name = name, .formula = SGT_DISPERSION_MODEL, .count = 3, .coefficient = mil};
    sgt_error e;
    if (mil_number(name, mil)) {
        tree_remark(s, SGT_REMARK_TURNED, n->line, key,
                    "nd %.3f, vd %.1f: %s is a MIL number, and its index approximate", mil[0], mil[1],
                    name);
    } else {
        const sgt_catalogue *c = sgt_source_glasses(s, n->line, key);
        if (!sgt_catalogue_find(c, name, m->makers, m->maker, &g, &e))
            tree_fail(s, n->line, key, "%s%s", e.words, name_hint(name));
        bool decided = false; /* by the makers of the lens, or by MAKER NAME */
        for (size_t i = 0; i < m->makers; i++) decided = decided || same_name(m->maker[i], g.maker);
        if (!decided && same_name(name, g.name)) tell_others(s, c, &g, n->line, key);
        if (g.remark) tree_remark(s, SGT_REMARK_NOTE, n->line, key, "%s: %s", g.name, g.remark);
    }
    const sgt_glass *own = own_copy(s, g);
    remember(m, name, own, told);
    return own;
}

static sgt_glass glass_of_map(media *m, node *map, const char *key)
{
    source *s = m->source;
    tree_map(s, map, key);
    const node *nd = tree_take(map, "nd"), *vd = tree_take(map, "vd");
    const node *slope = tree_take(map, "dPgF"), *sellmeier = tree_take(map, "sellmeier");
    tree_finish(s, map, "nd, vd, dPgF; or sellmeier");
    if (sellmeier && (nd || vd || slope))
        tree_fail(s, sellmeier->line, "sellmeier", "given beside nd, vd or dPgF");
    sgt_glass g = {.name = "the glass"};
    if (sellmeier) {
        size_t most = sellmeier->kind == NODE_LIST ? sellmeier->count : 0;
        double *c = tree_room(s, most + 1, sizeof *c); /* the first is 0: n^2 = 1 + ... */
        g.formula = 2, g.coefficient = c;
        g.count = 1 + tree_read_numbers(s, sellmeier, "sellmeier", SIZE_MAX, c + 1);
        if (g.count % 2 == 0)
            tree_fail(s, sellmeier->line, "sellmeier",
                      "must be pairs: K1, L1, K2, L2 ...; it has %zu numbers", g.count - 1);
        return g;
    }
    if (!nd || !vd) tree_fail(s, map->line, nd ? "vd" : "nd", "missing; a model glass has nd and vd");
    double *c = tree_room(s, 3, sizeof *c);
    c[0] = tree_read_number(s, nd, "nd", NUMBER_FINITE), c[1] = tree_read_number(s, vd, "vd", NUMBER_FINITE);
    if (slope) c[2] = tree_read_number(s, slope, "dPgF", NUMBER_FINITE);
    if (!(c[0] > 0)) tree_fail(s, nd->line, "nd", "must be positive, not %g", c[0]);
    if (!(c[1] >= 0)) tree_fail(s, vd->line, "vd", "must not be negative, but is %g", c[1]);
    if (!m->model_told)
        tree_remark(s, SGT_REMARK_NOTE, map->line, key,
                    "taken as a model of nd and vd: its index is approximate");
    m->model_told = true;
    g.formula = SGT_DISPERSION_MODEL, g.count = 3, g.coefficient = c;
    return g;
}

static sgt_glass glass_of_pairs(source *s, const node *list, const char *key)
{
    double *c = tree_room(s, 2 * list->count, sizeof *c);
    sgt_glass g = {.name = "the list", .formula = SGT_DISPERSION_PAIRS};
    g.count = 2 * list->count, g.coefficient = c;
    for (size_t i = 0; i < list->count; i++) {
        const node *pair = list->item[i];
        if (pair->kind != NODE_LIST || pair->count != 2)
            tree_fail(s, pair->line, key,
                          "must be pairs of a wavelength and an index, like [[0.4861, 1.5224]]");
        tree_read_numbers(s, pair, key, 2, c + 2 * i);
        if (i && !(c[2 * i] > c[2 * i - 2])) tree_fail(s, pair->line, key, "the wavelengths must rise");
    }
    if (list->count) g.from = c[0], g.to = c[2 * list->count - 2];
    return g;
}

medium sgt_medium_of_glass(media *m, node *n, const char *key)
{
    source *s = m->source;
    medium is = {.kind = MEDIUM_GLASS, .line = n->line, .key = key};
    if (n->kind == NODE_SCALAR && same_name(n->text, "air")) {
        is.kind = MEDIUM_NUMBER, is.number = 1;
        return is;
    }
    if (n->kind == NODE_SCALAR && same_name(n->text, "same")) {
        is.kind = MEDIUM_BEFORE;
        return is;
    }
    if (n->kind == NODE_SCALAR) {
        is.glass = glass_named(m, n, key);
    } else {
        sgt_glass g = n->kind == NODE_MAP ? glass_of_map(m, n, key) : glass_of_pairs(s, n, key);
        is.glass = own_copy(s, g);
    }
    const char *fault = sgt_glass_fault(is.glass);
    if (fault) tree_fail(s, n->line, key, "%s", fault);
    return is;
}

static double positive_index(source *s, const node *n, const char *key)
{
    double x = tree_read_number(s, n, key, NUMBER_FINITE);
    if (!(x > 0)) tree_fail(s, n->line, key, "must be positive, not %g", x);
    return x;
}

medium sgt_medium_of_index(media *m, const node *n, const char *key, size_t wavelengths)
{
    source *s = m->source;
    medium is = {.kind = MEDIUM_NUMBER, .line = n->line, .key = key};
    if (n->kind != NODE_LIST) {
        is.number = positive_index(s, n, key);
        return is;
    }
    if (n->count != wavelengths)
        tree_fail(s, n->line, key, "has %zu number%s, but the lens has %zu wavelength%s", n->count,
                  n->count == 1 ? "" : "s", wavelengths, wavelengths == 1 ? "" : "s");
    double *list = tree_room(s, n->count, sizeof *list);
    for (size_t i = 0; i < n->count; i++) list[i] = positive_index(s, n->item[i], key);
    is.kind = MEDIUM_LIST, is.list = list;
    return is;
}

double sgt_medium_index(const medium *m, const sgt_lens *lens, double um, double before, char why[WHY_SIZE])
{
    switch (m->kind) {
    case MEDIUM_BEFORE: return before;
    case MEDIUM_NUMBER: return m->number;
    case MEDIUM_LIST:
        if (!lens->wavelength) return m->list[0];
        for (size_t i = 0; i < lens->wavelengths; i++)
            if (lens->wavelength[i] == um) return m->list[i];
        snprintf(why, WHY_SIZE, "is for the wavelengths of the file; %g micrometres is none of them", um);
        return (double)NAN;
    case MEDIUM_GLASS: break;
    }
    double index = isnan(um) ? (double)NAN : sgt_glass_index(m->glass, um);
    if (isnan(um))
        snprintf(why, WHY_SIZE, "needs a wavelength: the file gives no wavelengths, as [0.5876] in "
                 "micrometres, and none was asked for");
    else if (isnan(index))
        snprintf(why, WHY_SIZE, "%s has no index at %g micrometres", m->glass->name, um);
    return index;
}

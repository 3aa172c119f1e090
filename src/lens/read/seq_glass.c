// SPDX-License-Identifier: MIT
/* seq_glass.c - glasses of a sequence file.
 *
 * NAMES.  CODE V writes NBK7_SCHOTT for N-BK7 of SCHOTT: the name of the maker without anything that is no
 * letter and no digit.  So the names of the catalogue are compared by their letters and digits, and no rule
 * of a maker is needed.  The lens file gets the name as the catalogue has it.
 *
 * FICTITIOUS GLASSES: digits.digits is nd = 1.digits and Vd = 100 times 0.digits, with as many digits as
 * there are; 517642 is 517.642; nd:Vd stands as it is.  CODE V's dispersion between the lines is not
 * published: the glass becomes a model of nd and Vd, which is approximate.  The digits are shifted as a text,
 * and rounded once.
 *
 * PRIVATE GLASSES stand in a block PRV ... END: PWL and wavelengths in nanometres, then 'NAME' and an index
 * at each; these become pairs, between which the lens file has straight lines.  'NAME' LAU a0 ... a5 is n^2 =
 * a0 + a1 L^2 + a2 / L^2 + a3 / L^4 + a4 / L^6 + a5 / L^8, L in micrometres: it becomes the indices at the
 * wavelengths of the lens. */
#include "seq.h"

#include "medium.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool counts(char c) { return (sgt_lower(c) >= 'a' && sgt_lower(c) <= 'z') || (c >= '0' && c <= '9'); }

/* Of letters and digits, whatever their case. */
static size_t hash_of(piece name)
{
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (const char *c = name.begin; c < name.end; c++)
        if (counts(*c)) hash = (hash ^ (unsigned char)sgt_lower(*c)) * 16777619u;
    return (hash ^ hash >> 16) % SEQ_HASH;
}

static bool alike(piece a, piece b)
{
    for (;;) {
        while (a.begin < a.end && !counts(*a.begin)) a.begin++;
        while (b.begin < b.end && !counts(*b.begin)) b.begin++;
        if (a.begin == a.end || b.begin == b.end) return a.begin == a.end && b.begin == b.end;
        if (sgt_lower(*a.begin++) != sgt_lower(*b.begin++)) return false;
    }
}

static piece piece_of(const char *text) { return (piece){text, text + strlen(text)}; }

/* ---------------------------------------------------------- private glasses */

static seq_private *own_glass(const seq *q, piece name)
{
    seq_private *g = q->own[hash_of(name)];
    while (g && !alike(g->name.text, name)) g = g->next;
    return g;
}

static void private_wavelengths(seq *q)
{
    q->um = NULL, q->ums = q->um_room = 0;
    for (const seq_word *w = sgt_seq_more(q); w; w = sgt_seq_more(q)) {
        q->um = tree_grow(q->s, q->um, q->ums, &q->um_room, sizeof *q->um);
        q->um[q->ums++] = (seq_number){sgt_seq_scaled(q, w, -3), w->line};
        if (!(q->um[q->ums - 1].value > 0)) tree_fail(q->s, w->line, "PWL", "a wavelength is above 0");
    }
}

static void private_glass(seq *q)
{
    enum { SERIES = 6 };
    const seq_word name = q->word[0];
    seq_private *g = tree_room(q->s, 1, sizeof *g);
    double x;
    g->name = name, g->um = q->um, g->ums = q->ums;
    if (q->next < q->words && !sgt_seq_number_of(q->word[q->next].text, &x)) {
        const seq_word *w = sgt_seq_more(q);
        if (!sgt_seq_is(w->text, "lau"))
            tree_fail(q->s, w->line, "PRV", "the formula \"%.*s\" of a glass is not read",
                      sgt_reader_width(w->text), w->text.begin);
        g->series = true;
    }
    const size_t wanted = g->series ? SERIES : q->ums, given = q->words - q->next;
    if (given != wanted || !wanted)
        tree_fail(
            q->s, name.line, "PRV", "glass %.*s has %zu numbers, and should have %zu, one for each of %s",
            sgt_reader_width(name.text), name.text.begin, given, wanted, g->series ? "a0 ... a5" : "PWL");
    g->value = tree_room(q->s, wanted, sizeof *g->value);
    while (g->count < wanted) g->value[g->count++] = sgt_seq_number(q);
    const size_t hash = hash_of(name.text);
    g->next = q->own[hash], q->own[hash] = g;
}

void sgt_seq_read_private(seq *q)
{
    static const seq_command row = {"PRV", SEQ_READ, NULL, 0, NULL};
    const piece word = q->word[0].text;
    q->row = &row;
    if (!q->whole)
        tree_fail(q->s, sgt_seq_line(q), "PRV", "the file ends in the middle of this line; is it cut off?");
    if (!q->word[0].quoted && sgt_seq_is(word, "end"))
        q->in_private = false;
    else if (!q->word[0].quoted && sgt_seq_is(word, "pwl"))
        private_wavelengths(q);
    else
        private_glass(q);
}

static int by_wavelength(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void set_pairs(seq *q, node *map, const seq_private *g, size_t line)
{
    double(*pair)[2] = tree_room(q->s, g->ums, sizeof *pair);
    for (size_t i = 0; i < g->ums; i++) pair[i][0] = g->um[i].value, pair[i][1] = g->value[i];
    qsort(pair, g->ums, sizeof *pair, by_wavelength);
    node *list = tree_node(q->s, NODE_LIST, line);
    for (size_t i = 0; i < g->ums; i++) tree_append(q->s, list, tree_numbers(q->s, line, 2, pair[i]));
    list->inline_ = true;
    tree_set(q->s, map, "glass", list);
}

static void set_series(seq *q, node *map, const seq_private *g, size_t line)
{
    const seq_list *um = &q->list[SEQ_WL];
    if (!um->count) tree_fail(q->s, line, "PRV", "this glass needs the wavelengths of the lens, WL");
    double *index = tree_room(q->s, um->count, sizeof *index);
    for (size_t i = 0; i < um->count; i++) {
        const double *a = g->value, l = um->value[i] * um->value[i], r = 1 / l;
        index[i] = sqrt(a[0] + a[1] * l + r * (a[2] + r * (a[3] + r * (a[4] + r * a[5]))));
        if (!(index[i] > 0 && isfinite(index[i])))
            tree_fail(q->s, g->name.line, "PRV", "glass %.*s has no index at %g micrometres",
                      sgt_reader_width(g->name.text), g->name.text.begin, um->value[i]);
    }
    tree_set(q->s, map, "index", tree_numbers(q->s, line, um->count, index));
}

/* Of each glass it is told once: at the block. */
static void set_private(seq *q, node *map, seq_private *g, size_t line)
{
    if (g->series)
        set_series(q, map, g, line);
    else if (g->ums == 1)
        sgt_seq_set_number(q, map, "index", line, g->value[0]);
    else
        set_pairs(q, map, g, line);
    if (g->name.line)
        tree_remark(
            q->s, SGT_REMARK_TURNED, g->name.line, "PRV", "%s",
            g->series ? "its indices at the wavelengths of the lens, by a series whose form is not published"
            : g->ums == 1 ? "one index for all wavelengths"
                          : "straight lines between its indices: how CODE V goes between is not published");
    g->name.line = 0;
}

/* ------------------------------------------------------- fictitious glasses */

static size_t digits_in(const char *at, const char *end)
{
    const char *c = at;
    while (c < end && *c >= '0' && *c <= '9') c++;
    return (size_t)(c - at);
}

/* nd and Vd of a code; false: it is none. */
static bool fictitious(seq *q, const seq_word *w, double *nd, double *vd)
{
    enum { SIX = 6, MOST = 40 };
    const piece t = w->text;
    const char *colon = memchr(t.begin, ':', (size_t)(t.end - t.begin));
    if (colon)
        return sgt_seq_number_of((piece){t.begin, colon}, nd) &&
               sgt_seq_number_of((piece){colon + 1, t.end}, vd);
    const size_t first = digits_in(t.begin, t.end);
    const bool point = t.begin + first < t.end && t.begin[first] == '.';
    const char *second = t.begin + first + point;
    const size_t rest = point ? digits_in(second, t.end) : 0;
    if (second + rest != t.end || first == 0 || first > MOST || rest > MOST) return false;
    if (!point && first != SIX)
        tree_fail(q->s, w->line, "S", "%.*s is no code of a glass: it has six digits, or a point",
                  sgt_reader_width(t), t.begin);
    if (point && rest == 0) return false;
    char text[2 * MOST];
    const int own = point ? (int)first : SIX / 2;
    const char *dispersion = point ? second : t.begin + SIX / 2;
    const int many = point ? (int)rest : SIX / 2;
    snprintf(text, sizeof text, "1.%.*s", own, t.begin);
    sgt_reader_number(piece_of(text), nd);
    snprintf(text, sizeof text, "0.%.*se2", many, dispersion);
    sgt_reader_number(piece_of(text), vd);
    return true;
}

static void set_model(seq *q, node *map, const seq_word *w, double nd, double vd)
{
    if (!(nd > 0 && vd > 0)) tree_fail(q->s, w->line, "S", "a glass of nd %g and Vd %g is none", nd, vd);
    node *model = tree_node(q->s, NODE_MAP, w->line);
    sgt_seq_set_number(q, model, "nd", w->line, nd);
    sgt_seq_set_number(q, model, "vd", w->line, vd);
    tree_set(q->s, map, "glass", model);
    if (q->approximate++ == 0) q->approximate_line = w->line;
}

/* ------------------------------------------------------------- a catalogue */

static void ask_catalogue(seq *q, size_t line)
{
    const sgt_catalogue *c = sgt_source_glasses(q->s, line, "S");
    sgt_glass g;
    q->known = tree_room(q->s, SEQ_HASH, sizeof *q->known);
    for (size_t i = sgt_catalogue_count(c); i-- > 0;) { /* so that the first one is found first */
        if (!sgt_catalogue_glass(c, i, &g) || !g.name) continue;
        seq_known *k = tree_room(q->s, 1, sizeof *k);
        const size_t hash = hash_of(piece_of(g.name));
        *k = (seq_known){g.name, g.maker ? g.maker : "", q->known[hash]};
        q->known[hash] = k;
    }
}

static bool as_spelled(piece name, const char *text)
{
    const char *c = name.begin;
    while (c < name.end && *text && sgt_lower(*c) == sgt_lower(*text)) c++, text++;
    return c == name.end && !*text;
}

/* The name as the lens file has it: MAKER NAME, or NAME if no maker is given.  NULL: there is none. */
static const char *catalogue_name(seq *q, piece name, const piece *maker)
{
    const char *found = NULL;
    for (const seq_known *k = q->known[hash_of(name)]; k; k = k->next) {
        if (!alike(name, piece_of(k->name)) || (maker && !alike(*maker, piece_of(k->maker)))) continue;
        if (maker) return tree_print(q->s, "%s %s", k->maker, k->name);
        if (!found || as_spelled(name, k->name)) found = k->name;
    }
    return found;
}

static void set_named(seq *q, node *map, const seq_word *w)
{
    const piece t = w->text;
    const char *bar = t.end;
    while (bar > t.begin && bar[-1] != '_') bar--;
    if (!q->known) ask_catalogue(q, w->line);
    const piece name = {t.begin, bar > t.begin ? bar - 1 : t.end}, maker = {bar, t.end};
    const char *found = catalogue_name(q, name, bar > t.begin ? &maker : NULL);
    if (!found && bar > t.begin) found = catalogue_name(q, t, NULL); /* a name with a bar in it */
    if (!found)
        found = tree_print(q->s, "%.*s%s%.*s", bar > t.begin ? sgt_reader_width(maker) : 0, maker.begin,
                           bar > t.begin ? " " : "", sgt_reader_width(name), name.begin);
    node *word = tree_word(q->s, w->line, found);
    tree_set(q->s, map, "glass", word);
}

void sgt_seq_set_medium(seq *q, node *map, const seq_surface *f, bool object)
{
    const seq_word *w = &f->glass;
    double nd, vd;
    if (f->mirror) sgt_seq_set_word(q, map, "mirror", f->line, "true");
    if (!w->line) {
        if (!f->mirror && !object) sgt_seq_set_word(q, map, "glass", f->line, "air");
        return;
    }
    seq_private *own = own_glass(q, w->text);
    if (own)
        set_private(q, map, own, w->line);
    else if (w->quoted)
        tree_fail(q->s, w->line, "S", "there is no glass '%.*s' in a PRV block of this file",
                  sgt_reader_width(w->text), w->text.begin);
    else if (fictitious(q, w, &nd, &vd))
        set_model(q, map, w, nd, vd);
    else
        set_named(q, map, w);
}

// SPDX-License-Identifier: MIT
/* seq_glass.c - glasses of a sequence file.
 *
 * NAMES.  CODE V writes NBK7_SCHOTT for N-BK7 of SCHOTT: the name of the maker without anything that is no
 * letter and no digit.  So the names of the catalogue are compared by their letters and digits, and no rule
 * of a maker is needed.  The lens file gets the name as the catalogue has it.  A name that is spelled as one
 * of several wins; else such a name is refused.
 *
 * FICTITIOUS GLASSES: digits.digits is nd = 1.digits and Vd = 100 times 0.digits, with as many digits as
 * there are, and no fewer than three on each side; 517642 is 517.642; nd:Vd stands as it is.  CODE V's
 * dispersion between the lines is not published: the glass becomes a model of nd and Vd, which is
 * approximate.  The digits are shifted as a text, and rounded once.
 *
 * PRIVATE GLASSES stand in a block PRV ... END: PWL and wavelengths in nanometres, then 'NAME' and an index
 * at each; these become pairs, between which the lens file has straight lines.  'NAME' LAU a0 ... a5 is n^2 =
 * a0 + a1 L^2 + a2 / L^2 + a3 / L^4 + a4 / L^6 + a5 / L^8, L in micrometres: it becomes the indices at the
 * wavelengths of the lens.  The file itself spells their names, twice: so these are compared as they are
 * spelled, but for the case of letters.  Quotes ask for a private glass.  A name without quotes is the
 * catalogue's; if it is spelled as a private glass, and both have it, nobody knows which is meant. */
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

static bool as_spelled(piece a, piece b)
{
    const size_t length = (size_t)(a.end - a.begin);
    size_t i = 0;
    while (i < length && i < (size_t)(b.end - b.begin) && sgt_lower(a.begin[i]) == sgt_lower(b.begin[i])) i++;
    return i == length && i == (size_t)(b.end - b.begin);
}

static seq_private *own_glass(const seq *q, piece name)
{
    seq_private *g = q->own[hash_of(name)];
    while (g && !as_spelled(g->name.text, name)) g = g->next;
    return g;
}

static void private_wavelengths(seq *q)
{
    q->um = NULL, q->ums = q->um_room = 0;
    for (const seq_word *w = sgt_seq_more(q); w; w = sgt_seq_more(q)) {
        q->um = tree_grow(q->s, q->um, q->ums, &q->um_room, sizeof *q->um);
        q->um[q->ums++] = (seq_number){sgt_seq_wave(q, w, -3), w->line};
    }
}

static void private_glass(seq *q)
{
    enum { SERIES = 6 };
    const seq_word name = q->word[0];
    const seq_private *before = own_glass(q, name.text);
    if (before)
        tree_fail(q->s, name.line, "PRV", "a second glass %.*s; the first stands in line %zu",
                  sgt_reader_width(name.text), name.text.begin, before->name.line);
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
    if (!g->told)
        tree_remark(
            q->s, SGT_REMARK_TURNED, g->name.line, "PRV", "%s",
            g->series ? "its indices at the wavelengths of the lens, by a series whose form is not published"
            : g->ums == 1 ? "one index for all wavelengths"
                          : "straight lines between its indices: how CODE V goes between is not published");
    g->told = true;
}

/* ------------------------------------------------------- fictitious glasses */

static size_t digits_in(const char *at, const char *end)
{
    const char *c = at;
    while (c < end && *c >= '0' && *c <= '9') c++;
    return (size_t)(c - at);
}

static bool is_number(piece text)
{
    double x;
    return sgt_seq_number_of(text, &x);
}

/* nd and Vd of a code; false: it is none.  A number that is no code is refused: it is no name either. */
static bool fictitious(seq *q, const seq_word *w, double *nd, double *vd)
{
    enum { SIX = 6, LEAST = 3, MOST = 40 };
    const piece t = w->text;
    const char *colon = memchr(t.begin, ':', (size_t)(t.end - t.begin));
    if (colon)
        return sgt_seq_number_of((piece){t.begin, colon}, nd) &&
               sgt_seq_number_of((piece){colon + 1, t.end}, vd);
    const size_t first = digits_in(t.begin, t.end);
    const bool point = t.begin + first < t.end && t.begin[first] == '.';
    const char *second = t.begin + first + point;
    const size_t rest = point ? digits_in(second, t.end) : 0;
    const bool code = second + rest == t.end && (point ? first >= LEAST && rest >= LEAST : first == SIX);
    if (!code && is_number(t))
        tree_fail(q->s, w->line, "S",
                  "%.*s is no code of a glass, such as 517642 or 517.642: it has six digits, or a point and "
                  "three digits or more on both sides.  An index is written as nd:Vd",
                  sgt_reader_width(t), t.begin);
    if (!code || first > MOST || rest > MOST) return false;
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

/* Of each code it is told once what was taken. */
static void count_model(seq *q, const seq_word *w, double nd, double vd)
{
    for (size_t i = 0; i < q->models; i++)
        if (as_spelled(q->model[i].code, w->text)) {
            q->model[i].count++;
            return;
        }
    if (q->models < SEQ_MODELS)
        q->model[q->models++] = (seq_model){w->text, w->line, 1, nd, vd};
    else if (q->other_models++ == 0)
        q->other_models_line = w->line;
}

static void set_model(seq *q, node *map, const seq_word *w, double nd, double vd)
{
    enum { HIGHEST = 6, WEAKEST = 150 }; /* above those of any glass: 4 of germanium, 95 of fluorite */
    if (!(nd >= 1 && nd < HIGHEST && vd > 0 && vd < WEAKEST))
        tree_fail(q->s, w->line, "S", "a glass of nd %g and Vd %g is none", nd, vd);
    node *model = tree_node(q->s, NODE_MAP, w->line);
    sgt_seq_set_number(q, model, "nd", w->line, nd);
    sgt_seq_set_number(q, model, "vd", w->line, vd);
    tree_set(q->s, map, "glass", model);
    count_model(q, w, nd, vd);
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

/* The name as the lens file has it: MAKER NAME, or NAME if no maker is given.  NULL: there is none.  Of
 * several with these letters it is the one that is spelled so. */
static const char *catalogue_name(seq *q, const seq_word *w, piece name, const piece *maker)
{
    const seq_known *found = NULL, *other = NULL;
    for (const seq_known *k = q->known[hash_of(name)]; k; k = k->next) {
        if (!alike(name, piece_of(k->name)) || (maker && !alike(*maker, piece_of(k->maker)))) continue;
        if (as_spelled(name, piece_of(k->name))) {
            found = k, other = NULL;
            break;
        }
        if (!found)
            found = k;
        else if (!as_spelled(piece_of(found->name), piece_of(k->name)))
            other = k;
    }
    if (other)
        tree_fail(q->s, w->line, "S", "%.*s may be %s or %s, whose letters and digits are the same",
                  sgt_reader_width(w->text), w->text.begin, found->name, other->name);
    if (!found) return NULL;
    return maker ? tree_print(q->s, "%s %s", found->maker, found->name) : found->name;
}

/* Behind the last bar stands a maker, unless the bar is in the name. */
static size_t maker_at(piece t)
{
    const char *bar = t.end;
    while (bar > t.begin && bar[-1] != '_') bar--;
    return (size_t)(bar - t.begin);
}

static const char *named(seq *q, const seq_word *w)
{
    const piece t = w->text;
    const size_t at = maker_at(t);
    if (!q->known) ask_catalogue(q, w->line);
    const piece name = {t.begin, at ? t.begin + at - 1 : t.end}, maker = {t.begin + at, t.end};
    const char *found = catalogue_name(q, w, name, at ? &maker : NULL);
    return found || !at ? found : catalogue_name(q, w, t, NULL);
}

/* Of a name that is not found, the lens file's reader tells so, and what is near. */
static const char *name_not_found(seq *q, piece t)
{
    const size_t at = maker_at(t);
    const piece name = {t.begin, at ? t.begin + at - 1 : t.end}, maker = {t.begin + at, t.end};
    return tree_print(q->s, "%.*s%s%.*s", at ? sgt_reader_width(maker) : 0, maker.begin, at ? " " : "",
                      sgt_reader_width(name), name.begin);
}

/* Without quotes. */
static void set_plain(seq *q, node *map, const seq_word *w)
{
    double nd, vd;
    seq_private *own = own_glass(q, w->text);
    const bool code = fictitious(q, w, &nd, &vd);
    const char *name = code ? NULL : named(q, w);
    if (own && (code || name))
        tree_fail(q->s, w->line, "S",
                  "%.*s is the private glass of line %zu, and a %s: write '%.*s' if the first is meant",
                  sgt_reader_width(w->text), w->text.begin, own->name.line,
                  code ? "code of a glass" : "glass of the catalogue, too", sgt_reader_width(w->text),
                  w->text.begin);
    if (own) {
        if (!own->told_plain)
            tree_remark(q->s, SGT_REMARK_TURNED, w->line, "S",
                        "the private glass %.*s, though without quotes", sgt_reader_width(w->text),
                        w->text.begin);
        own->told_plain = true;
        set_private(q, map, own, w->line);
    } else if (code) {
        set_model(q, map, w, nd, vd);
    } else {
        tree_set(q->s, map, "glass", tree_word(q->s, w->line, name ? name : name_not_found(q, w->text)));
    }
}

void sgt_seq_set_medium(seq *q, node *map, const seq_surface *f, bool object)
{
    const seq_word *w = &f->glass;
    if (f->mirror) sgt_seq_set_word(q, map, "mirror", f->line, "true");
    if (!w->line) {
        if (!f->mirror && !object) sgt_seq_set_word(q, map, "glass", f->line, "air");
        return;
    }
    if (!w->quoted) {
        set_plain(q, map, w);
        return;
    }
    seq_private *own = own_glass(q, w->text);
    if (!own)
        tree_fail(q->s, w->line, "S", "there is no glass '%.*s' in a PRV block of this file",
                  sgt_reader_width(w->text), w->text.begin);
    set_private(q, map, own, w->line);
}

// SPDX-License-Identifier: MIT
/* rii.c - one material in the form of the refractiveindex.info database (.yml).
 *
 *     REFERENCES: "..."
 *     DATA:
 *       - type: formula 2
 *         wavelength_range: 0.3 2.5
 *         coefficients: 0 1.03961212 0.00600069867
 *       - type: tabulated nk
 *         data: |
 *             0.300 1.5528 2.8607E-06
 *
 * It is YAML, but of one shape, so lines are read as they come: a key at the left margin begins a
 * part, of which DATA alone is used, and a dash an entry.  The first entry that has n is the
 * glass; k and a second n are left out, with a remark. */
#include "forms.h"

#include <string.h>

typedef enum part { PART_OTHER, PART_DATA } part;

typedef struct material {
    bool      found, range, finished; /* an entry with n; its range; its end */
    bool      table;
    size_t    columns;                /* of the table */
    bool      in_table;
    bool      more;                   /* something was left out */
    size_t    pairs;
    double   *pair;
    double    coefficient[READER_COEFFICIENTS];
    sgt_glass glass;
} material;

static piece bare(piece text)
{
    while (text.begin < text.end && (*text.begin == ' ' || *text.begin == '\t')) text.begin++;
    return text;
}

static bool rii_type(const reader *r, material *m, piece value)
{
    static const char *const formula[] = {"formula 1", "formula 2", "formula 3", "formula 4", "formula 5",
                                          "formula 6", "formula 7", "formula 8", "formula 9"};
    m->finished = m->found, m->in_table = false;
    bool with_k = sgt_reader_is(value, "tabulated nk"), table = with_k || sgt_reader_is(value, "tabulated n");
    int number = 0;
    for (int i = 0; i < 9; i++)
        if (sgt_reader_is(value, formula[i])) number = i + 1;
    if (!number && !table && !sgt_reader_is(value, "tabulated k") && !sgt_reader_is(value, "tabulated n2"))
        return sgt_reader_fail(r, r->line, "type", "no such kind of data: \"%.*s\"",
                               sgt_reader_width(value), value.begin);
    if (m->finished || (!number && !table)) return m->more = true;
    m->found = true, m->table = table, m->columns = with_k ? 3 : 2, m->more = m->more || with_k;
    m->glass.formula = table ? SGT_DISPERSION_PAIRS : number, m->glass.line = r->line;
    return true;
}

static bool rii_row(const reader *r, material *m, piece line)
{
    double value[READER_COEFFICIENTS];
    size_t count;
    if (!sgt_reader_numbers(r, "data", line, value, &count)) return false;
    if (count != m->columns)
        return sgt_reader_fail(r, r->line, "data", "%zu numbers, not %zu", count, m->columns);
    if (!m->pair) { /* as much as the rest of the file has lines for: a row has 4 characters or more */
        m->pair = sgt_arena_take(&r->catalogue->arena,
                                 ((size_t)(r->end - r->at) / 4 + 2) * 2 * sizeof *m->pair);
        if (!m->pair) return sgt_reader_fail(r, r->line, "data", "no memory");
    }
    m->pair[2 * m->pairs] = value[0], m->pair[2 * m->pairs + 1] = value[1];
    m->pairs++;
    return true;
}

static bool rii_entry(const reader *r, material *m, piece line)
{
    const char *colon = line.begin;
    while (colon < line.end && *colon != ':') colon++;
    bool ours = m->found && !m->finished;
    if (colon == line.end) {
        if (m->in_table) return !ours || rii_row(r, m, line);
        return sgt_reader_fail(r, r->line, "", "neither a key nor a row of data");
    }
    piece key = {line.begin, colon}, value = bare((piece){colon + 1, line.end});
    m->in_table = false;
    if (sgt_reader_is(key, "type")) {
        return sgt_reader_whole(r, "type") && rii_type(r, m, value);
    }
    if (sgt_reader_is(key, "data")) return m->in_table = true;
    if (!ours) return true;
    if (sgt_reader_is(key, "wavelength_range") || sgt_reader_is(key, "range")) {
        double range[READER_COEFFICIENTS];
        size_t count;
        if (!sgt_reader_numbers(r, "wavelength_range", value, range, &count)) return false;
        if (count != 2 || !(range[0] > 0 && range[1] >= range[0]))
            return sgt_reader_fail(r, r->line, "wavelength_range",
                                   "needs two wavelengths, positive and rising");
        m->glass.from = range[0], m->glass.to = range[1], m->range = true;
        return true;
    }
    if (sgt_reader_is(key, "coefficients")) {
        m->glass.coefficient = m->coefficient;
        return sgt_reader_numbers(r, "coefficients", value, m->coefficient, &m->glass.count);
    }
    return sgt_reader_fail(r, r->line, "", "\"%.*s\" is no key of an entry",
                           sgt_reader_width(key), key.begin);
}

bool sgt_read_rii(reader *r, piece name, piece maker)
{
    material m = {0};
    part in = PART_OTHER;
    for (piece line; sgt_reader_line(r, &line);) {
        piece text = bare(line);
        if (text.begin == text.end || *text.begin == '#') continue;
        bool dash = *text.begin == '-' && (text.begin + 1 == text.end || text.begin[1] == ' ');
        if (text.begin == line.begin && !dash) {
            in = sgt_reader_is(text, "DATA:") ? PART_DATA : PART_OTHER;
            continue;
        }
        if (in != PART_DATA) continue;
        if (dash) text = bare((piece){text.begin + 1, text.end}), m.in_table = false;
        if (text.begin < text.end && !rii_entry(r, &m, text)) return false;
    }
    sgt_glass *g = &m.glass;
    if (!m.found) return sgt_reader_fail(r, r->line, "DATA", "there is no index of refraction in this file");
    if (m.table) {
        if (m.pairs == 0) return sgt_reader_fail(r, r->line, "data", "an empty table");
        g->coefficient = m.pair, g->count = 2 * m.pairs;
        g->from = m.pair[0], g->to = m.pair[2 * m.pairs - 2];
    }
    if (g->count == 0) return sgt_reader_fail(r, r->line, "coefficients", "missing");
    if (!m.table && !m.range) return sgt_reader_fail(r, r->line, "wavelength_range", "missing");
    g->name = sgt_reader_text(r->catalogue, name), g->maker = sgt_reader_text(r->catalogue, maker);
    if (!g->name || !g->maker) return sgt_reader_fail(r, r->line, "", "no memory");
    if (m.more) g->remark = "absorption and further data are not used";
    r->line = g->line; /* of which sgt_glass_fault speaks */
    return sgt_reader_append(r, *g, m.table ? "data" : "coefficients");
}

// SPDX-License-Identifier: MIT
/* agf.c - glass catalogues in the form of OpticStudio (.agf).
 *
 * A line is a record: a key of two letters, then fields with blanks between.
 *     CC  comment on the catalogue
 *     NM  name, formula 1 ... 13, MIL number, nd, vd, exclude, status, melt frequency
 *     GC  comment on the glass
 *     CD  coefficients of the formula     LD  range of wavelengths, um
 *     ED, TD, OD, IT, MD, BD  expansion, temperature, price and resistance, transmission: not used
 * A glass begins with NM and ends before the next.  NM, CD and LD are needed.
 *
 * Programs disagree on the second term of formula 4 (some multiply it by w^2), and catalogues have
 * slips of the pen: where the formula and the nd that is printed differ, a remark says so. */
#include "forms.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* More than any catalogue rounds nd by. */
static const double ND_SLIP = 1e-4;

typedef struct draft {
    bool      open, has_coefficients, has_range;
    sgt_glass glass;
    double    coefficient[READER_COEFFICIENTS];
    char      remark[400];
} draft;

/* Appends to the remark, as much as fits. */
static void add_remark(draft *d, const char *text, size_t length)
{
    size_t used = strlen(d->remark), room = sizeof d->remark - used - 1;
    if (used && room > 2) memcpy(d->remark + used, "; ", 3), used += 2, room -= 2;
    if (length > room)
        for (length = room; length > 0 && (text[length] & 0xC0) == 0x80;) length--; /* no half character */
    memcpy(d->remark + used, text, length), d->remark[used + length] = 0;
}

static bool finish_glass(const reader *r, draft *d)
{
    if (!d->open) return true;
    sgt_glass *g = &d->glass;
    if (!d->has_coefficients)
        return sgt_reader_fail(r, g->line, "CD", "glass %.60s has no coefficients", g->name);
    if (!d->has_range)
        return sgt_reader_fail(r, g->line, "LD", "glass %.60s has no range of wavelengths", g->name);
    const double um = sgt_spectral_line("d");
    double n = sgt_glass_covers(g, um) ? sgt_glass_index(g, um) : (double)NAN;
    if (g->nd > 1 && fabs(n - g->nd) > ND_SLIP) {
        char text[100];
        /* %g: an nd of 1e300 has 300 digits in %f. */
        snprintf(text, sizeof text, "its formula gives nd = %.7g, but %.7g is printed", n, g->nd);
        add_remark(d, text, strlen(text));
    }
    g->remark = d->remark[0] ? d->remark : NULL;
    d->open = false;
    return sgt_reader_append(r, *g, "CD");
}

static bool begin_glass(const reader *r, draft *d, piece rest, piece maker)
{
    piece name = sgt_reader_word(&rest), formula = sgt_reader_word(&rest);
    double value[3];
    sgt_reader_word(&rest); /* the MIL number */
    piece nd = sgt_reader_word(&rest), vd = sgt_reader_word(&rest);
    if (!sgt_reader_whole(r, "NM")) return false;
    if (name.begin == name.end) return sgt_reader_fail(r, r->line, "NM", "no name");
    if (!sgt_reader_number(formula, &value[0]) || !(value[0] >= 1 && value[0] <= 13) ||
        value[0] != (int)value[0])
        return sgt_reader_fail(r, r->line, "NM", "glass %.*s: no such dispersion formula: \"%.*s\"",
                               sgt_reader_width(name), name.begin,
                               sgt_reader_width(formula),
                               formula.begin);
    *d = (draft){.open = true};
    d->glass = (sgt_glass){.formula = SGT_DISPERSION_AGF + (int)value[0], .line = r->line};
    d->glass.name = sgt_reader_text(r->catalogue, name);
    d->glass.maker = sgt_reader_text(r->catalogue, maker);
    if (!d->glass.name || !d->glass.maker) return sgt_reader_fail(r, r->line, "NM", "no memory");
    if (sgt_reader_number(nd, &value[1])) d->glass.nd = value[1];
    if (sgt_reader_number(vd, &value[2])) d->glass.vd = value[2];
    return true;
}

static bool read_coefficients(const reader *r, draft *d, piece rest)
{
    static const size_t used[] = {6, 6, 6, 5, 3, 8, 4, 4, 5, 8, 10, 8, 9};
    sgt_glass *g = &d->glass;
    if (d->has_coefficients) return sgt_reader_fail(r, r->line, "CD", "a second CD for glass %.60s", g->name);
    if (!sgt_reader_numbers(r, "CD", rest, d->coefficient, &g->count)) return false;
    size_t most = used[g->formula - SGT_DISPERSION_AGF - 1];
    for (size_t i = most; i < g->count; i++)
        if (d->coefficient[i] != 0) {
            static const char text[] = "CD has numbers that its formula does not use";
            add_remark(d, text, sizeof text - 1);
            break;
        }
    if (g->count > most) g->count = most;
    g->coefficient = d->coefficient;
    d->has_coefficients = true;
    const char *fault = sgt_glass_fault(g);
    return !fault || sgt_reader_fail(r, r->line, "CD", "glass %.60s: %s", g->name, fault);
}

static bool read_range(const reader *r, draft *d, piece rest)
{
    double value[READER_COEFFICIENTS];
    size_t count;
    if (!sgt_reader_numbers(r, "LD", rest, value, &count)) return false;
    if (count != 2 || !(value[0] > 0 && value[1] >= value[0]))
        return sgt_reader_fail(r, r->line, "LD", "glass %.60s: needs two wavelengths, positive and rising",
                               d->glass.name);
    d->glass.from = value[0], d->glass.to = value[1];
    d->has_range = true;
    return true;
}

bool sgt_read_agf(reader *r, piece maker)
{
    static const char *const unused[] = {"CC", "ED", "TD", "OD", "IT", "MD", "BD"};
    draft d = {0};
    bool any = false;
    for (piece line; sgt_reader_line(r, &line);) {
        piece rest = line, key = sgt_reader_word(&rest);
        bool fine = true, known = key.begin == key.end;
        for (size_t i = 0; i < sizeof unused / sizeof *unused; i++)
            known = known || sgt_reader_is(key, unused[i]);
        if (known) continue;
        if (sgt_reader_is(key, "NM")) {
            fine = finish_glass(r, &d) && begin_glass(r, &d, rest, maker);
            any = true;
        } else if (sgt_reader_is(key, "GC")) {
            while (rest.begin < rest.end && (*rest.begin == ' ' || *rest.begin == '\t')) rest.begin++;
            if (d.open && rest.begin < rest.end) add_remark(&d, rest.begin, (size_t)(rest.end - rest.begin));
        } else if (sgt_reader_is(key, "CD") || sgt_reader_is(key, "LD")) {
            const char *which = *key.begin == 'C' ? "CD" : "LD";
            fine = d.open ? *key.begin == 'C' ? read_coefficients(r, &d, rest) : read_range(r, &d, rest)
                          : sgt_reader_fail(r, r->line, which, "before the first NM");
        } else {
            fine = sgt_reader_fail(r, r->line, "", "\"%.*s\" is no record of a glass catalogue",
                                   sgt_reader_width(key), key.begin);
        }
        if (!fine) return false;
    }
    if (!finish_glass(r, &d)) return false;
    return any || sgt_reader_fail(r, r->line, "NM", "there is no glass in this file");
}

// SPDX-License-Identifier: MIT
/* csv.c - the table of glasses that ships.
 *
 *     maker,glass,formula,from_um,to_um,coefficients
 *     schott,N-BK7,2,0.3,2.5,0 1.03961212 0.00600069867 ...
 *
 * Blank lines and lines that begin with # are skipped.  Formulas are numbered as in lens.h. */
#include "forms.h"

static const char header[] = "maker,glass,formula,from_um,to_um,coefficients";

enum { MAKER, GLASS, FORMULA, FROM, TO, COEFFICIENTS, COLUMNS };
static const char *const column[] = {"maker", "glass", "formula", "from_um", "to_um", "coefficients"};

static bool read_row(reader *r, piece line)
{
    piece field[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
        const char *s = line.begin;
        while (s < line.end && *s != ',') s++;
        if ((s == line.end) != (i == COEFFICIENTS))
            return sgt_reader_fail(r, r->line, column[i], "a row has six fields: %s", header);
        field[i] = (piece){line.begin, s};
        if (field[i].begin == field[i].end) return sgt_reader_fail(r, r->line, column[i], "empty");
        line.begin = s < line.end ? s + 1 : s;
    }
    double value[3], coefficient[READER_COEFFICIENTS];
    for (int i = FORMULA; i <= TO; i++)
        if (!sgt_reader_number(field[i], &value[i - FORMULA]))
            return sgt_reader_fail(r, r->line, column[i], "\"%.*s\" is not a finite number",
                                   sgt_reader_width(field[i]),
                                   field[i].begin);
    if (!(value[0] >= 1 && value[0] <= 1000) || value[0] != (int)value[0])
        return sgt_reader_fail(r, r->line, "formula", "no such dispersion formula: %g", value[0]);
    if (!(value[1] > 0 && value[2] >= value[1]))
        return sgt_reader_fail(r, r->line, "from_um", "the range must be positive and rise, not %g to %g",
                               value[1], value[2]);
    sgt_glass g = {.formula = (int)value[0], .from = value[1], .to = value[2], .line = r->line};
    if (!sgt_reader_numbers(r, "coefficients", field[COEFFICIENTS], coefficient, &g.count)) return false;
    g.coefficient = coefficient;
    g.name = sgt_reader_text(r->catalogue, field[GLASS]);
    g.maker = sgt_reader_text(r->catalogue, field[MAKER]);
    if (!g.name || !g.maker) return sgt_reader_fail(r, r->line, "glass", "no memory");
    return sgt_reader_append(r, g, "coefficients");
}

bool sgt_read_csv(reader *r)
{
    bool begun = false, any = false;
    for (piece line; sgt_reader_line(r, &line);) {
        if (line.begin == line.end || *line.begin == '#') continue;
        if (!begun && (!sgt_reader_is(line, header) || !r->whole))
            return sgt_reader_fail(r, r->line, "", "the first line must be %s", header);
        if (begun && !read_row(r, line)) return false;
        any = begun, begun = true;
    }
    return any || sgt_reader_fail(r, r->line, "", "there is no glass in this file");
}

// SPDX-License-Identifier: MIT
/* passed.c - a ray that passed a lens, in short: how near it came to being clipped or reflected, and how well
 * each root is known. */
#include "passed.h"

#include "../show/frame.h"
#include "../../text/number.h"

#include <math.h>

static const column passed_head[] = {
    {"element", COLUMN_COUNT}, {"type", COLUMN_WORD}, {"r", COLUMN_NUMBER}, {"semi_diameter", COLUMN_NUMBER},
    {"share", COLUMN_NUMBER}, {"incidence", COLUMN_NUMBER}, {"t", COLUMN_NUMBER}, {"t_err", COLUMN_ERROR},
    {"evals", COLUMN_COUNT}, {"name", COLUMN_WORD},
};
enum { PASSED_COLUMNS = sizeof passed_head / sizeof passed_head[0] };

/* The last column is that of names, if the lens has any. */
static bool has_names(const lens *l)
{
    for (size_t i = 0; i < l->count; i++)
        if (*l->surface[i].name) return true;
    return false;
}

table *passed_begin(const table_target *target, const lens *l)
{
    return table_begin(target, PASSED_COLUMNS - !has_names(l), passed_head);
}

/* x with four digits. */
static double shortened(double x)
{
    char text[NUMBER_SIZE];
    number_print_short(text, x, 4);
    return number_read(text, &x) ? x : (double)NAN;
}

void passed_write(table *t, const job *j, const watched *w)
{
    const lens *l = &j->lens;
    const bool names = has_names(l);
    for (size_t i = 0; i < w->count; i++) {
        const sgt_element *e = &j->element[i];
        const sgt_hit *hit = &w->passage[i].hit;
        const sgt_arrival come = watched_arrival(w, l, i);
        double r = hypot(hit->p.x, hit->p.y), edge = e->semi_diameter > 0 ? e->semi_diameter : (double)NAN;
        table_count(t, (long long)i + 1);
        table_word(t, l->surface[i].type);
        table_number(t, r);
        table_number(t, edge);
        table_number(t, shortened(r / edge));
        table_number(t, shortened(sgt_incidence(e, &come)));
        table_number_within(t, hit->t, hit->t_err);
        table_count(t, hit->evals);
        if (names) table_word(t, l->surface[i].name);
    }
    const char *units = *l->units ? l->units : "that of the lens";
    table_line(t, "r: from the axis of the element.  share: r / semi_diameter.  incidence: degrees from the");
    table_line(t, "normal.  t, t_err: from the element before, or the ray's start.  evals: evaluations.  "
                  "Unit of length: %.20s.", units);
    table_line(t, "\n--all-elements shows how each root was found; --element J that at one element.");
}

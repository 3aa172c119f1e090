/* fan.c - sagitta fan: transverse errors along two lines of the pupil. */
#include "commands.h"
#include "../base/memory.h"
#include "../draw/chart.h"
#include "../look/look.h"
#include "../look/lines.h"

#include <math.h>

static const char fan_help[] =
    "sagitta fan LENS [options]\n"
    "\n"
    "Transverse errors: where the rays of a field meet the image, from where the chief ray of the primary\n"
    "wavelength does.  By default for two lines across the pupil, in y (tangential) and in x (sagittal).\n"
    "\n"
    "Columns\n"
    "  field, wavelength  the field, counted from 1; micrometres\n"
    "  px, py             the point of the pupil, in radii of it\n"
    "  fate               passed; missed, clipped, tir, lost; none: proven, no such ray\n"
    "  ex, ey             the errors in x and y (length, in the frame of the last surface)\n"
    "  e_err              rounding puts neither off by more (length)\n"
    "  ex_mrad, ey_mrad, e_err_mrad\n"
    "                     instead, if the lens is afocal: angles from the chief ray (milliradians)\n"
    "\n"
    "Options\n";

typedef struct fan_work {
    look look;
    launch_pattern points;
    table *table;
    sgt_ray_end *end;           /* [points], of one field and wavelength after another */
    look_lines *lines;          /* [fields]; NULL: no picture */
} fan_work;

/* In the unit of the picture. */
static double fan_small(const look *l, double x) { return l->primary.lens.of->afocal ? x : look_small(l, x); }

static void fan_rows(fan_work *w, size_t field)
{
    look *l = &w->look;
    const sgt_field_beam *beam = &l->beam[field];
    const sgt_ray_end chief = look_chief(l, beam, &l->primary, l->primary.element);
    sgt_ray_end about = chief;
    if (l->primary.lens.of->afocal) sgt_ends_as_angles(&chief.d, 1, &chief, &about);
    if (chief.fate != SGT_PASSED)
        note("field %zu: the chief ray does not get through, so there is no reference",
             l->fields.number[field] + 1);
    for (size_t b = 0; b < l->bands; b++) {
        const look_band *band = &l->band[b];
        const sgt_ray_end *end = w->end;
        look_trace(l, beam, band, band->element, &w->points, true, w->end);
        if (l->primary.lens.of->afocal) sgt_ends_as_angles(&chief.d, w->points.count, w->end, w->end);
        if (field + b > 0) table_gap(w->table);
        for (size_t i = 0; i < w->points.count; i++) {
            const double ex = end[i].p.x - about.p.x, ey = end[i].p.y - about.p.y;
            look_cells(w->table, l, field, band);
            table_number(w->table, end[i].px);
            table_number(w->table, end[i].py);
            look_fate_cell(w->table, &end[i]);
            look_number(w->table, ex);
            look_number(w->table, ey);
            look_number(w->table, end[i].p_err + about.p_err);
            if (w->lines)
                look_lines_add(&w->lines[field], b, &end[i], fan_small(l, ey), fan_small(l, ex));
        }
    }
}

exit_status command_fan(int argc, char *argv[])
{
    enum { ACROSS = 41 };
    static const struct option known[] = {LOOK_OPTIONS, {0}};
    column columns[] = {
        {"field", COLUMN_COUNT}, {"wavelength", COLUMN_EXACT}, {"px", COLUMN_NUMBER}, {"py", COLUMN_NUMBER},
        {"fate", COLUMN_CODE},   {"ex", COLUMN_NUMBER},        {"ey", COLUMN_NUMBER}, {"e_err", COLUMN_ERROR},
    };
    look_options o = {.pattern = "--cross 41"};
    for (int code; (code = getopt_long(argc, argv, LOOK_LETTERS, known, NULL)) != -1;)
        look_take_option(&o, code, fan_help);
    look_take_lens(&o, argc, argv, "fan");
    fan_work w = {.points = job_points(&o.job, SGT_PATTERN_CROSS, ACROSS)};
    if (o.picture) look_lines_check(&w.points);
    w.look = look_begin(&o);
    w.end = memory_take(w.points.count, sizeof *w.end);
    if (o.picture) w.lines = memory_take(w.look.fields.count, sizeof *w.lines);
    const bool afocal = w.look.primary.lens.of->afocal;
    if (afocal) columns[5].name = "ex_mrad", columns[6].name = "ey_mrad", columns[7].name = "e_err_mrad";
    w.table = table_begin(&o.shared.target, sizeof columns / sizeof columns[0], columns);
    for (size_t f = 0; f < w.look.fields.count; f++) {
        if (w.lines) w.lines[f] = look_lines_for(&w.look, &w.points);
        fan_rows(&w, f);
    }
    if (afocal)
        table_line(w.table, "ex_mrad, ey_mrad: angles from the chief ray of the primary wavelength.");
    else
        table_line(w.table, "ex, ey: from the chief ray of the primary wavelength.  Unit of length: %s.",
                   *w.look.primary.lens.units ? w.look.primary.lens.units : "that of the lens");
    look_verdict(w.table, &w.look);
    table_end(w.table);
    if (o.picture)
        look_lines_draw(&w.look, w.lines, "ray fans", "from the chief ray of the primary wavelength",
                        look_text("ey (%s)", afocal ? "mrad" : look_small_unit(&w.look)),
                        look_text("ex (%s)", afocal ? "mrad" : look_small_unit(&w.look)));
    return look_status(&w.look);
}
